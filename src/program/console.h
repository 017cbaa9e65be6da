/* SPDX-License-Identifier: MIT */
/*
 * The console: what a program prints, how far its work is, and Ctrl-C.
 *
 * One for the process. Ctrl-C while a command runs cancels the command. While the program waits for
 * a line it ends the program as it ends any other: what was acknowledged is on the disk. The line
 * of progress goes before anything else is written.
 */
#ifndef PROGRAM_CONSOLE_H
#define PROGRAM_CONSOLE_H

#include "base/watch.h"
#include "command/script.h"

/* For main, before all else. Messages begin with the program's name. */
void console_init(const char *program);

/* From now on Ctrl-C is heard; not where the caller of the program wants it ignored. */
void console_handle_interrupts(void);
/* A Ctrl-C that came before was for something else. */
void console_forget_interrupt(void);

/* Somebody who looks on: `wants` is asked each time the watch is, and `show` called then when the
 * work can be shown (base/watch.h). NULL for nobody; it stays the caller's. */
struct console_onlooker {
    void *context;
    bool (*wants)(void *context);
    void (*show)(void *context);
};
void console_look_on(const struct console_onlooker *onlooker);

/* Shows progress on standard error, and stops for Ctrl-C and for the limits of a replay. */
struct watch *console_watch(void);
void console_erase_progress(void);

/* To standard output and standard error, as a printer does; and that printer. */
void console_print(void *context, const char *text);
void console_warn(void *context, const char *text);
extern const struct printer console_printer;
/* For a printer whose lines may take their time: whether one is waited for. */
void console_wait(void *context, bool waits);

/* Prints the words of an error; returns the exit status. */
int console_finish(enum err err, const struct fault *fault);

#endif
