/*
 * Folders of plain files, as golden images lie in: copied whole or not at all.
 */
#ifndef BASE_FOLDER_H
#define BASE_FOLDER_H

#include "base/err.h"

/* Makes the folder `to`, which must not exist, with a copy of every regular file in `from`, each
 * synced; folders within are left out. On failure there is no `to`. */
enum err folder_copy(const char *from, const char *to, struct fault *fault);

/* Removes a folder that folder_copy made. */
void folder_discard(const char *path);

#endif
