/* `iftty show`: a picture file at the terminal. */
#include "program/programs.h"

#include "image/helper.h"
#include "tui/prompt/repl.h"

/* Fine, and silent, where standard output is no terminal. */
enum err run_show(const struct options *o, struct fault *fault)
{
    struct image_helper *helper;
    struct picture picture = {0};
    enum err err = image_helper_new(&helper, NULL, fault);
    if (!err)
        err = image_helper_read(helper, o->word[0], &picture, fault);
    if (!err) {
        const struct image_view view = {.width = picture.width,
                                        .height = picture.height,
                                        .rgba = picture.rgba,
                                        .smooth = o->smooth};
        show_picture_once(o->graphics, &view);
    }
    picture_release(&picture);
    image_helper_free(helper);
    return err;
}
