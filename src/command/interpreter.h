/* SPDX-License-Identifier: MIT */
/*
 * The interpreter: a session with its journal, and the files that its commands name. Commands come
 * in by interpreter_execute (command/execute.h), for keyboard, script and replay alike; the mode
 * says what is written and what is compared.
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
struct session;

/* What a command answers: text for the user, "key=value" words for the journal. */
struct reply {
    struct buf text;  /* lines, each ended by a line feed, safe to print */
    struct buf words; /* separated by single spaces */
    struct buf canonical;
    struct buf list;  /* of an error: lines to choose from. They may hold what is said of a patient:
                        they are shown, and kept nowhere */
    struct buf files; /* written by the command, by their paths, each ended by NUL */
};

void reply_clear(struct reply *reply);
void reply_release(struct reply *reply);

/* What is done with commands. A replay by a judge of golden images is a verification. */
enum interpreter_mode {
    MODE_LIVE,   /* they are new: recorded, and the files that they name are written */
    MODE_REPLAY, /* of a journal that somebody else may have written: nothing is recorded, files are
                    written only below out_folder */
    MODE_RESUME, /* of the user's own journal: nothing is written, it was when they were new */
    MODE_SKIM,   /* the same, where only what becomes of the session matters: no picture */
};

/* What a command asks of the program. */
enum interpreter_wish { WISH_NONE, WISH_QUIT, WISH_PILOT };

/* Commands that are carried out to be seen and no more (interpreter_sketch). */
struct sketch {
    bool is_begun;
    struct history_place place; /* what was before it */
    struct outlook outlook;
    size_t markers;
};

/* Who hears of each command of a replay that stood. */
struct listener {
    void *context;
    void (*hear)(void *context, const struct interpreter *interp, const struct reply *reply);
};

struct interpreter {
    struct session *session;
    struct history history;
    struct arena arena; /* of the command at hand, which fails where one of its buffers has */
    enum interpreter_mode mode;

    struct journal *journal;    /* where commands are recorded; NULL records nothing */
    const char *new_journal;    /* created with the first command that is recorded, or NULL */
    enum file_sync sync;        /* when what is recorded is synced */
    bool is_read_only;          /* a journal is resumed without being written to: J7 of journal.h */
    bool resumes_in_full;       /* each command is carried out and compared: what records say of
                                   seeds was not enough */
    size_t unrecorded;          /* commands that are in no journal, for the lack of one */
    const char *recorded_words; /* of the record that is resumed at hand, or NULL */
    const char *replayed_words; /* of the record that is replayed at hand, or NULL */
    const struct listener *listener;  /* of a replay, or NULL */
    const struct golden_judge *judge; /* of golden images in a replay; NULL compares none */

    struct buf home;        /* path of the journal at hand: goldens and scenes lie beside it */
    const char *scene_path; /* a scene to open whatever name `open` gives, or NULL */
    const char *out_folder; /* files go there, by their last names; NULL: where they say */

    /* Lists of names, each ended by NUL: of files that this replay has written, and so may replace;
     * of files that the command at hand has written, each followed by its backup ("" where it is
     * new). */
    struct buf made, written;
    struct buf placed; /* pairs of a name and its path below out_folder, each ended by NUL */

    struct image_helper *helper;   /* started on first use */
    struct picture_writer *writer; /* writes pictures beside the session; NULL: a command is
                                      acknowledged when its picture is written */
    struct picture_job *job;       /* of the command at hand, for the writer once it is recorded */

    struct sketch sketch;
    size_t applied;       /* edits that the command at hand has applied before it answered */
    size_t acknowledged;  /* the record of the command that stood last; 0 where it has none */
    uint64_t losses_of;   /* the finish (session_finish_source) whose losses were found last, */
    bool names_loss[256]; /* and the labels that it loses from, which the user has been told */
    bool has_options;     /* what `open` takes is given by options of a program */
    bool has_pilot;  /* somebody sits here: `pilot` can be had, and what is shown is what counts */
    bool has_blocks; /* charts are drawn with the blocks of UTF-8 */
    void (*add_keys)(struct buf *out); /* what `help keys` says here, or NULL */
    enum interpreter_wish wish;
    bool keeps;          /* the command at hand has found a file that it may not replace */
    bool shows_picture;  /* the last command made a picture to be shown inline: */
    struct canvas shown; /* it; no pixels stand for the session's rendition */
};

enum err interpreter_init(struct interpreter *interp, struct fault *fault);
void interpreter_release(struct interpreter *interp);

/* From now on pictures are written beside the session, at a prompt. picture_writer_news says what
 * became of each; one that could not be written changes nothing else: the command stands. */
enum err interpreter_write_beside(struct interpreter *interp, struct fault *fault);

/* Whether the commands are those of a journal that somebody else may have written: then names are
 * looked up, and files written, by the rules of command/trust.h. */
static inline bool interpreter_is_wary(const struct interpreter *interp)
{
    return interp->mode == MODE_REPLAY;
}

/* Has a picture shown inline, which is the interpreter's from now on, until the next command. */
void interpreter_show(struct interpreter *interp, const struct canvas *picture);

/* ---- its journal ---- */

/* Says which journal is at hand, without opening it: goldens and scenes are looked for beside it.
 */
enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault);

/* True where the file at `path` begins as a journal does. */
bool interpreter_is_journal(const char *path);

/* Starts a journal at `path`. */
enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault);

/* A line for the user where the journal's file system has no locks: what stands for one (resuming
 * says it by itself). */
void interpreter_tell_lock(const struct interpreter *interp, struct buf *told);

/*
 * Files that commands name: where they are found, where they may be written, and that those that a
 * command has written stand or fall with it.
 */

/* ---- found ---- */

/* $IFTTY_SCENES: folders separated by colons; Debian's mricron-data by default. */
const char *interpreter_scenes(void);

/* The path under which the scene `name` is found: scene_path; beside the journal; as it stands; in
 * a folder of interpreter_scenes(). Of a wary interpreter: scene_path; below the folder of the
 * journal or of interpreter_scenes(), where a name that leads elsewhere is looked for by its last
 * part; `by_proof`: what it leads to was tried before, by the proof of its record. */
enum err interpreter_find_scene(const struct interpreter *interp, const char *name, bool by_proof,
                                struct buf *path, struct fault *fault);

/* Of a wary interpreter: the path of a regular file elsewhere that the name leads to, which only
 * the proof of its record may have read (T1 of command/trust.h). */
bool interpreter_find_outside(const struct interpreter *interp, const char *name, struct buf *path);

/* Gives a command that is new the name of a file that it reads as the record is to have it: as seen
 * from the folder of the journal, where it lies elsewhere, or below the home folder ("~/"); a whole
 * path where they have no folder in common; as it stands where it is a whole path, or is found
 * beside the journal or among the scenes. ERR_INPUT where there are two files of that name. */
enum err interpreter_settle_name(const struct interpreter *interp, struct call *call,
                                 struct fault *fault);

/* The same for another file that a command reads, which no interpreter->scene_path stands for. */
enum err interpreter_find_file(const struct interpreter *interp, const char *name, struct buf *path,
                               struct fault *fault);

/* Whether a file in the folder of golden images, by its path, may be read (command/trust.h); with
 * *leads_out only golden_refuse_link says what is wrong with it. ERR_INPUT. */
enum err interpreter_may_read(const struct interpreter *interp, const char *path, bool *leads_out,
                              struct fault *fault);

/* ERR_CHECK with the words for every file that a link leads to and that is not what was recorded:
 * nothing is said of it. */
enum err golden_refuse_link(const char *path, struct fault *fault);

/* Where a file that a command names is to be written; an empty path where it is not. Below
 * interpreter->out_folder it has the last part of its name, and names that end alike are told apart
 * by numbers: a/lab.nii is lab.nii, then b/lab.nii is lab-2.nii. */
enum err interpreter_output_path(struct interpreter *interp, const char *name, struct buf *path,
                                 struct fault *fault);

/* ---- files that go with a command ---- */

/* Notes whether a command that is new finds a file in its way, which its writer refuses to replace:
 * its error then ends in the word that replaces it. */
void interpreter_note_kept(struct interpreter *interp, const char *path, enum file_mode mode);

/* Says that the command at hand is about to write `path`: where the command fails or cannot be
 * recorded, a file that was not there goes again, and one that is replaced comes back. */
enum err interpreter_will_write(struct interpreter *interp, const char *path, enum file_mode mode,
                                struct fault *fault);

/* Those files stay as they are now, or are again what they were. A command sees to it by itself. */
void interpreter_settle_files(struct interpreter *interp, bool stands);

#endif
