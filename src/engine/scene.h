/* SPDX-License-Identifier: MIT */
/*
 * The scene: one array of 16-byte cells with all data of each voxel.
 *
 * All data that the forest reads and writes for a voxel share one quarter of a cache line: this
 * made a run from scratch two and a half times as fast as separate arrays.
 *
 * Invariants
 *   S1 a cell of the rim has key 0, label 0, weight 0, and the flag CELL_RIM, always: it declines
 *      every offer (none is below 0), makes none, and counts as background;
 *   S2 a voxel outside the region of interest (engine/roi.h) has key 0, label 0, no predecessor,
 *      and the flag CELL_OUTSIDE: the forest treats it like the rim;
 *   S3 intensity belongs to the scene, weight to engine/weight.h, the rest to engine/forest.h;
 *   S4 a scene is *plain* while `plain` holds its intensities: its cells are not initialised yet
 *      and must not be accessed. Cells are eight times as large, and opening a scene does not need
 *      them.
 */
#ifndef ENGINE_SCENE_H
#define ENGINE_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/hash.h"
#include "base/team.h"
#include "base/watch.h"
#include "engine/grid.h"

/*
 * The key of a voxel: (cost, hops, root) from the highest bits down, compared as one integer.
 *
 * cost 0..65535 is the f_max path cost, hops the steps since the cost last rose, root the cell of
 * the seed. A path that ends in s offers its neighbour key_extend(key(s), w), which is always above
 * key(s): that alone makes the forest unique (engine/forest.h).
 */

/* Greater than all keys: no seed reaches the voxel. */
#define KEY_NONE UINT64_MAX

/* The largest hops, which no key of a finished forest has: no hop can be added. */
enum { KEY_HOPS_LIMIT = 65535 };

static inline uint64_t key_make(uint32_t cost, uint32_t hops, uint32_t root)
{
    return (uint64_t)cost << 48 | (uint64_t)hops << 32 | root;
}
static inline uint32_t key_cost(uint64_t key)
{
    return (uint32_t)(key >> 48);
}
static inline uint32_t key_hops(uint64_t key)
{
    return (uint32_t)(key >> 32) & 0xFFFF;
}
static inline uint32_t key_root(uint64_t key)
{
    return (uint32_t)key;
}
/* (cost, hops) as one number: keys of one level never offer below their own level. */
static inline uint32_t key_level(uint64_t key)
{
    return (uint32_t)(key >> 32);
}

/* The least key of a level; KEY_NONE beyond the last level. */
static inline uint64_t key_level_begin(uint64_t level)
{
    return level > UINT32_MAX ? KEY_NONE : level << 32;
}

/* The parts of key_extend: one hop more at the same cost (KEY_NONE if hops are exhausted, so that
 * the order stays strict), a rise to weight w, and the greater of two keys. */
static inline uint64_t key_hop(uint64_t key)
{
    return key_hops(key) == KEY_HOPS_LIMIT ? KEY_NONE : key + (UINT64_C(1) << 32);
}
static inline uint64_t key_rise(uint32_t w, uint32_t root)
{
    return key_make(w, 0, root);
}
static inline uint64_t key_greater(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Offer of a voxel with `key` to a neighbour of weight w: (w, 0, root) if w is above the cost, else
 * one hop more. The former is the greater key exactly in that case, so no branch is needed. */
static inline uint64_t key_extend(uint64_t key, uint32_t w)
{
    return key_greater(key_rise(w, key_root(key)), key_hop(key));
}

enum cell_flag {
    CELL_SEED = 1,     /* a seed is planted here; label is its own */
    CELL_QUEUED = 2,   /* in the queue at the level of its key */
    CELL_CLEARED = 4,  /* has just lost its tree */
    CELL_TOUCHED = 8,  /* has changed in this edit and has no final key yet */
    CELL_RIM = 16,     /* not a voxel */
    CELL_OUTSIDE = 32, /* a voxel outside the region of interest */
    CELL_RAISED = 64,  /* lost its predecessor's offer; others may offer a better one */
};

enum { DIRECTION_NONE = 255 };

struct cell {
    uint64_t key;
    uint16_t weight; /* w of every arc into this voxel, under ARC_TARGET (engine/weight.h) */
    uint16_t intensity;
    union {
        struct {
            uint8_t label;        /* label of the root; 0: background, or no seed reaches it */
            uint8_t direction;    /* from predecessor to here, in the adjacency; or none */
            uint8_t flags;        /* enum cell_flag */
            uint8_t former_label; /* former label of a touched voxel; else 0 */
        };
        uint32_t state; /* these four as one word, to be copied as a whole; not to be interpreted */
    };
};

/* Compose a state from its parts. */
static inline uint32_t cell_state(uint8_t label, uint8_t direction, uint8_t flags)
{
    const struct cell cell = {.label = label, .direction = direction, .flags = flags};
    return cell.state;
}
static inline uint8_t cell_state_direction(uint32_t state)
{
    const struct cell cell = {.state = state};
    return cell.direction;
}

/* Store the label of a cell that is about to change, unless it has changed in this edit already. */
static inline void cell_touch(struct cell *cell)
{
    if (!(cell->flags & CELL_TOUCHED))
        cell->former_label = cell->label;
    cell->flags |= CELL_TOUCHED;
}

/* True if a tree holds the cell: its key is neither KEY_NONE nor the 0 of S1 and S2. */
static inline bool cell_is_reached(const struct cell *cell)
{
    return cell->key + 1 > 1;
}

/*
 * Channels: further intensities of each voxel, as of another sequence or phase.
 *
 * The intensities of one channel, which is shown, are in the cells; each other channel has an
 * array. scene_swap_channel exchanges two. The weight of a voxel is the greatest of all channels,
 * each scaled by its percentage (engine/weight.h), and relaxation sees the strongest edge
 * (engine/relax.h): so nothing but pictures and figures depends on the channel that is shown.
 */
enum { CHANNELS_MOST = 7, PERCENT_MOST = 1000 };
struct channel {
    uint16_t *intensity; /* [grid.cells], 0 in the rim */
    uint32_t percent;    /* 0..PERCENT_MOST, scales its weights; 0: it only is shown */
};

struct scene {
    struct grid grid;
    struct cell *cell;                     /* [grid.cells] */
    struct channel channel[CHANNELS_MOST]; /* borrowed; of channels that are not in the cells */
    unsigned channels;
    unsigned shown;         /* the channel in the cells, 0 for the first; if it is another,
                               channel[shown - 1] has the first one's intensities */
    uint32_t percent;       /* as above, for the channel in the cells */
    uint16_t *plain;        /* S4: [z][y][x], owned; else NULL */
    uint32_t spacing_nm[3]; /* between voxel centres along x, y, z */
    int8_t world_axis[3]; /* the world axis along which each voxel axis runs, and its direction: */
    int8_t world_sign[3]; /* world 0 is to the patient's Right, 1 Anterior, 2 Superior */
    bool sides_unknown;   /* no direction of the axes is known: pictures name no sides */
    bool spacing_unknown; /* the spacing is 1 mm because it is unknown; pictures show no lengths */
    struct watch *watch;  /* watches, and may stop, work on the whole scene; or NULL */
};

/* Intensity of a voxel in a channel, 0 for the first, whichever is shown. */
static inline uint16_t scene_intensity(const struct scene *scene, unsigned channel, uint32_t cell)
{
    return channel == scene->shown
               ? scene->cell[cell].intensity
               : scene->channel[(channel ? channel : scene->shown) - 1].intensity[cell];
}

/* Create a scene of unreached voxels with these intensities [z][y][x] (NULL: 0), spacing 1 mm, and
 * the world's axes. ERR_INPUT, ERR_LIMIT (grid_init), ERR_MEMORY; ERR_CANCELLED by the watch, or
 * NULL. The caller frees it; *scene is NULL after an error, here and below. */
enum err scene_new(struct scene **scene, const uint32_t size[3], const uint16_t *intensity,
                   struct watch *watch, struct fault *fault);
/* Create a plain scene of these intensities, which were allocated by mem_array and belong to the
 * scene unless an error is returned. */
enum err scene_new_plain(struct scene **scene, const uint32_t size[3], uint16_t *intensity,
                         struct watch *watch, struct fault *fault);
void scene_free(struct scene *scene);

/* Initialise the cells of a plain scene, by a team and under its watch; if stopped, the scene stays
 * plain. `weigh` computes the weights of a row, so that each cell is written once; NULL: 0. */
typedef void scene_weigh_row(void *context, unsigned worker, uint32_t y, uint32_t z,
                             uint16_t *weight);
void scene_make_cells(struct scene *scene, struct team *team, scene_weigh_row *weigh,
                      void *context);

/* Exchange the intensities in the cells, which must be made, and those of scene->channel[channel],
 * with their percentages. */
void scene_swap_channel(struct scene *scene, unsigned channel, struct team *team);

/* Start a walk over the rows of a scene under its watch (engine/grid.h): over all rows (team NULL,
 * worker 0), or by each worker of a team over its slab. */
static inline struct grid_walk scene_walk(const struct scene *scene, const char *what,
                                          const struct team *team, unsigned worker)
{
    const struct slab slab = grid_slab(&scene->grid, worker, team_size(team));
    return grid_walk(&scene->grid, scene->watch, what, slab, worker);
}

/* Prefetch cells for a walk that has reached `cell`. Virtual machines do not prefetch far enough
 * ahead: the digest of ch2 needs 9 ms instead of 22. */
static inline void scene_fetch_ahead(const struct scene *scene, size_t cell)
{
    enum { AHEAD = 128 };
    __builtin_prefetch(
        (const char *)((uintptr_t)scene->cell + (cell + AHEAD) * sizeof(struct cell)));
}

/* Histogram of the intensities of all voxels, or, in a large scene, of every n-th row: enough for
 * percentiles. `team` may be NULL; one thread is used if memory is short. */
void intensities_count(uint32_t count[UINT16_MAX + 1], const struct scene *scene,
                       struct team *team);

/* Two percentiles in thousandths: the highest intensity with at most `low` of the voxels below it,
 * and the highest with fewer than `high` below it; {65535, 0} for an empty histogram. */
void intensities_range(int32_t range[2], const uint32_t count[UINT16_MAX + 1], uint64_t low,
                       uint64_t high);

/*
 * Interpolate some axes of `base` to 2n - 1 voxels: `doubled` has bit a set for axis a. Voxels at
 * whole steps equal those of the base; a voxel at half steps is the mean, halves rounded up, of the
 * 2, 4 or 8 base voxels around it. The spacing of these axes is halved, half a nanometre rounded
 * up; voxel 0,0,0 keeps its place. The result has no seeds, no weights and no channels.
 */
enum err scene_new_interpolated(struct scene **scene, const struct scene *base, unsigned doubled,
                                struct watch *watch, struct fault *fault);

/* Size of the interpolated scene. */
void scene_interpolated_size(uint32_t out[3], const uint32_t size[3], unsigned doubled);

/*
 * The paper's synthetic scene "geom", 200x200x100 voxels of 8 bits: blocks, balls, a torus and a
 * tube of several intensities in a graded field with fixed noise; the same on every machine.
 *
 * scene_new_geom interpolates one or more axes, as above. scene_new_geom_of fills a grid of any
 * size instead: the centre of each voxel, to an eighth of a voxel of the base, decides which solid
 * contains it, and each voxel has its own noise. At 200x200x100 it is the base itself. The scene is
 * computed row by row, with memory for one row.
 */
extern const uint32_t geom_size[3];
enum err scene_new_geom(struct scene **scene, unsigned doubled, struct watch *watch,
                        struct fault *fault);
enum err scene_new_geom_of(struct scene **scene, const uint32_t size[3], struct watch *watch,
                           struct fault *fault);

/* Digest: a 64-bit sum over sizes, spacing, axes and every intensity. Detects errors, not
 * forgery. */
uint64_t scene_digest(const struct scene *scene);

/*
 * Proof: SHA-256 over the same data, as 64 digits and a NUL: three sizes and three spacings in
 * nanometres as 32 bits each, then a byte for each axis (2 * world axis + 1 if it runs the other
 * way) and one zero byte, then the intensities, x fastest, as 16 bits; all little-endian. "" if the
 * watch stopped it.
 */
void scene_proof(char out[SHA256_HEX], const struct scene *scene);

/* Compute both at the same time, by a team. */
void scene_identify(uint64_t *digest, char proof[SHA256_HEX], const struct scene *scene,
                    struct team *team);

#endif
