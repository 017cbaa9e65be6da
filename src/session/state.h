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

#include "base/decimal.h"
#include "session/packed.h"
#include "engine/finish.h"
#include "engine/weight.h"
#include "render/background.h"
#include "render/border.h"
#include "render/look.h"
#include "render/palette.h"
#include "render/slice.h"
#include "render/view.h"
#include "session/edits.h"

enum { LABEL_NAME_BYTES = 32, FILE_WORDS_BYTES = 128 };

/* Here and below, no bytes are between members (tests/test_setting.c). */
struct kept {
    struct palette palette;
    char label_name[256][LABEL_NAME_BYTES]; /* "" for none; zeros after the end */
    uint16_t label_number[256]; /* what each is in files, or 0: its label (session/numbering.h) */
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
    uint64_t has_range;       /* 0 or 1, as wide as what it is about: */
    struct decimal range[2];  /* real values, lowest and highest inside */
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
    uint32_t decorations; /* of the rendition: bits of render/decoration.h */
    uint32_t background;  /* render/background.h */
    uint32_t context;     /* enum context_kind */
    struct slice_settings slices;
    uint32_t runs_by_itself; /* 0 or 1: "auto", each edit is run at once */
    uint32_t shows_finished; /* 0 or 1: pictures show labels as kept.finish leaves them */
};

struct state {
    struct kept kept;
    struct outlook outlook;
    struct edit_lists lists;
};

/* As a session of this semantics begins. */
struct state state_default(unsigned semantics);

/* Whether renditions show the voxels of a label, where they are not cut away. */
static inline bool kept_shows(const struct kept *kept, int label)
{
    return kept->visible[label] && kept->opacity[label];
}

/* Has a border show what these settings do; a recount is up to the caller. */
void kept_show(const struct kept *kept, struct border *border);

/* Two are the same where every member is: each is a setting (session/setting.h), or a row of
 * state.c. Maps are, where they are one and the same. */
bool kept_equals(const struct kept *a, const struct kept *b);
bool outlook_equals(const struct outlook *a, const struct outlook *b);

/* Bytes of both that these look at: all of them, for neither has any between its members. */
size_t state_bytes_compared(void);

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
unsigned state_difference(const struct state *a, const struct state *b);

#endif
