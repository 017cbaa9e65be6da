/* SPDX-License-Identifier: MIT */
/*
 * The pilot's host where one watches: a walk through a journal (steps/walkthrough.h), by lines that
 * keys of the pilot stand for.
 *
 *     step on N    step back N    step to N    step to last    step due
 *     step play    step faster    step slower
 *     step next [LABEL]    step previous [LABEL]    step largest
 *     step undone    step comments
 *
 * A step that is gone on to is drawn first, and carried out a moment later, by the next key or by
 * `step due`; what it changed is then hatched for a moment. Any other line is carried out where it
 * only looks or asks (interpreter_look). With a quiz, a step that plants is asked for before it is
 * drawn, and a line that plants is the answer.
 */
#ifndef PROGRAM_WATCH_HOST_H
#define PROGRAM_WATCH_HOST_H

#include "program/pilot_host.h"
#include "steps/own_turn.h"
#include "steps/walkthrough.h"

struct watching {
    struct pilot_interpreter pilot; /* first, as pilot_host.h wants it */
    struct walkthrough walk;
    struct reply reply;
    bool is_over_end; /* all records have been carried out, and the verdict is shown */
    bool skips;       /* what does not stand is not shown */
    bool is_hatched;  /* what the step has changed is */
    bool plays;
    unsigned speed;  /* quarters */
    uint64_t due_ns; /* of `step due`; 0: never */

    bool asks;                  /* a quiz */
    bool is_asked, is_answered; /* at the step after the one that is shown; of the one that is */
    struct own_turn turn;
    struct own_turns turns;
};

/* Fills in the host, whose context is `watching`; its interpreter has begun to walk. */
void watch_host_fill(struct pilot_host *host, struct watching *watching);
void watching_release(struct watching *watching);

#endif
