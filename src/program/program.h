/* SPDX-License-Identifier: MIT */
/*
 * Programs: one row of a table for each thing that a command line can do.
 *
 *     iftty verify --bisect A B        name, form, operands
 *
 * A row has the name of the program, its operands and options, its help, and its function. Usage,
 * help, usage errors and the README's list are made from it. A program that does several things has
 * several rows, its forms: they share the name, and an option selects one. A form has only options
 * that it uses; others are an error.
 *
 * A new program is a row in program_table.c and a function in a file run_NAME.c.
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
#include "engine/scene.h"
#include "tui/picture/graphics.h"
#include "verify/verify.h"

/* ---- options ---- */

/*
 * Each row of the table has the name of an option, its value, and the function that reads the value
 * into a struct. Help, messages and the programs' own lists of options are made from it.
 *
 * Options may be anywhere among the operands; "--" ends them. An option is given once at most,
 * unless option_read_next reads it. `--name=value` is the same as `--name value`; -V is --version.
 * Two rows may share a name if it has two meanings for two programs. Then both have a value, or
 * neither: a command line is split before its program is known.
 */

struct option {
    const char *name;  /* "--journal" */
    const char *value; /* "FILE"; NULL: no value */
    const char *help;  /* help; "" if it selects a form, which has its own */
    /* Reads the value, or NULL, into a member of `out`. ERR_USAGE. */
    enum err (*read)(const struct option *option, const char *text, void *out, struct fault *fault);
    size_t at;           /* offset of the member in `out` */
    int64_t least, most; /* range of a number, or of the numbers of a list */
    /* Adds the possible values, with these texts between them; NULL for any value. */
    void (*add_choices)(struct buf *out, const char *between, const char *before_last);
};

/* Functions for `read`: into a bool, a const char *, the next of `most` of them, a size_t, and a
 * const char * with a list. */
enum err option_read_flag(const struct option *, const char *, void *, struct fault *);
enum err option_read_text(const struct option *, const char *, void *, struct fault *);
enum err option_read_next(const struct option *, const char *, void *, struct fault *);
enum err option_read_number(const struct option *, const char *, void *, struct fault *);
enum err option_read_list(const struct option *, const char *, void *, struct fault *);

struct option_table {
    const struct option *row; /* the first is empty: 0 is no option */
    unsigned rows;
};

/* Find the row with a name among those `taken`, a list ended by 0. Returns 0 if it is missing. */
uint8_t option_find(const struct option_table *table, const uint8_t *taken, const char *name);

/* ---- programs ---- */

/* Operands and options of a command line. Another binary with its own programs has a struct that
 * begins with this one. */
struct options {
    const struct program *program;
    char **word; /* operands, without the program's name and form */
    int words;
    const char *commands, *journal, *scene, *out, *who, *page, *compare;
    const char *accept, *only, *picture, *surface, *shard;
    const char *channel[CHANNELS_MOST + 1]; /* ended by NULL */
    const char *volume, *regions, *as, *by, *fit, *landmarks, *orient, *procedure;
    const char *limit_memory, *limit_time, *limit_output;
    size_t from, until;            /* 0: not given */
    struct graphics_wish graphics; /* {0}: chosen by the terminal */
    bool help, read_only, times, steps, whole, keep_going, smooth, json, histogram, csv, binary,
        resample;
    bool no_strict, unconfined;
    bool is_form;                 /* set by options that only select a form */
    struct verify_options verify; /* those of `verify` alone; its function sets the rest */
};

enum { PROGRAM_OPTIONS_MOST = 26 };

typedef enum err program_run(const struct options *options, struct fault *fault);

struct program {
    const char *name;  /* NULL: the nameless program */
    const char *form;  /* "--bisect", the option that selects it; NULL: none */
    const char *words; /* operands, such as "JOURNAL...", and their number */
    int least, most;
    uint8_t option[PROGRAM_OPTIONS_MOST]; /* rows of the options' table, ended by 0 */
    const char *summary;                  /* one line */
    const char *detail;                   /* more help, a paragraph a line; or NULL */
    program_run *run;
};

struct program_table {
    const char *called;  /* "iftty" */
    const char *about;   /* one line of description */
    const char *closing; /* the end of the overview, lines */
    const struct program *row;
    unsigned rows;
    struct option_table option;
};

/* The programs of iftty. */
extern const struct program_table program_table;

/* Find the program, and read operands and options into `options`, which begins as {0} or with
 * default values. With --help only the program is found. ERR_USAGE. */
enum err program_read(const struct program_table *table, int count, char **word,
                      struct options *options, struct fault *fault);

/* All of main: read the command line, run the program or print help. Returns the exit status. */
int program_main(const struct program_table *table, int count, char **word,
                 struct options *options);

/* Add "iftty verify --bisect". */
void program_add_name(struct buf *out, const struct program_table *table,
                      const struct program *program);

/* Add the same with its operands: "iftty verify --bisect A B". */
void program_add_usage(struct buf *out, const struct program_table *table,
                       const struct program *program);

/* Try the names of programs as corrections of a misspelt word. */
void program_try_names(const struct program_table *table, struct near *near);

/* Add the list of all programs, with the options of the nameless one; and the help of a program.
 * False if there is no program of that name. */
void program_add_overview(struct buf *out, const struct program_table *table);
bool program_add_help(struct buf *out, const struct program_table *table, const char *name);

/*
 * The console: output of a program, progress, and Ctrl-C. There is one for the process.
 *
 * Ctrl-C cancels a running command. While the program waits for a line, it ends the program:
 * acknowledged commands are on the disk. The line of progress is erased before other output.
 */

/* Call first in main. Messages begin with the program's name. */
void console_init(const char *program);

/* Handle Ctrl-C from now on, unless the caller of the program ignores it. */
void console_handle_interrupts(void);
/* Ignore an earlier Ctrl-C. */
void console_forget_interrupt(void);

/* An onlooker: `wants` is called each time the watch is polled, and `show` then when the work can
 * be shown (base/watch.h); `stops` returns true to stop the work. NULL: none. It is borrowed. */
struct console_onlooker {
    void *context;
    bool (*wants)(void *context);
    void (*show)(void *context);
    bool (*stops)(void *context);
};
void console_look_on(const struct console_onlooker *onlooker);

/* A watch that shows progress on standard error, and stops for Ctrl-C and for the limits of a
 * replay. */
struct watch *console_watch(void);
void console_erase_progress(void);

/* Print to standard output and standard error; and the printer of both. */
void console_print(void *context, const char *text);
void console_warn(void *context, const char *text);
extern const struct printer console_printer;
/* For a printer that reads lines slowly: set while a line is awaited. */
void console_wait(void *context, bool waits);

/* Print an error; returns the exit status. */
int console_finish(enum err err, const struct fault *fault);

#endif
