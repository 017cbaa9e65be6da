#include "session/regions.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/scan.h"

/* The numbers of a list, one after another. */
struct numbers {
    const char *at;
    int64_t next, last;
};

static struct numbers numbers_of(const char *list)
{
    return (struct numbers){list, 1, 0};
}

static bool take(struct numbers *numbers, int64_t *number)
{
    if (numbers->next > numbers->last &&
        !scan_list_range(&numbers->at, 0, REGION_MOST, &numbers->next, &numbers->last))
        return false;
    *number = numbers->next++;
    return true;
}

static enum err choose(uint16_t *as, const char *regions, const char *labels, struct fault *fault)
{
    struct numbers region = numbers_of(regions), label = numbers_of(labels ? labels : regions);
    int64_t r, l;
    while (take(&region, &r)) {
        if (as[r] != REGION_NONE)
            return fault_set(fault, ERR_USAGE, "regions: %lld stands there twice", (long long)r);
        if (!take(&label, &l))
            return fault_set(fault, ERR_USAGE,
                             "as: expected a label for each of `regions`; from %lld on there is "
                             "none",
                             (long long)r);
        as[r] = (uint16_t)l;
    }
    if (take(&label, &l))
        return fault_set(fault, ERR_USAGE, "as: label %lld and those after it have no region",
                         (long long)l);
    return OK;
}

enum err regions_new(uint16_t **as, const char *regions, const char *labels, struct fault *fault)
{
    *as = NULL;
    if (labels && !regions)
        return fault_set(fault, ERR_USAGE, "as: needs `regions`, which become these labels");
    uint16_t *made = mem_array(REGION_MOST + 1, sizeof *made);
    if (!made)
        return fault_memory(fault, "the regions");
    for (uint32_t r = 0; r <= REGION_MOST; r++)
        made[r] = regions || r == 0 ? REGION_NONE : (uint16_t)r;
    const enum err err = regions ? choose(made, regions, labels, fault) : OK;
    if (err)
        free(made);
    else
        *as = made;
    return err;
}
