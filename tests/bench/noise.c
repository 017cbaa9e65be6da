/* SPDX-License-Identifier: MIT */
/* The worst label map: noise, whose every voxel is a seed. */
#include "command/execute.h"
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "program/console.h"
#include "session/session_inside.h"

/* A scene of SIDE^3 voxels, and a map of the labels 0 to 7 as chance has them. */
enum { SIDE = 200, SIDE_MOST = 400, LABELS = 8 };

struct noise {
    uint32_t size[3];
    struct buf folder, told;
    struct interpreter interp;
    struct reply reply;
    struct watch watch;
};

static void noise_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct noise *n = context;
    uint8_t *at = values;
    for (uint32_t x = 0; x < n->size[0]; x++)
        *at++ = (uint8_t)(hash_mix_at(x, (uint64_t)z * n->size[1] + y) % LABELS);
}

static enum err write_noise(struct noise *n, struct fault *fault)
{
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    char path[4096];
    geometry_place_plain(&geometry, (const double[]){1, 1, 1});
    snprintf(path, sizeof path, "%s/noise.nii", buf_text(&n->folder));
    return volume_write(path, FILE_REPLACE,
                        &(struct volume_map){.size = n->size,
                                             .geometry = &geometry,
                                             .type = VOXEL_UINT8,
                                             .description = "noise",
                                             .row = noise_row,
                                             .context = n},
                        NULL, fault);
}

static void hear(void *context, const char *line)
{
    struct noise *n = context;
    buf_add_text(&n->told, line);
    buf_add_char(&n->told, '\n');
}

static bool go_on(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)context;
    return watch_poll(console_watch(), what, done, total);
}

static enum err say(struct noise *n, const char *line, struct fault *fault)
{
    const enum err err = interpreter_execute(&n->interp, line, &n->reply, fault);
    return err ? fault_prefix(fault, err, "%s", line) : OK;
}

/* What it takes to open the map, with these words. */
static enum err measure(struct noise *n, const char *words, struct fault *fault)
{
    char line[4200];
    struct session *session = n->interp.session;
    enum err err = interpreter_init(&n->interp, fault);
    session->watch = &n->watch;
    snprintf(line, sizeof line, "open synth:geom:%ux%ux%u", n->size[0], n->size[1], n->size[2]);
    err = err ? err : say(n, line, fault);
    const size_t before = err ? 0 : session_memory(session);
    const uint64_t begin = clock_ns();
    snprintf(line, sizeof line, "labels %s/noise.nii %s", buf_text(&n->folder), words);
    err = err ? err : say(n, line, fault);
    const uint64_t planted = clock_ns();
    err = err ? err : say(n, "run", fault);
    const double mb =
        err ? 0
            : (double)(session_memory(session) + history_memory(&n->interp.history) - before) / 1e6;
    if (!err)
        printf("%-12s%10zu markers%10zu seeds%8.0f MB%8.0f ms, run%8.0f ms\n",
               *words ? words : "as it is", session->markers.count, forest_seeds(session->forest),
               mb, (double)(planted - begin) / 1e6, (double)(clock_ns() - planted) / 1e6);
    interpreter_release(&n->interp);
    return err;
}

enum err run_noise(const struct options *options, struct fault *fault)
{
    struct noise n = {.size = {SIDE, SIDE, SIDE}};
    const long side = options->words ? strtol(options->word[0], NULL, 10) : SIDE;
    if (side < 1 || side > SIDE_MOST)
        return fault_set(fault, ERR_USAGE, "SIDE: expected 1 to %d voxels, not %s", SIDE_MOST,
                         options->word[0]);
    n.size[0] = n.size[1] = n.size[2] = (uint32_t)side;
    n.watch = (struct watch){.context = &n, .poll = go_on, .announce = hear};
    enum err err = folder_fresh(&n.folder, NULL, fault);
    err = err ? err : write_noise(&n, fault);
    err = err ? err : measure(&n, "", fault);
    err = err ? err : measure(&n, "least=5", fault);
    if (!err)
        fputs(buf_text(&n.told), stdout);
    if (n.folder.length)
        folder_remove(buf_text(&n.folder));
    reply_release(&n.reply);
    buf_release(&n.told);
    buf_release(&n.folder);
    return err;
}
