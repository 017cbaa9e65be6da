/* SPDX-License-Identifier: MIT */
/*
 * The stored pictures of a session, for the files of this room. They make edits and other views
 * fast. draw.c creates them with the first picture; they follow the session until its scene is
 * closed (session/session.h).
 *
 * Invariants
 *   V1 the rendition, updated by the changes that wait, equals, pixel for pixel, one drawn from
 *      scratch of the labels of `rendered`, their border and the camera, in any mode;
 *   V2 if `live.of` is the session's finish source, the live labels equal those of session_labels;
 *   V3 the border of the live labels fits them, and the visibility and the cut of the last picture.
 */
#ifndef SHOW_PICTURES_H
#define SHOW_PICTURES_H

#include "engine/changes.h"
#include "engine/label_stats.h"
#include "render/border.h"
#include "render/layers.h"
#include "render/mesh.h"
#include "render/mip.h"
#include "render/rendition.h"
#include "render/shade.h"
#include "session/session.h"
#include "session/tally.h"

/* Finished labels in panels. {0}: none yet. */
struct live_finish {
    uint8_t *label; /* [border.scene->grid.cells], or NULL */
    size_t cells;
    uint64_t of; /* session_finish_source; 0 while they are rough */
    struct border border;
    struct tally tally; /* counted on the first query */
    struct label_measures measures;
};

/* The scene behind the objects, for outlooks with a context (render/mip.h). */
struct context {
    struct mip mip;
    struct rendition frame; /* borrows all maps of the rendition, but `rgba`; without maps if
                               nothing is drawn */
};

/* A rendition with a quarter of the pixels, in one sample each, of a surface that is up to date:
 * shown until there is time for the full one, whose shader it uses. */
struct coarse {
    struct rendition rendition;
    struct layers layers;
    uint64_t took_ns; /* time of the last rendition from scratch; 0: none was drawn */
    bool is_last;     /* it is the rendition that a panel showed last */
};

/* Store samples of at most this many pixels, so that edits are shown at once: 210 MB. */
enum { SAMPLES_STORED_MOST = 1 << 23 };

/* The view in which the objects of a panel fit: for this version of the border and this size. */
struct own_view {
    uint32_t zoom; /* 0: not known */
    uint32_t place[3];
    bool has_place; /* otherwise the middle of the scene */
    const struct border *border;
    uint32_t version, width, height, samples;
};

struct pictures {
    struct session *session;
    struct camera camera; /* the view, `look.samples` times as large; see session_draw_fitting */
    struct rendition rendition; /* has the size of camera.view; no maps if it has too many samples
                                   to be stored */
    struct context context;     /* behind it */
    struct layers layers;       /* for translucent objects */
    struct mesh mesh;           /* surface of the last picture */
    struct rendition reduced;   /* reduced to the view's size, if look.samples is above 1 */
    unsigned rendered;          /* V1; enum rendered (draw.h) */
    struct change_log waits;    /* changes of these labels since it was drawn; if the log does not
                                   follow, it is drawn from scratch when it is wanted */
    struct coarse coarse;       /* shown instead while keys arrive */
    struct own_view own;        /* view of panels */
    unsigned drawings;          /* increased when pixels or live labels may have changed */
    struct {                    /* at the beginning of the current command: */
        unsigned rendered;      /* never rough labels */
        unsigned drawings;
        struct change_log waits; /* its items are the first of the present one */
        struct camera camera;
        struct tally tally; /* live labels; stale if they were not counted */
    } former;
    struct tally tally_before_edit; /* the same for the last command before that edited */
    struct shader shader;
    struct live_finish live;
    uint8_t *decorated; /* the frame with its decorations (decorating.h) */
    size_t decorated_pixels;
    /* During the export of a picture that is not stored: gets its rows (render/bands.h), without
     * their context, which is drawn before. Otherwise NULL. */
    void (*take)(void *context, const struct rendition *rows, uint32_t top);
    void *take_context;
};

#endif
