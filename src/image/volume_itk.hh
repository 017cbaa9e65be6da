/* ITK's readers, by their names in requests. */
#ifndef IMAGE_VOLUME_ITK_HH
#define IMAGE_VOLUME_ITK_HH

#include <string>

#include <itkImageIOBase.h>

#include "image/volume_parts.hh"

namespace volume
{

/* How a format says where its voxels lie. */
enum class World { LPS, RAS, NONE };

struct Kind {
    const char *name, *format;
    itk::ImageIOBase::Pointer (*make)();
    World world;
    unsigned known; /* of a format that always says it */
};

/* NULL for none; of "any", the first that takes the file. */
const Kind *find_kind(const std::string &name, const std::string &path);

const char *type_of(itk::ImageIOBase &io);
itk::ImageIORegion whole_region(itk::ImageIOBase &io);

/* What the resolution of a picture says of its pixels: many programs write one without knowing, and
 * none says how far apart slices are. So it is told, and not taken. */
void note_resolution(Volume &volume, itk::ImageIOBase &io);

} // namespace volume

#endif
