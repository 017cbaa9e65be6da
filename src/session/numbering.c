/* SPDX-License-Identifier: MIT */
#include "session/numbering.h"

#include <string.h>

#include "base/scan.h"

enum { LABELS = 256, OTHER = REGION_NONE - 1 };

/* The label that has this own number, or LABELS. */
static unsigned label_of(const struct kept *kept, uint32_t number)
{
    unsigned label = number ? 1 : LABELS;
    while (label < LABELS && kept->label_number[label] != number)
        label++;
    return label;
}

uint16_t numbering_of(const struct kept *kept, unsigned label)
{
    return kept->label_number[label]        ? kept->label_number[label]
           : label_of(kept, label) < LABELS ? 0
                                            : (uint16_t)label;
}

void numbering_translate(uint16_t *as, const struct kept *kept)
{
    for (unsigned label = 1; label < LABELS; label++)
        if (kept->label_number[label] && as[label] == label)
            as[label] = OTHER;
    for (unsigned label = 1; label < LABELS; label++) {
        const uint16_t number = kept->label_number[label];
        if (number && as[number] != REGION_NONE)
            as[number] = (uint16_t)label;
    }
}

bool numbering_is_used(const struct kept *kept)
{
    bool is_used = false;
    for (unsigned label = 1; label < LABELS; label++)
        is_used |= kept->label_number[label] > 0;
    return is_used;
}

static bool is_chosen(const uint16_t *as, const bool *has, uint32_t r)
{
    return has[r] && as[r] != REGION_NONE;
}

void numbering_list(struct buf *list, const uint16_t *as, const bool has[REGION_MOST + 1],
                    const struct kept *kept)
{
    const bool takes_all = !numbering_is_used(kept);
    bool is_needed = false;
    for (uint32_t r = 1; r <= REGION_MOST; r++)
        is_needed |= is_chosen(as, has, r) && as[r] >= LABELS;
    for (uint32_t r = 1, last; is_needed && r <= REGION_MOST; r = last + 1) {
        last = r;
        if (!is_chosen(as, has, r) || (!takes_all && as[r] < LABELS))
            continue;
        while (last < REGION_MOST && is_chosen(as, has, last + 1) &&
               (takes_all || as[last + 1] >= LABELS))
            last++;
        buf_printf(list, list->length ? ",%u" : "%u", r);
        if (last > r)
            buf_printf(list, "-%u", last);
    }
}

/* ---- a list ---- */

static enum err refuse(const char *list, unsigned fits, struct fault *fault)
{
    int64_t first, last;
    uint32_t count = 0, low = 0, high = 0;
    for (const char *at = list; scan_list_range(&at, 0, REGION_MOST, &first, &last);)
        for (int64_t r = first; r <= last; r++, count++) {
            low = count == 0 ? (uint32_t)r : low;
            high = count < fits ? (uint32_t)r : high;
        }
    if (fits == 0)
        return fault_set(fault, ERR_INPUT,
                         "it has %u regions that are no labels yet, and no label is free; nothing "
                         "was planted",
                         count);
    return fault_set(fault, ERR_INPUT,
                     "it has %u regions, and labels for %u are free; choose some, as in "
                     "regions=%u-%u, or make all one label with label=1; nothing was planted",
                     count, fits, low, high);
}

enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault)
{
    bool is_free[LABELS];
    unsigned label = 1, fits = 0;
    int64_t first, last;
    *tally = (struct numbering_tally){0};
    for (unsigned l = 0; l < LABELS; l++)
        is_free[l] = l && !kept->label_number[l];
    for (size_t i = 0; i < markers->count; i++)
        if (markers->marker[i].stands && markers->marker[i].label > 0)
            is_free[markers->marker[i].label] = false;
    for (unsigned l = 0; l < LABELS; l++)
        fits += is_free[l];
    for (const char *at = list; scan_list_range(&at, 1, REGION_MOST, &first, &last);)
        for (int64_t r = first; r <= last; r++) {
            if (label_of(kept, (uint32_t)r) < LABELS)
                continue;
            while (label < LABELS && !is_free[label])
                label++;
            if (label == LABELS)
                return refuse(list, fits, fault);
            tally->names += *kept->label_name[label] != '\0';
            memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
            kept->label_number[label] = (uint16_t)r;
            tally->first_label = tally->regions++ ? tally->first_label : label;
            tally->last_label = label++;
        }
    return OK;
}

enum err numbering_check(const struct kept *kept, const bool used[256], struct fault *fault)
{
    for (unsigned label = 1; label < LABELS; label++) {
        const unsigned other = label_of(kept, label);
        if (used[label] && !kept->label_number[label] && other < LABELS)
            return fault_set(fault, ERR_INPUT,
                             "label %u would be %u in a file, and that is the number of label %u; "
                             "`label %u NAME number=N` gives it another; nothing was written",
                             label, label, other, label);
    }
    return OK;
}
