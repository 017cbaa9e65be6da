/* JSON texts out of bytes that are not ours. */
#ifndef BASE_JSON_H
#define BASE_JSON_H

#include "base/buf.h"

/* Adds `length` bytes as a JSON string. What safe_character (base/safe.h) does not let pass comes
 * out as \u00NN, byte by byte, so that the outcome is valid JSON and safe to print. */
void json_add_text(struct buf *out, const char *text, size_t length);

#endif
