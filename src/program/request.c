/* SPDX-License-Identifier: MIT */
#include "program/request.h"

#include <inttypes.h>
#include <string.h>

#include "base/json.h"
#include "command/near.h"

enum { ID_BYTES_MOST = 64 };

/* The keys, and whether each was given. */
enum { KEY_ID, KEY_DO, KEY_ARRAY, KEY_FINISHED, KEY_CANCEL, KEYS };
static const char *const key_name[KEYS] = {"id", "do", "array", "finished", "cancel"};

static enum err find_key(unsigned *key, const char *name, struct fault *fault)
{
    for (*key = 0; *key < KEYS; ++*key)
        if (strcmp(key_name[*key], name) == 0)
            return OK;
    struct near near = near_to(name);
    for (unsigned k = 0; k < KEYS; k++)
        near_try(&near, key_name[k], strlen(key_name[k]));
    fault_set(fault, ERR_USAGE, "expected do, array or cancel, with id, not the key %s", name);
    near_append(&near, "", fault);
    return ERR_USAGE;
}

static enum err take_id(struct buf *id, const struct json_member *m, struct fault *fault)
{
    struct json json = {.out = id};
    buf_clear(id);
    if (m->kind == JSON_NUMBER)
        buf_printf(id, "%" PRId64, m->number);
    else if (m->kind == JSON_TEXT && m->text.length <= ID_BYTES_MOST)
        json_bytes(&json, NULL, buf_text(&m->text), m->text.length);
    else
        return fault_set(fault, ERR_USAGE,
                         "%s: expected a whole number, or a text of at most %d bytes",
                         buf_text(&m->key), ID_BYTES_MOST);
    if (id->length && id->data[id->length - 1] == '\n') /* which ends a text by itself */
        id->data[--id->length] = '\0';
    return OK;
}

static enum err take_words(struct buf *words, const struct json_member *m, struct fault *fault)
{
    if (m->kind != JSON_TEXT)
        return fault_set(fault, ERR_USAGE, "%s: expected a text", buf_text(&m->key));
    buf_add(words, buf_text(&m->text), m->text.length);
    return OK;
}

static enum err take_member(struct request *request, unsigned key, const struct json_member *m,
                            struct fault *fault)
{
    switch (key) {
    case KEY_CANCEL:
        request->kind = REQUEST_CANCEL;
        return take_id(&request->id, m, fault);
    case KEY_ID:
        return take_id(&request->id, m, fault);
    case KEY_FINISHED:
        request->finished = m->kind == JSON_TRUE;
        return m->kind == JSON_TRUE || m->kind == JSON_FALSE
                   ? OK
                   : fault_set(fault, ERR_USAGE, "finished: expected true or false");
    default:
        request->kind = key == KEY_ARRAY ? REQUEST_ARRAY : REQUEST_COMMAND;
        return take_words(&request->words, m, fault);
    }
}

/* Which keys go together. */
static enum err check(const bool given[KEYS], struct fault *fault)
{
    const int asked = given[KEY_DO] + given[KEY_ARRAY] + given[KEY_CANCEL];
    if (asked != 1)
        return fault_set(fault, ERR_USAGE, "expected one of the keys do, array and cancel");
    if (given[KEY_CANCEL] && given[KEY_ID])
        return fault_set(fault, ERR_USAGE, "cancel has no id of its own: it gets no answer");
    if (given[KEY_FINISHED] && !given[KEY_ARRAY])
        return fault_set(fault, ERR_USAGE, "finished goes with array; a command says it itself");
    return OK;
}

void request_read(struct request *request, const char *line, size_t length)
{
    struct json_reader reader = {.bytes = line, .length = length};
    struct json_member member = {0};
    bool given[KEYS] = {false};
    enum err err;
    *request = (struct request){0};
    struct fault *fault = &request->fault;
    while (!(err = json_read(&reader, &member, fault)) && member.kind != JSON_END) {
        unsigned key;
        err = find_key(&key, buf_text(&member.key), fault);
        if (!err && given[key])
            err = fault_set(fault, ERR_USAGE, "%s is given twice", key_name[key]);
        if (!err)
            err = take_member(request, key, &member, fault);
        if (err)
            break;
        given[key] = true;
    }
    if (!err)
        err = check(given, fault);
    if (!request->id.length)
        buf_add_text(&request->id, "null");
    if (!err && (request->id.failed || request->words.failed))
        fault_memory(fault, "a request");
    json_member_release(&member);
}

void request_release(struct request *request)
{
    buf_release(&request->id);
    buf_release(&request->words);
    *request = (struct request){0};
}
