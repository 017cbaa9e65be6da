/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line_edit.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "tui/cells.h"
#include "tui/probe.h"
#include "tui/prompt/shell.h"
#include "tui/term.h"

enum { PASTE_PATIENCE_MS = 200 };

void line_editor_release(struct line_editor *e)
{
    line_release(&e->line);
    line_history_release(&e->history);
    buf_release(&e->held);
    buf_release(&e->input);
}

/* ---- drawing ---- */

static const char *suggestion(const struct line_editor *e)
{
    const bool may = e->knows && !e->line.searching && !e->pasting;
    return may ? line_suggestion(&e->line, e->knows, e->context) : "";
}

/* Add possible ends of a typed line: the rest of an older one, and the usage after that. */
static void add_hint(const struct line_editor *e, struct buf *hint)
{
    const struct line *l = &e->line;
    OWNED(buf_release) struct buf whole = {0};
    if (!e->hint || l->text.length == 0 || l->cursor < l->text.length || l->searching ||
        e->pasting || e->submits)
        return;
    const char *rest = suggestion(e);
    buf_add(&whole, buf_text(&l->text), l->text.length);
    buf_add_text(&whole, rest);
    buf_add_safe_text(hint, rest);
    if (!whole.failed)
        e->hint(e->context, buf_text(&whole), whole.length, hint);
}

enum { FOUND_ROWS_MOST = 10, ROWS_LEFT = 3, MARK_WIDE = 2 };

/* Add the lines that a search has found, near the chosen one, which is marked. */
static void add_found(const struct line *l, const struct term_size *size, struct buf *out)
{
    const size_t room = size->rows > ROWS_LEFT + FOUND_ROWS_MOST ? FOUND_ROWS_MOST
                        : size->rows > ROWS_LEFT                 ? size->rows - ROWS_LEFT
                                                                 : 0;
    const bool has_chosen = l->chosen < l->found_count;
    const size_t first = has_chosen && l->chosen >= room ? l->chosen + 1 - room : 0;
    for (size_t i = first; i < l->found_count && i < first + room; i++) {
        OWNED(buf_release) struct buf safe = {0};
        buf_add_safe_text(&safe, l->history->line[l->found[i]]);
        buf_add_text(out, has_chosen && i == l->chosen ? "> " : "  ");
        cells_crop(out, buf_text(&safe),
                   size->columns > MARK_WIDE + 1 ? size->columns - MARK_WIDE - 1 : 1);
        buf_add_char(out, '\n');
        out->failed |= safe.failed;
    }
}

static void draw_line(struct line_editor *e, const char *prompt, struct buf *out)
{
    const struct line *l = &e->line;
    const struct term_size size = term_size();
    OWNED(buf_release) struct buf search = {0}, hint = {0}, found = {0};
    add_hint(e, &hint);
    if (l->searching) {
        add_found(l, &size, &found);
        buf_printf(&search, "(%s '%s') ", l->search_failed ? "not found:" : "search",
                   buf_text(&l->wanted));
        prompt = buf_text(&search);
    } else if (e->held.length && !e->is_one_line && !e->submits) {
        buf_add_text(&found, "Enter runs the pasted lines, Ctrl-C drops them\n");
    }
    const struct line_content content = {.prompt = prompt,
                                         .text = buf_text(&l->text),
                                         .length = l->text.length,
                                         .cursor = l->cursor,
                                         .hint = buf_text(&hint),
                                         .grey = e->grey,
                                         .below = buf_text(&found)};
    line_draw(&e->drawing, &content, size.columns, size.rows, out);
}

static enum err redraw(struct line_editor *e, const char *prompt, struct fault *fault)
{
    struct buf out = {0};
    draw_line(e, prompt, &out);
    return term_write_text(&out, "drawing the line", fault);
}

/* Draw the line again with the cursor at its end, then `more`; the next output begins a line. */
static enum err leave_line(struct line_editor *e, const char *prompt, const char *more,
                           struct fault *fault)
{
    struct buf out = {0};
    e->line.cursor = e->line.text.length;
    e->line.searching = false;
    e->submits = true;
    draw_line(e, prompt, &out);
    e->submits = false;
    buf_add_text(&out, more);
    e->drawing = (struct line_drawing){0};
    return term_write_text(&out, "drawing the line", fault);
}

/* Move to the start of the line's rows and erase them. */
static void erase_line(struct line_editor *e, struct buf *out)
{
    if (e->drawing.row > 0)
        buf_printf(out, "\033[%uA", e->drawing.row);
    buf_add_text(out, "\r\033[J");
    e->drawing = (struct line_drawing){0};
}

/* Replace the drawn line by these lines, and draw it again below them. */
static enum err show_above(struct line_editor *e, const char *prompt, const struct buf *text,
                           struct fault *fault)
{
    struct buf out = {0};
    erase_line(e, &out);
    for (const char *at = buf_text(text); *at; at += strcspn(at, "\n"), at += *at == '\n') {
        buf_add(&out, at, strcspn(at, "\n"));
        buf_add_text(&out, "\r\n");
    }
    out.failed |= text->failed;
    draw_line(e, prompt, &out);
    return term_write_text(&out, "drawing the line", fault);
}

/* ---- completion ---- */

enum { PIECE_LEAST = 2 };

/* The first word, up to the cursor, may be a part of a name. */
static void find_by_piece(struct line_editor *e, size_t *start, struct buf *words)
{
    const struct line *l = &e->line;
    const char *text = buf_text(&l->text), *first = text + strspn(text, " ");
    const size_t end = (size_t)(first - text) + strcspn(first, " ");
    const struct candidates c = candidates_of(buf_text(words));
    OWNED(buf_release) struct buf piece = {0};
    if (!e->find || (c.count && !e->is_one_line) || end != l->cursor)
        return;
    if (c.count == 1 && c.common == l->cursor - *start) /* the word is complete */
        return;
    buf_add(&piece, first, l->cursor - (size_t)(first - text));
    if (piece.length >= PIECE_LEAST && !piece.failed) {
        *start = (size_t)(first - text);
        e->find(e->context, buf_text(&piece), words);
    }
}

static enum err complete_word(struct line_editor *e, const char *prompt, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0}, out = {0};
    struct line *l = &e->line;
    const struct term_size size = term_size();
    size_t start = l->cursor;
    if (e->complete)
        e->complete(e->context, buf_text(&l->text), l->cursor, &words, &start);
    find_by_piece(e, &start, &words);
    const struct candidates c = candidates_of(buf_text(&words));
    const size_t typed = l->cursor - (start < l->cursor ? start : l->cursor);
    const bool begins =
        c.common >= typed && strncmp(c.first, buf_text(&l->text) + start, typed) == 0;
    enum err err = OK;
    if (c.count + c.notes == 0 || words.failed || start > l->cursor) {
        buf_add_char(&out, '\a');
    } else if ((c.count == 1 && (begins || !c.notes)) || (begins && c.common > typed)) {
        const size_t end = l->cursor;
        const char last = c.first[c.common - 1];
        const bool is_whole = c.count == 1 && last != '/' && last != '=' && last != ' ';
        OWNED(buf_release) struct buf word = {0};
        buf_add(&word, c.first, c.common);
        if (is_whole && (end == l->text.length || l->text.data[end] != ' '))
            buf_add_char(&word, ' ');
        if (!word.failed)
            line_replace(l, start, end, buf_text(&word), word.length);
    } else {
        size_t cursor = l->cursor;
        err = leave_line(e, prompt, "\r\n", fault);
        l->cursor = cursor;
        candidates_list(&c, size.columns, size.rows, &out);
    }
    if (err)
        return err;
    draw_line(e, prompt, &out);
    return term_write_text(&out, "drawing the line", fault);
}

/* ---- keys ---- */

static enum line_editor_act do_action(struct line_editor *e, enum line_action action)
{
    if (!line_take_suggestion(&e->line, e->hint ? suggestion(e) : "", action))
        line_act(&e->line, action);
    return DUTY_NONE;
}

/* Leave a line of a full screen, empty. */
static enum line_editor_act leave_empty(struct line_editor *e)
{
    line_clear(&e->line);
    return DUTY_SUBMIT;
}

static enum line_editor_act key_by_table(struct line_editor *e, const struct key_event *event)
{
    const unsigned found = line_key_find(event, e->keys_before);
    if (found < LINE_ACTIONS)
        return do_action(e, (enum line_action)found);
    switch (found) {
    case DUTY_COMPLETE:
        return event->modifiers == 0 ? DUTY_COMPLETE : DUTY_NONE;
    case DUTY_SEARCH:
        line_search_begin(&e->line);
        return DUTY_NONE;
    case DUTY_DELETE_OR_END:
        return e->line.text.length == 0 ? DUTY_END : do_action(e, LINE_DELETE);
    case DUTY_ABANDON:
        return e->is_one_line ? leave_empty(e) : DUTY_ABANDON;
    case DUTY_OTHER_EDITOR: /* not for a single line on a full screen */
        return e->is_one_line ? DUTY_NONE : DUTY_OTHER_EDITOR;
    case DUTY_HOST_LINE:
        if (!e->line_of_ctrl_o)
            return DUTY_NONE;
        line_clear(&e->line);
        line_insert(&e->line, e->line_of_ctrl_o, strlen(e->line_of_ctrl_o));
        return DUTY_SUBMIT;
    case DUTY_MORE:
        return DUTY_NONE;
    default:
        return (enum line_editor_act)found;
    }
}

static enum line_editor_act plain_key(struct line_editor *e, const struct key_event *event)
{
    const bool held = event->modifiers & (KEY_CONTROL | KEY_ALT);
    if (event->key == KEY_ESCAPE && e->is_one_line)
        return leave_empty(e);
    if (event->key != KEY_CHARACTER || held || *e->keys_before)
        return key_by_table(e, event);
    line_insert(&e->line, event->text, event->length);
    return DUTY_NONE;
}

static enum line_editor_act search_key(struct line_editor *e, const struct key_event *event)
{
    struct line *l = &e->line;
    const bool control = event->key == KEY_CHARACTER && event->modifiers & KEY_CONTROL;
    if (event->key == KEY_CHARACTER && event->modifiers == 0) {
        line_search_add(l, event->text, event->length);
    } else if (event->key == KEY_BACKSPACE) {
        line_search_erase(l);
    } else if (event->key == KEY_DOWN ||
               (control && (event->point == 'r' || event->point == 'n'))) {
        line_search_older(l);
    } else if (event->key == KEY_UP || (control && event->point == 'p')) {
        line_search_newer(l);
    } else if (control && event->point == 'g') {
        line_search_end(l, false);
    } else {
        line_search_end(l, true);
        return event->key == KEY_ESCAPE || event->key == KEY_TAB ? DUTY_NONE : plain_key(e, event);
    }
    return DUTY_NONE;
}

/* Pasted text is inserted: only line feeds have an effect, except after empty lines, and Ctrl-C,
 * which ends a paste whose end never arrives. In a line of a full screen, where a line feed becomes
 * a blank, Ctrl-C is a key only if no more input follows it. */
static enum line_editor_act paste_key(struct line_editor *e, const struct key_event *event)
{
    bool control = event->modifiers & KEY_CONTROL;
    const bool is_key = !e->is_one_line || e->taken == e->input.length;
    if (event->key == KEY_CHARACTER && control && event->point == 'c' && is_key) {
        e->pasting = false;
        return e->is_one_line ? leave_empty(e) : DUTY_ABANDON;
    }
    if (event->key == KEY_ENTER && !e->is_one_line)
        return e->line.text.length ? DUTY_HOLD : DUTY_NONE;
    if (event->key == KEY_TAB || event->key == KEY_ENTER)
        line_paste(&e->line, " ", 1);
    else if (event->key == KEY_CHARACTER && !control)
        line_paste(&e->line, event->text, event->length);
    return DUTY_NONE;
}

bool line_editor_reply(struct line_editor *e)
{
    const char *body = e->keys.body;
    const bool is_answer = keys_is_answer(body);
    if (is_answer && e->answers_due > 0) {
        e->answers_due--;
        return false;
    }
    const enum probe_heard heard =
        e->probe ? graphics_hear(e->probe, body, e->facts) : PROBE_IGNORES;
    e->unanswered &= heard != PROBE_HAS_ALL;
    if (heard == PROBE_IGNORES && is_answer && e->answered)
        e->answered(e->asker);
    return heard == PROBE_HAS_ALL;
}

void line_editor_probe(struct line_editor *e)
{
    if (!e->probe)
        return;
    graphics_probe(e->probe, e->answers_due, e->facts, &e->input);
    e->answers_due = 0;
    e->unanswered = !e->facts->answers;
}

static enum line_editor_act take_key(struct line_editor *e, const struct key_event *event)
{
    if (event->key == KEY_REPLY) {
        line_editor_reply(e); /* the line is drawn again in any case */
        return DUTY_NONE;
    }
    if (event->key == KEY_PASTE_BEGIN || event->key == KEY_PASTE_END) {
        e->pasting = event->key == KEY_PASTE_BEGIN;
        e->line.last = LAST_OTHER;
        e->keys_before[0] = '\0';
        return DUTY_NONE;
    }
    if (e->pasting)
        return paste_key(e, event);
    return e->line.searching ? search_key(e, event) : plain_key(e, event);
}

/* A `[` after the Escape key, which has no meaning here, is not typed by a user; the letters that
 * begin a string sequence may be. */
void line_editor_rejoin_reply(struct line_editor *e, uint8_t byte)
{
    struct key_event event;
    const bool strings = e->unanswered || e->answers_due > 0;
    if (e->lone_escape && (byte == '[' || (strings && byte && strchr("P]_", byte))))
        keys_feed(&e->keys, 27, &event);
    e->lone_escape = false;
}

/* ---- the loop ---- */

/* In a paste, the LF of a CR LF is ignored. */
bool line_editor_next(struct line_editor *e, struct key_event *event)
{
    bool complete = false;
    while (!complete && e->taken < e->input.length) {
        const uint8_t byte = (uint8_t)e->input.data[e->taken++];
        line_editor_rejoin_reply(e, byte);
        const bool second = byte == '\n' && e->after_return;
        e->after_return = e->pasting && byte == '\r';
        complete = !second && keys_feed(&e->keys, byte, event);
    }
    if (e->taken == e->input.length) {
        buf_clear(&e->input);
        e->taken = 0;
    }
    return complete;
}

bool line_editor_time_out(struct line_editor *e, struct key_event *event)
{
    if (!keys_waiting(&e->keys) || !keys_time_out(&e->keys, event))
        return false;
    e->lone_escape = event->key == KEY_ESCAPE;
    return true;
}

/* Handle the bytes that have been read, up to a key that needs more than a redraw. */
static enum line_editor_act take_input(struct line_editor *e)
{
    struct key_event event;
    enum line_editor_act outcome = DUTY_NONE;
    while (outcome == DUTY_NONE && line_editor_next(e, &event))
        outcome = take_key(e, &event);
    return outcome;
}

/* State of the screen. */
enum screen { DRAWN, STALE, STALE_IN_PASTE };

/* Wait for bytes; set *screen if the line must be drawn again. */
static enum line_editor_act wait_for_input(struct line_editor *e, enum screen *screen)
{
    struct key_event event;
    bool waiting = !e->pasting && keys_waiting(&e->keys); /* a paste contains no keys */
    bool stalled = *screen == STALE_IN_PASTE;
    enum line_editor_act outcome;
    const int patience = waiting ? KEYS_TIMEOUT_MS : stalled ? PASTE_PATIENCE_MS : -1;
    switch (term_read(&e->input, patience, e->news ? e->news_descriptor : -1)) {
    case TERM_OTHER:
        return DUTY_NEWS;
    case TERM_BYTES:
        outcome = take_input(e);
        *screen = e->pasting || keys_waiting(&e->keys) ? STALE_IN_PASTE : STALE;
        return outcome;
    case TERM_TIMEOUT:
        *screen = STALE;
        return line_editor_time_out(e, &event) ? take_key(e, &event) : DUTY_NONE;
    case TERM_SIGNAL:
        if (term_was_continued()) /* every drawing reads the size anyway */
            e->drawing = (struct line_drawing){0};
        *screen = STALE;
        return DUTY_NONE;
    case TERM_CLOSED:
        break;
    }
    return DUTY_GONE;
}

void line_editor_take_answers(struct line_editor *e)
{
    if (e->answers_due > 0)
        probe_await(e->answers_due, 2000, &e->input);
    e->answers_due = 0;
}

void line_editor_suspend(struct line_editor *e)
{
    line_editor_take_answers(e);
    term_suspend();
}

/* ---- another editor ---- */

/*
 * Edit the line in another editor: $VISUAL, else $EDITOR, on a private file that is deleted
 * afterwards.
 *
 * The shell splits the variable into words, as in `EDITOR="code --wait"`. While the editor runs it
 * owns the terminal, in the modes that our caller had set; Ctrl-C and Ctrl-\ affect the editor
 * alone. Line feeds become blanks and other control characters are removed, so that the text is not
 * submitted by itself.
 */
enum { OTHER_EDITOR_BYTES_MOST = 1 << 20 }; /* read back from the file */

/* Make it a single line: each line end except the last becomes a blank, and control characters are
 * removed. */
static void make_one_line(struct buf *text)
{
    size_t kept = 0;
    while (text->length > 0 && strchr("\r\n \t", text->data[text->length - 1]))
        text->length--;
    for (size_t i = 0; i < text->length; i++) {
        const char c = strchr("\n\t", text->data[i]) && text->data[i] ? ' ' : text->data[i];
        if ((unsigned char)c >= ' ' && c != 127)
            text->data[kept++] = c;
    }
    text->length = kept;
    if (text->data)
        text->data[kept] = '\0';
}

static enum err edit_file(struct buf *text, const char *editor, const char *path,
                          struct fault *fault)
{
    OWNED(buf_release) struct buf written = {0}, command = {0};
    int status = 0;
    buf_printf(&written, "%s\n", buf_text(text));
    buf_printf(&command, "%s \"$@\"", editor);
    enum err err = command.failed
                       ? fault_memory(fault, "the editor's name")
                       : file_write(path, buf_text(&written), written.length, FILE_KEEP, fault);
    if (!err)
        err = term_set_mode(TERM_AS_FOUND, fault);
    if (!err)
        err = shell_run(buf_text(&command), path, NULL, &status, fault);
    if (!err && status != 0 && shell_has_none(status))
        err = fault_set(fault, ERR_INPUT,
                        "there is no editor %s; set VISUAL or EDITOR to one before iftty", editor);
    else if (!err && status != 0)
        err = fault_set(fault, ERR_INPUT, "%s ended with %s %d; the line is unchanged", editor,
                        WIFEXITED(status) ? "status" : "signal",
                        WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
    const enum err ours = term_set_mode(TERM_RAW, err ? NULL : fault);
    if (!err && !ours)
        err = file_read(&written, path, OTHER_EDITOR_BYTES_MOST, fault);
    if (!err && !ours) {
        make_one_line(&written);
        buf_clear(text);
        buf_add(text, buf_text(&written), written.length);
    }
    return err ? err : ours;
}

static enum err edit_elsewhere(struct buf *text, struct fault *fault)
{
    OWNED(buf_release) struct buf folder = {0}, path = {0};
    const char *visual = getenv("VISUAL");
    const char *editor = visual && *visual ? visual : getenv("EDITOR");
    if (!editor || !*editor)
        return fault_set(fault, ERR_USAGE,
                         "neither VISUAL nor EDITOR names an editor; `export EDITOR=nano` before "
                         "iftty, say");
    enum err err = folder_fresh(&folder, NULL, fault);
    if (err)
        return err;
    buf_printf(&path, "%s/line", buf_text(&folder));
    err = path.failed ? fault_memory(fault, "a path")
                      : edit_file(text, editor, buf_text(&path), fault);
    folder_remove(buf_text(&folder));
    return err;
}

/* Erase the line while another editor has it, and draw it again at the same place. */
static enum err edit_line_elsewhere(struct line_editor *e, const char *prompt, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0}, out = {0};
    struct fault why;
    line_editor_take_answers(e);
    erase_line(e, &out);
    enum err err = term_write_text(&out, "drawing the line", fault);
    buf_add(&text, buf_text(&e->line.text), e->line.text.length);
    const enum err failed = err ? OK : edit_elsewhere(&text, &why);
    if (!err && !failed && strcmp(buf_text(&text), buf_text(&e->line.text)) != 0)
        line_replace(&e->line, 0, e->line.text.length, buf_text(&text), text.length);
    buf_clear(&text);
    if (failed)
        buf_printf(&text, "error: %s\n", why.text);
    return err ? err : show_above(e, prompt, &text, fault);
}

/* ---- the end of a line ---- */

static void hold_line(struct line_editor *e)
{
    buf_printf(&e->held, "%s\n", buf_text(&e->line.text));
    line_clear(&e->line);
}

/* Make the first held line the line. */
static void take_held(struct line_editor *e)
{
    const size_t length = strcspn(buf_text(&e->held), "\n");
    line_clear(&e->line);
    line_insert(&e->line, e->held.data, length);
    e->held.length -= length + 1;
    memmove(e->held.data, e->held.data + length + 1, e->held.length + 1);
}

/* Carry out the result of a key, except the end of the line. */
static enum err carry_out(struct line_editor *e, const char *prompt, enum line_editor_act outcome,
                          struct fault *fault)
{
    OWNED(buf_release) struct buf news = {0};
    enum err err;
    switch (outcome) {
    case DUTY_ABANDON:
        err = leave_line(e, prompt, "^C\r\n", fault);
        line_clear(&e->line);
        buf_clear(&e->held);
        return err ? err : redraw(e, prompt, fault);
    case DUTY_HOLD:
        err = leave_line(e, prompt, "\r\n", fault);
        hold_line(e);
        return err;
    case DUTY_STOP:
        err = leave_line(e, prompt, "\r\n", fault);
        if (err)
            return err;
        line_editor_suspend(e);
        return redraw(e, prompt, fault);
    case DUTY_CLEAR:
        if (e->is_one_line) /* the rest of the screen belongs to the pilot */
            return redraw(e, prompt, fault);
        e->drawing = (struct line_drawing){0};
        line_editor_probe(e);
        err = term_write("\033[H\033[2J", 7, fault);
        return err ? err : redraw(e, prompt, fault);
    case DUTY_COMPLETE:
        return complete_word(e, prompt, fault);
    case DUTY_OTHER_EDITOR:
        return edit_line_elsewhere(e, prompt, fault);
    case DUTY_NEWS:
        e->news(e->context, &news);
        return show_above(e, prompt, &news, fault);
    default:
        return OK;
    }
}

enum err line_edit(struct line_editor *e, const char *prompt, bool *ended, struct fault *fault)
{
    const bool runs_held = e->held.length > 0 && !e->is_one_line;
    enum screen screen = STALE;
    enum err err = OK;
    line_clear(&e->line);
    e->line.text.failed = false;
    e->keys_before[0] = '\0';
    e->drawing = (struct line_drawing){0};
    enum line_editor_act outcome = runs_held ? DUTY_SUBMIT : take_input(e);
    while (!err && outcome != DUTY_SUBMIT && outcome != DUTY_END && outcome != DUTY_GONE) {
        if (outcome != DUTY_NONE) {
            err = carry_out(e, prompt, outcome, fault);
            screen = e->taken < e->input.length || outcome == DUTY_HOLD ? STALE : DRAWN;
            outcome = take_input(e);
            continue;
        }
        if (screen == STALE) {
            err = redraw(e, prompt, fault);
            screen = DRAWN;
        }
        if (!err)
            outcome = wait_for_input(e, &screen);
    }
    if (!err && (e->line.text.failed || e->input.failed))
        err = fault_memory(fault, "the line typed");
    if (!err && outcome != DUTY_GONE && !runs_held)
        err = leave_line(e, prompt, "\r\n", fault);
    if (!err && outcome == DUTY_SUBMIT && e->held.length > 0 && !e->is_one_line) {
        if (e->line.text.length)
            hold_line(e);
        take_held(e);
        err = e->held.failed ? fault_memory(fault, "the lines pasted")
                             : leave_line(e, prompt, "\r\n", fault);
    }
    e->stored = !err && outcome == DUTY_SUBMIT &&
                line_history_add(&e->history, buf_text(&e->line.text), e->line.text.length);
    *ended = outcome == DUTY_END || outcome == DUTY_GONE;
    return err;
}
