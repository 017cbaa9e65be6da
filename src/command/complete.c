/* SPDX-License-Identifier: MIT */
/*
 * Usage, help and completion of commands.
 *
 * Completion offers words by the table, the session and the files on the disk, as they are typed.
 * If one of them needs quotes, all are quoted, so that they have a common prefix; the same if a
 * quote was typed. A folder has no closing quote, since its files can follow. A tab and an
 * explanation may follow a word: the summary of a command, the help of a choice, a label's number,
 * the command of a record.
 */
#include "command/command.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "command/golden_files.h"
#include "command/interpreter.h"
#include "journal/golden.h"
#include "session/setting.h"

/* Columns; 50 remain for summaries. */
enum { INDENT = 4, SUMMARY_COLUMN = 26, LINE_MOST = 76 }; /* `iftty -c` adds 4 columns */

/* ---- usage and help ---- */

/* True if its choices are its only values. */
static bool is_choice(const struct parameter *p)
{
    return p->type == VALUE_CHOICE || p->type == VALUE_PARTS;
}

static void add_form(struct buf *out, const struct parameter *p)
{
    static const char *const form[VALUE_WORD + 1] = {
        [VALUE_POSITION] = "X,Y,Z",     [VALUE_LINE] = "X,Y,Z",      [VALUE_RANGE] = "A-B",
        [VALUE_LIST] = "A-B,C",         [VALUE_LABEL] = "LABEL",     [VALUE_COLOUR] = "#rrggbb",
        [VALUE_INTERVAL] = "LOW..HIGH", [VALUE_LABELS] = "A-B,NAME",
    };
    const double unit = p->type == VALUE_DECIMAL ? 1000 : 1;
    const bool is_number = p->type == VALUE_DECIMAL || p->type == VALUE_NUMBER;
    if (p->form || form[p->type])
        buf_add_text(out, p->form ? p->form : form[p->type]);
    else if (p->type == VALUE_RADIUS)
        buf_printf(out, "%lld..%lld|Rmm", (long long)p->least, (long long)p->most);
    else if (p->type == VALUE_FILE && p->keyed)
        buf_add_text(out, "FILE");
    else if (is_number && p->keyed)
        buf_printf(out, "%.10g..%.10g", (double)p->least / unit, (double)p->most / unit);
    else if (!is_choice(p))
        buf_add_text(out, p->name);
}

/* Add the form of a value: "X,Y,Z", "on|off", "0..32". */
static void usage_form(struct buf *out, const struct parameter *p)
{
    if (p->choices && !(p->type == VALUE_CHOICE && p->form))
        buf_printf(out, "%s%s", p->choices, is_choice(p) ? "" : "|");
    add_form(out, p);
}

/* Add "LABEL" or "[radius=0..32]"; "LOW HIGH|none" if the next one is paired with it. */
static void add_parameter(struct buf *out, const struct parameter *p)
{
    const bool brackets = p->optional && !p->paired;
    buf_add_text(out, brackets ? " [" : " ");
    if (p->keyed)
        buf_printf(out, "%s=", p->name);
    if (p[1].paired) {
        add_form(out, p);
        add_parameter(out, p + 1);
        buf_printf(out, "|%s", p->choices);
    } else {
        usage_form(out, p);
    }
    buf_add_text(out, p->type == VALUE_LINE || p->type == VALUE_PARTS ? " ..." : "");
    buf_add_text(out, brackets ? "]" : "");
}

/* Add the parameters not given yet (`value` NULL: all), each after a blank, with keys and brackets:
 * " LABEL [radius=0..32]". Positional ones come first. */
static void usage_rest(struct buf *out, const struct parameter *p, const struct value *value)
{
    for (int keyed = 0; keyed < 2; keyed++)
        for (int i = 0; p[i].type; i++) {
            const bool given = value && value[i].given && p[i].type != VALUE_LINE;
            const bool has_shown = p[i].paired && !(value && value[i - 1].given);
            if (p[i].keyed == keyed && !given && !has_shown)
                add_parameter(out, &p[i]);
        }
}

void command_usage(struct buf *out, const struct command *command)
{
    buf_add_text(out, command->name);
    usage_rest(out, command->parameter, NULL);
}

/* Add text in indented lines of at most `most` columns, broken at a gap. */
static void add_lines(struct buf *out, const char *text, size_t length, const char *gap,
                      size_t indent, size_t most)
{
    const size_t gap_length = strlen(gap);
    while (indent + length > most) {
        size_t n = most - indent;
        while (n > 0 && strncmp(text + n, gap, gap_length) != 0)
            n--;
        if (n == 0)
            break;
        buf_printf(out, "%*s%.*s\n", (int)indent, "", (int)n, text);
        text += n + 1;
        length -= n + 1;
        indent = INDENT;
    }
    buf_printf(out, "%*s%.*s\n", (int)indent, "", (int)length, text);
}

static void add_usage(struct buf *out, const struct command *command)
{
    OWNED(buf_release) struct buf usage = {0};
    command_usage(&usage, command);
    add_lines(out, buf_text(&usage), usage.length, " [", 0, LINE_MOST);
    out->failed |= usage.failed;
}

struct choice command_note(const struct command *command, const char *word, size_t length)
{
    for (const char *at = command->detail; at && *at; at += *at == '\n') {
        const size_t line = strcspn(at, "\n");
        const char *colon = memmem(at, line, ": ", 2);
        const char *end = at + length;
        const bool begins = colon && strncmp(at, word, length) == 0;
        if (begins && (end == colon || (end < colon && *end == ',')))
            return (struct choice){colon + 2, (size_t)(at + line - (colon + 2))};
        at += line;
    }
    return (struct choice){"", 0};
}

/* Add the usage, and the summary in the same line, or below if the usage is too long. */
static void list_command(struct buf *out, const struct command *command)
{
    const size_t before = out->length;
    add_usage(out, command);
    size_t length = out->length - before;
    if (length > 0 && length <= SUMMARY_COLUMN)
        out->length = before + --length;
    else
        length = 0;
    buf_printf(out, "%*s%s\n", (int)(SUMMARY_COLUMN - length), "", command->summary);
}

void command_help(struct buf *out, const struct command *command)
{
    if (command) {
        add_usage(out, command);
        buf_printf(out, "%*s%s\n", INDENT, "", command->summary);
        for (const char *at = command->detail; at && *at; at += *at == '\n') {
            const size_t length = strcspn(at, "\n");
            add_lines(out, at, length, " ", INDENT, LINE_MOST);
            at += length;
        }
        buf_printf(out, "%*sExample: %s\n", INDENT, "", command->example);
        return;
    }
    for (enum command_group group = 0; group < GROUPS; group++) {
        buf_printf(out, "%s%s\n", group ? "\n" : "", command_group_name[group]);
        for (unsigned i = 0; i < command_count(); i++)
            if (command_at(i)->group == group)
                list_command(out, command_at(i));
    }
}

/* ---- the line, as far as the cursor ---- */

/* The complete words, the parameters they fill, and the word at the cursor. */
struct partial {
    const struct command *command;       /* named by the first word, if complete; or NULL */
    unsigned words;                      /* complete ones before the cursor */
    struct value value[PARAMETERS_MOST]; /* only `given` is set, by complete words */

    struct buf word; /* at the cursor, without its quotes; empty after a blank */
    size_t start;    /* its first byte in the line, including a quote */
    bool quoted;     /* it begins with a quote, */
    bool closed;     /* which is closed: nothing can be added to the word */
    int parameter;   /* for the word, or -1 */
    size_t key;      /* bytes of `word` that are "radius=" */
};

/* Mark the parameter as given, and the one paired with it if the word is a choice. */
static void mark_given(struct partial *p, int i, const char *word)
{
    const struct parameter *parameter = p->command->parameter + i;
    p->value[i].given = true;
    if (parameter[1].paired && choice_find(parameter->choices, word) >= 0)
        p->value[i + 1].given = true;
}

/* Read the words of `line`, up to the one at its end. */
static bool read_words(struct partial *p, const char *line)
{
    const char *at = line;
    for (scan_blanks(&at); *at; scan_blanks(&at)) {
        const char *word = at;
        buf_clear(&p->word);
        p->start = (size_t)(word - line);
        p->quoted = *word == '"' || *word == '\'';
        const bool ends = command_take_word(&at, &p->word);
        if (!ends && at != word)
            return false;
        p->closed = ends && p->quoted;
        if (!ends || *at == '\0')
            return true;
        const char *whole = buf_text(&p->word);
        if (p->words++ == 0) {
            p->command = command_find(whole);
            continue;
        }
        const int i = p->command ? command_parameter_for(p->command, p->value, &whole) : -1;
        if (i >= 0)
            mark_given(p, i, whole);
    }
    buf_clear(&p->word);
    p->quoted = p->closed = false;
    p->start = strlen(line);
    return true;
}

/* Read line[0..cursor). False without memory, in a comment, and after a quote not followed by a
 * blank. The caller releases the word in any case. */
static bool read_partial(struct partial *partial, const char *line, size_t cursor)
{
    OWNED(buf_release) struct buf before = {0};
    *partial = (struct partial){.parameter = -1};
    buf_add(&before, line, cursor);
    const char *text = buf_text(&before), *first = text;
    scan_blanks(&first);
    const bool fine = *first != '#' && read_words(partial, text);
    if (fine && partial->command) {
        const char *word = buf_text(&partial->word), *value = word;
        partial->parameter = command_parameter_for(partial->command, partial->value, &value);
        partial->key = (size_t)(value - word);
    }
    return fine && !before.failed && !partial->word.failed;
}

/* ---- words ---- */

enum { POINTS_OFFERED = 20 }; /* the latest ones, if no digit was typed */

struct offers {
    struct buf *out;
    const char *typed; /* part of the value, without quotes */
    bool quoted;
    const struct interpreter *interp;
};

/* An explanation of a word; {0} for none. */
static struct choice note_of(const char *text)
{
    return (struct choice){text, strlen(text)};
}

/* Add one word, in quotes if requested; `open` leaves out the closing quote. */
static void write_offer(struct buf *out, const char *word, size_t length, bool quoted, bool open,
                        struct choice note)
{
    if (quoted)
        buf_add_char(out, '"');
    for (size_t i = 0; i < length; i++) {
        if (quoted && (word[i] == '"' || word[i] == '\\'))
            buf_add_char(out, '\\');
        buf_add_char(out, word[i]);
    }
    if (quoted && !open)
        buf_add_char(out, '"');
    if (note.length > 0) {
        buf_add_char(out, '\t');
        buf_add(out, note.word, note.length);
    }
    buf_add_char(out, '\n');
}

static bool starts_so(const struct offers *o, const char *word, size_t length)
{
    const size_t typed = strlen(o->typed);
    return length > 0 && length >= typed && memcmp(word, o->typed, typed) == 0;
}

static void offer(const struct offers *o, const char *word, size_t length, struct choice note)
{
    if (starts_so(o, word, length))
        write_offer(o->out, word, length, o->quoted, false, note);
}

/* Return the help of a choice: by its value, or with its key. */
static struct choice choice_note(const struct command *command, const struct parameter *p,
                                 const struct choice *choice)
{
    OWNED(buf_release) struct buf keyed = {0};
    const struct choice note = command_note(command, choice->word, choice->length);
    buf_printf(&keyed, "%s=%.*s", p->name, (int)choice->length, choice->word);
    return note.length || !p->keyed ? note : command_note(command, buf_text(&keyed), keyed.length);
}

static void offer_commands(const struct offers *o)
{
    for (unsigned i = 0; i < command_count(); i++)
        offer(o, command_at(i)->name, strlen(command_at(i)->name), note_of(command_at(i)->summary));
}

/* Names of several words are quoted, and then all others too; the value of a key cannot be
 * quoted. */
static void offer_labels(const struct offers *o, const struct parameter *p)
{
    struct offers offers = *o;
    for (unsigned label = (unsigned)p->least; label < 256; label++) {
        const char *name = o->interp->session->now.kept.label_name[label];
        offers.quoted |=
            !p->keyed && *name && starts_so(o, name, strlen(name)) && command_needs_quotes(name);
    }
    for (unsigned label = (unsigned)p->least; label < 256; label++) {
        const char *name = o->interp->session->now.kept.label_name[label];
        char note[32];
        snprintf(note, sizeof note, "label %u", numbering_of(&o->interp->session->now.kept, label));
        if (!p->keyed || !command_needs_quotes(name))
            offer(&offers, name, strlen(name), note_of(note));
    }
}

/* ---- the names in a folder ---- */

enum { LISTING_MOST = 20000 }; /* names; a larger folder is truncated */

struct listing {
    struct buf store;  /* names, each ended by NUL; a folder's ends in a slash */
    const char **name; /* pointers to the names, sorted */
    size_t count;
};

/* True for a name that a command can contain: UTF-8 without control characters. A name with a
 * leading dot only if the dot was typed. */
static bool is_fit(const char *name, const char *begin)
{
    return strncmp(name, begin, strlen(begin)) == 0 && (name[0] != '.' || begin[0] == '.') &&
           strcmp(name, ".") != 0 && strcmp(name, "..") != 0 && *safe_end(name) == '\0';
}

/* Follow links. */
static bool is_folder(int folder, const struct dirent *entry)
{
    struct stat status;
    if (entry->d_type != DT_LNK && entry->d_type != DT_UNKNOWN)
        return entry->d_type == DT_DIR;
    return fstatat(folder, entry->d_name, &status, 0) == 0 && S_ISDIR(status.st_mode);
}

static int compare_names(const void *a, const void *b)
{
    const char *const *x = a, *const *y = b;
    return strverscmp(*x, *y);
}

/* Read the names with this prefix into an empty listing; none without memory or if the folder
 * cannot be read. */
static void listing_read(struct listing *listing, const char *folder, const char *begin)
{
    DIR *dir = opendir(folder);
    if (!dir)
        return;
    size_t count = 0;
    for (struct dirent *entry; count < LISTING_MOST && (entry = readdir(dir));) {
        if (!is_fit(entry->d_name, begin))
            continue;
        buf_add_text(&listing->store, entry->d_name);
        if (is_folder(dirfd(dir), entry))
            buf_add_char(&listing->store, '/');
        buf_add_char(&listing->store, '\0');
        count++;
    }
    closedir(dir);
    if (listing->store.failed || !(listing->name = mem_array(count, sizeof *listing->name)))
        return;
    const char *at = listing->store.data;
    for (; listing->count < count; at += strlen(at) + 1)
        listing->name[listing->count++] = at;
    qsort(listing->name, count, sizeof *listing->name, compare_names);
}

static void listing_release(struct listing *listing)
{
    buf_release(&listing->store);
    free(listing->name);
}

/* ---- files ---- */

static const char *join_path(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    buf_add_text(path, name);
    return buf_text(path);
}

static void offer_files(const struct offers *o)
{
    const char *slash = strrchr(o->typed, '/'), *begin = slash ? slash + 1 : o->typed;
    const size_t leads = (size_t)(begin - o->typed);
    OWNED(buf_release) struct buf path = {0}, folder = {0};
    OWNED(listing_release) struct listing listing = {0};
    bool quoted = o->quoted;
    buf_add(&path, o->typed, leads);
    file_from_home(&folder, buf_text(&path));
    listing_read(&listing, leads ? buf_text(&folder) : ".", begin);
    for (size_t i = 0; i < listing.count && !quoted; i++)
        quoted = command_needs_quotes(join_path(&path, o->typed, leads, listing.name[i]));
    for (size_t i = 0; i < listing.count; i++) {
        const char *whole = join_path(&path, o->typed, leads, listing.name[i]);
        if (path.failed)
            break;
        write_offer(o->out, whole, path.length, quoted, whole[path.length - 1] == '/',
                    (struct choice){0});
    }
    o->out->failed |= path.failed;
}

/* Offer the existing golden images of the current journal. */
static void offer_goldens(const struct offers *o)
{
    static const char ending[] = ".exr";
    OWNED(golden_files_close) struct golden_files files = {.folder = -1};
    OWNED(listing_release) struct listing listing = {0};
    if (o->interp->home.length &&
        golden_files_open(&files, buf_text(&o->interp->home), false, NULL) == OK &&
        files.folder >= 0)
        listing_read(&listing, buf_text(&files.path), o->typed);
    for (size_t i = 0; i < listing.count; i++)
        if (file_is_named(listing.name[i], ending))
            offer(o, listing.name[i], strlen(listing.name[i]) - strlen(ending), (struct choice){0});
}

/* ---- places in the history ---- */

static void offer_points(const struct offers *o)
{
    const struct history *history = &o->interp->history;
    const size_t points = history->points;
    const bool any = o->typed[0] != '\0';
    for (size_t i = 0; i < history->branches; i++)
        offer(o, history->branch[i].name, strlen(history->branch[i].name), (struct choice){0});
    for (size_t i = any || points < POINTS_OFFERED ? 0 : points - POINTS_OFFERED; i < points; i++) {
        const struct point *point = &history->point[i];
        char number[24];
        const int length = snprintf(number, sizeof number, "%zu", point->record);
        offer(o, number, (size_t)length, note_of(point->command ? point->command : ""));
    }
}

/* ---- the whole ---- */

static void offer_values(const struct offers *o, const struct command *command,
                         const struct parameter *p)
{
    const char *choices = p->choices ? p->choices : "";
    struct choice choice;
    while (choice_next(&choice, &choices))
        offer(o, choice.word, choice.length, choice_note(command, p, &choice));
    if (p->type == VALUE_COMMAND)
        offer_commands(o);
    else if (p->type == VALUE_LABEL || p->type == VALUE_LABELS)
        offer_labels(o, p);
    else if (p->type == VALUE_FILE)
        offer_files(o);
    else if (p->type == VALUE_GOLDEN)
        offer_goldens(o);
    else if (p->type == VALUE_POINT)
        offer_points(o);
}

static void offer_keys(const struct offers *o, const struct partial *partial)
{
    const struct parameter *p = partial->command->parameter;
    for (int i = 0; p[i].type; i++) {
        OWNED(buf_release) struct buf key = {0}, form = {0};
        const struct choice note = command_note(partial->command, p[i].name, strlen(p[i].name));
        buf_printf(&key, "%s=", p[i].name);
        usage_form(&form, &p[i]);
        if (p[i].keyed && (!partial->value[i].given || p[i].type == VALUE_LINE))
            offer(o, buf_text(&key), key.length, note.length ? note : note_of(buf_text(&form)));
    }
}

void command_complete(struct buf *out, size_t *word_start, const char *line, size_t cursor,
                      const struct interpreter *interp)
{
    struct partial partial;
    *word_start = cursor;
    if (read_partial(&partial, line, cursor) && !partial.closed) {
        const struct offers offers = {out, buf_text(&partial.word) + partial.key, partial.quoted,
                                      interp};
        *word_start = partial.start + (partial.quoted ? 0 : partial.key);
        if (partial.words == 0)
            offer_commands(&offers);
        else if (partial.command) {
            const int i = partial.parameter;
            const struct parameter *p = partial.command->parameter;
            if (i >= 0)
                offer_values(&offers, partial.command, &p[i]);
            /* an optional number before a file: offer files too */
            if (i >= 0 && partial.key == 0 && p[i].type == VALUE_NUMBER && p[i].optional &&
                p[i + 1].type == VALUE_FILE)
                offer_values(&offers, partial.command, &p[i + 1]);
            if (partial.key == 0 && !partial.quoted)
                offer_keys(&offers, &partial);
        }
    }
    buf_release(&partial.word);
}

/* ---- hints ---- */

void command_hint(struct buf *out, const char *line, size_t length)
{
    struct partial p;
    OWNED(buf_release) struct buf rest = {0};
    bool knows = read_partial(&p, line, length);
    const bool begins = p.word.length == 0;
    if (p.words == 0 && !p.quoted) /* the name itself may be complete */
        p.command = begins ? NULL : command_find(buf_text(&p.word));
    knows = knows && p.command && (!p.quoted || p.closed) &&
            (begins || p.words == 0 || p.parameter >= 0);
    if (knows && p.words > 0 && p.key > 0 && buf_text(&p.word)[p.key] == '\0')
        usage_form(&rest, &p.command->parameter[p.parameter]);
    if (knows && p.words > 0 && !begins)
        mark_given(&p, p.parameter, buf_text(&p.word) + p.key);
    if (knows)
        usage_rest(&rest, p.command->parameter, p.value);
    const char *text = buf_text(&rest);
    buf_add_text(out, begins && *text == ' ' ? text + 1 : text);
    out->failed |= rest.failed;
    buf_release(&p.word);
}
