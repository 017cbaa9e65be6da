/* DICOM: where the pixels of a file lie, whether all of them are there, and what they are. GDCM
 * decodes what is packed; it makes zeros of what a cut file lacks, and takes big-endian numbers of
 * 32 bits for two of 16, so plain pixels are read here. */
#include "image/volume_parts.hh"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include <gdcmPixmapReader.h>
#include <zlib.h>

namespace volume
{

constexpr uint64_t undefined_length = 0xffffffff;
constexpr size_t inflated_most = size_t{256} << 20;

/* ---- the bytes of a file ---- */

/* All that follows in a file, inflated; up to where it is cut or damaged. */
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
        state = state == Z_BUF_ERROR ? Z_OK : state; /* it wants more */
    }
    inflateEnd(&zlib);
    return out;
}

/* Whether the first bytes may be of DICOM, with or without its preamble. */
bool may_be_dicom(const char *bytes, std::streamsize length)
{
    if (length >= 132 && std::memcmp(bytes + 128, "DICM", 4) == 0)
        return true;
    return length >= 16 && ((bytes[1] == 0 && (bytes[0] == 2 || bytes[0] == 8) && bytes[3] == 0) ||
                            (bytes[0] == 0 && bytes[1] == 8 && bytes[2] == 0));
}

/* A file whose data set is deflated is given as the same one that is not: GDCM cannot go back and
 * forth in such. */
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

/* ---- whether the pixels are there ---- */

uint64_t bytes_in(const Slice &slice)
{
    return uint64_t{slice.columns} * slice.rows * slice.samples * slice.frames * slice.bits / 8;
}

/* Whether the end mark of a JPEG of any kind stands in the last bytes before `end`. In its numbers
 * it cannot. */
bool ends_as_jpeg(std::istream &in, uint64_t begin, uint64_t end)
{
    char bytes[1024] = {0};
    const uint64_t length = std::min<uint64_t>(end - begin, sizeof bytes);
    static const char mark[2] = {'\xff', '\xd9'};
    in.seekg(static_cast<std::streamoff>(end - length));
    in.read(bytes, static_cast<std::streamsize>(length));
    return in && std::search(bytes, bytes + length, mark, mark + 2) != bytes + length;
}

/* Packed pixels are pieces, of which the first says where others begin. A frame of a JPEG is one or
 * more and has an end mark; one of RLE is one. */
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
    char before[12] = {0}; /* (VR, two bytes,) length; or, of implicit VR, tag and length */
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

/* ---- what they are ---- */

/* As this machine has numbers. What of 8 bits is written as words of 16 is so here, too. */
void reorder(std::vector<char> &bytes, const Slice &slice)
{
    const bool is_of_words = slice.bits == 8 && slice.is_big && !slice.is_of_bytes;
    const size_t width = is_of_words ? 2 : slice.bits / 8;
    const bool differs = slice.is_big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    for (size_t i = 0; (differs || is_of_words) && i + width <= bytes.size(); i += width)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                     bytes.begin() + static_cast<std::ptrdiff_t>(i + width));
}

/* Bits above those that are stored held overlays once, and are no part of the number. */
template <typename Number> void clear_unused(std::vector<char> &bytes, unsigned stored, bool sign)
{
    const auto mask = static_cast<Number>((uint64_t{1} << stored) - 1);
    const auto half = static_cast<Number>(sign ? uint64_t{1} << (stored - 1) : 0);
    for (size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
        Number value;
        std::memcpy(&value, &bytes[i], sizeof value);
        value = static_cast<Number>(((value & mask) ^ half) - half);
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
    bytes.resize(needed + needed % 2); /* with the byte that makes it even, where it is there */
    in->seekg(static_cast<std::streamoff>(slice.pixels_at));
    in->read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (static_cast<size_t>(in->gcount()) < needed)
        return false;
    reorder(bytes, slice);
    clear_unused(bytes, slice.bits, slice.stored, slice.high, slice.is_signed);
    return true;
}

bool read_packed(std::vector<char> &bytes, const Slice &slice)
{
    gdcm::PixmapReader reader; /* of the pixels alone: GDCM refuses places that it finds odd */
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

/* The pixels of a mosaic, image after image. */
void split_mosaic(std::vector<char> &bytes, const Slice &slice)
{
    const size_t width = slice.bits / 8, row = slice.columns * width, image = row * slice.rows;
    std::vector<char> split(bytes.size());
    for (size_t i = 0; i < slice.frames; i++) {
        const size_t corner = i / slice.tiles * image * slice.tiles + i % slice.tiles * row;
        for (size_t y = 0; y < slice.rows; y++)
            std::memcpy(&split[i * image + y * row], &bytes[corner + y * row * slice.tiles], row);
        /* What is left of the square is blank: where it is not, there are more than is said. */
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
                              "are taken as they stand",
                              first.stored, first.high));
    if (first.modality == "RTDOSE" && first.slope == 1)
        note(volume, "it does not say what dose its numbers are (no dose grid scaling)");
    if (longer)
        note(volume, words_of("bytes come after the pixels of %s, up to %llu: left out",
                              plural_of(longer, "file").c_str(), wide(most)));
}

} // namespace volume
