/* SPDX-License-Identifier: MIT */
/* `iftty apply`: carry an expert's procedure to other scenes, and write a journal for each. */
#ifndef APPLY_APPLY_H
#define APPLY_APPLY_H

#include "apply/procedure.h"
#include "command/script.h"
#include "session/session.h"

struct apply_options {
    struct procedure_source procedure;
    char *const *scene;
    size_t scenes;
    const char *by, *as; /* values of --by and --as; NULL: affine, labels */
    const char
        *fit; /* rigid, similarity or affine, for landmarks; NULL: the most that the pairs allow */
    const char *out;       /* a folder; NULL: the current one */
    const char *orient;    /* orientation, for scenes whose files do not have one; or NULL */
    const char *volume;    /* a list, used for each scene; or NULL */
    const char *landmarks; /* landmarks of the one subject: a text file or a journal; or NULL */
    bool json;
};

/* Process all scenes, unless cancelled, and print a result for each. Return the worst error:
 * ERR_CHECK if a scene was refused and none failed otherwise. */
enum err apply_procedure(const struct apply_options *options, const struct printer *printer,
                         struct fault *fault);

/*
 * Finding the map from a subject's world to the procedure's:
 *
 *     world      both worlds are the same
 *     landmarks  least squares over landmarks of the same names
 *     affine     registration of the intensities (apply/registration.h)
 *     file       a transform from another program (apply/registration.h)
 *
 * Nothing is guessed: a scene of unknown place is refused. Landmarks need sides and millimetres
 * only.
 */

enum carry_way {
    CARRY_WORLD,
    CARRY_LANDMARKS,
    CARRY_AFFINE,
    CARRY_FILE
}; /* indices of ORIGIN_WAYS */

#define CARRY_FITS "rigid|similarity|affine" /* indices: enum affine_kind */

struct carry_choice {
    enum carry_way way;
    const char *file; /* for CARRY_FILE */
    enum affine_kind kind;
    const struct procedure_landmark *landmark; /* the subject's */
    size_t landmarks;
    const uint16_t *intensity; /* the procedure's scene, [z][y][x]; NULL: unknown */
};

struct carry {
    struct affine pull; /* subject's world -> procedure's world */
    double rms_mm;      /* residual of the fit */
    struct buf words;   /* description of the map, one line */
};

/* Find the map by `choice`. Release `carry->words` in any case. ERR_INPUT with advice; ERR_CHECK
 * for a registration that must not be used. */
enum err carry_find(struct carry *carry, const struct carry_choice *choice,
                    const struct procedure *procedure, const struct session *subject,
                    struct fault *fault);

/* Read landmarks from a file of lines NAME X,Y,Z, in millimetres of the scene's world; # begins a
 * comment. ERR_INPUT with the line. */
enum err carry_read_landmarks(struct procedure_landmark mark[PROCEDURE_LANDMARKS], size_t *marks,
                              const char *path, struct fault *fault);

/*
 * One subject: write the journal of a procedure carried to its scene.
 *
 *     open SCENE; orient; settings; names of labels; landmarks
 *     origin CHAIN ...            the procedure, the map, and the seeds that were dropped
 *     labels NAME.seeds.nii.gz    or a `seed` for each gesture
 *     run
 *
 * The journal is written into a draft and renamed when it is complete (base/file.h). Existing files
 * are never replaced:
 *
 * - If a journal of that name exists, the subject counts as done if its first records, commands and
 *   results, equal those of the draft, and all its records are sound; further records are
 *   corrections. It is not registered again: the transform is read from the journal's origin.
 * - If a map of seeds of that name exists, as left by a killed task, it is used if its bytes are
 *   the expected ones; otherwise the subject fails.
 */

enum { PLANT_LABELS, PLANT_SEEDS }; /* indices of ORIGIN_PLANTS */

#define APPLY_DEPTH_MM 7
#define APPLY_GATE     0.15 /* 0.05 to 0.3 had similar results */

struct subject_choice {
    const char *scene;  /* path */
    const char *folder; /* for the journal */
    const char *orient; /* argument of `orient`, or NULL */
    int64_t volume;     /* in the file; -1: unspecified */
    int plants;
    double depth_mm, gate;
    struct carry_choice carry;
    struct watch *watch; /* or NULL */
};

/* Result for a label. */
struct subject_label {
    bool is_there;            /* exists in the procedure */
    uint64_t voxels;          /* now */
    double mm3, expected_mm3; /* now; in the procedure, scaled to this scene */
    uint64_t seeds, dropped;  /* planned; not planted */
    double depth_mm;          /* erosion */
    double doubt;             /* 0..1: weak voxels of its border, by hints */
    double far_mm3;           /* far from the label that was carried over (warp_count_far) */
    bool is_bad;              /* by volume, or by the share of these */
};

struct subject {
    struct buf journal; /* path */
    struct buf words;   /* description of the map; may be "" */
    bool was_there;     /* the journal existed */
    unsigned worst;     /* label whose volume differs most from the procedure's; 0: none */
    struct affine pull;
    double rms_mm;
    struct subject_label label[256];
};
void subject_release(struct subject *subject);

/* Paths that may be written: the scene's name with one of these endings. The journal, the map of
 * seeds, the folder of golden images. */
#define SUBJECT_JOURNAL ".iftty"
#define SUBJECT_SEEDS   ".seeds.nii.gz"
#define SUBJECT_GOLDENS ".golden"
void subject_path(struct buf *out, const struct subject_choice *choice, const char *ending);

/* Process one subject. `subject` starts as {0}; release it in any case. ERR_CHECK if the map is
 * refused; ERR_INPUT, ERR_IO. After an error no new journal is left. */
enum err subject_make(struct subject *subject, const struct procedure *procedure,
                      const struct subject_choice *choice, struct fault *fault);

/*
 * Warping a procedure's labels to another scene, and choosing seeds from them.
 *
 *     warped    each voxel of the scene gets the label of the nearest voxel of the procedure:
 *               voxel -> its world -> the procedure's world -> voxel. Voxels outside the
 *               procedure's grid get no label and no seed.
 *     eroded    a voxel stays a seed if it is at least `depth_mm` from the nearest voxel at a
 *               border of labels, measured between centres; the edge of the scene is no border. If
 *               fewer than a tenth of an object's voxels would remain, the depth is reduced to keep
 *               a tenth: its innermost voxels.
 *     gated     a seed of an object is dropped if its intensity is unlike the object's. The
 *               object's percentiles 10 and 90 in the procedure correspond to those of its warped
 *               voxels here; intensities farther outside them than `gate` times their difference
 *               are dropped. No image of the procedure is needed. The background is not gated.
 *
 * Floating point is allowed: the seeds are written to a map, and no replay recomputes them.
 */

/* Values of a map of seeds: 0 none, 1..255 seeds of those labels, and: */
enum { SEEDS_BACKGROUND = 256, SEEDS_DROPPED = 256 }; /* label + SEEDS_DROPPED: dropped */

enum { WARP_NONE = UINT16_MAX };

struct warped {
    uint16_t *label; /* [z][y][x] 0..255 or WARP_NONE; after warp_seeds, a map of seeds */
    size_t voxels;
    struct percentiles percentiles;     /* after warping */
    double depth_mm[256];               /* erosion */
    double within[256][2];              /* real values of seeds; low above high: any */
    uint64_t eroded[256], dropped[256]; /* seeds before the gate; dropped by it */
};
void warped_release(struct warped *warped);

/* Warp the labels. Release `warped` in any case. ERR_INPUT if the scene and the procedure share no
 * voxel; ERR_MEMORY, ERR_CANCELLED. */
enum err warp_labels(struct warped *warped, const struct procedure *procedure,
                     const struct session *session, const struct affine *pull, struct fault *fault);

/* Compute the range of intensities of each label's seeds, from the percentiles of both scenes. */
void warp_find_gates(struct warped *warped, const struct procedure *procedure, double gate);

/* Convert the labels to a map of seeds. ERR_MEMORY, ERR_CANCELLED. */
enum err warp_seeds(struct warped *warped, const struct session *session, double depth_mm,
                    struct fault *fault);

/* Count voxels of each label of the session that are far from the warped label: farther than 5 mm
 * and than a third of the radius of a ball of its volume, in whole millimetres. This finds a leak
 * that a loss elsewhere hides in the volume. ERR_MEMORY, ERR_CANCELLED. */
enum err warp_count_far(uint64_t far[256], const struct warped *warped,
                        const struct session *session, struct fault *fault);

/* Test whether a value is in a range; low above high means any value. */
static inline bool warp_may_have(const double within[2], double value)
{
    return within[0] > within[1] || (value >= within[0] && value <= within[1]);
}

#endif
