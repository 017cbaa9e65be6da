/* SPDX-License-Identifier: MIT */
/*
 * `iftty apply`: an expert's procedure carried to other scenes, a journal for each.
 */
#ifndef APPLY_APPLY_H
#define APPLY_APPLY_H

#include "apply/procedure.h"
#include "command/script.h"
#include "session/session.h"

struct apply_options {
    struct procedure_source procedure;
    char *const *scene;
    size_t scenes;
    const char *by, *as; /* as --by and --as have them; NULL: affine, and labels */
    const char *fit; /* rigid, similarity or affine, of landmarks; NULL: the most that they say */
    const char *out; /* a folder, or NULL for the one that one is in */
    const char *orient;    /* what the scenes' files do not say, or NULL */
    const char *volume;    /* of each scene, a list, or NULL */
    const char *landmarks; /* of the one subject: a file of lines, or a journal; or NULL */
    bool json;
};

/* Prints what came of each scene. All are tried, but for ERR_CANCELLED; the error of the worst
 * comes back: ERR_CHECK where one was refused and none failed otherwise. */
enum err apply_procedure(const struct apply_options *options, const struct printer *printer,
                         struct fault *fault);

/*
 * Carrying over: how a place of a subject's scene is found in the procedure's.
 *
 *     world      both have the same millimetres
 *     landmarks  those of the same names, by least squares
 *     affine     by the intensities of both (apply/registration.h)
 *     file       a transform that another program has found (apply/registration.h)
 *
 * Nothing is guessed: a scene of which nobody says where it lies is refused; landmarks need no
 * place, but sides and millimetres.
 */

enum carry_way { CARRY_WORLD, CARRY_LANDMARKS, CARRY_AFFINE, CARRY_FILE }; /* as ORIGIN_WAYS */

#define CARRY_FITS "rigid|similarity|affine" /* enum affine_kind */

struct carry_choice {
    enum carry_way way;
    const char *file; /* of CARRY_FILE */
    enum affine_kind kind;
    const struct procedure_landmark *landmark; /* the subject's */
    size_t landmarks;
    const uint16_t *intensity; /* of the procedure's scene, [z][y][x]; NULL where it is not known */
};

struct carry {
    struct affine pull; /* subject's world -> procedure's world */
    size_t pairs;       /* of landmarks, */
    double rms_mm;      /* and what they are off by */
    struct buf words;   /* what there is to say of it; no line feed */
};

/* `carry` is to be released by buf_release(&carry->words), whatever is returned. ERR_INPUT in words
 * that say what to do, ERR_CHECK for a registration that is not to be used. */
enum err carry_find(struct carry *carry, const struct carry_choice *choice,
                    const struct procedure *procedure, const struct session *subject,
                    struct fault *fault);

/* The landmarks of a file of lines NAME X,Y,Z in millimetres of the scene's world; comments begin
 * with #. ERR_INPUT with the line. */
enum err carry_read_landmarks(struct procedure_landmark mark[PROCEDURE_LANDMARKS], size_t *marks,
                              const char *path, struct fault *fault);

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

/* The paths that it may write: its journal, the map of its seeds, the folder with copies of labels,
 * each the name of the scene with one of these endings. */
#define SUBJECT_JOURNAL ".iftty"
#define SUBJECT_SEEDS   ".seeds.nii.gz"
#define SUBJECT_GOLDENS ".golden"
void subject_path(struct buf *out, const struct subject_choice *choice, const char *ending);

/* `subject` begins as {0}, and is to be released whatever is returned. ERR_CHECK where it is not to
 * be carried over so, ERR_INPUT, ERR_IO; there is no journal then that was not there before. */
enum err subject_make(struct subject *subject, const struct procedure *procedure,
                      const struct subject_choice *choice, struct fault *fault);

/*
 * A procedure's labels brought to another scene, and what of them is planted there.
 *
 *     warped    each voxel of the scene takes the label of the procedure's voxel that is nearest
 *               to where the pull leads: voxel -> its world -> the procedure's world -> voxel. One
 *               that leads beyond the procedure's grid has none, and nothing is planted there
 *     eroded    a voxel stays a seed where it is `depth_mm` or more from the voxels at the border
 *               of its label, by their centres; the edge of the scene is no border. Of an
 *               object so small that fewer than a tenth of its voxels would be left, the depth is
 *               what leaves a tenth: so it keeps seeds, and they are its innermost voxels
 *     gated     a seed of an object is dropped where its intensity is not one that the object had.
 *               The object's percentiles 10 and 90 in the procedure stand for those of its warped
 *               voxels here; what lies below the lower one, or above the higher one, by more than
 *               `gate` times what lies between them, is off. No image of the procedure is needed
 *               for that. The background has no intensity of its own and is not gated
 *
 * Floating point, and fine: what comes of it is written into a map, and no replay makes it anew.
 */

/* Values of a map of seeds: 0 for none, 1..255 for seeds of those labels, and: */
enum { SEEDS_BACKGROUND = 256, SEEDS_DROPPED = 256 }; /* label + SEEDS_DROPPED: it was dropped */

enum { WARP_NONE = UINT16_MAX };

struct warped {
    uint16_t *label; /* [z][y][x] 0..255, or WARP_NONE; then what warp_seeds makes of it */
    size_t voxels;
    struct percentiles percentiles;     /* of labels as they were warped */
    double depth_mm[256];               /* by which each was eroded */
    double within[256][2];              /* real values that its seeds have; low above high: any */
    uint64_t eroded[256], dropped[256]; /* seeds before the gate, and of those dropped by it */
};
void warped_release(struct warped *warped);

/* Labels alone. `warped` is to be released whatever is returned. ERR_INPUT where the scene and the
 * procedure have no voxel in common, ERR_MEMORY, ERR_CANCELLED. */
enum err warp_labels(struct warped *warped, const struct procedure *procedure,
                     const struct session *session, const struct affine *pull, struct fault *fault);

/* What is within the gate, of each label, by the percentiles of both. */
void warp_find_gates(struct warped *warped, const struct procedure *procedure, double gate);

/* Makes of the labels a map of seeds. ERR_MEMORY, ERR_CANCELLED. */
enum err warp_seeds(struct warped *warped, const struct session *session, double depth_mm,
                    struct fault *fault);

/* Whether a real value is within a range, or that is of any (low above high). */
static inline bool warp_may_have(const double within[2], double value)
{
    return within[0] > within[1] || (value >= within[0] && value <= within[1]);
}

#endif
