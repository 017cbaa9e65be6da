/* What a session hands on in files: maps, surfaces, seeds, and the names of labels. */
#include "command/act.h"

#include "base/file.h"
#include "image/surface_file.h"
#include "report/export_map.h"
#include "report/label_table.h"
#include "session/numbering.h"
#include "session/semantics.h"
#include "session/session.h"
#include "session/tally.h"
#include "show/draw.h"

enum err act_check_report(const struct value *file, struct fault *fault)
{
    if (!file->given || file_is_named(file->text, ".json|.csv"))
        return OK;
    return fault_set(fault, ERR_USAGE, "report: expected a name that ends in .json or .csv, not %s",
                     file->text);
}

enum err act_write_text(const struct act *act, const struct value *file,
                        const struct value *replace, const struct buf *text)
{
    const enum file_mode mode = act_file_mode(replace);
    struct buf path = {0};
    enum err err = text->failed
                       ? fault_memory(act->fault, "a report")
                       : interpreter_output_path(act->interp, file->text, &path, act->fault);
    if (!err && path.length)
        err = interpreter_will_write(act->interp, buf_text(&path), mode, act->fault);
    if (!err && path.length)
        err = file_write(buf_text(&path), buf_text(text), text->length, mode, act->fault);
    if (!err && path.length)
        act_write_file_line("wrote ", buf_text(&path), act->reply);
    buf_release(&path);
    return err;
}

/* The places of the parameters in the table; what is saved comes after the maps. */
enum { WHAT, FILE_NAME, REPLACE, FINISHED, LABEL, SMOOTH, TRIANGLES, EMPTY };
enum { SAVE_SEEDS = MAP_MARGIN + 1, SAVE_NAMES, SAVE_SURFACE };

static enum err save_seeds(const struct act *act, const char *path, enum file_mode how)
{
    struct buf text = {0};
    enum err err = OK;
    if (!file_is_named(path, ".csv"))
        return fault_set(act->fault, ERR_USAGE, "cannot write %s: expected FILE.csv for seeds",
                         path);
    err = export_seeds(&text, act->session, act->fault);
    if (!err)
        err = file_write(path, text.data, text.length, how, act->fault);
    buf_release(&text);
    return err;
}

static enum err save_names(const struct act *act, const char *path, enum file_mode how)
{
    enum label_table_format format;
    bool used[256];
    struct buf text = {0};
    if (!label_table_ending(path, &format))
        return fault_set(act->fault, ERR_USAGE,
                         "cannot write %s: expected .txt or .label for ITK-SNAP, .ctab for "
                         "FreeSurfer, .ctbl for 3D Slicer, .nii.txt or .lut for mricron",
                         path);
    const struct kept *kept = session_kept(act->session);
    if (format == TABLE_LUT && numbering_is_used(kept))
        return fault_set(act->fault, ERR_USAGE,
                         "cannot write %s: labels have numbers of their own, and a .lut holds 0 to "
                         "255; expected .txt, .label, .ctbl, .ctab or .nii.txt",
                         path);
    enum err err = session_count_labels(act->session, act->fault);
    for (int l = 0; l < 256; l++)
        used[l] = session_tally(act->session)->voxels[l] > 0 || *kept->label_name[l];
    if (!err)
        err = numbering_check(kept, used, act->fault);
    label_table_write(&text, format, session_kept(act->session), used);
    if (!err && text.failed)
        err = fault_memory(act->fault, "the names of labels");
    if (!err)
        err = file_write(path, text.data, text.length, how, act->fault);
    buf_release(&text);
    return err;
}

/* Those that mean nothing to what is saved are refused. */
static enum err check_parameters(const struct act *act)
{
    const struct value *value = act->value;
    const int64_t what = value[WHAT].number;
    if (what == SAVE_SURFACE && !value[EMPTY].given)
        return surface_file_check(value[FILE_NAME].text, act->fault);
    if (value[FINISHED].given && what != MAP_LABELS)
        return fault_set(act->fault, ERR_USAGE,
                         "finished: of labels alone, and of surfaces (`save labels FILE "
                         "finished=yes`)");
    if (value[EMPTY].given && what != MAP_LABELS)
        return fault_set(act->fault, ERR_USAGE, "empty: of `save labels` alone");
    if (value[LABEL].given || value[SMOOTH].given || value[TRIANGLES].given)
        return fault_set(act->fault, ERR_USAGE,
                         "label=, smooth= and triangles= are for `save surface`, not for %s",
                         value[WHAT].text);
    return OK;
}

static enum err save(const struct act *act, const struct labels *labels, const char *path)
{
    const enum file_mode how = act_file_mode(&act->value[REPLACE]);
    const int64_t what = act->value[WHAT].number;
    const enum err err = interpreter_will_write(act->interp, path, how, act->fault);
    if (err)
        return err;
    return what == SAVE_SEEDS   ? save_seeds(act, path, how)
           : what == SAVE_NAMES ? save_names(act, path, how)
           : what == SAVE_SURFACE
               ? act_save_surface(act, labels, path, how)
               : export_map(act->session, (enum map)what, labels, path, how, act->fault);
}

/* Of a map of labels: voxels with a label above 0, and those that no seed reaches, for they are
 * outside the region of interest or not. */
struct coverage {
    uint64_t labelled, outside, unreached;
};

static struct coverage cover(const struct session *session, const struct labels *labels)
{
    const struct grid *grid = &session_scene(session)->grid;
    struct coverage count = {0};
    struct task task = task_begin(session_watch(session), "counting", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const struct cell *cell = session_scene(session)->cell + c;
                const bool is_outside = cell->flags & CELL_OUTSIDE;
                count.labelled += labels_at(labels, c) > 0;
                count.outside += is_outside;
                count.unreached += !is_outside && !cell_is_reached(cell);
            }
        }
    return count;
}

/* A map without a label would be taken for an answer by who reads it. */
static enum err check_labels(const struct act *act, const struct coverage *coverage)
{
    if (coverage->labelled || act_is_yes(&act->value[EMPTY]) ||
        !semantics_has(session_semantics(act->session), MEANING_WHOLE_LABELS))
        return watch_fault(session_watch(act->session), act->fault);
    return fault_set(
        act->fault, ERR_INPUT,
        "no voxel has a label above 0: plant a `seed` of one first, or write the empty "
        "map with empty=yes; nothing was written");
}

static void warn_of_background(struct buf *out, uint64_t voxels, const char *which)
{
    if (voxels)
        buf_printf(out, "%llu voxel%s %s %s no label\n", (unsigned long long)voxels, plural(voxels),
                   which, voxels == 1 ? "has" : "have");
}

/* What a user might not expect of what was written. */
static void warn(const struct act *act, const char *path, const struct coverage *coverage)
{
    const struct session *session = act->session;
    const int64_t what = act->value[WHAT].number;
    warn_of_background(&act->reply->text, coverage->unreached, "that no seed reaches");
    warn_of_background(&act->reply->text, coverage->outside, "outside the region of interest");
    if (volume_ending(path) && !geometry_has_place(session_geometry(session)))
        buf_add_text(&act->reply->text,
                     "where it lies is as unknown in it as in the scene's file\n");
    if ((what == MAP_LABELS || what == SAVE_SURFACE) && !act->value[FINISHED].given &&
        session_shows_finished(session))
        buf_add_text(&act->reply->text, "it has the labels of the forest; `finished=yes` writes "
                                        "those that pictures show\n");
}

enum err act_save(const struct act *act)
{
    const int64_t what = act->value[WHAT].number;
    struct coverage coverage = {0};
    struct buf path = {0};
    struct labels labels;
    enum err err = check_parameters(act);
    if (!err)
        err = session_run(act->session, act->fault);
    if (!err)
        err = act_take_labels(act, &act->value[FINISHED], &labels);
    if (!err)
        err = interpreter_output_path(act->interp, act->value[FILE_NAME].text, &path, act->fault);
    if (!err && path.length) {
        const bool has_labels = what == MAP_LABELS || what == SAVE_SURFACE;
        if (has_labels)
            coverage = cover(act->session, &labels);
        if (what == MAP_LABELS)
            err = check_labels(act, &coverage);
        if (!err)
            err = save(act, &labels, buf_text(&path));
        if (!err)
            act_write_file_line("wrote ", buf_text(&path), act->reply);
        if (!err)
            warn(act, buf_text(&path), &coverage);
    }
    buf_release(&path);
    return err;
}
