/* SPDX-License-Identifier: MIT */
/*
 * Where a procedure comes from: the text of one, or a journal, which is carried out.
 *
 * A journal may be a stranger's. It is carried out in a process of its own (verify/side.h), which
 * hands back the procedure as text; so both are read by the same reader, and lead to the same
 * bytes.
 */
#ifndef APPLY_PROCEDURE_SOURCE_H
#define APPLY_PROCEDURE_SOURCE_H

#include "apply/procedure.h"
#include "verify/side.h"

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

#endif
