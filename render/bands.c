#include "render/bands.h"

#include "render/layers.h"
#include "render/projection.h"

/* More leave the caches. Of less, voxels and rows around that lie across two bands are drawn twice:
 * of voxels it takes 2 % more time to have half as many, which wide pictures spare memory by. */
enum { SAMPLES_HIGH = 64, SAMPLES_LEAST_HIGH = 32, SAMPLES_A_BAND = 1 << 18 };

struct drawing {
    const struct bands *bands;
    struct rendition *out; /* or NULL */
    struct team *team;
    uint32_t reach;  /* rows of samples that are drawn on both sides of a band, */
    uint32_t most;   /* and those of a band, of whole tiles */
    bool is_reduced; /* else pixels are what is drawn */
    struct rendition room[TEAM_MOST], pixels[TEAM_MOST]; /* for each thread */
    struct layers layers[TEAM_MOST];
};

static uint32_t round_up(uint32_t rows, uint32_t unit)
{
    return (rows + unit - 1) / unit * unit;
}

static struct drawing drawing_of(struct rendition *out, const struct bands *bands)
{
    const uint32_t samples = bands->look->samples;
    struct drawing d = {.bands = bands, .out = out, .is_reduced = out || samples > 1};
    d.team = bands->project == project_border ? bands->shader->team : NULL;
    d.reach = round_up((uint32_t)shade_reach(bands->look, bands->camera).pixels, TILE);
    uint32_t high = d.reach > SAMPLES_HIGH ? d.reach : SAMPLES_HIGH;
    if (!d.reach && SAMPLES_A_BAND / bands->camera->view.width < high)
        high = SAMPLES_LEAST_HIGH;
    if (bands->rows)
        high = bands->rows * samples;
    d.most = round_up(high, TILE) / samples * samples;
    return d;
}

/* The band of `height` rows of samples from row `top` on. */
static void draw_band(const struct drawing *d, uint32_t top, uint32_t height, unsigned thread)
{
    const struct bands *bands = d->bands;
    const struct rendition *room = &d->room[thread];
    const uint32_t samples = bands->look->samples, all = bands->camera->view.height;
    const uint32_t above = top < d->reach ? top : d->reach, rest = all - (top + height);
    const uint32_t drawn_height = above + height + (rest < d->reach ? rest : d->reach);
    const struct camera camera = camera_rows(bands->camera, top - above, drawn_height);
    struct rendition drawn = rendition_rows(room, 0, drawn_height);
    struct rendition fine = rendition_rows(room, above, height);
    if (bands->project == project_border)
        project_border_quietly(&drawn, &camera, bands->mesh);
    else
        bands->project(&drawn, &camera, bands->mesh);
    shade_rows(&drawn, above / TILE, above / TILE + fine.tiles_y, &camera, bands->mesh,
               bands->palette, bands->look, bands->shader);
    struct rendition pixels = fine;
    if (d->is_reduced) {
        pixels = d->out ? rendition_rows(d->out, top / samples, height / samples)
                        : rendition_rows(&d->pixels[thread], 0, height / samples);
        rendition_reduce(&pixels, &fine, samples, NULL);
    }
    if (bands->take)
        bands->take(bands->context, &pixels, top / samples);
}

static void draw_share(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct view *view = &d->bands->camera->view;
    struct task task = task_begin_part(d->bands->camera->scene->watch, "rendition",
                                       (uint64_t)view->width * view->height, thread);
    for (uint32_t i = thread; i * d->most < view->height; i += team_size(d->team)) {
        const uint32_t top = i * d->most, rest = view->height - top;
        const uint32_t height = rest < d->most ? rest : d->most;
        draw_band(d, top, height, thread);
        if (!task_advance(&task, (uint64_t)height * view->width))
            return;
    }
}

static enum err make_room(struct drawing *d, struct fault *fault)
{
    const struct bands *bands = d->bands;
    const struct view *view = &bands->camera->view;
    const uint32_t samples = bands->look->samples, most = d->most + 2 * d->reach;
    const uint32_t height = most < view->height ? most : view->height;
    enum err err = shader_prepare(bands->shader, bands->mesh->border, bands->look, fault);
    for (unsigned i = 0; i < team_size(d->team) && !err; i++) {
        struct rendition *room = &d->room[i];
        err = rendition_init(room, view->width, height, fault);
        if (!err && !d->out && d->is_reduced)
            err = rendition_init(&d->pixels[i], view->width / samples, d->most / samples, fault);
        if (!err)
            err = layers_take(&d->layers[i], room, bands->mesh->border, fault);
    }
    return err;
}

enum err bands_draw(struct rendition *out, const struct bands *bands, struct fault *fault)
{
    struct drawing d = drawing_of(out, bands);
    const enum err err = make_room(&d, fault);
    if (!err)
        team_run(d.team, draw_share, &d);
    for (int i = 0; i < TEAM_MOST; i++) {
        rendition_release(&d.room[i]);
        rendition_release(&d.pixels[i]);
        layers_release(&d.layers[i]);
    }
    return err;
}
