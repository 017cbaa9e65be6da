/* SPDX-License-Identifier: MIT */
/*
 * The register helper: registration by ITK, and transform files, in a process of its own.
 *
 * The program iftty-register is started for one request, takes all files and nearly all calls of
 * the kernel from itself before the first voxel comes (Landlock, seccomp, limits), and ends with
 * its answer. It opens no file: it gets voxels, decoded and bounded, or the bytes of a transform.
 * Its answers are checked: lengths and numbers.
 *
 * The protocol, as in coprocess.h:
 *
 *     request   register NX NY NZ NX NY NZ\n      the subject's scene, and the procedure's
 *                 12 numbers  voxels              of the one, and
 *                 12 numbers  voxels              of the other
 *     answer    any number of
 *                 progress DONE TOTAL\n
 *               and then
 *                 found\n  20 numbers
 *               or
 *                 error LENGTH\n  words
 *
 *     request   transform BYTES\n                of a file of ITK's transforms
 *                 bytes
 *     answer    transform LENGTH\n  kind  12 numbers
 *               or an error
 *
 * Numbers are doubles of this machine. Those of a request are the three rows of the matrix from
 * voxels to the world (right, anterior, superior; millimetres), its voxels are of 16 bits, x
 * fastest. Those found are the three rows of the map from the subject's world to the procedure's;
 * the metric of the map, of the identity, of the mirror image; what part of the subject's content
 * and of the procedure's lies in the other; agreement and length, in millimetres; and seconds.
 */
#ifndef REGISTER_REGISTER_HELPER_H
#define REGISTER_REGISTER_HELPER_H

#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "image/coprocess.h"

#define REGISTER_HELPER "iftty-register" /* the program (coprocess_find) */

/* For tests: another program, NULL for iftty-register beside the running one; and how long it may
 * stay silent. */
extern const char *register_helper_program;
extern int register_helper_patience_ms;

/* Starts one for `task` ("registration"), which may hold so many bytes, and may work for so many
 * milliseconds of the processor between two answers (0: as any coprocess). coprocess_release ends
 * it, after an error too. */
enum err register_helper_start(struct coprocess *out, const char *task, uint64_t bytes, int work_ms,
                               struct watch *watch, struct fault *fault);

/* Waits for the line `word`, and shows how far it is. */
enum err register_helper_await(struct coprocess *process, const char *word, struct fault *fault);

#endif
