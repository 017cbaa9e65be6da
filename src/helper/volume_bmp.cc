/* SPDX-License-Identifier: MIT */
/*
 * Slices as BMP: 8 bits of grey, not packed, as SkyScan's NRecon writes them. The reader of ITK 5.2
 * takes no header of 108 or 124 bytes, and makes colours of grey.
 *
 *     0 "BM"   10 where pixels begin   14 bytes of the header, from here
 *     18 columns   22 rows; below 0: from the top   28 bits a pixel   30 packing
 *     38 pixels a metre   46 colours of the palette; 0: 256
 *
 * The palette follows the header: blue, green, red, 0.
 * All little-endian. Rows begin at the bottom, and each fills up to 4 bytes.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cstring>
#include <fstream>

namespace volume
{

constexpr size_t head_bytes = 54;

struct Bmp {
    int64_t columns = 0, rows = 0;
    uint64_t begin = 0, header = 0, bits = 0, packing = 0, colours = 0;
    double metre[2] = {0, 0}; /* pixels */
    bool is_grey = false;     /* each number is the grey of its own */

    uint64_t stride() const
    {
        return (static_cast<uint64_t>(columns) + 3) / 4 * 4;
    }
    uint64_t height() const
    {
        return static_cast<uint64_t>(rows < 0 ? -rows : rows);
    }
};

static bool read_bmp(Bmp &bmp, std::ifstream &file, const std::string &path)
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

/* What is not read of it; "" for nothing. */
static std::string lack_of(const Bmp &bmp)
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

static Bmp open_bmp(std::ifstream &file, const std::string &path, size_t number, size_t all)
{
    Bmp bmp;
    const std::string what =
        words_of("slice %zu of %zu, %s, is ", number, all, last_name(path).c_str());
    if (!read_bmp(bmp, file, path))
        refuse("%scut short within its header; fetch it again", what.c_str());
    const std::string lack = lack_of(bmp);
    if (!lack.empty())
        refuse("%sa BMP %s; those of 8 bits of grey are read: `mogrify -format png -type "
               "Grayscale *.bmp` (imagemagick) makes PNG of all",
               what.c_str(), lack.c_str());
    file.seekg(0, std::ios::end);
    const uint64_t bytes = static_cast<uint64_t>(file.tellg());
    const uint64_t needed = bmp.begin + bmp.stride() * bmp.height();
    if (bytes < needed)
        refuse("%scut short: it has %llu bytes, and its header promises %llu; fetch it again",
               what.c_str(), wide(bytes), wide(needed));
    return bmp;
}

static void send_bmps(const Volume &volume, const std::vector<std::string> &path)
{
    std::vector<char> bytes(volume.size[0] * volume.size[1]);
    for (size_t z = 0; z < path.size(); z++) {
        std::ifstream file;
        const Bmp bmp = open_bmp(file, path[z], z + 1, path.size());
        if (static_cast<uint64_t>(bmp.columns) != volume.size[0] || bmp.height() != volume.size[1])
            refuse("slice %zu of %zu is %lldx%llu, and the first %llux%llu; expected slices of one "
                   "size",
                   z + 1, path.size(), static_cast<long long>(bmp.columns), wide(bmp.height()),
                   wide(volume.size[0]), wide(volume.size[1]));
        for (uint64_t y = 0; y < volume.size[1]; y++) {
            const uint64_t row = bmp.rows < 0 ? y : volume.size[1] - 1 - y;
            file.seekg(static_cast<std::streamoff>(bmp.begin + row * bmp.stride()));
            if (!file.read(&bytes[y * volume.size[0]],
                           static_cast<std::streamsize>(volume.size[0])))
                refuse("slice %zu of %zu cannot be read", z + 1, path.size());
        }
        send_piece(bytes.data(), bytes.size());
    }
}

void stack_bmps(Volume &volume, std::vector<std::string> path)
{
    std::ifstream file;
    std::sort(path.begin(), path.end(), is_before);
    const Bmp first = open_bmp(file, path[0], 1, path.size());
    volume.format = "BMP slices";
    volume.type = "uint8";
    volume.size[0] = static_cast<uint64_t>(first.columns);
    volume.size[1] = first.height();
    volume.size[2] = path.size();
    note_gaps(volume, path);
    if (first.metre[0] > 0 && first.metre[1] > 0)
        note_pixels(volume, 1e3 / first.metre[0], 1e3 / first.metre[1]);
    volume.send = [&volume, path]() { send_bmps(volume, path); };
}

} // namespace volume
