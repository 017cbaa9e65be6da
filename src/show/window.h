/* SPDX-License-Identifier: MIT */
/*
 * The window: the intensities that slices, and faces that are cut open, show as black and white.
 * Real values become intensities here, above render/, so that pictures are drawn in integers alone.
 */
#ifndef SHOW_WINDOW_H
#define SHOW_WINDOW_H

#include "session/session.h"

/* Intensities of black and white; they differ. A scene whose values fall as intensities rise has
 * the greater one first. What follows from the scene is found once. */
void window_of(int32_t window[2], struct session *session);

/* The real values that are black and white. */
void window_values(double value[2], struct session *session);

/* The same in words: "0" and "142.5". */
enum { WINDOW_WORDS_BYTES = 32 };
void window_words(char least[WINDOW_WORDS_BYTES], char most[WINDOW_WORDS_BYTES],
                  struct session *session);

#endif
