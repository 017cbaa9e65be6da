/* SPDX-License-Identifier: MIT */
#include "tui/theme.h"

#include <string.h>

const struct theme theme_dark = {.name = "dark",
                                 .hint = "\033[38;5;244m",
                                 .hint_16 = "\033[90m",
                                 .alarm = "\033[1;97;41m",
                                 .heading = "\033[1;36m",
                                 .key = "\033[33m",
                                 .has_colours = true};
static const struct theme theme_light = {.name = "light",
                                         .hint = "\033[38;5;242m",
                                         .hint_16 = "\033[90m",
                                         .alarm = "\033[1;97;41m",
                                         .heading = "\033[1;34m",
                                         .key = "\033[35m",
                                         .has_colours = true};
static const struct theme theme_none = {
    .name = "none", .hint = "", .hint_16 = "", .alarm = "\033[7m", .heading = "", .key = ""};

const struct theme *theme_find(const char *name)
{
    static const struct theme *const all[] = {&theme_dark, &theme_light, &theme_none};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (strcmp(all[i]->name, name) == 0)
            return all[i];
    return NULL;
}
