#include "session/drawn_colours.h"

#include <string.h>

#include "session/session_parts.h"

bool session_draws_colours(const struct session *session)
{
    const struct outlook *outlook = &session->now.outlook;
    return !outlook->decorations && outlook->context == CONTEXT_NONE;
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

void drawn_colours_take(void *context, const struct rendition *rows, uint32_t top)
{
    struct drawn_colours *colours = context;
    struct label_set labels = {{0}};
    label_set_add(&labels, rows);
    for (int i = 0; i < 4; i++)
        colours->labels[i] |= labels.bits[i];
    colours->digest += rendition_digest_rows(rows, top);
    if (!colours->rgba)
        return;
    uint8_t *rgba = colours->rgba + (size_t)4 * top * rows->width;
    memcpy(rgba, rows->rgba, (size_t)4 * rows->height * rows->width);
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
    session->drawn = colours;
    const enum err err = session_draw_labels(session, labels, RENDER_ONCE, fault);
    session->drawn = NULL;
    session->rendered = RENDERED_NOT;
    return err;
}
