/* SPDX-License-Identifier: MIT */
/*
 * `iftty watch`: show the steps of a journal in the pilot, by lines that its keys enter:
 *
 *     step on N    step back N    step to N    step to last    step comments
 *
 * `step on` draws a step first, and carries it out the next time. Other lines are carried out if
 * they only look or ask (interpreter_look).
 */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/scan.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/trust.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "program/programs.h"
#include "show/label_report.h"
#include "tui/pilot/pilot.h"
#include "tui/prompt/repl.h"
#include "verify/replay_file.h"

enum { SEEDS_DRAWN_MOST = 1 << 18, LABELS_SAID_MOST = 6 };

/* ---- the replay ---- */

static size_t points(const struct watched *w)
{
    return w->interp->session->has_scene ? w->interp->history.points : 0;
}

/* Collect the comments of a record, which may be any bytes. */
static void gather_comments(struct buf *comments, const char *bytes, const struct record *record)
{
    OWNED(buf_release) struct buf lines = {0};
    record_comments(&lines, NULL, bytes, record);
    for (const char *at = buf_text(&lines); *at;) {
        const size_t length = strcspn(at, "\n"), blank = strncmp(at, "# ", 2) == 0 ? 2 : *at == '#';
        if (length > blank) {
            buf_add(comments, at + blank, length - blank);
            buf_add_char(comments, '\n');
        }
        at += length + (at[length] == '\n');
    }
    comments->failed |= lines.failed;
}

/* Add a step if the record has led to a new point; `comments` are those since the last step. */
static enum err note_record(struct watched *w, const struct outlook *outlook, size_t before,
                            struct buf *comments, struct fault *fault)
{
    const size_t now = points(w);
    if (now < before || now < 2) /* the record has opened another scene */
        w->count = 0;
    if (now < 2 || w->count == now - 1)
        return OK;
    if (!mem_grow(&w->step, &w->capacity, w->count + 1, sizeof *w->step))
        return fault_memory(fault, "the steps of a journal");
    w->step[w->count++] = (struct watched_step){*outlook, w->comments.length};
    buf_add(&w->comments, buf_text(comments), strlen(buf_text(comments)) + 1);
    buf_clear(comments);
    return OK;
}

static enum err carry_out_all(struct watched *w, struct replay *replay, const char *bytes)
{
    OWNED(buf_release) struct buf comments = {0};
    enum err err = OK;
    while (!err && !replay->is_over) {
        const struct outlook outlook = w->interp->session->now.outlook;
        const size_t before = points(w);
        err = replay_next(replay, &w->why);
        if (err || replay->is_over)
            break;
        gather_comments(&comments, bytes, &replay->record);
        err = note_record(w, &outlook, before, &comments, &w->why);
        w->end = w->interp->history.present;
    }
    if (points(w) <= w->count) /* a record that differs has opened another scene */
        w->count = 0;
    if (!err && (comments.failed || w->comments.failed))
        err = fault_memory(&w->why, "the comments of a journal");
    return err;
}

enum err watched_begin(struct watched *w, struct interpreter *interp, const char *path,
                       struct fault *fault)
{
    struct replaying replaying = {.interp = interp, .judge = interp->judge};
    const struct replay_host host = replay_file_host(&replaying);
    const struct replay_options options = {0};
    struct replay replay;
    OWNED(buf_release) struct buf bytes = {0};
    *w = (struct watched){.interp = interp};
    enum err err = replay_file_begin(interp, path, &bytes, fault);
    if (!err)
        err = replay_begin(&replay, buf_text(&bytes), bytes.length, &host, &options, &w->report,
                           fault);
    if (!err) {
        if (w->report.is_journal)
            err = carry_out_all(w, &replay, buf_text(&bytes));
        else
            err = fault_set(&w->why, ERR_INPUT,
                            "this is a script: `iftty run` makes a journal of it");
        w->ended = replay_end(&replay, err, &w->why);
        if (!w->count || err == ERR_CANCELLED || err == ERR_LIMIT || err == ERR_MEMORY)
            err = w->ended ? fault_set(fault, w->ended, "%s", w->why.text)
                           : fault_set(fault, ERR_INPUT,
                                       "there is no step in this journal: nothing was planted");
        else
            err = OK;
    }
    interp->replayed_words = NULL;
    limits_rest(true);
    return err;
}

void watched_release(struct watched *w)
{
    replay_report_release(&w->report);
    buf_release(&w->comments);
    free(w->step);
    free(w->former);
}

/* ---- the gesture of a step ---- */

/* Find the middle of the corners of a box or an outline; otherwise the first place, as of a
 * stroke. */
static bool find_place(const struct call *call, uint32_t place[3])
{
    const struct parameter *p = call->command->parameter;
    uint64_t sum[3] = {0}, count = 0;
    for (int i = 0; p[i].type; i++) {
        const struct value *value = call->value + i;
        if (p[i].type == VALUE_POSITION && value->given && !p[i].keyed) {
            for (int a = 0; a < 3; a++)
                sum[a] += value->place[a];
            count++;
        } else if (p[i].type == VALUE_LINE && value->given && !p[i].optional) {
            for (size_t c = 1; c < value->line->count; c++, count++) /* the line begins with the
                                                                        place */
                for (int a = 0; a < 3; a++)
                    sum[a] += value->line->corner[c][a];
        }
    }
    for (int a = 0; count && a < 3; a++)
        place[a] = (uint32_t)(sum[a] / count);
    return count > 0;
}

/* Read the command of a step, by the names of labels before it. */
static void read_gesture(struct watched *w, size_t step)
{
    const struct point *point = w->interp->history.point + step;
    struct kept kept = kept_settings_get(w->interp->history.point[point->parent].settings);
    OWNED(call_release) struct call call = {.command = NULL};
    w->command = NULL;
    w->has_place = false;
    w->label = -1;
    if (command_parse_by(&call, point->command, w->interp->session, &kept, NULL) || !call.command)
        return;
    w->command = call.command;
    w->has_place = find_place(&call, w->place);
    const struct parameter *p = call.command->parameter;
    for (int i = 0; p[i].type && w->label < 0; i++)
        if (p[i].type == VALUE_LABEL && call.value[i].given && !p[i].keyed)
            w->label = (int)call.value[i].number;
}

/* List the seeds that a step has planted or queued. The caller releases. */
static enum err gesture_seeds(struct edits *seeds, const struct watched *w, size_t step,
                              struct fault *fault)
{
    const struct point *after = w->interp->history.point + step,
                       *before = w->interp->history.point + after->parent;
    const struct edits *waits = &after->lists.pending;
    const size_t waited = edits_count(&before->lists.pending), now = edits_count(waits);
    const struct edit *edit = after->seeds ? after->after : edits_first(waits) + waited;
    const size_t count = after->seeds ? after->seeds : now > waited ? now - waited : 0;
    enum err err = OK;
    *seeds = (struct edits){0};
    if (count > SEEDS_DRAWN_MOST) /* too many to be seen */
        return OK;
    for (size_t i = 0; !err && i < count; i++)
        if (edit[i].label != EDIT_ERASE)
            err = edits_add(seeds, edit[i], fault);
    if (err)
        edits_release(seeds);
    return err;
}

/* ---- showing ---- */

/* Aim slices at a voxel; a magnified part is kept only around the same voxel. */
static void aim_at(struct slice_settings *slices, const uint32_t place[3])
{
    const bool is_there = memcmp(slices->cross, place, sizeof slices->cross) == 0;
    slices->has_middle = is_there && slices->has_middle;
    memcpy(slices->cross, place, sizeof slices->cross);
    if (!slices->has_middle)
        memset(slices->middle, 0, sizeof slices->middle);
}

/* Compute the view of a step: the viewer's, or the journal's if that has changed. */
static struct outlook outlook_of(struct watched *w, size_t step, bool is_drawn)
{
    static const uint32_t nowhere[3];
    const struct outlook *recorded = &w->step[step ? step - 1 : 0].outlook;
    struct outlook compared = *recorded, out = w->interp->session->now.outlook;
    compared.slices.has_middle = 0;
    aim_at(&compared.slices, nowhere);
    const bool follows = memcmp(&compared, &w->shown, sizeof compared) != 0;
    const uint32_t *cross = recorded->slices.cross;
    if (follows)
        out = *recorded;
    out.runs_by_itself = recorded->runs_by_itself;
    out.slices.marks = is_drawn || recorded->slices.marks;
    if (w->has_place || follows || memcmp(cross, w->cross, sizeof w->cross) != 0)
        aim_at(&out.slices, w->has_place ? w->place : cross);
    w->shown = compared;
    memcpy(w->cross, cross, sizeof w->cross);
    return out;
}

/* Go to a point, with these lists instead of its own, or NULL. All or nothing. */
static enum err go_to(struct watched *w, uint32_t point, const struct outlook *outlook,
                      const struct edit_lists *lists, struct fault *fault)
{
    struct session *session = w->interp->session;
    struct history *history = &w->interp->history;
    const uint32_t present = history->present;
    limits_rest(false);
    session_mark(session);
    enum err err = history_look(history, session, point, fault);
    struct state state = session->now;
    state.outlook = *outlook;
    if (lists)
        state.lists = *lists;
    if (!err)
        err = session_go(session, &state, NULL, 0, fault);
    if (err) {
        session_rollback(session);
        history->present = present;
    } else {
        session_settle(session);
        watch_begin(session->watch);
    }
    limits_rest(true);
    return err;
}

/* Copy the labels before a drawn step. */
static enum err keep_former(struct watched *w, struct fault *fault)
{
    const struct scene *scene = w->interp->session->scene;
    const struct labels labels = labels_of_forest(scene);
    if (!w->former) {
        w->cells = scene->grid.cells;
        w->former = mem_array(w->cells, 1);
    }
    if (!w->former)
        return fault_memory(fault, "the labels before a step");
    labels_copy_row(&labels, (struct span){0, (uint32_t)w->cells}, w->former);
    w->changed = 0;
    memset(w->changes, 0, sizeof w->changes);
    return OK;
}

static void count_changes(struct watched *w)
{
    enum { AT_ONCE = 4096 };
    const struct labels labels = labels_of_forest(w->interp->session->scene);
    uint8_t now[AT_ONCE];
    for (size_t at = 0; at < w->cells; at += AT_ONCE) {
        const size_t count = w->cells - at < AT_ONCE ? w->cells - at : AT_ONCE;
        labels_copy_row(&labels, (struct span){(uint32_t)at, (uint32_t)(at + count)}, now);
        for (size_t i = 0; i < count; i++) {
            if (now[i] == w->former[at + i])
                continue;
            w->changed++;
            w->changes[now[i]]++;
            w->changes[w->former[at + i]]--;
        }
    }
}

enum err watched_draw(struct watched *w, size_t step, struct fault *fault)
{
    const struct history *history = &w->interp->history;
    const struct watched was = *w;
    OWNED(edits_release) struct edits seeds = {0};
    read_gesture(w, step ? step : 1);
    const struct point *after = history->point + (step ? step : 1);
    struct edit_lists lists = history->point[after->parent].lists;
    enum err err = step ? gesture_seeds(&seeds, w, step, fault) : OK;
    if (edits_count(&seeds))
        lists.pending = seeds;
    if (step && w->command && w->command->flags & COMMAND_PLANTS) {
        lists.eliminators = after->lists.eliminators;
        lists.applied = 0;
    }
    const struct outlook outlook = outlook_of(w, step, step > 0);
    if (!err)
        err = go_to(w, after->parent, &outlook, &lists, fault);
    if (err) {
        *w = was;
        return err;
    }
    w->at = step;
    w->is_drawn = step > 0;
    return OK;
}

enum err watched_carry_out(struct watched *w, size_t step, struct fault *fault)
{
    const bool is_drawn = w->is_drawn && w->at == step;
    TRY(is_drawn ? OK : watched_draw(w, step, fault));
    if (!step)
        return OK;
    const struct outlook outlook = outlook_of(w, step, false);
    TRY(keep_former(w, fault));
    TRY(go_to(w, (uint32_t)step, &outlook, NULL, fault));
    count_changes(w);
    w->is_drawn = false;
    return OK;
}

const uint8_t *watched_former(const struct watched *w)
{
    return w->at && !w->is_drawn && w->changed ? w->former : NULL;
}

/* ---- text ---- */

void watched_title(struct buf *out, const struct watched *w)
{
    const struct history *history = &w->interp->history;
    const struct point *point = history->point + w->at;
    if (!w->at) {
        buf_printf(out, "the beginning, before step 1 of %zu", w->count);
        return;
    }
    buf_printf(out, "step %zu of %zu, record %zu: ", w->at, w->count, point->record);
    buf_add_safe_excerpt(out, point->command, strlen(point->command));
    uint32_t end = w->end; /* the last state, or the one it comes from */
    while (end > w->at)
        end = history->point[end].parent;
    if (end == w->at)
        return;
    buf_add_text(out, point->branch == history->on ? "  (undone later)" : "  (on another branch)");
}

void watched_describe(struct buf *out, const struct watched *w)
{
    const struct session *session = w->interp->session;
    const size_t waits = session_pendings(session);
    unsigned said = 0, more = 0;
    if (w->is_drawn) {
        buf_add_text(out, "drawn, but not run yet");
        if (w->has_place)
            buf_printf(out, ": at %u,%u,%u", w->place[0], w->place[1], w->place[2]);
        if (w->label >= 0) {
            buf_add_text(out, w->has_place ? ", label " : ": label ");
            label_report_write_name(out, session, (unsigned)w->label);
        }
        return;
    }
    for (unsigned label = 0; w->at && label < 256; label++) {
        const int64_t change = w->changes[label];
        if (!change)
            continue;
        if (said == LABELS_SAID_MOST) {
            more++;
            continue;
        }
        buf_add_text(out, said++ ? ", " : "");
        label_report_write_name(out, session, label);
        buf_add_text(out, change > 0 ? " +" : " -");
        label_report_write_extent(out, session, (uint64_t)(change > 0 ? change : -change));
    }
    if (more)
        buf_printf(out, ", and %u labels more", more);
    if (w->at && w->changed)
        buf_printf(out, "%s%llu voxel%s changed", said ? "; " : "", (unsigned long long)w->changed,
                   plural(w->changed));
    else if (!waits && w->at)
        buf_add_text(out, "no label has changed");
    if (waits)
        buf_printf(out, "%s%zu edit%s for a run", w->changed ? "; " : "", waits,
                   waits == 1 ? " waits" : "s wait");
}

void watched_comments(struct buf *out, const struct watched *w)
{
    const char *at = w->at ? w->comments.data + w->step[w->at - 1].comments : "";
    while (*at) {
        const size_t n = strcspn(at, "\n");
        buf_add_safe(out, at, n);
        buf_add_char(out, '\n');
        at += n + (at[n] == '\n');
    }
}

void watched_verdict(struct buf *out, const struct watched *w)
{
    const struct replay_report *r = &w->report;
    if (w->ended) {
        buf_printf(out, "NOT verified: %s", w->why.text);
        return;
    }
    buf_printf(out, "verified: %zu command%s replayed, %zu result%s the same", r->executed,
               plural(r->executed), r->compared, plural(r->compared));
    if (r->is_torn)
        buf_add_text(out, "; an unfinished record at the end was left alone");
}

struct watching {
    struct pilot_interpreter pilot; /* first member (programs.h) */
    struct watched watched;
    struct reply reply;
    size_t last;  /* the last step that is shown */
    bool is_over; /* the verdict is shown, after the last step */
    struct pilot_host host;
    struct pilot_state state;
};

/* ---- from step to step ---- */

static enum err show_end(struct watching *w, struct fault *fault)
{
    const struct watched *shown = &w->watched;
    const bool is_there = shown->at == w->last && !shown->is_drawn;
    const enum err err = is_there ? OK : watched_carry_out(&w->watched, w->last, fault);
    w->is_over = !err;
    return err;
}

static enum err step_line(struct watching *w, const char *at, struct buf *output,
                          struct fault *fault)
{
    int64_t n = 0;
    const char *words = at;
    if (strcmp(at, "comments") == 0) {
        watched_comments(output, &w->watched);
        buf_add_text(output, output->length ? "" : "this step has no comment\n");
        return OK;
    }
    if (strcmp(at, "to last") == 0)
        return show_end(w, fault);
    const bool is_on = scan_text(&at, "on "), is_back = scan_text(&at, "back "),
               is_to = scan_text(&at, "to ");
    if (!(is_on || is_back || is_to) || !scan_integer(&at, is_to ? 0 : 1, 1000000, &n) || *at)
        return fault_set(fault, ERR_USAGE, "expected step on N, back N, to N or comments, not %s",
                         words);
    if (is_to && (size_t)n > w->last)
        return fault_set(fault, ERR_USAGE, "expected a step 0..%zu", w->last);
    const bool was_over = w->is_over;
    const size_t by = (size_t)n, from = was_over ? w->last + 1 : w->watched.at;
    /* A drawn step counts as the first of `step on N`. */
    const bool carries_out = is_on && w->watched.is_drawn;
    const size_t to = is_to ? by : is_on ? from + by - carries_out : from > by ? from - by : 0;
    TRY(is_back || (carries_out && by == 1) ? watched_carry_out(&w->watched, to, fault)
        : to > w->last                      ? show_end(w, fault)
                                            : watched_draw(&w->watched, to, fault));
    if (was_over && !is_on)
        w->is_over = false;
    return OK;
}

/* ---- the pilot's host ---- */

static enum err watch_execute(void *context, const char *line, struct buf *output,
                              struct fault *fault)
{
    struct watching *w = context;
    const char *at = line;
    enum err err;
    console_forget_interrupt();
    if (scan_text(&at, "step ")) {
        err = step_line(w, at, output, fault);
    } else {
        err = interpreter_look(w->pilot.interp, line, &w->reply, fault);
        buf_add_text(output, buf_text(err ? &w->reply.list : &w->reply.text));
    }
    console_erase_progress();
    w->pilot.panes.former = w->is_over ? NULL : watched_former(&w->watched);
    return err;
}

static enum err watch_drop(void *context, struct fault *fault)
{
    (void)context, (void)fault;
    return OK;
}

static void watch_caption(void *context, struct buf *lines)
{
    const struct watching *w = context;
    const struct watched *shown = &w->watched;
    OWNED(buf_release) struct buf comments = {0};
    if (w->is_over) {
        buf_printf(lines, "the end: %zu step%s, %zu record%s", shown->count, plural(shown->count),
                   shown->report.executed, plural(shown->report.executed));
        if (w->last < shown->count)
            buf_printf(lines, "; steps after %zu are left out", w->last);
        buf_add_char(lines, '\n');
        watched_verdict(lines, shown);
        buf_add_char(lines, '\n');
        return;
    }
    watched_title(lines, shown);
    buf_add_char(lines, '\n');
    watched_describe(lines, shown);
    buf_add_char(lines, '\n');
    watched_comments(&comments, shown);
    for (size_t i = 0; i + 1 < comments.length; i++)
        buf_add_char(lines, comments.data[i] == '\n' ? ' ' : comments.data[i]);
}

/* ---- the program ---- */

static enum err watch_screen(void *context, struct terminal_facts *facts,
                             struct line_editor *editor, bool *ended, struct fault *fault)
{
    struct watching *w = context;
    return pilot_run(&w->host, &w->state, facts, editor, ended, fault);
}

static enum err watch_at_terminal(const struct options *o, struct interpreter *interp,
                                  const struct config *config, struct fault *fault)
{
    static struct watching w; /* too large for the stack */
    const struct repl_host host = {
        .context = &w, .screen = watch_screen, .complete = pilot_host_complete};
    OWNED(buf_release) struct buf words = {0};
    w.pilot.interp = interp;
    w.pilot.smooth = o->smooth;
    w.pilot.watches = true;
    w.host = (struct pilot_host){
        .context = &w, .execute = watch_execute, .drop = watch_drop, .caption = watch_caption};
    pilot_host_fill(&w.host);
    pilot_state_init(&w.state, &config->setup);
    w.state.watches = true;
    enum err err = watched_begin(&w.watched, interp, o->word[0], fault);
    const size_t count = w.watched.count;
    w.last = o->until && o->until < count ? o->until : count;
    if (!err && o->from > w.last)
        err = fault_set(fault, ERR_USAGE, "--from %zu: expected a step 1..%zu", o->from, w.last);
    if (!err)
        err = watched_draw(&w.watched, o->from, fault);
    console_erase_progress();
    if (!err)
        err = run_screen_once(&host, o->graphics.count ? o->graphics : config->graphics, fault);
    if (!err) {
        watched_verdict(&words, &w.watched);
        buf_add_char(&words, '\n');
        console_print(NULL, buf_text(&words));
        if (w.watched.ended)
            err = fault_set(fault, w.watched.ended, "%s", w.watched.why.text);
    }
    watched_release(&w.watched);
    reply_release(&w.reply);
    panes_release(&w.pilot.panes);
    pilot_state_release(&w.state);
    return err;
}

enum err run_watch(const struct options *o, struct fault *fault)
{
    OWNED(config_release) struct config config = {.setup = pilot_setup_default};
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO))
        return fault_set(fault, ERR_USAGE,
                         "`watch` needs a terminal; `iftty replay JOURNAL` needs none, and "
                         "`iftty log JOURNAL` lists the records");
    if (o->until && o->from > o->until)
        return fault_set(fault, ERR_USAGE,
                         "--from %zu --until %zu: expected the first step before the last", o->from,
                         o->until);
    config_read(&config); /* before the process is confined */
    if (!theme_for(config.setup.theme, false)->has_colours)
        setenv("NO_COLOR", "1", 1);
    console_handle_interrupts();
    TRY(begin_confined(o, o->word[0], NULL, fault));
    OWNED(interpreter_release) struct interpreter interp;
    TRY(begin_by_options(&interp, o, fault));
    return watch_at_terminal(o, &interp, &config, fault);
}
