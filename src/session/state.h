/* SPDX-License-Identifier: MIT */
/*
 * A state: all of a session that a command can change, as a plain value.
 *
 *     kept      what belongs to the segmentation: undo, redo and goto lead back to it
 *     outlook   where one looks from: it stays when one goes through the history
 *     lists     edits that wait for a run, which markers stand, where eliminators were put
 *
 * The seeds that are planted belong to it too, but are known as a difference alone: the edits that
 * lead from one state to another (session_go). Everything else of a session follows from its state.
 *
 * A state is copied by assignment and costs some 11 kB; what is as large as the scene is shared,
 * immutable and counted. A copy borrows, until state_assign makes an owner of it.
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
 * A copy takes no time and shares the memory; adding to one list changes no other, even where they
 * share. So every state of a session has its own list of the edits that wait for a run, and all of
 * them together take the memory of one.
 *
 * Invariant: items before `end` of any list that holds the room are never written again.
 */
struct edit_room;

/* {0} is empty. */
struct edits {
    struct edit_room *room;
    size_t first, end; /* items of the room that are in the list */
};

/* One holder of the memory more, or fewer. A released list is empty. */
void edits_hold(const struct edits *edits);
void edits_release(struct edits *edits);

/* Adds to a list that is held. ERR_MEMORY leaves it as it was. */
enum err edits_add(struct edits *edits, struct edit edit, struct fault *fault);

/* The first of edits_count items; NULL where there are none. */
const struct edit *edits_first(const struct edits *edits);

/*
 * Lists that grow for as long as a session does are read from their end. Where others have added to
 * what they share, edits_add copies all of a list; these go on from there in memory of its own, and
 * copy nothing: else each edit after an undo would cost as much as all that were before.
 */

/* Adds to such a list, as edits_add; all its items come so, and edits_first is not for it. */
enum err edits_go_on(struct edits *edits, struct edit edit, struct fault *fault);

/* Its last items, *count of them, as they lie together; *edits, which has some and is borrowed,
 * becomes the list of those before. */
const struct edit *edits_last(struct edits *edits, size_t *count);

static inline size_t edits_count(const struct edits *edits)
{
    return edits->end - edits->first;
}

/*
 * The lists of a state, held, released, compared and measured together.
 *
 *     pending      edits of seeds that wait for a run; a later one of a voxel wins
 *     markers      {number, 1} for a marker that is put up, {number, EDIT_ERASE} for one that is
 *                  taken away; the last of a number decides whether it stands (session/markers.h)
 *     eliminators  where the user has put them, to be marked in slices: those of the last run, and
 *                  after them those that wait. What they do is among the pending edits
 */
struct edit_lists {
    struct edits pending, markers, eliminators;
    size_t applied; /* how many eliminators, from the first one on, were of the last run */
};

void edit_lists_hold(const struct edit_lists *lists);
void edit_lists_release(struct edit_lists *lists);

/* Whether each list is a copy of the other's; lists made apart differ unless both are empty. */
bool edit_lists_are_copies(const struct edit_lists *a, const struct edit_lists *b);

/* Bytes that they take, the memory of each divided among the lists that hold it. */
size_t edit_lists_memory(const struct edit_lists *lists);

/* ---- states ---- */

enum { LABEL_NAME_BYTES = 32, FILE_WORDS_BYTES = 128, LANDMARK_NAME_BYTES = 32, LANDMARKS = 64 };

/* A place of the patient that can be found in other scenes too; zeros after the end of its name. */
struct landmark {
    char name[LANDMARK_NAME_BYTES]; /* "" for none */
    uint32_t place[3];              /* a voxel */
};

/* Here and below, no bytes are between members (tests/test_setting.c). */
struct kept {
    struct palette palette;
    char label_name[256][LABEL_NAME_BYTES]; /* "" for none; zeros after the end */
    uint16_t label_number[256]; /* what each is in files, or 0: its label (session/map.h) */
    bool visible[256];
    uint8_t opacity[256]; /* of labels in renditions, percent; those of 0 are not shown there */
    char orient[8]; /* what `orient` has said of the scene (geometry_orient); "" for nothing */
    struct cut cut; /* what is cut away of what is visible */
    struct finish_list finish; /* what is done to labels that are handed out */
    unsigned adjacency;        /* 6 or 26 */
    struct weight_choice weight;
    int8_t polarity[256]; /* of each label, in percent; heeded while the weight is `polarity` */

    struct packed *weight_map;          /* uint16 [z][y][x]; NULL unless the weight is a file's */
    struct packed *mask;                /* bits (engine/roi.h); NULL for none */
    char weight_file[FILE_WORDS_BYTES]; /* what to call both; a long name is cut; "" for none */
    char mask_file[FILE_WORDS_BYTES];
    uint32_t mask_regions[2]; /* first and last */
    struct landmark
        landmark[LANDMARKS];       /* in the order in which they were put; those of none last */
    char origin[FILE_WORDS_BYTES]; /* the procedure that it was made by (`origin`); "": none */
    uint32_t origin_mm3[256];      /* and what volume each label had there; 0: it had none */
    uint64_t has_range;            /* 0 or 1, as wide as what it is about: */
    struct decimal range[2];       /* real values, lowest and highest inside */
};

/* How slices and mosaics are shown. */
struct slice_settings {
    uint32_t cross[3]; /* the voxel that they go through */
    uint32_t zoom;     /* of slices, thousandths of a pixel per smallest spacing; 0 for what fits */
    uint32_t times; /* of slices and mosaics, thousandths of what fits; 1000 where zoom is not 0 */
    uint32_t has_middle;      /* 0 or 1; and then, of what is magnified, in the middle: */
    uint32_t middle[3];       /* this voxel, else the cross-hair */
    uint32_t has_window;      /* 0 or 1, else these follow from the scene: */
    struct decimal window[2]; /* real values, black and white */
    enum slice_overlay overlay;
    uint32_t crosses, marks, words; /* 0 or 1: the cross-hair; seeds and eliminators; letters and
                                       bars */
};

/* Behind and around the objects: nothing, or a maximum intensity projection of the scene. */
#define CONTEXTS "none|mip"
enum context_kind { CONTEXT_NONE, CONTEXT_MIP };

struct outlook {
    struct view view;
    struct look look;
    uint32_t decorations;    /* of the rendition: bits of render/decoration.h */
    uint32_t background;     /* render/palette.h */
    uint32_t context;        /* enum context_kind */
    uint32_t runs_by_itself; /* 0 or 1: each edit is run at once */
    struct slice_settings slices;
    uint32_t shows_finished; /* 0 or 1: pictures show labels as kept.finish leaves them; it stays
                                the last member (tests/test_setting.c) */
};

struct state {
    struct kept kept;
    struct outlook outlook;
    struct edit_lists lists;
};

/* Whether renditions show the voxels of a label, where they are not cut away. */
static inline bool kept_shows(const struct kept *kept, int label)
{
    return kept->visible[label] && kept->opacity[label];
}

/* Has a border show what these settings do; a recount is up to the caller. */
void kept_show(const struct kept *kept, struct border *border);

/* Of what is shared: one holder more, or fewer. */
void kept_hold(const struct kept *kept);
void kept_release(struct kept *kept);
void state_release(struct state *state);

/* Makes *to a copy that owns, in place of one that did. Cannot fail. */
void state_assign(struct state *to, const struct state *from);

/* What of a session follows from a part of its state, and is made anew where that part differs. */
enum {
    MADE_WEIGHTS = 1,
    MADE_ROI = 2,
    MADE_FOREST = 4, /* follows from both, and from the seeds */
    MADE_BORDER = 8,
    MADE_CAMERA = 16,
    MADE_COLOURS = 32,
};

/*
 * Packed bytes: an immutable value as large as a scene, deflated and shared by all its holders.
 * For what is large and rarely read again: the masks and the weights out of files of every state.
 *
 * Reading takes no memory of its own, so that a state can be gone back to when there is none left.
 */

struct packed;

/* A copy of `length` bytes, held once. ERR_MEMORY; ERR_CANCELLED by the watch, or NULL. */
enum err packed_new(struct packed **packed, const void *bytes, size_t length, struct watch *watch,
                    struct fault *fault);

/* One holder more, or fewer: the last one frees it. Both take NULL. */
struct packed *packed_hold(struct packed *packed);
void packed_release(struct packed *packed);

/* Reads the bytes in order, a piece at a time, PACKED_PIECE bytes or at the end fewer, each handed
 * to `take` once. ERR_MEMORY where the inflater needs more room than zlib is known to need;
 * ERR_CANCELLED by the watch, or NULL. */
enum { PACKED_PIECE = 16384 };
enum err packed_read(const struct packed *packed,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct watch *watch, struct fault *fault);

/* Writes all the bytes, packed_length of them, to `out`. Errors as above. */
enum err packed_take_out(const struct packed *packed, void *out, struct watch *watch,
                         struct fault *fault);

/* How many bytes were packed, and how many they take now. */
size_t packed_length(const struct packed *packed);
size_t packed_memory(const struct packed *packed);

#endif
