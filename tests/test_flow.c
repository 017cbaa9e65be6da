/* SPDX-License-Identifier: MIT */
/* Frames over a simulated line: bytes wait their turn, an answer comes back half a round trip after
 * the last of them has arrived. */
#include "tests/check_main.h"
#include "tui/picture/graphics.h"
#include "tui/pilot/flow.h"

/* A picture that is sent at 1/n of its size: bytes go with the area. */
static unsigned divisor_of(const struct flow *f, size_t bytes)
{
    static const unsigned divisor[] = {1, 2, 3, 4, 6};
    const size_t budget = flow_budget(f);
    for (unsigned i = 0; i < sizeof divisor / sizeof divisor[0]; i++)
        if (bytes / (divisor[i] * divisor[i]) <= budget)
            return divisor[i];
    return 8;
}

#define MS UINT64_C(1000000)

enum { QUEUE = 64 };

struct line {
    uint64_t round_trip_ns, bytes_per_s;
    uint64_t free_ns; /* the line is busy until then */
    uint64_t
        jitter_ns; /* the terminal pauses: an answer, and all after it, is late by up to that */
    uint64_t seed, heard_ns;
    struct {
        uint64_t drawn_ns, answer_ns;
        unsigned state;
    } frame[QUEUE];
    unsigned first, count; /* frames whose answers are on their way */
    unsigned loses;        /* number of answers to be lost */
};

/* What the user at the other end sees. */
struct view {
    unsigned state;    /* the newest that is drawn */
    unsigned frames;   /* sent */
    unsigned deepest;  /* frames on the line at once */
    uint64_t oldest;   /* ns: the greatest age of a state when it was drawn, of late */
    size_t last_bytes; /* size of the last frame */
    size_t least_bytes;
};

static void send(struct line *line, struct view *view, unsigned state, size_t bytes, uint64_t now)
{
    const uint64_t begin = line->free_ns > now ? line->free_ns : now;
    const unsigned at = (line->first + line->count++) % QUEUE;
    line->free_ns = begin + bytes * UINT64_C(1000000000) / line->bytes_per_s;
    line->frame[at].drawn_ns = line->free_ns + line->round_trip_ns / 2;
    line->frame[at].answer_ns = line->frame[at].drawn_ns + line->round_trip_ns / 2;
    if (line->jitter_ns > 0 && check_below(&line->seed, 4) == 0)
        line->frame[at].answer_ns += check_random(&line->seed) % line->jitter_ns;
    if (line->frame[at].answer_ns < line->heard_ns)
        line->frame[at].answer_ns = line->heard_ns;
    line->heard_ns = line->frame[at].answer_ns;
    line->frame[at].state = state;
    view->frames++;
    view->last_bytes = bytes;
    view->least_bytes = bytes < view->least_bytes ? bytes : view->least_bytes;
    view->deepest = line->count > view->deepest ? line->count : view->deepest;
}

/* Show a picture of `full` bytes that changes every ms, from `from` to `to` ms; its state is the
 * time. Continue until everything sent has been drawn, with the last state. */
static void steer(struct flow *flow, struct line *line, struct view *view, size_t full,
                  unsigned from, unsigned to)
{
    unsigned sent = 0;
    for (unsigned ms = from; ms < to || line->count > 0 || sent < to; ms++) {
        const uint64_t now = ms * MS;
        const unsigned state = ms < to ? ms : to;
        /* Frames that have been drawn, and then those that have been answered. */
        for (unsigned i = 0; i < line->count; i++) {
            const unsigned at = (line->first + i) % QUEUE;
            if (line->frame[at].drawn_ns > now || line->frame[at].state <= view->state)
                continue;
            view->state = line->frame[at].state;
            if (now - view->state * MS > view->oldest)
                view->oldest = now - view->state * MS;
        }
        while (line->count > 0 && line->frame[line->first].answer_ns <= now) {
            line->first = (line->first + 1) % QUEUE;
            line->count--;
            if (line->loses > 0)
                line->loses--;
            else
                flow_answered(flow, now);
        }
        if (sent == state || !flow_may_send(flow, now))
            continue;
        const unsigned divisor = divisor_of(flow, full);
        sent = state;
        send(line, view, state, full / (divisor * divisor), now);
        flow_sent(flow, view->last_bytes, now);
    }
}

/* ---- stories ---- */

/* 120 ms there and back, 250 bytes a ms. */
STORY(frames_follow_each_other_as_fast_as_the_line_carries_them)
{
    struct flow flow = {.round_trip_ns = 120 * MS};
    CHECK(flow_may_send(&flow, 5 * MS));
    CHECK_INT(flow_wait_ms(&flow, 5 * MS), 0);
    flow_sent(&flow, 5000, 5 * MS);
    CHECK(!flow_may_send(&flow, 6 * MS)); /* nothing is known yet */
    CHECK_INT(flow_wait_ms(&flow, 6 * MS), 1999);
    flow_answered(&flow, 145 * MS);
    CHECK(flow_may_send(&flow, 145 * MS));
    flow_answered(&flow, 146 * MS); /* without a question */
    CHECK_INT(flow_carries_ns(&flow, 5000), 20 * MS);
    for (unsigned i = 0; i < 6; i++) {
        const uint64_t now = (200 + 20 * i) * MS;
        CHECK(i == 0 || !flow_may_send(&flow, now - 11 * MS));
        CHECK_INT(flow_wait_ms(&flow, now - 11 * MS), i > 0);
        CHECK(flow_may_send(&flow, now)); /* the line is about to be free */
        CHECK_INT(flow.due, i);
        flow_sent(&flow, 5000, now);
    }
    CHECK(!flow_may_send(&flow, 400 * MS)); /* the first answer should have come at 340 */
    CHECK_INT(flow_wait_ms(&flow, 400 * MS), 1800);
    flow_answered(&flow, 400 * MS);
    CHECK_INT(flow.due, 5);
    CHECK(flow_may_send(&flow, 440 * MS));
}

/* 16 MB/s with nothing in between, 10 Mbit/s, 2 Mbit/s, 256 kbit/s. */
STORY(on_any_line_the_newest_state_arrives_in_time)
{
    static const struct {
        unsigned round_trip_ms, bytes_per_s, late_ms;
    } lines[] = {{0, 16000000, 30}, {40, 1250000, 80}, {120, 250000, 130}, {300, 32000, 290}};
    for (unsigned known = 0; known < 2; known++)
        for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
            struct line line = {lines[i].round_trip_ms * MS, lines[i].bytes_per_s, .count = 0};
            struct flow flow = {.round_trip_ns = known ? lines[i].round_trip_ms * MS : 0};
            struct view view = {0};
            steer(&flow, &line, &view, 80000, 1, 5000); /* it learns */
            CHECK_INT(view.state, 5000);
            const unsigned learnt = view.frames;
            view.oldest = 0;
            view.deepest = 0;
            steer(&flow, &line, &view, 80000, 10000, 20000);
            printf("# round trip %u ms, %u bytes/s: %u frames in 10 s of %zu bytes, %u ms late\n",
                   lines[i].round_trip_ms, lines[i].bytes_per_s, view.frames - learnt,
                   view.last_bytes, (unsigned)(view.oldest / MS));
            CHECK_INT(view.state, 20000);
            CHECK(view.deepest <= FLOW_FRAMES && view.frames - learnt >= 150);
            CHECK(view.oldest < lines[i].late_ms * MS);
        }
}

STORY(quality_drops_before_latency_and_comes_back)
{
    struct line line = {40 * MS, 10000000, .count = 0};
    struct flow flow = {.round_trip_ns = 40 * MS};
    struct view view = {0};
    steer(&flow, &line, &view, 80000, 1, 3000);
    CHECK_INT(divisor_of(&flow, 80000), 1);
    line.bytes_per_s = 100000; /* 80000 bytes would take 800 ms */
    steer(&flow, &line, &view, 80000, 5000, 9000);
    CHECK(divisor_of(&flow, 80000) >= 3);
    view.oldest = 0;
    steer(&flow, &line, &view, 80000, 30000, 34000);
    CHECK(view.oldest < 100 * MS);
    line.bytes_per_s = 10000000;
    steer(&flow, &line, &view, 80000, 40000, 43000);
    CHECK_INT(divisor_of(&flow, 80000), 1);
}

STORY(small_changes_do_not_make_a_fast_line_look_slow)
{
    struct line line = {120 * MS, 1250000, .count = 0};
    struct flow flow = {.round_trip_ns = 120 * MS};
    struct view view = {0};
    steer(&flow, &line, &view, 900, 1, 3000);
    CHECK(divisor_of(&flow, 24000) == 1);
}

/* A terminal on the same machine draws 50 kB in 5 ms, and pauses for up to 150 ms at every fourth
 * frame: it never gets a coarse one. Some frames are very small. */
STORY(a_terminal_that_pauses_is_not_taken_for_a_slow_line)
{
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct line line = {
            .bytes_per_s = 10000000, .round_trip_ns = 1 * MS, .jitter_ns = 150 * MS, .seed = seed};
        struct flow flow = {.round_trip_ns = 1 * MS};
        struct view view = {0};
        steer(&flow, &line, &view, 50000, 1, 1000);
        for (unsigned ms = 2000; ms < 60000; ms += 1000) {
            const size_t full = check_below(&seed, 2) ? 50000 : 900;
            view.least_bytes = full;
            steer(&flow, &line, &view, full, ms, ms + 300);
            CHECK_INT(view.least_bytes, full);
        }
    }
}

/* Frames on their way when the key was released arrive within the round trip and a frame. */
STORY(when_the_key_is_released_nothing_comes_after_it)
{
    struct line line = {120 * MS, 250000, .count = 0};
    struct flow flow = {.round_trip_ns = 120 * MS};
    struct view view = {0};
    steer(&flow, &line, &view, 80000, 1, 3000);
    view.frames = 0;
    steer(&flow, &line, &view, 80000, 5000, 9000);
    CHECK_INT(view.state, 9000);
    CHECK(view.frames >= 4 * 20 && line.free_ns < 9070 * MS);
}

STORY(an_answer_that_is_lost_costs_two_seconds_once)
{
    struct line line = {40 * MS, 1250000, .count = 0};
    struct flow flow = {.round_trip_ns = 40 * MS};
    struct view view = {0};
    steer(&flow, &line, &view, 20000, 1, 1000);
    line.loses = 1;
    const unsigned before = view.frames;
    steer(&flow, &line, &view, 20000, 2000, 8000);
    CHECK_INT(view.state, 8000);
    CHECK(view.frames - before > 60);
    CHECK_INT(flow.late, 0);
}

/* A line of 30 kB/s gets 200 kB at first: the answer takes 7 s, and three barriers fail meanwhile.
 * Afterwards every answer is assigned to its own frame again. */
STORY(answers_that_come_late_are_not_taken_for_those_of_newer_frames)
{
    struct line line = {100 * MS, 30000, .count = 0};
    struct flow flow = {0};
    struct view view = {0};
    send(&line, &view, 1, 200000, 1 * MS);
    flow_sent(&flow, 200000, 1 * MS);
    steer(&flow, &line, &view, 80000, 2, 15000);
    CHECK_INT(view.state, 15000);
    CHECK_INT(flow.late, 0);
    view.oldest = 0;
    steer(&flow, &line, &view, 80000, 30000, 36000);
    CHECK(view.oldest < 200 * MS);
}

STORY(a_failed_barrier_asks_for_recovery_once)
{
    static const struct terminal_facts kitty = {.graphics = &graphics_kitty},
                                       sixel = {.graphics = &graphics_sixel};
    struct flow flow = {0};
    CHECK(!flow.failed);
    flow_sent(&flow, 100000, 0);
    CHECK(!flow_may_send(&flow, 1999 * MS) && flow_may_send(&flow, 2000 * MS) && flow.failed);
    CHECK_TEXT(graphics_recovery(&sixel), "\033\\");
    CHECK_TEXT(graphics_recovery(&kitty), "\033_Gm=0,q=2;\033\\\033_Gm=0,q=2;\033\\");
    CHECK(flow_budget(&flow) <= 5000); /* 100000 bytes in 2 s at the very best */
    flow_sent(&flow, 4000, 2000 * MS);
    CHECK(!flow.failed);
}

/* How kitty reads strings: ESC \ alone ends one. */
struct strings {
    bool is_open, waits; /* for more chunks of a picture */
    char body[200];
    size_t length;
    unsigned alone; /* ends of no string */
    char before;
};

static void end_string(struct strings *s)
{
    s->alone += !s->is_open;
    s->body[s->is_open ? s->length : 0] = '\0';
    s->waits = s->is_open ? strstr(s->body, "m=1;") != NULL : s->waits;
    s->is_open = false;
}

static void heed(struct strings *s, const char *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        const bool escaped = s->before == '\033';
        s->before = bytes[i];
        if (escaped && bytes[i] == '\\')
            end_string(s);
        else if (escaped && bytes[i] == '_' && !s->is_open)
            *s = (struct strings){.is_open = true, .waits = s->waits, .alone = s->alone};
        else if (s->is_open && s->length + 1 < sizeof s->body)
            s->body[s->length++] = bytes[i];
    }
}

/* A picture that is given up, wherever the line has cut it, leaves nothing open, and no end of a
 * string that did not begin. */
STORY(what_was_cut_is_ended_and_what_was_not_is_left_whole)
{
    static const char picture[] = "\033_Ga=T,f=100,q=2,m=1;iVBO\033\\\033_Gq=2,m=1;Rw0K\033\\"
                                  "\033_Gq=2,m=0;Ggo=\033\\\033[c";
    static const struct terminal_facts rows[] = {{.graphics = &graphics_kitty},
                                                 {.graphics = &graphics_tiles}};
    for (size_t cut = 0; cut < sizeof picture; cut++)
        for (int row = 0; row < 2; row++) {
            struct strings s = {0};
            heed(&s, picture, cut);
            const bool begins = s.before == '\033' && !s.is_open; /* which it cannot make good */
            heed(&s, graphics_recovery(&rows[row]), strlen(graphics_recovery(&rows[row])));
            CHECK(!s.is_open && !s.waits && (s.alone == 0 || begins));
        }
}

STORY(a_terminal_that_never_answers_gets_a_frame_now_and_then)
{
    struct flow flow = {.silent = true};
    CHECK(flow_may_send(&flow, 1 * MS));
    flow_sent(&flow, 1000, 1 * MS);
    CHECK(!flow_may_send(&flow, 200 * MS));
    CHECK_INT(flow_wait_ms(&flow, 200 * MS), 1);
    CHECK(flow_may_send(&flow, 201 * MS));
    CHECK_INT(flow_budget(&flow), FLOW_BYTES_START);
    flow_answered(&flow, 202 * MS);
    CHECK_INT(flow_budget(&flow), FLOW_BYTES_START);
}

STORY(a_long_way_begins_with_few_bytes)
{
    struct flow near = {.round_trip_ns = 30 * MS}, far = {.round_trip_ns = 120 * MS};
    CHECK_INT(flow_budget(&near), FLOW_BYTES_START);
    CHECK_INT(flow_budget(&far), FLOW_BYTES_FAR);
    flow_sent(&far, FLOW_BYTES_FAR, 1 * MS); /* and it was a fast one */
    flow_answered(&far, 123 * MS);
    CHECK(flow_budget(&far) >= FLOW_BYTES_START);
}

STORY(clocks_and_sizes_at_their_limits_do_no_harm)
{
    struct flow flow = {0};
    flow_sent(&flow, 0, 100);
    flow_answered(&flow, 50); /* before it was sent */
    CHECK(flow_budget(&flow) >= FLOW_BYTES_LEAST && flow_budget(&flow) <= FLOW_BYTES_MOST);
    flow_sent(&flow, SIZE_MAX, 200);
    flow_answered(&flow, UINT64_MAX / 2);
    CHECK(flow_budget(&flow) >= FLOW_BYTES_LEAST && flow_budget(&flow) <= FLOW_BYTES_MOST);
    CHECK_INT(divisor_of(&flow, SIZE_MAX), 8);
    CHECK_INT(divisor_of(&flow, 0), 1);
}
