/* SPDX-License-Identifier: MIT */
/*
 * Check that a file is as long as its header promises, before a library fills the rest with zeros.
 *
 * Formats whose parts have offsets (TIFF, PNG, HDF5, netCDF, which MINC 1 uses) are checked part by
 * part. In other formats the voxels are one run of bytes, in the file or in another one. Bytes
 * after the promised ones are ignored.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cerrno>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

/* ---- a file of known length ---- */

uint64_t sum_of(uint64_t a, uint64_t b)
{
    return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

uint64_t product_of(uint64_t a, uint64_t b)
{
    uint64_t product;
    return __builtin_mul_overflow(a, b, &product) ? UINT64_MAX : product;
}

uint64_t number_in(const char *bytes, unsigned width, bool is_big)
{
    uint64_t number = 0;
    for (unsigned i = 0; i < width; i++)
        number |= uint64_t{static_cast<uint8_t>(bytes[i])} << 8 * (is_big ? width - 1 - i : i);
    return number;
}

/* A file that refuses reads beyond its end. */
class Counted
{
  public:
    Counted(const std::string &path, std::string what) : what_(std::move(what))
    {
        struct stat status;
        fd_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        if (fd_ < 0 || fstat(fd_, &status) != 0 || !S_ISREG(status.st_mode)) {
            close();
            refuse("%sno plain file that can be read", what_.c_str());
        }
        bytes_ = static_cast<uint64_t>(status.st_size);
    }
    ~Counted()
    {
        close();
    }
    Counted(const Counted &) = delete;
    Counted &operator=(const Counted &) = delete;

    void need(uint64_t bytes) const
    {
        if (bytes > bytes_)
            refuse("%scut short: it has %llu bytes, and its header promises %llu; fetch it again",
                   what_.c_str(), wide(bytes_), wide(bytes));
    }
    uint64_t bytes() const
    {
        return bytes_;
    }
    int descriptor() const
    {
        return fd_;
    }

    /* Decode a number of `width` bytes, at most 8. */
    uint64_t number(uint64_t at, unsigned width)
    {
        char bytes[8];
        take(bytes, at, width);
        return number_in(bytes, width, is_big_endian);
    }
    std::string text(uint64_t at, unsigned length)
    {
        std::string bytes(length, '\0');
        take(&bytes[0], at, length);
        return bytes;
    }
    bool has(uint64_t at, const char *text, unsigned length)
    {
        char bytes[8];
        take(bytes, at, length);
        return std::memcmp(bytes, text, length) == 0;
    }

    bool is_big_endian = false;

  private:
    void close()
    {
        if (fd_ >= 0)
            ::close(fd_);
        fd_ = -1;
    }
    /* Read through a buffer: numbers are close together. */
    void take(char *to, uint64_t at, unsigned length)
    {
        need(sum_of(at, length));
        if (at < held_at_ || at + length > held_at_ + held_) {
            const ssize_t n = pread(fd_, piece_, sizeof piece_, static_cast<off_t>(at));
            held_at_ = at;
            held_ = n > 0 ? static_cast<uint64_t>(n) : 0;
            if (held_ < length)
                refuse("%sit cannot be read", what_.c_str());
        }
        std::memcpy(to, piece_ + (at - held_at_), length);
    }

    std::string what_;
    int fd_ = -1;
    uint64_t bytes_ = 0, held_at_ = 0, held_ = 0;
    char piece_[4096];
};

uint64_t check_bytes(const std::string &path, uint64_t bytes)
{
    const Counted file(path, "");
    file.need(bytes);
    return file.bytes() - bytes;
}

/* ---- TIFF ---- */

/* The numbers of a field of a page. */
struct Numbers {
    uint64_t count = 0, at = 0;
    unsigned width = 0;
};

/* Fields of a page by their tags. */
using PageFields = std::map<uint64_t, Numbers>;

enum PageTag : uint64_t {
    WIDTH = 256,
    HEIGHT = 257,
    BITS = 258,
    PACKING = 259,
    COLOURS = 262,
    STRIPS_AT = 273,
    SAMPLES = 277,
    STRIPS_LENGTH = 279,
    TILES_AT = 324, /* kept as STRIPS_AT */
    TILES_LENGTH = 325
};

/* First number of a field. */
uint64_t first_of(Counted &file, const PageFields &field, PageTag tag, uint64_t usual)
{
    const auto numbers = field.find(tag);
    return numbers != field.end() && numbers->second.count
               ? file.number(numbers->second.at, numbers->second.width)
               : usual;
}

/* Check the extent of the strips or tiles of a page. If an unpacked page has too few bytes in its
 * strips, libtiff reads beyond them; it also does if their lengths are 0, as old writers have them.
 */
void count_page(Counted &file, PageFields &field, uint64_t &counted)
{
    constexpr uint64_t none = 1, subsampled = 6;
    const Numbers place = field[STRIPS_AT], length = field[STRIPS_LENGTH];
    const uint64_t count = std::min(place.count, length.count);
    counted = sum_of(counted, count);
    if (counted > file.bytes())
        refuse("its pages have more fields and parts than it has bytes");
    std::vector<uint64_t> begin(count);
    for (uint64_t i = 0; i < count; i++)
        begin[i] = file.number(place.at + i * place.width, place.width);
    uint64_t has = 0;
    bool is_said = count > 0;
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t bytes = file.number(length.at + i * length.width, length.width);
        file.need(sum_of(begin[i], bytes));
        has = sum_of(has, bytes);
        is_said = is_said && bytes > 0;
    }
    uint64_t bits = product_of(first_of(file, field, BITS, 1), first_of(file, field, SAMPLES, 1));
    bits = product_of(bits, first_of(file, field, WIDTH, 0));
    bits = product_of(bits, first_of(file, field, HEIGHT, 0));
    if (is_said && has < bits / 8 && first_of(file, field, PACKING, none) == none &&
        first_of(file, field, COLOURS, none) != subsampled)
        refuse("cut short or false: a page has %llu bytes of pixels, and its size promises %llu",
               wide(has), wide(bits / 8));
}

void count_tiff(Counted &file)
{
    static const unsigned type_bytes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    file.is_big_endian = file.has(0, "MM", 2);
    const bool is_big = file.number(2, 2) == 43;
    const unsigned wide_bytes = is_big ? 8 : 4, head = is_big ? 8 : 2, entry = is_big ? 20 : 12;
    std::set<uint64_t> seen;
    uint64_t counted = 0;
    for (uint64_t page = file.number(is_big ? 8 : 4, wide_bytes); page != 0;) {
        if (!seen.insert(page).second)
            refuse("its pages lead back to one another");
        const uint64_t entries = file.number(page, head);
        const uint64_t end = sum_of(sum_of(page, head), product_of(entries, entry));
        PageFields field;
        std::set<uint64_t> met; /* libtiff reads the first entry of each tag */
        counted = sum_of(counted, entries);
        file.need(sum_of(end, wide_bytes));
        for (uint64_t at = page + head; at < end; at += entry) {
            const uint64_t tag = file.number(at, 2), type = file.number(at + 2, 2);
            Numbers numbers;
            numbers.count = file.number(at + 4, wide_bytes);
            numbers.width = type < sizeof type_bytes / sizeof *type_bytes ? type_bytes[type] : 0;
            const bool is_here = product_of(numbers.count, numbers.width) <= wide_bytes;
            const bool is_first = met.insert(tag).second;
            numbers.at = at + 4 + wide_bytes;
            if (numbers.width == 0 || numbers.width > 8)
                continue;
            if (!is_here)
                numbers.at = file.number(numbers.at, wide_bytes);
            file.need(sum_of(numbers.at, product_of(numbers.count, numbers.width)));
            /* libtiff reads the later entry of strips and tiles, not the one of the page's kind. */
            if (is_first)
                field[tag == TILES_AT       ? STRIPS_AT
                      : tag == TILES_LENGTH ? STRIPS_LENGTH
                                            : tag] = numbers;
        }
        count_page(file, field, counted);
        page = file.number(end, wide_bytes);
    }
}

/* ---- PNG ---- */

void count_png(Counted &file)
{
    file.is_big_endian = true;
    for (uint64_t at = 8, next;; at = next) {
        next = at + 12 + file.number(at, 4);
        file.need(next);
        if (file.has(at + 4, "IEND", 4))
            return;
    }
}

/* The chunk pHYs: pixels per metre along x and y if the last byte is 1. */
bool png_resolution(const std::string &path, double mm[2])
{
    Counted file(path, "");
    file.is_big_endian = true;
    for (uint64_t at = 8; !file.has(at + 4, "IDAT", 4) && !file.has(at + 4, "IEND", 4);
         at = sum_of(at, 12 + file.number(at, 4)))
        if (file.has(at + 4, "pHYs", 4) && file.number(at, 4) == 9 &&
            file.number(at + 16, 1) == 1) {
            for (unsigned a = 0; a < 2; a++)
                mm[a] = 1e3 / static_cast<double>(file.number(at + 8 + 4 * a, 4));
            return true;
        }
    return false;
}

/* ---- GIPL ---- */

/* Refuse types that ITK 5.2 does not read. */
void check_gipl(Counted &file)
{
    static const std::map<uint64_t, const char *> kinds = {
        {1, "1 bit"},     {31, "uint32"},   {32, "int32"},   {144, "complex"},
        {160, "complex"}, {192, "complex"}, {193, "complex"}};
    file.is_big_endian = true;
    const auto kind = kinds.find(file.number(8, 2));
    if (kind != kinds.end())
        refuse("its voxels are of type %llu (%s), which is not read; expected 8 or 16 bits, or "
               "real numbers",
               wide(kind->first), kind->second);
}

/* ---- VTK ---- */

/* attributes with voxels */
static const std::set<std::string> vtk_arrays = {"scalars", "vectors", "tensors", "color_scalars"};

/* Refuse values that ITK does not read as voxels, and name them. */
void check_vtk(const std::string &path)
{
    static const std::set<std::string> grids = {"structured_grid", "unstructured_grid", "polydata",
                                                "rectilinear_grid", "field"};
    static const std::set<std::string> others = {"field", "normals", "texture_coordinates"};
    static const std::set<std::string> types = {
        "unsigned_char", "char", "unsigned_short", "short",  "unsigned_int", "int",
        "unsigned_long", "long", "float",          "double", "vtktypeint64", "vtktypeuint64"};
    std::ifstream file(path, std::ios::binary);
    std::string line;
    uint64_t points = 1;
    bool has_sides = false;
    for (int i = 0; std::getline(file, line) && i < 100000; i++) {
        const std::vector<std::string> word = words_in(in_small_letters(line.substr(0, 1000)));
        if (i < 3 || word.empty())
            continue;
        if (word[0] == "dataset" && word.size() > 1 && grids.count(word[1]))
            refuse("it is a %s of VTK, whose points are on no grid of equal steps; the filter "
                   "Resample To Image of ParaView makes STRUCTURED_POINTS of it",
                   word[1].c_str());
        if (word[0] == "cell_data")
            refuse("its values are of cells (CELL_DATA), and only those of points are read; the "
                   "filter Cell Data to Point Data of ParaView makes means of them");
        if (others.count(word[0]))
            refuse("its first values are in %s, which is not read; expected SCALARS: save the one "
                   "array as legacy VTK",
                   word[0].c_str());
        const bool is_step = word[0] == "spacing" || word[0] == "aspect_ratio";
        has_sides = has_sides || word[0] == "dimensions";
        if (!has_sides && (is_step || word[0] == "origin"))
            refuse("its DIMENSIONS come after its spacing or origin, which is not read; move that "
                   "line to the one after DATASET");
        for (size_t a = 1; word[0] == "dimensions" && a < std::min<size_t>(4, word.size()); a++)
            points = product_of(points, std::strtoull(word[a].c_str(), nullptr, 10));
        if (word[0] == "point_data" && word.size() > 1 &&
            std::strtoull(word[1].c_str(), nullptr, 10) != points)
            refuse("its DIMENSIONS are of %llu points, and its POINT_DATA of another number",
                   wide(points));
        if (!vtk_arrays.count(word[0]))
            continue;
        if (word[0] != "color_scalars" && word.size() > 2 && !types.count(word[2]))
            refuse("its voxels are of %s, which is not read; expected char to double: the filter "
                   "Calculator of ParaView makes numbers of them",
                   word[2] == "bit" ? "type bit, eight in a byte" : "another type");
        return;
    }
}

/* ---- HDF5 ---- */

/* The superblock has the end of the file. */
void count_hdf5(Counted &file)
{
    const uint64_t version = file.number(8, 1);
    const bool is_old = version < 2;
    const uint64_t width = file.number(is_old ? 13 : 9, 1);
    const uint64_t at = (is_old ? 24 + 4 * version : 12) + 2 * width;
    if (width == 2 || width == 4 || width == 8)
        file.need(file.number(at, static_cast<unsigned>(width)));
}

/* ---- netCDF (MINC 1) ---- */

void check_minc_unit(const std::string &unit)
{
    static const std::set<std::string> fine = {
        "", "mm", "millimeter", "millimeters", "millimetre", "millimetres"};
    const size_t end = unit.find_last_not_of(std::string(" \0", 2));
    if (!fine.count(end == std::string::npos ? "" : unit.substr(0, end + 1)))
        refuse("the unit of its axes is not mm, in which MINC is read: bring steps and starts to "
               "mm, and type `minc_modify_header -sinsert xspace:units=mm FILE`, and so for yspace "
               "and zspace");
}

/* Skips the lists of a header: a word, a count, and the items. */
class NetCdf
{
  public:
    explicit NetCdf(Counted &file) : file_(file)
    {
        file.is_big_endian = true;
        const uint64_t version = file.number(3, 1);
        count_ = version == 5 ? 8 : 4;
        offset_ = version == 1 ? 4 : 8;
    }
    void count()
    {
        records_ = next(count_);
        for (uint64_t n = items(); n > 0; n--) {
            take_text(next(count_));
            side_.push_back(next(count_));
        }
        pass_attributes("");
        for (uint64_t n = items(); n > 0; n--)
            pass_variable();
        if (records_ > 0 && records_ != (count_ == 8 ? UINT64_MAX : UINT32_MAX))
            file_.need(sum_of(last_record_, product_of(records_ - 1, record_)));
    }

  private:
    uint64_t next(unsigned width)
    {
        const uint64_t value = file_.number(at_, width);
        at_ += width;
        return value;
    }
    void pass(uint64_t bytes)
    {
        at_ = sum_of(at_, sum_of(bytes, 3) / 4 * 4);
        file_.need(at_);
    }
    uint64_t items()
    {
        pass(4);
        return next(count_);
    }
    /* Return up to 16 letters of a text, and skip all of it. */
    std::string take_text(uint64_t length)
    {
        const std::string text = file_.text(at_, length < 16 ? static_cast<unsigned>(length) : 16);
        pass(length);
        return text;
    }
    uint64_t type_bytes()
    {
        static const uint64_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
        const uint64_t type = next(4);
        return type < sizeof bytes / sizeof *bytes ? bytes[type] : 0;
    }
    /* `of` is the variable's name; "" for the file. */
    void pass_attributes(const std::string &of)
    {
        for (uint64_t n = items(); n > 0; n--) {
            const std::string name = take_text(next(count_));
            const uint64_t width = type_bytes();
            const std::string value = take_text(product_of(width, next(count_)));
            if (name == "units" && (of == "xspace" || of == "yspace" || of == "zspace"))
                check_minc_unit(value);
        }
    }
    /* The first side of a variable with records is 0. */
    void pass_variable()
    {
        uint64_t values = 1;
        bool has_records = false;
        const std::string name = take_text(next(count_));
        const uint64_t sides = next(count_);
        for (uint64_t i = 0; i < sides; i++) {
            const uint64_t number = next(count_);
            const uint64_t side = number < side_.size() ? side_[number] : 0;
            has_records |= i == 0 && side == 0;
            values = has_records && i == 0 ? 1 : product_of(values, side);
        }
        pass_attributes(name);
        const uint64_t bytes = product_of(values, type_bytes());
        next(count_); /* its length, which may exceed 32 bits */
        const uint64_t end = sum_of(next(offset_), bytes);
        if (!has_records) {
            file_.need(end);
            return;
        }
        last_record_ = std::max(last_record_, end);
        record_ = sum_of(record_, sum_of(bytes, 3) / 4 * 4);
    }

    Counted &file_;
    unsigned count_, offset_;
    uint64_t at_ = 4, records_ = 0, record_ = 0, last_record_ = 0;
    std::vector<uint64_t> side_;
};

void count_parts(const std::string &kind, const std::string &path, const std::string &what)
{
    Counted file(path, what);
    const bool is_minc = kind == "minc"; /* netCDF or HDF5 */
    if (kind == "png")
        count_png(file);
    else if (kind == "gipl")
        check_gipl(file);
    else if (kind == "tiff")
        count_tiff(file);
    else if (kind == "vtk")
        check_vtk(path);
    else if (is_minc && file.has(0, "CDF", 3))
        NetCdf(file).count();
    else if ((is_minc || kind == "hdf5") && file.has(0, "\x89HDF", 4))
        count_hdf5(file);
    if (kind != "nrrd" && kind != "meta")
        return;
    const Header header = header_of(kind, path);
    /* The header of a NRRD that names files may end with its file. */
    if (header.end == 0 && !(kind == "nrrd" && header.names_files()))
        refuse("%scut short: it has %llu bytes, and ends within its header; fetch it again",
               what.c_str(), wide(file.bytes()));
}

/* ---- runs of voxels ---- */

enum class Packing { NONE, TEXT, GZIP };

struct Run {
    std::string path, what;
    Packing packing = Packing::NONE;
    uint64_t at = 0;       /* offset of the first byte, */
    bool from_end = false; /* or the run ends with the file */
    uint64_t bytes = 0;    /* unpacked */
    uint64_t values = 0;   /* numbers in them */
    std::string type;      /* type of a number */
    uint64_t packed = 0;   /* packed bytes, if the header has their number */
};

/* The files that a header names have equal shares of the voxels. */
std::vector<Run> runs_in(const std::vector<std::string> &named, Run all)
{
    std::vector<Run> runs;
    all.bytes /= named.size();
    all.values /= named.size();
    for (const std::string &path : named) {
        all.path = path;
        all.what = words_of("its voxels are in %s, which is ", last_name(path).c_str());
        runs.push_back(all);
    }
    return runs;
}

/* ---- runs by headers ---- */

std::vector<Run> runs_of_meta(Run run, const std::vector<std::string> &named)
{
    const Header header = header_of("meta", run.path);
    const auto is_true = [&](const char *name, const char *usual) {
        const std::string value = header.value(name);
        return std::strchr("Tt1", value.empty() ? *usual : value[0]) != nullptr;
    };
    const long long skipped = std::atoll(header.value("headersize").c_str());
    run.at = skipped > 0 ? static_cast<uint64_t>(skipped) : 0;
    run.from_end = skipped < 0;
    const bool is_packed_beside =
        named.size() == 1 &&
        named[0] == folder_of(run.path) + header.value("elementdatafile") + ".gz";
    if (is_true("compresseddata", "False") || is_packed_beside) {
        run.packing = Packing::GZIP;
        run.packed = std::strtoull(header.value("compresseddatasize").c_str(), nullptr, 10);
    } else if (!is_true("binarydata", "True")) {
        run.packing = Packing::TEXT;
    }
    if (!named.empty())
        return runs_in(named, run);
    run.at = run.at ? run.at : header.end;
    if (run.packing == Packing::GZIP && !run.packed) /* ITK would return zeros */
        refuse("its voxels are packed, and its header lacks CompressedDataSize; write it again "
               "without packing");
    return {run};
}

std::vector<Run> runs_of_nrrd(Run run, const std::vector<std::string> &named)
{
    const Header header = header_of("nrrd", run.path);
    const std::string encoding = in_small_letters(header.value("encoding"));
    const std::string lines = header.value("line skip") + header.value("lineskip");
    const std::string skip = header.value("byte skip") + header.value("byteskip");
    const long long skipped = std::atoll(skip.c_str());
    if (encoding == "gzip" || encoding == "gz")
        run.packing = Packing::GZIP;
    else if (encoding != "raw")
        run.packing = Packing::TEXT;
    if (encoding == "bzip2" || encoding == "bz2" || encoding == "hex" || std::atoll(lines.c_str()))
        return {}; /* teem checks these itself */
    run.from_end = skipped < 0;
    if (run.packing == Packing::GZIP)
        run.bytes = sum_of(run.bytes, skipped > 0 ? static_cast<uint64_t>(skipped) : 0);
    else
        run.at = skipped > 0 ? static_cast<uint64_t>(skipped) : 0;
    if (!named.empty())
        return runs_in(named, run);
    if (header.names_files())
        refuse("its header names no file with its voxels");
    run.at = sum_of(run.at, header.end);
    return {run};
}

/* The voxels begin after the line of their attribute, or after the table that follows it. */
Run run_of_vtk(Run run)
{
    std::ifstream file(run.path, std::ios::binary);
    std::string line;
    bool is_found = false;
    for (int i = 0; std::getline(file, line) && i < 100000; i++) {
        const std::string word = in_small_letters(line.substr(0, line.find_first_of(" \t\r")));
        if (is_found && word != "lookup_table")
            break;
        run.at += line.size() + (file.eof() ? 0 : 1);
        if (is_found)
            break;
        if (i == 2 && word == "ascii")
            run.packing = Packing::TEXT;
        is_found = i > 2 && vtk_arrays.count(word);
    }
    return run;
}

std::vector<Run> runs_of(const Volume &volume, const std::string &kind, const Request &request)
{
    Run run;
    run.path = request.path;
    run.bytes = bytes_in(volume, volume.volumes);
    run.values = run.bytes / bytes_of(volume.type);
    run.type = volume.type;
    if (kind == "meta")
        return runs_of_meta(run, request.named);
    if (kind == "nrrd")
        return runs_of_nrrd(run, request.named);
    if (kind == "vtk")
        return {run_of_vtk(run)};
    if (kind != "gipl")
        return {};
    run.at = 256;
    return {run};
}

/* ---- counting ---- */

/* Test whether a word is a number of the type. */
bool is_number_of(const std::string &word, const std::string &type)
{
    char *end = nullptr;
    errno = 0;
    if (type[0] == 'f') {
        const double value = std::strtod(word.c_str(), &end);
        const bool is_in = std::isnan(value) || std::isinf(value) || type == "float64" ||
                           std::fabs(value) <= static_cast<double>(FLT_MAX);
        return *end == '\0' && is_in && !(errno == ERANGE && std::isinf(value));
    }
    const auto bits = static_cast<unsigned>(8 * bytes_of(type));
    if (type[0] == 'u') {
        const unsigned long long value = std::strtoull(word.c_str(), &end, 10);
        return *end == '\0' && errno == 0 && word[0] != '-' && value <= UINT64_MAX >> (64 - bits);
    }
    const long long value = std::strtoll(word.c_str(), &end, 10);
    const long long most = INT64_MAX >> (64 - bits);
    return *end == '\0' && errno == 0 && value <= most && value >= -most - 1;
}

/* Check the numbers of the voxels. */
void check_text(const Run &run)
{
    constexpr size_t digits_most = 400; /* a double in full has 309 before its point */
    std::ifstream file(run.path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(run.at));
    uint64_t count = 0;
    std::string word;
    for (bool goes_on = true; goes_on && count < run.values && word.size() <= digits_most;) {
        char c = ' ';
        goes_on = static_cast<bool>(file.get(c));
        if (!std::strchr(" \t\r\n\v\f,", c)) {
            word += c;
        } else if (!word.empty()) {
            if (!is_number_of(word, run.type))
                break;
            count++;
            word.clear();
        }
    }
    const bool is_cut = file.eof() && count + 1 < run.values; /* within a number */
    if (!word.empty() && count < run.values && !is_cut)
        refuse("%snumber %llu of its voxels is not of their type, %s: a real number, a word, or a "
               "number beyond that type",
               run.what.c_str(), wide(count + 1), run.type.c_str());
    if (count < run.values)
        refuse("%scut short: it has %llu numbers, and its header promises %llu; fetch it again",
               run.what.c_str(), wide(count), wide(run.values));
}

/* Count packed and text voxels, by reading all of them. */
void count_closely(const Run &run)
{
    if (run.packing == Packing::TEXT) {
        check_text(run);
        return;
    }
    bool ends;
    const Counted file(run.path, run.what);
    const uint64_t bytes = inflated_bytes(file.descriptor(), run.at,
                                          run.packed ? run.packed : UINT64_MAX, run.bytes, &ends);
    if (!ends || bytes < run.bytes)
        refuse(INFLATED_LACKS, run.what.c_str(), wide(bytes),
               bytes < run.bytes ? "" : INFLATED_CHECKSUM, wide(run.bytes));
}

void count_voxels(Volume &volume, const std::string &kind, const Request &request)
{
    std::vector<Run> closely;
    for (const Run &run : runs_of(volume, kind, request)) {
        const Counted file(run.path, run.what);
        const uint64_t end = sum_of(run.at, run.bytes);
        if (kind == "vtk" && run.packing == Packing::NONE && file.bytes() > sum_of(end, 2))
            note(volume, words_of("%llu of its bytes come after the first array, which alone is "
                                  "read",
                                  wide(file.bytes() - end)));
        const uint64_t plain =
            run.packing == Packing::NONE ? run.bytes : std::max(run.packed, uint64_t{1});
        file.need(sum_of(run.from_end ? 0 : run.at, plain));
        if (run.packing != Packing::NONE)
            closely.push_back(run);
    }
    if (closely.empty())
        return;
    volume.send = [send = volume.send, closely]() {
        for (const Run &run : closely)
            count_closely(run);
        send();
    };
}

} // namespace volume
