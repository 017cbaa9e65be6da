/* SPDX-License-Identifier: MIT */
#include "steps/own_turn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/command.h"
#include "command/execute.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "image/geometry.h"
#include "show/label_report.h"
#include "command/limits.h"
#include "steps/step_words.h"

bool own_turn_can_be_asked(const struct walkthrough *w, size_t step)
{
    const struct step_seen *seen = walkthrough_seen(w, step);
    struct edits seeds;
    const bool plants = seen && seen->is_ball && !walkthrough_seeds(w, step, &seeds, NULL);
    const bool can = plants && edits_count(&seeds) > 0;
    if (plants)
        edits_release(&seeds);
    return can;
}

/* ---- what gestures change ---- */

struct comparing {
    const struct scene *scene;
    uint8_t *without, *theirs; /* [cells] labels without either gesture, and with the journal's */
    struct own_turn *turn;
};

static void keep(uint8_t *label, const struct scene *scene)
{
    const struct labels labels = labels_of_forest(scene);
    labels_copy_row(&labels, (struct span){0, (uint32_t)scene->grid.cells}, label);
}

static void keep_without(void *context)
{
    const struct comparing *c = context;
    keep(c->without, c->scene);
}

static void keep_theirs(void *context)
{
    const struct comparing *c = context;
    keep(c->theirs, c->scene);
}

static void count_own(void *context)
{
    const struct comparing *c = context;
    for (size_t i = 0; i < c->scene->grid.cells; i++) {
        scene_fetch_ahead(c->scene, i);
        const uint8_t own = c->scene->cell[i].label;
        const bool own_changes = own != c->without[i], changes = c->theirs[i] != c->without[i];
        c->turn->own += own_changes;
        c->turn->theirs += changes;
        c->turn->both += own_changes && changes && own == c->theirs[i];
    }
}

/* ---- how far apart they are ---- */

static enum err find_distance(struct own_turn *turn, const struct walkthrough *w, size_t step,
                              struct fault *fault)
{
    const struct session *session = w->interp->session;
    const struct geometry *geometry = session_geometry(session);
    double own[3], there[3], least = INFINITY;
    struct edits seeds;
    const enum err err = walkthrough_seeds(w, step, &seeds, fault);
    geometry_point(geometry, turn->place, own);
    for (size_t i = 0; !err && i < edits_count(&seeds); i++) {
        uint32_t place[3];
        double square = 0;
        grid_find(&session_scene(session)->grid, edits_first(&seeds)[i].cell, place);
        geometry_point(geometry, place, there);
        for (int a = 0; a < 3; a++)
            square += (there[a] - own[a]) * (there[a] - own[a]);
        least = square < least ? square : least;
    }
    turn->has_length = !session_scene(session)->spacing_unknown;
    turn->apart_mm = sqrt(least);
    edits_release(&seeds);
    return err;
}

static enum err read_own(struct own_turn *turn, const struct session *session, const char *line,
                         struct fault *fault)
{
    struct call call;
    enum err err = command_parse(&call, line, session, fault);
    if (err)
        return err;
    const unsigned both = COMMAND_PLANTS | COMMAND_SKETCHED; /* which a seed is */
    if (call.command && (call.command->flags & both) == both) {
        memcpy(turn->place, call_value(&call, "PLACE")->place, sizeof turn->place);
        turn->label = (int)call_value(&call, "LABEL")->number;
    } else {
        err = fault_set(fault, ERR_USAGE, "your turn takes a seed: its label at the cross-hair");
    }
    call_release(&call);
    return err;
}

enum err own_turn_take(struct own_turn *turn, struct walkthrough *w, size_t step, const char *line,
                       struct fault *fault)
{
    struct interpreter *interp = w->interp;
    struct comparing c = {.scene = session_scene(interp->session), .turn = turn};
    const size_t cells = c.scene->grid.cells;
    *turn = (struct own_turn){.wanted = walkthrough_seen(w, step)->label};
    enum err err = read_own(turn, interp->session, line, fault);
    if (err)
        return err;
    c.without = mem_array(cells, 1);
    c.theirs = mem_array(cells, 1);
    if (!c.without || !c.theirs)
        err = fault_memory(fault, "what two gestures change");
    limits_rest(false);
    if (!err)
        err = interpreter_try(interp, "", keep_without, &c, fault);
    if (!err)
        err = interpreter_try(interp, w->list.text.data + walkthrough_step(w, step)->command,
                              keep_theirs, &c, fault);
    if (!err)
        err = interpreter_try(interp, line, count_own, &c, fault);
    limits_rest(true);
    free(c.without);
    free(c.theirs);
    return err ? err : find_distance(turn, w, step, fault);
}

/* ---- words ---- */

static void add_distance(struct buf *out, double apart, bool has_length)
{
    if (has_length)
        buf_printf(out, "%.1f mm", apart);
    else
        buf_printf(out, "%.1f voxels", apart);
}

void own_turn_words(struct buf *out, const struct walkthrough *w, const struct own_turn *turn)
{
    add_distance(out, turn->apart_mm, turn->has_length);
    buf_add_text(out, " away, label ");
    if (turn->label == turn->wanted) {
        buf_add_text(out, "right");
    } else {
        label_report_write_name(out, w->interp->session, (unsigned)turn->label);
        buf_add_text(out, ", not ");
        label_report_write_name(out, w->interp->session, (unsigned)turn->wanted);
    }
    buf_printf(out, ", overlap %.2f: ", own_turn_overlap(turn));
    step_words_volume(out, w, turn->own);
    buf_add_text(out, ", theirs ");
    step_words_volume(out, w, turn->theirs);
}

enum err own_turns_add(struct own_turns *turns, const struct own_turn *turn, struct fault *fault)
{
    if (!mem_grow(&turns->turn, &turns->capacity, turns->count + 1, sizeof *turns->turn))
        return fault_memory(fault, "your turns");
    turns->turn[turns->count++] = *turn;
    return OK;
}

void own_turns_release(struct own_turns *turns)
{
    free(turns->turn);
    *turns = (struct own_turns){0};
}

static int by_distance(const void *a, const void *b)
{
    const struct own_turn *x = a, *y = b;
    return (x->apart_mm > y->apart_mm) - (x->apart_mm < y->apart_mm);
}

void own_turns_words(struct buf *out, const struct own_turns *turns)
{
    const size_t n = turns->count;
    size_t right = 0;
    double overlap = 0;
    buf_printf(out, "%zu of %zu gesture%s tried", n, n + turns->passed, plural(n + turns->passed));
    if (!n)
        return;
    qsort(turns->turn, n, sizeof *turns->turn, by_distance);
    for (size_t i = 0; i < n; i++) {
        right += turns->turn[i].label == turns->turn[i].wanted;
        overlap += own_turn_overlap(turns->turn + i);
    }
    buf_printf(out, ": labels right %zu, median distance ", right);
    add_distance(out, turns->turn[n / 2].apart_mm, turns->turn[0].has_length);
    buf_printf(out, ", mean overlap %.2f", overlap / (double)n);
}
