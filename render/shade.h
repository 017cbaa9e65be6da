/*
 * Shading: the colour of each pixel.
 *
 * It is a pure function of shown voxels, labels, intensities and depths near the pixel, and of
 * palette, look and view: shade_reach says how near. The incremental image relies on it. Where the
 * look has edges (render/edge.h), lines are drawn over the colours. A face where an object was cut
 * open (render/cut.h) shows the scene, in grey tinted with the object's colour.
 */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H

#include <stdbool.h>

#include "base/team.h"
#include "render/field.h"
#include "render/normal.h"
#include "render/occlusion.h"
#include "render/palette.h"
#include "render/rendition.h"
#include "render/seams.h"

enum { SHADE_SAMPLES_MOST = 4, LIGHT_PITCH_MOST = 90000 };

/* Looks have numbers: what is drawn under one stays as it is, so that images that were made under
 * it can be made again. A session draws under that of its journal's semantics. From look 2 on
 * surfaces are smooth; from look 3 on most of their pixels lie in patches (render/patch.h), and
 * pits and rims of cuts are looked at closely (render/refine.h); from look 4 on one sample stands
 * for a pixel where a patch shows one object, blocks of tiles are patches, and layers of
 * translucent objects are smooth too where voxels are large (render/layers.h). */
enum { LOOK_FIRST = 1, LOOK_SECOND, LOOK_THIRD, LOOK_PRESENT };

struct look {
    uint32_t number; /* LOOK_FIRST..LOOK_PRESENT */
    enum shade_mode mode;
    int32_t light[2]; /* where it comes from, thousandths of a degree: yaw to the viewer's right,
                         pitch above him; 0, 0 is from where he stands */
    uint32_t cue_percent; /* how much darker the far end of the scene is, 0..100 */
    uint32_t edges;       /* 0 or 1; all of a look is 32 bits wide, so looks are compared whole */
    uint32_t samples;     /* a pixel is the mean of samples x samples: 1, 2 or 4 */
    uint32_t creases;     /* 0 or 1: whether each object has normals of its own, so that a crease is
                             seen where two touch; translucent ones always have */
    uint32_t ao_percent;  /* of ambient occlusion (render/occlusion.h), 0..100; of no consequence
                             where something is translucent */
};

/* Surface; the light over the viewer's left shoulder. */
struct look look_default(uint32_t number);

/* Whether it shows surfaces between voxel centres (render/refine.h), for which a border has a skin:
 * what is not of cubes, from look 2 on. What the border has no skin for is shown as cubes, and so
 * are translucent objects where their layers are not refined. */
bool look_is_refined(const struct look *look);
bool shade_refines(const struct look *look, const struct camera *camera,
                   const struct border *border);
/* Whether layers are refined where objects are translucent and the border has a skin. */
bool shade_refines_layers(const struct look *look, const struct camera *camera);

/* What shading stores between one picture and the next, so that the next is made faster; each
 * thread has its own. */
struct shader_part {
    struct field shown, scene;
    bool has_shown, has_scene;
};
struct shader {
    int32_t window[2]; /* to be set where something is cut: the intensities that are black and
                          white on faces cut open; they differ, and either may be the greater */
    struct team *team; /* to be set: the threads that share the work, or NULL */
    struct shader_part part[TEAM_MOST];
    struct seams seams;   /* for layers (render/layers.h) and creases */
    struct bricks bricks; /* for ambient occlusion */
};

/* Frees what is stored; the shader, whose window and team stay, may be used again. A new one is
 * zeroed. */
void shader_release(struct shader *shader);
size_t shader_bytes(const struct shader *shader);

/* How far colours depend on what is around. */
struct shade_reach shade_reach(const struct look *look, const struct camera *camera);

/* Shades every stale tile and marks it shaded or empty, or such that one sample stands for each
 * pixel. ERR_MEMORY, with tiles still stale. Where the look is refined and was not before, or the
 * other way round, all tiles are stale. With several samples a pixel, what is seen of empty tiles
 * is for rendition_reduce to make. */
enum err shade(struct rendition *rendition, const struct camera *camera,
               const struct border *border, const struct palette *palette, const struct look *look,
               struct shader *shader, struct fault *fault);

/* The same in two steps, for the caller who has threads of his own: first what `threads` of them
 * need, which may be ERR_MEMORY. Then thread `number` shades tiles of a rendition of its own, from
 * row `first` of tiles to before row `end`, and only looks at the others; it ends early where the
 * watch has stopped, but does not poll it. */
enum err shader_prepare(struct shader *shader, unsigned threads, const struct camera *camera,
                        const struct border *border, const struct look *look, struct fault *fault);
void shade_rows(struct rendition *rendition, uint32_t first, uint32_t end,
                const struct camera *camera, const struct border *border,
                const struct palette *palette, const struct look *look, struct shader *shader,
                unsigned number);

#endif
