/* SPDX-License-Identifier: MIT */
/*
 * iftty: segment 3-D scenes by seeds, in a terminal.
 *
 * The programs are in program/program_table.c, each with the function that runs it. Exit status: 0
 * success, 1 a check failed or `apply` rejected a scene, 2 bad usage, 3 bad input or I/O, 130
 * Ctrl-C (base/err.h).
 */
#include "program/program.h"

int main(int count, char **word)
{
    struct options options = {.words = 0};
    return program_main(&program_table, count, word, &options);
}
