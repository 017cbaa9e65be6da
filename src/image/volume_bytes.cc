#include "image/volume_bytes.hh"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace volume
{

/* ---- a file, and how long it is ---- */

/* What a hostile header adds up to is too much, and not too little. */
uint64_t sum_of(uint64_t a, uint64_t b)
{
    return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

uint64_t product_of(uint64_t a, uint64_t b)
{
    uint64_t product;
    return __builtin_mul_overflow(a, b, &product) ? UINT64_MAX : product;
}

unsigned long long wide(uint64_t number)
{
    return number;
}

/* Reading where it does not go on, or asking for what it does not have, is a refusal. */
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

    /* A whole number of so many bytes, 8 at most. */
    uint64_t number(uint64_t at, unsigned width)
    {
        uint64_t value = 0;
        char bytes[8];
        take(bytes, at, width);
        for (unsigned i = 0; i < width; i++) {
            const auto byte = static_cast<unsigned char>(bytes[i]);
            value |= uint64_t{byte} << 8 * (is_big_endian ? width - 1 - i : i);
        }
        return value;
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
    /* By way of a piece that is held: numbers lie together. */
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

/* ---- TIFF ---- */

/* An array of numbers that a field of a page has. */
struct Numbers {
    uint64_t count = 0, at = 0;
    unsigned width = 0;
};

/* Where the strips or tiles of a page lie, and how long they are. */
void count_page(Counted &file, const Numbers &place, const Numbers &length, uint64_t &counted)
{
    const uint64_t count = std::min(place.count, length.count);
    counted = sum_of(counted, count);
    if (counted > file.bytes())
        refuse("its pages have more fields and parts than it has bytes");
    std::vector<uint64_t> begin(count);
    for (uint64_t i = 0; i < count; i++)
        begin[i] = file.number(place.at + i * place.width, place.width);
    for (uint64_t i = 0; i < count; i++)
        file.need(sum_of(begin[i], file.number(length.at + i * length.width, length.width)));
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
        Numbers place, length;
        counted = sum_of(counted, entries);
        file.need(sum_of(end, wide_bytes));
        for (uint64_t at = page + head; at < end; at += entry) {
            const uint64_t tag = file.number(at, 2), type = file.number(at + 2, 2);
            Numbers numbers;
            numbers.count = file.number(at + 4, wide_bytes);
            numbers.width = type < sizeof type_bytes / sizeof *type_bytes ? type_bytes[type] : 0;
            const bool is_here = product_of(numbers.count, numbers.width) <= wide_bytes;
            numbers.at = at + 4 + wide_bytes;
            if (numbers.width == 0 || numbers.width > 8)
                continue;
            if (!is_here)
                numbers.at = file.number(numbers.at, wide_bytes);
            file.need(sum_of(numbers.at, product_of(numbers.count, numbers.width)));
            if (tag == 273 || tag == 324)
                place = numbers;
            if (tag == 279 || tag == 325)
                length = numbers;
        }
        count_page(file, place, length, counted);
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

/* ---- HDF5 ---- */

/* Its superblock says where the file ends. */
void count_hdf5(Counted &file)
{
    const uint64_t version = file.number(8, 1);
    const bool is_old = version < 2;
    const uint64_t width = file.number(is_old ? 13 : 9, 1);
    const uint64_t at = (is_old ? 24 + 4 * version : 12) + 2 * width;
    if (width == 2 || width == 4 || width == 8)
        file.need(file.number(at, static_cast<unsigned>(width)));
}

/* ---- netCDF, which MINC 1 is ---- */

/* A list of its header is passed: a word, a count, and what each holds. */
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
            pass_name();
            side_.push_back(next(count_));
        }
        pass_attributes();
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
    void pass_name()
    {
        pass(next(count_));
    }
    uint64_t type_bytes()
    {
        static const uint64_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
        const uint64_t type = next(4);
        return type < sizeof bytes / sizeof *bytes ? bytes[type] : 0;
    }
    void pass_attributes()
    {
        for (uint64_t n = items(); n > 0; n--) {
            pass_name();
            const uint64_t width = type_bytes();
            pass(product_of(width, next(count_)));
        }
    }
    /* The first of its sides is 0 where it goes on from record to record. */
    void pass_variable()
    {
        uint64_t values = 1;
        bool has_records = false;
        pass_name();
        const uint64_t sides = next(count_);
        for (uint64_t i = 0; i < sides; i++) {
            const uint64_t number = next(count_);
            const uint64_t side = number < side_.size() ? side_[number] : 0;
            has_records |= i == 0 && side == 0;
            values = has_records && i == 0 ? 1 : product_of(values, side);
        }
        pass_attributes();
        const uint64_t bytes = product_of(values, type_bytes());
        next(count_); /* its length, which 32 bits may not hold */
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

/* ---- headers of lines ---- */

std::string trimmed(const std::string &text)
{
    const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/* Where they end: after a field, or (`last` is "") after an empty line; 0 where they do not. */
uint64_t end_of_header(const std::string &path, char between, const std::string &last)
{
    std::ifstream file(path, std::ios::binary);
    std::string line;
    uint64_t at = 0;
    while (std::getline(file, line)) {
        at += line.size() + (file.eof() ? 0 : 1);
        if (in_small_letters(trimmed(line.substr(0, line.find(between)))) == last)
            return at;
    }
    return 0;
}

bool has_whole_header(const std::string &kind, const std::string &path)
{
    if (kind == "meta")
        return end_of_header(path, '=', "elementdatafile") > 0;
    const auto fields = fields_of(path, ':', "");
    return fields.count("data file") || fields.count("datafile") ||
           end_of_header(path, ':', "") > 0;
}

void count_parts(const std::string &kind, const std::string &path, const std::string &what)
{
    static const std::set<std::string> counted = {"tiff", "lsm",  "png", "hdf5",
                                                  "minc", "nrrd", "meta"};
    if (!counted.count(kind))
        return;
    Counted file(path, what);
    if (kind == "nrrd" || kind == "meta") {
        if (!has_whole_header(kind, path))
            refuse("%scut short: it has %llu bytes, and ends within its header; fetch it again",
                   what.c_str(), wide(file.bytes()));
        return;
    }
    if (kind == "png")
        count_png(file);
    else if (kind == "tiff" || kind == "lsm")
        count_tiff(file);
    else if (file.has(0, "CDF", 3))
        NetCdf(file).count();
    else if (file.has(0, "\x89HDF", 4))
        count_hdf5(file);
}

/* ---- voxels in one run, or one for each file ---- */

enum class Packing { NONE, TEXT, GZIP };

struct Run {
    std::string path, what;
    Packing packing = Packing::NONE;
    uint64_t at = 0;       /* of its first byte, */
    bool from_end = false; /* or as many as are needed, up to the end */
    uint64_t bytes = 0;    /* of voxels, when they are unpacked */
    uint64_t values = 0;   /* the same in numbers */
    uint64_t packed = 0;   /* bytes of them in the file, where that is said */
};

std::string field(const std::map<std::string, std::string> &fields, const std::string &name)
{
    const auto found = fields.find(name);
    return found == fields.end() ? "" : trimmed(found->second);
}

std::string last_name(const std::string &path)
{
    std::string name = path.substr(path.find_last_of('/') + 1).substr(0, 60);
    for (char &c : name)
        c = c > ' ' && c < 127 ? c : '?';
    return name;
}

bool is_absolute(const std::string &name)
{
    return !name.empty() && name[0] == '/';
}

/* A file that a header names. */
Run run_beside(const Run &run, const std::string &header, const std::string &name)
{
    const size_t slash = header.find_last_of('/');
    const std::string folder = slash == std::string::npos ? "" : header.substr(0, slash + 1);
    Run made = run;
    made.path = is_absolute(name) ? name : folder + name;
    made.what = words_of("its voxels are in %s, which is ", last_name(name).c_str());
    return made;
}

/* The lines after the header, which name files. */
std::vector<std::string> listed_after(const std::string &path, uint64_t at)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<std::string> names;
    std::string line;
    file.seekg(static_cast<std::streamoff>(at));
    while (names.size() < 100000 && std::getline(file, line))
        if (!trimmed(line).empty())
            names.push_back(trimmed(line));
    return names;
}

/* "slice%03d.raw 1 14 1": the pattern with each number in place of its %03d. */
std::vector<std::string> counted_out(const std::string &pattern, uint64_t usual_last)
{
    std::istringstream words(pattern);
    std::vector<std::string> names;
    std::string name;
    long first = 1, last = static_cast<long>(std::min<uint64_t>(usual_last, 100000)), step = 1;
    words >> name;
    if (words >> first && words >> last)
        words >> step;
    const size_t at = name.find('%'), end = name.find_first_not_of("0123456789", at + 1);
    const int width = std::atoi(name.c_str() + at + 1);
    const long most = 1000000000;
    if (at == std::string::npos || end == std::string::npos || !std::strchr("diu", name[end]) ||
        width > 9 || step == 0 || std::max({first, last, step}) > most ||
        std::min({first, last, step}) < -most)
        refuse("the names of the files with its voxels make no sense");
    for (long n = first; step > 0 ? n <= last : n >= last; n += step) {
        std::string digits = std::to_string(std::labs(n));
        while (static_cast<int>(digits.size()) + (n < 0) < width)
            digits.insert(0, name[at + 1] == '0' ? "0" : " ");
        names.push_back(name.substr(0, at) + (n < 0 ? "-" : "") + digits + name.substr(end + 1));
        if (names.size() > 100000)
            refuse("it names more than 100000 files with its voxels");
    }
    return names;
}

/* The voxels are shared out evenly. */
std::vector<Run> runs_in(const std::vector<std::string> &names, const std::string &header,
                         const Run &all)
{
    std::vector<Run> runs;
    if (names.empty())
        refuse("its header names no file with its voxels");
    Run run = all;
    run.bytes /= names.size();
    run.values /= names.size();
    for (const std::string &name : names)
        runs.push_back(run_beside(run, header, name));
    return runs;
}

/* ---- where headers say that voxels are ---- */

std::vector<Run> runs_of_meta(Run run, const itk::ImageIOBase &io)
{
    const auto fields = fields_of(run.path, '=', "elementdatafile");
    const std::string data = field(fields, "elementdatafile");
    const unsigned dimensions = io.GetNumberOfDimensions();
    const uint64_t end = end_of_header(run.path, '=', "elementdatafile");
    const auto is_true = [&](const char *name, const char *usual) {
        const std::string value = field(fields, name);
        return std::strchr("Tt1", value.empty() ? *usual : value[0]) != nullptr;
    };
    const long long skipped = std::atoll(field(fields, "headersize").c_str());
    run.at = skipped > 0 ? static_cast<uint64_t>(skipped) : 0;
    run.from_end = skipped < 0;
    if (is_true("compresseddata", "False")) {
        run.packing = Packing::GZIP;
        run.packed = std::strtoull(field(fields, "compresseddatasize").c_str(), nullptr, 10);
    } else if (!is_true("binarydata", "True")) {
        run.packing = Packing::TEXT;
    }
    if (data == "LOCAL" || data == "Local" || data == "local") {
        run.at = run.at ? run.at : end;
        if (run.packing == Packing::GZIP && !run.packed) /* ITK gives zeros */
            refuse("its voxels are packed, and its header lacks CompressedDataSize; write it anew "
                   "without packing");
        return {run};
    }
    if (data.compare(0, 4, "LIST") == 0) {
        const std::string of = trimmed(data.substr(4));
        const unsigned each =
            of.empty() ? dimensions - 1 : static_cast<unsigned>(std::atoi(&of[0]));
        const std::vector<std::string> names = listed_after(run.path, end);
        uint64_t files = 1;
        for (unsigned a = each; a < dimensions; a++)
            files = product_of(files, io.GetDimensions(a));
        if (names.size() < files)
            refuse("cut short: its header names %s with voxels, and they are %llu",
                   plural_of(names.size(), "file").c_str(), wide(files));
        return runs_in({names.begin(), names.begin() + static_cast<long>(files)}, run.path, run);
    }
    if (data.find('%') != std::string::npos)
        return runs_in(counted_out(data, io.GetDimensions(dimensions - 1)), run.path, run);
    return {run_beside(run, run.path, data)};
}

std::vector<Run> runs_of_nrrd(Run run)
{
    const auto fields = fields_of(run.path, ':', "");
    const std::string encoding = in_small_letters(field(fields, "encoding"));
    const std::string data = field(fields, "data file") + field(fields, "datafile");
    const std::string lines = field(fields, "line skip") + field(fields, "lineskip");
    const std::string skip = field(fields, "byte skip") + field(fields, "byteskip");
    const uint64_t end = end_of_header(run.path, ':', "");
    const long long skipped = std::atoll(skip.c_str());
    if (encoding == "gzip" || encoding == "gz")
        run.packing = Packing::GZIP;
    else if (encoding != "raw")
        run.packing = Packing::TEXT;
    if (encoding == "bzip2" || encoding == "bz2" || encoding == "hex" || std::atoll(lines.c_str()))
        return {}; /* teem counts them itself */
    run.from_end = skipped < 0;
    if (run.packing == Packing::GZIP)
        run.bytes = sum_of(run.bytes, skipped > 0 ? static_cast<uint64_t>(skipped) : 0);
    else
        run.at = skipped > 0 ? static_cast<uint64_t>(skipped) : 0;
    if (data.empty()) {
        run.at = sum_of(run.at, end);
        return {run};
    }
    const char *last = fields.count("data file") ? "data file" : "datafile";
    if (data.compare(0, 4, "LIST") == 0)
        return runs_in(listed_after(run.path, end_of_header(run.path, ':', last)), run.path, run);
    if (data.find('%') != std::string::npos)
        return runs_in(counted_out(data, 1), run.path, run);
    return {run_beside(run, run.path, data)};
}

/* The voxels begin after the line of their attribute, or the table that may follow it. */
Run run_of_vtk(Run run)
{
    static const std::set<std::string> attributes = {"scalars", "vectors", "tensors",
                                                     "color_scalars"};
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
        is_found = i > 2 && attributes.count(word);
    }
    return run;
}

Run run_of_mrc(Run run)
{
    Counted file(run.path, "");
    file.is_big_endian = file.number(212, 1) == 0x11;
    run.at = sum_of(1024, file.number(92, 4));
    return run;
}

/* Of scanners each file is a slice; the voxels of Stimulate are beside the header. */
Run run_of_scanner(Run run, const std::string &kind, const Volume &volume)
{
    const size_t stem = run.path.size() - std::min<size_t>(run.path.size(), 4);
    if (kind != "stimulate")
        run.bytes /= volume.size[2] * volume.volumes;
    else if (run.path.compare(stem, 4, ".spr") == 0)
        return run_beside(run, run.path,
                          run.path.substr(0, stem).substr(run.path.find_last_of('/') + 1) + ".sdt");
    return run;
}

std::vector<Run> runs_of(const Volume &volume, const std::string &kind, const std::string &path,
                         const itk::ImageIOBase &io)
{
    static const std::set<std::string> scanners = {"ge4", "ge5", "geadw", "siemens", "stimulate"};
    Run run;
    run.path = path;
    run.bytes = bytes_in(volume, volume.volumes);
    run.values = run.bytes / bytes_of(volume.type);
    if (kind == "meta")
        return runs_of_meta(run, io);
    if (kind == "nrrd")
        return runs_of_nrrd(run);
    if (kind == "vtk")
        return {run_of_vtk(run)};
    if (kind == "mrc")
        return {run_of_mrc(run)};
    if (scanners.count(kind))
        return {run_of_scanner(run, kind, volume)};
    if (kind != "gipl")
        return {};
    run.at = 256;
    return {run};
}

/* ---- counting them ---- */

/* As far as they go, and one more than are needed. */
uint64_t numbers_in(std::ifstream &file, uint64_t most)
{
    uint64_t count = 0;
    bool in_number = false;
    char piece[65536];
    while (count <= most && (file.read(piece, sizeof piece), file.gcount() > 0))
        for (std::streamsize i = 0; i < file.gcount(); i++) {
            const bool is_number = std::strchr(" \t\r\n,", piece[i]) == nullptr;
            count += is_number && !in_number;
            in_number = is_number;
        }
    return count;
}

/* How many bytes come out; `ends`: up to the checksum, or so far after the last that is needed that
 * it does not matter. */
uint64_t inflated_in(std::ifstream &file, const Run &run, bool &ends)
{
    const uint64_t beyond = 65536;
    uint64_t bytes = 0, left = run.packed ? run.packed : UINT64_MAX;
    std::vector<char> in(65536), out(262144);
    z_stream stream = {};
    if (inflateInit2(&stream, 47) != Z_OK)
        throw std::bad_alloc();
    ends = false;
    while (!ends) {
        if (stream.avail_in == 0) {
            file.read(in.data(), static_cast<std::streamsize>(std::min<uint64_t>(left, in.size())));
            stream.next_in = reinterpret_cast<Bytef *>(in.data());
            stream.avail_in = static_cast<uInt>(file.gcount());
            left -= stream.avail_in;
        }
        stream.next_out = reinterpret_cast<Bytef *>(out.data());
        stream.avail_out = static_cast<uInt>(out.size());
        const int code = stream.avail_in ? inflate(&stream, Z_NO_FLUSH) : Z_BUF_ERROR;
        bytes += out.size() - stream.avail_out;
        ends = code == Z_STREAM_END || bytes > sum_of(run.bytes, beyond);
        if (code == Z_STREAM_END && bytes < run.bytes)
            ends = inflateReset(&stream) != Z_OK; /* another may follow */
        if (code != Z_OK && code != Z_STREAM_END)
            break;
    }
    inflateEnd(&stream);
    return bytes;
}

/* Packed voxels and text, which takes reading all of it. */
void count_closely(const Run &run)
{
    std::ifstream file(run.path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(run.at));
    if (run.packing == Packing::TEXT) {
        const uint64_t numbers = numbers_in(file, run.values);
        if (numbers < run.values)
            refuse("%scut short: it has %llu numbers, and its header promises %llu; fetch it again",
                   run.what.c_str(), wide(numbers), wide(run.values));
        return;
    }
    bool ends;
    const uint64_t bytes = inflated_in(file, run, ends);
    if (!ends || bytes < run.bytes)
        refuse("%scut short or damaged: of its packed voxels %llu bytes can be had%s, and its "
               "header promises %llu; fetch it again",
               run.what.c_str(), wide(bytes), bytes < run.bytes ? "" : " without their checksum",
               wide(run.bytes));
}

void count_voxels(Volume &volume, const std::string &kind, const std::string &path,
                  const itk::ImageIOBase &io)
{
    std::vector<Run> closely;
    for (const Run &run : runs_of(volume, kind, path, io)) {
        const Counted file(run.path, run.what);
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
