/*
 * Relaxation: the step that lets labels settle on the edges of the scene (engine/finish.h).
 *
 * Each label but 0 has a field; that of label 0 is what all others leave of RELAX_ONE, or nothing.
 * A voxel of some band takes the label of the greatest, of several its own if that is one of them,
 * or the smallest. So one field is made at a time, and of each voxel only the best so far is kept.
 *
 * The field of a label lies in a box around it. Each voxel has a value u, RELAX_ONE in the label
 * and 0 elsewhere at first. Those of the *band* move: voxels from which at most RELAX_REACH steps
 * along the axes lead to one on the other side of the label's border. All others keep their value,
 * as do seeds and voxels outside the region of interest.
 *
 * In a half-sweep all voxels of one parity of x + y + z move, each to
 *
 *     u + round((sum over its six neighbours n of w(n) * (u(n) - u)) / 1024),  within 0..RELAX_ONE
 *
 *     w(n) = floor(c(n) * floor(1536 * 2^32 / (sum of c)) / 2^32)
 *
 * where halves round to the even one, so that the field of what is not the label would be exactly
 * RELAX_ONE - u; 1536/1024 is over-relaxation by 24/16. c(n) is what a difference of intensities
 * lets through, 65536 for none down to 1 (finish_relax.c); beyond the scene and outside the region
 * of interest it is 0.
 *
 * Voxels of one parity have neighbours of the other alone: so within a half-sweep nothing depends
 * on order, and any number of threads, and any width of vectors, gives the same bits. Nor does it
 * matter how far another plane is, as long as those beside it are as far.
 */
#ifndef ENGINE_FINISH_RELAX_H
#define ENGINE_FINISH_RELAX_H

#include "engine/finish.h"

enum { RELAX_ONE = 1 << 20, RELAX_REACH = 16 };

/* Intensities as 0..255: from where a thousandth of all voxels is darker to where one is brighter,
 * of every n-th row where the scene is large. */
struct relax_greys {
    uint8_t of[UINT16_MAX + 1];
};
void relax_find_greys(struct relax_greys *greys, const struct scene *scene, struct team *team);

struct relax_field {
    const struct scene *scene;
    struct finish_box box;
    uint32_t size[3]; /* of the box */
    uint8_t *far;     /* [z][y][x], rows padded: steps to the other side of the border, or many */
    size_t length, cells; /* of a stored row, which holds every other voxel; of all rows */
    int32_t *u[2];        /* by parity [cells]: rows (z, y) with a rim; see stored_at */
    uint16_t *w[2][6];    /* -z -y -x +x +y +z; 0 for voxels that stay */
    struct span *part[2]; /* [rows]: of a row as it is stored, what moves */
    size_t *moving;       /* [size[2] + 1]: voxels that move in the planes before */
};

/* The field of a label as work->label has it; `around` is where that lies. ERR_MEMORY; of no use
 * where the scene's watch has stopped it. */
enum err relax_field_init(struct relax_field *field, const struct finish_work *work, uint8_t which,
                          const struct finish_box *around, const struct relax_greys *greys,
                          struct fault *fault);
void relax_field_release(struct relax_field *field);

/* Does so many sweeps, each of which moves even voxels, then odd ones. */
void relax_field_sweep(struct relax_field *field, uint32_t sweeps, struct team *team);

/* Of a voxel of the box, counted from its first corner. */
int32_t relax_value(const struct relax_field *field, uint32_t x, uint32_t y, uint32_t z);

#endif
