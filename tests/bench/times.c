/* SPDX-License-Identifier: MIT */
#include "tests/bench/times.h"

#include <stdlib.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/interpreter.h"

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

bool bench_find_in_tree(struct buf *path, const char *name)
{
    enum { FOLDERS_ABOVE = 4 };
    struct buf folder = {0};
    bool found = false;
    if (file_program_folder(&folder, NULL))
        return false;
    for (int i = 0; i < FOLDERS_ABOVE && !found; i++) {
        buf_add_text(&folder, "/..");
        buf_clear(path);
        buf_printf(path, "%s/%s", buf_text(&folder), name);
        found = !path->failed && file_exists(buf_text(path));
    }
    buf_release(&folder);
    return found;
}

enum err bench_find_example(struct buf *path, const struct interpreter *interp, struct fault *fault)
{
    struct buf scene = {0};
    const bool has_brain = interpreter_find_scene(interp, "ch2.nii.gz", false, &scene, NULL) == OK;
    const char *name = has_brain ? "examples/brain.iftty" : "examples/geom.iftty";
    buf_release(&scene);
    if (bench_find_in_tree(path, name))
        return OK;
    return fault_set(fault, ERR_IO, "%s does not lie beside the program", name);
}
