#include "session/state.h"

#include <string.h>

struct state state_default(void)
{
    struct state state = {
        .kept = {.cut = cut_none(), .adjacency = 6, .weight = {WEIGHT_MORPH, 1}},
        .outlook = {
            .look = look_default(),
            .slices = {.overlay = SLICE_CONTOUR, .crosses = true, .marks = true, .words = true}}};
    palette_default(&state.kept.palette);
    for (int label = 1; label < 256; label++)
        state.kept.visible[label] = true;
    return state;
}

/* ---- equality ---- */

static bool pair_equals(const int64_t a[2], const int64_t b[2])
{
    return a[0] == b[0] && a[1] == b[1];
}

static bool names_equal(const struct kept *a, const struct kept *b)
{
    for (int label = 0; label < 256; label++)
        if (strcmp(a->label_name[label], b->label_name[label]) != 0)
            return false;
    return strcmp(a->weight_file, b->weight_file) == 0 && strcmp(a->mask_file, b->mask_file) == 0;
}

static bool palette_equals(const struct palette *a, const struct palette *b)
{
    return memcmp(a->rgb, b->rgb, sizeof a->rgb) == 0;
}

static bool polarity_equals(const struct kept *a, const struct kept *b)
{
    return memcmp(a->polarity, b->polarity, sizeof a->polarity) == 0;
}

/* A cut has no padding (render/cut.h). */
static bool shows_the_same(const struct kept *a, const struct kept *b)
{
    return memcmp(a->visible, b->visible, sizeof a->visible) == 0 &&
           memcmp(&a->cut, &b->cut, sizeof a->cut) == 0;
}

/* Arcs weigh the same. */
static bool weighs_the_same(const struct kept *a, const struct kept *b)
{
    return a->adjacency == b->adjacency && weight_choice_equals(&a->weight, &b->weight) &&
           a->weight_map == b->weight_map &&
           (a->weight.kind != WEIGHT_POLARITY || polarity_equals(a, b));
}

static bool same_region_of_interest(const struct kept *a, const struct kept *b)
{
    return a->mask == b->mask && a->has_range == b->has_range &&
           pair_equals(a->range_thousandths, b->range_thousandths);
}

bool kept_equals(const struct kept *a, const struct kept *b)
{
    return palette_equals(&a->palette, &b->palette) && names_equal(a, b) && shows_the_same(a, b) &&
           weighs_the_same(a, b) && polarity_equals(a, b) && same_region_of_interest(a, b) &&
           a->mask_regions[0] == b->mask_regions[0] && a->mask_regions[1] == b->mask_regions[1];
}

static bool view_equals(const struct view *a, const struct view *b)
{
    return memcmp(a->angle, b->angle, sizeof a->angle) == 0 && a->zoom == b->zoom &&
           a->width == b->width && a->height == b->height &&
           memcmp(a->focus, b->focus, sizeof a->focus) == 0;
}

static bool look_equals(const struct look *a, const struct look *b)
{
    return a->mode == b->mode && a->light[0] == b->light[0] && a->light[1] == b->light[1] &&
           a->cue_percent == b->cue_percent && a->edges == b->edges && a->samples == b->samples;
}

static bool window_equals(const struct slice_settings *a, const struct slice_settings *b)
{
    return a->has_window == b->has_window &&
           pair_equals(a->window_thousandths, b->window_thousandths);
}

static bool slices_equal(const struct slice_settings *a, const struct slice_settings *b)
{
    return memcmp(a->cross, b->cross, sizeof a->cross) == 0 && a->zoom == b->zoom &&
           window_equals(a, b) && a->overlay == b->overlay && a->crosses == b->crosses &&
           a->marks == b->marks && a->words == b->words;
}

bool outlook_equals(const struct outlook *a, const struct outlook *b)
{
    return view_equals(&a->view, &b->view) && look_equals(&a->look, &b->look) &&
           slices_equal(&a->slices, &b->slices) && a->runs_by_itself == b->runs_by_itself;
}

/* Faces that are cut open show the scene, as slices do. */
static bool same_colours(const struct state *a, const struct state *b)
{
    return palette_equals(&a->kept.palette, &b->kept.palette) &&
           (cut_is_none(&b->kept.cut) || window_equals(&a->outlook.slices, &b->outlook.slices));
}

unsigned state_difference(const struct state *a, const struct state *b)
{
    const struct outlook *x = &a->outlook, *y = &b->outlook;
    const bool same_view = view_equals(&x->view, &y->view) && look_equals(&x->look, &y->look);
    return (weighs_the_same(&a->kept, &b->kept) ? 0u : MADE_WEIGHTS) |
           (same_region_of_interest(&a->kept, &b->kept) ? 0u : MADE_ROI) |
           (shows_the_same(&a->kept, &b->kept) ? 0u : MADE_BORDER) |
           (same_view ? 0u : MADE_CAMERA) | (same_colours(a, b) ? 0u : MADE_COLOURS);
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

void state_hold(const struct state *state)
{
    kept_hold(&state->kept);
    edits_hold(&state->pending);
    edits_hold(&state->eliminators);
}

void state_release(struct state *state)
{
    kept_release(&state->kept);
    edits_release(&state->pending);
    edits_release(&state->eliminators);
}

void state_assign(struct state *to, const struct state *from)
{
    struct state former = *to;
    state_hold(from);
    *to = *from;
    state_release(&former);
}
