/* SPDX-License-Identifier: MIT */
/* Creases: where two objects touch, each is shaded as if it were alone. */
#include "interpreting.h"

#include "tests/check_main.h"
#include "tests/random_commands.h"
#include "tests/stage.h"

static void draw(struct stage *s, struct rendition *out)
{
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    CHECK(rendition_init(out, s->view.width, s->view.height, NULL) == OK);
    stage_render(s, out, project_border);
}

static const int16_t *normal_at(const struct rendition *r, size_t pixel)
{
    return r->normal + 4 * pixel;
}

/* ---- each object by itself ---- */

/* Adjacent blocks of four labels, some of them cut open. */
static void stage_at_random(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 4 + check_below(random, 36);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    for (size_t i = 0; i < s->scene->grid.cells; i++)
        s->scene->cell[i].intensity = (uint16_t)check_below(random, 4000);
    for (int i = 0; i < 30; i++) {
        const struct grid *grid = &s->scene->grid;
        const uint8_t label = (uint8_t)check_below(random, 5);
        uint32_t from[3], end[3];
        for (int a = 0; a < 3; a++) {
            from[a] = check_below(random, size[a]);
            end[a] = from[a] + 1 + check_below(random, size[a] - from[a]);
        }
        for (uint32_t z = from[2]; z < end[2]; z++)
            for (uint32_t y = from[1]; y < end[1]; y++)
                for (uint32_t x = from[0]; x < end[0]; x++)
                    s->scene->cell[grid_cell(grid, x, y, z)].label = label;
    }
    if (check_below(random, 2))
        s->border.cut.last[check_below(random, 3)] = check_below(random, size[0]);
    s->shader.window[1] = 4000;
    border_recount(&s->border);
    stage_look_at_random(s, random);
    memset(s->border.opacity, BORDER_OPAQUE, sizeof s->border.opacity);
    s->look.mode = check_below(random, 3) < 2 ? SHADE_SURFACE : SHADE_CUBES;
    s->look.creases = 1;
    s->look.samples = 1; /* where other objects share a pixel, no sample represents them all */
    s->view.width = s->view.height = 90;
    s->view.zoom = 1000 + check_below(random, 2000);
}

static void show_alone(struct stage *s, int label)
{
    for (int other = 1; other < 256; other++)
        s->border.visible[other] = label == 0 || other == label;
    border_recount(&s->border);
}

/* Check that a pixel that shows the same point in both has the same normal, and that none is behind
 * the point that the object shows alone. Return the number of equal pixels. */
static size_t compare(const struct rendition *all, const struct rendition *alone, bool *agree)
{
    size_t same = 0;
    for (size_t i = 0; i < (size_t)all->width * all->height; i++) {
        *agree = *agree && all->depth[i] <= alone->depth[i] &&
                 (all->label[i] != alone->label[i] || all->depth[i] == alone->depth[i]);
        if (alone->cell[i] == CELL_NONE || all->cell[i] != alone->cell[i] ||
            all->depth[i] != alone->depth[i])
            continue;
        same++;
        *agree = *agree && memcmp(normal_at(all, i), normal_at(alone, i), 4 * sizeof(int16_t)) == 0;
    }
    return same;
}

STORY(an_object_among_others_has_the_normals_that_it_has_alone)
{
    size_t same = 0;
    for (unsigned number = 0; number < check_scaled(100) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        struct rendition all, alone;
        bool agree = true;
        stage_at_random(&s, &random);
        draw(&s, &all);
        for (int label = 1; label < 5; label++) {
            show_alone(&s, label);
            draw(&s, &alone);
            same += compare(&all, &alone, &agree);
            rendition_release(&alone);
        }
        show_alone(&s, 0);
        draw(&s, &alone);
        CHECK(rendition_digest(&all) == rendition_digest(&alone));
        CHECK_WITH(agree, "number %u: mode %d", number, (int)s.look.mode);
        rendition_release(&alone);
        rendition_release(&all);
    }
    CHECK(same > 1000);
}

/* ---- a crease ---- */

STORY(there_is_a_crease_where_two_objects_touch_and_nowhere_else)
{
    OWNED(stage_release) struct stage s;
    OWNED(rendition_release) struct rendition smooth, creased;
    /* A wall whose halves are two objects, seen from the front. */
    CHECK(stage_init(&s, (uint32_t[]){40, 20, 40}, 6, NULL) == OK);
    for (uint32_t z = 0; z < 40; z++)
        for (uint32_t y = 0; y < 10; y++)
            for (uint32_t x = 0; x < 40; x++)
                s.scene->cell[grid_cell(&s.scene->grid, x, y, z)].label = x < 20 ? 1 : 2;
    border_recount(&s.border);
    CHECK(view_by_name("front", s.view.angle));
    s.view.width = s.view.height = 40;
    s.view.zoom = 1000;
    draw(&s, &smooth);
    s.look.creases = 1;
    draw(&s, &creased);
    for (uint32_t x = 8; x < 32; x++) {
        const size_t pixel = 20 * 40 + x;
        const int across = normal_at(&creased, pixel)[0], far = x < 20 ? 19 - (int)x : (int)x - 20;
        CHECK_INT(normal_at(&smooth, pixel)[0], 0);
        if (far > 8) {
            CHECK(smooth.depth[pixel] == creased.depth[pixel]);
            CHECK_INT(across, 0);
        }
        if (far < 2) /* it faces the other one */
            CHECK(creased.label[pixel] == 1 ? across > 4000 : across < -4000);
    }
}

/* ---- in a session ---- */

static uint64_t digest_after(struct interpreter *interp, const char *lines)
{
    must(interp, lines);
    return rendition_digest(session_frame(interp->session));
}

BEGUN_STORY(creases_follow_each_edit_of_a_session, begin_interpreter)
{
    uint64_t random = 3;
    must(interp, "open synth:geom:40x40x40; auto on; size 90 90; zoom 2; view 30 20; "
                 "shade surface creases=yes ao=50");
    for (int i = 0; i < 40 && check_failures == 0; i++) {
        char line[80];
        random_command(line, sizeof line, "seed X,Y,Z <5> radius=3", (const uint32_t[]){40, 40, 40},
                       &random);
        must(interp, i % 5 == 4 ? "undo" : line);
        if (i % 10 == 6)
            must(interp, i % 20 == 6 ? "clip axial 0-20" : "clip none");
        const uint64_t updated = digest_after(interp, "render mode=ii");
        CHECK_INT(digest_after(interp, i % 2 ? "render mode=ray" : "render mode=sp"), updated);
    }
}
