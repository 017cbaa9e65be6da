/* SPDX-License-Identifier: MIT */
/*
 * GrowCut (Vezhnevets, Konouchine: "GrowCut", interactive multi-label N-D image segmentation by
 * cellular automata, Graphicon 2005), the plain method, for comparison.
 *
 * Each cell has a label and a strength, 1 at a seed and 0 elsewhere. A neighbour p conquers q where
 * g(|I(p) - I(q)|) * strength(p) > strength(q), with g(d) = 1 - d / 255: q then has its label and
 * that strength. Neighbours are the six by faces. The automaton ends where no cell changes; that
 * state is reached here by sweeps forth and back, in place, which leads to the same strengths as
 * all cells at once, in fewer rounds.
 */
#ifndef TESTS_BENCH_GROWCUT_H
#define TESTS_BENCH_GROWCUT_H

#include <stdint.h>

#include "base/err.h"

/* image[z][y][x]; marker: label + 1, or 0; label is filled: 0 where no seed reaches. */
enum err growcut(uint8_t *label, const uint8_t *image, const uint8_t *marker,
                 const uint32_t size[3], struct fault *fault);

#endif
