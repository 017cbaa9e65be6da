/* SPDX-License-Identifier: MIT */
/*
 * CSA: the private header of Siemens scanners, with facts that DICOM has no element for.
 *
 * It is binary, little-endian and untrusted: each count and length is checked against the bytes
 * that exist. Only its second version is read, written by scanners since 2004; the first one has no
 * plain lengths.
 *
 *     "SV10"  4 bytes  number of elements  77
 *     of each element
 *         name[64]  number of values  type[4]  a number  number of items  77 or 205
 *         of each item
 *             a number  LENGTH  77 or 205  a number
 *             LENGTH bytes of text, padded to a multiple of 4
 *
 * Numbers have 4 bytes, texts end with a NUL. Items beyond the number of values are empty.
 * (nibabel, doc/source/dicom/siemens_csa.rst.)
 */
#ifndef IMAGE_CSA_H
#define IMAGE_CSA_H

#include <stddef.h>
#include <stdint.h>

/* Read the first `most` values of the element `name`, as finite numbers. Return their count, up to
 * the first item that is no number; 0 if there is no such element; -1 if the bytes are no such
 * header or are cut before its end. */
int csa_numbers(double *out, int most, const uint8_t *bytes, size_t length, const char *name);

#endif
