/* SPDX-License-Identifier: MIT */
/* Results of registration: subjects made of ch2 with a known map, and scenes without one. The
 * bounds of src/apply/registration.h are between the two. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "image/volume.h"
#include "tests/bench/times.h"
#include "tests/deformed.h"

#define TURNED    .degrees = {5, -4, 6}
#define STRETCHED .scale = {1.06, 0.95, 1.03}
#define MOVED     .shift_mm = {6, -9, 7}
#define UNEVEN    .noise = 0.02, .bias = 0.15
#define ALL_OF_IT TURNED, STRETCHED, MOVED, UNEVEN

static const struct trial {
    const char *name;
    struct deformation how;
    bool is_to_be_found;
} trials[] = {
    {"itself", {.noise = 0}, true},
    {"affine", {ALL_OF_IT}, true},
    {"elastic 3 mm", {.elastic_mm = 3, .noise = 0.02, .bias = 0.15}, true},
    {"elastic 5 mm, affine", {ALL_OF_IT, .elastic_mm = 5}, true},
    {"noise of 10 %",
     {TURNED, STRETCHED, MOVED, .bias = 0.15, .elastic_mm = 5, .noise = 0.1},
     true},
    {"turned by 30 degrees",
     {.degrees = {5, -4, 30}, STRETCHED, MOVED, UNEVEN, .elastic_mm = 3},
     true},
    {"0.8 times as large",
     {TURNED, .scale = {1.25, 1.25, 1.25}, MOVED, UNEVEN, .elastic_mm = 3},
     true},
    {"moved by 60 mm", {TURNED, STRETCHED, .shift_mm = {60, 20, -30}, UNEVEN}, true},
    {"mirrored", {.mirrored = true}, false},
    {"mirrored, elastic 5 mm", {ALL_OF_IT, .elastic_mm = 5, .mirrored = true}, false},
    {"slab of 18 slices", {.first = 80, .planes = 18}, false},
    {"slab, elastic 5 mm", {ALL_OF_IT, .elastic_mm = 5, .first = 80, .planes = 18}, false},
    {"60 slices, elastic 5 mm", {ALL_OF_IT, .elastic_mm = 5, .first = 60, .planes = 60}, false},
    {"upper half, elastic 5 mm", {ALL_OF_IT, .elastic_mm = 5, .first = 90, .planes = 91}, false},
    {"noise alone", {.content = OF_NOISE}, false},
    {"nothing", {.content = OF_NOTHING}, false},
};

static size_t held_most;

/* Peak memory of the helper, the only child of this process. */
static bool look(void *context, const char *what, uint64_t done, uint64_t total)
{
    char path[64];
    int child;
    (void)context;
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", getpid(), getpid());
    OWNED(stream_release) FILE *file = fopen(path, "re");
    const size_t held = file && fscanf(file, "%d", &child) == 1 ? mem_held_by(child) : 0;
    held_most = held > held_most ? held : held_most;
    return watch_poll(console_watch(), what, done, total);
}

static void row(const char *name, const struct placed_scene *subject,
                const struct placed_scene *procedure, const struct subject *known)
{
    struct watch watch = {.poll = look};
    struct registration r;
    char off[16] = "-";
    held_most = 0;
    const uint64_t begin = clock_ns();
    const enum err err = registration_find(&r, subject, procedure, &watch, &bench_fault);
    if (err != ERR_CHECK && err != ERR_INPUT)
        must(err);
    if (!err && known)
        snprintf(off, sizeof off, "%.2f", subject_error(known, &r.affine));
    printf("%-24s %-7s", name, err ? "refused" : "found");
    if (err == ERR_INPUT)
        printf("   %s\n", bench_fault.text);
    else
        printf(" %6.3f %8.3f %8.3f %7.2f %9.2f  %4.2f-%4.2f %7s %6.1f %4zu\n", r.metric,
               r.identity_metric, r.mirrored_metric, r.overlap, r.agreement_mm, r.stretch[2],
               r.stretch[0], off, (double)(clock_ns() - begin) / 1e9, held_most / 1000000);
    fflush(stdout);
}

static void make(struct subject *subject, const struct volume *ch2, const struct deformation *how)
{
    must(subject_make(subject, ch2, how, 1) ? fault_memory(&bench_fault, "a subject") : OK);
}

static void made(const struct volume *ch2, const struct placed_scene *procedure)
{
    for (size_t i = 0; i < sizeof trials / sizeof *trials; i++) {
        struct subject subject;
        const struct trial *t = &trials[i];
        make(&subject, ch2, &t->how);
        const struct placed_scene placed = subject_placed(&subject);
        row(t->name, &placed, procedure, t->is_to_be_found ? &subject : NULL);
        scene_free(subject.scene);
    }
}

static void take(struct volume *out, const char *name)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    OWNED(buf_release) struct buf path = {0};
    must(interpreter_init(&interp, &bench_fault));
    must(interpreter_find_scene(&interp, 0, name, false, &path, &bench_fault));
    must(volume_read(out, buf_text(&path), NULL, NULL, &bench_fault));
}

/* Scenes as they are: other scans, another animal, a solid. */
static void others(const struct placed_scene *procedure)
{
    static const char *const names[] = {"ch2better.nii.gz", "ch2bet.nii.gz",
                                        "inia19-t1-brain.nii.gz"};
    static const double to_mm[3][4] = {{1, 0, 0, -100}, {0, 1, 0, -100}, {0, 0, 1, -50}};
    struct geometry geometry = {.spacing_nm = {1000000, 1000000, 1000000}};
    struct scene *scene;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        OWNED(volume_release) struct volume volume;
        take(&volume, names[i]);
        must(scene_new_plain(&scene, volume.size, volume.intensity, NULL, &bench_fault));
        volume.intensity = NULL;
        row(names[i], &(struct placed_scene){scene, &volume.geometry}, procedure, NULL);
        scene_free(scene);
    }
    must(scene_new_geom(&scene, 0, NULL, &bench_fault));
    if (geometry_place(&geometry, to_mm, ORIENTATION_FILE))
        row("synth:geom", &(struct placed_scene){scene, &geometry}, procedure, NULL);
    scene_free(scene);
}

enum err run_register(const struct options *options, struct fault *fault)
{
    OWNED(volume_release) struct volume ch2 = {0};
    struct subject procedure;
    OWNED(buf_release) struct buf helper = {0};
    (void)options, (void)fault;
    must(file_program_folder(&helper, &bench_fault));
    buf_add_text(&helper, "/../../iftty-register");
    register_helper_program = buf_text(&helper);
    take(&ch2, "ch2.nii.gz");
    make(&procedure, &ch2, &(struct deformation){.noise = 0});
    const struct placed_scene placed = subject_placed(&procedure);
    printf("%-24s %-7s %6s %8s %8s %7s %9s  %-9s %7s %6s %4s\n", "subject, onto ch2", "", "nats",
           "identity", "mirrored", "overlap", "agree, mm", "stretch", "off, mm", "s", "MB");
    made(&ch2, &placed);
    others(&placed);
    scene_free(procedure.scene);
    register_helper_program = NULL;
    return OK;
}
