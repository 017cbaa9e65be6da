/* SPDX-License-Identifier: MIT */
/* What is shown of a session: the picture of the last command, and the colours that it needs. */
#ifndef PROGRAM_SHOWN_H
#define PROGRAM_SHOWN_H

#include "command/interpreter.h"
#include "tui/picture/image_view.h"

/* The colours of the labels that can show, and of the background, which is a shade of one too, for
 * a palette; how many. */
unsigned shown_hues(uint32_t hue[256], const struct session *session);

/* The picture that the last command had shown, else the rendition. `smooth`: in all bits, where the
 * terminal can. Its pixels belong to the interpreter, its colours to this file, until the next. */
struct image_view shown_picture(struct interpreter *interp, bool smooth);

#endif
