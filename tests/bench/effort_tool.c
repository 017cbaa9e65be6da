/* SPDX-License-Identifier: MIT */
#include "command/execute.h"
#include "tests/bench/effort_tool.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "engine/labels.h"
#include "engine/weight.h"
#include "program/times.h"
#include "session/session.h"
#include "tests/bench/growcut.h"
#include "tests/peers/worker.h"

extern char **environ;

enum { PATH_ROOM = 4096, ANSWER_ROOM = 256 };

static void path_in(char path[PATH_ROOM], const char *folder, const char *name)
{
    snprintf(path, PATH_ROOM, "%s/%s", folder, name);
}

/* ---- what tools read ---- */

static enum err write_bytes(const char *folder, const char *name, const void *bytes, size_t length,
                            struct fault *fault)
{
    char path[PATH_ROOM];
    path_in(path, folder, name);
    return file_write(path, bytes, length, FILE_REPLACE, fault);
}

/* What `weight gauss 1` makes of an image of 8 bits fits 8 bits. */
static enum err write_gradient(const struct effort_object *object, const char *folder,
                               struct fault *fault)
{
    const struct weight_choice choice = {WEIGHT_GAUSS, 1000};
    struct weight_work work = {0};
    struct adjacency adjacency;
    struct scene *scene = NULL;
    uint8_t *gradient = mem_array(object->voxels, 1);
    enum err err =
        gradient ? scene_new(&scene, object->size, fault) : fault_memory(fault, "a gradient");
    if (!err)
        err = weight_work_reserve(&work, &scene->grid, &choice, fault);
    size_t voxel = 0;
    for (size_t pass = 0; !err && pass < 2; pass++, voxel = 0) {
        for (uint32_t z = 0; z < object->size[2]; z++)
            for (uint32_t y = 0; y < object->size[1]; y++) {
                const struct span row = grid_row(&scene->grid, y, z);
                for (uint32_t c = row.first; c < row.end; c++, voxel++)
                    if (pass == 0)
                        scene->cell[c].intensity = object->image[voxel];
                    else
                        gradient[voxel] =
                            (uint8_t)(scene->cell[c].weight < 255 ? scene->cell[c].weight : 255);
            }
        if (pass > 0)
            continue;
        adjacency_init(&adjacency, 6, &scene->grid);
        weight_compute(scene, &adjacency, &choice, &work);
    }
    err = err ? err : write_bytes(folder, "gradient.u8", gradient, object->voxels, fault);
    weight_work_release(&work);
    scene_free(scene);
    free(gradient);
    return err;
}

enum err effort_tool_prepare(const struct effort_object *object, const char *folder,
                             struct fault *fault)
{
    char path[PATH_ROOM], size[64];
    const int length = snprintf(size, sizeof size, "%u %u %u\n", object->size[0], object->size[1],
                                object->size[2]);
    path_in(path, folder, "scene.nii");
    enum err err = effort_object_save(object, path, fault);
    if (!err)
        err = write_bytes(folder, "size", size, (size_t)length, fault);
    if (!err)
        err = write_bytes(folder, "image.u8", object->image, object->voxels, fault);
    return err ? err : write_gradient(object, folder, fault);
}

/* ---- iftty ---- */

/* A line has its first corner again, since a polygon has three; a voxel is a seed. */
static void write_outline(struct buf *line, const struct effort_gesture *gesture)
{
    const size_t corners = gesture->corners == 2 ? 3 : gesture->corners;
    buf_add_text(line, corners == 1 ? "seed" : gesture->ring ? "outline" : "fill");
    for (size_t i = 0; i < corners; i++) {
        const uint32_t *at = gesture->corner[i % gesture->corners];
        buf_printf(line, "%s%u,%u,%u", i ? " to=" : " ", at[0], at[1], at[2]);
        if (i == 0)
            buf_printf(line, " %u", gesture->label);
    }
    if (gesture->ring && corners > 1)
        buf_printf(line, " ring=%u", gesture->ring);
}

void effort_write_command(struct buf *line, const struct effort_gesture *gesture, bool limits)
{
    const uint32_t *at = gesture->at, *to = gesture->to;
    buf_clear(line);
    if (gesture->shape == SHAPE_OUTLINE) {
        write_outline(line, gesture);
        return;
    }
    if (gesture->shape == SHAPE_BOX) {
        buf_printf(line, "box %u,%u,%u %u,%u,%u %u shell=yes around=1", at[0], at[1], at[2], to[0],
                   to[1], to[2], gesture->label);
        return;
    }
    buf_printf(line, "seed %u,%u,%u %u", at[0], at[1], at[2], gesture->label);
    if (gesture->radius)
        buf_printf(line, " radius=%u", gesture->radius);
    if (limits && gesture->shape == SHAPE_BALL && gesture->within)
        buf_printf(line, " within=%u", gesture->within);
    if (gesture->shape == SHAPE_SPHERE)
        buf_add_text(line, " shell=yes around=1");
    else if (gesture->shape == SHAPE_STROKE && memcmp(at, to, sizeof gesture->at) != 0)
        buf_printf(line, " to=%u,%u,%u", to[0], to[1], to[2]);
}

static enum err command(struct effort_tool *tool, const char *line, struct fault *fault)
{
    enum err err = interpreter_execute(tool->interp, line, &tool->reply, fault);
    return err ? fault_prefix(fault, err, "%s", line) : OK;
}

static enum err begin_iftty(struct effort_tool *tool, struct fault *fault)
{
    char line[PATH_ROOM + 16];
    tool->interp = mem_new(sizeof *tool->interp);
    enum err err =
        tool->interp ? interpreter_init(tool->interp, fault) : fault_memory(fault, "a session");
    snprintf(line, sizeof line, "open %s/scene.nii", tool->folder);
    err = err ? err : command(tool, line, fault);
    err = err ? err : command(tool, "auto on", fault);
    snprintf(line, sizeof line, "weight %s", tool->method->weight);
    err = err ? err : command(tool, line, fault);
    snprintf(line, sizeof line, "finish relax reach=%u", tool->method->reach);
    if (!err && tool->method->reach)
        err = command(tool, line, fault);
    return err;
}

static enum err apply_iftty(struct effort_tool *tool, const struct effort_gesture *gesture,
                            struct fault *fault)
{
    struct session *session = tool->interp->session;
    struct labels labels;
    struct buf line = {0};
    effort_write_command(&line, gesture, tool->method->limits);
    const double begin = worker_clock_ms();
    enum err err = command(tool, buf_text(&line), fault);
    err = err ? err : session_labels(session, tool->method->reach > 0, &labels, fault);
    tool->ms = worker_clock_ms() - begin;
    uint8_t *out = tool->label;
    for (uint32_t z = 0; !err && z < tool->grid.size[2]; z++)
        for (uint32_t y = 0; y < tool->grid.size[1]; y++, out += tool->grid.size[0])
            labels_copy_row(&labels, grid_row(&tool->grid, y, z), out);
    buf_release(&line);
    return err;
}

/* ---- from markers ---- */

static enum err mark(struct effort_tool *tool, const struct effort_gesture *gesture,
                     struct fault *fault)
{
    struct voxels voxels = {0};
    const enum err err = effort_gesture_voxels(&voxels, gesture, &tool->grid, fault);
    for (size_t i = 0; !err && i < voxels.count; i++)
        tool->marker[grid_voxel(&tool->grid, voxels.cell[i])] = (uint8_t)(gesture->label + 1);
    voxels_release(&voxels);
    return err;
}

static enum err apply_growcut(struct effort_tool *tool, struct fault *fault)
{
    const double begin = worker_clock_ms();
    const enum err err =
        growcut(tool->label, tool->object->image, tool->marker, tool->object->size, fault);
    tool->ms = worker_clock_ms() - begin;
    return err;
}

/* ---- workers ---- */

/* A program of tests/peers: Python's by a name, or one that was built. False where it is not there.
 */
static bool worker_words(const char *words[5], struct buf *path, const struct effort_tool *tool)
{
    const char *name = tool->method->weight;
    const bool is_built = strncmp(name, "itk", 3) == 0;
    if (!bench_find_in_tree(path,
                            is_built ? "tests/peers/itk_worker" : "tests/peers/python_worker.py"))
        return false;
    size_t count = 0;
    if (!is_built)
        words[count++] = "/usr/bin/python3";
    words[count++] = buf_text(path);
    if (!is_built)
        words[count++] = name;
    words[count++] = tool->folder;
    words[count] = NULL;
    return true;
}

static bool start_worker(struct effort_tool *tool, const char *const *words)
{
    int in[2], out[2];
    if (pipe(in) != 0)
        return false;
    if (pipe(out) != 0) {
        close(in[0]), close(in[1]);
        return false;
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, in[1]);
    posix_spawn_file_actions_addclose(&actions, out[0]);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const bool fine = posix_spawn(&child, words[0], &actions, NULL, (char *const *)(uintptr_t)words,
                                  environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]), close(out[1]);
    tool->to = in[1], tool->from = out[0];
    tool->child = fine ? child : 0;
    return fine;
}

/* A request, and its answer of one line; "" where the worker has ended. */
static void ask(struct effort_tool *tool, const char *request, char answer[ANSWER_ROOM])
{
    size_t length = 0;
    char c = '\0';
    answer[0] = '\0';
    if (write(tool->to, request, strlen(request)) != (ssize_t)strlen(request))
        return;
    for (ssize_t n; c != '\n';) {
        do
            n = read(tool->from, &c, 1);
        while (n < 0 && errno == EINTR);
        if (n <= 0)
            break;
        if (length + 1 < ANSWER_ROOM && c != '\n')
            answer[length++] = c;
    }
    answer[length] = '\0';
}

static enum err demand(struct effort_tool *tool, const char *request, char answer[ANSWER_ROOM],
                       struct fault *fault)
{
    ask(tool, request, answer);
    if (strcmp(answer, "ok") == 0 || (answer[0] >= '0' && answer[0] <= '9'))
        return OK;
    return fault_set(fault, ERR_IO, "%s answers '%.200s' to '%.*s'", tool->method->name, answer,
                     (int)strcspn(request, "\n"), request);
}

static enum err begin_worker(struct effort_tool *tool, struct fault *fault)
{
    char answer[ANSWER_ROOM];
    const char *words[5];
    struct buf path = {0};
    enum err err = OK;
    signal(SIGPIPE, SIG_IGN);
    if (!worker_words(words, &path, tool) || !start_worker(tool, words))
        err = fault_set(fault, ERR_IO, "the program of %s is not here", tool->method->name);
    buf_release(&path);
    return err ? err : demand(tool, "reset\n", answer, fault);
}

static enum err apply_worker(struct effort_tool *tool, struct fault *fault)
{
    char line[PATH_ROOM + 16], path[PATH_ROOM], answer[ANSWER_ROOM];
    enum err err =
        write_bytes(tool->folder, "markers.u8", tool->marker, tool->object->voxels, fault);
    snprintf(line, sizeof line, "markers %s/markers.u8\n", tool->folder);
    err = err ? err : demand(tool, line, answer, fault);
    err = err ? err : demand(tool, "run\n", answer, fault);
    tool->ms = err ? 0 : strtod(answer, NULL);
    snprintf(line, sizeof line, "labels %s/labels.u8\n", tool->folder);
    err = err ? err : demand(tool, line, answer, fault);
    path_in(path, tool->folder, "labels.u8");
    if (!err && !worker_read(path, tool->label, tool->object->voxels))
        err = fault_set(fault, ERR_IO, "%s wrote no labels", tool->method->name);
    for (size_t i = 0; !err && i < tool->object->voxels; i++)
        tool->label[i] = tool->label[i] == 2; /* as a marker, label + 1 */
    return err;
}

/* ---- any of them ---- */

enum err effort_tool_begin(struct effort_tool *tool, const struct effort_method *method,
                           const struct effort_object *object, const char *folder,
                           struct fault *fault)
{
    *tool = (struct effort_tool){
        .method = method, .object = object, .folder = folder, .to = -1, .from = -1};
    enum err err = grid_init(&tool->grid, object->size, fault);
    tool->label = mem_new(object->voxels);
    tool->marker = mem_new(object->voxels);
    if (!err && (!tool->label || !tool->marker))
        err = fault_memory(fault, "a tool");
    if (err || method->by == BY_GROWCUT)
        return err;
    return method->by == BY_IFTTY ? begin_iftty(tool, fault) : begin_worker(tool, fault);
}

enum err effort_tool_apply(struct effort_tool *tool, const struct effort_gesture *gesture,
                           struct fault *fault)
{
    if (tool->method->by == BY_IFTTY)
        return apply_iftty(tool, gesture, fault);
    const enum err err = mark(tool, gesture, fault);
    if (err || tool->gestures++ == 0)
        return err;
    return tool->method->by == BY_GROWCUT ? apply_growcut(tool, fault) : apply_worker(tool, fault);
}

void effort_tool_end(struct effort_tool *tool)
{
    if (tool->interp) {
        interpreter_release(tool->interp);
        free(tool->interp);
    }
    reply_release(&tool->reply);
    if (tool->to >= 0)
        close(tool->to), close(tool->from);
    if (tool->child)
        waitpid(tool->child, NULL, 0);
    free(tool->label);
    free(tool->marker);
    *tool = (struct effort_tool){.to = -1, .from = -1};
}
