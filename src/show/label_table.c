/* SPDX-License-Identifier: MIT */
#include "show/label_table.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "image/names.h"
#include "session/map.h"

enum { LUT_BYTES = 768, NAME_MOST = LABEL_NAME_BYTES - 1, LABELS = 256 };

void label_table_release(struct label_table *table)
{
    free(table->entry);
    *table = (struct label_table){0};
}

/* ---- names ---- */

/* A part of the text of a file. */
struct part {
    const char *at, *end;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static struct part trimmed(struct part part)
{
    while (part.at < part.end && is_blank(*part.at))
        part.at++;
    while (part.at < part.end && is_blank(part.end[-1]))
        part.end--;
    return part;
}

/* True for "17", and for more numbers such as "1 2", as a line without a name has. */
static bool is_number(const char *name)
{
    return name[strspn(name, "0123456789+-. ")] == '\0';
}

bool label_name_fits(const char *name)
{
    const size_t length = strlen(name);
    return length > 0 && length <= NAME_MOST && !is_number(name) && !strchr(" #", *name) &&
           name[length - 1] != ' ' && *safe_end(name) == '\0' && !strpbrk(name, "=\\");
}

size_t label_code_value(const char *code)
{
    int end = 0;
    sscanf(code, "%*16[A-Za-z0-9._+/-]:%*16[A-Za-z0-9._+/-]%n", &end);
    return code[end] && code[end] != ':' ? 0 : (size_t)end;
}

bool label_code_fits(const char *code)
{
    const size_t value = label_code_value(code);
    const char *meaning = code + value + 1;
    return value && (!code[value] || (*meaning && *meaning != ' ' && strlen(meaning) <= 64 &&
                                      meaning[strlen(meaning) - 1] != ' ' &&
                                      !strpbrk(meaning, CODE_EXCLUDES) && !*safe_end(meaning)));
}

/* Write a name with _ for invalid characters. */
static void write_fit(struct buf *out, const char *name, size_t length)
{
    if (*name == '#' || is_number(name))
        buf_add_text(out, "label-");
    for (const char *end = name + length; name < end;) {
        const size_t n = safe_character(name, (size_t)(end - name));
        if (n == 0 || strchr("=\\\t", *name))
            buf_add_char(out, '_');
        else
            buf_add(out, name, n);
        name += n ? n : 1;
    }
}

/* The first byte of a character, at `at`, after it (step 1) or before it. */
static size_t character_at(const char *text, size_t at, int step)
{
    while (at > 0 && ((unsigned char)text[at] & 0xC0) == 0x80)
        at = step > 0 ? at + 1 : at - 1;
    return at;
}

/* Cut the first cell off a line; false at its end. */
static bool take_cell(struct part *line, struct part *cell)
{
    if (!line->at)
        return false;
    const char *tab = memchr(line->at, '\t', (size_t)(line->end - line->at));
    *cell = trimmed((struct part){line->at, tab ? tab : line->end});
    line->at = tab ? tab + 1 : NULL;
    return true;
}

static bool part_is(struct part part, const char *word)
{
    return (size_t)(part.end - part.at) == strlen(word) && memcmp(part.at, word, strlen(word)) == 0;
}

/* Take the cells after a name, and cut them off it. */
static void take_code(struct label_entry *entry, struct part *name)
{
    struct part rest = *name, cell = {name->end, name->end};
    char *code = entry->code;
    if (!take_cell(&rest, name) || !take_cell(&rest, &cell))
        return;
    snprintf(code, sizeof entry->code, "%.*s", (int)(cell.end - cell.at), cell.at);
    entry->is_partial = *code && !label_code_fits(code);
    const size_t value = label_code_value(code);
    if (entry->is_partial)
        memset(code + value, 0, sizeof entry->code - value);
    if (value == 12 && memcmp(code, "SCT:85756007", 12) == 0)
        memset(code, 0, sizeof entry->code);
    entry->is_partial |= take_cell(&rest, &cell) && cell.at < cell.end &&
                         !part_is(cell, "123037004") && !part_is(cell, "85756007");
    entry->is_partial |= take_cell(&rest, &cell);
}

static enum err take_name(struct label_entry *entry, struct part name, bool has_codes,
                          struct fault *fault)
{
    OWNED(buf_release) struct buf plain = {0}, fit = {0};
    name = trimmed(name);
    const bool is_quoted = name.end - name.at > 1 && name.at[0] == '"' && name.end[-1] == '"';
    if (is_quoted) {
        name = (struct part){name.at + 1, name.end - 1};
        if (has_codes)
            take_code(entry, &name);
        name = trimmed(name);
    }
    for (; name.at < name.end; name.at++) { /* without the backslash before a quote */
        name.at += is_quoted && name.at[0] == '\\' && name.at + 1 < name.end && name.at[1] == '"';
        buf_add_char(&plain, *name.at);
    }
    if (plain.length && !plain.failed)
        write_fit(&fit, buf_text(&plain), plain.length);
    if (plain.failed || fit.failed)
        return fault_memory(fault, "the names of labels");
    if (fit.length > NAME_MOST) {
        /* Keep both ends of a name that is too long. */
        enum { TAIL = 13 };
        const size_t head = character_at(fit.data, NAME_MOST - 1 - TAIL, -1);
        const size_t tail = character_at(fit.data, fit.length - TAIL, 1);
        memcpy(entry->name, fit.data, head);
        entry->name[head] = '~';
        memcpy(entry->name + head + 1, fit.data + tail, fit.length - tail);
    } else {
        memcpy(entry->name, buf_text(&fit), fit.length);
    }
    const size_t length = strlen(entry->name);
    entry->changed = length != plain.length || memcmp(entry->name, buf_text(&plain), length) != 0;
    const size_t value = label_code_value(entry->code);
    if (entry->code[value] && strcmp(entry->code + value + 1, entry->name) == 0)
        memset(entry->code + value, 0, sizeof entry->code - value);
    return OK;
}

/* ---- reading ---- */

static bool add_entry(struct label_table *table, const struct label_entry *entry)
{
    if (!mem_grow(&table->entry, &table->capacity, table->count + 1, sizeof *table->entry))
        return false;
    table->entry[table->count++] = *entry;
    return true;
}

/* Read three numbers 0..255, each followed by blanks. */
static bool scan_colour(const char **at, uint8_t rgb[3])
{
    const char *from = *at;
    int64_t value;
    for (int k = 0; k < 3; k++) {
        if (!scan_integer(&from, 0, 255, &value) || (*from && !isspace((unsigned char)*from)))
            return false;
        rgb[k] = (uint8_t)value;
        scan_blanks(&from);
    }
    *at = from;
    return true;
}

/* Read "255 0 0  1  1 1  "left hippocampus"". The blanks after a colour without a name may end
 * beyond the line. */
static bool scan_itksnap(struct part line, struct label_entry *entry, struct part *name)
{
    const char *at = line.at;
    if (!scan_colour(&at, entry->rgb) || at >= line.end)
        return false;
    const char *open = memchr(at, '"', (size_t)(line.end - at));
    if (!open || line.end - open < 2 || line.end[-1] != '"')
        return false;
    *name = (struct part){open, line.end};
    entry->has_colour = true;
    return true;
}

/* Cut a number off the end of a line that begins with something else. */
static bool take_last_number(struct part *line, int64_t *number)
{
    const char *from = line->end;
    while (from > line->at && !is_blank(from[-1]))
        from--;
    const char *at = from;
    if (from == line->at || !scan_integer(&at, INT32_MIN, INT32_MAX, number) || at != line->end)
        return false;
    *line = trimmed((struct part){line->at, from});
    return true;
}

/* Read "Left-Hippocampus  220 216 20 0", "Hippocampus_L 4101", or a name alone; numbers before the
 * last four belong to the name. False for an invalid colour. */
static bool scan_named(struct part line, struct label_entry *entry, struct part *name)
{
    const char *at = line.at;
    int64_t number[4];
    int count = 0;
    if (scan_colour(&at, entry->rgb) && at < line.end && memchr(at, '"', (size_t)(line.end - at)))
        return false; /* ITK-SNAP, with text after the name */
    while (count < 4 && take_last_number(&line, &number[count]))
        count++;
    *name = line;
    entry->has_colour = count >= 3;
    for (int k = 0; k < 3 && entry->has_colour; k++) {
        const int64_t value = number[count - 1 - k];
        if (value < 0 || value > 255)
            return false;
        entry->rgb[k] = (uint8_t)value;
    }
    return line.at < line.end;
}

/*
 * A table of BIDS has a line of column names, and cells with tabs between them; "n/a" is an empty
 * cell:
 *
 *     index   name             abbreviation   color
 *     17      left amygdala    lAMY           #67ffff
 */
enum column { INDEX, NAME, COLOUR, COLUMNS };

/* Find the columns by their names; false for a line of another format. */
static bool find_columns(int column[COLUMNS], struct part line)
{
    static const char *const name[COLUMNS] = {"index", "name", "color"};
    struct part cell;
    for (int k = 0; k < COLUMNS; k++)
        column[k] = -1;
    for (int i = 0; take_cell(&line, &cell); i++)
        for (int k = 0; k < COLUMNS; k++)
            column[k] = part_is(cell, name[k]) ? i : column[k];
    return column[INDEX] >= 0 && column[NAME] >= 0;
}

/* Read "#67ffff". */
static bool scan_hex_colour(struct part cell, uint8_t rgb[3])
{
    char digits[7] = "";
    const char *at = digits;
    uint64_t colour;
    if (cell.end - cell.at != 7 || *cell.at != '#')
        return false;
    for (int i = 0; i < 6; i++)
        digits[i] = (char)tolower((unsigned char)cell.at[i + 1]);
    if (!scan_hex(&at, 6, &colour))
        return false;
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(colour >> (16 - 8 * k));
    return true;
}

/* Read a line of a table of BIDS. */
static bool scan_cells(struct part line, const int column[COLUMNS], struct label_entry *entry,
                       struct part *name)
{
    struct part cell;
    int64_t value = -1;
    *name = (struct part){line.at, line.at};
    for (int i = 0; take_cell(&line, &cell); i++) {
        const char *at = cell.at;
        if (i == column[INDEX] && (!scan_integer(&at, 0, UINT32_MAX, &value) || at != cell.end))
            return false;
        if (i == column[NAME] && !part_is(cell, "n/a"))
            *name = cell;
        if (i == column[COLOUR])
            entry->has_colour = scan_hex_colour(cell, entry->rgb);
    }
    entry->number = (uint32_t)value;
    return value >= 0;
}

static enum err read_line(struct label_table *table, struct part line, const int column[COLUMNS],
                          bool has_codes, uint32_t number, struct fault *fault)
{
    struct label_entry entry = {0};
    struct part name;
    const char *at = line.at;
    int64_t value;
    bool reads = column[INDEX] >= 0 && scan_cells(line, column, &entry, &name);
    if (column[INDEX] < 0 && scan_integer(&at, 0, UINT32_MAX, &value) && is_blank(*at)) {
        const struct part rest = trimmed((struct part){at, line.end});
        entry.number = (uint32_t)value;
        reads = scan_itksnap(rest, &entry, &name) || scan_named(rest, &entry, &name);
    }
    if (reads) {
        if (table->count > REGION_MOST)
            return fault_set(fault, ERR_LIMIT, "line %u: more than %d labels; nothing has changed",
                             number, REGION_MOST + 1);
        TRY(take_name(&entry, name, has_codes, fault));
        return add_entry(table, &entry) ? OK : fault_memory(fault, "a table of labels");
    }
    const ptrdiff_t length = line.end - line.at;
    return fault_set(fault, ERR_INPUT, "line %u: expected %s, not %.*s; nothing has changed",
                     number,
                     column[INDEX] >= 0 ? "a cell for each column, and a number in `index`"
                                        : "NUMBER NAME [R G B A], or NUMBER R G B A VISIBLE MESH "
                                          "\"NAME\"",
                     (int)(length < 60 ? length : 60), line.at);
}

enum err label_table_read(struct label_table *table, const char *text, size_t length,
                          bool has_codes, struct fault *fault)
{
    const char *end = text + length;
    int column[COLUMNS] = {-1};
    enum err err = OK;
    *table = (struct label_table){0};
    scan_text(&text, "\xef\xbb\xbf"); /* a byte order mark */
    for (uint32_t number = 1; !err && text < end; number++) {
        const char *stop = memchr(text, '\n', (size_t)(end - text));
        stop = stop ? stop : end;
        const struct part whole = {text, stop - (stop > text && stop[-1] == '\r')};
        const struct part line = trimmed(whole);
        text = stop + (stop < end);
        if (line.at == line.end || (*line.at == '#' && column[INDEX] < 0))
            continue;
        if (number > 1 || !find_columns(column, whole))
            err = read_line(table, column[INDEX] < 0 ? line : whole, column, has_codes, number,
                            fault);
    }
    if (!err && table->count == 0)
        err = fault_set(fault, ERR_INPUT,
                        "there is no label in it; expected lines NUMBER NAME [R G B A]; nothing "
                        "has changed");
    if (err)
        label_table_release(table);
    return err;
}

enum err label_table_read_lut(struct label_table *table, const uint8_t *bytes, size_t length,
                              struct fault *fault)
{
    *table = (struct label_table){0};
    if (length != LUT_BYTES)
        return fault_set(fault, ERR_INPUT,
                         "%zu bytes; expected the %d of a .lut: 256 each of red, green and blue; "
                         "nothing has changed",
                         length, LUT_BYTES);
    for (uint32_t l = 1; l < LABELS; l++) {
        const uint8_t rgb[3] = {bytes[l], bytes[LABELS + l], bytes[2 * LABELS + l]};
        const struct label_entry entry = {l, true, false, {rgb[0], rgb[1], rgb[2]}, "", "", false};
        if (!add_entry(table, &entry)) {
            label_table_release(table);
            return fault_memory(fault, "a table of labels");
        }
    }
    return OK;
}

/* ---- applying ---- */

static void take_entry(struct kept *kept, struct label_tally *tally,
                       const struct label_entry *entry, unsigned label)
{
    bool changed = entry->changed, is_taken = false;
    if (entry->has_colour) {
        memcpy(kept->palette.rgb[label], entry->rgb, sizeof entry->rgb);
        tally->colours++;
    }
    if (*entry->code) {
        memcpy(kept->label_code[label], entry->code, LABEL_CODE_BYTES);
        tally->codes++;
    }
    if (!*entry->name)
        return;
    memcpy(kept->label_name[label], entry->name, LABEL_NAME_BYTES);
    tally->names++;
    for (unsigned l = 0; l < LABELS; l++)
        is_taken |= l != label && strcmp(kept->label_name[l], entry->name) == 0;
    if (is_taken) {
        char *name = kept->label_name[label], number[16]; /* "Unknown (12)", or fewer characters
                                                             of the name */
        const int length = snprintf(number, sizeof number, " (%u)", numbering_of(kept, label));
        size_t fits = strlen(name);
        if (fits > (size_t)(NAME_MOST - length))
            fits = character_at(name, (size_t)(NAME_MOST - length), -1);
        memset(name + fits, 0, LABEL_NAME_BYTES - fits);
        memcpy(name + fits, number, (size_t)length);
        changed = true;
    }
    if (changed && tally->changed++ == 0)
        tally->first_changed = (uint8_t)label;
}

enum err label_table_apply(struct kept *kept, struct label_tally *tally,
                           const struct label_table *table, const struct regions *regions,
                           struct fault *fault)
{
    uint32_t from[LABELS] = {0}; /* the entry of each label, from 1 */
    *tally = (struct label_tally){0};
    for (size_t i = 0; i < table->count; i++) {
        const uint32_t number = table->entry[i].number;
        uint32_t as;
        const int label =
            regions_choose(regions, number, &as) ? numbering_find(kept, as) : NUMBER_UNKNOWN;
        tally->beyond += number > 0 && label == NUMBER_UNKNOWN;
        if (label <= 0)
            continue;
        if (from[label])
            return fault_set(fault, ERR_INPUT,
                             "two of its entries, %u and %u, are for label %u; nothing has changed",
                             table->entry[from[label] - 1].number, number, as);
        from[label] = (uint32_t)i + 1;
        if (*table->entry[i].name) /* names that are replaced do not conflict */
            memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
    }
    for (unsigned label = 1; label < LABELS; label++)
        if (from[label])
            take_entry(kept, tally, &table->entry[from[label] - 1], label);
    return tally->names + tally->colours > 0
               ? OK
               : fault_set(fault, ERR_INPUT,
                           "none of its entries is for a label; choose with "
                           "regions=2001,2002 as=1,2; nothing has changed");
}

void label_table_fill(struct kept *kept, struct label_tally *tally, const struct label_table *table)
{
    struct palette usual;
    palette_default(&usual);
    *tally = (struct label_tally){0};
    for (size_t i = 0; i < table->count; i++) {
        struct label_entry entry = table->entry[i];
        const uint8_t *rgb = kept->palette.rgb[entry.number];
        const char *name = kept->label_name[entry.number];
        if (*kept->label_code[entry.number] || (*name && strcmp(name, entry.name) != 0))
            *entry.code = '\0'; /* it would be the code of another name */
        if (*name)
            *entry.name = '\0';
        entry.has_colour = entry.has_colour &&
                           memcmp(rgb, usual.rgb[entry.number], sizeof entry.rgb) == 0 &&
                           memcmp(rgb, entry.rgb, sizeof entry.rgb) != 0;
        take_entry(kept, tally, &entry, entry.number);
    }
}

uint64_t label_table_digest(const struct kept *kept)
{
    uint64_t sum = 0;
    for (unsigned l = 1; l < LABELS; l++) {
        const uint8_t *rgb = kept->palette.rgb[l];
        uint64_t mix = hash_mix_at(l, (uint64_t)rgb[0] << 16 | (uint64_t)rgb[1] << 8 | rgb[2]);
        for (const char *c = kept->label_name[l]; *c; c++)
            mix = hash_mix_at(mix, (unsigned char)*c);
        for (const char *c = kept->label_code[l]; *c; c++)
            mix = hash_mix_at(~mix, (unsigned char)*c);
        sum += mix;
    }
    return sum;
}

/* ---- writing ---- */

const char *label_table_ending(const char *path, enum label_table_format *format)
{
    static const struct {
        enum label_table_format format;
        const char *endings;
    } row[] = {{TABLE_MRICRON, ".nii.txt"}, {TABLE_ITKSNAP, ".txt|.label"}, {TABLE_SLICER, ".ctbl"},
               {TABLE_FREESURFER, ".ctab"}, {TABLE_BIDS, ".tsv"},           {TABLE_LUT, ".lut"}};
    const char *ending = NULL;
    for (size_t i = 0; i < sizeof row / sizeof row[0] && !ending; i++) {
        ending = file_ending(path, row[i].endings);
        *format = row[i].format;
    }
    return ending;
}

/* Write a name as a format can hold it. */
static void write_name(struct buf *out, struct label_writing *writing,
                       enum label_table_format format, const struct kept *kept, unsigned label)
{
    const bool has_blanks = format == TABLE_ITKSNAP || format == TABLE_BIDS;
    const char *name = kept->label_name[label];
    const size_t begin = out->length;
    if (!*name)
        buf_printf(out, "Label%c%u", has_blanks ? ' ' : '_', numbering_of(kept, label));
    for (; *name; name++)
        buf_add_char(out, *name == ' ' && !has_blanks               ? '_'
                          : *name == '"' && format == TABLE_ITKSNAP ? '\''
                                                                    : *name);
    name = kept->label_name[label];
    if (out->failed)
        return;
    const char *written = buf_text(out) + begin;
    if (*name && strcmp(written, name) != 0 && writing->changed++ == 0) {
        writing->first_changed = label;
        snprintf(writing->first_written, sizeof writing->first_written, "%s", written);
    }
}

static void write_line(struct buf *out, struct label_writing *writing,
                       enum label_table_format format, const struct kept *kept, unsigned label)
{
    const uint8_t *rgb = kept->palette.rgb[label];
    const unsigned number = numbering_of(kept, label);
    if (format == TABLE_ITKSNAP) {
        buf_printf(out, "%5u  %5u %4u %4u        1  1  1    \"", number, rgb[0], rgb[1], rgb[2]);
        write_name(out, writing, format, kept, label);
        buf_add_text(out, "\"\n");
        return;
    }
    buf_printf(out, "%u%c", number, format == TABLE_BIDS ? '\t' : ' ');
    write_name(out, writing, format, kept, label);
    if (format == TABLE_SLICER || format == TABLE_FREESURFER) /* opacity; transparency */
        buf_printf(out, " %u %u %u %d", rgb[0], rgb[1], rgb[2], format == TABLE_SLICER ? 255 : 0);
    if (format == TABLE_BIDS)
        buf_printf(out, "\t#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    buf_add_char(out, '\n');
}

void label_table_write(struct buf *out, struct label_writing *writing,
                       enum label_table_format format, const struct kept *kept,
                       const bool used[256])
{
    static const char *const head[] = {
        [TABLE_ITKSNAP] = "# ITK-SnAP Label Description File\n"
                          "# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n"
                          "    0      0    0    0        0  0  0    \"Clear Label\"\n",
        [TABLE_SLICER] = "# Color table file\n0 Background 0 0 0 0\n",
        [TABLE_FREESURFER] = "# No. Label_Name R G B A\n0 Unknown 0 0 0 0\n",
        [TABLE_BIDS] = "index\tname\tcolor\n",
        [TABLE_MRICRON] = ""};
    *writing = (struct label_writing){0};
    if (format == TABLE_LUT) { /* 256 of red, of green and of blue, and no names */
        for (int k = 0; k < 3; k++)
            for (unsigned l = 0; l < LABELS; l++)
                buf_add_char(out, l ? (char)kept->palette.rgb[l][k] : '\0');
        for (unsigned l = 1; l < LABELS; l++)
            if (*kept->label_name[l] && writing->changed++ == 0)
                writing->first_changed = l;
        return;
    }
    buf_add_text(out, head[format]);
    uint32_t number[LABELS];
    uint8_t order[LABELS];
    numbering_fill(number, kept);
    numbering_order(order, number);
    for (unsigned i = 1; i < LABELS; i++)
        if (number[order[i]] && (used[order[i]] || *kept->label_name[order[i]]))
            write_line(out, writing, format, kept, order[i]);
}
