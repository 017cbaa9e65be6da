/* SPDX-License-Identifier: MIT */
/* Of the program, as `iftty --version`, pictures and records have it. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define PROGRAM_VERSION "0.1"
#define PROGRAM_DATE    "2026-11-24" /* of this version: pages of the manual and packages have it */

#endif
