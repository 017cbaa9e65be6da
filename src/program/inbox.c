/* SPDX-License-Identifier: MIT */
#include "program/inbox.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/json.h"
#include "base/mem.h"
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

/* Reads a line; the caller releases the request in any case. Its fault is ERR_USAGE or ERR_MEMORY
 * where it is none, and its id is then what was read of it. */
static void request_read(struct request *request, const char *line, size_t length)
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

static void request_release(struct request *request)
{
    buf_release(&request->id);
    buf_release(&request->words);
    *request = (struct request){0};
}

static bool is_of(const struct request *request, const struct request *cancel)
{
    return strcmp(buf_text(&request->id), buf_text(&cancel->id)) == 0;
}

static void cancel(struct inbox *inbox, const struct request *cancel)
{
    if (is_of(&inbox->at_hand, cancel)) {
        inbox->stops = true;
        return;
    }
    for (size_t i = 0; i < inbox->count; i++)
        inbox->waiting[inbox->first + i].is_cancelled |=
            is_of(&inbox->waiting[inbox->first + i], cancel);
}

static bool is_blank(const struct buf *line)
{
    return strspn(buf_text(line), " \t\r") == line->length;
}

/* The line at hand has come to its end. */
static enum err end_line(struct inbox *inbox, struct fault *fault)
{
    struct request request = {0};
    enum err err = inbox->line.failed ? fault_memory(fault, "a request") : OK;
    if (!err && !inbox->is_too_long && is_blank(&inbox->line))
        return OK;
    if (!err && inbox->is_too_long) {
        fault_set(&request.fault, ERR_USAGE, "the line is longer than %d bytes; it is passed over",
                  REQUEST_BYTES_MOST);
        buf_add_text(&request.id, "null");
    } else if (!err) {
        request_read(&request, buf_text(&inbox->line), inbox->line.length);
    }
    buf_clear(&inbox->line);
    inbox->is_too_long = false;
    if (!err && request.kind == REQUEST_CANCEL && !request.fault.code) {
        cancel(inbox, &request);
        request_release(&request);
        return OK;
    }
    const size_t end = inbox->first + inbox->count;
    if (!err && !mem_grow(&inbox->waiting, &inbox->capacity, end + 1, sizeof *inbox->waiting))
        err = fault_memory(fault, "a request");
    if (err) {
        request_release(&request);
        return err;
    }
    inbox->bytes += request.words.length;
    inbox->waiting[end] = request;
    inbox->count++;
    return OK;
}

enum err inbox_take(struct inbox *inbox, const char *bytes, size_t length, struct fault *fault)
{
    enum err err = OK;
    while (!err && length > 0) {
        const char *end = memchr(bytes, '\n', length);
        const size_t n = end ? (size_t)(end - bytes) : length;
        inbox->is_too_long |= inbox->line.length + n > REQUEST_BYTES_MOST;
        if (!inbox->is_too_long)
            buf_add(&inbox->line, bytes, n);
        if (inbox->line.failed)
            err = fault_memory(fault, "a request");
        else if (end)
            err = end_line(inbox, fault);
        bytes += n + (end != NULL);
        length -= n + (end != NULL);
    }
    return err;
}

bool inbox_has_room(const struct inbox *inbox)
{
    return inbox->count < INBOX_WAITING_MOST && inbox->bytes <= INBOX_BYTES_MOST;
}

enum err inbox_read(struct inbox *inbox, int fd, struct fault *fault)
{
    static char bytes[1 << 16];
    struct pollfd now = {.fd = fd, .events = POLLIN};
    if (inbox->is_over || !inbox_has_room(inbox) || poll(&now, 1, 0) <= 0)
        return OK;
    const ssize_t n = read(fd, bytes, sizeof bytes);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return OK;
    if (n > 0)
        return inbox_take(inbox, bytes, (size_t)n, fault);
    inbox->is_over = true;
    if (n < 0)
        return fault_errno(fault, "read", "standard input");
    return inbox->line.length || inbox->is_too_long ? end_line(inbox, fault) : OK;
}

const struct request *inbox_next(struct inbox *inbox)
{
    request_release(&inbox->at_hand);
    inbox->stops = false;
    if (inbox->count == 0)
        return NULL;
    inbox->at_hand = inbox->waiting[inbox->first++];
    inbox->stops = inbox->at_hand.is_cancelled;
    inbox->bytes -= inbox->at_hand.words.length;
    if (--inbox->count == 0)
        inbox->first = 0;
    if (inbox->first >= INBOX_WAITING_MOST) {
        memmove(inbox->waiting, inbox->waiting + inbox->first,
                inbox->count * sizeof *inbox->waiting);
        inbox->first = 0;
    }
    return &inbox->at_hand;
}

void inbox_release(struct inbox *inbox)
{
    for (size_t i = 0; i < inbox->count; i++)
        request_release(&inbox->waiting[inbox->first + i]);
    free(inbox->waiting);
    request_release(&inbox->at_hand);
    buf_release(&inbox->line);
    *inbox = (struct inbox){0};
}
