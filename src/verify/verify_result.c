/* SPDX-License-Identifier: MIT */
#include "verify/verify_result.h"

#include <inttypes.h>

#include "base/scan.h"

void verify_result_release(struct verify_result *result)
{
    buf_release(&result->why);
    buf_release(&result->lines);
    buf_release(&result->chain);
    buf_release(&result->orphans);
    buf_release(&result->slowest);
    evidence_release(&result->evidence);
}

void verify_result_fail(struct verify_result *result, enum err err, bool is_told,
                        const struct fault *fault)
{
    result->err = err;
    if (!err)
        return;
    buf_add_text(&result->why, fault->text);
    if (!is_told)
        buf_printf(&result->lines, "# %s\n", fault->text);
}

void verify_result_describe(struct buf *out, const struct verify_result *r)
{
    buf_printf(out,
               "%" PRIu64 " command%s, %" PRIu64 " result%s with %" PRIu64 " digest%s, %" PRIu64
               " golden image%s of %" PRIu64 " pixel%s",
               r->executed, plural(r->executed), r->compared, plural(r->compared), r->digests,
               plural(r->digests), r->goldens, plural(r->goldens), r->pixels, plural(r->pixels));
}

/* ---- through a pipe ---- */

enum { NUMBERS = 8 };

/* The parts that differ in length, in the order in which they are sent; NULL after the last. */
static struct buf *part_of(const struct verify_result *result, size_t number)
{
    struct verify_result *r = (struct verify_result *)(uintptr_t)result;
    struct buf *const part[] = {&r->why, &r->lines, &r->chain, &r->orphans, &r->slowest};
    enum { PARTS = sizeof part / sizeof *part };
    if (number < PARTS)
        return part[number];
    const size_t picture = (number - PARTS) / 2, half = (number - PARTS) % 2;
    if (picture >= r->evidence.pictures)
        return NULL;
    return half ? &r->evidence.picture[picture].png : &r->evidence.picture[picture].caption;
}

void verify_result_write(struct buf *out, const struct verify_result *r)
{
    const struct buf *part;
    const uint64_t number[NUMBERS] = {(uint64_t)r->err, r->executed,         r->compared,
                                      r->digests,       r->goldens,          r->pixels,
                                      r->took_ms,       r->evidence.pictures};
    buf_add_text(out, "result");
    for (size_t i = 0; i < NUMBERS; i++)
        buf_printf(out, " %" PRIu64, number[i]);
    buf_add_char(out, '\n');
    for (size_t i = 0; (part = part_of(r, i)); i++) {
        buf_printf(out, "part %zu\n", part->length);
        buf_add(out, buf_text(part), part->length);
    }
}

/* "NAME N N ...\n". The bytes are ended by a NUL, so that no number is read beyond it. */
static bool read_numbers(const char **at, const char *name, int64_t *number, size_t count)
{
    if (!scan_text(at, name))
        return false;
    for (size_t i = 0; i < count; i++)
        if (!scan_text(at, " ") || !scan_integer(at, 0, INT64_MAX, number + i))
            return false;
    return scan_text(at, "\n");
}

static bool read_all(struct verify_result *r, const char *at, const char *end)
{
    struct buf *part;
    int64_t number[NUMBERS], length;
    if (!read_numbers(&at, "result", number, NUMBERS) || number[0] > ERR_CANCELLED ||
        number[NUMBERS - 1] > EVIDENCE_MOST)
        return false;
    r->err = (enum err)number[0];
    r->evidence.pictures = (size_t)number[NUMBERS - 1];
    uint64_t *const count[] = {&r->executed, &r->compared, &r->digests,
                               &r->goldens,  &r->pixels,   &r->took_ms};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        *count[i] = (uint64_t)number[i + 1];
    for (size_t i = 0; (part = part_of(r, i)); i++, at += length) {
        if (!read_numbers(&at, "part", &length, 1) || length > end - at)
            return false;
        buf_add(part, at, (size_t)length);
        if (part->failed)
            return false;
    }
    return at == end;
}

enum err verify_result_read(struct verify_result *result, const struct buf *bytes,
                            struct fault *fault)
{
    return read_all(result, buf_text(bytes), buf_text(bytes) + bytes->length)
               ? OK
               : fault_set(fault, ERR_INPUT, "no result, or half of one: %zu bytes", bytes->length);
}

struct verify_sum verify_sum(const struct verify_result *result, size_t count)
{
    struct verify_sum sum = {.count = count};
    for (size_t i = 0; i < count; i++) {
        const enum err err = result[i].err;
        sum.verified += !err && !result[i].is_skipped;
        sum.skipped += result[i].is_skipped;
        sum.unreadable += err && err != ERR_CHECK;
        sum.took_ms += result[i].took_ms;
        if (err && (!sum.worst || sum.worst == ERR_CHECK))
            sum.worst = err;
    }
    sum.failed = count - sum.verified - sum.skipped;
    return sum;
}
