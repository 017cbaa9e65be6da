/* The folder that a test program works in, and leaves nothing of. */
#ifndef TESTS_FOLDER_H
#define TESTS_FOLDER_H

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

/* Removes a folder with all below it; 1, with a comment, where something is left. */
static inline int remove_folder(const char *folder)
{
    char command[PATH_MAX + 16];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    if (system(command) == 0)
        return 0;
    printf("# %s is left behind\n", folder);
    return 1;
}

#endif
