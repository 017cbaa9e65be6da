/*
 * An animated picture: several pictures of one size in one file, in turn.
 *
 * Frames go to the image helper as they are made, so no more than one is held. The file appears
 * whole, with all its frames, or not at all. GIF is what everybody shows; it has 256 colours for
 * each frame. TIFF keeps every colour, as pages.
 */
#ifndef IMAGE_MOVIE_H
#define IMAGE_MOVIE_H

#include <stdbool.h>

#include "image/helper.h"

struct image_movie {
    struct image_writing writing;
    struct buf draft;
    const char *path; /* the caller's */
    enum file_mode mode;
};

/* Whether the name is of a format that holds several pictures. */
bool image_movie_is_named(const char *path);

/* Begins a file of `frames` pictures, 1..IMAGE_FRAMES_MOST, each seen for `delay_ms`; `like` gives
 * their size, and the notes. On error nothing is begun. */
enum err image_movie_begin(struct image_movie *movie, struct image_helper *helper, const char *path,
                           enum file_mode mode, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault);

/* After an error of these nothing is left of the movie. */
enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault);
enum err image_movie_end(struct image_movie *movie, struct fault *fault); /* after all frames */

/* Ends a movie that will not be finished. One that is ended, or zeroed, is left alone. */
void image_movie_abandon(struct image_movie *movie);

#endif
