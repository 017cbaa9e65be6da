/* SPDX-License-Identifier: MIT */
#include "program/watch_host.h"

#include <string.h>

#include "base/clock.h"
#include "base/scan.h"
#include "command/execute.h"
#include "program/console.h"
#include "show/label_report.h"
#include "session/session.h"
#include "session/state.h"
#include "steps/step_words.h"

enum { QUARTERS = 4, SPEED_LEAST = 1, SPEED_MOST = 64 };
enum { DRAWN_MS = 700, HATCHED_MS = 700, PAUSE_MS = 600, ANSWER_MS = 3000 };

static size_t count_of(const struct watching *w)
{
    return w->walk.list.count;
}

static void due_in(struct watching *w, uint64_t ms)
{
    w->due_ns = clock_ns() + ms * 1000000 * QUARTERS / w->speed;
}

/* ---- going ---- */

static bool is_shown(const struct watching *w, size_t step)
{
    const struct step *s = walkthrough_step(&w->walk, step);
    return !w->skips || s->fate == STEP_STANDS;
}

/* So many steps on from the one that is shown, or back: as far as there are. 0 for the beginning;
 * count + 1 for what comes after all of them. */
static size_t step_beyond(const struct watching *w, int64_t by)
{
    const size_t count = count_of(w);
    size_t step = w->is_over_end ? count + 1 : w->walk.at;
    for (; by > 0 && step <= count; by--)
        do
            step++;
        while (step <= count && !is_shown(w, step));
    for (; by < 0 && step > 0; by++)
        do
            step--;
        while (step > 0 && !is_shown(w, step));
    return step;
}

static enum err show(struct watching *w, size_t step, enum step_phase phase, struct fault *fault)
{
    const enum err err = walkthrough_show(&w->walk, step, phase, fault);
    w->is_hatched = false;
    w->due_ns = 0;
    if (err) {
        w->plays = false;
        return err;
    }
    w->is_over_end = false;
    w->is_asked = phase == STEP_HIDDEN;
    w->is_answered = w->is_answered && phase == STEP_DRAWN;
    return OK;
}

/* All that follows is carried out too; how the replay ended is no error of the key. */
static enum err show_end(struct watching *w, struct fault *fault)
{
    const size_t last = count_of(w);
    enum err err =
        w->walk.at == last && w->walk.phase == STEP_AFTER ? OK : show(w, last, STEP_AFTER, fault);
    if (!err)
        err = walkthrough_finish(&w->walk, fault);
    w->plays = false;
    w->due_ns = 0;
    w->is_hatched = false;
    w->is_over_end = !err || w->walk.has_ended;
    return w->is_over_end ? OK : err;
}

static enum err draw(struct watching *w, size_t step, struct fault *fault)
{
    const enum err err = show(w, step, STEP_DRAWN, fault);
    if (!err)
        due_in(w, DRAWN_MS);
    return err;
}

static enum err carry_out(struct watching *w, struct fault *fault)
{
    const enum err err = show(w, w->walk.at, STEP_AFTER, fault);
    const struct step_seen *seen = walkthrough_seen(&w->walk, w->walk.at);
    w->is_hatched = !err && seen->changed > 0;
    if (w->is_hatched)
        due_in(w, HATCHED_MS);
    else if (!err && w->plays)
        due_in(w, PAUSE_MS);
    return err;
}

/* To the step, which is asked for first where that is wanted. */
static enum err go(struct watching *w, size_t step, struct fault *fault)
{
    if (step > count_of(w))
        return show_end(w, fault);
    enum err err = OK;
    if (w->asks)
        err = show(w, step, STEP_HIDDEN, fault);
    if (!err && w->asks && own_turn_can_be_asked(&w->walk, step))
        return OK;
    w->is_asked = false;
    return err ? err : draw(w, step, fault);
}

static enum err on(struct watching *w, int64_t by, struct fault *fault)
{
    if (w->is_asked) { /* it is passed over */
        w->turns.passed++;
        return draw(w, w->walk.at, fault);
    }
    if (w->walk.at && w->walk.phase == STEP_DRAWN) {
        const enum err err = carry_out(w, fault);
        if (err || by == 1)
            return err;
        by--;
    }
    return w->is_over_end ? OK : go(w, step_beyond(w, by), fault);
}

static enum err back(struct watching *w, int64_t by, struct fault *fault)
{
    w->plays = false;
    return show(w, step_beyond(w, -by), STEP_AFTER, fault);
}

static enum err go_on(struct watching *w, struct fault *fault)
{
    w->due_ns = 0;
    if (w->walk.at && w->walk.phase == STEP_DRAWN)
        return carry_out(w, fault);
    if (w->is_hatched) {
        w->is_hatched = false;
        if (w->plays)
            due_in(w, PAUSE_MS);
        return OK;
    }
    return w->plays ? on(w, 1, fault) : OK;
}

static enum err to(struct watching *w, const char *at, struct fault *fault)
{
    int64_t step;
    if (strcmp(at, "last") == 0)
        return show_end(w, fault);
    if (!scan_integer(&at, 0, INT64_MAX, &step) || *at || (uint64_t)step > count_of(w))
        return fault_set(fault, ERR_USAGE, "expected a step 0..%zu", count_of(w));
    return step ? go(w, (size_t)step, fault) : show(w, 0, STEP_BEFORE, fault);
}

/* ---- looking for steps ---- */

/* What `at` says, else that of the step that is shown. */
static int label_wanted(const struct watching *w, const char *at)
{
    int64_t label;
    const struct step_seen *seen = walkthrough_seen(&w->walk, w->walk.at);
    if (*at == ' ' && at++ && scan_integer(&at, 0, 255, &label) && !*at)
        return (int)label;
    return seen ? seen->label : STEP_NO_LABEL;
}

static enum err find_label(struct watching *w, const char *at, int by, struct fault *fault)
{
    const int label = label_wanted(w, at);
    if (label == STEP_NO_LABEL)
        return fault_set(fault, ERR_USAGE, "this step is of no label: 2n is the next of label 2");
    for (size_t step = step_beyond(w, by); step && step <= count_of(w);) {
        /* Which label it is about is known once it has been carried out. */
        const enum err err = step > w->walk.done ? show(w, step, STEP_AFTER, fault) : OK;
        if (err)
            return err;
        const struct step_seen *seen = walkthrough_seen(&w->walk, step);
        if (seen->label == label && seen->has_place)
            return draw(w, step, fault);
        do
            step = (size_t)((int64_t)step + by);
        while (step && step <= count_of(w) && !is_shown(w, step));
    }
    return fault_set(fault, ERR_INPUT, "there is no step of label %d %s this one", label,
                     by > 0 ? "after" : "before");
}

static enum err find_largest(struct watching *w, struct fault *fault)
{
    size_t found = 0;
    uint64_t most = 0;
    enum err err = walkthrough_finish(&w->walk, fault);
    for (size_t step = 1; step <= w->walk.done; step++) {
        const struct step_seen *seen = walkthrough_seen(&w->walk, step);
        if (is_shown(w, step) && seen->changed > most) {
            most = seen->changed;
            found = step;
        }
    }
    if (err && !w->walk.has_ended)
        return err;
    return found ? draw(w, found, fault)
                 : fault_set(fault, ERR_INPUT, "no step has given a voxel another label");
}

/* ---- lines ---- */

static enum err change_speed(struct watching *w, bool faster, struct buf *output)
{
    if (faster && w->speed < SPEED_MOST)
        w->speed *= 2;
    else if (!faster && w->speed > SPEED_LEAST)
        w->speed /= 2;
    buf_printf(output, "speed x%g\n", w->speed / (double)QUARTERS);
    return OK;
}

static enum err step_line(struct watching *w, const char *at, struct buf *output,
                          struct fault *fault)
{
    int64_t by = 1;
    const bool is_on = scan_text(&at, "on "), is_back = !is_on && scan_text(&at, "back ");
    if ((is_on || is_back) && scan_integer(&at, 1, 1000000, &by) && !*at)
        return is_on ? on(w, by, fault) : back(w, by, fault);
    if (strcmp(at, "due") == 0)
        return go_on(w, fault);
    if (scan_text(&at, "to "))
        return to(w, at, fault);
    if (scan_text(&at, "next"))
        return find_label(w, at, 1, fault);
    if (scan_text(&at, "previous"))
        return find_label(w, at, -1, fault);
    if (strcmp(at, "largest") == 0)
        return find_largest(w, fault);
    if (strcmp(at, "faster") == 0 || strcmp(at, "slower") == 0)
        return change_speed(w, *at == 'f', output);
    if (strcmp(at, "comments") == 0) {
        step_words_comments(output, &w->walk, w->walk.at);
        buf_add_text(output, output->length ? "" : "this step has no comment\n");
    } else if (strcmp(at, "undone") == 0) {
        w->skips = !w->skips;
        buf_add_text(output, w->skips ? "what was undone or given up is skipped\n"
                                      : "what was undone or given up is shown too\n");
    } else if (strcmp(at, "play") == 0) {
        w->plays = !w->plays && !w->is_over_end;
        w->due_ns = w->plays ? clock_ns() : 0;
        if (!w->plays)
            buf_add_text(output, "it stands still\n");
    } else {
        return fault_set(fault, ERR_USAGE, "step: expected on, back, to, next, previous, play ..");
    }
    return OK;
}

static enum err answer(struct watching *w, const char *line, struct fault *fault)
{
    enum err err = own_turn_take(&w->turn, &w->walk, w->walk.at, line, fault);
    if (!err)
        err = own_turns_add(&w->turns, &w->turn, fault);
    if (err)
        return err;
    w->is_answered = true;
    const bool plays = w->plays;
    err = show(w, w->walk.at, STEP_DRAWN, fault);
    if (plays)
        due_in(w, ANSWER_MS);
    return err;
}

static bool plants(const char *line)
{
    return scan_text(&line, "seed ");
}

static enum err execute(void *context, const char *line, struct buf *output, struct fault *fault)
{
    struct watching *w = context;
    const char *at = line;
    enum err err;
    console_forget_interrupt();
    if (scan_text(&at, "step ")) {
        err = step_line(w, at, output, fault);
    } else if (plants(line) && w->is_asked) {
        err = answer(w, line, fault);
    } else if (plants(line)) {
        err = fault_set(fault, ERR_USAGE,
                        w->asks ? "it is not your turn: the next step, please"
                                : "nothing is planted here; `iftty watch --quiz` asks you to");
    } else {
        err = interpreter_look(w->pilot.interp, line, &w->reply, fault);
        buf_add_text(output, buf_text(err ? &w->reply.list : &w->reply.text));
    }
    console_erase_progress();
    w->pilot.own = w->is_answered ? w->turn.place : NULL;
    w->pilot.former = w->is_hatched ? walkthrough_former(&w->walk) : NULL;
    return err;
}

static enum err sketch(void *context, const char *line, struct fault *fault)
{
    (void)context, (void)line;
    return fault_set(fault, ERR_USAGE, "nothing is drawn here");
}

static enum err drop(void *context, struct fault *fault)
{
    (void)context, (void)fault;
    return OK;
}

static bool finished(void *context)
{
    const struct watching *w = context;
    return w->pilot.interp->wish == WISH_QUIT;
}

static uint64_t due_ns(void *context)
{
    return ((const struct watching *)context)->due_ns;
}

/* ---- below the picture ---- */

static void add_what(struct buf *out, const struct watching *w)
{
    if (w->is_over_end) {
        step_words_verdict(out, &w->walk);
    } else if (w->is_asked) {
        buf_add_text(out, "go where the next gesture belongs; i plants the brush there, s2 label "
                          "2; Space passes");
    } else if (w->is_answered) {
        own_turn_words(out, &w->walk, &w->turn);
    } else if (w->walk.at && w->walk.phase == STEP_DRAWN) {
        const struct step_seen *seen = walkthrough_seen(&w->walk, w->walk.at);
        buf_add_text(out, "drawn, and not carried out yet");
        if (seen->has_place)
            buf_printf(out, ": at %u,%u,%u", seen->place[0], seen->place[1], seen->place[2]);
        if (seen->label != STEP_NO_LABEL) {
            buf_add_text(out, seen->has_place ? ", label " : ": label ");
            label_report_write_name(out, w->pilot.interp->session, (unsigned)seen->label);
        }
    } else {
        step_words_change(out, &w->walk, w->walk.at);
    }
}

static void caption(void *context, struct buf *lines)
{
    const struct watching *w = context;
    struct buf comments = {0};
    if (w->is_asked)
        buf_printf(lines, "YOUR TURN, before step %zu of %zu", w->walk.at, count_of(w));
    else if (w->is_over_end)
        buf_printf(lines, "the end: %zu step%s, %zu record%s", count_of(w), plural(count_of(w)),
                   w->walk.list.records, plural(w->walk.list.records));
    else
        step_words_title(lines, &w->walk, w->walk.at);
    if (w->plays)
        buf_printf(lines, "  playing x%g", w->speed / (double)QUARTERS);
    buf_add_char(lines, '\n');
    add_what(lines, w);
    buf_add_char(lines, '\n');
    if (w->is_over_end && w->asks)
        own_turns_words(lines, &w->turns);
    else if (!w->is_asked && !w->is_over_end)
        step_words_comments(&comments, &w->walk, w->walk.at);
    for (size_t i = 0; i + 1 < comments.length; i++)
        buf_add_char(lines, comments.data[i] == '\n' ? ' ' : comments.data[i]);
    buf_release(&comments);
}

void watch_host_fill(struct pilot_host *host, struct watching *watching)
{
    *host = (struct pilot_host){.context = watching,
                                .execute = execute,
                                .sketch = sketch,
                                .drop = drop,
                                .finished = finished,
                                .caption = caption,
                                .due_ns = due_ns};
    pilot_host_fill(host);
    watching->pilot.watches = true;
    watching->speed = QUARTERS;
}

void watching_release(struct watching *watching)
{
    walkthrough_release(&watching->walk);
    own_turns_release(&watching->turns);
    reply_release(&watching->reply);
    pilot_interpreter_release(&watching->pilot);
}
