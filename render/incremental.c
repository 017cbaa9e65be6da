/* SPDX-License-Identifier: MIT */
#include "render/incremental.h"

#include <string.h>

#include "engine/changes.h"
#include "render/projection.h"
#include "render/shade.h"

struct following {
    struct rendition *rendition;
    struct drawer drawer;
    int pixels; /* distance from quads at which colours may change */
};

static bool is_same(const struct mesh_brick *a, const struct mesh_quad *p,
                    const struct mesh_brick *b, const struct mesh_quad *q)
{
    if (p->label != q->label || p->is_closed != q->is_closed)
        return false;
    for (int k = 0; k < 4; k++)
        if (memcmp(&a->vertex[p->corner[k]], &b->vertex[q->corner[k]], sizeof *a->vertex) != 0)
            return false;
    return true;
}

/* A quad that hides this one still does, or is marked itself. */
static void mark_quads(const struct following *f, uint32_t number, const struct mesh_brick *brick,
                       const struct mesh_quad *quad)
{
    const struct sight sight = project_quad(&f->drawer, number, brick, quad);
    if (!project_is_hidden(f->rendition, &sight))
        rendition_mark_stale(f->rendition, sight.pixels, f->pixels);
}

/* Both lists of quads are sorted by key. */
static void follow_brick(void *context, const struct mesh *mesh, uint32_t number,
                         const struct mesh_brick *next)
{
    const struct following *f = context;
    const struct mesh_brick *former = mesh->brick[number];
    const uint32_t was = former ? former->quads : 0, is = next ? next->quads : 0;
    uint32_t i = 0, j = 0;
    while (i < was || j < is) {
        const struct mesh_quad *p = i < was ? &former->quad[i] : NULL;
        const struct mesh_quad *q = j < is ? &next->quad[j] : NULL;
        const bool goes = p && (!q || p->key < q->key), comes = q && (!p || q->key < p->key);
        if (!goes && !comes && is_same(former, p, next, q)) {
            i++, j++;
            continue;
        }
        if (!comes)
            mark_quads(f, number, former, p);
        if (!goes)
            mark_quads(f, number, next, q);
        i += !comes;
        j += !goes;
    }
}

enum err incremental_image(struct rendition *r, const struct camera *camera, struct mesh *mesh,
                           const struct border *border, const struct look *look,
                           const struct changes *changes, struct team *team, struct fault *fault)
{
    const struct shade_reach reach = shade_reach(look, camera);
    struct following following = {.rendition = r, .pixels = reach.pixels};
    const struct mesh_listener listener = {follow_brick, &following};
    if (changes->everything) {
        TRY(mesh_update(mesh, border, shade_kind(look), team, NULL, fault));
        project_border_shared(r, camera, mesh, team);
        return OK;
    }
    drawer_init(&following.drawer, camera, mesh);
    TRY(mesh_update(mesh, border, shade_kind(look), team, &listener, fault));
    for (size_t i = 0; i < changes->count && reach.voxels > 0; i++) {
        const struct change *c = changes->item + i;
        if (border->visible[c->former_label] != border->visible[c->label])
            rendition_mark_stale(r, project_around(camera, c->cell, reach.voxels), reach.pixels);
    }
    project_stale(r, camera, mesh);
    return OK;
}
