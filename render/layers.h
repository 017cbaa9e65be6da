/*
 * Layers: what each pixel shows where some of the objects are translucent.
 *
 * Along the ray of a pixel the shown voxels form runs of one label. The face by which the ray comes
 * into a run is a layer of the pixel: its depth is the crossing there, its label and opacity are
 * those of the run. Faces that a ray leaves by are none, so an object is as dense as its front. Nor
 * is there one where the ray has left a run of the label at most LAYERS_GAP voxels before: a ray
 * along a surface comes in and out of the cubes of its steps, and would draw them as a mesh. A
 * pixel holds its nearest LAYERS_MOST translucent layers that lie before the first opaque one, and
 * that one: however many surfaces are before it, an opaque object is seen. Keys of faces never tie
 * (render/view.h), so the layers are a function of what is shown and of the view; splatting the
 * faces in whatever order, walking the rays and repairing former layers give the same.
 *
 * Where a voxel is large, from look 4 on, layers are refined: they are where the smooth surface of
 * each object is (render/refine.h). The rendition is projected as if all objects were opaque, and
 * from its maps of cubes on each ray is walked through the scene, as the tile that it belongs to is
 * shaded (layers_refine). So these layers too are a function of what is shown and of the view.
 *
 * Colour. Each layer is shaded as the one surface of an opaque picture would be, with the normal
 * that the object has by itself. From the nearest on it takes its share of the light that is left;
 * shares of squared colours add up, which is near to what light does, until less than a 256th is
 * left, which goes to the last. What is left at the end is alpha, and the colour is that of what
 * was added alone: it is not multiplied by alpha.
 *
 * Depth, voxel, label and normal of the pixel are those of the layer that has the largest share,
 * the nearest of several: what is seen best there. Behind a pale shell that is what is in it.
 */
#ifndef RENDER_LAYERS_H
#define RENDER_LAYERS_H

#include "render/rendition.h"

struct seams;

enum {
    LAYERS_MOST = 8,
    LAYERS_GAP = 4, /* voxels, at most 7 */
};

struct layers {
    struct seams *seams;    /* borrowed; of the border that is shown */
    bool are_refined;       /* and made of maps of cubes, tile by tile, as tiles are shaded */
    uint32_t width, height; /* 0 where there is no memory yet */

    /* [height][width]: the first opaque layer; DEPTH_NONE, CELL_NONE and 0 where there is none */
    int64_t *last_depth;
    uint32_t *last_cell;
    uint8_t *last_label;

    /* [height][width][LAYERS_MOST]: the nearest translucent ones, from the nearest on; those beyond
     * the opaque one do not count */
    uint8_t *count; /* [height][width] */
    int64_t *depth;
    uint32_t *cell;
    uint8_t *label;

    struct rendition pass; /* one layer of a tile, to be shaded; its `layers` are these */
    uint8_t *root;         /* of squares, to the nearest */
};

/* A new one is zeroed. */
void layers_release(struct layers *layers);
size_t layers_bytes(const struct layers *layers);

/* To be called before a rendition is made of what a border shows: where an object is translucent,
 * the rendition takes these layers, which are its own from now on; else it has none. Both outlive
 * it, and so do the seams, which are made those of the border. They are refined where the border
 * has a skin and `are_refined` says so. ERR_MEMORY. */
enum err layers_take(struct layers *layers, struct rendition *rendition,
                     const struct border *border, struct seams *seams, bool are_refined,
                     struct fault *fault);

/* Whether a rendition has layers, and they are what is projected. */
static inline bool layers_are_projected(const struct rendition *rendition)
{
    return rendition->layers && !rendition->layers->are_refined;
}

/* Those of the rows of the rendition from one on, to be splatted into; borrows the maps. */
struct layers layers_rows(const struct layers *layers, uint32_t top);

/* Nothing is seen, and all is to be shaded. */
void layers_clear(struct rendition *rendition);

/* Of the four ways (render/projection.h), where a rendition has layers that are projected: scene
 * projection; border projection; the ray of a pixel; and the incremental image, which is false
 * where layers are to be made anew, since all has changed or there was no memory. */
void layers_splat_scene(struct rendition *rendition, const struct camera *camera,
                        const struct border *border);
void layers_splat_border(struct task *task, struct rendition *rendition,
                         const struct camera *camera, const struct border *border);
void layers_walk(struct layers *layers, const struct camera *camera, const struct border *border,
                 size_t pixel);
bool layers_follow(struct rendition *rendition, const struct camera *camera,
                   const struct border *border, const struct changes *changes,
                   struct shade_reach reach);

/* ---- layers of a pixel ---- */

void layers_put_none(struct layers *layers, size_t pixel);

struct layer {
    int64_t depth;
    uint32_t cell;
    uint8_t label; /* 0: the pixel has no layer of that number */
};

/* From the nearest on, number 0, to the opaque one, which is the last. */
struct layer layers_at(const struct layers *layers, size_t pixel, unsigned number);

/* One more: the opaque one, if it is nearer than that so far, or one of the others. */
void layers_put(struct layers *layers, size_t pixel, int64_t depth, uint32_t cell, uint8_t label,
                bool is_opaque);

/* ---- shading ---- */

/* Depths, voxels and labels of the pixels of a footprint, which is a tile; true where none of them
 * shows anything. */
bool layers_pick(struct rendition *rendition, const struct border *border, struct footprint tile);

/* A tile in the making. */
struct blend {
    struct layers *layers;
    const struct border *border;
    struct footprint tile;
    unsigned number;              /* of the next layer */
    tile_mask shown, goes_on;     /* pixels of which something is seen, and those with more of it */
    uint32_t left[TILE * TILE];   /* of the light of each pixel, of 2^16 */
    uint32_t sum[TILE * TILE][3]; /* of shares of squares */
};

/* Labels of the tile are made. */
void blend_begin(struct blend *blend, struct rendition *rendition, const struct border *border,
                 struct footprint tile);
/* Puts the next layer into layers->pass, and gives back which pixels have one, for the caller to
 * shade them; none after the last. */
tile_mask blend_next(struct blend *blend);
/* After that: adds the colours, and takes the normal where it is the pixel's. */
void blend_add(struct blend *blend, struct rendition *rendition);
void blend_end(const struct blend *blend, struct rendition *rendition);

#endif
