/* SPDX-License-Identifier: MIT */
#include "apply/apply.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/file.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/table.h"
#include "engine/brush.h"
#include "engine/hints.h"
#include "image/volume.h"
#include "journal/journal.h"
#include "session/map.h"
#include "session/paint.h"
#include "session/tally.h"

/* Tolerance of intensities of the background's gestures, relative to the difference of the largest
 * object's percentiles. 0.3 to 0.8 had similar results. */
#define GATE_OF_BACKGROUND 0.5

/* A label is bad if its volume is less than two thirds or more than three halves of the expected
 * one, or if one voxel of these is far from where it was carried. */
enum { BAD_ONE_OF = 50 };

struct making {
    struct interpreter interp;
    const struct procedure *procedure;
    const struct subject_choice *choice;
    struct subject *subject;
    bool is_there; /* the journal exists */
    struct warped warped;
    struct buf origin, seeds; /* a command; commands, one a line */
    struct buf made;          /* paths of written files, each with its NUL */
    uint32_t number[256];     /* numbers of the procedure's labels */
    uint8_t here[256];        /* labels of the session by labels of the procedure, */
    uint8_t there[256];       /* and the other way around */
    struct fault *fault;
};

void subject_release(struct subject *subject)
{
    buf_release(&subject->journal);
    buf_release(&subject->words);
}

/* The scene's file name without its own ending, in the output folder. */
void subject_path(struct buf *out, const struct subject_choice *choice, const char *ending)
{
    const char *scene = choice->scene, *of_scene = volume_ending(scene);
    size_t end = strlen(scene) - (of_scene ? strlen(of_scene) : 0);
    while (end > 1 && scene[end - 1] == '/')
        end--;
    size_t begin = end;
    while (begin > 0 && scene[begin - 1] != '/')
        begin--;
    buf_printf(out, "%s/%.*s%s", choice->folder, (int)(end - begin), scene + begin, ending);
}

/* ---- commands ---- */

static enum err execute_line(struct making *m, const char *line)
{
    OWNED(reply_release) struct reply reply = {0};
    const enum err err = interpreter_execute(&m->interp, line, &reply, m->fault);
    buf_add(&m->made, buf_text(&reply.files), err ? 0 : reply.files.length);
    return err;
}

static enum err execute_buf(struct making *m, struct buf *line)
{
    const enum err err =
        line->failed ? fault_memory(m->fault, "a command") : execute_line(m, buf_text(line));
    buf_release(line);
    return err;
}

static enum err open_scene(struct making *m)
{
    struct buf line = {0};
    buf_add_text(&line, "open ");
    command_write_word(&line, m->choice->scene);
    if (m->choice->volume >= 0)
        buf_printf(&line, " volume=%" PRId64, m->choice->volume);
    m->interp.has_options = true;
    TRY(execute_buf(m, &line));
    if (m->choice->orient) {
        buf_add_text(&line, "orient ");
        command_write_word(&line, m->choice->orient);
        TRY(execute_buf(m, &line));
    }
    return session_complete(m->interp.session, m->fault);
}

/* The commands may be a stranger's: allow only settings that read no file. */
static enum err execute_settings(struct making *m)
{
    OWNED(buf_release) struct buf line = {0};
    for (const char *at = buf_text(&m->procedure->settings); *at;) {
        const size_t n = strcspn(at, "\n");
        buf_clear(&line);
        buf_add(&line, at, n);
        at += n + (at[n] == '\n');
        OWNED(call_release) struct call call;
        bool is_fine = command_parse(&call, buf_text(&line), m->interp.session, NULL) == OK &&
                       call.command && (call.command->flags & COMMAND_CARRIED) &&
                       !(call.command->flags & COMMAND_PLANTS);
        for (int i = 0; is_fine && call.command->parameter[i].type; i++)
            is_fine = !call.command->parameter[i].is_read || call.value[i].number >= 0;
        if (!is_fine)
            return fault_set(m->fault, ERR_INPUT,
                             "the procedure has a setting that is not of weights or the finish: %s",
                             buf_text(&line));
        TRY(execute_line(m, buf_text(&line)));
    }
    return OK;
}

static enum err name_label(struct making *m, unsigned l)
{
    const struct procedure_label *label = &m->procedure->label[l];
    struct buf line = {0};
    buf_printf(&line, "label %u ", m->number[l]);
    if (*label->name)
        command_write_word(&line, label->name);
    else
        buf_printf(&line, "label-%u", m->number[l]);
    if (l)
        buf_printf(&line, " #%02x%02x%02x", label->rgb[0], label->rgb[1], label->rgb[2]);
    buf_add_text(&line, *label->code ? " code=" : "");
    if (*label->code)
        command_write_word(&line, label->code);
    return execute_buf(m, &line);
}

/* Make labels that have numbers, before settings that name them. */
static enum err number_labels(struct making *m)
{
    const struct kept *kept = &m->interp.session->now.kept;
    for (unsigned l = 1; l < 256; l++)
        if (m->procedure->label[l].number)
            TRY(name_label(m, l));
    for (unsigned l = 1; l < 256; l++) {
        const int here = numbering_find(kept, m->number[l]);
        m->here[l] = (uint8_t)(here > 0 ? here : 0);
        m->there[m->here[l]] = (uint8_t)l;
    }
    m->there[0] = 0;
    return OK;
}

static enum err name_labels(struct making *m)
{
    for (unsigned l = 0; l < 256; l++)
        if ((*m->procedure->label[l].name || *m->procedure->label[l].code) &&
            m->procedure->label[l].is_there && !m->procedure->label[l].number)
            TRY(name_label(m, l));
    return OK;
}

static bool find_voxel(int64_t place[3], const struct making *m, const double mm[3])
{
    const struct session *session = m->interp.session;
    return geometry_voxel(&session->geometry, mm, place) &&
           grid_contains(&session->scene->grid, place[0], place[1], place[2]);
}

static enum err place_landmarks(struct making *m)
{
    for (size_t i = 0; i < m->choice->carry.landmarks; i++) {
        const struct procedure_landmark *mark = &m->choice->carry.landmark[i];
        int64_t at[3];
        struct buf line = {0};
        if (!find_voxel(at, m, mark->mm)) /* outside the scene; the fit still uses it */
            continue;
        buf_printf(&line, "landmark %s %d,%d,%d", mark->name, (int)at[0], (int)at[1], (int)at[2]);
        TRY(execute_buf(m, &line));
    }
    return OK;
}

/* ---- seeds ---- */

static void write_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct making *m = context;
    const uint32_t *size = m->interp.session->scene->grid.size;
    memcpy(values, m->warped.label + ((size_t)z * size[1] + y) * size[0],
           size[0] * sizeof *m->warped.label);
}

static void note_label(struct making *m, unsigned label, uint64_t seeds, uint64_t dropped)
{
    m->subject->label[label].seeds += seeds;
    m->subject->label[label].dropped += dropped;
}

/* Write the map, unless a file with the same bytes exists. */
static enum err write_seeds(struct making *m, const struct volume_map *map, const char *path)
{
    struct watch *watch = m->interp.session->watch;
    OWNED(buf_release) struct buf draft = {0};
    if (!file_exists(path)) {
        const enum err err = volume_write(path, FILE_KEEP, map, watch, m->fault);
        buf_add(&m->made, path, err ? 0 : strlen(path) + 1);
        return err;
    }
    TRY(file_draft(&draft, path, FILE_REPLACE, m->fault));
    enum err err = volume_write(buf_text(&draft), FILE_REPLACE, map, watch, m->fault);
    if (!err && !file_holds_same(buf_text(&draft), path))
        err = fault_set(m->fault, ERR_IO,
                        "%s exists, and is not the map of seeds that would be written; it was left "
                        "alone; rename it, or choose another folder by --out DIR",
                        path);
    file_discard(buf_text(&draft));
    return err;
}

/* Write the map, and the command that plants it. */
static enum err prepare_labels(struct making *m)
{
    struct session *session = m->interp.session;
    OWNED(buf_release) struct buf path = {0}, regions = {0}, as = {0};
    TRY(warp_seeds(&m->warped, session, m->choice->depth_mm, m->fault));
    const struct volume_map map = {.size = session->scene->grid.size,
                                   .geometry = &session->geometry,
                                   .type = VOXEL_UINT16,
                                   .description = "iftty seeds",
                                   .row = write_row,
                                   .context = m};
    subject_path(&path, m->choice, SUBJECT_SEEDS);
    for (unsigned l = 1; l <= 256; l++) {
        const unsigned label = l % 256;
        const uint64_t left = m->warped.eroded[label] - m->warped.dropped[label];
        note_label(m, label, m->warped.eroded[label], m->warped.dropped[label]);
        m->subject->label[label].depth_mm = m->warped.depth_mm[label];
        if (left) {
            buf_printf(&regions, "%s%u", regions.length ? "," : "", l);
            buf_printf(&as, "%s%u", as.length ? "," : "", m->number[label]);
        }
    }
    if (!regions.length)
        return fault_set(m->fault, ERR_CHECK, "no seed is left to plant");
    if (path.failed)
        return fault_memory(m->fault, "a path");
    TRY(write_seeds(m, &map, buf_text(&path)));
    buf_add_text(&m->seeds, "labels ");
    command_write_word(&m->seeds, file_name(buf_text(&path)));
    buf_printf(&m->seeds, " regions=%s as=%s erode=0 rest=none\n", buf_text(&regions),
               buf_text(&as));
    return OK;
}

static void write_mm(struct buf *out, int64_t nm)
{
    const struct decimal mm = decimal_of(nm, 6);
    decimal_write(out, &mm);
    buf_add_text(out, "mm");
}

/* Range of intensities of a gesture's seeds; low above high: any. The background's seeds share no
 * intensity, so each of its gestures has a range around its own, matched by the largest object.
 * Without that range brain Dice was .895 instead of .936 on a head deformed by 5 mm, because
 * background was planted in the brain. */
static void find_range(double range[2], const struct making *m, const struct procedure_gesture *g)
{
    unsigned object = 1; /* the largest */
    for (unsigned l = 1; l < 256; l++)
        if (m->procedure->label[l].voxels > m->procedure->label[object].voxels)
            object = l;
    const struct procedure_label *there = &m->procedure->label[object];
    const struct percentiles *here = &m->warped.percentiles;
    const double spread = here->high[object] - here->low[object];
    memcpy(range, m->warped.within[g->label], 2 * sizeof *range);
    if (g->label > 0 || m->choice->gate <= 0 || there->high <= there->low || spread <= 0)
        return;
    const double matched =
        here->low[object] + (g->intensity - there->low) * spread / (there->high - there->low);
    range[0] = matched - GATE_OF_BACKGROUND * spread;
    range[1] = matched + GATE_OF_BACKGROUND * spread;
}

/* Count the voxels of a gesture in a range. */
static enum err count_seeds(struct making *m, const struct procedure_gesture *g, int64_t radius_nm,
                            const uint32_t (*corner)[3], const double range[2], uint64_t *left)
{
    const struct session *session = m->interp.session;
    const struct scene *scene = session->scene;
    OWNED(brush_release) struct brush brush = {0};
    OWNED(voxels_release) struct voxels voxels = {0};
    TRY(brush_init(&brush, scene->spacing_nm, radius_nm, BRUSH_REACH_MOST, m->fault));
    TRY(paint_stroke(&voxels, &scene->grid, &brush, corner, g->corners, session->watch, m->fault));
    *left = 0;
    for (size_t i = 0; i < voxels.count; i++)
        *left += warp_may_have(range, percentiles_value(session, voxels.cell[i]));
    note_label(m, g->label, voxels.count, voxels.count - *left);
    return OK;
}

/* Append the command of a gesture, unless a corner is outside the scene or no seed is left. */
static enum err prepare_gesture(struct making *m, const struct procedure_gesture *g,
                                const struct affine *push, double times, uint32_t (*corner)[3])
{
    const int64_t radius_nm = llround(g->radius_mm * times * 1e6),
                  within_nm = llround(g->within_mm * times * 1e6);
    double range[2];
    uint64_t left;
    for (size_t i = 0; i < g->corners; i++) {
        double mm[3];
        int64_t place[3];
        affine_apply(push, m->procedure->corner[g->corner + i], mm);
        if (!find_voxel(place, m, mm)) {
            note_label(m, g->label, 1, 1);
            return OK;
        }
        for (int a = 0; a < 3; a++)
            corner[i][a] = (uint32_t)place[a];
    }
    if (radius_nm > 1000000000)
        return fault_set(m->fault, ERR_INPUT, "a gesture of the procedure is larger than a metre");
    find_range(range, m, g);
    const struct decimal low = decimal_near(range[0], 9), high = decimal_near(range[1], 9);
    range[0] = decimal_value(&low);
    range[1] = decimal_value(&high);
    TRY(count_seeds(m, g, radius_nm, (const uint32_t(*)[3])corner, range, &left));
    if (!left)
        return OK;
    buf_printf(&m->seeds, "seed %u,%u,%u %u", corner[0][0], corner[0][1], corner[0][2],
               m->number[g->label]);
    if (radius_nm) {
        buf_add_text(&m->seeds, " radius=");
        write_mm(&m->seeds, radius_nm);
    }
    if (range[0] <= range[1]) {
        buf_add_text(&m->seeds, " range=");
        decimal_write(&m->seeds, &low);
        buf_add_text(&m->seeds, "..");
        decimal_write(&m->seeds, &high);
    }
    for (size_t i = 1; i < g->corners; i++)
        buf_printf(&m->seeds, " to=%u,%u,%u", corner[i][0], corner[i][1], corner[i][2]);
    if (g->within_mm == GESTURE_EXACT) {
        buf_add_text(&m->seeds, " within=0");
    } else if (within_nm) {
        buf_add_text(&m->seeds, " within=");
        write_mm(&m->seeds, within_nm);
    }
    if (g->has_over) {
        buf_add_text(&m->seeds, " over=");
        numbering_write_set(&m->seeds, m->number, &g->over);
    }
    buf_add_char(&m->seeds, '\n');
    return OK;
}

static enum err prepare_gestures(struct making *m)
{
    const struct procedure *p = m->procedure;
    struct affine push;
    OWNED(mem_release) uint32_t(*corner)[3] = calloc(p->corners + 1, sizeof *corner);
    if (!corner)
        return fault_memory(m->fault, "gestures");
    if (!p->gestures)
        return fault_set(m->fault, ERR_INPUT,
                         "the procedure has no ball and no stroke, which alone can be moved; carry "
                         "its labels by --as labels");
    if (!affine_invert(&push, &m->subject->pull))
        return fault_set(m->fault, ERR_INPUT, "the transform has no inverse");
    for (size_t i = 0; i < p->gestures; i++) {
        TRY(prepare_gesture(m, &p->gesture[i], &push, cbrt(fabs(affine_determinant(&push))),
                            corner));
    }
    if (m->seeds.failed)
        return fault_memory(m->fault, "gestures");
    return m->seeds.length ? OK : fault_set(m->fault, ERR_CHECK, "no seed is left to plant");
}

/* ---- the origin ---- */

static void add_choice(struct buf *out, const char *key, const char *choices, unsigned which)
{
    const struct choice word = choice_at(choices, which);
    buf_printf(out, " %s=%.*s", key, (int)word.length, word.word);
}

static void write_origin(struct making *m)
{
    const struct subject_choice *choice = m->choice;
    const struct procedure *p = m->procedure;
    struct buf *out = &m->origin;
    buf_clear(out);
    buf_printf(out, "origin %s digest=%s", p->chain.hex, p->digest);
    add_choice(out, "by", ORIGIN_WAYS, choice->carry.way);
    add_choice(out, "as", ORIGIN_PLANTS, (unsigned)choice->plants);
    for (unsigned i = 0; i < 12; i++) {
        const struct decimal number = decimal_near(m->subject->pull.m[i / 4][i % 4], 17);
        buf_add_text(out, i ? "," : " pull=");
        decimal_write(out, &number);
    }
    buf_printf(out, " scene=%s from=%s gate=%g depth=%g", m->interp.session->proof, p->scene,
               choice->gate * 100, choice->plants == PLANT_LABELS ? choice->depth_mm : 0);
    const char *between = " volumes=";
    if (choice->carry.way == CARRY_LANDMARKS)
        buf_printf(out, " rms=%.6g", m->subject->rms_mm);
    uint8_t order[256];
    numbering_order(order, m->number);
    for (unsigned i = 1, l; i < 256; i++)
        if (m->subject->label[l = order[i]].is_there) {
            buf_printf(out, "%s%u:%.0f", between, m->number[l],
                       fmin(round(m->subject->label[l].expected_mm3), UINT32_MAX));
            between = ",";
        }
    between = " dropped=";
    for (unsigned i = 0, l; i < 256; i++)
        if (m->subject->label[l = order[i]].seeds) {
            buf_printf(out, "%s%u:%llu/%llu", between, m->number[l],
                       (unsigned long long)m->subject->label[l].dropped,
                       (unsigned long long)m->subject->label[l].seeds);
            between = ",";
        }
}

/* ---- an existing journal ---- */

static enum err refuse_journal(const struct making *m)
{
    return fault_set(
        m->fault, ERR_IO,
        "%s exists, and differs from the journal that would be written: it is of another procedure "
        "or scene, of other options, or unfinished; choose another folder by --out DIR",
        buf_text(&m->subject->journal));
}

/* Parse the twelve numbers of an origin. */
static bool read_pull(struct affine *pull, const char *command)
{
    const char *at = strncmp(command, "origin ", 7) == 0 ? strstr(command, " pull=") : NULL;
    struct decimal number;
    unsigned count = 0;
    if (!at)
        return false;
    at += strlen(" pull=");
    while (count < 12 && decimal_scan(&at, &number)) {
        pull->m[count / 4][count % 4] = decimal_value(&number);
        count++;
        at += *at == ',';
    }
    return count == 12 && affine_is_finite(pull);
}

/* Read the transform from the journal's origin. */
static enum err find_pull(struct affine *pull, const struct making *m)
{
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    bool found = false;
    TRY(walk_file(&walk, &bytes, buf_text(&m->subject->journal), m->fault));
    while (!found && walk_next_sound(&walk, &record) == WALK_RECORD)
        found = read_pull(pull, record.command);
    return found ? OK : refuse_journal(m);
}

/* Compare the journal with the draft, record by record. */
static enum err compare_records(const struct making *m, const char *draft)
{
    OWNED(buf_release) struct buf bytes = {0}, own_bytes = {0};
    OWNED(walk_release) struct walk walk = {0}, own = {0};
    struct record record, own_record;
    bool same = true;
    TRY(walk_file(&walk, &bytes, draft, m->fault));
    TRY(walk_file(&own, &own_bytes, buf_text(&m->subject->journal), m->fault));
    while (same && walk_next_sound(&walk, &record) == WALK_RECORD)
        same = walk_next_sound(&own, &own_record) == WALK_RECORD &&
               strcmp(record.command, own_record.command) == 0 &&
               strcmp(record.result, own_record.result) == 0;
    while (same && walk_next_sound(&own, &own_record) == WALK_RECORD)
        ;
    same = same && walk.over == WALK_END && own.over == WALK_END;
    return same ? OK : refuse_journal(m);
}

/* ---- results ---- */

/* Count the voxels of each label that share a face with another label. */
static void count_borders(uint64_t border[256], const struct session *session)
{
    const struct scene *scene = session->scene;
    const struct grid *grid = &scene->grid;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            const struct cell *at = scene->cell + c;
            bool differs = false;
            for (int a = 0; a < 3; a++)
                differs |=
                    at[grid->step[a]].label != at->label || at[-grid->step[a]].label != at->label;
            border[at->label] += differs;
        }
}

static enum err find_doubts(struct making *m)
{
    struct session *session = m->interp.session;
    const struct hint_list *hints;
    if (session->now.kept.weight.kind == WEIGHT_POLARITY)
        return OK; /* has no hints */
    TRY(session_find_hints(session, &hints, NULL, m->fault));
    uint64_t border[256] = {0};
    count_borders(border, session);
    for (size_t i = 0; i < hints->count; i++) {
        const struct hint *hint = &hints->item[i];
        m->subject->label[m->there[hint->label]].doubt += hint->voxels;
        m->subject->label[m->there[hint->other]].doubt += hint->voxels;
    }
    for (unsigned l = 0; l < 256; l++) { /* the border has two sides */
        const double share = m->subject->label[l].doubt / (2 * (double)border[m->here[l]] + 1);
        m->subject->label[l].doubt = fmin(share, 1);
    }
    return OK;
}

/* The map of seeds has replaced the warped labels: warp them again. */
static enum err find_far(uint64_t far[256], struct making *m)
{
    const struct session *session = m->interp.session;
    warped_release(&m->warped);
    const enum err err =
        warp_labels(&m->warped, m->procedure, session, &m->subject->pull, m->fault);
    const struct grid *grid = &session->scene->grid;
    for (size_t i = 0; !err && i < grid->voxels; i++) /* as labels of the session */
        if (m->warped.label[i] < 256)
            m->warped.label[i] = m->here[m->warped.label[i]];
    return err ? err : warp_count_far(far, &m->warped, session, m->fault);
}

static enum err sum_up(struct making *m)
{
    struct session *session = m->interp.session;
    const double voxel_mm3 = tally_voxel_mm3(&session->geometry);
    double share;
    uint64_t far[256];
    TRY(session_find_worst(session, &m->subject->worst, &share, m->fault));
    TRY(find_doubts(m));
    TRY(find_far(far, m));
    m->subject->worst = m->there[m->subject->worst];
    for (unsigned l = 1; l < 256; l++) {
        struct subject_label *label = &m->subject->label[l];
        label->voxels = session->tally.voxels[m->here[l]];
        label->mm3 = (double)label->voxels * voxel_mm3;
        label->far_mm3 = (double)far[m->here[l]] * voxel_mm3;
        label->is_bad = label->is_there && (2 * label->mm3 > 3 * label->expected_mm3 ||
                                            3 * label->mm3 < 2 * label->expected_mm3 ||
                                            far[m->here[l]] * BAD_ONE_OF > label->voxels);
    }
    return OK;
}

/* ---- all steps ---- */

static enum err plant_seeds(struct making *m)
{
    TRY(execute_line(m, buf_text(&m->origin)));
    for (char *at = m->seeds.data; *at;) {
        char *end = at + strcspn(at, "\n");
        *end = '\0';
        TRY(execute_line(m, at));
        at = end + 1;
    }
    return execute_line(m, "run");
}

static enum err prepare_seeds(struct making *m)
{
    const struct procedure *p = m->procedure;
    const double shrinks = fabs(affine_determinant(&m->subject->pull));
    for (unsigned l = 0; l < 256; l++) {
        m->subject->label[l].is_there = l && p->label[l].voxels > 0;
        m->subject->label[l].expected_mm3 =
            (double)p->label[l].voxels * procedure_voxel_mm3(p) / shrinks;
    }
    TRY(warp_labels(&m->warped, p, m->interp.session, &m->subject->pull, m->fault));
    warp_find_gates(&m->warped, p, m->choice->gate);
    TRY(m->choice->plants == PLANT_LABELS ? prepare_labels(m) : prepare_gestures(m));
    write_origin(m);
    return m->origin.failed || m->seeds.failed ? fault_memory(m->fault, "seeds") : OK;
}

/* List all that is not carried over. */
static void say_left(struct making *m)
{
    static const char *const what[LEFT_GESTURES] = {"its map of weights", "its mask", "its range"};
    const uint32_t *left = m->procedure->left;
    struct buf *out = &m->subject->words;
    const char *before = out->length ? "; not carried over: " : "not carried over: ";
    for (int i = 0; i < LEFT_GESTURES; i++)
        if (left[i]) {
            buf_printf(out, "%s%s", before, what[i]);
            before = ", ";
        }
    if (left[LEFT_GESTURES] && m->choice->plants != PLANT_LABELS)
        buf_printf(out, "%s%u gesture%s that %s no ball or stroke", before, left[LEFT_GESTURES],
                   plural(left[LEFT_GESTURES]), left[LEFT_GESTURES] == 1 ? "is" : "are");
}

static enum err carry_over(struct making *m)
{
    struct carry carry = {.rms_mm = 0};
    const enum err err =
        m->is_there && m->choice->carry.way == CARRY_AFFINE
            ? find_pull(&carry.pull, m)
            : carry_find(&carry, &m->choice->carry, m->procedure, m->interp.session, m->fault);
    m->subject->pull = carry.pull;
    m->subject->rms_mm = carry.rms_mm;
    m->subject->words = carry.words;
    say_left(m);
    return err;
}

static enum err make_journal(struct making *m)
{
    static enum err (*const step[])(struct making * m) = {
        open_scene,    carry_over,  number_labels, execute_settings, name_labels, place_landmarks,
        prepare_seeds, plant_seeds, sum_up};
    for (size_t i = 0; i < sizeof step / sizeof *step; i++)
        TRY(step[i](m));
    return journal_sync(m->interp.journal, m->fault);
}

enum err subject_make(struct subject *subject, const struct procedure *procedure,
                      const struct subject_choice *choice, struct fault *fault)
{
    struct making m = {
        .procedure = procedure, .choice = choice, .subject = subject, .fault = fault};
    OWNED(buf_release) struct buf draft = {0}, goldens = {0};
    procedure_numbers(m.number, procedure);
    subject_path(&subject->journal, choice, SUBJECT_JOURNAL);
    subject_path(&goldens, choice, SUBJECT_GOLDENS);
    const char *path = buf_text(&subject->journal);
    const bool is_there = m.is_there = file_exists(path);
    const bool had_goldens = file_exists(buf_text(&goldens));
    enum err err = interpreter_init(&m.interp, fault);
    session_set_watch(m.interp.session, choice->watch);
    if (!err && (subject->journal.failed || goldens.failed))
        err = fault_memory(fault, "a path");
    if (!err)
        err = file_draft(&draft, path, FILE_REPLACE, fault);
    if (!err)
        err = interpreter_create_journal(&m.interp, buf_text(&draft), fault);
    const bool is_begun = !err;
    if (!err) /* name files by the journal's final name */
        err = interpreter_set_home(&m.interp, path, fault);
    if (!err)
        err = make_journal(&m);
    interpreter_release(&m.interp);
    if (!err && is_there)
        err = compare_records(&m, buf_text(&draft));
    subject->was_there = !err && is_there;
    const bool is_made = !err && !is_there;
    if (is_made)
        err = file_publish(buf_text(&draft), path, FILE_KEEP, fault);
    else if (is_begun)
        file_discard(buf_text(&draft));
    if (err || is_there) {
        for (size_t at = 0; at < m.made.length; at += strlen(m.made.data + at) + 1)
            file_discard(m.made.data + at);
        if (!had_goldens)
            rmdir(buf_text(&goldens));
    }
    warped_release(&m.warped);
    buf_release(&m.origin);
    buf_release(&m.seeds);
    buf_release(&m.made);
    return err;
}
