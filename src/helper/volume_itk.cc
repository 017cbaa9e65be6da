/* SPDX-License-Identifier: MIT */
/* The formats that ITK reads, by its readers alone, without its templates of images: this compiles
 * in seconds. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include <itkGiplImageIO.h>
#include <itkHDF5ImageIO.h>
#include <itkImageIOBase.h>
#include <itkMINCImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkVTKImageIO.h>
#include <metaImage.h>

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

/* ---- ITK's images ---- */

/* World of a format. */
enum class World { LPS, RAS, NONE };

struct Kind {
    const char *name, *format;
    itk::ImageIOBase::Pointer (*make)();
    World world;
    unsigned known; /* if the format always has it */
};

const char *type_of(const itk::ImageIOBase &io)
{
    using Type = itk::IOComponentEnum;
    static const std::map<Type, const char *> types = {
        {Type::UCHAR, "uint8"},    {Type::CHAR, "int8"},     {Type::USHORT, "uint16"},
        {Type::SHORT, "int16"},    {Type::UINT, "uint32"},   {Type::INT, "int32"},
        {Type::ULONG, "uint64"},   {Type::LONG, "int64"},    {Type::ULONGLONG, "uint64"},
        {Type::LONGLONG, "int64"}, {Type::FLOAT, "float32"}, {Type::DOUBLE, "float64"}};
    const auto type = types.find(io.GetComponentType());
    if (type == types.end())
        refuse("its voxels are of a type that is not read; expected integers or floats");
    return type->second;
}

/* Convert ITK's spacing, directions and origin to a matrix. In ITK's world x runs to the left and y
 * to the back: only signs change. */
void place_volume(Volume &volume, itk::ImageIOBase &io, World world)
{
    const unsigned dimensions = std::min(io.GetNumberOfDimensions(), 3U);
    for (unsigned a = 0; a < dimensions; a++) {
        const std::vector<double> direction = io.GetDirection(a);
        for (unsigned w = 0; w < 3; w++) {
            const double sign = world == World::LPS && w < 2 ? -1 : 1;
            const double along = world == World::NONE   ? a == w
                                 : w < direction.size() ? direction[w]
                                                        : 0;
            volume.to_mm[w][a] = sign * along * io.GetSpacing(a);
        }
        const double sign = world == World::LPS && a < 2 ? -1 : 1;
        volume.to_mm[a][3] = world == World::NONE ? 0 : sign * io.GetOrigin(a);
    }
    if (dimensions < 3) { /* a plane has no place in a patient */
        volume.known &= ~ORIENTATION;
        if (volume.known & SPACING)
            note(volume, "it is one slice, and says no thickness: 1 mm is taken for it");
    }
}

/* Number of volumes: values of colours are refused, other values are volumes. */
uint64_t volumes_in(itk::ImageIOBase &io)
{
    const unsigned components = io.GetNumberOfComponents();
    uint64_t volumes = components;
    if (components > 1 && io.GetPixelType() != itk::IOPixelEnum::VECTOR &&
        io.GetPixelType() != itk::IOPixelEnum::VARIABLELENGTHVECTOR)
        refuse("its voxels have %u values (colour, or a complex number); expected one: convert it "
               "to grey, or save one channel",
               components);
    for (unsigned a = 3; a < io.GetNumberOfDimensions(); a++)
        if (__builtin_mul_overflow(volumes, static_cast<uint64_t>(io.GetDimensions(a)), &volumes) ||
            volumes > number_most)
            refuse("it holds more than a million volumes; expected one");
    return volumes;
}

/* Read all volumes at once, and send the requested one. */
void send_whole(const Volume &volume, itk::ImageIOBase &io, uint64_t number)
{
    const size_t one = bytes_in(volume, 1), width = bytes_of(volume.type);
    std::vector<char> bytes(bytes_in(volume, volume.volumes));
    io.Read(bytes.data());
    const unsigned components = io.GetNumberOfComponents();
    if (components > 1) { /* interleaved: collect those of one */
        const size_t component = number % components, first = number / components * one;
        for (size_t i = 0; i < one; i += width)
            std::memcpy(&bytes[i], &bytes[first * components + i * components + component * width],
                        width);
        send_piece(bytes.data(), one);
        return;
    }
    send_piece(&bytes[number * one], one);
}

/* Read and send a few slices at a time, for readers that can. */
void send_in_parts(const Volume &volume, itk::ImageIOBase &io, uint64_t number)
{
    const size_t slice = bytes_in(volume, 1) / volume.size[2];
    const uint64_t most = std::max<uint64_t>(1, (size_t{64} << 20) / slice);
    const unsigned dimensions = io.GetNumberOfDimensions();
    std::vector<char> bytes(slice * std::min(most, volume.size[2]));
    for (uint64_t z = 0, n; z < volume.size[2]; z += n) {
        n = std::min(most, volume.size[2] - z);
        itk::ImageIORegion region(dimensions);
        uint64_t rest = number;
        for (unsigned a = 0; a < dimensions; a++) {
            const uint64_t side = io.GetDimensions(a);
            region.SetIndex(a, static_cast<long>(a < 2 ? 0 : a == 2 ? z : rest % side));
            region.SetSize(a, a < 2 ? side : a == 2 ? n : 1);
            if (a > 2)
                rest /= side;
        }
        io.SetIORegion(region);
        io.Read(bytes.data());
        send_piece(bytes.data(), n * slice);
    }
}

/* Fill in the volume once the reader has read its header. */
void describe_volume(Volume &volume, const itk::ImageIOBase::Pointer &io, const Request &request,
                     World world)
{
    volume.type = type_of(*io);
    if (io->GetNumberOfDimensions() < 2)
        refuse("it has 1 dimension; expected 2 or more");
    for (unsigned a = 0; a < std::min(io->GetNumberOfDimensions(), 3U); a++)
        volume.size[a] = io->GetDimensions(a);
    volume.volumes = volumes_in(*io);
    if (world == World::NONE)
        volume.known &= ~ORIENTATION;
    place_volume(volume, *io, world);
    volume.send = [&volume, io, number = request.volume]() {
        itk::ImageIORegion whole(io->GetNumberOfDimensions());
        for (unsigned a = 0; a < io->GetNumberOfDimensions(); a++)
            whole.SetSize(a, io->GetDimensions(a));
        io->SetIORegion(whole);
        if (io->GetNumberOfComponents() == 1 && io->CanStreamRead())
            send_in_parts(volume, *io, number);
        else
            send_whole(volume, *io, number);
    };
}

/* ---- geometry of headers in text ---- */

/* A NRRD has a place only if it names its space, and distances only if all are given; in a
 * MetaImage fields decide. */
unsigned known_by(const std::string &kind, const Header &header)
{
    static const std::set<std::string> anatomical = {"right-anterior-superior",
                                                     "left-anterior-superior",
                                                     "left-posterior-superior",
                                                     "ras",
                                                     "las",
                                                     "lps"};
    if (kind == "meta") {
        const bool has_axes =
            header.has("transformmatrix") || header.has("orientation") || header.has("rotation");
        return (header.has("elementspacing") ? SPACING : NOTHING) |
               (has_axes ? ORIENTATION : NOTHING);
    }
    if (!header.has("space directions"))
        return nrrd_has_spacings(header) ? SPACING : NOTHING;
    return anatomical.count(in_small_letters(header.value("space"))) ? SPACING | ORIENTATION
                                                                     : SPACING;
}

/* Numbers of "(1,0,0) none (0,1,0)", without none; {} if there are other words. */
std::vector<double> numbers_of(const std::string &text)
{
    std::vector<double> numbers;
    for (const char *at = text.c_str(); *at;) {
        char *end;
        const double number = std::strtod(at, &end);
        if (std::strchr("(), \t", *at))
            end = const_cast<char *>(at) + 1;
        else if (std::strncmp(at, "none", 4) == 0)
            end = const_cast<char *>(at) + 4;
        else if (end == at)
            return {};
        else
            numbers.push_back(number);
        at = end;
    }
    return numbers;
}

/* Convert a column of left-anterior-superior to our world. ITK 5.2 reverses x instead of y, and
 * fixed versions reverse y: accept both, and use the signs of the header. False, with the column
 * unchanged, if ITK has other numbers. */
bool turn_column(Volume &volume, int column, const double *is)
{
    const double said[3] = {-is[0], is[1], is[2]};
    bool is_right = true, is_turned = true;
    for (int w = 0; w < 3; w++) {
        const double has = volume.to_mm[w][column], near = 1e-9 * std::fabs(said[w]);
        is_right = is_right && std::fabs(has - said[w]) <= near;
        is_turned = is_turned && std::fabs(has - (w < 2 ? -said[w] : said[w])) <= near;
    }
    if (!is_right && !is_turned)
        return false;
    for (int w = 0; w < 2; w++)
        volume.to_mm[w][column] = std::copysign(volume.to_mm[w][column], said[w]);
    return true;
}

/* Place a NRRD in left-anterior-superior. If ITK has other numbers than the header, its place is
 * unknown, and a note says so. */
void place_las(Volume &volume, itk::ImageIOBase &io, const Header &header)
{
    const std::string space = in_small_letters(header.value("space"));
    if (!(volume.known & ORIENTATION) || (space != "las" && space != "left-anterior-superior"))
        return;
    const bool has_origin = header.has("space origin");
    const std::vector<double> axes = numbers_of(header.value("space directions"));
    std::vector<double> origin = numbers_of(header.value("space origin"));
    bool is_sure = axes.size() == 9 && (!has_origin || origin.size() == 3);
    if (!has_origin) /* as in every space: 0, whose signs ITK keeps and iftty reverses */
        origin = {0.0, -0.0, 0};
    for (int a = 0; a < 3 && is_sure; a++)
        is_sure = turn_column(volume, a, &axes[3 * static_cast<size_t>(a)]);
    is_sure = is_sure && turn_column(volume, 3, origin.data());
    if (!is_sure) {
        volume.known &= ~ORIENTATION;
        place_volume(volume, io, World::NONE);
        note(volume, "its space is left-anterior-superior, and the place of its voxels in it is "
                     "uncertain: sides of the patient are unknown");
    }
}

/* Convert lengths of a header to millimetres. If a unit is unknown, so is the place: axes may be
 * stretched. */
void scale_lengths(Volume &volume, itk::ImageIOBase &io, const Units &units)
{
    const bool has_place = volume.known & ORIENTATION;
    const unsigned dimensions = std::min(io.GetNumberOfDimensions(), 3U);
    for (unsigned a = 0; a < dimensions; a++) {
        double square = 0; /* the length along axis a, in a space that is not the patient's */
        for (unsigned w = 0; w < std::min<size_t>(3, io.GetDirection(a).size()); w++)
            square += std::pow(io.GetDirection(a)[w] * io.GetSpacing(a) * units.mm[w], 2);
        if (units.are_of_space && !has_place &&
            !(units.mm[0] == units.mm[1] && units.mm[1] == units.mm[2]))
            volume.to_mm[a][a] = std::sqrt(square);
        else
            for (unsigned w = 0; w < 3; w++)
                volume.to_mm[w][a] *= units.mm[units.are_of_space ? w : a];
        volume.to_mm[a][3] *= units.mm[a];
    }
    if (units.are_known || !(volume.known & SPACING))
        return;
    volume.known = NOTHING;
    place_volume(volume, io, World::NONE);
    note(volume, words_of("its field \"%s\" has a unit that is not known (" LENGTH_UNITS "): "
                          "distances of voxels are unknown; spacing=X,Y,Z says them in mm",
                          units.field));
}

/* ---- the formats of ITK ---- */

template <typename Reader> itk::ImageIOBase::Pointer make()
{
    return Reader::New().GetPointer();
}

/* ITK 5.2 does not convert the world of MINC: to the right and to the front. A format without a
 * patient has no world. */
const Kind kinds[] = {
    {"nrrd", "NRRD", make<itk::NrrdImageIO>, World::LPS, NOTHING},
    {"meta", "MetaImage", make<itk::MetaImageIO>, World::LPS, NOTHING},
    {"minc", "MINC", make<itk::MINCImageIO>, World::RAS, SPACING | ORIENTATION},
    {"png", "PNG", make<itk::PNGImageIO>, World::NONE, NOTHING},
    {"vtk", "VTK", make<itk::VTKImageIO>, World::NONE, SPACING},
    {"gipl", "GIPL", make<itk::GiplImageIO>, World::NONE, SPACING},
    {"itk-hdf5", "HDF5 of ITK", make<itk::HDF5ImageIO>, World::LPS, SPACING | ORIENTATION},
};

void open_by_itk(Volume &volume, const Request &request, const std::string &name)
{
    const Kind *kind = std::find_if(std::begin(kinds), std::end(kinds),
                                    [&](const Kind &each) { return name == each.name; });
    if (kind == std::end(kinds))
        refuse("it is of no format that is known here");
    const itk::ImageIOBase::Pointer io = kind->make();
    io->SetFileName(request.path);
    count_parts(name, request.path, "");
    const bool is_meta = name == "meta", is_text = is_meta || name == "nrrd";
    const Header header = is_text ? header_of(name, request.path) : Header();
    const Units units = is_text ? units_of(name, header) : Units();
    if (!io->CanReadFile(request.path.c_str()))
        refuse("its first bytes are of a %s file, and the rest of its header is not", kind->format);
    io->ReadImageInformation();
    if (is_meta) {
        std::vector<long> sides;
        for (unsigned a = 0; a < io->GetNumberOfDimensions(); a++)
            sides.push_back(static_cast<long>(io->GetDimensions(a)));
        check_meta(
            request,
            static_cast<itk::MetaImageIO &>(*io).GetMetaImagePointer()->ElementDataFileName(),
            sides);
    }
    volume.format = kind->format;
    volume.known = is_text ? known_by(name, header) : kind->known;
    describe_volume(volume, io, request, volume.known & ORIENTATION ? kind->world : World::NONE);
    if (name == "nrrd")
        place_las(volume, *io, header);
    if (is_text)
        scale_lengths(volume, *io, units);
    if (is_meta)
        scale_meta(volume, header);
    count_voxels(volume, name, request);
    double mm[2];
    if (name == "png" && png_resolution(request.path, mm)) /* ITK 5.2 ignores it */
        note_pixels(volume, mm[0], mm[1]);
}

} // namespace volume
