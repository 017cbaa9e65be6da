/* SPDX-License-Identifier: MIT */
/*
 * Own numbers of labels: what they are called in files.
 *
 * A label is 0..255, and atlases number their regions up to 65533 (session/map.h). So regions
 * of a file that are not all labels by their own numbers become labels in rising order, each the
 * lowest that is free, and the label remembers its number: maps and tables that are saved have it
 * again, and those that are read are understood by it.
 *
 *     a file has 2, 41, 1001, 1035       they become labels 1, 2, 3, 4
 *     label 77 is planted beside them    it has no own number, and is 77 in files
 *
 * A region that has become a label once is that label in every file from then on. A label is free
 * where it has no own number, and no marker that stands plants it.
 *
 * Invariants
 *   N1 no two labels have the same own number, and label 0 has none: it is 0 in every file;
 *   N2 which labels the regions of a list become follows from the list and the state.
 */
#ifndef SESSION_NUMBERING_H
#define SESSION_NUMBERING_H

#include "base/buf.h"
#include "session/markers.h"
#include "session/map.h"
#include "session/state.h"

/* What a label is in files; 0 for the background, and where its number is another label's. */
uint16_t numbering_of(const struct kept *kept, unsigned label);

/* Of regions that would become labels of their numbers (regions_new without labels), as[r]: those
 * that are own numbers become these labels; one that is another label's is none, as those above
 * 255 are. */
void numbering_translate(uint16_t *as, const struct kept *kept);

/* Whether labels have own numbers. */
bool numbering_is_used(const struct kept *kept);

/* Adds to `list`, as the parser takes it, the regions that are to be numbered: of those that a file
 * `has` and `as` chooses, the ones that are no label; where no label has an own number yet, all of
 * them but 0. Nothing where all of them are labels. */
void numbering_list(struct buf *list, const uint16_t *as, const bool has[REGION_MOST + 1],
                    const struct kept *kept);

/* What has become of a list. */
struct numbering_tally {
    unsigned regions, first_label, last_label; /* the labels of the first and of the last one */
    unsigned names;                            /* that were taken away from these labels */
};

/* Numbers free labels by a list in rising order, but for what is an own number already. A name that
 * such a label had is not that of the region, and goes. ERR_INPUT, and *kept is of no use, where
 * more are listed than are free. */
enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault);

/* ERR_INPUT where the number of one of these labels is another label's. */
enum err numbering_check(const struct kept *kept, const bool used[256], struct fault *fault);

#endif
