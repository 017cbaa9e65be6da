/*
 * The seams: the faces at which two shown objects touch.
 *
 * An opaque picture never shows such a face, so the border (render/border.h) knows nothing of them;
 * where objects are translucent it does. They are held as one bit per cell and axis. One more says
 * of each cell whether anything is to be seen there: a ray through cells without it stays in what
 * it is in. Yet another says that this is far away, so that such rays take many cells at once. And
 * labels are copied, a byte each: cells that are looked at here and there lie closer together then.
 *
 * Invariant: once seams_follow or seams_count was the last to be called, bit c % 64 of word c / 64
 * of between[a] says that cell c and its neighbour one step along axis a are both shown, and have
 * different labels; and that of `edge` that one of its six neighbours is shown and it is not, or it
 * is and one of them is not, or has another label. Where `has_near`, that of `near` says that there
 * is an edge at most SEAMS_NEAR steps away along each axis, or until a recount, that there was one.
 */
#ifndef RENDER_SEAMS_H
#define RENDER_SEAMS_H

#include "render/border.h"

enum { SEAMS_NEAR = 7 };

struct seams {
    const struct border *border; /* whose they are as of its version; NULL: of none */
    uint32_t version;
    uint64_t *between[3], *edge, *near; /* [words] each */
    bool has_near;
    uint8_t *label; /* [64 * words]; of all cells */
    size_t words;
};

/* A new one is zeroed. */
void seams_release(struct seams *seams);
size_t seams_bytes(const struct seams *seams);

/* Those of the border: nothing to do where they are that already, else a scan of the scene, under
 * its watch. ERR_MEMORY. */
enum err seams_count(struct seams *seams, const struct border *border, struct fault *fault);

/* The same after an edit, of which the border has just been told, in time proportional to it. */
enum err seams_follow(struct seams *seams, const struct border *border,
                      const struct changes *changes, struct fault *fault);

/* Finds what is near, of a border's seams, once. */
void seams_find_near(struct seams *seams);

static inline uint8_t seams_label(const struct seams *seams, uint32_t cell)
{
    return seams->label[cell];
}

static inline bool seams_is_edge(const struct seams *seams, uint32_t cell)
{
    return seams->edge[cell >> 6] >> (cell & 63) & 1;
}
static inline bool seams_is_near(const struct seams *seams, uint32_t cell)
{
    return seams->near[cell >> 6] >> (cell & 63) & 1;
}

/* Which of the 64 cells of word `w` have such a face on the side to which `step` leads, along axis
 * `a`. */
static inline uint64_t seams_toward(const struct seams *seams, size_t w, int a, ptrdiff_t step)
{
    const ptrdiff_t at = (ptrdiff_t)w * 64;
    return border_bits_from(seams->between[a], seams->words, step > 0 ? at : at + step);
}

#endif
