/* SPDX-License-Identifier: MIT */
/*
 * How much may be sent to the terminal, and when: so that the line is full and nothing waits in it.
 *
 *     frame ESC[c  frame ESC[c  ......   ESC[?62;4c  ESC[?62;4c     each answer says that a frame
 *                                                                   has been drawn
 *
 * write() returns when the kernel has the bytes, long before a slow line has carried them. A sender
 * of frame after frame fills every queue on the way, and the screen shows the past; one that waits
 * for each answer leaves a line with a long way idle most of the time. So each frame ends with a
 * question, a barrier, and
 *
 *   L1 a frame is sent when the line, at the rate that has been learnt, has all but carried those
 *      before it, at most FLOW_FRAMES of them without an answer. What came up meanwhile is dropped,
 *      not queued, and the newest state is what goes next;
 *   L2 when the oldest answer is overdue nothing is sent until it is there: the line has become
 *      slower, or stands still, and what is on it is all that ever queues up. After FLOW_LIMIT_NS
 *      without it all of them are given up; the transfer may have been cut on the way, so the next
 *      frame begins with what ends it (`failed`, graphics_add_recovery), and until the barriers
 *      have been sorted out again there is one frame at a time;
 *   L3 a frame has as many bytes as the line carries in FLOW_TARGET_NS: a picture that needs more
 *      is sent coarser (tui/pilot/finer.h), for quality is to drop before latency does. When
 *      nothing moves any more the caller sends the full picture.
 *
 * The line is taken for one that needs `round_trip + bytes x per_byte` for a frame alone, counted
 * from when the line was free for it. What a byte costs is the median of the slopes between the
 * last FLOW_SAMPLES frames, each pair of which counts as much as the two differ in size (Theil and
 * Sen), with one of no bytes at all that takes the round trip: so a terminal that pauses now and
 * then, or draws once in 16 ms whatever comes, is not taken for a slow line. Small frames say
 * nothing about a line that may carry much more, and are no samples. A budget grows at most
 * fourfold a frame, and doubles at least where a frame was soon enough.
 *
 * Answers come in order but bear no number. After barriers that failed, the next answer may be one
 * of theirs, come late, or that of the frame after them: the latter follows within the time that
 * its bytes take, or else it was that.
 *
 * Pure: the time is an argument, in ns of any clock that never goes back.
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

#define FLOW_LIMIT_NS  UINT64_C(2000000000)
#define FLOW_TARGET_NS UINT64_C(33000000)
#define FLOW_LEAD_NS   UINT64_C(10000000)  /* what the line still has when a frame is added */
#define FLOW_PAUSE_NS  UINT64_C(200000000) /* from frame to frame where nothing answers */

enum {
    FLOW_BYTES_START = 24 << 10,
    FLOW_BYTES_FAR = 10 << 10,
    FLOW_BYTES_LEAST = 512,
    FLOW_BYTES_MOST = 16 << 20
};
enum { FLOW_FRAMES = 16, FLOW_SAMPLES = 12 };

struct flow_frame {
    uint64_t sent_ns;
    size_t bytes;
    bool is_sample; /* it is large enough to show what the line carries */
};

struct flow {
    uint64_t round_trip_ns; /* as known beforehand; 0: not at all */
    bool silent;            /* the terminal answers nothing: frames keep a distance in time */
    /* ---- ours ---- */
    unsigned due;  /* read-only: frames whose barriers have no answer yet */
    bool failed;   /* read-only: some were given up, and nothing was sent since */
    unsigned late; /* barriers given up whose answers may still come */
    struct flow_frame frame[FLOW_FRAMES]; /* a ring of those that are due, */
    unsigned first;                       /* the oldest here */
    uint64_t sent_ns;                     /* the last frame */
    uint64_t answered_ns;                 /* the last answer */
    uint64_t settled_ns; /* if nothing else comes until then, what came was the answer; 0: unset */
    uint64_t least_ns;   /* the soonest answer yet */
    size_t sent_bytes;   /* of the frame that was answered last, which was soon */
    bool soon;           /* it took the line less than the target */
    struct flow_sample {
        double bytes, ns;
    } sample[FLOW_SAMPLES]; /* the last ones, in a ring */
    unsigned samples, next;
    unsigned surprises; /* in a row: frames that took far longer than what is known says */
    double per_byte_ns; /* what follows from the samples */
};

/* Whether a frame may go now. True after FLOW_LIMIT_NS too, when barriers have failed. */
bool flow_may_send(struct flow *f, uint64_t now_ns);

/* How long it takes at most until flow_may_send says yes: 0 when it does, else at least 1. */
int flow_wait_ms(const struct flow *f, uint64_t now_ns);

/* A frame of so many bytes and its question have been written; `now_ns` is from before the write,
 * which may block. */
void flow_sent(struct flow *f, size_t bytes, uint64_t now_ns);

/* An answer to ESC[c came. */
void flow_answered(struct flow *f, uint64_t now_ns);

/* Bytes that the next frame may have; FLOW_BYTES_LEAST..FLOW_BYTES_MOST. */
size_t flow_budget(const struct flow *f);

/* How long the line takes for so many bytes, in ns; 0 while that is not known. */
uint64_t flow_carries_ns(const struct flow *f, size_t bytes);

#endif
