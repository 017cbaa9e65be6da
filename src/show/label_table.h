/* SPDX-License-Identifier: MIT */
/*
 * Label tables: numbers, names and colours in files of other programs.
 *
 *     ITK-SNAP              1  255 0 0  1  1 1  "left hippocampus"      R G B, opacity, two flags
 *     FreeSurfer, Slicer    17  Left-Hippocampus  220 216 20 0          R G B A
 *     mricron               37  Hippocampus_L  4101                     a number of its own
 *     mricron, .lut         768 bytes: 256 of red, then of green, then of blue
 *
 * One reader takes all of them, line by line; empty lines and those that begin with # are passed
 * over. In .lut, number 0 has no meaning.
 *
 * A name stays as it is written where a label can have it (label_name_fits). Between double quotes,
 * \" is a quote. Else a sign that a name cannot hold becomes _, a number gets "label-" before it,
 * and a name that is too long loses its middle, since sides are at the end:
 * "Superior_fronto-occ~al_capsule)_R". Names that were changed are counted.
 *
 * Memory in, table out, and the reverse: who finds the file and reads it is the caller.
 */
#ifndef REPORT_LABEL_TABLE_H
#define REPORT_LABEL_TABLE_H

#include "base/buf.h"
#include "session/state.h"

/* Whether a label can have this name: printable UTF-8 of 1 to LABEL_NAME_BYTES - 1 bytes, without
 * = and \, with no blank at its ends and no # at its beginning; no number. */
bool label_name_fits(const char *name);

struct label_entry {
    uint32_t number;
    bool has_colour, changed; /* changed: its name is not as it stands in the file */
    uint8_t rgb[3];
    char name[LABEL_NAME_BYTES]; /* "" for none */
};

struct label_table {
    struct label_entry *entry; /* in the order of the file */
    size_t count, capacity;
};
void label_table_release(struct label_table *table);

/* A table of text: `length` bytes at `text`, and a NUL after them. ERR_LIMIT for more than
 * REGION_MOST + 1 labels; on the first line that is none of the above, ERR_INPUT with words that
 * name it. On errors *table is empty. */
enum err label_table_read(struct label_table *table, const char *text, size_t length,
                          struct fault *fault);

/* A .lut, of labels 1 to 255. */
enum err label_table_read_lut(struct label_table *table, const uint8_t *bytes, size_t length,
                              struct fault *fault);

/* What has become of the entries of a table. */
struct label_tally {
    unsigned names, colours; /* that labels were given */
    unsigned beyond;         /* entries whose label is none of 1..255, or that were not chosen */
    unsigned changed;        /* names that had to be made to fit; of the first of them: */
    uint8_t first_changed;
};

/* Gives labels 1..255 the names and colours of the entries: of entry n, to the label as[n]
 * (session/map.h). A name that another label has by then gets the number of the label at its
 * end. ERR_INPUT, and nothing has changed, where two entries are for one label, or none is for
 * any. */
enum err label_table_apply(struct kept *kept, struct label_tally *tally,
                           const struct label_table *table, const uint16_t *as,
                           struct fault *fault);

/* A sum mod 2^64 over names and colours of labels 1..255: what a table has led to. */
uint64_t label_table_digest(const struct kept *kept);

enum label_table_format {
    TABLE_ITKSNAP,
    TABLE_SLICER,
    TABLE_FREESURFER,
    TABLE_MRICRON,
    TABLE_LUT,
};

/* The ending of a name, and which format it says: .nii.txt mricron, other .txt and .label ITK-SNAP,
 * .ctbl 3D Slicer, .ctab FreeSurfer, .lut that. NULL for other names. */
const char *label_table_ending(const char *path, enum label_table_format *format);

/* Names that a format cannot hold as they are. */
struct label_writing {
    unsigned changed; /* of the first of them: */
    unsigned first_changed;
    char first_written[LABEL_NAME_BYTES]; /* "" in a .lut, which has no names */
};

/* Writes labels 1..255 that have a name or are `used`; a .lut has all of them. Blanks become _
 * where a format has none in names, and a double quote becomes ' for ITK-SNAP, where it ends a
 * name. */
void label_table_write(struct buf *out, struct label_writing *writing,
                       enum label_table_format format, const struct kept *kept,
                       const bool used[256]);

#endif
