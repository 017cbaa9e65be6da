/* SPDX-License-Identifier: MIT */
#include "apply/transform_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/scan.h"
#include "base/file.h"
#include "apply/register_helper.h"

enum { BYTES_MOST = 1 << 20, SIXTEEN = 16, KIND_MOST = 96, HELD_MOST = 256 << 20 };

static const char FSL[] = "fsl:";

/* ---- FSL ---- */

/* Sixteen numbers in four rows, the last of which is 0 0 0 1. */
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
            return false; /* strchr finds the NUL too */
        number[count++] = decimal_value(&decimal);
    }
    if (count != SIXTEEN || number[12] != 0 || number[13] != 0 || number[14] != 0 ||
        number[15] != 1)
        return false;
    memcpy(out->m, number, sizeof out->m);
    return true;
}

/* From FLIRT's millimetres of a scene to its world: along the voxel axes from the middle of the
 * first voxel, x from the other end where the axes are right-handed. */
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

/* FLIRT's matrix as a map from the moving scene's world to the fixed one's. */
static enum err world_of_flirt(struct affine *out, const struct affine *flirt,
                               const struct placed_grid *fixed, const struct placed_grid *moving,
                               struct fault *fault)
{
    struct affine to_fixed, to_moving, from_moving;
    if (!from_flirt(&to_fixed, fixed) || !from_flirt(&to_moving, moving) ||
        !affine_invert(&from_moving, &to_moving))
        return fault_set(fault, ERR_INPUT, "the place of a scene in the world has no inverse");
    affine_compose(out, flirt, &from_moving);
    affine_compose(out, &to_fixed, out);
    return OK;
}

/* ---- ITK ---- */

/* By the helper, which is confined, of a format that it knows. */
static enum err read_by_helper(struct affine *out, struct buf *kind, const struct buf *bytes,
                               struct fault *fault)
{
    struct coprocess process;
    char line[COPROCESS_LINE], name[KIND_MOST];
    const char *at = line;
    static const int64_t most = KIND_MOST - 1;
    int64_t length = 0;
    enum err err = register_helper_start(&process, "a transform", HELD_MOST, 0, NULL, fault);
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
    coprocess_release(&process);
    return err;
}

/* Out of LPS+: x and y run the other way, on both sides. */
static void turn_to_ras(struct affine *a)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if ((i < 2) != (j < 2))
                a->m[i][j] = 0 - a->m[i][j];
}

/* ---- which ---- */

/* What the file says, from the fixed scene's world to the moving one's, RAS+. */
static enum err take_file(struct affine *out, struct buf *kind, const struct buf *bytes,
                          bool is_fsl, const struct placed_grid *fixed,
                          const struct placed_grid *moving, struct fault *fault)
{
    const char *text = buf_text(bytes);
    const bool is_text = strlen(text) == bytes->length;
    struct affine flirt;
    enum err err = OK;
    if (is_fsl) {
        if (!is_text || !scan_square(&flirt, text))
            return fault_set(fault, ERR_INPUT,
                             "it is no matrix of FLIRT: four rows of four numbers, of which the "
                             "last is 0 0 0 1");
        buf_add_text(kind, "a matrix of FSL's FLIRT");
        err = world_of_flirt(out, &flirt, fixed, moving, fault);
        if (!err && !affine_invert(out, out))
            err = fault_set(fault, ERR_INPUT, "its matrix has no inverse");
        return err;
    }
    if (is_text && scan_square(&flirt, text))
        return fault_set(fault, ERR_INPUT,
                         "it is sixteen numbers, and does not say whose; where FLIRT wrote them, "
                         "name it as \"fsl:FILE\"");
    err = read_by_helper(out, kind, bytes, fault);
    turn_to_ras(out);
    return err;
}

static enum err check(const struct affine *a, struct fault *fault)
{
    struct affine back;
    const double determinant = affine_determinant(a);
    if (!affine_is_finite(a) || !affine_invert(&back, a))
        return fault_set(fault, ERR_INPUT, "it has no inverse");
    if (determinant < 0)
        return fault_set(fault, ERR_INPUT,
                         "it makes a mirror image of the patient (its determinant is %.3g); left "
                         "and right are mixed up in one of the scenes, or it is another program's",
                         determinant);
    return OK;
}

enum err transform_read(struct affine *out, struct buf *words, const char *path,
                        enum transform_fixed fixed, const struct placed_grid *procedure,
                        const struct placed_grid *subject, struct fault *fault)
{
    const bool is_fsl = scan_text(&path, FSL), takes_subject = fixed == TRANSFORM_SUBJECT_FIXED;
    const struct placed_grid *to = takes_subject ? subject : procedure;
    const struct placed_grid *from = takes_subject ? procedure : subject;
    const bool has_subject = geometry_has_place(subject->geometry);
    struct buf bytes = {0}, kind = {0};
    struct affine found;
    if (!has_subject || !geometry_has_place(procedure->geometry))
        return fault_set(fault, ERR_INPUT,
                         "%s: the file of the %s scene does not say where it lies in the world, so "
                         "nothing says what a transform's numbers mean in it",
                         path, has_subject ? "procedure's" : "subject's");
    enum err err = file_read(&bytes, path, BYTES_MOST, fault);
    if (err)
        return err;
    err = take_file(&found, &kind, &bytes, is_fsl, to, from, fault);
    if (!err)
        err = check(&found, fault);
    if (!err && !takes_subject)
        affine_invert(&found, &found);
    if (!err && words)
        buf_printf(words, "%s, taken as found with the %s scene as the fixed one%s",
                   buf_text(&kind), takes_subject ? "subject's" : "procedure's",
                   is_fsl ? " (-ref)" : "");
    if (!err && (kind.failed || (words && words->failed)))
        err = fault_memory(fault, "a transform's name");
    if (!err)
        *out = found;
    else
        fault_prefix(fault, err, "%s", path);
    buf_release(&bytes);
    buf_release(&kind);
    return err;
}
