/* SPDX-License-Identifier: MIT */
/* Questions about distances, angles and intensities: measure, profile, the histogram of info. */
#include "tests/scene_main.h"

#include "show/histogram.h"
#include "session/paint.h"

#define HAS(part) CHECK_HAS(buf_text(&reply.text), part)

STORY(a_chart_is_drawn_in_eighths_or_in_ascii)
{
    static const uint16_t eighths[] = {0, 1, 5, 8, 9, 16, 20, 3};
    OWNED(buf_release) struct buf out = {0};
    struct chart chart = {eighths, 8, 2, "9", "-1", 3, true};
    chart_write(&out, &chart);
    CHECK_TEXT(buf_text(&out), "  9 |    ▁██\n -1 | ▁▅████▃\n");
    buf_clear(&out);
    chart.has_blocks = false;
    chart_write(&out, &chart);
    CHECK_TEXT(buf_text(&out), "  9 |    .##\n -1 | .:####.\n");
}

/* The scene's world is oblique: its voxels are 1, 1.5 and 2.02 mm apart, y leans towards z. */
SCENE_STORY(distances_and_angles_are_those_of_the_world)
{
    MUST_ANSWER(interp, "measure 1,2,3 4,2,3", "3.00 mm, 3.00 voxels from 1,2,3 to 4,2,3\n");
    must(interp, "measure 1,2,3 1,4,3"); /* 2 steps of 0, 1.5, 0.25 mm */
    HAS("3.04 mm, 2.00 voxels");
    must(interp, "measure 1,2,3 1,2,3");
    HAS("0.00 mm, 0.00 voxels");
    must(interp, "measure 2,2,3 1,2,3 1,2,5");
    HAS("1.00 mm, 1.00 voxels from 2,2,3 to 1,2,3\n");
    HAS("4.00 mm, 2.00 voxels from 1,2,3 to 1,2,5\n");
    HAS("90.0 degrees at 1,2,3\n");
    must(interp, "measure 1,4,3 1,2,3 1,2,5"); /* y leans by atan(1/6) */
    HAS("80.5 degrees at 1,2,3\n");
    must(interp, "measure 0,2,3 1,2,3 4,2,3");
    HAS("180.0 degrees");
    MUST_FAIL(interp, "measure 1,2,3 1,2,3 4,2,3", ERR_INPUT,
              "there is no angle at 1,2,3: expected two other voxels");
    must(interp, "measure 4.5,-17,10.5mm 1,2,3"); /* voxel 1,2,1 or 1,2,2 */
    HAS(" from 1,2,");
    CHECK_INT(execute(interp, "measure 1,2,3 99,2,3"), ERR_INPUT);
    CHECK_INT(execute(interp, "measure 1,2,3"), ERR_USAGE);
    CHECK_INT(interp->acknowledged, 0); /* nothing is recorded */
}

/* Count the columns of the line of labels in an answer's chart. */
static size_t columns_of_labels(const char *text)
{
    const char *at = strstr(text, "labels |");
    return at ? strcspn(at + 8, "\n") : 0;
}

STORY(a_profile_has_the_voxels_of_a_stroke)
{
    struct interpreter interp;
    char line[96];
    begin_with_scene(&interp);
    must(&interp, "profile 0,0,0 11,5,9 values=yes");
    const struct session *session = interp.session;
    CHECK_INT(columns_of_labels(buf_text(&reply.text)), 12);
    HAS("labels |............\n");
    for (uint32_t i = 0; i <= 11; i++) {
        int64_t at[3];
        paint_step(at, (const uint32_t[]){0, 0, 0}, (const uint32_t[]){11, 5, 9}, i, 11);
        const uint32_t cell =
            grid_cell(&session->scene->grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
        snprintf(line, sizeof line, " mm  %d,%d,%d  %u  no seed reaches it\n", (int)at[0],
                 (int)at[1], (int)at[2], session->scene->cell[cell].intensity);
        HAS(line);
    }
    HAS("12 voxels; values ");
    must(&interp, "seed 1,1,1 2; seed 10,9,9 12; run; profile 0,0,0 11,10,9");
    HAS("labels |2");
    HAS("+\n");
    must(&interp, "profile 3,3,3 3,3,3");
    HAS("1 voxel; values ");
    CHECK_INT(columns_of_labels(buf_text(&reply.text)), 1);
    interpreter_release(&interp);
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:400x9x9; profile 0,4,4 399,4,4");
    CHECK_INT(columns_of_labels(buf_text(&reply.text)), CHART_COLUMNS);
    HAS("400 voxels, 6.2 in a column; values ");
    interpreter_release(&interp);
}

SCENE_STORY(a_histogram_counts_each_voxel_once)
{
    static uint32_t count[UINT16_MAX + 1];
    struct histogram h;
    struct geometry geometry = {.slope = -2, .intercept = 100};
    uint64_t random = 3;
    for (int window = 0; window < 3; window++) {
        static const char *const line[] = {"window auto", "window 20 70", "window 500 900"};
        must(interp, line[window]);
        histogram_of_session(&h, interp->session);
        uint64_t sum = h.below + h.above;
        for (unsigned i = 0; i < h.bins; i++)
            sum += h.bin[i];
        CHECK_INT(sum, interp->session->scene->grid.voxels);
        CHECK_INT(h.voxels, interp->session->scene->grid.voxels);
        must(interp, "info");
        HAS("histogram |");
        HAS("heights are square roots of counts");
    }
    for (int i = 0; i < 5000; i++)
        count[check_below(&random, 3000)]++;
    histogram_of_counts(&h, count, &geometry);
    CHECK(h.least < h.most); /* values fall as intensities rise */
    CHECK(h.bins <= HISTOGRAM_BINS && h.voxels == 5000);
    CHECK(h.below > 0 && h.below < 50 && h.above < 75);
}
