/* SPDX-License-Identifier: MIT */
/* The main of a test program that needs no set-up: run its stories. */
#ifndef TESTS_CHECK_MAIN_H
#define TESTS_CHECK_MAIN_H

#include "tests/check.h"

int main(void)
{
    return check_run();
}

#endif
