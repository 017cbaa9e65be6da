/* SPDX-License-Identifier: MIT */
/*
 * The image helper: all image formats except OpenEXR and written PNG, by OpenImageIO in a separate
 * process.
 *
 * OpenImageIO has no C interface and loads some 260 shared libraries, so the program iftty-image
 * contains it, which starts on first use. A decoder that crashes on a hostile file costs one error
 * message; the next request starts a new helper.
 *
 * The protocol, on the helper's standard input and output (a socket pair), one request and one
 * answer at a time. Numbers are decimal without sign or leading zeros; \n is one line feed;
 * everything else is counted bytes without an end mark.
 *
 *     request   write PATH_LENGTH WIDTH HEIGHT NOTES FRAMES DELAY CHANNELS\n
 *                                  path  notes  FRAMES * WIDTH * HEIGHT * CHANNELS bytes
 *               read PATH_LENGTH\n                      path
 *               about PATH_LENGTH\n                     path
 *     note      NAME_LENGTH VALUE_LENGTH\n              name  value
 *     answer    ok\n
 *               picture WIDTH HEIGHT NOTES\n            notes  WIDTH * HEIGHT * 4 bytes RGBA
 *               about WIDTH HEIGHT FRAMES NOTES FORMAT_LENGTH TYPE_LENGTH CHANNELS_LENGTH\n
 *                                  format  type  channels  notes
 *               error LENGTH\n                          words
 *
 * Rows run from the top. Sides are 1..16384, a path or name is at most 4096 bytes, a value at most
 * 1048576, notes at most 1024; frames are 1..1000, and DELAY is the time of each, 0..60000 ms.
 * CHANNELS are 3, RGB, or 4, RGBA. A request that breaks these rules ends the helper. A worked
 * example, a red pixel with one note:
 *
 *     write 5 1 1 1 1 0 3\na.png4 3\nviewtop\xff\x00\x00    ->  ok\n
 *     read 5\na.png      ->  picture 1 1 1\n4 3\nviewtop\xff\x00\x00\xff
 *
 * The helper executes each request in a child process, which can access that file alone (wire.hh).
 * Nothing here raises SIGPIPE or waits without a limit: a helper that is silent for
 * image_helper_patience_ms is killed.
 */
#ifndef IMAGE_IMAGE_HELPER_H
#define IMAGE_IMAGE_HELPER_H

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

#define IMAGE_HELPER "iftty-image" /* the program (coprocess_find) */

struct image_helper;

/* Create a client of the helper at the path `program`; NULL: of iftty-image (coprocess_find). It is
 * not started yet. */
enum err image_helper_new(struct image_helper **helper, const char *program, struct fault *fault);

/* Start it, unless it runs, for a caller that will need it soon: it loads its libraries in some
 * 160 ms. Every request starts it too. */
enum err image_helper_start(struct image_helper *helper, struct fault *fault);

/* End the helper, if it runs, and wait for it. */
void image_helper_free(struct image_helper *helper);

/* Write `picture` as `path`, atomically: .exr with all planes and .png by their formats of
 * strips, every other extension by the helper: the visible colours, and notes. A clear picture has
 * its alpha in PNG and TIFF, and is over black in other formats. Notes are lines "name: value" of
 * the image description, if a format has one. The same picture has the same bytes. */
enum err image_write(struct image_helper *helper, const char *path, enum file_mode mode,
                     const struct picture *picture, struct fault *fault);

/* The format that writes a file of this name while its picture is drawn; NULL for formats of the
 * helper. */
const struct strips_format *image_strips(const char *path);

/* For programs whose long work ends in one picture: check before the work that `path` (NULL: no
 * picture) is the name of a .png that can be written and does not exist; after it, write the
 * picture with a new helper. */
enum err image_check_png(const char *path, struct fault *fault);
enum err image_write_png(const char *path, const struct picture *picture, struct fault *fault);

/*
 * Write a file by the image helper, step by step: one picture, or an animation of several pictures
 * of one size.
 *
 * Frames are sent to the helper as they are drawn, so only one is in memory. The file is published
 * atomically, with all its frames. The helper compresses while the caller continues;
 * image_movie_end waits for it. Every viewer shows GIF, which has 256 colours for each frame; TIFF
 * has every colour, as pages.
 */
enum { IMAGE_FRAMES_MOST = 1000 };
struct image_movie {
    struct image_helper *helper; /* set by the caller, as the next two */
    const char *path;            /* not owned */
    enum file_mode mode;
    unsigned channels; /* zero before image_movie_begin, as the draft */
    struct buf draft;
};

/* Endings of formats that hold several pictures. */
#define IMAGE_MOVIES ".gif|.tif|.tiff"

/* Begin a file of `frames` pictures, 1..IMAGE_FRAMES_MOST, each shown for `delay_ms`, with the size
 * and the notes of `like`. An error of this and the next two functions removes the file. */
enum err image_movie_begin(struct image_movie *movie, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault);
enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault);
enum err image_movie_end(struct image_movie *movie, struct fault *fault); /* after all frames */

/* Abandon an unfinished movie, and end the helper, which the next request starts again. No effect
 * on a finished or zeroed movie. */
void image_movie_abandon(struct image_movie *movie);

/* Read the first image of `path`, in any format, as 8 bits per channel. On failure *out is empty.
 */
enum err image_helper_read(struct image_helper *helper, const char *path, struct picture *out,
                           struct fault *fault);

/* Facts about a file, in any format. Its first image is decoded, so a file cut short is an error.
 * The texts are copied from the file: not safe to print. */
struct image_facts {
    struct picture picture; /* sides and notes, no pixels */
    unsigned frames;
    char *format, *type, *channels; /* "png", "uint8", "R,G,B" */
};
enum err image_helper_about(struct image_helper *helper, const char *path, struct image_facts *out,
                            struct fault *fault);
void image_facts_release(struct image_facts *facts);

/* Time limit for a silent helper; tests reduce it. */
extern int image_helper_patience_ms;

/* Limit of a helper's own memory in bytes, from the next start, without its program and libraries;
 * 0: the free memory. A helper with all libraries uses 150 MB, and 350 MB for the largest picture
 * that is written. Beyond the limit the request fails, or the helper ends. */
extern uint64_t image_helper_memory_most;

#endif
