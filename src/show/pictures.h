/* SPDX-License-Identifier: MIT */
/*
 * The pictures of a session, for the files of this room: what is stored of them, so that an edit or
 * another look takes no longer than it must. They are there from the first one on that somebody
 * asks for (draw.c), and follow the session until its scene is closed (session/session.h).
 *
 * Invariants
 *   V1 the rendition, where `rendered`, is that of those labels, their border and the camera, pixel
 *      for pixel, whichever mode made it;
 *   V2 where `live.of` is what the session says now, the live labels are those that session_labels
 *      gives;
 *   V3 the border of these is that of their labels, and of what was visible and cut away when it
 *      was last drawn.
 */
#ifndef SHOW_PICTURES_H
#define SHOW_PICTURES_H

#include "engine/label_stats.h"
#include "render/border.h"
#include "render/layers.h"
#include "render/mesh.h"
#include "render/mip.h"
#include "render/rendition.h"
#include "render/shade.h"
#include "session/session.h"
#include "session/tally.h"

/* Finished labels that panels show. {0} is none yet. */
struct live_finish {
    uint8_t *label; /* [border.scene->grid.cells], or NULL */
    size_t cells;
    uint64_t of; /* session_finish_source; 0 while they are rough */
    struct border border;
    struct tally tally; /* of them, and what else is counted, once somebody has asked */
    struct label_measures measures;
};

/* The scene behind and around the objects, where the outlook has it so (render/mip.h). */
struct context {
    struct mip mip;
    struct rendition frame; /* borrows all maps of what is rendered but `rgba`, which is its own;
                               without maps where nothing is */
};

/* A quarter of the pixels, in one sample each, of a surface that is there: to be looked at until
 * there is time for the rendition. What shades it is the rendition's. */
struct coarse {
    struct rendition rendition;
    struct layers layers;
    uint64_t took_ns; /* the last rendition that was drawn from nothing; 0: none was */
};

/* Samples of so many pixels are stored, so that an edit is seen at once: 210 MB of them. */
enum { SAMPLES_STORED_MOST = 1 << 23 };

/* Where what a panel shows fits in it: what that border does, as it was then, in as many pixels. */
struct own_view {
    uint32_t zoom; /* 0: not known */
    uint32_t place[3];
    bool has_place; /* or the scene's middle is there */
    const struct border *border;
    uint32_t version, width, height, samples;
};

struct pictures {
    struct session *session;
    struct camera camera; /* of the view, `look.samples` times as large; see session_draw_fitting */
    struct rendition rendition; /* of camera.view's size; no maps where its samples are too many to
                                   be stored */
    struct context context;     /* what is behind it */
    struct layers layers;       /* the rendition's, where objects are translucent */
    struct mesh mesh;           /* of what was shown last */
    struct rendition reduced;   /* to the view's size, where look.samples is above 1 */
    unsigned rendered;          /* V1; enum rendered (draw.h) */
    struct coarse coarse;       /* in its place, while keys arrive */
    struct own_view own;        /* of panels */
    unsigned drawings;          /* how often pixels, or labels, may have become others */
    struct {                    /* when the command at hand began: */
        unsigned rendered;      /* not rough labels */
        unsigned drawings;
        struct camera camera;
        struct tally tally; /* of live labels; stale where nothing was counted */
    } former;
    struct tally tally_before_edit; /* the same, of the last command before it that edited */
    struct shader shader;
    struct live_finish live;
    uint8_t *decorated; /* colours of the frame with what is drawn over them (decorating.h) */
    size_t decorated_pixels;
    /* While a picture is drawn that is not stored: takes its rows (render/bands.h), without their
     * context, which is made before. Else NULL. */
    void (*take)(void *context, const struct rendition *rows, uint32_t top);
    void *take_context;
};

#endif
