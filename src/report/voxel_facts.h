/*
 * What a front end says of a voxel that one points at, in words that fit a line; how it came to its
 * label; and where the seeds and the centre of a label are. Nothing is changed here.
 */
#ifndef REPORT_VOXEL_FACTS_H
#define REPORT_VOXEL_FACTS_H

#include "base/buf.h"
#include "engine/way.h"
#include "session/session.h"

/* "label 2 cerebellum 142 ml (+1.2 ml)  intensity 93  0.5,18.0,-2.0 mm  mean 93, ..."; in the
 * background "label 0  label 2 ... (-1.2 ml)  intensity 93": of what the last edit changed. The
 * label's sums, from the mean on, are not known while a command is carried out. */
void voxel_facts_write(struct buf *out, struct session *session, const uint32_t place[3],
                       bool knows_sums);

/* Its intensity, as a real value. */
double voxel_facts_intensity(const struct session *session, const uint32_t place[3]);

/* How a voxel came to its label. {0} is of none. */
struct voxel_why {
    struct way way;       /* the path back to its seed */
    unsigned label, next; /* which it would have next; 0 where no other seed reaches it */
    uint32_t root[3];     /* the seed */
    bool has_edge;        /* the cost rises on the path, and at its strongest edge, */
    uint32_t edge[3];     /* into this voxel, for the last time */
};
void voxel_why_release(struct voxel_why *why);

/* Finds it, and adds it in words: "label 1 brain at a cost of 12, 212 steps from its seed,
 * strongest edge into 93,40,61; next is label 0 at 15". False, with words, where there is nothing
 * to find. */
bool voxel_why_find(struct voxel_why *why, const struct session *session, const uint32_t place[3],
                    struct buf *out);

/* Finds what an eliminator at a voxel would take (session/session.h), and adds it in words:
 * "marker 7: 3 trees, 123 voxels, 5 seeds wait, label 2", or "the tree of the seed at 1,2,3: 9
 * voxels, label 2". False where there is nothing. */
bool voxel_facts_find_held(struct held *held, const struct session *session,
                           const uint32_t place[3], bool tree, struct buf *out);

/* How many places `hint N` knows; 0 where it would say why there are none. */
unsigned voxel_facts_hints(struct session *session);

/* Adds what of the scene is in doubt in a slice: "coronal y=108: 1.2 ml in doubt". */
struct doubtful_slice;
void voxel_facts_write_doubt(struct buf *out, const struct session *session,
                             const struct doubtful_slice *slice);

/* ---- of a label ---- */

/* Where its seeds are, those of a command once, in the order in which they were planted: the one
 * that is `by` further than that at the cross-hair, round and round. False where it has none. */
bool voxel_facts_next_seed(const struct session *session, unsigned label, int64_t by,
                           uint32_t place[3]);

/* The voxel of the label that is nearest to the mean of all of them. False where it has none. */
bool voxel_facts_centre(struct session *session, unsigned label, uint32_t place[3]);

#endif
