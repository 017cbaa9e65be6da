/* SPDX-License-Identifier: MIT */
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
static struct subject procedure; /* ch2, five times as coarse: what it takes is seconds */
static char helper[FILE_LENGTH];

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

STORY(a_known_map_is_found_within_a_millimetre_and_again_in_the_same_bytes)
{
    struct registration first, second;
    struct subject subject;
    struct fault fault;
    CHECK_INT(find_of(&first, &known, &subject, &fault), OK);
    CHECK_TEXT(fault.text, "");
    CHECK(subject_error(&subject, &first.affine) < 1);
    CHECK(first.metric > 1.5 * first.identity_metric && first.metric > first.mirrored_metric);
    CHECK(first.tells_sides && first.overlap > 0.8 && first.agreement_mm < 2);
    CHECK(strlen(first.subject) == SHA256_HEX - 1 && strcmp(first.subject, first.procedure) != 0);
    CHECK_INT(find_of(&second, &known, &subject, &fault), OK);
    CHECK(memcmp(&first.affine, &second.affine, sizeof first.affine) == 0);
    CHECK(memcmp(&first.metric, &second.metric, sizeof first.metric) == 0);
    printf("# %.2f mm off, %.2f s of the processor\n", subject_error(&subject, &first.affine),
           first.seconds);
}

/* Voxels in another order, and a matrix that says so, in a session's cells: the same patient. */
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
    struct scene *cells = NULL;
    CHECK_INT(scene_new_filled(&cells, subject.scene->grid.size, subject.scene->plain, NULL, NULL),
              OK);
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
    CHECK_HAS(fault.text, "marks in both scenes");
}

STORY(a_mirror_image_and_a_slab_are_refused_in_words)
{
    struct deformation mirrored = known, slab = known;
    mirrored.mirrored = true;
    slab.first = 16;
    slab.planes = 4;
    check_refused(&mirrored, "left and right may be mixed up");
    check_refused(&slab, "of what one scene shows lies in the other");
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

STORY(a_helper_that_is_missing_dies_or_lies_costs_one_line)
{
    CHECK_HAS(fault_of(NULL), "; the package iftty-volume has it");
    CHECK_HAS(fault_of("exit 7"), "ended with status 7");
    CHECK_HAS(fault_of("kill -SEGV $$"), "died (Segmentation fault)");
    CHECK_HAS(fault_of(HEARD "echo what; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo progress 3 9; echo progress 2 9; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo progress 10 9; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo error 9999; sleep 9"), "makes no sense");
    CHECK_HAS(fault_of(HEARD "echo found; head -c 64 /dev/zero; kill $!"), "ended with status 0");
    CHECK_HAS(fault_of(HEARD "echo found; i=0; while [ $((i += 1)) -le 20 ]; do "
                             "printf '\\377\\377\\377\\377\\377\\377\\377\\377'; done; sleep 9"),
              "makes no sense");
}

/* What is said of an answer that is well formed. */
static enum err judged(const double number[20], struct fault *fault)
{
    struct registration found;
    const char *answer = file_in(folder, "answer");
    char script[2 * FILE_LENGTH];
    FILE *file = fopen(answer, "we");
    CHECK(file && fputs("found\n", file) >= 0 && fwrite(number, sizeof *number, 20, file) == 20);
    if (file)
        fclose(file);
    snprintf(script, sizeof script, HEARD "cat '%s'; sleep 9", answer);
    register_helper_program = make_script(folder, "odd", script);
    const enum err err = find(&found, &procedure, NULL, fault);
    register_helper_program = helper;
    return err;
}

STORY(each_figure_of_an_answer_is_judged)
{
    /* The map by rows; metrics of the map, the identity and the mirror image; overlap of the one
     * and the other; agreement and length; seconds. */
    static const double fine[20] = {1, 0, 0,   5,   0,   1, 0, 0, 0,   0,
                                    1, 0, 1.0, 0.5, 0.6, 1, 1, 1, 200, 5};
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
        {12, 0.1, ERR_CHECK, "next to nothing about each other (0.100 nats"},
        {13, 1.06, ERR_CHECK, "fit better as they lie in their worlds (1.060 nats to 1.000)"},
        {13, 1.04, OK, ""},
        {14, 1.02, OK, ""},
        {14, 1.04, ERR_CHECK, "left and right may be mixed up"},
        {15, 0.45, ERR_CHECK, "only 45 % of what one scene shows lies in the other"},
        {16, 0.12, ERR_CHECK, "only 12 % of what"},
        {17, 6.5, ERR_CHECK, "there and back leads 6.5 mm away; expected 6.0 mm or less"},
        {17, -1, ERR_IO, "makes no sense"},
        {3, NAN, ERR_IO, "makes no sense"},
        {12, INFINITY, ERR_IO, "makes no sense"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct fault fault;
        double number[20];
        memcpy(number, fine, sizeof number);
        number[cases[i].at] = cases[i].number;
        CHECK_INT(judged(number, &fault), cases[i].err);
        CHECK_HAS(fault.text, cases[i].words);
    }
}

STORY(a_helper_that_never_ends_is_ended)
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

/* Two balls, of the labels 3 and 200; each rater is wrong in another part of the voxels. */
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

/* The same from the papers, over voxels of doubles: [rater][said][is], and the labels' shares. */
enum { LABELS = 3 };
static const uint8_t said_by_place[LABELS] = {0, 3, 200};

static unsigned place_of(uint8_t label)
{
    return label == 0 ? 0 : label == 3 ? 1 : 2;
}

static void normalise(double rates[LABELS][LABELS], bool by_said)
{
    for (int i = 0; i < LABELS; i++) {
        double sum = 0;
        for (int j = 0; j < LABELS; j++)
            sum += by_said ? rates[i][j] : rates[j][i];
        for (int j = 0; j < LABELS; j++)
            *(by_said ? &rates[i][j] : &rates[j][i]) /= sum > 0 ? sum : 1;
    }
}

static void weigh(double weight[LABELS], double rates[RATERS][LABELS][LABELS],
                  const double share[LABELS], uint8_t map[RATERS][VOXELS], int voxel)
{
    double sum = 0;
    for (int is = 0; is < LABELS; is++) {
        weight[is] = share[is];
        for (int r = 0; r < RATERS; r++)
            weight[is] *= rates[r][place_of(map[r][voxel])][is];
        sum += weight[is];
    }
    for (int is = 0; is < LABELS; is++)
        weight[is] /= sum;
}

static void expect_rates(double rates[RATERS][LABELS][LABELS], uint8_t consensus[VOXELS],
                         uint8_t map[RATERS][VOXELS])
{
    double share[LABELS] = {0}, weight[LABELS];
    memset(rates, 0, RATERS * sizeof *rates);
    for (int i = 0; i < VOXELS; i++) {
        int votes[LABELS] = {0}, most = 0;
        for (int r = 0; r < RATERS; r++)
            votes[place_of(map[r][i])]++;
        for (int l = 0; l < LABELS; l++)
            most = votes[l] > votes[most] ? l : most;
        for (int r = 0; r < RATERS; r++) {
            share[place_of(map[r][i])] += 1.0 / (RATERS * VOXELS);
            rates[r][place_of(map[r][i])][most] += votes[most] > 1;
        }
    }
    for (int r = 0; r < RATERS; r++)
        normalise(rates[r], true);
    for (int iteration = 0; iteration < 100; iteration++) {
        static double next[RATERS][LABELS][LABELS];
        double most = 0;
        memset(next, 0, sizeof next);
        for (int i = 0; i < VOXELS; i++) {
            weigh(weight, rates, share, map, i);
            for (int r = 0; r < RATERS; r++)
                for (int is = 0; is < LABELS; is++)
                    next[r][place_of(map[r][i])][is] += weight[is];
        }
        for (int r = 0; r < RATERS; r++) {
            normalise(next[r], false);
            for (int k = 0; k < LABELS * LABELS; k++)
                most = fmax(most, fabs(next[r][k / 3][k % 3] - rates[r][k / 3][k % 3]));
        }
        memcpy(rates, next, sizeof next);
        if (most < 1e-5)
            break;
    }
    for (int i = 0; i < VOXELS; i++) {
        int best = 0;
        weigh(weight, rates, share, map, i);
        for (int l = 1; l < LABELS; l++)
            best = weight[l] > weight[best] ? l : best;
        consensus[i] = said_by_place[best];
    }
}

STORY(raters_and_their_consensus_are_those_of_the_papers)
{
    static uint8_t truth[VOXELS], map[RATERS][VOXELS];
    static uint8_t consensus[VOXELS], again[VOXELS], expected[VOXELS];
    static double rates[RATERS][LABELS][LABELS];
    const uint8_t *const maps[RATERS] = {map[0], map[1], map[2]};
    const double wrong[RATERS] = {0.03, 0.05, 0.1};
    static struct staple_rater rater[RATERS], twice[RATERS];
    unsigned off = 0, off_first = 0;
    struct fault fault = {0};
    rate(truth, map, wrong);
    expect_rates(rates, expected, map);
    CHECK_INT(staple_find(consensus, rater, RATERS, maps, cube, NULL, &fault), OK);
    CHECK_TEXT(fault.text, "");
    CHECK(memcmp(consensus, expected, VOXELS) == 0);
    for (int i = 0; i < VOXELS; i++) {
        off += consensus[i] != truth[i];
        off_first += map[0][i] != truth[i];
    }
    CHECK(off < off_first);
    for (unsigned r = 0; r < RATERS; r++)
        for (unsigned l = 0; l < LABELS; l++) {
            const uint8_t label = said_by_place[l];
            double is_not = 0, not_said = 0;
            for (int i = 0; i < VOXELS; i++) {
                is_not += consensus[i] != label;
                not_said += consensus[i] != label && map[r][i] != label;
            }
            CHECK(fabs(rater[r].sensitivity[label] - rates[r][l][l]) < 1e-6);
            CHECK(fabs(rater[r].specificity[label] - not_said / is_not) < 0.03);
        }
    CHECK(isnan(rater[0].sensitivity[1]) && isnan(rater[2].specificity[255]));
    CHECK(rater[0].sensitivity[3] > rater[2].sensitivity[3]);
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
        TELL(a_mirror_image_and_a_slab_are_refused_in_words),
        TELL(scenes_that_say_too_little_are_refused_before_anything_is_done),
        TELL(a_helper_that_is_missing_dies_or_lies_costs_one_line),
        TELL(each_figure_of_an_answer_is_judged),
        TELL(a_helper_that_never_ends_is_ended),
        TELL(a_stop_is_heard_and_the_helper_is_gone),
        TELL(a_helper_ends_with_its_client),
        TELL(raters_and_their_consensus_are_those_of_the_papers),
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
