/* SPDX-License-Identifier: MIT */
/* Files written from a session: golden images, finished labels, maps, surfaces, seeds, names of
 * labels. */
#include "command/act.h"

#include <string.h>
#include <time.h>

#include "base/file.h"
#include "base/mem.h"
#include "command/golden_files.h"
#include "image/exr.h"
#include "image/surface_file.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "session/map.h"
#include "session/session.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/export_map.h"
#include "show/export_picture.h"
#include "show/label_report.h"
#include "show/label_table.h"

/* The command `golden`: store a picture next to the journal, and compare it in a replay. */

/* ---- comparing ---- */

static struct golden_planes planes_of(const struct picture *p)
{
    return (struct golden_planes){p->width, p->height, {p->rgba, p->depth_mm, p->label, p->voxel}};
}

/* Report a missing image, and the file to restore if its PNG exists. */
static enum err refuse_missing(struct interpreter *interp, const char *name, const char *path,
                               struct fault *fault)
{
    struct buf *png = arena_buf(&interp->arena);
    buf_add(png, path, strlen(path) - strlen("exr"));
    buf_add_text(png, "png");
    return file_exists(buf_text(png))
               ? fault_set(fault, ERR_CHECK,
                           "golden image %s is missing: its PNG exists, but not %s, which is "
                           "compared; restore that file from a copy",
                           name, path)
               : fault_set(fault, ERR_CHECK, "golden image %s is missing: there is no %s", name,
                           path);
}

/* Compare the pixels, then the notes. */
static enum err compare_pictures(const struct picture *expected, const struct picture *actual,
                                 const struct interpreter *interp,
                                 struct golden_difference *difference, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0};
    const struct golden_planes e = planes_of(expected), a = planes_of(actual);
    TRY(golden_compare(&e, &a, difference, fault));
    if (difference->is_same)
        return golden_compare_notes(expected, actual, !interp->scene_path, fault);
    golden_describe(&words, difference);
    return fault_set(fault, ERR_CHECK, "%s", buf_text(&words));
}

static enum err compare_golden(struct interpreter *interp, const char *name, const char *path,
                               struct picture *actual, struct fault *fault)
{
    const struct golden_judge *judge = interp->judge;
    OWNED(picture_release) struct picture expected = {0};
    OWNED(golden_difference_release) struct golden_difference difference = {0};
    const bool has_source = judge && judge->source;
    const char *source = has_source ? judge->source(judge->context, path) : path;
    bool leads_out = false;
    enum err err = file_exists(source) ? interpreter_may_read(interp, source, &leads_out, fault)
                                       : refuse_missing(interp, name, source, fault);
    if (!err)
        err = exr_read_golden(&expected, source, actual, interp->session->watch, fault);
    bool is_read = !err;
    if (is_read)
        err = compare_pictures(&expected, actual, interp, &difference, fault);
    if (err == ERR_MEMORY || err == ERR_CANCELLED)
        return err;
    if (err) { /* each of these is a failure of the image */
        is_read = is_read && !leads_out;
        if (leads_out)
            golden_refuse_link(source, fault);
        if (file_exists(source))
            fault_prefix(fault, err, "golden image %s", name);
        err = fault ? fault_set(fault, ERR_CHECK, "%s", fault->text) : ERR_CHECK;
    }
    if (is_read && err) /* for people who compare the two */
        export_background(&expected, interp->session, NULL);
    const struct golden_finding finding = {name, path, actual, is_read ? &expected : NULL,
                                           is_read ? &difference : NULL};
    if (err && judge && judge->differs)
        err = judge->differs(judge->context, interp, &finding, fault);
    else if (!err && judge && judge->is_same)
        err = judge->is_same(judge->context, interp, &finding, fault);
    return err;
}

/* ---- storing ---- */

/* The EXR is the golden image; the PNG next to it is for people. Both are on the disk before their
 * record, and after the records that they name (command/golden_files.h). An existing golden image
 * must be the same; a missing PNG is written again. In this order no foreign PNG is ever next to an
 * image of the journal. */
static enum err write_golden(struct interpreter *interp, const char *name, const char *path,
                             struct picture *picture, struct fault *fault)
{
    OWNED(golden_files_close) struct golden_files files = {.folder = -1};
    struct buf *png = arena_buf(&interp->arena);
    if (interp->journal)
        TRY(journal_sync(interp->journal, fault));
    TRY(golden_files_open(&files, buf_text(&interp->home), true, fault));
    buf_printf(png, "%s/%s.png", buf_text(&files.path), name);
    const bool is_there = file_exists(path), has_png = file_exists(buf_text(png));
    if (is_there) {
        TRY(fault_prefix(fault, compare_golden(interp, name, path, picture, fault),
                         "it exists already and was left alone"));
    } else {
        TRY(file_may_write(buf_text(png), FILE_KEEP, fault));
        TRY(act_write_now(interp, path, FILE_KEEP, picture, fault));
    }
    return has_png ? OK : act_write_now(interp, buf_text(png), FILE_KEEP, picture, fault);
}

/* ---- the command ---- */

/* Make the picture and its digest. */
static enum err take_golden(const struct act *act, struct picture *picture)
{
    struct labels labels;
    const int64_t of = act_number(act, "of"); /* 0: the rendition */
    if (act->interp->mode == MODE_SKIM)
        return OK;
    TRY(of ? act_take_shown(act, &labels) : act_render_labels(act, RENDER_AS_KEPT, &labels));
    if (of)
        return act_take_slices(act, (enum slice_kind)(of - 1), &labels, picture);
    act_add_picture_digest(act);
    return act_take_picture(act, &labels, NULL, picture);
}

enum err act_golden(const struct act *act)
{
    struct interpreter *interp = act->interp;
    const bool is_new = interp->mode == MODE_LIVE;
    OWNED(picture_release) struct picture picture = {0};
    struct buf *path = act_buf(act);
    const char *name = act_text(act, "NAME");
    if (!golden_name_is_valid(name))
        return fault_set(act->fault, ERR_USAGE,
                         "NAME: expected at most 64 lower-case letters, digits, - and _, not %s",
                         name);
    if (interp->is_read_only && interp->journal && journal_only_looks(interp->journal))
        return fault_set(
            act->fault, ERR_USAGE,
            "the journal was opened read-only, and so were its golden images; `journal "
            "FILE` continues in a file of your own");
    TRY(take_golden(act, &picture));
    if (is_new && !interp->home.length) {
        buf_add_text(&act->reply->text, "not stored: there is no journal; `--journal FILE` "
                                        "records one from the beginning\n");
    } else if (is_new || interp->judge) {
        TRY(golden_path(path, buf_text(&interp->home), name, act->fault));
        if (!is_new)
            return compare_golden(interp, name, buf_text(path), &picture, act->fault);
        TRY(write_golden(interp, name, buf_text(path), &picture, act->fault));
        act_write_file_line("stored as ", buf_text(path), act->reply);
    }
    return OK;
}

/* ---- `finish`, `finished` ---- */

/* Read the parameters of a step: those of its row, and no others. */
static enum err take_argument(struct finish_step *step, const struct act *act)
{
    static const char *const own[] = {[FINISH_TAKES_RADIUS] = "radius",
                                      [FINISH_TAKES_VOXELS] = "voxels",
                                      [FINISH_TAKES_SWEEPS] = "sweeps"};
    const struct finish_row *row = &finish_table[step->kind];
    const char *other = row->takes != FINISH_TAKES_SWEEPS ? call_given(act->call, "reach") : NULL;
    for (unsigned i = 0; !other && i < sizeof own / sizeof *own; i++)
        other = own[i] && i != row->takes ? call_given(act->call, own[i]) : NULL;
    if (other)
        return fault_set(act->fault, ERR_USAGE, "%s: `finish %s` has none", other, row->name);
    step->argument = row->usual;
    if (row->takes == FINISH_TAKES_SWEEPS)
        step->reach = (uint32_t)act_number_or(act, "reach", FINISH_BAND);
    if (row->takes == FINISH_TAKES_NOTHING)
        return OK;
    const struct value *value = act_value(act, own[row->takes]);
    if (!value->given && !row->usual)
        return fault_set(act->fault, ERR_USAGE, "%s: `finish %s` needs it", own[row->takes],
                         row->name);
    if (value->given)
        step->argument = (uint32_t)value->number;
    step->in_nm = value->in_mm;
    return OK;
}

static enum err add_step(struct finish_list *list, const struct act *act)
{
    struct finish_step step = {.kind = (uint32_t)act_number(act, "STEP"),
                               .label = (uint32_t)act_number_or(act, "label", FINISH_ALL_LABELS)};
    TRY(take_argument(&step, act));
    if (list->count == FINISH_STEPS_MOST)
        return fault_set(act->fault, ERR_LIMIT,
                         "the finish has %d steps, and no room for more; `finish none` removes "
                         "them, `undo` the last one",
                         FINISH_STEPS_MOST);
    list->step[list->count++] = step;
    return finish_check(list, act->session->scene, act->fault);
}

enum err act_finish(const struct act *act)
{
    const struct value *step = act_value(act, "STEP");
    struct finish_list *list = &act->next->kept.finish;
    const bool clears = step->given && step->number == FINISH_KIND_COUNT;
    if ((clears || !step->given) && act_has(act, "radius|voxels|sweeps|reach|label"))
        return fault_set(act->fault, ERR_USAGE, "expected a step: " FINISH_KINDS);
    if (clears)
        *list = (struct finish_list){0};
    TRY(step->given && !clears ? add_step(list, act) : OK);
    TRY(act_go(act));
    if (!list->count)
        buf_add_text(&act->reply->text, "finish    none\n");
    act_write_finish(&act->reply->text, act->session);
    struct labels labels;
    if (!list->count || act->interp->mode != MODE_LIVE || act->session->skims ||
        !forest_seeds(act->session->forest))
        return OK;
    TRY(session_labels(act->session, true, &labels, act->fault));
    return act_write_losses(act->interp, &labels, false, act->session->watch, &act->reply->text,
                            act->fault);
}

/* ---- surfaces: what encloses the labels, as triangles ---- */

static void row_of_labels(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct labels *labels = context;
    labels_copy_row(labels, grid_row(&labels->scene->grid, y, z), label);
}

/* Make the surface; `joins`: all labels as one. */
static enum err make_surface(struct surface **surface, const struct act *act,
                             const struct labels *labels, bool joins)
{
    struct session *session = act->session;
    const struct value *label = act_value(act, "label"), *smooth = act_value(act, "smooth");
    struct labels of = *labels;
    const struct surface_source source = {session->scene->grid.size, row_of_labels, &of};
    struct surface_choice choice = {.joins = joins,
                                    .is_cubes = smooth->given && smooth->number == 0};
    for (int l = 1; l < 256; l++)
        choice.wanted[l] = !label->given || label->number == l;
    TRY(surface_new(surface, &source, &choice, session->watch, act->fault));
    if ((*surface)->parts)
        return OK;
    return label->given
               ? fault_set(act->fault, ERR_INPUT, "no voxel has label %u; nothing was written",
                           label->place[0])
               : fault_set(act->fault, ERR_INPUT,
                           "no voxel has a label above 0: plant a `seed` first; nothing was "
                           "written");
}

static enum err write_surface(const struct act *act, const struct labels *labels, const char *path,
                              enum file_mode how, const struct surface *surface)
{
    const struct session *session = act->session;
    struct volume_label label[256];
    struct buf *notes = act_buf(act);
    export_labels(label, &session->now.kept);
    if (labels->finished) {
        buf_add_text(notes, "finished: ");
        numbering_write_finish(notes, &session->now.kept);
    }
    const struct surface_document document = {surface, &session->geometry, label, buf_text(notes)};
    return surface_write(path, how, &document, session->watch, act->fault);
}

/* Report the size and position of each surface. */
static void answer_surface(const struct act *act, const struct surface *surface, bool joins)
{
    struct buf *out = &act->reply->text;
    const struct session *session = act->session;
    for (unsigned p = 0; p < surface->parts; p++) {
        const struct surface_part *part = &surface->part[p];
        buf_add_text(out, joins ? "all labels" : "label ");
        if (!joins)
            label_report_write_name(out, session, part->label);
        buf_printf(out, ": %zu triangles around ", part->triangles);
        label_report_write_extent(out, session, part->voxels);
        buf_add_char(out, '\n');
    }
    if (session->geometry.spacing_unknown)
        buf_add_text(out, "its coordinates are in voxels: the spacing is unknown\n");
    else if (session->geometry.orientation == ORIENTATION_UNKNOWN)
        buf_add_text(out, "its coordinates are in millimetres along the voxel axes: orientation is "
                          "unknown; use `orient` first\n");
}

static enum err save_surface(const struct act *act, const struct labels *labels, const char *path,
                             enum file_mode how)
{
    struct surface *surface = NULL;
    const struct value *most = act_value(act, "triangles");
    const bool joins = !act_has(act, "label") && !surface_file_tells_labels(path);
    enum err err = make_surface(&surface, act, labels, joins);
    if (!err && most->given)
        err = surface_reduce(surface, (size_t)most->number, act->session->watch, act->fault);
    if (!err)
        err = write_surface(act, labels, path, how, surface);
    if (!err)
        answer_surface(act, surface, joins);
    surface_free(surface);
    return err;
}

/* ---- `save` ---- */

/* Numbers of MAP after the maps. */
enum { SAVE_SEEDS = MAP_MARGIN + 1, SAVE_NAMES, SAVE_SURFACE };

static enum err save_seeds(const struct act *act, const char *path, enum file_mode how)
{
    struct buf *text = act_buf(act);
    if (!file_is_named(path, ".csv"))
        return fault_set(act->fault, ERR_USAGE, "cannot write %s: expected FILE.csv for seeds",
                         path);
    TRY(export_seeds(text, act->session, act->fault));
    return file_write(path, text->data, text->length, how, act->fault);
}

/* Note the codes of these labels, in a file that holds none. */
static void warn_of_codes(const struct act *act, const bool has[256])
{
    unsigned codes = 0;
    for (unsigned l = 1; l < 256; l++)
        codes += *act->session->now.kept.label_code[l] && has[l];
    if (codes)
        buf_printf(&act->reply->text,
                   "%u code%s not written: .seg.nrrd, .nii.gz and .dcm hold them\n", codes,
                   plural(codes));
}

static enum err save_names(const struct act *act, const char *path, enum file_mode how)
{
    enum label_table_format format;
    bool used[256];
    struct label_writing writing;
    struct buf *text = act_buf(act);
    if (!label_table_ending(path, &format))
        return fault_set(act->fault, ERR_USAGE,
                         "cannot write %s: expected .txt or .label for ITK-SNAP, .ctab for "
                         "FreeSurfer, .ctbl for 3D Slicer, .tsv for BIDS, .nii.txt or .lut for "
                         "mricron",
                         path);
    const struct kept *kept = &act->session->now.kept;
    if (format == TABLE_LUT && numbering_is_used(kept))
        return fault_set(act->fault, ERR_USAGE,
                         "cannot write %s: labels are numbered by a file, and a .lut holds 0 to "
                         "255; expected .txt, .label, .ctbl, .ctab, .tsv or .nii.txt",
                         path);
    TRY(session_count_labels(act->session, act->fault));
    for (int l = 0; l < 256; l++)
        used[l] = act->session->tally.voxels[l] > 0 || *kept->label_name[l];
    label_table_write(text, &writing, format, &act->session->now.kept, used);
    TRY(file_write(path, text->data, text->length, how, act->fault));
    warn_of_codes(act, used);
    if (!writing.changed)
        return OK;
    struct buf *out = &act->reply->text;
    buf_printf(out, "%u name%s ", writing.changed, plural(writing.changed));
    if (!*writing.first_written) {
        buf_add_text(out, "not written: a .lut holds colours alone\n");
        return OK;
    }
    buf_printf(out, "had to be changed to fit; the first is of label %u, in the file ",
               numbering_of(kept, writing.first_changed));
    buf_add_safe_text(out, writing.first_written);
    buf_add_char(out, '\n');
    return OK;
}

/* Reject parameters without meaning for MAP. */
static enum err check_parameters(const struct act *act)
{
    const int64_t what = act_number(act, "MAP");
    if (what == SAVE_SURFACE && !act_has(act, "empty"))
        return surface_file_check(act_text(act, "FILE"), act->fault);
    if (act_has(act, "finished") && what != MAP_LABELS)
        return fault_set(act->fault, ERR_USAGE,
                         "finished: only for labels and surfaces (`save labels FILE "
                         "finished=yes`)");
    if (act_has(act, "empty") && what != MAP_LABELS)
        return fault_set(act->fault, ERR_USAGE, "empty: only for `save labels`");
    if (act_has(act, "label|smooth|triangles"))
        return fault_set(act->fault, ERR_USAGE,
                         "label=, smooth= and triangles= are for `save surface`, not for %s",
                         act_text(act, "MAP"));
    return OK;
}

/* Coverage of a map of labels: voxels with a label above 0, and unreached voxels, outside the
 * region of interest or not. */
struct coverage {
    uint64_t labelled, outside, unreached, kept; /* kept: outside, in regions that are kept */
    bool has[256];
};

/* Count in an empty coverage. */
static enum err count_coverage(struct coverage *coverage, const struct session *session,
                               const struct labels *labels, struct fault *fault)
{
    OWNED(mem_release) uint16_t *rest = NULL;
    TRY(session_take_rest(session, &rest, fault));
    const uint16_t *region = rest;
    struct grid_walk walk = scene_walk(session->scene, "counting", NULL, 0);
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++) {
            const struct cell *cell = session->scene->cell + c;
            const bool is_kept = region && *region++;
            const bool is_outside = cell->flags & CELL_OUTSIDE && !is_kept;
            const uint8_t label = labels_at(labels, c);
            coverage->kept += is_kept;
            coverage->labelled += label > 0;
            coverage->has[label] = true;
            coverage->outside += is_outside;
            coverage->unreached += !is_outside && !is_kept && !cell_is_reached(cell);
        }
    return OK;
}

static void warn_of_background(struct buf *out, uint64_t voxels, const char *which)
{
    if (voxels)
        buf_printf(out, "%llu voxel%s %s %s no label\n", (unsigned long long)voxels, plural(voxels),
                   which, voxels == 1 ? "has" : "have");
}

/* Warn about contents that may be unexpected. */
static void warn_of_contents(const struct act *act, const char *path,
                             const struct coverage *coverage, bool finished)
{
    const struct session *session = act->session;
    const struct kept *kept = &session->now.kept;
    const int64_t what = act_number(act, "MAP");
    struct buf *out = &act->reply->text;
    unsigned names = 0;
    warn_of_background(out, coverage->unreached, "that no seed reaches");
    warn_of_background(out, coverage->outside, "outside the region of interest");
    if (what == MAP_LABELS && coverage->kept)
        buf_printf(out, "%llu voxel%s of other regions %s as in %s\n",
                   (unsigned long long)coverage->kept, plural(coverage->kept),
                   coverage->kept == 1 ? "is" : "are", kept->mask_file);
    for (unsigned l = 1; l < 256 && what == MAP_LABELS; l++)
        names += *kept->label_name[l] && coverage->has[l];
    if (names && !volume_holds_names(path))
        buf_printf(out,
                   "%u name%s and colours not written: %s holds none; `save names FILE` writes "
                   "them, and .seg.nrrd, .nii.gz and .mgz hold them\n",
                   names, plural(names), volume_ending(path));
    if (what == MAP_LABELS &&
        (!volume_holds_names(path) || file_is_named(path, ".mgh|.mgz|.mgh.gz")))
        warn_of_codes(act, coverage->has);
    if (volume_ending(path) && !geometry_has_place(&session->geometry))
        buf_add_text(out, "its position is as unknown as that of the scene's file\n");
    if ((what == MAP_LABELS || what == SAVE_SURFACE) && !act_has(act, "finished") && !finished &&
        session_shows_finished(session))
        buf_add_text(out, "it has the labels of the forest; `finished=yes` writes the labels shown "
                          "in pictures\n");
}

/* A DICOM SEG refers to the series of the scene, whose files are read again. */
static enum err save_map(const struct act *act, const struct labels *labels, const char *path,
                         enum file_mode how)
{
    struct dicom_source source = {.date = "19000101", .time = "000000"};
    const bool is_seg = act_number(act, "MAP") == MAP_LABELS && file_is_named(path, ".dcm");
    const time_t now = time(NULL);
    struct tm utc;
    enum err err = OK;
    if (!is_seg && act_has(act, "identity|times"))
        return fault_set(act->fault, ERR_USAGE,
                         "identity= and times= are for `save labels FILE.dcm`");
    if (act_is_yes(act, "times") && gmtime_r(&now, &utc)) {
        strftime(source.date, sizeof source.date, "%Y%m%d", &utc);
        strftime(source.time, sizeof source.time, "%H%M%S", &utc);
    }
    if (is_seg)
        err = fault_prefix(
            act->fault,
            session_find_source(act->session, &source, act_has(act, "identity"), act->fault),
            "cannot write %s", path);
    if (!err)
        err = export_map(act->session, (enum map)act_number(act, "MAP"), labels, path, how,
                         is_seg ? &source : NULL, act->fault);
    buf_release(&source.words);
    return err;
}

enum err act_save(const struct act *act)
{
    const int64_t what = act_number(act, "MAP");
    const bool has_labels = what == MAP_LABELS || what == SAVE_SURFACE;
    struct coverage coverage = {0};
    const enum file_mode how = act_file_mode(act);
    struct buf *to = act_buf(act);
    struct labels labels = {0};
    TRY(check_parameters(act));
    if (has_labels)
        TRY(act_take_labels(act, &labels));
    TRY(interpreter_output_path(act->interp, act_text(act, "FILE"), to, act->fault));
    if (!to->length)
        return OK;
    const char *path = buf_text(to);
    if (has_labels)
        TRY(count_coverage(&coverage, act->session, &labels, act->fault));
    /* An empty map would be mistaken for a result. */
    if (what == MAP_LABELS && !coverage.labelled && !coverage.kept && !act_is_yes(act, "empty"))
        return fault_set(
            act->fault, ERR_INPUT,
            "no voxel has a label above 0: plant a `seed` of one first, or write the empty "
            "map with empty=yes; nothing was written");
    TRY(watch_fault(act->session->watch, act->fault));
    TRY(interpreter_will_write(act->interp, path, how, act->fault));
    TRY(what == SAVE_SEEDS     ? save_seeds(act, path, how)
        : what == SAVE_NAMES   ? save_names(act, path, how)
        : what == SAVE_SURFACE ? save_surface(act, &labels, path, how)
                               : save_map(act, &labels, path, how));
    act_write_file_line("wrote ", path, act->reply);
    warn_of_contents(act, path, &coverage, labels.finished != NULL);
    return OK;
}
