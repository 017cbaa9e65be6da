#include "program/option.h"

#include <string.h>

#include "base/scan.h"

enum err option_read_flag(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    (void)text;
    (void)fault;
    *(bool *)((char *)out + option->at) = true;
    return OK;
}

enum err option_read_text(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    (void)fault;
    *(const char **)((char *)out + option->at) = text;
    return OK;
}

enum err option_read_number(const struct option *option, const char *text, void *out,
                            struct fault *fault)
{
    const char *at = text;
    int64_t number;
    if (!scan_integer(&at, option->least, option->most, &number) || *at)
        return fault_set(fault, ERR_USAGE, "%s: expected a number %lld..%lld, not %s", option->name,
                         (long long)option->least, (long long)option->most, text);
    *(size_t *)((char *)out + option->at) = (size_t)number;
    return OK;
}

enum err option_read_list(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    if (!scan_is_list(text, option->least, option->most))
        return fault_set(fault, ERR_USAGE,
                         "%s: expected numbers %lld..%lld, as in 1-90,105, not %s", option->name,
                         (long long)option->least, (long long)option->most, text);
    return option_read_text(option, text, out, fault);
}

uint8_t option_find(const struct option_table *table, const uint8_t *taken, const char *name)
{
    while (*taken && strcmp(table->row[*taken].name, name) != 0)
        taken++;
    return *taken;
}

static bool has_value(const struct option_table *table, const char *name)
{
    for (unsigned i = 1; i < table->rows; i++)
        if (strcmp(table->row[i].name, name) == 0)
            return table->row[i].value != NULL;
    return false;
}

bool option_next(struct option_words *w)
{
    while (w->at < w->count) {
        w->text = w->word[w->at++];
        w->value = NULL;
        w->is_option = !w->over && w->text[0] == '-' && w->text[1];
        if (!w->is_option)
            return true;
        w->over = strcmp(w->text, "--") == 0;
        if (w->over)
            continue;
        if (has_value(w->table, w->text) && w->at < w->count)
            w->value = w->word[w->at++];
        return true;
    }
    return false;
}
