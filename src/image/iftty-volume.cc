/*
 * iftty-volume: reads volumes by ITK, GDCM and HDF5 for the program that started it.
 *
 * One request comes on standard input, of one file or folder; what is in it goes to standard
 * output; volume_helper.h has the protocol byte for byte. Before the first byte of a file is read,
 * the process takes from itself all but reading that file (or that folder, and the folder of a
 * header whose voxels lie beside it). A decoder that crashes takes only this process along.
 *
 * What files say in words (names, numbers and dates of patients, the messages of libraries, which
 * quote them) never leaves this process: what it says itself are words and numbers of its own, and
 * the names of data sets in an HDF5 file.
 *
 * ITK's readers are called directly, without its templates of images: this compiles in seconds.
 */
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <dirent.h>
#include <signal.h>
#include <sys/stat.h>

#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>

#include <hdf5.h>

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
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkSiemensVisionImageIO.h>
#include <itkStimulateImageIO.h>
#include <itkTIFFImageIO.h>
#include <itkVTKImageIO.h>

#include "image/wire.hh"

extern "C" {
#include "base/confine.h"
}

namespace
{

using namespace wire;

constexpr uint64_t path_most = 4096;
constexpr uint64_t side_most = 65534;
constexpr uint64_t number_most = 1000000;
constexpr size_t notes_most = 1200;
constexpr size_t files_most = 100000;
constexpr size_t depth_most = 6;
constexpr size_t piece_most = 4 << 20;
constexpr rlim_t memory_most = RLIM_INFINITY; /* the client says how much */

/* What cannot be read; the words are for the user, and ours alone. */
struct Refusal {
    std::string words;
};

[[noreturn]] void refuse(const char *format, ...) __attribute__((format(printf, 1, 2)));
void refuse(const char *format, ...)
{
    char words[words_most];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    throw Refusal{words};
}

std::string words_of(const char *format, ...) __attribute__((format(printf, 1, 2)));
std::string words_of(const char *format, ...)
{
    char words[words_most];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    return words;
}

/* ---- what is said where a library gives up ---- */

/* The answer where a signal ends this process while it reads: made before, since a handler may do
 * little. Libraries end by assertions that fail, and by reading where nothing is. */
char last_answer[2 * words_most];
size_t last_length;

void expect_end(const std::string &words)
{
    const std::string answer = "error " + std::to_string(words.size()) + "\n" + words;
    last_length = 0;
    std::memcpy(last_answer, answer.data(), std::min(answer.size(), sizeof last_answer));
    last_length = std::min(answer.size(), sizeof last_answer);
}

void end_by_signal(int)
{
    const char *at = last_answer;
    for (size_t left = last_length; left > 0;) {
        const ssize_t n = write(wire::fd, at, left);
        if (n <= 0)
            break;
        at += n;
        left -= static_cast<size_t>(n);
    }
    _exit(4);
}

/* On a stack of its own, since the other may be full. */
void catch_signals()
{
    static char room[65536];
    stack_t stack = {};
    stack.ss_sp = room;
    stack.ss_size = sizeof room;
    sigaltstack(&stack, nullptr);
    struct sigaction action = {};
    action.sa_handler = end_by_signal;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL})
        sigaction(signal, &action, nullptr);
}

/* ---- what is asked, and what is answered ---- */

struct Request {
    std::string kind, data, path;
    bool follows_links = false, fills_gaps = false;
    uint64_t series = 0; /* counted from 1; 0: not said */
    uint64_t volume = 0; /* of a series of volumes, counted from 0 */
};

enum Known : unsigned { NOTHING = 0, SPACING = 1, ORIENTATION = 2 };

/* A volume before its voxels. `send` sends size[0] * size[1] * size[2] values of the type. */
struct Volume {
    uint64_t size[3] = {1, 1, 1};
    std::string format, type;
    uint64_t volumes = 1;
    unsigned known = NOTHING;
    double to_mm[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}; /* right, anterior, superior */
    double slope = 1, intercept = 0;
    std::string notes; /* lines */
    std::function<void()> send;
};

void note(Volume &volume, const std::string &line)
{
    if (volume.notes.size() + line.size() + 1 <= notes_most)
        volume.notes += line + "\n";
}

void progress(uint64_t done, uint64_t total)
{
    transmit("progress " + std::to_string(done) + " " + std::to_string(total) + "\n");
}

void send_piece(const void *bytes, size_t length)
{
    const char *at = static_cast<const char *>(bytes);
    while (length > 0) {
        const size_t piece = std::min(length, piece_most);
        transmit("piece " + std::to_string(piece) + "\n");
        transmit(at, piece);
        at += piece;
        length -= piece;
    }
}

/* The header of an answer; and, when the client asks for them, the voxels. */
void answer(const Volume &volume)
{
    for (const uint64_t side : volume.size)
        if (side < 1 || side > side_most)
            refuse("it has %llu voxels along one side; expected 1 to %llu",
                   static_cast<unsigned long long>(side),
                   static_cast<unsigned long long>(side_most));
    double number[14];
    std::memcpy(number, volume.to_mm, sizeof volume.to_mm);
    number[12] = volume.slope;
    number[13] = volume.intercept;
    std::string line = "volume";
    for (const uint64_t side : volume.size)
        line += " " + std::to_string(side);
    line += " " + std::to_string(volume.volumes) + " " + std::to_string(volume.known) + " " +
            std::to_string(volume.format.size()) + " " + std::to_string(volume.type.size()) + " " +
            std::to_string(volume.notes.size()) + "\n";
    transmit(line + volume.format + volume.type + volume.notes);
    transmit(number, sizeof number);
    if (receive_line() != "voxels")
        leave(2);
    volume.send();
}

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

size_t bytes_of(const std::string &type)
{
    return static_cast<size_t>(std::atoi(type.c_str() + type.find_first_of("0123456789"))) / 8;
}

/* How a format says where its voxels lie. */
enum class World { LPS, RAS, NONE };

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

size_t bytes_in(const Volume &volume, uint64_t volumes)
{
    uint64_t bytes = bytes_of(volume.type);
    for (const uint64_t n : {volume.size[0], volume.size[1], volume.size[2], volumes})
        if (__builtin_mul_overflow(bytes, n, &bytes))
            refuse("its voxels do not fit the memory of any machine");
    return static_cast<size_t>(bytes);
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

itk::ImageIORegion whole_region(itk::ImageIOBase &io)
{
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); a++)
        region.SetSize(a, io.GetDimensions(a));
    return region;
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
            leave(2);
        io->SetIORegion(whole_region(*io));
        if (io->GetNumberOfComponents() == 1 && io->CanStreamRead())
            send_in_parts(volume, *io, number);
        else
            send_whole(volume, *io, number);
    };
}

/* ---- headers of text ---- */

/* The fields of a header of lines "NAME: VALUE" or "NAME = VALUE", by their names in small letters,
 * up to an empty line or the field `last`. */
std::map<std::string, std::string> fields_of(const std::string &path, char between,
                                             const std::string &last)
{
    std::map<std::string, std::string> fields;
    std::ifstream file(path, std::ios::binary);
    std::string line;
    while (fields.size() < 1000 && std::getline(file, line) && line.size() < 65536) {
        if (!line.empty() && line.back() == '\r')
            line.pop_back();
        if (line.empty())
            break;
        const size_t at = line.find(between);
        if (at == std::string::npos || line[0] == '#')
            continue;
        std::string name = line.substr(0, at), value = line.substr(at + 1);
        while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back())))
            name.pop_back();
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        fields[name] = value;
        if (name == last)
            break;
    }
    return fields;
}

/* NRRD: a place only where it names the space, and distances where it gives them all. */
unsigned known_by_nrrd(const std::string &path)
{
    const auto fields = fields_of(path, ':', "");
    const auto space = fields.find("space"), directions = fields.find("space directions"),
               spacings = fields.find("spacings");
    unsigned known = NOTHING;
    if (directions != fields.end() ||
        (spacings != fields.end() && spacings->second.find("nan") == std::string::npos &&
         spacings->second.find("NaN") == std::string::npos))
        known |= SPACING;
    if (space != fields.end() && directions != fields.end()) {
        std::string name = space->second;
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        name.erase(0, name.find_first_not_of(" \t"));
        name = name.substr(0, name.find_last_not_of(" \t") + 1);
        static const std::set<std::string> anatomical = {"right-anterior-superior",
                                                         "left-anterior-superior",
                                                         "left-posterior-superior",
                                                         "ras",
                                                         "las",
                                                         "lps"};
        if (anatomical.count(name))
            known |= ORIENTATION;
    }
    return known;
}

unsigned known_by_meta(const std::string &path)
{
    const auto fields = fields_of(path, '=', "elementdatafile");
    unsigned known = NOTHING;
    if (fields.count("elementspacing"))
        known |= SPACING;
    for (const char *name : {"transformmatrix", "orientation", "rotation"})
        if (fields.count(name))
            known |= ORIENTATION;
    return known;
}

/* ---- the formats of ITK ---- */

template <typename Reader> itk::ImageIOBase::Pointer make()
{
    return Reader::New().GetPointer();
}

struct Kind {
    const char *name, *format;
    itk::ImageIOBase::Pointer (*make)();
    World world;
    unsigned known; /* of a format that always says it */
};

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
    if (!io->CanReadFile(request.path.c_str()))
        refuse("its first bytes are of a %s file, and the rest of its header is not", kind->format);
    io->ReadImageInformation();
    volume.format = kind->format;
    volume.known = name == "nrrd"   ? known_by_nrrd(request.path)
                   : name == "meta" ? known_by_meta(request.path)
                                    : kind->known;
    describe(volume, io, request, volume.known & ORIENTATION ? kind->world : World::NONE);
    if (name == "mrc")
        for (auto &row : volume.to_mm)
            for (double &number : row)
                number *= 1e-7; /* Angstrom */
    if (name == "lsm")
        for (auto &row : volume.to_mm)
            for (double &number : row)
                number *= 1e3; /* metres */
}

/* ---- HDF5 of other programs ---- */

/* Closes what it holds. */
class Handle
{
  public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close)
    {
    }
    ~Handle()
    {
        if (id_ >= 0)
            close_(id_);
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;
    operator hid_t() const
    {
        return id_;
    }

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

struct DataSet {
    std::string name, type;
    std::vector<hsize_t> side;
};

std::string hdf_type(hid_t set)
{
    Handle type(H5Dget_type(set), H5Tclose);
    const size_t bits = 8 * H5Tget_size(type);
    const bool is_power = bits == 8 || bits == 16 || bits == 32 || bits == 64;
    if (H5Tget_class(type) == H5T_INTEGER && is_power)
        return (H5Tget_sign(type) == H5T_SGN_NONE ? "uint" : "int") + std::to_string(bits);
    if (H5Tget_class(type) == H5T_FLOAT && bits >= 16)
        return bits <= 32 ? "float32" : "float64";
    return "";
}

hid_t hdf_memory_type(const std::string &type)
{
    const std::map<std::string, hid_t> types = {
        {"uint8", H5T_NATIVE_UINT8},   {"int8", H5T_NATIVE_INT8},     {"uint16", H5T_NATIVE_UINT16},
        {"int16", H5T_NATIVE_INT16},   {"uint32", H5T_NATIVE_UINT32}, {"int32", H5T_NATIVE_INT32},
        {"uint64", H5T_NATIVE_UINT64}, {"int64", H5T_NATIVE_INT64},   {"float32", H5T_NATIVE_FLOAT},
        {"float64", H5T_NATIVE_DOUBLE}};
    return types.at(type);
}

bool describe_set(DataSet &set, hid_t file, const char *name)
{
    Handle id(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    if (id < 0)
        return false;
    Handle space(H5Dget_space(id), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 3 || rank > 5)
        return false;
    set.name = name;
    set.type = hdf_type(id);
    set.side.resize(static_cast<size_t>(rank));
    H5Sget_simple_extent_dims(space, set.side.data(), nullptr);
    return !set.type.empty();
}

herr_t visit(hid_t file, const char *name, const H5O_info_t *info, void *list)
{
    auto &sets = *static_cast<std::vector<DataSet> *>(list);
    DataSet set;
    if (info->type == H5O_TYPE_DATASET && describe_set(set, file, name))
        sets.push_back(set);
    return sets.size() < 1000 ? 0 : 1;
}

/* "/t0/channel0 (400x512x512 uint16)", in letters that are safe to print. */
std::string listed(const std::vector<DataSet> &sets)
{
    std::string list;
    size_t count = 0;
    for (const DataSet &set : sets) {
        std::string name = "/" + set.name.substr(0, 60);
        for (char &c : name)
            c = c > ' ' && c < 127 ? c : '?';
        for (size_t a = set.side.size(); a-- > 0;)
            name += (a + 1 == set.side.size() ? " (" : "x") + std::to_string(set.side[a]);
        if (count++ == 4)
            return list + words_of(", and %zu more", sets.size() - 4);
        list += (list.empty() ? "" : ", ") + name + " " + set.type + ")";
    }
    return list;
}

/* What ilastik and others note: micrometres along the axes, the slowest first. */
void place_set(Volume &volume, hid_t set)
{
    double um[3] = {0, 0, 0};
    if (H5Aexists(set, "element_size_um") <= 0)
        return;
    Handle attribute(H5Aopen(set, "element_size_um", H5P_DEFAULT), H5Aclose);
    Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 3 || H5Aread(attribute, H5T_NATIVE_DOUBLE, um) < 0)
        return;
    for (int a = 0; a < 3; a++)
        volume.to_mm[a][a] = um[2 - a] / 1e3;
    if (um[0] > 0 && um[1] > 0 && um[2] > 0)
        volume.known = SPACING;
}

/* Slices of the last three dimensions, each of the others at one place. */
void send_set(const Volume &volume, hid_t set, size_t rank, std::vector<hsize_t> from)
{
    const size_t slice = bytes_in(volume, 1) / volume.size[2];
    const uint64_t most = std::max<uint64_t>(1, (size_t{64} << 20) / slice);
    std::vector<char> bytes(slice * std::min(most, volume.size[2]));
    for (uint64_t z = 0, n; z < volume.size[2]; z += n) {
        n = std::min(most, volume.size[2] - z);
        std::vector<hsize_t> count(rank, 1);
        from[rank - 3] = z;
        count[rank - 3] = n;
        count[rank - 2] = volume.size[1];
        count[rank - 1] = volume.size[0];
        Handle space(H5Dget_space(set), H5Sclose);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr);
        Handle memory(H5Screate_simple(static_cast<int>(rank), count.data(), nullptr), H5Sclose);
        if (H5Dread(set, hdf_memory_type(volume.type), memory, space, H5P_DEFAULT, bytes.data()) <
            0)
            refuse("the data set is damaged, or packed in a way that is not known here");
        send_piece(bytes.data(), n * slice);
    }
}

const DataSet &choose_set(const std::vector<DataSet> &sets, const std::string &wanted)
{
    if (sets.empty())
        refuse("it holds no data set of three dimensions of integers or floats");
    if (wanted.empty() && sets.size() == 1)
        return sets[0];
    for (const DataSet &set : sets)
        if (set.name == wanted || "/" + set.name == wanted)
            return set;
    refuse("%s; choose one with data=NAME: %s",
           wanted.empty() ? words_of("it holds %zu data sets", sets.size()).c_str()
                          : "it has no such data set of three dimensions",
           listed(sets).c_str());
}

void open_hdf5(Volume &volume, const Request &request)
{
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const hid_t id = H5Fopen(request.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0)
        refuse("its first bytes are of an HDF5 file, and the rest of it is damaged");
    const std::shared_ptr<Handle> file = std::make_shared<Handle>(id, H5Fclose);
    for (const char *group : {"/ITKImage", "/minc-2.0"})
        if (H5Lexists(*file, group, H5P_DEFAULT) > 0) {
            open_by_itk(volume, request, group[1] == 'I' ? "itk-hdf5" : "minc");
            return;
        }
    std::vector<DataSet> sets;
    H5Ovisit(*file, H5_INDEX_NAME, H5_ITER_INC, visit, &sets);
    const DataSet chosen = choose_set(sets, request.data);
    const size_t rank = chosen.side.size();
    for (size_t a = 0; a < 3; a++)
        volume.size[a] = chosen.side[rank - 1 - a];
    for (size_t a = 0; a + 3 < rank; a++)
        volume.volumes *= chosen.side[a];
    if (volume.volumes < 1 || volume.volumes > number_most)
        refuse("the data set holds no volume, or more than a million");
    volume.format = "HDF5";
    volume.type = chosen.type;
    std::vector<hsize_t> from(rank, 0);
    uint64_t rest = request.volume;
    for (size_t a = rank - 3; a-- > 0; rest /= chosen.side[a])
        from[a] = rest % chosen.side[a];
    const std::shared_ptr<Handle> set =
        std::make_shared<Handle>(H5Dopen2(*file, chosen.name.c_str(), H5P_DEFAULT), H5Dclose);
    place_set(volume, *set);
    volume.send = [&volume, file, set, rank, from]() { send_set(volume, *set, rank, from); };
}

/* ---- DICOM: one slice ---- */

struct Slice {
    std::string path, series, object; /* never said */
    std::string modality;
    unsigned frame = 0, frames = 1;
    unsigned columns = 0, rows = 0, samples = 1, bits = 16;
    bool is_signed = false, has_position = false, has_axes = false, is_inverse = false;
    double position[3] = {0, 0, 0}, axis[6] = {1, 0, 0, 0, 1, 0}; /* left, posterior, superior */
    double spacing[2] = {0, 0}; /* of rows, of columns; 0: not said */
    double between = 0, thickness = 0;
    double slope = 1, intercept = 0;
    int series_number = 0, instance = 0, acquisition = 0, time = 0, echo = 0;
    double along = 0; /* its place on the normal of its plane */
};

const gdcm::Tag frames_tag(0x0028, 0x0008), shared_tag(0x5200, 0x9229), each_tag(0x5200, 0x9230),
    detector_tag(0x0054, 0x0022), offsets_tag(0x3004, 0x000c);

std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value =
        set.FindDataElement(tag) ? set.GetDataElement(tag).GetByteValue() : nullptr;
    std::string text = value ? std::string(value->GetPointer(), value->GetLength()) : "";
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
        text.pop_back();
    return text;
}

/* Takes up to `most` decimal numbers; how many there were, of those that are finite. */
size_t decimals_of(const gdcm::DataSet &set, const gdcm::Tag &tag, double *out, size_t most)
{
    const std::string text = text_of(set, tag);
    const char *at = text.c_str();
    size_t count = 0;
    for (char *end; count < most && *at; at = *end == '\\' ? end + 1 : "") {
        const double number = std::strtod(at, &end);
        if (end == at || !std::isfinite(number))
            break;
        out[count++] = number;
        while (*end == ' ')
            end++;
    }
    return count;
}

void take_decimal(double &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    if (decimals_of(set, tag, &number, 1) == 1)
        out = number;
}

void take_integer(int &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    if (decimals_of(set, tag, &number, 1) == 1 && std::fabs(number) < 1e9)
        out = static_cast<int>(number);
}

/* A binary number of 16 or 32 bits, which GDCM holds in the order of this machine. */
void take_binary(unsigned &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value =
        set.FindDataElement(tag) ? set.GetDataElement(tag).GetByteValue() : nullptr;
    uint16_t half;
    uint32_t whole;
    if (value && value->GetLength() == sizeof half) {
        std::memcpy(&half, value->GetPointer(), sizeof half);
        out = half;
    } else if (value && value->GetLength() == sizeof whole) {
        std::memcpy(&whole, value->GetPointer(), sizeof whole);
        out = whole;
    }
}

/* Six numbers that are two unit vectors at right angles, within what decimals lose. */
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

/* What a data set says of a slice; of an enhanced image, one of its groups of functions. */
void take_place(Slice &slice, const gdcm::DataSet &set)
{
    double number[6];
    if (decimals_of(set, gdcm::Tag(0x0020, 0x0032), number, 3) == 3) {
        std::copy(number, number + 3, slice.position);
        slice.has_position = true;
    }
    if (decimals_of(set, gdcm::Tag(0x0020, 0x0037), number, 6) == 6 && are_axes(number)) {
        std::copy(number, number + 6, slice.axis);
        slice.has_axes = true;
    }
    if (decimals_of(set, gdcm::Tag(0x0028, 0x0030), number, 2) == 2 && number[0] > 0 &&
        number[1] > 0)
        std::copy(number, number + 2, slice.spacing);
    take_decimal(slice.between, set, gdcm::Tag(0x0018, 0x0088));
    take_decimal(slice.thickness, set, gdcm::Tag(0x0018, 0x0050));
    take_decimal(slice.slope, set, gdcm::Tag(0x0028, 0x1053));
    take_decimal(slice.intercept, set, gdcm::Tag(0x0028, 0x1052));
    take_decimal(slice.slope, set, gdcm::Tag(0x3004, 0x000e)); /* of a dose */
    take_integer(slice.time, set, gdcm::Tag(0x0020, 0x0100));
    unsigned time = 0;
    take_binary(time, set, gdcm::Tag(0x0020, 0x9128));
    if (time)
        slice.time = static_cast<int>(time);
}

/* The first item of a sequence, or item `number`; empty where there is none. */
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
}

void take_pixels(Slice &slice, const gdcm::DataSet &set)
{
    unsigned is_signed = 0;
    take_binary(slice.rows, set, gdcm::Tag(0x0028, 0x0010));
    take_binary(slice.columns, set, gdcm::Tag(0x0028, 0x0011));
    take_binary(slice.samples, set, gdcm::Tag(0x0028, 0x0002));
    take_binary(slice.bits, set, gdcm::Tag(0x0028, 0x0100));
    take_binary(is_signed, set, gdcm::Tag(0x0028, 0x0103));
    slice.is_signed = is_signed == 1;
    const std::string colours = text_of(set, gdcm::Tag(0x0028, 0x0004));
    slice.is_inverse = colours == "MONOCHROME1";
    if (!colours.empty() && colours.compare(0, 10, "MONOCHROME") != 0)
        slice.samples = 3; /* a palette */
}

/* The order in which those of one place, or without a place, come. */
void take_order(Slice &slice, const gdcm::DataSet &set)
{
    slice.series = text_of(set, gdcm::Tag(0x0020, 0x000e));
    slice.object = text_of(set, gdcm::Tag(0x0008, 0x0018));
    slice.modality = text_of(set, gdcm::Tag(0x0008, 0x0060));
    take_integer(slice.series_number, set, gdcm::Tag(0x0020, 0x0011));
    take_integer(slice.acquisition, set, gdcm::Tag(0x0020, 0x0012));
    take_integer(slice.instance, set, gdcm::Tag(0x0020, 0x0013));
    take_integer(slice.echo, set, gdcm::Tag(0x0018, 0x0086));
}

void normal_of(double normal[3], const double axis[6])
{
    for (int w = 0; w < 3; w++) {
        const int u = (w + 1) % 3, v = (w + 2) % 3;
        normal[w] = axis[u] * axis[3 + v] - axis[v] * axis[3 + u];
    }
}

/* The frames of a file that holds several. Without a place of their own they have none. */
void add_frames(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set)
{
    Slice common = first;
    take_functions(common, item_of(set, shared_tag, 0));
    std::vector<double> offsets(common.frames);
    const bool has_offsets =
        common.has_position && common.has_axes &&
        decimals_of(set, offsets_tag, offsets.data(), offsets.size()) == offsets.size();
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

/* Whether the first bytes may be of DICOM, with or without its preamble. */
bool may_be_dicom(const std::string &path)
{
    char bytes[132] = {0};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes, sizeof bytes);
    if (file.gcount() == sizeof bytes && std::memcmp(bytes + 128, "DICM", 4) == 0)
        return true;
    return file.gcount() >= 16 &&
           ((bytes[1] == 0 && (bytes[0] == 2 || bytes[0] == 8) && bytes[3] == 0) ||
            (bytes[0] == 0 && bytes[1] == 8 && bytes[2] == 0));
}

/* The slices of a file; false where it is no DICOM. One without pixels adds none. */
bool scan(std::vector<Slice> &slices, const std::string &path)
{
    static const std::set<gdcm::Tag> wanted = {gdcm::Tag(0x0008, 0x0018),
                                               gdcm::Tag(0x0008, 0x0060),
                                               gdcm::Tag(0x0018, 0x0050),
                                               gdcm::Tag(0x0018, 0x0086),
                                               gdcm::Tag(0x0018, 0x0088),
                                               gdcm::Tag(0x0020, 0x000e),
                                               gdcm::Tag(0x0020, 0x0011),
                                               gdcm::Tag(0x0020, 0x0012),
                                               gdcm::Tag(0x0020, 0x0013),
                                               gdcm::Tag(0x0020, 0x0032),
                                               gdcm::Tag(0x0020, 0x0037),
                                               gdcm::Tag(0x0020, 0x0100),
                                               gdcm::Tag(0x0028, 0x0002),
                                               gdcm::Tag(0x0028, 0x0004),
                                               frames_tag,
                                               gdcm::Tag(0x0028, 0x0010),
                                               gdcm::Tag(0x0028, 0x0011),
                                               gdcm::Tag(0x0028, 0x0030),
                                               gdcm::Tag(0x0028, 0x0100),
                                               gdcm::Tag(0x0028, 0x0103),
                                               gdcm::Tag(0x0028, 0x1052),
                                               gdcm::Tag(0x0028, 0x1053),
                                               detector_tag,
                                               offsets_tag,
                                               gdcm::Tag(0x3004, 0x000e),
                                               shared_tag,
                                               each_tag};
    if (!may_be_dicom(path))
        return false;
    gdcm::Reader reader;
    reader.SetFileName(path.c_str());
    if (!reader.ReadSelectedTags(wanted))
        return false;
    const gdcm::DataSet &set = reader.GetFile().GetDataSet();
    Slice slice;
    slice.path = path;
    take_pixels(slice, set);
    if (slice.rows == 0 || slice.columns == 0)
        return true;
    take_order(slice, set);
    take_place(slice, set);
    take_place(slice, item_of(set, detector_tag, 0));
    int frames = 1;
    take_integer(frames, set, frames_tag);
    slice.frames = static_cast<unsigned>(std::min(std::max(frames, 1), 65535));
    if (slice.frames > 1 || set.FindDataElement(each_tag))
        add_frames(slices, slice, set);
    else
        slices.push_back(slice);
    return true;
}

/* ---- DICOM: a series ---- */

bool are_parallel(const Slice &a, const Slice &b)
{
    for (int i = 0; i < 6; i++)
        if (std::fabs(a.axis[i] - b.axis[i]) > 1e-3)
            return false;
    return true;
}

bool are_alike(const Slice &a, const Slice &b)
{
    return a.series == b.series && a.columns == b.columns && a.rows == b.rows &&
           a.samples == b.samples && a.has_axes == b.has_axes && a.has_position == b.has_position &&
           are_parallel(a, b) && std::fabs(a.spacing[0] - b.spacing[0]) <= 1e-4 * a.spacing[0] &&
           std::fabs(a.spacing[1] - b.spacing[1]) <= 1e-4 * a.spacing[1];
}

using Series = std::vector<Slice>;

/* Slices of one series that lie in one direction and have one size, in the order of the numbers of
 * their series. */
std::vector<Series> series_of(std::vector<Slice> slices)
{
    std::vector<Series> all;
    for (Slice &slice : slices) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const Series &series) {
            return are_alike(series[0], slice);
        });
        if (at == all.end())
            all.push_back({slice});
        else
            at->push_back(slice);
    }
    std::stable_sort(all.begin(), all.end(), [](const Series &a, const Series &b) {
        return std::tie(a[0].series_number, a[0].series) <
               std::tie(b[0].series_number, b[0].series);
    });
    return all;
}

/* The modality by its code; nothing else that may stand there is said. */
std::string modality_of(const Slice &slice)
{
    static const std::set<std::string> known = {"CT", "MR", "PT", "NM", "US",  "CR",     "DX", "MG",
                                                "XA", "RF", "OT", "SC", "OCT", "RTDOSE", "SEG"};
    return known.count(slice.modality) ? slice.modality : "of another modality";
}

std::string plural_of(size_t count, const char *noun)
{
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/* "1: 120 slices of 512x512, CT; 2: ..." */
std::string listed(const std::vector<Series> &all)
{
    std::string list;
    for (size_t i = 0; i < all.size(); i++) {
        if (i == 6)
            return list + words_of("; and %zu more", all.size() - i);
        const Slice &slice = all[i][0];
        list += words_of("%s%zu: %s of %ux%u, %s", i ? "; " : "", i + 1,
                         plural_of(all[i].size(), "slice").c_str(), slice.columns, slice.rows,
                         modality_of(slice).c_str());
    }
    return list;
}

Series choose_series(const std::vector<Series> &all, uint64_t wanted)
{
    if (wanted == 0 && all.size() == 1)
        return all[0];
    if (wanted == 0)
        refuse("it holds %zu series; choose one with series=N: %s", all.size(),
               listed(all).c_str());
    if (wanted > all.size())
        refuse("there is no series %llu; it holds %s", static_cast<unsigned long long>(wanted),
               listed(all).c_str());
    return all[wanted - 1];
}

/* Files that are there twice count once. */
size_t drop_copies(Series &series)
{
    std::set<std::pair<std::string, unsigned>> seen;
    const size_t before = series.size();
    series.erase(
        std::remove_if(
            series.begin(), series.end(),
            [&](const Slice &slice) {
                return !slice.object.empty() && !seen.insert({slice.object, slice.frame}).second;
            }),
        series.end());
    return before - series.size();
}

bool have_places(const Series &series)
{
    return series[0].has_position && series[0].has_axes;
}

/* By their places along the normal of the first; those of one place, and all where they have none,
 * by time, echo and number. */
void sort_slices(Series &series)
{
    double normal[3];
    normal_of(normal, series[0].axis);
    for (Slice &slice : series)
        for (int w = 0; w < 3 && have_places(series); w++)
            slice.along += normal[w] * slice.position[w];
    std::stable_sort(series.begin(), series.end(), [](const Slice &a, const Slice &b) {
        /* what is nearer than this lies in one place */
        const double p = std::floor(a.along * 200 + 0.5), q = std::floor(b.along * 200 + 0.5);
        return std::tie(p, a.time, a.echo, a.acquisition, a.instance, a.frame) <
               std::tie(q, b.time, b.echo, b.acquisition, b.instance, b.frame);
    });
}

bool is_same_place(const Slice &a, const Slice &b)
{
    return std::fabs(a.along - b.along) < 0.0075;
}

/* How many slices lie in each place, which must be as many everywhere. */
size_t count_volumes(const Series &series)
{
    std::vector<size_t> count;
    if (!have_places(series))
        return 1;
    for (size_t i = 0; i < series.size(); i++)
        if (i > 0 && is_same_place(series[i - 1], series[i]))
            count.back()++;
        else
            count.push_back(1);
    const size_t most = *std::max_element(count.begin(), count.end());
    const size_t least = *std::min_element(count.begin(), count.end());
    const auto first = std::max_element(count.begin(), count.end()) - count.begin();
    const auto fewer = std::min_element(count.begin(), count.end()) - count.begin();
    if (most != least)
        refuse("slices are doubled or missing: place %td of %zu along the series holds %zu slices "
               "and place %td holds %zu; put those of one volume into a folder of their own",
               first + 1, count.size(), most, fewer + 1, least);
    return most;
}

/* Where gaps are, in steps: 0 between slices that follow each other. */
struct Gaps {
    double step = 0;             /* the usual distance */
    double least = 0, most = 0;  /* found */
    std::vector<size_t> missing; /* after slice i */
    size_t all = 0;              /* slices that are missing */
    bool is_irregular = false;
};

Gaps gaps_of(const std::vector<double> &along)
{
    Gaps gaps;
    std::vector<double> steps;
    for (size_t i = 1; i < along.size(); i++)
        steps.push_back(along[i] - along[i - 1]);
    gaps.missing.resize(steps.size());
    if (steps.empty())
        return gaps;
    std::vector<double> sorted = steps;
    std::sort(sorted.begin(), sorted.end());
    gaps.step = sorted[(sorted.size() - 1) / 2];
    gaps.least = sorted.front();
    gaps.most = sorted.back();
    bool are_multiples = true;
    for (size_t i = 0; i < steps.size(); i++) {
        const double times = std::floor(steps[i] / gaps.step + 0.5);
        const double off = std::fabs(steps[i] - times * gaps.step);
        are_multiples &= times >= 1 && times < 1000 && off <= 0.02 * gaps.step + 0.005;
        gaps.missing[i] = are_multiples ? static_cast<size_t>(times) - 1 : 0;
        gaps.all += gaps.missing[i];
    }
    if (!are_multiples) {
        gaps.missing.assign(steps.size(), 0);
        gaps.all = 0;
        gaps.is_irregular = true;
    }
    return gaps;
}

std::string listed(const Gaps &gaps)
{
    std::string list;
    size_t count = 0;
    for (size_t i = 0; i < gaps.missing.size(); i++)
        if (gaps.missing[i] && count++ < 8)
            list +=
                words_of("%s%zu after slice %zu", list.empty() ? "" : ", ", gaps.missing[i], i + 1);
    return list + (count > 8 ? words_of(", and in %zu more places", count - 8) : "");
}

/* A series as it is read: `slice[z]` of the volume that is wanted, of frame `blank` where there is
 * none. */
struct Stack {
    std::vector<Slice> slice;
    bool is_real = false; /* rescaled each by its own: float32 */
    double slope = 1, intercept = 0;
};

const unsigned blank = 65535;

void note_unevenness(Volume &volume, const Gaps &gaps, const std::vector<Slice> &slice)
{
    const size_t last = slice.size() - 1;
    if (gaps.is_irregular) {
        const double mean = (slice[last].along - slice[0].along) / static_cast<double>(last);
        double off = 0;
        for (size_t i = 0; i <= last; i++)
            off = std::max(
                off, std::fabs(slice[i].along - slice[0].along - mean * static_cast<double>(i)));
        note(volume, words_of("slices are not evenly spaced: %g to %g mm apart; taken as %g mm, "
                              "which puts a slice up to %.2g mm off its place",
                              gaps.least, gaps.most, mean, off));
    }
    double sideways = 0;
    for (size_t i = 1; i < last; i++) {
        const double part =
            (slice[i].along - slice[0].along) / (slice[last].along - slice[0].along);
        for (int w = 0; w < 3; w++) {
            const double line =
                slice[0].position[w] + part * (slice[last].position[w] - slice[0].position[w]);
            sideways = std::max(sideways, std::fabs(slice[i].position[w] - line));
        }
    }
    if (sideways > 0.1)
        note(volume,
             words_of("slices do not lie in one line: up to %.2g mm to the side", sideways));
}

/* Puts blank slices where some are missing, if the user wants them. */
void close_gaps(std::vector<Slice> &slice, const Gaps &gaps, bool fills_gaps, Volume &volume)
{
    if (gaps.all == 0)
        return;
    if (!fills_gaps)
        refuse("%s missing (%s) of %zu; `open FOLDER missing=blank` puts blank ones in their "
               "places",
               gaps.all == 1 ? "a slice is" : (std::to_string(gaps.all) + " slices are").c_str(),
               listed(gaps).c_str(), slice.size() + gaps.all);
    std::vector<Slice> filled;
    for (size_t i = 0; i < slice.size(); i++) {
        filled.push_back(slice[i]);
        for (size_t n = 0; i + 1 < slice.size() && n < gaps.missing[i]; n++) {
            filled.push_back(slice[i]);
            filled.back().frame = blank;
        }
    }
    slice = filled;
    note(volume, words_of("%s: blank in their places", listed(gaps).c_str()));
}

/* The way from voxels to the world: rows, columns, and from the first slice to the last. */
void place(Volume &volume, const std::vector<Slice> &slice)
{
    const Slice &first = slice.front(), &last = slice.back();
    const size_t steps = slice.size() - 1;
    double column[3][3], normal[3];
    normal_of(normal, first.axis);
    const double depth = first.between > 0 ? first.between : first.thickness;
    const bool is_placed = first.has_position && first.has_axes;
    for (int w = 0; w < 3; w++) {
        column[0][w] = first.axis[w] * (first.spacing[1] > 0 ? first.spacing[1] : 1);
        column[1][w] = first.axis[3 + w] * (first.spacing[0] > 0 ? first.spacing[0] : 1);
        column[2][w] = steps > 0 && is_placed
                           ? (last.position[w] - first.position[w]) / static_cast<double>(steps)
                           : normal[w] * (depth > 0 ? depth : 1);
        const double sign = is_placed && w < 2 ? -1 : 1;
        for (int a = 0; a < 3; a++)
            volume.to_mm[w][a] = sign * column[a][w];
        volume.to_mm[w][3] = is_placed ? sign * first.position[w] : 0;
    }
    if (first.spacing[0] > 0 && (steps > 0 && is_placed ? true : depth > 0))
        volume.known |= SPACING;
    if (is_placed)
        volume.known |= ORIENTATION;
    else
        note(volume, "its slices hold no place in the patient: they are in the order of their "
                     "numbers");
}

/* What number a slice holds, and what a blank one. */
void settle_type(Volume &volume, Stack &stack)
{
    const Slice &first = stack.slice[0];
    stack.slope = first.slope;
    stack.intercept = first.intercept;
    for (const Slice &slice : stack.slice)
        stack.is_real |= slice.slope != first.slope || slice.intercept != first.intercept ||
                         slice.bits != first.bits || slice.is_signed != first.is_signed;
    if (first.samples != 1)
        refuse("its pixels have colours; expected one value each");
    if (first.bits != 8 && first.bits != 16 && first.bits != 32)
        refuse("its pixels have %u bits; expected 8, 16 or 32 (a segmentation of 1 bit: convert it "
               "with segimage2itkimage of dcmqi)",
               first.bits);
    volume.type =
        stack.is_real ? "float32" : (first.is_signed ? "int" : "uint") + std::to_string(first.bits);
    if (!stack.is_real) {
        volume.slope = stack.slope;
        volume.intercept = stack.intercept;
    }
    if (first.is_inverse)
        note(volume, "its values are for display with bright and dark exchanged (MONOCHROME1)");
}

/* ---- DICOM: pixels ---- */

/* The number at `at`, of so many bytes. */
int64_t number_at(const char *at, unsigned bits, bool is_signed)
{
    uint64_t value = 0;
    if (bits == 8) {
        value = static_cast<uint8_t>(*at);
    } else if (bits == 16) {
        uint16_t half;
        std::memcpy(&half, at, sizeof half);
        value = half;
    } else {
        uint32_t whole;
        std::memcpy(&whole, at, sizeof whole);
        value = whole;
    }
    const uint64_t sign = uint64_t{1} << (bits - 1);
    return is_signed ? static_cast<int64_t>(value ^ sign) - static_cast<int64_t>(sign)
                     : static_cast<int64_t>(value);
}

/* Decodes files; a file of several frames once for all of them that follow each other. */
class Decoder
{
  public:
    /* The pixels of a slice, or nothing where they cannot be had. */
    const char *decode(const Slice &slice)
    {
        const size_t frame = size_t{slice.columns} * slice.rows * (slice.bits / 8);
        if (slice.path != path_ && !read(slice, frame))
            return nullptr;
        return &bytes_[frame * slice.frame];
    }

  private:
    bool read(const Slice &slice, size_t frame)
    {
        gdcm::ImageReader reader;
        path_.clear();
        reader.SetFileName(slice.path.c_str());
        if (!reader.Read())
            return false;
        const gdcm::Image &image = reader.GetImage();
        const gdcm::PixelFormat &format = image.GetPixelFormat();
        if (image.GetDimension(0) != slice.columns || image.GetDimension(1) != slice.rows ||
            format.GetBitsAllocated() != slice.bits || format.GetSamplesPerPixel() != 1 ||
            image.GetBufferLength() != frame * slice.frames)
            return false;
        bytes_.resize(frame * slice.frames);
        if (!image.GetBuffer(bytes_.data()))
            return false;
        path_ = slice.path;
        clear_unused(format);
        return true;
    }

    /* Bits above those that are stored held overlays once, and are no part of the number. */
    void clear_unused(const gdcm::PixelFormat &format)
    {
        const unsigned bits = format.GetBitsAllocated(), stored = format.GetBitsStored();
        if (bits != 16 || stored >= bits || format.GetHighBit() + 1U != stored)
            return;
        const unsigned mask = (1U << stored) - 1, sign = 1U << (stored - 1);
        const bool is_signed = format.GetPixelRepresentation() == 1;
        for (size_t i = 0; i + 1 < bytes_.size(); i += 2) {
            uint16_t value;
            std::memcpy(&value, &bytes_[i], sizeof value);
            const unsigned kept = value & mask;
            value = static_cast<uint16_t>(is_signed ? (kept ^ sign) - sign : kept);
            std::memcpy(&bytes_[i], &value, sizeof value);
        }
    }

    std::string path_;
    std::vector<char> bytes_;
};

/* A blank slice holds what is air in a CT, and else 0. */
void send_blank(const Volume &volume, const Stack &stack, const Slice &slice)
{
    const size_t pixels = size_t{slice.columns} * slice.rows;
    const double real = slice.modality == "CT" ? -1024 : 0;
    std::vector<char> bytes(pixels * bytes_of(volume.type));
    const double stored = (real - stack.intercept) / stack.slope;
    for (size_t i = 0; i < pixels; i++)
        if (stack.is_real) {
            const float value = static_cast<float>(real);
            std::memcpy(&bytes[4 * i], &value, sizeof value);
        } else if (volume.type == "int16" && stored >= -32768 && stored <= 32767) {
            const int16_t value = static_cast<int16_t>(stored);
            std::memcpy(&bytes[2 * i], &value, sizeof value);
        }
    send_piece(bytes.data(), bytes.size());
}

void send_real(const char *from, const Slice &slice)
{
    std::vector<float> real(size_t{slice.columns} * slice.rows);
    for (size_t i = 0; i < real.size(); i++)
        real[i] = static_cast<float>(static_cast<double>(number_at(from + i * (slice.bits / 8),
                                                                   slice.bits, slice.is_signed)) *
                                         slice.slope +
                                     slice.intercept);
    send_piece(real.data(), real.size() * sizeof(float));
}

void send_stack(const Volume &volume, const Stack &stack)
{
    Decoder decoder;
    for (size_t z = 0; z < stack.slice.size(); z++) {
        const Slice &slice = stack.slice[z];
        if (slice.frame == blank) {
            send_blank(volume, stack, slice);
            continue;
        }
        const std::string words =
            words_of("slice %zu of %zu cannot be decoded: it is damaged, or packed in a way that "
                     "is not known here",
                     z + 1, stack.slice.size());
        expect_end(words);
        const char *bytes = decoder.decode(slice);
        if (!bytes)
            throw Refusal{words};
        if (stack.is_real)
            send_real(bytes, slice);
        else
            send_piece(bytes, size_t{slice.columns} * slice.rows * (slice.bits / 8));
    }
}

/* Slices that have been found, of which `wanted` is a series. */
void stack_series(Volume &volume, Series series, const Request &request)
{
    const size_t copies = drop_copies(series);
    sort_slices(series);
    volume.volumes = count_volumes(series);
    if (request.volume >= volume.volumes)
        refuse("there is no volume %llu; it holds %s, counted from 0",
               static_cast<unsigned long long>(request.volume),
               plural_of(volume.volumes, "volume").c_str());
    const std::shared_ptr<Stack> stack = std::make_shared<Stack>();
    std::vector<double> along;
    for (size_t i = request.volume; i < series.size(); i += volume.volumes) {
        stack->slice.push_back(series[i]);
        along.push_back(series[i].along);
    }
    place(volume, stack->slice);
    if (have_places(series)) {
        const Gaps gaps = gaps_of(along);
        note_unevenness(volume, gaps, stack->slice);
        const size_t found = stack->slice.size();
        close_gaps(stack->slice, gaps, request.fills_gaps, volume);
        for (auto &row : volume.to_mm)
            row[2] *= stack->slice.size() > 1 ? static_cast<double>(found - 1) /
                                                    static_cast<double>(stack->slice.size() - 1)
                                              : 1;
    }
    if (copies)
        note(volume, plural_of(copies, "file") + (copies == 1 ? " is a copy" : " are copies") +
                         " of others, and left out");
    settle_type(volume, *stack);
    volume.format = "DICOM";
    volume.size[0] = stack->slice[0].columns;
    volume.size[1] = stack->slice[0].rows;
    volume.size[2] = stack->slice.size();
    volume.send = [&volume, stack]() { send_stack(volume, *stack); };
}

/* ---- folders ---- */

struct Files {
    std::vector<std::string> path;
    size_t links = 0;                 /* that are not followed */
    std::vector<std::string> targets; /* of links that are */
};

std::string real_path(const std::string &path)
{
    char *real = realpath(path.c_str(), nullptr);
    const std::string text = real ? real : "";
    std::free(real);
    return text;
}

void add_file(Files &files, const std::string &path, bool follows_links)
{
    struct stat status;
    if (lstat(path.c_str(), &status) != 0)
        return;
    if (S_ISLNK(status.st_mode)) {
        if (!follows_links || stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
            files.links++;
            return;
        }
        files.targets.push_back(real_path(path));
    }
    if (S_ISREG(status.st_mode))
        files.path.push_back(path);
}

/* The regular files below a folder, hidden ones left out, in the order of their names. */
void walk(Files &files, const std::string &folder, bool follows_links, size_t depth)
{
    std::vector<std::string> names;
    DIR *entries = opendir(folder.c_str());
    if (!entries)
        return;
    while (const struct dirent *entry = readdir(entries))
        if (entry->d_name[0] != '.')
            names.emplace_back(entry->d_name);
    closedir(entries);
    std::sort(names.begin(), names.end());
    for (const std::string &name : names) {
        const std::string path = folder + "/" + name;
        struct stat status;
        if (files.path.size() > files_most)
            refuse("the folder holds more than %zu files; give the one with the slices",
                   files_most);
        if (lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
            if (depth < depth_most)
                walk(files, path, follows_links, depth + 1);
        } else {
            add_file(files, path, follows_links);
        }
    }
}

/* Names as people count: slice9 before slice10. */
bool is_before(const std::string &a, const std::string &b)
{
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (std::isdigit(static_cast<unsigned char>(a[i])) &&
            std::isdigit(static_cast<unsigned char>(b[j]))) {
            const auto end = [](const std::string &s, size_t at) {
                while (at < s.size() && std::isdigit(static_cast<unsigned char>(s[at])))
                    at++;
                return at;
            };
            const auto digits = [](const std::string &s, size_t from, size_t to) {
                while (from + 1 < to && s[from] == '0')
                    from++;
                return s.substr(from, to - from);
            };
            const size_t m = end(a, i), n = end(b, j);
            const std::string p = digits(a, i, m), q = digits(b, j, n);
            if (p != q)
                return p.size() != q.size() ? p.size() < q.size() : p < q;
            i = m;
            j = n;
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            i++;
            j++;
        }
    }
    return a.size() - i < b.size() - j;
}

/* "png", "tiff" or nothing, by the first bytes. */
std::string picture_kind(const std::string &path)
{
    char bytes[4] = {0};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes, sizeof bytes);
    if (std::memcmp(bytes, "\x89PNG", 4) == 0)
        return "png";
    if (std::memcmp(bytes, "II*\0", 4) == 0 || std::memcmp(bytes, "MM\0*", 4) == 0)
        return "tiff";
    return "";
}

itk::ImageIOBase::Pointer open_picture(const std::string &kind, const std::string &path,
                                       size_t number, size_t all)
{
    const itk::ImageIOBase::Pointer io = find_kind(kind, path)->make();
    io->SetFileName(path);
    try {
        io->ReadImageInformation();
    } catch (const std::exception &) {
        refuse("slice %zu of %zu cannot be decoded", number, all);
    }
    return io;
}

void send_pictures(const Volume &volume, const std::vector<std::string> &path,
                   const std::string &kind)
{
    std::vector<char> bytes(bytes_in(volume, 1) / volume.size[2]);
    for (size_t z = 0; z < path.size(); z++) {
        const itk::ImageIOBase::Pointer io = open_picture(kind, path[z], z + 1, path.size());
        const bool is_flat = io->GetNumberOfDimensions() < 3 || io->GetDimensions(2) == 1;
        if (!is_flat || io->GetDimensions(0) != volume.size[0] ||
            io->GetDimensions(1) != volume.size[1] || io->GetNumberOfComponents() != 1 ||
            volume.type != type_of(*io))
            refuse("slice %zu of %zu is %zux%zu with %u values of %s a pixel, and the first "
                   "%llux%llu with 1 of %s; expected slices of one kind",
                   z + 1, path.size(), static_cast<size_t>(io->GetDimensions(0)),
                   static_cast<size_t>(io->GetDimensions(1)), io->GetNumberOfComponents(),
                   type_of(*io), static_cast<unsigned long long>(volume.size[0]),
                   static_cast<unsigned long long>(volume.size[1]), volume.type.c_str());
        io->SetIORegion(whole_region(*io));
        io->Read(bytes.data());
        send_piece(bytes.data(), bytes.size());
    }
}

/* Says where numbers in names leave some out: the last number of each name. */
void note_gaps(Volume &volume, const std::vector<std::string> &path)
{
    long former = -1;
    size_t gaps = 0;
    std::string first;
    for (size_t i = 0; i < path.size(); i++) {
        size_t end = path[i].find_last_of("0123456789");
        size_t begin = end;
        while (begin != std::string::npos && begin > 0 &&
               std::isdigit(static_cast<unsigned char>(path[i][begin - 1])))
            begin--;
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

void stack_pictures(Volume &volume, std::vector<std::string> path, const std::string &kind)
{
    std::sort(path.begin(), path.end(), is_before);
    const itk::ImageIOBase::Pointer io = open_picture(kind, path[0], 1, path.size());
    if (io->GetNumberOfComponents() != 1)
        refuse("slice 1 of %zu has %u values a pixel (colour); expected one", path.size(),
               io->GetNumberOfComponents());
    volume.format = kind == "png" ? "PNG slices" : "TIFF slices";
    volume.type = type_of(*io);
    volume.size[0] = io->GetDimensions(0);
    volume.size[1] = io->GetDimensions(1);
    volume.size[2] = path.size();
    note_gaps(volume, path);
    volume.send = [&volume, path, kind]() { send_pictures(volume, path, kind); };
}

void open_folder(Volume &volume, const Request &request, const Files &files)
{
    std::vector<Slice> slices;
    std::vector<std::string> png, tiff;
    size_t others = 0, without = 0;
    for (size_t i = 0; i < files.path.size(); i++) {
        const std::string &path = files.path[i];
        const size_t before = slices.size();
        if (i % 64 == 0)
            progress(i, files.path.size());
        expect_end(
            words_of("file %zu of %zu, in the order of names, is damaged; fetch it again, or "
                     "take it out of the folder",
                     i + 1, files.path.size()));
        if (scan(slices, path)) {
            without += slices.size() == before;
            continue;
        }
        const std::string kind = picture_kind(path);
        if (kind == "png")
            png.push_back(path);
        else if (kind == "tiff")
            tiff.push_back(path);
        else
            others++;
    }
    if (slices.empty() && png.empty() && tiff.empty())
        refuse("the folder holds no slices of DICOM, TIFF or PNG (%s of other kinds, %s of DICOM "
               "without pixels, %s that lead out of it)",
               plural_of(others, "file").c_str(), plural_of(without, "file").c_str(),
               plural_of(files.links, "link").c_str());
    if (!slices.empty())
        stack_series(volume, choose_series(series_of(slices), request.series), request);
    else
        stack_pictures(volume, tiff.size() >= png.size() ? tiff : png,
                       tiff.size() >= png.size() ? "tiff" : "png");
    if (slices.empty())
        others += std::min(png.size(), tiff.size());
    else
        others += png.size() + tiff.size();
    if (others + files.links)
        note(volume, plural_of(others + files.links, "file") + " of other kinds left out");
}

void open_dicom(Volume &volume, const Request &request)
{
    std::vector<Slice> slices;
    if (!scan(slices, request.path))
        refuse("its first bytes are of a DICOM file, and the rest of its header is damaged");
    if (slices.empty())
        refuse("a DICOM file without pixels (a DICOMDIR, a report or a plan); open the folder with "
               "the slices");
    stack_series(volume, choose_series(series_of(slices), request.series), request);
    if (volume.size[2] == 1)
        note(volume, "it is one slice: `open FOLDER` reads a whole series");
}

/* ---- confinement ---- */

/* MINC 1 is read by way of a MINC 2 that the library makes: a folder for it, which nobody else may
 * look into; "" where there can be none. */
std::string folder_for_minc(const Request &request)
{
    char bytes[3] = {0};
    std::ifstream(request.path, std::ios::binary).read(bytes, sizeof bytes);
    if (request.kind != "minc" || std::memcmp(bytes, "CDF", 3) != 0)
        return "";
    const char *const place = std::getenv("TMPDIR");
    std::string folder = std::string(place && *place ? place : "/tmp") + "/iftty-minc-XXXXXX";
    if (!mkdtemp(&folder[0]))
        refuse("it is MINC 1, for which there is no room in $TMPDIR; `mincconvert -2` makes MINC 2 "
               "of it");
    setenv("TMPDIR", folder.c_str(), 1);
    return folder;
}

/* From here on this process reads what it was asked for, and nothing else. */
void confine(const Request &request, const Files &files, const std::string &room)
{
    const std::set<std::string> beside = {"nrrd", "meta", "any"};
    std::vector<std::string> path = files.targets;
    std::vector<struct confine_place> places;
    path.push_back(request.path);
    if (beside.count(request.kind)) {
        const size_t slash = request.path.find_last_of('/');
        path.push_back(slash == std::string::npos ? "." : request.path.substr(0, slash + 1));
    }
    for (const std::string &name : path)
        places.push_back({name.c_str(), CONFINE_READ});
    const std::string above = room.substr(0, room.find_last_of('/'));
    if (!room.empty()) {
        places.push_back({room.c_str(), CONFINE_WRITE});
        places.push_back({above.c_str(), CONFINE_EMPTY});
    }
    const struct rlimit none = {0, 0}, few = {256, 256};
    if (room.empty())
        setrlimit(RLIMIT_FSIZE, &none);
    setrlimit(RLIMIT_NOFILE, &few);
    confine_to(places.data(), places.size());
    confine_calls();
}

Request receive_request()
{
    Request request;
    const std::string line = receive_line();
    const size_t kind = line.find(' ', 5);
    if (line.compare(0, 5, "open ") != 0 || kind == std::string::npos)
        leave(2);
    request.kind = line.substr(5, kind - 5);
    size_t at = kind + 1;
    const uint64_t flags = take_number(line, at, 3);
    request.follows_links = flags & 1;
    request.fills_gaps = flags & 2;
    request.series = take_number(line, at, number_most);
    request.volume = take_number(line, at, UINT32_MAX);
    const uint64_t data = take_number(line, at, path_most);
    const uint64_t path = take_number(line, at, path_most);
    request.data = receive_text(data);
    request.path = receive_text(path);
    return request;
}

void open(Volume &volume, const Request &request, const Files &files)
{
    if (request.kind == "folder")
        open_folder(volume, request, files);
    else if (request.kind == "dicom")
        open_dicom(volume, request);
    else if (request.kind == "hdf5")
        open_hdf5(volume, request);
    else
        open_by_itk(volume, request, request.kind);
}

/* Libraries print to standard error, which leads nowhere, and GDCM more than it needs to. */
void serve()
{
    Volume volume;
    std::string room;
    expect_end("it is damaged: its reader gave up");
    catch_signals();
    gdcm::Trace::SetWarning(false);
    gdcm::Trace::SetError(false);
    itk::Object::SetGlobalWarningDisplay(false);
    try {
        Files files;
        const Request request = receive_request();
        if (request.kind == "folder")
            walk(files, request.path, request.follows_links, 0);
        room = folder_for_minc(request);
        confine(request, files, room);
        open(volume, request, files);
        answer(volume);
    } catch (const Refusal &refusal) {
        answer_error(refusal.words);
    } catch (const std::bad_alloc &) {
        answer_error("it takes more memory than it may");
    } catch (const std::exception &) {
        answer_error("it is damaged, or of a kind that is not known here");
    }
    if (!room.empty())
        rmdir(room.c_str());
}

} // namespace

int main()
{
    prepare(memory_most);
    serve();
    leave(0);
}
