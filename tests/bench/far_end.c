/* SPDX-License-Identifier: MIT */
#include "tests/bench/far_end.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "tests/bench/times.h"

enum {
    PACKET = 1400,
    PACKETS = 1024, /* on their way at most; what comes then waits in the pseudo-terminal */
    SEQUENCE = 96,  /* bytes that are remembered of an escape sequence */
};

#define PATIENCE_NS UINT64_C(60000000000) /* without a byte */
#define IDLE_NS     UINT64_C(10000000000) /* without a byte, and without processor time */
#define POLL_NS     UINT64_C(5000000)

/* One direction of the line: packets in the order in which they arrive. */
struct lane {
    struct packet {
        uint64_t due_ns;
        size_t length;
        char bytes[PACKET];
    } packet[PACKETS]; /* a ring */
    size_t first, packets;
};

struct far_end {
    int terminal; /* or -1 */
    pid_t child;  /* or 0 */
    uint64_t started_ns;
    const struct graphics *graphics;
    double ns_per_byte;
    uint64_t one_way_ns, free_ns; /* when all that was put on the line has left */
    uint64_t still_ns;            /* it rests when nothing came, and the program did nothing */
    struct lane here, there;      /* to the terminal; to the program */
    char sequence[SEQUENCE];      /* since the last escape */
    size_t length;
    const char *const *awaited; /* texts that have not arrived yet; of the first */
    size_t matched;             /* this number of bytes has */
    uint64_t *came_ns;          /* its moment */
    bool is_ahead;              /* the picture that came last is not shown yet */
    bool counts_ahead;          /* as something that comes */
    bool has_rows;              /* rows of text since the last barrier */
    uint64_t frame_ns;          /* time of the last frame */
    bool is_soon;               /* what is awaited is enough */
    uint64_t worked_ns;         /* the program, before the result at hand */
    struct far_result *result;
};

/* ---- the line ---- */

/* Place for the next packet; NULL if the line is full. */
static struct packet *lane_end(struct lane *lane)
{
    return lane->packets < PACKETS ? &lane->packet[(lane->first + lane->packets) % PACKETS] : NULL;
}

/* Take the next packet that has arrived, or NULL. It is valid until another is added. */
static const struct packet *lane_take(struct lane *lane, uint64_t now_ns)
{
    const struct packet *packet = &lane->packet[lane->first];
    if (lane->packets == 0 || packet->due_ns > now_ns)
        return NULL;
    lane->first = (lane->first + 1) % PACKETS;
    lane->packets--;
    return packet;
}

static uint64_t lane_due_ns(const struct lane *lane)
{
    return lane->packets > 0 ? lane->packet[lane->first].due_ns : UINT64_MAX;
}

/* Keys and answers, which are short. */
static void send(struct far_end *e, uint64_t now_ns, const char *text)
{
    struct packet *packet = lane_end(&e->there);
    if (!packet)
        return;
    packet->due_ns = now_ns + e->one_way_ns;
    packet->length = strlen(text);
    memcpy(packet->bytes, text, packet->length);
    e->there.packets++;
}

/* Read the program's output, and put it on the line. */
static bool load(struct far_end *e)
{
    struct packet *packet = lane_end(&e->here);
    const ssize_t n = read(e->terminal, packet->bytes, PACKET);
    if (n <= 0)
        return false;
    const uint64_t now_ns = clock_ns();
    e->free_ns = e->free_ns > now_ns ? e->free_ns : now_ns;
    e->free_ns += (uint64_t)((double)n * e->ns_per_byte);
    packet->length = (size_t)n;
    packet->due_ns = e->free_ns + e->one_way_ns;
    e->here.packets++;
    return true;
}

/* ---- the terminal at the far end ---- */

/* The escape sequence so far may be a question. */
static void answer(struct far_end *e, uint64_t now_ns)
{
    enum { AS_KITTY, AS_GHOSTTY, AS_SIXEL, AS_PLAIN, KINDS };
    static const struct {
        const char *question, *answer[KINDS];
    } known[] = {
        {"[>q",
         {"\033P>|kitty(0.26.5)\033\\", "\033P>|ghostty 1.0.0\033\\", "\033P>|XTerm(379)\033\\",
          ""}},
        {"[>c", {"\033[>1;4000;26c", "\033[>1;10;0c", "\033[>41;379;0c", ""}},
        {"[16t", {"\033[6;16;8t", "\033[6;16;8t", "\033[6;16;8t", ""}},
        {"[?2026$p", {"\033[?2026;2$y", "\033[?2026;2$y", "\033[?2026;0$y", ""}},
        {"[c", {"\033[?62;c", "\033[?62;22c", "\033[?63;1;2;4;6;9;15;22c", "\033[?64;1;2c"}}};
    const int kind = e->graphics == &graphics_kitty   ? AS_KITTY
                     : e->graphics == &graphics_tiles ? AS_GHOSTTY
                     : e->graphics == &graphics_sixel ? AS_SIXEL
                                                      : AS_PLAIN;
    const size_t n = e->length;
    if (kind <= AS_GHOSTTY && n > 4 && memcmp(e->sequence, "_G", 2) == 0 &&
        memcmp(e->sequence + n - 3, "a=q", 3) == 0)
        send(e, now_ns, "\033_Gi=31;OK\033\\");
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(e->sequence, known[i].question) == 0)
            send(e, now_ns, known[i].answer[kind]);
}

/* Test whether the last byte of an escape sequence changes the screen: questions and cursor moves
 * do not. A command for pictures does when it ends, unless its picture is below the others
 * (tui/picture/kitty.c). */
static bool shows(const struct far_end *e)
{
    const char *sequence = e->sequence;
    const char last = sequence[e->length - 1];
    if (sequence[0] == '_')
        return false;
    if (sequence[0] == '[')
        return e->length > 1 && last >= '@' && last != 'H' && last != 'c';
    return sequence[0] != '\\' || e->length > 1 || !e->is_ahead;
}

/* No text that is awaited begins again within itself. */
static void match(struct far_end *e, char c, uint64_t now_ns)
{
    const char *text = *e->awaited;
    if (!text)
        return;
    e->matched = c == text[e->matched] ? e->matched + 1 : c == text[0];
    if (text[e->matched])
        return;
    *e->came_ns++ = now_ns;
    e->awaited++;
    e->matched = 0;
}

static void note_frame(struct far_end *e, uint64_t now_ns)
{
    struct far_result *r = e->result;
    if (r->frames++ && now_ns - e->frame_ns > r->gap_ns)
        r->gap_ns = now_ns - e->frame_ns;
    e->frame_ns = now_ns;
}

static void take(struct far_end *e, char c, uint64_t now_ns)
{
    match(e, c, now_ns);
    if (c == '\033') {
        /* Further chunks of a picture do not say what it is for. */
        if (e->sequence[0] == '_' && strstr(e->sequence, "a="))
            e->is_ahead = strstr(e->sequence, ",p=1000,w=1,h=1,") != NULL;
        e->length = 0;
    } else if (e->length + 1 < SEQUENCE) {
        e->sequence[e->length++] = c;
        e->sequence[e->length] = '\0';
        answer(e, now_ns);
        e->has_rows |= strcmp(e->sequence, "[K") == 0;
        if (strcmp(e->sequence, "[c") == 0) {
            if (e->has_rows) /* otherwise it is sent ahead */
                note_frame(e, now_ns);
            e->has_rows = false;
        }
        e->result->last_ns = e->counts_ahead || shows(e) ? now_ns : e->result->last_ns;
    }
}

/* Deliver packets that have arrived at either end. False if the program is gone. */
static bool deliver(struct far_end *e, uint64_t now_ns)
{
    const struct packet *packet;
    while ((packet = lane_take(&e->here, now_ns))) {
        for (size_t i = 0; i < packet->length; i++)
            take(e, packet->bytes[i], packet->due_ns);
        e->result->bytes += packet->length;
    }
    while ((packet = lane_take(&e->there, now_ns)))
        if (write(e->terminal, packet->bytes, packet->length) < 0)
            return false;
    return true;
}

/* Lets time pass until something happens, `limit_ns` at the latest. False where the program is
 * gone. */
static bool pass(struct far_end *e, uint64_t limit_ns)
{
    const uint64_t here_ns = lane_due_ns(&e->here), there_ns = lane_due_ns(&e->there);
    uint64_t next_ns = here_ns < there_ns ? here_ns : there_ns;
    next_ns = next_ns < limit_ns ? next_ns : limit_ns;
    const uint64_t now_ns = clock_ns(), wait_ns = next_ns > now_ns ? next_ns - now_ns : 0;
    struct pollfd ready = {e->terminal, lane_end(&e->here) ? POLLIN : 0, 0};
    const struct timespec wait = {(time_t)(wait_ns / 1000000000), (long)(wait_ns % 1000000000)};
    if (ppoll(&ready, 1, &wait, NULL) > 0 && (!(ready.revents & POLLIN) || !load(e)))
        return false;
    return deliver(e, clock_ns());
}

/* Processor time of the program so far. */
static uint64_t worked_ns(const struct far_end *e)
{
    clockid_t clock;
    struct timespec t;
    if (clock_getcpuclockid(e->child, &clock) != 0 || clock_gettime(clock, &t) != 0)
        return 0;
    return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

static void begin(struct far_end *e, const char *keys, const char *const *awaited,
                  struct far_result *out)
{
    const uint64_t begin_ns = clock_ns();
    e->worked_ns = worked_ns(e);
    *out = (struct far_result){e->started_ns ? e->started_ns : begin_ns, .last_ns = begin_ns};
    e->started_ns = 0;
    e->result = out;
    e->came_ns = out->came_ns;
    e->awaited = awaited;
    e->matched = 0;
    send(e, begin_ns, keys);
}

static enum err rest(struct far_end *e, struct fault *fault)
{
    uint64_t worked = 0, busy_ns = 0;
    for (;;) {
        const uint64_t now_ns = clock_ns(), last_ns = e->result->last_ns;
        const uint64_t work = worked_ns(e);
        busy_ns = work != worked ? now_ns : busy_ns;
        worked = work;
        const uint64_t later_ns = last_ns > busy_ns || e->is_ahead ? last_ns : busy_ns;
        const bool rests = (e->here.packets == 0 || e->is_ahead) && now_ns > later_ns + e->still_ns;
        if (!*e->awaited && (e->is_soon || rests)) {
            e->result->processor_ns = work - e->worked_ns;
            return OK;
        }
        if (now_ns > last_ns + PATIENCE_NS ||
            (now_ns > last_ns + IDLE_NS && now_ns > busy_ns + IDLE_NS))
            return fault_set(fault, ERR_IO, "the program showed nothing for %u s",
                             (unsigned)((now_ns - last_ns) / 1000000000));
        if (!pass(e, now_ns + POLL_NS))
            return fault_set(fault, ERR_IO, "the program is gone");
    }
}

enum err far_end_press(struct far_end *e, const char *keys, const char *const *awaited,
                       struct far_result *out, struct fault *fault)
{
    begin(e, keys, awaited, out);
    return rest(e, fault);
}

enum err far_end_press_soon(struct far_end *e, const char *keys, const char *const *awaited,
                            struct far_result *out, struct fault *fault)
{
    e->is_soon = true;
    const enum err err = far_end_press(e, keys, awaited, out, fault);
    e->is_soon = false;
    return err;
}

enum err far_end_hold(struct far_end *e, const char *key, unsigned times, double every_ms,
                      struct far_result *out, struct fault *fault)
{
    static const char *const nothing[] = {NULL};
    begin(e, key, nothing, out);
    const uint64_t begin_ns = out->pressed_ns;
    for (unsigned i = 1; i < times; i++) {
        out->pressed_ns = begin_ns + (uint64_t)(i * every_ms * 1e6);
        while (clock_ns() < out->pressed_ns)
            if (!pass(e, out->pressed_ns))
                return fault_set(fault, ERR_IO, "the program is gone");
        send(e, out->pressed_ns, key);
    }
    const struct far_result held = *out;
    const enum err err = rest(e, fault);
    out->frames = held.frames;
    out->gap_ns = held.gap_ns;
    return err;
}

enum err far_end_wait(struct far_end *e, double ms, struct far_result *out, struct fault *fault)
{
    static const char *const nothing[] = {NULL};
    begin(e, "", nothing, out);
    e->counts_ahead = true;
    const uint64_t end_ns = out->pressed_ns + (uint64_t)(ms * 1e6);
    while (clock_ns() < end_ns)
        if (!pass(e, end_ns))
            return fault_set(fault, ERR_IO, "the program is gone");
    e->counts_ahead = false;
    out->processor_ns = worked_ns(e) - e->worked_ns;
    return OK;
}

/* ---- beginning and end ---- */

static _Noreturn void become_program(int inner, const char *program, char *const *argument,
                                     const char *term, const char *home)
{
    setsid();
    ioctl(inner, TIOCSCTTY, 0);
    for (int fd = 0; fd < 3; fd++)
        dup2(inner, fd);
    setenv("TERM", term, 1);
    setenv("HOME", home, 1);
    setenv("IFTTY_HISTORY", "", 1);
    setenv("IFTTY_CONFIG", "", 1);
    unsetenv("NO_COLOR");
    unsetenv("TMUX");
    execv(program, argument);
    _exit(127);
}

static bool start(struct far_end *e, const char *program, char *const *argument, const char *home)
{
    const struct winsize size = {FAR_ROWS, FAR_COLUMNS, FAR_COLUMNS * FAR_CELL_WIDTH,
                                 FAR_ROWS * FAR_CELL_HEIGHT};
    e->terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (e->terminal < 0 || grantpt(e->terminal) != 0 || unlockpt(e->terminal) != 0 ||
        ioctl(e->terminal, TIOCSWINSZ, &size) != 0)
        return false;
    const int inner = open(ptsname(e->terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (inner < 0)
        return false;
    e->started_ns = clock_ns();
    e->child = fork();
    if (e->child == 0)
        become_program(inner, program, argument,
                       e->graphics == &graphics_kitty ? "xterm-kitty" : "xterm-256color", home);
    close(inner);
    return e->child > 0;
}

enum err far_end_new(struct far_end **out, const char *program, char *const *argument,
                     const char *home, const struct graphics *graphics, const struct far_line *line,
                     struct fault *fault)
{
    OWNED(buf_release) struct buf own = {0};
    enum err err = OK;
    struct far_end *e = *out = mem_new(sizeof *e);
    if (!e)
        return fault_memory(fault, "a line");
    e->terminal = -1;
    e->graphics = graphics;
    e->one_way_ns = (uint64_t)(line->one_way_ms * 1e6);
    e->still_ns = (uint64_t)(line->still_ms * 1e6) + 2 * e->one_way_ns;
    if (line->bits_per_second > 0)
        e->ns_per_byte = 8e9 / line->bits_per_second;
    if (!program && !bench_find_in_tree(&own, "iftty"))
        err = fault_set(fault, ERR_IO, "iftty does not lie beside the benchmarks; build it first");
    else if (!start(e, program ? program : buf_text(&own), argument, home))
        err = fault_set(fault, ERR_IO, "there is no pseudo-terminal");
    return err;
}

void far_end_free(struct far_end *e)
{
    if (e && e->child > 0) {
        kill(e->child, SIGKILL);
        waitpid(e->child, NULL, 0);
    }
    if (e && e->terminal >= 0)
        close(e->terminal);
    free(e);
}
