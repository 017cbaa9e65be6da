/*
 * DICOM: the mosaics of Siemens, whose one picture holds all slices of a volume side by side.
 *
 *     0 1 2     N images lie in rows from the top, in a square of as few as hold them; what is
 *     3 4 5     left of it is blank. N, and the side towards which slices follow each other, are
 *     6 . .     said by the private header alone (csa.h).
 *
 * The place that the file says is that of a slice as large as the whole square around the middle
 * of the first one: its corner is moved back by half of what the square is larger. So it is in
 * nibabel (nicom, MosaicWrapper) and in SPM; GDCM has a splitter, which takes the middle of a slice
 * for its corner and, where nothing says N, a number that fits.
 */
#include "image/volume_dicom.hh"

#include <algorithm>
#include <cmath>
#include <cstring>

extern "C" {
#include "image/csa.h"
}

namespace volume
{

static const gdcm::Tag type_tag(0x0008, 0x0008), matrix_tag(0x0018, 0x1310);

/* Blocks of private elements that are looked into. */
constexpr uint16_t first_block = 0x10, last_block = 0x1f;
constexpr uint16_t csa_group = 0x0029, csa_element = 0x10;
constexpr uint16_t count_group = 0x0019, count_element = 0x0a;
constexpr unsigned images_most = 4096;

gdcm::Tag owner_tag(uint16_t group, uint16_t block)
{
    return {group, block};
}

gdcm::Tag private_tag(uint16_t group, uint16_t block, uint16_t element)
{
    return {group, static_cast<uint16_t>(block << 8 | element)};
}

gdcm::Tag find_private(const gdcm::DataSet &set, uint16_t group, uint16_t element,
                       const char *owner)
{
    for (uint16_t block = first_block; block <= last_block; block++)
        if (text_of(set, owner_tag(group, block)) == owner)
            return private_tag(group, block, element);
    return {0, 0};
}

bool is_called_mosaic(const gdcm::DataSet &set)
{
    const std::string type = "\\" + text_of(set, type_tag) + "\\";
    return type.find("\\MOSAIC\\") != std::string::npos;
}

/* What the private header says. */
struct Private {
    unsigned images = 0; /* 0: nothing says so */
    bool is_contrary = false;
    double normal[3] = {0, 0, 0};
    bool has_normal = false;
};

Private private_of(const gdcm::DataSet &set)
{
    Private header;
    unsigned beside = 0;
    take_binary(beside, set, find_private(set, count_group, count_element, "SIEMENS MR HEADER"));
    header.images = beside;
    const gdcm::Tag tag = find_private(set, csa_group, csa_element, "SIEMENS CSA HEADER");
    const gdcm::ByteValue *value = value_of(set, tag);
    if (!value)
        return header;
    const auto *bytes = reinterpret_cast<const uint8_t *>(value->GetPointer());
    const size_t length = value->GetLength();
    double images = 0;
    if (csa_numbers(&images, 1, bytes, length, "NumberOfImagesInMosaic") == 1 && images >= 0 &&
        images <= images_most && images == std::floor(images))
        header.images = static_cast<unsigned>(images);
    header.is_contrary = beside && beside != header.images;
    header.has_normal = csa_numbers(header.normal, 3, bytes, length, "SliceNormalVector") == 3;
    return header;
}

/* The least square that holds so many. */
unsigned side_of(unsigned images)
{
    unsigned side = 1;
    while (side * side < images)
        side++;
    return side;
}

/* Whether so many images lie side by side in it. An image that was cut out of a mosaic may still
 * have its header: then they would be far smaller than what was acquired. */
bool holds(const Slice &whole, unsigned images, const gdcm::DataSet &set)
{
    const unsigned side = side_of(images);
    uint16_t matrix[4] = {0, 0, 0, 0};
    take_bytes(matrix, sizeof matrix, set, matrix_tag);
    const unsigned acquired = *std::max_element(matrix, matrix + 4);
    return whole.columns % side == 0 && whole.rows % side == 0 &&
           2 * std::max(whole.columns, whole.rows) / side >= acquired;
}

/* From one image to the next in the patient; false where that is not said. */
bool take_step(double step[3], const Slice &whole, const Private &header)
{
    const double apart = whole.between > 0 ? whole.between : whole.thickness;
    double normal[3], along = 0;
    normal_of(normal, whole.axis);
    for (int w = 0; w < 3; w++)
        along += normal[w] * header.normal[w];
    for (int w = 0; w < 3; w++)
        step[w] = normal[w] * (along < 0 ? -apart : apart);
    return header.has_normal && std::fabs(std::fabs(along) - 1) < 1e-2 && apart > 0 &&
           whole.has_position && whole.has_axes && whole.spacing[0] > 0;
}

void add_images(std::vector<Slice> &slices, const Slice &whole, unsigned images,
                const double step[3])
{
    Slice slice = whole;
    slice.tiles = side_of(images);
    slice.images = images;
    slice.frames = slice.tiles * slice.tiles;
    slice.columns /= slice.tiles;
    slice.rows /= slice.tiles;
    for (int w = 0; w < 3; w++)
        slice.position[w] +=
            whole.axis[w] * whole.spacing[1] * (whole.columns - slice.columns) / 2.0 +
            whole.axis[3 + w] * whole.spacing[0] * (whole.rows - slice.rows) / 2.0;
    for (unsigned i = 0; i < images; i++) {
        slice.frame = i;
        slices.push_back(slice);
        for (int w = 0; w < 3; w++)
            slice.position[w] += step[w];
    }
}

bool add_mosaic(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set)
{
    const bool is_called = is_called_mosaic(set);
    const Private header = private_of(set);
    const bool fits = header.images > 0 && holds(first, header.images, set);
    double step[3];
    if (!is_called && !fits && !header.is_contrary)
        return false;
    Slice whole = first;
    if (header.images == 0)
        whole.fault = "a mosaic, and nothing says how many images it holds: the private header "
                      "that does (Siemens CSA) is missing, as after some ways to anonymise, or is "
                      "damaged; export it again with that, or as single slices";
    else if (header.is_contrary)
        whole.fault = "a mosaic, and two of its private elements (Siemens) do not say the same of "
                      "how many images it holds; export it again as single slices";
    else if (!fits)
        whole.fault = words_of("a mosaic that is said to hold %u images, which do not fit "
                               "side by side into its %ux%u pixels; export it again as single "
                               "slices",
                               header.images, first.columns, first.rows);
    else if (!take_step(step, first, header))
        whole.fault = "a mosaic that does not say where its images lie, or towards which side they "
                      "follow each other (SliceNormalVector in the private header, Siemens CSA); "
                      "export it again with that, or as single slices";
    if (!whole.fault.empty())
        slices.push_back(whole);
    else
        add_images(slices, first, header.images, step);
    return true;
}

/* ---- pixels ---- */

/* What is left of the square is blank: where it is not, there are more images than is said. */
void check_blank(const char *tile, size_t pixels, size_t width)
{
    for (size_t i = 1; i < pixels; i++)
        if (std::memcmp(tile, tile + i * width, width) != 0)
            refuse("a mosaic that holds more images than its private header says");
}

void split_mosaic(std::vector<char> &bytes, const Slice &slice)
{
    const size_t width = slice.bits / 8, row = slice.columns * width, image = row * slice.rows;
    std::vector<char> split(bytes.size());
    for (size_t i = 0; i < slice.frames; i++) {
        const size_t corner = i / slice.tiles * image * slice.tiles + i % slice.tiles * row;
        for (size_t y = 0; y < slice.rows; y++)
            std::memcpy(&split[i * image + y * row], &bytes[corner + y * row * slice.tiles], row);
        if (i >= slice.images)
            check_blank(&split[i * image], image / width, width);
    }
    bytes.swap(split);
}

} // namespace volume
