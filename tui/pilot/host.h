/* SPDX-License-Identifier: MIT */
/*
 * What the pilot asks of its host, who knows the scene: facts of the present state, a picture as it
 * is wished, and that a line is carried out.
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
enum { PILOT_TIMES_ONE = 1000, PILOT_TIMES_MOST = 4096000 }; /* of pilot_facts.times */

/* Planes, and panes: they are shown as render/mosaic.h lays them out. */
enum pilot_pane { PILOT_AXIAL, PILOT_CORONAL, PILOT_SAGITTAL, PILOT_RENDITION, PILOT_PANES };

/* Whose labels the picture shows: the forest's, or finished ones, which are rough where an edit has
 * changed them since. */
enum pilot_labels { PILOT_FOREST, PILOT_ROUGH, PILOT_FINISHED };

/* What is known of a voxel, part by part; one that begins with a blank goes on with the one before.
 */
enum pilot_known {
    PILOT_HERE,   /* the label's number, */
    PILOT_NAME,   /* its name, */
    PILOT_VOLUME, /* how large it is, */
    PILOT_CHANGE, /* and how much of that is due to the last edit */
    PILOT_INTENSITY,
    PILOT_MM,
    PILOT_IN_FOREST, /* the forest's label, where what is shown is another */
    PILOT_SUMS,      /* mean, deviation and extent of the label */
    PILOT_KNOWN
};
enum { PILOT_KNOWN_BYTES = 80 };

/* What the host knows of the present state. */
struct pilot_facts {
    uint32_t size[3];     /* of the scene, in voxels */
    uint32_t place[3];    /* of the cross-hair: a voxel */
    uint32_t index[3];    /* its slice, by plane: */
    const char *plane[3]; /* what slices of that are called, "axial" or "z", */
    unsigned axis[3];     /* the axis that they are counted along, 0 for x, */
    bool counts_down[3];  /* and whether the next one that K leads to has a lower number */
    size_t waiting;       /* edits that wait for a run */
    char known[PILOT_KNOWN][PILOT_KNOWN_BYTES]; /* of the voxel there, in words; "" for nothing */
    double intensity;                           /* there, in real values */
    double window[2];                           /* black and white, in real values */
    uint32_t zoom;                              /* at which the rendition is shown, thousandths */
    bool fits_itself;                           /* has this in its middle, which nobody chose: */
    uint32_t middle[3];
    uint32_t frame_width; /* of the rendition, in pixels */
    uint32_t frame_height;
    unsigned overlay; /* of labels in slices: 0 none, 1 tint, 2 contour */
    bool has_object;  /* a voxel has a label above 0, or a seed waits to give it one */
    bool takes_all;   /* an object's are the only seeds so far */
    uint32_t times;   /* by which slices are magnified, thousandths */
    enum pilot_labels shows;
    bool has_finish; /* labels can be finished */
};

/* How a voxel came to its label: the path back to its seed. */
struct pilot_way {
    unsigned label, next; /* which it would have next; 0 where no other seed reaches it */
    uint32_t root[3];     /* the seed */
    bool has_edge;        /* the cost rises on the path, and at its strongest edge, */
    uint32_t edge[3];     /* into this voxel, for the last time */
};

struct pilot_setup;

/* How the picture is wanted. */
struct pilot_wish {
    uint32_t width, height;           /* pixels */
    uint32_t cell_width, cell_height; /* those of a character's cell */
    bool words;                       /* letters and titles in the slices can be read in pixels */
    bool marks_held;                  /* what `held` has found is marked */
    bool marks_way;                   /* the path that `why` has found is */
    bool heat;                        /* slices are coloured where labels are uncertain */
    uint64_t within_ns; /* not 0: a rendition that takes longer may be less than it is, and then
                           view->is_hasty says so */
    bool marks_pixel;   /* a pixel of the rendition, by column and row of its own, is marked */
    uint32_t pixel[2];
    const struct pilot_setup *setup; /* whose keys are named in the picture; NULL: the table's */
    const uint32_t (*corner)[3];     /* of a box or an outline: marked in the slices, */
    size_t corners;
    bool marks_corners;   /* each with a cross, */
    bool marks_outline;   /* and the line through them, with what it encloses in the colour of */
    unsigned label;       /* this label */
    enum pilot_pane pane; /* that is marked, */
    bool is_alone;        /* or has the whole screen */
};

/* Who looks on while a command is carried out, or something else that takes long. */
struct pilot_onlooker {
    void *context;
    bool (*stops)(void *context); /* asked as often: whether it is to end; NULL: it is not */
    bool (*wants)(void *context); /* asked often, at any moment of the work: whether to draw */
    void (*draw)(void *context);  /* when what stands so far can be drawn: by `picture`, as ever */
};

struct pilot_host {
    void *context;
    /* As of struct repl_host; completion and news are the line editor's. */
    enum err (*execute)(void *context, const char *line, struct buf *output, struct fault *fault);
    /* Carries out a seed or a cross-hair to be seen and no more; and takes all of those back, as
     * every other line does first. */
    enum err (*sketch)(void *context, const char *line, struct fault *fault);
    enum err (*drop)(void *context, struct fault *fault);
    bool (*finished)(void *context);

    /* Of a host that shows something step by step, else NULL: lines that stand below the picture,
     * PILOT_CAPTIONS of them, in place of what is known of the voxel. */
    void (*caption)(void *context, struct buf *lines);
    bool keeps_status; /* they stand above that */

    /* False where there is no scene. */
    bool (*facts)(void *context, struct pilot_facts *facts);
    /* The place that lies so many slices along each plane's count; as far as the scene goes. */
    void (*move)(void *context, const int64_t by[3], uint32_t place[3]);
    /* Draws; the pixels stay until the next call. */
    enum err (*picture)(void *context, const struct pilot_wish *wish, struct image_view *view,
                        struct fault *fault);
    /* The voxel in the middle of the slices of a pane, and the place of the cross-hair, once the
     * picture has gone on by so many eighths of it. False where it is shown to its end. */
    bool (*pan)(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                uint32_t place[3]);
    /* Of slices that may be wanted next, `number` by `number` from 0 on, the nearest first: a name,
     * which another slice, or the same shown otherwise, does not have; 0 where there is none. May
     * be NULL. And its greys below, with no more than width, height, hue, slice and below filled
     * in, which stay until the next call; false where there are none. */
    uint64_t (*name_ahead)(void *context, const struct pilot_wish *wish, unsigned number);
    bool (*ahead)(void *context, const struct pilot_wish *wish, unsigned number,
                  struct image_view *view);
    /* The voxel that the last picture shows at a pixel, and in which pane that is; false for none,
     * with the pane none the less. */
    bool (*voxel_at)(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                     enum pilot_pane *pane);
    /* The voxel under a pixel of the rendition, by its own columns and rows. */
    bool (*voxel_of_frame)(void *context, uint32_t column, uint32_t row, uint32_t place[3]);
    /* The rendition's own pixel that the last picture shows at one of its pixels, or the
     * nearest. */
    void (*frame_pixel)(void *context, uint32_t column, uint32_t row, uint32_t pixel[2]);
    /* Adds what a label is called: "2 cerebellum". */
    void (*label)(void *context, unsigned label, struct buf *out);
    /* Adds what an eliminator at a voxel would take away, a marker or the single tree: "marker 7: 3
     * trees, 123 voxels, label 2". False where there is nothing. */
    bool (*held)(void *context, const uint32_t place[3], bool tree, struct buf *out);
    /* Finds how a voxel came to its label, and adds it in words. False, with words, where there is
     * nothing to find. */
    bool (*why)(void *context, const uint32_t place[3], struct pilot_way *way, struct buf *out);
    /* How many places `hint N` knows; 0 where it would say why there are none. */
    unsigned (*hints)(void *context);
    /* The slice in which it is the `rank`th least certain, from 1 on, where the label ends: its
     * pane, a place in it, and in words how much is in doubt. False, with words, where there is
     * none of that rank. */
    bool (*doubt)(void *context, unsigned label, unsigned rank, enum pilot_pane *pane,
                  uint32_t place[3], struct buf *out);
    /* The outline of the label that is there in the slice of a pane through a place, from its last
     * corner back to its first, into an empty line; and in words what it is of: of a marker there,
     * else, with 0, of the label as it is shown. False, with words, for neither. */
    bool (*outline)(void *context, unsigned label, enum pilot_pane pane, const uint32_t place[3],
                    struct polyline *line, uint32_t *marker, struct buf *out);
    /* Where the label's seeds are, those of a command once: the one that is `by` further than that
     * at the cross-hair, round and round. False where it has none. */
    bool (*seed)(void *context, unsigned label, int64_t by, uint32_t place[3]);
    /* The voxel of the label that is nearest to the mean of all of them. False where it has
     * none. */
    bool (*centre)(void *context, unsigned label, uint32_t place[3]);
    bool (*is_hidden)(void *context, unsigned label);
    /* From now on, or with NULL no more, somebody looks on. */
    void (*look_on)(void *context, const struct pilot_onlooker *onlooker);
    /* Makes exact what the picture shows, while nobody waits for anything else: where facts say
     * PILOT_ROUGH. Adds to `news` what the user should know of the result. ERR_CANCELLED where the
     * onlooker stops it: nothing has changed then. */
    enum err (*finish)(void *context, const struct pilot_onlooker *onlooker, struct buf *news,
                       struct fault *fault);
    /* Within `draw`: the cross-hair is shown at a place, or with NULL where it is. */
    void (*peek)(void *context, const uint32_t place[3]);
};

#endif
