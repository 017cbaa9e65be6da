#include "tui/pilot/pilot_rows.h"

#include <string.h>

#include "tui/cells.h"

/* A row of text, cut to the screen, without a line feed. */
static void add_row(struct buf *out, unsigned row, unsigned columns, const char *text)
{
    struct buf cut = {0};
    cells_crop(&cut, text, columns);
    buf_printf(out, "\033[%u;1H\033[m\033[K", row + 1);
    buf_add(out, buf_text(&cut), strcspn(buf_text(&cut), "\r\n"));
    out->failed |= cut.failed;
    buf_release(&cut);
}

/* "axial 90 at 90,108,90  brush 2 pons r3 drawing  1 waits for space  label 1 head  ..." */
static void add_status(struct buf *row, const struct pilot_state *state,
                       const struct pilot_host *host, const struct pilot_facts *facts)
{
    static const char *const pane[] = {"axial", "coronal", "sagittal"};
    const uint32_t *at = facts->place;
    buf_printf(row, "%s %u at %u,%u,%u  brush ", pane[state->pane], facts->index[state->pane],
               at[0], at[1], at[2]);
    host->label(host->context, state->label, row);
    if (state->radius)
        buf_printf(row, " r%u", state->radius);
    buf_add_text(row, state->pen_is_down ? " drawing" : "");
    buf_add_text(row, state->has_mark ? " stroke" : "");
    if (facts->waiting)
        buf_printf(row, "  %zu wait%s for space", facts->waiting, facts->waiting == 1 ? "s" : "");
    buf_printf(row, "  %s", facts->where);
}

void pilot_rows_add(struct buf *out, const struct pilot_state *state, const struct pilot_host *host,
                    const struct pilot_facts *facts, const struct buf *message,
                    const struct term_size *size)
{
    struct buf upper = {0}, lower = {0};
    if (message->length)
        cells_wrap(&lower, message, size->columns);
    else
        pilot_keys_hint(state, facts, &lower);
    const char *second = strchr(buf_text(&lower), '\n');
    if (second)
        buf_add(&upper, buf_text(&lower), (size_t)(second - buf_text(&lower)));
    else
        add_status(&upper, state, host, facts);
    add_row(out, size->rows - 2, size->columns, buf_text(&upper));
    add_row(out, size->rows - 1, size->columns, second ? second + 1 : buf_text(&lower));
    out->failed |= upper.failed || lower.failed;
    buf_release(&upper);
    buf_release(&lower);
}

void pilot_rows_add_help(struct buf *out)
{
    struct buf page = {0};
    unsigned row = 1;
    pilot_keys_page(&page);
    for (const char *at = buf_text(&page); *at; row++) {
        const size_t n = strcspn(at, "\n");
        buf_printf(out, "\033[%u;1H\033[K", row + 1);
        buf_add(out, at, n);
        at += n + (at[n] == '\n');
    }
    buf_printf(out, "\033[%u;1H  any key goes on", row + 2);
    out->failed |= page.failed;
    buf_release(&page);
}

void pilot_rows_add_page(struct buf *out, const struct buf *text, size_t *at,
                         const struct term_size *size)
{
    const size_t first = *at;
    for (unsigned row = 1; row < size->rows && *at < text->length; row++) {
        const char *feed = memchr(text->data + *at, '\n', text->length - *at);
        *at = feed ? (size_t)(feed - (const char *)text->data) + 1 : text->length;
    }
    buf_add_text(out, "\033[m\033[H\033[2J");
    buf_add(out, buf_text(text) + first, *at - first);
    buf_printf(out, "\033[%u;1H%s", size->rows,
               *at < text->length ? "(any key: more; q: enough)" : "(any key)");
}
