/* SPDX-License-Identifier: MIT */
#include "render/bands.h"

#include "render/layers.h"
#include "render/projection.h"

/* Larger bands do not fit the caches. Smaller ones draw voxels at their borders twice: half the
 * height costs 2 % more time, which wide pictures accept to save memory. */
enum { SAMPLES_HIGH = 64, SAMPLES_LEAST_HIGH = 32, SAMPLES_A_BAND = 1 << 18 };

/* Memory of one thread: a band, and, if colours depend on nearby rows, the band with those rows. */
struct room {
    struct rendition drawn, pixels, around;
    struct layers layers;
    uint32_t first, end; /* rows of samples in `around` */
};

struct drawing {
    const struct bands *bands;
    struct rendition *out; /* or NULL */
    struct team *team;
    uint32_t reach;  /* rows of samples that shading reads on both sides of a band */
    uint32_t most;   /* rows of samples in a band, whole tiles */
    bool is_reduced; /* samples are reduced to pixels */
    struct room room[TEAM_MOST];
};

static uint32_t round_up(uint32_t rows, uint32_t unit)
{
    return (rows + unit - 1) / unit * unit;
}

/* Draw rows of samples without edges. The result is valid until the thread draws again. */
static struct rendition draw_rows(const struct drawing *d, uint32_t top, uint32_t height,
                                  struct room *room)
{
    const struct bands *bands = d->bands;
    const struct camera camera = camera_rows(bands->camera, top, height);
    struct rendition drawn = rendition_rows(&room->drawn, 0, height);
    if (bands->project == project_border)
        project_border_part(&drawn, &camera, bands->mesh, 1);
    else
        bands->project(&drawn, &camera, bands->mesh);
    shade_rows(&drawn, &camera, bands->mesh, bands->palette, bands->look, bands->shader);
    return drawn;
}

/* The same with edges. A thread draws successive bands, so it keeps the rows around them. */
static struct rendition draw_with_edges(const struct drawing *d, uint32_t top, uint32_t height,
                                        struct room *room)
{
    const struct bands *bands = d->bands;
    const uint32_t all = bands->camera->view.height, first = top < d->reach ? 0 : top - d->reach;
    const uint32_t below = top + height, end = all - below < d->reach ? all : below + d->reach;
    if (first >= room->end)
        room->end = first;
    else {
        const struct rendition kept =
            rendition_rows(&room->around, first - room->first, room->end - first);
        rendition_copy(&room->around, &kept, kept.height);
    }
    for (room->first = first; room->end < end;) {
        const uint32_t rows = end - room->end < d->most ? end - room->end : d->most;
        const struct rendition drawn = draw_rows(d, room->end, rows, room);
        struct rendition to = rendition_rows(&room->around, room->end - first, rows);
        rendition_copy(&to, &drawn, rows);
        room->end += rows;
    }
    struct rendition whole = rendition_rows(&room->around, 0, end - first);
    struct rendition band = rendition_rows(&whole, top - first, height);
    shade_edges(&whole, (top - first) / TILE, (top - first) / TILE + band.tiles_y, bands->camera,
                bands->palette, bands->look);
    return band;
}

/* Draw every n-th band, or, if rows around are kept, the bands of one part of the picture. */
static void draw_share(void *context, unsigned thread)
{
    struct drawing *d = context;
    const struct view *view = &d->bands->camera->view;
    struct task task = task_begin_part(d->bands->camera->scene->watch, "rendition",
                                       (uint64_t)view->width * view->height, thread);
    const size_t count = (view->height + d->most - 1) / d->most;
    const struct share part =
        d->reach ? team_share(d->team, thread, count) : (struct share){thread, count};
    for (size_t i = part.first; i < part.end; i += d->reach ? 1 : team_size(d->team)) {
        const uint32_t top = (uint32_t)i * d->most, rest = view->height - top;
        const uint32_t height = rest < d->most ? rest : d->most;
        /* Draw the band of `height` rows of samples from row `top` on. */
        const struct bands *bands = d->bands;
        const uint32_t samples = bands->look->samples;
        struct rendition fine = d->reach ? draw_with_edges(d, top, height, &d->room[thread])
                                         : draw_rows(d, top, height, &d->room[thread]);
        struct rendition pixels = fine;
        if (d->is_reduced) {
            pixels = d->out ? rendition_rows(d->out, top / samples, height / samples)
                            : rendition_rows(&d->room[thread].pixels, 0, height / samples);
            rendition_reduce(&pixels, &fine, samples, NULL);
        }
        if (bands->take)
            bands->take(bands->context, &pixels, top / samples);
        if (!task_advance(&task, (uint64_t)height * view->width))
            return;
    }
}

static enum err make_room(struct drawing *d, struct fault *fault)
{
    const struct bands *bands = d->bands;
    const struct view *view = &bands->camera->view;
    const uint32_t all = view->height, samples = bands->look->samples;
    const uint32_t around = d->most + 2 * d->reach, most = d->most < all ? d->most : all;
    TRY(shader_prepare(bands->shader, bands->mesh->border, bands->look, fault));
    for (unsigned i = 0; i < team_size(d->team); i++) {
        struct room *room = &d->room[i];
        TRY(rendition_init(&room->drawn, view->width, most, fault));
        if (d->reach)
            TRY(rendition_init(&room->around, view->width, around < all ? around : all, fault));
        if (!d->out && d->is_reduced)
            TRY(rendition_init(&room->pixels, view->width / samples, d->most / samples, fault));
        TRY(layers_attach(&room->layers, &room->drawn, bands->mesh->border, fault));
    }
    return OK;
}

enum err bands_draw(struct rendition *out, const struct bands *bands, struct fault *fault)
{
    const uint32_t samples = bands->look->samples;
    struct drawing d = {.bands = bands, .out = out, .is_reduced = out || samples > 1};
    d.team = bands->project == project_border ? bands->shader->team : NULL;
    d.reach = round_up((uint32_t)shade_reach(bands->look, bands->camera).pixels, TILE);
    uint32_t high = SAMPLES_HIGH;
    if (SAMPLES_A_BAND / bands->camera->view.width < high)
        high = SAMPLES_LEAST_HIGH;
    if (bands->rows)
        high = bands->rows * samples;
    d.most = round_up(high, TILE) / samples * samples;
    const enum err err = make_room(&d, fault);
    if (!err)
        team_run(d.team, draw_share, &d);
    for (int i = 0; i < TEAM_MOST; i++) {
        rendition_release(&d.room[i].drawn);
        rendition_release(&d.room[i].around);
        rendition_release(&d.room[i].pixels);
        layers_release(&d.room[i].layers);
    }
    return err;
}
