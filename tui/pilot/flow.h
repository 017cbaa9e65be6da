/* SPDX-License-Identifier: MIT */
/*
 * Sending to the terminal: keep a slow line full, without frames that wait in it.
 *
 * Three parts share the learnt rate of the line: `flow` decides when a frame may be sent and how
 * many bytes it may have, `refine` makes a frame that fits into them, and `ahead` uses an idle line
 * for slices that may be wanted next. `pace` classifies how keys arrive. All are pure: the time is
 * an argument, in ns of any clock that never goes back.
 *
 *     frame ESC[c  frame ESC[c  ......   ESC[?62;4c  ESC[?62;4c     each answer confirms that a
 *                                                                   frame has been drawn
 *
 * write() returns when the kernel has the bytes, long before a slow line has carried them. A sender
 * of frame after frame fills every queue on the way, and the screen shows old states; a sender that
 * waits for each answer leaves a line with a long delay idle most of the time. So each frame ends
 * with a question, a barrier, and
 *
 *   L1 a frame is sent when the line, at its learnt rate, has almost carried the frames before it;
 *      at most FLOW_FRAMES frames are unanswered. Intermediate states are dropped, not queued: the
 *      next frame shows the newest state;
 *   L2 while the oldest answer is overdue nothing is sent: the line has become slower or is stuck,
 *      and only the frames already sent can queue up. After FLOW_LIMIT_NS all of them are given up.
 *      The transfer may have been cut on the way, so the next frame begins with a recovery sequence
 *      (`failed`, graphics_recovery), and one frame at a time is sent until the late answers
 *      have been assigned;
 *   L3 a frame has as many bytes as the line carries in FLOW_TARGET_NS: a larger picture is sent
 *      coarser, since quality drops before latency does. When nothing moves the caller sends the
 *      full picture.
 *
 * Model of the line: a frame alone needs `round_trip + bytes x per_byte`, counted from the moment
 * the line was free. The cost of a byte is the median of the slopes between the last FLOW_SAMPLES
 * frames (Theil and Sen), each pair weighted by its difference in size, with an empty frame of
 * one round trip. So a terminal that pauses now and then, or draws once in 16 ms, is not
 * mistaken for a slow line. Small frames are no samples. The budget grows at most fourfold a frame,
 * and at least doubles after a frame that was fast enough.
 *
 * Answers arrive in order but have no number. After failed barriers the next answer may be a late
 * one or that of the newest frame. The latter follows within the transfer time of its bytes; if
 * nothing follows, the answer was that of the newest frame.
 *
 *     struct flow flow = {.round_trip_ns = facts.round_trip_ns, .silent = !facts.answers};
 *     if (flow_may_send(&flow, now)) {
 *         .. as fine as flow_budget(&flow) allows ..
 *         .. term_write(frame, ESC[c) ..
 *         flow_sent(&flow, bytes, now);
 *     } else {
 *         .. wait for input, at most flow_wait_ms(&flow, now) ..
 *     }
 *     .. at a KEY_REPLY "[?..c": flow_answered(&flow, now) ..
 */
#ifndef TUI_PILOT_FLOW_H
#define TUI_PILOT_FLOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tui/pilot/host.h"

#define FLOW_LIMIT_NS  UINT64_C(2000000000)
#define FLOW_TARGET_NS UINT64_C(33000000)
#define FLOW_LEAD_NS   UINT64_C(10000000)  /* transfer time left when the next frame is sent; */
#define FLOW_DRAW_NS   UINT64_C(40000000)  /* the time to draw it is added, up to this limit */
#define FLOW_PAUSE_NS  UINT64_C(200000000) /* between frames if the terminal does not answer */

enum {
    FLOW_BYTES_START = 24 << 10,
    FLOW_BYTES_FAR = 10 << 10,
    FLOW_BYTES_LEAST = 512,
    FLOW_BYTES_MOST = 16 << 20,
    FLOW_FRAMES = 16,
    FLOW_SAMPLES = 12
};

struct flow {
    uint64_t round_trip_ns; /* known beforehand; 0: unknown */
    bool silent;            /* the terminal answers nothing: send frames at intervals */
    uint64_t drawn_ns;      /* time that drawing the last frame took */
    /* ---- private, but for reading `due` and `failed` ---- */
    unsigned due;  /* frames whose barriers are unanswered */
    bool failed;   /* frames were given up, and nothing was sent since */
    unsigned late; /* barriers given up whose answers may still arrive */
    struct flow_frame {
        uint64_t sent_ns;
        size_t bytes;
        bool is_sample;   /* large enough to measure the rate */
    } frame[FLOW_FRAMES]; /* a ring of the unanswered frames, */
    unsigned first;       /* the oldest of them */
    uint64_t sent_ns;     /* time of the last frame, */
    uint64_t answered_ns; /* and of the last answer */
    uint64_t settled_ns;  /* without an answer by then, the last was the newest frame's; or 0 */
    uint64_t least_ns;    /* the fastest answer so far */
    size_t sent_bytes;    /* size of the last answered frame, */
    bool soon;            /* and whether the line took less than the target for it */
    struct flow_sample {
        double bytes, ns;
    } sample[FLOW_SAMPLES]; /* a ring */
    unsigned samples, next;
    unsigned surprises; /* consecutive frames that took far longer than the model predicts */
    double per_byte_ns; /* computed from the samples */
};

/* Return true if a frame may be sent now. It may after FLOW_LIMIT_NS too, when barriers failed. */
bool flow_may_send(struct flow *f, uint64_t now_ns);

/* Longest wait until flow_may_send returns true: 0 if it does now, else at least 1. */
int flow_wait_ms(const struct flow *f, uint64_t now_ns);

/* A frame of `bytes` and its question have been written; `now_ns` is the time before the write,
 * which may block. */
void flow_sent(struct flow *f, size_t bytes, uint64_t now_ns);

/* An answer to ESC[c arrived. */
void flow_answered(struct flow *f, uint64_t now_ns);

/* Size of the next frame, FLOW_BYTES_LEAST..FLOW_BYTES_MOST. */
size_t flow_budget(const struct flow *f);

/* Return the time for `bytes` on the line, in ns; 0 while the rate is unknown. */
uint64_t flow_carries_ns(const struct flow *f, size_t bytes);

/* ---- how keys arrive ---- */

/*
 * A slow rendition is drawn coarsely first, and finely when no key follows (pilot_wish).
 * A coarse rendition needs half the time. After a single key both are drawn, so that is worth it
 * only where the fine one is very slow; while a key is held the coarse one replaces it. On one
 * core, with 30 ms for a turn, a held key shows 29 frames a second instead of 25 and uses a
 * sixth less processor time.
 */

/* Keys rest after this time, which is longer than the interval of a held key; drawing delays keys,
 * so a key is held up to the longer interval. */
#define PACE_REST_NS UINT64_C(40000000)
#define PACE_HELD_NS UINT64_C(100000000)

/* Time limit of a rendition that is drawn finely at once: after a single key, while one is held. */
#define PACE_SINGLE_NS  UINT64_C(50000000)
#define PACE_BETWEEN_NS UINT64_C(25000000)

/* `{.within_ns = PACE_SINGLE_NS}`: no key has arrived. */
struct pace {
    uint64_t key_ns;    /* time of the last key; 0: none */
    uint64_t within_ns; /* time limit of a rendition after it */
};

void pace_key(struct pace *pace, uint64_t now_ns);

/* ---- pictures that get finer ---- */

/*
 * A picture is cut into tiles. Tiles that the screen shows correctly stay; of the others as many
 * are sent as the frame's budget allows, in coarser pixels if necessary; of fine tiles up to half
 * as many more, to the end of a row. Words stay sharp in coarse tiles, and the focus of the view
 * gets fine first; the first frame has as many tiles as fit, those of the focus first. The cost of
 * tiles is learnt from the frames that were sent. Where the terminal stores the greys of a slice
 * (tui/picture/painter.h) little is left to send, and tiles are fine at once; where it will get
 * them, tiles wait.
 *
 *     struct refine r = {0};
 *     refine_begin(&r, &wanted, moves, budget, &shown)    shown: the picture to put on the screen
 *     .. painter_show(&p, &shown, &out) ..
 *     refine_sent(&r, bytes)
 *     if (r.is_coarse) .. another frame makes it finer ..
 */
enum { REFINE_TILE = 16, REFINE_LEVELS = 5 }; /* pixels a side; coarser by 1, 2, 4, 8, 16 */

struct refine {
    uint32_t width, height;
    uint8_t *rgba;  /* shown on the screen */
    bool is_coarse; /* it differs from the wanted picture */
    unsigned level; /* level and number of tiles of the last frame, */
    size_t tiles;
    double cost[REFINE_LEVELS]; /* bytes a tile */
    struct raster_box *stale;   /* tiles of the present frame that differ from the wanted picture */
    size_t stales, stale_capacity;
    bool waits;    /* some tiles wait for the terminal to get their greys */
    bool is_begun; /* only a part of the first picture was sent, as coarse as possible */
};

/* Set `shown`, of the size of `wanted` and owned by the refine until the next call, to the picture
 * to send. If something moves all of it is sent, as coarse as the budget requires; otherwise as
 * many tiles as fit are made fine. Return false without memory. */
bool refine_begin(struct refine *r, const struct image_view *wanted, bool moves, size_t budget,
                  struct image_view *shown);

/* Tell how many bytes the painter made of it. */
void refine_sent(struct refine *r, size_t bytes);

/* The screen was cleared. */
void refine_forget(struct refine *r);
void refine_release(struct refine *r);

/* ---- slices that are sent ahead ---- */

/*
 * Slices that may be wanted next are sent to a terminal that stores them (tui/picture/painter.h)
 * while the line is idle.
 *
 *   A1 each slice is sent once. Hosts name slices as they are shown now; a name that was sent is
 *      neither drawn nor sent again until the terminal may have dropped its slices;
 *   A2 only slices within AHEAD_WITHIN of the cross-hair are sent, on both sides and in all planes,
 *      the nearest first: when all of them are there nothing happens until a key;
 *   A3 none is sent if the line carries a slice in less than AHEAD_LATE_NS anyway;
 *   A4 none is sent when the pilot is opened again, until a key is pressed.
 */
enum {
    AHEAD_WITHIN = 4,
    AHEAD_NUMBERS = 6 * AHEAD_WITHIN,
    AHEAD_NEAR = 6,     /* numbers: the next slices of all planes */
    AHEAD_KNOWN = 512,  /* names */
    AHEAD_BYTES = 25000 /* about, for one slice */
};
#define AHEAD_LATE_NS UINT64_C(50000000)

/* `{0}`: nothing was sent. */
struct ahead {
    unsigned number; /* index of the next one to consider; AHEAD_NUMBERS when all have been sent */
    bool rests;      /* nothing is sent from the next ahead_begin on (A4) */
    uint64_t name;   /* name of `view`, which the host has drawn; 0: none */
    struct image_view view;
    uint64_t known[AHEAD_KNOWN]; /* a ring */
    size_t names;                /* number of names ever stored */
};

/* Another state is shown: start with the slices around it. */
void ahead_begin(struct ahead *ahead);

/* The terminal may have dropped its slices. */
void ahead_forget(struct ahead *ahead);

/* Return the next slice to send, the same one until ahead_has_gone; NULL if all were sent. */
struct image_view *ahead_next(struct ahead *ahead, const struct pilot_host *host,
                              const struct pilot_wish *wish);
void ahead_has_gone(struct ahead *ahead);

/* Return true if the line is so slow that sending ahead is worth it (A3). */
bool ahead_pays(const struct flow *flow);

#endif
