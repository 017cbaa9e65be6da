/*
 * The pilot's host: a desk, seen from the cockpit (tui/pilot.h). It turns what the pilot asks into
 * looks at the session; whatever changes goes through the desk's one door, as a line.
 */
#ifndef HOST_PILOT_HOST_H
#define HOST_PILOT_HOST_H

#include "command/desk.h"
#include "tui/pilot.h"

struct pilot_desk {
    struct desk *desk;
    bool smooth;          /* all bits of every colour, where the terminal can */
    struct canvas canvas; /* the last picture */
    uint32_t hue[256];
};

/* Fills in all of a host but its context, execute and finished. The context that
 * these functions are given begins with a struct pilot_desk. */
void pilot_host_fill(struct pilot_host *host);

/* The colours of the labels that can show, for a palette; how many. */
unsigned pilot_hues(uint32_t hue[256], const struct session *session);

void pilot_desk_release(struct pilot_desk *pilot);

#endif
