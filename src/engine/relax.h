/* SPDX-License-Identifier: MIT */
/*
 * Stored fields of relaxation: after an edit, only the fields that it may have changed are
 * recomputed, and large ones only around the edit.
 *
 * A field depends on the voxels of its label, on the seeds and the region of interest in its box
 * and next to it, on the intensities there, and on the numbers of sweeps and steps. All of these
 * are stored and compared, so edits need not report their changes, and a stored field equals the
 * one that would be computed.
 *
 * A change spreads one voxel with each half-sweep, but most of it vanishes by rounding. So the
 * values of large fields are stored after each RELAX_CHECKPOINT half-sweeps: each group of
 * half-sweeps is repeated where its first values differ from before and as far as they can spread,
 * and the result is compared with the stored one. If an edit changes the scale of intensities or
 * half of the box, the field is recomputed.
 *
 * Only chunks that may have moved are stored (relax_field_next). All fields together use at most as
 * much memory as the scene's cells, and those with checkpoints half of it; fields beyond that are
 * recomputed each time.
 */
#ifndef ENGINE_RELAX_H
#define ENGINE_RELAX_H

#include "engine/finish.h"

/*
 * The field of a label in relaxation, as explained below.
 *
 * Most of a field never moves: voxels far from the border have neighbours of the same value, and at
 * strong edges of the scene movements round to 0. So rows are divided into chunks of RELAX_CHUNK
 * voxels, half of them of either parity, and a half-sweep visits a chunk only if one of its own
 * values, or of those next to it, moved at their last turn: all others would stay. About a third of
 * a field is visited. The weights of a chunk are computed at its first visit.
 *
 * Sets of voxels, and of chunks, are bits of 64-bit words.
 */

enum { RELAX_ONE = 1 << 20, RELAX_CHUNK = 16, RELAX_CHECKPOINT = 8 };

/* {0} has no memory yet; its memory is reused for one field after another. */
struct relax_field {
    const struct scene *scene;
    const uint8_t *label; /* labels of the scene, from finish_work, */
    uint8_t which;        /* and the label of this field */
    struct team *team;    /* NULL if several fields are computed in parallel */
    unsigned worker; /* number of the thread, if several fields are computed in parallel; else 0 */
    bool shows;      /* show the result between sweeps, if the watch wants to */
    uint32_t scale[CHANNELS_MOST + 1]; /* greys of a difference of one intensity, in 2^-16 greys: of
                                          the cells, then of each further channel */
    uint32_t reach;  /* steps from the border to the last voxels that move, 1..FINISH_BAND_MOST */
    uint32_t halves; /* half-sweeps */
    size_t room;     /* bytes for `store`; 0: none is made */
    struct relax_stored *store; /* values at checkpoints, or NULL */
    struct finish_box box;
    uint32_t size[3];   /* size of the box */
    size_t rows;        /* stored rows: those of the box, and a rim */
    size_t words;       /* words of a row of voxels: bit x + 2 is voxel x; four chunks a word */
    size_t chunk_words; /* words of a row of chunks */
    void *memory;       /* memory of all members below */
    size_t bytes;
    uint32_t *count;        /* [65536]: histogram of the intensities in the band */
    uint64_t *inside;       /* [rows][words]: voxels of the label, */
    uint64_t *band, *near;  /* the band; the band and one step more */
    uint64_t *busy;         /* [size[2]]: rows of a plane that were visited recently */
    uint8_t *row_moved[2];  /* by parity [rows]: a chunk of the row moved at its last turn */
    uint64_t *moved[2];     /* by parity [rows][chunk_words]: the chunk moved at its last visit, */
    uint64_t *end_moved[2]; /* with its voxel next to the next chunk of the row, */
    uint64_t *may[2];       /* it may move at all, */
    uint64_t *known[2];     /* it was visited: its weights are computed, */
    uint32_t *slot[2];      /* [rows][chunks] and stored in this slot */
    int32_t *u[2];          /* [rows][chunks][RELAX_CHUNK / 2]: values */
    struct relax_weights *weights;
    uint32_t slots;                    /* slots in use */
    const struct relax_stored *stored; /* source of a stored field, or NULL */
};

/* A stored field, followed by its data. */
struct relax_stored {
    size_t bytes;
    struct finish_box box;
    uint32_t scale[CHANNELS_MOST + 1];
    bool is_updatable;        /* all checkpoints and the band are stored */
    uint32_t checkpoints;     /* the last is the end */
    uint32_t count, capacity; /* stored chunks, and the most there can be */
    uint64_t *band;           /* [rows][words] */
    uint32_t *slot;           /* [rows][chunks]: 1 + the chunk's place; 0: its values are initial */
    int32_t (*value)[RELAX_CHUNK]; /* [checkpoints][capacity]: even voxels first */
};

/* Allocate the field of a label in a box: its bounding box, `reach` voxels larger on each side
 * within the scene. Each sweep moves even voxels, then odd ones. On ERR_MEMORY the field has no
 * memory. */
enum err relax_field_begin(struct relax_field *field, const struct finish_work *work, uint8_t which,
                           const struct finish_box *box, uint32_t reach, uint32_t sweeps,
                           struct fault *fault);
void relax_field_release(struct relax_field *field);

/* Compute the field, by its team. Undefined if the scene's watch has stopped it. */
void relax_field_make(struct relax_field *field);

/* Consecutive voxels of a row: value[i] is that of x + i, from the first corner. */
struct relax_part {
    size_t chunk; /* position to continue at; 0 at the beginning */
    uint32_t x, count;
    int32_t value[RELAX_CHUNK];
};

/* Find the next part of a row whose values may have moved; false at the end. All other voxels of
 * the scene have their initial value: RELAX_ONE in the label, 0 elsewhere. */
bool relax_field_next(const struct relax_field *field, uint32_t y, uint32_t z,
                      struct relax_part *part);

/* Return the field's `store`, or a new one of at most `most` bytes with the end alone; to be freed
 * by mem_pages_free. NULL without memory, or if it needs more. relax_field_read makes a stored
 * field readable. */
struct relax_stored *relax_field_store(struct relax_field *field, size_t most);
void relax_field_read(struct relax_field *field, const struct finish_work *work, uint8_t which,
                      const struct relax_stored *stored);

/* Update a stored field that is updatable and whose box still contains the label's. `changed`
 * contains the voxels with another label than before, former and new seeds, and voxels that entered
 * or left the region of interest. It is empty afterwards, and `stale` includes the voxels whose
 * value has changed; if the scene's watch stops the update, `changed` is the box to continue with.
 * False if the field has to be recomputed. `part` is undefined afterwards. */
bool relax_field_update(struct relax_field *part, const struct finish_work *work, uint8_t which,
                        struct relax_stored *stored, uint32_t reach, uint32_t sweeps,
                        struct finish_box *changed, struct finish_box *stale);

/* True if a voxel of the scene was never visited: its value is the initial one, and would be if it
 * were a seed. */
bool relax_field_is_initial(const struct relax_field *field, uint32_t x, uint32_t y, uint32_t z);

/* {0} is empty. Belongs to one scene, whose intensities do not change. */
struct relax_kept {
    size_t cells, bytes, most; /* bytes used by fields, and their limit */
    uint8_t *label, *stays;    /* [cells]: labels of the fields; relevant flags of cells, */
    uint8_t *result;           /* and the result for all labels, but for rows of `stale` */
    struct finish_box stale;
    bool lacks; /* there was no room for the field of a label: all rows stay stale */
    uint32_t sweeps, reach;
    struct relax_stored *field[256]; /* NULL: not stored */
    struct finish_box changed[256];  /* changed voxels that stored fields do not follow yet */
};

size_t relax_kept_memory(const struct relax_kept *kept);
void relax_kept_release(struct relax_kept *kept);

/*
 * Relaxation: the step that moves borders of labels to edges of the scene (engine/finish.h).
 *
 * Each label except 0 has a field; the field of label 0 is RELAX_ONE minus the sum of all others,
 * but at least 0. A voxel of some band is assigned the label of the greatest field; on a tie its
 * own label if that is one of them, else the smallest. So a few fields are computed at a time, and
 * only the best so far is stored for each voxel; and only where a field has moved, since elsewhere
 * the own label's field is RELAX_ONE.
 *
 * The field of a label is computed in a box around it. Each voxel has a value u, initially
 * RELAX_ONE in the label and 0 elsewhere. The voxels of the *band* move: at most `reach` steps
 * along the axes lead from them to a voxel on the other side of the label's border. All others keep
 * their value, as do seeds and voxels outside the region of interest.
 *
 * In a half-sweep all voxels of one parity of x + y + z move, each to
 *
 *     u + round((sum over its six neighbours n of w(n) * (u(n) - u)) / 1024),  within 0..RELAX_ONE
 *
 *     w(n) = floor(c(n) * floor(1536 * 2^32 / (sum of c)) / 2^32)
 *
 * where halves round to even, so that the field of the label's complement would be exactly
 * RELAX_ONE - u; 1536/1024 is over-relaxation by 24/16. c(n) is the conductance of a difference of
 * intensities, from 65536 for none down to 1, by the number of greys in it: 255 greys are the range
 * from the 2nd to the 98th percentile of the intensities in the band, so edges are those of this
 * label, independent of the rest of the scene. Of several channels the greatest difference counts,
 * each in greys of its own range, times its percentage. Outside the scene and outside the region of
 * interest it is 0.
 *
 * Voxels of one parity have neighbours of the other parity only: so within a half-sweep nothing
 * depends on order, and any number of threads and any width of vectors compute the same bits.
 * Other planes may be at other half-sweeps, as long as adjacent planes are at the same.
 */

/* Called with each field, by the thread that began, while the others are idle. */
typedef void relax_see(void *context, const struct relax_field *field);

/* Compute the field of a label, or FINISH_ALL_LABELS, for the labels of work->label, and pass each
 * to `see`, in no order. ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err relax_each(const struct finish_work *work, unsigned label, uint32_t sweeps, uint32_t reach,
                    relax_see *see, void *context, struct fault *fault);

#endif
