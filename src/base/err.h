/* SPDX-License-Identifier: MIT */
/*
 * Errors: one list of codes, and one line of text that a user can act on.
 *
 * A fallible function returns `enum err` and may fill a `struct fault`: the mistake, the expected
 * value, the state that is unchanged. Callers prepend their context (fault_prefix). No code below
 * main prints to the terminal or exits.
 */
#ifndef BASE_ERR_H
#define BASE_ERR_H

#include <stddef.h>

/* code, exit status of a program that ends with it, name */
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

/* The text of an error: one line without a line feed, already safe to print on a terminal. */
struct fault {
    enum err code;
    char text[512];
    size_t at; /* if the text is about a byte of a line that was read: its number, from 1; otherwise
                  0 */
};

/* Fill `fault` (which may be NULL) with a printf-like text, with `at` 0, and return `code`. Bytes
 * from file names, headers and journals that a terminal would obey are escaped. */
enum err fault_set(struct fault *fault, enum err code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Put a printf-like text and ": " before the text of `fault`; return fault->code, or `code` if
 * `fault` is NULL. Change nothing and return OK if `code` is OK. */
enum err fault_prefix(struct fault *fault, enum err code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Append words to the text of `fault` (which may be NULL) if there is room for all of them. */
void fault_append(struct fault *fault, const char *words);

/* Report errno after `what` on `path`: "cannot open ch2.nii: No such file or directory". */
enum err fault_errno(struct fault *fault, const char *what, const char *path);

/* Report that memory ran out, and its purpose. */
enum err fault_memory(struct fault *fault, const char *purpose);

/* Return the error of a call, if it fails, from the function that makes the call. Locals that own
 * memory or a file are declared with OWNED (base/mem.h), so this return releases them too. */
#define TRY(call)                                                                                  \
    do {                                                                                           \
        const enum err err_of_call = (call);                                                       \
        if (err_of_call)                                                                           \
            return err_of_call;                                                                    \
    } while (0)

int err_exit_status(enum err code);
const char *err_name(enum err code);

#endif
