/* SPDX-License-Identifier: MIT */
#include "apply/apply.h"

#include <string.h>

#include "base/choice.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/file.h"
#include "base/safe.h"
#include "apply/registration.h"

/* ---- landmarks ---- */

enum { LANDMARKS_BYTES = 1 << 16 };

static bool read_mark(struct procedure_landmark *mark, const char *at)
{
    const size_t n = strcspn(at, " \t");
    struct decimal number;
    if (n == 0 || n >= PROCEDURE_NAME)
        return false;
    *mark = (struct procedure_landmark){.name = ""};
    memcpy(mark->name, at, n);
    at += n;
    for (int a = 0; a < 3; a++) {
        if (a > 0 && !scan_text(&at, ",") && *at != ' ' && *at != '\t')
            return false;
        scan_blanks(&at);
        if (!decimal_scan(&at, &number))
            return false;
        mark->mm[a] = decimal_value(&number);
    }
    scan_text(&at, "mm");
    scan_blanks(&at);
    return *at == '\0' && *safe_end(mark->name) == '\0';
}

static bool is_named(const struct procedure_landmark *mark, size_t marks, const char *name)
{
    for (size_t i = 0; i < marks; i++)
        if (strcmp(mark[i].name, name) == 0)
            return true;
    return false;
}

enum err carry_read_landmarks(struct procedure_landmark mark[PROCEDURE_LANDMARKS], size_t *marks,
                              const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0}, line = {0};
    TRY(file_read(&text, path, LANDMARKS_BYTES, fault));
    size_t number = 0;
    *marks = 0;
    for (const char *at = buf_text(&text); *at; at += *at == '\n') {
        const size_t n = strcspn(at, "\r\n");
        struct procedure_landmark next;
        buf_clear(&line);
        buf_add(&line, at, n);
        at += n + (at[n] == '\r');
        number++;
        if (n == 0 || *buf_text(&line) == '#')
            continue;
        if (!read_mark(&next, buf_text(&line)) || is_named(mark, *marks, next.name))
            return fault_set(fault, ERR_INPUT,
                             "%s, line %zu: expected NAME X,Y,Z in millimetres, each name once",
                             path, number);
        if (*marks == PROCEDURE_LANDMARKS)
            return fault_set(fault, ERR_LIMIT, "%s: %d landmarks are taken, and no more", path,
                             PROCEDURE_LANDMARKS);
        mark[(*marks)++] = next;
    }
    return OK;
}

static enum err fit_landmarks(struct carry *carry, const struct carry_choice *choice,
                              const struct procedure *p, struct fault *fault)
{
    double from[PROCEDURE_LANDMARKS][3], to[PROCEDURE_LANDMARKS][3];
    size_t n = 0;
    for (size_t i = 0; i < choice->landmarks; i++)
        for (size_t k = 0; k < p->landmarks; k++)
            if (strcmp(choice->landmark[i].name, p->landmark[k].name) == 0) {
                memcpy(from[n], choice->landmark[i].mm, sizeof from[n]);
                memcpy(to[n++], p->landmark[k].mm, sizeof to[n]);
            }
    if (n < AFFINE_PAIRS)
        return fault_set(fault, ERR_INPUT,
                         "%zu landmark%s of the subject %s in the procedure too (%zu and %zu), and "
                         "3 are needed; `landmark NAME X,Y,Z` adds them to the procedure's "
                         "journal, and --landmarks FILE names the subject's",
                         n, plural(n), n == 1 ? "is" : "are", choice->landmarks, p->landmarks);
    const enum affine_kind kind =
        choice->kind == AFFINE_FULL && n < AFFINE_PAIRS_FULL ? AFFINE_RIGID : choice->kind;
    TRY(affine_fit(&carry->pull, kind, n, (const double(*)[3])from, (const double(*)[3])to,
                   &carry->rms_mm, fault));
    const struct choice word = choice_at(CARRY_FITS, kind);
    buf_printf(&carry->words, "%.*s by %zu landmarks, off by %.2f mm", (int)word.length, word.word,
               n, carry->rms_mm);
    return OK;
}

/* ---- registration ---- */

/* Place and spacing of the procedure's scene. */
static struct geometry geometry_of(const struct procedure *p)
{
    struct geometry geometry = {.slope = 1};
    geometry_place(&geometry, (const double(*)[4])p->to_mm.m, ORIENTATION_SFORM);
    for (int a = 0; a < 3; a++)
        geometry_spacing(&geometry.spacing_nm[a], geometry_step_mm(&geometry, a));
    return geometry;
}

static enum err find_affine(struct carry *carry, const struct carry_choice *choice,
                            const struct procedure *p, const struct session *subject,
                            struct fault *fault)
{
    struct registration found;
    struct scene *scene = NULL;
    const struct geometry geometry = geometry_of(p);
    if (!choice->intensity)
        return fault_set(fault, ERR_INPUT,
                         "--by affine needs both scenes, and a procedure's file has no scene; use "
                         "the journal with its scene, or --by landmarks, --by FILE (a transform "
                         "that was found with the scene) or --by world");
    enum err err = scene_new(&scene, p->size, choice->intensity, subject->watch, fault);
    if (!err) {
        memcpy(scene->spacing_nm, geometry.spacing_nm, sizeof scene->spacing_nm);
        memcpy(scene->world_axis, geometry.world_axis, sizeof scene->world_axis);
        memcpy(scene->world_sign, geometry.world_sign, sizeof scene->world_sign);
        const struct placed_scene moving = {scene, &geometry};
        const struct placed_scene fixed = {subject->scene, &subject->geometry};
        err = registration_find(&found, &fixed, &moving, subject->watch, fault);
    }
    if (!err) {
        carry->pull = found.affine;
        buf_printf(&carry->words,
                   "registered: overlap %.0f %%, mutual information %.3f (%.3f before), agreement "
                   "%.2f mm",
                   100 * found.overlap, found.metric, found.identity_metric, found.agreement_mm);
        if (!found.tells_sides)
            buf_add_text(&carry->words, "; the images do not tell left from right, the files alone "
                                        "do: look at a side that you know");
    }
    scene_free(scene);
    return err;
}

/* ---- all ways ---- */

/* Reject a scene whose place is not known well enough. */
static enum err check_place(const struct carry_choice *choice, const struct procedure *p,
                            const struct session *subject, struct fault *fault)
{
    const struct geometry *geometry = &subject->geometry;
    const bool has_place = geometry_has_place(geometry);
    if (!geometry_has_sides(geometry))
        return fault_set(
            fault, ERR_INPUT, "its file does not say %s, and iftty does not guess it; %s",
            geometry->spacing_unknown ? "how far apart voxels are"
                                      : "to which sides of the patient its axes run",
            geometry->spacing_unknown
                ? "write a file that does"
                : "if you know the orientation for sure, give it, for example by --orient RAS");
    if (choice->way == CARRY_LANDMARKS || choice->way == CARRY_AFFINE ||
        (has_place && p->has_place))
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "%s where %s in the world; --by landmarks needs only sides and millimetres",
                     has_place      ? "the procedure's scene does not say"
                     : p->has_place ? "its file does not say"
                                    : "neither its file nor the procedure's scene says",
                     has_place || p->has_place ? "it is" : "they are");
}

enum err carry_find(struct carry *carry, const struct carry_choice *choice,
                    const struct procedure *p, const struct session *subject, struct fault *fault)
{
    const struct geometry *geometry = &subject->geometry;
    *carry = (struct carry){.rms_mm = 0};
    affine_identity(&carry->pull);
    TRY(check_place(choice, p, subject, fault));
    if (choice->way == CARRY_WORLD)
        return OK;
    if (choice->way == CARRY_LANDMARKS)
        return fit_landmarks(carry, choice, p, fault);
    if (choice->way == CARRY_AFFINE)
        return find_affine(carry, choice, p, subject, fault);
    const struct geometry of_procedure = geometry_of(p);
    struct placed_grid there = {.geometry = &of_procedure}, here = {.geometry = geometry};
    memcpy(there.size, p->size, sizeof there.size);
    memcpy(here.size, subject->scene->grid.size, sizeof here.size);
    return transform_read(&carry->pull, &carry->words, choice->file, &there, &here, fault);
}
