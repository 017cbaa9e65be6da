/* SPDX-License-Identifier: MIT */
/*
 * Functions that the pilot calls in its host, which knows the scene: read facts of the present
 * state, draw a picture, carry out a line.
 */
#ifndef TUI_PILOT_HOST_H
#define TUI_PILOT_HOST_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/polyline.h"
#include "tui/picture/image_view.h"

enum { PILOT_CAPTIONS = 3 };
enum { PILOT_TIMES_ONE = 1000, PILOT_TIMES_MOST = 4096000 }; /* for pilot_facts.times */

/* Planes, and panes, which render/mosaic.h lays out. */
enum pilot_pane { PILOT_AXIAL, PILOT_CORONAL, PILOT_SAGITTAL, PILOT_RENDITION, PILOT_PANES };

/* Labels in the picture: those of the forest, or finished ones, which are rough near voxels that an
 * edit has changed. */
enum pilot_labels { PILOT_FOREST, PILOT_ROUGH, PILOT_FINISHED };

/* Facts of a voxel, in parts; a part that begins with a blank continues the one before. */
enum pilot_known {
    PILOT_HERE,   /* the label's number, */
    PILOT_NAME,   /* its name, */
    PILOT_VOLUME, /* its volume, */
    PILOT_CHANGE, /* and how much the last edit has changed it */
    PILOT_INTENSITY,
    PILOT_MM,
    PILOT_IN_FOREST, /* the forest's label, if the label shown differs */
    PILOT_SUMS,      /* mean, deviation and extent of the label */
    PILOT_KNOWN
};
enum { PILOT_KNOWN_BYTES = 80 };

/* Facts of the present state. */
struct pilot_facts {
    uint32_t size[3];     /* size of the scene, in voxels */
    uint32_t place[3];    /* voxel of the cross-hair */
    const char *plane[3]; /* name of slices, by plane, "axial" or "z", */
    unsigned axis[3];     /* the axis that they are counted along, 0 for x, */
    bool counts_down[3];  /* and whether the next slice (key K) has a lower number */
    size_t waiting;       /* edits that will take effect at the next run */
    char known[PILOT_KNOWN][PILOT_KNOWN_BYTES]; /* facts of the voxel, in words; "" if unknown */
    double intensity;                           /* intensity of the voxel, as a real value */
    unsigned channel;                           /* its channel, from 0: the one that is shown */
    double window[2];                           /* black and white, in real values */
    uint32_t zoom;                              /* zoom of the rendition, in thousandths */
    uint32_t default_zoom; /* with this zoom and the scene in the centre the view fits by itself */
    bool is_fitted;        /* the view was fitted automatically, around this voxel: */
    uint32_t middle[3];
    uint32_t frame_width; /* size of the rendition, in pixels */
    uint32_t frame_height;
    unsigned overlay;    /* labels in slices: 0 none, 1 tint, 2 contour */
    bool has_object;     /* a voxel has a label above 0, or a seed waits to give it one */
    bool has_one_object; /* only the seeds of one object exist so far */
    bool wants_outline;  /* the first seeds of one object and of the background exist */
    bool has_pieces;     /* there are pieces of a segmentation */
    bool is_grown;       /* objects were grown from seeds, and nothing exact was planted so far */
    bool has_label;      /* the voxel has a label, */
    uint32_t label;      /* shown there */
    uint32_t times;      /* magnification of slices, in thousandths */
    enum pilot_labels shows;
    bool has_finish; /* labels can be finished */
};

/* The path from a voxel back to the seed of its label. */
struct pilot_way {
    uint32_t label, next; /* numbers of it, and of the label it would have otherwise, or 0 */
    uint32_t root[3];     /* the seed */
    bool has_edge; /* the cost rises along the path, last to its maximum at the strongest edge, */
    uint32_t edge[3]; /* which leads into this voxel */
};

enum { PILOT_LABELS = 256, PILOT_NAME_BYTES = 32, PILOT_CODE_BYTES = 104 };

/* A label, in a list. */
struct pilot_label {
    uint32_t number;
    char name[PILOT_NAME_BYTES], volume[PILOT_NAME_BYTES]; /* in words; "" for none */
    char code[PILOT_CODE_BYTES];                           /* "SCT:10200004"; likewise */
    uint8_t rgb[3];
    bool is_hidden;
};

struct pilot_setup;
struct pilot_onlooker;

/* The wanted picture. */
struct pilot_wish {
    uint32_t width, height;           /* pixels */
    uint32_t cell_width, cell_height; /* size of a character's cell, in pixels */
    bool words;                       /* letters and titles in the slices are readable in pixels */
    bool marks_held;                  /* mark the result of `held` */
    bool marks_way;                   /* mark the path that `why` has found */
    bool heat;                        /* colour slices where labels are uncertain */
    /* Not 0: time limit of a full rendition. If it would take longer, a coarser one is drawn and
     * view->is_hasty set. */
    uint64_t within_ns;
    const struct pilot_onlooker *onlooker; /* NULL, or what stops a full one: ERR_CANCELLED */
    bool marks_pixel; /* mark a pixel of the rendition, by its own column and row */
    uint32_t pixel[2];
    const struct pilot_setup *setup; /* its keys are named; NULL: the table's */
    const uint32_t (*corner)[3]; /* corners of a box or an outline, to be marked in the slices, */
    size_t corners;
    bool marks_corners;   /* each with a cross, */
    bool marks_outline;   /* and the line through them, with its area in the colour of */
    uint32_t label;       /* this label */
    enum pilot_pane pane; /* the pane to mark, */
    bool is_alone;        /* or to show on the whole screen */
};

/* Callbacks during a command, or other long work. */
struct pilot_onlooker {
    void *context;
    bool (*stops)(void *context); /* called as often: true stops it; or NULL */
    bool (*wants)(void *context); /* called often: true requests a drawing */
    /* called when the present state can be drawn: by `picture`, as usual */
    void (*draw)(void *context);
};

struct pilot_host {
    void *context;
    /* As in struct repl_host; completion and news are those of the line editor. */
    enum err (*execute)(void *context, const char *line, struct buf *output, struct fault *fault);
    /* Preview a seed or a cross-hair without recording it; and undo all previews, as every other
     * line does first. `sketch` may be NULL for a pilot that only watches. */
    enum err (*sketch)(void *context, const char *line, struct fault *fault);
    enum err (*drop)(void *context, struct fault *fault);
    bool (*finished)(void *context);

    /* For a host that shows something step by step, else NULL: add PILOT_CAPTIONS lines below the
     * picture, in place of the facts of the voxel. */
    void (*caption)(void *context, struct buf *lines);
    bool keeps_status; /* the captions are above those facts, not in place of them */

    /* Return false without a scene. */
    bool (*facts)(void *context, struct pilot_facts *facts);
    /* Set the place `by` slices further, counted in each plane, within the scene. */
    void (*move)(void *context, const int64_t by[3], uint32_t place[3]);
    /* Draw the picture; its pixels are valid until the next call. */
    enum err (*picture)(void *context, const struct pilot_wish *wish, struct image_view *view,
                        struct fault *fault);
    /* Find the voxel in the middle of the slices of a pane, and the place of the cross-hair, after
     * the picture has moved by eighths of its size. Return false at the end of the scene. */
    bool (*pan)(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                uint32_t place[3]);
    /* Slices that may be wanted next, by `number` from 0, the nearest first. name_ahead returns a
     * name, which is unique for the slice as it is shown now; 0 for none. May be NULL. `ahead`
     * draws the greys of one, with only width, height, hue, slice and below set, valid until the
     * next call; false for none. */
    uint64_t (*name_ahead)(void *context, const struct pilot_wish *wish, unsigned number);
    bool (*ahead)(void *context, const struct pilot_wish *wish, unsigned number,
                  struct image_view *view);
    /* Find the voxel that the last picture shows at a pixel, and its pane. Return false if there is
     * no voxel; the pane is set anyway. */
    bool (*voxel_at)(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                     enum pilot_pane *pane);
    /* Find the voxel under a pixel of the rendition, by the rendition's columns and rows. */
    bool (*voxel_of_frame)(void *context, uint32_t column, uint32_t row, uint32_t place[3]);
    /* Convert a pixel of the last picture to the nearest pixel of the rendition. */
    void (*frame_pixel)(void *context, uint32_t column, uint32_t row, uint32_t pixel[2]);
    /* Labels are named by their numbers. Add the number and the name of one: "2 cerebellum". */
    void (*label)(void *context, uint32_t label, struct buf *out);
    /* List the labels that have voxels or a name, by number; return their count. */
    unsigned (*labels)(void *context, struct pilot_label label[PILOT_LABELS]);
    /* Find the label `by` places after one by number, cyclically; by 0: that label. Return false if
     * it does not exist: *next is then the label at the cross-hair, or the first one. */
    bool (*next_label)(void *context, uint32_t label, int by, uint32_t *next);
    /* Add the effect of an eliminator at a voxel, on a marker or a single tree: "marker 7: 3 trees,
     * 123 voxels, label 2". Return false without an effect. */
    bool (*held)(void *context, const uint32_t place[3], bool tree, struct buf *out);
    /* Find the path of a voxel to its seed, and add it in words. Return false, with words, without
     * a path. */
    bool (*why)(void *context, const uint32_t place[3], struct pilot_way *way, struct buf *out);
    /* Return the number of places of `hint N`; 0 if the command would report an error. */
    unsigned (*hints)(void *context);
    /* Find the slice where the border of the label is `rank`th least certain, from 1 on: its pane,
     * a place in it, and in words the uncertain amount. Return false, with words, beyond the last
     * rank. */
    bool (*doubt)(void *context, uint32_t label, unsigned rank, enum pilot_pane *pane,
                  uint32_t place[3], struct buf *out);
    /* Find the outline of the label in the slice of a pane through a place: add it, closed from its
     * last corner to its first, to an empty line, and in words its source: a marker, or, with 0,
     * the label as shown. Return false, with words, without either. */
    bool (*outline)(void *context, uint32_t label, enum pilot_pane pane, const uint32_t place[3],
                    struct polyline *line, uint32_t *marker, struct buf *out);
    /* Find a seed of the label, one per command: `by` places after the one at the cross-hair,
     * cyclically. Return false without seeds. */
    bool (*seed)(void *context, uint32_t label, int64_t by, uint32_t place[3]);
    /* Find the voxel of the label nearest to the mean of all its voxels. Return false if it has
     * none. */
    bool (*centre)(void *context, uint32_t label, uint32_t place[3]);
    bool (*is_hidden)(void *context, uint32_t label);
    /* Set the callbacks, or with NULL remove them. */
    void (*look_on)(void *context, const struct pilot_onlooker *onlooker);
    /* Make the shown labels exact in idle time, if facts report PILOT_ROUGH. Add messages for the
     * user to `news`. ERR_CANCELLED, with nothing changed, if the onlooker stops it. */
    enum err (*finish)(void *context, const struct pilot_onlooker *onlooker, struct buf *news,
                       struct fault *fault);
    /* During `draw`: show the cross-hair at a place, or with NULL at its own place. */
    void (*preview_cross)(void *context, const uint32_t place[3]);
};

#endif
