/* SPDX-License-Identifier: MIT */
/* Version of the program, as in `iftty --version`, pictures and records. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define PROGRAM_VERSION "1.0"
#define PROGRAM_DATE    "2026-11-28" /* its date, for manual pages and packages */

#endif
