/* SPDX-License-Identifier: MIT */
/* The functions of the programs, for the table (program_table.c). What each does is said there. */
#ifndef PROGRAM_PROGRAMS_H
#define PROGRAM_PROGRAMS_H

#include "command/interpreter.h"
#include "image/volume_format.h"
#include "program/program.h"
#include "tui/picture/image_view.h"

enum err run_prompt(const struct options *options, struct fault *fault);
enum err run_version(const struct options *options, struct fault *fault);
enum err run_script(const struct options *options, struct fault *fault);
enum err run_commands(const struct options *options, struct fault *fault);
enum err run_serve(const struct options *options, struct fault *fault);
enum err run_replay(const struct options *options, struct fault *fault);
enum err run_tutorial(const struct options *options, struct fault *fault);
enum err run_watch(const struct options *options, struct fault *fault);
enum err run_verify(const struct options *options, struct fault *fault);
enum err run_verify_bisect(const struct options *options, struct fault *fault);
enum err run_accept(const struct options *options, struct fault *fault);
enum err run_reseal(const struct options *options, struct fault *fault);
enum err run_diff(const struct options *options, struct fault *fault);
enum err run_apply(const struct options *options, struct fault *fault);
enum err run_log_procedure(const struct options *options, struct fault *fault);
enum err run_compare(const struct options *options, struct fault *fault);
enum err run_log(const struct options *options, struct fault *fault);
enum err run_log_script(const struct options *options, struct fault *fault);
enum err run_log_check(const struct options *options, struct fault *fault);
enum err run_log_anonymise(const struct options *options, struct fault *fault);
enum err run_log_repair(const struct options *options, struct fault *fault);
enum err run_show(const struct options *options, struct fault *fault);
enum err run_info(const struct options *options, struct fault *fault);
enum err run_help(const struct options *options, struct fault *fault);

/* What programs begin and end with: an interpreter as the options want it, and the walls around a
 * journal that may be a stranger's. */

/* With the scene, folder and journal of the options. Lines about a journal that is resumed go to
 * standard error. To be released, whatever is returned. */
enum err begin_interpreter(struct interpreter *interp, const struct options *o,
                           struct fault *fault);

/* Has a large scene that is opened from now on wait for the first command that looks at it: for
 * programs that carry out commands one by one, and look at voxels in no other way. */
void begin_to_wait(struct interpreter *interp);

/* The scene or journal that a session is to begin with, or NULL, and whether it is a journal, which
 * is resumed then. ERR_USAGE, ERR_INPUT and ERR_IO for options that do not go with it. */
enum err begin_check(const struct options *o, const char **first, bool *resumes,
                     struct fault *fault);

/* The volume of a file of the command line, by its number there from 0, as --volume has it. */
struct volume_choice begin_volume(const struct options *o, size_t which);

/* NAME-N.iftty for the first N that is free here: where a session records that begins with `first`,
 * or with NULL, and was given no journal. */
void begin_journal_name(struct buf *journal, const char *first);

/* Syncs what the journal has not synced yet, when a session ends that ends with `err`. */
enum err end_journal(struct interpreter *interp, enum err err, struct fault *fault);

/* Before anything is carried out that a journal says: the limits of the options, and the kernel's
 * walls. `written` is a folder that may be written, or NULL. */
enum err begin_confined(const struct options *o, const char *journal, const char *written,
                        struct fault *fault);

/* The same in the process that verifies one journal, where `context` is the options. */
enum err begin_one(void *context, const char *journal, struct fault *fault);

/* What is shown of a session: the picture of the last command, and the colours that it needs. */

/* The colours of the labels that can show, and of the background, which is a shade of one too, for
 * a palette; how many. */
unsigned shown_hues(uint32_t hue[256], const struct session *session);

/* The picture that the last command had shown, else the rendition. `smooth`: in all bits, where the
 * terminal can. Its pixels belong to the interpreter, its colours to this file, until the next. */
struct image_view shown_picture(struct interpreter *interp, bool smooth);

/* The session at prompt and pilot that `iftty` and `iftty tutorial` have in common. */

struct lesson;

/* On the scene or journal of the options; or with a lesson, whose scene it begins with. Then no
 * line is remembered from one time to the next, and nothing but the journal stays behind. */
enum err prompt_run(const struct options *o, struct lesson *lesson, struct fault *fault);

#endif
