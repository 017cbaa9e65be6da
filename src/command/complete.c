/*
 * Completion: what may stand at the cursor, by the table, by what the session knows, and by what is
 * on the disk.
 *
 * Words come as they are to be typed. Where one of them needs quotes all are given them, and so
 * they are where a quote was typed: they have a beginning in common then. A folder has no closing
 * quote, since what is in it may follow.
 */
#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "command/interpreter.h"
#include "command/listing.h"
#include "command/partial.h"
#include "journal/golden.h"

enum { POINTS_OFFERED = 20 }; /* the latest, where no digit was typed */

struct offers {
    struct buf *out;
    const char *typed; /* of the value, without quotes */
    bool quoted;
    const struct interpreter *interp;
};

/* One word, between quotes where they were asked for; open-ended without the closing one. */
static void write_offer(struct buf *out, const char *word, size_t length, bool quoted, bool open)
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
    buf_add_char(out, '\n');
}

static void offer(const struct offers *o, const char *word, size_t length)
{
    const size_t typed = strlen(o->typed);
    if (length > 0 && length >= typed && memcmp(word, o->typed, typed) == 0)
        write_offer(o->out, word, length, o->quoted, false);
}

static void offer_choices(const struct offers *o, const char *choices)
{
    struct choice choice;
    while (choice_next(&choice, &choices))
        offer(o, choice.word, choice.length);
}

static void offer_commands(const struct offers *o)
{
    for (unsigned i = 0; i < command_count; i++)
        offer(o, command_table[i].name, strlen(command_table[i].name));
}

static void offer_labels(const struct offers *o, const struct parameter *p)
{
    for (int label = (int)p->least; label < 256; label++) {
        const char *name = o->interp->session.now.kept.label_name[label];
        offer(o, name, strlen(name));
    }
}

/* ---- files ---- */

static bool needs_quotes(const char *word)
{
    struct buf out = {0};
    command_write_word(&out, word);
    const bool needs = out.length > 0 && out.data[0] == '"';
    buf_release(&out);
    return needs;
}

static const char *join(struct buf *path, const char *folder, size_t length, const char *name)
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
    struct buf path = {0};
    struct listing listing;
    bool quoted = o->quoted;
    buf_add(&path, o->typed, leads);
    listing_read(&listing, leads ? buf_text(&path) : ".", begin);
    for (size_t i = 0; i < listing.count && !quoted; i++)
        quoted = needs_quotes(join(&path, o->typed, leads, listing.name[i]));
    for (size_t i = 0; i < listing.count; i++) {
        const char *whole = join(&path, o->typed, leads, listing.name[i]);
        if (path.failed)
            break;
        write_offer(o->out, whole, path.length, quoted, whole[path.length - 1] == '/');
    }
    o->out->failed |= path.failed;
    listing_release(&listing);
    buf_release(&path);
}

/* Those of the present journal that are there. */
static void offer_goldens(const struct offers *o)
{
    static const char ending[] = ".exr";
    struct buf folder = {0};
    struct listing listing = {0};
    if (o->interp->home.length && golden_folder(&folder, buf_text(&o->interp->home), NULL) == OK)
        listing_read(&listing, buf_text(&folder), o->typed);
    for (size_t i = 0; i < listing.count; i++)
        if (file_is_named(listing.name[i], ending))
            offer(o, listing.name[i], strlen(listing.name[i]) - strlen(ending));
    listing_release(&listing);
    buf_release(&folder);
}

/* ---- places in the history ---- */

static void offer_points(const struct offers *o)
{
    const struct history *history = &o->interp->history;
    const size_t points = history->points;
    const bool any = o->typed[0] != '\0';
    for (size_t i = 0; i < history->branches; i++)
        offer(o, history->branch[i].name, strlen(history->branch[i].name));
    for (size_t i = any || points < POINTS_OFFERED ? 0 : points - POINTS_OFFERED; i < points; i++) {
        struct buf number = {0};
        buf_printf(&number, "%zu", history->point[i].record);
        offer(o, buf_text(&number), number.length);
        buf_release(&number);
    }
}

/* ---- the whole ---- */

static void offer_values(const struct offers *o, const struct parameter *p)
{
    if (p->choices)
        offer_choices(o, p->choices);
    switch (p->type) {
    case VALUE_COMMAND:
        offer_commands(o);
        break;
    case VALUE_LABEL:
        offer_labels(o, p);
        break;
    case VALUE_FILE:
        offer_files(o);
        break;
    case VALUE_GOLDEN:
        offer_goldens(o);
        break;
    case VALUE_POINT:
        offer_points(o);
        break;
    default:
        break;
    }
}

static void offer_keys(const struct offers *o, const struct partial *partial)
{
    const struct parameter *p = partial->command->parameter;
    for (int i = 0; p[i].type; i++) {
        struct buf key = {0};
        buf_printf(&key, "%s=", p[i].name);
        if (p[i].keyed && !partial->value[i].given)
            offer(o, buf_text(&key), key.length);
        buf_release(&key);
    }
}

/* Of a number that may be left out before a file, the file too. */
static void offer_parameters(const struct offers *o, const struct partial *partial)
{
    const int i = partial->parameter;
    const struct parameter *p = partial->command->parameter;
    if (i >= 0)
        offer_values(o, &p[i]);
    if (i >= 0 && partial->key == 0 && p[i].type == VALUE_NUMBER && p[i].optional &&
        p[i + 1].type == VALUE_FILE)
        offer_values(o, &p[i + 1]);
    if (partial->key == 0 && !partial->quoted)
        offer_keys(o, partial);
}

void command_complete(struct buf *out, size_t *word_start, const char *line, size_t cursor,
                      const struct interpreter *interp)
{
    struct partial partial;
    *word_start = cursor;
    if (partial_read(&partial, line, cursor) && !partial.closed) {
        const struct offers offers = {out, buf_text(&partial.word) + partial.key, partial.quoted,
                                      interp};
        *word_start = partial.start + (partial.quoted ? 0 : partial.key);
        if (partial.words == 0)
            offer_commands(&offers);
        else if (partial.command)
            offer_parameters(&offers, &partial);
    }
    partial_release(&partial);
}
