/* SPDX-License-Identifier: MIT */
#include "verify/side.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "command/interpreter.h"
#include "engine/scene.h"
#include "session/map.h"
#include "session/session.h"
#include "verify/process.h"
#include "verify/replay_file.h"

enum { ALIGNMENT = 8 };

/* End of the labels, where the additional data begins. */
static size_t labels_end(size_t voxels)
{
    return (voxels + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* ---- in the process of the journal ---- */

struct task_at_hand {
    const char *path;
    const struct side_options *options;
    const struct side_work *work;
};

static enum err carry_out(struct interpreter *interp, const struct task_at_hand *task,
                          struct side_facts *facts, struct fault *fault)
{
    const struct listener listener = {task->work->context, task->work->hear};
    OWNED(replay_report_release) struct replay_report report = {0};
    interp->listener = listener.hear ? &listener : NULL;
    const bool is_strict = task->options->is_strict;
    enum err err =
        replay_file(interp, task->path, 0, task->options->last, NULL, NULL, &report, fault);
    interp->listener = NULL;
    facts->is_edited = !report.is_intact;
    facts->is_torn = report.is_torn;
    facts->chain = report.chain;
    if (err == ERR_CHECK && report.outcome == REPLAY_SAME && !is_strict)
        err = OK;
    if (err == ERR_CHECK)
        err = fault_prefix(fault, ERR_CHECK,
                           "its results differ from the recorded ones%s; see iftty verify",
                           is_strict ? ", or was edited" : "");
    if (!err && is_strict && !report.is_journal)
        err = fault_set(fault, ERR_INPUT,
                        "it is a script; `iftty run FILE --journal NAME` makes a journal of it");
    if (!err && !interp->session->has_scene)
        err = fault_set(fault, ERR_INPUT, "it opens no scene");
    return err;
}

/* Fill the facts, and append labels and additional data to `out`. */
static enum err hand_back(struct buf *out, const struct interpreter *interp,
                          const struct side_work *work, struct side_facts *facts,
                          struct fault *fault)
{
    const struct session *session = interp->session;
    const struct kept *kept = &session->now.kept;
    const struct labels labels = labels_of_forest(session->scene);
    const struct grid *grid = &labels.scene->grid;
    const size_t voxels = grid->voxels, end = labels_end(voxels);
    uint8_t *label = buf_reserve(out, end);
    if (!label)
        return fault_memory(fault, "labels");
    uint8_t *to = label;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w); to += grid->size[0])
        labels_copy_row(&labels, w.row, to);
    memset(to, 0, end - voxels);
    out->length += end;
    memcpy(facts->size, grid->size, sizeof facts->size);
    facts->is_private = session->is_private;
    memcpy(facts->proof, session->proof, sizeof facts->proof);
    memcpy(facts->label_name, kept->label_name, sizeof facts->label_name);
    numbering_fill(facts->label_number, kept);
    facts->palette = kept->palette;
    facts->scene_digest = session->scene_digest;
    facts->voxels = voxels;
    facts->pending = session_pendings(session);
    const size_t before = out->length;
    const enum err err =
        work->add ? work->add(work->context, interp, facts, label, out, fault) : OK;
    facts->more = out->length - before;
    return err || !out->failed ? err : fault_memory(fault, "the result of a journal");
}

static void carry_out_one(void *context, size_t number, struct buf *out)
{
    (void)number;
    const struct task_at_hand *task = context;
    const struct side_options *o = task->options;
    struct fault fault = {0};
    OWNED(mem_release) struct side_facts *facts = mem_new(sizeof *facts);
    if (!facts)
        return;
    buf_add(out, facts, sizeof *facts);
    OWNED(interpreter_release) struct interpreter interp;
    facts->err = interpreter_init(&interp, &fault);
    interp.scene_path = o->scene_path;
    interp.channel_path = o->channel_path;
    if (!facts->err && o->begin)
        facts->err = o->begin(o->context, task->path, &fault);
    if (!facts->err)
        facts->err = carry_out(&interp, task, facts, &fault);
    if (!facts->err)
        facts->err = hand_back(out, &interp, task->work, facts, &fault);
    memcpy(facts->why, fault.text, sizeof facts->why);
    if (!out->failed)
        memcpy(out->data, facts, sizeof *facts);
}

/* ---- in the parent ---- */

/* Check the form of the bytes, since the process is not trusted. */
static bool is_whole(const struct side_facts *f, size_t length)
{
    const uint64_t voxels = (uint64_t)f->size[0] * f->size[1] * f->size[2];
    return f->size[0] <= UINT16_MAX && f->size[1] <= UINT16_MAX && f->size[2] <= UINT16_MAX &&
           voxels && voxels == f->voxels && voxels <= UINT32_MAX && f->more <= length - sizeof *f &&
           length - sizeof *f - f->more == labels_end(f->voxels);
}

static enum err judge(struct side *side, bool is_strict, struct fault *fault)
{
    struct side_facts *f = (struct side_facts *)(void *)side->bytes.data;
    if (side->bytes.length < sizeof *f)
        return fault_memory(fault, "labels");
    f->why[sizeof f->why - 1] = f->proof[sizeof f->proof - 1] = '\0';
    f->chain.hex[RECORD_CHAIN_DIGITS] = '\0';
    for (int label = 0; label < 256; label++)
        f->label_name[label][LABEL_NAME_BYTES - 1] = '\0';
    /* Status 1 of a comparison means that the two differ, and nothing else. */
    if (f->err > OK && f->err <= ERR_CANCELLED)
        return fault_set(fault, f->err == ERR_CHECK && !is_strict ? ERR_INPUT : f->err, "%s",
                         f->why);
    if (f->err || !is_whole(f, side->bytes.length))
        return fault_set(fault, ERR_INPUT, "its process returned malformed data");
    side->facts = f;
    side->labels = (const uint8_t *)(f + 1);
    side->more = side->labels + labels_end(f->voxels);
    return OK;
}

enum err side_carry_out(struct side *side, const char *path, const struct side_options *options,
                        const struct side_work *work, struct fault *fault)
{
    static const struct side_work no_work;
    struct task_at_hand task = {path, options, work ? work : &no_work};
    const struct processes how = {.work = carry_out_one,
                                  .context = &task,
                                  .most = sizeof(struct side_facts) + UINT32_MAX + ALIGNMENT +
                                          task.work->most,
                                  .watch = options->watch,
                                  .what = "replaying"};
    enum err err = process_run(&side->bytes, &how, fault);
    if (!err)
        err = judge(side, options->is_strict, fault);
    return err == ERR_CANCELLED ? err : fault_prefix(fault, err, "%s", path);
}

void side_release(struct side *side)
{
    buf_release(&side->bytes);
}
