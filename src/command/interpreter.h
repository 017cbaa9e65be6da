/*
 * The interpreter: a session with its journal, and the one way in for commands.
 *
 * Keyboard, script and replay all call interpreter_execute. A command is carried out, recorded (if
 * it changes something), and only then acknowledged; when the record cannot be written, the session
 * is taken back to before it, and so it is where the session's watch stops it. The mode says what
 * is written and what is compared.
 */
#ifndef COMMAND_INTERPRETER_H
#define COMMAND_INTERPRETER_H

#include "base/file.h"
#include "command/command.h"
#include "command/golden_judge.h"
#include "image/helper.h"
#include "image/picture_writer.h"
#include "journal/journal.h"
#include "render/canvas.h"
#include "session/history.h"

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

struct interpreter {
    struct session *session;
    struct history history;
    enum interpreter_mode mode;

    struct journal *journal;    /* where commands are recorded; NULL records nothing */
    const char *new_journal;    /* created with the first command that is recorded, or NULL */
    enum file_sync sync;        /* when what is recorded is synced */
    bool is_read_only;          /* a journal is resumed without being written to: J7 of journal.h */
    size_t unrecorded;          /* commands that are in no journal, for the lack of one */
    const char *recorded_words; /* of the record that is resumed at hand, or NULL */
    const char *replayed_words; /* of the record that is replayed at hand, or NULL */
    const struct golden_judge *judge; /* of golden images in a replay; NULL compares none */

    struct buf home;        /* path of the journal at hand: goldens and scenes lie beside it */
    const char *scene_path; /* a scene to open whatever name `open` gives, or NULL */
    const char *out_folder; /* files go there, by their last names; NULL: where they say */

    /* Lists of names, each ended by NUL: of golden images so far; of files that this replay has
     * written, and so may replace; of files that the command at hand has written, each followed by
     * its backup ("" where it is new). */
    struct buf goldens, made, written;
    struct buf placed; /* pairs of a name and its path below out_folder, each ended by NUL */

    struct image_helper *helper;   /* started on first use */
    struct picture_writer *writer; /* writes pictures beside the session; NULL: a command is
                                      acknowledged when its picture is written */
    struct picture_job *job;       /* of the command at hand, for the writer once it is recorded */

    struct sketch sketch;
    size_t applied;      /* edits that the command at hand has applied before it answered */
    size_t acknowledged; /* the record of the command that stood last; 0 where it has none */
    bool has_pilot;      /* `pilot` can be had here */
    bool has_blocks;     /* charts are drawn with the blocks of UTF-8 */
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

/* ---- the one way in (execute.c) ---- */

/* Carries one line out. `reply` is cleared first. An empty line or a comment does nothing, and
 * leaves reply->canonical empty. On error nothing has changed.
 *
 * What shows, writes or answers from labels (COMMAND_ANSWERS) first applies the edits that wait. A
 * question, which has no record, then has that of a run, RUN_FOR and its name. */
#define RUN_FOR "run for="
enum err interpreter_execute(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault);
void reply_clear(struct reply *reply);
void reply_release(struct reply *reply);

/* ---- sketches (execute.c) ---- */

/* Carries out a command of those that can be sketched (else ERR_USAGE) without recording it, so
 * that one sees what a pen draws before it is lifted: then the one command comes that all of it
 * stands for. No other command finds the sketch in place: it is dropped first, and the session is
 * what it was before, bit for bit. */
enum err interpreter_sketch(struct interpreter *interp, const char *line, struct fault *fault);

/* Fine where there is none. ERR_MEMORY leaves it in place. */
enum err interpreter_drop_sketch(struct interpreter *interp, struct fault *fault);

/* Adds what a record says of the forest, after a command that edits it. */
void execute_add_digests(struct reply *reply, const struct session *session);

/* Has a picture shown inline, which is the interpreter's from now on, until the next command. */
void interpreter_show(struct interpreter *interp, const struct canvas *picture);

/* ---- journals (resume.c) ---- */

/* Starts a journal at `path`, or resumes it and goes on recording there. Resuming skims: every
 * command changes seeds and settings, the forest is computed once, and compared with what the last
 * record says of it. Where that is not the same, the commands are carried out and compared one by
 * one, to say which of them differs. `told` gets lines for the user. */
enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault);
enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

/* The same with every command carried out and compared. */
enum err interpreter_resume_in_full(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

/* A line for the user where the journal's file system has no locks: what stands for one (resuming
 * says it by itself). */
void interpreter_tell_lock(const struct interpreter *interp, struct buf *told);

/* ---- where files are (paths.c) ---- */

/* Says which journal is at hand, without opening it: goldens and scenes are looked for beside it.
 */
enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault);

/* True where the file at `path` begins as a journal does. */
bool interpreter_is_journal(const char *path);

/* Whether the commands are those of a journal that somebody else may have written: then names are
 * looked up, and files written, by the rules of sandbox/trust.h. */
static inline bool interpreter_is_wary(const struct interpreter *interp)
{
    return interp->mode == MODE_REPLAY;
}

/* $IFTTY_SCENES: folders separated by colons; Debian's mricron-data by default. */
const char *interpreter_scenes(void);

/* The path under which the scene `name` is found: scene_path; beside the journal; as it stands; in
 * a folder of interpreter_scenes(). Of a wary interpreter: scene_path; below the folder of the
 * journal or of interpreter_scenes(), where a name that leads elsewhere is looked for by its last
 * part; `by_proof`: what it leads to was tried before, by the proof of its record. */
enum err interpreter_find_scene(const struct interpreter *interp, const char *name, bool by_proof,
                                struct buf *path, struct fault *fault);

/* Of a wary interpreter: the path of a regular file elsewhere that the name leads to, which only
 * the proof of its record may have read (T1 of sandbox/trust.h). */
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

/* Whether a file in the folder of golden images, by its path, may be read: a wary
 * interpreter follows no link that leads out of the folder that holds it. ERR_INPUT. */
enum err interpreter_may_read(const struct interpreter *interp, const char *path,
                              struct fault *fault);

/* Where a file that a command names is to be written; an empty path where it is not. Below
 * interpreter->out_folder it has the last part of its name, and names that end alike are told apart
 * by numbers: a/lab.nii is lab.nii, then b/lab.nii is lab-2.nii. */
enum err interpreter_output_path(struct interpreter *interp, const char *name, struct buf *path,
                                 struct fault *fault);

/* ---- files that go with a command (outputs.c) ---- */

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
