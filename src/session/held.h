/*
 * What an eliminator at a voxel would take away: the marker whose trees hold the voxel, or the
 * single tree. For front ends, which show it first; nothing is changed here.
 *
 * It takes time by what is held, up to a bound, and never by the scene: trees are counted from
 * their roots, and which marker a voxel belongs to is asked of the root in its key.
 */
#ifndef SESSION_HELD_H
#define SESSION_HELD_H

#include "session/session.h"

enum { HELD_MOST = 2000000 }; /* voxels that are counted: some 80 ms */

struct held {
    uint32_t marker; /* its number, the first of a stroke's; 0 for a single tree, */
    uint32_t seed;   /* which is this one's */
    uint8_t label;
    size_t trees;  /* of seeds that are planted */
    size_t waits;  /* seeds of it that wait to be */
    size_t voxels; /* of the trees */
    bool has_more; /* than HELD_MOST: these three are the least that there are */
};

/* Of `tree`, or where the semantics know no markers, the single tree. ERR_INPUT where nothing holds
 * the voxel; ERR_MEMORY. */
enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault);

/* Whether it holds a voxel, until the next command. */
bool session_is_held(const struct session *session, const struct held *held, uint32_t cell);

#endif
