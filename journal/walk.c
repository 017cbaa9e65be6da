#include "journal/walk.h"

#include <assert.h>
#include <string.h>

/* One line of the bytes, without its line feed. */
struct line {
    const char *text;
    size_t length;
    size_t offset;
    size_t number;
    bool is_complete; /* its line feed is there */
};

struct position {
    size_t offset;
    size_t line;
};

static bool take_line(const struct walk *walk, struct position *at, struct line *line)
{
    if (at->offset == walk->length)
        return false;
    const char *text = walk->bytes + at->offset;
    const size_t rest = walk->length - at->offset;
    const char *feed = memchr(text, '\n', rest);
    const size_t length = feed ? (size_t)(feed - text) : rest;
    *line = (struct line){text, length, at->offset, at->line, feed != NULL};
    at->offset += length + (feed != NULL);
    at->line++;
    return true;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool line_is_result(const struct line *line)
{
    return line->length > 0 && *line->text == '=';
}

/* The smallest block that a disk writes whole. */
enum { SECTOR = 512 };

/* ---- the beginning --------------------------------------------------------------------------- */

/* A file of another kind: in a long one, what it begins with shows that it is no text. */
static enum err check_script(const struct walk *walk, struct fault *fault)
{
    const char *zero = memchr(walk->bytes, '\0', walk->length < SECTOR ? walk->length : SECTOR);
    return zero ? fault_set(fault, ERR_INPUT,
                            "this is neither a journal, which begins with a header, nor a script, "
                            "which is text: byte %zu is zero",
                            (size_t)(zero - walk->bytes))
                : OK;
}

/* Finds out what the bytes are, and steps over the header of a journal. */
static enum err read_header(struct walk *walk, struct fault *fault)
{
    size_t length = walk->length;
    while (length > 0 && walk->bytes[length - 1] == '\0')
        length--;
    const char *feed = length ? memchr(walk->bytes, '\n', length) : NULL;
    const size_t first = feed ? (size_t)(feed - walk->bytes) : length;
    unsigned format;
    const bool is_begun =
        !feed && (length ? record_header_is_begun(walk->bytes, length) : walk->length > 0);
    if (!is_begun && !record_header_is_meant(walk->bytes, first))
        return check_script(walk, fault);
    walk->is_journal = true;
    walk->ends_in_zeros = length < walk->length;
    walk->length = length;
    if (is_begun)
        return OK; /* walk_next finds it torn */
    if (first && walk->bytes[first - 1] == '\r')
        return fault_set(fault, ERR_INPUT, "line 1: %s", RECORD_WINDOWS);
    if (!record_header_parse(walk->bytes, first, &format, &walk->semantics))
        return fault_set(fault, ERR_INPUT,
                         "the header in line 1 is malformed; \"# iftty journal %d semantics N\" "
                         "was expected, not: %.*s",
                         RECORD_FORMAT, first < 100 ? (int)first : 100, walk->bytes);
    if (format != RECORD_FORMAT)
        return fault_set(fault, ERR_INPUT,
                         "this is a journal of format %u; this program reads format %d", format,
                         RECORD_FORMAT);
    assert(feed); /* a header without it is only begun */
    walk->offset = walk->header_length = first + 1;
    walk->line = 2;
    return OK;
}

enum err walk_begin(struct walk *walk, const char *bytes, size_t length, struct fault *fault)
{
    *walk = (struct walk){.bytes = bytes ? bytes : "", .length = length, .line = 1};
    walk->chain = record_chain_zero;
    const enum err err = read_header(walk, fault);
    /* All memory that the walk will need: walk_next cannot fail for the lack of it. */
    if (err || (buf_reserve(&walk->command, RECORD_LINE_MAX) &&
                buf_reserve(&walk->result, RECORD_LINE_MAX)))
        return err;
    walk_release(walk);
    return fault_memory(fault, "reading a journal");
}

void walk_release(struct walk *walk)
{
    buf_release(&walk->command);
    buf_release(&walk->result);
}

enum err walk_judge(const struct walk *walk, struct fault *fault)
{
    return walk->over == WALK_DAMAGED ? fault_set(fault, ERR_INPUT, "%s", walk->fault.text) : OK;
}

/* ---- the ends -------------------------------------------------------------------------------- */

static enum walk_step end_walk(struct walk *walk, enum walk_step step, size_t offset, size_t line)
{
    walk->over = step;
    walk->place = (struct record){.number = walk->records + 1,
                                  .line = line,
                                  .offset = offset,
                                  .end = walk->length,
                                  .command = "",
                                  .result = ""};
    return step;
}

static enum walk_step end_damaged(struct walk *walk, const struct line *line, const char *what)
{
    fault_set(&walk->fault, ERR_INPUT, "record %zu is damaged at line %zu, byte %zu: %s",
              walk->records + 1, line->number, line->offset, what);
    return end_walk(walk, WALK_DAMAGED, line->offset, line->number);
}

static enum walk_step end_torn(struct walk *walk)
{
    fault_set(&walk->fault, ERR_INPUT,
              "record %zu is torn: its write did not finish (line %zu, from byte %zu)",
              walk->records + 1, walk->line, walk->offset);
    return end_walk(walk, WALK_TORN, walk->offset, walk->line);
}

/* Zeros stand only where sectors were not written: from a sector's beginning, or the end of what
 * was written before, to a sector's end or the last byte. No writer writes single zero bytes. */
static bool zeros_are_sectors(const struct walk *walk)
{
    for (size_t at = walk->offset; at < walk->length; at++) {
        size_t end = at;
        while (end < walk->length && walk->bytes[end] == '\0')
            end++;
        if (end > at && ((at > 0 && at % SECTOR != 0 && walk->bytes[at - 1] != '\n') ||
                         (end != walk->length && end % SECTOR != 0)))
            return false;
        at = end;
    }
    return true;
}

/* What may have waited to be synced (J1) is the record of a command that changed nothing of the
 * segmentation: it has no words. What is left of a result line shows it: "= 12 chain=...". */
static bool may_have_waited(const struct line *line)
{
    static const char chain[] = " chain=";
    const char *zero = memchr(line->text, '\0', line->length);
    const char *at = line->text + 1, *end = zero ? zero : line->text + line->length;
    at += at < end && *at == ' ';
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    const size_t left = (size_t)(end - at), most = sizeof chain - 1;
    return at <= end && memcmp(at, chain, left < most ? left : most) == 0;
}

/* A disk may write the sectors of what was not synced in any order, and lose power between two:
 * zeros then stand where one was not written, and bytes after them. Such a record is the last:
 * after its result line, if that is there, nothing follows; or all that follows may have waited. */
static bool is_torn_by_zeros(const struct walk *walk, const struct line *line)
{
    struct position at = {walk->offset, walk->line};
    struct line later;
    if (!walk->is_journal || !memchr(line->text, '\0', line->length))
        return false;
    while (take_line(walk, &at, &later))
        if (line_is_result(&later) && !may_have_waited(&later) && at.offset < walk->length)
            return false;
    return zeros_are_sectors(walk);
}

/* ---- a record -------------------------------------------------------------------------------- */

/* Why no line of ours looks like this; NULL where it may. */
static const char *line_fault(const struct walk *walk, const struct line *line)
{
    if (line->length > RECORD_LINE_MAX)
        return "the line is longer than 65535 bytes";
    if (memchr(line->text, '\0', line->length))
        return "the line holds a zero byte";
    if (walk->is_journal && line->is_complete && line->length &&
        line->text[line->length - 1] == '\r')
        return RECORD_WINDOWS;
    return NULL;
}

static const char *command_fault(const struct walk *walk, const struct line *line)
{
    if (line_is_result(line))
        return "a result line stands without its command";
    if (walk->is_journal && is_blank(*line->text))
        return "a command line begins with a blank";
    if (walk->is_journal && record_line_is_sealed(line->text, line->length))
        return "a result line is malformed or runs into the line before";
    return NULL;
}

static void set_text(struct buf *text, const char *bytes, size_t length)
{
    buf_clear(text);
    buf_add(text, bytes, length);
    assert(!text->failed);
}

/* The result line of the record that begins at walk->offset; judges number and chain. */
static void judge_result(struct walk *walk, const struct line *line,
                         const struct record_result *result, struct record *record)
{
    struct record_chain chain;
    const bool is_first = walk->records == 0;
    const char *begin = walk->bytes + walk->offset;
    const size_t covered = line->offset - walk->offset + result->covered;
    record_chain_compute(&chain, &walk->chain, walk->bytes, is_first ? walk->header_length : 0,
                         begin, covered);
    set_text(&walk->result, result->words, result->words_length);
    record->has_result = true;
    record->result = buf_text(&walk->result);
    record->noted = result->number;
    record->number_fits = result->number == walk->noted + 1;
    record->chain = result->chain;
    record->chain_fits =
        walk->is_journal && memcmp(chain.hex, result->chain.hex, RECORD_CHAIN_DIGITS) == 0;
    walk->noted = result->number;
    walk->chain = result->chain;
}

/* Finds the next command line; WALK_RECORD when it is in `line`. */
static enum walk_step find_command(struct walk *walk, struct position *at, struct line *line)
{
    const char *wrong;
    do {
        if (!take_line(walk, at, line)) {
            const bool is_torn =
                walk->is_journal &&
                (walk->offset < walk->length || walk->ends_in_zeros || walk->header_length == 0);
            return is_torn ? end_torn(walk) : end_walk(walk, WALK_END, walk->offset, walk->line);
        }
        if ((wrong = line_fault(walk, line)))
            return is_torn_by_zeros(walk, line) ? end_torn(walk) : end_damaged(walk, line, wrong);
        if (walk->is_journal && !line->is_complete)
            return end_torn(walk);
        /* Scripts may be indented; a journal says things in one way. */
        for (; !walk->is_journal && line->length > 0 && is_blank(*line->text); line->text++)
            line->length--;
    } while (line->length == 0 || *line->text == '#');
    if ((wrong = command_fault(walk, line)))
        return end_damaged(walk, line, wrong);
    return WALK_RECORD;
}

/* Takes the result line that stands at `at`, if one does: *has_result says so. */
static enum walk_step find_result(struct walk *walk, struct position *at, bool *has_result,
                                  struct line *line, struct record_result *result)
{
    struct position after = *at;
    const char *wrong;
    *has_result = false;
    if (!take_line(walk, &after, line))
        return walk->is_journal ? end_torn(walk) : WALK_RECORD;
    if (!line_is_result(line))
        return WALK_RECORD;
    if ((wrong = line_fault(walk, line)))
        return is_torn_by_zeros(walk, line) ? end_torn(walk) : end_damaged(walk, line, wrong);
    if (walk->is_journal && !line->is_complete)
        return end_torn(walk);
    if (!record_result_parse(line->text, line->length, result))
        return end_damaged(walk, line, "the result line is malformed");
    *has_result = true;
    *at = after;
    return WALK_RECORD;
}

enum walk_step walk_next(struct walk *walk, struct record *record)
{
    struct position at = {walk->offset, walk->line};
    struct line line, result_line;
    struct record_result result;
    bool has_result = false;
    if (walk->over == WALK_RECORD && find_command(walk, &at, &line) == WALK_RECORD)
        find_result(walk, &at, &has_result, &result_line, &result);
    if (walk->over != WALK_RECORD) {
        *record = walk->place;
        return walk->over;
    }
    set_text(&walk->command, line.text, line.length);
    *record = (struct record){.number = walk->records + 1,
                              .line = line.number,
                              .offset = walk->offset,
                              .command_offset = line.offset,
                              .result_offset = has_result ? result_line.offset : at.offset,
                              .end = at.offset,
                              .command = buf_text(&walk->command),
                              .result = ""};
    if (has_result)
        judge_result(walk, &result_line, &result, record);
    walk->offset = at.offset;
    walk->line = at.line;
    walk->records++;
    return WALK_RECORD;
}

enum walk_step walk_next_sound(struct walk *walk, struct record *record)
{
    const struct walk before = *walk;
    const enum walk_step step = walk_next(walk, record);
    struct fault why;
    if (step != WALK_RECORD || !walk->is_journal || !record_judge(record, &why))
        return step;
    const size_t line = record->line;
    *walk = before; /* take the record back */
    walk->fault = why;
    end_walk(walk, WALK_DAMAGED, walk->offset, line);
    *record = walk->place;
    return WALK_DAMAGED;
}
