/* SPDX-License-Identifier: MIT */
/* Functions of keys that plant or remove: seeds, strokes, boxes and shells, with a brush. */
#include "tui/pilot/pilot_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/scan.h"

enum { RADIUS_MOST = 32 };
enum { LINE_MOST = 60000 }; /* bytes; the limit of a journal is 65535 */

/* ---- lines ---- */

/* Add the command of a seed, without its line feed. */
static void begin_seed(struct press *p, const uint32_t place[3], const struct pilot_brush *brush)
{
    buf_printf(p->line, "seed " PLACE, XYZ(place));
    pilot_add_label(p, brush);
    if (!brush->radius)
        return;
    buf_add_text(p->line, " radius=");
    pilot_add_radius(p->line, brush);
}

/* Add a seed of the brush; if the other end differs, a stroke to there. */
static void add_seed(struct press *p, const uint32_t place[3], const uint32_t *other_end)
{
    begin_seed(p, place, &p->state->brush);
    if (other_end)
        buf_printf(p->line, " to=" PLACE, XYZ(other_end));
    buf_add_char(p->line, '\n');
    p->state->is_silent = false;
}

/* ---- the brush ---- */

static void say_brush(struct press *p)
{
    const struct pilot_brush *brush = &p->state->brush;
    buf_add_text(p->message, "the brush: label ");
    p->host->label(p->host->context, brush->label, p->message);
    buf_add_text(p->message, ", radius ");
    pilot_add_radius(p->message, brush);
    if (brush->has_range) {
        buf_add_text(p->message, ", intensities ");
        interval_write(p->message, brush->range_channel, brush->range);
    }
    buf_add_text(p->message, pilot_is_exact(brush, p->facts) ? ", exact" : "");
    if (brush->limit) {
        buf_printf(p->message, ",%s ", pilot_limits[brush->limit]);
        p->host->label(p->host->context, brush->limit_label, p->message);
    }
}

/* Choose the label of the count, otherwise that under the cross-hair. Return false, with a message,
 * without any. */
static bool take_label(struct press *p, uint32_t *label)
{
    const uint32_t count = p->state->count;
    if (count && !pilot_has_label(p, count))
        return false;
    if (!count && !p->facts->has_label)
        buf_add_text(p->message, "this voxel has no label");
    else
        *label = count ? count : p->facts->label;
    return count || p->facts->has_label;
}

/* By 0: the label under the cross-hair. */
void pilot_choose_label(struct press *p)
{
    uint32_t *label = &p->state->brush.label;
    if (p->by && !p->state->count)
        p->host->next_label(p->host->context, *label, p->by, label);
    else if (!take_label(p, label))
        return;
    say_brush(p);
}

/* Let trees grow from seeds of the brush, or not, from now on. */
void pilot_change_growth(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    brush->growth = pilot_is_exact(brush, p->facts) ? BRUSH_GROWS : BRUSH_EXACT;
    say_brush(p);
    buf_add_text(p->message, brush->growth == BRUSH_GROWS ? ", grows" : "");
}

/* `by` is BRUSH_OVER or BRUSH_KEEP. The same label again ends it. */
void pilot_change_limit(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const enum brush_limit limit = (enum brush_limit)p->by;
    uint32_t label = 0;
    if (!take_label(p, &label))
        return;
    brush->limit = brush->limit == limit && brush->limit_label == label ? BRUSH_ALL : limit;
    brush->limit_label = label;
    say_brush(p);
}

void pilot_change_radius(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const uint32_t most = brush->in_mm ? 2 * RADIUS_MOST : RADIUS_MOST;
    brush->radius = pilot_shifted(brush->radius, p->by * pilot_times(p), most + 1);
    say_brush(p);
}

/* Switch between voxels and millimetres. */
void pilot_change_unit(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    brush->in_mm = !brush->in_mm;
    brush->radius = brush->in_mm ? 2 * brush->radius : brush->radius / 2;
    say_brush(p);
}

/* The range extends by the count to each side, else by a twentieth of the window, in whole numbers
 * if possible. */
void pilot_take_range(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const double here = p->facts->intensity;
    double width = fabs(p->facts->window[1] - p->facts->window[0]) / 20;
    width = p->state->count             ? p->state->count
            : width > 1 && width < 1e12 ? (double)(int64_t)width
                                        : width;
    brush->has_range = true;
    brush->range_channel = p->facts->channel;
    brush->range[0] = pilot_decimal(here - width);
    brush->range[1] = pilot_decimal(here + width);
    say_brush(p);
}

void pilot_begin_range(struct press *p)
{
    p->state->typed[0] = '\0';
    if (p->facts->channel)
        snprintf(p->state->typed, sizeof p->state->typed, "%u:", p->facts->channel + 1);
}

void pilot_type_range(struct press *p)
{
    char *typed = p->state->typed;
    const size_t length = strlen(typed);
    if (length < PILOT_RANGE_BYTES - 1) {
        typed[length] = (char)p->event->point;
        typed[length + 1] = '\0';
    }
}

void pilot_erase_typed(struct press *p)
{
    const size_t length = strlen(p->state->typed);
    p->state->typed[length ? length - 1 : 0] = '\0';
}

/* Without digits, except for those of the channel, remove the range. */
void pilot_end_range(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const char *at = p->state->typed, *prefix = strchr(at, ':');
    const bool is_none = !*at || (prefix && !prefix[1]);
    struct decimal range[2];
    unsigned channel = brush->range_channel;
    if (!is_none && !(interval_scan(&at, &channel, range) && *at == '\0')) {
        buf_printf(p->message,
                   "expected LOW..HIGH, as in 40..1200.5, not %s; the brush is unchanged",
                   p->state->typed);
        return;
    }
    brush->has_range = !is_none;
    brush->range_channel = channel;
    if (brush->has_range)
        memcpy(brush->range, range, sizeof range);
    say_brush(p);
}

/* ---- seeds ---- */

/* Give the brush a label, and report it if that is another one. */
static void set_label(struct press *p, uint32_t label)
{
    if (p->state->brush.label != label) {
        buf_add_text(p->message, "brush ");
        p->host->label(p->host->context, label, p->message);
        buf_add_text(p->message, "; ");
    }
    p->state->brush.label = label;
}

/* The brush gets the label of the digit, if it exists. */
static bool take_digit(struct press *p)
{
    const uint32_t digit = p->event->point - '0';
    const bool exists = pilot_has_label(p, digit);
    if (exists)
        set_label(p, digit);
    return exists;
}

/* With `by` 1: plant a seed of the label of the digit. */
void pilot_plant(struct press *p)
{
    struct pilot_state *state = p->state;
    uint32_t place[3];
    if (p->by && !take_digit(p))
        return;
    if (!pilot_may_plant(p, !state->stroke.is_set) || !pilot_take_voxel(p, place))
        return;
    add_seed(p, place, state->stroke.is_set ? state->stroke.place : NULL);
    state->stroke.is_set = false;
}

/* The radius is that of the brush, which gets the label. With `by` 1 it is the label of the digit,
 * else the next one. */
void pilot_plant_at_edge(struct press *p)
{
    struct pilot_state *state = p->state;
    if (!pilot_has_edge(p) || (p->by && !take_digit(p)))
        return;
    if (!p->by)
        set_label(p, state->way.next);
    if (!pilot_may_plant(p, true))
        return;
    pilot_jump(p, state->way.edge);
    add_seed(p, state->way.edge, NULL);
}

/* Plant the surface of the ball around the path's seed through the edge. */
void pilot_enclose_at_edge(struct press *p)
{
    const struct pilot_way *way = &p->state->way;
    if (!pilot_has_edge(p) || !pilot_may_plant(p, false))
        return;
    if (memcmp(way->root, way->edge, sizeof way->root) == 0 || way->label == way->next) {
        buf_add_text(p->message, "there is no shell between a voxel and itself");
        return;
    }
    pilot_jump(p, way->edge);
    buf_printf(p->line, "seed " PLACE " %u shell=yes around=%u through=" PLACE, XYZ(way->root),
               way->next, way->label, XYZ(way->edge));
    pilot_add_exact(p, &p->state->brush);
    buf_add_char(p->line, '\n');
    p->state->is_silent = false;
}

void pilot_show_held(struct press *p)
{
    uint32_t place[3];
    if (!pilot_take_voxel(p, place))
        return;
    if (p->host->held(p->host->context, place, p->by, p->message)) {
        p->state->mode = p->by ? PILOT_CONFIRMING_TREE : PILOT_CONFIRMING;
        pilot_say(p, p->by ? "; {eliminate-that-tree} removes it" : "; {eliminate-it} removes it");
    } else {
        buf_add_text(p->message, "no tree holds this voxel");
    }
}

/* ---- strokes ---- */

void pilot_go_to(struct press *p, const uint32_t place[3])
{
    struct pilot_pen *pen = &p->state->pen;
    if (!pilot_cross(p, place) || pilot_outline_to(p, place) || !pen->is_down ||
        !pilot_may_plant(p, false))
        return;
    pen->brush = p->state->brush;
    p->line->failed |= (pen->line.count == 0 && !polyline_add(&pen->line, p->facts->place)) ||
                       !polyline_add(&pen->line, place);
    add_seed(p, place, p->facts->place);
    p->state->sketches = p->state->is_silent = true;
}

/* A stroke too long for a line of the journal is split into connected parts. */
void pilot_add_stroke(struct press *p)
{
    const struct pilot_pen *pen = &p->state->pen;
    const uint32_t(*corner)[3] = (const uint32_t(*)[3])pen->line.corner;
    const char *end = "\n";
    struct buf *line = p->line;
    buf_printf(line, "cross " PLACE "\n", XYZ(p->facts->place));
    size_t begin = line->length;
    begin_seed(p, corner[0], &pen->brush);
    for (size_t i = 1; i < pen->line.count; i++) {
        if (line->length - begin > LINE_MOST) {
            buf_add_text(line, end);
            end = " joined=yes\n";
            begin = line->length;
            begin_seed(p, corner[i - 1], &pen->brush);
        }
        buf_printf(line, " to=" PLACE, XYZ(corner[i]));
    }
    buf_add_text(line, end);
    p->state->is_silent = false;
}

void pilot_lower_pen(struct press *p)
{
    if (!p->state->pen.is_down && !pilot_may_plant(p, false))
        return;
    p->state->pen.is_down = !p->state->pen.is_down;
    if (!p->state->pen.is_down) /* otherwise the row below the picture shows that the pen is down */
        buf_add_text(p->message, "the pen is up");
}

/* Set one end; the next seed is the other end. */
static void begin_stroke_at(struct press *p, const uint32_t place[3])
{
    memcpy(p->state->stroke.place, place, sizeof p->state->stroke.place);
    p->state->stroke.is_set = true;
    buf_add_text(p->message, "one end of a stroke; a seed at the other end draws it");
}

void pilot_begin_stroke(struct press *p)
{
    begin_stroke_at(p, p->facts->place);
}

void pilot_stroke_at_edge(struct press *p)
{
    if (!pilot_has_edge(p))
        return;
    p->state->brush.label = p->state->way.next;
    begin_stroke_at(p, p->state->way.edge);
    pilot_jump(p, p->state->way.edge);
}

void pilot_drop_stroke(struct press *p)
{
    struct pilot_state *state = p->state;
    state->drops = state->pen.line.count > 1;
    if (state->drops)
        buf_add_text(p->message, "the stroke is dropped, and the pen is up");
    else if (state->outline.count)
        buf_add_text(p->message, "the corners are dropped");
    state->pen.line.count = state->outline.count = 0;
    state->stroke.is_set = state->pen.is_down = false;
}

/* ---- corners, and boxes ---- */

void pilot_set_corner(struct press *p)
{
    const struct polyline *outline = &p->state->outline;
    if (!pilot_add_corner(p, p->facts->place))
        return;
    pilot_say(p,
              outline->count == 1   ? "%zu corner; {box} plants the box to the cross-hair, "
                                      "{enclose-in-box} its faces, {enclose} a ball's shell"
              : outline->count == 2 ? "%zu corners"
                                    : "%zu corners; {polygon} plants the outline",
              outline->count);
}

/* Return true if exactly one corner is set; otherwise say what to do. */
static bool has_one_corner(struct press *p, const char *what, const char *corner)
{
    const struct polyline *outline = &p->state->outline;
    if (outline->count == 1)
        return true;
    pilot_say(p, "%s needs one %s, and there are %zu; %s", what, corner, outline->count,
              outline->count ? "{drop} drops them" : "{corner} sets it");
    return false;
}

/* Plant the box from the corner to the cross-hair. */
void pilot_plant_box(struct press *p)
{
    struct polyline *outline = &p->state->outline;
    if (!has_one_corner(p, "a box", "corner") || !pilot_may_plant(p, false))
        return;
    buf_printf(p->line, "box " PLACE " " PLACE, XYZ(outline->corner[0]), XYZ(p->facts->place));
    pilot_add_label(p, &p->state->brush);
    buf_add_char(p->line, '\n');
    pilot_remember_shape(p);
}

/* Plant background around the label of the brush: with `by` 1 on the box from the corner to the
 * cross-hair, with 0 on the ball around the corner. */
void pilot_plant_shell(struct press *p)
{
    const struct polyline *outline = &p->state->outline;
    const unsigned inside = p->state->brush.label;
    if (!has_one_corner(p, p->by ? "a box" : "a ball", p->by ? "corner" : "middle") ||
        !pilot_may_plant(p, false))
        return;
    buf_printf(p->line, "%s " PLACE, p->by ? "box" : "seed", XYZ(outline->corner[0]));
    if (p->by)
        buf_printf(p->line, " " PLACE, XYZ(p->facts->place));
    buf_add_text(p->line, " 0 shell=yes");
    if (inside)
        buf_printf(p->line, " around=%u", inside);
    if (!p->by)
        buf_printf(p->line, " through=" PLACE, XYZ(p->facts->place));
    pilot_add_exact(p, &p->state->brush);
    buf_add_char(p->line, '\n');
    pilot_remember_shape(p);
}

bool pilot_move_shape(struct press *p)
{
    const struct pilot_shape *shape = &p->state->shape;
    struct polyline *outline = &p->state->outline;
    bool fits = true;
    outline->count = 0;
    for (size_t i = 0; fits && i < shape->outline.count; i++) {
        int64_t at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = (int64_t)shape->outline.corner[i][a] + p->facts->place[a] - shape->place[a];
            fits &= at[a] >= 0;
        }
        const uint32_t corner[3] = {(uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]};
        fits = fits && polyline_add(outline, corner);
    }
    if (fits)
        return true;
    outline->count = 0;
    buf_add_text(p->message, "here it would extend beyond the scene");
    return false;
}
