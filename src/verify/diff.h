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

#endif
