/* SPDX-License-Identifier: MIT */
/*
 * Pictures as slices, in natural order of their names: PNG by ITK, and BMP of 8 bits of grey,
 * uncompressed, as SkyScan's NRecon writes it. ITK 5.2 reads no BMP with a header of 108 or 124
 * bytes, and converts grey to colours.
 *
 *     0 "BM"   10 offset of the pixels   14 bytes of the header, from here
 *     18 columns   22 rows; negative: from the top   28 bits a pixel   30 compression
 *     38 pixels a metre   46 colours of the palette; 0: 256
 *
 * The palette follows the header: blue, green, red, 0.
 * All numbers are little-endian. Rows begin at the bottom, and are padded to 4 bytes.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <itkPNGImageIO.h>

namespace volume
{

/* A file with its header read. `read` fills in the pixels, rows from the top. */
struct Picture {
    uint64_t columns = 0, rows = 0;
    std::string type;
    unsigned values = 1;   /* per pixel */
    double mm[2] = {0, 0}; /* pixel size by the resolution; 0: unknown */
    std::function<void(std::vector<char> &)> read;
};

/* ---- BMP ---- */

constexpr size_t head_bytes = 54;

struct Bmp {
    int64_t columns = 0, rows = 0;
    uint64_t begin = 0, header = 0, bits = 0, packing = 0, colours = 0;
    double metre[2] = {0, 0}; /* pixels a metre */
    bool is_grey = false;     /* each entry of the palette is the grey of its index */

    uint64_t stride() const
    {
        return (static_cast<uint64_t>(columns) + 3) / 4 * 4;
    }
    uint64_t height() const
    {
        return static_cast<uint64_t>(rows < 0 ? -rows : rows);
    }
};

bool read_bmp(Bmp &bmp, std::ifstream &file, const std::string &path)
{
    char head[head_bytes], colour[4];
    file.open(path, std::ios::binary);
    if (!file.read(head, sizeof head))
        return false;
    const auto number = [&](size_t at, unsigned width) {
        return number_in(head + at, width, false);
    };
    const auto with_sign = [&](size_t at) { return static_cast<int32_t>(number(at, 4)); };
    bmp.begin = number(10, 4);
    bmp.header = number(14, 4);
    bmp.columns = with_sign(18);
    bmp.rows = with_sign(22);
    bmp.bits = number(28, 2);
    bmp.packing = number(30, 4);
    bmp.metre[0] = with_sign(38);
    bmp.metre[1] = with_sign(42);
    bmp.colours = number(46, 4) ? number(46, 4) : 256;
    bmp.is_grey = bmp.colours <= 256;
    file.seekg(static_cast<std::streamoff>(14 + bmp.header));
    for (uint64_t i = 0; i < bmp.colours && bmp.is_grey; i++)
        bmp.is_grey =
            file.read(colour, sizeof colour) && number_in(colour, 3, false) == i * 0x10101;
    file.clear();
    return true;
}

/* Describe an unsupported BMP; "" if it is supported. */
std::string lack_of(const Bmp &bmp)
{
    if (bmp.header < 40)
        return words_of("of OS/2 (a header of %llu bytes)", wide(bmp.header));
    if (bmp.bits != 8)
        return words_of("of %llu bits a pixel", wide(bmp.bits));
    if (bmp.packing != 0)
        return "that is packed (as RLE)";
    if (!bmp.is_grey)
        return "with a palette of colours";
    return bmp.columns < 1 || bmp.rows == 0 ? "without pixels" : "";
}

bool is_bmp(const std::string &path)
{
    char head[18] = {0};
    std::ifstream file(path, std::ios::binary);
    file.read(head, sizeof head);
    const uint64_t header = number_in(head + 14, 4, false);
    return std::memcmp(head, "BM", 2) == 0 && header >= 12 && header <= 124;
}

Picture open_bmp(const std::string &path, size_t number, size_t all)
{
    const auto file = std::make_shared<std::ifstream>();
    Bmp bmp;
    Picture picture;
    const std::string what =
        words_of("slice %zu of %zu, %s, is ", number, all, last_name(path).c_str());
    if (!read_bmp(bmp, *file, path))
        refuse("%scut short within its header; fetch it again", what.c_str());
    const std::string lack = lack_of(bmp);
    if (!lack.empty())
        refuse("%sa BMP %s; those of 8 bits of grey are read: `mogrify -format png -type "
               "Grayscale *.bmp` (imagemagick) makes PNG of all",
               what.c_str(), lack.c_str());
    file->seekg(0, std::ios::end);
    const uint64_t bytes = static_cast<uint64_t>(file->tellg());
    const uint64_t needed = bmp.begin + bmp.stride() * bmp.height();
    if (bytes < needed)
        refuse("%scut short: it has %llu bytes, and its header promises %llu; fetch it again",
               what.c_str(), wide(bytes), wide(needed));
    picture.columns = static_cast<uint64_t>(bmp.columns);
    picture.rows = bmp.height();
    picture.type = "uint8";
    for (int a = 0; a < 2; a++)
        picture.mm[a] = bmp.metre[a] > 0 ? 1e3 / bmp.metre[a] : 0;
    picture.read = [=](std::vector<char> &to) {
        for (uint64_t y = 0; y < picture.rows; y++) {
            const uint64_t row = bmp.rows < 0 ? y : picture.rows - 1 - y;
            file->seekg(static_cast<std::streamoff>(bmp.begin + row * bmp.stride()));
            if (!file->read(&to[y * picture.columns], static_cast<std::streamsize>(bmp.columns)))
                refuse("slice %zu of %zu cannot be read", number, all);
        }
    };
    return picture;
}

/* ---- PNG ---- */

Picture open_png(const std::string &path, size_t number, size_t all)
{
    Picture picture;
    const itk::PNGImageIO::Pointer io = itk::PNGImageIO::New();
    io->SetFileName(path);
    try {
        io->ReadImageInformation();
    } catch (const std::exception &) {
        refuse("slice %zu of %zu cannot be decoded", number, all);
    }
    picture.columns = io->GetDimensions(0);
    picture.rows = io->GetDimensions(1);
    picture.type = type_of(*io);
    picture.values = io->GetNumberOfComponents();
    picture.read = [io](std::vector<char> &to) {
        itk::ImageIORegion region(2);
        region.SetSize(0, io->GetDimensions(0));
        region.SetSize(1, io->GetDimensions(1));
        io->SetIORegion(region);
        io->Read(to.data());
    };
    return picture;
}

/* ---- folders ---- */

/* Natural order: slice9 before slice10. */
bool is_before(const std::string &a, const std::string &b)
{
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (std::isdigit(static_cast<unsigned char>(a[i])) &&
            std::isdigit(static_cast<unsigned char>(b[j]))) {
            /* Zeros in front of a number do not count. */
            const auto take_digits = [](const std::string &s, size_t &at) {
                const size_t from = at;
                at = std::min(s.find_first_not_of("0123456789", at), s.size());
                const size_t first = std::min(s.find_first_not_of('0', from), at - 1);
                return s.substr(first, at - first);
            };
            const std::string p = take_digits(a, i), q = take_digits(b, j);
            if (p != q)
                return p.size() != q.size() ? p.size() < q.size() : p < q;
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            i++;
            j++;
        }
    }
    return a.size() - i < b.size() - j;
}

/* Note gaps between the last numbers of names. */
void note_gaps(Volume &volume, const std::vector<std::string> &path)
{
    long former = -1;
    size_t gaps = 0;
    std::string first;
    for (size_t i = 0; i < path.size(); i++) {
        const size_t end = path[i].find_last_of("0123456789");
        const size_t begin = path[i].find_last_not_of("0123456789", end) + 1;
        if (end == std::string::npos || end - begin > 9)
            return;
        const long number = std::atol(path[i].c_str() + begin);
        if (former >= 0 && number != former + 1 && gaps++ == 0)
            first = words_of("after slice %zu", i);
        former = number;
    }
    if (gaps)
        note(volume, words_of("the numbers in the names of the slices leave some out (the first "
                              "time %s)",
                              first.c_str()));
}

/* Note the pixel size by the resolution of a picture. It is not used, because many programs write
 * one without knowing it, and it has no distance between slices. ITK has 1 if it is missing. */
void note_pixels(Volume &volume, double x, double y)
{
    if (std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0 && !(x == 1 && y == 1))
        note(volume, words_of("its resolution says pixels of %.6gx%.6g mm, and nothing how far "
                              "apart slices are: where you know that, open it with "
                              "spacing=%.6g,%.6g,Z",
                              x, y, x, y));
}

void stack_pictures(Volume &volume, std::vector<std::string> path, const std::string &kind)
{
    const bool is_bmp = kind == "bmp";
    const auto open = is_bmp ? open_bmp : open_png;
    std::sort(path.begin(), path.end(), is_before);
    for (size_t z = 0; z < path.size() && !is_bmp; z++) /* open_bmp checks its file itself */
        count_parts(
            kind, path[z],
            words_of("slice %zu of %zu, %s, is ", z + 1, path.size(), last_name(path[z]).c_str()));
    if (kind == "tiff") {
        stack_tiffs(volume, path);
        note_gaps(volume, path);
        return;
    }
    const Picture first = open(path[0], 1, path.size());
    if (first.values != 1)
        refuse("slice 1 of %zu has %u values a pixel (%s); expected grey: `mogrify -format png "
               "-type Grayscale -alpha off *.png` (imagemagick) makes grey of all",
               path.size(), first.values,
               first.values == 2 ? "grey with alpha" : "colours, perhaps of a palette");
    volume.format = is_bmp ? "BMP slices" : "PNG slices";
    volume.type = first.type;
    volume.size[0] = first.columns;
    volume.size[1] = first.rows;
    volume.size[2] = path.size();
    note_gaps(volume, path);
    double mm[2] = {first.mm[0], first.mm[1]};
    if (!is_bmp)
        png_resolution(path[0], mm); /* ITK 5.2 ignores it */
    note_pixels(volume, mm[0], mm[1]);
    volume.send = [&volume, path, open]() {
        std::vector<char> bytes(bytes_in(volume, 1) / volume.size[2]);
        for (size_t z = 0; z < path.size(); z++) {
            const Picture slice = open(path[z], z + 1, path.size());
            if (slice.columns != volume.size[0] || slice.rows != volume.size[1] ||
                slice.values != 1 || slice.type != volume.type)
                refuse("slice %zu of %zu is %llux%llu with %s of %s a pixel, and the first "
                       "%llux%llu with 1 of %s; expected slices of one kind",
                       z + 1, path.size(), wide(slice.columns), wide(slice.rows),
                       plural_of(slice.values, "value").c_str(), slice.type.c_str(),
                       wide(volume.size[0]), wide(volume.size[1]), volume.type.c_str());
            slice.read(bytes);
            send_piece(bytes.data(), bytes.size());
        }
    };
}

} // namespace volume
