/* SPDX-License-Identifier: MIT */
/*
 * The steps of a journal as pictures, and a page of HTML that shows them: for each step what was
 * there before, the gesture, and what it led to.
 *
 *     DIR/index.html        without a script, and with nothing to be fetched but the pictures
 *     DIR/step-12-1.png     before; -2 the gesture, where it was made at a place; -3 after, with
 *                           what changed hatched, where anything did
 *
 * Names in the page are numbers alone; what a journal says stands there as text, escaped.
 */
#ifndef STEPS_STEP_PAGES_H
#define STEPS_STEP_PAGES_H

#include "steps/walkthrough.h"

struct step_pages {
    const char *folder; /* which is there, and empty */
    const char *title;  /* what the journal is called, which a private scene keeps back */
    size_t first, last; /* steps; 0: from the first on, to the last */
    struct watch *watch;
};

/* Writes them, the page last, whatever the replay comes to: *verdict is what ended it, OK where the
 * journal is verified. ERR_IO, ERR_LIMIT, ERR_CANCELLED, ERR_MEMORY; what was written stays then,
 * without a page. */
enum err step_pages_write(struct walkthrough *w, const struct step_pages *pages, enum err *verdict,
                          struct fault *fault);

#endif
