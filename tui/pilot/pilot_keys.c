#include "tui/pilot/pilot_keys.h"

#include <stdio.h>
#include <string.h>

enum {
    JUMP = 10, /* voxels */
    PIXEL_JUMP = 16,
    RADIUS_MOST = 32,
    LABELS = 256,
    COUNT_MOST = 9999,
    TURN = 15, /* degrees */
    ZOOM_LEAST = 10,
    ZOOM_MOST = 64000
};

const char pilot_keys_help[] =
    "  arrows, h j k l   move the cross-hair       Ctrl-arrows, H L   by ten voxels\n"
    "  J K, Page keys    the slice                 # and a number     a count: #25l\n"
    "  Tab               the next slice's plane    mouse              a click: there\n"
    "\n"
    "  0 .. 9            a seed of that label      s    of the label at hand\n"
    "  n N               choose the label          + -  the brush's radius\n"
    "  v                 pen down: moving draws    m    one end of a stroke: the next\n"
    "  x x               eliminate the tree             seed draws a line from there\n"
    "  space             run what waits            u    undo, Ctrl-R  redo\n"
    "\n"
    "  r R, Shift-arrows turn the view             z Z  nearer, farther\n"
    "  w                 the window of the greys   p    a pixel of the rendition\n"
    "  :                 a command                 ?    these keys\n"
    "  Ctrl-L            draw anew                 q    back to the prompt\n";

void pilot_state_init(struct pilot_state *state)
{
    *state = (struct pilot_state){.pane = PILOT_AXIAL, .label = 1};
}

/* ---- lines ---- */

static void add_place(struct buf *line, const char *before, const uint32_t place[3])
{
    buf_printf(line, "%s%u,%u,%u", before, place[0], place[1], place[2]);
}

static void add_seed(const struct pilot_state *state, const uint32_t place[3],
                     const uint32_t *other_end, struct buf *line)
{
    add_place(line, "seed ", place);
    buf_printf(line, " %u", state->label);
    if (state->radius)
        buf_printf(line, " radius=%u", state->radius);
    if (other_end)
        add_place(line, " to=", other_end);
    buf_add_char(line, '\n');
}

/* Takes the cross-hair to a place, unless it is there. Whether it moves. */
static bool add_cross(const struct pilot_facts *facts, const uint32_t place[3], struct buf *line)
{
    if (memcmp(place, facts->place, sizeof facts->place) == 0)
        return false;
    add_place(line, "cross ", place);
    buf_add_char(line, '\n');
    return true;
}

/* The same; with the pen down, a stroke leads there. */
static void go_to(const struct pilot_state *state, const struct pilot_facts *facts,
                  const uint32_t place[3], struct buf *line)
{
    if (add_cross(facts, place, line) && state->pen_is_down)
        add_seed(state, place, facts->place, line);
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

static void move(const struct pilot_state *state, const struct pilot_host *host,
                 const struct pilot_facts *facts, int64_t right, int64_t up, int64_t through,
                 struct buf *line)
{
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    by[screen_of[state->pane].across] = -right;
    by[screen_of[state->pane].along] = up;
    by[state->pane] = through;
    host->move(host->context, by, place);
    go_to(state, facts, place, line);
}

/* The direction of an arrow or of one of h j k l, and how far it goes by itself. */
static bool read_direction(const struct key_event *event, int *right, int *up, int *far)
{
    *right = *up = 0;
    *far = event->modifiers & KEY_CONTROL ? JUMP : 1;
    switch (event->key) {
    case KEY_LEFT:
        *right = -1;
        return true;
    case KEY_RIGHT:
        *right = 1;
        return true;
    case KEY_UP:
        *up = 1;
        return true;
    case KEY_DOWN:
        *up = -1;
        return true;
    case KEY_CHARACTER:
        break;
    default:
        return false;
    }
    if (event->modifiers)
        return false;
    switch (event->point) {
    case 'H':
        *far = JUMP;
        *right = -1;
        return true;
    case 'h':
        *right = -1;
        return true;
    case 'L':
        *far = JUMP;
        *right = 1;
        return true;
    case 'l':
        *right = 1;
        return true;
    case 'k':
        *up = 1;
        return true;
    case 'j':
        *up = -1;
        return true;
    default:
        return false;
    }
}

/* ---- the modes ---- */

static double magnitude(double value)
{
    return value < 0 ? -value : value;
}

/* A decimal as commands take it: three places at most, no zeros behind. */
static void add_decimal(struct buf *line, double value)
{
    const long long thousandths = (long long)(magnitude(value) * 1000 + 0.5);
    buf_printf(line, "%s%lld", value < 0 && thousandths ? "-" : "", thousandths / 1000);
    unsigned places = (unsigned)(thousandths % 1000);
    if (places) {
        char digits[8];
        int n = snprintf(digits, sizeof digits, ".%03u", places);
        while (digits[n - 1] == '0')
            n--;
        buf_add(line, digits, (size_t)n);
    }
}

static enum pilot_deed change_window(struct pilot_state *state, const struct key_event *event,
                                     const struct pilot_facts *facts, struct buf *line)
{
    int right, up, far;
    const double width = facts->window[1] - facts->window[0];
    const double least = magnitude(width) / 50 > 0.001 ? width / 50 : 0.001;
    if (event->key == KEY_CHARACTER && event->point == 'a' && !event->modifiers) {
        buf_add_text(line, "window auto\n");
        state->mode = PILOT_FLYING;
        return PILOT_NOTHING;
    }
    if (!read_direction(event, &right, &up, &far)) {
        state->mode = PILOT_FLYING;
        return PILOT_NOTHING;
    }
    /* To the right wider, up brighter. */
    const double low = facts->window[0] - least * (right + up) * far;
    const double high = facts->window[1] + least * (right - up) * far;
    buf_add_text(line, "window ");
    add_decimal(line, low);
    buf_add_char(line, ' ');
    add_decimal(line, high);
    buf_add_char(line, '\n');
    return PILOT_NOTHING;
}

static uint32_t shifted(uint32_t at, int64_t by, uint32_t most)
{
    const int64_t to = (int64_t)at + by;
    return to < 0 ? 0 : to >= (int64_t)most ? most - 1 : (uint32_t)to;
}

static enum pilot_deed pick(struct pilot_state *state, const struct key_event *event,
                            const struct pilot_host *host, const struct pilot_facts *facts,
                            struct buf *line, struct buf *message)
{
    int right, up, far;
    uint32_t place[3];
    if (read_direction(event, &right, &up, &far)) {
        const int64_t step = far > 1 ? PIXEL_JUMP : state->count ? (int64_t)state->count : 1;
        state->pixel[0] = shifted(state->pixel[0], right * step, facts->frame_width);
        state->pixel[1] = shifted(state->pixel[1], -up * step, facts->frame_height);
        return PILOT_NOTHING;
    }
    state->mode = PILOT_FLYING;
    if (event->key != KEY_ENTER)
        return PILOT_NOTHING;
    if (host->voxel_of_frame(host->context, state->pixel[0], state->pixel[1], place))
        go_to(state, facts, place, line);
    else
        buf_add_text(message, "no object is seen at that pixel");
    return PILOT_NOTHING;
}

/* ---- flying ---- */

static void say_hand(const struct pilot_state *state, const struct pilot_host *host,
                     struct buf *message)
{
    buf_add_text(message, "the brush: label ");
    host->label(host->context, state->label, message);
    buf_printf(message, ", radius %u%s", state->radius, state->pen_is_down ? ", pen down" : "");
}

static void plant(struct pilot_state *state, const struct pilot_facts *facts, struct buf *line)
{
    add_seed(state, facts->place, state->has_mark ? state->mark : NULL, line);
    state->has_mark = false;
}

static void turn(int yaw, int pitch, uint32_t count, struct buf *line)
{
    const int times = count ? (int)(count < 24 ? count : 24) : 1;
    buf_printf(line, "turn %d", yaw * times * TURN);
    if (pitch)
        buf_printf(line, " %d", pitch * times * TURN);
    buf_add_char(line, '\n');
}

static void zoom(uint32_t now, bool nearer, struct buf *line)
{
    uint32_t next = nearer ? now + now / 4 + 1 : now - now / 5;
    next = next < ZOOM_LEAST ? ZOOM_LEAST : next > ZOOM_MOST ? ZOOM_MOST : next;
    buf_add_text(line, "zoom ");
    add_decimal(line, next / 1000.0);
    buf_add_char(line, '\n');
}

static enum pilot_deed picture_writer_control(const struct key_event *event, struct buf *line)
{
    switch (event->point) {
    case 'r':
        buf_add_text(line, "redo\n");
        return PILOT_NOTHING;
    case 'l':
        return PILOT_REDRAW;
    case 'z':
        return PILOT_SUSPEND;
    case 'd':
        return PILOT_LEAVE;
    default:
        return PILOT_NOTHING;
    }
}

static void choose(struct pilot_state *state, uint32_t point)
{
    if (point == 'n')
        state->label = (state->label + 1) % LABELS;
    else if (point == 'N')
        state->label = (state->label + LABELS - 1) % LABELS;
    else if (point == '+' || point == '=')
        state->radius += state->radius < RADIUS_MOST;
    else if (point == '-' || point == '_')
        state->radius -= state->radius > 0;
    else
        state->pen_is_down = !state->pen_is_down;
}

static void begin_confirming(struct pilot_state *state, const struct pilot_host *host,
                             struct buf *message)
{
    struct buf tree = {0};
    if (host->tree(host->context, &tree)) {
        state->mode = PILOT_CONFIRMING;
        buf_printf(message, "x again eliminates %s", buf_text(&tree));
    } else {
        buf_add_text(message, "no tree holds this voxel");
    }
    message->failed |= tree.failed;
    buf_release(&tree);
}

static void begin_picking(struct pilot_state *state, const struct pilot_facts *facts)
{
    state->mode = PILOT_PICKING;
    state->pixel[0] = facts->frame_width / 2;
    state->pixel[1] = facts->frame_height / 2;
}

static enum pilot_deed picture_writer_letter(struct pilot_state *state,
                                             const struct key_event *event,
                                             const struct pilot_host *host,
                                             const struct pilot_facts *facts, struct buf *line,
                                             struct buf *message)
{
    const uint32_t count = state->count ? state->count : 1;
    if (event->point >= '0' && event->point <= '9') {
        state->label = event->point - '0';
        plant(state, facts, line);
        return PILOT_NOTHING;
    }
    switch (event->point) {
    case 's':
        plant(state, facts, line);
        break;
    case 'J':
        move(state, host, facts, 0, 0, -(int64_t)count, line);
        break;
    case 'K':
        move(state, host, facts, 0, 0, count, line);
        break;
    case 'n':
    case 'N':
    case '+':
    case '=':
    case '-':
    case '_':
    case 'v':
        choose(state, event->point);
        say_hand(state, host, message);
        break;
    case 'm':
        memcpy(state->mark, facts->place, sizeof state->mark);
        state->has_mark = true;
        buf_add_text(message, "one end of a stroke; a seed where the other is draws it");
        break;
    case 'x':
        begin_confirming(state, host, message);
        break;
    case ' ':
        buf_add_text(line, "run\n");
        break;
    case 'u':
        buf_add_text(line, "undo");
        if (state->count)
            buf_printf(line, " %u", count);
        buf_add_char(line, '\n');
        break;
    case 'r':
        turn(1, 0, state->count, line);
        break;
    case 'R':
        turn(-1, 0, state->count, line);
        break;
    case 'z':
        zoom(facts->zoom, true, line);
        break;
    case 'Z':
        zoom(facts->zoom, false, line);
        break;
    case 'w':
        state->mode = PILOT_WINDOWING;
        break;
    case 'p':
        begin_picking(state, facts);
        break;
    case '?':
        state->mode = PILOT_HELPING;
        break;
    case ':':
        return PILOT_PROMPT;
    case 'q':
        return PILOT_LEAVE;
    default:
        buf_add_text(message, "no key of the pilot's; ? tells them");
    }
    return PILOT_NOTHING;
}

static enum pilot_deed fly(struct pilot_state *state, const struct key_event *event,
                           const struct pilot_host *host, const struct pilot_facts *facts,
                           struct buf *line, struct buf *message)
{
    int right, up, far;
    const bool is_arrow = event->key != KEY_CHARACTER;
    if (read_direction(event, &right, &up, &far)) {
        const int64_t steps = state->count ? (int64_t)state->count * far : far;
        if (is_arrow && event->modifiers & KEY_SHIFT)
            turn(right, up, state->count, line);
        else
            move(state, host, facts, right * steps, up * steps, 0, line);
        return PILOT_NOTHING;
    }
    switch (event->key) {
    case KEY_PAGE_UP:
    case KEY_PAGE_DOWN:
        move(state, host, facts, 0, 0,
             (int64_t)(state->count ? state->count : 1) * (event->key == KEY_PAGE_UP ? 1 : -1),
             line);
        return PILOT_NOTHING;
    case KEY_TAB:
        state->pane = (enum pilot_pane)((state->pane + 1) % PILOT_RENDITION);
        return PILOT_NOTHING;
    case KEY_ESCAPE:
        state->has_mark = state->pen_is_down = false;
        return PILOT_NOTHING;
    case KEY_CHARACTER:
        if (event->modifiers & KEY_CONTROL)
            return picture_writer_control(event, line);
        return picture_writer_letter(state, event, host, facts, line, message);
    default:
        return PILOT_NOTHING;
    }
}

/* True where the key is a part of a count. */
static bool count_on(struct pilot_state *state, const struct key_event *event, struct buf *message)
{
    if (event->key != KEY_CHARACTER || event->modifiers)
        return false;
    const bool is_digit = event->point >= '0' && event->point <= '9';
    if (event->point == '#') {
        state->counts = true;
        state->count = 0;
    } else if (!state->counts || !is_digit) {
        return false;
    } else {
        const uint32_t next = state->count * 10 + (event->point - '0');
        state->count = next < COUNT_MOST ? next : COUNT_MOST;
    }
    buf_printf(message, "#%u", state->count);
    return true;
}

enum pilot_deed pilot_press(struct pilot_state *state, const struct key_event *event,
                            const struct pilot_host *host, const struct pilot_facts *facts,
                            struct buf *line, struct buf *message)
{
    enum pilot_deed deed = PILOT_NOTHING;
    if (count_on(state, event, message))
        return PILOT_NOTHING;
    state->counts = false;
    const bool is_x = event->key == KEY_CHARACTER && event->point == 'x' && !event->modifiers;
    switch (state->mode) {
    case PILOT_HELPING:
        state->mode = PILOT_FLYING;
        break;
    case PILOT_CONFIRMING:
        state->mode = PILOT_FLYING;
        if (is_x || event->key == KEY_ENTER) {
            add_place(line, "remove ", facts->place);
            buf_add_char(line, '\n');
        } else if (event->key != KEY_ESCAPE) {
            deed = fly(state, event, host, facts, line, message);
        }
        break;
    case PILOT_WINDOWING:
        deed = change_window(state, event, facts, line);
        break;
    case PILOT_PICKING:
        deed = pick(state, event, host, facts, line, message);
        break;
    case PILOT_FLYING:
        deed = fly(state, event, host, facts, line, message);
    }
    state->count = 0;
    return deed;
}

/* ---- what the keys do now ---- */

void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out)
{
    switch (state->mode) {
    case PILOT_FLYING:
    case PILOT_HELPING:
        buf_add_text(out, "0-9 seed  x eliminate  u undo  : command  ? keys  q back");
        break;
    case PILOT_CONFIRMING:
        buf_add_text(out, "x or Enter eliminates the hatched tree  Escape keeps it");
        break;
    case PILOT_WINDOWING:
        buf_add_text(out, "window ");
        add_decimal(out, facts->window[0]);
        buf_add_char(out, ' ');
        add_decimal(out, facts->window[1]);
        buf_add_text(out, "  left right width  up down brightness  a auto  Enter done");
        break;
    case PILOT_PICKING:
        buf_printf(out, "pixel %u,%u of the rendition  arrows move it  Enter goes to its voxel",
                   state->pixel[0], state->pixel[1]);
    }
}

/* ---- the mouse ---- */

void pilot_click(struct pilot_state *state, const struct key_event *event, uint32_t column,
                 uint32_t row, const struct pilot_host *host, const struct pilot_facts *facts,
                 struct buf *line, struct buf *message)
{
    const struct mouse *mouse = &event->mouse;
    uint32_t place[3];
    enum pilot_pane pane;
    const bool shows = host->voxel_at(host->context, column, row, place, &pane);
    state->drags &= mouse->action == MOUSE_MOVED;
    if (mouse->action == MOUSE_WHEEL_UP || mouse->action == MOUSE_WHEEL_DOWN) {
        const bool up = mouse->action == MOUSE_WHEEL_UP;
        int64_t by[3] = {0, 0, 0};
        if (pane == PILOT_RENDITION) {
            zoom(facts->zoom, up, line);
            return;
        }
        by[pane] = up ? 1 : -1;
        host->move(host->context, by, place);
        if (state->mode == PILOT_CONFIRMING) { /* the tree that was told is not under it any more */
            state->mode = PILOT_FLYING;
            buf_clear(message);
        }
        add_cross(facts, place, line);
    } else if (mouse->button == MOUSE_LEFT && mouse->action == MOUSE_PRESSED) {
        if (!shows) {
            buf_clear(message);
            buf_add_text(message, "nothing is seen there");
            return;
        }
        state->mode = PILOT_FLYING;
        state->drags = true;
        if (pane != PILOT_RENDITION)
            state->pane = pane;
        add_cross(facts, place, line);
    } else if (state->drags && shows && pane == state->pane) {
        go_to(state, facts, place, line);
    }
}
