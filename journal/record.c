/* SPDX-License-Identifier: MIT */
#include "journal/record.h"

#include <assert.h>
#include <inttypes.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"

static const char header_begin[] = RECORD_HEADER;
static const char header_middle[] = " semantics ";
static const char chain_mark[] = " chain=";

enum {
    HEADER_MAX = 64,
    VERSION_MAX = 999999999,
    VERSION_DIGITS = 9,
    MARK_LENGTH = sizeof chain_mark - 1,
    SEAL_LENGTH = MARK_LENGTH + RECORD_CHAIN_DIGITS,
    NUMBER_DIGITS_MAX = 15
};

const struct record_chain record_chain_zero = {"00000000000000000000000000000000"};

static bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_control(char c)
{
    return (unsigned char)c < 0x20 || c == 0x7F;
}

enum err record_judge(const struct record *record, struct fault *fault)
{
    const char *what = NULL;
    if (!record->has_result)
        what = "it has no result line";
    else if (!record->chain_fits)
        what = "its chain digest does not fit its bytes";
    else if (!record->number_fits)
        what = "it is numbered out of order";
    if (!what)
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "record %zu (line %zu, from byte %" PRIu64 ") was edited or damaged: %s",
                     record->number, record->line, record->offset, what);
}

/* ---- line 1 ---------------------------------------------------------------------------------- */

static void header_print(char out[HEADER_MAX], unsigned format, unsigned semantics)
{
    snprintf(out, HEADER_MAX, "%s%u%s%u", header_begin, format, header_middle, semantics);
}

void record_header(struct buf *out, unsigned semantics)
{
    char line[HEADER_MAX];
    assert(semantics >= 1 && semantics <= VERSION_MAX);
    header_print(line, RECORD_FORMAT, semantics);
    buf_printf(out, "%s\n", line);
}

/* Parse line 1, without its line feed; false if it is not a header. */
static bool parse_header(const char *line, size_t length, unsigned *format, unsigned *semantics)
{
    char text[HEADER_MAX], again[HEADER_MAX];
    const char *at = text;
    int64_t f, s;
    if (length >= sizeof text)
        return false;
    memcpy(text, line, length);
    text[length] = '\0';
    if (!scan_text(&at, header_begin) || !scan_integer(&at, 1, VERSION_MAX, &f) ||
        !scan_text(&at, header_middle) || !scan_integer(&at, 1, VERSION_MAX, &s))
        return false;
    header_print(again, (unsigned)f, (unsigned)s);
    if (strlen(again) != length || memcmp(again, text, length) != 0)
        return false; /* leading zeros or trailing bytes: a header has one spelling */
    *format = (unsigned)f;
    *semantics = (unsigned)s;
    return true;
}

/* True if `text` is a beginning of our header, at least one byte and without its line feed. */
static bool is_begun_header(const char *text, size_t length)
{
    char begin[HEADER_MAX];
    const size_t whole =
        (size_t)snprintf(begin, sizeof begin, "%s%d%s", header_begin, RECORD_FORMAT, header_middle);
    const size_t both = length < whole ? length : whole;
    if (length == 0 || length > whole + VERSION_DIGITS || memcmp(text, begin, both) != 0)
        return false;
    for (size_t i = both; i < length; i++)
        if (!scan_is_digit(text[i]) || text[both] == '0')
            return false;
    return true;
}

/* ---- contents of a record --------------------------------------------------------------------
 * */

/* Read the 32 digits that end a sealed line; false if the line does not end so. */
static bool read_seal(const char *line, size_t length, struct record_chain *chain)
{
    if (length < SEAL_LENGTH || memcmp(line + length - SEAL_LENGTH, chain_mark, MARK_LENGTH) != 0)
        return false;
    const char *digit = line + length - RECORD_CHAIN_DIGITS;
    for (unsigned i = 0; i < RECORD_CHAIN_DIGITS; i++)
        if (!scan_is_digit(digit[i]) && !(digit[i] >= 'a' && digit[i] <= 'f'))
            return false;
    memcpy(chain->hex, digit, RECORD_CHAIN_DIGITS);
    chain->hex[RECORD_CHAIN_DIGITS] = '\0';
    return true;
}

/* True if `line` ends like a sealed result line: " chain=" and 32 hexadecimal digits. */
static bool is_sealed(const char *line, size_t length)
{
    struct record_chain chain;
    return read_seal(line, length, &chain);
}

/* Reject control characters in written lines, so that a journal can be printed as it is. */
enum err record_line_check(const char *what, const char *line, struct fault *fault)
{
    if (strlen(line) > RECORD_LINE_MAX)
        return fault_set(fault, ERR_LIMIT, "%s is longer than %d bytes", what, RECORD_LINE_MAX);
    const char *control = line;
    while (*control && !is_control(*control))
        control++;
    if (*control)
        return fault_set(fault, ERR_INPUT,
                         "%s holds the control character %02x at its byte %zu: %.200s", what,
                         (unsigned char)*control, (size_t)(control - line), line);
    return OK;
}

enum err record_command_check(const char *command, struct fault *fault)
{
    TRY(record_line_check("a command", command, fault));
    if (*command == '\0' || strchr(" #=", *command))
        return fault_set(fault, ERR_INPUT,
                         "a command is not empty and does not begin with a blank, '#' or '=': "
                         "%.200s",
                         command);
    if (is_sealed(command, strlen(command)))
        return fault_set(fault, ERR_INPUT, "a command does not end like a result line: %.200s",
                         command);
    return OK;
}

enum err record_comment_check(const char *comment, struct fault *fault)
{
    TRY(record_line_check("a comment", comment, fault));
    if (*comment && *comment != '#')
        return fault_set(fault, ERR_INPUT, "a comment begins with '#': %.200s", comment);
    return OK;
}

void record_comments(struct buf *comments, struct buf *signature, const char *bytes,
                     const struct record *record)
{
    static const size_t sign = sizeof RECORD_SIGNATURE - 1;
    const char *at = bytes + record->offset, *const end = bytes + record->command_offset;
    while (at < end) {
        const char *feed = memchr(at, '\n', (size_t)(end - at)), *const next =
                                                                     feed ? feed + 1 : end;
        const size_t length = (size_t)(next - at);
        const bool signs = length > sign && memcmp(at, RECORD_SIGNATURE, sign) == 0;
        if (signs && signature) {
            buf_clear(signature); /* the last one counts */
            buf_add(signature, at + sign, length - sign - (feed != NULL));
        } else if (!signs && comments)
            buf_add(comments, at, length);
        at = next;
    }
}

bool record_word_next(const char **cursor, const char *end, struct record_word *word)
{
    const char *at = *cursor;
    if (at == end || !is_lower(*at))
        return false;
    word->key = at;
    while (at < end && (is_lower(*at) || scan_is_digit(*at) || *at == '_' || *at == '-'))
        at++;
    word->key_length = (size_t)(at - word->key);
    if (at == end || *at++ != '=')
        return false;
    word->value = at;
    while (at < end && *at != ' ' && !is_control(*at))
        at++;
    word->value_length = (size_t)(at - word->value);
    if (word->value_length == 0 || (at < end && *at != ' '))
        return false;
    if (at < end && ++at == end) /* a space separates words and does not follow the last */
        return false;
    *cursor = at;
    return true;
}

bool record_key_is(const struct record_word *word, const char *key, size_t key_length)
{
    return word->key_length == key_length && memcmp(word->key, key, key_length) == 0;
}

bool record_word_is_digest(const struct record_word *word)
{
    return word->value_length >= 16 && word->value_length <= 64 &&
           strspn(word->value, "0123456789abcdef") >= word->value_length;
}

static bool has_digest(const char *words)
{
    const char *at = words, *end = words + strlen(words);
    struct record_word word;
    while (record_word_next(&at, end, &word))
        if (record_word_is_digest(&word))
            return true;
    return false;
}

bool record_lacks_digest(const char *recorded, const char *given)
{
    return !has_digest(recorded) && has_digest(given);
}

bool record_word_find(const char *words, const char *key, size_t key_length,
                      struct record_word *word)
{
    const char *at = words, *end = words + strlen(words);
    while (record_word_next(&at, end, word))
        if (record_key_is(word, key, key_length))
            return true;
    return false;
}

bool record_word_is_among(const char *words, const struct record_word *like,
                          struct record_word *found)
{
    if (!record_word_find(words, like->key, like->key_length, found)) {
        *found = (struct record_word){0};
        return false;
    }
    return found->value_length == like->value_length &&
           memcmp(found->value, like->value, like->value_length) == 0;
}

static bool words_are_valid(const char *words, size_t length)
{
    struct record_word word[RECORD_WORDS_MAX];
    const char *at = words, *end = words + length;
    unsigned count = 0;
    while (at < end) {
        if (count == RECORD_WORDS_MAX || !record_word_next(&at, end, &word[count]) ||
            record_key_is(&word[count], "chain", 5))
            return false;
        for (unsigned i = 0; i < count; i++)
            if (record_key_is(&word[i], word[count].key, word[count].key_length))
                return false;
        count++;
    }
    return true;
}

enum err record_words_check(const char *words, struct fault *fault)
{
    if (words_are_valid(words, strlen(words)))
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "result words are at most %d different key=value pairs with single spaces "
                     "between, not: %.200s",
                     RECORD_WORDS_MAX, words);
}

/* ---- the chain and the result line ----------------------------------------------------------- */

void record_chain_compute(struct record_chain *out, const struct record_chain *before,
                          const char *header, size_t header_length, const char *bytes,
                          size_t length)
{
    struct sha256_ctx sha;
    sha256_init(&sha);
    sha256_update(&sha, RECORD_CHAIN_DIGITS, (const uint8_t *)before->hex);
    sha256_update(&sha, header_length, (const uint8_t *)header);
    sha256_update(&sha, length, (const uint8_t *)bytes);
    sha256_hex(out->hex, &sha, RECORD_CHAIN_DIGITS / 2);
}

/* Parts of a result line: places in the given line, not copies. */
struct result {
    uint64_t number;
    const char *words;
    size_t words_length;
    struct record_chain chain;
    size_t covered; /* bytes of the line that the chain covers */
};

/* Parse `line`, without its line feed; false if it is not a well-formed result line. */
static bool parse_result(const char *line, size_t length, struct result *result)
{
    if (!read_seal(line, length, &result->chain))
        return false;
    const char *at = line, *end = line + length - SEAL_LENGTH;
    if (end - at < 3 || at[0] != '=' || at[1] != ' ' || at[2] == '0')
        return false;
    at += 2;
    result->number = 0;
    const char *digits = at;
    for (; at < end && scan_is_digit(*at) && at - digits < NUMBER_DIGITS_MAX; at++)
        result->number = 10 * result->number + (uint64_t)(*at - '0');
    if (at == digits || (at < end && *at != ' '))
        return false;
    if (at < end && ++at == end)
        return false;
    result->words = at;
    result->words_length = (size_t)(end - at);
    result->covered = (size_t)(end - line);
    return words_are_valid(result->words, result->words_length);
}

enum err record_encode(struct buf *out, struct record_chain *chain, const char *header,
                       const char *comments, const struct record *record, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    struct record_chain after;
    TRY(record_command_check(record->command, fault));
    TRY(record_words_check(record->result, fault));
    assert(*comments == '\0' || comments[strlen(comments) - 1] == '\n');
    buf_printf(&text, "%s%s\n", comments, record->command);
    const size_t result = text.length;
    buf_printf(&text, "= %zu%s%s", record->number, *record->result ? " " : "", record->result);
    if (text.length - result + SEAL_LENGTH > RECORD_LINE_MAX)
        return fault_set(fault, ERR_LIMIT, "a result line is longer than %d bytes",
                         RECORD_LINE_MAX);
    record_chain_compute(&after, chain, header, strlen(header), buf_text(&text), text.length);
    buf_printf(&text, "%s%s\n", chain_mark, after.hex);
    if (text.failed || !buf_reserve(out, text.length))
        return fault_memory(fault, "a record of the journal");
    buf_add(out, text.data, text.length);
    *chain = after;
    return OK;
}

/* ---- a walk: lines --------------------------------------------------------------------------- */

/* One line, without its line feed. */
struct line {
    const char *text;
    size_t length;
    size_t offset;
    size_t number;
    bool is_complete; /* it has its line feed */
};

struct position {
    size_t offset;
    size_t line;
};

static bool read_line(const struct walk *walk, struct position *at, struct line *line)
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

/* The smallest block that a disk writes atomically. */
enum { SECTOR = 512 };

/* ---- a walk: the beginning ------------------------------------------------------------------- */

/* Find out the kind of the bytes, and skip the header of a journal. */
static enum err read_header(struct walk *walk, struct fault *fault)
{
    size_t length = walk->length;
    while (length > 0 && walk->bytes[length - 1] == '\0')
        length--;
    const char *feed = length ? memchr(walk->bytes, '\n', length) : NULL;
    const size_t first = feed ? (size_t)(feed - walk->bytes) : length;
    unsigned format;
    const bool is_begun = !feed && (length == 0 || is_begun_header(walk->bytes, length));
    const size_t begin = sizeof header_begin - 1; /* a file that begins so is meant as a journal */
    if (!is_begun && (first < begin || memcmp(walk->bytes, header_begin, begin) != 0)) {
        /* Another kind of file: in a long file, a zero near the beginning shows that it is not
         * text. */
        const char *zero = memchr(walk->bytes, '\0', walk->length < SECTOR ? walk->length : SECTOR);
        return zero ? fault_set(fault, ERR_INPUT,
                                "this is neither a journal, which begins with a header, nor a "
                                "script, which is text: byte %zu is zero",
                                (size_t)(zero - walk->bytes))
                    : OK;
    }
    walk->is_journal = true;
    walk->ends_in_zeros = length < walk->length;
    walk->length = length;
    if (is_begun)
        return OK; /* walk_next reports it as torn */
    if (first && walk->bytes[first - 1] == '\r')
        return fault_set(fault, ERR_INPUT, "line 1: %s", RECORD_WINDOWS);
    if (!parse_header(walk->bytes, first, &format, &walk->semantics))
        return fault_set(fault, ERR_INPUT,
                         "the header in line 1 is malformed; \"# iftty journal %d semantics N\" "
                         "was expected, not: %.*s",
                         RECORD_FORMAT, first < 100 ? (int)first : 100, walk->bytes);
    if (format != RECORD_FORMAT)
        return fault_set(fault, ERR_INPUT,
                         "this is a journal of format %u; this program reads format %d", format,
                         RECORD_FORMAT);
    assert(feed); /* without a line feed the header is unfinished */
    walk->offset = walk->header_length = first + 1;
    walk->line = 2;
    return OK;
}

enum err walk_begin(struct walk *walk, const char *bytes, size_t length, struct fault *fault)
{
    *walk = (struct walk){.bytes = bytes ? bytes : "", .length = length, .line = 1};
    walk->chain = record_chain_zero;
    TRY(read_header(walk, fault));
    /* Reserve all memory for the walk, so that walk_next cannot fail. */
    if (buf_reserve(&walk->command, RECORD_LINE_MAX) && buf_reserve(&walk->result, RECORD_LINE_MAX))
        return OK;
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

/* ---- a walk: the ends ------------------------------------------------------------------------ */

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

/* Zeros are sectors that were not written: from the beginning of a sector, or the end of written
 * bytes, to the end of a sector or the file. No program writes single zero bytes. */
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

/* True if the record may have waited for its sync (J1): it is of a command that changed nothing
 * of the segmentation, and has no words. The rest of its result line shows that: "= 12 chain=...".
 * */
static bool may_have_waited(const struct line *line)
{
    const char *zero = memchr(line->text, '\0', line->length);
    const char *at = line->text + 1, *end = zero ? zero : line->text + line->length;
    at += at < end && *at == ' ';
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    const size_t left = (size_t)(end - at), most = MARK_LENGTH;
    return at <= end && memcmp(at, chain_mark, left < most ? left : most) == 0;
}

/* A disk may write unsynced sectors in any order and lose power between two of them. Then zeros
 * replace a missing sector and other bytes follow. Such a record is the last one: nothing follows
 * its result line, or only records that may have waited. */
static bool is_torn_by_zeros(const struct walk *walk, const struct line *line)
{
    struct position at = {walk->offset, walk->line};
    struct line later;
    if (!walk->is_journal || !memchr(line->text, '\0', line->length))
        return false;
    while (read_line(walk, &at, &later))
        if (line_is_result(&later) && !may_have_waited(&later) && at.offset < walk->length)
            return false;
    return zeros_are_sectors(walk);
}

/* ---- a walk: a record ------------------------------------------------------------------------ */

/* Reason why the line cannot be ours, or NULL. */
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

static void set_text(struct buf *text, const char *bytes, size_t length)
{
    buf_clear(text);
    buf_add(text, bytes, length);
    assert(!text->failed);
}

/* Read the result line of the record at walk->offset, and judge its number and chain. */
static void judge_result(struct walk *walk, const struct line *line, const struct result *result,
                         struct record *record)
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

/* Find the next command line. WALK_RECORD if `line` holds it. */
static enum walk_step find_command(struct walk *walk, struct position *at, struct line *line)
{
    const char *wrong;
    do {
        if (!read_line(walk, at, line)) {
            const bool is_torn =
                walk->is_journal &&
                (walk->offset < walk->length || walk->ends_in_zeros || walk->header_length == 0);
            return is_torn ? end_torn(walk) : end_walk(walk, WALK_END, walk->offset, walk->line);
        }
        if ((wrong = line_fault(walk, line)))
            return is_torn_by_zeros(walk, line) ? end_torn(walk) : end_damaged(walk, line, wrong);
        if (walk->is_journal && !line->is_complete)
            return end_torn(walk);
        /* Scripts may be indented; a journal has one form. */
        for (; !walk->is_journal && line->length > 0 && is_blank(*line->text); line->text++)
            line->length--;
    } while (line->length == 0 || *line->text == '#');
    if (line_is_result(line))
        return end_damaged(walk, line, "a result line has no command line");
    if (walk->is_journal && is_blank(*line->text))
        return end_damaged(walk, line, "a command line begins with a blank");
    if (walk->is_journal && is_sealed(line->text, line->length))
        return end_damaged(walk, line, "a result line is malformed or runs into the line before");
    return WALK_RECORD;
}

/* Read the result line at `at`; false without one, or if the walk ends there. */
static bool find_result(struct walk *walk, struct position *at, struct line *line,
                        struct result *result)
{
    struct position after = *at;
    const bool has_line = read_line(walk, &after, line);
    if (has_line ? !line_is_result(line) : !walk->is_journal)
        return false;
    const char *wrong = has_line ? line_fault(walk, line) : NULL;
    if (wrong && !is_torn_by_zeros(walk, line))
        end_damaged(walk, line, wrong);
    else if (wrong || !has_line || (walk->is_journal && !line->is_complete))
        end_torn(walk);
    else if (!parse_result(line->text, line->length, result))
        end_damaged(walk, line, "the result line is malformed");
    else
        *at = after;
    return walk->over == WALK_RECORD;
}

enum walk_step walk_next(struct walk *walk, struct record *record)
{
    struct position at = {walk->offset, walk->line};
    struct line line, result_line;
    struct result result;
    const bool has_result = walk->over == WALK_RECORD &&
                            find_command(walk, &at, &line) == WALK_RECORD &&
                            find_result(walk, &at, &result_line, &result);
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
    *walk = before; /* undo the step */
    walk->fault = why;
    end_walk(walk, WALK_DAMAGED, walk->offset, line);
    *record = walk->place;
    return WALK_DAMAGED;
}
