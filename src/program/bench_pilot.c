#include "program/bench_pilot.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/folder.h"
#include "program/bench_pty.h"
#include "program/bench_times.h"

enum {
    PACKET = 1400,
    PACKETS = 4096, /* on their way at most; what comes then waits in the pseudo-terminal */
    REPLIES = 64,
    SEQUENCE = 96, /* bytes that are remembered of an escape sequence */
    KEYS_MOST = 100,
    JOURNAL_MOST = 64 << 20,
};

#define PATIENCE_NS UINT64_C(10000000000) /* without a byte */
#define STILL_NS    UINT64_C(80000000)    /* nothing came for so long, and the line's round trip */

struct packet {
    uint64_t due_ns;
    size_t length;
    char bytes[PACKET];
};

struct reply {
    uint64_t due_ns;
    char bytes[64];
};

struct far_end {
    int terminal;
    const struct graphics *graphics;
    double ns_per_byte;
    uint64_t one_way_ns, free_ns; /* when all that was put on the line has left */
    struct packet *packet;        /* a ring */
    size_t first, packets;
    struct reply reply[REPLIES]; /* a queue */
    size_t replies;
    enum { PLAIN, ESCAPE, CSI, STRING, STRING_ESCAPE } state;
    char sequence[SEQUENCE];
    size_t length;
    char before; /* the last plain character but one */
    bool prompts;
    uint64_t pressed_ns, last_ns, barrier_ns; /* the keys; the last byte; the first barrier after */
    size_t bytes;
};

/* ---- the terminal at the far end ---- */

static void send(struct far_end *e, uint64_t now_ns, const char *text)
{
    if (e->replies == REPLIES)
        return;
    struct reply *reply = &e->reply[e->replies++];
    reply->due_ns = now_ns + e->one_way_ns;
    const size_t length = strlen(text);
    memcpy(reply->bytes, text, length < sizeof reply->bytes ? length + 1 : 0);
}

static void answer(struct far_end *e, uint64_t now_ns)
{
    static const struct {
        const char *question, *kitty, *sixel;
    } known[] = {{"[>q", "\033P>|kitty(0.26.5)\033\\", "\033P>|XTerm(379)\033\\"},
                 {"[>c", "\033[>1;4000;26c", "\033[>41;379;0c"},
                 {"[16t", "\033[6;16;8t", "\033[6;16;8t"},
                 {"[?2026$p", "\033[?2026;2$y", "\033[?2026;0$y"},
                 {"[c", "\033[?62;c", "\033[?63;1;2;4;6;9;15;22c"}};
    const bool kitty = e->graphics == &graphics_kitty;
    e->sequence[e->length < SEQUENCE ? e->length : SEQUENCE - 1] = '\0';
    if (strcmp(e->sequence, "[c") == 0 && e->barrier_ns == 0)
        e->barrier_ns = now_ns;
    if (kitty && strncmp(e->sequence, "_G", 2) == 0 && strstr(e->sequence, "a=q"))
        send(e, now_ns, "\033_Gi=31;OK\033\\");
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(e->sequence, known[i].question) == 0)
            send(e, now_ns, kitty ? known[i].kitty : known[i].sixel);
}

static void remember(struct far_end *e, char c)
{
    if (e->length < SEQUENCE)
        e->sequence[e->length++] = c;
}

static void take(struct far_end *e, char c, uint64_t now_ns)
{
    switch (e->state) {
    case PLAIN:
        e->prompts |= e->before == '>' && c == ' ';
        e->before = c;
        e->length = 0;
        e->state = c == '\033' ? ESCAPE : PLAIN;
        break;
    case ESCAPE:
        remember(e, c);
        e->state = c == '[' ? CSI : strchr("P_]^X", c) ? STRING : PLAIN;
        break;
    case CSI:
        remember(e, c);
        if (c >= 0x40 && c <= 0x7e) {
            answer(e, now_ns);
            e->state = PLAIN;
        }
        break;
    case STRING:
        if (c == '\033')
            e->state = STRING_ESCAPE;
        else
            remember(e, c);
        break;
    case STRING_ESCAPE:
        answer(e, now_ns);
        e->state = PLAIN;
        break;
    }
}

/* ---- the line ---- */

/* Takes what the program has written, and puts it on the line. */
static bool load(struct far_end *e)
{
    struct packet *packet = &e->packet[(e->first + e->packets) % PACKETS];
    const ssize_t n = read(e->terminal, packet->bytes, PACKET);
    if (n <= 0)
        return false;
    const uint64_t now_ns = clock_ns();
    e->free_ns = e->free_ns > now_ns ? e->free_ns : now_ns;
    e->free_ns += (uint64_t)((double)n * e->ns_per_byte);
    packet->length = (size_t)n;
    packet->due_ns = e->free_ns + e->one_way_ns;
    e->packets++;
    return true;
}

static void deliver(struct far_end *e, uint64_t now_ns)
{
    while (e->packets > 0 && e->packet[e->first].due_ns <= now_ns) {
        const struct packet *packet = &e->packet[e->first];
        for (size_t i = 0; i < packet->length; i++)
            take(e, packet->bytes[i], packet->due_ns);
        e->last_ns = packet->due_ns;
        e->bytes += packet->length;
        e->first = (e->first + 1) % PACKETS;
        e->packets--;
    }
}

static bool write_replies(struct far_end *e, uint64_t now_ns)
{
    size_t written = 0;
    while (written < e->replies && e->reply[written].due_ns <= now_ns) {
        const char *bytes = e->reply[written++].bytes;
        if (write(e->terminal, bytes, strlen(bytes)) < 0)
            return false;
    }
    e->replies -= written;
    memmove(e->reply, e->reply + written, e->replies * sizeof *e->reply);
    return true;
}

/* Lets time pass until something happens, `limit_ns` at the latest. False where the program is
 * gone. */
static bool pass(struct far_end *e, uint64_t limit_ns)
{
    uint64_t next_ns = limit_ns;
    if (e->packets > 0 && e->packet[e->first].due_ns < next_ns)
        next_ns = e->packet[e->first].due_ns;
    if (e->replies > 0 && e->reply[0].due_ns < next_ns)
        next_ns = e->reply[0].due_ns;
    const uint64_t now_ns = clock_ns(), wait_ns = next_ns > now_ns ? next_ns - now_ns : 0;
    struct pollfd ready = {e->terminal, e->packets < PACKETS ? POLLIN : 0, 0};
    const struct timespec wait = {(time_t)(wait_ns / 1000000000), (long)(wait_ns % 1000000000)};
    if (ppoll(&ready, 1, &wait, NULL) > 0 && !((ready.revents & POLLIN) ? load(e) : false))
        return false;
    deliver(e, clock_ns());
    return write_replies(e, clock_ns());
}

/* Presses keys, and waits until what they have brought about has come to rest: a prompt or, in the
 * pilot, a frame, and nothing after it. */
static bool press(struct far_end *e, const char *keys, bool in_pilot)
{
    const uint64_t begin_ns = clock_ns(), still_ns = STILL_NS + 2 * e->one_way_ns;
    e->barrier_ns = e->last_ns = 0;
    e->prompts = false;
    e->bytes = 0;
    e->pressed_ns = begin_ns;
    send(e, begin_ns, keys);
    for (;;) {
        const uint64_t now_ns = clock_ns();
        const bool came = in_pilot ? e->barrier_ns > 0 : e->prompts;
        if (came && e->packets == 0 && now_ns > e->last_ns + still_ns)
            return true;
        const uint64_t since_ns = e->last_ns > begin_ns ? e->last_ns : begin_ns;
        if (now_ns > since_ns + PATIENCE_NS || !pass(e, now_ns + 5000000))
            return false;
    }
}

/* ---- the pilot's keys ---- */

struct times {
    double shown_ms[KEYS_MOST], last_ms[KEYS_MOST], bytes[KEYS_MOST];
    unsigned keys;
};

static bool timed_press(struct far_end *e, const char *keys, struct times *t)
{
    if (!press(e, keys, true))
        return false;
    t->shown_ms[t->keys] = times_between(e->pressed_ns, e->barrier_ns);
    t->last_ms[t->keys] = times_between(e->pressed_ns, e->last_ns);
    t->bytes[t->keys++] = (double)e->bytes;
    return true;
}

static struct bench_key medians(struct times *t)
{
    return (struct bench_key){t->keys, times_median(t->shown_ms, t->keys),
                              times_median(t->last_ms, t->keys), times_median(t->bytes, t->keys)};
}

static bool press_all(struct far_end *e, unsigned keys, struct bench_keys *out)
{
    static const char *const ways[] = {"7l", "6k", "9h", "5K", "8j", "7J", "4h", "9k"};
    struct times moves = {.keys = 0}, seeds = {.keys = 0};
    bool good = press(e, "", false) && press(e, "auto on\r", false) && press(e, "pilot\r", true) &&
                press(e, "5l", true);
    for (unsigned i = 0; good && i < keys; i++)
        good = timed_press(e, i % 8 < 4 ? "l" : "k", &moves);
    for (unsigned i = 0; good && i < keys / 2; i++)
        good = press(e, ways[i % 8], true) && timed_press(e, i % 2 ? "2" : "3", &seeds) &&
               press(e, "u", true);
    *out = (struct bench_keys){medians(&moves), medians(&seeds)};
    return good;
}

/* A copy of the journal in a folder of its own, which becomes the program's home. */
static enum err copy_journal(struct buf *folder, struct buf *path, const char *journal,
                             struct fault *fault)
{
    struct buf bytes = {0};
    enum err err = folder_fresh(folder, NULL, fault);
    if (!err)
        err = file_read(&bytes, journal, JOURNAL_MOST, fault);
    buf_printf(path, "%s/%s", buf_text(folder), file_name(journal));
    if (!err && path->failed)
        err = fault_memory(fault, "a path");
    if (!err)
        err = file_write(buf_text(path), bytes.data, bytes.length, FILE_KEEP, fault);
    buf_release(&bytes);
    return err;
}

static enum err run_pilot(struct far_end *e, const char *home, char *journal, unsigned keys,
                          struct bench_keys *out, struct fault *fault)
{
    const struct winsize size = {PILOT_ROWS, PILOT_COLUMNS, PILOT_COLUMNS * PILOT_CELL_WIDTH,
                                 PILOT_ROWS * PILOT_CELL_HEIGHT};
    char *const argument[] = {"iftty", journal, NULL};
    const char *term = e->graphics == &graphics_kitty ? "xterm-kitty" : "xterm-256color";
    struct bench_pty pty;
    enum err err = OK;
    if (!bench_pty_open(&pty, &size) || !bench_pty_start(&pty, argument, term, home))
        err = fault_set(fault, ERR_IO, "there is no pseudo-terminal for the pilot");
    e->terminal = pty.terminal;
    if (!err && !press_all(e, keys, out))
        err = fault_set(fault, ERR_IO, "the pilot showed nothing for ten seconds");
    bench_pty_close(&pty);
    return err;
}

enum err bench_pilot(const char *journal, const struct graphics *graphics,
                     const struct bench_line *line, unsigned keys, struct bench_keys *out,
                     struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    struct far_end e = {.graphics = graphics, .one_way_ns = (uint64_t)(line->one_way_ms * 1e6)};
    if (line->bits_per_second > 0)
        e.ns_per_byte = 8e9 / line->bits_per_second;
    *out = (struct bench_keys){.move = {0}};
    e.packet = calloc(PACKETS, sizeof *e.packet);
    enum err err = e.packet ? OK : fault_memory(fault, "a line");
    if (!err)
        err = copy_journal(&folder, &path, journal, fault);
    if (!err)
        err = run_pilot(&e, buf_text(&folder), path.data, keys < KEYS_MOST ? keys : KEYS_MOST, out,
                        fault);
    if (folder.length)
        folder_discard(buf_text(&folder));
    free(e.packet);
    buf_release(&folder);
    buf_release(&path);
    return err;
}
