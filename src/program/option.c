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

enum option_kind option_next(struct option_words *words, char **word, const char **value)
{
    *value = NULL;
    while (words->at < words->count) {
        *word = words->word[words->at++];
        if (words->over || (*word)[0] != '-' || (*word)[1] == '\0')
            return OPTION_OPERAND;
        words->over = strcmp(*word, "--") == 0;
        if (words->over)
            continue;
        if (has_value(words->table, *word) && words->at < words->count)
            *value = words->word[words->at++];
        return OPTION_OPTION;
    }
    return OPTION_END;
}
