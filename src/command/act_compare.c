/* The command `compare`: the labels beside those of a file. A question: nothing is recorded. */
#include "command/act.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "report/comparison_picture.h"
#include "session/session.h"
#include "session/map.h"

/* The places of the parameters in the table. */
enum { FILE_NAME, REGIONS, AS, LABEL, AT, REPORT, PICTURE, REPLACE, FINISHED, RESAMPLE };

static enum err check_names(const struct act *act)
{
    const enum err err = act_check_report(&act->value[REPORT], act->fault);
    if (err)
        return err;
    if (act->value[AT].given && !act->value[PICTURE].given)
        return fault_set(act->fault, ERR_USAGE,
                         "at: it says where slices of the picture lie; expected picture=FILE too");
    return OK;
}

/* ---- labels ---- */

/* The session's; where one is chosen, that one alone. */
static enum err take_own(struct compared *compared, const struct act *act)
{
    const struct grid *grid = &session_scene(act->session)->grid;
    const struct value *only = &act->value[LABEL];
    uint8_t *label = compared->label[0] = mem_array(grid->voxels, 1);
    struct task task = task_begin(session_watch(act->session), "present labels", grid->voxels);
    struct labels labels;
    enum err err = label ? act_take_labels(act, &act->value[FINISHED], &labels)
                         : fault_memory(act->fault, "the labels");
    if (err)
        return err;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            labels_copy_row(&labels, grid_row(grid, y, z), label);
            for (const uint8_t *end = label + grid->size[0]; label < end; label++)
                *label = only->given && *label != only->number ? 0 : *label;
        }
    return watch_fault(session_watch(act->session), act->fault);
}

static enum err read_map(struct compared *compared, const struct act *act,
                         const struct map_labels *choice)
{
    const struct session *session = act->session;
    const char *name = act->value[FILE_NAME].text;
    const struct map_place place = session_map_place(session, act_is_yes(&act->value[RESAMPLE]));
    struct volume map = {0};
    struct buf path = {0};
    enum err err = interpreter_find_file(act->interp, name, &path, act->fault);
    if (!err)
        err = map_read(&map, buf_text(&path), &place, session_watch(session), act->fault);
    if (!err)
        buf_add_text(&act->reply->text, map.notes);
    if (!err)
        err = act_naming(
            name,
            map_to_labels(&compared->label[1], &map, choice, session_watch(session), act->fault),
            act->fault);
    volume_release(&map);
    buf_release(&path);
    return err;
}

static enum err take_map(struct compared *compared, const struct act *act)
{
    const struct value *value = act->value;
    uint16_t *as = NULL;
    enum err err = act_choose_regions(&as, act, &value[REGIONS], &value[AS], &value[LABEL]);
    if (!err) {
        const struct map_labels choice = {as, value[LABEL].given ? (int)value[LABEL].number
                                                                 : LABEL_OWN};
        err = read_map(compared, act, &choice);
    }
    free(as);
    return err;
}

/* ---- answers ---- */

static enum err write_report(const struct act *act, const struct comparison_report *report)
{
    const struct value *file = &act->value[REPORT];
    struct buf text = {0};
    if (!file->given)
        return OK;
    if (file_is_named(file->text, ".json"))
        comparison_write_json(&text, report);
    else
        comparison_write_csv(&text, report);
    const enum err err = act_write_text(act, file, &act->value[REPLACE], &text);
    buf_release(&text);
    return err;
}

/* Through the place that is named, or the voxel where both are farthest apart, or the cross-hair.
 */
static enum err write_picture(const struct act *act, const struct compared *compared,
                              const struct comparison_report *report)
{
    const uint32_t *cross = session_outlook(act->session)->slices.cross;
    const uint32_t *place = act->value[AT].given ? act->value[AT].place
                                                 : comparison_farthest(report->comparison, cross);
    struct picture picture = {0};
    struct buf path = {0};
    struct labels labels;
    if (!act->value[PICTURE].given)
        return OK;
    enum err err =
        session_labels(act->session, act_is_yes(&act->value[FINISHED]), &labels, act->fault);
    if (!err)
        err = interpreter_output_path(act->interp, act->value[PICTURE].text, &path, act->fault);
    if (!err && path.length)
        err = comparison_picture_draw(&picture, act->session, compared, report, place, act->fault);
    if (!err && path.length)
        err = act_note_picture(act, &labels, &picture);
    if (!err && path.length)
        err =
            act_write_picture(act, buf_text(&path), act_file_mode(&act->value[REPLACE]), &picture);
    picture_release(&picture);
    buf_release(&path);
    return err;
}

static enum err answer(const struct act *act, const struct compared *compared,
                       const struct comparison *comparison)
{
    const struct session *session = act->session;
    const char *name =
        act_is_yes(&act->value[FINISHED]) ? "the labels here, finished" : "the labels here";
    const struct comparison_report report = {comparison,
                                             {name, act->value[FILE_NAME].text},
                                             session_kept(session)->label_name,
                                             session_geometry(session)};
    enum err err = write_report(act, &report);
    if (!err)
        err = write_picture(act, compared, &report);
    if (!err)
        comparison_write_text(&act->reply->text, &report);
    if (!err)
        act_write_no_seeds(act);
    return err;
}

/* ---- the command ---- */

enum err act_compare(const struct act *act)
{
    struct session *session = act->session;
    struct compared compared = {0};
    struct comparison *comparison = mem_new(sizeof *comparison);
    enum err err = comparison ? check_names(act) : fault_memory(act->fault, "a comparison");
    for (int a = 0; a < 3; a++) {
        compared.size[a] = session_scene(session)->grid.size[a];
        compared.spacing_nm[a] = session_scene(session)->spacing_nm[a];
    }
    if (!err)
        err = take_map(&compared, act);
    if (!err)
        err = take_own(&compared, act);
    if (!err)
        err = comparison_make(comparison, &compared, session_team(session), session_watch(session),
                              act->fault);
    if (!err)
        err = answer(act, &compared, comparison);
    free(compared.label[0]);
    free(compared.label[1]);
    free(comparison);
    return err;
}
