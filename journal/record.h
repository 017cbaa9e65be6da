/* SPDX-License-Identifier: MIT */
/*
 * A record: one command, its results, and a digest that chains it to all records before it.
 *
 *     # zero or more comments and blank lines, part of the record they precede
 *     seed 20,30,40 2
 *     = 3 forest=0123456789abcdef seeds=3 chain=<32 hexadecimal digits>
 *
 * journal/FORMAT.md describes the bytes. This file encodes a record and walks over records in
 * memory. It neither reads nor writes files, and does not know the meaning of commands.
 *
 * The chain is part of a text, so the journal stays a script that anyone may read and edit, and an
 * edit always leaves a trace. The chain is a seal against accidents and quiet edits, not a
 * signature: it holds no secret.
 */
#ifndef JOURNAL_RECORD_H
#define JOURNAL_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

enum {
    RECORD_FORMAT = 1,       /* version of the format that this code writes and reads */
    RECORD_LINE_MAX = 65535, /* bytes of a line without its line feed */
    RECORD_WORDS_MAX = 64,   /* result words of one record */
    RECORD_CHAIN_DIGITS = 32,
};

/* Beginning of line 1 of a journal; the format version follows. */
#define RECORD_HEADER "# iftty journal "

/* Message for lines that end with a carriage return and a line feed. */
#define RECORD_WINDOWS                                                                             \
    "it has the line ends of Windows: a carriage return before the line feed; `tr -d '\\r' <FILE " \
    ">OTHER` removes them"

/* A chain digest as text: 32 lower-case hexadecimal digits and a NUL. */
struct record_chain {
    char hex[RECORD_CHAIN_DIGITS + 1];
};

/* The chain before the first record: 32 zeros. */
extern const struct record_chain record_chain_zero;

struct record {
    size_t number; /* number of the command in its file, from 1 */
    size_t line;   /* line of the command, from 1 */
    /* Places in the file: the record's first byte, comments included; its command line; its
     * result line, or the end if missing; the first byte after the record. */
    uint64_t offset, command_offset, result_offset, end;
    const char *command; /* without its line feed, ended by NUL */

    bool has_result;           /* false in a script; then the following members are empty or
                                  false */
    const char *result;        /* result words or "", ended by NUL */
    uint64_t noted;            /* number on the result line */
    bool number_fits;          /* it is one more than the number before */
    struct record_chain chain; /* as on the result line */
    bool chain_fits;           /* it is the digest of the record's bytes */
};

/* Check that a record of a journal is as it was written: OK, or ERR_INPUT and words with its
 * number, line and byte offset. */
enum err record_judge(const struct record *record, struct fault *fault);

/* Write line 1 of a journal, line feed included. `semantics` is 1..999999999. */
void record_header(struct buf *out, unsigned semantics);

/* ERR_INPUT or ERR_LIMIT and words if a line, which they call `what`, is too long or has a control
 * character. */
enum err record_line_check(const char *what, const char *line, struct fault *fault);

/* ERR_INPUT or ERR_LIMIT and words if `command` is invalid in a record: empty, too long, with a
 * blank, '#' or '=' at its beginning, a control character, or the end of a sealed result line. */
enum err record_command_check(const char *command, struct fault *fault);

/* The same for result words: "key=value" pairs with single spaces between them, or "". Keys are
 * [a-z][a-z0-9_-]*, each once, and not "chain"; values are one byte or more without blanks. */
enum err record_words_check(const char *words, struct fault *fault);

/* The same for one comment, a line that begins with '#' or is empty. */
enum err record_comment_check(const char *comment, struct fault *fault);

/* Begins the comment line that signs its record, a line per record: "#@ who=NAME at=TIME
 * session=N", each word optional. */
#define RECORD_SIGNATURE "#@ "

/* Append the comment lines of a record in `bytes`, a whole journal or script, to `comments`.
 * Replace `signature` by the words of the line that signs it, without its beginning; without such a
 * line it is unchanged. Each may be NULL. */
void record_comments(struct buf *comments, struct buf *signature, const char *bytes,
                     const struct record *record);

/* Append a whole record to `out`; only number, command and result of `record` are used. *chain
 * is that of the record before, and becomes that of this one. `header` is line 1 with its line feed
 * for record 1 and "" for the others; `comments` are whole lines, or "". On failure `out` and
 * *chain are unchanged. */
enum err record_encode(struct buf *out, struct record_chain *chain, const char *header,
                       const char *comments, const struct record *record, struct fault *fault);

/* Compute the chain of `length` bytes, a record up to but not including " chain=", after
 * `before`. */
void record_chain_compute(struct record_chain *out, const struct record_chain *before,
                          const char *header, size_t header_length, const char *bytes,
                          size_t length);

/* One result word: places in the text it came from. */
struct record_word {
    const char *key;
    size_t key_length;
    const char *value;
    size_t value_length;
};

/* Read the next word at *cursor; false at `end`, or at a malformed word (*cursor is then before
 * `end`). */
bool record_word_next(const char **cursor, const char *end, struct record_word *word);

bool record_key_is(const struct record_word *word, const char *key, size_t key_length);

/* True if its value is a digest: 16 to 64 lower-case hexadecimal digits. No count is as long. */
bool record_word_is_digest(const struct record_word *word);

/* True if the command computes a digest and the record has none, so that the record proves
 * nothing. */
bool record_lacks_digest(const char *recorded, const char *given);

/* Find the word with this key in `words`, ended by NUL. */
bool record_word_find(const char *words, const char *key, size_t key_length,
                      struct record_word *word);

/* True if `words` hold `like`, key and value. *found is their word of that key, or {0}. */
bool record_word_is_among(const char *words, const struct record_word *like,
                          struct record_word *found);

/* ---- a walk ---- */

/*
 * A walk over the records of a journal, or the commands of a script, in memory.
 *
 * One walker reads both: a journal is a script with proof, and a script is a journal without. Bytes
 * that begin with a header line are a journal; all others are a script.
 *
 * States of a journal's bytes:
 *   sound     record_judge(&record) is OK;
 *   unsound   a readable record whose result is missing, or whose number or chain does not fit:
 *             edited or damaged. The walk continues. The next record is chained to the chain
 *             *written* in this one, so that only changed records are unsound;
 *   torn      the bytes after the last record begin a record: a write did not finish. Every prefix
 *             of a journal is sound records and at most one torn record. Zeros at the end count as
 *             not written: file systems leave them after a loss of power;
 *   damaged   bytes that our writer never leaves and no reader can use: a result line that is
 *             malformed or has no command, a line too long, a zero byte. The walk ends.
 *
 * A script is never torn: its last line may lack a line feed, commands may be indented, and no
 * result lines are expected. A result line in a script is returned, but fits no chain.
 *
 * The walk writes nothing; the bytes belong to the caller.
 */
enum walk_step { WALK_RECORD, WALK_END, WALK_TORN, WALK_DAMAGED };

struct walk {
    const char *bytes;
    size_t length;
    bool is_journal;
    bool ends_in_zeros;        /* zeros follow after `length`, in a journal */
    unsigned semantics;        /* number in the header; 0 without a header */
    size_t header_length;      /* bytes of line 1 in a journal, line feed included */
    size_t offset;             /* offset of the next record */
    size_t line;               /* number of the line at `offset`, from 1 */
    size_t records;            /* records returned */
    uint64_t noted;            /* number on the last result line */
    struct record_chain chain; /* chain on the last result line */
    enum walk_step over;       /* WALK_RECORD until the walk ends */
    struct record place;       /* place of the end */
    struct fault fault;        /* reason of the end, for WALK_TORN and WALK_DAMAGED */
    struct buf command, result;
};

/* Begin a walk over `length` bytes, which must stay until walk_release. ERR_INPUT for a header
 * that is malformed or of an unknown format, and for binary bytes without a header; ERR_MEMORY.
 * After an error walk_release is allowed, not required. */
enum err walk_begin(struct walk *walk, const char *bytes, size_t length, struct fault *fault);

/* Return the next record; its texts are valid until the next call. At WALK_TORN and WALK_DAMAGED
 * `record` holds the number, line and offset of the fault, and walk->fault the words. A torn record
 * begins at its offset; damage is at its offset in the record that begins at walk->offset. After
 * the end, every call returns the same. */
enum walk_step walk_next(struct walk *walk, struct record *record);

/* The same, but an unsound record of a journal ends the walk as WALK_DAMAGED. */
enum walk_step walk_next_sound(struct walk *walk, struct record *record);

/* ERR_INPUT and words if the walk ended in damage, otherwise OK. */
enum err walk_judge(const struct walk *walk, struct fault *fault);

void walk_release(struct walk *walk);

#endif
