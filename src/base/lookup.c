/* SPDX-License-Identifier: MIT */
#include "base/lookup.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

struct lookup_row {
    uint64_t key;
    uint32_t number;
    bool is_used;
};

/* Where a key is, or is to be. */
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
