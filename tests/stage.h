/*
 * What stories of renditions share: a scene, its forest and border, and how they are looked at.
 *
 * The rendition takes memory where a story wants it to; stage_release gives it back with the rest,
 * also where stage_init failed halfway.
 */
#ifndef TESTS_STAGE_H
#define TESTS_STAGE_H

#include <string.h>

#include "render/border.h"
#include "engine/forest.h"
#include "render/layers.h"
#include "render/projection.h"
#include "render/rendition.h"
#include "render/shade.h"
#include "tests/check.h"

struct stage {
    struct scene *scene;
    struct forest *forest;
    struct border border;
    struct view view;
    struct camera camera;
    struct palette palette;
    struct look look;
    struct shader shader;
    struct rendition rendition;
    struct layers layers; /* that of the rendition, or of any other that a story has */
};

/* Takes the scene, with a forest of no seeds, in the view and look that a session begins with. */
static inline enum err stage_take(struct stage *s, struct scene *scene, unsigned adjacency,
                                  struct fault *why)
{
    *s = (struct stage){
        .scene = scene, .view = view_default(scene), .look = look_default(LOOK_PRESENT)};
    palette_default(&s->palette);
    const enum err err = forest_new(&s->forest, scene, adjacency, why);
    return err ? err : border_init(&s->border, scene, why);
}

/* The same for a new scene, all of it zero. */
static inline enum err stage_init(struct stage *s, const uint32_t size[3], unsigned adjacency,
                                  struct fault *why)
{
    struct scene *scene = NULL;
    *s = (struct stage){0};
    const enum err err = scene_new(&scene, size, why);
    return err ? err : stage_take(s, scene, adjacency, why);
}

/* The border as the look has it projected. */
static inline enum err stage_fit_border(struct stage *s)
{
    return border_set_skin(&s->border, look_is_refined(&s->look), NULL);
}

/* Half of the time, some of the labels are translucent. */
static inline void stage_opacities(struct stage *s, uint64_t *random)
{
    const bool translucent = check_below(random, 2);
    for (int label = 1; label < 256; label++)
        s->border.opacity[label] =
            (uint8_t)(translucent && check_below(random, 3) ? 1 + check_below(random, 100) : 100);
}

/* Half of the time, none. */
static inline uint32_t stage_occlusion(uint64_t *random)
{
    return check_below(random, 2) ? 1 + check_below(random, 100) : 0;
}

/* Any look, any angles, and any of so many modes of shading, the first ones. */
static inline void stage_look_at_random(struct stage *s, uint32_t modes, uint64_t *random)
{
    s->look.number = LOOK_FIRST + check_below(random, LOOK_PRESENT - LOOK_FIRST + 1);
    s->look.mode = (enum shade_mode)check_below(random, modes);
    s->look.edges = check_below(random, 2);
    s->look.samples = 1u << check_below(random, 3);
    s->look.ao_percent = stage_occlusion(random);
    s->look.creases = check_below(random, 2);
    stage_opacities(s, random);
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)check_below(random, VIEW_TURN);
}

/* All samples of a rendition that shading leaves out where it is to be reduced: those that another
 * one stands for, and those of tiles that show nothing. */
static inline void stage_fill(struct rendition *r, uint32_t samples)
{
    for (uint32_t y = 0; y < r->height; y++)
        for (uint32_t x = 0; x < r->width; x++) {
            const size_t here = (size_t)y * r->width + x;
            const uint8_t state = r->stale[(size_t)(y / TILE) * r->tiles_x + x / TILE];
            const size_t from = (size_t)(y / samples * samples + samples / 2) * r->width +
                                x / samples * samples + samples / 2;
            if (state == TILE_EMPTY)
                rendition_empty(r, here, 1);
            if (state != TILE_STANDS || from == here)
                continue;
            r->depth[here] = r->depth[from];
            r->cell[here] = r->cell[from];
            r->label[here] = r->label[from];
            memcpy(r->rgba + 4 * here, r->rgba + 4 * from, 4);
            memcpy(r->normal + 4 * here, r->normal + 4 * from, 4 * sizeof *r->normal);
        }
}

/* Has a rendition of what is shown the stage's layers where it needs them; the camera is made. */
static inline void stage_take_layers(struct stage *s, struct rendition *rendition)
{
    CHECK(stage_fit_border(s) == OK);
    CHECK(shade_take_layers(&s->shader, &s->layers, rendition, &s->camera, &s->border, &s->look,
                            NULL) == OK);
}

/* The stage's picture of what is shown, by its view. */
static inline void stage_draw(struct stage *s)
{
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    CHECK(rendition_init(&s->rendition, s->view.width, s->view.height, NULL) == OK);
    stage_take_layers(s, &s->rendition);
    splat_border(&s->rendition, &s->camera, &s->border);
    CHECK(shade(&s->rendition, &s->camera, &s->border, &s->palette, &s->look, &s->shader, NULL) ==
          OK);
    stage_fill(&s->rendition, s->look.samples);
}

static inline void stage_release(struct stage *s)
{
    rendition_release(&s->rendition);
    shader_release(&s->shader);
    layers_release(&s->layers);
    border_release(&s->border);
    forest_free(s->forest);
    scene_free(s->scene);
}

#endif
