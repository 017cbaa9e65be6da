/*
 * The steps of the file layer that can fail: open, write, sync, cut. For base/file.c,
 * base/file_log.c and base/file_lines.c alone; each asks file_step_hook (base/file.h) first, so that tests reach every
 * one of them.
 */
#ifndef BASE_FILE_STEPS_H
#define BASE_FILE_STEPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A descriptor that no child inherits, or -1 and errno. */
int file_step_open(const char *path, int flags);

/* All of `length` bytes, or false and errno; then some of them may have been written. */
bool file_step_write(int fd, const char *path, const char *bytes, size_t length);

/* What was written to `fd` is on the disk, or false and errno. */
bool file_step_sync(int fd, const char *path);

/* Syncs the folder that holds `path`, so that a new name in it survives. File systems that cannot
 * sync a folder answer EINVAL; there is nothing more to do on those. */
bool file_step_sync_folder(const char *path);

/* Cuts the file to `length` bytes, or false and errno. */
bool file_step_cut(int fd, const char *path, uint64_t length);

#endif
