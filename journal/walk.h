/*
 * A walk over the records of a journal, or the commands of a script, in memory.
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
#ifndef JOURNAL_WALK_H
#define JOURNAL_WALK_H

#include "journal/record.h"

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
