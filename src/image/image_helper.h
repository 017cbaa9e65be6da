/* SPDX-License-Identifier: MIT */
/*
 * The image helper: every image format but OpenEXR, and PNG as it is written, by OpenImageIO in a
 * process of its own.
 *
 * OpenImageIO has no C interface and loads some 260 shared libraries, so it lives in the program
 * iftty-image, started on first use. A decoder that dies on a hostile file costs one error
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
 * 1048576, notes at most 1024; frames are 1..1000, and DELAY is how long each is seen, 0..60000 ms.
 * CHANNELS are 3, RGB, or 4, RGBA. What breaks these rules ends the helper. A worked example, a red
 * pixel with one note:
 *
 *     write 5 1 1 1 1 0 3\na.png4 3\nviewtop\xff\x00\x00    ->  ok\n
 *     read 5\na.png      ->  picture 1 1 1\n4 3\nviewtop\xff\x00\x00\xff
 *
 * The helper carries each request out in a process of its own, which reaches no file but that one
 * (wire.hh). Nothing here ever raises SIGPIPE or waits without end: a helper that is silent for
 * image_helper_patience_ms is ended.
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

/* A client of the helper at the path `program`, or where that is NULL, of iftty-image beside the
 * running program; which is not started yet. */
enum err image_helper_new(struct image_helper **helper, const char *program, struct fault *fault);

/* Starts it, unless it runs, for the caller who will need it soon: it takes some 160 ms to load its
 * libraries, beside whatever else is done. Every request does so by itself. */
enum err image_helper_start(struct image_helper *helper, struct fault *fault);

/* Ends the helper, if it runs, and waits for it. */
void image_helper_free(struct image_helper *helper);

/* Writes `picture` as `path`, whole or not at all: .exr by exr_write with all planes, .png by
 * png_write, any other extension by the helper: what is shown of it, and notes; a clear picture has
 * its alpha in PNG and TIFF, and is over black in other formats. Notes are lines "name: value" of
 * the image description, where a format has one. The same picture gives the same bytes. */
enum err image_write(struct image_helper *helper, const char *path, enum file_mode mode,
                     const struct picture *picture, struct fault *fault);

/* How a file of this name is written while its picture is drawn; NULL for formats of the helper. */
const struct strips_format *image_strips(const char *path);

/* For programs whose long work ends in one picture: before it, whether `path` (NULL: no picture is
 * wanted) is the name of a .png that can be written and is not there yet; then the picture, by a
 * helper of its own. */
enum err image_check_png(const char *path, struct fault *fault);
enum err image_write_png(const char *path, const struct picture *picture, struct fault *fault);

/*
 * A file by the image helper, step by step: of one picture, or an animated one, of several of one
 * size in turn.
 *
 * Frames go to the helper as they are made, so no more than one is held. The file appears whole,
 * with all its frames, or not at all. The helper compresses what it has got while the caller does
 * something else; image_movie_end waits for it. Every viewer shows GIF, which has 256 colours for
 * each frame; TIFF has every colour, as pages.
 */
enum { IMAGE_FRAMES_MOST = 1000 };
struct image_movie {
    struct image_helper *helper; /* the caller says these three, */
    const char *path;            /* and this stays its own; */
    enum file_mode mode;
    unsigned channels; /* the rest is zero before it begins */
    struct buf draft;
};

/* Whether the name is of a format that holds several pictures. */
bool image_movie_is_named(const char *path);

/* Begins a file of `frames` pictures, 1..IMAGE_FRAMES_MOST, each seen for `delay_ms`; `like` gives
 * their size, and the notes. After an error of this and the next two nothing is left of it. */
enum err image_movie_begin(struct image_movie *movie, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault);
enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault);
enum err image_movie_end(struct image_movie *movie, struct fault *fault); /* after all frames */

/* Ends a movie that will not be finished, and the helper, which the next request starts again. One
 * that is ended, or zeroed, is left alone. */
void image_movie_abandon(struct image_movie *movie);

/* Reads the first image of `path`, in any format, into 8 bits per channel. On failure *out is
 * empty. */
enum err image_helper_read(struct image_helper *helper, const char *path, struct picture *out,
                           struct fault *fault);

/* What a file is, in any format. Its first image is decoded, so one that is cut short is an error.
 * The texts are those of the file: not safe to print. */
struct image_facts {
    struct picture picture; /* sides and notes, no pixels */
    unsigned frames;
    char *format, *type, *channels; /* "png", "uint8", "R,G,B" */
};
enum err image_helper_about(struct image_helper *helper, const char *path, struct image_facts *out,
                            struct fault *fault);
void image_facts_release(struct image_facts *facts);

/* How long a helper may stay silent; tests wait less. */
extern int image_helper_patience_ms;

/* Bytes that a helper started from now on may hold for itself, its program and libraries not
 * counted; 0: as many as are free. One with all its libraries holds 150 MB, and 350 MB over the
 * largest picture that is written. What it does not get is an error of the request, or its end. */
extern uint64_t image_helper_memory_most;

#endif
