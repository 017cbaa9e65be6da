/* SPDX-License-Identifier: MIT */
/*
 * TIFF by libtiff: one file of pages, or a folder of files of one page each.
 *
 * Voxels are the numbers of the file: the indices of a palette, the grey of grey with alpha.
 * Colours, complex numbers and pages that differ are refused. A page of 1 bit in which 0 is white
 * is inverted; with more bits it is refused, because readers disagree about it. An Orientation is
 * applied. Thumbnails and mask pages (NewSubfileType) are left out and counted.
 *
 * libtiff maps no file, allocates no more than allocation_most at once, and reports errors to
 * Problems instead of standard error.
 */
#include "helper/volume_tiff.hh"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <memory>

#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include "helper/volume_parts.hh"

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

constexpr tmsize_t allocation_most = tmsize_t{1} << 30;
constexpr size_t pages_most = 1000000;
constexpr uint32_t tag_lsm = 34412, tag_metamorph = 33629, tag_fluoview = 34361;

/* ---- a file ---- */

/* Errors and warnings of libtiff since the last reset. */
struct Problems {
    bool has_error = false, has_warning = false, has_mixed_samples = false;
};

int take_error(TIFF *, void *context, const char *, const char *format, va_list)
{
    auto &problems = *static_cast<Problems *>(context);
    problems.has_error = true;
    problems.has_mixed_samples |= std::strstr(format, "different values per") != nullptr;
    return 1;
}

int take_warning(TIFF *, void *context, const char *, const char *, va_list)
{
    static_cast<Problems *>(context)->has_warning = true;
    return 1;
}

class Tiff
{
  public:
    explicit Tiff(const std::string &path)
    {
        const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions *)> options(
            TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree);
        TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), allocation_most);
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), take_error, &problems);
        TIFFOpenOptionsSetWarningHandlerExtR(options.get(), take_warning, &problems);
        /* m: no mapping; c: strips as they are stored */
        file_ = TIFFOpenExt(path.c_str(), "rmc", options.get());
        if (!file_)
            damaged();
    }
    ~Tiff()
    {
        if (file_)
            TIFFClose(file_);
    }
    Tiff(const Tiff &) = delete;
    Tiff &operator=(const Tiff &) = delete;
    operator TIFF *() const
    {
        return file_;
    }
    uint64_t bytes() const
    {
        struct stat status;
        return fstat(TIFFFileno(file_), &status) == 0 ? static_cast<uint64_t>(status.st_size) : 0;
    }
    [[noreturn]] void damaged() const
    {
        if (problems.has_mixed_samples)
            refuse("a TIFF with values of different types in a pixel, which are not read");
        refuse("damaged: a directory of its pages cannot be read; fetch it again");
    }

    Problems problems;

  private:
    TIFF *file_ = nullptr;
};

/* ---- pages ---- */

template <typename Number> Number field_of(TIFF *file, uint32_t tag, Number usual)
{
    Number number = usual;
    return TIFFGetFieldDefaulted(file, tag, &number) ? number : usual;
}

/* Bytes of a tag without a type in libtiff. */
std::string bytes_of_tag(TIFF *file, uint32_t tag)
{
    uint32_t count = 0;
    const char *bytes = nullptr;
    if (!TIFFFindField(file, tag, TIFF_BYTE) || !TIFFGetField(file, tag, &count, &bytes) || !bytes)
        return "";
    return std::string(bytes, count);
}

/* Refuse microscope stacks with axes in unsupported tags. */
void refuse_foreign(TIFF *file, size_t pages)
{
    for (int i = 0; i < TIFFGetTagListCount(file); i++) {
        const uint32_t tag = TIFFGetTagListEntry(file, i);
        uint32_t planes = 1;
        const void *values = nullptr;
        if (tag == tag_metamorph && !TIFFGetField(file, tag, &planes, &values))
            planes = 1;
        if ((tag == tag_metamorph && planes > 1) || (tag == tag_fluoview && pages > 1))
            refuse("a stack of %s, whose channels and frames are not read; `bfconvert FILE "
                   "A.ome.tif` (Bio-Formats) makes an OME-TIFF of it",
                   tag == tag_fluoview ? "FluoView" : "MetaMorph");
    }
}

TiffPage page_of(const Tiff &file)
{
    TiffPage page;
    uint16_t extras = 0;
    const uint16_t *kind = nullptr;
    page.at = TIFFCurrentDirOffset(file);
    page.width = field_of<uint32_t>(file, TIFFTAG_IMAGEWIDTH, 0);
    page.height = field_of<uint32_t>(file, TIFFTAG_IMAGELENGTH, 0);
    page.samples = field_of<uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL, 1);
    page.bits = field_of<uint16_t>(file, TIFFTAG_BITSPERSAMPLE, 1);
    page.format = field_of<uint16_t>(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    page.photometric = field_of<uint16_t>(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    page.orientation = field_of<uint16_t>(file, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    page.compression = field_of<uint16_t>(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    page.depth = field_of<uint32_t>(file, TIFFTAG_IMAGEDEPTH, 1);
    const uint32_t subfile = field_of<uint32_t>(file, TIFFTAG_SUBFILETYPE, 0);
    page.is_reduced = subfile & FILETYPE_REDUCEDIMAGE;
    page.is_mask = (subfile & FILETYPE_MASK) || page.photometric == PHOTOMETRIC_MASK;
    if (TIFFGetField(file, TIFFTAG_EXTRASAMPLES, &extras, &kind))
        for (unsigned i = extras;
             i > 0 && page.alphas + 1 < page.samples && kind[i - 1] != EXTRASAMPLE_UNSPECIFIED; i--)
            page.alphas++;
    return page;
}

/* Type of the voxels: small integers get the next wider type, float16 becomes float32; "" for an
 * unsupported type. */
std::string type_of(const TiffPage &page)
{
    const unsigned bits = page.bits;
    const bool is_whole = bits <= 16 || bits == 24 || bits == 32 || bits == 64;
    const unsigned wide_bits = bits <= 8 ? 8 : bits <= 16 ? 16 : bits <= 32 ? 32 : 64;
    if (page.format == SAMPLEFORMAT_IEEEFP)
        return bits == 16 || bits == 32 ? "float32" : bits == 64 ? "float64" : "";
    if (!is_whole || bits == 0)
        return "";
    if (page.format == SAMPLEFORMAT_INT)
        return "int" + std::to_string(wide_bits);
    return page.format == SAMPLEFORMAT_UINT || page.format == SAMPLEFORMAT_VOID
               ? "uint" + std::to_string(wide_bits)
               : "";
}

bool is_grey(const TiffPage &page)
{
    return page.photometric == PHOTOMETRIC_MINISBLACK ||
           page.photometric == PHOTOMETRIC_MINISWHITE || page.photometric == PHOTOMETRIC_PALETTE;
}

/* Refuse a page that holds no voxels, or that libtiff cannot unpack. */
void check_page(const TiffPage &page, bool is_lsm)
{
    if (page.width == 0 || page.height == 0)
        refuse("a TIFF that does not say how large its pages are");
    if (page.format == SAMPLEFORMAT_COMPLEXINT || page.format == SAMPLEFORMAT_COMPLEXIEEEFP)
        refuse("a TIFF of complex numbers; save their magnitude");
    if (!is_grey(page) && !(is_lsm && page.photometric == PHOTOMETRIC_RGB))
        refuse("a TIFF with colours (%u values a pixel); expected one value: convert it to grey, "
               "or save one channel",
               page.samples);
    if (type_of(page).empty())
        refuse("a TIFF with numbers of %u bits%s, which are not read; write it with 8, 16 or 32",
               page.bits, page.format == SAMPLEFORMAT_IEEEFP ? " (real)" : "");
    if (page.photometric == PHOTOMETRIC_MINISWHITE && page.bits > 1)
        refuse("a TIFF in which 0 is white (MinIsWhite), and readers disagree whether its numbers "
               "are to be inverted: in a copy, `tiffset -d N -s 262 1 COPY`, of each page N from 0 "
               "on, keeps them");
    if (page.depth > 1)
        refuse("a TIFF with %u slices in a page (ImageDepth), which are not read; write a page "
               "for each",
               page.depth);
    if (page.compression == COMPRESSION_OJPEG ||
        !TIFFIsCODECConfigured(static_cast<uint16_t>(page.compression)))
        refuse("packed in a way that libtiff does not read (Compression %u); `bfconvert FILE "
               "A.ome.tif` (Bio-Formats) unpacks it",
               page.compression);
}

std::string words_for(const TiffPage &page)
{
    static const char *const colours[] = {"0 is white", "0 is black", "colours", "a palette"};
    std::string words = words_of("%ux%u with %s of %s%u (%s", page.width, page.height,
                                 plural_of(page.samples, "value").c_str(),
                                 page.format == SAMPLEFORMAT_IEEEFP ? "float"
                                 : page.format == SAMPLEFORMAT_INT  ? "int"
                                 : page.format > SAMPLEFORMAT_VOID  ? "complex"
                                                                    : "uint",
                                 page.bits, colours[page.photometric < 4 ? page.photometric : 2]);
    if (page.orientation > ORIENTATION_TOPLEFT)
        words += words_of(", Orientation %u", page.orientation);
    return words + ")";
}

bool are_alike(const TiffPage &a, const TiffPage &b)
{
    return a.width == b.width && a.height == b.height && a.samples == b.samples &&
           a.alphas == b.alphas && a.bits == b.bits && type_of(a) == type_of(b) &&
           a.photometric == b.photometric && a.orientation == b.orientation;
}

/* Read all pages, the first tag CZ_LSMINFO, and the description of the first page or of the first
 * image. */
std::vector<TiffPage> pages_of(Tiff &file, std::string &description, std::string &lsm)
{
    std::vector<TiffPage> pages;
    bool has_image = false;
    do {
        const char *text = nullptr;
        file.problems = Problems();
        pages.push_back(page_of(file));
        if (!has_image && TIFFGetField(file, TIFFTAG_IMAGEDESCRIPTION, &text) && text)
            description = description.empty() ? text : description;
        has_image |= !pages.back().is_reduced && !pages.back().is_mask;
        if (lsm.empty())
            lsm = bytes_of_tag(file, tag_lsm);
        refuse_foreign(file, TIFFLastDirectory(file) ? pages.size() : 2);
        if (pages.size() > pages_most)
            refuse("a TIFF of more than %zu pages", pages_most);
    } while (TIFFReadDirectory(file));
    if (file.problems.has_error || !TIFFLastDirectory(file))
        file.damaged();
    return pages;
}

/* ---- pixels ---- */

float float_of(uint16_t half)
{
    const int exponent = half >> 10 & 31;
    const float fraction = static_cast<float>(half & 1023) / 1024;
    const float size = exponent == 31 ? (fraction == 0 ? INFINITY : NAN)
                       : exponent     ? std::ldexp(1 + fraction, exponent - 15)
                                      : std::ldexp(fraction, -14);
    return half >> 15 ? -size : size;
}

/* Extract a number at bit `at` of a row, highest bit first. */
uint32_t bits_at(const uint8_t *row, size_t at, unsigned bits)
{
    uint32_t number = 0;
    for (size_t i = at; i < at + bits; i++)
        number = number << 1 | (row[i / 8] >> (7 - i % 8) & 1u);
    return number;
}

/* Convert one sample of each pixel of a row, with `samples` interleaved, to the voxel type. */
void convert_row(uint8_t *to, const uint8_t *from, const TiffPage &page, size_t pixels,
                 unsigned sample, unsigned samples)
{
    const bool is_signed = page.format == SAMPLEFORMAT_INT;
    const bool is_inverse = page.photometric == PHOTOMETRIC_MINISWHITE;
    const unsigned bits = page.bits;
    const size_t wide_bytes = bytes_of(type_of(page));
    if (bits == 8 * wide_bytes && samples == 1) {
        std::memcpy(to, from, pixels * wide_bytes);
        return;
    }
    for (size_t i = 0; i < pixels; i++, to += wide_bytes) {
        const size_t at = (i * samples + sample) * bits;
        const uint8_t *byte = from + at / 8; /* for whole bytes, in this machine's order */
        if (bits == 8 * wide_bytes) {
            std::memcpy(to, byte, wide_bytes);
            continue;
        }
        if (page.format == SAMPLEFORMAT_IEEEFP) {
            const float number = float_of(load<uint16_t>(byte));
            std::memcpy(to, &number, sizeof number);
            continue;
        }
        uint32_t number = bits == 24 ? static_cast<uint32_t>(number_in(
                                           reinterpret_cast<const char *>(byte), 3, is_big_machine))
                                     : bits_at(from, at, bits);
        if (is_signed && number >> (bits - 1))
            number |= UINT32_MAX << bits;
        if (is_inverse) /* 1 bit */
            number ^= 1;
        if (is_big_machine) /* the low bytes are the last ones */
            number <<= 32 - 8 * wide_bytes;
        std::memcpy(to, &number, wide_bytes);
    }
}

/* An unpacked strip or tile: rows of pixels with interleaved samples. */
struct Piece {
    size_t x, y, columns, rows; /* in the page */
    size_t row_bytes;
    unsigned sample, samples;
};

void convert_piece(std::vector<uint8_t> &to, const uint8_t *from, const TiffPage &page,
                   const Piece &piece)
{
    const size_t width = bytes_of(type_of(page));
    const size_t columns = std::min<size_t>(piece.columns, page.width - piece.x);
    const size_t rows = std::min<size_t>(piece.rows, page.height - piece.y);
    for (size_t y = 0; y < rows; y++)
        convert_row(&to[((piece.y + y) * page.width + piece.x) * width], from + y * piece.row_bytes,
                    page, columns, piece.sample, piece.samples);
}

/* Offset of the pixels of an unpacked page if they are contiguous; 0 otherwise. */
uint64_t begin_of_run(const Tiff &file)
{
    if (TIFFIsTiled(file) ||
        field_of<uint16_t>(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE) != COMPRESSION_NONE)
        return 0;
    uint64_t end = 0;
    for (uint32_t i = 0; i < TIFFNumberOfStrips(file); i++) {
        const uint64_t at = TIFFGetStrileOffset(file, i);
        if (i > 0 && at != end)
            return 0;
        end = at + TIFFGetStrileByteCount(file, i);
    }
    return TIFFGetStrileOffset(file, 0);
}

/* Read plane `number` after the first one, in a file with one page and contiguous planes. */
void read_run(std::vector<uint8_t> &to, const Tiff &file, const TiffPage &page, size_t number)
{
    const size_t row = (size_t{page.width} * page.samples * page.bits + 7) / 8;
    std::vector<uint8_t> from(row * page.height);
    const uint64_t at = begin_of_run(file) + number * from.size();
    for (size_t done = 0; done < from.size();) {
        const ssize_t n =
            pread(TIFFFileno(file), &from[done], from.size() - done, static_cast<off_t>(at + done));
        if (n <= 0)
            refuse("cut short: slice %zu ends before its last voxel; fetch it again", number + 1);
        done += static_cast<size_t>(n);
    }
    if (TIFFIsByteSwapped(file) && page.bits >= 16)
        reverse_each(from, page.bits / 8);
    convert_piece(to, from.data(), page, {0, 0, page.width, page.height, row, 0, page.samples});
}

/* Refuse a strip or tile that unpacks incompletely. Decoders of faxes and JPEG fill in missing
 * pixels, and warn. */
void check_piece(const Tiff &file, const TiffPage &page, tmsize_t is, tmsize_t expected,
                 size_t number)
{
    const bool is_filled = file.problems.has_warning && page.compression != COMPRESSION_LZW;
    if (is < expected || file.problems.has_error || is_filled)
        refuse("cut short or damaged: the pixels of page %zu cannot be unpacked; fetch it again",
               number + 1);
}

/* Read one sample of libtiff's current page, in stored order. */
void read_stored(std::vector<uint8_t> &to, Tiff &file, const TiffPage &page, unsigned sample,
                 size_t number)
{
    const bool is_tiled = TIFFIsTiled(file);
    const bool is_apart = page.samples > 1 && field_of<uint16_t>(file, TIFFTAG_PLANARCONFIG, 1) ==
                                                  PLANARCONFIG_SEPARATE;
    uint32_t columns = page.width, rows = 0;
    if (is_tiled) {
        columns = field_of<uint32_t>(file, TIFFTAG_TILEWIDTH, 0);
        rows = field_of<uint32_t>(file, TIFFTAG_TILELENGTH, 0);
    } else {
        rows = std::min(field_of<uint32_t>(file, TIFFTAG_ROWSPERSTRIP, UINT32_MAX), page.height);
    }
    const auto row_bytes = is_tiled ? TIFFTileRowSize(file) : TIFFScanlineSize(file);
    const auto most = is_tiled ? TIFFTileSize(file) : TIFFStripSize(file);
    const uint64_t bits = uint64_t{columns} * (is_apart ? 1 : page.samples) * page.bits;
    if (columns == 0 || rows == 0 || row_bytes <= 0 || most <= 0 ||
        static_cast<uint64_t>(row_bytes) < (bits + 7) / 8)
        file.damaged();
    std::vector<uint8_t> from(static_cast<size_t>(most));
    Piece piece = {0,
                   0,
                   columns,
                   rows,
                   static_cast<size_t>(row_bytes),
                   is_apart ? 0 : sample,
                   is_apart ? 1 : page.samples};
    for (size_t y = 0; y < page.height; y += rows)
        for (size_t x = 0; x < page.width; x += columns) {
            const auto plane = static_cast<uint16_t>(is_apart ? sample : 0);
            const auto left = std::min<size_t>(rows, page.height - y);
            const auto expected = is_tiled ? most : static_cast<tmsize_t>(left) * row_bytes;
            const auto column = static_cast<uint32_t>(x), line = static_cast<uint32_t>(y);
            file.problems = Problems();
            const tmsize_t n =
                is_tiled ? TIFFReadEncodedTile(file, TIFFComputeTile(file, column, line, 0, plane),
                                               from.data(), most)
                         : TIFFReadEncodedStrip(file, TIFFComputeStrip(file, line, plane),
                                                from.data(), expected);
            check_piece(file, page, n, expected, number);
            piece.x = x;
            piece.y = y;
            convert_piece(to, from.data(), page, piece);
        }
}

bool is_turned(const TiffPage &page)
{
    return page.orientation >= ORIENTATION_LEFTTOP && page.orientation <= ORIENTATION_LEFTBOT;
}

/* Reorder rows and columns by an Orientation of 2 to 8; from 5 on they are stored in columns. */
void orient(std::vector<uint8_t> &bytes, const TiffPage &page)
{
    const unsigned o = page.orientation;
    const bool in_columns = is_turned(page);
    const bool is_right = o == ORIENTATION_TOPRIGHT || o == ORIENTATION_BOTRIGHT ||
                          o == ORIENTATION_RIGHTTOP || o == ORIENTATION_RIGHTBOT;
    const bool is_bottom = o == ORIENTATION_BOTRIGHT || o == ORIENTATION_BOTLEFT ||
                           o == ORIENTATION_RIGHTBOT || o == ORIENTATION_LEFTBOT;
    const size_t width = in_columns ? page.height : page.width;
    const size_t height = in_columns ? page.width : page.height;
    const size_t unit = bytes.size() / width / height;
    const std::vector<uint8_t> stored = bytes;
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const size_t p = is_right ? width - 1 - x : x, q = is_bottom ? height - 1 - y : y;
            const size_t from = in_columns ? p * page.width + q : q * page.width + p;
            std::memcpy(&bytes[(y * width + x) * unit], &stored[from * unit], unit);
        }
}

/* ---- a file of pages ---- */

/* An open file and its slices. */
struct Opened {
    explicit Opened(const std::string &path) : file(path)
    {
    }
    Tiff file;
    std::vector<TiffPage> page;
    TiffStack stack;
    unsigned samples = 1; /* channels */
    size_t first = 0;     /* page that the others must equal */
};

void read_slice(std::vector<uint8_t> &bytes, Opened &opened, uint64_t volume, uint64_t z)
{
    const TiffStack &stack = opened.stack;
    const size_t index = stack.page[volume / opened.samples * stack.slices + z];
    const TiffPage &page = opened.page[stack.is_run ? opened.first : index];
    if (stack.is_run) {
        read_run(bytes, opened.file, page, index);
    } else {
        if (TIFFCurrentDirOffset(opened.file) != page.at &&
            !TIFFSetSubDirectory(opened.file, page.at))
            opened.file.damaged();
        read_stored(bytes, opened.file, page, static_cast<unsigned>(volume % opened.samples),
                    index);
    }
    if (page.orientation > ORIENTATION_TOPLEFT && page.orientation <= ORIENTATION_LEFTBOT)
        orient(bytes, page);
}

/* Pixel size by the resolution of the page; 0: unknown. */
TiffStack resolution_of(TIFF *file)
{
    TiffStack stack;
    const auto unit = field_of<uint16_t>(file, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
    const float per[2] = {field_of<float>(file, TIFFTAG_XRESOLUTION, 0),
                          field_of<float>(file, TIFFTAG_YRESOLUTION, 0)};
    for (int a = 0; a < 2; a++)
        stack.step[a] = std::isfinite(per[a]) && per[a] > 0 ? 1 / double{per[a]} : 0;
    stack.unit = unit == RESUNIT_INCH ? "inch" : unit == RESUNIT_CENTIMETER ? "cm" : "";
    return stack;
}

/* Set the voxel size if all of it is known; otherwise note the known part, and the option that sets
 * it. */
void place_stack(Volume &volume, const TiffStack &stack, bool in_columns)
{
    static const char *const letter[] = {"X", "Y", "Z"};
    const double mm = length_mm(stack.unit.c_str());
    std::string said[3], typed[3];
    unsigned known = 0;
    double step[3];
    for (int a = 0; a < 3; a++)
        step[a] = stack.step[in_columns && a < 2 ? 1 - a : a];
    for (int a = 0; a < 3; a++) {
        const bool is_known = std::isfinite(step[a]) && step[a] > 0;
        known += is_known;
        said[a] = is_known ? words_of("%.6g", step[a] * (mm > 0 ? mm : 1)) : "?";
        typed[a] = is_known && mm > 0 ? said[a] : letter[a];
        volume.to_mm[a][a] = is_known && mm > 0 ? step[a] * mm : 1;
    }
    const std::string set = "spacing=" + typed[0] + "," + typed[1] + "," + typed[2];
    const char *by = stack.by.c_str();
    if (known == 3 && mm > 0) {
        volume.known |= SPACING;
    } else if (known == 0 || (mm <= 0 && step[0] == 1 && step[1] == 1 && known == 2)) {
        return; /* nothing, or a meaningless default */
    } else if (mm <= 0) {
        if (stack.unit.empty() && stack.by == "its resolution")
            return; /* only the ratio of the sides */
        note(volume,
             words_of("%s says voxels of %sx%sx%s, and %s: where you know their size, open "
                      "it with %s",
                      by, said[0].c_str(), said[1].c_str(), said[2].c_str(),
                      stack.unit.empty() ? "no unit"
                                         : ("their unit is " + printable(stack.unit, 20)).c_str(),
                      set.c_str()));
    } else if (step[2] > 0) {
        note(volume,
             words_of("%s says slices of %s mm, and not how large all sides of a pixel are: "
                      "where you know that, open it with %s",
                      by, said[2].c_str(), set.c_str()));
    } else {
        note(volume, words_of("%s says pixels of %sx%s mm, and nothing how far apart slices are: "
                              "where you know that, open it with %s",
                              by, said[0].c_str(), said[1].c_str(), set.c_str()));
    }
}

/* Note the order of volumes. */
void note_axes(Volume &volume, const TiffStack &stack)
{
    std::string list;
    size_t axes = 0;
    for (const TiffAxis &axis : stack.axes)
        if (axis.size > 1)
            list += (axes++ ? " of each of " : "") +
                    plural_of(axis.size, axis.letter == 'C'   ? "channel"
                                         : axis.letter == 'T' ? "frame"
                                                              : "step");
    if (axes)
        note(volume, "its volumes are " + list + (axes > 1 ? ", in this order" : ""));
    if (stack.slices == 1 && stack.page.size() > 1 && !stack.is_run)
        note(volume, stack.by +
                         " says 1 slice for each: where they are slices of one volume, `tiffset "
                         "-u 270 COPY` removes it from a copy; then each page is a slice");
}

/* Note the pages left out, and how numbers are interpreted. */
void note_pages(Volume &volume, const Opened &opened)
{
    const TiffPage &first = opened.page[opened.first];
    size_t reduced = 0, masks = 0;
    for (const TiffPage &page : opened.page) {
        masks += page.is_mask;
        reduced += page.is_reduced && !page.is_mask;
    }
    if (reduced)
        note(volume, plural_of(reduced, "page") + " of reduced resolution left out");
    if (masks)
        note(volume, plural_of(masks, "mask page") + " left out");
    if (first.alphas)
        note(volume, "its pixels are grey with alpha: the grey is taken, alpha is left out");
    if (first.photometric == PHOTOMETRIC_PALETTE)
        note(volume, "its colours are of a palette: voxels are the indices, which it stores");
    if (first.photometric == PHOTOMETRIC_MINISWHITE)
        note(volume, "0 is white in it (MinIsWhite): its voxels are 1 where it is white");
    if (first.format == SAMPLEFORMAT_VOID)
        note(volume, "the type of its numbers is unknown: read as unsigned integers");
    if (first.orientation > ORIENTATION_TOPLEFT && first.orientation <= ORIENTATION_LEFTBOT)
        note(volume, words_of("its rows and columns are stored in another order (Orientation %u): "
                              "put in the order of display",
                              first.orientation));
    for (const std::string &line : opened.stack.note)
        note(volume, line);
}

/* Refuse a file with contiguous planes that ends before the last one. */
void check_run(const Opened &opened)
{
    const TiffPage &page = opened.page[opened.first];
    const uint64_t all = opened.file.bytes();
    const uint64_t row = (uint64_t{page.width} * page.samples * page.bits + 7) / 8;
    const uint64_t at = begin_of_run(opened.file);
    uint64_t end = 0;
    if (at == 0)
        refuse("%s says %zu images in 1 page, which is packed or in pieces, so that the others are "
               "not found",
               opened.stack.by.c_str(), opened.stack.page.size());
    if (__builtin_mul_overflow(row * page.height, opened.stack.page.size(), &end) ||
        __builtin_add_overflow(end, at, &end) || all < end)
        refuse("cut short: it has %llu bytes, and its header promises %llu; fetch it again",
               wide(all), wide(end));
}

/* Note bytes after the only page: some writers give further slices neither directory nor
 * description. */
void note_rest(Volume &volume, const Opened &opened)
{
    constexpr uint64_t least = 4096; /* longer than most descriptions */
    const uint64_t at = begin_of_run(opened.file), all = opened.file.bytes();
    const uint64_t bytes = bytes_in(volume, 1);
    if (opened.page.size() != 1 || opened.stack.is_run || at == 0 || opened.page[0].samples != 1 ||
        opened.page[0].bits != 8 * bytes_of(volume.type))
        return;
    if (all > at && all - at > bytes && all - at - bytes >= std::max(bytes, least))
        note(volume,
             words_of("%llu bytes come after the pixels of its only page: `open raw:FILE "
                      "size=%llu,%llu,N type=%s offset=%llu endian=%s` reads them as slices",
                      wide(all - at - bytes), wide(volume.size[0]), wide(volume.size[1]),
                      volume.type.c_str(), wide(at),
                      TIFFIsBigEndian(opened.file) ? "big" : "little"));
}

/* Open a file and arrange its pages. */
std::shared_ptr<Opened> open_pages(const std::string &path)
{
    const auto opened = std::make_shared<Opened>(path);
    Tiff &file = opened->file;
    const TiffStack resolution = resolution_of(file);
    std::string description, lsm;
    opened->page = pages_of(file, description, lsm);
    const std::vector<size_t> images = images_of(opened->page);
    if (images.empty())
        refuse("a TIFF of thumbnails or masks: none of its pages is an image of full resolution "
               "(NewSubfileType)");
    opened->first = images[0];
    const TiffPage &first = opened->page[opened->first];
    check_page(first, !lsm.empty());
    opened->samples = first.samples - first.alphas;
    if (!lsm.empty() && file.bytes() > UINT32_MAX)
        refuse("an LSM of more than 4 GB, whose offsets do not fit their 32 bits; `bfconvert FILE "
               "A.ome.tif` (Bio-Formats) makes an OME-TIFF of it");
    opened->stack =
        stack_of(opened->page, opened->samples, path, description, lsm, resolution, type_of(first));
    const TiffStack &stack = opened->stack;
    if (stack.is_run) {
        if (!TIFFSetSubDirectory(file, first.at))
            file.damaged();
        check_run(*opened);
        return opened;
    }
    opened->first = stack.page[0];
    const TiffPage &model = opened->page[opened->first];
    for (const size_t number : stack.page) {
        const TiffPage &page = opened->page[number];
        if (!are_alike(page, model))
            refuse("a TIFF of pages that differ: page %zu of %zu is %s, and page %zu %s; `tiffcp "
                   "FILE,0,1 A.tif` copies pages of one kind, here its first and second",
                   number + 1, opened->page.size(), words_for(page).c_str(), opened->first + 1,
                   words_for(model).c_str());
        check_page(page, !lsm.empty());
    }
    return opened;
}

void open_tiff(Volume &volume, const Request &request)
{
    count_parts("tiff", request.path, "");
    const std::shared_ptr<Opened> opened = open_pages(request.path);
    const TiffPage &page = opened->page[opened->first];
    volume.format = "TIFF";
    volume.type = type_of(page);
    volume.size[0] = is_turned(page) ? page.height : page.width;
    volume.size[1] = is_turned(page) ? page.width : page.height;
    volume.size[2] = opened->stack.slices;
    volume.volumes = opened->stack.volumes;
    place_stack(volume, opened->stack, is_turned(page));
    if (page.compression != COMPRESSION_NONE && page.compression != COMPRESSION_ADOBE_DEFLATE &&
        page.compression != COMPRESSION_DEFLATE)
        volume.known |= CLOSELY_PACKED;
    note_axes(volume, opened->stack);
    note_pages(volume, *opened);
    note_rest(volume, *opened);
    volume.send = [&volume, opened, number = request.volume]() {
        std::vector<uint8_t> bytes(bytes_in(volume, 1) / volume.size[2]);
        for (uint64_t z = 0; z < volume.size[2]; z++) {
            read_slice(bytes, *opened, number, z);
            send_piece(bytes.data(), bytes.size());
        }
    };
}

/* ---- a folder of files ---- */

/* Run `read` for a file of the folder, and prepend slice and file to a refusal. */
template <typename Read> void name_slice(const std::vector<std::string> &path, size_t z, Read read)
{
    try {
        read();
    } catch (const Refusal &refusal) {
        throw Refusal{
            words_of("slice %zu of %zu, %s: ", z + 1, path.size(), last_name(path[z]).c_str()) +
            refusal.words};
    }
}

/* Open a file with a single slice. */
std::shared_ptr<Opened> open_slice(const std::string &path)
{
    const auto opened = open_pages(path);
    if (opened->stack.slices != 1)
        refuse("a TIFF of %llu pages; expected 1: open the file, or make one of all with `tiffcp "
               "FILES A.tif`",
               wide(opened->stack.slices));
    if (opened->stack.volumes != 1)
        refuse("a TIFF of %llu channels or frames; expected 1: save one of them",
               wide(opened->stack.volumes));
    return opened;
}

void stack_tiffs(Volume &volume, const std::vector<std::string> &path)
{
    std::shared_ptr<Opened> opened;
    name_slice(path, 0, [&]() { opened = open_slice(path[0]); });
    const TiffPage model = opened->page[opened->first];
    volume.format = "TIFF slices";
    volume.type = type_of(model);
    volume.size[0] = is_turned(model) ? model.height : model.width;
    volume.size[1] = is_turned(model) ? model.width : model.height;
    volume.size[2] = path.size();
    TiffStack stack = opened->stack;
    stack.step[2] = 0; /* no file has the distance between files */
    place_stack(volume, stack, is_turned(model));
    note_pages(volume, *opened);
    volume.send = [&volume, path, model]() {
        std::vector<uint8_t> bytes(bytes_in(volume, 1) / volume.size[2]);
        for (size_t z = 0; z < path.size(); z++) {
            name_slice(path, z, [&]() {
                const auto slice = open_slice(path[z]);
                const TiffPage &page = slice->page[slice->first];
                if (!are_alike(page, model))
                    refuse("it is %s, and the first %s; expected slices of one kind",
                           words_for(page).c_str(), words_for(model).c_str());
                read_slice(bytes, *slice, 0, 0);
            });
            send_piece(bytes.data(), bytes.size());
        }
    };
}

} // namespace volume
