/* SPDX-License-Identifier: MIT */
#include "command/golden_judge.h"

#include <string.h>

#include "base/safe.h"
#include "base/scan.h"
#include "journal/record.h"

/* ---- notes ---- */

bool golden_note_is_of_its_time(const struct attribute *note)
{
    static const char program[] = "iftty ";
    const char *name = note->name, *value = note->value;
    if (strcmp(name, "iftty:journal") == 0)
        return !strchr(value, '/') && !*safe_end(value);
    if (strcmp(name, "iftty:chain") == 0)
        return scan_is_hex(value, RECORD_CHAIN_DIGITS);
    if (strcmp(name, "Software") != 0 || strncmp(value, program, sizeof program - 1) != 0)
        return false;
    value += sizeof program - 1;
    const size_t major = strspn(value, "0123456789"), all = strspn(value, "0123456789.");
    return major && all > major + 1 && all <= major + 17 && !value[all];
}

static enum err refuse_note(const struct attribute *note, const char *drawn, struct fault *fault)
{
    struct buf words = {0};
    buf_add_safe_text(&words, note->name);
    buf_add_text(&words, " is ");
    buf_add_safe(&words, note->value, strnlen(note->value, 200));
    if (drawn) {
        buf_add_text(&words, ", and what is drawn has ");
        buf_add_safe(&words, drawn, strnlen(drawn, 200));
    } else {
        buf_add_text(&words, ", which is no note of what is drawn");
    }
    const enum err err = fault_set(fault, ERR_CHECK, "its note %s", buf_text(&words));
    buf_release(&words);
    return err;
}

static bool counts(const struct attribute *note, bool names_scene)
{
    return !golden_note_is_of_its_time(note) &&
           (names_scene || strcmp(note->name, "iftty:scene-name") != 0);
}

enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault)
{
    for (size_t i = 0; i < kept->attributes; i++) {
        const struct attribute *note = &kept->attribute[i];
        const char *now = picture_find(drawn, note->name);
        if (counts(note, names_scene) && (!now || strcmp(now, note->value) != 0))
            return refuse_note(note, now, fault);
    }
    for (size_t i = 0; i < drawn->attributes; i++)
        if (counts(&drawn->attribute[i], names_scene) &&
            !picture_find(kept, drawn->attribute[i].name))
            return fault_set(fault, ERR_CHECK, "it has no note %s, which what is drawn has",
                             drawn->attribute[i].name);
    return OK;
}
