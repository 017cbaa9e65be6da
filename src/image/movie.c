#include "image/movie.h"

bool image_movie_is_named(const char *path)
{
    return file_is_named(path, ".gif|.tif|.tiff");
}

/* Nothing is held any more, and no draft lies about. */
static void forget(struct image_movie *movie)
{
    if (movie->draft.length)
        file_discard(buf_text(&movie->draft));
    buf_release(&movie->draft);
    *movie = (struct image_movie){0};
}

enum err image_movie_begin(struct image_movie *movie, struct image_helper *helper, const char *path,
                           enum file_mode mode, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault)
{
    *movie = (struct image_movie){.path = path, .mode = mode};
    enum err err = file_draft(&movie->draft, path, mode, fault);
    movie->writing = (struct image_writing){helper, buf_text(&movie->draft), path};
    if (!err)
        err = image_helper_begin(&movie->writing, like, frames, delay_ms, fault);
    if (err)
        forget(movie);
    return err;
}

enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault)
{
    enum err err = image_helper_frame(&movie->writing, picture, fault);
    if (err)
        image_movie_abandon(movie);
    return err;
}

enum err image_movie_end(struct image_movie *movie, struct fault *fault)
{
    enum err err = image_helper_end(&movie->writing, fault);
    if (!err) {
        err = file_publish(buf_text(&movie->draft), movie->path, movie->mode, fault);
        buf_clear(&movie->draft); /* it has another name now, or is gone */
    }
    forget(movie);
    return err;
}

void image_movie_abandon(struct image_movie *movie)
{
    if (movie->writing.helper)
        image_helper_abandon(&movie->writing);
    forget(movie);
}
