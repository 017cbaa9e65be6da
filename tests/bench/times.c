/* SPDX-License-Identifier: MIT */
#include "tests/bench/times.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "program/program.h"

struct fault bench_fault;
const char *bench_subject;

void must(enum err err)
{
    if (err && bench_subject)
        fault_prefix(&bench_fault, err, "%s", bench_subject);
    if (err)
        exit(console_finish(err, &bench_fault));
}

void *must_have(size_t bytes)
{
    void *memory = mem_new(bytes);
    must(memory ? OK : fault_memory(&bench_fault, "a benchmark"));
    return memory;
}

double times_between(uint64_t begin, uint64_t end)
{
    return (double)(end - begin) / 1e6;
}

double times_since(uint64_t begin)
{
    return times_between(begin, clock_ns());
}

static int compare_ms(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

double times_quantile(double *ms, size_t count, double share)
{
    qsort(ms, count, sizeof *ms, compare_ms);
    return count ? ms[(size_t)(share * (double)(count - 1) + 0.5)] : 0;
}

double times_median(double *ms, size_t count)
{
    qsort(ms, count, sizeof *ms, compare_ms);
    return count ? (ms[(count - 1) / 2] + ms[count / 2]) / 2 : 0;
}

uint64_t times_add(struct times *times, uint64_t begin)
{
    const uint64_t now = clock_ns();
    if (times->count < TIMES_MOST)
        times->ms[times->count++] = times_between(begin, now);
    return now;
}

void times_print_title(void)
{
    printf("%-44s %9s %9s %9s\n", "", "median", "9 of 10", "most");
}

void times_print(const char *what, struct times *times, double scale, const char *unit)
{
    printf("%-44s %9.2f %9.2f %9.2f  %s\n", what, times_median(times->ms, times->count) * scale,
           times_quantile(times->ms, times->count, 0.9) * scale,
           times_quantile(times->ms, times->count, 1) * scale, unit);
}

void times_write(struct json *json, struct times *times)
{
    json_fixed(json, "median", times_median(times->ms, times->count), 3);
    json_fixed(json, "most", times_quantile(times->ms, times->count, 1), 3);
}

static struct buf json_text_of;

struct json *bench_json(void)
{
    static struct json json = {.out = &json_text_of};
    return &json;
}

void bench_json_print(void)
{
    fputs(buf_text(&json_text_of), stdout);
    buf_release(&json_text_of);
}

enum { FOLDERS_MOST = 64 };
static struct buf folders[FOLDERS_MOST];
static int folder_count;

static void remove_folders(void)
{
    while (folder_count > 0) {
        struct buf *folder = &folders[--folder_count];
        if (folder->length)
            folder_remove(buf_text(folder));
        buf_release(folder);
    }
}

const char *bench_folder(const char *below)
{
    if (folder_count == 0)
        atexit(remove_folders);
    struct buf *folder = &folders[folder_count++];
    must(folder_fresh(folder, below, &bench_fault));
    return buf_text(folder);
}

bool bench_find_in_tree(struct buf *path, const char *name)
{
    enum { FOLDERS_ABOVE = 4 };
    OWNED(buf_release) struct buf folder = {0};
    bool found = false;
    if (file_program_folder(&folder, NULL))
        return false;
    for (int i = 0; i < FOLDERS_ABOVE && !found; i++) {
        buf_add_text(&folder, "/..");
        buf_clear(path);
        buf_printf(path, "%s/%s", buf_text(&folder), name);
        found = !path->failed && file_exists(buf_text(path));
    }
    return found;
}

enum err bench_find_example(struct buf *path, const struct interpreter *interp, struct fault *fault)
{
    OWNED(buf_release) struct buf scene = {0};
    const bool has_brain =
        interpreter_find_scene(interp, 0, "ch2.nii.gz", false, &scene, NULL) == OK;
    const char *name = has_brain ? "examples/brain.iftty" : "examples/geom.iftty";
    if (bench_find_in_tree(path, name))
        return OK;
    return fault_set(fault, ERR_IO, "%s does not lie beside the program", name);
}
