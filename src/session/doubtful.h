/* SPDX-License-Identifier: MIT */
/*
 * Which slice to outline next: that with the most doubt (engine/doubt.h), of all three planes.
 *
 * Slices in which an outline of the label lies already say what they can, and those beside them
 * nearly the same: they are left out. Of those of one plane that come after each other in rank, two
 * lie DOUBTFUL_APART or more slices apart, since the doubt of neighbours is the same.
 *
 * Robots who outline what comes first here reach as far with as many outlines as those who outline
 * the slice that is most wrong, which nobody can know.
 */
#ifndef SESSION_DOUBTFUL_H
#define SESSION_DOUBTFUL_H

#include "base/err.h"
#include "engine/doubt.h"
#include "engine/labels.h"
#include "session/session.h"

enum { DOUBTFUL_MOST = 5, DOUBTFUL_APART = 5 };

struct doubtful_slice {
    unsigned axis; /* at right angles to it; */
    uint32_t at;   /* and its place along that */
    uint64_t doubt;
};

/* The slices of most doubt, the first one first, for a label or FINISH_ALL_LABELS, as of the last
 * run; *count of them. Made in about the time of `finish relax`, and at once while labels, seeds
 * and steps stay. The errors of doubt_find. */
enum err doubtful_find(struct doubtful_slice slice[DOUBTFUL_MOST], size_t *count,
                       struct session *session, unsigned label, struct fault *fault);

/* A voxel in the middle of what a label has in the slice; where it has nothing there, of what it
 * has in the nearest one that it is in, moved to this one. False where it has no voxel. */
bool doubtful_place(uint32_t place[3], const struct labels *labels, unsigned label,
                    const struct doubtful_slice *slice);

#endif
