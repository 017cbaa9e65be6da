/* SPDX-License-Identifier: MIT */
/*
 * The interpreter: a session with its journal, and the files named by its commands. Prompt, scripts
 * and replay all execute commands by interpreter_execute (command/execute.h); the mode decides
 * about writing and comparing.
 */
#ifndef COMMAND_INTERPRETER_H
#define COMMAND_INTERPRETER_H

#include "base/buf.h"
#include "base/file.h"
#include "base/file_log.h"
#include "render/canvas.h"
#include "session/history.h"

struct call;
struct golden_judge;
struct interpreter;
struct image_helper;
struct journal;
struct picture_job;
struct picture_writer;

/* The result of a command: text for the user, "key=value" words for the journal. */
struct reply {
    struct buf text;  /* lines, each ended by a line feed, safe to print */
    struct buf words; /* separated by single spaces */
    struct buf canonical;
    struct buf list;  /* choices of an error; they may contain patient data and are never stored */
    struct buf files; /* paths of the files written by the command, each ended by NUL */
};

void reply_clear(struct reply *reply);
void reply_release(struct reply *reply);

/* Modes of execution. A replay with a judge of golden images is a verification. */
enum interpreter_mode {
    MODE_LIVE,   /* new commands: recorded, and their files are written */
    MODE_REPLAY, /* a stranger's journal: no recording, files only below out_folder */
    MODE_RESUME, /* the user's own journal: nothing is written again */
    MODE_SKIM,   /* the same without pictures: only the state of the session matters */
};

/* A request of a command to the program. */
enum interpreter_wish { WISH_NONE, WISH_QUIT, WISH_PILOT };

/* Commands that are executed only to be seen (interpreter_sketch). */
struct sketch {
    bool is_begun;
    struct history_place place; /* the state before it */
    struct outlook outlook;
    size_t markers;
};

/* Callback after each successful command of a replay. */
struct listener {
    void *context;
    void (*hear)(void *context, const struct interpreter *interp, const struct reply *reply);
};

struct interpreter {
    struct session *session;
    struct history history;
    struct arena arena; /* owned by the current command, which fails if one of its buffers failed */
    enum interpreter_mode mode;

    struct journal *journal; /* the journal that commands are appended to; NULL records nothing */
    const char *new_journal; /* path of the journal to create at the first record, or NULL */
    struct buf comments;     /* for this record, a line each */
    const char *who;         /* name that signs records (journal_sign), or NULL */
    bool times;              /* records are signed with their times */
    enum file_sync sync;     /* when records are synced */
    bool is_read_only;       /* the resumed journal is not written to: J7 of journal.h */
    bool resumes_in_full;    /* resume by executing and comparing each command */
    size_t unrecorded;       /* number of commands in no journal */
    const char *recorded_words;       /* while a record is resumed, or NULL */
    const char *replayed_words;       /* while a record is replayed, or NULL */
    const struct listener *listener;  /* called in a replay, or NULL */
    const struct golden_judge *judge; /* judges golden images in a replay; NULL compares none */

    struct buf home; /* path of the current journal: golden images and scenes are next to it */
    const char *scene_path; /* the scene to open in place of any name given to `open`, or NULL */
    const char *const
        *channel_path;      /* files to read for the next recorded `channel FILE` commands, in
                               place of their names, ended by NULL; or NULL */
    const char *out_folder; /* folder for all files, by their last names; NULL: names as given */

    /* Lists of names, each ended by NUL. `made`: files written by this replay, which it may
     * replace. `written`: files written by the current command, each followed by its backup ("" for
     * a new file). */
    struct buf made, written;
    struct buf placed; /* pairs of a name and its path below out_folder, each ended by NUL */

    struct image_helper *helper;   /* started on first use */
    struct picture_writer *writer; /* writes pictures in the background, at a prompt, or NULL: a
                                      failed picture does not undo its command */
    struct picture_job *job;       /* picture of the current command, queued once it is recorded */

    struct sketch sketch;
    size_t applied;       /* number of pending edits that the current command applied first */
    size_t acknowledged;  /* record of the last successful command; 0 if it has none */
    uint64_t losses_of;   /* the finish (session_finish_source) of the last search for losses, */
    bool names_loss[256]; /* and the labels with a loss, which the user has seen */
    bool has_options;     /* the parameters of `open` come from options of a program */
    bool has_channels;    /* the command line names channels */
    bool has_pilot;       /* at a terminal: `pilot` is available, shown labels are the default */
    bool has_blocks;      /* charts are drawn with the blocks of UTF-8 */
    void (*add_keys)(struct buf *out); /* adds the text of `help keys`, or NULL */
    void (*add_terminal)(const void *terminal, struct buf *out); /* adds lines of `info`, or NULL */
    const void *terminal;
    enum interpreter_wish wish;
    bool found_existing; /* the current command has found a file that it must not replace */
    bool shows_picture;  /* the last command made a picture to show inline: */
    struct canvas shown; /* it, until the next command; without pixels, the session's rendition */
};

enum err interpreter_init(struct interpreter *interp, struct fault *fault);
void interpreter_release(struct interpreter *interp);

/* True while executing a stranger's journal: names are resolved and files written by the rules of
 * command/trust.h. */
static inline bool interpreter_is_wary(const struct interpreter *interp)
{
    return interp->mode == MODE_REPLAY;
}

/* ---- its journal ---- */

/* Set the path of the current journal without opening it: golden images and scenes are searched
 * next to it. */
enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault);

/* True if the file at `path` begins like a journal. */
bool interpreter_is_journal(const char *path);

/* True for a comment line that a script or prompt stores with the next record: not the header of a
 * journal, nor a line that signs another record. */
bool interpreter_is_comment(const char *line);

/* Store such a line; does nothing with others, or while no journal is written. */
enum err interpreter_comment(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault);

/* Create a journal at `path`. */
enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault);

/* Add a line if the journal's file system has no locks: the name of the lock file (resuming adds it
 * itself). */
void interpreter_write_lock(const struct interpreter *interp, struct buf *told);

/*
 * Files named by commands: where they are found and where they may be written. Files written by a
 * command are removed again if it fails.
 */

/* ---- found ---- */

/* $IFTTY_SCENES: folders separated by colons; by default Debian's mricron-data. */
const char *interpreter_scenes(void);

/* Find the path of the scene `name`, or of the file of a channel: scene_path, or for a recorded
 * channel the first of channel_path; next to the journal; as given; in a folder of
 * interpreter_scenes(). In a wary interpreter: scene_path or channel_path; below the folder of the
 * journal or of interpreter_scenes(), where a name that leads elsewhere is searched by its last
 * part. `by_proof`: the file elsewhere has already been tried by the proof of its record. */
enum err interpreter_find_scene(const struct interpreter *interp, bool is_channel, const char *name,
                                bool by_proof, struct buf *path, struct fault *fault);

/* In a wary interpreter: find the path of a regular file elsewhere that may be read only with the
 * proof of its record (T1 of command/trust.h). */
bool interpreter_find_outside(const struct interpreter *interp, bool is_channel, const char *name,
                              struct buf *path);

/* Rewrite the name of the file that a new command reads for the record: relative to the folder of
 * the journal if it is elsewhere, or below the home folder ("~/"); absolute if they have no folder
 * in common; unchanged if it is absolute or is found next to the journal or among the scenes.
 * ERR_INPUT if two files have that name. */
enum err interpreter_settle_name(const struct interpreter *interp, struct call *call,
                                 struct fault *fault);

/* As interpreter_find_scene, for another file that a command reads: without scene_path and
 * channel_path. */
enum err interpreter_find_file(const struct interpreter *interp, const char *name, struct buf *path,
                               struct fault *fault);

/* Check that a file in the folder of golden images may be read (command/trust.h). With *leads_out,
 * report errors by golden_refuse_link only. ERR_INPUT. */
enum err interpreter_may_read(const struct interpreter *interp, const char *path, bool *leads_out,
                              struct fault *fault);

/* ERR_CHECK with the same words for every file behind a link that differs from the record, so that
 * nothing is learned about the file. */
enum err golden_refuse_link(const char *path, struct fault *fault);

/* Find the path for a file that a command writes; empty if it is not written. Below
 * interpreter->out_folder it has the last part of its name, and equal names are numbered: a/lab.nii
 * is lab.nii, then b/lab.nii is lab-2.nii. */
enum err interpreter_output_path(struct interpreter *interp, const char *name, struct buf *path,
                                 struct fault *fault);

/* ---- files that go with a command ---- */

/* Note whether a new command finds an existing file that its writer must not replace: its error
 * then ends with "replace=yes overwrites it". */
void interpreter_note_existing(struct interpreter *interp, const char *path, enum file_mode mode);

/* Announce that the current command is about to write `path`. If the command fails or cannot be
 * recorded, a new file is removed and a replaced one is restored. */
enum err interpreter_will_write(struct interpreter *interp, const char *path, enum file_mode mode,
                                struct fault *fault);

/* Keep these files, or restore the previous ones. The interpreter calls it at the end of each
 * command. */
void interpreter_settle_files(struct interpreter *interp, bool succeeded);

#endif
