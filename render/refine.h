/*
 * Refining: from the first cube of a pixel's ray to the surface between voxel centres.
 *
 * The surface is where the field of shown voxels comes inside (render/field.h), between centres
 * too, so that it is curved where cubes are not. It lies in solid voxels (render/border.h) alone:
 * from the first cube on, the ray is followed in steps of half a voxel, or of a whole one where
 * that cannot be too far, until it is inside in a solid voxel. Where
 * the whole is cut open, the ray is inside at once, on the face of a cube. In a pit it is inside as
 * it comes to its first solid voxel, since the ground there lies further out; from look 3 on it is
 * followed back to where it came inside, at most two voxels, and else seen at that face. Rims of
 * what is cut open are clean lines from look 3 on too.
 *
 * The ray may be followed to the surface of one label instead, through the voxels that have it and
 * their face neighbours, which are solid for it.
 *
 * So what is seen is a pure function of the map of cubes, of shown and solid voxels and of the
 * view: where the four ways agree in cubes, they agree in what is seen.
 */
#ifndef RENDER_REFINE_H
#define RENDER_REFINE_H

#include "render/field.h"
#include "render/rendition.h"

enum {
    REFINE_POINT_BITS = 12,     /* points are in 2^-12 voxels from the centre of voxel 0 */
    REFINE_REACH = FIELD_REACH, /* what is seen of a pixel depends on what is shown at most so many
                                   steps along each axis away from voxels on its ray, */
    MEETING_REACH = 2,          /* and its label, on labels of voxels at most so many away */
};

/* In the low two bits of a depth: not on a face that is cut open. */
enum { REFINE_WITHIN = 3 };

enum refine_pace { REFINE_QUARTER, REFINE_HALF, REFINE_WHOLE };

/* The labels for which a voxel is solid: its own, and those of its neighbours. */
struct solid {
    uint32_t cell; /* 0: of none */
    uint8_t labels, label[7];
};

/* Those of voxels that were looked at: rays side by side meet the same. A new one is zeroed. */
enum { REFINE_SOLIDS = 1024 };
struct solids {
    struct solid at[REFINE_SOLIDS];
};

struct refiner {
    const struct camera *camera;
    const struct border *border;
    struct locator locator[3];
    int64_t depth[REFINE_WHOLE + 1]; /* crossings of such a part of a voxel, */
    int32_t step[REFINE_WHOLE + 1]
                [3];            /* and that along each axis, in 2^-REFINE_POINT_BITS voxels */
    bool cuts;                  /* something is cut away */
    bool is_close;              /* from look 3 on: pits, and rims of what is cut open */
    bool meets;                 /* where objects meet, a point's voxel is that of meeting_voxel */
    struct field_reader *shown; /* the one reader that there is of that field */
    uint8_t label;              /* whose surface is looked for; 0: of all that is shown */
    const struct seams *seams;  /* to be set where it is of a label: the border's, */
    struct solids *solids;      /* and these, of one thread */
};

/* The border outlives this; `shown`, of the field of shown voxels, is for the caller to set. */
void refiner_init(struct refiner *refiner, const struct camera *camera,
                  const struct border *border);

/* Whether a ray that comes into a cube at this depth comes from one that is cut away. */
bool refine_is_cut_open(const struct refiner *refiner, int64_t depth, uint32_t cell);

/* The shown voxel that the point of a surface belongs to which a pixel shows at this depth, by
 * meeting_voxel where objects meet. Where the point lies in no solid voxel, CELL_NONE, or if it
 * `goes_on` that of the next solid voxel within two voxels on the ray. */
struct refine_owner {
    bool meets, goes_on;
};
uint32_t refine_voxel_at(const struct refiner *refiner, int64_t depth, uint32_t x, uint32_t y,
                         struct refine_owner how);
/* Whether that is to be looked at there. */
bool refine_meets_at(const struct refiner *refiner, int64_t depth, uint32_t x, uint32_t y);

struct solid refine_solid(const struct refiner *refiner, uint32_t cell);

/* Follows the ray of a pixel from where it comes into a cube that is solid for a label: true where
 * it comes inside of what has the label, at that depth and voxel; else to this depth there is
 * nothing of it. */
bool refine_label(struct refiner *refiner, uint8_t label, uint32_t x, uint32_t y, int64_t *depth,
                  uint32_t *cell);

/* The voxel with that label that a point of the label's surface belongs to, which a pixel shows at
 * this depth; CELL_NONE where no surface can lie. */
uint32_t refine_label_voxel(struct refiner *refiner, uint8_t label, int64_t depth, uint32_t x,
                            uint32_t y);

/* Where that ray, which is inside of what has the label at some point within a voxel or two of this
 * depth, or is not any more, leaves it: at most REFINE_END voxels further on. */
enum { REFINE_END = 4 };
int64_t refine_end(struct refiner *refiner, uint8_t label, uint32_t x, uint32_t y, int64_t depth);

/* A voxel's width along the ray, as a difference of depths. */
static inline int64_t refine_width(const struct refiner *refiner)
{
    return refiner->depth[REFINE_WHOLE];
}

/* Whether a pixel's ray is outside at one depth, and inside at another. */
bool refine_crosses(struct refiner *refiner, int64_t from, int64_t to, uint32_t x, uint32_t y);

/* Has what the pixels of a footprint will look at first come to the caches: voxels and blocks of
 * the field that lie beside each other in a picture lie far apart in memory. */
void refine_fetch(const struct refiner *refiner, const struct rendition *rendition,
                  struct footprint pixels);

/* What is seen of a pixel, whose maps of cubes are made. */
void refine_pixel(struct rendition *rendition, struct refiner *refiner, uint32_t x, uint32_t y);

/* ---- where objects meet ---- */

/* Which voxel a point of a surface shows, where several objects meet.
 *
 * By its own voxel alone, the line along which two objects meet runs along faces of voxels, and is
 * stairs where voxels are large. So shown voxels up to two steps away speak for their objects, the
 * more the nearer they are; the object that most is said for has the point, and of its voxels the
 * nearest is shown. A point between eight voxels of one object is that object's.
 *
 * The weight is that of two tents along the axes, of one step and of two, of which the former
 * counts three times as much: at the centre of a voxel its own object has the point, and what is as
 * small as a voxel stays.
 *
 * `own` is the point's own voxel, which is shown, and is given back where no other object has the
 * point. */
uint32_t meeting_voxel(const struct border *border, const int32_t point[3], uint32_t own);

#endif
