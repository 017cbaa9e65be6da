/*
 * The context: the scene itself, as a maximum intensity projection behind and around the objects of
 * the rendition (render/mip.h), where the outlook has it so.
 */
#ifndef SHOW_CONTEXT_H
#define SHOW_CONTEXT_H

#include "render/mip.h"
#include "render/rendition.h"

struct session;

/* What commands call them. */
#define CONTEXTS "none|mip"
enum context_kind { CONTEXT_NONE, CONTEXT_MIP };

struct context {
    struct mip mip;
    struct rendition frame; /* borrows all maps of what is rendered but `rgba`, which is its own;
                               without maps where nothing is */
};

/* Another picture is to come. */
void context_forget(struct context *context);
void context_release(struct context *context);
size_t context_bytes(const struct context *context);

/* Puts it behind what is rendered, at the size of the view, where that has just changed. Nothing to
 * do where the outlook has none. ERR_MEMORY, ERR_CANCELLED. */
enum err context_put(struct session *session, const struct rendition *rendered,
                     struct fault *fault);

#endif
