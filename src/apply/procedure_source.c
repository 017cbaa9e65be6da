/* SPDX-License-Identifier: MIT */
#include "apply/procedure_source.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apply/percentiles.h"
#include "base/file.h"
#include "base/mem.h"
#include "command/answers.h"
#include "command/command.h"
#include "command/interpreter.h"
#include "engine/finish.h"
#include "session/markers.h"
#include "session/setting.h"

_Static_assert((int)PROCEDURE_NAME == (int)LABEL_NAME_BYTES &&
                   (int)PROCEDURE_NAME == (int)LANDMARK_NAME_BYTES &&
                   (int)PROCEDURE_LANDMARKS == (int)LANDMARKS,
               "names and landmarks of a session fit");

/* ---- which command put up which markers ---- */

struct planted {
    size_t record, first, last; /* its markers, from 1 */
};

struct noting {
    struct planted *planted;
    size_t count, capacity, seen;
    bool failed, with_image;
};

static void note_markers(void *context, const struct interpreter *interp, const struct reply *reply)
{
    (void)reply;
    struct noting *n = context;
    const size_t now = session_markers(interp->session)->count;
    if (now == n->seen)
        return;
    n->failed |= !mem_grow(&n->planted, &n->capacity, n->count + 1, sizeof *n->planted);
    if (!n->failed)
        n->planted[n->count++] = (struct planted){interp->history.records, n->seen + 1, now};
    n->seen = now;
}

/* ---- gestures ---- */

/* What of a marker the seeds still are, at least half of it: another may lie over it. */
static bool still_stands(const struct markers *markers, const struct marker *marker)
{
    uint32_t own = 0;
    for (uint32_t i = 0; i < marker->voxels; i++)
        own += markers_seed(markers, markers->cover[marker->first + i].cell) == marker->label;
    return marker->stands && marker->label >= 0 && 2 * own >= marker->voxels && own > 0;
}

static double length_mm(const struct value *value, double voxel_mm)
{
    return value->in_mm ? (double)value->number / 1e6 : (double)value->number * voxel_mm;
}

static enum err add_gesture(struct procedure *p, const struct session *session,
                            const struct call *call, struct fault *fault)
{
    const struct geometry *geometry = session_geometry(session);
    const struct value *to = call_value(call, "to"), *place = call_value(call, "PLACE");
    const double voxel_mm = cbrt(procedure_voxel_mm3(p));
    const uint32_t(*corner)[3] =
        (const uint32_t(*)[3])(to->given ? to->line->corner[0] : place->place);
    const uint32_t first =
        grid_cell(&session_scene(session)->grid, corner[0][0], corner[0][1], corner[0][2]);
    const struct procedure_gesture gesture = {
        .label = (uint8_t)call_value(call, "LABEL")->number,
        .radius_mm = length_mm(call_value(call, "radius"), voxel_mm),
        .within_mm = length_mm(call_value(call, "within"), voxel_mm),
        .intensity = percentiles_value(session, first)};
    enum err err = procedure_add_gesture(p, &gesture, fault);
    for (size_t i = 0; !err && i < (to->given ? to->line->count : 1); i++) {
        double mm[3];
        geometry_point(geometry, corner[i], mm);
        err = procedure_add_corner(p, mm, fault);
    }
    return err;
}

static const char *command_of(const struct history *history, size_t record)
{
    for (size_t i = 1; i < history->points; i++)
        if (history->point[i].record == record)
            return history->point[i].command;
    return NULL;
}

/* Balls and strokes alone: what else was planted is in the labels. */
static enum err take_gestures(struct procedure *p, const struct noting *noting,
                              const struct interpreter *interp, struct fault *fault)
{
    const struct markers *markers = session_markers(interp->session);
    enum err err = OK;
    for (size_t i = 0; !err && i < noting->count; i++) {
        const struct planted *planted = &noting->planted[i];
        const char *line = command_of(&interp->history, planted->record);
        struct call call = {.command = NULL};
        bool stands = false;
        for (size_t m = planted->first; line && !stands && m <= planted->last; m++)
            stands = still_stands(markers, &markers->marker[m - 1]);
        if (!stands)
            continue;
        if (planted->first == planted->last && !command_parse(&call, line, interp->session, NULL) &&
            call.command && call.command->flags & COMMAND_CARRIED && !call_has(&call, "shell"))
            err = add_gesture(p, interp->session, &call, fault);
        else
            p->left[LEFT_GESTURES]++;
        call_release(&call);
    }
    return noting->failed ? fault_memory(fault, "gestures") : err;
}

/* ---- settings ---- */

static void write_settings(struct buf *out, const struct kept *kept, const struct state *state)
{
    struct buf text = {0};
    if (kept->weight.kind !=
        WEIGHT_FILE) { /* a map lies on its scene: the default takes its place */
        act_write_weight(&text, kept);
        buf_add_text(out, "weight ");
        buf_add(out, buf_text(&text),
                kept->weight.kind == WEIGHT_POLARITY ? strcspn(buf_text(&text), " ") : text.length);
        buf_add_char(out, '\n');
    }
    for (unsigned label = 0; kept->weight.kind == WEIGHT_POLARITY && label < 256; label++)
        if (kept->polarity[label])
            buf_printf(out, "polarity %u %d\n", label, kept->polarity[label]);
    for (const struct command *setting = setting_table; setting->name; setting++)
        if (setting->flags & COMMAND_CARRIED) {
            setting_write(out, setting, state);
            buf_add_char(out, '\n');
        }
    buf_clear(&text);
    finish_write(&text, &kept->finish);
    for (const char *at = buf_text(&text); kept->finish.count && *at;) {
        const char *next = strstr(at, ", ");
        buf_printf(out, "finish %.*s\n", next ? (int)(next - at) : (int)strlen(at), at);
        at = next ? next + 2 : "";
    }
    out->failed |= text.failed;
    buf_release(&text);
}

/* ---- all of a session ---- */

static enum err take_place(struct procedure *p, const struct session *session, struct fault *fault)
{
    const struct geometry *geometry = session_geometry(session);
    if (geometry->orientation == ORIENTATION_UNKNOWN || geometry->spacing_unknown)
        return fault_set(fault, ERR_INPUT,
                         "the file of its scene does not say %s, and nobody may guess it; `orient` "
                         "and `open ... spacing=` in a journal of that scene say it",
                         geometry->spacing_unknown ? "how far apart voxels are"
                                                   : "to which sides of the patient its axes run");
    p->has_place = geometry_has_place(geometry);
    memcpy(p->to_mm.m, geometry->to_mm, sizeof p->to_mm.m);
    memcpy(p->size, session_scene(session)->grid.size, sizeof p->size);
    memcpy(p->scene, session_proof(session), sizeof p->scene);
    return OK;
}

static enum err take_labels(struct procedure *p, const struct session *session, struct fault *fault)
{
    const struct kept *kept = session_kept(session);
    const struct scene *scene = session_scene(session);
    const struct grid *grid = &scene->grid;
    struct percentiles *found = mem_new(sizeof *found);
    uint16_t *label = mem_array(grid->voxels, sizeof *label);
    p->voxel = mem_array(grid->voxels, 1);
    enum err err = found && label && p->voxel ? OK : fault_memory(fault, "labels");
    size_t i = 0;
    for (uint32_t z = 0; !err && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, i++)
                label[i] = p->voxel[i] = scene->cell[c].label;
        }
    if (!err)
        err = percentiles_find(found, session, label, fault);
    for (unsigned l = 0; !err && l < 256; l++) {
        struct procedure_label *to = &p->label[l];
        to->is_there = found->voxels[l] > 0;
        to->voxels = found->voxels[l];
        to->low = found->low[l];
        to->high = found->high[l];
        to->number = kept->label_number[l];
        memcpy(to->name, kept->label_name[l], sizeof to->name);
        memcpy(to->rgb, kept->palette.rgb[l], sizeof to->rgb);
    }
    free(found);
    free(label);
    return err;
}

static enum err take_all(struct procedure *p, const struct noting *noting,
                         const struct interpreter *interp, struct fault *fault)
{
    struct session *session = interp->session;
    enum err err = session_complete(session, fault);
    if (!err && session_pendings(session))
        err = session_run(session, fault);
    if (!err)
        err = take_place(p, session, fault);
    const struct kept *kept = session_kept(session);
    if (!err)
        err = take_labels(p, session, fault);
    if (!err)
        err = take_gestures(p, noting, interp, fault);
    for (size_t i = 0; !err && i < LANDMARKS && *kept->landmark[i].name; i++) {
        struct procedure_landmark *mark = &p->landmark[p->landmarks++];
        memcpy(mark->name, kept->landmark[i].name, sizeof mark->name);
        geometry_point(session_geometry(session), kept->landmark[i].place, mark->mm);
    }
    write_settings(&p->settings, kept, session_state(session));
    p->left[LEFT_WEIGHTS] = kept->weight.kind == WEIGHT_FILE;
    p->left[LEFT_MASK] = *kept->mask_file != '\0';
    p->left[LEFT_RANGE] = kept->has_range != 0;
    return !err && p->settings.failed ? fault_memory(fault, "a procedure") : err;
}

/* ---- what its process hands back ---- */

/* How long the text is, the text, and the intensities. */
static enum err hand_back(void *context, const struct interpreter *interp,
                          const struct side_facts *facts, const uint8_t *label, struct buf *out,
                          struct fault *fault)
{
    (void)label;
    const struct noting *noting = context;
    const struct scene *scene = session_scene(interp->session);
    const struct grid *grid = &scene->grid;
    struct procedure procedure = {.chain = facts->chain};
    struct buf text = {0};
    const enum err err = take_all(&procedure, noting, interp, fault);
    if (!err)
        procedure_write(&text, &procedure);
    const uint64_t length = text.length;
    buf_add(out, &length, sizeof length);
    buf_add(out, buf_text(&text), text.length);
    out->failed |= text.failed;
    uint16_t *to = !err && noting->with_image ? buf_reserve(out, grid->voxels * sizeof *to) : NULL;
    for (uint32_t z = 0; to && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, out->length += sizeof *to)
                memcpy(out->data + out->length, &scene->cell[c].intensity, sizeof *to);
        }
    buf_release(&text);
    procedure_release(&procedure);
    return err;
}

/* The process may have been taken over: its text is read as a stranger's. */
static enum err take_back(struct buf *text, struct buf *image, const struct side *side,
                          const char *path, struct fault *fault)
{
    const char *at = side->more;
    uint64_t length, left = side->facts->more;
    if (left >= sizeof length)
        memcpy(&length, at, sizeof length);
    if (left < sizeof length || length > left - sizeof length)
        return fault_set(fault, ERR_INPUT, "%s: its process hands back what makes no sense", path);
    at += sizeof length, left -= sizeof length;
    buf_add(text, at, length);
    if (image)
        buf_add(image, at + length, left - length);
    return text->failed || (image && image->failed) ? fault_memory(fault, "a procedure") : OK;
}

/* ---- from outside ---- */

enum err procedure_text(struct buf *text, struct buf *image, const struct procedure_source *source,
                        struct fault *fault)
{
    struct noting noting = {.with_image = image};
    const struct side_work work = {
        .context = &noting, .hear = note_markers, .add = hand_back, .most = UINT32_MAX};
    struct side_options how = source->journal;
    struct side side = {.facts = NULL};
    if (file_begins_with(source->path, PROCEDURE_BEGINS))
        return file_read(text, source->path, PROCEDURE_BYTES, fault);
    how.is_strict = true;
    enum err err = side_carry_out(&side, source->path, &how, &work, fault);
    if (!err)
        err = take_back(text, image, &side, source->path, fault);
    side_release(&side);
    return err;
}

enum err procedure_load(struct procedure *p, struct buf *image,
                        const struct procedure_source *source, struct fault *fault)
{
    struct buf text = {0};
    enum err err = procedure_text(&text, image, source, fault);
    if (!err) {
        err = procedure_read(p, buf_text(&text), text.length, fault);
        if (!err && image && image->length &&
            image->length != (size_t)2 * p->size[0] * p->size[1] * p->size[2])
            err = fault_set(fault, ERR_INPUT, "its process hands back what makes no sense");
        if (err)
            fault_prefix(fault, err, "%s", source->path);
    }
    buf_release(&text);
    return err;
}
