#include "image/pair.h"

#include <ctype.h>
#include <string.h>

#include "base/file.h"
#include "image/nifti_header.h"

#define BOTH     "; expected both files of the pair"
#define EXCHANGE "; the .hdr and the .img may have each other's names"

enum { ENDING = 4 /* ".hdr" or ".img" */ };

static bool is_voxels(const char *path)
{
    return file_is_named(path, PAIR_VOXELS);
}

/* Its ending in small letters or capitals, as that of `path` is. */
static void name_other(struct buf *other, const char *path, const char *end, bool is_packed)
{
    const char *to = is_voxels(path) ? ".hdr" : ".img";
    buf_clear(other);
    buf_add(other, path, (size_t)(end - path));
    for (int i = 0; i < ENDING; i++)
        buf_add_char(other, (char)(isupper((unsigned char)end[i]) ? toupper(to[i]) : to[i]));
    buf_add_text(other, !is_packed ? "" : end[ENDING] ? end + ENDING : ".gz");
}

bool pair_other(struct buf *other, const char *path)
{
    const char *end = file_ending(path, PAIR_HEADERS "|" PAIR_VOXELS);
    buf_clear(other);
    if (!end)
        return false;
    const bool is_packed = end[ENDING] != '\0';
    for (int i = 0; i < 2; i++) {
        name_other(other, path, end, i ? !is_packed : is_packed);
        if (!other->failed && file_exists(buf_text(other)))
            return true;
    }
    name_other(other, path, end, is_packed);
    return false;
}

enum err pair_check_header(const char *path, struct fault *fault)
{
    if (file_is_named(path, PAIR_HEADERS))
        return OK;
    if (is_voxels(path))
        return fault_set(fault, ERR_INPUT,
                         "it begins with a header, and its name is that of the voxels" EXCHANGE);
    return fault_set(fault, ERR_INPUT,
                     "the header of a pair, ANALYZE or NIfTI, by its magic, which is neither "
                     "\"n+1\" nor \"n+2\"; expected the names A.hdr and A.img");
}

/* What it is called, and where it should be, is said where there is none. */
static enum err go_to_other(struct volume_source *source, bool to_voxels, struct fault *fault)
{
    struct buf other = {0};
    enum err err;
    if (pair_other(&other, source->path)) {
        err = source_switch(source, buf_text(&other), fault);
        if (err)
            fault_prefix(fault, err, "%s", file_name(buf_text(&other)));
    } else if (to_voxels)
        err = fault_set(fault, ERR_IO, "there is no %s beside it, with its voxels" BOTH,
                        file_name(buf_text(&other)));
    else
        err = fault_set(fault, ERR_IO,
                        "there is no %s beside it, with its header" BOTH
                        "; `open raw:FILE size=X,Y,Z type=T` reads voxels without one",
                        file_name(buf_text(&other)));
    err = other.failed ? fault_memory(fault, "a path") : err;
    buf_release(&other);
    return err;
}

enum err pair_go_to_header(struct volume_source *source, struct fault *fault)
{
    uint8_t begin[NIFTI_LEAST_BYTES];
    if (is_voxels(source->path))
        return go_to_other(source, false, fault);
    if (go_to_other(source, false, NULL) == OK &&
        nifti_header_is_one(begin, source_peek(source, begin, sizeof begin)))
        return fault_set(fault, ERR_INPUT, "it begins with no header, and its .img does" EXCHANGE);
    return fault_set(fault, ERR_INPUT,
                     "no header of ANALYZE or NIfTI: its first four bytes are neither 348 nor 540");
}

enum err pair_go_to_voxels(struct volume_source *source, struct fault *fault)
{
    return is_voxels(source->path) ? source_switch(source, source->path, fault)
                                   : go_to_other(source, true, fault);
}
