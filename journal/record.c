#include "journal/record.h"

#include <assert.h>
#include <inttypes.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

#include "base/hash.h"
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

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_control(char c)
{
    return (unsigned char)c < 0x20 || c == 0x7F;
}

/* The first control character of `text`, or its end. */
static const char *find_control(const char *text)
{
    while (*text && !is_control(*text))
        text++;
    return text;
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

bool record_header_parse(const char *line, size_t length, unsigned *format, unsigned *semantics)
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
        return false; /* leading zeros, or something after it: one header has one spelling */
    *format = (unsigned)f;
    *semantics = (unsigned)s;
    return true;
}

bool record_header_is_meant(const char *text, size_t length)
{
    const size_t begin = sizeof header_begin - 1;
    return length >= begin && memcmp(text, header_begin, begin) == 0;
}

bool record_header_is_begun(const char *text, size_t length)
{
    char begin[HEADER_MAX];
    const size_t whole =
        (size_t)snprintf(begin, sizeof begin, "%s%d%s", header_begin, RECORD_FORMAT, header_middle);
    const size_t both = length < whole ? length : whole;
    if (length == 0 || length > whole + VERSION_DIGITS || memcmp(text, begin, both) != 0)
        return false;
    for (size_t i = both; i < length; i++)
        if (!is_digit(text[i]) || text[both] == '0')
            return false;
    return true;
}

/* ---- what may stand in a record -------------------------------------------------------------- */

/* Control characters are refused in what we write, so that a journal can be shown as it is. */
static enum err line_check(const char *what, const char *line, struct fault *fault)
{
    if (strlen(line) > RECORD_LINE_MAX)
        return fault_set(fault, ERR_LIMIT, "%s is longer than %d bytes", what, RECORD_LINE_MAX);
    const char *control = find_control(line);
    if (*control)
        return fault_set(fault, ERR_INPUT,
                         "%s holds the control character %02x at its byte %zu: %.200s", what,
                         (unsigned char)*control, (size_t)(control - line), line);
    return OK;
}

enum err record_command_check(const char *command, struct fault *fault)
{
    enum err err = line_check("a command", command, fault);
    if (err)
        return err;
    if (*command == '\0' || strchr(" #=", *command))
        return fault_set(fault, ERR_INPUT,
                         "a command is not empty and does not begin with a blank, '#' or '=': "
                         "%.200s",
                         command);
    if (record_line_is_sealed(command, strlen(command)))
        return fault_set(fault, ERR_INPUT, "a command does not end like a result line: %.200s",
                         command);
    return OK;
}

enum err record_comment_check(const char *comment, struct fault *fault)
{
    enum err err = line_check("a comment", comment, fault);
    if (err)
        return err;
    if (*comment && *comment != '#')
        return fault_set(fault, ERR_INPUT, "a comment begins with '#': %.200s", comment);
    return OK;
}

bool record_word_next(const char **cursor, const char *end, struct record_word *word)
{
    const char *at = *cursor;
    if (at == end || !is_lower(*at))
        return false;
    word->key = at;
    while (at < end && (is_lower(*at) || is_digit(*at) || *at == '_' || *at == '-'))
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
    if (at < end && ++at == end) /* a space stands between words, not after the last */
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

/* Takes the 32 digits that end a sealed line; false where it does not end so. */
static bool take_seal(const char *line, size_t length, struct record_chain *chain)
{
    if (length < SEAL_LENGTH || memcmp(line + length - SEAL_LENGTH, chain_mark, MARK_LENGTH) != 0)
        return false;
    const char *digit = line + length - RECORD_CHAIN_DIGITS;
    for (unsigned i = 0; i < RECORD_CHAIN_DIGITS; i++)
        if (!is_digit(digit[i]) && !(digit[i] >= 'a' && digit[i] <= 'f'))
            return false;
    memcpy(chain->hex, digit, RECORD_CHAIN_DIGITS);
    chain->hex[RECORD_CHAIN_DIGITS] = '\0';
    return true;
}

bool record_line_is_sealed(const char *line, size_t length)
{
    struct record_chain chain;
    return take_seal(line, length, &chain);
}

bool record_result_parse(const char *line, size_t length, struct record_result *result)
{
    if (!take_seal(line, length, &result->chain))
        return false;
    const char *at = line, *end = line + length - SEAL_LENGTH;
    if (end - at < 3 || at[0] != '=' || at[1] != ' ' || at[2] == '0')
        return false;
    at += 2;
    result->number = 0;
    const char *digits = at;
    for (; at < end && is_digit(*at) && at - digits < NUMBER_DIGITS_MAX; at++)
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
    struct buf text = {0};
    struct record_chain after;
    enum err err = record_command_check(record->command, fault);
    if (!err)
        err = record_words_check(record->result, fault);
    if (err)
        return err;
    assert(*comments == '\0' || comments[strlen(comments) - 1] == '\n');
    buf_printf(&text, "%s%s\n", comments, record->command);
    const size_t result = text.length;
    buf_printf(&text, "= %zu%s%s", record->number, *record->result ? " " : "", record->result);
    if (text.length - result + SEAL_LENGTH > RECORD_LINE_MAX)
        err = fault_set(fault, ERR_LIMIT, "a result line is longer than %d bytes", RECORD_LINE_MAX);
    record_chain_compute(&after, chain, header, strlen(header), buf_text(&text), text.length);
    buf_printf(&text, "%s%s\n", chain_mark, after.hex);
    if (!err && (text.failed || !buf_reserve(out, text.length)))
        err = fault_memory(fault, "a record of the journal");
    if (!err) {
        buf_add(out, text.data, text.length);
        *chain = after;
    }
    buf_release(&text);
    return err;
}
