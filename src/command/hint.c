/* What may follow in a line that is being typed. */
#include "command/partial.h"

static void add_hint(struct buf *out, struct partial *p)
{
    struct buf rest = {0};
    const bool begins = p->word.length == 0;
    if (p->words == 0 && !p->quoted) /* the name itself may be whole already */
        p->command = begins ? NULL : command_find(buf_text(&p->word));
    if (!p->command || (p->quoted && !p->closed) || (!begins && p->words > 0 && p->parameter < 0))
        return;
    if (p->words > 0 && p->key > 0 && buf_text(&p->word)[p->key] == '\0')
        usage_form(&rest, &p->command->parameter[p->parameter]);
    if (p->words > 0 && !begins)
        partial_give(p, p->parameter, buf_text(&p->word) + p->key);
    usage_rest(&rest, p->command->parameter, p->value);
    const char *text = buf_text(&rest);
    buf_add_text(out, begins && *text == ' ' ? text + 1 : text);
    out->failed |= rest.failed;
    buf_release(&rest);
}

void command_hint(struct buf *out, const char *line, size_t length)
{
    struct partial partial;
    if (partial_read(&partial, line, length))
        add_hint(out, &partial);
    partial_release(&partial);
}
