/* SPDX-License-Identifier: MIT */
/* What is said of a step, in lines that are safe to print; and what the whole has come to. */
#ifndef STEPS_STEP_WORDS_H
#define STEPS_STEP_WORDS_H

#include "steps/walkthrough.h"

/* "step 12 of 431, record 15: seed 67,119,76 1 radius=3", with "undone later" or "on another
 * alternative" where it does not stand. Step 0 is the beginning. */
void step_words_title(struct buf *out, const struct walkthrough *w, size_t step);

/* "1 brain +12.4 ml, 0 -12.4 ml; 12 345 voxels", of a step that was carried out; "no voxel has
 * another label", and "12 edits wait" where they do. */
void step_words_change(struct buf *out, const struct walkthrough *w, size_t step);

/* So many voxels of the session's scene, as a volume where its spacing is known. */
void step_words_volume(struct buf *out, const struct walkthrough *w, uint64_t voxels);

/* The comments of a step, lines; "" where it has none. */
void step_words_comments(struct buf *out, const struct walkthrough *w, size_t step);

/* One line: "verified: 494 commands carried out again, 480 results the same", "NOT verified: ..",
 * or how far the replay has come. */
void step_words_verdict(struct buf *out, const struct walkthrough *w);

#endif
