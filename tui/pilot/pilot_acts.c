/* SPDX-License-Identifier: MIT */
/* Functions of keys that move, ask, or change the display: each adds a command, or changes the
 * pilot's own state. */
#include "tui/pilot/pilot_keys.h"

#include <string.h>

enum { JUMP = 10, PIXEL_JUMP = 16 }; /* voxels, pixels */
enum { TURN = 15, TURNS_MOST = 24 }; /* degrees */
enum { ZOOM_LEAST = 10, ZOOM_MOST = 64000 };

static int right_of(int way)
{
    return (way % PILOT_WAYS == PILOT_RIGHT) - (way % PILOT_WAYS == PILOT_LEFT);
}

static int up_of(int way)
{
    return (way % PILOT_WAYS == PILOT_UP) - (way % PILOT_WAYS == PILOT_DOWN);
}

/* ---- moving ---- */

/* The planes whose slices are counted along the screen in a pane, to the right and up. The
 * patient's left is on the right; in sagittal slices the front is on the left. Slices are counted
 * towards the head, the front and the right. */
static const struct {
    enum pilot_pane across, along;
} screen_of[3] = {
    [PILOT_AXIAL] = {PILOT_SAGITTAL, PILOT_CORONAL},
    [PILOT_CORONAL] = {PILOT_SAGITTAL, PILOT_AXIAL},
    [PILOT_SAGITTAL] = {PILOT_CORONAL, PILOT_AXIAL},
};

static void move_pixel(struct press *p, int64_t right, int64_t up)
{
    uint32_t *pixel = p->state->pixel;
    pixel[0] = pilot_shifted(pixel[0], right, p->facts->frame_width);
    pixel[1] = pilot_shifted(pixel[1], -up, p->facts->frame_height);
}

static void add_window(struct press *p, double low, double high)
{
    buf_add_text(p->line, "window ");
    pilot_add_decimal(p->line, low);
    buf_add_char(p->line, ' ');
    pilot_add_decimal(p->line, high);
    buf_add_char(p->line, '\n');
    p->state->is_silent = true;
}

/* Report that the scene ends before the count, as in 70L. */
static void say_edge(struct press *p, int64_t asked, const uint32_t place[3])
{
    const uint32_t *here = p->facts->place;
    int64_t went = 0;
    for (int a = 0; a < 3; a++)
        went += place[a] > here[a] ? place[a] - here[a] : here[a] - place[a];
    if (went < asked && went > 0)
        buf_printf(p->message, "%lld of %lld: ", (long long)went, (long long)asked);
    if (went < asked)
        buf_add_text(p->message, "the edge of the scene");
}

/* `by` is a direction, and whether to move far. A window gets wider to the right, brighter up. */
void pilot_move(struct press *p)
{
    const int right = right_of(p->by), up = up_of(p->by);
    const bool far = p->by >= PILOT_FAR;
    if (p->state->mode == PILOT_WINDOWING) {
        const double *window = p->facts->window, width = window[1] - window[0];
        const double step = (width != 0 ? width / 50 : 0.001) * (far ? JUMP : 1);
        add_window(p, window[0] - step * (right + up), window[1] + step * (right - up));
    } else if (p->state->mode == PILOT_PICKING) {
        move_pixel(p, right * (far ? PIXEL_JUMP : 1), up * (far ? PIXEL_JUMP : 1));
    } else {
        const enum pilot_pane pane = p->state->pane;
        const int64_t asked = pilot_times(p) * (far ? JUMP : 1);
        int64_t by[3] = {0, 0, 0};
        uint32_t place[3];
        by[screen_of[pane].across] = -right * asked;
        by[screen_of[pane].along] = up * asked;
        p->host->move(p->host->context, by, place);
        pilot_go_to(p, place);
        say_edge(p, asked, place);
    }
}

/* Move by slices. A jump draws nothing; J and K draw while the pen is down. */
static void move_through(struct press *p, int64_t slices, bool is_jump)
{
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    by[p->state->pane] = slices;
    p->host->move(p->host->context, by, place);
    if (is_jump)
        pilot_cross(p, place);
    else {
        pilot_go_to(p, place);
        say_edge(p, slices < 0 ? -slices : slices, place);
    }
}

void pilot_change_slice(struct press *p)
{
    if (p->state->mode == PILOT_PICKING)
        move_pixel(p, 0, p->by * PIXEL_JUMP);
    else
        move_through(p, p->by * pilot_times(p), false);
}

/* ---- jumps ---- */

void pilot_to_slice(struct press *p)
{
    const int64_t here = p->facts->place[p->facts->axis[p->state->pane]], count = p->state->count;
    const int64_t by = count ? count - here : p->by < 0 ? -here : INT32_MAX;
    pilot_remember_place(p);
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
    pilot_say(p, "{go-to-mark:%c} leads back here", (char)p->event->point);
}

/* Return the mark of the pressed letter; NULL, with a message, if it is not set. */
static const struct pilot_mark *mark_pressed(struct press *p)
{
    const char letter = (char)p->event->point;
    const struct pilot_mark *mark = &p->state->mark[letter - 'a'];
    if (mark->is_set)
        return mark;
    pilot_say(p, "there is no mark %c; {mark:%c} sets it", letter, letter);
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
    if (mark)
        buf_printf(p->line, "measure " PLACE " " PLACE "\n", XYZ(mark->place),
                   XYZ(p->facts->place));
}

void pilot_go_back(struct press *p)
{
    const struct pilot_mark former = p->state->former;
    if (former.is_set)
        pilot_jump(p, former.place);
    else
        buf_add_text(p->message, "there was no jump yet");
}

/* By 0: go to the label's centre. */
void pilot_next_seed(struct press *p)
{
    const struct pilot_host *host = p->host;
    const unsigned label = p->state->brush.label;
    uint32_t place[3];
    if (p->by ? host->seed(host->context, label, p->by * pilot_times(p), place)
              : host->centre(host->context, label, place)) {
        pilot_jump(p, place);
        return;
    }
    buf_add_text(p->message, "label ");
    host->label(host->context, label, p->message);
    buf_add_text(p->message, p->by ? " has no seed" : " has no voxel");
}

/* ---- paths, and uncertain places ---- */

void pilot_explain(struct press *p)
{
    struct pilot_way *way = &p->state->way;
    uint32_t place[3];
    if (pilot_take_voxel(p, place) && p->host->why(p->host->context, place, way, p->message))
        p->state->mode = PILOT_EXPLAINING;
}

void pilot_go_to_edge(struct press *p)
{
    if (pilot_has_edge(p))
        pilot_jump(p, p->state->way.edge);
}

/* Hints are visited cyclically. */
void pilot_go_to_hint(struct press *p)
{
    struct pilot_state *state = p->state;
    const unsigned hints = p->host->hints(p->host->context);
    if (state->count)
        state->hint = state->count;
    else if (p->by > 0)
        state->hint = state->hint < hints ? state->hint + 1 : 1;
    else
        state->hint = state->hint > 1 && state->hint <= hints + 1 ? state->hint - 1 : hints;
    state->hint = state->hint ? state->hint : 1;
    pilot_remember_place(p);
    buf_printf(p->line, "hint %u\n", state->hint);
}

void pilot_show_heat(struct press *p)
{
    p->state->heat = !p->state->heat;
    if (p->state->heat)
        buf_add_text(p->message, "red, where the border is least certain");
}

/* ---- display ---- */

void pilot_undo(struct press *p)
{
    buf_add_text(p->line, p->by < 0 ? "undo" : "redo");
    if (p->state->count)
        buf_printf(p->line, " %u", p->state->count);
    buf_add_char(p->line, '\n');
}

/* Hide or show the chosen label, or that of the count. */
void pilot_hide(struct press *p)
{
    const uint32_t label = p->state->count ? p->state->count : p->state->brush.label;
    if (label == 0) {
        buf_add_text(p->message, "the background is never shown");
        return;
    }
    if (!pilot_has_label(p, label))
        return;
    const bool is_hidden = p->host->is_hidden(p->host->context, label);
    uint32_t place[3];
    if (!is_hidden && !p->host->seed(p->host->context, label, 1, place) &&
        !p->host->centre(p->host->context, label, place)) {
        buf_add_text(p->message, "there is no label ");
        p->host->label(p->host->context, label, p->message);
        buf_add_text(p->message, " to hide: it has no voxel and no seed");
        return;
    }
    buf_printf(p->line, "%s %u\n", is_hidden ? "show" : "hide", label);
    buf_printf(p->message, "%s label ", is_hidden ? "shown:" : "hidden:");
    p->host->label(p->host->context, label, p->message);
}

void pilot_show_all(struct press *p)
{
    uint32_t label = 0;
    bool is_hidden = false;
    do {
        p->host->next_label(p->host->context, label, 1, &label);
        is_hidden = label && p->host->is_hidden(p->host->context, label);
    } while (label && !is_hidden);
    if (is_hidden)
        buf_add_text(p->line, "show all\n");
    buf_add_text(p->message, is_hidden ? "all labels are shown" : "no label is hidden");
}

static int degrees(const struct press *p)
{
    return TURN * (int)(pilot_times(p) < TURNS_MOST ? pilot_times(p) : TURNS_MOST);
}

/* `by` is a direction. */
void pilot_turn(struct press *p)
{
    buf_printf(p->line, "turn %d", right_of(p->by) * degrees(p));
    if (up_of(p->by))
        buf_printf(p->line, " %d", up_of(p->by) * degrees(p));
    buf_add_char(p->line, '\n');
}

void pilot_roll(struct press *p)
{
    buf_printf(p->line, "turn 0 0 %d\n", p->by * degrees(p));
}

void pilot_change_zoom(struct press *p)
{
    const uint32_t now = p->facts->zoom, *middle = p->facts->middle;
    uint32_t next = p->by > 0 ? now + now / 4 + 1 : now - now / 5;
    next = next < ZOOM_LEAST ? ZOOM_LEAST : next > ZOOM_MOST ? ZOOM_MOST : next;
    buf_add_text(p->line, "zoom ");
    pilot_add_decimal(p->line, next / 1000.0);
    if (p->facts->is_fitted)
        buf_printf(p->line, " at=" PLACE, XYZ(middle));
    buf_add_char(p->line, '\n');
}

/* Let the view fit the shown objects by itself again. */
void pilot_fit(struct press *p)
{
    buf_add_text(p->line, "focus scene\nzoom ");
    pilot_add_decimal(p->line, p->facts->default_zoom / 1000.0);
    buf_add_char(p->line, '\n');
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
        buf_add_text(p->message, "labels are not finished yet: `:finish relax` settles them on "
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
    add_window(p, (double)low / 1000, (double)(low + window->width) / 1000);
    buf_printf(p->message, "the window of %s", window->name);
}

/* ---- magnified slices ---- */

static void add_magnify(struct press *p, uint32_t by, const uint32_t middle[3])
{
    buf_add_text(p->line, "magnify ");
    pilot_add_decimal(p->line, by / 1000.0);
    buf_printf(p->line, " at=" PLACE "\n", XYZ(middle));
    p->state->is_silent = true;
}

/* Return the next of 1, 1.25, 1.5, 2, 2.5, 3, 4, 5, 6, 8 .. */
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

bool pilot_magnify_by(struct press *p, int64_t steps)
{
    const uint32_t now = p->facts->times;
    uint32_t next = now;
    for (int64_t i = steps < 0 ? -steps : steps; i > 0; i--)
        next = next_times(next, steps > 0);
    p->state->is_silent = true;
    if (next == now)
        return false;
    if (next == PILOT_TIMES_ONE)
        buf_add_text(p->line, "magnify fit\n");
    else
        add_magnify(p, next, p->facts->place);
    return true;
}

/* By 0: show whole slices. */
void pilot_magnify(struct press *p)
{
    const int64_t steps = p->by ? p->by * (pilot_times(p) < 64 ? pilot_times(p) : 64) : -64;
    if (!pilot_magnify_by(p, steps))
        buf_add_text(p->message, steps < 0 ? "slices are shown whole" : "slices cannot be larger");
}

void pilot_recentre(struct press *p)
{
    if (p->facts->times == PILOT_TIMES_ONE)
        pilot_say(p, "slices are shown whole; {magnify} shows them larger");
    else
        add_magnify(p, p->facts->times, p->facts->place);
}

/* Move slices within the pane if they are magnified, but the rendition in PILOT_PICKING. The
 * cross-hair moves along, without a stroke, if it would leave the visible part. */
void pilot_pan(struct press *p)
{
    const int by = (int)(pilot_times(p) < PIXEL_JUMP ? pilot_times(p) : PIXEL_JUMP);
    const int right = right_of(p->by) * by, down = -up_of(p->by) * by;
    uint32_t middle[3], place[3];
    if (p->facts->times <= PILOT_TIMES_ONE || p->state->mode == PILOT_PICKING) {
        if (p->facts->is_fitted)
            buf_printf(p->line, "focus " PLACE "\n", XYZ(p->facts->middle));
        buf_printf(p->line, "pan %d %d\n", right * PIXEL_JUMP, down * PIXEL_JUMP);
    } else if (p->host->pan(p->host->context, p->state->pane, right, down, middle, place)) {
        pilot_cross(p, place);
        add_magnify(p, p->facts->times, middle);
    } else {
        buf_add_text(p->message, "the slice ends there");
    }
}

void pilot_show_alone(struct press *p)
{
    p->state->is_alone = !p->state->is_alone;
}

/* ---- a pixel of the rendition ---- */

/* Keep the pixel that was picked last if the picture contains it. */
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
    if (!p->by || pilot_take_voxel(p, place))
        p->state->mode = p->state->base = pilot_home(p->state);
}

/* ---- watched steps ---- */

void pilot_step(struct press *p)
{
    buf_printf(p->line, "step %s %lld\n", p->by < 0 ? "back" : "on", (long long)pilot_times(p));
}

void pilot_to_step(struct press *p)
{
    if (p->state->count)
        buf_printf(p->line, "step to %u\n", p->state->count);
    else
        buf_add_text(p->line, p->by < 0 ? "step to 0\n" : "step to last\n");
}
