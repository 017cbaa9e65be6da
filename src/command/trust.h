/* SPDX-License-Identifier: MIT */
/*
 * Trust: what the journal of somebody else may reach while it is replayed or verified.
 *
 * Protects against: a journal, which is a program that we did not write, that reads or overwrites
 * the user's files. It reaches no more than
 *     (T1) for reading, the scene that was given by --scene, and regular files below the folder of
 *          the journal or a folder of scenes ($IFTTY_SCENES): no links that lead out of that
 *          folder, no devices, pipes or sockets; what an absolute name, one with ".." or one with
 *          "~/" names is looked for there by the last part. With one file of a pair (image/nifti.h)
 *          the other is read, of which the same holds. A scene may be a folder there (of DICOM,
 *          say), in which links are left alone. What a header names is read below the folder of the
 *          header alone (helper/volume_parts.hh), on every kernel. A library reads only where the
 *          kernel has Landlock, or the user says --unconfined. The journal itself may be a link to
 *          one that lies anywhere; anything else there is as if it were nothing.
 *              A regular file anywhere else, by its path or behind a link, is read as a scene for a
 *          record that has the SHA-256 of its voxels (`sha256=`), which only somebody who has them
 *          can write. What is there decides, and not its name: it is read in silence, and where it
 *          is not that scene, whatever else it is, a folder, a device, or something that was put in
 *          its place meanwhile, all is as if there were nothing: the same words, the same status,
 *          nothing drawn and nothing written. So no one learns of a file what he does not know. A
 *          part of it (crop, reduce, a data set of HDF5) could be guessed voxel by voxel, voxels
 *          without a header (raw:) byte by byte, and a header without voxels by one's own voxels
 *          beside a link: these are not read so, nor are masks, maps and lists.
 *              A golden image, its PNG or a copy of labels may be a link to a regular file. It is
 *          read and compared, and where it is not what was recorded, that alone is said;
 *     (T2) for writing, the folder of --out, or a fresh temporary one, by the last part of a name;
 *          nothing there is overwritten but what the same replay has written;
 *     (T3) so much memory, time and output (trust.h).
 * Names are resolved by base/confine.h; what is checked is the folder and file themselves, not
 * their names. Where the kernel has Landlock, T1 and T2 hold for the process itself as well
 * (confine.h), even if a hostile file takes a decoder over: of what lies elsewhere, it reaches the
 * one file that the first `open` with a proof led to when the process was confined. The helpers are
 * confined further, and in every use (wire.hh).
 *
 * The user's own journal, with which a session continues, is not restricted.
 */
#ifndef SANDBOX_TRUST_H
#define SANDBOX_TRUST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/confine.h"
#include "base/err.h"
#include "base/watch.h"

/* What is looked for, and for the words: "scene", "was opened". */
struct trust_sought {
    const char *kind, *undone;
    bool is_scene; /* which may be a folder, and can be given by --scene */
    bool by_proof; /* what leads out is as if it were not there: it is known not to be the scene */
};

/* path = the file `name` (or the folder, if that is taken too) below the folder of the journal
 * `home`, or of a folder of `scenes` (separated by colons), the first that has it. ERR_INPUT for a
 * name that leads out or is no file, ERR_IO where there is none. */
enum err trust_find(struct buf *path, const char *home, const char *scenes, const char *name,
                    const struct trust_sought *sought, struct fault *fault);

/* path = the regular file that `name` leads to, out of those folders, as a scene whose record has a
 * proof: of a pair, both are. False where it leads nowhere else, or to anything else. */
bool trust_find_outside(struct buf *path, const char *home, const char *scenes, const char *name);

/* Whether the name of a file can only be of one that is not below any of those folders. */
bool trust_leads_out(const char *name);

/* Looks at `path`, in the folder of golden images of a journal, which has to be below the journal's
 * own. *leads_out: the file is a link to a regular file elsewhere, as git-annex and workflow
 * engines make them. The caller may read that, and says nothing of it but that it is the picture,
 * or the labels, that were recorded. */
enum beneath trust_look_at_golden(const char *path, bool *leads_out);

/* What a replay needs: NULL for what there is not. */
struct trust_places {
    char *const *journal;
    int journals;
    const char *goldens;        /* the folder of golden images, where it may lie elsewhere */
    const char *scene, *scenes; /* --scene; folders, separated by colons */
    const char *outside;        /* a scene elsewhere, of which a record has a proof */
    const char *const *linked;  /* files, ended by NULL, that links among golden images lead to */
    const char *helper[2];      /* the programs of the helpers for images and for volumes */
    const char *const *written; /* folders, ended by NULL, that the user wants written */
};

/* Confines the process to these places until it ends. False, and nothing is confined, where the
 * kernel cannot, or where they are more than some 250 folders. */
bool trust_confine(const struct trust_places *places);

/*
 * Limits of a replay: how much memory, time and output the journal of somebody else may take.
 *
 * Protects against: a journal that fills the memory or the disk, or never ends.
 *
 * One set for the process, because memory and time are the process's.
 *     (L1) memory is checked before a scene is loaded (mem_available), and again while commands
 *          work;
 *     (L2) time is checked while commands work and after each;
 *     (L3) output is checked before a file grows too large, by the kernel (RLIMIT_FSIZE), and after
 *          each command, whose files are removed again;
 *     (L4) what is beyond a limit ends the replay with ERR_LIMIT, and words that name the option.
 * The image helper is a process of its own, and may hold as much memory again, or 512 MB where that
 * is more.
 */

struct limits {
    uint64_t memory_bytes; /* 0: three quarters of what is free at the beginning */
    uint64_t time_ms;      /* 0: an hour */
    uint64_t output_bytes; /* 0: 4 GB */
};

/* Texts as options give them, or NULL: "500M", "2G" (powers of 1000) and "90", "1.5h", "20m",
 * "90s". ERR_USAGE. */
enum err limits_read(struct limits *limits, const char *memory, const char *time,
                     const char *output, struct fault *fault);

/* From now on they hold. */
void limits_begin(const struct limits *limits);

/* While a person looks at what the journal has come to, or thinks, its time stands still. */
void limits_rest(bool rests);

/* Whether the work is to stop, for the poll of a watch; limits_watch is a watch that polls nothing
 * else, or NULL where no limits hold. */
bool limits_stop(void);
struct watch *limits_watch(void);

/* A file is about to be written: it cannot grow beyond what is left. */
void limits_will_write(void);

/* A command has ended with `err`, and has written files: pairs of a path and another text, each
 * ended by NUL. What it is to end with. */
enum err limits_judge(enum err err, const struct buf *written, struct fault *fault);

#endif
