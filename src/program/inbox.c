/* SPDX-License-Identifier: MIT */
#include "program/inbox.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

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
