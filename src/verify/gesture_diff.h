/*
 * The journals of an expert and of a trainee compared by what each has done: kinds, places and
 * order of gestures (verify/gesture_match.h), and Dice over the steps (verify/gesture.h).
 *
 * Three processes one after the other, by the rules for the journals of others: the expert's, for
 * the labels that it ends with; again, for its own steps; and the trainee's.
 */
#ifndef VERIFY_GESTURE_DIFF_H
#define VERIFY_GESTURE_DIFF_H

#include "verify/diff.h"

/* Path 0 is the expert's, path 1 the trainee's. OK however far they differ; the errors of
 * gestures_carry_out and gesture_match_make. */
enum err gesture_diff(const struct diff_options *options, const struct printer *printer,
                      struct fault *fault);

#endif
