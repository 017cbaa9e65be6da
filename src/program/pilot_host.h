/*
 * The pilot's host (tui/pilot/pilot.h): answers what the pilot asks from the interpreter's session.
 * What changes anything goes to the interpreter as a line.
 */
#ifndef PROGRAM_PILOT_HOST_H
#define PROGRAM_PILOT_HOST_H

#include "command/interpreter.h"
#include "program/console.h"
#include "program/pilot_notes.h"
#include "engine/way.h"
#include "session/session.h"
#include "tui/pilot/pilot.h"

struct pilot_interpreter {
    struct interpreter *interp;
    bool smooth;                              /* all bits of every colour, where the terminal can */
    struct canvas canvas;                     /* the last picture, */
    struct slicing_panel panel;               /* what it is of, */
    struct canvas beyond;                     /* a slice that was sent ahead, */
    struct raster_box around;                 /* all of it */
    struct image_note note[PILOT_NOTES_MOST]; /* and what is written over it */
    struct raster_box slice[3];               /* where the slices are in it */
    struct held held;                         /* what was asked for last, until the next command, */
    struct way way;                           /* and the path that was */
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
