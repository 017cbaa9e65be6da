/*
 * Options of a command line: a table says what each is called, what its value is and how that is
 * read into a struct. Help, messages and the programs' own lists of options come from its rows.
 *
 * Options may stand anywhere among the operands; "--" ends them. Two rows may share a name where it
 * means two things to two programs. Both have a value then, or neither: a command line is taken
 * apart before it is known which program reads it.
 */
#ifndef PROGRAM_OPTION_H
#define PROGRAM_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

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

/* Goes through a command line, word by word. Begins with `table`, `word` and `count`; a copy goes
 * through it once more. */
struct option_words {
    const struct option_table *table;
    char **word;
    int count;
    int at;    /* the next one */
    bool over; /* "--" was met */
    /* what option_next has found: an option or an operand, */
    char *text;
    bool is_option;
    const char *value; /* and its value; NULL where it has none, or none is left */
};

/* The next operand or option; false at the end. */
bool option_next(struct option_words *words);

#endif
