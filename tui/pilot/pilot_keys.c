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

void pilot_state_init(struct pilot_state *state)
{
    *state = (struct pilot_state){.pane = PILOT_AXIAL, .label = 1};
}

/* A key, and what it is pressed upon. */
struct press {
    struct pilot_state *state;
    const struct key_event *event;
    const struct pilot_host *host;
    const struct pilot_facts *facts;
    struct buf *line, *message;
    unsigned which; /* of the keys of a row, from 0 */
    enum pilot_deed deed;
};

static void dispatch(struct press *p);

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

/* ---- lines ---- */

static void add_place(struct buf *line, const char *before, const uint32_t place[3])
{
    buf_printf(line, "%s%u,%u,%u", before, place[0], place[1], place[2]);
}

static void add_seed(struct pilot_state *state, const uint32_t place[3], const uint32_t *other_end,
                     struct buf *line)
{
    add_place(line, "seed ", place);
    buf_printf(line, " %u", state->label);
    if (state->radius)
        buf_printf(line, " radius=%u", state->radius);
    if (other_end)
        add_place(line, " to=", other_end);
    buf_add_char(line, '\n');
    state->is_silent = false;
}

/* Takes the cross-hair to a place, unless it is there. Whether it moves. */
static bool add_cross(struct pilot_state *state, const struct pilot_facts *facts,
                      const uint32_t place[3], struct buf *line)
{
    if (memcmp(place, facts->place, sizeof facts->place) == 0)
        return false;
    add_place(line, "cross ", place);
    buf_add_char(line, '\n');
    state->is_silent = true;
    return true;
}

/* The same; with the pen down, a stroke leads there. */
static void go_to(struct pilot_state *state, const struct pilot_facts *facts,
                  const uint32_t place[3], struct buf *line)
{
    if (add_cross(state, facts, place, line) && state->pen_is_down)
        add_seed(state, place, facts->place, line);
}

static double magnitude(double value)
{
    return value < 0 ? -value : value;
}

/* A decimal as commands take it: three places at most, no zeros at its end. */
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

static void zoom(uint32_t now, bool nearer, struct buf *line)
{
    uint32_t next = nearer ? now + now / 4 + 1 : now - now / 5;
    next = next < ZOOM_LEAST ? ZOOM_LEAST : next > ZOOM_MOST ? ZOOM_MOST : next;
    buf_add_text(line, "zoom ");
    add_decimal(line, next / 1000.0);
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

static void move(struct press *p, int64_t right, int64_t up, int64_t through)
{
    const enum pilot_pane pane = p->state->pane;
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    by[screen_of[pane].across] = -right;
    by[screen_of[pane].along] = up;
    by[pane] = through;
    p->host->move(p->host->context, by, place);
    go_to(p->state, p->facts, place, p->line);
}

/* The direction of an arrow or of one of h j k l H L; whether it goes far. */
static bool direction(const struct key_event *event, int *right, int *up)
{
    const bool is_letter = event->key == KEY_CHARACTER;
    const uint32_t c = is_letter ? event->point : 0;
    *right = (event->key == KEY_RIGHT || c == 'l' || c == 'L') -
             (event->key == KEY_LEFT || c == 'h' || c == 'H');
    *up = (event->key == KEY_UP || c == 'k') - (event->key == KEY_DOWN || c == 'j');
    return is_letter ? c == 'H' || c == 'L' : event->modifiers & KEY_CONTROL;
}

static void move_in_plane(struct press *p)
{
    int right, up;
    const int64_t far = direction(p->event, &right, &up) ? JUMP : 1, steps = times(p) * far;
    move(p, right * steps, up * steps, 0);
}

/* J and Page down go back, K and Page up on. */
static void change_slice(struct press *p)
{
    const bool back = p->event->key == KEY_PAGE_DOWN || p->event->point == 'J';
    move(p, 0, 0, back ? -times(p) : times(p));
}

static void next_pane(struct press *p)
{
    p->state->pane = (enum pilot_pane)((p->state->pane + 1) % PILOT_RENDITION);
}

/* ---- seeds ---- */

static void plant(struct press *p)
{
    struct pilot_state *state = p->state;
    add_seed(state, p->facts->place, state->has_mark ? state->mark : NULL, p->line);
    state->has_mark = false;
}

static void plant_label(struct press *p)
{
    p->state->label = p->event->point - '0';
    plant(p);
}

static void say_brush(struct press *p)
{
    buf_add_text(p->message, "the brush: label ");
    p->host->label(p->host->context, p->state->label, p->message);
    buf_printf(p->message, ", radius %u%s", p->state->radius,
               p->state->pen_is_down ? ", pen down" : "");
}

static void choose_label(struct press *p)
{
    p->state->label = (p->state->label + (p->which == 0 ? 1 : LABELS - 1)) % LABELS;
    say_brush(p);
}

static void change_radius(struct press *p)
{
    const int64_t by = p->which % 2 == 0 ? times(p) : -times(p);
    p->state->radius = shifted(p->state->radius, by, RADIUS_MOST + 1);
    say_brush(p);
}

static void lower_pen(struct press *p)
{
    p->state->pen_is_down = !p->state->pen_is_down;
    say_brush(p);
}

static void mark_end(struct press *p)
{
    memcpy(p->state->mark, p->facts->place, sizeof p->state->mark);
    p->state->has_mark = true;
    buf_add_text(p->message, "one end of a stroke; a seed where the other is draws it");
}

static void drop_stroke(struct press *p)
{
    p->state->has_mark = p->state->pen_is_down = false;
}

static void show_tree(struct press *p)
{
    struct buf tree = {0};
    if (p->host->tree(p->host->context, &tree)) {
        p->state->mode = PILOT_CONFIRMING;
        buf_printf(p->message, "x again eliminates %s", buf_text(&tree));
    } else {
        buf_add_text(p->message, "no tree holds this voxel");
    }
    p->message->failed |= tree.failed;
    buf_release(&tree);
}

static void undo(struct press *p)
{
    buf_add_text(p->line, "undo");
    if (p->state->count)
        buf_printf(p->line, " %u", p->state->count);
    buf_add_char(p->line, '\n');
}

/* ---- the view and the window ---- */

static void add_turn(struct press *p, int yaw, int pitch)
{
    const int by = TURN * (int)(times(p) < 24 ? times(p) : 24);
    buf_printf(p->line, "turn %d", yaw * by);
    if (pitch)
        buf_printf(p->line, " %d", pitch * by);
    buf_add_char(p->line, '\n');
}

static void turn(struct press *p)
{
    add_turn(p, p->which == 0 ? 1 : -1, 0);
}

static void turn_by_arrow(struct press *p)
{
    int right, up;
    direction(p->event, &right, &up);
    add_turn(p, right, up);
}

static void change_zoom(struct press *p)
{
    zoom(p->facts->zoom, p->which == 0, p->line);
}

/* To the right wider, up brighter. */
static void change_window(struct press *p)
{
    int right, up;
    const int far = direction(p->event, &right, &up) ? JUMP : 1;
    const double *window = p->facts->window, width = window[1] - window[0];
    const double step = magnitude(width) / 50 > 0.001 ? width / 50 : 0.001;
    buf_add_text(p->line, "window ");
    add_decimal(p->line, window[0] - step * (right + up) * far);
    buf_add_char(p->line, ' ');
    add_decimal(p->line, window[1] + step * (right - up) * far);
    buf_add_char(p->line, '\n');
}

/* ---- a pixel of the rendition ---- */

static void begin_picking(struct press *p)
{
    p->state->pixel[0] = p->facts->frame_width / 2;
    p->state->pixel[1] = p->facts->frame_height / 2;
}

static void move_pixel(struct press *p)
{
    int right, up;
    const int64_t step = direction(p->event, &right, &up) ? PIXEL_JUMP : times(p);
    uint32_t *pixel = p->state->pixel;
    pixel[0] = shifted(pixel[0], right * step, p->facts->frame_width);
    pixel[1] = shifted(pixel[1], -up * step, p->facts->frame_height);
}

static void go_to_pixel(struct press *p)
{
    const uint32_t *pixel = p->state->pixel;
    uint32_t place[3];
    if (p->host->voxel_of_frame(p->host->context, pixel[0], pixel[1], place))
        go_to(p->state, p->facts, place, p->line);
    else
        buf_add_text(p->message, "no object is seen at that pixel");
}

/* ---- the table ---- */

#define IN(mode)   (1u << (mode))
#define MOVING     IN(PILOT_MOVING)
#define CONFIRMING IN(PILOT_CONFIRMING)
#define WINDOWING  IN(PILOT_WINDOWING)
#define PICKING    IN(PILOT_PICKING)

/* Keys are parted by blanks: a character, a name, "arrows", "0-9", "any", with Ctrl- or Shift-. The
 * first row that fits is taken. Those of `also` do the same and are not shown. Without keys a row
 * begins another part of the page. */
static const struct row {
    const char *keys, *also;
    unsigned in;         /* these modes */
    const char *command; /* what it does: this line, with the cross-hair's place for '@', */
    void (*act)(struct press *);
    enum pilot_deed deed; /* this, or that */
    enum pilot_mode then; /* the mode afterwards; PILOT_MOVING where none is named */
    bool is_silent;       /* what the line does is seen below the picture anyway */
    const char *help;     /* on the page of keys, NULL for not there */
    const char *hint;     /* below the picture as long as one of its modes lasts, or NULL */
} table[] = {
    {"arrows h j k l", .in = MOVING, .act = move_in_plane, .help = "move the cross-hair"},
    {"Ctrl-arrows H L", .in = MOVING, .act = move_in_plane, .help = "by ten voxels"},
    {"J K Page-keys", .in = MOVING, .act = change_slice, .help = "the slice"},
    {"#", .help = "a count: #25l"},
    {"Tab", .in = MOVING, .act = next_pane, .help = "the next slice's plane"},
    {"mouse", .help = "a click: there"},
    {.keys = ""},
    {"0-9", .in = MOVING, .act = plant_label, .help = "a seed of that label", .hint = "0-9 seed"},
    {"s", .in = MOVING, .act = plant, .help = "of the chosen label"},
    {"n N", .in = MOVING, .act = choose_label, .help = "choose the label"},
    {"+ -", .also = "= _", .in = MOVING, .act = change_radius, .help = "the brush's radius"},
    {"v", .in = MOVING, .act = lower_pen, .help = "pen down: moving draws"},
    {"m", .in = MOVING, .act = mark_end, .help = "one end of a stroke"},
    {"x", .in = MOVING, .act = show_tree, .help = "x x eliminates a tree", .hint = "x eliminate"},
    {"Escape", .in = MOVING, .act = drop_stroke, .help = "no pen, no stroke"},
    {"space", .in = MOVING, .command = "run\n", .help = "run what waits"},
    {"u", .in = MOVING, .act = undo, .help = "undo", .hint = "u undo"},
    {"Ctrl-R", .in = MOVING, .command = "redo\n", .help = "redo"},
    {.keys = ""},
    {"r R", .in = MOVING, .act = turn, .help = "turn the view"},
    {"Shift-arrows", .in = MOVING, .act = turn_by_arrow, .help = "to any side"},
    {"z Z", .in = MOVING, .act = change_zoom, .help = "nearer, farther"},
    {"w", .in = MOVING, .then = PILOT_WINDOWING, .help = "the window of greys"},
    {"p", .in = MOVING, .act = begin_picking, .then = PILOT_PICKING,
     .help = "pick in the rendition"},
    {":", .in = MOVING, .deed = PILOT_PROMPT, .help = "a command", .hint = ": command"},
    {"?", .in = MOVING, .then = PILOT_HELPING, .help = "these keys", .hint = "? keys"},
    {"Ctrl-L", .in = MOVING, .deed = PILOT_REDRAW, .help = "draw anew"},
    {"Ctrl-Z", .in = MOVING, .deed = PILOT_SUSPEND, .help = "stop, as a job"},
    {"q", .also = "Ctrl-D", .in = MOVING, .deed = PILOT_LEAVE, .help = "back to the prompt",
     .hint = "q back"},

    {"x Enter", .in = CONFIRMING, .command = "remove @\n",
     .hint = "x or Enter eliminates the hatched tree"},
    {"Escape", .in = CONFIRMING, .hint = "Escape keeps it"},
    {"any", .in = CONFIRMING, .act = dispatch},

    {"arrows h j k l", .also = "H L Ctrl-arrows Shift-arrows", .in = WINDOWING,
     .act = change_window, .then = PILOT_WINDOWING, .is_silent = true,
     .hint = "left right width  up down brightness"},
    {"a", .in = WINDOWING, .command = "window auto\n", .is_silent = true, .hint = "a auto"},
    {"any", .in = WINDOWING, .hint = "Enter done"},

    {"arrows h j k l", .also = "H L Ctrl-arrows Shift-arrows", .in = PICKING, .act = move_pixel,
     .then = PILOT_PICKING, .hint = "arrows move it"},
    {"Enter", .in = PICKING, .act = go_to_pixel, .hint = "Enter goes to its voxel"},
    {"any", .in = PICKING | IN(PILOT_HELPING)},
};
enum { ROWS = sizeof table / sizeof table[0] };

/* ---- finding the row ---- */

static bool is_word(const char *word, size_t length, const char *name)
{
    return strlen(name) == length && memcmp(word, name, length) == 0;
}

static bool is_arrow(enum key key)
{
    return key == KEY_UP || key == KEY_DOWN || key == KEY_RIGHT || key == KEY_LEFT;
}

/* Takes "Ctrl-" or "Shift-" off a word. */
static unsigned take_modifier(const char **word, size_t *length)
{
    const bool control = *length > 5 && memcmp(*word, "Ctrl-", 5) == 0;
    const bool shift = *length > 6 && memcmp(*word, "Shift-", 6) == 0;
    const size_t taken = control ? 5 : shift ? 6 : 0;
    *word += taken;
    *length -= taken;
    return control ? KEY_CONTROL : shift ? KEY_SHIFT : 0;
}

static bool fits_arrow(unsigned modifier, const struct key_event *event)
{
    const unsigned pressed = event->modifiers & (KEY_SHIFT | KEY_CONTROL);
    return is_arrow(event->key) &&
           (modifier == KEY_SHIFT ? pressed & KEY_SHIFT : pressed == modifier);
}

/* Shift is a part of the character. */
static bool fits_character(const char *word, size_t length, unsigned modifier,
                           const struct key_event *event)
{
    const uint32_t point = event->point;
    if (event->key != KEY_CHARACTER || (event->modifiers & KEY_CONTROL) != modifier)
        return false;
    if (is_word(word, length, "0-9"))
        return point >= '0' && point <= '9';
    if (is_word(word, length, "space"))
        return point == ' ';
    return length == 1 && point == (uint32_t)(modifier ? *word | 32 : *word);
}

static bool fits_word(const char *word, size_t length, const struct key_event *event)
{
    static const struct {
        enum key key;
        const char *name;
    } named[] = {{KEY_TAB, "Tab"},
                 {KEY_ENTER, "Enter"},
                 {KEY_ESCAPE, "Escape"},
                 {KEY_PAGE_UP, "Page-keys"},
                 {KEY_PAGE_DOWN, "Page-keys"}};
    for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
        if (event->key == named[i].key && is_word(word, length, named[i].name))
            return true;
    if (is_word(word, length, "any"))
        return true;
    const unsigned modifier = take_modifier(&word, &length);
    if (is_word(word, length, "arrows"))
        return fits_arrow(modifier, event);
    return fits_character(word, length, modifier, event);
}

/* Whether one of the words fits; counts them in *which up to that. */
static bool fits_any(const char *words, const struct key_event *event, unsigned *which)
{
    for (const char *at = words; at && *at; ++*which) {
        const size_t length = strcspn(at, " ");
        if (fits_word(at, length, event))
            return true;
        at += length + (at[length] == ' ');
    }
    return false;
}

static void add_command(struct press *p, const char *command)
{
    const size_t place = strcspn(command, "@");
    buf_add(p->line, command, place);
    if (command[place])
        add_place(p->line, "", p->facts->place);
    buf_add_text(p->line, command + place + (command[place] != '\0'));
}

static void dispatch(struct press *p)
{
    for (const struct row *row = table; row < table + ROWS; row++) {
        p->which = 0;
        if (!(row->in & IN(p->state->mode)) || (!fits_any(row->keys, p->event, &p->which) &&
                                                !fits_any(row->also, p->event, &p->which)))
            continue;
        p->deed = row->deed;
        p->state->mode = row->then;
        p->state->is_silent = row->is_silent;
        if (row->command)
            add_command(p, row->command);
        if (row->act)
            row->act(p);
        return;
    }
    if (p->event->key == KEY_CHARACTER && !(p->event->modifiers & KEY_CONTROL))
        buf_add_text(p->message, "this key does nothing; ? shows the keys");
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
    struct press press = {state, event, host, facts, line, message, 0, PILOT_NOTHING};
    state->is_silent = false;
    if (count_on(state, event, message))
        return PILOT_NOTHING;
    state->counts = false;
    dispatch(&press);
    state->count = 0;
    return press.deed;
}

/* ---- what the keys do ---- */

void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out)
{
    const enum pilot_mode mode = state->mode == PILOT_HELPING ? PILOT_MOVING : state->mode;
    const char *gap = "";
    if (mode == PILOT_WINDOWING) {
        buf_add_text(out, "window ");
        add_decimal(out, facts->window[0]);
        buf_add_char(out, ' ');
        add_decimal(out, facts->window[1]);
        gap = "  ";
    } else if (mode == PILOT_PICKING) {
        buf_printf(out, "pixel %u,%u of the rendition", state->pixel[0], state->pixel[1]);
        gap = "  ";
    }
    for (size_t i = 0; i < ROWS; i++) {
        if (!table[i].hint || !(table[i].in & IN(mode)))
            continue;
        buf_printf(out, "%s%s", gap, table[i].hint);
        gap = "  ";
    }
}

/* Two rows of the table on a line; an empty one between parts. */
void pilot_keys_page(struct buf *out)
{
    const struct row *left = NULL;
    for (const struct row *row = table; row < table + ROWS; row++) {
        const bool ends_part = !*row->keys;
        if (left && row->help)
            buf_printf(out, "%*s%-15s %s", 24 - (int)strlen(left->help), "", row->keys, row->help);
        if (left && (row->help || ends_part))
            buf_add_char(out, '\n');
        if (!left && row->help)
            buf_printf(out, "  %-16s %s", row->keys, row->help);
        if (ends_part)
            buf_add_char(out, '\n');
        if (row->help || ends_part)
            left = left || ends_part ? NULL : row;
    }
    if (left)
        buf_add_char(out, '\n');
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
    state->is_silent = false;
    if (mouse->action == MOUSE_WHEEL_UP || mouse->action == MOUSE_WHEEL_DOWN) {
        const bool up = mouse->action == MOUSE_WHEEL_UP;
        int64_t by[3] = {0, 0, 0};
        if (pane == PILOT_RENDITION) {
            zoom(facts->zoom, up, line);
            return;
        }
        by[pane] = up ? 1 : -1;
        host->move(host->context, by, place);
        if (state->mode == PILOT_CONFIRMING) { /* the tree shown is not under it any more */
            state->mode = PILOT_MOVING;
            buf_clear(message);
        }
        add_cross(state, facts, place, line);
    } else if (mouse->button == MOUSE_LEFT && mouse->action == MOUSE_PRESSED) {
        if (!shows) {
            buf_clear(message);
            buf_add_text(message, "nothing is seen there");
            return;
        }
        state->mode = PILOT_MOVING;
        state->drags = true;
        if (pane != PILOT_RENDITION)
            state->pane = pane;
        add_cross(state, facts, place, line);
    } else if (state->drags && shows && pane == state->pane) {
        go_to(state, facts, place, line);
    }
}
