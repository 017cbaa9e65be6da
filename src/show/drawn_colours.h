/*
 * Colours alone: a picture for a file that holds nothing else, drawn a few rows at a time.
 *
 * Nobody will ask for the depth or the voxel of one of its pixels, so no map of them is stored: it
 * takes 4 bytes a pixel rather than 25, and the rows that are being drawn. What else is said of a
 * picture is taken from its rows as they come: its digest, and the labels that it shows.
 */
#ifndef SHOW_DRAWN_COLOURS_H
#define SHOW_DRAWN_COLOURS_H

#include "render/rendition.h"
#include "session/session.h"

/* Labels that pixels show, 0 among them: a bit each. */
struct label_set {
    uint64_t bits[4];
};

static inline void label_set_put(struct label_set *set, uint8_t label)
{
    set->bits[label >> 6] |= UINT64_C(1) << (label & 63);
}

static inline bool label_set_has(const struct label_set *set, unsigned label)
{
    return set->bits[label >> 6] >> (label & 63) & 1;
}

/* Those of a rendition. */
void label_set_add(struct label_set *set, const struct rendition *rendition);

struct drawn_colours {
    uint8_t
        *rgba; /* to be set: [height][width][4] of the view's size, or NULL for the rest alone */
    _Atomic uint64_t digest; /* rendition_digest */
    _Atomic uint64_t labels[4];
    uint32_t height, background;
};

/* Whether they are enough for a picture of the session as it is: context, and marks of seeds, look
 * at more than colours. */
bool session_draws_colours(const struct session *session);

/* What is behind the objects in them; clear, where the file's format decides how that is shown. */
uint32_t session_behind_colours(const struct session *session);

/* Draws such labels (session_labels), as session_draw_labels does, into `colours`, over what is
 * behind them: from nothing. A rendition of one sample a pixel that is there is drawn over, so that
 * going back needs no memory; others are let go of. ERR_MEMORY, ERR_CANCELLED. */
enum err session_draw_colours(struct session *session, const struct labels *labels,
                              struct drawn_colours *colours, struct fault *fault);
struct label_set drawn_labels(const struct drawn_colours *colours);

/* For draw.c: takes what bands draw (render/bands.h). */
void drawn_colours_take(void *colours, const struct rendition *rows, uint32_t top);

#endif
