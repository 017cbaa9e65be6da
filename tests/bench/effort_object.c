/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_object.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "engine/components.h"
#include "image/volume.h"
#include "tests/bench/times.h"

enum { CROP_MOST = 80, REGIONS_MOST = 4000, MARGIN = 16 };

const char *const effort_group_name[EFFORT_GROUPS] = {"tuned", "other", "ct"};

struct row {
    const char *name;
    enum effort_group group;
    const char *scene, *map; /* NULL: the phantom that `regions` is the number of */
    const char *regions;     /* in the map, modulo `modulo` unless that is 0 */
    uint16_t modulo;
    uint8_t closed, reduced; /* number of times */
    uint8_t margin;          /* around a crop */
};

#define AAL      "aal.nii.gz"
#define HARVARD  "HarvardOxford-cort-maxprob-thr0-1mm.nii.gz"
#define JHU      "JHU-WhiteMatter-labels-1mm.nii.gz"
#define CH2      "ch2.nii.gz"
#define MACAQUE  "inia19-t1-brain.nii.gz"
#define NEURO    "inia19-NeuroMaps.nii.gz"
#define TUNED(n) n, GROUP_TUNED
#define OTHER(n) n, GROUP_OTHER
#define CT(n)    n, GROUP_CT

static const struct row row[] = {
    {TUNED("putamen"), CH2, AAL, "73", 0, 0, 0, MARGIN},
    {TUNED("thalamus"), CH2, AAL, "77", 0, 0, 0, MARGIN},
    {TUNED("caudate"), CH2, AAL, "71", 0, 0, 0, MARGIN},
    {TUNED("hippocampus"), CH2, AAL, "37", 0, 0, 0, MARGIN},
    {TUNED("cerebellum"), CH2, AAL, "91-116", 0, 0, 0, 12},
    {TUNED("cerebellum-2mm"), CH2, AAL, "91-116", 0, 0, 1, 12},
    {TUNED("m-putamen"), MACAQUE, NEURO, "98", 0, 0, 0, MARGIN},
    {TUNED("m-caudate"), MACAQUE, NEURO, "82", 0, 0, 0, MARGIN},
    {TUNED("m-thalamus"), MACAQUE, NEURO, "497", 0, 0, 0, MARGIN},
    {TUNED("m-white-matter"), MACAQUE, NEURO, "55,97,193", 0, 0, 1, 8},
    {TUNED("m-cerebellum"), MACAQUE, NEURO, "230-262", 1000, 2, 0, MARGIN},
    {TUNED("tube"), NULL, NULL, "0", 0, 0, 0, 0},
    {TUNED("textures"), NULL, NULL, "1", 0, 0, 0, 0},
    {TUNED("shells"), NULL, NULL, "2", 0, 0, 0, 0},

    {OTHER("insula"), CH2, AAL, "29", 0, 0, 0, MARGIN},
    {OTHER("amygdala"), CH2, AAL, "41", 0, 0, 0, MARGIN},
    {OTHER("pallidum"), CH2, AAL, "75", 0, 0, 0, MARGIN},
    {OTHER("calcarine"), CH2, AAL, "43", 0, 0, 0, MARGIN},
    {OTHER("vermis"), CH2, AAL, "109-116", 0, 0, 0, MARGIN},
    {OTHER("genu"), CH2, JHU, "3", 0, 0, 0, MARGIN},
    {OTHER("occipital-pole"), CH2, HARVARD, "48", 0, 0, 0, MARGIN},
    {OTHER("bet-thalamus"), "ch2bet.nii.gz", AAL, "78", 0, 0, 0, MARGIN},
    {OTHER("better-caudate"), "ch2better.nii.gz", AAL, "72", 0, 0, 1, MARGIN},
    {OTHER("m-2"), MACAQUE, NEURO, "2", 0, 0, 0, MARGIN},
    {OTHER("m-237"), MACAQUE, NEURO, "237", 0, 0, 0, MARGIN},
    {OTHER("m-151"), MACAQUE, NEURO, "151", 0, 0, 0, MARGIN},
    {OTHER("m-1054"), MACAQUE, NEURO, "1054", 0, 0, 0, MARGIN},
    {OTHER("m-10"), MACAQUE, NEURO, "10", 0, 0, 0, MARGIN},
    {OTHER("temporal-pole"), CH2, AAL, "87", 0, 0, 0, MARGIN},
    {OTHER("brain"), CH2, "ch2bet.nii.gz", "1-255", 0, 0, 0, MARGIN},
    {OTHER("m-1055"), MACAQUE, NEURO, "1055", 0, 0, 0, MARGIN},
    {OTHER("m-1193"), MACAQUE, NEURO, "1193", 0, 0, 0, MARGIN},
    {OTHER("m-124"), MACAQUE, NEURO, "124", 0, 0, 0, MARGIN},
    {OTHER("neck"), NULL, NULL, "3", 0, 0, 0, 0},
    {OTHER("fading"), NULL, NULL, "4", 0, 0, 0, 0},

    {CT("ct-liver"), NULL, NULL, "51", 0, 0, 0, 0},
    {CT("ct-kidney"), NULL, NULL, "52", 0, 0, 0, 0},
    {CT("ct-spleen"), NULL, NULL, "53", 0, 0, 0, 0},
    {CT("ct-aorta"), NULL, NULL, "54", 0, 0, 0, 0},
    {CT("ct-lesion"), NULL, NULL, "55", 0, 0, 0, 0},
    {CT("ct-vessel"), NULL, NULL, "56", 0, 0, 0, 0},
};
enum { ROWS = sizeof row / sizeof *row };

const char *effort_object_name(size_t number)
{
    return number < ROWS ? row[number].name : NULL;
}

enum effort_group effort_object_group(size_t number)
{
    return row[number].group;
}

/* ---- a scene and its truth, on the way ---- */

struct matter {
    uint32_t size[3];
    uint16_t *image;
    uint8_t *truth;
};

static size_t voxels_of(const uint32_t size[3])
{
    return (size_t)size[0] * size[1] * size[2];
}

static void matter_release(struct matter *m)
{
    free(m->image);
    free(m->truth);
    *m = (struct matter){0};
}

static struct matter matter_new(const uint32_t size[3])
{
    struct matter m = {.image = must_have(voxels_of(size) * sizeof *m.image),
                       .truth = must_have(voxels_of(size))};
    memcpy(m.size, size, sizeof m.size);
    return m;
}

/* ---- regions ---- */

static bool is_listed(const char *list, int64_t region)
{
    int64_t first, last;
    for (const char *at = list; scan_list_range(&at, 0, REGIONS_MOST, &first, &last);)
        if (region >= first && region <= last)
            return true;
    return false;
}

static void mark_regions(struct matter *m, const struct volume *scene, const struct volume *map,
                         const struct row *r)
{
    bool listed[REGIONS_MOST];
    for (int i = 0; i < REGIONS_MOST; i++)
        listed[i] = i && is_listed(r->regions, r->modulo ? i % r->modulo : i);
    size_t voxel = 0;
    for (uint32_t z = 0; z < m->size[2]; z++)
        for (uint32_t y = 0; y < m->size[1]; y++)
            for (uint32_t x = 0; x < m->size[0]; x++, voxel++) {
                double mm[3];
                int64_t at[3];
                geometry_point(&scene->geometry, (const uint32_t[]){x, y, z}, mm);
                bool inside = geometry_voxel(&map->geometry, mm, at);
                for (int a = 0; a < 3; a++)
                    inside = inside && at[a] >= 0 && at[a] < map->size[a];
                if (!inside)
                    continue;
                const size_t place =
                    ((size_t)at[2] * map->size[1] + (size_t)at[1]) * map->size[0] + (size_t)at[0];
                const uint16_t region = map->intensity[place];
                m->truth[voxel] = region < REGIONS_MOST && listed[region];
            }
}

/* The truth grows, or shrinks, by the six faces; beyond the scene is what it is anyway. */
static void step_truth(struct matter *m, bool grows)
{
    const size_t n[3] = {m->size[0], m->size[1], m->size[2]};
    const size_t step[3] = {1, n[0], n[0] * n[1]}, voxels = voxels_of(m->size);
    uint8_t *next = must_have(voxels);
    memcpy(next, m->truth, voxels);
    for (size_t voxel = 0; voxel < voxels; voxel++)
        for (int a = 0; a < 3; a++) {
            const size_t i = voxel / step[a] % n[a];
            if ((i > 0 && m->truth[voxel - step[a]] == grows) ||
                (i + 1 < n[a] && m->truth[voxel + step[a]] == grows))
                next[voxel] = grows;
        }
    free(m->truth);
    m->truth = next;
}

static void read_volume(struct volume *out, const char *name, const struct interpreter *interp)
{
    OWNED(buf_release) struct buf path = {0};
    must(interpreter_find_file(interp, name, &path, &bench_fault));
    must(volume_read(out, buf_text(&path), NULL, NULL, &bench_fault));
    /* If a file has two different places, iftty uses neither; in these files the sform is right. */
    if (!geometry_has_place(&out->geometry) && out->geometry.sform.code)
        geometry_take_form(&out->geometry, ORIENTATION_SFORM);
}

static struct matter matter_read(const struct row *r, const struct interpreter *interp)
{
    OWNED(volume_release) struct volume scene = {0}, map = {0};
    read_volume(&scene, r->scene, interp);
    read_volume(&map, r->map, interp);
    struct matter m = matter_new(scene.size);
    memcpy(m.image, scene.intensity, voxels_of(m.size) * sizeof *m.image);
    mark_regions(&m, &scene, &map, r);
    for (int i = 0; i < 2 * r->closed; i++)
        step_truth(&m, i < r->closed);
    return m;
}

/* ---- reduced, cut out, stretched ---- */

/* Blocks at the end of an axis that are not full are left out. */
static void reduce(struct matter *m)
{
    const uint32_t size[3] = {m->size[0] / 2, m->size[1] / 2, m->size[2] / 2};
    struct matter half = matter_new(size);
    size_t voxel = 0;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++, voxel++) {
                uint32_t sum = 0, inside = 0;
                for (uint32_t i = 0; i < 8; i++) {
                    const size_t place =
                        ((size_t)(2 * z + (i >> 2)) * m->size[1] + 2 * y + (i >> 1 & 1)) *
                            m->size[0] +
                        2 * x + (i & 1);
                    sum += m->image[place];
                    inside += m->truth[place];
                }
                half.image[voxel] = (uint16_t)((sum + 4) / 8);
                half.truth[voxel] = inside >= 4;
            }
    matter_release(m);
    *m = half;
}

/* Keep the largest component of the truth, and find the box around it. */
static void keep_largest(struct matter *m, uint32_t first[3], uint32_t last[3])
{
    OWNED(components_release) struct components pieces = {0};
    struct grid grid;
    must(grid_init(&grid, m->size, &bench_fault));
    OWNED(mem_release) uint8_t *label = must_have(grid.cells);
    for (size_t r = 0; r < (size_t)grid.size[1] * grid.size[2]; r++)
        memcpy(
            label +
                grid_row(&grid, (uint32_t)(r % grid.size[1]), (uint32_t)(r / grid.size[1])).first,
            m->truth + r * grid.size[0], grid.size[0]);
    must(components_find(&pieces, &grid, label, NULL, &bench_fault));
    memset(m->truth, 0, grid.voxels);
    for (int a = 0; a < 3; a++)
        first[a] = UINT32_MAX, last[a] = 0;
    const struct component *best = NULL;
    for (size_t i = 0; i < pieces.count; i++)
        if (pieces.item[i].label && (!best || pieces.item[i].voxels > best->voxels))
            best = &pieces.item[i];
    if (!best)
        must(fault_set(&bench_fault, ERR_INPUT, "no voxel of the scene is in these regions"));
    for (uint32_t r = best->run; r != RUN_NONE; r = pieces.run[r].next) {
        const struct place p = grid_place(&grid, pieces.run[r].first);
        const uint32_t length = pieces.run[r].end - pieces.run[r].first;
        memset(m->truth + grid_voxel(&grid, pieces.run[r].first), 1, length);
        const uint32_t low[3] = {p.x, p.y, p.z}, high[3] = {p.x + length - 1, p.y, p.z};
        for (int a = 0; a < 3; a++) {
            first[a] = low[a] < first[a] ? low[a] : first[a];
            last[a] = high[a] > last[a] ? high[a] : last[a];
        }
    }
}

static void crop(struct matter *m, const uint32_t first[3], const uint32_t last[3])
{
    const uint32_t size[3] = {last[0] - first[0] + 1, last[1] - first[1] + 1,
                              last[2] - first[2] + 1};
    struct matter part = matter_new(size);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++) {
            const size_t from =
                ((size_t)(first[2] + z) * m->size[1] + first[1] + y) * m->size[0] + first[0];
            const size_t to = ((size_t)z * size[1] + y) * size[0];
            memcpy(part.image + to, m->image + from, size[0] * sizeof *part.image);
            memcpy(part.truth + to, m->truth + from, size[0]);
        }
    matter_release(m);
    *m = part;
}

/* The box and the margin, within the scene; whether no side of that is longer than it may be. */
static bool add_margin(uint32_t first[3], uint32_t last[3], const struct row *r,
                       const uint32_t size[3])
{
    bool fits = true;
    for (int a = 0; a < 3; a++) {
        first[a] = first[a] > r->margin ? first[a] - r->margin : 0;
        last[a] = last[a] + r->margin < size[a] ? last[a] + r->margin : size[a] - 1;
        fits = fits && last[a] - first[a] < CROP_MOST;
    }
    return fits || r->group == GROUP_TUNED;
}

static void cut_out(struct matter *m, const struct row *r)
{
    uint32_t first[3], last[3];
    for (int i = 0; i < r->reduced; i++)
        reduce(m);
    keep_largest(m, first, last);
    while (!add_margin(first, last, r, m->size)) {
        reduce(m);
        keep_largest(m, first, last);
    }
    crop(m, first, last);
}

/* The lowest value that more than `share` voxels do not exceed. */
static uint32_t quantile(const uint32_t *count, size_t share)
{
    uint32_t value = 0;
    for (size_t sum = count[0]; sum <= share && value < UINT16_MAX;)
        sum += count[++value];
    return value;
}

static void stretch(uint8_t *out, const uint16_t *image, size_t voxels)
{
    uint32_t count[UINT16_MAX + 1] = {0};
    for (size_t i = 0; i < voxels; i++)
        count[image[i]]++;
    const uint32_t low = quantile(count, voxels / 1000);
    const uint32_t high = quantile(count, voxels - 1 - voxels / 1000);
    const uint32_t range = high > low ? high - low : 1;
    for (size_t i = 0; i < voxels; i++) {
        const uint32_t value = image[i] < low ? low : image[i] > high ? high : image[i];
        out[i] = (uint8_t)(((value - low) * 255 + range / 2) / range);
    }
}

/* ---- an object ---- */

static struct matter matter_make(const struct row *r, const struct interpreter *interp)
{
    const uint32_t side[3] = {PHANTOM_SIDE, PHANTOM_SIDE, PHANTOM_SIDE};
    struct matter m = r->scene ? matter_read(r, interp) : matter_new(side);
    if (r->scene)
        cut_out(&m, r);
    else
        phantom_fill((enum phantom)(r->regions[0] - '0'),
                     r->group == GROUP_CT ? r->regions[1] - '0' : 0, m.image, m.truth);
    return m;
}

void effort_object_load(struct effort_object *object, size_t number,
                        const struct interpreter *interp)
{
    struct matter m = matter_make(&row[number], interp);
    *object = (struct effort_object){.name = row[number].name,
                                     .group = row[number].group,
                                     .voxels = voxels_of(m.size),
                                     .truth = m.truth};
    memcpy(object->size, m.size, sizeof m.size);
    object->image = must_have(object->voxels);
    stretch(object->image, m.image, object->voxels);
    if (object->group == GROUP_CT)
        object->hounsfield = m.image;
    else
        free(m.image);
}

void effort_object_release(struct effort_object *object)
{
    free(object->image);
    free(object->truth);
    free(object->hounsfield);
    *object = (struct effort_object){0};
}

static void image_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct effort_object *object = context;
    const size_t first = ((size_t)z * object->size[1] + y) * object->size[0];
    if (object->hounsfield)
        memcpy(values, object->hounsfield + first, object->size[0] * sizeof *object->hounsfield);
    else
        memcpy(values, object->image + first, object->size[0]);
}

enum err effort_object_save(const struct effort_object *object, const char *path,
                            struct fault *fault)
{
    static const double spacing_mm[3] = {1, 1, 1};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    geometry_place_plain(&geometry, spacing_mm);
    const struct volume_map map = {.size = object->size,
                                   .geometry = &geometry,
                                   .type = object->hounsfield ? VOXEL_UINT16 : VOXEL_UINT8,
                                   .description = "an object",
                                   .row = image_row,
                                   .context = (void *)(uintptr_t)object};
    return volume_write(path, FILE_REPLACE, &map, NULL, fault);
}
