/* SPDX-License-Identifier: MIT */
/* Units of length by the names that files have for them. */
#ifndef IMAGE_UNITS_H
#define IMAGE_UNITS_H

/* The names, for messages. */
#define LENGTH_UNITS "pm, angstrom, nm, um, mm, cm, dm, m, in"

/* Millimetres in a unit: "um", "\u00b5m" in UTF-8 or Latin-1, "micrometers"; small and capital
 * letters are the same. 0 where the name is not known: a length is never guessed. */
double length_mm(const char *name);

#endif
