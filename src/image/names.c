/* SPDX-License-Identifier: MIT */
#include "image/names.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"

/* Add a character in quotes; one of `blanks` as a blank. */
static void add_quoted(struct buf *names, char c, const char *blanks)
{
    if (c == '"')
        buf_add_char(names, '\\');
    buf_add_char(names, strchr(blanks, c) ? ' ' : c);
}

void names_add(struct buf *names, uint32_t number, const uint8_t rgb[3], const char *name,
               size_t length, const char *code)
{
    buf_printf(names, "%u ", number);
    if (rgb)
        buf_printf(names, "%u %u %u 1 1 1 ", rgb[0], rgb[1], rgb[2]);
    buf_add_char(names, '"');
    for (size_t i = 0; i < length; i++)
        add_quoted(names, name[i], "\t\n\r");
    buf_add_text(names, *code ? "\t" : "");
    while (*code)
        add_quoted(names, *code++, "\n\r");
    buf_add_text(names, "\"\n");
}

void names_split_code(char part[3][CODE_PART_BYTES], const struct volume_label *label)
{
    *part[2] = '\0';
    sscanf(label->code, "%16[^:]:%16[^:]:%64[^\n]", part[0], part[1], part[2]);
    if (!*part[2])
        snprintf(part[2], sizeof part[2], "%s", *label->name ? label->name : part[1]);
    for (char *c = part[2]; (c = strpbrk(c, CODE_EXCLUDES));)
        *c = '_';
}

bool names_scan_part(const char **at, uint8_t *part)
{
    struct decimal decimal;
    if (!decimal_scan(at, &decimal) || decimal.sign < 0)
        return false;
    const double value = decimal_value(&decimal) * 255 + 0.5;
    *part = value < 256 ? (uint8_t)value : 255;
    return true;
}

/* ---- XML ---- */

/* Return the first place of a word in the text, or its end. */
static const char *find(const char *at, const char *end, const char *word)
{
    const size_t length = strlen(word);
    while ((size_t)(end - at) >= length && memcmp(at, word, length) != 0) {
        const char *next = memchr(at + 1, *word, (size_t)(end - at) - 1);
        at = next ? next : end;
    }
    return (size_t)(end - at) >= length ? at : end;
}

/* Return the value of an attribute of the tag in at..end; NULL if it has none. */
static const char *find_attribute(const char *at, const char *end, const char *name)
{
    const size_t length = strlen(name);
    for (; at < end; at++) {
        const char quote = *at;
        if (quote == '"' || quote == '\'') { /* the value of another attribute */
            const char *close = memchr(at + 1, quote, (size_t)(end - at) - 1);
            at = close ? close : end - 1;
        } else if (strchr(" \t\r\n", quote) && (size_t)(end - at) > length + 2 &&
                   memcmp(at + 1, name, length) == 0 && at[length + 1] == '=' &&
                   strchr("\"'", at[length + 2]))
            return at + length + 3;
    }
    return NULL;
}

/* Append the character of a reference, "&lt;" or "&#60;", and return its length; 0 for others. */
static size_t add_reference(struct buf *name, const char *at, const char *end)
{
    static const char *const word[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    int64_t code;
    for (size_t i = 0; i < sizeof word / sizeof *word; i++) {
        const size_t length = strlen(word[i]);
        if ((size_t)(end - at) < length || memcmp(at, word[i], length) != 0)
            continue;
        buf_add_char(name, "&<>\"'"[i]);
        return length;
    }
    const char *from = at;
    if (!scan_text(&at, "&#") || !scan_integer(&at, 32, 126, &code) || !scan_text(&at, ";"))
        return 0;
    buf_add_char(name, (char)code);
    return (size_t)(at - from);
}

/* Read the text of an element up to its closing tag. */
static const char *read_content(struct buf *name, const char *at, const char *end)
{
    static const char begin[] = "<![CDATA[";
    while (at < end) {
        const char *from = at;
        if (scan_text(&from, begin)) {
            at = find(from, end, "]]>");
            buf_add(name, from, (size_t)(at - from));
            at += at < end ? 3 : 0;
            continue;
        }
        if (*at == '<')
            return at;
        const size_t length = *at == '&' ? add_reference(name, at, end) : 0;
        if (!length)
            buf_add_char(name, *at);
        at += length ? length : 1;
    }
    return end;
}

/* Read a <Label ...>NAME</Label>, from the end of its name on. */
static const char *read_label(struct buf *names, struct buf *name, const char *at, const char *end)
{
    static const char *const part[] = {"Red", "Green", "Blue"};
    const char *close = find(at, end, ">");
    const char *key = find_attribute(at, close, "Key");
    uint8_t rgb[3];
    bool has_colour = true;
    int64_t number = -1;
    char code[128] = "";
    const char *of = find_attribute(at, close, "Code");
    const char quote = of ? of[-1] : 0;
    for (size_t i = 0; of && of < close && *of != quote && i < sizeof code - 1; i++, of++)
        code[i] = *of == '\t' ? ' ' : *of;
    for (int k = 0; k < 3; k++) {
        const char *value = find_attribute(at, close, part[k]);
        has_colour = has_colour && value && names_scan_part(&value, &rgb[k]);
    }
    const bool is_empty = close == end || close[-1] == '/';
    buf_clear(name);
    at = is_empty ? close : read_content(name, close + 1, end);
    if (!key || !scan_integer(&key, 0, UINT32_MAX, &number) || name->failed ||
        (number == 0 && strcmp(buf_text(name), "???") == 0))
        return at;
    names_add(names, (uint32_t)number, has_colour ? rgb : NULL, buf_text(name), name->length, code);
    return at;
}

void names_read_xml(struct buf *names, const char *xml, size_t length, uint32_t table)
{
    static const char open[] = "<LabelTable", element[] = "<Label";
    const char *end = xml + length, *at = find(xml, end, open);
    OWNED(buf_release) struct buf name = {0};
    for (const char *next = at; next < end && table-- > 0;) {
        next = find(next + 1, end, open);
        at = next < end ? next : at;
    }
    at += at < end ? sizeof open - 1 : 0;
    const char *stop = find(at, end, "</LabelTable");
    while ((at = find(at, stop, "<")) < stop) {
        const char *word = at++;
        if (scan_text(&word, "!--"))
            at = find(word, stop, "-->");
        else if (scan_text(&word, element) && strchr(" \t\r\n", *word))
            at = read_label(names, &name, word, stop);
    }
    names->failed |= name.failed;
}

unsigned names_next(const struct volume_label label[256], uint32_t *last)
{
    unsigned next = 0;
    for (unsigned l = 1; l < 256; l++)
        if (label[l].number > *last && (label[l].used || *label[l].name) &&
            (!next || label[l].number < label[next].number))
            next = l;
    *last = next ? label[next].number : *last;
    return next;
}

void names_write_xml(struct buf *out, const struct volume_label label[256])
{
    buf_add_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CaretExtension>\n"
                      " <VolumeInformation Index=\"0\">\n  <LabelTable>\n   <Label Key=\"0\" "
                      "Red=\"0\" Green=\"0\" Blue=\"0\" Alpha=\"0\"><![CDATA[???]]></Label>\n");
    uint32_t last = 0;
    for (unsigned l; (l = names_next(label, &last)) > 0;) {
        const struct volume_label *of = &label[l];
        buf_printf(out, "   <Label Key=\"%u\" Red=\"%.6f\" Green=\"%.6f\" Blue=\"%.6f\" ",
                   of->number, of->rgb[0] / 255.0, of->rgb[1] / 255.0, of->rgb[2] / 255.0);
        buf_printf(out, *of->code ? "Alpha=\"1\" Code=\"%s\"><![CDATA[" : "Alpha=\"1\"%s><![CDATA[",
                   of->code);
        for (const char *c = of->name; *c; c++) {
            if (*c == '>' && c > of->name + 1 && c[-1] == ']' && c[-2] == ']')
                buf_add_text(out, "]]><![CDATA[");
            buf_add_char(out, *c);
        }
        buf_add_text(out, "]]></Label>\n");
    }
    buf_add_text(out, "  </LabelTable>\n  <StudyMetaDataLinkSet>\n  </StudyMetaDataLinkSet>\n"
                      "  <VolumeType><![CDATA[Label]]></VolumeType>\n </VolumeInformation>\n"
                      "</CaretExtension>\n");
}
