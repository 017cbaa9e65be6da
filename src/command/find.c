/* SPDX-License-Identifier: MIT */
#include "command/find.h"

#include <string.h>

#include "base/choice.h"
#include "command/command.h"
#include "session/setting.h"

/* What the piece is of, the best first. */
enum { OF_NAME, OF_CHOICE, OF_KEY, OF_SUMMARY, WITHIN_NAME, RANKS };

/* Whether a word of the text begins so, from the byte `from` on. */
static bool has_word(const char *text, const char *piece, size_t from)
{
    for (const char *at = text; (at = strcasestr(at, piece)); at++)
        if (at >= text + from && (at == text || strchr(" -(`/", at[-1])))
            return true;
    return false;
}

static void add(struct buf *out, const char *name, const struct choice *choice, const char *key,
                const char *note, size_t length)
{
    buf_add_text(out, name);
    if (choice) {
        buf_add_char(out, ' ');
        buf_add(out, choice->word, choice->length);
    }
    buf_add_char(out, '\t');
    buf_printf(out, "%s%s", key, *key ? "=: " : "");
    buf_add(out, note, length);
    buf_add_char(out, '\n');
}

/* Its first parameter's; words such as on and none say nothing of what they are about. */
static void find_choices(struct buf *out, const struct command *command, const char *piece,
                         unsigned *count)
{
    const struct parameter *p = command->parameter;
    const char *choices = p->type && !p->keyed && p->choices ? p->choices : "";
    struct choice choice;
    while (choice_next(&choice, &choices)) {
        size_t length;
        const char *note = command_note(command, choice.word, choice.length, &length);
        if (choice.length < strlen(piece) || choice.length < 4 ||
            strncasecmp(choice.word, piece, strlen(piece)) != 0 || *count == COMMANDS_FOUND_MOST)
            continue;
        if (!length)
            note = command->summary, length = strlen(note);
        add(out, command->name, &choice, "", note, length);
        ++*count;
    }
}

static bool is_of_key(const struct command *command, const char *piece, const char **key)
{
    for (const struct parameter *p = command->parameter; p->type; p++)
        if (p->keyed && strncasecmp(p->name, piece, strlen(piece)) == 0) {
            *key = p->name;
            return true;
        }
    return false;
}

static unsigned rank_of(const struct command *command, const char *piece, const char **key)
{
    *key = "";
    return has_word(command->name, piece, 1)      ? OF_NAME
           : is_of_key(command, piece, key)       ? OF_KEY
           : has_word(command->summary, piece, 0) ? OF_SUMMARY
           : strcasestr(command->name, piece)     ? WITHIN_NAME
                                                  : RANKS;
}

void command_find_by_piece(struct buf *out, const char *piece, bool are_some)
{
    unsigned count = 0;
    for (unsigned rank = OF_NAME; rank < (are_some ? OF_KEY : RANKS); rank++)
        for (unsigned i = 0; i < command_count() && count < COMMANDS_FOUND_MOST; i++) {
            const struct command *command = command_at(i);
            const char *key, *note = command->summary;
            size_t length = strlen(note);
            if (rank == OF_CHOICE)
                find_choices(out, command, piece, &count);
            else if (strncasecmp(command->name, piece, strlen(piece)) != 0 &&
                     rank_of(command, piece, &key) == rank) {
                size_t of_key = 0;
                const char *words = *key ? command_note(command, key, strlen(key), &of_key) : note;
                add(out, command->name, NULL, key, of_key ? words : note, of_key ? of_key : length);
                count++;
            }
        }
}
