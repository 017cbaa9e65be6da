/*
 * Bytes counted: whether a file is as long as its header promises, before a library fills up with
 * zeros what is missing.
 *
 * Formats whose parts say where they lie (TIFF, PNG, HDF5, netCDF, which MINC 1 is) are gone
 * through part by part; of the others the voxels are one run of bytes, in the file or beside it.
 * What a file has more than its header promises is nobody's concern.
 */
#ifndef IMAGE_VOLUME_BYTES_HH
#define IMAGE_VOLUME_BYTES_HH

#include <map>
#include <string>

#include "image/volume_parts.hh"

namespace volume
{

/* The header of a NRRD or MetaImage, which is one of lines. */
struct Header {
    /* Of names in small letters, without the blanks around them. */
    std::map<std::string, std::string> field;
    uint64_t end = 0; /* how many bytes it has; 0 where it does not end */

    std::string value(const char *name) const; /* "" for none */
};

Header header_of(const std::string &kind, const std::string &path); /* volume_itk.cc */

/* Of the first kind of formats, before a library reads one; nothing of others. `what` begins the
 * words of a refusal: "slice 3 of 9 is ", or "" for the file that was asked for. */
void count_parts(const std::string &kind, const std::string &path, const std::string &what);

/* Of the second, once its header is known: of voxels that are packed, or written as text, when they
 * are to be sent. */
void count_voxels(Volume &volume, const std::string &kind, const Request &request);

} // namespace volume

#endif
