#include "show/context.h"

#include <stdlib.h>

#include "base/mem.h"
#include "session/session_inside.h"
#include "show/window.h"

void context_forget(struct context *context)
{
    free(context->frame.rgba);
    context->frame = (struct rendition){0};
}

void context_release(struct context *context)
{
    mip_release(&context->mip);
    context_forget(context);
}

size_t context_bytes(const struct context *context)
{
    const struct rendition *frame = &context->frame;
    return mip_bytes(&context->mip) + (size_t)4 * frame->width * frame->height;
}

/* The view of the picture, of which the session's camera may see samples. */
static enum err aim(struct camera *camera, const struct session *session, struct fault *fault)
{
    const uint32_t samples = session->now.outlook.look.samples;
    struct view view = session->camera.view;
    view.width /= samples;
    view.height /= samples;
    view.zoom /= samples;
    return camera_init(camera, session->scene, &view, fault);
}

static enum err take_rendered(struct context *context, const struct rendition *rendered,
                              struct fault *fault)
{
    uint8_t *rgba = context->frame.rgba;
    if (context->frame.width != rendered->width || context->frame.height != rendered->height) {
        context_forget(context);
        rgba = mem_array((size_t)rendered->width * rendered->height, 4);
    }
    if (!rgba)
        return fault_memory(fault, "a picture");
    context->frame = *rendered;
    context->frame.rgba = rgba;
    return OK;
}

enum err context_put(struct session *session, const struct rendition *rendered, struct fault *fault)
{
    struct context *context = &session->context;
    struct mip_source source = {
        .scene = session->scene, .digest = session->scene_digest, .cut = session->now.kept.cut};
    struct camera camera;
    if (session->now.outlook.context == CONTEXT_NONE)
        return OK;
    window_of(source.window, session);
    enum err err = aim(&camera, session, fault);
    if (!err)
        err = mip_draw(&context->mip, &source, &camera, session->team, fault);
    if (!err)
        err = take_rendered(context, rendered, fault);
    if (!err)
        mip_put_behind(context->frame.rgba, rendered->rgba, context->mip.brightness,
                       (size_t)rendered->width * rendered->height);
    return err;
}
