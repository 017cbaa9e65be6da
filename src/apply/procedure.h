/* SPDX-License-Identifier: MIT */
/*
 * A procedure: what a journal holds of a segmentation that can be carried to another scene.
 *
 * That is the labels that it came to, with their grid and where it lies; how each label is called;
 * between which intensities most of its voxels are; the gestures that still stand; landmarks; and
 * the settings of weights and of the finish. No image, no name of a file or of a person, and no
 * comment. So it can be handed on where the scene may not be.
 *
 * As text (`iftty log --procedure`), which a reader takes only as it is written here:
 *
 *     iftty procedure 1
 *     chain 74120d6c3f0cc54e2237dc0bced98ab5
 *     scene SHA256                      of the scene that it was made on (engine/scene.h)
 *     world place|sides                 whether to_mm is a place in the world, or sides alone
 *     size 181 217 181
 *     to_mm A B C D ...                 twelve numbers: world = to_mm * (i, j, k, 1), as NIfTI
 *     left 0 1 0 3                      what is not carried over (enum procedure_left)
 *     setting weight gauss 1.5          a command each
 *     label 2 #56b4e9 0 40.5 90 cerebellum    colour, own number, percentiles 10 and 90, name
 *     landmark AC 0.5 3 -4              millimetres of the world
 *     gesture 2 3 0 75 X Y Z ...        label, radius and reach in mm (0: none), intensity, corners
 *     voxels
 *     0*345 1*17 0*4 ...                labels by rows, x fastest; as many as voxels
 *     digest SHA256                     of all bytes before this line
 *
 * Lines stand in this order, those from `setting` to `gesture` as often as they are wanted, and
 * `left` only where something is. Intensities are real values. Numbers have 17 digits, and so are
 * the same when they are read.
 */
#ifndef APPLY_PROCEDURE_H
#define APPLY_PROCEDURE_H

#include "apply/affine.h"
#include "base/buf.h"
#include "base/err.h"
#include "base/hash.h"
#include "journal/record.h"
#include "session/session.h"
#include "verify/side.h"

#define PROCEDURE_BEGINS "iftty procedure "

enum {
    PROCEDURE_VERSION = 1,
    PROCEDURE_GESTURES = 100000,
    PROCEDURE_CORNERS = 1000000,
    PROCEDURE_BYTES = 1 << 28,
    PROCEDURE_VOXELS = 1 << 30,
    PROCEDURE_NAME = 32, /* bytes of a name, its end among them */
    PROCEDURE_LANDMARKS = 64,
};

struct procedure_label {
    bool is_there; /* it has voxels */
    char name[PROCEDURE_NAME];
    uint8_t rgb[3];
    uint16_t number;  /* in files; 0: the label itself */
    uint64_t voxels;  /* follows from the labels */
    double low, high; /* real values: percentiles 10 and 90 of its voxels */
};

struct procedure_landmark {
    char name[PROCEDURE_NAME];
    double mm[3];
};

/* A ball of seeds, or a stroke of them. */
struct procedure_gesture {
    uint8_t label;
    double radius_mm, within_mm; /* 0: none */
    double intensity;            /* real value, in the middle of its first ball */
    size_t corner, corners;      /* in `corner` */
};

/* What lies on the procedure's own scene, and so is not carried over: whether its weights are a
 * map, whether a mask or a range restricts its trees; how many gestures stand that are no ball or
 * stroke, of which the labels alone are carried. */
enum procedure_left { LEFT_WEIGHTS, LEFT_MASK, LEFT_RANGE, LEFT_GESTURES, LEFT_KINDS };

struct procedure {
    struct record_chain chain;
    char scene[SHA256_HEX];
    char digest[SHA256_HEX]; /* of its text */
    bool has_place;
    uint32_t size[3];
    struct affine to_mm; /* of voxels */
    struct buf settings; /* commands, a line each */
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

/* Volume of a voxel, mm3. */
double procedure_voxel_mm3(const struct procedure *procedure);

/* Adds the text. */
void procedure_write(struct buf *out, const struct procedure *procedure);

/* Takes the text apart. `procedure` begins as {0}, and is to be released whatever is returned.
 * ERR_INPUT with the line that is wrong, and what was expected; ERR_MEMORY. Memory is bounded by
 * what it says of its size, PROCEDURE_VOXELS bytes at most. */
enum err procedure_read(struct procedure *procedure, const char *bytes, size_t length,
                        struct fault *fault);

/* Adds a corner to the gesture that is the last. */
enum err procedure_add_corner(struct procedure *procedure, const double mm[3], struct fault *fault);
enum err procedure_add_gesture(struct procedure *procedure, const struct procedure_gesture *gesture,
                               struct fault *fault);

/*
 * Where a procedure comes from: the text of one, or a journal, which is carried out.
 *
 * A journal may be a stranger's. It is carried out in a process of its own (verify/side.h), which
 * hands back the procedure as text; so both are read by the same reader, and lead to the same
 * bytes.
 */

struct procedure_source {
    const char *path;
    struct side_options journal; /* how one is carried out; strictly, whatever this says */
};

/* The text of it. `image` (NULL: not wanted) gets the intensities of the scene, two bytes each,
 * [z][y][x]; it stays empty where the procedure is a file, which has none. Words name the file.
 * ERR_CHECK where a journal gives other results than it records. */
enum err procedure_text(struct buf *text, struct buf *image, const struct procedure_source *source,
                        struct fault *fault);

/* The same, read. `procedure` begins as {0}, and is to be released whatever is returned. */
enum err procedure_load(struct procedure *procedure, struct buf *image,
                        const struct procedure_source *source, struct fault *fault);

/*
 * Between which intensities most voxels of each label lie: percentiles 10 and 90, as real values.
 * By those the grey of an object in one scene is matched with that in another.
 */

struct percentiles {
    uint64_t voxels[256];
    double low[256], high[256]; /* 0 for a label without voxels */
};

/* Of label[z][y][x], 0..255; other numbers count for nothing. ERR_MEMORY: it takes 256 kB for each
 * label. */
enum err percentiles_find(struct percentiles *out, const struct session *session,
                          const uint16_t *label, struct fault *fault);

/* The real value of the intensity at a voxel. */
double percentiles_value(const struct session *session, uint32_t cell);

#endif
