/*
 * Shading: the colour of each pixel, by Phong's model, in integers.
 *
 * The point that a pixel shows lies on a face of a voxel's cube; its normal comes from one of
 *
 *   surface   the smoothed field of shown voxels (render/field.h): the direction in which it falls
 *   scene     the gradient of the scene's intensities, turned outward by the surface's normal,
 *             which is used where the scene is flat
 *   depth     the plane that fits the depths around the pixel best
 *
 * So a pixel's colour is a pure function of shown voxels, labels, intensities and depths near it,
 * and of palette, look and view: shade_reach says how near. The incremental image relies on it. The
 * light moves with the viewer. Pixels further away are a little darker. Where the look has edges, a
 * pixel is darkened beside which another object, or nothing, lies further back. A face where an
 * object was cut open (render/cut.h) shows the scene, in grey tinted with the object's colour.
 */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H

#include <stdbool.h>

#include "render/field.h"
#include "render/rendition.h"

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

/* Distinct colours, also for people who do not distinguish red from green, in turn. */
void palette_default(struct palette *palette);

/* Where normals come from, and what commands call it. */
#define SHADE_MODES "surface|scene|depth"
enum shade_mode { SHADE_SURFACE, SHADE_SCENE, SHADE_DEPTH };

enum { SHADE_SAMPLES_MOST = 4, LIGHT_PITCH_MOST = 90000 };

struct look {
    enum shade_mode mode;
    int32_t light[2]; /* where it comes from, thousandths of a degree: yaw to the viewer's right,
                         pitch above him; 0, 0 is from where he stands */
    uint32_t cue_percent; /* how much darker the far end of the scene is, 0..100 */
    uint32_t edges;       /* 0 or 1; all of a look is 32 bits wide, so looks are compared whole */
    uint32_t samples;     /* a pixel is the mean of samples x samples: 1, 2 or 4 */
};

/* Surface; the light over the viewer's left shoulder. */
struct look look_default(void);

/* What shading stores between one picture and the next, so that the next is made faster. */
struct shader {
    int32_t window[2]; /* to be set where something is cut: the intensities that are black and
                          white on faces cut open; they differ, and either may be the greater */
    struct field shown, scene;
    bool has_shown, has_scene;
};

/* Frees what is stored; the shader, whose window stays, may be used again. A new one is zeroed. */
void shader_release(struct shader *shader);
size_t shader_bytes(const struct shader *shader);

/* How far colours depend on what is around. */
struct shade_reach shade_reach(const struct look *look, const struct camera *camera);

/* Shades every stale tile and marks it fresh. ERR_MEMORY, with tiles still stale. */
enum err shade(struct rendition *rendition, const struct camera *camera,
               const struct border *border, const struct palette *palette, const struct look *look,
               struct shader *shader, struct fault *fault);

#endif
