#include "tui/pilot/typed_ahead.h"

#include "base/scan.h"

bool typed_ahead_has_room(const struct typed_ahead *ahead)
{
    const size_t count = ahead->count;
    return count == 0 || (count < TYPED_AHEAD_MOST && ahead->event[count - 1].key != KEY_PASTE_END);
}

void typed_ahead_add(struct typed_ahead *ahead, const struct key_event *event)
{
    if (ahead->count < TYPED_AHEAD_MOST)
        ahead->event[ahead->count++] = *event;
}

bool typed_ahead_take(struct typed_ahead *ahead, struct key_event *event)
{
    if (ahead->taken == ahead->count)
        return false;
    *event = ahead->event[ahead->taken++];
    if (ahead->taken == ahead->count)
        ahead->taken = ahead->count = 0;
    return true;
}

/* "cross X,Y,Z" and no more, or nothing at all. */
static bool only_moves(const struct buf *line, uint32_t place[3], bool *moves)
{
    const char *at = buf_text(line);
    *moves = scan_text(&at, "cross ");
    for (int a = 0; *moves && a < 3; a++) {
        int64_t n;
        if ((a > 0 && !scan_text(&at, ",")) || !scan_integer(&at, 0, UINT32_MAX, &n))
            return false;
        place[a] = (uint32_t)n;
    }
    return *at == '\0' || (*moves && at[0] == '\n' && at[1] == '\0');
}

/* False where the key does more than move, and changes the state then. */
static bool show_one(const struct key_event *event, struct pilot_state *state,
                     const struct pilot_host *host, struct buf *line, struct buf *message)
{
    struct pilot_state next = *state;
    struct pilot_facts facts;
    uint32_t place[3];
    bool moves;
    buf_clear(line);
    if (event->key == KEY_MOUSE || !pilot_only_moves(&next, event) ||
        !host->facts(host->context, &facts) ||
        pilot_press(&next, event, host, &facts, line, message) != PILOT_NOTHING ||
        next.mode != state->mode || !only_moves(line, place, &moves))
        return false;
    *state = next;
    if (moves)
        host->peek(host->context, place);
    return true;
}

void typed_ahead_show(const struct typed_ahead *ahead, struct pilot_state *state,
                      const struct pilot_host *host)
{
    struct buf line = {0}, message = {0};
    for (size_t i = ahead->taken; i < ahead->count; i++)
        if (!show_one(ahead->event + i, state, host, &line, &message))
            break;
    buf_release(&line);
    buf_release(&message);
}
