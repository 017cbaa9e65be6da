/* What keys do: each function writes the line of a command, or changes the pilot's own state. */
#include "tui/pilot/pilot_press.h"

#include <stdio.h>
#include <string.h>

#include "base/scan.h"

enum {
    JUMP = 10, /* voxels */
    PIXEL_JUMP = 16,
    RADIUS_MOST = 32,
    LABELS = 256,
    TURN = 15, /* degrees */
    TURNS_MOST = 24,
    ZOOM_LEAST = 10,
    ZOOM_MOST = 64000,
    CORNERS_MOST = 1000,
    LINE_MOST = 60000 /* bytes; a journal takes 65535 */
};

/* The count typed before the key. */
static int64_t times(const struct press *p)
{
    return p->state->count ? p->state->count : 1;
}

/* `at` moved by so many, and no further than 0 .. end - 1. */
static uint32_t shifted(uint32_t at, int64_t by, uint32_t end)
{
    const int64_t to = (int64_t)at + by;
    return to < 0 ? 0 : to >= (int64_t)end ? end - 1 : (uint32_t)to;
}

static int right_of(int way)
{
    return (way % PILOT_WAYS == PILOT_RIGHT) - (way % PILOT_WAYS == PILOT_LEFT);
}

static int up_of(int way)
{
    return (way % PILOT_WAYS == PILOT_UP) - (way % PILOT_WAYS == PILOT_DOWN);
}

static void add_own_key(struct press *p, const char *name)
{
    setup_add_first_key(p->message, p->state->setup, name);
}

/* ---- lines ---- */

void pilot_add_place(struct buf *line, const char *before, const uint32_t place[3])
{
    buf_printf(line, "%s%u,%u,%u", before, place[0], place[1], place[2]);
}

/* "2.5mm" */
static void add_radius(struct buf *out, const struct pilot_brush *brush)
{
    pilot_add_decimal(out, brush->in_mm ? brush->radius / 2.0 : brush->radius);
    buf_add_text(out, brush->in_mm ? "mm" : "");
}

/* "80..120" */
static void add_range(struct buf *out, const struct pilot_brush *brush)
{
    decimal_write(out, &brush->range[0]);
    buf_add_text(out, "..");
    decimal_write(out, &brush->range[1]);
}

/* " 2 range=80..120" */
static void add_label(struct buf *line, const struct pilot_brush *brush)
{
    buf_printf(line, " %u", brush->label);
    if (!brush->has_range)
        return;
    buf_add_text(line, " range=");
    add_range(line, brush);
}

void pilot_begin_seed(struct buf *line, const uint32_t place[3], const struct pilot_brush *brush)
{
    pilot_add_place(line, "seed ", place);
    add_label(line, brush);
    if (!brush->radius)
        return;
    buf_add_text(line, " radius=");
    add_radius(line, brush);
}

static void add_seed(struct pilot_state *state, const uint32_t place[3], const uint32_t *other_end,
                     struct buf *line)
{
    pilot_begin_seed(line, place, &state->brush);
    if (other_end)
        pilot_add_place(line, " to=", other_end);
    buf_add_char(line, '\n');
    state->is_silent = false;
}

/* Parts of a stroke that is too long for a line of the journal are joined. */
void pilot_add_stroke(struct pilot_state *state, const struct pilot_facts *facts, struct buf *line)
{
    const struct pilot_pen *pen = &state->pen;
    const uint32_t(*corner)[3] = (const uint32_t(*)[3])pen->line.corner;
    const char *end = "\n";
    pilot_add_place(line, "cross ", facts->place);
    buf_add_text(line, end);
    size_t begin = line->length;
    pilot_begin_seed(line, corner[0], &pen->brush);
    for (size_t i = 1; i < pen->line.count; i++) {
        if (line->length - begin > LINE_MOST) {
            buf_add_text(line, end);
            end = " joined=yes\n";
            begin = line->length;
            pilot_begin_seed(line, corner[i - 1], &pen->brush);
        }
        pilot_add_place(line, " to=", corner[i]);
    }
    buf_add_text(line, end);
    state->is_silent = false;
}

bool pilot_cross(struct pilot_state *state, const struct pilot_facts *facts,
                 const uint32_t place[3], struct buf *line)
{
    if (memcmp(place, facts->place, sizeof facts->place) == 0)
        return false;
    pilot_add_place(line, "cross ", place);
    buf_add_char(line, '\n');
    state->is_silent = true;
    return true;
}

void pilot_go_to(struct pilot_state *state, const struct pilot_facts *facts,
                 const uint32_t place[3], struct buf *line)
{
    struct pilot_pen *pen = &state->pen;
    if (!pilot_cross(state, facts, place, line) || !pen->is_down)
        return;
    pen->brush = state->brush;
    line->failed |= (pen->line.count == 0 && !polyline_add(&pen->line, facts->place)) ||
                    !polyline_add(&pen->line, place);
    add_seed(state, place, facts->place, line);
    state->sketches = state->is_silent = true;
}

static double magnitude(double value)
{
    return value < 0 ? -value : value;
}

/* To a thousandth, or of smaller and of huge values to so many digits. */
static struct decimal decimal_for(double value)
{
    const bool is_huge = magnitude(value) >= 1e12;
    if (magnitude(value) < 1 || is_huge)
        return decimal_near(value, is_huge ? 17 : 6);
    return decimal_of((int64_t)(value * 1000 + (value < 0 ? -0.5 : 0.5)), 3);
}

void pilot_add_decimal(struct buf *line, double value)
{
    const struct decimal decimal = decimal_for(value);
    decimal_write(line, &decimal);
}

void pilot_zoom(uint32_t now, bool nearer, struct buf *line)
{
    uint32_t next = nearer ? now + now / 4 + 1 : now - now / 5;
    next = next < ZOOM_LEAST ? ZOOM_LEAST : next > ZOOM_MOST ? ZOOM_MOST : next;
    buf_add_text(line, "zoom ");
    pilot_add_decimal(line, next / 1000.0);
    buf_add_char(line, '\n');
}

/* ---- moving ---- */

/* Which plane's slices are counted along the screen in a pane, and which way: to the right, and
 * up. The patient's left is on the right, his front in sagittal slices on the left; slices are
 * counted towards his head, his front and his right. */
static const struct {
    enum pilot_pane across, along;
} screen_of[3] = {
    [PILOT_AXIAL] = {PILOT_SAGITTAL, PILOT_CORONAL},
    [PILOT_CORONAL] = {PILOT_SAGITTAL, PILOT_AXIAL},
    [PILOT_SAGITTAL] = {PILOT_CORONAL, PILOT_AXIAL},
};

static void move_cross(struct press *p, int64_t right, int64_t up)
{
    const enum pilot_pane pane = p->state->pane;
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    by[screen_of[pane].across] = -right;
    by[screen_of[pane].along] = up;
    p->host->move(p->host->context, by, place);
    pilot_go_to(p->state, p->facts, place, p->line);
}

static void move_pixel(struct press *p, int64_t right, int64_t up)
{
    uint32_t *pixel = p->state->pixel;
    pixel[0] = shifted(pixel[0], right, p->facts->frame_width);
    pixel[1] = shifted(pixel[1], -up, p->facts->frame_height);
}

/* To the right wider, up brighter. */
static void change_window(struct press *p, int right, int up, int far)
{
    const double *window = p->facts->window, width = window[1] - window[0];
    const double step = width != 0 ? width / 50 : 0.001;
    buf_add_text(p->line, "window ");
    pilot_add_decimal(p->line, window[0] - step * (right + up) * far);
    buf_add_char(p->line, ' ');
    pilot_add_decimal(p->line, window[1] + step * (right - up) * far);
    buf_add_char(p->line, '\n');
    p->state->is_silent = true;
}

void pilot_move(struct press *p)
{
    const int right = right_of(p->by), up = up_of(p->by);
    const bool far = p->by >= PILOT_FAR;
    if (p->state->mode == PILOT_WINDOWING)
        change_window(p, right, up, far ? JUMP : 1);
    else if (p->state->mode == PILOT_PICKING)
        move_pixel(p, right * (far ? PIXEL_JUMP : 1), up * (far ? PIXEL_JUMP : 1));
    else
        move_cross(p, right * times(p) * (far ? JUMP : 1), up * times(p) * (far ? JUMP : 1));
}

/* By so many slices; a jump draws nothing, whereas J and K do with the pen down. */
static void move_through(struct press *p, int64_t slices, bool is_jump)
{
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    by[p->state->pane] = slices;
    p->host->move(p->host->context, by, place);
    if (is_jump)
        pilot_cross(p->state, p->facts, place, p->line);
    else
        pilot_go_to(p->state, p->facts, place, p->line);
}

void pilot_change_slice(struct press *p)
{
    if (p->state->mode == PILOT_PICKING)
        move_pixel(p, 0, p->by * PIXEL_JUMP);
    else
        move_through(p, p->by * times(p), false);
}

/* ---- jumps: they draw nothing, and can be taken back ---- */

void pilot_jump(struct press *p, const uint32_t place[3])
{
    if (!pilot_cross(p->state, p->facts, place, p->line))
        return;
    p->state->former.is_set = true;
    memcpy(p->state->former.place, p->facts->place, sizeof p->facts->place);
}

void pilot_to_slice(struct press *p)
{
    const int64_t here = p->facts->index[p->state->pane], count = p->state->count;
    const int64_t by = count ? count - here : p->by < 0 ? -here : INT32_MAX;
    p->state->former.is_set = true;
    memcpy(p->state->former.place, p->facts->place, sizeof p->facts->place);
    move_through(p, p->facts->counts_down[p->state->pane] ? -by : by, true);
}

void pilot_next_pane(struct press *p)
{
    const unsigned step = p->by < 0 ? PILOT_RENDITION - 1 : 1;
    p->state->pane = (enum pilot_pane)((p->state->pane + step) % PILOT_RENDITION);
}

void pilot_set_mark(struct press *p)
{
    struct pilot_mark *mark = &p->state->mark[p->event->point - 'a'];
    mark->is_set = true;
    memcpy(mark->place, p->facts->place, sizeof mark->place);
    setup_add_key_to(p->message, p->state->setup, "go-to-mark", (char)p->event->point);
    buf_add_text(p->message, " leads back here");
}

/* The mark of the letter that was pressed; NULL, with a message, where it is not set. */
static const struct pilot_mark *mark_pressed(struct press *p)
{
    const char letter = (char)p->event->point;
    const struct pilot_mark *mark = &p->state->mark[letter - 'a'];
    if (mark->is_set)
        return mark;
    buf_printf(p->message, "there is no mark %c; ", letter);
    setup_add_key_to(p->message, p->state->setup, "mark", letter);
    buf_add_text(p->message, " sets it");
    return NULL;
}

void pilot_go_to_mark(struct press *p)
{
    const struct pilot_mark *mark = mark_pressed(p);
    if (mark)
        pilot_jump(p, mark->place);
}

void pilot_measure(struct press *p)
{
    const struct pilot_mark *mark = mark_pressed(p);
    if (!mark)
        return;
    pilot_add_place(p->line, "measure ", mark->place);
    pilot_add_place(p->line, " ", p->facts->place);
    buf_add_char(p->line, '\n');
}

void pilot_go_back(struct press *p)
{
    const struct pilot_mark former = p->state->former;
    if (former.is_set)
        pilot_jump(p, former.place);
    else
        buf_add_text(p->message, "there was no jump to go back from");
}

static void say_no_label(struct press *p, const char *has)
{
    buf_add_text(p->message, "label ");
    p->host->label(p->host->context, p->state->brush.label, p->message);
    buf_add_text(p->message, has);
}

void pilot_next_seed(struct press *p)
{
    uint32_t place[3];
    if (p->host->seed(p->host->context, p->state->brush.label, p->by * times(p), place))
        pilot_jump(p, place);
    else
        say_no_label(p, " has no seed");
}

void pilot_go_to_centre(struct press *p)
{
    uint32_t place[3];
    if (p->host->centre(p->host->context, p->state->brush.label, place))
        pilot_jump(p, place);
    else
        say_no_label(p, " has no voxel");
}

/* ---- seeds ---- */

bool pilot_take_voxel(struct press *p, uint32_t place[3])
{
    const uint32_t *pixel = p->state->pixel;
    memcpy(place, p->facts->place, sizeof p->facts->place);
    if (p->state->mode != PILOT_PICKING)
        return true;
    if (!p->host->voxel_of_frame(p->host->context, pixel[0], pixel[1], place)) {
        buf_add_text(p->message, "no object is seen at that pixel");
        return false;
    }
    pilot_cross(p->state, p->facts, place, p->line);
    return true;
}

void pilot_plant(struct press *p)
{
    struct pilot_state *state = p->state;
    uint32_t place[3];
    if (!pilot_take_voxel(p, place))
        return;
    add_seed(state, place, state->stroke.is_set ? state->stroke.place : NULL, p->line);
    state->stroke.is_set = false;
}

void pilot_plant_label(struct press *p)
{
    p->state->brush.label = p->event->point - '0';
    pilot_plant(p);
}

void pilot_add_brush(struct buf *out, const struct pilot_brush *brush)
{
    if (brush->radius) {
        buf_add_text(out, " r");
        add_radius(out, brush);
    }
    if (brush->has_range) {
        buf_add_char(out, ' ');
        add_range(out, brush);
    }
}

static void say_brush(struct press *p)
{
    const struct pilot_brush *brush = &p->state->brush;
    buf_add_text(p->message, "the brush: label ");
    p->host->label(p->host->context, brush->label, p->message);
    buf_add_text(p->message, ", radius ");
    add_radius(p->message, brush);
    if (!brush->has_range)
        return;
    buf_add_text(p->message, ", intensities ");
    add_range(p->message, brush);
}

void pilot_choose_label(struct press *p)
{
    const uint32_t count = p->state->count;
    if (count >= LABELS) {
        buf_printf(p->message, "labels are 0 to %d, not %u", LABELS - 1, count);
        return;
    }
    p->state->brush.label =
        count ? count : (p->state->brush.label + (p->by < 0 ? LABELS - 1 : 1)) % LABELS;
    say_brush(p);
}

void pilot_change_radius(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const uint32_t most = brush->in_mm ? 2 * RADIUS_MOST : RADIUS_MOST;
    brush->radius = shifted(brush->radius, p->by * times(p), most + 1);
    say_brush(p);
}

/* From so many voxels to so many millimetres, and back. */
void pilot_change_unit(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    brush->in_mm = !brush->in_mm;
    brush->radius = brush->in_mm ? 2 * brush->radius : brush->radius / 2;
    say_brush(p);
}

/* ---- the brush within intensities ---- */

/* As wide on each side as the count says, or a twentieth of the window, in whole numbers if so. */
void pilot_take_range(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const double here = p->facts->intensity;
    double width = magnitude(p->facts->window[1] - p->facts->window[0]) / 20;
    width = p->state->count             ? p->state->count
            : width > 1 && width < 1e12 ? (double)(int64_t)width
                                        : width;
    brush->has_range = true;
    brush->range[0] = decimal_for(here - width);
    brush->range[1] = decimal_for(here + width);
    say_brush(p);
}

void pilot_begin_range(struct press *p)
{
    p->state->typed[0] = '\0';
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

bool pilot_scan_range(const char **at, struct decimal range[2])
{
    return decimal_scan(at, &range[0]) && scan_text(at, "..") && decimal_scan(at, &range[1]) &&
           decimal_value(&range[0]) <= decimal_value(&range[1]);
}

/* Nothing typed takes the range away. */
void pilot_end_range(struct press *p)
{
    struct pilot_brush *brush = &p->state->brush;
    const char *at = p->state->typed;
    struct decimal range[2];
    if (*at && !(pilot_scan_range(&at, range) && *at == '\0')) {
        buf_printf(p->message,
                   "expected LOW..HIGH, as in 40..1200.5, not %s; the brush is as it "
                   "was",
                   p->state->typed);
        return;
    }
    brush->has_range = p->state->typed[0] != '\0';
    if (brush->has_range)
        memcpy(brush->range, range, sizeof range);
    say_brush(p);
}

/* ---- boxes and polygons ---- */

/* Whether a slice of some plane goes through all corners and the place. */
static bool is_flat(const struct polyline *outline, const uint32_t place[3])
{
    bool same[3] = {true, true, true};
    for (size_t i = 0; i < outline->count; i++)
        for (int a = 0; a < 3; a++)
            same[a] &= outline->corner[i][a] == place[a];
    return same[0] || same[1] || same[2];
}

void pilot_set_corner(struct press *p)
{
    struct polyline *outline = &p->state->outline;
    if (outline->count >= 2 && !is_flat(outline, p->facts->place)) {
        buf_add_text(p->message, "this lies in another slice than the corners so far; ");
        add_own_key(p, "drop");
        buf_add_text(p->message, " drops them");
        return;
    }
    if (outline->count >= CORNERS_MOST || !polyline_add(outline, p->facts->place)) {
        buf_printf(p->message, "a polygon has %d corners at most", CORNERS_MOST);
        return;
    }
    buf_printf(p->message, "%zu corner%s", outline->count, outline->count == 1 ? "" : "s");
    if (outline->count == 2)
        return;
    buf_add_text(p->message, "; ");
    if (outline->count > 1) {
        add_own_key(p, "polygon");
        buf_add_text(p->message, " plants the polygon");
        return;
    }
    add_own_key(p, "box");
    buf_add_text(p->message, " plants the box to the cross-hair, ");
    add_own_key(p, "enclose-in-box");
    buf_add_text(p->message, " its faces, ");
    add_own_key(p, "enclose");
    buf_add_text(p->message, " a ball's shell");
}

/* The corners are set no more, but remembered for `.`. */
static void keep_shape(struct press *p)
{
    struct pilot_shape *shape = &p->state->shape;
    const struct polyline former = shape->outline;
    shape->outline = p->state->outline;
    memcpy(shape->place, p->facts->place, sizeof shape->place);
    p->state->outline = former;
    p->state->outline.count = 0;
}

/* Whether one corner is set; says what to do where not. */
static bool has_one_corner(struct press *p, const char *what, const char *corner)
{
    const struct polyline *outline = &p->state->outline;
    if (outline->count == 1)
        return true;
    buf_printf(p->message, "%s takes one %s, and there are %zu; ", what, corner, outline->count);
    add_own_key(p, outline->count ? "drop" : "corner");
    buf_add_text(p->message, outline->count ? " drops them" : " sets it");
    return false;
}

/* From the corner to the cross-hair. */
void pilot_plant_box(struct press *p)
{
    struct polyline *outline = &p->state->outline;
    if (!has_one_corner(p, "a box", "corner"))
        return;
    pilot_add_place(p->line, "box ", outline->corner[0]);
    pilot_add_place(p->line, " ", p->facts->place);
    add_label(p->line, &p->state->brush);
    buf_add_char(p->line, '\n');
    keep_shape(p);
}

/* The background's, around the label of the brush: of the box between the corner and the
 * cross-hair, or of the ball around the one through the other. */
void pilot_plant_shell(struct press *p)
{
    const struct polyline *outline = &p->state->outline;
    const unsigned inside = p->state->brush.label;
    if (!has_one_corner(p, p->by ? "a box" : "a ball", p->by ? "corner" : "middle"))
        return;
    pilot_add_place(p->line, p->by ? "box " : "seed ", outline->corner[0]);
    if (p->by)
        pilot_add_place(p->line, " ", p->facts->place);
    buf_add_text(p->line, " 0 shell=yes");
    if (inside)
        buf_printf(p->line, " around=%u", inside);
    if (!p->by)
        pilot_add_place(p->line, " through=", p->facts->place);
    buf_add_char(p->line, '\n');
    keep_shape(p);
}

void pilot_plant_polygon(struct press *p)
{
    struct polyline *outline = &p->state->outline;
    if (outline->count < 3) {
        buf_printf(p->message, "a polygon takes 3 corners or more, and there %s %zu; ",
                   outline->count == 1 ? "is" : "are", outline->count);
        add_own_key(p, "corner");
        buf_add_text(p->message, " sets one");
        return;
    }
    pilot_add_place(p->line, "fill ", outline->corner[0]);
    add_label(p->line, &p->state->brush);
    for (size_t i = 1; i < outline->count; i++)
        pilot_add_place(p->line, " to=", outline->corner[i]);
    buf_add_char(p->line, '\n');
    keep_shape(p);
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
    buf_add_text(p->message, "here it would leave the scene");
    return false;
}

/* ---- strokes ---- */

void pilot_lower_pen(struct press *p)
{
    p->state->pen.is_down = !p->state->pen.is_down;
    if (!p->state->pen.is_down) /* else what stands below the picture says so as long as it is */
        buf_add_text(p->message, "the pen is up");
}

void pilot_begin_stroke(struct press *p)
{
    memcpy(p->state->stroke.place, p->facts->place, sizeof p->state->stroke.place);
    p->state->stroke.is_set = true;
    buf_add_text(p->message, "one end of a stroke; a seed where the other is draws it");
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

void pilot_show_held(struct press *p)
{
    struct buf held = {0};
    uint32_t place[3];
    if (!pilot_take_voxel(p, place))
        return;
    if (p->host->held(p->host->context, place, p->by, &held)) {
        p->state->mode = p->by ? PILOT_CONFIRMING_TREE : PILOT_CONFIRMING;
        buf_printf(p->message, "%s; ", buf_text(&held));
        add_own_key(p, p->by ? "eliminate-that-tree" : "eliminate-it");
        buf_add_text(p->message, " removes it");
    } else {
        buf_add_text(p->message, "no tree holds this voxel");
    }
    p->message->failed |= held.failed;
    buf_release(&held);
}

void pilot_undo(struct press *p)
{
    buf_add_text(p->line, p->by < 0 ? "undo" : "redo");
    if (p->state->count)
        buf_printf(p->line, " %u", p->state->count);
    buf_add_char(p->line, '\n');
}

/* ---- what is shown ---- */

/* The chosen label, or that of the count. */
void pilot_hide(struct press *p)
{
    const unsigned label = p->state->count ? p->state->count : p->state->brush.label;
    if (label == 0 || label >= LABELS) {
        buf_add_text(p->message, label ? "labels are 1 to 255" : "the background is never shown");
        return;
    }
    const bool is_hidden = p->host->is_hidden(p->host->context, label);
    buf_printf(p->line, "%s %u\n", is_hidden ? "show" : "hide", label);
    buf_printf(p->message, "%s label ", is_hidden ? "shown:" : "hidden:");
    p->host->label(p->host->context, label, p->message);
}

void pilot_show_all(struct press *p)
{
    unsigned label = 1;
    while (label < LABELS && !p->host->is_hidden(p->host->context, label))
        label++;
    if (label < LABELS)
        buf_add_text(p->line, "show all\n");
    buf_add_text(p->message, label < LABELS ? "all labels are shown" : "no label is hidden");
}

void pilot_turn(struct press *p)
{
    const int by = TURN * (int)(times(p) < TURNS_MOST ? times(p) : TURNS_MOST);
    buf_printf(p->line, "turn %d", right_of(p->by) * by);
    if (up_of(p->by))
        buf_printf(p->line, " %d", up_of(p->by) * by);
    buf_add_char(p->line, '\n');
}

void pilot_roll(struct press *p)
{
    const int by = TURN * (int)(times(p) < TURNS_MOST ? times(p) : TURNS_MOST);
    buf_printf(p->line, "turn 0 0 %d\n", p->by * by);
}

static void add_magnify(uint32_t by, const uint32_t middle[3], struct buf *line)
{
    buf_add_text(line, "magnify ");
    pilot_add_decimal(line, by / 1000.0);
    pilot_add_place(line, " at=", middle);
    buf_add_char(line, '\n');
}

/* Slices go on, and the cross-hair with them where they would leave it; with no stroke, for nobody
 * drew one. */
static void pan_slices(struct press *p, int right, int down)
{
    uint32_t middle[3], place[3];
    if (!p->host->pan(p->host->context, p->state->pane, right, down, middle, place)) {
        buf_add_text(p->message, "the slice ends there");
        return;
    }
    pilot_cross(p->state, p->facts, place, p->line);
    add_magnify(p->facts->times, middle, p->line);
    p->state->is_silent = true;
}

/* Of slices, where they are magnified and one does not correct; else of the rendition. */
void pilot_pan(struct press *p)
{
    const int by = (int)(times(p) < PIXEL_JUMP ? times(p) : PIXEL_JUMP);
    const int right = right_of(p->by) * by, down = -up_of(p->by) * by;
    if (p->facts->times > PILOT_TIMES_ONE && p->state->mode == PILOT_MOVING)
        pan_slices(p, right, down);
    else
        buf_printf(p->line, "pan %d %d\n", right * PIXEL_JUMP, down * PIXEL_JUMP);
}

/* ---- slices, larger and smaller ---- */

/* The next of 1, 1.25, 1.5, 2, 2.5, 3, 4, 5, 6, 8 .. */
static uint32_t next_times(uint32_t now, bool larger)
{
    static const uint32_t quarters[] = {4, 5, 6};
    uint32_t before = PILOT_TIMES_ONE;
    for (uint32_t unit = PILOT_TIMES_ONE / 4;; unit *= 2)
        for (int i = 0; i < 3; i++) {
            const uint32_t step = quarters[i] * unit;
            if (step >= PILOT_TIMES_MOST || (larger ? step > now : step >= now))
                return !larger ? before : step < PILOT_TIMES_MOST ? step : PILOT_TIMES_MOST;
            before = step;
        }
}

bool pilot_magnify_by(const struct pilot_facts *facts, int64_t steps, struct buf *line)
{
    uint32_t next = facts->times;
    for (int64_t i = steps < 0 ? -steps : steps; i > 0; i--)
        next = next_times(next, steps > 0);
    if (next == facts->times)
        return false;
    if (next == PILOT_TIMES_ONE)
        buf_add_text(line, "magnify fit\n");
    else
        add_magnify(next, facts->place, line);
    return true;
}

/* More or less so, or not at all. */
void pilot_magnify(struct press *p)
{
    const int64_t steps = p->by ? p->by * (times(p) < 64 ? times(p) : 64) : -64;
    p->state->is_silent = true;
    if (!pilot_magnify_by(p->facts, steps, p->line))
        buf_add_text(p->message, steps < 0 ? "slices are shown whole" : "slices cannot be larger");
}

void pilot_recentre(struct press *p)
{
    if (p->facts->times == PILOT_TIMES_ONE) {
        buf_add_text(p->message, "slices are shown whole; ");
        add_own_key(p, "magnify");
        buf_add_text(p->message, " shows them larger");
        return;
    }
    add_magnify(p->facts->times, p->facts->place, p->line);
    p->state->is_silent = true;
}

void pilot_show_alone(struct press *p)
{
    p->state->is_alone = !p->state->is_alone;
}

void pilot_change_zoom(struct press *p)
{
    pilot_zoom(p->facts->zoom, p->by > 0, p->line);
}

void pilot_change_overlay(struct press *p)
{
    static const char *const overlay[] = {"none", "tint", "contour"};
    buf_printf(p->line, "overlay %s\n", overlay[(p->facts->overlay + 1) % 3]);
}

void pilot_change_labels(struct press *p)
{
    if (p->facts->has_finish)
        buf_printf(p->line, "finished %s\n", p->facts->shows == PILOT_FOREST ? "on" : "off");
    else
        buf_add_text(p->message, "labels are not finished yet: `:finish relax` has them settle on "
                                 "the edges of the scene");
}

void pilot_preset(struct press *p)
{
    const struct pilot_setup *setup = p->state->setup;
    const size_t number = p->event->point - '1';
    if (number >= setup->windows) {
        buf_printf(p->message, "there are %zu windows", setup->windows);
        return;
    }
    const struct setup_window *window = setup->window + number;
    const int64_t low = window->centre - window->width / 2;
    buf_add_text(p->line, "window ");
    pilot_add_decimal(p->line, (double)low / 1000);
    buf_add_char(p->line, ' ');
    pilot_add_decimal(p->line, (double)(low + window->width) / 1000);
    buf_add_char(p->line, '\n');
    buf_printf(p->message, "the window of %s", window->name);
}

/* ---- a pixel of the rendition ---- */

/* It stays where it was, as long as the picture goes there. */
void pilot_begin_picking(struct press *p)
{
    struct pilot_state *state = p->state;
    const uint32_t size[2] = {p->facts->frame_width, p->facts->frame_height};
    for (int i = 0; i < 2; i++)
        if (!state->has_pixel || state->pixel[i] >= size[i])
            state->pixel[i] = size[i] / 2;
    state->has_pixel = true;
    state->mode = state->base = PILOT_PICKING;
}

void pilot_end_picking(struct press *p)
{
    uint32_t place[3];
    if (p->by && !pilot_take_voxel(p, place))
        return;
    p->state->mode = p->state->base = PILOT_MOVING;
}
