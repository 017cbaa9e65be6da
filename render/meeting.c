#include "render/meeting.h"

#include <string.h>

enum {
    SIDE = 2 * MEETING_REACH,
    PART_BITS = 7,
    PART = 1 << PART_BITS,
    VOICES = SIDE * SIDE * SIDE
};

bool meeting_is_at(const struct border *border, const int32_t point[3])
{
    const struct grid *grid = &border->scene->grid;
    uint32_t first = grid_cell(grid, 0, 0, 0);
    int label = -1;
    for (int a = 0; a < 3; a++)
        first += (uint32_t)((point[a] >> MEETING_BITS) * grid->step[a]);
    for (unsigned i = 0; i < 8; i++) {
        const uint32_t voxel = first + (i & 1) + (i & 2 ? (uint32_t)grid->step[1] : 0) +
                               (i & 4 ? (uint32_t)grid->step[2] : 0);
        if (!border_shows(border, voxel))
            continue;
        const uint8_t its = labels_at(&border->labels, voxel);
        if (label >= 0 && its != label)
            return true;
        label = its;
    }
    return false;
}

/* ---- votes ---- */

/* The voxels around a point: SIDE along each axis from `first` on, with their weights by either
 * tent. */
struct around {
    int64_t first[3]; /* of the scene, before its first voxel too */
    uint32_t narrow[3][SIDE], wide[3][SIDE];
};

static void find_around(struct around *around, const int32_t point[3])
{
    for (int a = 0; a < 3; a++) {
        const uint32_t part = (uint32_t)point[a] >> (MEETING_BITS - PART_BITS) & (PART - 1);
        const uint32_t narrow[SIDE] = {0, PART - part, part, 0};
        const uint32_t wide[SIDE] = {PART - part, 2 * PART - part, PART + part, part};
        around->first[a] = (point[a] >> MEETING_BITS) - 1;
        memcpy(around->narrow[a], narrow, sizeof narrow);
        memcpy(around->wide[a], wide, sizeof wide);
    }
}

/* A shown voxel; all weights around a point add up to 2^29 at most. */
struct voice {
    uint32_t voxel, weight;
    uint8_t label;
};

static unsigned find_voices(struct voice voice[VOICES], const struct border *border,
                            const struct around *around)
{
    enum { ALIKE = 64, NARROW = 3 * ALIKE }; /* it counts three times as much as the wide one */
    const struct grid *grid = &border->scene->grid;
    unsigned count = 0;
    for (int i = 0; i < VOICES; i++) {
        const int x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const int64_t at[3] = {around->first[0] + x, around->first[1] + y, around->first[2] + z};
        if (!grid_contains(grid, at[0], at[1], at[2]))
            continue;
        const uint32_t voxel = grid_cell(grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
        const uint32_t weight =
            NARROW * around->narrow[0][x] * around->narrow[1][y] * around->narrow[2][z] +
            around->wide[0][x] * around->wide[1][y] * around->wide[2][z];
        if (weight && border_shows(border, voxel))
            voice[count++] = (struct voice){voxel, weight, labels_at(&border->labels, voxel)};
    }
    return count;
}

static uint32_t said_for(const struct voice *voice, unsigned count, uint8_t label)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < count; i++)
        sum += voice[i].label == label ? voice[i].weight : 0;
    return sum;
}

/* The label that most is said for; of several the least. */
static uint8_t choose(const struct voice *voice, unsigned count, uint8_t label)
{
    uint32_t most = said_for(voice, count, label);
    for (unsigned i = 0; i < count; i++) {
        if (voice[i].label == label)
            continue;
        const uint32_t sum = said_for(voice, count, voice[i].label);
        if (sum > most || (sum == most && voice[i].label < label)) {
            most = sum;
            label = voice[i].label;
        }
    }
    return label;
}

uint32_t meeting_voxel(const struct border *border, const int32_t point[3], uint32_t own)
{
    struct voice voice[VOICES];
    struct around around;
    if (!meeting_is_at(border, point))
        return own;
    find_around(&around, point);
    const uint8_t its = labels_at(&border->labels, own);
    const unsigned count = find_voices(voice, border, &around);
    const uint8_t label = choose(voice, count, its);
    uint32_t nearest = 0, voxel = own;
    for (unsigned i = 0; i < count && label != its; i++)
        if (voice[i].label == label && voice[i].weight > nearest) {
            nearest = voice[i].weight;
            voxel = voice[i].voxel;
        }
    return voxel;
}
