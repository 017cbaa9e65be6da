/* SPDX-License-Identifier: MIT */
#include "manual/markdown.h"

#include <ctype.h>
#include <string.h>

#include "manual/roff.h"

enum { CELLS_MOST = 8, CODE_INDENT = 4 };

struct page {
    struct buf *out;
    const char *next; /* line */
    unsigned line;
    bool failed;
    struct buf paragraph;          /* what was read of one, in one line */
    const char *before;            /* what parts the next paragraph or lines from what is there */
    struct buf head;               /* the first row of the table that is being read */
    size_t begins[CELLS_MOST + 1]; /* where each of its cells begins there */
    unsigned columns;              /* 0: no table */
};

struct line {
    const char *text;
    size_t length;
};

static bool take_line(struct page *page, struct line *line)
{
    if (!*page->next)
        return false;
    *line = (struct line){page->next, strcspn(page->next, "\n")};
    page->next += line->length;
    page->next += *page->next == '\n';
    page->line++;
    return true;
}

static bool begins(const struct line *line, const char *with)
{
    return line->length >= strlen(with) && memcmp(line->text, with, strlen(with)) == 0;
}

static size_t indent_of(const struct line *line)
{
    size_t n = 0;
    while (n < line->length && line->text[n] == ' ')
        n++;
    return n;
}

/* ---- words ---- */

/* One paragraph, or cell, with its fonts; a mark that is not closed, a link or a tag is refused. */
static void add_words(struct page *page, const char *text)
{
    struct roff_lines lines = {page->out, 0};
    struct buf word = {0};
    bool is_typed = false, is_strong = false, is_stressed = false;
    for (; *text; text++) {
        bool is_mark = *text == '`' || (!is_typed && *text == '*');
        if (*text == '`')
            is_typed = !is_typed;
        else if (is_mark && text[1] == '*')
            text++, is_strong = !is_strong;
        else if (is_mark)
            is_stressed = !is_stressed;
        page->failed |= !is_typed && (*text == '<' || strncmp(text, "](", 2) == 0);
        if (is_mark)
            buf_printf(&word, "\\f%c", is_typed || is_strong ? 'B' : is_stressed ? 'I' : 'R');
        else if (*text != ' ')
            roff_add_escaped(&word, text, 1);
        if (word.length && (text[1] == ' ' || !text[1])) {
            roff_add_word(&lines, &word);
            buf_clear(&word);
        }
    }
    buf_add_char(page->out, '\n');
    page->failed |= is_typed || is_strong || is_stressed;
    buf_release(&word);
}

static void end_paragraph(struct page *page)
{
    if (page->paragraph.length) {
        buf_add_text(page->out, page->before);
        add_words(page, buf_text(&page->paragraph));
        page->before = ".PP\n";
    }
    buf_clear(&page->paragraph);
}

/* ---- lines as they are ---- */

static void begin_verbatim(struct page *page, bool is_of_item)
{
    buf_printf(page->out, "%s.nf\n", is_of_item ? ".IP\n" : page->before);
}

static void add_verbatim(struct page *page, const struct line *line, size_t indent)
{
    struct buf shown = {0};
    if (line->length > indent) {
        buf_printf(&shown, "%*s", CODE_INDENT, "");
        buf_add(&shown, line->text + indent, line->length - indent);
    }
    roff_add_verbatim(page->out, buf_text(&shown), shown.length);
    page->out->failed |= shown.failed;
    buf_release(&shown);
}

static void end_verbatim(struct page *page)
{
    buf_add_text(page->out, ".fi\n");
    page->before = ".PP\n";
}

static void add_fenced(struct page *page)
{
    struct line line = {0};
    bool any = false;
    begin_verbatim(page, false);
    while ((any = take_line(page, &line)) && !begins(&line, "```"))
        add_verbatim(page, &line, 0);
    page->failed |= !any;
    end_verbatim(page);
}

/* Those from `line` on that are indented as far as it is. */
static void add_indented(struct page *page, struct line line)
{
    const size_t indent = indent_of(&line);
    begin_verbatim(page, indent > CODE_INDENT);
    add_verbatim(page, &line, indent);
    for (;;) {
        const struct line next = {page->next, strcspn(page->next, "\n")};
        if (indent_of(&next) < indent || !take_line(page, &line))
            break;
        add_verbatim(page, &line, indent);
    }
    end_verbatim(page);
}

/* ---- tables ---- */

/* Where a row's next cell ends: at a '|' that is not typed. */
static size_t cell_end(const char *text, size_t at, size_t length)
{
    for (bool is_typed = false; at < length && (is_typed || text[at] != '|'); at++)
        is_typed ^= text[at] == '`';
    return at;
}

/* `row` is "| a | b |"; the cells go to `out`, each ended by a NUL, and begin at `at`. */
static unsigned split_row(const struct line *row, struct buf *out, size_t at[CELLS_MOST + 1])
{
    unsigned n = 0;
    buf_clear(out);
    for (size_t i = 1; i < row->length && n < CELLS_MOST; n++) {
        size_t end = cell_end(row->text, i, row->length);
        const size_t next = end + 1;
        while (i < end && row->text[i] == ' ')
            i++;
        while (end > i && row->text[end - 1] == ' ')
            end--;
        at[n] = out->length;
        buf_add(out, row->text + i, end - i);
        buf_add_char(out, '\0');
        i = next;
    }
    return n;
}

static void add_row(struct page *page, const struct line *row)
{
    struct buf cells = {0}, said = {0};
    size_t at[CELLS_MOST + 1];
    const char *between = ".IP \\(bu 2\n";
    if (!page->columns) {
        page->columns = split_row(row, &page->head, page->begins);
    } else if (!begins(row, "|---")) {
        page->failed |= split_row(row, &cells, at) != page->columns;
        for (unsigned i = 0; i < page->columns && !page->failed && !cells.failed; i++) {
            if (!cells.data[at[i]])
                continue;
            buf_clear(&said);
            buf_printf(&said, "*%s:* %s", page->head.data + page->begins[i], cells.data + at[i]);
            buf_add_text(page->out, between);
            add_words(page, buf_text(&said));
            between = ".br\n";
        }
        page->before = ".PP\n";
    }
    page->out->failed |= page->head.failed || cells.failed || said.failed;
    buf_release(&cells);
    buf_release(&said);
}

/* ---- the text ---- */

static void add_heading(struct page *page, const struct line *line)
{
    const bool is_first = line->text[1] == ' ';
    const size_t mark = is_first ? 2 : 3;
    page->failed |= !is_first && !begins(line, "## ");
    buf_add_text(page->out, is_first ? ".SH " : ".SS ");
    if (is_first)
        roff_add_capitals(page->out, line->text + mark, line->length - mark);
    else if (!page->failed)
        roff_add_escaped(page->out, line->text + mark, line->length - mark);
    buf_add_char(page->out, '\n');
    page->before = "";
}

/* How long the mark of an item is that begins there: "- ", "12. "; 0 where none does. */
static size_t item_mark(const struct line *line)
{
    size_t n = 0;
    if (begins(line, "- "))
        return 2;
    while (n < line->length && isdigit((unsigned char)line->text[n]))
        n++;
    return n && n + 1 < line->length && memcmp(line->text + n, ". ", 2) == 0 ? n + 2 : 0;
}

static void begin_item(struct page *page, const struct line *line, size_t mark)
{
    if (*line->text == '-')
        buf_add_text(page->out, ".IP \\(bu 2\n");
    else
        buf_printf(page->out, ".IP %.*s 3\n", (int)mark - 1, line->text);
    page->before = "";
    buf_add(&page->paragraph, line->text + mark, line->length - mark);
}

static void add_line(struct page *page, const struct line *line)
{
    const size_t mark = item_mark(line), indent = indent_of(line);
    const bool is_row = begins(line, "|"), goes_on = page->paragraph.length && !mark;
    if (!is_row)
        page->columns = 0;
    if (!goes_on || !line->length || is_row || begins(line, "```") || begins(line, "#"))
        end_paragraph(page);
    if (!line->length)
        return;
    if (begins(line, "```"))
        add_fenced(page);
    else if (begins(line, "#"))
        add_heading(page, line);
    else if (is_row)
        add_row(page, line);
    else if (mark)
        begin_item(page, line, mark);
    else if (page->paragraph.length) {
        buf_add_blank(&page->paragraph);
        buf_add(&page->paragraph, line->text + indent, line->length - indent);
    } else if (indent >= CODE_INDENT)
        add_indented(page, *line);
    else {
        page->failed |= indent > 0; /* a second paragraph of an item */
        buf_add(&page->paragraph, line->text, line->length);
    }
}

unsigned markdown_add(struct buf *out, const char *text)
{
    struct page page = {.out = out, .next = text, .before = ""};
    struct line line;
    while (!page.failed && take_line(&page, &line))
        add_line(&page, &line);
    end_paragraph(&page);
    out->failed |= page.paragraph.failed;
    buf_release(&page.paragraph);
    buf_release(&page.head);
    return page.failed ? page.line : 0;
}
