/* SPDX-License-Identifier: MIT */
/*
 * The field of a label in relaxation, which engine/finish_relax.h explains.
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
#ifndef ENGINE_RELAX_FIELD_H
#define ENGINE_RELAX_FIELD_H

#include "engine/finish.h"

enum { RELAX_ONE = 1 << 20, RELAX_CHUNK = 16 };

/* {0} has no memory yet; what it has then serves fields one after another. */
struct relax_field {
    const struct scene *scene;
    const uint8_t *label; /* of the scene, as finish_work has them, */
    uint8_t which;        /* and the label whose field this is */
    struct team *team;    /* NULL where several fields are made side by side */
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
 * field's team, whose first thread has the number `worker`: 0, but where several fields are made
 * side by side. Of no use where the scene's watch has stopped it. */
void relax_field_make(struct relax_field *field, uint32_t sweeps, unsigned worker);

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

/* Stores a field that was made in so many bytes; and has one read again, alone, which was. */
size_t relax_field_stored_bytes(const struct relax_field *field);
void relax_field_store(const struct relax_field *field, struct relax_stored *stored, size_t bytes);
void relax_field_read(struct relax_field *field, const struct finish_work *work, uint8_t which,
                      const struct relax_stored *stored);

/* Whether a voxel of the scene has never been looked at: it is as it was at first, and would be
 * were it a seed. */
bool relax_field_rests(const struct relax_field *field, uint32_t x, uint32_t y, uint32_t z);

#endif
