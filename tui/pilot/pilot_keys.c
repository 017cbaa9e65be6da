/* SPDX-License-Identifier: MIT */
#include "tui/pilot/pilot_keys.h"

#include <string.h>

#include "base/mem.h"
#include "base/scan.h"

void pilot_state_init(struct pilot_state *state, const struct pilot_setup *setup)
{
    *state = (struct pilot_state){.setup = setup, .pane = PILOT_AXIAL, .brush = setup->brush};
}

void pilot_fit_label(struct pilot_state *state, const struct pilot_host *host,
                     const struct pilot_facts *facts)
{
    uint32_t place[3], label = 0;
    if (facts->has_pieces && facts->has_object && !state->had_object) {
        do
            host->next_label(host->context, label, 1, &label);
        while (label && !host->seed(host->context, label, 1, place));
        label = facts->has_label && facts->label ? facts->label : label;
        state->brush.label = label ? label : state->brush.label;
    }
    state->had_object = facts->has_object;
    host->next_label(host->context, state->brush.label, 0, &state->brush.label);
}

void pilot_fit_brush(struct pilot_state *state, uint32_t side)
{
    const uint32_t most = side < 20 ? 1 : side / 10;
    struct pilot_brush *brush = &state->brush;
    brush->radius = brush->fits && brush->radius > most ? most : brush->radius;
    brush->fits = false;
}

void pilot_state_enter(struct pilot_state *state)
{
    pilot_end_outline(state);
    state->pen.is_down = state->stroke.is_set = state->drags = false;
    state->pen.line.count = 0;
    state->doubt = state->count = state->leader = 0;
}

void pilot_state_release(struct pilot_state *state)
{
    polyline_release(&state->pen.line);
    polyline_release(&state->outline);
    polyline_release(&state->hold.line);
    polyline_release(&state->shape.outline);
}

/* ---- finding the row ---- */

/* Return true if one of the words is the event after that leader; with NULL, any key after it. */
static bool fits_any(const char *words, uint32_t leader, const struct key_event *event)
{
    struct chord chord;
    while (words && chord_next(&words, &chord))
        if (event ? chord_fits(&chord, leader, event) : chord.leader == leader)
            return true;
    return false;
}

/* Find the row by the user's keys (`own`), or by those of the table that the user's do not
 * replace. */
static const struct pilot_row *find_among(const struct pilot_state *state,
                                          const struct key_event *event, bool own)
{
    const struct pilot_setup *setup = state->setup;
    for (const struct pilot_row *row = setup->table; row < setup->table + setup->rows; row++) {
        if (!row->name || !(row->in & PILOT_IN(state->mode)))
            continue;
        const char *words = setup_own(setup, row);
        if (own ? fits_any(words, state->leader, event)
                : (!words && fits_any(row->keys, state->leader, event)) ||
                      fits_any(row->also, state->leader, event))
            return row;
    }
    return NULL;
}

const struct pilot_row *pilot_row_of(const struct pilot_state *state, const struct key_event *event)
{
    const struct pilot_row *row = find_among(state, event, true);
    return row ? row : find_among(state, event, false);
}

bool pilot_moves(const struct pilot_state *state, const struct key_event *event)
{
    const struct pilot_row *row = pilot_row_of(state, event);
    const bool counts = event->key == KEY_CHARACTER && event->point >= '0' && event->point <= '9';
    return row ? row->flags & PILOT_ONLY_MOVES : counts && !event->modifiers;
}

bool pilot_only_moves(const struct pilot_state *state, const struct key_event *event)
{
    return !state->pen.is_down && !pilot_outlines(state->base) && pilot_moves(state, event);
}

/* ---- a key that waits for a second one ---- */

/* Add the keys after the leader: "gg first-slice  gc centre"; return true if there are any. */
static bool add_keys_after(const struct pilot_state *state, uint32_t leader, struct buf *message)
{
    const char *gap = "";
    OWNED(buf_release) struct buf keys = {0};
    const struct pilot_setup *setup = state->setup;
    for (const struct pilot_row *row = setup->table; row < setup->table + setup->rows; row++) {
        buf_clear(&keys);
        if (row->name && row->in & PILOT_IN(state->mode))
            setup_add_keys(&keys, setup, row, SIZE_MAX);
        if (!fits_any(buf_text(&keys), leader, NULL))
            continue;
        buf_printf(message, "%s%s %s", gap, buf_text(&keys), row->name);
        gap = "  ";
    }
    message->failed |= keys.failed;
    return *gap;
}

/* ---- effects ---- */

/* Run the row of a key, and store its change if it has become a command. */
static void carry_out(struct press *p, const struct pilot_row *row)
{
    const size_t before = p->line->length;
    p->by = row->by;
    p->request = row->request;
    p->state->is_silent = row->flags & PILOT_IS_SILENT;
    p->state->says_all = row->flags & PILOT_SAYS_ALL;
    p->state->has_pages = row->flags & PILOT_HAS_PAGES;
    if (!(row->flags & PILOT_STAYS))
        p->state->mode = row->then ? row->then : p->state->base;
    if (row->command) {
        const size_t place = strcspn(row->command, "@");
        buf_add(p->line, row->command, place);
        if (row->command[place])
            buf_printf(p->line, PLACE, XYZ(p->facts->place));
        buf_add_text(p->line, row->command + place + (row->command[place] != '\0'));
    }
    if (row->act)
        row->act(p);
    if (row->flags & PILOT_CHANGES && p->line->length > before)
        p->state->change = (struct pilot_change){row, *p->event, p->state->count};
}

void pilot_repeat(struct press *p)
{
    const struct pilot_change change = p->state->change;
    struct press again = *p;
    if (!change.row) {
        buf_add_text(p->message, "there is no change to repeat yet");
        return;
    }
    again.event = &change.key;
    p->state->count = change.count;
    if (change.row->flags & PILOT_OUTLINES && !(pilot_may_plant(p, false) && pilot_move_shape(p)))
        return;
    carry_out(&again, change.row);
}

/* ---- counts ---- */

/* Return true if the key is a digit of a count. */
static bool take_count_digit(struct press *p)
{
    struct pilot_state *state = p->state;
    const struct key_event *event = p->event;
    const bool is_digit = event->key == KEY_CHARACTER && !event->modifiers && !state->leader &&
                          event->point >= '0' && event->point <= '9';
    if (!is_digit || find_among(state, event, true) ||
        (state->mode != pilot_home(state) && !pilot_outlines(state->mode)))
        return false;
    if (state->count == 0 && event->point == '0') {
        pilot_say(p, "a count begins with 1-9; {plant-label:0} plants a seed of label 0");
        return true;
    }
    const uint64_t next = (uint64_t)state->count * 10 + (event->point - '0');
    state->count = next < UINT32_MAX ? (uint32_t)next : UINT32_MAX;
    buf_printf(p->message, "%u", state->count);
    return true;
}

/* Return true if another key must follow. */
static bool take_first_key(struct press *p)
{
    struct pilot_state *state = p->state;
    const struct key_event *event = p->event;
    if (state->leader || event->key != KEY_CHARACTER || event->modifiers ||
        find_among(state, event, true) || !add_keys_after(state, event->point, p->message))
        return false;
    buf_add_text(p->message, "  Escape leaves");
    state->leader = event->point;
    return true;
}

/* ---- strokes ---- */

/* Return true if the pen is down and draws with the brush of its stroke. */
static bool has_same_brush(const struct pilot_state *state)
{
    const struct pilot_brush *a = &state->pen.brush, *b = &state->brush;
    const bool in_same = a->has_range == b->has_range &&
                         (!a->has_range || (a->range_channel == b->range_channel &&
                                            memcmp(a->range, b->range, sizeof a->range) == 0));
    return state->pen.is_down && a->label == b->label && a->radius == b->radius &&
           a->in_mm == b->in_mm && in_same && a->growth == b->growth && a->limit == b->limit &&
           (!a->limit || a->limit_label == b->limit_label);
}

/* Turn the present stroke into a command before the other lines, unless they continue it. */
static void end_stroke(struct press *p)
{
    struct pilot_state *state = p->state;
    struct buf *line = p->line;
    if (state->sketches)
        return;
    if (state->pen.line.count > 1) {
        OWNED(buf_release) struct buf rest = {0};
        buf_add(&rest, buf_text(line), line->length);
        buf_clear(line);
        pilot_add_stroke(p);
        buf_add(line, buf_text(&rest), rest.length);
        line->failed |= rest.failed;
    }
    state->pen.line.count = 0;
}

/* Warn at the first exact gesture among objects that were grown, in place of its answer. */
static void warn_of_grown(struct press *p)
{
    if (!p->state->has_exact || p->state->sketches || !p->facts->is_grown)
        return;
    buf_clear(p->message);
    pilot_say(p, "objects here were grown, and voxels beyond can change too; {undo}, then "
                 "{freeze} keeps all labels as they are");
    p->state->is_silent = true;
}

/* Return true if the mode has keys that begin with this one. */
static bool is_first_key(const struct pilot_state *state, const struct key_event *event)
{
    OWNED(buf_release) struct buf keys = {0};
    return event->key == KEY_CHARACTER && !event->modifiers &&
           add_keys_after(state, event->point, &keys);
}

enum pilot_request pilot_press(struct press *p)
{
    struct pilot_state *state = p->state;
    state->is_silent = state->says_all = state->sketches = state->drops = state->has_exact = false;
    if (state->mode != state->base && !pilot_row_of(state, p->event) &&
        !is_first_key(state, p->event))
        state->mode = state->base; /* a key of another mode has its usual effect */
    if ((state->count || state->leader) && p->event->key == KEY_ESCAPE) {
        state->count = state->leader = 0;
        return PILOT_NOTHING;
    }
    if (take_count_digit(p) || take_first_key(p))
        return PILOT_NOTHING;
    const struct pilot_row *row = pilot_row_of(state, p->event);
    if (row && state->count && !(row->flags & PILOT_COUNTS)) {
        setup_add_keys(p->message, state->setup, row, 1);
        buf_add_text(p->message, " accepts no count; nothing was done");
    } else if (row) {
        carry_out(p, row);
    } else if (p->event->key != KEY_OTHER) {
        const bool is_ctrl_c = p->event->modifiers == KEY_CONTROL && p->event->point == 'c';
        pilot_say(p, is_ctrl_c ? "{leave} leaves"
                               : "this key does nothing here; {keys} shows the keys");
    }
    state->count = state->leader = 0;
    if (p->request == PILOT_PROMPT || p->request == PILOT_LEAVE || p->line->length ||
        !has_same_brush(state))
        end_stroke(p);
    warn_of_grown(p);
    return p->request;
}

/* ---- the mouse ---- */

/* By 1 for up, -1 for down. */
static void turn_wheel(struct press *p, enum pilot_pane pane)
{
    struct pilot_state *state = p->state;
    int64_t by[3] = {0, 0, 0};
    uint32_t place[3];
    if (pane == PILOT_RENDITION) {
        pilot_change_zoom(p);
        return;
    }
    if (p->event->modifiers & KEY_CONTROL) {
        pilot_magnify_by(p, p->by);
        return;
    }
    by[pane] = p->by;
    p->host->move(p->host->context, by, place);
    if (pilot_confirms(state->mode)) { /* the question was about another voxel */
        state->mode = state->base;
        buf_clear(p->message);
    }
    pilot_cross(p, place);
}

static void drop_ball(struct pilot_state *state)
{
    state->encloses = false;
    state->outline.count = 0;
}

/* The right button is pressed at the centre of a ball and released on its surface. The cross-hair
 * moves along. */
static void enclose(struct press *p, const uint32_t place[3], enum pilot_pane pane)
{
    struct pilot_state *state = p->state;
    struct pilot_facts there = *p->facts;
    struct press end = *p;
    const enum mouse_action action = p->event->mouse.action;
    const struct polyline *outline = &state->outline;
    if (action == MOUSE_PRESSED) {
        state->mode = state->base = pilot_home(state);
        state->pane = pane;
        state->outline.count = 0;
        state->encloses = polyline_add(&state->outline, place);
    }
    if (!state->encloses)
        return;
    if (action != MOUSE_RELEASED) {
        pilot_cross(p, place);
        return;
    }
    memcpy(there.place, place, sizeof there.place);
    end.facts = &there;
    if (memcmp(outline->corner[0], place, sizeof there.place) != 0)
        pilot_plant_shell(&end);
    drop_ball(state);
}

/* Effects of the mouse, except the end of a stroke. */
static void click(struct press *p, uint32_t column, uint32_t row)
{
    struct pilot_state *state = p->state;
    const struct mouse *mouse = &p->event->mouse;
    uint32_t place[3];
    enum pilot_pane pane;
    const bool shows = p->host->voxel_at(p->host->context, column, row, place, &pane);
    const bool outlines = pilot_outlines(state->base);
    const bool pulls =
        mouse->button == MOUSE_RIGHT && shows && pane != PILOT_RENDITION && !outlines;
    state->drags &= mouse->action == MOUSE_MOVED || outlines;
    if (state->encloses && !pulls &&
        (mouse->button != MOUSE_RIGHT || mouse->action == MOUSE_RELEASED))
        drop_ball(state);
    state->is_silent = state->says_all = state->sketches = state->drops = state->has_exact = false;
    if (state->mode == PILOT_PICKING && pane == PILOT_RENDITION && mouse->button == MOUSE_LEFT &&
        mouse->action != MOUSE_RELEASED) {
        p->host->frame_pixel(p->host->context, column, row, state->pixel);
        return;
    }
    if (mouse->action == MOUSE_WHEEL_UP || mouse->action == MOUSE_WHEEL_DOWN) {
        p->by = mouse->action == MOUSE_WHEEL_UP ? 1 : -1;
        turn_wheel(p, pane);
    } else if (outlines && (mouse->action == MOUSE_RELEASED ||
                            (mouse->button == MOUSE_LEFT && shows && pane < PILOT_RENDITION))) {
        pilot_outline_click(p, place, pane);
    } else if (mouse->button == MOUSE_LEFT && mouse->action == MOUSE_PRESSED) {
        if (!shows) {
            buf_clear(p->message);
            buf_add_text(p->message, "that pixel shows nothing");
            return;
        }
        state->mode = state->base = outlines ? state->base : pilot_home(state);
        state->drags = !state->watches && !outlines;
        if (pane != PILOT_RENDITION)
            state->pane = pane;
        pilot_cross(p, place);
    } else if (pulls) {
        enclose(p, place, pane);
    } else if (state->drags && shows && pane == state->pane) {
        pilot_go_to(p, place);
    }
}

void pilot_click(struct press *p, uint32_t column, uint32_t row)
{
    click(p, column, row);
    if (p->line->length || p->event->mouse.action != MOUSE_MOVED)
        end_stroke(p);
    warn_of_grown(p);
}

/* ---- keys typed ahead ---- */

bool typed_ahead_has_room(const struct typed_ahead *ahead)
{
    const size_t count = ahead->count;
    return count == 0 || (count < TYPED_AHEAD_MOST && ahead->event[count - 1].key != KEY_PASTE_END);
}

void typed_ahead_add(struct typed_ahead *ahead, const struct key_event *event)
{
    if (ahead->count < TYPED_AHEAD_MOST)
        ahead->event[ahead->count++] = *event;
}

bool typed_ahead_take(struct typed_ahead *ahead, struct key_event *event)
{
    if (ahead->taken == ahead->count)
        return false;
    *event = ahead->event[ahead->taken++];
    if (ahead->taken == ahead->count)
        ahead->taken = ahead->count = 0;
    return true;
}

void typed_ahead_put_back(struct typed_ahead *ahead, const struct key_event *event)
{
    if (ahead->taken > 0)
        ahead->event[--ahead->taken] = *event;
    else
        typed_ahead_add(ahead, event);
}

/* Return true if the line is "cross X,Y,Z" alone, or empty. */
static bool only_moves(const struct buf *line, uint32_t place[3], bool *moves)
{
    const char *at = buf_text(line);
    *moves = scan_text(&at, "cross ");
    for (int a = 0; *moves && a < 3; a++) {
        int64_t n;
        if ((a > 0 && !scan_text(&at, ",")) || !scan_integer(&at, 0, UINT32_MAX, &n))
            return false;
        place[a] = (uint32_t)n;
    }
    return *at == '\0' || (*moves && at[0] == '\n' && at[1] == '\0');
}

void typed_ahead_show(const struct typed_ahead *ahead, struct pilot_state *state,
                      const struct pilot_host *host)
{
    OWNED(buf_release) struct buf line = {0}, message = {0};
    for (size_t i = ahead->taken; i < ahead->count; i++) {
        const struct key_event *event = ahead->event + i;
        struct pilot_state next = *state;
        struct pilot_facts facts;
        struct press press = {&next, event, host, &facts, &line, &message, 0, PILOT_NOTHING};
        uint32_t place[3];
        bool moves;
        buf_clear(&line);
        if (event->key == KEY_MOUSE || !pilot_only_moves(&next, event) ||
            !host->facts(host->context, &facts) || pilot_press(&press) != PILOT_NOTHING ||
            next.mode != state->mode || !only_moves(&line, place, &moves))
            break;
        *state = next;
        if (moves)
            host->preview_cross(host->context, place);
    }
}
