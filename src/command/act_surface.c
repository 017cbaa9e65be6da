/* `save surface`: what encloses the labels, as triangles. */
#include "command/act.h"

#include "image/surface_file.h"
#include "report/export_map.h"

enum { PASSES_USUALLY = 20 };

/* The places of the parameters in the table. */
enum { LABEL = 4, SMOOTH, TRIANGLES };

static void row_of_labels(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct labels *labels = context;
    labels_copy_row(labels, grid_row(&labels->scene->grid, y, z), label);
}

static void row_of_all(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct labels *labels = context;
    row_of_labels(context, y, z, label);
    for (uint32_t x = 0; x < labels->scene->grid.size[0]; x++)
        label[x] = label[x] != 0;
}

/* `joins`: all labels as one. */
static enum err make_surface(struct surface **surface, const struct act *act,
                             const struct labels *labels, bool joins)
{
    struct session *session = act->session;
    const struct value *label = &act->value[LABEL], *smooth = &act->value[SMOOTH];
    struct labels of = *labels;
    const struct surface_source source = {session_scene(session)->grid.size,
                                          joins ? row_of_all : row_of_labels, &of};
    bool wanted[256];
    for (int l = 0; l < 256; l++)
        wanted[l] = !label->given || label->number == l;
    const unsigned passes = smooth->given ? (unsigned)smooth->number : PASSES_USUALLY;
    const enum err err =
        surface_new(surface, &source, wanted, passes, session_watch(session), act->fault);
    if (err || (*surface)->parts)
        return err;
    return label->given
               ? fault_set(act->fault, ERR_INPUT, "no voxel has label %lld; nothing was written",
                           (long long)label->number)
               : fault_set(act->fault, ERR_INPUT,
                           "no voxel has a label above 0: plant a `seed` first; nothing was "
                           "written");
}

static enum err write_surface(const struct act *act, const struct labels *labels, const char *path,
                              enum file_mode how, const struct surface *surface)
{
    const struct session *session = act->session;
    struct volume_label label[256];
    struct buf notes = {0};
    export_labels(label, session_kept(session));
    if (labels->finished) {
        buf_add_text(&notes, "finished: ");
        finish_write(&notes, &session_kept(session)->finish);
    }
    const struct surface_document document = {surface, session_geometry(session), label,
                                              buf_text(&notes)};
    const enum err err =
        notes.failed ? fault_memory(act->fault, "a surface")
                     : surface_write(path, how, &document, session_watch(session), act->fault);
    buf_release(&notes);
    return err;
}

/* What each surface has and encloses, and where it lies. */
static void answer(const struct act *act, const struct surface *surface, bool joins)
{
    struct buf *out = &act->reply->text;
    const struct session *session = act->session;
    for (unsigned p = 0; p < surface->parts; p++) {
        const struct surface_part *part = &surface->part[p];
        buf_add_text(out, joins ? "all labels" : "label ");
        if (!joins)
            label_report_write_name(out, session, part->label);
        buf_printf(out, ": %zu triangles around ", part->triangles);
        label_report_write_extent(out, session, part->voxels);
        buf_add_char(out, '\n');
    }
    if (session_geometry(session)->spacing_unknown)
        buf_add_text(out, "its places are in voxels: how far apart those are is unknown\n");
    else if (session_geometry(session)->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(out, "its places are in millimetres along the axes of the voxels: the "
                          "orientation is unknown (`orient` says it)\n");
}

enum err act_save_surface(const struct act *act, const struct labels *labels, const char *path,
                          enum file_mode how)
{
    struct surface *surface = NULL;
    const struct value *most = &act->value[TRIANGLES];
    const bool joins = !act->value[LABEL].given && !surface_file_tells_labels(path);
    enum err err = make_surface(&surface, act, labels, joins);
    if (!err && most->given)
        err =
            surface_reduce(surface, (size_t)most->number, session_watch(act->session), act->fault);
    if (!err)
        err = write_surface(act, labels, path, how, surface);
    if (!err)
        answer(act, surface, joins);
    surface_free(surface);
    return err;
}
