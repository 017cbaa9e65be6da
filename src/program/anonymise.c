#include "session/parameter.h"
#include "program/anonymise.h"

#include <ctype.h>
#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "command/command.h"
#include "command/table.h"
#include "image/volume.h"
#include "report/label_table.h"
#include "journal/walk.h"

void anonymiser_release(struct anonymiser *anonymiser)
{
    buf_release(&anonymiser->names);
}

static bool takes_file(const struct command *command)
{
    for (unsigned p = 0; command && p < PARAMETERS_MOST; p++)
        if (command->parameter[p].type == VALUE_FILE)
            return true;
    return false;
}

/* One of "a|b|c", or a keyed parameter with its value. */
static bool is_word_of(const struct parameter *p, const char *word)
{
    const size_t name = strlen(p->name);
    if (p->keyed && strncmp(word, p->name, name) == 0 && word[name] == '=')
        return true;
    return p->choices && choice_find(p->choices, word) >= 0;
}

static bool is_file(const struct command *command, const char *word)
{
    if (strchr(word, '/'))
        return true;
    if (!takes_file(command) || strncmp(word, "synth:", 6) == 0)
        return false;
    const bool is_number = word[strspn(word, "0123456789.-")] == '\0';
    const struct parameter *p = command->parameter;
    if (is_number && (p->type != VALUE_FILE || p->choices))
        return false;
    for (; p->type; p++)
        if (is_word_of(p, word))
            return false;
    return true;
}

/* From 1, in the order in which they were met. */
static unsigned number_of(struct anonymiser *anonymiser, const char *name)
{
    unsigned number = 1;
    const char *at = buf_text(&anonymiser->names), *end = at + anonymiser->names.length;
    for (; at < end; at += strlen(at) + 1, number++)
        if (strcmp(at, name) == 0)
            return number;
    buf_add(&anonymiser->names, name, strlen(name) + 1);
    return number;
}

/* ".nii.gz", ".png", "%03d.png"; "" where the ending might be a word. */
static const char *ending_of(const char *name)
{
    const char *dot = strrchr(name, '.'), *percent = strchr(name, '%');
    enum label_table_format format;
    size_t n = 0;
    if (label_table_ending(name, &format))
        return label_table_ending(name, &format);
    while (dot && isalnum((unsigned char)dot[1 + n]))
        n++;
    if (!dot || n > 4 || dot[1 + n] != '\0')
        return "";
    if (volume_ending(name))
        return volume_ending(name);
    if (percent && strspn(percent + 1, "0123456789") + 2 == (size_t)(dot - percent) &&
        dot[-1] == 'd')
        return percent;
    return dot;
}

static void add_name(struct anonymiser *anonymiser, struct buf *out, const char *name,
                     bool is_scene)
{
    struct buf word = {0};
    const char *ending = ending_of(file_name(name));
    if (is_scene)
        buf_add_text(&word, "scene");
    else
        buf_printf(&word, "file-%u%s", number_of(anonymiser, name), *ending == '%' ? "-" : "");
    buf_add_text(&word, ending);
    command_write_word(out, buf_text(&word));
    out->failed |= word.failed;
    buf_release(&word);
}

void anonymise_command(struct anonymiser *anonymiser, struct buf *out, const char *command)
{
    struct buf word = {0};
    const struct command *known = NULL;
    bool is_open = false;
    for (unsigned n = 0; *command; n++) {
        const char *rest = command;
        buf_clear(&word);
        if (!command_take_word(&rest, &word,
                               COMMAND_QUOTES)) { /* a quote that does not end: nothing is sure */
            buf_add_text(out, "...");
            break;
        }
        const char *text = buf_text(&word);
        if (n == 0) {
            known = command_find(text);
            is_open = known && known->act == act_open;
        }
        if (n > 0 && is_file(known, text))
            add_name(anonymiser, out, text, is_open);
        else
            buf_add(out, command, (size_t)(rest - command));
        command = rest;
        for (; *command == ' ' || *command == '\t'; command++)
            buf_add_char(out, ' ');
    }
    out->failed |= word.failed | anonymiser->names.failed;
    buf_release(&word);
}

enum err anonymise_script(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct anonymiser anonymiser = {0};
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD) {
        anonymise_command(&anonymiser, out, record.command);
        buf_add_char(out, '\n');
    }
    if (!err)
        err = walk_judge(&walk, fault);
    if (out->failed)
        err = fault_memory(fault, "the commands of a journal");
    walk_release(&walk);
    anonymiser_release(&anonymiser);
    return err;
}
