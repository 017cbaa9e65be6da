/* SPDX-License-Identifier: MIT */
/*
 * Fields of relaxation that are kept, so that after an edit those alone are made anew which it may
 * have changed.
 *
 * A field follows from where its label lies, from the seeds and the region of interest in its box
 * and right beside it, from the intensities there, and from the numbers of sweeps and steps.
 * All of these are kept as they were, and compared: so nobody has to tell what an edit has changed,
 * and a field that is kept is the one that would be made.
 *
 * Of a field, chunks are kept that may have moved (relax_field_next). All of them together take as
 * much memory as the scene's cells at most; what is beyond that is made each time.
 */
#ifndef ENGINE_RELAX_H
#define ENGINE_RELAX_H

#include "engine/finish.h"

/*
 * The field of a label in relaxation, which engine/relax.h explains.
 *
 * Most of a field never moves: voxels far from the border have neighbours of their own value, and
 * where the scene has an edge on the border, what moves rounds to nothing. So rows are divided into
 * chunks of RELAX_CHUNK voxels, half of them of either parity, and in a half-sweep a chunk is
 * looked at only where one of its own values or of those beside them moved when it was their turn:
 * all others would stay. Of a field some third is looked at. What a chunk needs beside its values,
 * the weights, is worked out when it is looked at first.
 *
 * Sets of voxels, and of chunks, are bits of 64-bit words.
 */

enum { RELAX_ONE = 1 << 20, RELAX_CHUNK = 16 };

/* {0} has no memory yet; what it has then serves fields one after another. */
struct relax_field {
    const struct scene *scene;
    const uint8_t *label; /* of the scene, as finish_work has them, */
    uint8_t which;        /* and the label whose field this is */
    struct team *team;    /* NULL where several fields are made side by side */
    unsigned worker;      /* the number of the team's first thread, which is not 0 there */
    bool shows;           /* between sweeps, what the watch wants shown */
    uint32_t scale;       /* 2^16 greys for a difference of one intensity */
    uint32_t reach; /* steps from the border to the last voxels that move, 1..FINISH_BAND_MOST */
    struct finish_box box;
    uint32_t size[3];   /* of the box */
    size_t rows;        /* stored: those of the box, and a rim */
    size_t words;       /* of a row of voxels: bit x + 2 is that of x; four chunks a word */
    size_t chunk_words; /* of a row of chunks */
    void *memory;       /* of all that follows */
    size_t bytes;
    uint32_t *count;       /* [65536]: voxels of the band by their intensity */
    uint64_t *inside;      /* [rows][words]: voxels of the label, */
    uint64_t *band, *near; /* of the band, and of that and a step further */
    uint64_t *busy;        /* [size[2]]: rows of a plane that were looked at of late */
    uint8_t *stirs[2];     /* by parity [rows]: whether a chunk has moved when its turn was last */
    uint64_t *moved[2];    /* by parity [rows][chunk_words]: when it was looked at last, */
    uint64_t *spills[2];   /* with a voxel beside the next chunk of the row, */
    uint64_t *may[2];      /* at all, */
    uint64_t *known[2];    /* and whether it has been: its weights are there, */
    uint32_t *slot[2];     /* [rows][chunks] in this slot */
    int32_t *u[2];         /* [rows][chunks][RELAX_CHUNK / 2]: values */
    struct relax_weights *weights;
    uint32_t slots;                    /* that are taken */
    const struct relax_stored *stored; /* what is read, of a field that was made before; or NULL */
};

/* A field as it is read, with what follows it: bits of chunks that may have moved, how many of them
 * there are before each row, and their values, even voxels first. */
struct relax_stored {
    size_t bytes;
    struct finish_box box;
    uint64_t *known;  /* [rows][chunk_words] */
    uint32_t *before; /* [rows] */
    int32_t (*value)[RELAX_CHUNK];
};

/* Has memory for the field of a label that lies in `around`. ERR_MEMORY; then it holds none. */
enum err relax_field_begin(struct relax_field *field, const struct finish_work *work, uint8_t which,
                           const struct finish_box *around, uint32_t reach, struct fault *fault);
void relax_field_release(struct relax_field *field);

/* Makes the field, and does so many sweeps, each of which moves even voxels, then odd ones; by the
 * field's team. Of no use where the scene's watch has stopped it. */
void relax_field_make(struct relax_field *field, uint32_t sweeps);

/* Some voxels of a row that hang together: value[i] is that of x + i, from the first corner. */
struct relax_part {
    size_t chunk; /* to go on with; 0 to begin with */
    uint32_t x, count;
    int32_t value[RELAX_CHUNK];
};

/* The next part of a row whose values may have moved; false where there is none. All other voxels
 * of the scene are as they were at first: RELAX_ONE in the label, 0 elsewhere. */
bool relax_field_next(const struct relax_field *field, uint32_t y, uint32_t z,
                      struct relax_part *part);

/* Stores a field that was made, in at most so many bytes (NULL: no memory, or it takes more), which
 * mem_pages_free frees; and has one read again, alone, which was. */
struct relax_stored *relax_field_store(const struct relax_field *field, size_t most);
void relax_field_read(struct relax_field *field, const struct finish_work *work, uint8_t which,
                      const struct relax_stored *stored);

/* Whether a voxel of the scene has never been looked at: it is as it was at first, and would be
 * were it a seed. */
bool relax_field_rests(const struct relax_field *field, uint32_t x, uint32_t y, uint32_t z);

/* {0} has kept nothing yet. It is of one scene, whose intensities stay. */
struct relax_kept {
    size_t cells, bytes, most; /* taken for fields, and how many may be */
    uint8_t *label, *stays;    /* [cells]: what fields are of; flags of cells that matter */
    uint32_t sweeps, reach;
    struct relax_stored *field[256]; /* NULL: not kept */
};

size_t relax_kept_memory(const struct relax_kept *kept);
void relax_kept_release(struct relax_kept *kept);

/*
 * Relaxation: the step that lets labels settle on the edges of the scene (engine/finish.h).
 *
 * Each label but 0 has a field; that of label 0 is what all others leave of RELAX_ONE, or nothing.
 * A voxel of some band takes the label of the greatest, of several its own if that is one of them,
 * or the smallest. So a few fields are made at a time, and of each voxel only the best so far is
 * kept; and only where some field has moved, since else the label's own is RELAX_ONE, and stays.
 *
 * The field of a label lies in a box around it. Each voxel has a value u, RELAX_ONE in the label
 * and 0 elsewhere at first. Those of the *band* move: voxels from which at most `reach` steps
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
 * RELAX_ONE - u; 1536/1024 is over-relaxation by 24/16. c(n) is the conductance of a difference of
 * intensities, 65536 for none down to 1, by the number of greys in it: 255 greys are the range from
 * the 2nd to the 98th percentile of the intensities in the band, so an edge is one of this label,
 * whatever else is in the scene. Beyond the scene and outside the region of interest it is 0.
 *
 * Voxels of one parity have neighbours of the other alone: so within a half-sweep nothing depends
 * on order, and any number of threads, and any width of vectors, gives the same bits. Nor does it
 * matter how far another plane is, as long as those beside it are as far.
 */

/* Sees a field that is made, by the thread that began, while the others rest. */
typedef void relax_see(void *context, const struct relax_field *field);

/* Makes the field of a label, or FINISH_ALL_LABELS, as work->label has them, and has each seen, in
 * no order. ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err relax_each(const struct finish_work *work, unsigned label, uint32_t sweeps, uint32_t reach,
                    relax_see *see, void *context, struct fault *fault);

#endif
