/* The formats that ITK reads, by its readers directly, without its templates of images: this
 * compiles in seconds. */
#include "image/volume_itk.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <vector>

#include <itkBruker2dseqImageIO.h>
#include <itkGE4ImageIO.h>
#include <itkGE5ImageIO.h>
#include <itkGEAdwImageIO.h>
#include <itkGiplImageIO.h>
#include <itkHDF5ImageIO.h>
#include <itkLSMImageIO.h>
#include <itkMINCImageIO.h>
#include <itkMRCImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkSiemensVisionImageIO.h>
#include <itkStimulateImageIO.h>
#include <itkTIFFImageIO.h>
#include <itkVTKImageIO.h>
#include <metaImage.h>

#include "image/volume_bytes.hh"
#include "image/volume_parts.hh"

namespace volume
{

constexpr size_t fields_most = 1000;

/* ---- what ITK reads ---- */

const char *type_of(itk::ImageIOBase &io)
{
    switch (io.GetComponentType()) {
    case itk::IOComponentEnum::UCHAR:
        return "uint8";
    case itk::IOComponentEnum::CHAR:
        return "int8";
    case itk::IOComponentEnum::USHORT:
        return "uint16";
    case itk::IOComponentEnum::SHORT:
        return "int16";
    case itk::IOComponentEnum::UINT:
        return "uint32";
    case itk::IOComponentEnum::INT:
        return "int32";
    case itk::IOComponentEnum::ULONG:
    case itk::IOComponentEnum::ULONGLONG:
        return "uint64";
    case itk::IOComponentEnum::LONG:
    case itk::IOComponentEnum::LONGLONG:
        return "int64";
    case itk::IOComponentEnum::FLOAT:
        return "float32";
    case itk::IOComponentEnum::DOUBLE:
        return "float64";
    default:
        refuse("its voxels are of a type that is not read; expected integers or floats");
    }
}

/* The matrix of ITK's spacing, directions and origin. Its world runs to the left and to the back
 * where ours runs to the right and to the front: signs change, and nothing else. */
void place(Volume &volume, itk::ImageIOBase &io, World world)
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
    if (dimensions < 3)
        volume.known &= ~SPACING;
}

/* Voxels of several values: colours are refused, others are a series of volumes. */
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

/* All of it at once, and of that the volume that is wanted. */
void send_whole(const Volume &volume, itk::ImageIOBase &io, uint64_t number)
{
    const size_t one = bytes_in(volume, 1), width = bytes_of(volume.type);
    std::vector<char> bytes(bytes_in(volume, volume.volumes));
    io.Read(bytes.data());
    const unsigned components = io.GetNumberOfComponents();
    if (components > 1) { /* next to each other: bring those of one together */
        const size_t component = number % components, first = number / components * one;
        for (size_t i = 0; i < one; i += width)
            std::memcpy(&bytes[i], &bytes[first * components + i * components + component * width],
                        width);
        send_piece(bytes.data(), one);
        return;
    }
    send_piece(&bytes[number * one], one);
}

/* A few slices at a time, where the reader can. */
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

std::vector<long> sides_of(itk::ImageIOBase &io)
{
    std::vector<long> sides;
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); a++)
        sides.push_back(static_cast<long>(io.GetDimensions(a)));
    return sides;
}

/* What is left to do once the reader has read its header. */
void describe(Volume &volume, const itk::ImageIOBase::Pointer &io, const Request &request,
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
    place(volume, *io, world);
    const uint64_t number = request.volume;
    volume.send = [&volume, io, number]() {
        if (number >= volume.volumes)
            refuse("there is no such volume in it");
        io->SetIORegion(whole_region(*io));
        if (io->GetNumberOfComponents() == 1 && io->CanStreamRead())
            send_in_parts(volume, *io, number);
        else
            send_whole(volume, *io, number);
    };
}

/* ITK has 1 where there is none. */
void note_resolution(Volume &volume, itk::ImageIOBase &io)
{
    const double x = io.GetSpacing(0), y = io.GetSpacing(1);
    if (std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0 && !(x == 1 && y == 1))
        note(volume, words_of("its resolution says pixels of %.6gx%.6g mm, and nothing how far "
                              "apart slices are: where you know that, open it with "
                              "spacing=%.6g,%.6g,Z",
                              x, y, x, y));
}

/* ---- headers of text ---- */

std::string Header::value(const char *name) const
{
    const auto found = field.find(name);
    return found == field.end() ? "" : found->second;
}

std::string trimmed(const std::string &text)
{
    const size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/* That of a MetaImage, of "NAME = VALUE", ends with the field that says where its voxels are; a
 * NRRD's, of "NAME: VALUE", with an empty line. */
Header header_of(const std::string &kind, const std::string &path)
{
    const bool is_meta = kind == "meta";
    Header header;
    std::ifstream file(path, std::ios::binary);
    std::string line;
    for (uint64_t at = 0; header.end == 0 && std::getline(file, line);) {
        at += line.size() + (file.eof() ? 0 : 1);
        const size_t between = line.find(is_meta ? '=' : ':');
        const std::string name = in_small_letters(trimmed(line.substr(0, between)));
        if (between != std::string::npos && line[0] != '#' && header.field.size() < fields_most)
            header.field[name] = trimmed(line.substr(between + 1));
        if (is_meta ? name == "elementdatafile" : trimmed(line).empty())
            header.end = at;
    }
    return header;
}

/* NRRD: a place only where it names the space, and distances where it gives them all. */
unsigned known_by_nrrd(const std::string &path)
{
    static const std::set<std::string> anatomical = {"right-anterior-superior",
                                                     "left-anterior-superior",
                                                     "left-posterior-superior",
                                                     "ras",
                                                     "las",
                                                     "lps"};
    const Header header = header_of("nrrd", path);
    const std::string spacings = in_small_letters(header.value("spacings"));
    const bool has_directions = header.field.count("space directions");
    const bool has_spacings =
        header.field.count("spacings") && spacings.find("nan") == std::string::npos;
    unsigned known = has_directions || has_spacings ? SPACING : NOTHING;
    if (has_directions && anatomical.count(in_small_letters(header.value("space"))))
        known |= ORIENTATION;
    return known;
}

unsigned known_by_meta(const std::string &path)
{
    const Header header = header_of("meta", path);
    unsigned known = header.field.count("elementspacing") ? SPACING : NOTHING;
    for (const char *name : {"transformmatrix", "orientation", "rotation"})
        if (header.field.count(name))
            known |= ORIENTATION;
    return known;
}

/* ---- the formats of ITK ---- */

template <typename Reader> itk::ImageIOBase::Pointer make()
{
    return Reader::New().GetPointer();
}

/* ITK 5.2 gives the world of a MINC as it is, to the right and to the front. A format that does not
 * know the patient has no world. */
const Kind kinds[] = {
    {"nrrd", "NRRD", make<itk::NrrdImageIO>, World::LPS, NOTHING},
    {"meta", "MetaImage", make<itk::MetaImageIO>, World::LPS, NOTHING},
    {"minc", "MINC", make<itk::MINCImageIO>, World::RAS, SPACING | ORIENTATION},
    {"mrc", "MRC", make<itk::MRCImageIO>, World::NONE, SPACING},
    {"lsm", "LSM", make<itk::LSMImageIO>, World::NONE, SPACING},
    {"tiff", "TIFF", make<itk::TIFFImageIO>, World::NONE, NOTHING},
    {"png", "PNG", make<itk::PNGImageIO>, World::NONE, NOTHING},
    {"vtk", "VTK", make<itk::VTKImageIO>, World::NONE, SPACING},
    {"gipl", "GIPL", make<itk::GiplImageIO>, World::NONE, SPACING},
    {"ge5", "GE 5", make<itk::GE5ImageIO>, World::LPS, SPACING | ORIENTATION},
    {"ge4", "GE 4", make<itk::GE4ImageIO>, World::LPS, SPACING | ORIENTATION},
    {"geadw", "GE ADW", make<itk::GEAdwImageIO>, World::LPS, SPACING | ORIENTATION},
    {"siemens", "Siemens Vision", make<itk::SiemensVisionImageIO>, World::LPS,
     SPACING | ORIENTATION},
    {"bruker", "Bruker", make<itk::Bruker2dseqImageIO>, World::LPS, SPACING | ORIENTATION},
    {"stimulate", "Stimulate", make<itk::StimulateImageIO>, World::NONE, SPACING},
    {"itk-hdf5", "HDF5 of ITK", make<itk::HDF5ImageIO>, World::LPS, SPACING | ORIENTATION},
};

/* Those that no first bytes tell are tried in turn. */
bool is_tried(const Kind &kind)
{
    static const std::set<std::string> names = {"ge4",    "ge5",  "geadw",    "siemens",
                                                "bruker", "gipl", "stimulate"};
    return names.count(kind.name) > 0;
}

const Kind *find_kind(const std::string &name, const std::string &path)
{
    for (const Kind &kind : kinds)
        if (name == kind.name ||
            (name == "any" && is_tried(kind) && kind.make()->CanReadFile(path.c_str())))
            return &kind;
    return nullptr;
}

void open_by_itk(Volume &volume, const Request &request, const std::string &name)
{
    const Kind *kind = find_kind(name, request.path);
    if (!kind)
        refuse("it is of no format that is known here");
    itk::ImageIOBase::Pointer io = kind->make();
    io->SetFileName(request.path);
    count_parts(kind->name, request.path, "");
    if (!io->CanReadFile(request.path.c_str()))
        refuse("its first bytes are of a %s file, and the rest of its header is not", kind->format);
    if (name == "any")
        check_stimulate(request);
    io->ReadImageInformation();
    if (name == "meta")
        check_meta(
            request,
            static_cast<itk::MetaImageIO &>(*io).GetMetaImagePointer()->ElementDataFileName(),
            sides_of(*io));
    volume.format = kind->format;
    volume.known = name == "nrrd"   ? known_by_nrrd(request.path)
                   : name == "meta" ? known_by_meta(request.path)
                                    : kind->known;
    describe(volume, io, request, volume.known & ORIENTATION ? kind->world : World::NONE);
    count_voxels(volume, kind->name, request);
    if (name == "tiff" || name == "png")
        note_resolution(volume, *io);
    if (name == "mrc")
        for (auto &row : volume.to_mm)
            for (double &number : row)
                number *= 1e-7; /* Angstrom */
    if (name == "lsm")
        for (auto &row : volume.to_mm)
            for (double &number : row)
                number *= 1e3; /* metres */
}

itk::ImageIORegion whole_region(itk::ImageIOBase &io)
{
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); a++)
        region.SetSize(a, io.GetDimensions(a));
    return region;
}

} // namespace volume
