/* SPDX-License-Identifier: MIT */
/* Registration: results in scenes with a known map, refusals, reproducibility, and helpers that
 * crash, misbehave or hang. */
#include "tests/check.h"

#include <signal.h>

#include "base/clock.h"
#include "command/interpreter.h"
#include "image/volume.h"
#include "tests/deformed.h"
#include "tests/folder.h"
#include "tests/orphans.h"

static char folder[FOLDER_LENGTH];
static struct volume ch2;
static struct subject procedure; /* ch2, five times as coarse, to need seconds only */

enum { COARSE = 5 };

static const struct deformation known = {.degrees = {5, -4, 6},
                                         .scale = {1.06, 0.95, 1.03},
                                         .shift_mm = {6, -9, 7},
                                         .noise = 0.02,
                                         .bias = 0.15};

static enum err find(struct registration *out, const struct subject *subject, struct watch *watch,
                     struct fault *fault)
{
    const struct placed_scene one = subject_placed(subject), other = subject_placed(&procedure);
    *fault = (struct fault){.text = ""};
    return registration_find(out, &one, &other, watch, fault);
}

static enum err find_of(struct registration *out, const struct deformation *d,
                        struct subject *subject, struct fault *fault)
{
    CHECK_INT(subject_make(subject, &ch2, d, COARSE), OK);
    const enum err err = find(out, subject, NULL, fault);
    scene_free(subject->scene);
    return err;
}

/* ---- what is found ---- */

STORY(a_known_map_is_found_within_a_millimetre_and_reproduced_exactly)
{
    struct registration first, second;
    struct subject subject;
    struct fault fault;
    CHECK_INT(find_of(&first, &known, &subject, &fault), OK);
    CHECK_TEXT(fault.text, "");
    CHECK(subject_error(&subject, &first.affine) < 1);
    CHECK(first.metric > 1.5 * first.identity_metric && first.metric > first.mirrored_metric);
    CHECK(first.tells_sides && first.overlap > 0.8 && first.agreement_mm < 2);
    CHECK_INT(find_of(&second, &known, &subject, &fault), OK);
    CHECK(memcmp(&first.affine, &second.affine, sizeof first.affine) == 0);
    CHECK(memcmp(&first.metric, &second.metric, sizeof first.metric) == 0);
    printf("# %.2f mm off\n", subject_error(&subject, &first.affine));
}

/* The same patient with reversed voxel order, a matching matrix, and cells instead of plain voxels.
 */
STORY(the_storage_order_of_voxels_does_not_matter)
{
    struct registration found;
    struct subject subject;
    struct fault fault;
    const struct deformation straight = {.mirrored = true};
    CHECK_INT(subject_make(&subject, &ch2, &straight, COARSE), OK);
    struct geometry *geometry = &subject.geometry;
    const uint32_t last = subject.scene->grid.size[0] - 1;
    double to_mm[3][4];
    memcpy(to_mm, geometry->to_mm, sizeof to_mm);
    for (int w = 0; w < 3; w++) {
        to_mm[w][3] += last * to_mm[w][0];
        to_mm[w][0] = -to_mm[w][0];
    }
    CHECK(geometry_place(geometry, (const double(*)[4])to_mm, ORIENTATION_FILE));
    struct scene *cells = NULL;
    CHECK_INT(scene_new(&cells, subject.scene->grid.size, subject.scene->plain, NULL, NULL), OK);
    scene_free(subject.scene);
    subject.scene = cells;
    CHECK_INT(find(&found, &subject, NULL, &fault), OK);
    CHECK(subject_error(&subject, &found.affine) < 0.2);
    scene_free(subject.scene);
}

/* ---- what is refused ---- */

static void check_refused(const struct deformation *d, const char *words)
{
    struct registration found;
    struct subject subject;
    struct fault fault;
    CHECK_INT(find_of(&found, d, &subject, &fault), ERR_CHECK);
    CHECK_HAS(fault.text, words);
    CHECK_HAS(fault.text, "landmarks in both scenes");
}

STORY(mirror_images_slabs_and_scenes_without_contrast_or_orientation_are_refused)
{
    struct deformation mirrored = known, slab = known;
    mirrored.mirrored = true;
    slab.first = 16;
    slab.planes = 4;
    check_refused(&mirrored, "left and right may be swapped");
    check_refused(&slab, "of one scene's content is inside the other");
    struct registration found;
    struct subject subject;
    struct fault fault;
    const struct deformation nothing = {.content = OF_NOTHING};
    CHECK_INT(find_of(&found, &nothing, &subject, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the subject's scene has no contrast");
    CHECK_INT(subject_make(&subject, &ch2, &nothing, COARSE), OK);
    geometry_place_spaced(&subject.geometry);
    CHECK_INT(find(&found, &subject, NULL, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the subject's file does not say how its axes run");
    scene_free(subject.scene);
}

/* ---- helpers that misbehave ---- */

static const char *fault_of(const char *script)
{
    static struct fault fault;
    struct registration found;
    register_helper_program = script ? make_script(folder, "odd", script) : "/nowhere/odd";
    CHECK_INT(find(&found, &procedure, NULL, &fault), ERR_IO);
    register_helper_program = built_program("iftty-register");
    return fault.text;
}

/* Receives the request, and answers. */
#define HEARD "exec 3<&0; cat <&3 >/dev/null & "

STORY(a_missing_or_faulty_helper_is_an_error_of_one_line)
{
    CHECK_HAS(fault_of(NULL), "; the package iftty-volume has it");
    CHECK_HAS(fault_of("exit 7"), "ended with status 7");
    CHECK_HAS(fault_of("kill -SEGV $$"), "died (Segmentation fault)");
    CHECK_HAS(fault_of(HEARD "echo what; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo progress 3 9; echo progress 2 9; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo progress 10 9; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo error 9999; sleep 9"), "invalid answer");
    CHECK_HAS(fault_of(HEARD "echo found; head -c 64 /dev/zero; kill $!"), "ended with status 0");
    CHECK_HAS(fault_of(HEARD "echo found; i=0; while [ $((i += 1)) -le 19 ]; do "
                             "printf '\\377\\377\\377\\377\\377\\377\\377\\377'; done; sleep 9"),
              "invalid answer");
}

/* Check a well-formed answer. */
static enum err judged(const double number[19], struct fault *fault)
{
    struct registration found;
    const char *answer = file_in(folder, "answer");
    char script[2 * FILE_LENGTH];
    FILE *file = fopen(answer, "we");
    CHECK(file && fputs("found\n", file) >= 0 && fwrite(number, sizeof *number, 19, file) == 19);
    if (file)
        fclose(file);
    snprintf(script, sizeof script, HEARD "cat '%s'; sleep 9", answer);
    register_helper_program = make_script(folder, "odd", script);
    const enum err err = find(&found, &procedure, NULL, fault);
    register_helper_program = built_program("iftty-register");
    return err;
}

STORY(each_figure_of_an_answer_is_checked)
{
    /* The map by rows; metrics of the map, the identity and the mirror image; overlap of the one
     * and the other; agreement and length. */
    static const double fine[19] = {1, 0, 0,   5,   0,   1, 0, 0, 0,  0,
                                    1, 0, 1.0, 0.5, 0.6, 1, 1, 1, 200};
    static const struct {
        int at;
        double number;
        enum err err;
        const char *words;
    } cases[] = {
        {3, 5, OK, ""},
        {0, -1, ERR_CHECK, "no mirror image"},
        {0, 1.8, ERR_CHECK, "it stretches by 1.80, 1.00 and 1.00"},
        {5, 0.5, ERR_CHECK, "it stretches by 1.00, 1.00 and 0.50"},
        {5, 0, ERR_CHECK, "it stretches by 1.00, 1.00 and 0.00"},
        {12, 0.1, ERR_CHECK, "hardly related (0.100 nats"},
        {13, 1.06, ERR_CHECK, "fit better without it (1.060 nats to 1.000)"},
        {13, 1.04, OK, ""},
        {14, 1.02, OK, ""},
        {14, 1.04, ERR_CHECK, "left and right may be swapped"},
        {15, 0.45, ERR_CHECK, "only 45 % of one scene's content is inside the other"},
        {16, 0.12, ERR_CHECK, "only 12 % of one"},
        {17, 6.5, ERR_CHECK, "the maps there and back differ by 6.5 mm; expected 6.0 mm or less"},
        {17, -1, ERR_IO, "invalid answer"},
        {3, NAN, ERR_IO, "invalid answer"},
        {12, INFINITY, ERR_IO, "invalid answer"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct fault fault;
        double number[19];
        memcpy(number, fine, sizeof number);
        number[cases[i].at] = cases[i].number;
        CHECK_INT(judged(number, &fault), cases[i].err);
        CHECK_HAS(fault.text, cases[i].words);
    }
}

STORY(a_helper_that_hangs_is_killed)
{
    register_helper_patience_ms = 1000;
    const uint64_t begin = clock_ns();
    CHECK_HAS(fault_of(HEARD "sleep 60"), "did not answer for 1 s");
    CHECK(clock_ns() - begin < UINT64_C(30000000000));
    register_helper_patience_ms = 60000;
}

/* ---- stopping ---- */

static unsigned polls;

static bool stop_after_some(void *context, const char *what, uint64_t done, uint64_t total)
{
    const unsigned *most = context;
    CHECK((!what || strcmp(what, "registration") == 0) && (done <= total || total == 0));
    return ++polls >= *most;
}

STORY(a_cancelled_registration_ends_its_helper)
{
    struct registration found;
    struct fault fault;
    unsigned most = 40;
    struct watch watch = {.context = &most, .poll = stop_after_some};
    polls = 0;
    adopt_orphans();
    CHECK_INT(find(&found, &procedure, &watch, &fault), ERR_CANCELLED);
    CHECK(polls < 45 && await_orphans());
}

STORY(a_helper_ends_with_its_client)
{
    static const unsigned after_ms[] = {0, 30, 700};
    for (size_t i = 0; i < sizeof after_ms / sizeof *after_ms; i++) {
        fflush(stdout);
        const pid_t client = fork();
        if (client == 0) {
            struct registration found;
            struct fault fault;
            find(&found, &procedure, NULL, &fault);
            _exit(0);
        }
        usleep(1000 * after_ms[i]);
        CHECK(kill(client, SIGKILL) == 0 && await_orphans());
    }
}

int main(void)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    OWNED(buf_release) struct buf scene = {0};
    struct fault fault = {0};
    register_helper_program = built_program("iftty-register");
    if (!make_folder(folder, "register") || interpreter_init(&interp, NULL) != OK ||
        interpreter_find_scene(&interp, 0, "ch2.nii.gz", false, &scene, &fault) != OK ||
        volume_read(&ch2, buf_text(&scene), NULL, NULL, &fault) != OK ||
        subject_make(&procedure, &ch2, &(struct deformation){.noise = 0}, COARSE) != OK) {
        printf("# %s\nnot ok 1 - there is a scene\n1..1\n", fault.text);
        return 1;
    }
    const int failed = check_run();
    scene_free(procedure.scene);
    volume_release(&ch2);
    return failed | remove_folder(folder);
}
