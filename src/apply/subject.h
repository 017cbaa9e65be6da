/* SPDX-License-Identifier: MIT */
/*
 * One subject: the journal that a procedure comes to in its scene.
 *
 *     open SCENE; orient; settings; names of labels; landmarks
 *     origin CHAIN ...            whose it is, how it was carried over, what was dropped
 *     labels NAME.seeds.nii.gz    or a `seed` for each gesture
 *     run
 *
 * It is written into a draft, and gets its name when it is complete (base/file.h). A file that this
 * run did not write is never replaced:
 *
 * - A journal of that name counts as done before if its first records, commands and results, are
 *   those of the draft, and all of it is sound; records after them are corrections. A registration
 *   is not made again for that: the transform in the origin of that journal is used.
 * - A map of seeds of that name, as a task leaves that was killed, is used if it has the bytes that
 *   would be written; else the subject fails.
 */
#ifndef APPLY_SUBJECT_H
#define APPLY_SUBJECT_H

#include "apply/carry.h"
#include "apply/procedure.h"

enum { PLANT_LABELS, PLANT_SEEDS }; /* as ORIGIN_PLANTS */

#define APPLY_DEPTH_MM 7
#define APPLY_GATE     0.15 /* 0.05 to 0.3 did alike */

struct subject_choice {
    const char *scene;  /* the file */
    const char *folder; /* where the journal goes */
    const char *orient; /* what `orient` is to say of it, or NULL */
    int64_t volume;     /* of the file; -1: none is chosen */
    int plants;
    double depth_mm, gate;
    struct carry_choice carry;
    struct watch *watch; /* or NULL */
};

/* What came of a label. */
struct subject_label {
    bool is_there;            /* in the procedure */
    uint64_t voxels;          /* now */
    double mm3, expected_mm3; /* now; and in the procedure, in the millimetres of this scene */
    uint64_t seeds, dropped;  /* that were to be planted, and of those not planted */
    double depth_mm;          /* by which it was eroded */
    double doubt;             /* 0..1: of the voxels at its border, those that hints calls weak */
};

struct subject {
    struct buf journal; /* its path */
    struct buf words;   /* how it was carried over; "" for nothing to say */
    bool was_there;     /* done before */
    unsigned worst;     /* the label whose volume is farthest from the procedure's; 0: none */
    struct affine pull;
    double rms_mm;
    struct subject_label label[256];
};
void subject_release(struct subject *subject);

/* The paths that it may write: its journal, the map of its seeds, the folder with copies of labels.
 */
void subject_journal(struct buf *out, const struct subject_choice *choice);
void subject_seeds(struct buf *out, const struct subject_choice *choice);
void subject_goldens(struct buf *out, const struct subject_choice *choice);

/* `subject` begins as {0}, and is to be released whatever is returned. ERR_CHECK where it is not to
 * be carried over so, ERR_INPUT, ERR_IO; there is no journal then that was not there before. */
enum err subject_make(struct subject *subject, const struct procedure *procedure,
                      const struct subject_choice *choice, struct fault *fault);

#endif
