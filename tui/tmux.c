/* SPDX-License-Identifier: MIT */
#include "tui/tmux.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"

#define QUESTION                                                                                   \
    "exec timeout 1 tmux display-message -p "                                                      \
    "'#{client_termtype}|#{client_termfeatures}|#{allow-passthrough}' 2>/dev/null </dev/null"

void tmux_wrap(struct buf *out, const struct buf *commands)
{
    const char *at = buf_text(commands);
    out->failed |= commands->failed;
    for (const char *end; (end = strstr(at, "\033\\")); at = end + 2) {
        buf_add_text(out, "\033Ptmux;\033");
        buf_add(out, at, (size_t)(end - at));
        buf_add_text(out, "\033\033\\\033\\");
    }
}

void tmux_read(struct tmux_client *client, const char *answer)
{
    struct choice field = {0};
    *client = (struct tmux_client){0};
    if (!choice_next(&field, &answer))
        return;
    if (field.length < sizeof client->name)
        memcpy(client->name, field.word, field.length);
    if (!choice_next(&field, &answer))
        return;
    for (const char *at = field.word, *end = at + field.length; at < end;) {
        const size_t length = strcspn(at, ",|");
        client->has_sixel |= length == 5 && memcmp(at, "sixel", 5) == 0;
        at += length + 1;
    }
    /* "0" and "1" in versions before 3.4 */
    static const enum tmux_passing passing[] = {TMUX_PASSES_NOTHING, TMUX_PASSES_NOTHING,
                                                TMUX_PASSES, TMUX_PASSES, TMUX_PASSES};
    char word[8] = {0};
    const size_t length = strcspn(answer, "\r\n");
    memcpy(word, answer, length < sizeof word ? length : 0);
    const int found = choice_find("off|0|on|1|all", word);
    client->passing = found < 0 ? TMUX_PASSING_UNKNOWN : passing[found];
}

bool tmux_ask(struct tmux_client *client)
{
    char answer[1024] = "";
    *client = (struct tmux_client){0};
    FILE *from = getenv("TMUX") ? popen(QUESTION, "re") : NULL;
    if (!from)
        return false;
    const size_t length = fread(answer, 1, sizeof answer - 1, from);
    pclose(from);
    tmux_read(client, answer);
    return length > 0;
}
