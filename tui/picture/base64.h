/*
 * Bytes as text (RFC 4648): three bytes are four characters, padded with '='.
 */
#ifndef TUI_PICTURE_BASE64_H
#define TUI_PICTURE_BASE64_H

#include <stdint.h>

#include "base/buf.h"

/* Without memory out->failed is set. */
void base64_add(struct buf *out, const uint8_t *byte, size_t length);

#endif
