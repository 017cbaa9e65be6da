/* SPDX-License-Identifier: MIT */
#include "apply/registration.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"

enum { BYTES_MOST = 1 << 20, SIXTEEN = 16, KIND_MOST = 96, TRANSFORM_HELD_MOST = 256 << 20 };

static const char FSL[] = "fsl:";

const char *register_helper_program;
int register_helper_patience_ms = 60000;

/* Start the helper for `task`, with this limit of memory. Always call coprocess_release. */
static enum err start_helper(struct coprocess *out, const char *task, uint64_t bytes,
                             struct watch *watch, struct fault *fault)
{
    const uint64_t available = mem_available();
    TRY(coprocess_init(out, REGISTER_HELPER, register_helper_program, fault));
    out->kind = "the register helper";
    out->made_of = COPROCESS_OF_ITK;
    out->package = "iftty-volume";
    out->patience_ms = register_helper_patience_ms;
    out->memory = bytes < available ? bytes : available;
    out->watch = watch;
    out->doing = task;
    return coprocess_start(out, fault);
}

/* ---- FSL ---- */

/* Parse four rows of four numbers; the last row must be 0 0 0 1. */
static bool scan_square(struct affine *out, const char *text)
{
    double number[SIXTEEN];
    int count = 0;
    for (;;) {
        struct decimal decimal;
        text += strspn(text, " \t\r\n");
        if (!*text)
            break;
        if (count == SIXTEEN || !decimal_scan(&text, &decimal) || !strchr(" \t\r\n", *text))
            return false; /* strchr also matches the NUL */
        number[count++] = decimal_value(&decimal);
    }
    if (count != SIXTEEN || number[12] != 0 || number[13] != 0 || number[14] != 0 ||
        number[15] != 1)
        return false;
    memcpy(out->m, number, sizeof out->m);
    return true;
}

/* Map from FLIRT's millimetres of a scene to its world: along the voxel axes from the centre of the
 * first voxel, x from the other end if the axes are right-handed. */
static bool from_flirt(struct affine *out, const struct placed_grid *grid)
{
    const struct geometry *geometry = grid->geometry;
    struct affine to_voxel = {{{0}}}, to_world;
    for (int a = 0; a < 3; a++) {
        const double step = geometry_step_mm(geometry, a);
        if (!(step > 0))
            return false;
        to_voxel.m[a][a] = 1 / step;
    }
    if (!geometry_is_mirrored(geometry)) {
        to_voxel.m[0][0] = -to_voxel.m[0][0];
        to_voxel.m[0][3] = (double)grid->size[0] - 1;
    }
    memcpy(to_world.m, geometry->to_mm, sizeof to_world.m);
    affine_compose(out, &to_world, &to_voxel);
    return true;
}

/* ---- ITK ---- */

/* Parse a transform of ITK in the confined helper. */
static enum err read_by_helper(struct affine *out, struct buf *kind, const struct buf *bytes,
                               struct fault *fault)
{
    char line[COPROCESS_LINE], name[KIND_MOST];
    const char *at = line;
    static const int64_t most = KIND_MOST - 1;
    int64_t length = 0;
    OWNED(coprocess_release) struct coprocess process;
    enum err err = start_helper(&process, "a transform", TRANSFORM_HELD_MOST, NULL, fault);
    snprintf(line, sizeof line, "transform %zu\n", bytes->length);
    if (!err && !(coprocess_transmit(&process, line, strlen(line)) &&
                  coprocess_transmit(&process, buf_text(bytes), bytes->length)))
        err = coprocess_fault(&process, NULL, NULL, fault);
    err = err ? err : coprocess_answer(&process, line, NULL, NULL, fault);
    if (!err) {
        bool makes_sense = (scan_text(&at, "transform ") &&
                            coprocess_numbers(at, 1, &most, &length) && length > 0) ||
                           coprocess_odd(&process);
        makes_sense = makes_sense && coprocess_receive(&process, name, (size_t)length) &&
                      coprocess_receive(&process, out->m, sizeof out->m);
        for (int64_t i = 0; makes_sense && i < length; i++)
            makes_sense = (name[i] > ' ' && name[i] <= '~') || coprocess_odd(&process);
        err = makes_sense ? OK : coprocess_fault(&process, NULL, NULL, fault);
    }
    buf_add_text(kind, "ITK's ");
    buf_add(kind, name, err ? 0 : (size_t)length);
    return err;
}

/* ---- all formats ---- */

/* Parse a file to a map from the fixed scene's world to the moving one's, RAS+. */
static enum err take_file(struct affine *out, struct buf *kind, const struct buf *bytes,
                          bool is_fsl, const struct placed_grid *fixed,
                          const struct placed_grid *moving, struct fault *fault)
{
    const char *text = buf_text(bytes);
    const bool is_text = strlen(text) == bytes->length;
    struct affine flirt, to_fixed, to_moving, from_moving;
    if (is_fsl) { /* it maps the moving scene to the fixed one */
        if (!is_text || !scan_square(&flirt, text))
            return fault_set(fault, ERR_INPUT,
                             "it is no matrix of FLIRT; expected four rows of four numbers, the "
                             "last one 0 0 0 1");
        buf_add_text(kind, "a matrix of FSL's FLIRT");
        if (!from_flirt(&to_fixed, fixed) || !from_flirt(&to_moving, moving) ||
            !affine_invert(&from_moving, &to_moving))
            return fault_set(fault, ERR_INPUT, "the place of a scene in the world has no inverse");
        affine_compose(out, &flirt, &from_moving);
        affine_compose(out, &to_fixed, out);
        return affine_invert(out, out) ? OK
                                       : fault_set(fault, ERR_INPUT, "its matrix has no inverse");
    }
    if (is_text && scan_square(&flirt, text))
        return fault_set(
            fault, ERR_INPUT,
            "its sixteen numbers may mean anything; if FLIRT wrote them, name it as \"fsl:FILE\"");
    TRY(read_by_helper(out, kind, bytes, fault));
    for (int i = 0; i < 3; i++) /* from LPS+ to RAS+: reverse x and y on both sides */
        for (int j = 0; j < 4; j++)
            if ((i < 2) != (j < 2))
                out->m[i][j] = 0 - out->m[i][j];
    return OK;
}

enum err transform_read(struct affine *out, struct buf *words, const char *path,
                        const struct placed_grid *procedure, const struct placed_grid *subject,
                        struct fault *fault)
{
    const bool is_fsl = scan_text(&path, FSL), has_subject = geometry_has_place(subject->geometry);
    OWNED(buf_release) struct buf bytes = {0}, kind = {0};
    struct affine found, back;
    if (!has_subject || !geometry_has_place(procedure->geometry))
        return fault_set(fault, ERR_INPUT,
                         "%s: the file of the %s scene does not say where it is in the world, so a "
                         "transform's numbers have no meaning in it",
                         path, has_subject ? "procedure's" : "subject's");
    TRY(file_read(&bytes, path, BYTES_MOST, fault));
    enum err err = take_file(&found, &kind, &bytes, is_fsl, subject, procedure, fault);
    if (!err && (!affine_is_finite(&found) || !affine_invert(&back, &found)))
        err = fault_set(fault, ERR_INPUT, "it has no inverse");
    if (!err && affine_determinant(&found) < 0)
        err = fault_set(
            fault, ERR_INPUT,
            "it makes a mirror image of the patient (its determinant is %.3g): left and right are "
            "swapped in one of the scenes, or it is no transform of ITK or FLIRT",
            affine_determinant(&found));
    buf_printf(words, "%s, taken as found with the subject's scene as the fixed one%s",
               buf_text(&kind), is_fsl ? " (-ref)" : "");
    if (!err && (kind.failed || words->failed))
        err = fault_memory(fault, "a transform's name");
    TRY(fault_prefix(fault, err, "%s", path));
    *out = found;
    return OK;
}

enum {
    VOXELS_MOST = 1 << 23, /* limit of a registered scene; larger scenes are reduced */
    MAP = 12,              /* numbers of a map or a matrix */
    NUMBERS = 19
};

/* Two scenes with their pyramids, and ITK, which took 190 MB for two heads of 7 M voxels. */
static const uint64_t HELD_MOST = UINT64_C(1) << 30;

/* ---- request ---- */

/* A scene reduced by boxes of voxels. */
struct reduced {
    const struct scene *scene;
    uint32_t size[3], factor[3];
    double to_mm[3][4];
};

/* Enlarge the shortest side of a voxel until few enough remain. */
static void reduce_scene(struct reduced *out, const struct placed_scene *placed)
{
    const struct grid *grid = &placed->scene->grid;
    struct geometry geometry = *placed->geometry;
    *out = (struct reduced){.scene = placed->scene, .factor = {1, 1, 1}};
    double first[3], step[3];
    for (;;) {
        size_t voxels = 1;
        int shortest = -1;
        double length = 0;
        for (int a = 0; a < 3; a++) {
            out->size[a] = grid->size[a] / out->factor[a];
            voxels *= out->size[a];
            step[a] = out->factor[a];
            first[a] = (step[a] - 1) / 2;
            const double side = geometry_step_mm(placed->geometry, a) * step[a];
            if (out->size[a] > 1 && (shortest < 0 || side < length)) {
                shortest = a;
                length = side;
            }
        }
        if (voxels <= VOXELS_MOST || shortest < 0)
            break;
        out->factor[shortest]++;
    }
    geometry_derive(&geometry, first, step);
    memcpy(out->to_mm, geometry.to_mm, sizeof out->to_mm);
}

/* Rounded mean of a box. */
static uint16_t mean_of(const struct reduced *from, const uint32_t place[3])
{
    const uint32_t *f = from->factor, *size = from->scene->grid.size;
    const uint64_t voxels = (uint64_t)f[0] * f[1] * f[2];
    uint64_t sum = 0;
    for (uint32_t z = place[2] * f[2]; z < (place[2] + 1) * f[2]; z++)
        for (uint32_t y = place[1] * f[1]; y < (place[1] + 1) * f[1]; y++)
            for (uint32_t x = place[0] * f[0]; x < (place[0] + 1) * f[0]; x++)
                sum += from->scene->plain
                           ? from->scene->plain[x + size[0] * (y + (size_t)size[1] * z)]
                           : from->scene->cell[grid_cell(&from->scene->grid, x, y, z)].intensity;
    return (uint16_t)((sum + voxels / 2) / voxels);
}

static enum err send_scene(struct coprocess *process, const struct reduced *from,
                           struct watch *watch, struct fault *fault)
{
    const uint32_t *size = from->size, *factor = from->factor;
    const size_t plane = (size_t)size[0] * size[1];
    struct task task = task_begin(watch, "registration", from->scene->grid.voxels);
    OWNED(mem_release) uint16_t *voxel = mem_array(plane, sizeof *voxel);
    if (!voxel)
        return fault_memory(fault, "a slice of the scene");
    bool goes = coprocess_transmit(process, from->to_mm, sizeof from->to_mm);
    for (uint32_t z = 0; goes && z < size[2]; z++) {
        uint16_t *to = voxel;
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                *to++ = mean_of(from, (const uint32_t[3]){x, y, z});
        goes = task_advance(&task, (uint64_t)plane * factor[0] * factor[1] * factor[2]) &&
               coprocess_transmit(process, voxel, plane * sizeof *voxel);
    }
    TRY(watch_fault(watch, fault));
    return goes ? OK : coprocess_fault(process, NULL, NULL, fault);
}

/* ---- answer ---- */

static enum err receive_found(struct registration *out, struct coprocess *process,
                              struct fault *fault)
{
    enum { STEPS_MOST = 1000000 };
    static const int64_t most[2] = {STEPS_MOST, STEPS_MOST};
    char line[COPROCESS_LINE];
    double number[NUMBERS];
    int64_t before = -1, step[2];
    for (;; before = step[0]) {
        const char *at = line;
        TRY(coprocess_answer(process, line, NULL, NULL, fault));
        if (strcmp(line, "found") == 0)
            break;
        if (!scan_text(&at, "progress ") || !coprocess_numbers(at, 2, most, step) ||
            step[0] < before || step[0] > step[1]) {
            coprocess_odd(process);
            return coprocess_fault(process, NULL, NULL, fault);
        }
        if (watch_poll(process->watch, process->doing, (uint64_t)step[0], (uint64_t)step[1]))
            return watch_fault(process->watch, fault);
    }
    bool makes_sense = coprocess_receive(process, number, sizeof number);
    for (int i = 0; makes_sense && i < NUMBERS; i++)
        if (!isfinite(number[i]) || (i >= MAP && number[i] < 0))
            makes_sense = coprocess_odd(process);
    if (!makes_sense)
        return coprocess_fault(process, NULL, NULL, fault);
    memcpy(out->affine.m, number, sizeof out->affine.m);
    const double *at = number + MAP;
    out->metric = *at++;
    out->identity_metric = *at++;
    out->mirrored_metric = *at++;
    out->overlap = fmin(fmin(at[0], at[1]), 1);
    out->tells_sides = out->mirrored_metric * REGISTRATION_MIRRORED_MOST < out->metric;
    at += 2;
    out->agreement_mm = *at++;
    out->length_mm = *at;
    affine_stretches(&out->affine, out->stretch);
    return OK;
}

/* Reject an implausible result. The most telling figure comes first: the later ones often fail with
 * it. */
static enum err check_result(const struct registration *r, struct fault *fault)
{
    const double volume = affine_determinant(&r->affine);
    const double identity_least = r->identity_metric * (1 - REGISTRATION_WORSE_MOST);
    char words[200] = "";
    if (r->metric < REGISTRATION_METRIC_LEAST)
        snprintf(words, sizeof words,
                 "their intensities are hardly related (%.3f nats; expected "
                 "%.2f or more)",
                 r->metric, REGISTRATION_METRIC_LEAST);
    else if (r->overlap < REGISTRATION_OVERLAP_LEAST)
        snprintf(
            words, sizeof words,
            "only %.0f %% of one scene's content is inside the other; expected %.0f %% or more",
            100 * r->overlap, 100 * REGISTRATION_OVERLAP_LEAST);
    else if (!(volume * REGISTRATION_VOLUME_MOST >= 1 && volume <= REGISTRATION_VOLUME_MOST) ||
             r->stretch[2] < REGISTRATION_STRETCH_LEAST ||
             r->stretch[0] > REGISTRATION_STRETCH_MOST)
        snprintf(words, sizeof words,
                 "it stretches by %.2f, %.2f and %.2f; expected %.2f to %.2f, no mirror image, and "
                 "a volume of %.1f to %.1f",
                 r->stretch[0], r->stretch[1], r->stretch[2], REGISTRATION_STRETCH_LEAST,
                 REGISTRATION_STRETCH_MOST, 1 / REGISTRATION_VOLUME_MOST, REGISTRATION_VOLUME_MOST);
    else if (!(r->agreement_mm <= REGISTRATION_AGREEMENT_MOST * r->length_mm))
        snprintf(words, sizeof words,
                 "the maps there and back differ by %.1f mm; expected %.1f mm or less",
                 r->agreement_mm, REGISTRATION_AGREEMENT_MOST * r->length_mm);
    else if (r->mirrored_metric > REGISTRATION_MIRRORED_MOST * r->metric)
        snprintf(words, sizeof words,
                 "its mirror image fits better (%.3f nats to %.3f): left and right may be swapped "
                 "in one of the files",
                 r->mirrored_metric, r->metric);
    else if (r->metric < identity_least)
        snprintf(words, sizeof words, "the scenes fit better without it (%.3f nats to %.3f)",
                 r->identity_metric, r->metric);
    else
        return OK;
    return fault_set(fault, ERR_CHECK,
                     "the scenes were registered, and the result is implausible: %s; use landmarks "
                     "in both scenes, or a transform of another program",
                     words);
}

enum err registration_find(struct registration *out, const struct placed_scene *subject,
                           const struct placed_scene *procedure, struct watch *watch,
                           struct fault *fault)
{
    struct reduced scene[2];
    char line[COPROCESS_LINE];
    *out = (struct registration){.metric = 0};
    if (!geometry_has_sides(subject->geometry) || !geometry_has_sides(procedure->geometry))
        return fault_set(fault, ERR_INPUT,
                         "the %s file does not say how its axes run in the patient, or how far "
                         "apart its voxels are, so left and right are unknown",
                         geometry_has_sides(subject->geometry) ? "procedure's" : "subject's");
    reduce_scene(&scene[0], subject);
    reduce_scene(&scene[1], procedure);
    const uint32_t *a = scene[0].size, *b = scene[1].size;
    const int length = snprintf(line, sizeof line, "register %u %u %u %u %u %u\n", a[0], a[1], a[2],
                                b[0], b[1], b[2]);
    OWNED(coprocess_release) struct coprocess process;
    TRY(start_helper(&process, "registration", HELD_MOST, watch, fault));
    if (!coprocess_transmit(&process, line, (size_t)length))
        return coprocess_fault(&process, NULL, NULL, fault);
    for (int i = 0; i < 2; i++)
        TRY(send_scene(&process, &scene[i], watch, fault));
    TRY(receive_found(out, &process, fault));
    TRY(watch_fault(watch, fault));
    return check_result(out, fault);
}
