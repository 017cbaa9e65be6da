/*
 * Drawings made of lines of text, for where they go: as wide as they are into a file or a pipe, cut
 * at the edge of a terminal, which would break them in the middle.
 */
#ifndef TUI_CROP_H
#define TUI_CROP_H

#include <stdbool.h>

#include "base/buf.h"

/* The columns of the terminal that `fd` is; 0 where it is none, or does not say. */
unsigned crop_columns(int fd);

/* Whether the environment says that text is UTF-8: LC_ALL, else LC_CTYPE, else LANG. */
bool crop_locale_is_utf8(void);

/* Adds `text`, which is safe to print, with each line cut to `columns` cells, 0 for none cut. */
void crop_lines(struct buf *out, const char *text, unsigned columns);

#endif
