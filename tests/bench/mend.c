/* SPDX-License-Identifier: MIT */
/* How many gestures mend a segmentation that is opened again: defects, and ways to open it. */
#include "command/execute.h"
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "program/times.h"
#include "program/console.h"
#include "tests/bench/effort_robot.h"
#include "tests/bench/effort_tool.h"
#include "session/session_inside.h"

/*
 * The truth of an object (effort_object.h) is a label map. In each of DEFECTS copies of it one
 * defect is planted: a ball of radius 3 to 8 around a voxel of the border is taken out, or is
 * added. `labels` opens the copy, and the careful robot corrects what is wrong near the defect, the
 * largest piece of it first, until no more than a quarter of the defect is wrong there, or GESTURES
 * were made. What a gesture breaks elsewhere is counted too.
 */
enum { DEFECTS = 10, GESTURES = 12, NEAR = 6, MENDED_SHARE = 4 };

/* How the map is opened and corrected. */
static const struct way {
    const char *name, *words;
    bool limits;
} way[] = {
    {"erode=0", "erode=0", false},
    {"erode=0, within", "erode=0", true},
    {"erode=2", "erode=2", false},
};
enum { WAYS = sizeof way / sizeof *way };

struct outcome {
    unsigned mended, gestures; /* of those that were mended: all they took */
    uint64_t left, planted;    /* voxels wrong in the end, and of the defects */
    uint64_t beyond;           /* that gestures have made wrong elsewhere */
};

struct mend {
    struct effort_object object;
    uint8_t *map, *label, *near; /* [voxels] */
    struct interpreter interp;
    struct reply reply;
    struct buf folder, line;
};

/* ---- defects ---- */

static bool is_border(const struct effort_object *o, size_t i)
{
    const size_t row = o->size[0], plane = row * o->size[1];
    const size_t x = i % row, y = i / row % o->size[1], z = i / plane;
    if (x == 0 || y == 0 || z == 0 || x + 1 == row || y + 1 == o->size[1] || z + 1 == o->size[2])
        return false;
    const uint8_t *t = o->truth + i;
    return *t && (!t[1] || !*(t - 1) || !t[row] || !*(t - row) || !t[plane] || !*(t - plane));
}

/* The voxel of the border that chance says. */
static size_t choose_middle(const struct effort_object *o, uint64_t chance)
{
    size_t count = 0, at = 0;
    for (size_t i = 0; i < o->voxels; i++)
        count += is_border(o, i);
    size_t left = count ? chance % count : 0;
    for (size_t i = 0; i < o->voxels; i++)
        if (is_border(o, i) && left-- == 0)
            at = i;
    return at;
}

static int64_t square(int64_t x)
{
    return x * x;
}

/* The map with defect `number`, and what lies near it. Returns how many voxels it has. */
static uint64_t plant(struct mend *m, unsigned number)
{
    const struct effort_object *o = &m->object;
    const size_t middle = choose_middle(o, hash_mix_at(number + 1, o->voxels));
    const int64_t radius = 3 + number % 6, row = o->size[0], plane = row * o->size[1];
    const int64_t at[3] = {(int64_t)middle % row, (int64_t)middle / row % o->size[1],
                           (int64_t)middle / plane};
    uint64_t planted = 0;
    for (size_t i = 0; i < o->voxels; i++) {
        const int64_t v = (int64_t)i;
        const int64_t far = square(v % row - at[0]) + square(v / row % o->size[1] - at[1]) +
                            square(v / plane - at[2]);
        const bool is_in = far <= radius * radius;
        m->map[i] = is_in ? number % 2 : o->truth[i];
        m->near[i] = far <= square(radius + NEAR);
        planted += m->map[i] != o->truth[i];
    }
    return planted;
}

/* ---- a session ---- */

static enum err command(struct mend *m, struct fault *fault)
{
    const enum err err = interpreter_execute(&m->interp, buf_text(&m->line), &m->reply, fault);
    return err ? fault_prefix(fault, err, "%s", buf_text(&m->line)) : OK;
}

static enum err say(struct mend *m, const char *line, struct fault *fault)
{
    buf_clear(&m->line);
    buf_add_text(&m->line, line);
    return command(m, fault);
}

static enum err say_file(struct mend *m, const char *name, const char *file, const char *words,
                         struct fault *fault)
{
    buf_clear(&m->line);
    buf_printf(&m->line, "%s %s/%s %s", name, buf_text(&m->folder), file, words);
    return command(m, fault);
}

static enum err open_map(struct mend *m, const struct way *w, struct fault *fault)
{
    enum err err = interpreter_init(&m->interp, fault);
    err = err ? err : say_file(m, "open", "scene.nii", "", fault);
    err = err ? err : say(m, "auto on", fault);
    return err ? err : say_file(m, "labels", "map.nii", w->words, fault);
}

/* The labels now: what is wrong near the defect, and elsewhere, which the robot does not see. */
static enum err look(struct mend *m, uint64_t *left, uint64_t *beyond, struct fault *fault)
{
    struct session *session = m->interp.session;
    const struct grid *grid = &session->scene->grid;
    struct labels labels;
    const enum err err = session_labels(session, false, &labels, fault);
    uint8_t *out = m->label;
    *left = *beyond = 0;
    for (uint32_t z = 0; !err && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++, out += grid->size[0])
            labels_copy_row(&labels, grid_row(grid, y, z), out);
    for (size_t i = 0; !err && i < m->object.voxels; i++) {
        const bool is_wrong = m->label[i] != m->object.truth[i];
        *left += is_wrong && m->near[i];
        *beyond += is_wrong && !m->near[i];
        if (!m->near[i])
            m->label[i] = m->object.truth[i];
    }
    return err;
}

static enum err correct(struct mend *m, const struct way *w, uint64_t planted,
                        struct outcome *outcome, struct fault *fault)
{
    struct effort_robot robot;
    struct effort_gesture gesture;
    uint64_t left = 0, beyond = 0, before = 0;
    unsigned gestures = 0;
    bool wrong = true;
    enum err err = effort_robot_init(&robot, ROBOT_CAREFUL, &m->object, fault);
    err = err ? err : look(m, &left, &before, fault);
    beyond = before;
    while (!err && wrong && left > planted / MENDED_SHARE && gestures < GESTURES) {
        err = effort_robot_next(&robot, m->label, &gesture, &wrong, fault);
        effort_write_command(&m->line, &gesture, w->limits);
        err = err || !wrong ? err : command(m, fault);
        err = err ? err : look(m, &left, &beyond, fault);
        gestures++;
    }
    const bool is_mended = left <= planted / MENDED_SHARE;
    outcome->mended += is_mended;
    outcome->gestures += is_mended ? gestures : 0;
    outcome->left += left;
    outcome->planted += planted;
    outcome->beyond += beyond > before ? beyond - before : 0;
    effort_robot_release(&robot);
    return err;
}

/* ---- all ---- */

static enum err mend_one(struct mend *m, unsigned number, struct outcome outcome[WAYS],
                         struct fault *fault)
{
    struct effort_object map = m->object;
    char path[4096];
    const uint64_t planted = plant(m, number);
    map.image = m->map;
    snprintf(path, sizeof path, "%s/map.nii", buf_text(&m->folder));
    enum err err = effort_object_save(&map, path, fault);
    for (size_t w = 0; !err && w < WAYS; w++) {
        err = open_map(m, &way[w], fault);
        err = err ? err : correct(m, &way[w], planted, &outcome[w], fault);
        interpreter_release(&m->interp);
    }
    return err;
}

static enum err mend_object(struct mend *m, size_t object, struct outcome outcome[WAYS],
                            struct fault *fault)
{
    struct interpreter files;
    char path[4096];
    enum err err = interpreter_init(&files, fault);
    err = err ? err : effort_object_load(&m->object, object, &files, fault);
    interpreter_release(&files);
    snprintf(path, sizeof path, "%s/scene.nii", buf_text(&m->folder));
    err = err ? err : effort_object_save(&m->object, path, fault);
    m->map = mem_array(m->object.voxels, 1);
    m->label = mem_array(m->object.voxels, 1);
    m->near = mem_array(m->object.voxels, 1);
    if (!err && (!m->map || !m->label || !m->near))
        err = fault_memory(fault, "a defect");
    for (unsigned number = 0; !err && number < DEFECTS; number++)
        err = watch_poll(console_watch(), m->object.name, number, DEFECTS)
                  ? fault_set(fault, ERR_CANCELLED, "cancelled")
                  : mend_one(m, number, outcome, fault);
    free(m->map);
    free(m->label);
    free(m->near);
    effort_object_release(&m->object);
    return err;
}

static void write_outcomes(struct buf *out, const char *name, const struct outcome outcome[WAYS],
                           unsigned objects)
{
    buf_printf(out, "%s\n", name);
    for (size_t w = 0; w < WAYS; w++) {
        const struct outcome *o = &outcome[w];
        buf_printf(out, "    %-30s %3u of %-3u", way[w].name, o->mended, objects * DEFECTS);
        buf_printf(out, "%10.1f", o->mended ? (double)o->gestures / o->mended : 0.0);
        buf_printf(out, "%9.1f %%%9llu\n", 100.0 * (double)o->left / (double)o->planted,
                   (unsigned long long)o->beyond);
    }
}

static bool wants(const struct options *options, size_t object)
{
    bool wanted = options->words == 0 && effort_object_group(object) < GROUP_WHOLE;
    for (int i = 0; i < options->words; i++)
        wanted |= strcmp(options->word[i], effort_object_name(object)) == 0;
    return wanted;
}

enum err run_mend(const struct options *options, struct fault *fault)
{
    struct mend m = {.reply = {.text = {0}}};
    struct outcome all[WAYS] = {{0}};
    struct buf out = {0};
    unsigned objects = 0;
    enum err err = folder_fresh(&m.folder, NULL, fault);
    buf_printf(&out, "%-34s %10s%10s%11s%9s\n", "", "mended", "gestures", "left", "beyond");
    for (size_t i = 0; !err && effort_object_name(i); i++) {
        struct outcome one[WAYS] = {{0}};
        if (!wants(options, i))
            continue;
        err = mend_object(&m, i, one, fault);
        objects++;
        for (size_t w = 0; w < WAYS; w++) {
            all[w].mended += one[w].mended;
            all[w].gestures += one[w].gestures;
            all[w].left += one[w].left;
            all[w].planted += one[w].planted;
            all[w].beyond += one[w].beyond;
        }
        if (!err)
            write_outcomes(&out, effort_object_name(i), one, 1);
    }
    if (!err && objects > 1)
        write_outcomes(&out, "all", all, objects);
    if (!err)
        fputs(buf_text(&out), stdout);
    if (m.folder.length)
        folder_remove(buf_text(&m.folder));
    reply_release(&m.reply);
    buf_release(&m.folder);
    buf_release(&m.line);
    buf_release(&out);
    return err;
}
