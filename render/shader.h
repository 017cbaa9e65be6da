/* SPDX-License-Identifier: MIT */
/*
 * The shader: what shading stores between one picture and the next, so that the next is made
 * faster. What that is, shading alone knows (render/shade.h).
 */
#ifndef RENDER_SHADER_H
#define RENDER_SHADER_H

#include <stddef.h>
#include <stdint.h>

struct shader {
    int32_t window[2]; /* to be set where something is cut: the intensities that are black and
                          white on faces cut open; they differ, and either may be the greater */
    struct team *team; /* to be set: the threads that share the work, or NULL */
    struct shader_store *store;
};

/* Frees what is stored; the shader, whose window and team stay, may be used again. A new one is
 * zeroed. */
void shader_release(struct shader *shader);
size_t shader_bytes(const struct shader *shader);

#endif
