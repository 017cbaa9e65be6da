/*
 * The field: how full the scene is around a point, as a smooth function of the point.
 *
 * Labels are steps; a surface shaded by them would be a staircase. So what is shown (1, else 0) is
 * smoothed by a tent of FIELD_RADIUS voxels each way along every axis, and what lies between voxel
 * centres is interpolated. The direction in which the field falls is the normal of the surface.
 * The field of the scene itself (FIELD_SCENE) is the same of its intensities, smoothed less.
 *
 * The field of one label is that of the shown voxels which have it. How far inside of that a point
 * is is known in fields of FIELD_SURFACES alone.
 *
 * It is made where it is needed, in blocks of FIELD_BLOCK voxels a side, of which a bounded number
 * is stored: making one costs some 3 us, of a surface 5, a picture needs some hundreds, and the
 * next one from another side needs mostly the same. A stored block is made again where a word of
 * the border's sets that it was made of has changed since (border->changed). So the field is a pure
 * function of what is shown, in whatever order points are asked for.
 *
 * Points are in 1/256 voxels along the scene's axes from the centre of voxel 0,0,0, and lie at most
 * half a voxel outside the scene: from -256 on, and before 256 times the voxels of an axis.
 */
#ifndef RENDER_FIELD_H
#define RENDER_FIELD_H

#include <stdint.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/err.h"
#include "render/seams.h"

enum {
    FIELD_RADIUS = 3, /* voxels; of the shown voxels */
    FIELD_REACH = 5,  /* the gradient at a point in a voxel's cube depends on what is shown at most
                         so many steps away along each axis, and on no other voxel */
    FIELD_INSIDE_UNIT = 4, /* of a 4096th of the smoothed value */
    FIELD_BLOCK = 8,
    FIELD_SIDE = FIELD_BLOCK + 1, /* places of a block along an axis: between two of them a point */
};

/* A surface is that of the whole (render/border.h), which knows how far inside a point is; surfaces
 * are those of labels too. */
enum field_kind { FIELD_SHOWN, FIELD_SURFACE, FIELD_SURFACES, FIELD_SCENE };

/* Along x, y, z; the fourth is 0. In a unit of their own for each kind, less than 2^13. */
struct gradient {
    int16_t along[4];
};

/* Gradients at voxel centres; place 0 of block b along an axis is voxel FIELD_BLOCK * b - 1. */
struct field_block {
    struct gradient at[FIELD_SIDE][FIELD_SIDE][FIELD_SIDE]; /* [z][y][x] */
    int16_t inside[FIELD_SIDE][FIELD_SIDE][FIELD_SIDE + 1]; /* likewise; above 0 inside, in
                                                              FIELD_INSIDE_UNIT, less than 2^14 */
};

struct field {
    const struct border *border;
    const struct seams *seams; /* to be set where fields of labels are asked for: the border's */
    enum field_kind kind;
    int brighter;   /* FIELD_SCENE: intensities are shifted left by this, to 12 bits */
    uint32_t slots; /* of blocks, a power of 2 */
    uint32_t asked; /* how often blocks were asked for */
    struct field_block *block;
    struct field_slot *slot;
    struct field_tables *tables;
};

/* A field with no block made yet, for one of `threads` which each have their own, and store less in
 * it the more there are. The border outlives it. */
enum err field_init(struct field *field, const struct border *border, enum field_kind kind,
                    unsigned threads, struct fault *fault);
/* Whether the field is as one that is made now: it has room for more blocks where something is
 * translucent. */
bool field_fits(const struct field *field, const struct border *border, unsigned threads);
void field_release(struct field *field);
size_t field_bytes(const struct field *field);

/* The block with these numbers along x, y, z, of all that is shown, or of one label that is not 0;
 * valid until the next one is asked for. */
const struct field_block *field_block(struct field *field, const uint32_t number[3], uint8_t label);

/* Where a block was last found, so that points close together need not look it up. A field has one
 * reader: what another one asks for may take the place of the block. */
struct field_reader {
    struct field *field;
    uint8_t label; /* of which to read the field; 0: of all that is shown */
    uint32_t number[3];
    uint8_t block_label;
    const struct field_block *block; /* NULL at first */
};

/* Has what is stored of the field around a point come to the caches. */
void field_fetch(const struct field_reader *reader, const int32_t point[3]);

/* Two gradients side by side. */
typedef int16_t field_pair __attribute__((vector_size(2 * sizeof(struct gradient))));

static inline field_pair field_pair_at(const struct gradient *at)
{
    field_pair pair;
    memcpy(&pair, at, sizeof pair);
    return pair;
}

/* Of the way from each number to another, `part` of 256; rounded down to a whole number.
 * Differences are below 2^14. Compilers do not find the instruction that there is for it. */
static inline field_pair field_between(field_pair from, field_pair to, int32_t part)
{
    field_pair way = 2 * (to - from);
#ifdef __SSE2__
    way = (field_pair)_mm_mulhi_epi16((__m128i)way, _mm_set1_epi16((int16_t)(part * 128)));
#else
    for (int i = 0; i < 8; i++)
        way[i] = (int16_t)(way[i] * (part * 128) >> 16);
#endif
    return from + way;
}

/* Between the eight places from `at` on: gradients of two neighbours along x lie side by side. */
static inline struct gradient field_of(const struct gradient *at, const int32_t part[3])
{
    enum { Y = FIELD_SIDE, Z = FIELD_SIDE * FIELD_SIDE };
    struct gradient out;
    const field_pair above = field_between(field_pair_at(at), field_pair_at(at + Z), part[2]);
    const field_pair below =
        field_between(field_pair_at(at + Y), field_pair_at(at + Y + Z), part[2]);
    const field_pair edge = field_between(above, below, part[1]);
    const field_pair next = __builtin_shufflevector(edge, edge, 4, 5, 6, 7, 4, 5, 6, 7);
    const field_pair point = field_between(edge, next, part[0]);
    memcpy(&out, &point, sizeof out);
    return out;
}

/* The number of the block along an axis, and likewise. */
static inline uint32_t field_along(int32_t point, uint32_t *first, int32_t *part)
{
    const uint32_t from = (uint32_t)(point + 256); /* from the centre of the rim's cell */
    *first = from / 256 % FIELD_BLOCK;
    *part = (int32_t)(from % 256);
    return from / (256 * FIELD_BLOCK);
}

/* Finds the block of a point, the first of the eight places around it, and how far it is from that
 * to the next, of 256. */
static inline void field_find(struct field_reader *reader, const int32_t point[3],
                              uint32_t first[3], int32_t part[3])
{
    const uint32_t number[3] = {field_along(point[0], &first[0], &part[0]),
                                field_along(point[1], &first[1], &part[1]),
                                field_along(point[2], &first[2], &part[2])};
    const uint32_t apart = (number[0] ^ reader->number[0]) | (number[1] ^ reader->number[1]) |
                           (number[2] ^ reader->number[2]) |
                           (uint32_t)(reader->block_label ^ reader->label);
    if (apart || !reader->block) {
        reader->block = field_block(reader->field, number, reader->label);
        reader->block_label = reader->label;
        memcpy(reader->number, number, sizeof number);
    }
}

static inline struct gradient field_at(struct field_reader *reader, const int32_t point[3])
{
    uint32_t first[3];
    int32_t part[3];
    field_find(reader, point, first, part);
    return field_of(&reader->block->at[first[2]][first[1]][first[0]], part);
}

/* Of two places side by side, between those from `at` on along z and y: times 256. */
static inline void field_inside_pair(int32_t out[2], const int16_t *at, const int32_t part[3])
{
    enum { Y = FIELD_SIDE + 1, Z = FIELD_SIDE * Y };
#ifdef __SSE2__
    const __m128i low = _mm_unpacklo_epi16(_mm_loadu_si32(at), _mm_loadu_si32(at + Z));
    const __m128i high = _mm_unpacklo_epi16(_mm_loadu_si32(at + Y), _mm_loadu_si32(at + Y + Z));
    const __m128i along_z = _mm_madd_epi16(_mm_unpacklo_epi64(low, high),
                                           _mm_set1_epi32(part[2] * 65536 + 256 - part[2]));
    const __m128i way = _mm_sub_epi32(_mm_unpackhi_epi64(along_z, along_z), along_z);
    const __m128i along_y = _mm_madd_epi16(_mm_srai_epi32(way, 8), _mm_set1_epi32(part[1]));
    _mm_storel_epi64((__m128i *)(void *)out, _mm_add_epi32(along_z, along_y));
#else
    for (int x = 0; x < 2; x++) { /* 2^14 times 2^16 at most */
        const int32_t low = at[x] * 256 + (at[x + Z] - at[x]) * part[2];
        const int32_t high = at[x + Y] * 256 + (at[x + Y + Z] - at[x + Y]) * part[2];
        out[x] = low + ((high - low) >> 8) * part[1];
    }
#endif
}

/* How far inside a point is; the reader's field is of surfaces. */
static inline int32_t field_inside(struct field_reader *reader, const int32_t point[3])
{
    uint32_t first[3];
    int32_t part[3], at_x[2];
    field_find(reader, point, first, part);
    field_inside_pair(at_x, &reader->block->inside[first[2]][first[1]][first[0]], part);
    return (at_x[0] + ((at_x[1] - at_x[0]) >> 8) * part[0]) >> 8;
}

#endif
