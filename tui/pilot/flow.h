/*
 * How much may be sent to the terminal, and when: so that what is on screen is never older than the
 * line makes it.
 *
 *     frame ESC[c   ............   ESC[?62;4c      the answer says that the frame has been drawn
 *
 * write() returns when the kernel has the bytes, long before a slow line has carried them. A sender of
 * frame after frame fills every queue on the way, and the screen shows the past. So each frame
 * ends with a question, a barrier, and
 *
 *   L1 a frame is sent only when the barrier before it has been answered: what came up meanwhile is
 *      dropped, not queued, and the newest state is what goes next;
 *   L2 after FLOW_LIMIT_NS without an answer it goes on anyway, one frame at a time; the transfer
 *      may have been cut on the way, so a frame after a failed barrier begins with what ends it
 *      (`failed`, probe_add_recovery);
 *   L3 a frame has as many bytes as the line carries in FLOW_TARGET_NS: a picture that needs more
 *      is sent coarser (tui/pilot/refine.h), for quality is to drop before latency does. When nothing
 *      moves any more the caller sends the full picture.
 *
 * The line is taken for one that needs `round_trip + bytes x per_byte`. Both come from what has
 * been measured, by least squares in which older frames count less and less; what the terminal
 * needs to draw is in it. A budget grows at most fourfold a frame, and doubles at least where a
 * frame was soon enough, since small frames say little about a line.
 *
 * Answers come in order but bear no number. After a barrier that failed, the next answer may be its
 * own, come late, or that of the frame after it: the latter follows within the time that its bytes
 * take, or else it was that.
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
#define FLOW_TARGET_NS UINT64_C(100000000)
#define FLOW_PAUSE_NS  UINT64_C(200000000) /* from frame to frame where nothing answers */

enum { FLOW_BYTES_START = 64 << 10, FLOW_BYTES_LEAST = 1 << 10, FLOW_BYTES_MOST = 16 << 20 };

struct flow {
    uint64_t round_trip_ns; /* as known beforehand; 0: not at all */
    bool silent;            /* the terminal answers nothing: frames keep a distance in time */
    /* ---- ours ---- */
    bool due;      /* the last barrier has no answer yet */
    bool failed;   /* read-only: it was given up, and nothing was sent since */
    unsigned late; /* barriers given up whose answers may still come */
    uint64_t sent_ns;
    uint64_t settled_ns; /* if nothing else comes until then, what came was the answer; 0: unset */
    uint64_t least_ns;   /* the soonest answer yet */
    size_t sent_bytes;
    double most_bytes;           /* the largest frame of late */
    bool soon;                   /* the last frame took no longer than the target */
    double weight, x, y, xx, xy; /* of the least squares: bytes and ns */
};

/* Whether a frame may go now. True after FLOW_LIMIT_NS too, when the barrier has failed. */
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

#endif
