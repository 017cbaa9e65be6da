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

#endif
