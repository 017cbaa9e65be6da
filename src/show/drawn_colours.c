#include "show/drawn_colours.h"

#include <string.h>

#include "session/finished.h"
#include "show/decorating.h"
#include "session/session_inside.h"
#include "show/draw.h"

bool session_draws_colours(const struct session *session)
{
    return session->now.outlook.context == CONTEXT_NONE && session_decorates_ahead(session);
}

uint32_t session_behind_colours(const struct session *session)
{
    const uint32_t background = session->now.outlook.background;
    return background == BACKGROUND_FADE ? BACKGROUND_CLEAR : background;
}

void label_set_add(struct label_set *set, const struct rendition *r)
{
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        label_set_put(set, r->label[i]);
}

struct label_set drawn_labels(const struct drawn_colours *colours)
{
    const _Atomic uint64_t *labels = colours->labels;
    return (struct label_set){{labels[0], labels[1], labels[2], labels[3]}};
}

/* Both are what is drawn, with decorations over it that are in the picture already: whether there
 * are any. */
static bool unite(uint8_t *picture, uint8_t *drawn, size_t pixels)
{
    bool is_decorated = false;
    for (size_t i = 0; i < 4 * pixels; i += 4)
        if (picture[i + 3]) {
            memcpy(drawn + i, picture + i, 4);
            is_decorated = true;
        } else {
            memcpy(picture + i, drawn + i, 4);
        }
    return is_decorated;
}

void drawn_colours_take(void *context, const struct rendition *rows, uint32_t top)
{
    struct drawn_colours *colours = context;
    uint8_t *rgba = colours->rgba + (size_t)4 * top * rows->width;
    struct label_set labels = {{0}};
    label_set_add(&labels, rows);
    for (int i = 0; i < 4; i++)
        colours->labels[i] |= labels.bits[i];
    if (unite(rgba, rows->rgba, (size_t)rows->height * rows->width))
        memset(rows->blank, 0, (size_t)rows->tiles_x * rows->tiles_y * sizeof *rows->blank);
    colours->digest += rendition_digest_rows(rows, top);
    background_put_rows(rgba, rows->width, top, rows->height, colours->height, colours->background);
}

enum err session_draw_colours(struct session *session, const struct labels *labels,
                              struct drawn_colours *colours, struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    colours->height = view->height;
    colours->background = session_behind_colours(session);
    colours->digest = rendition_digest_begin(view->width, view->height);
    for (int i = 0; i < 4; i++)
        colours->labels[i] = 0;
    if (session->now.outlook.look.samples > 1)
        session_release_rendition(session);
    session->rendered = RENDERED_NOT;
    enum err err = session_decorate_ahead(session, labels, colours->rgba, fault);
    session->drawn = colours;
    if (!err)
        err = session_draw_labels(session, labels, RENDER_ONCE, fault);
    session->drawn = NULL;
    session->rendered = RENDERED_NOT;
    return err;
}
