/* SPDX-License-Identifier: MIT */
/*
 * Files in a journal's folder of golden images: the only code that decides which of them belong to
 * the journal. Every writer and every remover of such a file calls it.
 *
 * Protects against: a stranger's journal whose folder leads to files of the user, which a
 * verification would list, and --remove-orphans, --accept, --reseal or resuming would remove or
 * replace.
 *
 *     (F1) The folder is a real one. If its name is a link, nothing in it belongs to the journal:
 *          nothing in it is listed, written, replaced or removed. It is opened once, and files in
 *          it are examined and removed through that descriptor, so that replacing the folder by a
 *          link has no effect.
 *     (F2) A file belongs to the journal by its name and by its own notes, below.
 *     (F3) Only FILE_LEFTOVER and FILE_STRAY are removed, and with such an image its PNG, if that
 *          is one of them or empty. A file that is a link is neither. A golden image that is a link
 *          is read, and accepting replaces the link.
 */
#ifndef COMMAND_GOLDEN_FILES_H
#define COMMAND_GOLDEN_FILES_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/picture.h"
#include "journal/golden.h"
#include "journal/record.h"

struct golden_files {
    int folder;               /* descriptor, or -1 */
    struct buf path;          /* the folder, for messages and names of new images */
    struct buf name;          /* the journal's name in the notes of pictures */
    struct buf named;         /* files named by its records, each ended by NUL */
    struct buf chains;        /* chains of its records: char[RECORD_CHAIN_DIGITS + 1], sorted */
    struct record_chain last; /* chain of the last record */
};

/* Open the folder of the journal at that path; a writer also `makes` it if it does not exist.
 * ERR_INPUT if its name is a link or no folder, ERR_IO, ERR_MEMORY. Without a folder, OK and -1.
 * Always call golden_files_close. */
enum err golden_files_open(struct golden_files *files, const char *journal, bool makes,
                           struct fault *fault);

/* Read the files named by the records of a journal, and the chains of the records. */
enum err golden_files_read(struct golden_files *files, const char *bytes, size_t length,
                           struct fault *fault);
void golden_files_close(struct golden_files *files);

enum file_of {
    FILE_NAMED,    /* NAME.exr or NAME.png of a record `golden NAME`; a copy that a record names */
    FILE_HIDDEN,   /* its name begins with a dot: a draft, which is removed with its process */
    FILE_LEFTOVER, /* an image that no record names, made after the journal's last record */
    FILE_STRAY,    /* an image that no record names, whose notes name the journal or a record */
    FILE_FOREIGN   /* anything else */
};

/* Classify the file of that name, after golden_files_read. Images are read up to their notes. */
enum file_of golden_files_judge(const struct golden_files *files, const char *name);

/* Remove the file, and for an image NAME.exr also NAME.png, if F3 allows it; else ERR_CHECK. A
 * missing file is fine. */
enum err golden_files_remove(const struct golden_files *files, const char *name,
                             struct fault *fault);

/* Create the folder `to`, which must not exist, with the files named by records, after
 * golden_files_read. A link is copied as a link, not its content. On failure `to` does not
 * exist. */
enum err golden_files_copy(const struct golden_files *files, const char *to, struct fault *fault);

/* Remove the images that are FILE_LEFTOVER next to a journal that is being resumed, and add a line
 * for each. `bytes` are those of the journal. */
void golden_files_clear(const char *journal, const char *bytes, size_t length, struct buf *told);

/*
 * Comparison of golden images.
 *
 * `golden NAME` writes a file in a plain session. In a replay it compares the new picture with that
 * file if the interpreter has a judge, and the judge decides about a difference: src/verify has a
 * judge that writes evidence and one that accepts the new picture. The commands know neither.
 */

struct interpreter;

/* A golden image that is missing, unreadable or different. Borrowed. */
struct golden_finding {
    const char *name, *path;        /* name of the golden image; its path next to the journal */
    struct picture *actual;         /* notes may be added */
    const struct picture *expected; /* NULL if it cannot be read */
    const struct golden_difference *difference; /* NULL if it cannot be read */
};

struct golden_judge {
    void *context;
    /* Return the file to compare in place of the one at `path`; NULL: `path` itself. */
    const char *(*source)(void *context, const char *path);
    /* Called if every plane of every pixel is the same. NULL: OK. */
    enum err (*is_same)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
    /* Called with the difference in `fault`. Return OK and an empty fault if the new picture is
     * accepted; else ERR_CHECK, with the same or better words. NULL: ERR_CHECK. */
    enum err (*differs)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
};

/* ---- notes ---- */

/*
 * A golden image must have the same notes (show/export_picture.h) as the new picture, and none may
 * be missing. Only the form is checked of the notes about the time of writing: the journal, its
 * record and the version of the program.
 */

/* True for a valid note about the time of writing. */
bool golden_note_is_of_its_time(const struct attribute *note);

/* Compare the notes; ERR_CHECK with the first difference. Without names_scene, the name of the
 * scene may differ, since another scene was opened in its place. */
enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault);

#endif
