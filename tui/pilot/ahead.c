/* SPDX-License-Identifier: MIT */
#include "tui/pilot/ahead.h"

void ahead_begin(struct ahead *ahead)
{
    ahead->number = 0;
    ahead->name = 0;
}

void ahead_forget(struct ahead *ahead)
{
    ahead_begin(ahead);
    ahead->names = 0;
}

static bool is_known(const struct ahead *ahead, uint64_t name)
{
    const size_t names = ahead->names < AHEAD_KNOWN ? ahead->names : AHEAD_KNOWN;
    for (size_t i = 0; i < names; i++)
        if (ahead->known[i] == name)
            return true;
    return false;
}

struct image_view *ahead_next(struct ahead *ahead, const struct pilot_host *host,
                              const struct pilot_wish *wish)
{
    for (; !ahead_is_over(ahead); ahead->number++) {
        const uint64_t name = host->name_ahead(host->context, wish, ahead->number);
        if (name && name == ahead->name)
            return &ahead->view;
        if (!name || is_known(ahead, name) ||
            !host->ahead(host->context, wish, ahead->number, &ahead->view))
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
