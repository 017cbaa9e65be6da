/* SPDX-License-Identifier: MIT */
#include "image/nrrd_voxels.h"

#include <stdlib.h>

#include "base/mem.h"
#include "image/inflated.h"
#include "image/part.h"

struct voxels {
    struct source_decoder decoder; /* first: what the source knows of it */
    struct volume_source file;     /* of gzip from where that begins */
    enum voxel_type type;
    bool big_endian, is_packed;
    uint64_t offset, at, needed; /* bytes: before the voxels; of them, that were taken, and all */
};

uint64_t nrrd_voxels_bytes(const struct nrrd_header *header)
{
    return (uint64_t)header->size[0] * header->size[1] * header->size[2] *
           voxel_bytes(header->type);
}

/* ---- what is wrong ---- */

/* Why packed voxels could not be had: in place of `err`, if that is about what is in the file. OK
 * where they are whole, and what follows them is not. */
static enum err judge(const struct voxels *voxels, enum err err, struct fault *fault)
{
    bool ends;
    if (err != ERR_INPUT || !voxels->is_packed)
        return err;
    const uint64_t needed = voxels->needed, bytes = inflated_bytes(voxels->file.fd, voxels->offset,
                                                                   UINT64_MAX, needed, &ends);
    if (ends && bytes >= needed)
        return OK;
    return fault_set(fault, ERR_INPUT, INFLATED_LACKS, "", (unsigned long long)bytes,
                     bytes < needed ? "" : INFLATED_CHECKSUM, (unsigned long long)needed);
}

/* ---- as a source ---- */

static enum err take_voxels(struct source_decoder *decoder, void *to, size_t length,
                            struct fault *fault)
{
    struct voxels *voxels = (struct voxels *)decoder;
    enum err err = source_read(&voxels->file, to, length, "the voxels", NULL, fault);
    if (err) {
        const enum err why = judge(voxels, err, fault);
        return why ? why : err;
    }
    voxels->at += length;
    voxels_reorder(to, length / voxel_bytes(voxels->type), voxels->type, voxels->big_endian);
    if (voxels->at == voxels->needed)
        err = source_finish(&voxels->file, fault);
    return judge(voxels, err, fault);
}

static void free_voxels(struct source_decoder *decoder)
{
    struct voxels *voxels = (struct voxels *)decoder;
    source_close(&voxels->file);
    free(voxels);
}

enum err nrrd_voxels_enter(struct volume_source *source, const struct nrrd_header *header,
                           struct fault *fault)
{
    struct voxels *voxels = mem_new(sizeof *voxels);
    if (!voxels)
        return fault_memory(fault, "the voxels");
    *voxels = (struct voxels){.decoder = {take_voxels, free_voxels},
                              .type = header->type,
                              .big_endian = header->big_endian,
                              .is_packed = header->is_packed,
                              .offset = header->offset,
                              .needed = nrrd_voxels_bytes(header)};
    const enum err err =
        source_enter(&voxels->file, source, header->is_packed ? header->offset : 0, fault);
    if (err || voxels->file.packed != header->is_packed)
        free_voxels(&voxels->decoder);
    else
        source->decoder = &voxels->decoder;
    return err;
}

bool nrrd_voxels_are_of(const struct volume_source *source)
{
    return source->decoder->take == take_voxels;
}

/* Goes through all of them, so that those that are taken in part are sound as a whole. */
static enum err pass(struct voxels *voxels, struct fault *fault)
{
    uint8_t last;
    enum err err = source_go_to(&voxels->file, voxels->needed - 1, "the voxels", fault);
    if (!err)
        err = source_read(&voxels->file, &last, 1, "the voxels", NULL, fault);
    if (!err)
        err = source_finish(&voxels->file, fault);
    return judge(voxels, err, fault);
}

enum err nrrd_voxels_begin(struct volume_source *source, const struct volume_header *header,
                           struct fault *fault)
{
    struct voxels *voxels = (struct voxels *)source->decoder;
    enum err err = OK;
    if (voxels->is_packed && voxels->file.most < voxels->needed)
        err = judge(voxels, ERR_INPUT, fault); /* before anything of their size is allocated */
    else if (voxels->is_packed && part_is_less(header))
        err = pass(voxels, fault);
    return err ? err
               : source_go_to(&voxels->file, voxels->is_packed ? 0 : voxels->offset, "the voxels",
                              fault);
}
