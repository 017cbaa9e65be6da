/*
 * Trust: what the journal of somebody else may reach while it is replayed or verified.
 *
 * Protects against: a journal, which is a program that we did not write, that reads or overwrites
 * the user's files. It reaches no more than
 *     (T1) for reading, the scene that was given by --scene, and regular files below the folder of
 *          the journal or a folder of scenes ($IFTTY_SCENES): no links that lead out of that
 *          folder, no devices, pipes or sockets; what an absolute name or one with ".." names is
 *          looked for there by the last part. With one file of a pair (image/pair.h) the other is
 *          read, of which the same holds. A scene may be a folder there (of DICOM, say), in which
 *          links are left alone;
 *     (T2) for writing, the folder of --out, or a fresh temporary one, by the last part of a name;
 *          nothing there is overwritten but what the same replay has written;
 *     (T3) so much memory, time and output (limits.h).
 * Names are resolved by openat2 with RESOLVE_BENEATH, or, where the kernel does not have it, step
 * by step without following any link; what is checked is the folder and file themselves, not their
 * names. Where the kernel has Landlock, T1 and T2 hold for the process itself as well (confine.h),
 * even if a hostile file takes a decoder over. The helpers are confined further, and in every use
 * (wire.hh).
 *
 * The user's own journal, with which a session continues, is not restricted.
 */
#ifndef SANDBOX_TRUST_H
#define SANDBOX_TRUST_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

/* path = the file `name` (or the folder, if that is taken too) below the folder of the journal
 * `home`, or of a folder of `scenes` (separated by colons), the first that has it. `kind` and
 * `undone` are for the words: "scene", "was opened". ERR_INPUT for a name that leads out or is no
 * file, ERR_IO where there is none. */
enum err trust_find(struct buf *path, const char *home, const char *scenes, const char *name,
                    const char *kind, const char *undone, bool takes_folders, struct fault *fault);

/* What a replay needs: NULL for what there is not. */
struct trust_places {
    char *const *journal;
    int journals;
    const char *goldens;        /* the folder of golden images, where it may lie elsewhere */
    const char *scene, *scenes; /* --scene; folders, separated by colons */
    const char *helper[2];      /* the programs of the helpers for images and for volumes */
    const char *const *written; /* folders, ended by NULL, that the user wants written */
    const char *const *run;     /* programs, ended by NULL, that the user wants run: they may read
                                   their folders, and run the system's programs, being scripts */
};

/* Confines the process to these places until it ends. False, and nothing is confined, where the
 * kernel cannot, or where they are more than some 250 folders. */
bool trust_confine(const struct trust_places *places);

#endif
