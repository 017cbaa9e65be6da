/* SPDX-License-Identifier: MIT */
/* The main of a test program with a folder for its files: make the folder, run the stories, remove
 * it. If RUN_IN_FOLDER is defined, the folder is the working directory of the stories. */
#ifndef TESTS_FOLDER_MAIN_H
#define TESTS_FOLDER_MAIN_H

#include "tests/check.h"
#include "tests/folder.h"

static char folder[FOLDER_LENGTH];

int main(void)
{
    if (!make_folder(folder, "test"))
        return 1;
#ifdef RUN_IN_FOLDER
    if (chdir(folder) != 0)
        return 1;
#endif
    const int status = check_run();
    return status | remove_folder(folder);
}

#endif
