/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "command/near.h"
#include "journal/journal.h"

enum {
    LABEL_MOST = 255,
    SEED_RADIUS_MOST = 32,
    NOTED_MOST = 10, /* wrong lines that are reported */
};
#define REAL_MOST INT64_C(1000000000) /* thousandths */

void config_release(struct config *config)
{
    buf_release(&config->path);
    buf_release(&config->start);
    buf_release(&config->who);
    buf_release(&config->words);
}

/* ---- a line, after its first word ---- */

static bool is_end(const char *at)
{
    scan_blanks(&at);
    return *at == '\0';
}

static bool take_number(const char **at, unsigned places, int64_t least, int64_t most, int64_t *out)
{
    scan_blanks(at);
    const bool is_number =
        places ? scan_decimal(at, places, least, most, out) : scan_integer(at, least, most, out);
    return is_number && (**at == ' ' || **at == '\0');
}

static enum err take_theme(struct config *config, const char *words, struct fault *fault)
{
    const struct theme *theme = theme_find(words);
    if (!theme)
        return fault_set(fault, ERR_USAGE, "expected " THEME_NAMES ", not %s", words);
    config->setup.theme = theme;
    return OK;
}

static enum err take_graphics(struct config *config, const char *words, struct fault *fault)
{
    return graphics_read(words, "graphics", &config->graphics, fault);
}

/* Read voxels, or halves of a millimetre. */
static bool take_radius(const char **at, struct pilot_brush *brush)
{
    int64_t tenths;
    if (!scan_decimal(at, 1, 0, 10 * SEED_RADIUS_MOST, &tenths))
        return false;
    brush->in_mm = scan_text(at, "mm");
    const int64_t unit = brush->in_mm ? 5 : 10;
    brush->radius = (unsigned)(tenths / unit);
    return tenths % unit == 0 && (**at == ' ' || **at == '\0');
}

static enum err take_brush(struct config *config, const char *words, struct fault *fault)
{
    struct pilot_brush brush = pilot_setup_default.brush;
    const int growth = choice_find("exact|grows", words);
    int64_t label;
    if (growth >= 0) {
        config->setup.brush.growth = growth ? BRUSH_GROWS : BRUSH_EXACT;
        return OK;
    }
    bool fine = take_number(&words, 0, 0, LABEL_MOST, &label);
    scan_blanks(&words);
    brush.fits = !(*words >= '0' && *words <= '9');
    if (fine && !brush.fits)
        fine = take_radius(&words, &brush);
    scan_blanks(&words);
    brush.has_range = fine && scan_text(&words, "range=");
    if (brush.has_range)
        fine = interval_scan(&words, &brush.range_channel, brush.range);
    if (!fine || !is_end(words))
        return fault_set(
            fault, ERR_USAGE,
            "expected a label 0..%d, then optionally a radius 0..%d in voxels, or in mm in steps "
            "of 0.5, and range=LOW..HIGH; or exact or grows alone",
            LABEL_MOST, SEED_RADIUS_MOST);
    brush.label = (unsigned)label;
    brush.growth = config->setup.brush.growth;
    config->setup.brush = brush;
    return OK;
}

/* Move the first word of a line to `word`. */
static void take_word(const char **words, struct buf *word)
{
    const size_t length = strcspn(*words, " ");
    buf_add(word, *words, length);
    *words += length;
    scan_blanks(words);
}

static enum err take_window(struct config *config, const char *words, struct fault *fault)
{
    OWNED(buf_release) struct buf name = {0};
    int64_t centre, width;
    take_word(&words, &name);
    if (!take_number(&words, 3, -REAL_MOST, REAL_MOST, &centre) ||
        !take_number(&words, 3, 2, REAL_MOST, &width) || !is_end(words))
        return fault_set(
            fault, ERR_USAGE,
            "expected a name, a centre, and a width above 0, as in window liver 60 160");
    return setup_window(&config->setup, buf_text(&name), centre, width, fault);
}

static enum err take_keys(struct config *config, const char *words, struct fault *fault)
{
    OWNED(buf_release) struct buf name = {0};
    take_word(&words, &name);
    const struct pilot_row *row = setup_row(&config->setup, buf_text(&name));
    if (!row) {
        struct near near = near_to(buf_text(&name));
        for (size_t i = 0; i < pilot_rows; i++)
            if (pilot_table[i].name)
                near_try(&near, pilot_table[i].name, strlen(pilot_table[i].name));
        fault_set(fault, ERR_USAGE, "there is no action %s", buf_text(&name));
        return near_append(&near, "", fault);
    }
    return *words ? setup_keys(&config->setup, row, words, fault)
                  : fault_set(fault, ERR_USAGE, "expected keys after %s", buf_text(&name));
}

static enum err take_state(bool *is_off, const char *words, struct fault *fault)
{
    const int state = choice_find("on|off", words);
    if (state < 0)
        return fault_set(fault, ERR_USAGE, "expected on or off, not %s",
                         *words ? words : "nothing");
    *is_off = state == 1;
    return OK;
}

static enum err take_pager(struct config *config, const char *words, struct fault *fault)
{
    return take_state(&config->plain_answers, words, fault);
}

static enum err take_ahead(struct config *config, const char *words, struct fault *fault)
{
    return take_state(&config->setup.sends_none_ahead, words, fault);
}

static enum err take_start(struct config *config, const char *words, struct fault *fault)
{
    if (!*words)
        return fault_set(fault, ERR_USAGE, "expected a command, or none");
    config->has_start = true;
    if (strcmp(words, "none") != 0)
        buf_printf(&config->start, "%zu %s\n", config->line, words);
    return OK;
}

static enum err take_who(struct config *config, const char *words, struct fault *fault)
{
    OWNED(buf_release) struct buf name = {0};
    take_word(&words, &name);
    TRY(journal_who_check(buf_text(&name), fault));
    const bool times = strcmp(words, "times=yes") == 0;
    if (*words && !times)
        return fault_set(fault, ERR_USAGE, "expected times=yes after the name, not %s", words);
    buf_clear(&config->who);
    buf_add_text(&config->who, buf_text(&name));
    config->times = times;
    return OK;
}

/* The first words of lines, and their functions. */
#define KINDS "theme|graphics|brush|window|key|pager|ahead|start|who"
static enum err (*const take[])(struct config *config, const char *words, struct fault *fault) = {
    take_theme, take_graphics, take_brush, take_window, take_keys,
    take_pager, take_ahead,    take_start, take_who};

/* ---- lines ---- */

static enum err take_line(struct config *config, const char *line, struct fault *fault)
{
    OWNED(buf_release) struct buf word = {0};
    take_word(&line, &word);
    const int kind = choice_find(KINDS, buf_text(&word));
    if (kind >= 0)
        return take[kind](config, line, fault);
    fault_set(fault, ERR_USAGE,
              "expected theme, graphics, brush, window, key, pager, ahead, start or who, not %s",
              buf_text(&word));
    return near_append_choices(buf_text(&word), KINDS, fault);
}

/* Accept printable UTF-8 alone. */
static enum err check_bytes(const char *text, size_t length, struct fault *fault)
{
    if (length > CONFIG_LINE_MOST)
        return fault_set(fault, ERR_LIMIT, "it has %zu bytes, and may have %d", length,
                         CONFIG_LINE_MOST);
    for (size_t at = 0, n; at < length; at += n) {
        const bool is_blank = text[at] == '\t' || (text[at] == '\r' && at + 1 == length);
        n = is_blank ? 1 : safe_character(text + at, length - at);
        if (n == 0)
            return fault_set(fault, ERR_INPUT, "byte %zu, %02x, is not text", at + 1,
                             (unsigned char)text[at]);
    }
    return OK;
}

static enum err take_bytes(struct config *config, const char *text, size_t length,
                           struct fault *fault)
{
    OWNED(buf_release) struct buf line = {0};
    TRY(check_bytes(text, length, fault));
    /* Words are separated by blanks, without blanks at the ends. */
    while (length > 0 && strchr(" \t\r", text[length - 1]))
        length--;
    while (length > 0 && strchr(" \t", *text))
        text++, length--;
    for (size_t i = 0; i < length; i++)
        buf_add_char(&line, text[i] == '\t' ? ' ' : text[i]);
    if (line.length && *line.data != '#')
        TRY(take_line(config, buf_text(&line), fault));
    if (line.failed)
        return fault_memory(fault, "a line");
    return OK;
}

/* Report the current line, which is ignored. */
static void note_wrong(struct config *config, const struct fault *fault)
{
    if (++config->wrong > NOTED_MOST)
        return;
    buf_add_safe_text(&config->words, buf_text(&config->path));
    buf_printf(&config->words, ":%zu: %s; left out\n", config->line, fault->text);
}

void config_take(struct config *config, const char *text, size_t length)
{
    const char *at = text, *const end = text + length;
    struct fault fault;
    while (at < end) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const size_t n = (size_t)((feed ? feed : end) - at);
        if (++config->line > CONFIG_LINES_MOST) {
            fault_set(&fault, ERR_LIMIT, "it and those after it are more than %d lines",
                      CONFIG_LINES_MOST);
            note_wrong(config, &fault);
            break;
        }
        if (take_bytes(config, at, n, &fault))
            note_wrong(config, &fault);
        at += n + (feed != NULL);
    }
    if (config->wrong > NOTED_MOST)
        buf_printf(&config->words, "and %zu lines more\n", config->wrong - NOTED_MOST);
}

/* ---- the file ---- */

void config_read(struct config *config)
{
    OWNED(buf_release) struct buf text = {0};
    struct fault fault;
    struct buf *path = &config->path;
    const char *own = getenv("IFTTY_CONFIG"), *folder = getenv("XDG_CONFIG_HOME");
    const char *home = getenv("HOME");
    if (own)
        buf_add_text(path, own);
    else if (folder && *folder == '/')
        buf_printf(path, "%s/iftty/config", folder);
    else if (home && *home == '/')
        buf_printf(path, "%s/.config/iftty/config", home);
    /* The default file may be missing; a named file, or one that cannot be looked up, is an
     * error. */
    const bool is_there =
        path->length && !path->failed && (own || !file_is_missing(buf_text(path)));
    if (is_there && file_read(&text, buf_text(path), CONFIG_BYTES_MOST, &fault))
        buf_printf(&config->words, "%s; left out\n", fault.text);
    else if (is_there)
        config_take(config, buf_text(&text), text.length);
    if (!config->has_start)
        buf_add_text(&config->start, CONFIG_USUAL_START);
}
