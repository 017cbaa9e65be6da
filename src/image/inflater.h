/*
 * An inflater: the bytes of a gzip file from its beginning on, by ISA-L.
 *
 * It is three times as fast as zlib (as fast as libdeflate, which can only inflate a file as a
 * whole), and has no words for what is wrong with a file: where it fails, zlib is asked again
 * (image/source.h). A file of several streams, one after another, is all of them.
 */
#ifndef IMAGE_INFLATER_H
#define IMAGE_INFLATER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct inflater;

/* Of a file that is open, and stays open and the caller's; where in it others read, is theirs. NULL
 * without memory, or where iftty was built without ISA-L. */
struct inflater *inflater_new(int fd);
void inflater_free(struct inflater *inflater);

/* The next bytes into `to`, or nowhere (NULL). Returns how many: fewer than `most` where the last
 * stream has ended with the right checksum, or where anything is wrong. */
size_t inflater_take(struct inflater *inflater, void *to, size_t most);

/* Whether the last stream has ended, with the right checksum. */
bool inflater_has_ended(const struct inflater *inflater);

#endif
