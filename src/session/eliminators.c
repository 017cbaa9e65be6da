#include "session/eliminators.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void eliminators_release(struct eliminators *e)
{
    free(e->cell);
    *e = (struct eliminators){0};
}

enum err eliminators_add(struct eliminators *e, uint32_t cell, struct fault *fault)
{
    if (!mem_grow(&e->cell, &e->capacity, e->end + 1, sizeof *e->cell))
        return fault_memory(fault, "an eliminator");
    e->cell[e->end++] = cell;
    return OK;
}

void eliminators_apply(struct eliminators *e)
{
    e->first = e->waiting;
    e->waiting = e->end;
}

void eliminators_forget(struct eliminators *e)
{
    e->first = e->waiting = e->end;
}

/* Those that were forgotten before the mark will not come back. */
void eliminators_mark(struct eliminators *e)
{
    if (e->first > 0 && e->end > e->first)
        memmove(e->cell, e->cell + e->first, (e->end - e->first) * sizeof *e->cell);
    e->waiting -= e->first;
    e->end -= e->first;
    e->first = 0;
    e->mark[0] = e->first;
    e->mark[1] = e->waiting;
    e->mark[2] = e->end;
}

void eliminators_rollback(struct eliminators *e)
{
    e->first = e->mark[0];
    e->waiting = e->mark[1];
    e->end = e->mark[2];
}
