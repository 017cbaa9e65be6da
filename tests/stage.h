/* SPDX-License-Identifier: MIT */
/* Data for stories about renditions: a scene, its forest and border, and the view.
 *
 * A story allocates the rendition if it needs one; stage_release frees it with the rest, also after
 * a failed stage_init. */
#ifndef TESTS_STAGE_H
#define TESTS_STAGE_H

#include "render/border.h"
#include "engine/forest.h"
#include "render/incremental.h"
#include "render/shade.h"
#include "render/layers.h"
#include "render/mesh.h"
#include "render/projection.h"
#include "render/rendition.h"
#include "tests/random.h"

struct stage {
    struct scene *scene;
    struct forest *forest;
    struct border border;
    struct mesh mesh; /* mesh of the border in the last picture */
    struct view view;
    struct camera camera;
    struct palette palette;
    struct look look;
    struct shader shader;
    struct rendition rendition;
    struct layers layers; /* layers of this rendition, or of another one in a story */
};

/* Own the scene, with a forest without seeds, in the initial view and look of a session. */
static inline enum err stage_take(struct stage *s, struct scene *scene, unsigned adjacency,
                                  struct fault *why)
{
    *s = (struct stage){.scene = scene, .view = view_default(scene), .look = look_default()};
    palette_default(&s->palette);
    const enum err err = forest_new(&s->forest, scene, adjacency, why);
    return err ? err : border_init(&s->border, scene, why);
}

/* The same for a new scene of zeros. */
static inline enum err stage_init(struct stage *s, const uint32_t size[3], unsigned adjacency,
                                  struct fault *why)
{
    struct scene *scene = NULL;
    *s = (struct stage){0};
    const enum err err = scene_new(&scene, size, NULL, NULL, why);
    return err ? err : stage_take(s, scene, adjacency, why);
}

/* Give the scene's axes one of the six orders, and the directions of three bits: 0 is +1. */
static inline void stage_turn(struct stage *s, unsigned order, unsigned backwards)
{
    static const int8_t axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                      {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int a = 0; a < 3; a++) {
        s->scene->world_axis[a] = axes[order % 6][a];
        s->scene->world_sign[a] = backwards >> a & 1 ? -1 : 1;
    }
}

/* The same at random, with spacings of 0.3 to 2.3 mm along half of the axes. */
static inline void stage_turn_at_random(struct stage *s, uint64_t *random)
{
    stage_turn(s, check_below(random, 6), check_below(random, 8));
    for (int a = 0; a < 3; a++)
        s->scene->spacing_nm[a] =
            check_below(random, 2) ? 1000000 : 300000 + check_below(random, 2000000);
}

/* Set label 1 where `holds` is true of the place, relative to the middle of the scene, in voxels; 0
 * elsewhere. */
typedef bool stage_shape(const double at[3]);
static inline void stage_put(struct stage *s, stage_shape *holds)
{
    const struct grid *grid = &s->scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                const double at[3] = {x - (grid->size[0] - 1) / 2.0, y - (grid->size[1] - 1) / 2.0,
                                      z - (grid->size[2] - 1) / 2.0};
                s->scene->cell[grid_cell(grid, x, y, z)].label = holds(at);
            }
    border_recount(&s->border);
}

/* Return the point that a pixel of the stage's picture shows, relative to the middle of the scene,
 * in mm. */
static inline void stage_point(const struct stage *s, size_t pixel, double out[3])
{
    const struct rendition *r = &s->rendition;
    for (int a = 0; a < 3; a++) {
        const int64_t x = (int64_t)(pixel % r->width), y = (int64_t)(pixel / r->width);
        const int64_t first = camera_crossing(&s->camera, a, 0, x, y);
        const double beyond =
            (double)((r->depth[pixel] & ~(int64_t)NUMBER_MASK) - first) / (double)s->camera.T[a];
        const double from_middle = beyond - s->scene->grid.size[a] / 2.0;
        out[a] = (s->camera.flip[a] ? -from_middle : from_middle) * s->scene->spacing_nm[a] / 1e6;
    }
}

static inline int stage_by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Edit the forest and update the border. */
static inline struct changes stage_edit(struct stage *s, const struct edit *batch, size_t count)
{
    CHECK(forest_edit(s->forest, batch, count, NULL) == OK);
    const struct changes changes = forest_changes(s->forest);
    border_update(&s->border, &changes);
    return changes;
}

/* Plant one seed, of background or of three labels. */
static inline struct changes stage_seed_at_random(struct stage *s, uint64_t *random)
{
    const struct edit seed = {random_voxel(&s->scene->grid, random),
                              (int16_t)check_below(random, 4), 0};
    return stage_edit(s, &seed, 1);
}

/* Plant seeds, and erase those whose trees contain a voxel: three edits at once. */
static inline struct changes stage_edit_at_random(struct stage *s, uint64_t *random)
{
    struct edit batch[3];
    for (int i = 0; i < 3; i++) {
        const uint32_t at = random_voxel(&s->scene->grid, random);
        batch[i] = (struct edit){at, (int16_t)((int)check_below(random, 5) - 1), 0};
        if (batch[i].label == EDIT_ERASE && cell_is_reached(&s->scene->cell[at]))
            batch[i].cell = key_root(s->scene->cell[at].key);
    }
    return stage_edit(s, batch, 3);
}

/* Make some of the labels translucent, half of the time. */
static inline void stage_opacities(struct stage *s, uint64_t *random)
{
    const bool translucent = check_below(random, 2);
    for (int label = 1; label < 256; label++)
        s->border.opacity[label] =
            (uint8_t)(translucent && check_below(random, 3) ? 1 + check_below(random, 100) : 100);
}

/* The plane through the centre of a voxel that keeps the side in direction `ahead`, which is along
 * voxel axes, of any length below 2^31, in a scene of this spacing. */
static inline struct cut_plane stage_plane_through(const struct scene *scene,
                                                   const uint32_t place[3], const int32_t ahead[3])
{
    int64_t into[3];
    for (int a = 0; a < 3; a++)
        into[a] = (int64_t)ahead[a] * scene->spacing_nm[a];
    return cut_plane_at(into, place, 0);
}

/* Return a strength of occlusion, 0 half of the time. */
static inline uint32_t stage_occlusion(uint64_t *random)
{
    return check_below(random, 2) ? 1 + check_below(random, 100) : 0;
}

/* Choose any look and any angles. */
static inline void stage_look_at_random(struct stage *s, uint64_t *random)
{
    s->look.mode = check_below(random, 4) == 1 ? SHADE_CUBES : SHADE_SURFACE;
    s->look.edges = check_below(random, 2);
    s->look.samples = 1u << check_below(random, 3);
    s->look.ao_percent = stage_occlusion(random);
    s->look.creases = check_below(random, 2);
    stage_opacities(s, random);
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)check_below(random, VIEW_TURN);
}

/* Fill the samples of empty tiles, which shading leaves to rendition_reduce. */
static inline void stage_fill(struct rendition *r)
{
    for (uint32_t y = 0; y < r->height; y++)
        for (uint32_t x = 0; x < r->width; x++)
            if (r->stale[(size_t)(y / TILE) * r->tiles_x + x / TILE] == TILE_EMPTY)
                rendition_empty(r, (size_t)y * r->width + x, 1);
}

/* Update the mesh, and add the layers of the stage to a rendition that needs them. */
static inline void stage_fit(struct stage *s, struct rendition *rendition)
{
    CHECK(mesh_update(&s->mesh, &s->border, shade_kind(&s->look), NULL, NULL, NULL) == OK);
    CHECK(layers_attach(&s->layers, rendition, &s->border, NULL) == OK);
}

/* Shade a rendition. */
static inline void stage_shade(struct stage *s, struct rendition *rendition)
{
    CHECK(shade(rendition, &s->camera, &s->mesh, &s->palette, &s->look, &s->shader, NULL) == OK);
    stage_fill(rendition);
}

/* Draw a complete picture; the camera is set. */
static inline void stage_render(struct stage *s, struct rendition *rendition, projection *project)
{
    stage_fit(s, rendition);
    project(rendition, &s->camera, &s->mesh);
    stage_shade(s, rendition);
}

/* Initialise renditions of samples and of the reduced picture, for the stage's view. */
static inline void stage_samples_init(struct stage *s, struct rendition *fine,
                                      struct rendition *out)
{
    CHECK(rendition_init(fine, s->view.width, s->view.height, NULL) == OK);
    CHECK(rendition_init(out, s->view.width / s->look.samples, s->view.height / s->look.samples,
                         NULL) == OK);
    stage_fit(s, fine);
}

static inline void stage_reduce(struct stage *s, struct rendition *fine, struct rendition *out)
{
    CHECK(shade(fine, &s->camera, &s->mesh, &s->palette, &s->look, &s->shader, NULL) == OK);
    rendition_reduce(out, fine, s->look.samples, s->shader.team);
}

/* Update the mesh and the pixels after an edit; the border is up to date. */
static inline void stage_follow(struct stage *s, struct rendition *rendition,
                                const struct changes *changes)
{
    mesh_note(&s->mesh, &s->border, changes);
    CHECK(incremental_image(rendition, &s->camera, &s->mesh, &s->border, &s->look, changes,
                            s->shader.team, NULL) == OK);
}

/* Draw the stage's picture by its view. */
static inline void stage_draw(struct stage *s)
{
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    CHECK(rendition_init(&s->rendition, s->view.width, s->view.height, NULL) == OK);
    stage_render(s, &s->rendition, project_border);
}

/* Whether two pictures have the same pixels; prints the first that differs. */
static inline bool stage_same_pixels(const struct rendition *a, const struct rendition *b,
                                     const char *what)
{
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            size_t p = (size_t)y * a->width + x;
            if (a->depth[p] == b->depth[p] && a->cell[p] == b->cell[p] &&
                a->label[p] == b->label[p] && memcmp(a->rgba + 4 * p, b->rgba + 4 * p, 4) == 0 &&
                memcmp(a->normal + 4 * p, b->normal + 4 * p, 4 * sizeof *a->normal) == 0)
                continue;
            printf("# %s: pixel %u,%u: depth %" PRId64 " %" PRId64 " cell %u %u label %u %u\n",
                   what, x, y, a->depth[p], b->depth[p], a->cell[p], b->cell[p], a->label[p],
                   b->label[p]);
            return false;
        }
    return true;
}

static inline void stage_release(struct stage *s)
{
    rendition_release(&s->rendition);
    shader_release(&s->shader);
    layers_release(&s->layers);
    mesh_release(&s->mesh);
    border_release(&s->border);
    forest_free(s->forest);
    scene_free(s->scene);
}

#endif
