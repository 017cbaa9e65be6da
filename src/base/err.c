/* SPDX-License-Identifier: MIT */
#include "base/err.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/safe.h"

/* Replace the text, safe to print. */
static void set_words(struct fault *fault, const char *format, va_list words)
{
    char raw[sizeof fault->text];
    vsnprintf(raw, sizeof raw, format, words);
    safe_copy(fault->text, sizeof fault->text, raw, strlen(raw));
}

enum err fault_set(struct fault *fault, enum err code, const char *format, ...)
{
    if (!fault)
        return code;
    va_list words;
    va_start(words, format);
    set_words(fault, format, words);
    va_end(words);
    fault->code = code;
    fault->at = 0;
    return code;
}

enum err fault_prefix(struct fault *fault, enum err code, const char *format, ...)
{
    if (!fault || !code)
        return code;
    char former[sizeof fault->text];
    va_list words;
    memcpy(former, fault->text, sizeof former);
    va_start(words, format);
    set_words(fault, format, words);
    va_end(words);
    size_t used = strlen(fault->text);
    snprintf(fault->text + used, sizeof fault->text - used, ": %s", former);
    return fault->code;
}

void fault_append(struct fault *fault, const char *words)
{
    const size_t used = fault ? strlen(fault->text) : 0, length = strlen(words);
    if (fault && used + length < sizeof fault->text)
        memcpy(fault->text + used, words, length + 1);
}

enum err fault_errno(struct fault *fault, const char *what, const char *path)
{
    return fault_set(fault, ERR_IO, "cannot %s %s: %s", what, path, strerror(errno));
}

enum err fault_memory(struct fault *fault, const char *purpose)
{
    return fault_set(fault, ERR_MEMORY, "out of memory for %s; nothing has changed", purpose);
}

static const struct {
    int status;
    const char *name;
} err_table[] = {
#define ERR_ROW(code, status, name) {status, name},
    ERR_LIST(ERR_ROW)};

int err_exit_status(enum err code)
{
    return err_table[code].status;
}

const char *err_name(enum err code)
{
    return err_table[code].name;
}
