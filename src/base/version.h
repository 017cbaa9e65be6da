/* SPDX-License-Identifier: MIT */
/* Of the program, as `iftty --version`, pictures and records have it. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define PROGRAM_VERSION "1.0"
#define PROGRAM_DATE    "2026-11-28" /* of this version: pages of the manual and packages have it */

#endif
