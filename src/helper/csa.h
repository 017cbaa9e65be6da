/* SPDX-License-Identifier: MIT */
/*
 * CSA: the private header in which Siemens scanners say of a picture what DICOM has no place for.
 *
 * It is binary, little-endian, and a stranger's: each count and length is held against the bytes
 * that are there. Its second kind alone is read, which scanners have written since 2004; the first
 * one does not say its lengths plainly.
 *
 *     "SV10"  4 bytes  number of elements  77
 *     of each element
 *         name[64]  how many values it has  type[4]  a number  number of items  77 or 205
 *         of each item
 *             a number  LENGTH  77 or 205  a number
 *             LENGTH bytes of text, and up to 3 to a multiple of 4
 *
 * Numbers have 4 bytes, texts end at a NUL. More items may be there than values: those are empty.
 * (nibabel, doc/source/dicom/siemens_csa.rst.)
 */
#ifndef IMAGE_CSA_H
#define IMAGE_CSA_H

#include <stddef.h>
#include <stdint.h>

/* The first `most` values of the element `name`, as finite numbers; how many there are of those, up
 * to the first item that is none. 0 where there is no such element; -1 where the bytes are no such
 * header, or are cut short before it ends. */
int csa_numbers(double *out, int most, const uint8_t *bytes, size_t length, const char *name);

#endif
