/* SPDX-License-Identifier: MIT */
/*
 * Two journals or scripts compared: the first command in which they differ, and how far the labels
 * differ that they end with.
 *
 * Each is carried out in a process of its own, by the rules for the journals of
 * others, B first: only its labels, names and colours stay, a byte a voxel, while A is carried out.
 * The picture is drawn by A's process, which has the scene. Nothing is written but that picture,
 * and that by the process that asked for it.
 */
#ifndef VERIFY_DIFF_H
#define VERIFY_DIFF_H

#include "command/script.h"
#include "engine/labels.h"
#include "image/picture.h"
#include "session/session.h"
#include "verify/side.h"

struct diff_options {
    const char *path[2];
    struct side_options side;
    const char *picture; /* a file that is not there yet, or NULL */
    bool json;
};

/* Prints what differs. OK where the labels are the same, ERR_CHECK where not. ERR_INPUT for what
 * cannot be read or carried out, gives other results than it says, opens no scene, or one of
 * another size than the other's. */
enum err diff_journals(const struct diff_options *options, const struct printer *printer,
                       struct fault *fault);

/*
 * The picture of two sets of labels of one scene: both as the first session shows its own, side by
 * side, and where they differ.
 *
 *     +----------+----------+----------+
 *     | A        | B        | A, B     |   strips of words above and below; below stand the labels
 *     |  (A's    |  (B's    |  (where  |   with their Dice, and what the colours on the right
 *     |  labels) |  labels) |  not)    |   mean
 *     +----------+----------+----------+
 *
 * View, look, cuts, colours and what is hidden are those of A's session for all three. On the right
 * all objects of either are a grey shade, and the voxels whose labels differ shine through it:
 * orange what A alone has for an object, blue what B alone has, purple what is another object in
 * each. People who cannot distinguish red from green can distinguish these. A voxel that lies
 * behind something is paler than one that is visible.
 */
struct difference_picture {
    const char *name[2];     /* of the two: shown as they are, as far as they are ASCII */
    const uint8_t *label[2]; /* [z][y][x] */
    const struct overlap *overlap;
};

/* Draws it into `picture`, which the caller releases; colours alone. The session is of no other use
 * afterwards: its scene has had its labels replaced, and its forest no longer fits them. ERR_LIMIT
 * where three views are wider than a picture may be, ERR_MEMORY, ERR_CANCELLED. */
enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *of, struct fault *fault);

#endif
