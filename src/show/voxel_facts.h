/* SPDX-License-Identifier: MIT */
/*
 * What a front end says of a voxel that one points at, in words that fit a line; how it came to its
 * label; and where the seeds and the centre of a label are. Nothing is changed here.
 */
#ifndef REPORT_VOXEL_FACTS_H
#define REPORT_VOXEL_FACTS_H

#include "base/buf.h"
#include "base/polyline.h"
#include "engine/way.h"
#include "session/session.h"

/* What is known of a voxel, part by part; one that begins with a blank goes on with the one before.
 * A label is the one that is shown, finished or the forest's. */
enum voxel_fact {
    FACT_HERE,   /* "here 2", "no label", "outside the region of interest" */
    FACT_NAME,   /* " cerebellum" */
    FACT_VOLUME, /* " 142 ml"; in the background "changed 2 cerebellum 142 ml", the label of which
                       the last edit changed most */
    FACT_CHANGE, /* " (+1.2 ml)", by the last edit */
    FACT_INTENSITY, /* "intensity 93" */
    FACT_PLACE,     /* "0.5,18.0,-2.0 mm", or why that is not known */
    FACT_IN_FOREST, /* "in the forest 1 brain", where the finished label is another */
    FACT_SUMS,      /* "mean 93, ..", of the label; not while a command is carried out */
    VOXEL_FACTS
};

/* Adds each to its text; nothing where there is nothing to say. */
void voxel_facts_write(struct buf fact[VOXEL_FACTS], struct session *session,
                       const uint32_t place[3], bool knows_sums);

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

/* Finds it, and adds it in words, which are to fit a row of 80 columns: "label 1 brain, cost 12,
 * 212 steps, strongest edge 93,40,61; next 0 at 15". False, with words, where there is nothing to
 * find. */
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

/*
 * The outline that is there in a slice, to be corrected: that of a marker, or else the border of a
 * label as it is shown; and in which slice to outline next.
 */

/* A marker counts that stands, lies in the slice alone and has the place within a few voxels of
 * itself; of several, the latest. */
enum { OUTLINE_FACTS_NEAR = 8 };

/* Finds it, in the slice across an axis through a place, and adds in words what it is of. The line
 * is empty before; `marker` is 0 where it is of the label's border, of the largest piece
 * (session/doubtful.h). False, with words, where there is none. */
bool outline_facts_find(struct polyline *line, uint32_t *marker, struct session *session,
                        unsigned label, unsigned axis, const uint32_t place[3], struct buf *out);

/* The slice in which it is the `rank`th least certain, from 1 on, where the label ends
 * (session/doubtful.h): the axis that it lies across, a place in it, and in words how much is in
 * doubt. False, with words, where there is none of that rank. */
bool outline_facts_next(unsigned *axis, uint32_t place[3], struct session *session, unsigned label,
                        size_t rank, struct buf *out);

#endif
