/* SPDX-License-Identifier: MIT */
/*
 * A procedure: the part of a journal's segmentation that can be carried to another scene.
 *
 * It has the final labels with their grid and place, the labels' names, colours and intensities,
 * the gestures that are still in effect, landmarks, and the settings of weights and finish. It has
 * no image, no name of a file or person, and no comment, so it can be shared where the scene may
 * not be.
 *
 * As text (`iftty log --procedure`), read only in exactly this form:
 *
 *     iftty procedure 1
 *     chain 74120d6c3f0cc54e2237dc0bced98ab5
 *     scene SHA256                      of its scene (engine/scene.h)
 *     world place|sides                 whether to_mm is a place in the world, or sides alone
 *     size 181 217 181
 *     to_mm A B C D ...                 twelve numbers: world = to_mm * (i, j, k, 1), as NIfTI
 *     left 0 1 0 3                      not carried over (enum procedure_left)
 *     setting weight gauss 1.5          a command each
 *     label 2 #56b4e9 0 40.5 90 cerebellum    index, colour, number (0: the index), percentiles 10
 *                                       and 90, name
 *     code SCT:113305005                of the label before
 *     landmark AC 0.5 3 -4              millimetres of the world
 *     gesture 2 3 0 75 X Y Z ...        label, radius and reach in mm (0: none; -1: exact),
 *                                       intensity, over=LABELS unless all, corners
 *     voxels
 *     0*345 1*17 0*4 ...                labels by rows, x fastest; one for each voxel
 *     digest SHA256                     of all bytes before this line
 *
 * Gestures and voxels have the indices of labels. Lines have this order; those from `setting` to
 * `gesture` may be repeated or missing, and `left` is missing if nothing is left out. Intensities
 * are real values. Numbers have 17 digits, enough to be read back exactly.
 */
#ifndef APPLY_PROCEDURE_H
#define APPLY_PROCEDURE_H

#include "apply/affine.h"
#include "base/buf.h"
#include "base/err.h"
#include "base/hash.h"
#include "journal/record.h"
#include "session/session.h"
#include "session/setting.h"
#include "verify/side.h"

#define PROCEDURE_BEGINS "iftty procedure "

enum {
    PROCEDURE_VERSION = 1,
    PROCEDURE_GESTURES = 100000,
    PROCEDURE_CORNERS = 1000000,
    PROCEDURE_BYTES = 1 << 28,
    PROCEDURE_VOXELS = 1 << 30,
    PROCEDURE_NAME = 32, /* bytes of a name, with its NUL */
    PROCEDURE_LANDMARKS = 64,
};

struct procedure_label {
    bool is_there; /* it has voxels or a number */
    char name[PROCEDURE_NAME];
    char code[LABEL_CODE_BYTES];
    uint8_t rgb[3];
    uint32_t number;  /* 0: the index */
    uint64_t voxels;  /* counted from the labels */
    double low, high; /* real values: percentiles 10 and 90 of its voxels */
};

struct procedure_landmark {
    char name[PROCEDURE_NAME];
    double mm[3];
};

/* A ball or a stroke of seeds. */
enum { GESTURE_EXACT = -1 };
struct procedure_gesture {
    uint8_t label;
    double radius_mm;
    double within_mm; /* 0: none; GESTURE_EXACT: no tree grows from its seeds */
    bool has_over;    /* only voxels of these labels take part: */
    struct label_set over;
    double intensity;       /* real value, at the centre of the first ball */
    size_t corner, corners; /* in `corner` */
};

/* Parts of the procedure that belong to its scene and are not carried over: a map of weights, a
 * mask, a range of intensities; and the number of gestures that are no ball or stroke, whose labels
 * alone are carried. */
enum procedure_left { LEFT_WEIGHTS, LEFT_MASK, LEFT_RANGE, LEFT_GESTURES, LEFT_KINDS };

struct procedure {
    struct record_chain chain;
    char scene[SHA256_HEX];
    char digest[SHA256_HEX]; /* SHA-256 of its text */
    bool has_place;
    uint32_t size[3];
    struct affine to_mm; /* from voxels */
    struct buf settings; /* one command a line */
    uint32_t left[LEFT_KINDS];
    struct procedure_label label[256];
    struct procedure_landmark landmark[PROCEDURE_LANDMARKS];
    size_t landmarks;
    struct procedure_gesture *gesture;
    size_t gestures, gesture_capacity;
    double (*corner)[3]; /* millimetres */
    size_t corners, corner_capacity;
    uint8_t *voxel; /* [z][y][x] */
};

void procedure_release(struct procedure *procedure);

/* Numbers of all labels, as numbering_fill gets them. */
void procedure_numbers(uint32_t number[256], const struct procedure *procedure);

/* Volume of a voxel, mm3. */
double procedure_voxel_mm3(const struct procedure *procedure);

/* Append the text. */
void procedure_write(struct buf *out, const struct procedure *procedure);

/* Parse a text. `procedure` starts as {0}; release it in any case. ERR_INPUT names the wrong line
 * and the expected text; ERR_MEMORY. Memory is bounded by the size in the text, at most
 * PROCEDURE_VOXELS bytes. */
enum err procedure_read(struct procedure *procedure, const char *bytes, size_t length,
                        struct fault *fault);

/* Append a corner to the last gesture. */
enum err procedure_add_corner(struct procedure *procedure, const double mm[3], struct fault *fault);
enum err procedure_add_gesture(struct procedure *procedure, const struct procedure_gesture *gesture,
                               struct fault *fault);

/*
 * Source of a procedure: its text, or a journal, which is replayed.
 *
 * A journal may be a stranger's. It is replayed in a process of its own (verify/side.h), which
 * returns the procedure as text, so both sources pass the same parser and yield the same bytes.
 */

struct procedure_source {
    const char *path;
    struct side_options journal; /* options of the replay; always strict */
};

/* Get the text. `image` (or NULL) gets the intensities of the scene, two bytes each, [z][y][x]; it
 * stays empty if the source is a text. The fault names the file. ERR_CHECK if a journal does not
 * reproduce its results. */
enum err procedure_text(struct buf *text, struct buf *image, const struct procedure_source *source,
                        struct fault *fault);

/* Get and parse it. `procedure` starts as {0}; release it in any case. */
enum err procedure_load(struct procedure *procedure, struct buf *image,
                        const struct procedure_source *source, struct fault *fault);

/* Percentiles 10 and 90 of each label's intensities, as real values. They match an object's grey in
 * one scene with that in another. */

struct percentiles {
    uint64_t voxels[256];
    double low[256], high[256]; /* 0 for a label without voxels */
};

/* Count label[z][y][x], 0..255, and ignore other numbers. ERR_MEMORY: 256 kB for each label. */
enum err percentiles_find(struct percentiles *out, const struct session *session,
                          const uint16_t *label, struct fault *fault);

/* Real value of a voxel's intensity. */
double percentiles_value(const struct session *session, uint32_t cell);

#endif
