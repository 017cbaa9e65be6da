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

#include <itkImageIOBase.h>

#include "image/volume_parts.hh"

namespace volume
{

/* The fields of a header of lines "NAME: VALUE" or "NAME = VALUE" (volume_itk.cc). */
std::string in_small_letters(std::string text);
std::map<std::string, std::string> fields_of(const std::string &path, char between,
                                             const std::string &last);

/* The last name of a path, in letters that are safe to print. */
std::string last_name(const std::string &path);

/* Of the first kind of formats, before a library reads one; nothing of others. `what` begins the
 * words of a refusal: "slice 3 of 9 is ", or "" for the file that was asked for. */
void count_parts(const std::string &kind, const std::string &path, const std::string &what);

/* Of the second, once its header is known: of voxels that are packed, or written as text, when they
 * are to be sent. */
void count_voxels(Volume &volume, const std::string &kind, const std::string &path,
                  const itk::ImageIOBase &io);

} // namespace volume

#endif
