/* SPDX-License-Identifier: MIT */
/*
 * Shared by the parts of iftty-volume: requests, answers, and how reading ends.
 *
 * Text from files (names, numbers and dates of patients, and library messages that quote them)
 * never leaves the process. It sends only its own words and numbers, the names of data sets in an
 * HDF5 file and of segments, UIDs and, if a user asks for it, the patient's identity for a
 * segmentation, the names of files that a header refers to, and, if a user chooses among series
 * (Request.lists), descriptions that do not name the patient. A faulty file of a folder is named:
 * its name is the user's.
 */
#ifndef IMAGE_VOLUME_PARTS_HH
#define IMAGE_VOLUME_PARTS_HH

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gdcm
{
class DataSet;
class Tag;
class TransferSyntax;
} // namespace gdcm

namespace itk
{
class ImageIOBase;
} // namespace itk

namespace volume
{

constexpr uint64_t number_most = 1000000;

/* ---- requests and answers ---- */

struct Request {
    std::string kind, data, path;
    std::string room; /* a writable folder; "" for none */
    bool follows_links = false, fills_gaps = false;
    bool is_alone = false;          /* do not read voxels in other files, or data sets */
    bool lists = false;             /* descriptions of series may be sent, to choose by */
    bool chooses = false;           /* the user chose `volume` */
    bool refers = false;            /* send UIDs of the series, */
    bool identifies = false;        /* with its patient and study */
    uint64_t series = 0;            /* counted from 1; 0: unspecified */
    std::string wanted;             /* or a piece of its description; "": unspecified */
    std::string skip;               /* files of a folder to leave out: NAME,NAME; "": none */
    uint64_t volume = 0;            /* in a series of volumes, counted from 0 */
    std::string segments;           /* labels of DICOM SEG, "3,5-7"; "": all */
    uint64_t threshold = 0;         /* thousandths, for fractional segments; 0: none */
    uint64_t step_nm = 0;           /* distance of the scene's slices; 0: unknown */
    std::vector<std::string> named; /* paths of the files that the header names */
};

enum Known : unsigned { NOTHING = 0, SPACING = 1, ORIENTATION = 2, CLOSELY_PACKED = 4 };

/* A volume without its voxels. `send` sends size[0] * size[1] * size[2] values of the type. */
struct Volume {
    uint64_t size[3] = {1, 1, 1};
    std::string format, type;
    std::string contents; /* the chosen volume, otherwise of all; "": unknown */
    uint64_t volumes = 1;
    uint64_t series = 0; /* counted from 1; 0: not from a series */
    uint32_t frame = 0;  /* hash of its FrameOfReferenceUID; 0: none */
    unsigned known = NOTHING;
    double to_mm[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}; /* right, anterior, superior */
    double slope = 1, intercept = 0;
    std::string notes; /* lines */
    bool is_segments = false;
    uint64_t overlaps = 0;  /* voxels in several segments */
    std::string references; /* lines about the series (volume_helper.h) */
    std::string names;      /* lines about segments (image/names.h) */
    std::function<void()> send;
};

void note(Volume &volume, const std::string &line);

/* Report progress while the header is read. */
void progress(uint64_t done, uint64_t total);

/* Send lines about the error that follows, for the user alone. */
void answer_list(const std::string &lines);

/* Send some of the voxels. */
void send_piece(const void *bytes, size_t length);

/* Send the header and, if the client asks for them, the voxels of the requested volume. */
void answer(const Volume &volume, const Request &request);

size_t bytes_of(const std::string &type);                /* per number */
size_t bytes_in(const Volume &volume, uint64_t volumes); /* in this number of volumes */

/* ---- refusals ---- */

/* Thrown if a file cannot be read. The words are for the user, and contain no text of the file. */
struct Refusal {
    std::string words;
};

[[noreturn]] void refuse(const char *format, ...) __attribute__((format(printf, 1, 2)));
void refuse_for(const std::string &wrong); /* does nothing for "" */
std::string words_of(const char *format, ...) __attribute__((format(printf, 1, 2)));
std::string plural_of(size_t count, const char *noun);

/* For %llu. */
inline unsigned long long wide(uint64_t number)
{
    return number;
}

/* Make text from a file safe to print, in ASCII, at most `most` letters; the same for names. */
std::string printable(const std::string &text, size_t most);
std::string shown(const std::string &name);

std::string in_small_letters(std::string text);
/* Split at blanks. */
std::vector<std::string> words_in(const std::string &text);

/* Set the answer in case a library ends the process by a signal. */
void expect_end(const std::string &words);

/* Longest message that the client does not cut off. */
size_t words_room(const Request &request);
void catch_signals();

/* ---- numbers and slices ---- */

constexpr bool is_big_machine = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;

/* Saturate on overflow. */
uint64_t sum_of(uint64_t a, uint64_t b);
uint64_t product_of(uint64_t a, uint64_t b);

/* Decode a number of `width` bytes, at most 8. */
uint64_t number_in(const char *bytes, unsigned width, bool is_big);

/* Read a number in the byte order of this machine, at any alignment. */
template <typename Number> Number load(const void *bytes)
{
    Number number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

/* Reverse the byte order of numbers of `width` bytes. */
template <typename Byte> void reverse_each(std::vector<Byte> &bytes, size_t width)
{
    for (size_t at = 0; at + width <= bytes.size(); at += width)
        std::reverse(&bytes[at], &bytes[at] + width);
}

/* Value of a tag: its numbers; or numbers to sort by, and its text. */
using Value = std::pair<std::vector<double>, std::string>;

/* Tags that distinguish images of one place: the rows of the table in volume_tags.cc. */
enum Tagged : unsigned {
    TEMPORAL_POSITION,
    ECHO_TIME,
    ECHO_NUMBER,
    INVERSION_TIME,
    FLIP_ANGLE,
    TUBE_VOLTAGE,
    B_VALUE,
    GRADIENT,
    IMAGE_TYPE,
    COMPLEX_COMPONENT,
    TRIGGER_TIME,
    TIME_OFFSET,
    DIMENSION_INDEX,
    ACQUISITION_NUMBER,
    ACQUISITION_TIME,
    CONTENT_TIME,
    INSTANCE_NUMBER,
};

/* A Modality LUT. */
struct Lookup {
    int64_t first = 0; /* stored number of the first value, also used for lower ones */
    std::vector<uint16_t> value;
};

struct Slice {
    std::string path, series, object; /* never sent */
    std::string name;                 /* its file, relative to the folder; "" for a single file */
    std::string modality;
    std::string description;        /* printable; sent to choose by, */
    bool names_patient = false;     /* but not if it names the patient */
    std::map<unsigned, Value> tags; /* by row (volume_tags.cc) */
    std::string fault;              /* reason why it cannot be read; "" if it can */
    uint32_t reference = 0;         /* hash of its FrameOfReferenceUID; 0: none */
    unsigned frame = 0, frames = 1;
    unsigned tiles = 1, images = 0; /* in a mosaic: per side of the square, in all */
    unsigned columns = 0, rows = 0, samples = 1, bits = 16;
    bool is_signed = false, has_position = false, has_axes = false, is_inverse = false;
    double position[3] = {0, 0, 0}, axis[6] = {1, 0, 0, 0, 1, 0}; /* left, posterior, superior */
    double spacing[2] = {0, 0}; /* between rows, between columns; 0: unknown */
    double between = 0, thickness = 0;
    double slope = 1, intercept = 0;
    std::shared_ptr<const Lookup> lookup; /* instead of slope and intercept; may be null */
    double location = NAN;                /* SliceLocation; NaN: unknown */
    int series_number = 0;
    double along = 0; /* position on the normal of its plane, or SliceLocation */
    /* pixels of its file */
    uint64_t pixels_at = 0, rest = 0; /* first byte; bytes after the last frame */
    bool is_packed = false, is_big = false, is_of_bytes = false;
    unsigned stored = 0, high = 0; /* bits of a number, highest bit; 0 stored: unknown */
    std::string lack;              /* missing pixels, in our words; "" for none */
};

/* Add the slices of a file; false if it is no DICOM. A file without pixels adds none, a mosaic
 * several. */
bool scan(std::vector<Slice> &slices, const std::string &path);

/* Test whether a DICOM file claims to be an image, for example if it was cut before its pixels.
 * Otherwise `words` gets its kind, and what converts it. */
bool is_of_images(std::string &words, const std::string &path);

/* Refuse slices with missing pixels, and name the first such file. */
void check_pixels(Volume &volume, const std::vector<Slice> &slices);

/* Read the pixels of all frames of a file, in the byte order of this machine, and of a mosaic image
 * by image; false on failure. */
bool read_pixels(std::vector<char> &bytes, const Slice &slice);

void normal_of(double normal[3], const double axis[6]);

/* Find the pixels of a file, and how many are missing. `in` is at the end of its header. */
void find_pixels(Slice &slice, std::istream &in, const gdcm::TransferSyntax &syntax);

/* Open a DICOM file, a deflated one as its inflated copy; null if it is no DICOM. */
std::unique_ptr<std::istream> open_bytes(const std::string &path);

/* ---- elements of DICOM ---- */

/* Text of an element without trailing blanks, "" if there is no such element; its raw bytes. */
std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag);
std::string raw_of(const gdcm::DataSet &set, const gdcm::Tag &tag);

/* Parse up to `most` decimal numbers and return their count. If one is malformed, for example by a
 * decimal comma, return 0 and set `fault`. */
size_t decimals_of(std::string &fault, const gdcm::DataSet &set, const gdcm::Tag &tag, double *out,
                   size_t most);

/* Copy a value of exactly that length, in the byte order of this machine; false otherwise. */
bool take_bytes(void *out, size_t length, const gdcm::DataSet &set, const gdcm::Tag &tag);

/* Read a binary number of 16 or 32 bits, the size and numbers of pixels, and the place of a slice or
 * of a functional group. */
void take_binary(unsigned &out, const gdcm::DataSet &set, const gdcm::Tag &tag);
void take_pixels(Slice &slice, const gdcm::DataSet &set);
void take_place(Slice &slice, const gdcm::DataSet &set);

/* Item `number` of a sequence; empty if there is no such item. */
gdcm::DataSet item_of(const gdcm::DataSet &set, const gdcm::Tag &tag, size_t number);

/* Find the tag of a private element of an owner; group 0 if there is no such element. */
gdcm::Tag find_private(const gdcm::DataSet &set, uint16_t group, uint16_t element,
                       const char *owner);

/* Kind of an image type, for example "phase"; "" for none. */
std::string kind_of(const std::string &image_type);

/* ---- images of one place (volume_tags.cc) ---- */

/* Add the tags of a data set, or of a nested one. */
void take_tags(Slice &slice, const gdcm::DataSet &set);

/* Value of a row with one value; empty if the slice has no such tag. */
const Value &value_of(const Slice &slice, Tagged row);

/* Divide a series, sorted by place, into volumes: sort the images of each place by volume, and
 * return a label for each volume. Refuse images that no tag divides. `by_instance`: only
 * InstanceNumber divides them. */
std::vector<std::string> divide_volumes(std::vector<Slice> &series,
                                        const std::vector<size_t> &count, bool &by_instance);

/* Describe a fault of a file by its name, if it is in a folder, and how to leave it out. */
std::string about_file(const std::string &name, const std::string &what);

/* Make a description of a series safe to print between quotes. */
std::string description_of(const std::string &said);

/* Compute the matrix from voxels to the world: rows, columns, first slice to last. */
void place_series(Volume &volume, const std::vector<Slice> &slice);

/* Choose one of the series of the slices, and arrange it. */
void stack_slices(Volume &volume, const std::vector<Slice> &slices, const Request &request);

struct Files {
    std::vector<std::string> path;
    size_t links = 0;                 /* that are not followed */
    std::vector<std::string> targets; /* followed links */
};

/* List the regular files below a folder, except hidden ones, in order of their names. */
void walk(Files &files, const std::string &folder, bool follows_links, size_t depth);

/* ---- extent of files (volume_bytes.cc) ---- */

/* Check the extent of formats whose parts have offsets, before a library reads them; other formats
 * pass. `what` is the subject of a refusal: "slice 3 of 9 is ", or "" for the requested file. */
void count_parts(const std::string &kind, const std::string &path, const std::string &what);

/* Pixel size of a PNG; false if it has none. */
bool png_resolution(const std::string &path, double mm[2]);

/* Refuse a unit of an axis of MINC other than millimetres or none. */
void check_minc_unit(const std::string &unit);

/* Refuse a file with fewer bytes; return the excess. */
uint64_t check_bytes(const std::string &path, uint64_t bytes);

/* Check the extent of the other formats, once the header is known. Packed and text voxels are
 * counted when they are sent. */
void count_voxels(Volume &volume, const std::string &kind, const Request &request);

/* ---- headers in text, and the files that they name (volume_names.cc) ---- */

/* The header of a NRRD or MetaImage, in lines. */
struct Header {
    /* by names in small letters, without blanks around them */
    std::map<std::string, std::string> field;
    uint64_t end = 0; /* its length in bytes; 0 if it has no end */

    std::string value(const char *name) const; /* "" for none */
    bool has(const char *name) const
    {
        return field.count(name) > 0;
    }
    bool names_files() const /* for a NRRD */
    {
        return has("data file") || has("datafile");
    }
};

Header header_of(const std::string &kind, const std::string &path);

/* Units of a header in millimetres: of the axes of its space (rows of Volume.to_mm), or of the axes
 * of voxels (columns). */
struct Units {
    double mm[3] = {1, 1, 1};
    bool are_known = true; /* false if a word is unknown; it counts as 1 */
    bool are_of_space = false;
    const char *field = ""; /* its field */
};

/* Read units. Refuse kinds of files that ITK does not read, axes of time or lists among those of
 * space, and malformed numbers. */
Units units_of(const std::string &kind, const Header &header);
bool nrrd_has_spacings(const Header &header); /* for each axis of space */

/* Read slope and intercept from ElementToIntensityFunction. */
void scale_meta(Volume &volume, const Header &header);

/* "./" if the path has no folder; ends with a slash */
std::string folder_of(const std::string &path);
std::string last_name(const std::string &path); /* safe to print */

/* Check the name of a file that `header` refers to: it must be a regular file below the header's
 * folder. No absolute name, no "..", no link that leads out, no pipe, no device. This is checked
 * before a library gets the file, whatever the kernel confines. Return "" or the fault. */
std::string wrong_with(const std::string &header, const std::string &name);

/* Paths of the files that the header of a NRRD or MetaImage names; none if it contains the voxels.
 * Refuse names that fail the check, and lists that are too short. */
std::vector<std::string> named_files(const Request &request);

/* Check that ITK reads the same names and sizes from a MetaImage. */
void check_meta(const Request &request, const std::string &name, const std::vector<long> &sides);

/* ---- pictures as slices (volume_pictures.cc) ---- */

/* Open "png", "tiff" or "bmp" files as slices, in natural order of their names. */
void stack_pictures(Volume &volume, std::vector<std::string> path, const std::string &kind);
bool is_bmp(const std::string &path); /* by its first bytes */

/* The same for sorted TIFF files. */
void stack_tiffs(Volume &volume, const std::vector<std::string> &path);

/* Note the pixel size by the resolution, without using it. */
void note_pixels(Volume &volume, double x, double y);

const char *type_of(const itk::ImageIOBase &io);

void open_tiff(Volume &volume, const Request &request);
void open_mrc(Volume &volume, const Request &request);
void open_by_itk(Volume &volume, const Request &request, const std::string &name);
void open_hdf5(Volume &volume, const Request &request);
/* Open DICOM SEG (volume_seg.cc); false for other files. */
bool open_segments(Volume &volume, const Request &request);

/* Describe the series of these slices for a segmentation of it; frame `blank` is a missing one. */
constexpr unsigned blank = 65535;
std::string references_of(const std::vector<Slice> &slices, bool identifies);
void open_dicom(Volume &volume, const Request &request);
void open_folder(Volume &volume, const Request &request, const Files &files);

} // namespace volume

#endif
