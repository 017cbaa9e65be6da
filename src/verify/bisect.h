/* SPDX-License-Identifier: MIT */
/* The first record in which two journals differ. Nothing is carried out. */
#ifndef VERIFY_BISECT_H
#define VERIFY_BISECT_H

#include "command/script.h"

/* Prints TAP of one test. OK when both give the same, ERR_CHECK with the first that differs when
 * not, ERR_INPUT for a journal that is not sound. */
enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault);

#endif
