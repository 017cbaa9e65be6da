/* SPDX-License-Identifier: MIT */
#include "tui/pilot/pilot.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "tui/cells.h"
#include "tui/keys.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"
#include "tui/pilot/flow.h"
#include "tui/prompt/pager.h"
#include "tui/term.h"

/* The smallest screen. */
enum { COLUMNS_LEAST = 20, ROWS_LEAST = 10, ROWS_OF_TEXT = 2, PASTE_MOST = 4096 };

/* On a line that carries fewer bytes a second than this, bytes cost more than the time to compress
 * them. */
enum { SLOW_BYTES = 10000, AHEAD_DUE = 2 };
#define SLOW_NS       UINT64_C(8000000)
#define STILL_SLOW_NS UINT64_C(5000000)

#define ENTER_SCREEN  "\033[?1049h\033[?25l" TERM_PROMPT_BEGINS
#define LEAVE_SCREEN  TERM_PROMPT_ENDS "\033[?25h\033[?1049l"
#define MOUSE_ON      "\033[?1002h\033[?1006h"
#define MOUSE_OFF     "\033[?1006l\033[?1002l"
#define PIXELS_ON     "\033[?1016h"
#define PIXELS_OFF    "\033[?1016l"

/* Sequences by the unit of mouse reports: none, cells, pixels. */
static const struct {
    const char *enter, *leave;
} screen_of[] = {{ENTER_SCREEN, LEAVE_SCREEN},
                 {ENTER_SCREEN MOUSE_ON, MOUSE_OFF LEAVE_SCREEN},
                 {ENTER_SCREEN MOUSE_ON PIXELS_ON, PIXELS_OFF MOUSE_OFF LEAVE_SCREEN}};

/* Pixels of an unsteady hand: moving the mouse by fewer drags nothing. */
enum { SHAKES_MOST = 4 };

/* Output between these appears at once. If a read of kitty 0.26 .. 0.32 ends within the first
 * sequence after FRAME_BEGINS, kitty drops that sequence, a patch of the picture for example: so a
 * single byte follows, which cannot be cut in two. */
#define FRAME_BEGINS "\033[?2026h\r"
#define FRAME_ENDS   "\033[?2026l"

struct pilot {
    const struct pilot_host *host;
    struct terminal_facts *facts;
    struct line_editor *editor; /* shares input and keys with the prompt */
    struct pilot_state *state;
    int told; /* index of the present sequences in screen_of; -1: none */
    struct painter painter;
    struct buf message;     /* about the last key or command; removed by the next */
    bool is_stale;          /* the screen does not show the present state, */
    bool is_hasty;          /* or shows a hastily drawn picture of it */
    struct pace pace;       /* intervals of keys */
    struct image_view view; /* the picture of the present state, if drawn, */
    bool is_drawn;          /* while the line was busy; cleared when a frame is sent */
    struct refine refine;
    struct flow flow;
    bool is_resized;
    bool is_paging;     /* a page is shown: nothing is drawn until a key is pressed */
    bool is_blank;      /* the screen is blank */
    bool stores_slices; /* the line is so slow that slices are stored in the terminal */
    struct ahead sent;  /* slices that were sent ahead */
    struct mouse held;  /* place where the mouse button was pressed, */
    bool is_still;      /* and whether the mouse has not moved since */
    bool is_pasting;
    struct buf pasted; /* text of the present or last paste */
    bool is_over, has_ended;

    enum pilot_labels shows; /* labels in the last frame */
    bool finish_failed;      /* finishing labels failed, and nothing has changed since */

    /* Keys typed during a command, or while labels are finished. */
    struct typed_ahead ahead;
    size_t ahead_shown; /* number of them that are shown */
    /* time of the next read and of the next drawing; of the last request to draw */
    uint64_t reads_ns, shows_ns, wanted_ns;
    bool is_showing;
    bool has_progress; /* a command has the last row */
};

static bool read_keys_ahead(struct pilot *p, uint64_t now_ns);
static bool has_partial_key(const struct pilot *p);

static void say_error(struct pilot *p, const struct fault *why)
{
    buf_clear(&p->message);
    buf_printf(&p->message, "error: %s", why->text);
}

/* ---- text ---- */

/* A row of text in these colours, CSI .. m, cut to the screen, without a line feed. */
static void add_row(struct buf *out, unsigned row, unsigned columns, const char *text,
                    const char *colours)
{
    OWNED(buf_release) struct buf cut = {0};
    cells_crop(&cut, text, columns);
    buf_printf(out, "\033[%u;1H\033[m%s\033[K", row + 1, colours);
    buf_add(out, buf_text(&cut), strcspn(buf_text(&cut), "\r\n"));
    buf_add_text(out, *colours ? "\033[m" : "");
    out->failed |= cut.failed;
}

static const struct theme *theme_of(const struct pilot *p)
{
    return theme_for(p->state->setup->theme, p->facts->is_light);
}

static bool has_status(const struct pilot *p)
{
    return !p->host->caption || p->host->keeps_status;
}

static unsigned rows_of_text(const struct pilot *p)
{
    return ROWS_OF_TEXT + (p->host->caption ? PILOT_CAPTIONS - !has_status(p) : 0);
}

/* Add the captions: rows above the last one, from a host that shows steps. The last line continues
 * in free rows; other lines are cut after a word. */
static void add_captions(struct buf *out, const struct pilot *p, const struct term_size *size)
{
    static const char cut[] = " ...";
    OWNED(buf_release) struct buf lines = {0};
    p->host->caption(p->host->context, &lines);
    const char *at = buf_text(&lines);
    for (unsigned i = 0; i < PILOT_CAPTIONS; i++) {
        OWNED(buf_release) struct buf row = {0};
        const size_t length = strcspn(at, "\n");
        const bool may_continue = i + 1 < PILOT_CAPTIONS && (!at[length] || !at[length + 1]);
        size_t n = cells_fit(at, length, size->columns);
        const bool is_cut = n < length && !may_continue;
        if (is_cut)
            n = cells_fit(at, length, size->columns - strlen(cut));
        buf_add(&row, at, n);
        buf_add_text(&row, is_cut ? cut : "");
        add_row(out, size->rows - rows_of_text(p) + i, size->columns, buf_text(&row), "");
        at += is_cut ? length : n;
        at += strspn(at, " ");
        at += *at == '\n';
        lines.failed |= row.failed;
    }
    out->failed |= lines.failed;
}

/* Return true if the words about one key end before this byte. */
static bool ends_item(const char *text, size_t at)
{
    return strchr(";,", text[at]) || strncmp(text + at, "  ", 2) == 0;
}

/* The sequence before a key in a row of keys. */
static const char *bold_of(const struct pilot *p)
{
    return p->facts->colours == COLOURS_NONE ? "" : "\033[1m";
}

/* Return the cells of a text with sequences. */
static size_t shown_width(const char *text, size_t length)
{
    size_t width = 0, cells;
    for (size_t i = 0; i < length; width += cells)
        i += cells_next(text + i, length - i, &cells);
    return width;
}

/* Add the hints: whole items from the beginning as far as they fit, and always the last one, how to
 * leave. */
static void add_hint(struct buf *out, const struct pilot *p, const struct pilot_facts *facts,
                     unsigned columns)
{
    OWNED(buf_release) struct buf hint = {0};
    pilot_keys_hint(p->state, facts, bold_of(p), &hint);
    const char *text = buf_text(&hint);
    size_t last = hint.length, fits = 0;
    while (last > 0 && !ends_item(text, last - 1))
        last--;
    last += strspn(text + last, " ");
    const size_t room = 2 + shown_width(text + last, hint.length - last);
    for (size_t i = 1; i < last; i++)
        if (ends_item(text, i) && shown_width(text, i) + room <= columns)
            fits = i;
    if (shown_width(text, hint.length) <= columns)
        last = fits = 0;
    buf_add(out, text, fits);
    buf_printf(out, "%s%s", fits ? "  " : "", text + last);
    out->failed |= hint.failed;
}

/* The last two rows of the screen: pilot_add_status, and the last message or the hints. A message
 * longer than a row uses both, until the next key. */
static void add_rows(struct buf *out, const struct pilot *p, const struct pilot_facts *facts,
                     const struct term_size *size)
{
    const char *const alarm = p->facts->colours == COLOURS_NONE ? "\033[7m" : theme_of(p)->alarm;
    OWNED(buf_release) struct buf upper = {0}, lower = {0};
    if (p->is_pasting)
        buf_add_text(&lower,
                     "pasted text goes to the line of : when it is complete; Ctrl-C drops it");
    else if (p->message.length)
        cells_wrap(&lower, &p->message, size->columns);
    else
        add_hint(&lower, p, facts, size->columns);
    const char *second = strchr(buf_text(&lower), '\n');
    if (p->host->caption)
        add_captions(out, p, size);
    /* The first message of a mode is shown above its hints. */
    const bool begins = p->message.length && !second && pilot_is_passing(p->state);
    if (begins) {
        buf_add(&upper, buf_text(&lower), lower.length);
        buf_clear(&lower);
        add_hint(&lower, p, facts, size->columns);
    } else if (second)
        buf_add(&upper, buf_text(&lower), (size_t)(second - buf_text(&lower)));
    else if (has_status(p))
        pilot_add_status(&upper, p->state, p->host, facts, size->columns);
    if (second || begins || has_status(p))
        add_row(out, size->rows - 2, size->columns, buf_text(&upper),
                p->state->pen.is_down || p->state->base == PILOT_OUTLINING ? alarm : "");
    if (!p->has_progress)
        add_row(out, size->rows - 1, size->columns, second ? second + 1 : buf_text(&lower), "");
    out->failed |= upper.failed || lower.failed;
}

/* The sequence that clears the screen, except pictures. ESC[2J would make a terminal drop stored
 * slices. */
static const char *blank_of(const struct pilot *p)
{
    return p->facts->graphics->keeping ? "\033[m\033[H\033[J" : "\033[m\033[H\033[2J";
}

/* ---- the screen ---- */

static struct pilot_wish wish_of(const struct pilot *p)
{
    struct pilot_wish wish = {.words = p->facts->graphics->kind == GRAPHICS_PIXELS,
                              .marks_held = pilot_confirms(p->state->mode),
                              .marks_way = p->state->mode == PILOT_EXPLAINING,
                              .heat = p->state->heat,
                              .within_ns = p->is_stale ? p->pace.within_ns : 0,
                              .marks_pixel = p->state->mode == PILOT_PICKING,
                              .pixel = {p->state->pixel[0], p->state->pixel[1]},
                              .setup = p->state->setup,
                              .corner = (const uint32_t(*)[3])p->state->outline.corner,
                              .corners = p->state->outline.count,
                              .marks_corners = !pilot_outlines(p->state->base),
                              .marks_outline = p->state->outline.count > 1,
                              .label = p->state->brush.label,
                              .pane = p->state->mode == PILOT_PICKING ? PILOT_RENDITION
                                                                      : p->state->pane};
    painter_size(&p->painter, &wish.width, &wish.height);
    wish.is_alone = p->state->is_alone;
    wish.cell_width = wish.width / p->painter.columns;
    wish.cell_height = wish.height / p->painter.rows;
    return wish;
}

/* Return true if keys rest and a hasty picture is to be replaced by the full one. */
static bool is_due(const struct pilot *p)
{
    return p->is_hasty && clock_ns() >= p->pace.key_ns + PACE_REST_NS;
}

/* A key stops the drawing of a full rendition, and so does another state of the terminal. */
static bool stops_drawing(void *context)
{
    struct pilot *p = context;
    read_keys_ahead(p, clock_ns());
    return p->ahead.count > p->ahead.taken || has_partial_key(p) || p->is_pasting || p->is_stale;
}

/* Draw the present state; ERR_CANCELLED if that was stopped. */
static enum err draw_view(struct pilot *p)
{
    const struct pilot_onlooker onlooker = {.context = p, .stops = stops_drawing};
    const bool may_stop = !p->is_stale && !p->is_blank && !p->flow.failed && !p->is_pasting;
    struct pilot_wish wish = wish_of(p);
    struct fault why;
    wish.onlooker = may_stop ? &onlooker : NULL;
    p->reads_ns = 0;
    const enum err err = p->host->picture(p->host->context, &wish, &p->view, &why);
    const bool is_stopped = may_stop && (err == ERR_CANCELLED || p->is_stale);
    if (err || is_stopped)
        p->view = (struct image_view){0};
    if (is_stopped)
        return ERR_CANCELLED;
    if (err)
        say_error(p, &why);
    p->is_hasty = p->view.is_hasty;
    return err;
}

/* The host draws a state once, and again after a hasty picture; frames that make a picture finer
 * use the one that is there. Return false if it was stopped. */
static bool add_picture(struct pilot *p, struct buf *out)
{
    struct image_view shown;
    enum err err = OK;
    if (p->facts->graphics->kind == GRAPHICS_NOTHING)
        return true;
    if (!p->view.rgba || p->is_stale || is_due(p))
        err = draw_view(p);
    if (err)
        return err != ERR_CANCELLED;
    struct image_view view = p->view;
    /* Sixels of a first picture in blocks need three times the bytes of other protocols. */
    const bool is_large = p->flow.samples == 0 && p->facts->graphics->palette_always;
    const size_t budget = flow_budget(&p->flow) / (is_large ? 3 : 1), before = out->length;
    const uint64_t takes_ns = flow_carries_ns(&p->flow, SLOW_BYTES);
    /* A slow line counts as slow until it is much faster. */
    p->stores_slices = takes_ns > (p->stores_slices ? STILL_SLOW_NS : SLOW_NS);
    view.is_slow = p->stores_slices;
    if (p->stores_slices)
        painter_keep(&p->painter, &view, p->is_stale ? 0 : budget, out);
    const size_t kept = out->length - before; /* bytes */
    if (!refine_begin(&p->refine, &view, p->is_stale, kept < budget ? budget - kept : 1, &shown)) {
        out->failed = true;
        return true;
    }
    painter_show(&p->painter, &shown, out);
    refine_sent(&p->refine, out->length - before - kept);
    if (p->is_stale)
        ahead_begin(&p->sent);
    return true;
}

/* Return true if slices are to be sent ahead, now or later. */
static bool may_send_ahead(const struct pilot *p)
{
    return p->stores_slices && !p->state->setup->sends_none_ahead && p->facts->graphics->keeping &&
           p->host->name_ahead && !p->flow.silent && p->sent.number < AHEAD_NUMBERS &&
           ahead_pays(&p->flow);
}

static enum err send_frame(struct pilot *p, struct buf *out, struct fault *fault)
{
    const uint64_t now_ns = clock_ns();
    const size_t bytes = out->length;
    const enum err err = term_write_text(out, "a frame", fault);
    flow_sent(&p->flow, bytes, now_ns);
    return err;
}

/* Send the whole present state in one write, with a question whose answer confirms it. */
static enum err draw(struct pilot *p, struct fault *fault)
{
    const struct term_size size = term_size();
    const uint64_t begin_ns = clock_ns();
    struct buf out = {0};
    struct pilot_facts facts;
    if (!p->host->facts(p->host->context, &facts)) {
        p->is_over = true;
        return OK;
    }
    pilot_fit_label(p->state, p->host, &facts);
    if (p->flow.failed) { /* the state of the terminal is unknown */
        buf_add_text(&out, graphics_recovery(p->facts));
        painter_drop(&p->painter, &out);
        ahead_forget(&p->sent);
        p->is_blank = true;
    }
    if (p->facts->synchronizes)
        buf_add_text(&out, FRAME_BEGINS);
    if (p->is_blank) {
        painter_remove(&p->painter, &out);
        buf_add_text(&out, blank_of(p));
        refine_forget(&p->refine);
    }
    if (!add_picture(p, &out)) {
        buf_release(&out);
        return OK;
    }
    p->state->sends_ahead = p->state->sends_ahead && may_send_ahead(p);
    add_rows(&out, p, &facts, &size);
    if (p->facts->synchronizes)
        buf_add_text(&out, FRAME_ENDS);
    if (p->facts->answers)
        buf_add_text(&out, p->facts->barrier);
    p->is_stale = p->is_blank = p->is_drawn = false;
    p->shows = facts.shows;
    p->flow.drawn_ns = clock_ns() - begin_ns;
    return send_frame(p, &out, fault);
}

/* Send a frame that changes no pixel: a part of a slice that may be wanted next, while the line is
 * idle. A mark in the row of text appears with the first and is removed after the last. */
static enum err send_ahead(struct pilot *p, struct fault *fault)
{
    const struct pilot_wish wish = wish_of(p);
    const struct term_size size = term_size();
    const bool was_marked = p->state->sends_ahead;
    struct image_view *view = NULL;
    struct pilot_facts facts;
    struct buf out = {0};
    while (painter_has_room(&p->painter) && (view = ahead_next(&p->sent, p->host, &wish))) {
        view->is_slow = true;
        painter_keep(&p->painter, view, 1, &out);
        if (out.length || out.failed)
            break;
        ahead_has_gone(&p->sent);
    }
    if (!view)
        p->sent.number = AHEAD_NUMBERS;
    p->state->sends_ahead = view != NULL;
    if (p->state->sends_ahead != was_marked && p->host->facts(p->host->context, &facts))
        add_rows(&out, p, &facts, &size);
    if (out.length == 0)
        return OK;
    buf_add_text(&out, p->facts->barrier);
    return send_frame(p, &out, fault);
}

/* Place the picture, by the size of the screen. */
static void lay_out(struct pilot *p)
{
    const struct term_size size = term_size();
    probe_resize(p->facts, &size);
    painter_place(&p->painter, p->facts, 0, 0, size.columns,
                  size.rows > rows_of_text(p) + 1 ? size.rows - rows_of_text(p) : 1);
    p->is_stale = p->is_blank = true;
}

/* Use the facts about the terminal, which may have changed. */
static enum err adopt_facts(struct pilot *p, struct fault *fault)
{
    const struct terminal_facts *facts = p->facts;
    const int told = facts->mouse ? 1 + (facts->mouse_unit != MOUSE_CELLS) : 0;
    const bool is_new = told != p->told;
    p->told = told;
    p->flow.silent = !facts->answers;
    p->editor->keys.unit = facts->mouse_unit;
    p->facts->reports |= facts->mouse;
    lay_out(p);
    return is_new ? term_change_sequences(screen_of[told].enter, screen_of[told].leave, fault) : OK;
}

static enum err clear_picture(struct pilot *p, bool all_anew, struct fault *fault)
{
    struct buf out = {0};
    painter_remove(&p->painter, &out);
    if (all_anew) /* including stored slices */
        painter_drop(&p->painter, &out), ahead_forget(&p->sent);
    buf_add_text(&out, blank_of(p));
    p->is_stale = p->is_blank = true;
    return term_write_text(&out, "a blank screen", fault);
}

/* ---- commands ---- */

/* Add the last line of an answer to the message below the picture. */
static void add_last_line(struct buf *message, const char *text)
{
    size_t length = strlen(text);
    while (length > 0 && text[length - 1] == '\n')
        length--;
    size_t first = length;
    while (first > 0 && text[first - 1] != '\n')
        first--;
    const bool joins = message->length > 0 && message->data[message->length - 1] != ' ';
    buf_add_text(message, joins && length > first ? "; " : "");
    buf_add(message, text + first, length - first);
}

static void keep_last_line(struct buf *message, const char *text)
{
    buf_clear(message);
    add_last_line(message, text);
}

static bool read_key(struct pilot *p, struct key_event *event);

/* A long command is watched: its progress is drawn, in at most a quarter of the time, and the
 * cross-hair follows the keys. Its record is made at its end. */
#define SHOWN_AFTER_NS UINT64_C(250000000)
#define SHOWN_EVERY_NS UINT64_C(100000000)
#define READ_EVERY_NS  UINT64_C(10000000)

/* Send a frame after keys were carried out for this long, even if more have arrived: otherwise
 * nothing would be drawn while a pen is held whose edits take longer than the interval of its keys.
 */
#define KEYS_NS UINT64_C(30000000)

/* Keys are read ahead up to the first that does more than move the cross-hair: the text after a
 * colon is read by the line editor. Where nothing is recorded, steps are read ahead too. */
static bool takes_ahead(const struct pilot *p)
{
    const struct typed_ahead *ahead = &p->ahead;
    const struct key_event *last = ahead->count ? ahead->event + ahead->count - 1 : NULL;
    const struct pilot_row *row = last && p->state->watches ? pilot_row_of(p->state, last) : NULL;
    return typed_ahead_has_room(ahead) &&
           (!last || (p->state->watches ? !row || row->request == PILOT_NOTHING
                                        : pilot_moves(p->state, last)));
}

/* Read keys; return false if it is too early. */
static bool read_keys_ahead(struct pilot *p, uint64_t now_ns)
{
    struct key_event event;
    if (p->is_showing || now_ns < p->reads_ns)
        return false;
    p->reads_ns = now_ns + READ_EVERY_NS;
    if (takes_ahead(p))
        term_read(&p->editor->input, 0, -1);
    while (takes_ahead(p) && read_key(p, &event))
        typed_ahead_add(&p->ahead, &event);
    p->wanted_ns = now_ns;
    return true;
}

/* Return true if the last key that was read ahead leaves, and nothing is recorded: keys before it
 * do not matter. */
static bool is_left(void *context)
{
    const struct pilot *p = context;
    const struct typed_ahead *ahead = &p->ahead;
    const struct pilot_row *row = ahead->count > ahead->taken
                                      ? pilot_row_of(p->state, ahead->event + ahead->count - 1)
                                      : NULL;
    return p->state->watches && row && row->request == PILOT_LEAVE;
}

static bool wants_show(void *context)
{
    struct pilot *p = context;
    const uint64_t now_ns = clock_ns();
    return read_keys_ahead(p, now_ns) && now_ns >= p->shows_ns && flow_may_send(&p->flow, now_ns);
}

/* Move the cursor to the last row, where progress is shown and lines are typed. */
static enum err go_to_last_row(const char *then, struct fault *fault)
{
    struct buf place = {0};
    buf_printf(&place, "\033[%u;1H%s", term_size().rows, then);
    return term_write_text(&place, "a place", fault);
}

static void show_so_far(void *context)
{
    struct pilot *p = context;
    struct pilot_state *state = p->state, ahead = *state;
    p->is_showing = true;
    typed_ahead_show(&p->ahead, &ahead, p->host);
    p->state = &ahead;
    p->is_stale = true;
    draw(p, NULL);
    p->state = state;
    p->host->preview_cross(p->host->context, NULL);
    go_to_last_row("", NULL);
    p->ahead_shown = p->ahead.count;
    const uint64_t now_ns = clock_ns(), rests_ns = 3 * (now_ns - p->wanted_ns);
    p->shows_ns = now_ns + (rests_ns > SHOWN_EVERY_NS ? rests_ns : SHOWN_EVERY_NS);
    p->is_showing = false;
}

/* Carry out one line. Meanwhile the cursor is in the row of progress. */
static enum err carry_out(struct pilot *p, const char *line, struct buf *output,
                          enum err *of_command, struct fault *fault)
{
    const struct pilot_onlooker onlooker = {p, is_left, wants_show, show_so_far};
    const struct pilot_host *host = p->host;
    struct fault why = {0};
    TRY(go_to_last_row("", fault));
    TRY(term_set_mode(TERM_QUIET, fault));
    const uint64_t now_ns = clock_ns();
    p->shows_ns = now_ns + SHOWN_AFTER_NS;
    p->reads_ns = p->state->watches ? 0 : p->shows_ns;
    if (p->state->watches && read_keys_ahead(p, now_ns) && is_left(p)) {
        p->is_over = true;
        return term_set_mode(TERM_RAW, fault);
    }
    p->has_progress = true;
    host->look_on(host->context, &onlooker);
    *of_command = p->state->sketches ? host->sketch(host->context, line, &why)
                                     : host->execute(host->context, line, output, &why);
    host->look_on(host->context, NULL);
    p->has_progress = false;
    const enum err err = term_set_mode(TERM_RAW, fault);
    if (*of_command)
        say_error(p, &why);
    p->is_stale = true;
    p->finish_failed = false;
    p->is_over = host->finished(host->context) || is_left(p);
    return err;
}

static enum err show_pages(struct pilot *p, const struct buf *text, struct fault *fault);

/* Carry out the lines of a key, until one fails. */
static enum err carry_out_all(struct pilot *p, const char *lines, struct fault *fault)
{
    OWNED(buf_release) struct buf line = {0}, output = {0};
    enum err err = OK, of_command = OK;
    while (!err && !of_command && *lines) {
        const size_t n = strcspn(lines, "\n");
        buf_clear(&line);
        buf_clear(&output);
        buf_add(&line, lines, n);
        lines += n + (lines[n] == '\n');
        err = line.failed ? fault_memory(fault, "a command")
                          : carry_out(p, buf_text(&line), &output, &of_command, fault);
    }
    if (!err && !of_command && output.length && p->state->has_pages)
        err = show_pages(p, &output, fault);
    else if (!err && !of_command && output.length && !p->state->is_silent) {
        add_last_line(&p->message, p->state->says_all ? "" : buf_text(&output));
        for (const char *at = buf_text(&output); p->state->says_all && *at; at++)
            buf_add_text(&p->message, *at == '\n' ? at[1] ? "; " : "" : (char[]){*at, '\0'});
    }
    p->state->has_pages = false;
    return err;
}

/* ---- the prompt below ---- */

static void await_key(struct pilot *p, struct key_event *event);

/* Edit the text after `/`. Return false at its end: Enter keeps it, any other key discards it. */
static bool edit_filter(struct buf *wanted, const struct key_event *event)
{
    const bool is_text = event->key == KEY_CHARACTER && event->modifiers == 0;
    const bool erases = event->key == KEY_BACKSPACE && wanted->length > 0;
    if (is_text)
        buf_add(wanted, event->text, event->length);
    else if (erases)
        char_erase(wanted);
    else if (event->key != KEY_ENTER)
        buf_clear(wanted);
    return is_text || erases;
}

/* Return true for a key of the pilot, except for those that turn or leave pages. */
static bool is_described(const struct pilot *p, const struct key_event *event)
{
    OWNED(buf_release) struct buf page = {0};
    const struct pilot_keys_wish wish = {p->state->setup, p->state->watches, 0, NULL, NULL, event};
    pilot_keys_page(&page, &wish);
    return page.length > 0 && !pager_is_left_by(event) && event->key != KEY_ENTER &&
           !(event->key == KEY_CHARACTER && event->point == ' ');
}

/* Show a text by pages on the whole screen; NULL for the keys, filtered by the text after `/`, or
 * the description of one key. */
static enum err show_by_pages(struct pilot *p, const struct buf *text, struct fault *fault)
{
    OWNED(buf_release) struct buf keys = {0}, wanted = {0};
    struct key_event event = {0}, key = {0}; /* the last one, and the one that is described */
    bool stays = true, asks = false;
    size_t at = 0;
    enum err err = clear_picture(p, false, fault);
    while (!err && !p->is_over && stays) {
        const struct term_size size = term_size();
        const struct theme *theme = p->facts->colours == COLOURS_NONE ? NULL : theme_of(p);
        const struct pilot_keys_wish wish = {p->state->setup,   p->state->watches,
                                             size.columns,      theme,
                                             buf_text(&wanted), key.key ? &key : NULL};
        OWNED(buf_release) struct buf wrapped = {0}, page = {0};
        buf_clear(&keys);
        if (!text)
            pilot_keys_page(&keys, &wish);
        cells_wrap(&wrapped, text ? text : &keys, size.columns);
        const size_t end = pager_page_end(&wrapped, at, &size);
        buf_add_text(&page, blank_of(p));
        buf_add(&page, buf_text(&wrapped) + at, end - at);
        buf_printf(&page, "\033[%u;1H%s%s", size.rows,
                   asks                   ? "/"
                   : end < wrapped.length ? PAGER_MORE
                   : text                 ? "(any key)"
                                          : "a key shows its description; / finds keys by a word; "
                                            "Escape leaves",
                   asks ? buf_text(&wanted) : "");
        page.failed |= wrapped.failed || keys.failed;
        err = term_write_text(&page, "a page", fault);
        p->is_resized = false;
        if (!err)
            await_key(p, &event);
        if (p->is_resized || asks) {
            asks = asks && (p->is_resized || edit_filter(&wanted, &event));
            at = 0;
        } else if (!text && event.key == KEY_CHARACTER && event.point == '/') {
            buf_clear(&wanted);
            key.key = KEY_PENDING;
            asks = true;
            at = 0;
        } else if (!text && is_described(p, &event)) {
            key = event;
            at = 0;
        } else {
            stays = end < wrapped.length && !pager_is_left_by(&event);
            at = end;
        }
    }
    return err;
}

/* Leave the screen to another program: no picture, and no answer is due. */
static enum err leave_screen(struct pilot *p, struct fault *fault)
{
    const enum err err = clear_picture(p, true, fault);
    if (p->flow.due) /* otherwise that program would read the answers as keys */
        probe_await(p->flow.due, 2000, &p->editor->input);
    p->flow.due = 0;
    return err;
}

/* Show a long answer on the whole screen: in the user's pager, else by pages. */
static enum err show_pages(struct pilot *p, const struct buf *text, struct fault *fault)
{
    const struct term_size size = term_size();
    OWNED(buf_release) struct buf wrapped = {0};
    cells_wrap(&wrapped, text, size.columns);
    if (pager_page_end(&wrapped, 0, &size) == wrapped.length || !p->editor->pager)
        return show_by_pages(p, text, fault);
    const enum err err = leave_screen(p, fault);
    const bool is_shown = !err && pager_run(p->editor->pager, text);
    lay_out(p);
    return err || is_shown ? err : show_by_pages(p, text, fault);
}

static enum err ask_for_command(struct pilot *p, struct fault *fault)
{
    OWNED(buf_release) struct buf output = {0};
    enum err of_command = OK;
    bool ended = false;
    enum err err = go_to_last_row("\033[K\033[?25h", fault);
    p->editor->is_one_line = true;
    if (!err)
        err = line_edit(p->editor, ":", &ended, fault);
    p->editor->is_one_line = false;
    if (!err)
        err = term_write("\033[?25l", 6, fault);
    /* Long lines may have scrolled the picture, and the screen or the facts may have changed. */
    if (!err)
        err = adopt_facts(p, fault);
    const char *line = buf_text(&p->editor->line.text);
    p->is_over |= !err && strcmp(line, "q") == 0; /* as in vim */
    if (!err && !ended && !p->is_over && line[strspn(line, " \t")]) {
        err = carry_out(p, line, &output, &of_command, fault);
        const char *feed = strchr(buf_text(&output), '\n');
        if (!err && !of_command && feed && feed[1])
            err = show_pages(p, &output, fault);
        else if (!err && !of_command)
            keep_last_line(&p->message, buf_text(&output));
    }
    return err;
}

/* Pass pasted text to the line editor as a paste, before all later input. */
static enum err ask_for_pasted(struct pilot *p, struct fault *fault)
{
    struct line_editor *e = p->editor;
    struct buf input = {0};
    buf_add_text(&input, "\033[200~");
    buf_add(&input, buf_text(&p->pasted), p->pasted.length);
    buf_add_text(&input, "\033[201~");
    buf_add(&input, buf_text(&e->input) + e->taken, e->input.length - e->taken);
    buf_clear(&p->pasted);
    if (input.failed || p->pasted.failed) {
        buf_release(&input);
        return fault_memory(fault, "the pasted text");
    }
    buf_release(&e->input);
    e->input = input;
    e->taken = 0;
    return ask_for_command(p, fault);
}

/* ---- the list of labels ---- */

/* Add "> ## 12  liver  1.64 l  hidden  brush  SCT:10200004", with a box of the label's colour. */
static void add_label_row(struct buf *out, const struct pilot *p, const struct pilot_label *label,
                          bool is_chosen)
{
    const uint8_t *c = label->rgb;
    const char *name = label->number || *label->name ? label->name : "background";
    buf_add_text(out, is_chosen ? "> " : "  ");
    if (p->facts->colours == COLOURS_24BIT)
        buf_printf(out, "\033[48;2;%u;%u;%um  \033[m", c[0], c[1], c[2]);
    buf_printf(out, " %5u  %s%*s %10s%s%s  %s", label->number, name,
               32 - (int)cells_width(name, strlen(name)), "", label->volume,
               label->is_hidden ? "  hidden" : "",
               label->number == p->state->brush.label ? "  brush" : "", label->code);
}

static enum err draw_labels(struct pilot *p, const struct pilot_label *label, size_t count,
                            size_t at, struct fault *fault)
{
    const struct term_size size = term_size();
    const size_t room = size.rows - 1, first = at < room ? 0 : at + 1 - room;
    const char *bold = bold_of(p), *end = *bold ? "\033[m" : "";
    OWNED(buf_release) struct buf out = {0}, row = {0};
    buf_add_text(&out, blank_of(p));
    for (size_t i = first; i < count && i < first + room; i++) {
        buf_clear(&row);
        add_label_row(&row, p, label + i, i == at);
        add_row(&out, (unsigned)(i - first), size.columns, buf_text(&row), "");
    }
    buf_clear(&row);
    buf_printf(&row, "%sEnter%s go there  %sb%s brush  %se%s hide, show  %sr%s rename  %sq%s back",
               bold, end, bold, end, bold, end, bold, end, bold, end);
    add_row(&out, size.rows - 1, size.columns, buf_text(&row), "");
    out.failed |= row.failed;
    return term_write_text(&out, "a list of labels", fault);
}

/* Carry out a key in the list, at the label *at; add its command to `lines`. Return false for a key
 * that leaves the list. */
static bool take_label_key(struct pilot *p, const struct key_event *event,
                           const struct pilot_label *label, size_t count, size_t *at,
                           struct buf *lines)
{
    const char key = event->key == KEY_CHARACTER && !event->modifiers ? (char)event->point : '\0';
    const uint32_t number = label[*at].number;
    uint32_t place[3];
    if (event->key == KEY_UP || key == 'k')
        *at -= *at > 0;
    else if (event->key == KEY_DOWN || key == 'j')
        *at += *at + 1 < count;
    else if (key == 'b')
        p->state->brush.label = number;
    else if (key == 'e' && number)
        buf_printf(lines, "%s %u\n", label[*at].is_hidden ? "show" : "hide", number);
    else if (key == 'r')
        /* Quotes, for a name with blanks; the key after the paste moves the cursor between them. */
        buf_printf(&p->pasted, "label %u \"\"\033[201~\033[D\033[200~", number);
    else if (event->key == KEY_ENTER && p->host->centre(p->host->context, number, place))
        buf_printf(lines, "cross " PLACE "\n", XYZ(place));
    else if (event->key == KEY_ENTER)
        buf_printf(&p->message, "label %u has no voxel", number);
    return key != 'r' && event->key != KEY_ENTER && !pager_is_left_by(event);
}

static enum err show_labels(struct pilot *p, struct fault *fault)
{
    struct pilot_label label[PILOT_LABELS];
    size_t count = p->host->labels(p->host->context, label), at = 0;
    bool stays = count > 0;
    enum err err = clear_picture(p, false, fault);
    if (count == 0)
        buf_add_text(&p->message, "no label has a voxel or a name yet");
    while (at + 1 < count && label[at].number < p->state->brush.label)
        at++;
    while (!err && !p->is_over && stays) {
        struct key_event event = {0};
        OWNED(buf_release) struct buf lines = {0};
        p->is_resized = false;
        err = draw_labels(p, label, count, at, fault);
        if (!err)
            await_key(p, &event);
        if (!err && !p->is_over && !p->is_resized)
            stays = take_label_key(p, &event, label, count, &at, &lines);
        p->state->is_silent = true;
        if (!err && lines.length)
            err = carry_out_all(p, buf_text(&lines), fault);
        count = p->host->labels(p->host->context, label);
    }
    p->is_stale = p->is_blank = true;
    return err || !p->pasted.length ? err : ask_for_pasted(p, fault);
}

/* ---- keys ---- */

/* A frame has been drawn. */
static void frame_answered(void *asker)
{
    struct pilot *p = asker;
    flow_answered(&p->flow, clock_ns());
}

static enum err do_request(struct pilot *p, enum pilot_request request, struct fault *fault)
{
    if (request == PILOT_PROMPT)
        return ask_for_command(p, fault);
    if (request == PILOT_SHOW_KEYS)
        return show_by_pages(p, NULL, fault);
    if (request == PILOT_SHOW_LABELS)
        return show_labels(p, fault);
    if (request == PILOT_REDRAW) {
        const enum err err = leave_screen(p, fault);
        line_editor_probe(p->editor);
        return err ? err : adopt_facts(p, fault);
    }
    p->is_over |= request == PILOT_LEAVE;
    if (request != PILOT_SUSPEND)
        return OK;
    const enum err err = leave_screen(p, fault);
    term_suspend();
    lay_out(p);
    return err;
}

/* Find the pixel of the picture under the mouse, or under its cell. Return false outside the
 * picture. */
static bool pixel_of(struct pilot *p, const struct mouse *mouse, uint32_t *column, uint32_t *row)
{
    uint32_t width, height;
    painter_size(&p->painter, &width, &height);
    const uint32_t across = width / p->painter.columns, down = height / p->painter.rows;
    if (p->facts->mouse_unit == MOUSE_CELLS) {
        *column = mouse->column * across + across / 2;
        *row = mouse->row * down + down / 2;
    } else { /* cells of blocks have few pixels */
        if (mouse->action == MOUSE_PRESSED)
            p->held = *mouse;
        p->is_still =
            mouse->action == MOUSE_PRESSED ||
            (p->is_still && abs((int)mouse->column - (int)p->held.column) <= SHAKES_MOST &&
             abs((int)mouse->row - (int)p->held.row) <= SHAKES_MOST);
        const struct mouse *at = p->is_still ? &p->held : mouse;
        *column = at->column * across / p->facts->cell_width;
        *row = at->row * down / p->facts->cell_height;
    }
    return *column < width && *row < height;
}

static enum err take_key(struct pilot *p, const struct key_event *event, struct fault *fault)
{
    struct pilot_facts facts;
    OWNED(buf_release) struct buf lines = {0};
    struct press press = {p->state, event, p->host, &facts, &lines, &p->message, 0, PILOT_NOTHING};
    uint32_t column, row;
    if (event->key == KEY_PASTE_END && p->pasted.length)
        return ask_for_pasted(p, fault);
    if (event->key == KEY_PASTE_END || event->key == KEY_OTHER)
        return OK;
    if (!p->host->facts(p->host->context, &facts)) {
        p->is_over = true;
        return OK;
    }
    pilot_fit_label(p->state, p->host, &facts);
    pace_key(&p->pace, clock_ns());
    p->painter.kept.losses = 0;
    p->sent.rests = false;
    if (event->key != KEY_MOUSE) {
        buf_clear(&p->message);
        pilot_press(&press);
    } else if (pixel_of(p, &event->mouse, &column, &row)) {
        if (!p->view.rgba) /* a click stopped the drawing of a finer picture */
            p->is_stale = true, draw_view(p);
        pilot_click(&press, column, row);
    }
    /* The mouse may move from pixel to pixel without any change. */
    p->is_stale |= event->key != KEY_MOUSE || event->mouse.action != MOUSE_MOVED || lines.length ||
                   p->state->mode == PILOT_PICKING;
    enum err err = p->state->drops ? p->host->drop(p->host->context, fault) : OK;
    if (!err)
        err = lines.failed ? fault_memory(fault, "a command")
                           : carry_out_all(p, buf_text(&lines), fault);
    p->state->sketches = false;
    return err ? err : do_request(p, press.request, fault);
}

/* Add keys of a paste to its text (P3). Ctrl-C ends an unfinished paste, unless it is part of it,
 * followed by more input. Return true at the end of the paste. */
static bool take_pasted(struct pilot *p, struct key_event *event)
{
    const struct line_editor *e = p->editor;
    const bool control = event->modifiers & KEY_CONTROL;
    p->is_stale = true;
    if (event->key == KEY_CHARACTER && control && event->point == 'c' &&
        e->taken == e->input.length) {
        buf_clear(&p->pasted);
        event->key = KEY_PASTE_END;
    }
    if (event->key == KEY_ENTER || event->key == KEY_TAB)
        buf_add_char(&p->pasted, ' ');
    else if (event->key == KEY_CHARACTER && !control && p->pasted.length < PASTE_MOST)
        buf_add(&p->pasted, event->text, event->length);
    p->is_pasting = event->key != KEY_PASTE_END;
    return !p->is_pasting;
}

/* Return true if the event is for the pilot. Answers and pastes are handled here. */
static bool is_for_pilot(struct pilot *p, struct key_event *event)
{
    if (event->key == KEY_REPLY) {
        if (line_editor_reply(p->editor))
            p->is_resized |= adopt_facts(p, NULL) == OK;
        else if (painter_take_reply(&p->painter, p->editor->keys.body))
            ahead_forget(&p->sent), p->is_stale = true;
        if (!(event->modifiers & KEY_ALT))
            return false;
        *event =
            (struct key_event){.key = KEY_ESCAPE}; /* Escape was pressed right before the answer */
    }
    if (event->key == KEY_PASTE_BEGIN && !p->is_pasting) {
        buf_clear(&p->pasted);
        p->is_pasting = p->is_stale = true;
        return false;
    }
    return !p->is_pasting || take_pasted(p, event);
}

static bool read_key(struct pilot *p, struct key_event *event)
{
    struct line_editor *e = p->editor;
    while (e->taken < e->input.length) {
        const uint8_t byte = (uint8_t)e->input.data[e->taken++];
        if (e->taken < e->input.length) /* a bracket alone is a key */
            line_editor_rejoin_reply(e, byte);
        e->lone_escape = false;
        if (keys_feed(&e->keys, byte, event) && is_for_pilot(p, event))
            return true;
    }
    buf_clear(&e->input);
    e->taken = 0;
    return false;
}

/* Split an Alt-KEY without effect into Escape and KEY: a terminal sends the same bytes for both,
 * and tmux or a slow line joins them. Otherwise `Esc :` as in vim would lose its colon, and the
 * letters after it would be keys. */
static bool split_alt(struct pilot *p, struct key_event *event)
{
    struct key_event rest = *event;
    if (!(event->modifiers & KEY_ALT) || event->key == KEY_MOUSE || event->key == KEY_OTHER ||
        (!p->is_paging && pilot_row_of(p->state, event)))
        return true;
    rest.modifiers &= ~(unsigned)KEY_ALT;
    typed_ahead_put_back(&p->ahead, &rest);
    *event = (struct key_event){.key = KEY_ESCAPE};
    return true;
}

/* Get the next available key; false without one. */
static bool next_key(struct pilot *p, struct key_event *event)
{
    return (typed_ahead_take(&p->ahead, event) || read_key(p, event)) && split_alt(p, event);
}

static bool has_more(const struct pilot *p)
{
    return p->is_stale || p->is_drawn || p->refine.is_coarse || is_due(p);
}

/* Return true if the bytes so far are a key of their own unless more follows. A paste has no keys,
 * however slowly its end arrives. */
static bool has_partial_key(const struct pilot *p)
{
    return !p->is_pasting && keys_waiting(&p->editor->keys);
}

/* Return true if a slice is to be sent ahead now: the nearest at the rate of the line, others a few
 * at a time, so that a key hardly waits for them. */
static bool is_send_ahead_due(const struct pilot *p)
{
    return may_send_ahead(p) && !p->is_hasty &&
           p->flow.due <= (p->sent.number < AHEAD_NEAR ? FLOW_FRAMES : AHEAD_DUE);
}

/* Wait once, for bytes, news, a signal, the end of a sequence or the time of a frame. Return true
 * with a key that is complete because nothing followed. */
static bool wait_once(struct pilot *p, struct key_event *event)
{
    struct line_editor *e = p->editor;
    const bool has_frame = !p->is_paging && (has_more(p) || is_send_ahead_due(p));
    const uint64_t now_ns = clock_ns(), rests_ns = p->pace.key_ns + PACE_REST_NS;
    int patience_ms = has_partial_key(p) ? KEYS_TIMEOUT_MS
                      : has_frame        ? flow_wait_ms(&p->flow, now_ns)
                                         : -1;
    if (!has_partial_key(p) && !p->is_paging && p->is_hasty && rests_ns > now_ns) {
        const int due_ms = (int)((rests_ns - now_ns) / 1000000);
        patience_ms = patience_ms < 0 || patience_ms > due_ms ? due_ms + 1 : patience_ms;
    }
    const enum term_input input = term_read(&e->input, patience_ms, e->news_descriptor);
    if (input == TERM_CLOSED) {
        p->is_over = p->has_ended = true;
    } else if (input == TERM_OTHER && e->news) {
        OWNED(buf_release) struct buf news = {0};
        e->news(e->context, &news);
        if (news.length)
            keep_last_line(&p->message, buf_text(&news));
        p->is_stale = true;
    } else if (input == TERM_TIMEOUT) {
        return !p->is_pasting && line_editor_time_out(e, event) && is_for_pilot(p, event) &&
               split_alt(p, event);
    }
    return false;
}

/* ---- in idle time ---- */

/* Keys that move the cross-hair are followed; any other key that has an effect ends the work. */
static bool wants_moves(void *context)
{
    struct pilot *p = context;
    const uint64_t now_ns = clock_ns();
    return read_keys_ahead(p, now_ns) && p->ahead.count > p->ahead_shown &&
           flow_may_send(&p->flow, now_ns);
}

static bool stops_for_keys(void *context)
{
    const struct pilot *p = context;
    bool stops = has_partial_key(p) || p->is_pasting;
    for (size_t i = p->ahead.taken; i < p->ahead.count; i++)
        stops = stops || !pilot_only_moves(p->state, p->ahead.event + i);
    return stops;
}

/* Labels are rough right after an edit. Finish them, unless a key arrives: then begin again after
 * it. */
static void finish_labels(struct pilot *p)
{
    const struct pilot_onlooker onlooker = {p, stops_for_keys, wants_moves, show_so_far};
    OWNED(buf_release) struct buf news = {0};
    struct fault why = {0};
    p->reads_ns = 0;
    p->ahead_shown = 0;
    const enum err err = p->host->finish(p->host->context, &onlooker, &news, &why);
    if (!err && news.length)
        keep_last_line(&p->message, buf_text(&news));
    p->is_stale = err != ERR_CANCELLED || p->ahead_shown > 0;
    p->finish_failed = err != OK && err != ERR_CANCELLED;
    if (p->finish_failed)
        say_error(p, &why);
}

static void follow_screen(struct pilot *p)
{
    if (term_was_resized() || term_was_continued()) {
        p->is_resized = true;
        lay_out(p);
    }
}

/* For a page of text: wait for a key, or another size of the screen. */
static void await_key(struct pilot *p, struct key_event *event)
{
    bool has_key = false;
    p->is_paging = true;
    while (!p->is_over && !p->is_resized && !has_key) {
        has_key = next_key(p, event) || wait_once(p, event);
        follow_screen(p);
        has_key = has_key && event->key != KEY_PASTE_END && event->key != KEY_OTHER &&
                  event->key != KEY_MOUSE;
    }
    p->is_paging = false;
    buf_clear(&p->pasted);
}

/* Return true if a click has arrived: it refers to the present picture, so no other is drawn before
 * it. */
static bool has_click(const struct pilot *p)
{
    const struct typed_ahead *ahead = &p->ahead;
    return (ahead->count > ahead->taken && ahead->event[ahead->count - 1].key == KEY_MOUSE) ||
           strstr(buf_text(&p->editor->input) + p->editor->taken, "\033[<0;");
}

static enum err run(struct pilot *p, struct fault *fault)
{
    struct key_event event;
    enum err err = OK;
    while (!err && !p->is_over) {
        const uint64_t begin_ns = clock_ns();
        bool shows_first = false; /* before the next key */
        follow_screen(p);
        while (!err && !p->is_over && !shows_first && next_key(p, &event)) {
            err = take_key(p, &event, fault);
            shows_first = p->is_stale && clock_ns() >= begin_ns + KEYS_NS && !has_click(p);
        }
        if (shows_first) /* answers may have arrived behind keys */
            p->reads_ns = 0, read_keys_ahead(p, clock_ns());
        const bool has_frame = !err && !p->is_over && (has_more(p) || is_send_ahead_due(p));
        if (has_frame && flow_may_send(&p->flow, clock_ns()))
            err = has_more(p) || p->flow.failed ? draw(p, fault) : send_ahead(p, fault);
        else if (has_frame && !p->is_stale && is_due(p) && p->view.rgba)
            p->is_drawn = draw_view(p) != ERR_CANCELLED; /* while the line is busy */
        if (shows_first || p->ahead.count > p->ahead.taken)
            continue;
        const bool is_rough = !p->is_stale && !p->is_hasty && !p->is_drawn && !p->finish_failed &&
                              !has_partial_key(p) && !p->is_pasting && p->host->finish &&
                              p->shows == PILOT_ROUGH;
        if (!err && !p->is_over && is_rough)
            finish_labels(p);
        else if (!err && !p->is_over && wait_once(p, &event))
            err = take_key(p, &event, fault);
    }
    return err;
}

enum err pilot_run(const struct pilot_host *host, struct pilot_state *state,
                   struct terminal_facts *facts, struct line_editor *editor, bool *ended,
                   struct fault *fault)
{
    const struct term_size size = term_size();
    struct pilot p = {.host = host,
                      .state = state,
                      .facts = facts,
                      .told = -1,
                      .editor = editor,
                      .pace.within_ns = PACE_SINGLE_NS,
                      .sent.rests = state->was_open,
                      .flow.round_trip_ns = facts->round_trip_ns};
    struct buf out = {0};
    *ended = false;
    if (size.columns < COLUMNS_LEAST || size.rows < ROWS_LEAST)
        return fault_set(fault, ERR_USAGE, "the pilot needs a screen of %dx%d characters or more",
                         COLUMNS_LEAST, ROWS_LEAST);
    pilot_state_enter(state);
    state->sends_ahead = false;
    state->was_open = true;
    editor->answered = frame_answered;
    editor->asker = &p;
    if (!facts->answers && facts->advice)
        buf_add_text(&p.message, facts->advice);
    enum err err = adopt_facts(&p, fault);
    if (!err)
        err = run(&p, fault);
    host->drop(host->context, NULL); /* undo a preview at the end of the input */
    painter_remove(&p.painter, &out);
    painter_drop(&p.painter, &out);
    term_write_text(&out, "a blank screen", NULL);
    term_change_sequences(TERM_PROMPT_BEGINS, TERM_PROMPT_ENDS, NULL);
    editor->answered = NULL;
    editor->answers_due += p.flow.due;
    *ended = p.has_ended;
    painter_release(&p.painter);
    refine_release(&p.refine);
    buf_release(&p.pasted);
    buf_release(&p.message);
    return err;
}
