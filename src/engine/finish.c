/* SPDX-License-Identifier: MIT */
/* The table of steps, the list and its text form, and the steps on whole components: largest,
 * components and holes. */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/labels.h"

#define ROW(kind, name, by, takes, usual, uses, help)                                              \
    [FINISH_##kind] = {#name, FINISH_TAKES_##takes, usual, FINISH_USES_##uses, finish_##by},
const struct finish_row finish_table[] = {FINISH_LIST(ROW, ROW)};

enum err finish_make(uint8_t **label, const struct finish_list *list, const struct scene *scene,
                     struct team *team, struct relax_kept *kept, struct fault *fault)
{
    const size_t cells = scene->grid.cells;
    const struct labels forest = labels_of_forest(scene);
    *label = NULL;
    TRY(finish_check(list, scene, fault));
    struct finish_work work = {scene, team, mem_pages(cells), mem_pages(cells), kept};
    enum err err = work.label && work.next ? OK : fault_memory(fault, "finished labels");
    if (!err) {
        labels_copy(&forest, work.label, team);
        err = watch_fault(scene->watch, fault);
    }
    for (uint32_t i = 0; !err && i < list->count; i++)
        err = finish_table[list->step[i].kind].apply(&work, &list->step[i], fault);
    err = err ? err : watch_fault(scene->watch, fault);
    mem_pages_free(work.next, cells);
    if (err)
        mem_pages_free(work.label, cells);
    *label = err ? NULL : work.label;
    return err;
}

bool finish_uses_seeds(const struct finish_list *list)
{
    bool uses = false;
    for (uint32_t i = 0; i < list->count; i++)
        uses |= finish_table[list->step[i].kind].uses == FINISH_USES_SEEDS;
    return uses;
}

/* ---- limits ---- */

enum err finish_check(const struct finish_list *list, const struct scene *scene,
                      struct fault *fault)
{
    for (const struct finish_step *step = list->step; step < list->step + list->count; step++) {
        uint32_t reach[3] = {0};
        if (finish_table[step->kind].takes == FINISH_TAKES_RADIUS)
            finish_reach(reach, step, scene);
        for (int a = 0; a < 3; a++)
            if (reach[a] > FINISH_RADIUS_MOST)
                return fault_set(fault, ERR_LIMIT,
                                 "finish %s: the radius reaches %u voxels along %c; at most %d",
                                 finish_table[step->kind].name, reach[a], "xyz"[a],
                                 FINISH_RADIUS_MOST);
    }
    return OK;
}

/* ---- text form ---- */

void finish_write(struct buf *out, const struct finish_list *list, const uint32_t number[256])
{
    for (uint32_t i = 0; i < list->count; i++) {
        buf_add_text(out, i ? ", " : "");
        const struct finish_step *step = &list->step[i];
        const struct finish_row *row = &finish_table[step->kind];
        buf_add_text(out, row->name);
        if (row->takes == FINISH_TAKES_RADIUS && step->in_nm)
            buf_printf(out, " radius=%gmm", step->argument / 1e6);
        else if (row->takes == FINISH_TAKES_RADIUS)
            buf_printf(out, " radius=%u", step->argument);
        else if (row->takes == FINISH_TAKES_VOXELS)
            buf_printf(out, " voxels=%u", step->argument);
        else if (row->takes == FINISH_TAKES_SWEEPS)
            buf_printf(out, " sweeps=%u reach=%u", step->argument, step->reach);
        if (step->label != FINISH_ALL_LABELS)
            buf_printf(out, " label=%u", number[step->label]);
    }
    if (!list->count)
        buf_add_text(out, "none");
}

/* ---- common parts of steps ---- */

void finish_clear(struct finish_work *work)
{
    const struct grid *grid = &work->scene->grid;
    const size_t plane = (size_t)grid->step[2];
    struct task task = task_begin(work->scene->watch, "finished labels", grid->cells);
    for (size_t at = 0; at < grid->cells && task_advance(&task, plane / 16); at += plane)
        memset(work->next + at, 0, plane);
}

void finish_reach(uint32_t reach[3], const struct finish_step *step, const struct scene *scene)
{
    for (int a = 0; a < 3; a++)
        reach[a] = step->in_nm ? step->argument / scene->spacing_nm[a] : step->argument;
}

/* ---- bounding boxes of labels ---- */

void finish_box_include(struct finish_box *box, const struct finish_box *other)
{
    for (int a = 0; a < 3; a++) {
        box->first[a] = box->first[a] < other->first[a] ? box->first[a] : other->first[a];
        box->last[a] = box->last[a] > other->last[a] ? box->last[a] : other->last[a];
    }
}

struct finish_box finish_box_widen(const struct finish_box *box, uint32_t by,
                                   const struct finish_box *within)
{
    struct finish_box wide = *within;
    for (int a = 0; a < 3; a++) {
        if (box->first[a] > within->first[a] + by)
            wide.first[a] = box->first[a] - by;
        if (box->last[a] + by < within->last[a])
            wide.last[a] = box->last[a] + by;
    }
    return wide;
}

bool finish_box_contains(const struct finish_box *box, const struct finish_box *other)
{
    bool contains = true;
    for (int a = 0; a < 3; a++)
        contains = contains && other->first[a] >= box->first[a] && other->last[a] <= box->last[a];
    return contains;
}

struct boxing {
    const struct finish_work *work;
    const char *what;
    struct finish_box (*part)[256]; /* [workers] */
};

static void clear_boxes(struct finish_box box[256])
{
    for (unsigned label = 0; label < 256; label++)
        box[label] = finish_box_none();
}

static void find_part(void *context, unsigned worker)
{
    const struct boxing *boxing = context;
    const struct finish_work *work = boxing->work;
    const uint32_t length = work->scene->grid.size[0];
    struct grid_walk w = scene_walk(work->scene, boxing->what, work->team, worker);
    clear_boxes(boxing->part[worker]);
    while (grid_walk_next(&w)) {
        const uint8_t *row = work->label + w.row.first;
        for (uint32_t x = 0, end; x < length; x = end) {
            for (end = x + 1; end < length && row[end] == row[x];)
                end += end + 8 <= length && memcmp(row + end - 1, row + end, 8) == 0 ? 8 : 1;
            const struct finish_box run = {{x, w.y, w.z}, {end - 1, w.y, w.z}};
            finish_box_include(&boxing->part[worker][row[x]], &run);
        }
    }
}

enum err finish_find_boxes(struct finish_box box[256], const struct finish_work *work,
                           const char *what, struct fault *fault)
{
    const unsigned workers = team_size(work->team);
    struct boxing boxing = {work, what, mem_array(workers, sizeof *boxing.part)};
    if (!boxing.part)
        return fault_memory(fault, what);
    team_run(work->team, find_part, &boxing);
    clear_boxes(box);
    for (unsigned worker = 0; worker < workers; worker++)
        for (unsigned label = 0; label < 256; label++)
            finish_box_include(&box[label], &boxing.part[worker][label]);
    free(boxing.part);
    return OK;
}

/* ---- reassignment ---- */

struct reassigning {
    struct finish_work *work; /* work->next is 1 in voxels of pending components, else 0 */
    const struct components *pieces;
    bool *waits;
    uint16_t *taker; /* label assigned to each component in the current round */
};

enum { NO_LABEL = 256 };

static uint32_t count_faces(const struct finish_work *work, uint32_t first, uint32_t end,
                            uint32_t faces[256])
{
    for (uint32_t c = first; c < end; c++)
        faces[work->label[c]] += !work->next[c];
    return end - first;
}

/* Count the faces of a run, except those at the edge of the scene. */
static uint32_t count_run(const struct finish_work *work, const struct component_run *run,
                          uint32_t faces[256])
{
    const struct grid *grid = &work->scene->grid;
    const struct place p = grid_place(grid, run->first);
    const uint32_t at[3] = {p.x, p.y, p.z}, first = run->first, end = run->end;
    uint32_t looked = 2;
    if (p.x > 0)
        count_faces(work, first - 1, first, faces);
    if (p.x + (end - first) < grid->size[0])
        count_faces(work, end, end + 1, faces);
    for (int a = 1; a < 3; a++) {
        const uint32_t step = (uint32_t)grid->step[a];
        if (at[a] > 0)
            looked += count_faces(work, first - step, end - step, faces);
        if (at[a] + 1 < grid->size[a])
            looked += count_faces(work, first + step, end + step, faces);
    }
    return looked;
}

/* Find the label that is assigned to a component; NO_LABEL if it has no face that counts. */
static uint16_t find_new_label(const struct reassigning *g, const struct component *piece,
                               struct task *task)
{
    uint32_t faces[256] = {0}, most = 0;
    uint16_t taker = NO_LABEL;
    for (uint32_t r = piece->run; r != RUN_NONE; r = g->pieces->run[r].next)
        if (!task_advance(task, count_run(g->work, &g->pieces->run[r], faces)))
            return NO_LABEL;
    faces[piece->label] = 0;
    for (uint16_t label = 0; label < 256; label++)
        if (faces[label] > most) {
            most = faces[label];
            taker = label;
        }
    task_advance(task, 64);
    return taker;
}

/* Write a value at each voxel of a component. */
static void mark_piece(const struct components *pieces, const struct component *piece, uint8_t *at,
                       uint8_t value)
{
    for (uint32_t r = piece->run; r != RUN_NONE; r = pieces->run[r].next)
        memset(at + pieces->run[r].first, value, pieces->run[r].end - pieces->run[r].first);
}

/* Perform a round. False if no component was assigned a label, or the watch has stopped it. */
static bool reassign_round(const struct reassigning *g, unsigned taker, struct task *task)
{
    const struct components *pieces = g->pieces;
    bool any = false;
    for (size_t i = 0; i < pieces->count; i++)
        g->taker[i] = g->waits[i] ? find_new_label(g, &pieces->item[i], task) : NO_LABEL;
    for (size_t i = 0; i < pieces->count && task_advance(task, 1); i++) {
        if (g->taker[i] == NO_LABEL)
            continue;
        if (taker == FINISH_ALL_LABELS || taker == g->taker[i])
            mark_piece(pieces, &pieces->item[i], g->work->label, (uint8_t)g->taker[i]);
        mark_piece(pieces, &pieces->item[i], g->work->next, 0);
        g->waits[i] = false;
        any = true;
    }
    return any && task_advance(task, 1);
}

/* Choose the components that a step reassigns. */
static void choose_pieces(bool *waits, const struct components *found,
                          const struct finish_step *step)
{
    size_t largest[256];
    uint32_t voxels[256] = {0};
    for (size_t i = 0; i < found->count; i++) {
        const struct component *item = &found->item[i];
        if (item->voxels > voxels[item->label]) {
            voxels[item->label] = item->voxels;
            largest[item->label] = i;
        }
    }
    for (size_t i = 0; i < found->count; i++) {
        const struct component *item = &found->item[i];
        const bool may_go = item->label != 0 && finish_is_for(step, item->label);
        if (step->kind == FINISH_LARGEST)
            waits[i] = may_go && i != largest[item->label];
        else if (step->kind == FINISH_COMPONENTS)
            waits[i] = may_go && item->voxels < step->argument;
        else if (step->kind == FINISH_HOLES)
            waits[i] = item->label == 0 && !item->at_edge;
        else
            waits[i] = item->label != 0;
    }
}

enum err finish_reassign(struct finish_work *work, const uint8_t *of,
                         const struct finish_step *step, struct fault *fault)
{
    struct watch *watch = work->scene->watch;
    OWNED(components_release) struct components found;
    TRY(components_find(&found, &work->scene->grid, of, watch, fault));
    OWNED(mem_release) bool *waits = mem_array(found.count, sizeof *waits);
    OWNED(mem_release) uint16_t *taker = mem_array(found.count, sizeof *taker);
    if (!waits || !taker)
        return fault_memory(fault, "finished labels");
    struct reassigning reassigning = {work, &found, waits, taker};
    struct task task = task_begin(watch, "pieces of labels", 0);
    choose_pieces(waits, &found, step);
    finish_clear(work);
    for (size_t i = 0; i < found.count && task_advance(&task, 16); i++)
        if (waits[i])
            mark_piece(&found, &found.item[i], work->next, 1);
    while (reassign_round(&reassigning,
                          step->kind == FINISH_HOLES ? step->label : FINISH_ALL_LABELS, &task))
        ;
    return watch_fault(watch, fault);
}

enum err finish_pieces(struct finish_work *work, const struct finish_step *step,
                       struct fault *fault)
{
    return finish_reassign(work, work->label, step, fault);
}
