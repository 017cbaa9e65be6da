/* SPDX-License-Identifier: MIT */
#include "verify/name_list.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

bool name_list_add(struct name_list *list, const char *name)
{
    char *copy = strdup(name);
    if (!copy || !mem_grow(&list->name, &list->capacity, list->count + 1, sizeof *list->name)) {
        free(copy);
        return false;
    }
    list->name[list->count++] = copy;
    return true;
}

static int compare(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

void name_list_sort(struct name_list *list)
{
    size_t kept = 0;
    if (list->count)
        qsort(list->name, list->count, sizeof *list->name, compare);
    for (size_t i = 0; i < list->count; i++) {
        if (kept && strcmp(list->name[kept - 1], list->name[i]) == 0)
            free(list->name[i]);
        else
            list->name[kept++] = list->name[i];
    }
    list->count = kept;
}

void name_list_release(struct name_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->name[i]);
    free(list->name);
    *list = (struct name_list){0};
}
