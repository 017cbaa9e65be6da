#include "verify/diff_side.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/process.h"
#include "verify/difference_picture.h"
#include "verify/replay_file.h"
#include "session/session.h"
#include "session/state.h"

enum { SIDE_MOST = 16384, /* of a picture */ FRAME_MOST = 4 * SIDE_MOST * SIDE_MOST };

/* ---- in its process ---- */

struct work {
    const struct diff_options *options;
    int which;                     /* 0: A */
    const struct diff_side *other; /* B, for A's picture; or NULL */
};

static void copy_labels(uint8_t *label, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                *label++ = scene->cell[c].label;
        }
}

/* A journal that was edited by hand, and gives the results it records, is taken with a warning. */
static enum err carry_out(struct interpreter *interp, const struct work *work,
                          struct diff_facts *facts, struct fault *fault)
{
    const struct diff_options *o = work->options;
    struct replay_report report = {0};
    enum err err =
        replay_file(interp, o->path[work->which], 0, o->last, NULL, NULL, &report, fault);
    facts->is_edited = !report.is_intact;
    facts->is_torn = report.is_torn;
    if (err == ERR_CHECK && report.outcome == REPLAY_SAME)
        err = OK;
    if (err == ERR_CHECK)
        err = fault_prefix(fault, ERR_CHECK,
                           "it gives other results than it records; see iftty verify");
    if (!err && !session_has_scene(interp->session))
        err = fault_set(fault, ERR_INPUT, "it opens no scene");
    replay_report_release(&report);
    return err;
}

static void note_facts(struct diff_facts *facts, const struct session *session)
{
    memcpy(facts->size, session_scene(session)->grid.size, sizeof facts->size);
    memcpy(facts->proof, session_proof(session), sizeof facts->proof);
    memcpy(facts->label_name, session_kept(session)->label_name, sizeof facts->label_name);
    facts->palette = session_kept(session)->palette;
    facts->scene_digest = session_scene_digest(session);
    facts->voxels = session_scene(session)->grid.voxels;
    facts->pending = session_pendings(session);
}

/* Names and colours of labels that A has none of are B's. */
static void borrow(struct kept *kept, const struct diff_facts *other, const struct overlap *overlap)
{
    for (int label = 1; label < 256; label++) {
        if (overlap->a[label])
            continue;
        memcpy(kept->palette.rgb[label], other->palette.rgb[label], 3);
        if (!kept->label_name[label][0])
            memcpy(kept->label_name[label], other->label_name[label], LABEL_NAME_BYTES);
    }
}

static enum err draw(struct picture *picture, struct session *session, const struct work *work,
                     const uint8_t *label, struct fault *fault)
{
    struct overlap overlap;
    overlap_count(&overlap, label, work->other->labels, session_scene(session)->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {file_name(work->options->path[0]), file_name(work->options->path[1])},
        .label = {label, work->other->labels},
        .overlap = &overlap};
    struct state next = *session_state(session);
    borrow(&next.kept, work->other->facts, &overlap);
    const enum err err = session_go(session, &next, NULL, 0, fault);
    return err ? err : difference_picture_draw(picture, session, &difference_picture, fault);
}

/* Labels and picture to `out`, after the facts. */
static enum err hand_back(struct buf *out, struct session *session, const struct work *work,
                          struct diff_facts *facts, struct fault *fault)
{
    const size_t voxels = session_scene(session)->grid.voxels;
    struct picture picture = {0};
    uint8_t *label = buf_reserve(out, voxels);
    if (!label)
        return fault_memory(fault, "labels");
    copy_labels(label, session_scene(session));
    out->length += voxels;
    note_facts(facts, session);
    if (!work->other || memcmp(work->other->facts->size, facts->size, sizeof facts->size) != 0)
        return OK;
    const enum err err = draw(&picture, session, work, label, fault);
    if (!err) {
        facts->picture_width = picture.width;
        facts->picture_height = picture.height;
        buf_add(out, picture.rgba, (size_t)4 * picture.width * picture.height);
    }
    picture_release(&picture);
    return err;
}

static void carry_out_one(void *context, size_t number, struct buf *out)
{
    (void)number;
    const struct work *work = context;
    const struct diff_options *o = work->options;
    struct interpreter interp;
    struct fault fault = {0};
    struct diff_facts *facts = mem_new(sizeof *facts);
    if (!facts)
        return;
    buf_add(out, facts, sizeof *facts);
    facts->err = interpreter_init(&interp, &fault);
    interp.scene_path = o->scene_path;
    if (!facts->err && o->begin)
        facts->err = o->begin(o->context, o->path[work->which], &fault);
    if (!facts->err)
        facts->err = carry_out(&interp, work, facts, &fault);
    if (!facts->err)
        facts->err = hand_back(out, interp.session, work, facts, &fault);
    memcpy(facts->why, fault.text, sizeof facts->why);
    if (!out->failed)
        memcpy(out->data, facts, sizeof *facts);
    free(facts);
    interpreter_release(&interp);
}

/* ---- from outside ---- */

/* What came back is of the form it should be, whatever has become of the process. */
static bool is_whole(const struct diff_facts *f, size_t length)
{
    const uint64_t pixels = (uint64_t)f->picture_width * f->picture_height;
    const uint64_t voxels = (uint64_t)f->size[0] * f->size[1] * f->size[2];
    return f->picture_width <= SIDE_MOST && f->picture_height <= SIDE_MOST &&
           f->size[0] <= UINT16_MAX && f->size[1] <= UINT16_MAX && f->size[2] <= UINT16_MAX &&
           voxels == f->voxels && voxels <= UINT32_MAX && length - sizeof *f == voxels + 4 * pixels;
}

static void end_texts(struct diff_facts *f)
{
    f->why[sizeof f->why - 1] = f->proof[sizeof f->proof - 1] = '\0';
    for (int label = 0; label < 256; label++)
        f->label_name[label][LABEL_NAME_BYTES - 1] = '\0';
}

static enum err judge(struct diff_side *side, struct fault *fault)
{
    struct diff_facts *f = (struct diff_facts *)(void *)side->bytes.data;
    if (side->bytes.length < sizeof *f)
        return fault_memory(fault, "labels");
    end_texts(f);
    /* Status 1 stands for a difference between the two, and for nothing else. */
    if (f->err > OK && f->err <= ERR_CANCELLED)
        return fault_set(fault, f->err == ERR_CHECK ? ERR_INPUT : f->err, "%s", f->why);
    if (f->err || !is_whole(f, side->bytes.length))
        return fault_set(fault, ERR_INPUT, "its process hands back what makes no sense");
    side->facts = f;
    side->labels = (const uint8_t *)(f + 1);
    side->pixels = side->labels + f->voxels;
    return OK;
}

enum err diff_side_carry_out(struct diff_side *side, const struct diff_options *options, int which,
                             const struct diff_side *other, struct fault *fault)
{
    struct work work = {options, which, other};
    const struct processes how = {.work = carry_out_one,
                                  .context = &work,
                                  .most =
                                      (uint64_t)sizeof(struct diff_facts) + UINT32_MAX + FRAME_MOST,
                                  .watch = options->watch};
    enum err err = process_run(&side->bytes, &how, fault);
    if (!err)
        err = judge(side, fault);
    return err && err != ERR_CANCELLED ? fault_prefix(fault, err, "%s", options->path[which]) : err;
}

void diff_side_release(struct diff_side *side)
{
    buf_release(&side->bytes);
}
