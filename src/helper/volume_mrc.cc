/* SPDX-License-Identifier: MIT */
/*
 * MRC, CCP4 and the files of IMOD: a header of 1024 bytes, an extended one, and one run of voxels.
 *
 *     byte 0     nx ny nz: columns, rows and sections; mode: the type of a number
 *     byte 28    mx my mz: intervals in the cell along x, y, z; in a stack of volumes mz sections
 *     byte 40    the cell: x y z in Angstrom, three angles in degrees
 *     byte 64    axes (1 x, 2 y, 3 z) along columns, rows and sections
 *     byte 76    least, greatest and mean value; undetermined if least > greatest
 *     byte 88    ispg: 0 a stack of images, 401 a stack of volumes
 *     byte 92    bytes of the extended header
 *     byte 152   "IMOD" as a number, and flags: 1 bytes are signed, 16 numbers have 4 bits
 *     byte 208   "MAP ", and the byte order: 0x44 little, 0x11 big
 *
 * Bytes (mode 0) are signed. Exceptions: IMOD has a flag for it; and if determined statistics
 * exceed int8, bytes are unsigned. The orientation is unknown, so origins do not matter.
 *
 * From: CCP-EM, MRC2014 (https://www.ccpem.ac.uk/mrc_format/mrc2014.php), and the MRC page of IMOD.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

namespace volume
{

constexpr uint64_t header_bytes = 1024;
constexpr uint64_t piece_most = uint64_t{64} << 20;
constexpr uint64_t imod_stamp = 1146047817;

struct Mrc {
    bool is_big = false;
    uint64_t side[3] = {0};      /* columns, rows and sections of a volume */
    int axis[3] = {0, 1, 2};     /* axis of each */
    uint64_t begin = 0, one = 0; /* bytes before the voxels; of a volume */
};

/* ---- header ---- */

class MrcHeader
{
  public:
    explicit MrcHeader(const std::string &path)
    {
        std::ifstream file(path, std::ios::binary);
        check_bytes(path, header_bytes);
        if (!file.read(bytes_, header_bytes))
            refuse("it cannot be read");
        if (std::memcmp(bytes_ + 208, "MAP ", 4) != 0)
            refuse("its first bytes are not of an MRC file: byte 208 is not \"MAP \"");
    }
    int64_t number(unsigned at) const
    {
        return static_cast<int32_t>(number_in(bytes_ + at, 4, is_big));
    }
    double real(unsigned at) const
    {
        const auto bits = static_cast<uint32_t>(number_in(bytes_ + at, 4, is_big));
        return static_cast<double>(load<float>(&bits));
    }
    unsigned char stamp() const
    {
        return static_cast<unsigned char>(bytes_[212]);
    }
    /* Test whether the first numbers are plausible in this byte order. */
    bool makes_sense() const
    {
        bool makes = number(12) >= 0 && number(12) <= 127 && number(92) >= 0;
        for (unsigned a = 0; a < 3; a++)
            makes = makes && number(4 * a) > 0 && number(4 * a) <= 1 << 24 &&
                    number(64 + 4 * a) >= 0 && number(64 + 4 * a) <= 3;
        return makes;
    }

    bool is_big = false;

  private:
    char bytes_[header_bytes];
};

/* Use the machine stamp if the numbers are plausible then; otherwise the other order. */
void find_order(Volume &volume, MrcHeader &header)
{
    const bool is_said = header.stamp() == 0x44 || header.stamp() == 0x11;
    header.is_big = header.stamp() == 0x11;
    if (header.makes_sense())
        return;
    header.is_big = !header.is_big;
    if (!header.makes_sense())
        refuse("its header is damaged: its sides, mode and axes make sense in no byte order");
    if (is_said)
        note(volume, words_of("its machine stamp is wrong: its numbers are %s-endian",
                              header.is_big ? "big" : "little"));
}

bool bytes_are_signed(Volume &volume, const MrcHeader &header)
{
    const double least = header.real(76), greatest = header.real(80);
    if (static_cast<uint64_t>(header.number(152)) == imod_stamp)
        return header.number(156) & 1;
    if (!(least >= 0 && least < greatest && greatest > 127 && greatest <= 255))
        return true;
    note(volume, words_of("its bytes are taken as unsigned: its greatest value, %g, is beyond "
                          "int8, which its mode (0) says",
                          greatest));
    return false;
}

void take_mode(Volume &volume, const MrcHeader &header)
{
    const int64_t mode = header.number(12);
    const bool is_of_4_bits =
        static_cast<uint64_t>(header.number(152)) == imod_stamp && header.number(156) & 16;
    if (mode == 101 || (mode == 0 && is_of_4_bits))
        refuse("its numbers have 4 bits (mode 101), which are not read; `newstack -mode 1 FILE "
               "OUT` of IMOD makes whole numbers of 16 bits");
    if (mode == 3 || mode == 4)
        refuse("its numbers are complex (mode %d); expected real ones: save the magnitude",
               static_cast<int>(mode));
    if (mode == 16)
        refuse("its voxels are colours (mode 16); expected one value: convert it to grey");
    if (mode == 12)
        refuse("its numbers are float16 (mode 12), which are not read; `newstack -mode 2 FILE OUT` "
               "of IMOD makes float32 of them");
    volume.type = mode == 0   ? bytes_are_signed(volume, header) ? "int8" : "uint8"
                  : mode == 1 ? "int16"
                  : mode == 6 ? "uint16"
                  : mode == 2 ? "float32"
                              : "";
    if (volume.type.empty())
        refuse("its mode is %lld; expected 0, 1, 2 or 6",
               static_cast<long long>(header.number(12)));
}

/* Old programs write zeros for x, y, z. */
void take_axes(Mrc &mrc, const MrcHeader &header)
{
    bool is_there[4] = {false}, is_none = true;
    for (unsigned i = 0; i < 3; i++) {
        is_there[header.number(64 + 4 * i)] = true;
        is_none = is_none && header.number(64 + 4 * i) == 0;
    }
    if (is_none)
        return;
    if (!is_there[1] || !is_there[2] || !is_there[3])
        refuse("its columns, rows and sections run along axes %d, %d, %d; expected 1, 2 and 3 in "
               "any order",
               static_cast<int>(header.number(64)), static_cast<int>(header.number(68)),
               static_cast<int>(header.number(72)));
    for (unsigned i = 0; i < 3; i++)
        mrc.axis[i] = static_cast<int>(header.number(64 + 4 * i)) - 1;
}

void take_sides(Mrc &mrc, Volume &volume, const MrcHeader &header)
{
    const int64_t sections = header.number(8), interval = header.number(36);
    for (unsigned i = 0; i < 3; i++)
        mrc.side[i] = static_cast<uint64_t>(header.number(4 * i));
    if (header.number(88) >= 401) { /* 400 plus the space group */
        if (interval < 1 || sections % interval != 0)
            refuse("it is a stack of volumes of %lld sections in all, and %lld in each; expected "
                   "a whole number of volumes",
                   static_cast<long long>(sections), static_cast<long long>(interval));
        volume.volumes = static_cast<uint64_t>(sections / interval);
        mrc.side[2] = static_cast<uint64_t>(interval);
    }
    for (unsigned i = 0; i < 3; i++)
        volume.size[mrc.axis[i]] = mrc.side[i];
    if (volume.volumes > number_most)
        refuse("it holds more than a million volumes");
}

/* Spacing is the cell divided by its intervals. */
void take_spacing(Volume &volume, const MrcHeader &header)
{
    bool is_square = true;
    volume.known = SPACING;
    for (unsigned a = 0; a < 3; a++) {
        const double mm = header.real(40 + 4 * a) / static_cast<double>(header.number(28 + 4 * a)) *
                          1e-7; /* Angstrom */
        const double angle = header.real(52 + 4 * a);
        is_square = is_square && (angle == 0 || std::fabs(angle - 90) < 1e-3);
        if (!(header.number(28 + 4 * a) > 0 && mm > 0 && std::isfinite(mm)))
            volume.known = NOTHING;
        else
            volume.to_mm[a][a] = mm;
    }
    if (header.number(88) == 0 && header.number(36) == 1 && header.number(8) > 1) {
        volume.known = NOTHING;
        note(volume, "it is a stack of images, and does not say how far apart they are");
    } else if (!is_square) {
        volume.known = NOTHING;
        note(volume, "the axes of its cell are not at right angles: distances of voxels are "
                     "unknown");
    }
    if (volume.known == NOTHING)
        for (unsigned a = 0; a < 3; a++)
            volume.to_mm[a][a] = 1;
}

/* ---- voxels ---- */

/* Send slices of z, whatever the order of axes, and read as few sections as possible. */
void send_mrc(const Volume &volume, const Mrc &mrc, const std::string &path, uint64_t number)
{
    std::ifstream file(path, std::ios::binary);
    const auto width = static_cast<unsigned>(bytes_of(volume.type));
    const uint64_t step[3] = {1, mrc.side[0], mrc.side[0] * mrc.side[1]};
    uint64_t along[3]; /* numbers to the next x, y, z */
    for (unsigned i = 0; i < 3; i++)
        along[mrc.axis[i]] = step[i];
    const bool is_in_order = mrc.axis[2] == 2;
    const uint64_t slice = volume.size[0] * volume.size[1];
    const uint64_t most = std::max<uint64_t>(1, piece_most / (slice * width));
    const uint64_t held = is_in_order ? std::min(most, volume.size[2]) * slice : mrc.one / width;
    std::vector<char> from(held * width), to(std::min(most, volume.size[2]) * slice * width);
    for (uint64_t z = 0, n; z < volume.size[2]; z += n) {
        n = std::min(most, volume.size[2] - z);
        if (is_in_order || z == 0) {
            const uint64_t first = is_in_order ? z * slice * width : 0;
            file.seekg(static_cast<std::streamoff>(mrc.begin + number * mrc.one + first));
            file.read(from.data(),
                      static_cast<std::streamsize>(is_in_order ? n * slice * width : from.size()));
            if (!file)
                refuse("it cannot be read");
            if (mrc.is_big != is_big_machine)
                reverse_each(from, width);
        }
        size_t at = 0;
        for (uint64_t k = 0; k < n; k++)
            for (uint64_t y = 0; y < volume.size[1]; y++)
                for (uint64_t x = 0; x < volume.size[0]; x++, at += width)
                    std::memcpy(
                        &to[at],
                        &from[((is_in_order ? k : z + k) * along[2] + y * along[1] + x * along[0]) *
                              width],
                        width);
        send_piece(to.data(), at);
    }
}

void open_mrc(Volume &volume, const Request &request)
{
    MrcHeader header(request.path);
    Mrc mrc;
    find_order(volume, header);
    mrc.is_big = header.is_big;
    volume.format = "MRC";
    take_mode(volume, header);
    take_axes(mrc, header);
    take_sides(mrc, volume, header);
    take_spacing(volume, header);
    mrc.begin = header_bytes + static_cast<uint64_t>(header.number(92));
    mrc.one = bytes_in(volume, 1);
    bytes_in(volume, volume.volumes); /* check that they fit 64 bits */
    const uint64_t rest = check_bytes(request.path, mrc.begin + volume.volumes * mrc.one);
    if (rest > 0)
        note(volume, words_of("%llu of its bytes come after the voxels", wide(rest)));
    volume.send = [&volume, mrc, &request]() {
        send_mrc(volume, mrc, request.path, request.volume);
    };
}

} // namespace volume
