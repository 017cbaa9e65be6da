/* SPDX-License-Identifier: MIT */
/* Writes the workload that all workers share: workload FOLDER SCENE ATLAS 8|16.
 *
 * The scene must have 8 bits, which some peers order fastest. With 16 bits, its intensities are
 * multiplied by WIDEN, and a hash of the place is added that is below WIDEN, so that the gradient
 * has many values. The gradient is that of `weight morph` over 6 neighbours. The first markers are
 * the regions of the atlas, each shrunk by three rounds, and the air: voxels darker than DARK that
 * lie in no region, shrunk likewise, as label 0.
 *
 * Each further set has one correction more, a ball of seeds. The third and the seventh lie where
 * two regions meet, and have the label of the region on the other side: they move a border between
 * dense markers. The others lie in the head where there is no region, and have the number of the
 * edit as label: they claim what no marker was near. A ball takes the place of markers it covers.
 *
 *     FOLDER/size             "X Y Z BITS"
 *     FOLDER/gradient.u16     two bytes per voxel, x fastest
 *     FOLDER/markers-N.u8     after N edits, 0..EDITS: label + 1, or 0 where there is no marker */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "engine/weight.h"
#include "session/map.h"
#include "session/seed_file.h"

enum { EDITS = 8, ROUNDS = 3, DARK = 20, WIDEN = 97 };

/* Squares of the radii of balls, in turn: 179 and 203 voxels. */
static const int ball_square[2] = {12, 13};
enum { BALL_REACH = 3 };

struct workload {
    const char *folder;
    unsigned factor; /* of the intensities */
    struct scene *scene;
    struct volume image, atlas;
    uint16_t *region; /* the atlas, which seeds_from_map works over */
    bool *dark;
    uint8_t *marker; /* all [voxels] */
};

static enum err save(const struct workload *work, const char *name, const void *bytes,
                     size_t length, struct fault *fault)
{
    OWNED(buf_release) struct buf path = {0};
    buf_printf(&path, "%s/%s", work->folder, name);
    return path.failed ? fault_memory(fault, "a path")
                       : file_write(buf_text(&path), bytes, length, FILE_REPLACE, fault);
}

static enum err save_gradient(const struct workload *work, struct fault *fault)
{
    const struct grid *grid = &work->scene->grid;
    uint16_t *gradient = mem_array(grid->voxels, sizeof *gradient), *next = gradient;
    if (!gradient)
        return fault_memory(fault, "a gradient");
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                *next++ = work->scene->cell[c].weight;
        }
    const size_t bytes = grid->voxels * sizeof *gradient;
    enum err err = save(work, "gradient.u16", gradient, bytes, fault);
    free(gradient);
    return err;
}

/* Plants the regions of a map, shrunk: each as a label of its number, or all as `label`. */
static enum err mark(struct workload *work, struct volume *map, const char *what, int label,
                     struct fault *fault)
{
    const struct grid *grid = &work->scene->grid;
    const struct region_choice choice = {1, 254, NULL, label, ROUNDS, 0, 0};
    struct region_tally tally;
    OWNED(seeds_release) struct seeds seeds = {0};
    enum err err = seeds_from_map(&seeds, &tally, map, grid, &choice, NULL, fault);
    if (err)
        return err;
    for (size_t i = 0; i < seeds.count; i++)
        work->marker[grid_voxel(grid, seeds.edit[i].cell)] = (uint8_t)(seeds.edit[i].label + 1);
    printf("%s=%u %s_voxels=%zu ", what, tally.regions, what, seeds.count);
    return OK;
}

static enum err mark_air(struct workload *work, struct fault *fault)
{
    struct volume air = work->image; /* its intensities are of no use any more */
    for (size_t i = 0; i < work->scene->grid.voxels; i++)
        air.intensity[i] = work->dark[i] && work->region[i] == 0;
    air.geometry.slope = 1;
    air.geometry.intercept = 0;
    return mark(work, &air, "air", 0, fault);
}

/* ---- edits ---- */

/* The marker of a ball about this voxel, or 0 where it is no place for an edit of this number. */
static uint8_t marker_for(const struct workload *work, int edit, size_t voxel)
{
    const uint32_t *size = work->scene->grid.size;
    const size_t step[3] = {1, size[0], (size_t)size[0] * size[1]};
    const uint16_t own = work->region[voxel];
    if (edit % 4 != 3)
        return own == 0 && !work->dark[voxel] ? (uint8_t)(edit + 1) : 0;
    for (int a = 0; own && a < 3; a++) {
        const uint16_t other = work->region[voxel + step[a]];
        if (other && other != own)
            return (uint8_t)(other + 1);
    }
    return 0;
}

static void mark_ball(struct workload *work, const uint32_t at[3], int square, uint8_t marker)
{
    const uint32_t *size = work->scene->grid.size;
    for (int z = -BALL_REACH; z <= BALL_REACH; z++)
        for (int y = -BALL_REACH; y <= BALL_REACH; y++)
            for (int x = -BALL_REACH; x <= BALL_REACH; x++)
                if (x * x + y * y + z * z <= square)
                    work->marker[((size_t)((int)at[2] + z) * size[1] + (size_t)((int)at[1] + y)) *
                                     size[0] +
                                 (size_t)((int)at[0] + x)] = marker;
}

/* Draws voxels, the same in every run, until one is a place for this edit. */
static void mark_correction(struct workload *work, int edit)
{
    const uint32_t *size = work->scene->grid.size;
    for (uint64_t n = 0;; n++) {
        uint32_t at[3];
        for (unsigned a = 0; a < 3; a++)
            at[a] = BALL_REACH +
                    (uint32_t)(hash_mix_at((uint64_t)edit, 3 * n + a) % (size[a] - 2 * BALL_REACH));
        const size_t voxel = ((size_t)at[2] * size[1] + at[1]) * size[0] + at[0];
        const uint8_t marker = marker_for(work, edit, voxel);
        if (marker) {
            mark_ball(work, at, ball_square[edit % 2], marker);
            return;
        }
    }
}

/* ---- all of it ---- */

static enum err widen(struct workload *work, struct fault *fault)
{
    const size_t voxels = (size_t)work->image.size[0] * work->image.size[1] * work->image.size[2];
    for (size_t i = 0; i < voxels; i++) {
        uint16_t *intensity = work->image.intensity + i;
        if (*intensity > UINT8_MAX)
            return fault_set(fault, ERR_INPUT, "the scene has the intensity %u; expected 8 bits",
                             *intensity);
        *intensity = (uint16_t)(*intensity * work->factor + hash_place(i) % work->factor);
    }
    return OK;
}

static enum err make_scene(struct workload *work, const char *image, const char *atlas,
                           struct fault *fault)
{
    enum err err = volume_read(&work->image, image, NULL, NULL, fault);
    if (!err)
        err = volume_read(&work->atlas, atlas, NULL, NULL, fault);
    if (!err)
        err = widen(work, fault);
    if (!err)
        err = scene_new(&work->scene, work->image.size, work->image.intensity, NULL, fault);
    if (!err)
        err = map_check_size(work->atlas.size, &work->scene->grid, fault);
    if (err)
        return err;
    const size_t voxels = work->scene->grid.voxels;
    work->marker = mem_new(voxels);
    work->region = mem_array(voxels, sizeof *work->region);
    work->dark = mem_array(voxels, sizeof *work->dark);
    if (!work->marker || !work->region || !work->dark)
        return fault_memory(fault, "markers");
    memcpy(work->region, work->atlas.intensity, voxels * sizeof *work->region);
    for (size_t i = 0; i < voxels; i++)
        work->dark[i] = work->image.intensity[i] / work->factor < DARK;
    struct adjacency adjacency;
    adjacency_init(&adjacency, 6, &work->scene->grid);
    weight_compute(work->scene, &adjacency, &(struct weight_choice){WEIGHT_MORPH, 1},
                   &(struct weight_work){0});
    return OK;
}

static enum err make_workload(struct workload *work, struct fault *fault)
{
    printf("voxels=%zu ", work->scene->grid.voxels);
    char text[64];
    const uint32_t *size = work->scene->grid.size;
    const int length = snprintf(text, sizeof text, "%u %u %u %d\n", size[0], size[1], size[2],
                                work->factor > 1 ? 16 : 8);
    enum err err = save(work, "size", text, (size_t)length, fault);
    if (!err)
        err = save_gradient(work, fault);
    if (!err)
        err = mark(work, &work->atlas, "regions", LABEL_OWN, fault);
    if (!err)
        err = mark_air(work, fault);
    for (int edit = 0; !err && edit <= EDITS; edit++) {
        if (edit > 0)
            mark_correction(work, edit);
        char name[32];
        snprintf(name, sizeof name, "markers-%d.u8", edit);
        err = save(work, name, work->marker, work->scene->grid.voxels, fault);
    }
    printf("edits=%d\n", EDITS);
    return err;
}

int main(int argc, char **argv)
{
    struct workload work = {0};
    struct fault fault;
    if (argc != 5) {
        fprintf(stderr, "usage: workload FOLDER SCENE ATLAS 8|16\n");
        return err_exit_status(ERR_USAGE);
    }
    work.folder = argv[1];
    work.factor = strcmp(argv[4], "16") == 0 ? WIDEN : 1;
    enum err err = make_scene(&work, argv[2], argv[3], &fault);
    if (!err)
        err = make_workload(&work, &fault);
    if (err)
        fprintf(stderr, "workload: %s\n", fault.text);
    volume_release(&work.image);
    volume_release(&work.atlas);
    scene_free(work.scene);
    free(work.region);
    free(work.dark);
    free(work.marker);
    return err_exit_status(err);
}
