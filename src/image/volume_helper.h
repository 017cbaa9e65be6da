/* SPDX-License-Identifier: MIT */
/*
 * The volume helper: every volume that no reader of our own takes, by ITK, GDCM and HDF5 in a
 * process of its own.
 *
 * The program iftty-volume is started for one file or folder, takes from itself all but reading
 * that one and what its header names below its folder (Landlock, seccomp, limits), and ends with
 * it. What it says is believed no more than the file: sizes are checked before anything is
 * allocated, numbers before they are used, and its words are its own; nothing that a file says in
 * words (a patient's name, a date) comes out of it, but names of data sets, and of files that a
 * header names and that are not read, and, for the user who is to choose a series, their
 * descriptions. Files of a folder are named where something is wrong with them.
 *
 * The protocol, as in coprocess.h:
 *
 *     request   open KIND FLAGS SERIES VOLUME WORD_LENGTH SKIP_LENGTH DATA_LENGTH ROOM_LENGTH
 *                 PATH_LENGTH\n
 *                 word  skip  data  room  path
 *     answer    any number of
 *                 progress DONE TOTAL\n
 *               and then any of these, once
 *                 series NUMBER\n
 *                 list LENGTH\n  lines
 *                 contents LENGTH\n  words
 *               and then
 *                 volume NX NY NZ VOLUMES KNOWN FORMAT_LENGTH TYPE_LENGTH NOTES_LENGTH\n
 *                   format  type  notes  14 numbers
 *               or
 *                 error LENGTH\n  words
 *     request   voxels\n
 *     answer    any number of
 *                 piece LENGTH\n  bytes
 *               up to the last voxel, or an error
 *
 * KIND is a word of the table in volume_helper.c. FLAGS: 1 links in a folder are followed, 2 blank
 * slices take the place of those that are missing, 4 there may be a list of series or of volumes,
 * in which their files have words, 8 mosaics are one slice, and damaged files of a folder are left
 * out, 16 a file whose voxels lie in others, or may, is refused, and so is one of many data sets,
 * 32 of NRRD in left-anterior-superior x is turned, and y is not.
 * SERIES counts from 1, 0 is for the only one, or for the one of whose description the word is a
 * piece; an answer says its NUMBER. The skip are names of files that are left out, with commas
 * between them. VOLUME counts from 0; the data are the name of a
 * data set, the room a folder that the helper may write into, if any, which the client removes.
 * KNOWN: 1 the spacing, 2 the place, 4 its voxels may be packed more closely than gzip packs.
 * The numbers are doubles of this machine: the three rows of the matrix to the world (right,
 * anterior, superior; millimetres), slope and intercept. Voxels are of the type, in the order of
 * this machine, x fastest.
 */
#ifndef IMAGE_VOLUME_HELPER_H
#define IMAGE_VOLUME_HELPER_H

#include <stdbool.h>
#include <stdint.h>

#include "image/volume_format.h"

#define VOLUME_HELPER "iftty-volume" /* the program (coprocess_find) */

/* For formats of our own, which hand on what they do not read: of volume_format, these two. */
enum err volume_helper_read_header(struct volume_header *out, struct volume_source *source,
                                   struct fault *fault);
enum err volume_helper_begin_voxels(const struct volume_header *header,
                                    struct volume_source *source, struct fault *fault);

/* For tests: another program, NULL for iftty-volume beside the running one; and how long it may
 * stay silent, apart from a second for each 20 MB of voxels. */
extern const char *volume_helper_program;
extern int volume_helper_patience_ms;

/* For the journals of others: bytes that it may hold (0: what is free), and whether links inside a
 * folder are left alone. */
extern uint64_t volume_helper_memory_most;
extern bool volume_helper_is_wary;

/* Whether nothing is read where the kernel does not confine the helper. */
extern bool volume_helper_needs_landlock;

#endif
