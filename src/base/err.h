/* SPDX-License-Identifier: MIT */
/*
 * Errors: one list of codes, and one line of words that a user can act on.
 *
 * A fallible function returns `enum err` and may fill a `struct fault`: what was wrong, what was
 * expected, what is unchanged. Words gather on the way up (fault_prefix). Nothing below main
 * prints to the terminal or exits.
 */
#ifndef BASE_ERR_H
#define BASE_ERR_H

#include <stddef.h>

/* code, exit status of a program that ends with it, what it is called */
#define ERR_LIST(X)                                                                                \
    X(OK, 0, "fine")                                                                               \
    X(ERR_CHECK, 1, "check failed")                                                                \
    X(ERR_USAGE, 2, "bad usage")                                                                   \
    X(ERR_INPUT, 3, "bad input")                                                                   \
    X(ERR_IO, 3, "input or output failed")                                                         \
    X(ERR_MEMORY, 3, "out of memory")                                                              \
    X(ERR_LIMIT, 3, "beyond a limit")                                                              \
    X(ERR_CANCELLED, 130, "cancelled")

enum err {
#define ERR_CODE(code, status, name) code,
    ERR_LIST(ERR_CODE)
#undef ERR_CODE
};

/* The words of an error: one line without a line feed, already safe to print on a terminal. */
struct fault {
    enum err code;
    char text[512];
    size_t at; /* where they are about a byte of a line that was read: which, from 1; else 0 */
};

/* Fills `fault` (which may be NULL) with printf-like words, at no byte, and returns `code`. Bytes
 * that a terminal would obey (from file names, headers, journals) come out escaped. */
enum err fault_set(struct fault *fault, enum err code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts printf-like words and ": " before those already in `fault`; returns fault->code,
 * or `code` when `fault` is NULL. */
enum err fault_prefix(struct fault *fault, enum err code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts words after those in `fault` (which may be NULL), where there is room for all of them. */
void fault_append(struct fault *fault, const char *words);

/* The words of errno after `what` on `path`: "cannot open ch2.nii: No such file or directory". */
enum err fault_errno(struct fault *fault, const char *what, const char *path);

/* Out of memory, in words that say what the memory was for. */
enum err fault_memory(struct fault *fault, const char *purpose);

int err_exit_status(enum err code);
const char *err_name(enum err code);

#endif
