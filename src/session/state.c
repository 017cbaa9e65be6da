#include "session/state.h"

#include <string.h>

#include "session/semantics.h"

struct state state_default(unsigned semantics)
{
    const uint32_t look = LOOK_FIRST + (uint32_t)semantics_has(semantics, MEANING_LOOK) +
                          (uint32_t)semantics_has(semantics, MEANING_PATCHES) +
                          (uint32_t)semantics_has(semantics, MEANING_SMOOTH_LAYERS);
    struct state state = {.kept = {.cut = cut_none(), .adjacency = 6, .weight = {WEIGHT_MORPH, 1}},
                          .outlook = {.look = look_default(look),
                                      .background = background_default(look),
                                      .slices = {.times = SLICE_TIMES_ONE,
                                                 .overlay = SLICE_CONTOUR,
                                                 .crosses = true,
                                                 .marks = true,
                                                 .words = true}}};
    palette_default(&state.kept.palette, look);
    for (int label = 1; label < 256; label++)
        state.kept.visible[label] = true;
    memset(state.kept.opacity, BORDER_OPAQUE, sizeof state.kept.opacity);
    return state;
}

void kept_show(const struct kept *kept, struct border *border)
{
    for (int label = 0; label < 256; label++)
        border->visible[label] = kept_shows(kept, label);
    memcpy(border->opacity, kept->opacity, sizeof border->opacity);
    border->cut = kept->cut;
}

/* ---- equality ---- */

/* Three that only matter while something else is so, and what is true of every field. */
enum { MADE_BY_POLARITY = 64, MADE_BY_WINDOW = 128, MADE_BY_OPACITY = 256, DIFFERS = 512 };

/* A field, which has no padding within, and what follows from it. */
struct state_field {
    size_t at, bytes;
    unsigned made;
};
#define FIELD(owner, member, made)                                                                 \
    {                                                                                              \
        offsetof(struct owner, member), sizeof(((struct owner *)0)->member), made                  \
    }

static const struct state_field kept_field[] = {
    FIELD(kept, palette, MADE_COLOURS),
    FIELD(kept, label_name, 0),
    FIELD(kept, label_number, 0),
    FIELD(kept, visible, MADE_BORDER),
    FIELD(kept, opacity, MADE_BY_OPACITY),
    FIELD(kept, orient, MADE_CAMERA),
    FIELD(kept, cut, MADE_BORDER),
    FIELD(kept, adjacency, MADE_WEIGHTS),
    FIELD(kept, weight, MADE_WEIGHTS),
    FIELD(kept, polarity, MADE_BY_POLARITY),
    FIELD(kept, weight_map, MADE_WEIGHTS),
    FIELD(kept, mask, MADE_ROI),
    FIELD(kept, weight_file, 0),
    FIELD(kept, mask_file, 0),
    FIELD(kept, mask_regions, 0),
    FIELD(kept, has_range, MADE_ROI),
    FIELD(kept, range, MADE_ROI),
    FIELD(kept, finish, 0),
};

static const struct state_field outlook_field[] = {
    FIELD(outlook, view, MADE_CAMERA),
    FIELD(outlook, look, MADE_CAMERA),
    FIELD(outlook, background, 0),
    FIELD(outlook, decorations, 0),
    FIELD(outlook, context, MADE_COLOURS),
    FIELD(outlook, slices.cross, 0),
    FIELD(outlook, slices.zoom, 0),
    FIELD(outlook, slices.times, 0),
    FIELD(outlook, slices.has_middle, 0),
    FIELD(outlook, slices.middle, 0),
    FIELD(outlook, slices.has_window, MADE_BY_WINDOW),
    FIELD(outlook, slices.window, MADE_BY_WINDOW),
    FIELD(outlook, slices.overlay, 0),
    FIELD(outlook, slices.crosses, 0),
    FIELD(outlook, slices.marks, 0),
    FIELD(outlook, slices.words, 0),
    FIELD(outlook, runs_by_itself, 0),
    FIELD(outlook, shows_finished, MADE_COLOURS),
};

_Static_assert(sizeof(struct weight_choice) == 2 * sizeof(uint32_t), "no padding");
_Static_assert(sizeof(struct finish_list) == (1 + 4 * FINISH_STEPS_MOST) * sizeof(uint32_t),
               "no padding");
_Static_assert(sizeof(struct look) == 9 * sizeof(uint32_t), "no padding");
_Static_assert(sizeof(struct view) == 6 * sizeof(uint32_t) + 3 * sizeof(int64_t), "no padding");
_Static_assert(sizeof(struct cut) == 8 * sizeof(uint32_t) +
                                         CUT_PLANES_MOST * sizeof(struct cut_plane) +
                                         CUT_BOXES_MOST * sizeof(struct cut_box),
               "no padding");

/* DIFFERS and what follows from the fields that do, or 0. */
static unsigned compare(const struct state_field *field, size_t fields, const void *a,
                        const void *b)
{
    const char *x = a, *y = b;
    unsigned made = 0;
    for (const struct state_field *f = field; f < field + fields; f++)
        if (memcmp(x + f->at, y + f->at, f->bytes) != 0)
            made |= DIFFERS | f->made;
    return made;
}

static unsigned compare_kept(const struct kept *a, const struct kept *b)
{
    return compare(kept_field, sizeof kept_field / sizeof *kept_field, a, b);
}

static unsigned compare_outlooks(const struct outlook *a, const struct outlook *b)
{
    return compare(outlook_field, sizeof outlook_field / sizeof *outlook_field, a, b);
}

bool kept_equals(const struct kept *a, const struct kept *b)
{
    return compare_kept(a, b) == 0;
}

bool outlook_equals(const struct outlook *a, const struct outlook *b)
{
    return compare_outlooks(a, b) == 0;
}

/* Whether a label is shown in renditions of one, and not in those of the other. */
static bool hides_others(const uint8_t a[256], const uint8_t b[256])
{
    for (int label = 0; label < 256; label++)
        if (!a[label] != !b[label])
            return true;
    return false;
}

/* Polarities are heeded by one weight alone; the window of slices colours what is cut open,
 * and the context. */
unsigned state_difference(const struct state *a, const struct state *b)
{
    unsigned made = compare_kept(&a->kept, &b->kept) | compare_outlooks(&a->outlook, &b->outlook);
    if (made & MADE_BY_POLARITY && b->kept.weight.kind == WEIGHT_POLARITY)
        made |= MADE_WEIGHTS;
    if (made & MADE_BY_WINDOW && (!cut_is_none(&b->kept.cut) || b->outlook.context))
        made |= MADE_COLOURS;
    if (made & MADE_BY_OPACITY)
        made |= hides_others(a->kept.opacity, b->kept.opacity) ? MADE_BORDER : MADE_COLOURS;
    return made & ~(unsigned)(MADE_BY_POLARITY | MADE_BY_WINDOW | MADE_BY_OPACITY | DIFFERS);
}

/* ---- ownership ---- */

void kept_hold(const struct kept *kept)
{
    packed_hold(kept->weight_map);
    packed_hold(kept->mask);
}

void kept_release(struct kept *kept)
{
    packed_release(kept->weight_map);
    packed_release(kept->mask);
    kept->weight_map = kept->mask = NULL;
}

void state_release(struct state *state)
{
    kept_release(&state->kept);
    edit_lists_release(&state->lists);
}

void state_assign(struct state *to, const struct state *from)
{
    struct state former = *to;
    kept_hold(&from->kept);
    edit_lists_hold(&from->lists);
    *to = *from;
    state_release(&former);
}
