/* SPDX-License-Identifier: MIT */
/* Random commands, each from a form:
 *
 *     X Y Z, U V W    a random voxel of the scene, and another one: "box X,Y,Z U,V,W 2"
 *     <5> <3-7>       a number below 5; a number from 3 to 7
 *     [on|off|]       one of these texts, which may contain the above
 *
 * Commands have no capital letters of their own. random_form chooses one of many forms, with "; "
 * between them. */
#ifndef TESTS_RANDOM_COMMANDS_H
#define TESTS_RANDOM_COMMANDS_H

#include "tests/check.h"

/* Static storage. */
static inline const char *random_form(const char *forms, uint64_t *random)
{
    static char form[128];
    uint32_t count = 1;
    for (const char *at = forms; (at = strstr(at, "; ")) != NULL; at++)
        count++;
    for (uint32_t before = check_below(random, count); before > 0; before--)
        forms = strstr(forms, "; ") + 2;
    const char *end = strstr(forms, "; ");
    snprintf(form, sizeof form, "%.*s", end ? (int)(end - forms) : (int)strlen(forms), forms);
    return form;
}

static inline void random_command(char *line, size_t room, const char *form,
                                  const uint32_t sides[3], uint64_t *random)
{
    uint32_t place[6];
    char *out = line;
    for (int i = 0; i < 6; i++)
        place[i] = check_below(random, sides[i % 3]);
    for (char *at = (char *)(uintptr_t)form; *at; at++) {
        if (!CHECK(out + 12 < line + room))
            break;
        if (*at >= 'U' && *at <= 'Z') {
            out += sprintf(out, "%u", place[(*at - 'U' + 3) % 6]);
        } else if (*at == '<') {
            uint32_t low = 0, end = (uint32_t)strtoul(at + 1, &at, 10);
            if (*at == '-') {
                low = end;
                end = (uint32_t)strtoul(at + 1, &at, 10) + 1;
            }
            out += sprintf(out, "%u", low + check_below(random, end - low));
        } else if (*at == '[') { /* go to the text that is chosen */
            uint32_t texts = 1;
            for (const char *end = at; *end != ']'; end++)
                texts += *end == '|';
            for (uint32_t before = check_below(random, texts); before > 0;)
                before -= *++at == '|';
        } else if (*at == '|') { /* and behind the others */
            at = strchr(at, ']');
        } else if (*at != ']') {
            *out++ = *at;
        }
    }
    *out = '\0';
}

#endif
