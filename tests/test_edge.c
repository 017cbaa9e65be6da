/* SPDX-License-Identifier: MIT */
/* Edges: what has a line, on which side, and how strong it is for every number of samples. */
#include "tests/check_main.h"

#include <math.h>

#include "render/edge.h"
#include "tests/stage.h"

enum { SIDE = 61, PIXELS = 64 };

static void begin(struct stage *s)
{
    CHECK(stage_init(s, (uint32_t[]){SIDE, SIDE, SIDE}, 6, NULL) == OK);
    s->look.light[0] = s->look.light[1] = 0;
    s->look.cue_percent = 0;
    s->view.zoom = 1000;
}

/* Gives a label to all voxels for which `holds` is true. */
static void fill(struct stage *s, uint8_t label, bool (*holds)(int x, int y, int z))
{
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                if (holds(x, y, z))
                    s->scene
                        ->cell[grid_cell(&s->scene->grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)]
                        .label = label;
    border_recount(&s->border);
}

/* A picture of PIXELS a side, of samples x samples each, which the caller releases. */
static struct rendition draw(struct stage *s, uint32_t samples, bool edges)
{
    struct rendition out;
    const uint32_t zoom = s->view.zoom;
    rendition_release(&s->rendition);
    s->look.samples = samples;
    s->look.edges = edges;
    s->view.width = s->view.height = PIXELS * samples;
    s->view.zoom = zoom * samples;
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    CHECK(rendition_init(&s->rendition, PIXELS * samples, PIXELS * samples, NULL) == OK);
    CHECK(rendition_init(&out, PIXELS, PIXELS, NULL) == OK);
    stage_render(s, &s->rendition, project_border);
    rendition_reduce(&out, &s->rendition, samples, NULL);
    s->view.zoom = zoom;
    return out;
}

static int red_at(const struct rendition *r, uint32_t x, uint32_t y)
{
    return r->rgba[4 * ((size_t)y * r->width + x)];
}

/* The number of pixels of the last drawn samples that have a line of a kind, within `margin` pixels
 * of the middle. Each must be the same as when it is computed alone. */
static int count(const struct stage *s, enum edge kind, int margin)
{
    struct edges edges, alone;
    const struct rendition *r = &s->rendition;
    const int middle = (int)r->width / 2, reach = margin * (int)s->look.samples;
    int n = 0;
    edges_init(&edges, r, &s->camera, s->look.samples);
    for (int y = middle - reach; y < middle + reach; y++)
        for (int x = middle - reach; x < middle + reach; x++) {
            if (r->cell[(size_t)y * r->width + (size_t)x] == CELL_NONE)
                continue;
            const enum edge edge = edge_at(&edges, (uint32_t)x, (uint32_t)y);
            edges_init(&alone, r, &s->camera, s->look.samples);
            CHECK(edge == edge_at(&alone, (uint32_t)x, (uint32_t)y));
            n += edge == kind;
        }
    return n;
}

/* ---- shapes ---- */

static bool in_step(int x, int y, int z)
{
    return y <= (x < 30 ? 40 : 20) && z >= 0;
}
static bool in_ball(int x, int y, int z)
{
    const int d[3] = {x - 30, y - 30, z - 30};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= 25 * 25;
}
static bool in_slope(int x, int y, int z)
{
    return y <= 2 * x - 30 && z >= 0;
}
static bool in_roof(int x, int y, int z)
{
    return y <= 20 + abs(x - 30) && z >= 0;
}
static bool in_right(int x, int y, int z)
{
    return x >= 30 && y <= 20 && z >= 0;
}
static bool in_left(int x, int y, int z)
{
    return x < 30 && y <= 20 && z >= 0;
}

/* ---- how strong ---- */

/* The share that lines take of the squares of reds around the middle, which samples are averaged
 * by: pixels in all. */
static double taken(struct stage *s, uint32_t samples)
{
    OWNED(rendition_release)
    struct rendition plain = draw(s, samples, false), lined = draw(s, samples, true);
    double sum = 0;
    for (uint32_t y = 20; y < PIXELS - 20; y++)
        for (uint32_t x = 20; x < PIXELS - 20; x++)
            if (red_at(&plain, x, y))
                sum += 1 - pow((double)red_at(&lined, x, y) / red_at(&plain, x, y), 2);
    return sum;
}

/* Between two objects on one plane, which is not dark by itself, as rounded silhouettes are. */
STORY(a_line_is_as_strong_at_every_number_of_samples)
{
    OWNED(stage_release) struct stage s;
    begin(&s);
    fill(&s, 1, in_right);
    fill(&s, 2, in_left);
    memcpy(s.palette.rgb[2], s.palette.rgb[1], 3);
    for (int i = 0; i < 6; i++) {
        s.view.angle[0] = i * 3000, s.view.angle[2] = i * 13000;
        const double one = taken(&s, 1), two = taken(&s, 2), four = taken(&s, 4);
        if (!CHECK(one > 18 && fabs(two / one - 1) < 0.2 && fabs(four / one - 1) < 0.2))
            printf("# view %d: %.1f %.1f %.1f\n", i, one, two, four);
    }
}

/* Light outside, dark within: no background hides both. */
static void outline_shows(struct stage *s, uint32_t samples)
{
    OWNED(rendition_release)
    struct rendition plain = draw(s, samples, false), lined = draw(s, samples, true);
    const uint32_t width = PIXELS * samples;
    for (uint32_t y = width / 4; y < width * 3 / 4; y++) {
        uint32_t x = 0;
        while (s->rendition.rgba[4 * (y * width + x) + 3] == 0)
            x++;
        for (uint32_t i = 0; i < samples; i++) {
            CHECK(red_at(&s->rendition, x + i, y) > 200);
            CHECK(red_at(&s->rendition, x + samples + i, y) < 80);
        }
    }
    CHECK_INT(red_at(&lined, 20, 32), red_at(&plain, 20, 32));
}

STORY(an_outline_shows_against_black_and_against_white)
{
    OWNED(stage_release) struct stage s;
    begin(&s);
    fill(&s, 1, in_ball);
    for (uint32_t samples = 1; samples <= 4; samples *= 2)
        outline_shows(&s, samples);
}

/* ---- where ---- */

/* A line through all of 40 rows, one pixel wide. */
static void has_one_line(struct stage *s, uint32_t samples)
{
    OWNED(rendition_release) struct rendition out = draw(s, samples, true);
    const int dark = count(s, EDGE_DARK, 20), rows = 40 * (int)samples;
    CHECK_WITH(dark >= rows * (int)samples * 9 / 10 && dark <= rows * (int)samples * 11 / 10,
               "yaw %d, %u samples: %d pixels in %d rows", s->view.angle[0], samples, dark, rows);
}

STORY(what_hides_a_part_of_itself_has_a_line_and_so_has_a_fold)
{
    static const struct {
        bool (*holds)(int x, int y, int z);
        int32_t yaw;
    } shape[] = {{in_step, 0}, {in_step, 4000}, {in_roof, 0}, {in_roof, 9000}};
    for (size_t i = 0; i < sizeof shape / sizeof *shape; i++) {
        OWNED(stage_release) struct stage s;
        begin(&s);
        fill(&s, 1, shape[i].holds);
        s.view.angle[0] = shape[i].yaw;
        for (uint32_t samples = 1; samples <= 4; samples *= 2)
            has_one_line(&s, samples);
    }
}

STORY(objects_that_touch_have_one_line_between_them)
{
    OWNED(stage_release) struct stage s;
    begin(&s);
    fill(&s, 1, in_right);
    fill(&s, 2, in_left);
    for (int i = 0; i < 5; i++) {
        s.view.angle[0] = i * 4000;
        for (uint32_t samples = 1; samples <= 4; samples *= 2)
            has_one_line(&s, samples);
    }
}

STORY(the_background_is_behind_an_object_whatever_its_label)
{
    OWNED(stage_release) struct stage s;
    begin(&s);
    fill(&s, 1, in_ball);
    OWNED(rendition_release) struct rendition out = draw(&s, 1, true);
    const int lines[] = {count(&s, EDGE_DARK, 25), count(&s, EDGE_LIGHT, 25)};
    memset(s.rendition.label, 0, (size_t)s.rendition.width * s.rendition.height);
    CHECK_INT(count(&s, EDGE_DARK, 25), lines[0]);
    CHECK_INT(count(&s, EDGE_LIGHT, 25), lines[1]);
}

STORY(what_is_round_or_steep_has_no_line_but_its_outline)
{
    for (int shape = 0; shape < 2; shape++) {
        OWNED(stage_release) struct stage s;
        begin(&s);
        fill(&s, 1, shape ? in_slope : in_ball);
        for (int i = 0; i < 12; i++) {
            s.view.zoom = 1000 + 250 * (uint32_t)i;
            s.view.angle[0] = shape ? i * 1500 : i * 31000;
            s.view.angle[1] = i * (shape ? 2000 : 17000);
            for (uint32_t samples = 1; samples <= 2; samples++) {
                OWNED(rendition_release) struct rendition out = draw(&s, samples, true);
                const int margin = shape ? 8 : 16;
                if (!CHECK(count(&s, EDGE_DARK, margin) + count(&s, EDGE_LIGHT, margin) == 0))
                    printf("# shape %d view %d\n", shape, i);
            }
        }
    }
}
