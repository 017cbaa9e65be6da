/*
 * Text in HTML and XML. The one way by which bytes from outside reach a report.
 */
#ifndef VERIFY_MARKUP_H
#define VERIFY_MARKUP_H

#include "base/buf.h"

/* Adds text that stands between tags or in an attribute between double or single quotes: what is
 * not printable UTF-8 as \xNN, as on a terminal (base/safe.h), so that XML allows what is left;
 * then & < > " ' as entities. A line feed stays one. */
void markup_add(struct buf *out, const char *text);

#endif
