/* SPDX-License-Identifier: MIT */
/*
 * Verification of journals: replay each in a process of its own, compare every result and golden
 * image, and print the outcome as TAP in the order of the files.
 *
 * A journal is untrusted, so each has its own process: a process that crashes, or is killed for its
 * memory, is one failure with its signal named, and the other journals are verified. Results return
 * through a pipe (verify_inside.h); all reports read the same array of results.
 */
#ifndef VERIFY_VERIFY_H
#define VERIFY_VERIFY_H

#include "command/script.h"
#include "verify/process.h"
#include "verify/side.h"

struct verify_options {
    char *const *path; /* paths of the journals */
    size_t count;
    const char *scene_path;          /* scene to open in place of the name in `open`, or NULL */
    const char *const *channel_path; /* the same for `channel`, ended by NULL; or NULL */
    const char *evidence_folder;     /* folder for evidence of golden images that differ, or NULL;
                                    journals of equal names use subfolders N/ for the Nth of
                                    `path` */
    const char *junit, *html;        /* reports that replace existing files, or NULL */
    bool json;                       /* print one JSON object instead of TAP */
    bool strict;                     /* fail on incomplete evidence */
    bool fail_fast;                  /* end at the first failure and skip the remaining journals */
    bool timings;                    /* print the slowest records of each journal */
    bool removes_orphans;            /* remove the orphans of journals that verify otherwise */
    const char *expect;              /* expected last chain of the only journal, or NULL */
    size_t first, last;              /* records to compare; 0 for all */
    size_t processes;                /* processes at once, 1..PROCESSES_MOST; 0: one */
    /* Called in the process of each journal before it is carried out; or NULL. An error is the
     * result. */
    enum err (*begin)(void *context, const char *journal, struct fault *fault);
    void *context;
    struct watch *watch; /* when it stops, all processes are ended: ERR_CANCELLED */
};

/* True in a run without a person: the environment variable CI is not empty, as set by services
 * that run tests. Then verification is strict, and decisions of a person are rejected. */
bool ci_is_set(void);

/* ERR_CHECK if anything differs, a golden image is missing, or the journal names no command for
 * an image (known only after a replay to the end, without `last`); otherwise the worst error. */
enum err verify_files(const struct verify_options *options, const struct printer *printer,
                      struct fault *fault);

/* Print the first record that differs as TAP of one test. OK if both journals have the same
 * records, ERR_CHECK if one differs, ERR_INPUT for a journal that is not sound. */
enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault);

/*
 * Resealing a journal: the honest way to change one. Carry it out again. Every record with another
 * result receives that of today, and a comment with the reason and the former result. The former
 * journal is stored next to it. Nothing else changes.
 *
 *     # accepted: softer light (golden image left: 512 pixels differ, first column 3, row 4: ...)
 *     # it was: chain=<32 digits> picture=0123456789abcdef
 *     golden left
 *     = 12 picture=fedcba9876543210 chain=<32 digits>
 *
 * A journal names its golden images, so accepting one changes the journal, even if only the file is
 * drawn again: the reason becomes part of the chain.
 *
 * Promises
 *     (R1) whole or not at all: golden images and journal are all unchanged, or all new;
 *     (R2) the result verifies with this build, except for pictures that are not accepted;
 *     (R3) the bytes of the former journal remain, as FILE.before-N;
 *     (R4) no other process writes the journal meanwhile.
 */

/* `iftty verify --accept WHY`: draw golden images that differ or are missing again, and update
 * the digests in records of pictures. Rejected if a record has another result that is not of a
 * picture, if the journal was edited, if its folder has an orphan (ERR_CHECK), and if the
 * environment variable CI is set (ERR_USAGE): accepting is a person's decision. `only`, or NULL:
 * names of the golden images to accept, as "first,second". All other pictures and their records are
 * unchanged; ERR_CHECK if any of them differs, after the named ones were accepted. ERR_USAGE for a
 * name that the journal does not have. */
enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const char *only, const struct printer *printer, struct fault *fault);

/* `iftty log --reseal`: recompute the results of a journal that was edited by hand or written by
 * another version. With a reason, `--accept WHY`, accept its pictures in the same step. Without a
 * reason golden images are unchanged, and the different ones are counted. */
enum err reseal_edited(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault);

/*
 * Comparison of two journals or scripts: the first command that differs, and the difference of
 * their final labels.
 *
 * Each is carried out in a process of its own, under the rules for untrusted journals, B first:
 * while A is carried out, only B's labels, names and colours are kept, a byte per voxel. The
 * process of A has the scene and draws the picture. That picture is the only file written, by the
 * process that asked for it.
 */

struct diff_options {
    const char *path[2];
    struct side_options side;
    const char *picture; /* a file that does not exist yet, or NULL */
    bool json;
};

/* Print the differences. OK if the labels are the same, ERR_CHECK if not. ERR_INPUT if a file
 * cannot be read or carried out, does not reproduce its results, opens no scene, or opens one of
 * another size than the other file. */
enum err diff_journals(const struct diff_options *options, const struct printer *printer,
                       struct fault *fault);

/* ---- pages: one HTML file, without scripts, whose policy lets a browser fetch nothing ---- */

/* Add text between tags or in a quoted attribute: the only way by which untrusted bytes reach a
 * report. Bytes that are not printable UTF-8 become \xNN, as on a terminal (base/safe.h), so that
 * the rest is valid XML; then & < > " ' become entities. A line feed is kept.
 * Markup `after` follows as it is. */
void markup_add(struct buf *out, const char *text, const char *after);

void page_begin(struct buf *out, const char *title);
void page_end(struct buf *out);

/* Add a figure with its caption; `png` is the file's bytes. */
void page_add_picture(struct buf *out, const char *caption, const struct buf *png);

#endif
