/* SPDX-License-Identifier: MIT */
#include "command/anonymise.h"

#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/command.h"
#include "image/exr.h"
#include "image/volume.h"
#include "show/label_table.h"

/* ---- names of files ---- */

/* Return the number of a name, from 1, in order of appearance. */
static unsigned number_of(struct buf *names, const char *name)
{
    unsigned number = 1;
    const char *at = buf_text(names), *end = at + names->length;
    for (; at < end; at += strlen(at) + 1, number++)
        if (strcmp(at, name) == 0)
            return number;
    buf_add(names, name, strlen(name) + 1);
    return number;
}

/* Endings of files other than volumes and tables of labels. */
#define OTHER_ENDINGS                                                                              \
    ".png|.jpg|.jpeg|.tif|.tiff|.gif|.bmp|.webp|.csv|.tsv|.txt|.json|.html|.xml|.stl|.ply|.obj|"   \
    ".vtp|.vtk|.img|.raw|.dcm|.mha|.mhd|.mnc|.h5|.hdf5|.ims|.mrc|.tfm|.mat|.iftty|" EXR_NAMES

/* Return ".nii.gz", ".png", "%03d.png"; "" for an ending of no known format, which may be a
 * person's name. */
static const char *ending_of(const char *name)
{
    const char *percent = strchr(name, '%');
    enum label_table_format format;
    const char *ending = label_table_ending(name, &format);
    if (!ending)
        ending = volume_ending(name);
    if (!ending)
        ending = file_ending(name, OTHER_ENDINGS);
    if (!ending)
        return "";
    return percent && strspn(percent + 1, "0123456789") + 2 == (size_t)(ending - percent) &&
                   ending[-1] == 'd'
               ? percent
               : ending;
}

static void add_name(struct buf *names, struct buf *out, const char *name, bool is_scene)
{
    OWNED(buf_release) struct buf word = {0};
    const char *ending = ending_of(file_name(name));
    if (is_scene)
        buf_add_text(&word, "scene");
    else
        buf_printf(&word, "file-%u%s", number_of(names, name), *ending == '%' ? "-" : "");
    buf_add_text(&word, ending);
    command_write_word(out, buf_text(&word));
    out->failed |= word.failed;
}

/* ---- words ---- */

enum fate { WORD_STAYS, WORD_IS_FILE, WORD_IS_CODE, WORD_GOES };

/* Decide about a value by its parameter, NULL if it fits none. */
static enum fate judge(const struct parameter *p, const char *value)
{
    const bool is_numbers = value[strspn(value, "0123456789abcdefABCDEF.,:/+-")] == '\0';
    if (!p)
        return value[strspn(value, "0123456789.-")] ? WORD_IS_FILE : WORD_STAYS;
    if (p->choices && choice_find(p->choices, value) >= 0)
        return WORD_STAYS;
    if (p->type == VALUE_FILE)
        return p->is_scene && strncmp(value, "synth:", 6) == 0 ? WORD_STAYS : WORD_IS_FILE;
    if (p->is_code)
        return label_code_value(value) ? WORD_IS_CODE : WORD_GOES;
    if (p->type == VALUE_WORD && !p->is_kept)
        return WORD_GOES;
    /* Other types contain no path, except for slashes between numbers. */
    return strchr(value, '/') && !(p->is_kept && is_numbers) ? WORD_IS_FILE : WORD_STAYS;
}

/* Add a word after the name of the command, and mark its parameter as given. */
static void add_word(struct buf *names, struct buf *out, const struct command *command,
                     struct value *value, const char *word, const char *as_written, size_t length)
{
    const char *text = word;
    const int i = command ? command_parameter_for(command, value, &text) : -1;
    const struct parameter *p = i < 0 ? NULL : &command->parameter[i];
    const enum fate fate = judge(p, text);
    if (p)
        value[i].given = p->type != VALUE_LINE;
    if (fate == WORD_GOES)
        return;
    buf_add_char(out, ' ');
    if (fate == WORD_STAYS) {
        buf_add(out, as_written, length);
        return;
    }
    buf_add(out, word, (size_t)(text - word)); /* its key */
    if (fate == WORD_IS_CODE) {                /* without its meaning, which is free text */
        buf_add(out, text, label_code_value(text));
        return;
    }
    if (p && p->is_scene && scan_text(&text, "raw:"))
        buf_add_text(out, "raw:");
    add_name(names, out, text, p && p->is_scene);
}

void anonymise_command(struct buf *names, struct buf *out, const char *command)
{
    struct value value[PARAMETERS_MOST] = {{.given = false}};
    OWNED(buf_release) struct buf word = {0};
    const struct command *known = NULL;
    for (unsigned n = 0; *command; n++) {
        const char *rest = command;
        buf_clear(&word);
        if (!command_take_word(&rest, &word)) {
            buf_add_text(out, " ..."); /* unterminated quote: no word can be trusted */
            break;
        }
        if (n == 0) {
            known = command_find(buf_text(&word));
            buf_add(out, command, (size_t)(rest - command));
        } else {
            add_word(names, out, known, value, buf_text(&word), command, (size_t)(rest - command));
        }
        command = rest + strspn(rest, " \t");
    }
    out->failed |= word.failed | names->failed;
}
