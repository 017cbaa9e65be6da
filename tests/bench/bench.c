/* SPDX-License-Identifier: MIT */
/* The benchmarks as a program: its table, and its main. */
#include "tests/bench/bench.h"
#include "tests/bench/times.h"

enum { JSON = 1, QUICK_PAPER, QUICK_GROWTH, QUICK_KEYS, ROUNDS, METHOD, PROGRAM, BRUSH, SCENE };

#define FLAG(member) option_read_flag, offsetof(struct bench_options, member), 0, 0, NULL
#define TEXT(member) option_read_text, offsetof(struct bench_options, member), 0, 0, NULL

static const struct option option[] = {
    {0},
    [JSON] = {"--json", NULL, "print JSON", FLAG(common.json)},
    [QUICK_PAPER] = {"--quick", NULL, "only the first two steps", FLAG(quick)},
    [QUICK_GROWTH] = {"--quick", NULL, "only the first two scenes, of smaller tiles", FLAG(quick)},
    [QUICK_KEYS] = {"--quick", NULL, "one start, few keys of a small scene, no line", FLAG(quick)},
    [ROUNDS] = {"--rounds", "N", "time each experiment N times (3), take the median",
                option_read_number, offsetof(struct bench_options, rounds), 1, 99, NULL},
    [METHOD] = {"--method", "TEXT", "that method alone, or all with this in their names",
                TEXT(method)},
    [PROGRAM] = {"--program", "FILE", "time that iftty instead of this tree's", TEXT(program)},
    [BRUSH] = {"--brush", "N", "radius of balls at most N (3)", option_read_number,
               offsetof(struct bench_options, brush), 1, 128, NULL},
    [SCENE] = {"--scene", "FILE", "measure on this scene", TEXT(common.scene)},
};

static const struct program program[] = {
    {.name = "brain",
     .words = "",
     .option = {SCENE, JSON},
     .summary = "runs, edits, pictures and memory",
     .detail = "On ch2, or on synth:geom where that is not there; or on the scene that is given.",
     .run = run_brain},
    {.name = "terminal",
     .words = "",
     .option = {JSON},
     .summary = "pictures for terminals",
     .detail = "Bytes and time of a picture, and of a part of it that changes, by every graphics "
               "protocol.",
     .run = run_terminal},
    {.name = "paper",
     .words = "[SCENE...]",
     .most = 24,
     .option = {ROUNDS, QUICK_PAPER, JSON},
     .summary = "the paper's five experiments",
     .detail = "On brain and geom, as they are or with the axes interpolated that have a 2 in "
               "brain211, or ch2better, or all: the same seeds in the same eight steps as in the "
               "paper, beside its figures.",
     .run = run_paper},
    {.name = "growth",
     .words = "",
     .option = {QUICK_GROWTH, JSON},
     .summary = "one edit, in scenes of 4 to 300 million voxels",
     .detail = "As many scenes as memory holds together. The edit touches the same voxels in each.",
     .run = run_growth},
    {.name = "render",
     .words = "",
     .option = {JSON},
     .summary = "frames and incremental images; VTK beside them",
     .detail = "Whole frames of ch2 with brain and cerebellum, their parts, and incremental "
               "images; VTK where it is installed.",
     .run = run_render},
    {.name = "frames",
     .words = "[TEXT]",
     .most = 1,
     .option = {JSON},
     .summary = "frames by one thread and by all, a turntable; VTK beside them",
     .detail = "Whole frames and incremental images of ch2 with brain and cerebellum, of several "
               "sizes and samples, by one thread and by all of them in turn; a turntable of 36 "
               "large pictures, and the memory for it; VTK where it is installed. With TEXT, "
               "those alone that have it in their names.",
     .run = run_frames},
    {.name = "journal",
     .words = "[JOURNAL]",
     .most = 1,
     .option = {JSON},
     .summary = "what recording, reading and verifying cost",
     .detail = "100000 records encoded and read; recording beside the session that is recorded; "
               "verifying beside the forests and renditions that are made on the way.",
     .run = run_journal},
    {.name = "keys",
     .words = "[TEXT]",
     .most = 1,
     .option = {QUICK_KEYS, PROGRAM, JSON},
     .summary = "from the start to the prompt, from a key to its picture",
     .detail =
         "iftty in a terminal that the benchmark plays, with kitty's graphics and with sixel, "
         "at once and through lines of 20 Mbit/s and 30 ms and of 2 Mbit/s and 120 ms; with "
         "TEXT, those alone that have it in their names: kitty_local, sixel_slow, tiles_fast. "
         "Figures of the first run are stored in build/bench-keys.txt, and compared with.",
     .run = run_keys},
    {.name = "looks",
     .words = "[SIZE]",
     .most = 1,
     .option = {JSON},
     .summary = "how soon a stop is heard while one works",
     .detail = "Each kind of command on synth:geom:SIZE (256x256x256; 1024x1024x1024 takes 20 GB): "
               "its time, how often it looks at the watch, and the longest time between two looks.",
     .run = run_looks},
    {.name = "surface",
     .words = "",
     .summary = "how true surfaces of balls, rods, planes and sheets are",
     .detail = "At random places and in random directions: radius, volume, ripple, the median and "
               "95 % of the angles of normals.",
     .run = run_surface},
    {.name = "effort",
     .words = "[OBJECT...]",
     .most = 40,
     .option = {METHOD, BRUSH},
     .summary = "how many gestures a segmentation takes, by a robot",
     .detail = "A robot corrects the largest error, on the objects of tuned, other and ct, or on "
               "those named: weights, shells and relaxed labels, alone and together.",
     .run = run_effort},
    {.name = "register",
     .words = "",
     .summary = "what registration finds, what it refuses, and by how much",
     .detail = "Subjects made of ch2 (turned, stretched, bent, noisy), and scenes that have no map "
               "onto it: its mirror image, a slab, noise, a solid, another animal. How far off the "
               "map is at most in a box of the head, where it is known.",
     .run = run_register},
};

static const struct program_table table = {
    .called = "bench",
    .about = "bench: what iftty costs, as the paper measures it and in its parts",
    .closing = "`make bench-paper ARGS=--json` builds and runs one of them.\n",
    .row = program,
    .rows = sizeof program / sizeof program[0],
    .option = {option, sizeof option / sizeof option[0]},
};

int main(int count, char **word)
{
    struct bench_options options = {.rounds = 3};
    const int status = program_main(&table, count, word, &options.common);
    bench_json_print();
    return status;
}
