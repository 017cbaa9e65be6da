/* SPDX-License-Identifier: MIT */
/*
 * The pilot's host (tui/pilot/host.h): answers what the pilot asks from the interpreter's session.
 * What changes anything goes to the interpreter as a line.
 */
#ifndef PROGRAM_PILOT_HOST_H
#define PROGRAM_PILOT_HOST_H

#include "command/interpreter.h"
#include "program/console.h"
#include "show/voxel_facts.h"
#include "show/panes.h"
#include "tui/pilot/host.h"

struct pilot_interpreter {
    struct interpreter *interp;
    bool watches;       /* nothing is planted */
    bool smooth;        /* all bits of every colour, where the terminal can */
    struct panes panes; /* the last picture, */
    struct raster_box slice[PANES_SLICES], beyond; /* and where slices are in it, and beyond */
    struct held held;      /* what was asked for last, until the next command, */
    struct voxel_why why;  /* and the path that was */
    const uint8_t *former; /* labels [cells] before what is shown has changed them, or NULL */
    uint32_t hue[256];

    const struct pilot_onlooker *onlooker; /* while a command is carried out, or NULL */
    struct console_onlooker looks_on;
    uint32_t cross[3]; /* where the cross-hair is while it is shown elsewhere: */
    bool peeks;
};

/* Fills in all of a host but its context, execute and finished. The context that these functions
 * are given begins with a struct pilot_interpreter. */
void pilot_host_fill(struct pilot_host *host);

void pilot_interpreter_release(struct pilot_interpreter *pilot);

#endif
