/* SPDX-License-Identifier: MIT */
/*
 * Files that commands name: where they are found, where they may be written, and that those that a
 * command has written stand or fall with it.
 */
#ifndef COMMAND_FILES_H
#define COMMAND_FILES_H

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"

struct call;
struct interpreter;

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
