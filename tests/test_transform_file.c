/* SPDX-License-Identifier: MIT */
/* Transform files: files written by ITK (tests/transforms/, with places mapped by ITK itself), the
 * meaning of FLIRT's matrices, the direction of maps, and refusals. */
#include <math.h>

#include "base/file.h"
#include "apply/registration.h"

static void make_scenes(void);
#define BEFORE_STORIES make_scenes()
#include "tests/folder_main.h"

/* Two scenes: axes from right to left, as often in NIfTI, and a tilted scene with other steps. */
static struct geometry procedure_geometry, subject_geometry;
static const struct placed_grid procedure = {{181, 217, 181}, &procedure_geometry};
static const struct placed_grid subject = {{160, 200, 100}, &subject_geometry};

static void make_scenes(void)
{
    static const double one[3][4] = {{-1, 0, 0, 90}, {0, 1, 0, -126}, {0, 0, 1, -72}};
    static const double other[3][4] = {
        {1.1, 0.1, 0, -80}, {-0.1, 1.2, 0.2, -110}, {0, -0.2, 2, -90}};
    CHECK(geometry_place(&procedure_geometry, one, ORIENTATION_FILE));
    CHECK(geometry_place(&subject_geometry, other, ORIENTATION_FILE));
    register_helper_program = built_program("iftty-register");
}

static const char *file_with(const char *name, const void *bytes, size_t length)
{
    const char *path = file_in(folder, name);
    CHECK_INT(file_write(path, bytes, length, FILE_REPLACE, NULL), OK);
    return path;
}

static struct buf words;

static enum err read_file(struct affine *out, const char *path, struct fault *fault)
{
    *fault = (struct fault){.text = ""};
    buf_clear(&words);
    return transform_read(out, &words, path, &procedure, &subject, fault);
}

static void check_refused(const char *text, const char *expected)
{
    struct affine out = {{{42}}};
    struct fault fault;
    CHECK_INT(read_file(&out, file_with("a.txt", text, strlen(text)), &fault), ERR_INPUT);
    CHECK_HAS(fault.text, expected);
    CHECK_HAS(fault.text, "a.txt");
    CHECK(out.m[0][0] == 42);
}

#define HEAD "#Insight Transform File V1.0\n#Transform 0\n"

/* ---- ITK ---- */

/* Each line of the list has a file and three places mapped by ITK, in LPS. */
STORY(files_of_itk_map_places_as_itk_does)
{
    OWNED(stream_release) FILE *list = fopen("tests/transforms/places.txt", "re");
    char name[64];
    double p[3], q[3];
    unsigned lines = 0;
    CHECK(list != NULL);
    while (list && fscanf(list, "%63s %lf %lf %lf %lf %lf %lf", name, &p[0], &p[1], &p[2], &q[0],
                          &q[1], &q[2]) == 7) {
        char path[128];
        struct affine there;
        struct fault fault;
        const double from[3] = {-p[0], -p[1], p[2]}, to[3] = {-q[0], -q[1], q[2]};
        double found[3];
        snprintf(path, sizeof path, "tests/transforms/%s", name);
        CHECK_WITH(read_file(&there, path, &fault) == OK, "%s", fault.text);
        CHECK_HAS(buf_text(&words), "taken as found with the subject's scene as the fixed one");
        affine_apply(&there, from, found);
        for (int i = 0; i < 3; i++)
            CHECK(fabs(found[i] - to[i]) < (strstr(name, "float") ? 1e-4 : 1e-10));
        lines++;
    }
    CHECK_INT(lines, 3 * 11);
}

#define TRANSFORM(kind, numbers, fixed)                                                            \
    HEAD "Transform: " kind "\nParameters: " numbers "\nFixedParameters:" fixed "\n"

STORY(files_of_itk_that_are_not_affine_or_not_whole_are_refused)
{
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {TRANSFORM("BSplineTransform_double_3_3", "1 2 3", " 0"),
         "it holds a \"BSplineTransform_double_3_3\"; supported are"},
        {TRANSFORM("AffineTransform_double_2_2", "1 0 0 1 0 0", " 0 0"), "three dimensions"},
        {TRANSFORM("AffineTransform_double_3_3", "1 0 0 1", " 0 0 0"),
         "has 4 parameters and 3 fixed ones; expected 12 and 3"},
        {TRANSFORM("Euler3DTransform_double_3_3", "0 0 0 nan 0 0", " 0 0 0"), "line 4 is not"},
        {TRANSFORM("VersorRigid3DTransform_double_3_3", "0.9 0.9 0 0 0 0", " 0 0 0"), "no turn"},
        {TRANSFORM("AffineTransform_double_3_3", "-1 0 0 0 1 0 0 0 1 0 0 0", " 0 0 0"),
         "mirror image of the patient"},
        {TRANSFORM("AffineTransform_double_3_3", "1 0 0 0 1 0 0 0 0 0 0 0", " 0 0 0"),
         "it has no inverse"},
        {HEAD, "it holds no transform"},
        {TRANSFORM("TranslationTransform_double_3_3", "1 2 3",
                   "") "#Transform 1\nTransform: TranslationTransform_double_3_3\n"
                       "Parameters: 1 2 3\nFixedParameters:\n",
         "more than one transform"},
        {HEAD "what\n", "line 3 is not"},
        {"", "no affine transform that is known here"},
        {"solid\n", "no affine transform that is known here"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused(cases[i].text, cases[i].expected);
}

/* Every truncation and every changed byte of a MATLAB file is read or refused, without a crash. */
STORY(damaged_files_of_matlab_are_refused)
{
    OWNED(buf_release) struct buf whole = {0};
    struct fault fault;
    struct affine out;
    unsigned refused = 0;
    CHECK_INT(file_read(&whole, "tests/transforms/affine.mat", 4096, &fault), OK);
    for (size_t n = 0; n < whole.length; n++)
        CHECK_INT(read_file(&out, file_with("b.mat", buf_text(&whole), n), &fault), ERR_INPUT);
    for (size_t n = 0; n < whole.length; n++) {
        char bytes[4096];
        memcpy(bytes, buf_text(&whole), whole.length);
        bytes[n] = (char)(bytes[n] ^ 0xff);
        refused += read_file(&out, file_with("b.mat", bytes, whole.length), &fault) != OK;
    }
    CHECK(refused > 60 && refused < whole.length);
}

/* ---- FSL ---- */

static void world_place(double out[3], const struct placed_grid *grid, const double voxel[3])
{
    for (int w = 0; w < 3; w++) {
        const double *m = grid->geometry->to_mm[w];
        out[w] = m[0] * voxel[0] + m[1] * voxel[1] + m[2] * voxel[2] + m[3];
    }
}

STORY(a_matrix_of_flirt_maps_in_to_ref)
{
    static const char text[] = "1.02  0.03  -0.01  4.5  \n-0.02  0.98  0.05  -7.25  \n"
                               "0.01  -0.04  1.01  3e+00  \n0  0  0  1  \n";
    static const struct affine matrix = {
        {{1.02, 0.03, -0.01, 4.5}, {-0.02, 0.98, 0.05, -7.25}, {0.01, -0.04, 1.01, 3}}};
    char name[FILE_LENGTH + 8];
    struct fault fault;
    snprintf(name, sizeof name, "fsl:%s", file_with("f.mat", text, sizeof text - 1));
    CHECK(geometry_is_mirrored(&procedure_geometry) && !geometry_is_mirrored(&subject_geometry));
    for (int way = 0; way < 2; way++) {
        const struct placed_grid *in = way ? &subject : &procedure,
                                 *ref = way ? &procedure : &subject;
        struct affine to_in;
        buf_clear(&words);
        CHECK_INT(transform_read(&to_in, &words, name, in, ref, &fault), OK);
        CHECK_HAS(buf_text(&words), "a matrix of FSL's FLIRT");
        CHECK_HAS(buf_text(&words), "(-ref)");
        for (int i = 0; i < 20; i++) {
            const double voxel[3] = {7 * i, 5 * i + 3, 100 - 4 * i};
            double mm[3], moved[3], from[3], world[3], back[3];
            /* FSL's definition: a voxel of the moving scene, in its millimetres, maps to a voxel
             * of the reference; x from the other end if the axes are right-handed. */
            const bool is_right = !geometry_is_mirrored(in->geometry);
            for (int a = 0; a < 3; a++)
                mm[a] = voxel[a] * geometry_step_mm(in->geometry, a);
            if (is_right)
                mm[0] = (in->size[0] - 1 - voxel[0]) * geometry_step_mm(in->geometry, 0);
            affine_apply(&matrix, mm, moved);
            /* the voxel of ref, and its place */
            double there[3];
            for (int a = 0; a < 3; a++)
                there[a] = moved[a] / geometry_step_mm(ref->geometry, a);
            if (!geometry_is_mirrored(ref->geometry))
                there[0] = ref->size[0] - 1 - there[0];
            world_place(from, ref, there);
            world_place(world, in, voxel);
            affine_apply(&to_in, from, back);
            for (int w = 0; w < 3; w++)
                CHECK(fabs(back[w] - world[w]) < 1e-9);
        }
    }
}

STORY(sixteen_numbers_are_refused_without_their_program)
{
    static const char text[] = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    char name[FILE_LENGTH + 8];
    struct affine out;
    struct fault fault;
    check_refused(text, "its sixteen numbers may mean anything; if FLIRT wrote them, name it as "
                        "\"fsl:FILE\"");
    snprintf(name, sizeof name, "fsl:%s", file_with("a.txt", text, sizeof text - 1));
    CHECK_INT(read_file(&out, name, &fault), OK);
    static const char *const wrong[] = {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2",
                                        "1 0 0 0 0 1 0 0 0 0 1 0",
                                        "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1", "a b c", HEAD};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        file_with("a.txt", wrong[i], strlen(wrong[i]));
        CHECK_INT(read_file(&out, name, &fault), ERR_INPUT);
        CHECK_HAS(fault.text, "it is no matrix of FLIRT");
    }
}

STORY(an_unplaced_scene_and_a_missing_file_are_refused)
{
    struct geometry unplaced = subject_geometry;
    const struct placed_grid nowhere = {{160, 200, 100}, &unplaced};
    struct affine out;
    struct fault fault;
    unplaced.orientation = ORIENTATION_UNKNOWN;
    CHECK_INT(
        transform_read(&out, &words, "tests/transforms/affine.tfm", &procedure, &nowhere, &fault),
        ERR_INPUT);
    CHECK_HAS(fault.text, "the file of the subject's scene does not say where it is");
    CHECK(read_file(&out, "fsl:nowhere.mat", &fault) != OK);
    CHECK_HAS(fault.text, "nowhere.mat");
}

/* ---- helpers that misbehave ---- */

static const char *fault_of(const char *script)
{
    static struct fault fault;
    struct affine out = {{{42}}};
    const char *const usual = register_helper_program;
    register_helper_program = script ? make_script(folder, "odd", script) : "/nowhere/odd";
    CHECK(read_file(&out, "tests/transforms/affine.tfm", &fault) && out.m[0][0] == 42);
    CHECK_HAS(fault.text, "tests/transforms/affine.tfm: ");
    register_helper_program = usual;
    return fault.text;
}

#define HEARD "exec 3<&0; cat <&3 >/dev/null & "

STORY(a_missing_or_faulty_helper_is_an_error_of_one_line)
{
    CHECK_HAS(fault_of(NULL), "; the package iftty-volume has it");
    CHECK_HAS(fault_of("kill -SEGV $$"), "died (Segmentation fault)");
    CHECK_HAS(fault_of(HEARD "echo what; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo transform 9999; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo transform 2; printf '\\033['; head -c 96 /dev/zero; sleep 9"),
              "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo transform 1; printf a; head -c 96 /dev/zero; sleep 9"),
              "it has no inverse");
    CHECK_HAS(fault_of(HEARD "echo transform 1; printf a; yes | tr -d '\\n' | tr y '\\377' | "
                             "head -c 96; sleep 9"),
              "it has no inverse");
}
