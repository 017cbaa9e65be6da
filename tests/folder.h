/* SPDX-License-Identifier: MIT */
/* The folder that a test program works in, and leaves nothing of. It lies below $TMPDIR, which
 * tests/run.sh sets for each program; for a program that is run by hand, in memory where there is
 * such a place. */
#ifndef TESTS_FOLDER_H
#define TESTS_FOLDER_H

#include <dirent.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"

/* A folder's name; the name of a file in it. */
enum { FOLDER_LENGTH = 160, FILE_LENGTH = FOLDER_LENGTH + 272 };

/* Makes a folder with `word` in its name; false, with a comment, where that cannot be. */
static inline bool make_folder(char folder[FOLDER_LENGTH], const char *word)
{
    const char *below = getenv("TMPDIR");
    if (!below || !*below)
        below = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    const int length = snprintf(folder, FOLDER_LENGTH, "%s/iftty-%s-XXXXXX", below, word);
    if (length < FOLDER_LENGTH && mkdtemp(folder))
        return true;
    printf("# no folder can be made below %s\n", below);
    return false;
}

/* The path of a file in a folder; good until the fourth call after. */
static inline const char *file_in(const char *folder, const char *name)
{
    static char path[4][FILE_LENGTH];
    static unsigned next;
    char *at = path[next++ % 4];
    snprintf(at, FILE_LENGTH, "%s/%s", folder, name);
    return at;
}

/* Writes a shell script that can be run; its path, as of file_in. */
static inline const char *make_script(const char *folder, const char *name, const char *text)
{
    const char *path = file_in(folder, name);
    FILE *out = fopen(path, "we");
    if (!out || fprintf(out, "#!/bin/sh\n%s\n", text) < 0 || fclose(out) != 0 ||
        chmod(path, 0700) != 0)
        printf("# %s cannot be written\n", path);
    return path;
}

/* The path of a program of this build. Static storage; good until the next call. */
static inline const char *built_program(const char *name)
{
    static char path[FILE_LENGTH];
    const char *build = getenv("IFTTY_BUILD");
    snprintf(path, sizeof path, "%s/%s", build ? build : "build", name);
    return path;
}

/* For OWNED(listing_release) DIR *listing = opendir(folder). */
static inline void listing_release(DIR **listing)
{
    if (*listing)
        closedir(*listing);
}

/* The number of names in a folder, without "." and "..", that begin so. */
static inline unsigned count_names(const char *folder, const char *prefix)
{
    OWNED(listing_release) DIR *listing = opendir(folder);
    unsigned count = 0;
    for (const struct dirent *entry; listing && (entry = readdir(listing));)
        count += strncmp(entry->d_name, prefix, strlen(prefix)) == 0 &&
                 strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    return count;
}

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
