/* SPDX-License-Identifier: MIT */
/* The session at prompt and pilot that `iftty` and `iftty tutorial` have in common. */
#ifndef PROGRAM_PROMPT_H
#define PROGRAM_PROMPT_H

#include "program/program.h"

struct lesson;

/* On the scene or journal of the options; or with a lesson, whose scene it begins with. Then no
 * line is remembered from one time to the next, and nothing but the journal stays behind. */
enum err prompt_run(const struct options *o, struct lesson *lesson, struct fault *fault);

#endif
