/*
 * Registration and STAPLE: what is found in scenes whose map is known, what is refused, the same
 * bytes again, and helpers that die, lie, or never end.
 */
#include "tests/check.h"

#include <signal.h>
#include <unistd.h>

#include "base/clock.h"
#include "command/files.h"
#include "command/interpreter.h"
#include "image/volume.h"
#include "register/register_helper.h"
#include "register/staple.h"
#include "tests/deformed.h"
#include "tests/folder.h"
#include "tests/orphans.h"

static char folder[FOLDER_LENGTH];
static struct volume ch2;
static struct subject procedure; /* ch2, four times as coarse: what it takes is seconds */
static char helper[FILE_LENGTH];

enum { COARSE = 4 };

static const struct deformation known = {.degrees = {5, -4, 6},
                                         .scale = {1.06, 0.95, 1.03},
                                         .shift_mm = {6, -9, 7},
                                         .elastic_mm = 3,
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

STORY(a_known_map_is_found_within_a_millimetre_and_again_in_the_same_bytes)
{
    struct registration first, second;
    struct subject subject;
    struct fault fault;
    CHECK_INT(find_of(&first, &known, &subject, &fault), OK);
    CHECK_TEXT(fault.text, "");
    CHECK(subject_error(&subject, &first.affine) < 2);
    CHECK(first.metric > 1.5 * first.identity_metric && first.metric > first.mirrored_metric);
    CHECK(first.overlap > 0.8 && first.agreement_mm < 2);
    CHECK(strlen(first.subject) == SHA256_HEX - 1 && strcmp(first.subject, first.procedure) != 0);
    CHECK_INT(find_of(&second, &known, &subject, &fault), OK);
    CHECK(memcmp(&first.affine, &second.affine, sizeof first.affine) == 0);
    CHECK(memcmp(&first.metric, &second.metric, sizeof first.metric) == 0);
    printf("# %.2f mm off, %.2f s of the processor\n", subject_error(&subject, &first.affine),
           first.seconds);
}

/* Voxels in another order, and a matrix that says so: the same patient. */
STORY(how_voxels_are_stored_does_not_matter)
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
    CHECK_HAS(fault.text, "marks in both scenes");
}

STORY(a_mirror_image_a_slab_and_noise_are_refused_in_words)
{
    struct deformation mirrored = known, slab = known;
    const struct deformation noise = {.content = OF_NOISE};
    mirrored.mirrored = true;
    slab.first = 20;
    slab.planes = 5;
    check_refused(&mirrored, "left and right may be mixed up");
    check_refused(&slab, "of what one scene shows lies in the other");
    check_refused(&noise, "say next to nothing about each other");
}

STORY(scenes_that_say_too_little_are_refused_before_anything_is_done)
{
    struct registration found;
    struct subject subject;
    struct fault fault;
    const struct deformation nothing = {.content = OF_NOTHING};
    CHECK_INT(find_of(&found, &nothing, &subject, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the subject's scene has no contrast");
    CHECK_INT(subject_make(&subject, &ch2, &nothing, COARSE), OK);
    geometry_place_spaced(&subject.geometry);
    CHECK_INT(find(&found, &subject, NULL, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the subject's file does not say how its axes lie");
    scene_free(subject.scene);
}

/* ---- helpers that misbehave ---- */

static const char *fault_of(const char *script)
{
    static struct fault fault;
    struct registration found;
    register_helper_program = script ? make_script(folder, "odd", script) : "/nowhere/odd";
    CHECK_INT(find(&found, &procedure, NULL, &fault), ERR_IO);
    register_helper_program = helper;
    return fault.text;
}

/* Takes the request, and answers. */
#define HEARD "exec 3<&0; cat <&3 >/dev/null & "
#define ONES  "printf '\\0\\0\\0\\0\\0\\0\\360\\077'"

STORY(a_helper_that_is_missing_dies_or_lies_costs_one_line)
{
    CHECK_HAS(fault_of(NULL), "`make build/iftty-register` builds it");
    CHECK_HAS(fault_of("exit 7"), "ended with status 7");
    CHECK_HAS(fault_of("kill -SEGV $$"), "died (Segmentation fault)");
    CHECK_HAS(fault_of(HEARD "echo what; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo progress 3 9; echo progress 2 9; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo progress 10 9; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo error 9999; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo found; head -c 64 /dev/zero"), "ended with status 0");
    CHECK_HAS(fault_of(HEARD "echo found; i=0; while [ $((i += 1)) -le 20 ]; do "
                             "printf '\\377\\377\\377\\377\\377\\377\\377\\377'; done; sleep 9"),
              "makes no sense");
}

/* A map that is no map, in an answer that is well formed: of twenty ones. */
STORY(an_answer_that_makes_sense_is_judged_all_the_same)
{
    struct registration found;
    struct fault fault;
    register_helper_program =
        make_script(folder, "odd",
                    HEARD "echo found; i=0; while [ $((i += 1)) -le 20 ]; do " ONES "; done; "
                          "sleep 9");
    CHECK_INT(find(&found, &procedure, NULL, &fault), ERR_CHECK);
    CHECK_HAS(fault.text, "it stretches by 3.00, 0.00 and 0.00");
    register_helper_program = helper;
}

STORY(a_helper_that_never_ends_is_ended)
{
    register_helper_patience_ms = 1000;
    struct registration found;
    struct fault fault;
    register_helper_program = make_script(folder, "odd", HEARD "sleep 60");
    const uint64_t begin = clock_ns();
    CHECK_INT(find(&found, &procedure, NULL, &fault), ERR_IO);
    CHECK_HAS(fault.text, "did not answer for ");
    CHECK(clock_ns() - begin < UINT64_C(40000000000));
    register_helper_program = helper;
    register_helper_patience_ms = 60000;
}

/* ---- stopping ---- */

static unsigned polls;

static bool stop_after_some(void *context, const char *what, uint64_t done, uint64_t total)
{
    const unsigned *most = context;
    CHECK(!what || strcmp(what, "registration") == 0);
    CHECK(done <= total || total == 0);
    return ++polls >= *most;
}

STORY(a_stop_is_heard_and_the_helper_is_gone)
{
    struct registration found;
    struct fault fault;
    unsigned most = 40;
    struct watch watch = {.context = &most, .poll = stop_after_some};
    polls = 0;
    adopt_orphans();
    CHECK_INT(find(&found, &procedure, &watch, &fault), ERR_CANCELLED);
    CHECK(polls < 45);
    CHECK(await_orphans());
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
        CHECK(kill(client, SIGKILL) == 0);
        CHECK(await_orphans());
    }
}

/* ---- STAPLE ---- */

enum { SIDE = 24, VOXELS = SIDE * SIDE * SIDE, RATERS = 3 };
static const uint32_t cube[3] = {SIDE, SIDE, SIDE};

/* Two balls, of the labels 3 and 200; raters of whom each is wrong in another part of the voxels. */
static void rate(uint8_t truth[VOXELS], uint8_t map[RATERS][VOXELS], const double wrong[RATERS])
{
    static const uint8_t others[4] = {0, 3, 200, 0};
    for (int i = 0; i < VOXELS; i++) {
        const int x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const int a = (x - 8) * (x - 8) + (y - 8) * (y - 8) + (z - 12) * (z - 12);
        const int b = (x - 17) * (x - 17) + (y - 17) * (y - 17) + (z - 12) * (z - 12);
        truth[i] = a < 36 ? 3 : b < 25 ? 200 : 0;
        for (unsigned r = 0; r < RATERS; r++) {
            const uint64_t h = hash_mix_at((uint64_t)i, r);
            const bool errs = (double)(h >> 11) / 0x1p53 < wrong[r];
            map[r][i] = errs ? others[h & 3] : truth[i];
        }
    }
}

STORY(raters_are_known_by_their_errors_and_the_consensus_is_better_than_any)
{
    static uint8_t truth[VOXELS], map[RATERS][VOXELS], consensus[VOXELS], again[VOXELS];
    const uint8_t *const maps[RATERS] = {map[0], map[1], map[2]};
    const double wrong[RATERS] = {0.02, 0.05, 0.4};
    struct staple_rater rater[RATERS], twice[RATERS];
    unsigned off = 0, off_first = 0;
    struct fault fault = {0};
    rate(truth, map, wrong);
    CHECK_INT(staple_find(consensus, rater, RATERS, maps, cube, NULL, &fault), OK);
    CHECK_TEXT(fault.text, "");
    for (int i = 0; i < VOXELS; i++) {
        off += consensus[i] != truth[i];
        off_first += map[0][i] != truth[i];
    }
    CHECK(off < off_first / 2);
    /* Beside those that are counted on the truth. */
    for (unsigned r = 0; r < RATERS; r++)
        for (unsigned label = 0; label < STAPLE_LABELS; label++) {
            double is = 0, said = 0, is_not = 0, not_said = 0;
            for (int i = 0; i < VOXELS; i++) {
                is += truth[i] == label;
                said += truth[i] == label && map[r][i] == label;
                is_not += truth[i] != label;
                not_said += truth[i] != label && map[r][i] != label;
            }
            if (label != 0 && label != 3 && label != 200) {
                CHECK(isnan(rater[r].sensitivity[label]) && isnan(rater[r].specificity[label]));
                continue;
            }
            CHECK(fabs(rater[r].sensitivity[label] - said / is) < 0.03);
            CHECK(fabs(rater[r].specificity[label] - not_said / is_not) < 0.03);
        }
    CHECK_INT(staple_find(again, twice, RATERS, maps, cube, NULL, &fault), OK);
    CHECK(memcmp(consensus, again, VOXELS) == 0 && memcmp(rater, twice, sizeof rater) == 0);
}

STORY(raters_who_agree_are_right_and_too_few_are_refused)
{
    static uint8_t truth[VOXELS], map[RATERS][VOXELS], consensus[VOXELS];
    const uint8_t *const maps[2] = {map[0], map[0]};
    struct staple_rater rater[2];
    struct fault fault = {0};
    rate(truth, map, (const double[RATERS]){0});
    CHECK_INT(staple_find(consensus, rater, 2, maps, cube, NULL, &fault), OK);
    CHECK(memcmp(consensus, truth, VOXELS) == 0);
    CHECK(rater[0].sensitivity[3] > 0.999 && rater[1].specificity[200] > 0.999);
    CHECK_INT(staple_find(consensus, rater, 1, maps, cube, NULL, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "1 map; STAPLE takes 2 to 64");
    register_helper_program = make_script(
        folder, "odd", HEARD "echo consensus; yes | head -c 20000; sleep 9"); /* labels of 'y' */
    CHECK_INT(staple_find(consensus, rater, 2, maps, cube, NULL, &fault), ERR_IO);
    CHECK_HAS(fault.text, "makes no sense");
    register_helper_program = helper;
}

int main(void)
{
    static const struct story stories[] = {
        TELL(a_known_map_is_found_within_a_millimetre_and_again_in_the_same_bytes),
        TELL(how_voxels_are_stored_does_not_matter),
        TELL(a_mirror_image_a_slab_and_noise_are_refused_in_words),
        TELL(scenes_that_say_too_little_are_refused_before_anything_is_done),
        TELL(a_helper_that_is_missing_dies_or_lies_costs_one_line),
        TELL(an_answer_that_makes_sense_is_judged_all_the_same),
        TELL(a_helper_that_never_ends_is_ended),
        TELL(a_stop_is_heard_and_the_helper_is_gone),
        TELL(a_helper_ends_with_its_client),
        TELL(raters_are_known_by_their_errors_and_the_consensus_is_better_than_any),
        TELL(raters_who_agree_are_right_and_too_few_are_refused),
    };
    const char *build = getenv("IFTTY_BUILD") ? getenv("IFTTY_BUILD") : "build";
    struct interpreter interp;
    struct buf scene = {0};
    struct fault fault = {0};
    snprintf(helper, sizeof helper, "%s/iftty-register", build);
    register_helper_program = helper;
    if (!make_folder(folder, "register") || interpreter_init(&interp, NULL) != OK ||
        interpreter_find_scene(&interp, "ch2.nii.gz", false, &scene, &fault) != OK ||
        volume_read(&ch2, buf_text(&scene), NULL, NULL, &fault) != OK ||
        subject_make(&procedure, &ch2, &(struct deformation){.noise = 0}, COARSE) != OK) {
        printf("# %s\nnot ok 1 - there is a scene\n1..1\n", fault.text);
        return 1;
    }
    const int failed = check_run(stories, sizeof stories / sizeof stories[0]);
    scene_free(procedure.scene);
    volume_release(&ch2);
    buf_release(&scene);
    interpreter_release(&interp);
    return failed | remove_folder(folder);
}
