#include "command/partial.h"

#include <string.h>

#include "base/choice.h"
#include "base/scan.h"

void partial_give(struct partial *p, int i, const char *word)
{
    const struct parameter *parameter = p->command->parameter + i;
    p->value[i].given = true;
    if (parameter[1].paired && choice_find(parameter->choices, word) >= 0)
        p->value[i + 1].given = true;
}

static void take_whole_word(struct partial *p)
{
    const char *word = buf_text(&p->word);
    if (p->words++ == 0) {
        p->command = command_find(word);
        return;
    }
    const int i = p->command ? command_parameter_for(p->command, p->value, &word) : -1;
    if (i >= 0)
        partial_give(p, i, word);
}

/* The words of `line`, up to the one at its end. */
static bool read_words(struct partial *p, const char *line)
{
    const char *at = line;
    for (scan_blanks(&at); *at; scan_blanks(&at)) {
        const char *word = at;
        buf_clear(&p->word);
        p->start = (size_t)(word - line);
        p->quoted = strchr(COMMAND_QUOTES, *word) != NULL;
        const bool ends = command_take_word(&at, &p->word, COMMAND_QUOTES);
        if (!ends && at != word)
            return false;
        p->closed = ends && p->quoted;
        if (!ends || *at == '\0')
            return true;
        take_whole_word(p);
    }
    buf_clear(&p->word);
    p->quoted = p->closed = false;
    p->start = strlen(line);
    return true;
}

bool partial_read(struct partial *partial, const char *line, size_t cursor)
{
    struct buf before = {0};
    *partial = (struct partial){.parameter = -1};
    buf_add(&before, line, cursor);
    const char *text = buf_text(&before), *first = text;
    scan_blanks(&first);
    bool fine = *first != '#' && read_words(partial, text);
    if (fine && partial->command) {
        const char *word = buf_text(&partial->word), *value = word;
        partial->parameter = command_parameter_for(partial->command, partial->value, &value);
        partial->key = (size_t)(value - word);
    }
    fine = fine && !before.failed && !partial->word.failed;
    buf_release(&before);
    return fine;
}

void partial_release(struct partial *partial)
{
    buf_release(&partial->word);
}
