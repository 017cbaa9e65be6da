/* What the readers of DICOM share of data sets. */
#ifndef IMAGE_VOLUME_DICOM_HH
#define IMAGE_VOLUME_DICOM_HH

#include <string>
#include <vector>

#include <gdcmDataSet.h>

#include "image/volume_parts.hh"

namespace volume
{

/* The text of an element without the blanks at its end; "" where there is none. */
std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag);

/* NULL where there is none. */
const gdcm::ByteValue *value_of(const gdcm::DataSet &set, const gdcm::Tag &tag);

/* Takes a value of that length, of numbers in the order of this machine; false for no such one. */
bool take_bytes(void *out, size_t length, const gdcm::DataSet &set, const gdcm::Tag &tag);

/* Takes a binary number of 16 or 32 bits. */
void take_binary(unsigned &out, const gdcm::DataSet &set, const gdcm::Tag &tag);

void take_decimal(double &out, const gdcm::DataSet &set, const gdcm::Tag &tag);

/* ---- what a series is told by (volume_choice.cc) ---- */

void take_words(Slice &slice, const gdcm::DataSet &set);

/* ---- mosaics (volume_mosaic.cc) ---- */

/* Where the owner has that private element; of group 0 where it has none. */
gdcm::Tag find_private(const gdcm::DataSet &set, uint16_t group, uint16_t element,
                       const char *owner);

/* The images of a mosaic in their places, or `first` with what is wrong with it; false where it is
 * no mosaic. */
bool add_mosaic(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set);

} // namespace volume

#endif
