/* SPDX-License-Identifier: MIT */
/* Scenes of any size: what is refused before memory is allocated, the synthetic scene at every
 * size, the watch over long work, and the line that shows progress. tests/test_large.sh tests the
 * program. */
#include <fcntl.h>
#include <unistd.h>

#include "base/watch.h"
#include "tests/check_main.h"
#include "engine/scene.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "tui/progress.h"

/* ---- sizes ---- */

STORY(cells_beyond_32_bits_are_refused_and_never_wrap)
{
    static const struct {
        uint32_t size[3];
        enum err err;
    } row[] = {
        {{1623, 1623, 1623}, OK},        /* 1625^3, below 2^32 - 1 */
        {{1624, 1624, 1623}, ERR_LIMIT}, /* 1626 * 1626 * 1625, above */
        {{65534, 21843, 1}, OK},         /* 65536 * 21845 * 3 = 2^32 - 65536 */
        {{65534, 21844, 1}, ERR_LIMIT},
        {{65534, 65534, 65534}, ERR_LIMIT}, /* 2^48 cells */
        {{65535, 1, 1}, ERR_LIMIT},
        {{UINT32_MAX, UINT32_MAX, UINT32_MAX}, ERR_LIMIT},
        {{1, UINT32_MAX - 1, 1}, ERR_LIMIT}, /* a side that wraps to none */
        {{0, 1, 1}, ERR_INPUT},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const uint32_t *n = row[i].size;
        struct grid grid;
        const enum err err = grid_init(&grid, n, NULL);
        CHECK_INT(err, row[i].err);
        if (err)
            continue;
        const uint64_t cells = ((uint64_t)n[0] + 2) * ((uint64_t)n[1] + 2) * ((uint64_t)n[2] + 2);
        const uint32_t last = grid_cell(&grid, n[0] - 1, n[1] - 1, n[2] - 1);
        const struct place p = grid_place(&grid, last);
        CHECK(grid.cells == cells && cells < CELL_NONE);
        CHECK(p.x == n[0] - 1 && p.y == n[1] - 1 && p.z == n[2] - 1);
        CHECK(grid_voxel(&grid, last) == (uint64_t)n[0] * n[1] * n[2] - 1);
    }
}

STORY(a_scene_takes_less_than_twenty_bytes_a_voxel)
{
    static const uint32_t size[3] = {1024, 1024, 1024};
    CHECK(session_bytes_for(size) < UINT64_C(20) << 30);
    static const uint32_t most[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
    CHECK(session_bytes_for(most) == UINT64_MAX);
}

STORY(arrays_beyond_the_memory_of_the_machine_are_refused)
{
    const size_t available = mem_available();
    if (available == SIZE_MAX)
        return; /* the kernel does not say */
    CHECK(!mem_array(available / 4096 * 2, 4096));
    uint32_t *array = NULL;
    size_t capacity = 0;
    CHECK(mem_grow(&array, &capacity, 100, sizeof *array));
    const size_t before = capacity;
    uint32_t *const former = array;
    CHECK(!mem_grow(&array, &capacity, available, sizeof *array));
    CHECK(!mem_grow(&array, &capacity, SIZE_MAX / 4, sizeof *array));
    CHECK(!mem_grow(&array, &capacity, SIZE_MAX, sizeof *array));
    CHECK(array == former && capacity == before);
    free(array);
    void *pages = mem_pages(available * 2); /* addresses alone */
    CHECK(pages != NULL);
    mem_pages_free(pages, available * 2);
}

STORY(what_lies_free_between_what_is_used_is_given_back)
{
    enum { BLOCKS = 8192, BYTES = 16 << 10, USED = 32 };
    void **block = mem_array(BLOCKS, sizeof *block);
    for (int i = 0; i < BLOCKS && block; i++)
        CHECK((block[i] = mem_array(BYTES, 1)) && memset(block[i], 1, BYTES));
    const size_t all = mem_held();
    for (int i = 0; i < BLOCKS && block; i++)
        if (i % USED)
            free(block[i]);
    mem_trim();
    if (!MEM_MAY_BE_LIMITED)
        SKIP("a sanitiser takes more memory than a replay leaves");
    else
        CHECK(mem_held() + (size_t)BLOCKS / 2 * BYTES < all);
    for (int i = 0; i < BLOCKS && block; i += USED)
        free(block[i]);
    free(block);
}

/* ---- the synthetic scene ---- */

/* A voxel of a scene twice as fine, far from any surface, differs from geom's by noise alone. */
STORY(geom_of_another_size_shows_the_same_solids)
{
    static const uint32_t fine[3] = {400, 400, 200}, odd[3] = {77, 130, 3};
    static const uint32_t inside[][3] = {/* of the base */
                                         {5, 5, 5},      {30, 100, 50},  {50, 84, 50},
                                         {66, 84, 50},   {150, 70, 40},  {136, 78, 52},
                                         {125, 140, 50}, {100, 140, 50}, {199, 199, 99}};
    struct scene *base, *scene;
    CHECK(scene_new_geom(&base, 0, NULL, NULL) == OK);
    CHECK(scene_new_geom_of(&scene, fine, NULL, NULL) == OK);
    for (size_t i = 0; i < sizeof inside / sizeof inside[0]; i++) {
        const uint32_t *at = inside[i];
        const struct cell *a = base->cell + grid_cell(&base->grid, at[0], at[1], at[2]);
        const struct cell *b =
            scene->cell + grid_cell(&scene->grid, 2 * at[0] + 1, 2 * at[1], 2 * at[2] + 1);
        CHECK(abs(a->intensity - b->intensity) <= 8);
    }
    scene_free(scene);
    CHECK(scene_new_geom_of(&scene, odd, NULL, NULL) == OK);
    CHECK_INT(scene->grid.voxels, 77 * 130 * 3);
    uint64_t digest = scene_digest(scene);
    scene_free(scene);
    CHECK(scene_new_geom_of(&scene, odd, NULL, NULL) == OK && scene_digest(scene) == digest);
    scene_free(scene);
    scene_free(base);
}

/* ---- the watch ---- */

struct seen {
    unsigned looks, stop_at;
    uint64_t done, total;
    char told[128];
};

static bool see(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct seen *seen = context;
    seen->done = what ? done : seen->done;
    seen->total = what ? total : seen->total;
    return ++seen->looks >= seen->stop_at;
}

static void hear(void *context, const char *line)
{
    struct seen *seen = context;
    snprintf(seen->told, sizeof seen->told, "%s", line);
}

STORY(a_task_is_looked_at_now_and_then_and_stays_stopped)
{
    struct seen seen = {.stop_at = 3};
    struct watch watch = {.context = &seen, .poll = see, .announce = hear};
    struct task task = task_begin(&watch, "work", 10 * TASK_STEP);
    unsigned steps = 0;
    while (task_advance(&task, TASK_STEP / 4))
        steps++;
    CHECK_INT(steps, 11);
    CHECK_INT(seen.looks, 3);
    CHECK_INT(seen.done, 3 * TASK_STEP);
    CHECK_INT(seen.total, 10 * TASK_STEP);
    seen.stop_at = 100;
    CHECK(!task_advance(&task, 1)); /* W1 */
    struct task next = task_begin(&watch, "more work", 2 * TASK_STEP);
    CHECK(task_advance(&next, 1) && !task_advance(&next, TASK_STEP));
    CHECK(watch_stops(&watch) && watch_fault(&watch, NULL) == ERR_CANCELLED);
    seen.looks = 0;
    seen.stop_at = 1;
    watch_ignore_stop(&watch); /* W2 */
    CHECK(!watch_stops(&watch) && watch_fault(&watch, NULL) == OK);
    CHECK_INT(seen.looks, 2);
    watch_begin(&watch);
    CHECK(watch_stops(&watch));
    watch_announce(&watch, "%d voxels", 7);
    CHECK_TEXT(seen.told, "7 voxels");
    task = task_begin(NULL, "work", TASK_STEP);
    CHECK(task_advance(&task, UINT64_C(1) << 40));
    CHECK(!watch_stops(NULL) && watch_fault(NULL, NULL) == OK);
    watch_begin(NULL);
    watch_announce(NULL, "nobody");
}

/* ---- the line ---- */

/* What has been written to the pipe up to now. */
static const char *written(int fd)
{
    static char text[512];
    const ssize_t n = read(fd, text, sizeof text - 1);
    text[n > 0 ? n : 0] = '\0';
    return text;
}

STORY(the_line_comes_late_is_drawn_over_itself_and_goes)
{
    const uint64_t ms = 1000000;
    uint64_t now = 5000 * ms;
    int end[2];
    if (!CHECK(pipe2(end, O_NONBLOCK) == 0))
        return;
    struct progress p = {.fd = end[1], .shows = true, .columns = 80};
    progress_show(&p, "weights", 0, 100, now);
    progress_show(&p, "weights", 49, 100, now += 499 * ms);
    CHECK_TEXT(written(end[0]), "");
    progress_show(&p, "weights", 50, 100, now += 1 * ms);
    CHECK_TEXT(written(end[0]),
               "\rweights               [############------------]  50 %, 1 s left");
    progress_show(&p, "weights", 60, 100, now += 99 * ms);
    CHECK_TEXT(written(end[0]), "");
    progress_show(&p, "forest", 1234, 0, now += 1000 * ms);
    CHECK_TEXT(written(end[0]),
               "\rforest                1234 voxels, 1 s                          \r");
    progress_erase(&p);
    CHECK_TEXT(written(end[0]), "\r                                      \r");
    p.owns_row = true;
    progress_show(&p, "weights", 0, 10, now += 1000 * ms);
    progress_show(&p, "weights", 5, 10, now += 1000 * ms);
    written(end[0]);
    progress_show(&p, "forest", 1234, 0, now += 1000 * ms); /* the rest of the row is erased */
    CHECK_TEXT(written(end[0]), "\rforest                1234 voxels, 2 s"
                                "                          \033[K\r");
    progress_erase(&p);
    written(end[0]);
    progress_erase(&p);
    progress_show(&p, "forest", 1, 2, now += 1000 * ms); /* something new begins */
    CHECK_TEXT(written(end[0]), "");
    p.shows = false;
    progress_show(&p, "forest", 1, 2, now += 1000 * ms);
    CHECK_TEXT(written(end[0]), "");
    close(end[0]);
    close(end[1]);
}

STORY(time_left_is_that_of_the_step_at_hand)
{
    const uint64_t ms = 1000000;
    uint64_t now = 5000 * ms;
    int end[2];
    if (!CHECK(pipe2(end, O_NONBLOCK) == 0))
        return;
    struct progress p = {.fd = end[1], .shows = true, .columns = 80};
    progress_show(&p, "weights", 1, 100, now);
    progress_show(&p, "forest", 0, 100, now += 10000 * ms);
    CHECK_HAS(written(end[0]), "   0 %, 10 s"); /* nothing can be reported yet */
    progress_show(&p, "forest", 10, 100, now += 2000 * ms);
    CHECK_HAS(written(end[0]), "  10 %, 18 s left");
    progress_show(&p, "forest", 50, 100, now += 2000 * ms);
    CHECK_HAS(written(end[0]), "  50 %, 4 s left");
    progress_show(&p, "forest", 5, 100, now += 2000 * ms); /* once more from the start */
    CHECK_HAS(written(end[0]), "   5 %, 16 s");
    progress_show(&p, "forest", 100, 100, now += 2000 * ms);
    CHECK_HAS(written(end[0]), " 100 %, 18 s");
    progress_show(&p, "forest", UINT64_MAX / 2, UINT64_MAX, now += 2000 * ms);
    CHECK_HAS(written(end[0]), "  50 %, ");
    close(end[0]);
    close(end[1]);
}

static const char *line_of(const char *what, uint64_t done, uint64_t total, bool blocks,
                           unsigned columns)
{
    static char text[256];
    OWNED(buf_release) struct buf line = {0};
    const struct progress_step step = {.what = what, .done = done, .total = total, .seconds = 3};
    progress_line(&line, &step, blocks, columns);
    snprintf(text, sizeof text, "%s", buf_text(&line));
    return text;
}

STORY(the_line_fits_the_terminal_and_where_text_is_utf_8_the_bar_has_eighths)
{
    CHECK_TEXT(line_of("digest of the weights", UINT64_MAX, UINT64_MAX, false, 79),
               "digest of the weights [########################] 100 %, 3 s");
    CHECK_TEXT(line_of("weights", 0, UINT64_C(1) << 40, false, 30),
               "weights               [-------");
    CHECK_TEXT(line_of("weights", 3, 0, false, 0), "");
    CHECK_TEXT(line_of("weights", 0, 192, true, 79),
               "weights               ▕                        ▏   0 %, 3 s");
    CHECK_TEXT(line_of("weights", 12, 192, true, 79),
               "weights               ▕█▌                      ▏   6 %, 3 s");
    CHECK_TEXT(line_of("weights", 192, 192, true, 79),
               "weights               ▕████████████████████████▏ 100 %, 3 s");
    CHECK_TEXT(line_of("weights", 12, 192, true, 24), "weights               ▕█");
}
