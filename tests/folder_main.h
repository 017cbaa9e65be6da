/* SPDX-License-Identifier: MIT */
/* The main of a test program with a folder for its files: make the folder, run the stories, remove
 * it. Defined before this is included:
 *
 *     RUN_IN_FOLDER     the folder is the working directory of the stories
 *     ONLY_LEAVES       an expression of grep -E: another name in it, after all stories, is a
 *                       failure
 *     BEFORE_STORIES    a statement that is executed before them */
#ifndef TESTS_FOLDER_MAIN_H
#define TESTS_FOLDER_MAIN_H

#include "tests/check.h"
#include "tests/folder.h"

static char folder[FOLDER_LENGTH];

int main(void)
{
    if (!make_folder(folder, "test"))
        return 1;
#ifdef BEFORE_STORIES
    BEFORE_STORIES;
#endif
#ifdef RUN_IN_FOLDER
    if (chdir(folder) != 0)
        return 1;
#endif
    int status = check_run();
#ifdef ONLY_LEAVES
    char command[FOLDER_LENGTH + 256];
    snprintf(command, sizeof command, "! ls -A '%s' | grep -vxE '%s'", folder, ONLY_LEAVES);
    status |= system(command) != 0;
#endif
    return status | remove_folder(folder);
}

#endif
