/* SPDX-License-Identifier: MIT */
/*
 * Resealing a journal: the honest way to change one. It is carried out again, every record that
 * gives another result gets that of today and a comment that says why, with what it said before,
 * and the former journal is stored beside it. Nothing else changes.
 *
 *     # accepted: softer light (golden image left: 512 pixels differ, first column 3, row 4: ...)
 *     # it was: chain=<32 digits> picture=0123456789abcdef
 *     golden left
 *     = 12 picture=fedcba9876543210 chain=<32 digits>
 *
 * A journal names its golden images, so accepting one is a change of the journal, even where only
 * the file is drawn again: the reason is part of the chain from then on.
 *
 * Promises
 *     (R1) whole or not at all: golden images and journal are all as they were, or all new;
 *     (R2) what is written verifies, here and now, but for pictures that are not accepted;
 *     (R3) the bytes of the former journal stay, as FILE.before-N;
 *     (R4) nobody else writes the journal meanwhile.
 */
#ifndef VERIFY_RESEAL_H
#define VERIFY_RESEAL_H

#include "command/golden_files.h"
#include "command/script.h"

/* `iftty verify --accept WHY`: golden images that differ or are missing are drawn again, and
 * records of pictures get today's digests. Refused where a record gives another result that is no
 * picture's, where the journal was edited, where an orphan lies in its folder (ERR_CHECK), and
 * where the environment variable CI is set (ERR_USAGE): accepting is a person's decision.
 *
 * `only`, or NULL: the names of the golden images to accept, as "first,second". All other pictures
 * stay as they were, with their records: ERR_CHECK where any of them differs, after the named ones
 * were accepted. ERR_USAGE for a name that the journal does not give. */
enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const char *only, const struct printer *printer, struct fault *fault);

/* `iftty log --reseal`: a journal that was edited by hand, or that another version wrote, gets the
 * results that its commands give here. With a reason, `--accept WHY`, its pictures are accepted in
 * the same step. Without one golden images are left alone, and counted where they are others
 * now. */
enum err reseal_edited(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault);

#endif
