/* SPDX-License-Identifier: MIT */
/*
 * Trust: the files that a stranger's journal may reach while it is replayed or verified.
 *
 * Protects against: a journal, which is a program written by a stranger, that reads or overwrites
 * the user's files. It reaches only
 *     (T1) for reading, the files given by --scene and --channel, and regular files below the
 *          folder of the journal or a folder of scenes ($IFTTY_SCENES): no links that lead out of
 *          that folder, no devices, pipes or sockets. An absolute name, or one with ".." or "~/",
 *          is searched there by its last part. With one file of a pair (image/volume.h) the other
 *          one is read under the same rule. A scene may be a folder there (DICOM, say); links in
 *          it are ignored. A file named by a header is read only below the folder of the header
 *          (helper/volume_parts.hh), on every kernel. A library reads files only if the kernel
 *          has Landlock, or with --unconfined. The journal itself may be a link to a journal
 *          anywhere; a link to anything else is treated as missing.
 *              A regular file elsewhere, by its path or behind a link, is read as a scene or a
 *          channel for a record with the SHA-256 of its voxels (`sha256=`), which can only be
 *          written by an owner of the voxels. The content decides, not the name: the file is read
 *          silently, and if its voxels differ (a folder, a device, a file replaced
 *          meanwhile), the result is the same as for a missing file: the same words, the same
 *          status, nothing drawn and nothing written. So nothing is learned about an unknown
 *          file. Parts of a file (crop, reduce, a data set of HDF5, a channel of such a part)
 *          could be guessed voxel by voxel, voxels without a header (raw:) byte by byte, and a
 *          header without voxels by adding voxels next to a link: these are not read this way,
 *          nor are masks, maps and lists.
 *              A golden image, its PNG or a copy of labels may be a link to a regular file. It is
 *          read and compared, and the only message is that it differs from the record;
 *     (T2) for writing, the folder of --out, or a fresh temporary one, by the last part of a name;
 *          only files written by the same replay are overwritten there;
 *     (T3) limited memory, time and output (below).
 * Names are resolved by base/confine.h, which checks the folders and files themselves, not their
 * names. If the kernel has Landlock, T1 and T2 also hold for the process (confine.h), even if a
 * hostile file controls a decoder: outside it can read only the files of `open` and `channel` with
 * a proof, as they resolved before confinement, 16 at most. The helpers are confined further, in
 * every use (wire.hh).
 *
 * The user's own journal, with which a session continues, is not restricted.
 */
#ifndef COMMAND_TRUST_H
#define COMMAND_TRUST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/confine.h"
#include "base/err.h"
#include "base/watch.h"

/* The wanted file, and words for messages: "scene", "was opened". */
struct trust_sought {
    const char *kind, *undone;
    const char *hint; /* "; expected --scene FILE", or "" */
    bool is_scene;    /* may be a folder */
    bool by_proof;    /* treat a file that leads out as missing: it is known not to be the scene */
};

/* path = the file `name` (or the folder, if allowed) below the folder of the journal `home` or a
 * folder of `scenes` (separated by colons), the first that has it. ERR_INPUT for a name that leads
 * out or is no file, ERR_IO if it is missing. */
enum err trust_find(struct buf *path, const char *home, const char *scenes, const char *name,
                    const struct trust_sought *sought, struct fault *fault);

/* path = the regular file outside of those folders that `name` leads to, as a scene whose record
 * has a proof; for a pair, both files. False if it leads anywhere else. */
bool trust_find_outside(struct buf *path, const char *home, const char *scenes, const char *name);

/* True if a file of this name cannot be below any of those folders. */
bool trust_leads_out(const char *name);

/* Check `path`, in the folder of golden images of a journal, which must be below the journal's own
 * folder. *leads_out: the file is a link to a regular file elsewhere, as created by git-annex and
 * workflow engines. The caller may read it, and report only whether it is the recorded picture or
 * labels. */
enum path_kind trust_look_at_golden(const char *path, bool *leads_out);

/* Files needed by a replay; NULL if absent. */
struct trust_places {
    char *const *journal;
    int journals;
    const char *goldens;        /* the folder of golden images, if it may be elsewhere */
    const char *scenes;         /* folders, separated by colons */
    const char *const *given;   /* scenes and channels, ended by NULL: of --scene and --channel, and
                                   those elsewhere with a proof in a record */
    const char *const *linked;  /* files, ended by NULL, behind links among the golden images */
    const char *helper[2];      /* the programs of the helpers for images and for volumes */
    const char *const *written; /* folders to write to, ended by NULL */
};

/* Confine the process to these places until it ends. False, without confinement, if the kernel
 * cannot do it, there are more than 2048 places, or memory runs out. */
bool trust_confine(const struct trust_places *places);

/*
 * Limits of a replay: memory, time and output of a stranger's journal.
 *
 * Protects against: a journal that fills the memory or the disk, or never ends.
 *
 * The limits are global, because memory and time are those of the process.
 *     (L1) memory is checked before a scene is loaded (mem_available), and again during commands;
 *     (L2) time is checked during commands and after each;
 *     (L3) output is checked before a file grows too large, by the kernel (RLIMIT_FSIZE), and after
 *          each command, whose files are then removed;
 *     (L4) exceeding a limit ends the replay with ERR_LIMIT, and the words name the option.
 * The helpers for images and volumes are processes of their own, each with the same limit of
 * memory, but at least 512 MB.
 */

struct limits {
    uint64_t memory_bytes; /* 0: three quarters of the free memory */
    uint64_t time_ms;      /* 0: an hour */
    uint64_t output_bytes; /* 0: 4 GB */
};

/* Read the limits from the texts of options, or NULL: "500M", "2G" (powers of 1000) and "90",
 * "1.5h", "20m", "90s". ERR_USAGE. */
enum err limits_read(struct limits *limits, const char *memory, const char *time,
                     const char *output, struct fault *fault);

/* Enforce these limits from now on. */
void limits_begin(const struct limits *limits);

/* Stop the clock while the program waits for the user. */
void limits_rest(bool rests);

/* True if work must stop, for the poll of a watch. limits_watch is a watch that polls only the
 * limits, or NULL without limits. */
bool limits_stop(void);
struct watch *limits_watch(void);

/* Limit the size of a file that is about to be written to the remaining output. */
void limits_will_write(void);

/* Check the limits after a command that ended with `err`. `written` contains pairs of a path and
 * another text, each ended by NUL. Return the final error. */
enum err limits_judge(enum err err, const struct buf *written, struct fault *fault);

#endif
