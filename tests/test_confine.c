/* SPDX-License-Identifier: MIT */
/* Confinement of the helpers, from outside: what the kernel reports of working helpers, and the end
 * of helpers that hang, whose client is killed, or that allocate all memory (probe/). */
#include "orphans.h"

#include <signal.h>
#include <unistd.h>

#include "base/confine.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/image_helper.h"
#include "image/volume.h"
#include "image/volume_helper.h"
#include "apply/registration.h"
#include "folder_main.h"

static const char *file_with(const char *name, const char *text)
{
    const char *path = file_in(folder, name);
    CHECK_INT(file_write(path, text, strlen(text), FILE_REPLACE, NULL), OK);
    return path;
}

/* ---- what the kernel says ---- */

/* First child of a process; 0 if it has none. */
static int child_of(int process)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", process, process);
    OWNED(stream_release) FILE *file = fopen(path, "r");
    int child;
    return file && fscanf(file, "%d", &child) == 1 ? child : 0;
}

static bool has_status(int process, const char *line)
{
    char path[64], text[4096];
    snprintf(path, sizeof path, "/proc/%d/status", process);
    OWNED(stream_release) FILE *file = fopen(path, "r");
    const size_t n = file ? fread(text, 1, sizeof text - 1, file) : 0;
    text[n] = '\0';
    return strstr(text, line) != NULL;
}

static bool works(int process)
{
    return has_status(process, "State:\tS") || has_status(process, "State:\tR");
}

static void check_status(int process)
{
    CHECK(process > 0 && has_status(process, "NoNewPrivs:\t1"));
    CHECK(!confine_knows_calls() || has_status(process, "Seccomp:\t2"));
}

/* At most a minute. */
#define WAIT_UNTIL(condition)                                                                      \
    for (int i = 0; i < 6000 && !(condition); i++)                                                 \
    usleep(10000)

STORY(the_image_helper_is_confined_before_the_first_pixel)
{
    OWNED(image_helper_drop) struct image_helper *helper = NULL;
    OWNED(picture_release) struct picture picture;
    CHECK_INT(image_helper_new(&helper, built_program("iftty-image"), NULL), OK);
    struct image_movie movie = {helper, file_in(folder, "a.gif"), .mode = FILE_REPLACE};
    CHECK_INT(picture_init(&picture, 8, 8, 0, NULL), OK);
    CHECK_INT(image_movie_begin(&movie, &picture, 2, 0, NULL), OK);
    const int taker = child_of(getpid());
    int worker = 0;
    WAIT_UNTIL((worker = child_of(taker)) > 0);
    WAIT_UNTIL(has_status(worker, "NoNewPrivs:\t1") && has_status(worker, "Seccomp:\t2"));
    check_status(worker);
    image_movie_abandon(&movie);
    WAIT_UNTIL(!works(worker));
    CHECK(child_of(getpid()) == 0 && !works(worker));
}

STORY(the_volume_helper_is_confined_before_it_answers)
{
    static const char volume[] = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
                                 "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n12345678";
    struct volume_reader reader;
    volume_helper_program = built_program("iftty-volume");
    CHECK_INT(volume_open(&reader, file_with("a.mha", volume), NULL, NULL, NULL), OK);
    check_status(child_of(getpid()));
    volume_close(&reader);
    volume_helper_program = NULL;
}

/* It receives voxels or the bytes of a transform, but no file. */
STORY(the_register_helper_reaches_nothing)
{
    struct geometry geometry = {.spacing_nm = {1000000, 1000000, 1000000}};
    struct scene *scene = NULL;
    struct registration found;
    struct fault fault = {0};
    static const double to_mm[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    CHECK(geometry_place(&geometry, to_mm, ORIENTATION_FILE));
    CHECK_INT(scene_new(&scene, (const uint32_t[]){8, 8, 8}, NULL, NULL, NULL), OK);
    const struct placed_scene placed = {scene, &geometry};
    if (!confine_version() || !confine_knows_calls()) {
        SKIP("the kernel has no Landlock");
        scene_free(scene);
        return;
    }
    register_helper_program = built_program("tests/probe/iftty-register");
    CHECK_INT(registration_find(&found, &placed, &placed, NULL, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "registering: ");
    CHECK_HAS(fault.text, "attempts, all refused");
    const struct placed_grid grid = {{8, 8, 8}, &geometry};
    struct affine way;
    OWNED(buf_release) struct buf words = {0};
    CHECK_INT(transform_read(&way, &words, file_with("a.tfm", "#Insight Transform File V1.0\n"),
                             &grid, &grid, &fault),
              ERR_INPUT);
    CHECK_HAS(fault.text, "a.tfm: reading: ");
    CHECK_HAS(fault.text, "attempts, all refused");
    register_helper_program = NULL;
    scene_free(scene);
}

/* ---- those that go too far ---- */

static const char *image_fault(const char *name)
{
    static struct fault fault;
    OWNED(image_helper_drop) struct image_helper *helper = NULL;
    struct picture picture;
    fault = (struct fault){0};
    CHECK_INT(image_helper_new(&helper, built_program("tests/probe/iftty-image"), NULL), OK);
    CHECK(image_helper_read(helper, file_with(name, "x"), &picture, &fault) != OK);
    return fault.text;
}

static const char *volume_fault(const char *name)
{
    static struct fault fault;
    struct volume volume;
    fault = (struct fault){0};
    volume_helper_program = built_program("tests/probe/iftty-volume");
    CHECK(volume_read(&volume, file_with(name, "NRRD0004\n"), NULL, NULL, &fault) != OK);
    volume_helper_program = NULL;
    return fault.text;
}

STORY(a_decoder_that_hangs_or_makes_no_progress_is_killed_and_others_may_work_on)
{
    image_helper_patience_ms = volume_helper_patience_ms = 1000;
    CHECK_HAS(image_fault("spin.png"), "did not answer for 1 s and was ended");
    CHECK_HAS(volume_fault("spin.nrrd"), "did not answer for 1 s and was ended");
    image_helper_patience_ms = volume_helper_patience_ms = 60000;
    CHECK_INT(child_of(getpid()), 0);
    volume_helper_patience_ms = 600000;
    CHECK_HAS(volume_fault("spin.nrrd"), "worked for 5 s without progress and was ended");
    volume_helper_patience_ms = 1500; /* it needs 3.6 s */
    CHECK_HAS(volume_fault("slow.nrrd"), "it has grown");
    volume_helper_patience_ms = 60000;
    CHECK_INT(child_of(getpid()), 0);
}

/* Start a request in a child process, and kill it after a delay. */
static void ask_and_be_killed(const char *(*ask)(const char *), const char *name, unsigned ms)
{
    fflush(stdout);
    const pid_t client = fork();
    if (client == 0) {
        ask(name);
        _exit(0);
    }
    usleep(1000 * ms);
    CHECK(kill(client, SIGKILL) == 0);
}

STORY(a_decoder_ends_with_its_client_at_any_time)
{
    static const unsigned after_ms[] = {0, 5, 60, 1000}; /* while it starts; while it decodes */
    adopt_orphans();
    for (size_t i = 0; i < sizeof after_ms / sizeof *after_ms; i++) {
        ask_and_be_killed(image_fault, "spin.png", after_ms[i]);
        ask_and_be_killed(volume_fault, "spin.nrrd", after_ms[i]);
        CHECK(await_orphans());
    }
}

STORY(the_memory_of_a_decoder_is_limited)
{
    if (!MEM_MAY_BE_LIMITED) {
        SKIP("a sanitiser takes more memory than a replay leaves");
        return;
    }
    image_helper_memory_most = volume_helper_memory_most = 600000000;
    CHECK_HAS(image_fault("memory.png"), "memory refused after ");
    CHECK_HAS(volume_fault("memory.nrrd"), "memory refused after ");
    image_helper_memory_most = volume_helper_memory_most = 0;
}

STORY(an_answer_that_drips_is_refused)
{
    static const char drip[] =
        "i=0; while [ $((i += 1)) -le 90 ]; do printf x || exit 1; sleep 0.2; done";
    static const char round[] = "printf 'progress 1 9\\nprogress 1 9\\n'; sleep 60";
    struct fault fault = {0};
    struct volume volume;
    volume_helper_program = make_script(folder, "drip", drip);
    volume_helper_patience_ms = 1000;
    CHECK(volume_read(&volume, file_with("a.nrrd", "NRRD0004\n"), NULL, NULL, &fault) != OK);
    CHECK_HAS(fault.text, "did not answer for 1 s and was ended");
    volume_helper_program = make_script(folder, "round", round);
    volume_helper_patience_ms = 60000;
    CHECK(volume_read(&volume, file_in(folder, "a.nrrd"), NULL, NULL, &fault) != OK);
    CHECK_HAS(fault.text, "invalid answer");
    volume_helper_program = NULL;
}
