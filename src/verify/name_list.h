/* SPDX-License-Identifier: MIT */
/*
 * A list of texts that is kept in the order of their bytes, each once: names of files, say, which
 * no file system lists in an order.
 *
 * `struct name_list list = {0}` is an empty one. It owns its texts.
 */
#ifndef VERIFY_NAME_LIST_H
#define VERIFY_NAME_LIST_H

#include <stdbool.h>
#include <stddef.h>

struct name_list {
    char **name;
    size_t count, capacity;
};

/* Adds a copy, unless it is there already; false without memory. Out of order: name_list_sort comes
 * before anything else is asked. */
bool name_list_add(struct name_list *list, const char *name);

/* Puts them in order, and leaves each once. */
void name_list_sort(struct name_list *list);

void name_list_release(struct name_list *list);

#endif
