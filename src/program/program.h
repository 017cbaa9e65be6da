/* SPDX-License-Identifier: MIT */
/*
 * Programs: what can be done from a command line, one row of a table each.
 *
 *     iftty verify --bisect A B        name, form, operands
 *
 * A row says what the program is called, which operands and options it takes, what it does, and
 * which function that is. Usage, help, what is refused as bad usage, and the README's list come
 * from it. A program that does several things has a row for each, its forms: they share the name,
 * and an option says which is meant. What a form ignored would be an option
 * that it does not take, and that is refused.
 *
 * A new program is a row in program_table.c and its function in a file run_NAME.c.
 */
#ifndef PROGRAM_PROGRAM_H
#define PROGRAM_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"
#include "command/near.h"
#include "command/script.h"
#include "tui/picture/graphics.h"

/* ---- options ---- */

/*
 * A table says what each is called, what its value is and how that is read into a struct. Help,
 * messages and the programs' own lists of options come from its rows.
 *
 * Options may stand anywhere among the operands; "--" ends them. Each is given once at most, and
 * `--name=value` is the same as `--name value`; -V is --version. Two rows may share a name where it
 * means two things to two programs. Both have a value then, or neither: a command line is taken
 * apart before it is known which program reads it.
 */

struct option {
    const char *name;  /* "--journal" */
    const char *value; /* "FILE"; NULL: it has none */
    const char *help; /* what it does, in a few words; "" where the program that takes it says it */
    /* Reads the value, NULL where there is none, into a member of `out`. ERR_USAGE. */
    enum err (*read)(const struct option *option, const char *text, void *out, struct fault *fault);
    size_t at;           /* of the member, in bytes from `out` */
    int64_t least, most; /* of a number, or of those of a list */
    /* Adds the words that the value can be, with these between them; NULL where it is free. */
    void (*add_choices)(struct buf *out, const char *between, const char *before_last);
};

/* What `read` can be: into a bool, a const char *, a size_t, and a const char * that is a list. */
enum err option_read_flag(const struct option *, const char *, void *, struct fault *);
enum err option_read_text(const struct option *, const char *, void *, struct fault *);
enum err option_read_number(const struct option *, const char *, void *, struct fault *);
enum err option_read_list(const struct option *, const char *, void *, struct fault *);

struct option_table {
    const struct option *row; /* the first is empty, so that 0 is no option */
    unsigned rows;
};

/* The number of the row with that name among those `taken`, a list ended by 0; 0 for none. */
uint8_t option_find(const struct option_table *table, const uint8_t *taken, const char *name);

/* ---- programs ---- */

/* What a command line gave, for the program that it names. Another binary with programs of its own
 * has a struct that begins with this one. */
struct options {
    const struct program *program;
    char **word; /* operands, without the program's name and form */
    int words;
    const char *commands, *journal, *scene, *out;
    const char *junit, *html, *accept, *only, *picture, *surface;
    const char *expect, *shard;
    const char *volume, *regions, *as, *by, *fit, *landmarks, *orient, *procedure;
    const char *limit_memory, *limit_time, *limit_output;
    size_t processes, from, until; /* 0: not given */
    struct graphics_wish graphics; /* {0}: the terminal decides */
    bool help, read_only, whole, keep_going, smooth, json, histogram, csv, binary, resample,
        anonymise;
    bool strict, no_strict, fail_fast, timings, remove_orphans;
    bool unconfined;
    bool is_form; /* one that only says which form is meant */
};

enum { PROGRAM_OPTIONS_MOST = 26 };

typedef enum err program_run(const struct options *options, struct fault *fault);

struct program {
    const char *name;  /* NULL: of a command line that names none */
    const char *form;  /* "--bisect", which its command line holds; NULL: none */
    const char *words; /* operands, as in "JOURNAL...", and how many they are */
    int least, most;
    uint8_t option[PROGRAM_OPTIONS_MOST]; /* rows of the options' table, ended by 0 */
    const char *summary;                  /* one line */
    const char *detail;                   /* more, a paragraph a line; or NULL */
    program_run *run;
};

struct program_table {
    const char *called;  /* "iftty" */
    const char *about;   /* what it is: one line */
    const char *closing; /* what else there is to know, lines */
    const struct program *row;
    unsigned rows;
    struct option_table option;
};

/* What iftty can do. */
extern const struct program_table program_table;

/* Finds the program and reads its operands and options into `options`, which begins as {0}, or with
 * what stands for options that are not given. With --help only the name is read. ERR_USAGE. */
enum err program_read(const struct program_table *table, int count, char **word,
                      struct options *options, struct fault *fault);

/* The whole of main: reads, runs or prints help; returns the exit status. */
int program_main(const struct program_table *table, int count, char **word,
                 struct options *options);

/* Adds "iftty verify --bisect". */
void program_add_name(struct buf *out, const struct program_table *table,
                      const struct program *program);

/* Adds the same with its operands: "iftty verify --bisect A B". */
void program_add_usage(struct buf *out, const struct program_table *table,
                       const struct program *program);

/* Tries the programs' names as what a misspelt one was meant to be. */
void program_try_names(const struct program_table *table, struct near *near);

/* Adds the list of all programs, with the options of the nameless one; and all there is to know
 * about the program of that name, NULL for the nameless one. False for a name that is none. */
void program_add_overview(struct buf *out, const struct program_table *table);
bool program_add_help(struct buf *out, const struct program_table *table, const char *name);

/*
 * The console: what a program prints, how far its work is, and Ctrl-C.
 *
 * One for the process. Ctrl-C while a command runs cancels the command. While the program waits for
 * a line it ends the program as it ends any other: what was acknowledged is on the disk. The line
 * of progress goes before anything else is written.
 */

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
