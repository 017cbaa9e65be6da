/* SPDX-License-Identifier: MIT */
/*
 * Files in a journal's folder of golden images: the one place that decides which belong to the
 * journal. Every writer and every remover of such a file asks here.
 *
 * Protects against: a stranger's journal whose folder leads to files of the user, which a
 * verification would list, and --remove-orphans, --accept, --reseal or resuming would remove or
 * replace.
 *
 *     (F1) The folder is a real one. Where its name is a link, nothing in it belongs to the
 *          journal: nothing there is listed, written, replaced or removed. It is opened once, and
 *          files in it are looked at and removed by that descriptor, so that a link that takes its
 *          place meanwhile changes nothing.
 *     (F2) A file belongs to the journal by its name and by what the file itself says, below.
 *     (F3) Only FILE_LEFTOVER and FILE_STRAY are removed. A file that is a link is neither. A
 *          golden image that is a link is read, and accepting replaces the link.
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
    int folder;               /* descriptor; -1 where there is none */
    struct buf path;          /* of the folder, for messages and for names that `golden` makes */
    struct buf name;          /* that pictures have of the journal */
    struct buf named;         /* files of its records, each ended by NUL */
    struct buf chains;        /* of its records: char[RECORD_CHAIN_DIGITS + 1] each, sorted */
    struct record_chain last; /* of the last record */
};

/* Opens the folder of the journal at that path. ERR_INPUT where its name is a link, or is of no
 * folder. Always call golden_files_close. */
enum err golden_files_open(struct golden_files *files, const char *journal, struct fault *fault);

/* The same for a writer: makes the folder where there is none. */
enum err golden_files_make(struct golden_files *files, const char *journal, struct fault *fault);

/* Reads from the bytes of the journal which files its records name, and their chains. */
enum err golden_files_read(struct golden_files *files, const char *bytes, size_t length,
                           struct fault *fault);
void golden_files_close(struct golden_files *files);

enum file_of {
    FILE_NAMED,    /* NAME.exr or NAME.png of a record `golden NAME`; a copy that a record names */
    FILE_HIDDEN,   /* its name begins with a dot: a draft, which goes with its process */
    FILE_LEFTOVER, /* an image that no record names, made after the journal's last record */
    FILE_STRAY,    /* an image that no record names, whose notes name the journal or a record */
    FILE_FOREIGN   /* anything else */
};

/* Decides about the file of that name, after golden_files_read. Images are read as far as their
 * notes. */
enum file_of golden_files_judge(const struct golden_files *files, const char *name);

/* Removes that file, and of an image NAME.exr NAME.png as well, where F3 allows it; else
 * ERR_CHECK. A file that is gone is fine. */
enum err golden_files_remove(const struct golden_files *files, const char *name,
                             struct fault *fault);

/* Makes the folder `to`, which must not exist, with the files that records name, after
 * golden_files_read; of a link a link, so that nothing is copied that it leads to. On failure there
 * is no `to`. */
enum err golden_files_copy(const struct golden_files *files, const char *to, struct fault *fault);

/* Removes the images that are FILE_LEFTOVER beside a journal that is being continued, and says so.
 * `bytes` are those of the journal. */
void golden_files_clear(const char *journal, const char *bytes, size_t length, struct buf *told);

/*
 * Golden images beside their journal: who judges them, and what they must say. Which files there
 * belong to a journal is command/golden_files.h.
 *
 * `golden NAME` writes a file in a plain session. In a replay it compares what is drawn with that
 * file, where the interpreter has a judge, and the judge is asked what follows from a difference:
 * src/verify has one that leaves evidence for a person, and one that accepts the new picture. The
 * commands know neither.
 */

struct interpreter;

/* A golden image that is missing, cannot be read, or shows something else. Borrowed. */
struct golden_finding {
    const char *name, *path;        /* of the golden image; its place beside the journal */
    struct picture *actual;         /* to which notes may be added */
    const struct picture *expected; /* NULL where none can be read */
    const struct golden_difference *difference; /* NULL likewise */
};

struct golden_judge {
    void *context;
    /* The file that is compared instead of the one at `path`; NULL: that one. */
    const char *(*source)(void *context, const char *path);
    /* Called where every plane of every pixel is the same, for what else there is to ask. NULL:
     * OK. */
    enum err (*is_same)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
    /* Called with what is wrong in `fault`. OK, with an empty fault, where the picture is taken
     * in; ERR_CHECK, with the fault as it was or in better words, where not. NULL: ERR_CHECK. */
    enum err (*differs)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
};

/* ---- notes ---- */

/*
 * The words that a golden image carries beside its pixels (show/export_picture.h) are those that
 * the picture drawn now would carry, and none is missing. Which journal it was of, at which record,
 * and which version drew it, is of the time at which it was made: of those only the form is looked
 * at.
 */

/* Whether it is one of those, and of their form. */
bool golden_note_is_of_its_time(const struct attribute *note);

/* OK, or ERR_CHECK with the first that differs. Of a scene that was opened in place of another the
 * name counts for nothing (!names_scene). */
enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault);

#endif
