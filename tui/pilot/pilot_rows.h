/*
 * The text that the pilot writes: two rows below the picture, and pages. Pure.
 *
 * The upper row tells where the cross-hair is, what a key would plant and what waits, then the
 * voxel: a narrow screen cuts off what can be missed first. The lower one has the last message, or
 * what the keys do now. A message of more than a row takes both, until the next key.
 */
#ifndef TUI_PILOT_PILOT_ROWS_H
#define TUI_PILOT_PILOT_ROWS_H

#include "tui/pilot/pilot_keys.h"
#include "tui/term.h"

enum { PILOT_ROWS = 2 };

/* Adds both rows, at the foot of a screen of this size. */
void pilot_rows_add(struct buf *out, const struct pilot_state *state, const struct pilot_host *host,
                    const struct pilot_facts *facts, const struct buf *message,
                    const struct term_size *size);

/* Adds the keys, from the top of the screen. */
void pilot_rows_add_help(struct buf *out);

/* Adds what one screen of this size shows of a text that cells_wrap has broken, from byte *at on,
 * and below it which key goes on; *at is then where the next screen begins. */
void pilot_rows_add_page(struct buf *out, const struct buf *text, size_t *at,
                         const struct term_size *size);

#endif
