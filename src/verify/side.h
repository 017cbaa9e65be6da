/* SPDX-License-Identifier: MIT */
/*
 * Result of a journal or script, as one side of a comparison or as the source of a procedure
 * (src/apply). A process of its own carries it out under the rules for untrusted journals. It
 * returns bytes: the facts, then, on success, a label for each voxel and additional data. So no
 * memory of an untrusted journal remains when the next one is carried out.
 */
#ifndef VERIFY_SIDE_H
#define VERIFY_SIDE_H

#include "base/buf.h"
#include "base/hash.h"
#include "base/watch.h"
#include "engine/labels.h"
#include "journal/record.h"
#include "session/state.h"

struct interpreter;
struct reply;

struct side_facts { /* sent between processes of this program as they are */
    enum err err;
    char why[sizeof((struct fault *)0)->text];
    uint32_t size[3];
    uint64_t scene_digest;
    char proof[SHA256_HEX];
    struct record_chain chain; /* chain of the last record */
    size_t voxels, pending, more;
    uint8_t is_edited, is_torn, is_private; /* booleans */
    char label_name[256][LABEL_NAME_BYTES];
    uint32_t label_number[256]; /* (numbering_fill) */
    struct palette palette;
};

/* Begins as {0}. */
struct side {
    struct buf bytes;
    /* Places in `bytes`, set on success. */
    const struct side_facts *facts;
    const uint8_t *labels; /* [z][y][x], of the forest */
    const void *more;      /* [facts->more], additional data, aligned to 8 bytes */
};

/* Options common to all sides of a comparison. */
struct side_options {
    bool is_strict;         /* require a whole journal as it was recorded; otherwise ERR_CHECK */
    const char *scene_path; /* scene to open in place of the name in `open`, or NULL */
    const char *const *channel_path; /* the same for `channel`, ended by NULL; or NULL */
    size_t last;                     /* last record to carry out; 0 for all */
    /* Called in each process before the journal is carried out; or NULL. */
    enum err (*begin)(void *context, const char *journal, struct fault *fault);
    void *context;
    struct watch *watch; /* when it stops, the process is ended: ERR_CANCELLED */
};

/* Additional work of the process; {0} for none. */
struct side_work {
    void *context;
    /* Called after each successful command; or NULL. */
    void (*hear)(void *context, const struct interpreter *interp, const struct reply *reply);
    /* At the end: append additional data to `out`, which may move `label`, the labels described
     * by the facts. Or NULL. */
    enum err (*add)(void *context, const struct interpreter *interp, const struct side_facts *facts,
                    const uint8_t *label, struct buf *out, struct fault *fault);
    uint64_t most; /* bytes that it may append */
};

/* ERR_INPUT if the file cannot be read or carried out, does not reproduce its results, or opens
 * no scene. Words begin with the path. A journal that was edited by hand and reproduces its results
 * is accepted, unless `is_strict`. */
enum err side_carry_out(struct side *side, const char *path, const struct side_options *options,
                        const struct side_work *work, struct fault *fault);
void side_release(struct side *side);

#endif
