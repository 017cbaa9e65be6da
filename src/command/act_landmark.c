/* SPDX-License-Identifier: MIT */
#include "command/act_landmark.h"

#include <string.h>

#include "base/scan.h"
#include "base/hash.h"
#include "command/act.h"

/* ---- landmarks ---- */

enum err act_landmark(const struct act *act)
{
    struct landmark *mark = act->next->kept.landmark;
    const char *name = act_text(act, "NAME");
    const bool goes = act_has(act, "PLACE") && act_text(act, "PLACE");
    const enum err err = act_check_name(name, LANDMARK_NAME_BYTES, act->fault);
    size_t at = 0;
    if (err)
        return err;
    while (at < LANDMARKS && *mark[at].name && strcmp(mark[at].name, name) != 0)
        at++;
    if (goes && (at == LANDMARKS || !*mark[at].name))
        return fault_set(act->fault, ERR_USAGE,
                         "there is no landmark %s; `info` lists them; nothing has changed", name);
    if (at == LANDMARKS)
        return fault_set(act->fault, ERR_LIMIT, "there are %d landmarks, and no more are taken",
                         LANDMARKS);
    memset(mark[at].name, 0, sizeof mark[at].name);
    memset(mark[at].place, 0, sizeof mark[at].place);
    if (goes) {
        const struct landmark none = mark[at];
        memmove(mark + at, mark + at + 1, (LANDMARKS - 1 - at) * sizeof *mark);
        mark[LANDMARKS - 1] = none;
    } else {
        memcpy(mark[at].name, name, strlen(name));
        memcpy(mark[at].place, act_place(act, "PLACE"), sizeof mark[at].place);
    }
    return act_go(act);
}

/* ---- the origin ---- */

static enum err check_digest(const struct act *act, const char *key)
{
    const char *text = act_text(act, key);
    return !text || scan_is_hex(text, SHA256_HEX - 1)
               ? OK
               : fault_set(act->fault, ERR_USAGE, "%s: expected the 64 digits of a SHA-256, not %s",
                           key, text);
}

static enum err check_pull(const struct act *act)
{
    const char *at = act_text(act, "pull");
    struct decimal number;
    unsigned count = 0;
    if (!at)
        return OK;
    while (decimal_scan(&at, &number) && ++count < 12 && scan_text(&at, ","))
        ;
    return count == 12 && !*at ? OK
                               : fault_set(act->fault, ERR_USAGE,
                                           "pull: expected twelve numbers with commas between");
}

/* "1:1200000,2:150000" into volume[256], or where that is NULL, "1:12/3400,.." */
static enum err read_list(const struct act *act, const char *key, uint32_t *volume)
{
    const char *at = act_text(act, key);
    int64_t label, number, of, before = -1;
    bool fine = true;
    while (fine && at && *at) {
        fine = scan_integer(&at, 0, 255, &label) && label > before && scan_text(&at, ":") &&
               scan_integer(&at, 0, UINT32_MAX, &number) &&
               (volume ||
                (scan_text(&at, "/") && scan_integer(&at, 0, UINT32_MAX, &of) && number <= of)) &&
               (!*at || (scan_text(&at, ",") && *at));
        if (fine && volume)
            volume[label] = (uint32_t)number;
        before = label;
    }
    return fine ? OK
                : fault_set(act->fault, ERR_USAGE, "%s: expected %s, by rising labels, not %s", key,
                            volume ? "LABEL:MM3,.." : "LABEL:N/OF,..", act_text(act, key));
}

enum err act_origin(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const char *procedure = act_text(act, "PROCEDURE");
    const bool is_none = strcmp(procedure, "none") == 0;
    struct buf words = {0};
    enum err err =
        is_none || scan_is_hex(procedure, 32)
            ? OK
            : fault_set(act->fault, ERR_USAGE,
                        "PROCEDURE: expected the 32 digits of a chain, or none, not %s", procedure);
    static const char *const digest[] = {"digest", "scene", "from"};
    for (int i = 0; !err && i < 3; i++)
        err = check_digest(act, digest[i]);
    if (!err)
        err = check_pull(act);
    memset(kept->origin_mm3, 0, sizeof kept->origin_mm3);
    if (!err)
        err = read_list(act, "volumes", kept->origin_mm3);
    if (!err)
        err = read_list(act, "dropped", NULL);
    if (err)
        return err;
    if (!is_none)
        buf_printf(&words, "procedure %s", procedure);
    if (act_has(act, "by"))
        buf_printf(&words, ", by %s", act_text(act, "by"));
    if (act_has(act, "as"))
        buf_printf(&words, ", as %s", act_text(act, "as"));
    memset(kept->origin, 0, sizeof kept->origin);
    if (words.length < sizeof kept->origin)
        memcpy(kept->origin, buf_text(&words), words.length);
    buf_release(&words);
    return act_go(act);
}

/* ---- in words ---- */

void act_write_origin(struct buf *out, const struct session *session)
{
    const struct kept *kept = session_kept(session);
    for (size_t i = 0; i < LANDMARKS && *kept->landmark[i].name; i++) {
        const struct landmark *mark = &kept->landmark[i];
        buf_add_text(out, i ? ", " : "landmarks ");
        buf_add_safe_text(out, mark->name);
        buf_printf(out, " %u,%u,%u", mark->place[0], mark->place[1], mark->place[2]);
    }
    buf_add_text(out, *kept->landmark[0].name ? "\n" : "");
    if (*kept->origin)
        buf_printf(out, "origin    %s\n", kept->origin);
}
