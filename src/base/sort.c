/* SPDX-License-Identifier: MIT */
#include "base/sort.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

struct lookup_row {
    uint64_t key;
    uint32_t number;
    bool is_used;
};

/* Find the row of a key, or the free row for it. */
static struct lookup_row *row_of(struct lookup_row *row, size_t rows, uint64_t key)
{
    size_t at = (size_t)hash_mix(key) & (rows - 1);
    while (row[at].is_used && row[at].key != key)
        at = (at + 1) & (rows - 1);
    return &row[at];
}

static bool grow(struct lookup *lookup)
{
    const size_t rows = lookup->rows ? 2 * lookup->rows : 1024;
    struct lookup_row *row = mem_array(rows, sizeof *row);
    if (!row)
        return false;
    memset(row, 0, rows * sizeof *row);
    for (size_t i = 0; i < lookup->rows; i++)
        if (lookup->row[i].is_used)
            *row_of(row, rows, lookup->row[i].key) = lookup->row[i];
    free(lookup->row);
    lookup->row = row;
    lookup->rows = rows;
    return true;
}

uint32_t *lookup_at(struct lookup *lookup, uint64_t key)
{
    if (3 * lookup->used >= 2 * lookup->rows && !grow(lookup))
        return NULL;
    struct lookup_row *row = row_of(lookup->row, lookup->rows, key);
    if (!row->is_used) {
        *row = (struct lookup_row){key, LOOKUP_NEW, true};
        lookup->used++;
    }
    return &row->number;
}

void lookup_clear(struct lookup *lookup)
{
    if (lookup->used)
        memset(lookup->row, 0, lookup->rows * sizeof *lookup->row);
    lookup->used = 0;
}

void lookup_release(struct lookup *lookup)
{
    free(lookup->row);
    *lookup = (struct lookup){0};
}

enum { DIGITS = 1 << 16 };

static unsigned digit_of(uint64_t number, unsigned shift)
{
    return number >> shift & (DIGITS - 1);
}

/* Distribute one array into the other by 16 bits; `begin` has DIGITS places. False if stopped. */
static bool distribute(const uint64_t *from, uint64_t *to, size_t count, unsigned shift,
                       size_t *begin, struct watch *watch)
{
    struct task task = task_begin(watch, "putting in order", 2 * (uint64_t)count);
    size_t before = 0;
    memset(begin, 0, DIGITS * sizeof *begin);
    for (size_t i = 0; i < count && task_advance(&task, 1); i++)
        begin[digit_of(from[i], shift)]++;
    for (unsigned d = 0; d < DIGITS; d++) {
        const size_t here = begin[d];
        begin[d] = before;
        before += here;
    }
    for (size_t i = 0; i < count && task_advance(&task, 1); i++)
        to[begin[digit_of(from[i], shift)]++] = from[i];
    return !watch || !watch->stopped;
}

enum err sort_by_upper_half(uint64_t *number, size_t count, struct watch *watch,
                            struct fault *fault)
{
    enum { FEW = 64 };
    for (size_t i = 1; i < count && count <= FEW; i++) { /* insertion sort, in place and not
                                                            interruptible */
        const uint64_t one = number[i];
        size_t at = i;
        for (; at > 0 && number[at - 1] >> 32 > one >> 32; at--)
            number[at] = number[at - 1];
        number[at] = one;
    }
    if (count <= FEW)
        return OK;
    OWNED(mem_release) uint64_t *room = mem_array(count, sizeof *room);
    OWNED(mem_release) size_t *begin = mem_array(DIGITS, sizeof *begin);
    const bool fits = room && begin;
    if (fits && distribute(number, room, count, 32, begin, watch))
        distribute(room, number, count, 48, begin, watch);
    return fits ? watch_fault(watch, fault) : fault_memory(fault, "putting seeds in order");
}

int sort_compare(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

int sort_compare_32(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}
