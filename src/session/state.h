/* SPDX-License-Identifier: MIT */
/*
 * A state: everything in a session that a command can change, as a plain value.
 *
 *     kept      the segmentation: undo, redo and goto restore it
 *     outlook   the view: it is unchanged by undo, redo and goto
 *     lists     pending edits, valid markers, places of eliminators
 *
 * The planted seeds belong to the state too, but only their changes are stored: the edits that lead
 * from one state to another (session_go). Everything else in a session follows from its state.
 *
 * A state is copied by assignment and has about 44 kB. Data as large as the scene is shared,
 * immutable and counted. A copy borrows; state_assign makes an owner.
 */
#ifndef SESSION_STATE_H
#define SESSION_STATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/scan.h"
#include "base/watch.h"
#include "engine/finish.h"
#include "engine/weight.h"
#include "render/palette.h"
#include "render/cut.h"
#include "render/look.h"
#include "render/slice.h"
#include "render/view.h"

struct border;
struct edit;

/* ---- lists of edits ---- */

/*
 * Edits in order: a list that is a value.
 *
 * A copy costs no time and shares the memory; appending to one list changes no other, even if they
 * share. So every state of a session has its own list of pending edits, and all of them together
 * use the memory of one.
 *
 * Invariant: items before `end` of any list that holds the room are never written again.
 */
struct edit_room;

/* {0} is empty. */
struct edits {
    struct edit_room *room;
    size_t first, end; /* items of the room in the list */
};

/* Add or remove a holder of the memory. A released list is empty. */
void edits_hold(const struct edits *edits);
void edits_release(struct edits *edits);

/* Append to a list that is held. ERR_MEMORY: no change. */
enum err edits_add(struct edits *edits, struct edit edit, struct fault *fault);

/* The first of edits_count items; NULL for an empty list. */
const struct edit *edits_first(const struct edits *edits);

/*
 * Lists that grow for the whole session are read from their end. If another list has appended to
 * the shared memory, edits_add copies the list; edits_go_on continues in memory of its own without
 * a copy, so that an edit after an undo does not cost as much as all former edits.
 */

/* Append to such a list. All its items must be appended so, and edits_first does not apply to
 * it. */
enum err edits_go_on(struct edits *edits, struct edit edit, struct fault *fault);

/* Return its last items, *count of them, contiguous; *edits, not empty and borrowed, becomes the
 * list of the items before. */
const struct edit *edits_last(struct edits *edits, size_t *count);

static inline size_t edits_count(const struct edits *edits)
{
    return edits->end - edits->first;
}

/*
 * The lists of a state, held, released, compared and measured together.
 *
 *     pending      edits of seeds that wait for a run; a later one of a voxel wins
 *     markers      {number, 1} for a marker that is set, {number, EDIT_ERASE} for a removed
 *                  marker; the last item of a number decides if it is valid (session/markers.h)
 *     eliminators  their places, to be marked in slices: of the last run, then pending ones.
 *                  Their effects are among the pending edits
 */
struct edit_lists {
    struct edits pending, markers, eliminators;
    size_t applied; /* eliminators of the last run, at the beginning of the list */
};

void edit_lists_hold(const struct edit_lists *lists);
void edit_lists_release(struct edit_lists *lists);

/* True if each list is a copy of the other's; lists made separately differ unless both are
 * empty. */
bool edit_lists_are_copies(const struct edit_lists *a, const struct edit_lists *b);

/* Bytes of the lists, the memory of each divided among its holders. */
size_t edit_lists_memory(const struct edit_lists *lists);

/* ---- states ---- */

enum { LABEL_NAME_BYTES = 32, LABEL_CODE_BYTES = 104, FILE_WORDS_BYTES = 128 };
enum { LANDMARK_NAME_BYTES = 32, LANDMARKS = 64 };

/* A place of the patient that can be found in other scenes too. */
struct landmark {
    char name[LANDMARK_NAME_BYTES]; /* padded with zeros; "" for none */
    uint32_t place[3];              /* a voxel */
};

/* A further channel of the scene (engine/scene.h). The first channel is the scene's own. */
struct channel_values; /* counted; channel.c */
struct kept_channel {
    struct channel_values *values; /* NULL: none */
    uint32_t percent;              /* scales its weights */
    uint32_t slot; /* 1..CHANNELS_MOST: index of its window, for as long as the channel exists */
    char name[LABEL_NAME_BYTES]; /* "" for none */
};

/* No padding between members, here and below (tests/test_setting.c). */
struct kept {
    struct palette palette;
    char label_name[256][LABEL_NAME_BYTES]; /* "" for none; padded with zeros */
    char label_code[256][LABEL_CODE_BYTES]; /* "SCHEME:VALUE[:MEANING]"; likewise */
    uint32_t label_number[256]; /* number of each label; all 0: the label itself (session/map.h) */
    bool label_is_region[256];  /* the label is a region of a file */
    bool visible[256];
    uint8_t opacity[256]; /* opacity of labels in renditions, percent; 0 hides the label */
    char orient[8];       /* argument of `orient` for the scene (geometry_orient); "" for none */
    struct cut cut;       /* the part of the visible labels that is cut away */
    struct finish_list finish; /* steps applied to labels on output */
    unsigned adjacency;        /* 6 or 26 */
    struct weight_choice weight;
    int8_t polarity[256]; /* polarity of each label, in percent; used if the weight is `polarity` */

    struct packed *weight_map; /* uint16 [z][y][x]; NULL unless the weight is a file's */
    struct packed *mask;       /* bits (engine/roi.h); NULL for none */
    struct packed *rest; /* regions that the mask excludes (`labels rest=keep`): uint16 numbers in
                            files [z][y][x], 0 for none; or NULL */
    struct kept_channel channel[CHANNELS_MOST]; /* used ones first */
    uint32_t percent;                           /* scales the first channel's weights */
    uint32_t range_channel;                     /* channel of the range, 0 for the first */
    char weight_file[FILE_WORDS_BYTES];         /* names of both, cut if long; "" for none */
    char mask_file[FILE_WORDS_BYTES];
    uint32_t mask_regions[2];            /* first and last */
    struct landmark landmark[LANDMARKS]; /* in order of creation; unused ones last */
    char origin[FILE_WORDS_BYTES];       /* name of the procedure (`origin`); "" for none */
    uint32_t origin_mm3[256];            /* volume of each label in the procedure; 0 for none */
    uint64_t has_range;                  /* 0 or 1, as wide as the range: */
    struct decimal range[2];             /* real values, lowest and highest inside */
};

/* Display of slices and mosaics. */
struct slice_settings {
    uint32_t cross[3];   /* voxel of the cross-hair */
    uint32_t zoom;       /* zoom of slices, thousandths of a pixel per smallest spacing; 0: fit */
    uint32_t times;      /* size of slices and mosaics, thousandths of the fitting size; 1000 if
                       zoom is not 0 */
    uint32_t has_middle; /* 0 or 1: magnified pictures are centred at */
    uint32_t middle[3];  /* this voxel; otherwise at the cross-hair */
    uint32_t channel;    /* slot of the channel shown, 0 for the first (session_shown_channel); by
                         slot: */
    uint64_t window_of[CHANNELS_MOST + 1];       /* digest of the channel that has this window
                                              (session_shown_digest), which no other channel of
                                              the slot has; 0: it follows from the scene */
    struct decimal window[CHANNELS_MOST + 1][2]; /* real values, black and white */
    enum slice_overlay overlay;
    uint32_t crosses, marks, words; /* 0 or 1: the cross-hair; seeds and eliminators; letters
                                       and bars */
};

/* Behind and around the objects: nothing, or a maximum intensity projection of the scene. */
#define CONTEXTS "none|mip"
enum context_kind { CONTEXT_NONE, CONTEXT_MIP };

struct outlook {
    struct view view;
    struct look look;
    uint32_t decorations;    /* decorations of the rendition: bits of render/decoration.h */
    uint32_t background;     /* render/palette.h */
    uint32_t context;        /* enum context_kind */
    uint32_t runs_by_itself; /* 0 or 1: run after each edit */
    struct slice_settings slices;
    uint32_t shows_finished; /* 0 or 1: pictures show labels after kept.finish; must be the
                                last member (tests/test_setting.c) */
};

struct state {
    struct kept kept;
    struct outlook outlook;
    struct edit_lists lists;
};

/* True if renditions show the voxels of a label that are not cut away. */
static inline bool kept_shows(const struct kept *kept, int label)
{
    return kept->visible[label] && kept->opacity[label];
}

/* Set the labels and cuts of a border; the caller recounts it. */
void kept_show(const struct kept *kept, struct border *border);

/* Add or remove a holder of the shared data. */
void kept_hold(const struct kept *kept);
void kept_release(struct kept *kept);
void state_release(struct state *state);

/* Make *to an owning copy, releasing the former one. Cannot fail. */
void state_assign(struct state *to, const struct state *from);

struct channel_values *channel_values_hold(struct channel_values *values);
void channel_values_release(struct channel_values **values);
size_t channel_values_memory(const struct channel_values *values); /* divided among its holders */
unsigned kept_channels(const struct kept *kept);                   /* number of further channels */

/* Parts of a session that are recomputed when the members they depend on change. */
enum {
    MADE_WEIGHTS = 1,
    MADE_ROI = 2,
    MADE_FOREST = 4, /* depends on both, and on the seeds */
    MADE_BORDER = 8,
    MADE_CAMERA = 16,
    MADE_COLOURS = 32,
    MADE_CHANNELS = 1024, /* which intensities are in the cells; setting.c uses 64 to 512 */
};

/*
 * Packed bytes: an immutable value as large as a scene, deflated and shared by all its holders. For
 * large data that is rarely read: masks and weights out of files of every state.
 *
 * Reading allocates no memory, so that a state can be restored without any.
 */

struct packed;

/* Make a copy of `length` bytes with one holder. ERR_MEMORY; ERR_CANCELLED by the watch, or
 * NULL. */
enum err packed_new(struct packed **packed, const void *bytes, size_t length, struct watch *watch,
                    struct fault *fault);

/* Add or remove a holder; the last one frees it. Both accept NULL; a released pointer becomes
 * NULL. */
struct packed *packed_hold(struct packed *packed);
void packed_release(struct packed **packed);

/* Read the bytes in order, in pieces of PACKED_PIECE bytes (the last may be shorter), each
 * passed to `take` once. ERR_MEMORY if the inflater needs more memory than zlib is known to need;
 * ERR_CANCELLED by the watch, or NULL. */
enum { PACKED_PIECE = 16384 };
enum err packed_read(const struct packed *packed,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct watch *watch, struct fault *fault);

/* Copy all bytes to `out`. Errors as above. */
enum err packed_take_out(const struct packed *packed, void *out, struct watch *watch,
                         struct fault *fault);

/* Number of bytes in use; 0 for NULL. */
size_t packed_memory(const struct packed *packed);

#endif
