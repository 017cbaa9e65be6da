/* SPDX-License-Identifier: MIT */
/*
 * A record: one command, what it gave, and a digest that chains it to all before it.
 *
 *     # zero or more comments and blank lines, part of the record they precede
 *     seed 20,30,40 2
 *     = 3 forest=0123456789abcdef seeds=3 chain=<32 hexadecimal digits>
 *
 * journal/FORMAT.md describes the bytes. This file encodes a record and walks over many in memory;
 * it neither reads nor writes files, and knows nothing of what a command means.
 *
 * Why a chain in a text: the journal stays a script that anyone may read and edit, and an
 * edit always leaves a trace. It is a seal against accidents and quiet edits, not a
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
    RECORD_FORMAT = 1,       /* the version of the format that this code writes and reads */
    RECORD_LINE_MAX = 65535, /* bytes of a line without its line feed */
    RECORD_WORDS_MAX = 64,   /* result words of one record */
    RECORD_CHAIN_DIGITS = 32,
};

/* What line 1 of a journal begins with; the format version follows. */
#define RECORD_HEADER "# iftty journal "

/* What is wrong where a line ends by a carriage return and a line feed. */
#define RECORD_WINDOWS                                                                             \
    "it has the line ends of Windows: a carriage return before the line feed; `tr -d '\\r' <FILE " \
    ">OTHER` takes them away"

/* A chain digest as text: 32 lower-case hexadecimal digits and a NUL. */
struct record_chain {
    char hex[RECORD_CHAIN_DIGITS + 1];
};

/* The chain before the first record: 32 zeros. */
extern const struct record_chain record_chain_zero;

struct record {
    size_t number; /* of the command in its file, from 1 */
    size_t line;   /* where the command stands, from 1 */
    /* Places in the file: the record's first byte, comments included; that of its command line, and
     * of its result line, or the end where there is none; the first byte after the record. */
    uint64_t offset, command_offset, result_offset, end;
    const char *command; /* without its line feed, ended by NUL */

    bool has_result;           /* a script has none; the rest is then empty and nothing fits */
    const char *result;        /* the result words, "" where there are none, ended by NUL */
    uint64_t noted;            /* the number that the result line holds */
    bool number_fits;          /* it is one more than the number before */
    struct record_chain chain; /* as the result line holds it */
    bool chain_fits;           /* it is what the bytes of the record give */
};

/* Says whether a record of a journal is as it was written: OK, or ERR_INPUT and words with its
 * number, line and byte offset. */
enum err record_judge(const struct record *record, struct fault *fault);

/* Line 1 of a journal, line feed included. `semantics` is 1..999999999. */
void record_header(struct buf *out, unsigned semantics);

/* ERR_INPUT or ERR_LIMIT and words where `command` cannot stand in a record: empty, too long, a
 * blank, '#' or '=' at its beginning, a control character, or the look of a sealed result line at
 * its end. */
enum err record_command_check(const char *command, struct fault *fault);

/* The same for result words: "key=value" pairs with single spaces between, or "". Keys are
 * [a-z][a-z0-9_-]*, each once, and not "chain"; values are one byte or more without blanks. */
enum err record_words_check(const char *words, struct fault *fault);

/* The same for one comment, a line that begins with '#' or is empty. */
enum err record_comment_check(const char *comment, struct fault *fault);

/* Adds a whole record to `out`: number, command and result of `record`; nothing else of it counts.
 * *chain is that of the record before, and then its own. `header` is line 1 with its line feed for
 * record 1 and "" for the others; `comments` are whole lines, or "". On failure `out` and *chain
 * are as they were. */
enum err record_encode(struct buf *out, struct record_chain *chain, const char *header,
                       const char *comments, const struct record *record, struct fault *fault);

/* The chain that `length` bytes (a record up to but without " chain=") give after `before`. */
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

/* Takes the next word of `length` bytes of words at *cursor; false at their end, or where no
 * well-formed word stands (*cursor is then not at the end). */
bool record_word_next(const char **cursor, const char *end, struct record_word *word);

bool record_key_is(const struct record_word *word, const char *key, size_t key_length);

/* Whether its value is a digest: 16 to 64 lower-case hexadecimal digits. No count is as long. */
bool record_word_is_digest(const struct record_word *word);

/* Whether there is no digest among the recorded words, and one among those that the command gives:
 * then nothing says that it gives the same. */
bool record_lacks_digest(const char *recorded, const char *given);

/* Finds the word with this key in `words`, ended by NUL. */
bool record_word_find(const char *words, const char *key, size_t key_length,
                      struct record_word *word);

/* Whether `words` hold `like`, key and value. *found is the word that they have of that key, or {0}
 * where they have none. */
bool record_word_is_among(const char *words, const struct record_word *like,
                          struct record_word *found);

/* ---- a walk ---- */

/*
 * Over the records of a journal, or the commands of a script, in memory.
 *
 * One walker reads both, so that a journal is a script and a script is a journal without proof.
 * Bytes that begin with a header line are a journal; all others are a script.
 *
 * What a walk distinguishes in a journal:
 *   sound     record_judge(&record) is OK;
 *   unsound   a record that can be read, but whose result is missing or whose number or chain does
 *             not fit: edited or damaged. The walk goes on. The next record is chained to what this
 *             one *says* its chain is, so that only records that were touched are unsound;
 *   torn      what follows the last record is a beginning of one: a write that did not finish.
 *             Every prefix of a journal is sound records and at most one torn record. Zeros at the
 *             end count as not written: that is what file systems leave after a loss of power;
 *   damaged   bytes that no writer of ours leaves and no reader can use: a result line that
 *             is malformed or has lost its command, a line too long, a zero byte. The walk ends.
 *
 * In a script nothing is torn: the last line may lack its line feed, commands may be indented, and
 * a result line is not expected. One that is there is given, but fits no chain.
 *
 * Where the walk is not over its record's bytes, nothing here writes; the bytes stay the caller's.
 */
enum walk_step { WALK_RECORD, WALK_END, WALK_TORN, WALK_DAMAGED };

struct walk {
    const char *bytes;
    size_t length;
    bool is_journal;
    bool ends_in_zeros;        /* after `length`, in a journal */
    unsigned semantics;        /* of the header; 0 where there is none */
    size_t header_length;      /* bytes of line 1 in a journal, line feed included */
    size_t offset;             /* of the next record: all before it has been given */
    size_t line;               /* number of the line at `offset`, from 1 */
    size_t records;            /* given so far */
    uint64_t noted;            /* the number that the last result line held */
    struct record_chain chain; /* and its chain */
    enum walk_step over;       /* WALK_RECORD while the walk goes on */
    struct record place;       /* where it ended */
    struct fault fault;        /* why it ended, for WALK_TORN and WALK_DAMAGED */
    struct buf command, result;
};

/* Begins a walk over `length` bytes, which must stay until walk_release. ERR_INPUT for a header
 * that is malformed or of a format we do not know, and for no header before bytes that are no text,
 * ERR_MEMORY; then there is nothing to release, and walk_release is fine too. */
enum err walk_begin(struct walk *walk, const char *bytes, size_t length, struct fault *fault);

/* The next record; its texts stay until the next call. At WALK_TORN and WALK_DAMAGED `record`
 * holds the number, line and offset of what was found, and walk->fault the words; a torn record
 * begins at its offset, while damage stands at its offset in a record that begins at walk->offset.
 * Once over, the walk gives the same answer again. */
enum walk_step walk_next(struct walk *walk, struct record *record);

/* The same, but an unsound record of a journal ends the walk as WALK_DAMAGED. */
enum walk_step walk_next_sound(struct walk *walk, struct record *record);

/* ERR_INPUT and the words of it where the walk ended in damage, else OK. */
enum err walk_judge(const struct walk *walk, struct fault *fault);

void walk_release(struct walk *walk);

#endif
