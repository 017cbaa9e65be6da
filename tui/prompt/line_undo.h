/*
 * What was done to a line, so that it can be taken back step by step, the last step first.
 *
 * A step says where the text changed, how much was added there, and holds what was removed: taking
 * it back puts that in the place of what was added. What is typed up to the next word is one step,
 * and so are characters erased one after another, and older lines looked through.
 *
 * Bounded: the oldest steps go when there are LINE_UNDO_MOST, or what they hold is more than
 * LINE_UNDO_BYTES. A step that cannot be held, for its size or for the lack of memory, takes all
 * before it along, since they would no longer fit the text.
 */
#ifndef TUI_PROMPT_LINE_UNDO_H
#define TUI_PROMPT_LINE_UNDO_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"

enum { LINE_UNDO_MOST = 1000, LINE_UNDO_BYTES = 1 << 20 };

struct line_change {
    size_t at;             /* bytes before it in the text */
    size_t removed, added; /* bytes */
    size_t cursor;         /* before the change */
};

/* `struct line_undo u = {0}` is empty and ready. */
struct line_undo {
    struct line_change *change; /* the oldest first */
    size_t count, capacity;
    struct buf removed; /* by all of them, in their order */
};

/* Whether a change is a step of its own, or more of the last one, where it fits that. */
enum line_step {
    STEP_NEW,
    STEP_TYPED,  /* added where the last addition ended */
    STEP_ERASED, /* removed right before or right after what was removed last */
    STEP_OVER    /* in the place of all that the last step added */
};

void line_undo_note(struct line_undo *u, const struct line_change *change, const char *removed,
                    enum line_step step);

/* Takes the last step off: *removed is what to put back, valid until the next note. False where
 * there is none. */
bool line_undo_take(struct line_undo *u, struct line_change *change, const char **removed);

void line_undo_clear(struct line_undo *u);
void line_undo_release(struct line_undo *u);

#endif
