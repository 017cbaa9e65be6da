/* SPDX-License-Identifier: MIT */
/*
 * Outlines: keys and the mouse draw one freehand, edit an existing one, drag it, and close it.
 *
 * An outline is a list of corners in one slice, set one by one with `a` or drawn with the pen; it
 * is closed from the last corner to the first. Dragging works on the voxels along the line, as it
 * was when it was grabbed. Voxels near the hold move along, the others less, the farther they are
 * along the line, in integers:
 *
 *     by w(s) = (R^2 - s^2)^2 / R^4 of the way, s voxels along the line, up to the reach R,
 *
 * which grows with the way, so that the result is a bulge and not a spike.
 */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tui/pilot/pilot_keys.h"

enum { HOLD_MOST = 8 }; /* voxels from the line to a place where it can be grabbed */
enum { CORNERS_LEAST = 3 };
/* Voxels along the line; products of coordinates and R^4 stay below 2^63. */
enum { REACH_LEAST = 6, REACH_MOST = 1024 };

/* ---- drawing ---- */

/* Return true if one slice contains all corners and the place. */
static bool is_flat(const struct polyline *outline, const uint32_t place[3])
{
    bool same[3] = {true, true, true};
    for (size_t i = 0; i < outline->count; i++)
        for (int a = 0; a < 3; a++)
            same[a] &= outline->corner[i][a] == place[a];
    return same[0] || same[1] || same[2];
}

static void say_too_many(struct press *p)
{
    buf_printf(p->message, "an outline has %d corners at most", PILOT_CORNERS_MOST);
}

bool pilot_add_corner(struct press *p, const uint32_t place[3])
{
    struct polyline *outline = &p->state->outline;
    const unsigned across = p->facts->axis[p->state->pane];
    const bool leaves_plane = p->state->mode == PILOT_OUTLINING && outline->count > 0 &&
                              outline->corner[0][across] != place[across];
    if (leaves_plane || (outline->count >= 2 && !is_flat(outline, place))) {
        pilot_say(p, "this is in another slice than the corners so far; {drop} drops them");
        return false;
    }
    if (outline->count >= PILOT_CORNERS_MOST && p->state->mode == PILOT_OUTLINING)
        polyline_simplify(outline);
    if (outline->count >= PILOT_CORNERS_MOST || !polyline_add(outline, place)) {
        say_too_many(p);
        return false;
    }
    return true;
}

void pilot_end_outline(struct pilot_state *state)
{
    state->outline.count = state->hold.line.count = 0;
    state->hold.is_set = state->is_bent = false;
    state->instead = 0;
    state->mode = state->base = pilot_home(state);
}

void pilot_drop_outline(struct press *p)
{
    struct pilot_state *state = p->state;
    const size_t corners = state->outline.count;
    if (state->hold.is_set) {
        const struct polyline bent = state->outline;
        state->outline = state->hold.line;
        state->hold.line = bent;
        state->hold.is_set = false;
        buf_add_text(p->message, "the outline is unchanged");
        return;
    }
    pilot_end_outline(state);
    buf_add_text(p->message, corners ? "the outline is dropped" : "the pen is up");
}

/* ---- closing ---- */

void pilot_remember_shape(struct press *p)
{
    struct pilot_shape *shape = &p->state->shape;
    const struct polyline former = shape->outline;
    shape->outline = p->state->outline;
    memcpy(shape->place, p->facts->place, sizeof shape->place);
    p->state->outline = former;
    p->state->outline.count = 0;
}

void pilot_close_outline(struct press *p)
{
    struct pilot_state *state = p->state;
    struct polyline *outline = &state->outline;
    const bool is_drawn = state->base == PILOT_OUTLINING;
    if (is_drawn && outline->count == 0) {
        pilot_drop_outline(p);
        return;
    }
    if (is_drawn)
        polyline_simplify(outline);
    if (outline->count > PILOT_CORNERS_MOST) {
        say_too_many(p);
        return;
    }
    if (outline->count < CORNERS_LEAST) {
        pilot_say(p, "an outline needs %d corners or more, and there %s %zu; %s", CORNERS_LEAST,
                  outline->count == 1 ? "is" : "are", outline->count,
                  is_drawn ? "{drop-outline} drops it" : "{corner} sets one");
        return;
    }
    if (!pilot_may_plant(p, false))
        return;
    buf_printf(p->line, "%s " PLACE, state->brush.label ? "outline" : "fill",
               XYZ(outline->corner[0]));
    pilot_add_label(p, &state->brush);
    for (size_t i = 1; i < outline->count; i++)
        buf_printf(p->line, " to=" PLACE, XYZ(outline->corner[i]));
    if (state->instead)
        buf_printf(p->line, " instead=%u", state->instead);
    buf_add_char(p->line, '\n');
    pilot_remember_shape(p);
    state->change = (struct pilot_change){setup_row(state->setup, "polygon"), *p->event, 0};
    pilot_end_outline(state);
    state->doubt = 0; /* the ranking has changed */
}

void pilot_begin_outline(struct press *p)
{
    struct pilot_state *state = p->state;
    if (state->base == PILOT_OUTLINING) {
        pilot_close_outline(p);
        return;
    }
    if (state->base == PILOT_SHAPING)
        pilot_end_outline(state);
    state->mode = state->base = PILOT_OUTLINING;
    state->pen.is_down = state->stroke.is_set = false;
}

/* ---- dragging ---- */

/* a + by * part / parts, rounded half up; within 0 .. end - 1. */
static uint32_t moved(uint32_t a, int64_t by, int64_t part, int64_t parts, uint32_t end)
{
    const int64_t twice = 2 * (a * parts + by * part) + parts;
    const int64_t to = twice < 0 ? 0 : twice / (2 * parts);
    return to < (int64_t)end ? (uint32_t)to : end - 1;
}

static int64_t farthest(const int64_t by[3])
{
    int64_t most = 0;
    for (int a = 0; a < 3; a++)
        most = llabs(by[a]) > most ? llabs(by[a]) : most;
    return most;
}

static void way_to(int64_t by[3], const uint32_t from[3], const uint32_t to[3])
{
    for (int a = 0; a < 3; a++)
        by[a] = (int64_t)to[a] - from[a];
}

/* List the voxels of a closed line, each as a corner. */
static bool ring_make(struct polyline *ring, const struct polyline *line)
{
    for (size_t i = 0; i < line->count; i++) {
        const uint32_t *from = line->corner[i], *to = line->corner[(i + 1) % line->count];
        int64_t by[3];
        way_to(by, from, to);
        const int64_t steps = farthest(by);
        if (!mem_grow(&ring->corner, &ring->capacity, ring->count + (size_t)steps,
                      sizeof *ring->corner))
            return false;
        for (int64_t step = 0; step < steps; step++, ring->count++)
            for (int a = 0; a < 3; a++)
                ring->corner[ring->count][a] = moved(from[a], by[a], step, steps, UINT32_MAX);
    }
    return true;
}

/* Return the index of the line's voxel nearest to a place; `count` if none is within HOLD_MOST. */
static size_t nearest_of(const struct polyline *ring, const uint32_t place[3])
{
    int64_t least = HOLD_MOST * HOLD_MOST + 1;
    size_t nearest = ring->count;
    for (size_t i = 0; i < ring->count; i++) {
        int64_t by[3];
        way_to(by, place, ring->corner[i]);
        if (farthest(by) > HOLD_MOST)
            continue;
        const int64_t far = by[0] * by[0] + by[1] * by[1] + by[2] * by[2];
        if (far < least) {
            least = far;
            nearest = i;
        }
    }
    return nearest;
}

static bool grab_at(struct press *p, const uint32_t place[3])
{
    struct pilot_state *state = p->state;
    struct pilot_hold *hold = &state->hold;
    OWNED(polyline_release) struct polyline ring = {0};
    hold->line.count = 0;
    hold->is_set = is_flat(&state->outline, place) && ring_make(&ring, &state->outline) &&
                   nearest_of(&ring, place) < ring.count;
    for (size_t i = 0; hold->is_set && i < state->outline.count; i++)
        hold->is_set = polyline_add(&hold->line, state->outline.corner[i]);
    memcpy(hold->place, place, sizeof hold->place);
    if (!hold->is_set)
        buf_printf(p->message, "the outline is more than %d voxels from here", HOLD_MOST);
    return hold->is_set;
}

/* Grab the line, or release it. */
void pilot_grab(struct press *p)
{
    if (p->state->hold.is_set)
        p->state->hold.is_set = false;
    else
        grab_at(p, p->facts->place);
}

/* Set the line to the grabbed one, bent so that the grabbed voxel is at the place. */
static bool bend_outline(struct polyline *out, const struct pilot_hold *hold,
                         const uint32_t place[3], const uint32_t size[3])
{
    OWNED(polyline_release) struct polyline ring = {0};
    int64_t by[3];
    bool fits = ring_make(&ring, &hold->line);
    const int64_t count = (int64_t)ring.count, at = (int64_t)nearest_of(&ring, hold->place);
    way_to(by, hold->place, place);
    int64_t reach = REACH_LEAST + 2 * farthest(by);
    reach = reach > count / 3 ? count / 3 : reach;
    reach = reach > REACH_MOST ? REACH_MOST : reach < 1 ? 1 : reach;
    out->count = 0;
    for (int64_t i = 0; fits && i < count; i++) {
        const int64_t one_way = llabs(i - at);
        const int64_t along = one_way < count - one_way ? one_way : count - one_way;
        const int64_t left = along < reach ? reach * reach - along * along : 0;
        uint32_t to[3];
        for (int a = 0; a < 3; a++)
            to[a] = moved(ring.corner[i][a], by[a], left * left, reach * reach * reach * reach,
                          size[a]);
        fits = polyline_add(out, to);
    }
    polyline_simplify(out);
    return fits;
}

bool pilot_outline_to(struct press *p, const uint32_t place[3])
{
    struct pilot_state *state = p->state;
    /* The first corner is where the pen was put down. */
    if (state->base == PILOT_OUTLINING &&
        (state->outline.count > 0 || pilot_add_corner(p, p->facts->place)))
        pilot_add_corner(p, place);
    if (state->base != PILOT_SHAPING || !state->hold.is_set)
        return state->base == PILOT_OUTLINING || state->base == PILOT_SHAPING;
    if (!is_flat(&state->hold.line, place))
        buf_add_text(p->message, "this is in another slice than the outline");
    else if (!bend_outline(&state->outline, &state->hold, place, p->facts->size))
        p->line->failed = true;
    state->is_bent = true;
    return true;
}

/* ---- existing outlines ---- */

/* Load the outline in the slice of the pane at a place, for editing. */
static void load_outline(struct press *p, const uint32_t place[3])
{
    struct pilot_state *state = p->state;
    pilot_end_outline(state);
    if (!p->host->outline(p->host->context, state->brush.label, state->pane, place, &state->outline,
                          &state->instead, p->message)) {
        pilot_end_outline(state);
        pilot_say(p, "; {outline} draws an outline");
        return;
    }
    state->pen.is_down = false;
    state->mode = state->base = PILOT_SHAPING;
}

/* Return true, with a message, if an edited outline is not planted yet. */
static bool is_unfinished(struct press *p)
{
    if (p->state->is_bent)
        pilot_say(p, "{close-outline} plants the outline first, {drop-outline} drops it");
    return p->state->is_bent;
}

void pilot_load_outline(struct press *p)
{
    if (!is_unfinished(p))
        load_outline(p, p->facts->place);
}

/* Ranks are visited cyclically. */
void pilot_go_to_doubt(struct press *p)
{
    struct pilot_state *state = p->state;
    const unsigned label = state->brush.label, count = state->count;
    OWNED(buf_release) struct buf words = {0};
    uint32_t place[3];
    if (is_unfinished(p))
        return;
    unsigned rank = count              ? count
                    : p->by > 0        ? state->doubt + 1
                    : state->doubt > 1 ? state->doubt - 1
                                       : 1;
    bool found = p->host->doubt(p->host->context, label, rank, &state->pane, place, &words);
    if (!found && rank > 1) {
        buf_clear(&words);
        rank = 1;
        found = p->host->doubt(p->host->context, label, rank, &state->pane, place, &words);
    }
    buf_add_text(p->message, buf_text(&words));
    p->message->failed |= words.failed;
    if (!found)
        return;
    state->doubt = rank;
    buf_add_text(p->message, "; ");
    pilot_jump(p, place);
    load_outline(p, place);
}

/* ---- the mouse ---- */

/* A click adds a corner; dragging draws, and releasing the button closes the outline. */
void pilot_outline_click(struct press *p, const uint32_t place[3], enum pilot_pane pane)
{
    struct pilot_state *state = p->state;
    const enum mouse_action action = p->event->mouse.action;
    if (action == MOUSE_PRESSED) {
        state->pane = pane;
        state->dragged = 0;
        state->drags =
            state->base == PILOT_OUTLINING ? pilot_add_corner(p, place) : grab_at(p, place);
        pilot_cross(p, place);
    } else if (action == MOUSE_MOVED && state->drags && pane == state->pane) {
        if (pilot_cross(p, place))
            pilot_outline_to(p, place);
        state->dragged += p->line->length > 0;
    } else if (action == MOUSE_RELEASED && state->drags) {
        state->drags = state->hold.is_set = false;
        if (state->base == PILOT_OUTLINING && state->dragged >= CORNERS_LEAST) {
            pilot_close_outline(p);
            state->mode = state->base = PILOT_OUTLINING; /* the pen stays down */
            state->change =
                (struct pilot_change){setup_row(state->setup, "close-outline"), *p->event, 0};
        }
    }
}
