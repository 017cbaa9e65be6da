/* SPDX-License-Identifier: MIT */
/* Response to a stop: the time between two looks at the watch, in each kind of command. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "command/execute.h"
#include "tests/bench/times.h"
#include "session/session_inside.h"

/* "@x,y,z" is a place in percent of the scene's sides, in the same solid at every size. */
static const char *const steps[] = {
    "open synth:geom:SIZE",
    "seed @22,42,50 1 radius=3",
    "run",
    "range 40 210",
    "range none",
    "seed @33,42,50 1 radius=8",
    "seed @68,39,52 2 radius=32",
    "seed @50,70,50 3 radius=8 to=@62,70,50",
    "seed @2,2,2 0 radius=8",
    "run",
    "stats",
    "seed @60,60,50 4 radius=16",
    "run",
    "remove @33,42,50",
    "run",
    "undo",
    "goto 10",
    "render mode=sp",
    "render mode=bp",
    "render mode=ray",
    "clip axial 10-60",
    "render mode=bp",
    "clip none",
    "save labels labels.nii",
    "save labels labels.nii.gz",
    "save cost cost.nii",
    "save root root.nii",
    "mask labels.nii regions=0-9",
    "mask none",
    "seed-file labels.nii regions=1-3 erode=1 each=1000",
    "run",
    "seed-file labels.nii regions=3-3 erode=2",
    "run",
    "undo 2",
    "weight sobel",
    "weight gauss 1.5",
    "weight morph radius=2",
    "weight cost.nii",
    "weight polarity",
    "polarity 1 40",
    "remove @33,42,50",
    "run",
    "undo",
    "adjacency 26",
    "finish relax",
    "save labels relaxed.nii finished=yes",
    "finish none",
    "finish majority",
    "save labels finished.nii finished=yes",
    "finish largest",
    "finish open radius=3",
    "finish close radius=9",
    "finish holes",
    "render finished=yes",
};
enum { STEPS = sizeof steps / sizeof *steps };

/* ---- watching ---- */

struct looks {
    uint64_t last_ns, longest_ns;
    size_t count;
    const char *before, *after; /* work before and after the longest time */
    const char *what;
};

static void note(struct looks *looks, const char *what)
{
    const uint64_t now = clock_ns(), since = now - looks->last_ns;
    if (since > looks->longest_ns) {
        looks->longest_ns = since;
        looks->before = looks->what;
        looks->after = what;
    }
    looks->what = what;
    looks->last_ns = clock_ns();
}

static bool look(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct looks *looks = context;
    (void)done, (void)total;
    looks->count++;
    note(looks, what ? what : looks->what);
    return false;
}

/* ---- commands ---- */

/* A command with the places of this scene. */
static void write_command(struct buf *line, const char *at, const char *size,
                          const struct session *session)
{
    buf_clear(line);
    while (*at) {
        unsigned x, y, z;
        int length;
        if (strncmp(at, "SIZE", 4) == 0) {
            buf_add_text(line, size);
            at += 4;
        } else if (sscanf(at, "@%u,%u,%u%n", &x, &y, &z, &length) == 3) {
            const uint32_t *n = session->scene->grid.size;
            buf_printf(line, "%u,%u,%u", x * n[0] / 100, y * n[1] / 100, z * n[2] / 100);
            at += length;
        } else {
            buf_add_char(line, *at++);
        }
    }
}

static void print(const char *line, double ms, const struct looks *looks, struct json *json)
{
    const double longest = (double)looks->longest_ns / 1e6;
    if (!json) {
        printf("%-50s %9.1f ms %8zu looks %8.2f ms  %s .. %s\n", line, ms, looks->count, longest,
               looks->before, looks->after);
        fflush(stdout);
        return;
    }
    json_object(json, NULL);
    json_text(json, "command", line);
    json_fixed(json, "ms", ms, 3);
    json_count(json, "looks", looks->count);
    json_fixed(json, "longest_ms", longest, 3);
    json_end(json);
}

static void carry_out(struct interpreter *interp, const char *size, struct json *json)
{
    struct looks looks;
    struct watch watch = {.context = &looks, .poll = look};
    OWNED(reply_release) struct reply reply = {0};
    OWNED(buf_release) struct buf line = {0};
    double worst = 0;
    interp->session->watch = &watch;
    for (size_t i = 0; i < STEPS; i++) {
        write_command(&line, steps[i], size, interp->session);
        const uint64_t begin = clock_ns();
        looks = (struct looks){.last_ns = begin, .what = "begin", .before = "", .after = ""};
        bench_subject = buf_text(&line);
        must(interpreter_execute(interp, buf_text(&line), &reply, &bench_fault));
        note(&looks, "end");
        print(buf_text(&line), times_since(begin), &looks, json);
        worst = (double)looks.longest_ns / 1e6 > worst ? (double)looks.longest_ns / 1e6 : worst;
    }
    if (!json)
        printf("%-50s %34.2f ms\n", "the longest", worst);
}

/* In a folder of its own, which goes with the maps that are saved there. */
enum err run_looks(const struct options *options, struct fault *fault)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    const char *folder = bench_folder(NULL);
    (void)fault;
    must(chdir(folder) == 0 ? OK : fault_errno(&bench_fault, "use", folder));
    must(interpreter_init(&interp, &bench_fault));
    if (options->json)
        json_array(bench_json(), NULL);
    carry_out(&interp, options->words ? options->word[0] : "256x256x256",
              options->json ? bench_json() : NULL);
    if (options->json)
        json_end(bench_json());
    return OK;
}
