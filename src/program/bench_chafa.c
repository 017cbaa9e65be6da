#include "program/bench_chafa.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/folder.h"
#include "image/png.h"

enum { ROUNDS = 7 };

static _Noreturn void become_chafa(const struct graphics *by, uint32_t side, const char *path,
                                   int output)
{
    char size[32];
    const bool is_text = by->kind == GRAPHICS_TEXT;
    const int nowhere = open("/dev/null", O_RDWR);
    /* where there are pixels, chafa takes cells for squares of 8x8 */
    snprintf(size, sizeof size, "%ux%u", side / 8, is_text ? side / 16 : side / 8);
    dup2(nowhere, 0);
    dup2(output, 1);
    dup2(nowhere, 2);
    execlp("chafa", "chafa", "-f", by->chafa, "-c", "full", "--font-ratio", is_text ? "1/2" : "1/1",
           "-s", size, path, (char *)NULL);
    _exit(127);
}

/* Its bytes; 0 where it cannot be run. */
static size_t run_chafa(const struct graphics *by, uint32_t side, const char *path)
{
    char taken[4096];
    int ends[2], status = 1;
    size_t bytes = 0;
    ssize_t n;
    if (pipe2(ends, O_CLOEXEC) != 0)
        return 0;
    const pid_t child = fork();
    if (child == 0)
        become_chafa(by, side, path, ends[1]);
    close(ends[1]);
    while ((n = read(ends[0], taken, sizeof taken)) > 0 || (n < 0 && errno == EINTR))
        bytes += n > 0 ? (size_t)n : 0;
    close(ends[0]);
    if (child > 0)
        waitpid(child, &status, 0);
    return status == 0 ? bytes : 0;
}

static struct bench_cost time_chafa(const struct graphics *by, uint32_t side, const char *path)
{
    struct bench_cost cost = {0};
    double ms[ROUNDS];
    for (int i = 0; i < ROUNDS && (i == 0 || cost.bytes > 0); i++) {
        const uint64_t begin = clock_ns();
        cost.bytes = (double)run_chafa(by, side, path);
        ms[i] = times_since(begin);
    }
    cost.ms = cost.bytes > 0 ? times_median(ms, ROUNDS) : 0;
    return cost;
}

static enum err write_png(struct buf *path, const char *folder, const char *name, uint32_t side,
                          const uint8_t *rgba, struct fault *fault)
{
    struct buf png = {0};
    buf_printf(path, "%s/%s", folder, name);
    enum err err = png_encode(&png, side, side, rgba, fault);
    if (!err)
        err = file_write(buf_text(path), png.data, png.length, FILE_KEEP, fault);
    buf_release(&png);
    return err;
}

enum err bench_chafa(struct bench_cost *cost, const struct graphics *by,
                     const struct image_view *view, struct fault *fault)
{
    struct buf folder = {0}, picture = {0}, dot = {0};
    *cost = (struct bench_cost){0};
    enum err err = folder_fresh(&folder, NULL, fault);
    if (err)
        return err;
    err = write_png(&picture, buf_text(&folder), "picture.png", view->width, view->rgba, fault);
    if (!err)
        err = write_png(&dot, buf_text(&folder), "dot.png", 1, view->rgba, fault);
    if (!err)
        *cost = time_chafa(by, view->width, buf_text(&picture));
    if (cost->bytes > 0) {
        const double start_ms = time_chafa(by, 8, buf_text(&dot)).ms;
        cost->ms = cost->ms > start_ms ? cost->ms - start_ms : 0;
    }
    folder_discard(buf_text(&folder));
    buf_release(&folder);
    buf_release(&picture);
    buf_release(&dot);
    return err;
}
