/* SPDX-License-Identifier: MIT */
/*
 * What a journal or script comes to, as one side of a comparison, or as what a procedure is taken
 * from (src/apply): a process of its own carries it out, by the rules for the journals of others,
 * and hands back bytes: the facts, then, where it went well, a label for each voxel, then what was
 * asked for besides. So nothing of a stranger's journal, nor of the memory it takes, is left when
 * the next one is carried out.
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

struct side_facts { /* from one process of this program to another, so they are sent as they are */
    enum err err;
    char why[sizeof((struct fault *)0)->text];
    uint32_t size[3];
    uint64_t scene_digest;
    char proof[SHA256_HEX];
    struct record_chain chain; /* of the last record */
    size_t voxels, pending, more;
    uint8_t is_edited, is_torn, is_private; /* booleans */
    char label_name[256][LABEL_NAME_BYTES];
    struct palette palette;
};

/* Begins as {0}. */
struct side {
    struct buf bytes;
    /* Places in them, once it was carried out well. */
    const struct side_facts *facts;
    const uint8_t *labels; /* [z][y][x], of the forest */
    const void *more;      /* [facts->more], what was asked for besides; aligned to 8 bytes */
};

/* What all sides of a comparison go by. */
struct side_options {
    bool is_strict; /* it is to be a journal, whole as it was recorded; ERR_CHECK where it is not */
    const char *scene_path; /* a scene to open whatever name `open` gives, or NULL */
    size_t last;            /* no command after this record is carried out; 0 for all */
    /* Called in each process before the journal is carried out; or NULL. */
    enum err (*begin)(void *context, const char *journal, struct fault *fault);
    void *context;
    struct watch *watch; /* when it stops, the process is ended: ERR_CANCELLED */
};

/* What the process does besides; {0} for nothing. */
struct side_work {
    void *context;
    /* After each command that stood; or NULL. */
    void (*hear)(void *context, const struct interpreter *interp, const struct reply *reply);
    /* At the end: adds what is handed back besides; `label` is that of the facts, and may lie
     * elsewhere from the first byte on. Or NULL. */
    enum err (*add)(void *context, const struct interpreter *interp, const struct side_facts *facts,
                    const uint8_t *label, struct buf *out, struct fault *fault);
    uint64_t most; /* bytes that it may add */
};

/* ERR_INPUT for what cannot be read or carried out, gives other results than it says, or opens no
 * scene; words begin with the path. A journal that was edited by hand and gives the results that it
 * records is taken, unless `is_strict`. */
enum err side_carry_out(struct side *side, const char *path, const struct side_options *options,
                        const struct side_work *work, struct fault *fault);
void side_release(struct side *side);

#endif
