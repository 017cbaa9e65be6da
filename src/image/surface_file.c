/* SPDX-License-Identifier: MIT */
#include "image/surface_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/sort.h"
#include "base/least.h"

enum { FLUSH = 1 << 20 };

/* The transform from points to the world: rows of 2^-shift millimetres. */
struct world {
    int64_t row[3][4];
    int shift;
    bool is_mirrored;
};

struct output {
    const char *says; /* meaning of positions; notes */
    bool is_of_the_world;
    const char *draft;
    int fd;
    struct buf bytes; /* not yet written to the file */
    bool fine;
    struct task task;
    const struct surface *surface;
    const struct volume_label *label; /* [256] */
    struct world world;
    float (*mm)[3]; /* [points]: positions in the world */
};

/* ---- the world ---- */

/* The coordinate of a point along one axis of the world, in 2^-shift millimetres. */
static int64_t along_world(const struct world *world, int axis, const struct surface_point *point)
{
    const int64_t *row = world->row[axis];
    int64_t sum = row[3];
    for (int a = 0; a < 3; a++) {
        const int64_t voxel = point->at[a] / SURFACE_ONE, rest = point->at[a] % SURFACE_ONE;
        sum += row[a] * (voxel - 1) + row[a] * rest / SURFACE_ONE;
    }
    return sum;
}

/* Move each point of a part that has the same place as another. */
static bool move_apart(const struct output *out, const struct surface_part *part, float step_mm,
                       struct lookup *taken)
{
    lookup_clear(taken);
    for (size_t i = part->point; i < part->point + part->points; i++)
        for (bool is_apart = false; !is_apart;) {
            uint64_t key = 0;
            for (int w = 0; w < 3; w++) {
                uint32_t bits;
                memcpy(&bits, &out->mm[i][w], sizeof bits);
                key = hash_mix_at(key, bits);
            }
            uint32_t *point = lookup_at(taken, key);
            if (!point)
                return false;
            is_apart = *point == LOOKUP_NEW;
            if (is_apart)
                *point = 0;
            else
                out->mm[i][0] = fmaxf(out->mm[i][0] + step_mm, nextafterf(out->mm[i][0], INFINITY));
        }
    return true;
}

static enum err find_places(struct output *out, const struct geometry *geometry,
                            struct fault *fault)
{
    const struct surface *s = out->surface;
    OWNED(lookup_release) struct lookup taken = {0};
    struct world *world = &out->world;
    double finest_mm = 1e300, far = 0, most = 0;
    int exponent;
    for (int a = 0; a < 3; a++)
        finest_mm = fmin(finest_mm, geometry->spacing_nm[a] / 1e6);
    /* Each sum of the row's terms fits 62 bits: a point is below 2^16 voxels. */
    for (int i = 0; i < 12; i++)
        most = fmax(most, fabs(geometry->to_mm[i / 4][i % 4]) * (i % 4 < 3 ? 65536 : 1));
    frexp(most, &exponent);
    world->shift = 59 - exponent;
    for (int i = 0; i < 12; i++)
        world->row[i / 4][i % 4] = (int64_t)ldexp(geometry->to_mm[i / 4][i % 4], world->shift);
    world->is_mirrored = geometry_is_mirrored(geometry);
    out->mm = mem_array(s->points + 1, sizeof *out->mm);
    bool fits = out->mm;
    for (size_t i = 0; fits && i < s->points; i++)
        for (int w = 0; w < 3; w++) {
            const int64_t at = along_world(&out->world, w, &s->point[i]);
            out->mm[i][w] = (float)ldexp((double)at, -out->world.shift) + 0.0f; /* no -0 */
            far = fmax(far, fabs((double)out->mm[i][w]));
        }
    if (far >= finest_mm / 32 * 16777216) /* singles hold 24 bits */
        return fault_set(fault, ERR_LIMIT,
                         "the surface is up to %.6g mm from the origin of the world, too far for "
                         "voxels of %.6g mm in the single precision of such files",
                         far, finest_mm);
    for (unsigned p = 0; fits && p < s->parts; p++)
        fits = move_apart(out, &s->part[p], (float)(finest_mm / SURFACE_ONE), &taken);
    return fits ? OK : fault_memory(fault, "a surface");
}

/* The points of a triangle, counter-clockwise as seen from outside. */
static void corners_of(uint32_t corner[3], const struct output *out, size_t triangle)
{
    const uint32_t *point = out->surface->triangle[triangle].point;
    corner[0] = point[0];
    corner[1] = point[out->world.is_mirrored ? 2 : 1];
    corner[2] = point[out->world.is_mirrored ? 1 : 2];
}

/* ---- bytes ---- */

static void flush_bytes(struct output *out)
{
    out->fine = out->fine && !out->bytes.failed &&
                file_step_write(out->fd, out->draft, buf_text(&out->bytes), out->bytes.length);
    buf_clear(&out->bytes);
}

/* Count an item and flush a full buffer; false after an error or a stop. */
static bool next_item(struct output *out)
{
    if (out->bytes.length >= FLUSH)
        flush_bytes(out);
    return out->fine && task_advance(&out->task, 1);
}

static void put_number(struct output *out, uint64_t number, unsigned bytes)
{
    uint8_t little[8];
    bits_put(little, bytes, number, false);
    buf_add(&out->bytes, little, bytes);
}

static void put_float(struct output *out, float value)
{
    put_number(out, bits_of_real((double)value, 4), 4);
}

static void put_point(struct output *out, uint32_t point)
{
    for (int w = 0; w < 3; w++)
        put_float(out, out->mm[point][w]);
}

static unsigned number_of(const struct output *out, unsigned label)
{
    return out->label[label].number ? out->label[label].number : label;
}

/* "1 brain", safe in a line of text. */
static void put_label(struct buf *out, const struct output *from, unsigned label)
{
    buf_printf(out, "%u%s", number_of(from, label), *from->label[label].name ? " " : "");
    buf_add_safe_text(out, from->label[label].name);
}

/* ---- STL ---- */

/* Halve a vector until its components are below 2^bits, so that products fit. */
static void shorten(int64_t vector[3], int bits)
{
    int64_t most = 0;
    for (int w = 0; w < 3; w++)
        most = most < llabs(vector[w]) ? llabs(vector[w]) : most;
    for (; most >= INT64_C(1) << bits; most /= 2)
        for (int w = 0; w < 3; w++)
            vector[w] /= 2;
}

static void put_normal(struct output *out, const uint32_t corner[3])
{
    const struct surface_point *point = out->surface->point;
    int64_t u[3], v[3], normal[3];
    uint64_t square = 0;
    for (int w = 0; w < 3; w++) {
        const int64_t from = along_world(&out->world, w, &point[corner[0]]);
        u[w] = along_world(&out->world, w, &point[corner[1]]) - from;
        v[w] = along_world(&out->world, w, &point[corner[2]]) - from;
    }
    shorten(u, 20);
    shorten(v, 20);
    for (int w = 0; w < 3; w++) {
        const int i = (w + 1) % 3, k = (w + 2) % 3;
        normal[w] = u[i] * v[k] - u[k] * v[i];
    }
    shorten(normal, 30);
    for (int w = 0; w < 3; w++)
        square += (uint64_t)(normal[w] * normal[w]);
    const int64_t length = square ? square_root(square) : 1;
    for (int w = 0; w < 3; w++)
        put_float(out, (float)(normal[w] * 65536 / length) / 65536.0f);
}

static void write_stl(struct output *out)
{
    char head[80] = "";
    snprintf(head, sizeof head, "iftty surface: %s", out->says);
    buf_add(&out->bytes, head, sizeof head);
    put_number(out, out->surface->triangles, 4);
    for (size_t i = 0; i < out->surface->triangles && next_item(out); i++) {
        uint32_t corner[3];
        corners_of(corner, out, i);
        put_normal(out, corner);
        for (int k = 0; k < 3; k++)
            put_point(out, corner[k]);
        put_number(out, 0, 2);
    }
}

/* Write the corners of each triangle, each in `bytes`, after their number in a byte if counted. */
static void put_triangles(struct output *out, bool counts, unsigned bytes)
{
    for (size_t i = 0; i < out->surface->triangles && next_item(out); i++) {
        uint32_t corner[3];
        corners_of(corner, out, i);
        if (counts)
            put_number(out, 3, 1);
        for (int k = 0; k < 3; k++)
            put_number(out, corner[k], bytes);
    }
}

/* ---- PLY ---- */

static void write_ply(struct output *out)
{
    const struct surface *s = out->surface;
    buf_printf(&out->bytes, "ply\nformat binary_little_endian 1.0\ncomment iftty surface: %s\n",
               out->says);
    for (unsigned p = 0; p < s->parts; p++) {
        buf_add_text(&out->bytes, "comment label ");
        put_label(&out->bytes, out, s->part[p].label);
        buf_add_char(&out->bytes, '\n');
    }
    buf_printf(&out->bytes,
               "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
               "property uchar red\nproperty uchar green\nproperty uchar blue\n"
               "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
               s->points, s->triangles);
    for (unsigned p = 0; p < s->parts; p++)
        for (size_t i = 0; i < s->part[p].points && next_item(out); i++) {
            put_point(out, (uint32_t)(s->part[p].point + i));
            buf_add(&out->bytes, out->label[s->part[p].label].rgb, 3);
        }
    put_triangles(out, true, 4);
}

/* ---- OBJ ---- */

static void write_obj(struct output *out)
{
    buf_printf(&out->bytes, "# iftty surface: %s\n", out->says);
    const struct surface *s = out->surface;
    for (const struct surface_part *part = s->part; part < s->part + s->parts; part++) {
        const uint8_t *rgb = out->label[part->label].rgb;
        buf_add_text(&out->bytes, "o ");
        put_label(&out->bytes, out, part->label);
        buf_add_char(&out->bytes, '\n');
        for (size_t i = part->point; i < part->point + part->points && next_item(out); i++) {
            buf_add_char(&out->bytes, 'v');
            for (int w = 0; w < 3; w++)
                buf_printf(&out->bytes, " %.9g", (double)out->mm[i][w]);
            for (int k = 0; k < 3; k++)
                buf_printf(&out->bytes, " %.4g", rgb[k] / 255.0);
            buf_add_char(&out->bytes, '\n');
        }
        for (size_t i = part->triangle; i < part->triangle + part->triangles && next_item(out);
             i++) {
            uint32_t corner[3];
            corners_of(corner, out, i);
            buf_printf(&out->bytes, "f %u %u %u\n", corner[0] + 1, corner[1] + 1, corner[2] + 1);
        }
    }
}

/* ---- VTP ---- */

/* "RAS", in the notation of such files. */
#define VTP_SPACE                                                                                  \
    "<FieldData>\n<DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" "                 \
    "format=\"ascii\">82 65 83 0</DataArray>\n</FieldData>\n"

static void put_array(struct output *out, const char *type, const char *name, int components,
                      uint64_t *offset, uint64_t bytes)
{
    buf_printf(&out->bytes,
               "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
               "offset=\"%llu\"/>\n",
               type, name, components, (unsigned long long)*offset);
    *offset += 8 + bytes;
}

/* Write for each point the colour of its label, or if `bytes` is not 0, the label's number. */
static void put_of_labels(struct output *out, unsigned bytes)
{
    const struct surface *s = out->surface;
    put_number(out, (bytes ? bytes : 3) * s->points, 8);
    for (unsigned p = 0; p < s->parts; p++)
        for (size_t i = 0; i < s->part[p].points && next_item(out); i++)
            if (bytes)
                put_number(out, number_of(out, s->part[p].label), bytes);
            else
                buf_add(&out->bytes, out->label[s->part[p].label].rgb, 3);
}

static void write_vtp(struct output *out)
{
    const struct surface *s = out->surface;
    const uint64_t points = out->surface->points, triangles = out->surface->triangles;
    uint64_t offset = 0;
    unsigned label_bytes = 1;
    for (unsigned p = 0; p < s->parts; p++)
        while (number_of(out, s->part[p].label) >> (8 * label_bytes - 1) >> 1)
            label_bytes *= 2;
    buf_printf(&out->bytes,
               "<?xml version=\"1.0\"?>\n"
               "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
               "header_type=\"UInt64\">\n"
               "<!-- iftty surface: %s -->\n<PolyData>\n%s"
               "<Piece NumberOfPoints=\"%llu\" NumberOfPolys=\"%llu\">\n<Points>\n",
               out->says, out->is_of_the_world ? VTP_SPACE : "", (unsigned long long)points,
               (unsigned long long)triangles);
    put_array(out, "Float32", "Points", 3, &offset, 12 * points);
    buf_add_text(&out->bytes, "</Points>\n<PointData Scalars=\"colour\">\n");
    put_array(out, "UInt8", "colour", 3, &offset, 3 * points);
    put_array(out,
              label_bytes > 2   ? "UInt32"
              : label_bytes > 1 ? "UInt16"
                                : "UInt8",
              "label", 1, &offset, label_bytes * points);
    buf_add_text(&out->bytes, "</PointData>\n<Polys>\n");
    put_array(out, "Int64", "connectivity", 1, &offset, 24 * triangles);
    put_array(out, "Int64", "offsets", 1, &offset, 8 * triangles);
    buf_add_text(&out->bytes,
                 "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
    put_number(out, 12 * s->points, 8);
    for (size_t i = 0; i < s->points && next_item(out); i++)
        put_point(out, (uint32_t)i);
    put_of_labels(out, 0);
    put_of_labels(out, label_bytes);
    put_number(out, 24 * s->triangles, 8);
    put_triangles(out, false, 8);
    put_number(out, 8 * s->triangles, 8);
    for (size_t i = 0; i < s->triangles && next_item(out); i++)
        put_number(out, 3 * (i + 1), 8);
    buf_add_text(&out->bytes, "\n</AppendedData>\n</VTKFile>\n");
}

/* ---- files ---- */

static const struct surface_format {
    const char *ending;
    bool tells_labels;
    void (*write)(struct output *out);
} formats[] = {{".stl", false, write_stl},
               {".ply", true, write_ply},
               {".obj", true, write_obj},
               {".vtp", true, write_vtp}};

static const struct surface_format *format_of(const char *path)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (file_is_named(path, formats[i].ending))
            return &formats[i];
    return NULL;
}

enum err surface_file_check(const char *path, struct fault *fault)
{
    return format_of(path) ? OK
                           : fault_set(fault, ERR_USAGE,
                                       "cannot write %s: expected the name of a surface, .stl, "
                                       ".ply, .obj or .vtp",
                                       path);
}

bool surface_file_tells_labels(const char *path)
{
    const struct surface_format *format = format_of(path);
    return format && format->tells_labels;
}

static enum err write_draft(struct output *out, const char *path, struct watch *watch,
                            struct fault *fault)
{
    out->fd = file_step_open(out->draft, O_WRONLY | O_CREAT | O_EXCL);
    if (out->fd < 0)
        return fault_errno(fault, "write", path);
    out->fine = true;
    format_of(path)->write(out);
    flush_bytes(out);
    const int number = errno;
    const bool closed = close(out->fd) == 0;
    if (out->fine && closed && !watch_stops(watch))
        return OK;
    if (!out->fine)
        errno = number;
    const enum err err = out->bytes.failed    ? fault_memory(fault, "a surface")
                         : watch_stops(watch) ? watch_fault(watch, fault)
                                              : fault_errno(fault, "write", path);
    file_discard(out->draft);
    return err;
}

enum err surface_write(const char *path, enum file_mode mode,
                       const struct surface_document *document, struct watch *watch,
                       struct fault *fault)
{
    const struct surface *surface = document->surface;
    const struct geometry *geometry = document->geometry;
    const bool is_spaced = !geometry->spacing_unknown;
    struct output out = {.surface = surface,
                         .label = document->label,
                         .is_of_the_world =
                             is_spaced && geometry->orientation != ORIENTATION_UNKNOWN};
    OWNED(buf_release) struct buf draft = {0}, says = {0};
    buf_printf(&says, "%s%s%s",
               out.is_of_the_world ? "millimetres; SPACE=RAS" /* 3D Slicer reads SPACE */
               : is_spaced         ? "millimetres, along the axes of voxels; orientation unknown"
                                   : "voxels, along their axes",
               *document->notes ? "; " : "", document->notes);
    enum err err = says.failed ? fault_memory(fault, "a surface") : surface_file_check(path, fault);
    if (!err)
        err = find_places(&out, geometry, fault);
    if (!err)
        err = file_draft(&draft, path, mode, fault);
    if (!err) {
        out.says = buf_text(&says);
        out.draft = buf_text(&draft);
        out.task = task_begin(watch, "writing", surface->points + surface->triangles);
        err = write_draft(&out, path, watch, fault);
    }
    if (!err)
        err = file_publish(out.draft, path, mode, fault);
    buf_release(&out.bytes);
    free(out.mm);
    return err;
}
