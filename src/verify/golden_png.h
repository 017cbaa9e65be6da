/*
 * The PNG beside a golden image, which people look at: what is shown has to be what was compared.
 * Each pixel is that of the golden image, its colours over their background; each text is a note of
 * the golden image, or says when the PNG was drawn; and nothing else is in it (image/png_read.h).
 * Every verification asks for that, so what proves the golden image, a lock or a signature of the
 * journal, proves the PNG.
 *
 * One that is not there shows nothing: only a lock, which pins its bytes, asks for it.
 */
#ifndef VERIFY_GOLDEN_PNG_H
#define VERIFY_GOLDEN_PNG_H

#include "command/golden_judge.h"
#include "command/interpreter.h"

/* OK, or ERR_CHECK. The finding is of a golden image that is the same as what is drawn. */
enum err golden_png_check(struct interpreter *interp, const struct golden_finding *finding,
                          struct fault *fault);

#endif
