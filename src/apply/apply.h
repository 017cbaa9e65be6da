/* SPDX-License-Identifier: MIT */
/*
 * `iftty apply`: an expert's procedure carried to other scenes, a journal for each.
 */
#ifndef APPLY_APPLY_H
#define APPLY_APPLY_H

#include "apply/procedure.h"
#include "command/script.h"

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

#endif
