#include "tui/pilot/flow.h"

/* What a frame counts when the next has come: the line of ten frames ago hardly matters. */
#define FADE     0.8
#define SLACK_NS UINT64_C(50000000)

static uint64_t since(uint64_t then_ns, uint64_t now_ns)
{
    return now_ns > then_ns ? now_ns - then_ns : 0;
}

/* When the next frame may go, if nothing comes until then. */
static uint64_t ready_ns(const struct flow *f)
{
    const uint64_t limit = f->sent_ns + FLOW_LIMIT_NS;
    if (f->silent)
        return f->sent_ns ? f->sent_ns + FLOW_PAUSE_NS : 0;
    if (!f->due)
        return 0;
    return f->settled_ns && f->settled_ns < limit ? f->settled_ns : limit;
}

/* ---- the line ---- */

/* Points of one size have no slope; then the round trip is the one end, or a guess of it. */
static double ns_per_byte(const struct flow *f)
{
    const double spread = f->weight * f->xx - f->x * f->x;
    const double soonest = (double)f->least_ns, known = (double)f->round_trip_ns;
    const double trip = known > 0 && known < soonest ? known : soonest / 2;
    double slope;
    if (f->weight <= 0 || f->x <= 0)
        return 0;
    if (spread > 0.02 * f->x * f->x)
        slope = (f->weight * f->xy - f->x * f->y) / spread;
    else
        slope = (f->y - f->weight * trip) / f->x;
    return slope > 0 ? slope : 0;
}

/* What even no bytes at all would take. */
static uint64_t round_trip(const struct flow *f)
{
    if (f->round_trip_ns && (f->least_ns == 0 || f->round_trip_ns < f->least_ns))
        return f->round_trip_ns;
    return f->least_ns;
}

static void forget(struct flow *f)
{
    f->weight = f->x = f->y = f->xx = f->xy = 0;
}

/* A frame that took far longer than what is known says: the line has changed, and old frames say
 * nothing about it. */
static void learn(struct flow *f, size_t bytes, uint64_t took_ns)
{
    const double x = (double)bytes, y = (double)took_ns;
    const double expected = (double)round_trip(f) + ns_per_byte(f) * x;
    if (y > 2 * expected + SLACK_NS)
        forget(f);
    f->weight = f->weight * FADE + 1;
    f->x = f->x * FADE + x;
    f->y = f->y * FADE + y;
    f->xx = f->xx * FADE + x * x;
    f->xy = f->xy * FADE + x * y;
    f->most_bytes = x > f->most_bytes * FADE ? x : f->most_bytes * FADE;
}

/* Of a barrier that failed it is only known that it took too long: all earlier is forgotten. */
static void give_up(struct flow *f)
{
    const double byte_ns = 2 * ns_per_byte(f);
    const double at_least = (double)FLOW_LIMIT_NS / (double)(f->sent_bytes ? f->sent_bytes : 1);
    const double now = byte_ns > at_least ? byte_ns : at_least;
    forget(f);
    f->most_bytes = 0;
    learn(f, FLOW_BYTES_START, (uint64_t)(now * FLOW_BYTES_START));
    f->soon = false;
    f->failed = true;
    f->due = false;
    f->late++;
}

/* ---- sending and hearing ---- */

bool flow_may_send(struct flow *f, uint64_t now_ns)
{
    if (now_ns < ready_ns(f))
        return false;
    if (f->due && f->settled_ns) {
        f->due = false;
        f->late = 0;
    } else if (f->due) {
        give_up(f);
    }
    f->settled_ns = 0;
    return true;
}

int flow_wait_ms(const struct flow *f, uint64_t now_ns)
{
    return (int)((since(now_ns, ready_ns(f)) + 999999) / 1000000);
}

void flow_sent(struct flow *f, size_t bytes, uint64_t now_ns)
{
    f->sent_ns = now_ns;
    f->sent_bytes = bytes;
    f->failed = false;
    f->settled_ns = 0;
    f->due = !f->silent;
}

void flow_answered(struct flow *f, uint64_t now_ns)
{
    const uint64_t took = since(f->sent_ns, now_ns);
    if (f->late > 0) {
        f->late--;
        if (f->due) /* whose is it? */
            f->settled_ns = now_ns + f->least_ns / 2 + SLACK_NS +
                            (uint64_t)(2 * ns_per_byte(f) * (double)f->sent_bytes);
        return;
    }
    if (!f->due)
        return;
    f->due = false;
    f->settled_ns = 0;
    f->soon = took <= round_trip(f) + FLOW_TARGET_NS;
    if (f->least_ns == 0 || took < f->least_ns)
        f->least_ns = took;
    learn(f, f->sent_bytes, took);
}

/* ---- what to send ---- */

size_t flow_budget(const struct flow *f)
{
    const double per_byte = ns_per_byte(f), grown = 4 * f->most_bytes;
    const double most = grown > FLOW_BYTES_START ? grown : FLOW_BYTES_START;
    const double at_least = f->soon ? 2 * (double)f->sent_bytes : FLOW_BYTES_LEAST;
    if (f->weight <= 0)
        return FLOW_BYTES_START;
    double bytes =
        per_byte * most <= (double)FLOW_TARGET_NS ? most : (double)FLOW_TARGET_NS / per_byte;
    bytes = bytes < at_least ? at_least : bytes;
    bytes = bytes < FLOW_BYTES_LEAST ? FLOW_BYTES_LEAST : bytes;
    return bytes > FLOW_BYTES_MOST ? FLOW_BYTES_MOST : (size_t)bytes;
}
