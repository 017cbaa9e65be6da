/* SPDX-License-Identifier: MIT */
/*
 * DICOM: read the header of a file with its slices or the images of a mosaic, find its pixels,
 * check that they are complete, and read them.
 *
 * GDCM reads headers and unpacks pixels. It fills cut files with zeros and reads big-endian numbers
 * of 32 bits as two of 16, so plain pixels are read here.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <istream>
#include <set>
#include <sstream>

#include <gdcmDataSet.h>
#include <gdcmDicts.h>
#include <gdcmGlobal.h>
#include <gdcmPixmapReader.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmUIDs.h>
#include <zlib.h>

extern "C" {
#include "helper/csa.h"
}

namespace volume
{

constexpr uint64_t undefined_length = 0xffffffff;
constexpr size_t inflated_most = size_t{256} << 20;
constexpr size_t description_most = 64; /* a long string in DICOM */
constexpr size_t private_least = 3;     /* letters of a name that are searched for */

static const gdcm::Tag frames_tag(0x0028, 0x0008), shared_tag(0x5200, 0x9229),
    each_tag(0x5200, 0x9230), detector_tag(0x0054, 0x0022), offsets_tag(0x3004, 0x000c),
    description_tag(0x0008, 0x103e), name_tag(0x0010, 0x0010), id_tag(0x0010, 0x0020),
    birth_tag(0x0010, 0x0030), type_tag(0x0008, 0x0008);

/* ---- bytes of a file ---- */

/* Inflate the rest of a file, up to its end or to the first damaged byte. */
std::string inflate_rest(std::istream &file)
{
    std::string out;
    std::vector<char> packed(1 << 16), plain(1 << 20);
    z_stream zlib = {};
    int state = inflateInit2(&zlib, -MAX_WBITS);
    while (state == Z_OK && (file.read(packed.data(), 1 << 16), file.gcount() > 0)) {
        zlib.next_in = reinterpret_cast<Bytef *>(packed.data());
        zlib.avail_in = static_cast<unsigned>(file.gcount());
        do {
            zlib.next_out = reinterpret_cast<Bytef *>(plain.data());
            zlib.avail_out = 1 << 20;
            state = inflate(&zlib, Z_NO_FLUSH);
            out.append(plain.data(), plain.size() - zlib.avail_out);
            if (out.size() > inflated_most) {
                inflateEnd(&zlib);
                refuse("a deflated DICOM file of more than %zu MB when it is inflated; `dcmconv "
                       "+te FILE PLAIN` inflates it",
                       inflated_most >> 20);
            }
        } while (state == Z_OK && zlib.avail_out == 0);
        state = state == Z_BUF_ERROR ? Z_OK : state; /* more input is needed */
    }
    inflateEnd(&zlib);
    return out;
}

/* Test whether the first bytes may be DICOM, with or without a preamble. */
bool may_be_dicom(const char *bytes, std::streamsize length)
{
    if (length >= 132 && std::memcmp(bytes + 128, "DICM", 4) == 0)
        return true;
    return length >= 16 && ((bytes[1] == 0 && (bytes[0] == 2 || bytes[0] == 8) && bytes[3] == 0) ||
                            (bytes[0] == 0 && bytes[1] == 8 && bytes[2] == 0));
}

/* GDCM cannot seek in deflated data sets, so an inflated copy replaces them. */
std::unique_ptr<std::istream> open_bytes(const std::string &path)
{
    static const char syntax[] = "\x02\0\x10\0UI\x16\0"
                                 "1.2.840.10008.1.2.1.99";
    static const char plain[] = "DICM\x02\0\0\0UL\x04\0\x1c\0\0\0\x02\0\x10\0UI\x14\0"
                                "1.2.840.10008.1.2.1";
    char begin[1024] = {0};
    auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
    file->read(begin, sizeof begin);
    const std::streamsize length = file->gcount();
    if (!may_be_dicom(begin, length))
        return nullptr;
    file->clear();
    file->seekg(0);
    if (length < 144 || std::memcmp(begin + 128, "DICM\x02\0\0\0UL\x04\0", 12) != 0 ||
        std::search(begin + 144, begin + length, syntax, syntax + sizeof syntax - 1) ==
            begin + length)
        return file;
    file->seekg(static_cast<std::streamoff>(144 + number_in(begin + 140, 4, false)));
    return std::make_unique<std::istringstream>(
        std::string(128, '\0') + std::string(plain, sizeof plain) + inflate_rest(*file));
}

/* ---- elements ---- */

/* NULL if there is no such element. */
const gdcm::ByteValue *value_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    return set.FindDataElement(tag) ? set.GetDataElement(tag).GetByteValue() : nullptr;
}

bool take_bytes(void *out, size_t length, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value = value_of(set, tag);
    if (!value || value->GetLength() != length)
        return false;
    std::memcpy(out, value->GetPointer(), length);
    return true;
}

std::string raw_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value = value_of(set, tag);
    return value ? std::string(value->GetPointer(), value->GetLength()) : "";
}

std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    std::string text = raw_of(set, tag);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
        text.pop_back();
    return text;
}

size_t decimals_of(std::string &fault, const gdcm::DataSet &set, const gdcm::Tag &tag, double *out,
                   size_t most)
{
    const std::string text = text_of(set, tag);
    const char *at = text.c_str();
    size_t count = 0;
    while (count < most && *at) {
        char *end;
        const double number = std::strtod(at, &end);
        while (*end == ' ')
            end++;
        const bool is_number = end > at && text.find_first_of("xXnNiI") == std::string::npos;
        if ((*end && *end != '\\') || (is_number && !std::isfinite(number))) {
            const gdcm::DictEntry &entry =
                gdcm::Global::GetInstance().GetDicts().GetDictEntry(tag, nullptr);
            fault =
                words_of("a file whose %s (%04x,%04x) is no decimal number with a point, such as "
                         "1.5; `dcmodify -m %04x,%04x=NUMBER FILE` corrects it",
                         entry.GetName(), tag.GetGroup(), tag.GetElement(), tag.GetGroup(),
                         tag.GetElement());
            return 0;
        }
        if (!is_number) /* empty */
            break;
        out[count++] = number;
        at = *end ? end + 1 : end;
    }
    return count;
}

void take_decimal(Slice &slice, double &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    if (decimals_of(slice.fault, set, tag, &number, 1) == 1)
        out = number;
}

/* A malformed number counts as missing. */
void take_integer(int &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    std::string fault;
    if (decimals_of(fault, set, tag, &number, 1) == 1 && std::fabs(number) < 1e9)
        out = static_cast<int>(number);
}

void take_binary(unsigned &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    uint16_t half;
    uint32_t whole;
    if (take_bytes(&half, sizeof half, set, tag))
        out = half;
    else if (take_bytes(&whole, sizeof whole, set, tag))
        out = whole;
}

gdcm::Tag find_private(const gdcm::DataSet &set, uint16_t group, uint16_t element,
                       const char *owner)
{
    constexpr uint16_t first_block = 0x10, last_block = 0x1f;
    for (uint16_t block = first_block; block <= last_block; block++)
        if (text_of(set, {group, block}) == owner)
            return {group, static_cast<uint16_t>(block << 8 | element)};
    return {0, 0};
}

/* ---- descriptions of a series ---- */

/* Test whether a text contains a part of another, split at `ends`. */
bool has_part(const std::string &text, const std::string &of, const char *ends)
{
    for (size_t from = 0; from < of.size();) {
        const size_t to = std::min(of.find_first_of(ends, from), of.size());
        if (to - from >= private_least &&
            text.find(of.substr(from, to - from)) != std::string::npos)
            return true;
        from = to + 1;
    }
    return false;
}

std::string description_of(const std::string &said)
{
    std::string text = printable(said, description_most);
    std::replace(text.begin(), text.end(), '"', '?');
    return text;
}

std::string kind_of(const std::string &image_type)
{
    static const std::pair<const char *, const char *> kinds[] = {
        {"\\P\\", "phase"},     {"\\PHASE\\", "phase"},         {"\\R\\", "real"},
        {"\\REAL\\", "real"},   {"\\I\\", "imaginary"},         {"\\IMAGINARY\\", "imaginary"},
        {"\\M\\", "magnitude"}, {"\\MAGNITUDE\\", "magnitude"}, {"\\LOCALIZER\\", "localizer"}};
    const std::string type = "\\" + image_type + "\\";
    for (const auto &kind : kinds)
        if (type.find(kind.first) != std::string::npos)
            return kind.second;
    return "";
}

void take_words(Slice &slice, const gdcm::DataSet &set)
{
    const std::string said = text_of(set, description_tag), small = in_small_letters(said);
    slice.description = description_of(said);
    slice.names_patient = has_part(small, in_small_letters(text_of(set, name_tag)), "^=\\ ,.-") ||
                          has_part(small, in_small_letters(text_of(set, id_tag)), "\\") ||
                          has_part(small, text_of(set, birth_tag), "\\");
}

/* ---- slices ---- */

/* Test for two orthogonal unit vectors, within the error of decimals. */
bool are_axes(const double axis[6])
{
    double one = 0, two = 0, dot = 0;
    for (int w = 0; w < 3; w++) {
        one += axis[w] * axis[w];
        two += axis[w + 3] * axis[w + 3];
        dot += axis[w] * axis[w + 3];
    }
    return std::fabs(one - 1) < 0.01 && std::fabs(two - 1) < 0.01 && std::fabs(dot) < 0.01;
}

void take_place(Slice &slice, const gdcm::DataSet &set)
{
    double number[6];
    if (decimals_of(slice.fault, set, gdcm::Tag(0x0020, 0x0032), number, 3) == 3) {
        std::copy(number, number + 3, slice.position);
        slice.has_position = true;
    }
    if (decimals_of(slice.fault, set, gdcm::Tag(0x0020, 0x0037), number, 6) == 6 &&
        are_axes(number)) {
        std::copy(number, number + 6, slice.axis);
        slice.has_axes = true;
    }
    if (decimals_of(slice.fault, set, gdcm::Tag(0x0028, 0x0030), number, 2) == 2 && number[0] > 0 &&
        number[1] > 0)
        std::copy(number, number + 2, slice.spacing);
    take_decimal(slice, slice.between, set, gdcm::Tag(0x0018, 0x0088));
    take_decimal(slice, slice.thickness, set, gdcm::Tag(0x0018, 0x0050));
    take_decimal(slice, slice.slope, set, gdcm::Tag(0x0028, 0x1053));
    take_decimal(slice, slice.intercept, set, gdcm::Tag(0x0028, 0x1052));
    take_decimal(slice, slice.slope, set, gdcm::Tag(0x3004, 0x000e)); /* dose grid scaling */
    take_decimal(slice, slice.location, set, gdcm::Tag(0x0020, 0x1041));
}

gdcm::DataSet item_of(const gdcm::DataSet &set, const gdcm::Tag &tag, size_t number)
{
    gdcm::SmartPointer<gdcm::SequenceOfItems> items;
    if (set.FindDataElement(tag))
        items = set.GetDataElement(tag).GetValueAsSQ();
    if (!items || number >= items->GetNumberOfItems())
        return {};
    return items->GetItem(number + 1).GetNestedDataSet();
}

void take_functions(Slice &slice, const gdcm::DataSet &group)
{
    for (const gdcm::Tag &tag :
         {gdcm::Tag(0x0020, 0x9113), gdcm::Tag(0x0020, 0x9116), gdcm::Tag(0x0028, 0x9110),
          gdcm::Tag(0x0028, 0x9145), gdcm::Tag(0x0020, 0x9111)})
        take_place(slice, item_of(group, tag, 0));
    for (const gdcm::DataElement &element : group.GetDES()) {
        if (!element.GetTag().IsPublic())
            continue;
        const gdcm::DataSet function = item_of(group, element.GetTag(), 0);
        take_tags(slice, function);
        take_tags(slice, item_of(function, gdcm::Tag(0x0018, 0x9076), 0)); /* diffusion gradient */
    }
}

void take_pixels(Slice &slice, const gdcm::DataSet &set)
{
    unsigned is_signed = 0;
    take_binary(slice.rows, set, gdcm::Tag(0x0028, 0x0010));
    take_binary(slice.columns, set, gdcm::Tag(0x0028, 0x0011));
    take_binary(slice.samples, set, gdcm::Tag(0x0028, 0x0002));
    take_binary(slice.bits, set, gdcm::Tag(0x0028, 0x0100));
    take_binary(is_signed, set, gdcm::Tag(0x0028, 0x0103));
    take_binary(slice.stored, set, gdcm::Tag(0x0028, 0x0101));
    take_binary(slice.high, set, gdcm::Tag(0x0028, 0x0102));
    slice.is_signed = is_signed == 1;
    slice.reference = 0;
    for (const char c : text_of(set, gdcm::Tag(0x0020, 0x0052)))
        slice.reference = slice.reference * 1000003u ^ static_cast<unsigned char>(c);
    int frames = 1;
    take_integer(frames, set, frames_tag);
    slice.frames = static_cast<unsigned>(std::min(std::max(frames, 1), 65535));
    const std::string colours = text_of(set, gdcm::Tag(0x0028, 0x0004));
    slice.is_inverse = colours == "MONOCHROME1";
    if (!colours.empty() && colours.compare(0, 10, "MONOCHROME") != 0)
        slice.samples = 3; /* a palette */
}

/* Read the Modality LUT, which replaces a slope. */
void take_lookup(Slice &slice, const gdcm::DataSet &set)
{
    static const gdcm::Tag tag(0x0028, 0x3000), slope_tag(0x0028, 0x1053);
    uint16_t descriptor[3] = {0, 0, 0}; /* number of values, first stored number, bits */
    const gdcm::DataSet item = item_of(set, tag, 0);
    const std::string data = raw_of(item, {0x0028, 0x3006});
    if (!set.FindDataElement(tag))
        return;
    const bool has_all = take_bytes(descriptor, sizeof descriptor, item, {0x0028, 0x3002});
    const size_t count = descriptor[0] ? descriptor[0] : 65536, width = data.size() / count;
    if (!has_all || (width != 1 && width != 2) || data.size() > count * width + 1 ||
        descriptor[2] < 8 || descriptor[2] > 8 * width || set.FindDataElement(slope_tag)) {
        slice.fault = "an image whose Modality LUT is damaged, or contradicts its RescaleSlope; "
                      "export it again";
        return;
    }
    const auto lookup = std::make_shared<Lookup>();
    lookup->first = slice.is_signed ? static_cast<int16_t>(descriptor[1]) : descriptor[1];
    for (size_t i = 0; i < count; i++)
        lookup->value.push_back(width == 2 ? load<uint16_t>(&data[2 * i])
                                           : static_cast<uint8_t>(data[i]));
    slice.lookup = lookup;
}

void normal_of(double normal[3], const double axis[6])
{
    for (int w = 0; w < 3; w++) {
        const int u = (w + 1) % 3, v = (w + 2) % 3;
        normal[w] = axis[u] * axis[3 + v] - axis[v] * axis[3 + u];
    }
}

/* Add the frames of a file with several. Without a place of their own they have none. */
void add_frames(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set)
{
    Slice common = first;
    take_functions(common, item_of(set, shared_tag, 0));
    std::vector<double> offsets(common.frames + size_t{1}); /* one more, to detect too many */
    const bool has_offsets = common.has_position && common.has_axes &&
                             decimals_of(common.fault, set, offsets_tag, offsets.data(),
                                         offsets.size()) == common.frames;
    double normal[3];
    normal_of(normal, common.axis);
    common.has_position = false;
    for (unsigned f = 0; f < first.frames; f++) {
        Slice slice = common;
        slice.frame = f;
        take_functions(slice, item_of(set, each_tag, f));
        for (int w = 0; w < 3 && has_offsets; w++)
            slice.position[w] += normal[w] * (offsets[f] - offsets[0]);
        slice.has_position |= has_offsets;
        slices.push_back(slice);
    }
}

/* ---- mosaics ----
 *
 * The mosaics of Siemens: one picture holds all slices of a volume side by side.
 *
 *     0 1 2     N images in rows from the top, in the smallest square that holds them; the rest is
 *     3 4 5     blank. Only the private header (csa.h) has N, and the direction in which slices
 *     6 . .     follow each other.
 *
 * The position in the file is the corner of a slice as large as the whole square, centred on the
 * first slice: it is moved by half the difference, as in nibabel (nicom, MosaicWrapper) and SPM.
 * GDCM's splitter uses the centre of a slice as its corner and, without N, any number that fits. */

static const gdcm::Tag matrix_tag(0x0018, 0x1310);

constexpr uint16_t csa_group = 0x0029, csa_element = 0x10;
constexpr uint16_t count_group = 0x0019, count_element = 0x0a;
constexpr unsigned images_most = 4096;

/* Facts of the private header. */
struct Private {
    unsigned images = 0; /* 0: unknown */
    bool is_contrary = false;
    double normal[3] = {0, 0, 0};
    bool has_normal = false;
};

Private private_of(const gdcm::DataSet &set)
{
    Private header;
    unsigned other = 0;
    take_binary(other, set, find_private(set, count_group, count_element, "SIEMENS MR HEADER"));
    header.images = other;
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
    header.is_contrary = other && other != header.images;
    header.has_normal = csa_numbers(header.normal, 3, bytes, length, "SliceNormalVector") == 3;
    return header;
}

/* Side of the smallest square that holds `images`. */
unsigned side_of(unsigned images)
{
    unsigned side = 1;
    while (side * side < images)
        side++;
    return side;
}

/* Test whether the images fit side by side. An image cut out of a mosaic may still have the
 * mosaic's header: its images would be much smaller than the acquired ones. */
bool holds(const Slice &whole, unsigned images, const gdcm::DataSet &set)
{
    const unsigned side = side_of(images);
    uint16_t matrix[4] = {0, 0, 0, 0};
    take_bytes(matrix, sizeof matrix, set, matrix_tag);
    const unsigned acquired = *std::max_element(matrix, matrix + 4);
    return whole.columns % side == 0 && whole.rows % side == 0 &&
           2 * std::max(whole.columns, whole.rows) / side >= acquired;
}

/* Compute the step from one image to the next in the patient; false if it is unknown. */
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

/* Add the images of a mosaic, or `first` with its fault; false if it is no mosaic. */
bool add_mosaic(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set)
{
    const std::string type = "\\" + text_of(set, type_tag) + "\\";
    const bool is_called = type.find("\\MOSAIC\\") != std::string::npos;
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
        whole.fault = words_of("a mosaic whose header says %u images, which do not fit "
                               "side by side into its %ux%u pixels; export it again as single "
                               "slices",
                               header.images, first.columns, first.rows);
    else if (!take_step(step, first, header))
        whole.fault =
            "a mosaic without the place of its images, or without the side towards which they "
            "follow each other (SliceNormalVector in the private header, Siemens CSA); "
            "export it again with that, or as single slices";
    if (!whole.fault.empty())
        slices.push_back(whole);
    else
        add_images(slices, first, header.images, step);
    return true;
}

/* ---- missing pixels ---- */

uint64_t bytes_in(const Slice &slice)
{
    return uint64_t{slice.columns} * slice.rows * slice.samples * slice.frames * slice.bits / 8 +
           (uint64_t{slice.columns} * slice.rows * slice.samples * slice.frames * slice.bits % 8 >
            0);
}

/* Test for the end mark of a JPEG in the last bytes before `end`. Coded numbers cannot contain it.
 */
bool ends_as_jpeg(std::istream &in, uint64_t begin, uint64_t end)
{
    char bytes[1024] = {0};
    const uint64_t length = std::min<uint64_t>(end - begin, sizeof bytes);
    static const char mark[2] = {'\xff', '\xd9'};
    in.seekg(static_cast<std::streamoff>(end - length));
    in.read(bytes, static_cast<std::streamsize>(length));
    return in && std::search(bytes, bytes + length, mark, mark + 2) != bytes + length;
}

/* Packed pixels are pieces, and the first one is a table of offsets. A frame of a JPEG has one or
 * more pieces and an end mark, a frame of RLE one piece. */
void check_packed(Slice &slice, std::istream &in, uint64_t size, const std::string &syntax)
{
    const bool is_jpeg = syntax.compare(0, 20, "1.2.840.10008.1.2.4.") == 0 && syntax.size() == 22;
    const bool is_rle = syntax == "1.2.840.10008.1.2.5";
    uint64_t at = slice.pixels_at;
    uint32_t frames = 0;
    char item[8];
    for (size_t piece = 0; at + sizeof item <= size; piece++) {
        in.seekg(static_cast<std::streamoff>(at));
        in.read(item, sizeof item);
        const uint64_t length = number_in(item + 4, 4, false);
        at += sizeof item;
        if (std::memcmp(item, "\xfe\xff\0\xe0", 4) != 0)
            break;
        if (length > size - at) {
            slice.lack =
                words_of("is cut short: the last piece of its packed pixels has %llu of %llu "
                         "bytes",
                         wide(size - at), wide(length));
            return;
        }
        at += length;
        frames += piece > 0 && (is_rle || (is_jpeg && ends_as_jpeg(in, at - length, at)));
    }
    if ((is_jpeg || is_rle) && frames < slice.frames)
        slice.lack = words_of("is cut short: %u of %u frames of its packed pixels are whole",
                              frames, slice.frames);
}

void find_pixels(Slice &slice, std::istream &in, const gdcm::TransferSyntax &syntax)
{
    const std::streamoff at = in.tellg();
    char before[12] = {0}; /* (VR, two bytes,) length; with implicit VR, tag and length */
    slice.lack = "holds no pixels of whole numbers";
    in.clear();
    if (at < static_cast<std::streamoff>(sizeof before))
        return;
    in.seekg(at - static_cast<std::streamoff>(sizeof before));
    in.read(before, sizeof before);
    const bool is_big = syntax == gdcm::TransferSyntax::ExplicitVRBigEndian;
    const char *tag = is_big ? "\x7f\xe0\0\x10" : "\xe0\x7f\x10\0";
    const bool is_explicit = std::memcmp(before, tag, 4) == 0;
    if (!is_explicit && std::memcmp(before + 4, tag, 4) != 0)
        return;
    in.seekg(0, std::ios::end);
    const auto size = static_cast<uint64_t>(in.tellg());
    const uint64_t length = number_in(before + 8, 4, is_big), needed = bytes_in(slice);
    slice.lack.clear();
    slice.pixels_at = static_cast<uint64_t>(at);
    slice.is_packed = length == undefined_length;
    slice.is_big = is_big || syntax == gdcm::TransferSyntax::ImplicitVRBigEndianPrivateGE;
    slice.is_of_bytes = is_explicit && before[4] == 'O' && before[5] == 'B';
    if (slice.is_packed) {
        check_packed(slice, in, size, syntax.GetString());
        return;
    }
    const uint64_t there = std::min(length, size - std::min(size, slice.pixels_at));
    slice.rest = there > needed + 1 ? there - needed : 0;
    if (there < needed)
        slice.lack = words_of("is cut short: %llu of %llu bytes of pixels are there", wide(there),
                              wide(needed));
}

/* ---- objects without images ---- */

/* By SOP class, or by a prefix that ends with a point. */
static const std::pair<const char *, const char *> objects[] = {
    {"1.2.840.10008.1.3.10", "a DICOMDIR, the index of a folder; open the folder with the slices"},
    {"1.2.840.10008.5.1.4.1.1.4.2", "MR spectroscopy, which is not read"},
    {"1.2.840.10008.5.1.4.1.1.9.", "a waveform, which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.11.",
     "a presentation state, which has no voxels; open the images that it is for"},
    {"1.2.840.10008.5.1.4.1.1.30",
     "a parametric map, which is not read; `paramap2itkimage --inputDICOM FILE --outputDirectory "
     "FOLDER` of dcmqi makes a volume of it"},
    {"1.2.840.10008.5.1.4.1.1.66.4",
     "a segmentation (DICOM SEG), and no slice of a scene; `labels FILE` reads it"},
    {"1.2.840.10008.5.1.4.1.1.66.5",
     "a surface segmentation, meshes without voxels; 3D Slicer reads it and makes a label map"},
    {"1.2.840.10008.5.1.4.1.1.66.7",
     "a label map segmentation (DICOM SEG), and no slice of a scene; `labels FILE` reads it"},
    {"1.2.840.10008.5.1.4.1.1.66.8",
     "a height map segmentation (DICOM SEG), which is not read; 3D Slicer or highdicom reads it"},
    {"1.2.840.10008.5.1.4.1.1.66.6", "a result of tractography, which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.66", "raw data, which is not read"},
    {"1.2.840.10008.5.1.4.1.1.66.", "a registration or a list of points, which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.67", "a mapping to real-world values, which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.68.", "a surface scan, which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.88.", "a structured report (SR), which has no voxels"},
    {"1.2.840.10008.5.1.4.1.1.104.", "an encapsulated document (PDF, CDA, STL), without voxels"},
    {"1.2.840.10008.5.1.4.1.1.481.3",
     "contours of radiotherapy (RTSTRUCT), which are not read; `plastimatch convert --input FILE "
     "--referenced-ct FOLDER --output-labelmap labels.nii.gz` makes a label map of them"},
    {"1.2.840.10008.5.1.4.1.1.481.1", ""},
    {"1.2.840.10008.5.1.4.1.1.481.2", ""},
    {"1.2.840.10008.5.1.4.1.1.481.", "a plan or record of radiotherapy (RTPLAN), without voxels"},
};

/* Description of an object that is no image; "" for an image or an unknown class. */
static std::string other_than_image(const gdcm::File &file)
{
    for (const std::string &name : {text_of(file.GetDataSet(), gdcm::Tag(0x0008, 0x0016)),
                                    text_of(file.GetHeader(), gdcm::Tag(0x0002, 0x0002))})
        for (const auto &object : objects) {
            const size_t length = std::strlen(object.first);
            const bool is_several = object.first[length - 1] == '.';
            if (name.compare(0, is_several ? length : std::string::npos, object.first) == 0) {
                if (*object.second)
                    return object.second;
                break;
            }
        }
    return "";
}

/* ---- files ---- */

bool scan(std::vector<Slice> &slices, const std::string &path)
{
    static const gdcm::Tag pixels(0x7fe0, 0x0010);
    const auto in = open_bytes(path);
    gdcm::Reader reader;
    if (!in)
        return false;
    reader.SetStream(*in);
    if (!reader.ReadUpToTag(pixels, {pixels}))
        return false;
    const gdcm::DataSet &set = reader.GetFile().GetDataSet();
    Slice slice;
    slice.path = path;
    take_pixels(slice, set);
    if (slice.rows == 0 || slice.columns == 0)
        return true;
    slice.series = text_of(set, gdcm::Tag(0x0020, 0x000e));
    slice.object = text_of(set, gdcm::Tag(0x0008, 0x0018));
    slice.modality = text_of(set, gdcm::Tag(0x0008, 0x0060));
    take_integer(slice.series_number, set, gdcm::Tag(0x0020, 0x0011));
    take_words(slice, set);
    take_tags(slice, set);
    take_lookup(slice, set);
    take_place(slice, set);
    take_place(slice, item_of(set, detector_tag, 0));
    const std::string other = other_than_image(reader.GetFile());
    if (!other.empty()) { /* one slice for all frames */
        slice.fault = other;
        slices.push_back(slice);
        return true;
    }
    if (slice.lookup && !slices.empty() && slices.back().lookup &&
        slices.back().lookup->first == slice.lookup->first &&
        slices.back().lookup->value == slice.lookup->value)
        slice.lookup = slices.back().lookup; /* share it in memory */
    find_pixels(slice, *in, reader.GetFile().GetHeader().GetDataSetTransferSyntax());
    if (slice.frames == 1 && add_mosaic(slices, slice, set))
        return true;
    if (slice.frames > 1 || set.FindDataElement(each_tag))
        add_frames(slices, slice, set);
    else
        slices.push_back(slice);
    return true;
}

bool is_of_images(std::string &words, const std::string &path)
{
    static const gdcm::Tag class_tag(0x0002, 0x0002), end_tag(0x0008, 0x0018);
    const auto in = open_bytes(path);
    gdcm::Reader reader;
    gdcm::UIDs uid;
    if (!in)
        return false;
    reader.SetStream(*in);
    if (!reader.ReadUpToTag(end_tag, {}))
        return false;
    words = other_than_image(reader.GetFile());
    return words.empty() &&
           uid.SetFromUID(text_of(reader.GetFile().GetHeader(), class_tag).c_str()) &&
           std::strstr(uid.GetName(), "Image Storage");
}

/* ---- pixels ---- */

/* Clear bits above the stored ones: they once held overlays. */
template <typename Number> void clear_unused(std::vector<char> &bytes, unsigned stored, bool sign)
{
    const auto mask = static_cast<Number>((uint64_t{1} << stored) - 1);
    const auto half = static_cast<Number>(sign ? uint64_t{1} << (stored - 1) : 0);
    for (size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
        const auto value = static_cast<Number>(((load<Number>(&bytes[i]) & mask) ^ half) - half);
        std::memcpy(&bytes[i], &value, sizeof value);
    }
}

void clear_unused(std::vector<char> &bytes, unsigned bits, unsigned stored, unsigned high,
                  bool is_signed)
{
    if (stored == 0 || stored >= bits || high + 1 != stored)
        return;
    if (bits == 8)
        clear_unused<uint8_t>(bytes, stored, is_signed);
    else if (bits == 16)
        clear_unused<uint16_t>(bytes, stored, is_signed);
    else
        clear_unused<uint32_t>(bytes, stored, is_signed);
}

bool read_plain(std::vector<char> &bytes, const Slice &slice)
{
    const auto in = open_bytes(slice.path);
    if (!in)
        return false;
    const auto needed = static_cast<size_t>(bytes_in(slice));
    bytes.resize(needed + needed % 2); /* with the padding byte, if there is one */
    in->seekg(static_cast<std::streamoff>(slice.pixels_at));
    in->read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (static_cast<size_t>(in->gcount()) < needed)
        return false;
    /* Convert to the byte order of this machine. Numbers of 8 bits may be stored in words of 16. */
    const bool is_of_words = slice.bits == 8 && slice.is_big && !slice.is_of_bytes;
    if (is_of_words || slice.is_big != is_big_machine)
        reverse_each(bytes, is_of_words ? 2 : slice.bits / 8);
    clear_unused(bytes, slice.bits, slice.stored, slice.high, slice.is_signed);
    return true;
}

bool read_packed(std::vector<char> &bytes, const Slice &slice)
{
    gdcm::PixmapReader reader; /* reads pixels alone: GDCM's image reader rejects unusual places */
    reader.SetFileName(slice.path.c_str());
    if (!reader.Read())
        return false;
    const gdcm::Pixmap &image = reader.GetPixmap();
    const gdcm::PixelFormat &format = image.GetPixelFormat();
    if (image.GetDimension(0) != slice.columns * slice.tiles ||
        image.GetDimension(1) != slice.rows * slice.tiles ||
        format.GetBitsAllocated() != slice.bits || format.GetSamplesPerPixel() != 1 ||
        image.GetBufferLength() != bytes_in(slice))
        return false;
    bytes.resize(image.GetBufferLength());
    if (!image.GetBuffer(bytes.data()))
        return false;
    clear_unused(bytes, slice.bits, format.GetBitsStored(), format.GetHighBit(),
                 format.GetPixelRepresentation() == 1);
    return true;
}

/* Reorder the pixels of a mosaic image by image. */
void split_mosaic(std::vector<char> &bytes, const Slice &slice)
{
    const size_t width = slice.bits / 8, row = slice.columns * width, image = row * slice.rows;
    std::vector<char> split(bytes.size());
    for (size_t i = 0; i < slice.frames; i++) {
        const size_t corner = i / slice.tiles * image * slice.tiles + i % slice.tiles * row;
        for (size_t y = 0; y < slice.rows; y++)
            std::memcpy(&split[i * image + y * row], &bytes[corner + y * row * slice.tiles], row);
        /* The unused rest of the square is blank; otherwise there are more images than the header
         * says. */
        for (size_t at = width; i >= slice.images && at < image; at += width)
            if (std::memcmp(&split[i * image], &split[i * image + at], width) != 0)
                refuse("a mosaic that holds more images than its private header says");
    }
    bytes.swap(split);
}

bool read_pixels(std::vector<char> &bytes, const Slice &slice)
{
    if (slice.samples != 1 || (slice.bits != 8 && slice.bits != 16 && slice.bits != 32))
        return false;
    if (!(slice.is_packed ? read_packed(bytes, slice) : read_plain(bytes, slice)))
        return false;
    if (slice.tiles > 1)
        split_mosaic(bytes, slice);
    return true;
}

void check_pixels(Volume &volume, const std::vector<Slice> &slices)
{
    const Slice &first = slices[0];
    std::set<std::string> seen;
    const Slice *lack = nullptr;
    size_t lacking = 0, longer = 0;
    uint64_t most = 0;
    for (const Slice &slice : slices) {
        if (!seen.insert(slice.path).second)
            continue;
        longer += slice.rest > 0;
        most = std::max(most, slice.rest);
        if (!slice.lack.empty() && lacking++ == 0)
            lack = &slice;
    }
    const std::string others =
        lacking > 1 ? words_of("; and so are others, %zu in all", lacking) : "";
    if (lack)
        throw Refusal{about_file(lack->name, lack->lack + others)};
    if (first.stored && first.stored < first.bits && first.high + 1 != first.stored)
        note(volume, words_of("it says of its numbers that they have %u bits, up to bit %u: they "
                              "are used unchanged",
                              first.stored, first.high));
    if (first.modality == "RTDOSE" && first.slope == 1)
        note(volume, "it does not say what dose its numbers are (no dose grid scaling)");
    if (longer)
        note(volume, words_of("bytes come after the pixels of %s, up to %llu: left out",
                              plural_of(longer, "file").c_str(), wide(most)));
}

} // namespace volume
