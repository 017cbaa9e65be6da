/* SPDX-License-Identifier: MIT */
#include "image/strips.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/least.h"
#include "base/mem.h"

/* One in the making; `rows` has no pixels before some are lent, and after it is packed. */
struct strip {
    struct picture rows;
    uint32_t missing; /* rows that are not given yet */
};

struct strips {
    const struct strips_format *format;
    void *coder;
    char *path;
    enum file_mode mode;
    struct picture like; /* sizes and kinds alone */
    unsigned planes;
    uint32_t height;             /* rows of a strip */
    struct strip *strip;         /* [pieces.count] */
    struct strips_pieces pieces; /* owns its array and descriptor */
    uint64_t end;

    pthread_mutex_t lock; /* protects strips, pieces, and the following members */
    struct picture spare; /* the memory of a packed strip */
    enum err err;         /* the first */
    struct fault fault;
};

/* ---- beginning and end ---- */

void strips_abandon(struct strips *s)
{
    if (!s)
        return;
    for (size_t i = 0; s->strip && i < s->pieces.count; i++)
        picture_release(&s->strip[i].rows);
    picture_release(&s->spare);
    if (s->coder)
        s->format->end(s->coder);
    if (s->pieces.fd >= 0)
        close(s->pieces.fd);
    pthread_mutex_destroy(&s->lock);
    free(s->strip);
    free(s->pieces.piece);
    free(s->path);
    free(s);
}

enum err strips_begin(struct strips **out, const struct strips_format *format, const char *path,
                      enum file_mode mode, const struct picture *like, unsigned planes,
                      struct fault *fault)
{
    struct strips *s = mem_new(sizeof *s);
    OWNED(buf_release) struct buf draft = {0};
    *out = NULL;
    if (!s)
        return fault_memory(fault, path);
    pthread_mutex_init(&s->lock, NULL);
    struct strips_pieces *pieces = &s->pieces;
    pieces->fd = -1;
    s->format = format;
    s->mode = mode;
    s->planes = format->holds_planes ? planes : 0;
    s->like = (struct picture){.width = like->width,
                               .height = like->height,
                               .is_clear = like->is_clear,
                               .is_associated = like->is_associated,
                               .tiled = like->tiled,
                               .space = like->space};
    s->height = s->format->height(like);
    pieces->count = (like->height + s->height - 1) / s->height;
    pieces->path = s->path = strdup(path);
    s->strip = mem_new(pieces->count * sizeof *s->strip);
    pieces->piece = mem_new(pieces->count * sizeof *pieces->piece);
    enum err err = s->path && s->strip && pieces->piece ? OK : fault_memory(fault, path);
    for (size_t i = 0; !err && i < pieces->count; i++)
        s->strip[i].missing = pieces->piece[i].rows =
            least(s->height, like->height - (uint32_t)i * s->height);
    if (!err)
        err = s->format->begin(&s->coder, path, like, planes, fault);
    if (!err)
        err = file_draft(&draft, path, mode, fault); /* on the disk of the final file */
    if (!err)
        pieces->fd = file_step_open(buf_text(&draft), O_RDWR | O_CREAT | O_EXCL);
    if (!err && pieces->fd < 0)
        err = fault_errno(fault, "write", path);
    if (!err)
        file_discard(buf_text(&draft)); /* it stays open, without a name */
    if (err)
        strips_abandon(s);
    else
        *out = s;
    return err;
}

enum err strips_end(struct strips *s, const struct picture *like, struct fault *fault)
{
    OWNED(buf_release) struct buf draft = {0};
    enum err err = s->err ? fault_set(fault, s->err, "%s", s->fault.text) : OK;
    if (!err)
        err = file_draft(&draft, s->path, s->mode, fault);
    if (!err) {
        err = s->format->write(s->coder, buf_text(&draft), like, &s->pieces, fault);
        if (err)
            file_discard(buf_text(&draft));
        else
            err = file_publish(buf_text(&draft), s->path, s->mode, fault);
    }
    strips_abandon(s);
    return err;
}

/* ---- rows ---- */

/* Mark rows as the picture of the file is marked. */
static struct picture of_kind(const struct strips *s, struct picture rows)
{
    rows.is_clear = s->like.is_clear;
    rows.is_associated = s->like.is_associated;
    rows.tiled = s->like.tiled;
    rows.space = s->like.space;
    return rows;
}

uint32_t strips_lend(struct strips *s, uint32_t top, uint32_t most, struct picture *rows)
{
    const uint32_t number = top / s->height, first = number * s->height, above = top - first;
    const uint32_t height = least(s->height, s->like.height - first);
    struct strip *strip = &s->strip[number];
    pthread_mutex_lock(&s->lock);
    if (!s->err && !strip->rows.rgba && s->spare.rgba && s->spare.height == height) {
        strip->rows = s->spare;
        s->spare = (struct picture){0};
    } else if (!s->err && !strip->rows.rgba)
        s->err = picture_init(&strip->rows, s->like.width, height, s->planes, &s->fault);
    const bool fine = !s->err;
    pthread_mutex_unlock(&s->lock);
    if (!fine)
        return 0;
    *rows = of_kind(s, picture_rows(&strip->rows, above, least(most, height - above)));
    return rows->height;
}

void strips_give(struct strips *s, uint32_t top, uint32_t rows)
{
    const uint32_t number = top / s->height;
    struct strip *strip = &s->strip[number];
    struct strips_piece *piece = &s->pieces.piece[number];
    const int fd = s->pieces.fd;
    struct fault fault = {0};
    OWNED(buf_release) struct buf packed = {0};
    uint32_t check = 0;
    pthread_mutex_lock(&s->lock);
    strip->missing -= rows;
    const bool is_whole = !strip->missing && strip->rows.rgba;
    pthread_mutex_unlock(&s->lock);
    if (!is_whole)
        return;
    const struct picture all = of_kind(s, strip->rows);
    enum err err = s->format->pack(s->coder, &all, number * s->height, &packed, &check, &fault);
    pthread_mutex_lock(&s->lock);
    if (err && !s->err)
        s->fault = fault;
    if (!err && !s->err &&
        (lseek(fd, (off_t)s->end, SEEK_SET) < 0 ||
         !file_step_write(fd, s->path, buf_text(&packed), packed.length)))
        err = fault_errno(&s->fault, "write", s->path);
    s->err = s->err ? s->err : err;
    piece->from = s->end;
    piece->bytes = packed.length;
    piece->check = check;
    s->end += packed.length;
    picture_release(&s->spare);
    s->spare = strip->rows;
    strip->rows = (struct picture){0};
    pthread_mutex_unlock(&s->lock);
}

enum err strips_write(const struct strips_format *format, const char *path, enum file_mode mode,
                      const struct picture *picture, struct fault *fault)
{
    struct strips *s;
    struct picture to;
    TRY(strips_begin(&s, format, path, mode, picture, picture_planes(picture), fault));
    for (uint32_t y = 0, n; y < picture->height; y += n) {
        n = strips_lend(s, y, picture->height - y, &to);
        const struct picture from = picture_rows(picture, y, n);
        const size_t pixels = (size_t)n * picture->width;
        if (!n)
            break;
        memcpy(to.rgba, format->holds_planes ? from.rgba : picture_colours(&from), 4 * pixels);
        if (to.depth_mm)
            memcpy(to.depth_mm, from.depth_mm, pixels * sizeof *to.depth_mm);
        if (to.label)
            memcpy(to.label, from.label, pixels * sizeof *to.label);
        if (to.voxel)
            memcpy(to.voxel, from.voxel, pixels * sizeof *to.voxel);
        if (to.normal)
            memcpy(to.normal, from.normal, 3 * pixels * sizeof *to.normal);
        strips_give(s, y, n);
    }
    return strips_end(s, picture, fault);
}

enum err strips_read(const struct strips_pieces *pieces, size_t number, struct buf *out,
                     struct fault *fault)
{
    const struct strips_piece *piece = &pieces->piece[number];
    buf_clear(out);
    void *to = buf_reserve(out, piece->bytes);
    if (!to)
        return fault_memory(fault, pieces->path);
    errno = EIO; /* for a file that is shorter than it was written */
    if (file_read_at(pieces->fd, to, piece->bytes, piece->from) != (ssize_t)piece->bytes)
        return fault_errno(fault, "write", pieces->path);
    out->length = piece->bytes;
    return OK;
}
