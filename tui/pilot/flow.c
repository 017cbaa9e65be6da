/* SPDX-License-Identifier: MIT */
#include "tui/pilot/flow.h"

#include "base/least.h"

enum { SAMPLE_FROM = 2000 }; /* bytes */

#define SLACK_NS UINT64_C(50000000)  /* answers may be this much later than expected, */
#define PAUSE_NS UINT64_C(200000000) /* and this much where a terminal pauses */

static uint64_t since(uint64_t then_ns, uint64_t now_ns)
{
    return now_ns > then_ns ? now_ns - then_ns : 0;
}

static uint64_t later(uint64_t a_ns, uint64_t b_ns)
{
    return a_ns > b_ns ? a_ns : b_ns;
}

/* ---- the line ---- */

/* Return the time of an empty frame; half of the fastest answer while it is unknown. */
static uint64_t round_trip(const struct flow *f)
{
    if (f->round_trip_ns == 0)
        return f->least_ns / 2;
    return f->least_ns == 0 ? f->round_trip_ns : least_64(f->round_trip_ns, f->least_ns);
}

struct slope {
    double ns, weight; /* ns a byte; bytes */
};

enum { SLOPES_MOST = FLOW_SAMPLES * (FLOW_SAMPLES + 1) / 2 };

/* Skip pairs of similar size: their noise exceeds the difference. */
static unsigned add_slope(struct slope *slope, unsigned count, struct flow_sample a,
                          struct flow_sample b)
{
    const double apart = b.bytes - a.bytes, larger = a.bytes > b.bytes ? a.bytes : b.bytes;
    const double weight = apart < 0 ? -apart : apart;
    struct slope new = {(b.ns - a.ns) / apart, weight};
    if (weight < 1 || weight < larger / 4)
        return count;
    for (unsigned i = 0; i < count; i++)
        if (new.ns < slope[i].ns) {
            const struct slope moved = slope[i];
            slope[i] = new;
            new = moved;
        }
    slope[count] = new;
    return count + 1;
}

/* Compute the weighted median of the slopes. */
static double per_byte_ns(const struct flow *f)
{
    struct slope slope[SLOPES_MOST];
    const struct flow_sample empty = {0, (double)round_trip(f)};
    unsigned count = 0;
    double half = 0;
    for (unsigned i = 0; i < f->samples; i++) {
        count = add_slope(slope, count, empty, f->sample[i]);
        for (unsigned k = 0; k < i; k++)
            count = add_slope(slope, count, f->sample[k], f->sample[i]);
    }
    for (unsigned i = 0; i < count; i++)
        half += slope[i].weight / 2;
    for (unsigned i = 0; i < count; i++)
        if ((half -= slope[i].weight) <= 0)
            return slope[i].ns > 0 ? slope[i].ns : 0;
    return 0;
}

static void add_sample(struct flow *f, double bytes, double ns)
{
    f->sample[f->next] = (struct flow_sample){bytes, ns};
    f->next = (f->next + 1) % FLOW_SAMPLES;
    f->samples += f->samples < FLOW_SAMPLES;
    f->per_byte_ns = per_byte_ns(f);
}

/* ---- frames that are due ---- */

static const struct flow_frame *due_frame(const struct flow *f, unsigned i)
{
    return &f->frame[(f->first + i) % FLOW_FRAMES];
}

/* Return the time when the line will have carried the first `count` due frames. */
static uint64_t carried_ns(const struct flow *f, unsigned count)
{
    uint64_t free_ns = since(round_trip(f), f->answered_ns);
    for (unsigned i = 0; i < count; i++)
        free_ns = later(free_ns, due_frame(f, i)->sent_ns) +
                  (uint64_t)(f->per_byte_ns * (double)due_frame(f, i)->bytes);
    return free_ns;
}

static uint64_t limit_ns(const struct flow *f)
{
    const uint64_t limit = due_frame(f, 0)->sent_ns + FLOW_LIMIT_NS;
    return f->settled_ns && f->settled_ns < limit ? f->settled_ns : limit;
}

/* Return the time when the next frame may be sent, if no answer arrives before. */
static uint64_t ready_ns(const struct flow *f, uint64_t now_ns)
{
    if (f->silent)
        return f->sent_ns ? f->sent_ns + FLOW_PAUSE_NS : 0;
    if (f->due == 0)
        return 0;
    const uint64_t lead = FLOW_LEAD_NS + least_64(f->drawn_ns, FLOW_DRAW_NS);
    const uint64_t ready = since(lead, carried_ns(f, f->due));
    const uint64_t overdue = carried_ns(f, 1) + round_trip(f) + SLACK_NS;
    if (f->late > 0 || f->settled_ns || f->samples == 0 || f->due == FLOW_FRAMES ||
        later(now_ns, ready) > overdue)
        return limit_ns(f);
    return ready;
}

/* ---- sending, and answers ---- */

bool flow_may_send(struct flow *f, uint64_t now_ns)
{
    double bytes = 0;
    if (now_ns < ready_ns(f, now_ns))
        return false;
    if (f->due > 0 && f->settled_ns && now_ns >= f->settled_ns) {
        f->due = 0;
        f->late = 0;
    } else if (f->due > 0 && now_ns >= limit_ns(f)) {
        /* All that is known of the frames given up is that they were too slow. */
        for (unsigned i = 0; i < f->due; i++)
            bytes += (double)due_frame(f, i)->bytes;
        f->samples = f->next = 0;
        add_sample(f, bytes, (double)round_trip(f) + (double)FLOW_LIMIT_NS);
        f->soon = false;
        f->failed = true;
        f->late += f->due;
        f->due = 0;
    }
    f->settled_ns = 0;
    return true;
}

int flow_wait_ms(const struct flow *f, uint64_t now_ns)
{
    return (int)((since(now_ns, ready_ns(f, now_ns)) + 999999) / 1000000);
}

void flow_sent(struct flow *f, size_t bytes, uint64_t now_ns)
{
    f->sent_ns = now_ns;
    f->failed = false;
    f->settled_ns = 0;
    if (f->silent || f->due == FLOW_FRAMES)
        return;
    const bool is_sample = bytes >= SAMPLE_FROM || bytes >= flow_budget(f) / 2;
    f->frame[(f->first + f->due++) % FLOW_FRAMES] = (struct flow_frame){now_ns, bytes, is_sample};
}

void flow_answered(struct flow *f, uint64_t now_ns)
{
    const struct flow_frame frame = *due_frame(f, 0);
    if (f->late > 0) {
        /* The answer may be that of an older frame. If many are late, their answers may arrive as
         * slowly as the frames were given up. */
        const uint64_t follows_ns = f->least_ns / 2 + SLACK_NS +
                                    (uint64_t)(2 * f->per_byte_ns * (double)due_frame(f, 0)->bytes);
        f->late--;
        if (f->due > 0)
            f->settled_ns =
                now_ns + (f->late > 0 ? later(follows_ns, FLOW_LIMIT_NS / 2) : follows_ns);
        return;
    }
    if (f->due == 0)
        return;
    const uint64_t free_ns = later(frame.sent_ns, since(round_trip(f), f->answered_ns));
    const uint64_t took_ns = since(frame.sent_ns, now_ns), alone_ns = since(free_ns, now_ns);
    f->first = (f->first + 1) % FLOW_FRAMES;
    f->due--;
    f->settled_ns = 0;
    f->answered_ns = now_ns;
    if (f->least_ns == 0 || took_ns < f->least_ns)
        f->least_ns = took_ns;
    /* A single frame that is far slower than expected is a pause of the terminal; two in a row mean
     * that the line has changed, so earlier frames do not count. */
    const double bytes = (double)frame.bytes, ns = (double)alone_ns;
    const double expected = (double)round_trip(f) + f->per_byte_ns * bytes;
    f->surprises = ns > 4 * expected + PAUSE_NS ? f->surprises + 1 : 0;
    if (f->surprises == 2)
        f->samples = f->next = 0;
    if (frame.is_sample || f->samples == 0 || f->surprises > 1)
        add_sample(f, bytes, ns);
    f->soon = alone_ns <= round_trip(f) + FLOW_TARGET_NS * 3 / 4;
    f->sent_bytes = frame.bytes;
}

/* ---- budget ---- */

uint64_t flow_carries_ns(const struct flow *f, size_t bytes)
{
    return (uint64_t)(f->per_byte_ns * (double)bytes);
}

size_t flow_budget(const struct flow *f)
{
    double most = FLOW_BYTES_START;
    const double at_least = f->soon ? 2 * (double)f->sent_bytes : FLOW_BYTES_LEAST;
    if (f->samples == 0) /* a line with a long delay is rarely a fast one */
        return f->round_trip_ns > 2 * FLOW_TARGET_NS ? FLOW_BYTES_FAR : FLOW_BYTES_START;
    for (unsigned i = 0; i < f->samples; i++)
        most = 4 * f->sample[i].bytes > most ? 4 * f->sample[i].bytes : most;
    double bytes = f->per_byte_ns * most <= (double)FLOW_TARGET_NS
                       ? most
                       : (double)FLOW_TARGET_NS / f->per_byte_ns;
    bytes = bytes < at_least ? at_least : bytes;
    bytes = bytes < FLOW_BYTES_LEAST ? FLOW_BYTES_LEAST : bytes;
    return bytes > FLOW_BYTES_MOST ? FLOW_BYTES_MOST : (size_t)bytes;
}

/* ---- keys, and slices that are sent ahead ---- */

void pace_key(struct pace *pace, uint64_t now_ns)
{
    const bool is_held = pace->key_ns > 0 && now_ns < pace->key_ns + PACE_HELD_NS;
    pace->within_ns = is_held ? PACE_BETWEEN_NS : PACE_SINGLE_NS;
    pace->key_ns = now_ns;
}

void ahead_begin(struct ahead *ahead)
{
    ahead->number = ahead->rests ? AHEAD_NUMBERS : 0;
    ahead->name = 0;
}

void ahead_forget(struct ahead *ahead)
{
    ahead_begin(ahead);
    ahead->names = 0;
}

struct image_view *ahead_next(struct ahead *ahead, const struct pilot_host *host,
                              const struct pilot_wish *wish)
{
    const size_t names = ahead->names < AHEAD_KNOWN ? ahead->names : AHEAD_KNOWN;
    for (; ahead->number < AHEAD_NUMBERS; ahead->number++) {
        const uint64_t name = host->name_ahead(host->context, wish, ahead->number);
        bool is_known = false;
        if (name && name == ahead->name)
            return &ahead->view;
        for (size_t i = 0; i < names; i++)
            is_known |= ahead->known[i] == name;
        if (!name || is_known || !host->ahead(host->context, wish, ahead->number, &ahead->view))
            continue;
        ahead->name = name;
        return &ahead->view;
    }
    return NULL;
}

void ahead_has_gone(struct ahead *ahead)
{
    ahead->known[ahead->names++ % AHEAD_KNOWN] = ahead->name;
    ahead->name = 0;
    ahead->number++;
}

bool ahead_pays(const struct flow *flow)
{
    return flow_carries_ns(flow, AHEAD_BYTES) > AHEAD_LATE_NS;
}
