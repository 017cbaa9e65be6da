/* SPDX-License-Identifier: MIT */
/*
 * What the parts of iftty-volume share: what is asked, what is answered, and how reading ends.
 *
 * What files say in words (names, numbers and dates of patients, the messages of libraries, which
 * quote them) never leaves the process: what it says itself are words and numbers of its own, the
 * names of data sets in an HDF5 file, and those of files that a header names and that are not read;
 * and, where a series is to be chosen by a user who sees it (Request.lists), descriptions that do
 * not name the patient. A file of a folder is named where something is wrong with it: its name is
 * the user's.
 */
#ifndef IMAGE_VOLUME_PARTS_HH
#define IMAGE_VOLUME_PARTS_HH

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gdcm
{
class DataSet;
class Tag;
} // namespace gdcm

namespace itk
{
class ImageIOBase;
} // namespace itk

namespace volume
{

constexpr uint64_t number_most = 1000000;

/* ---- what is asked, and what is answered ---- */

struct Request {
    std::string kind, data, path;
    std::string room; /* a folder that may be written into; "" for none */
    bool follows_links = false, fills_gaps = false;
    bool is_alone = false;          /* voxels in other files, and data sets, are not read */
    bool lists = false;             /* what files say of their series may be said, to choose by */
    bool chooses = false;           /* `volume` is what the user chose */
    uint64_t series = 0;            /* counted from 1; 0: not said */
    std::string wanted;             /* or a piece of its description; "": not said */
    std::string skip;               /* files of a folder that are left out: NAME,NAME; "": none */
    uint64_t volume = 0;            /* of a series of volumes, counted from 0 */
    std::vector<std::string> named; /* the paths of the files that its header names */
};

enum Known : unsigned { NOTHING = 0, SPACING = 1, ORIENTATION = 2, CLOSELY_PACKED = 4 };

/* A volume before its voxels. `send` sends size[0] * size[1] * size[2] values of the type. */
struct Volume {
    uint64_t size[3] = {1, 1, 1};
    std::string format, type;
    std::string contents; /* of the volume that was chosen, else of all; "": not said */
    uint64_t volumes = 1;
    uint64_t series = 0; /* which one it is, counted from 1; 0: there are none */
    unsigned known = NOTHING;
    double to_mm[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}; /* right, anterior, superior */
    double slope = 1, intercept = 0;
    std::string notes; /* lines */
    std::function<void()> send;
};

void note(Volume &volume, const std::string &line);

/* While the header is made: so many of so many files. */
void progress(uint64_t done, uint64_t total);

/* Before an error: lines that it is about, for the user alone. */
void answer_list(const std::string &lines);

/* Some of the voxels. */
void send_piece(const void *bytes, size_t length);

/* The header; and, when the client asks for them, the voxels. */
void answer(const Volume &volume);

size_t bytes_of(const std::string &type);                /* of a number */
size_t bytes_in(const Volume &volume, uint64_t volumes); /* of so many volumes */

/* ---- how reading ends ---- */

/* What cannot be read; the words are for the user, and ours alone. */
struct Refusal {
    std::string words;
};

[[noreturn]] void refuse(const char *format, ...) __attribute__((format(printf, 1, 2)));
void refuse_for(const std::string &wrong); /* nothing where it is "" */
std::string words_of(const char *format, ...) __attribute__((format(printf, 1, 2)));
std::string plural_of(size_t count, const char *noun);

/* For %llu. */
inline unsigned long long wide(uint64_t number)
{
    return number;
}

/* What a file says, in ASCII that is safe to print, up to `most` letters; and the name of a file,
 * or of what is in one. */
std::string printable(const std::string &text, size_t most);
std::string shown(const std::string &name);

std::string in_small_letters(std::string text);
/* The words between blanks. */
std::vector<std::string> words_in(const std::string &text);

/* What is answered where a library ends the process by a signal from now on. */
void expect_end(const std::string &words);

/* How long words may be, so that nothing of them is cut off. */
size_t words_room(const Request &request);
void catch_signals();

/* ---- what is read ---- */

constexpr bool is_big_machine = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;

/* The number that so many bytes are, 8 at most. */
uint64_t number_in(const char *bytes, unsigned width, bool is_big);

/* A number of this machine, wherever it lies. */
template <typename Number> Number load(const void *bytes)
{
    Number number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

/* Brings numbers of so many bytes each into the other byte order. */
template <typename Byte> void reverse_each(std::vector<Byte> &bytes, size_t width)
{
    for (size_t at = 0; at + width <= bytes.size(); at += width)
        std::reverse(&bytes[at], &bytes[at] + width);
}

/* The value of a tag: its numbers; or its text, with the numbers that it is sorted by before. */
using Value = std::pair<std::vector<double>, std::string>;

/* The tags that tell images of one place apart: the rows of the table in volume_tags.cc. */
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

/* Numbers for those that a file stores, of a Modality LUT. */
struct Lookup {
    int64_t first = 0; /* the stored number of the first value; lower ones have it too */
    std::vector<uint16_t> value;
};

struct Slice {
    std::string path, series, object; /* never said */
    std::string name;                 /* of its file below the folder; "" where it is one file */
    std::string modality;
    std::string description;        /* printable; said to who chooses: */
    bool names_patient = false;     /* not even to those */
    std::map<unsigned, Value> tags; /* those that it has, by row (volume_tags.cc) */
    std::string fault;              /* why it cannot be read; "" where it can */
    unsigned frame = 0, frames = 1;
    unsigned tiles = 1, images = 0; /* of a mosaic: along a side of the square, and in all */
    unsigned columns = 0, rows = 0, samples = 1, bits = 16;
    bool is_signed = false, has_position = false, has_axes = false, is_inverse = false;
    double position[3] = {0, 0, 0}, axis[6] = {1, 0, 0, 0, 1, 0}; /* left, posterior, superior */
    double spacing[2] = {0, 0}; /* of rows, of columns; 0: not said */
    double between = 0, thickness = 0;
    double slope = 1, intercept = 0;
    std::shared_ptr<const Lookup> lookup; /* in place of these; null for none */
    double location = NAN;                /* SliceLocation; NaN: not said */
    int series_number = 0;
    double along = 0; /* its place on the normal of its plane, or its SliceLocation */
    /* of the pixels of its file */
    uint64_t pixels_at = 0, rest = 0; /* the first byte; how many come after the last frame */
    bool is_packed = false, is_big = false, is_of_bytes = false;
    unsigned stored = 0, high = 0; /* bits of a number, and its highest; 0 stored: not said */
    std::string lack;              /* what is missing, in words of ours; "" for nothing */
};

/* The slices of a file; false where it is no DICOM. One without pixels adds none. Mosaics hold
 * several. */
bool scan(std::vector<Slice> &slices, const std::string &path);

/* Whether a file of DICOM says that it is an image, as one does that was cut before its pixels; if
 * not, `words` has what it is instead, and what converts it. */
bool is_of_images(std::string &words, const std::string &path);

/* Refuses slices of which pixels are missing, by the name of the first such file. */
void check_pixels(Volume &volume, const std::vector<Slice> &slices);

/* The pixels of all frames of its file, of a mosaic image after image, in the order of this
 * machine; false where they cannot be had. */
bool read_pixels(std::vector<char> &bytes, const Slice &slice);

void normal_of(double normal[3], const double axis[6]);

/* ---- elements of DICOM ---- */

/* The text of an element without the blanks at its end; "" where there is none. Its bytes. */
std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag);
std::string raw_of(const gdcm::DataSet &set, const gdcm::Tag &tag);

/* Takes up to `most` decimal numbers; how many there were. Where one is no number, as with a decimal
 * comma, none: `fault` says so. */
size_t decimals_of(std::string &fault, const gdcm::DataSet &set, const gdcm::Tag &tag, double *out,
                   size_t most);

/* The tag of a private element of that owner; of group 0 where there is none. */
gdcm::Tag find_private(const gdcm::DataSet &set, uint16_t group, uint16_t element,
                       const char *owner);

/* "phase" and the like, by the words that DICOM has for it in an image type; "" for none. */
std::string kind_of(const std::string &image_type);

/* ---- images of one place (volume_tags.cc) ---- */

/* Adds the tags of a data set, or of one that is nested in it. */
void take_tags(Slice &slice, const gdcm::DataSet &set);

/* Of a row that has one value; empty where the slice has none. */
const Value &value_of(const Slice &slice, Tagged row);

/* Divides a series, sorted by place, of so many images at each place, into volumes: puts the images
 * of each place in the order of their volumes and returns a label for each volume. Refuses those
 * that no tag divides. `by_instance`: by InstanceNumber alone. */
std::vector<std::string> divide_volumes(std::vector<Slice> &series,
                                        const std::vector<size_t> &count, bool &by_instance);

/* What is wrong with a file, by its name where it is one of a folder, and how to go on without. */
std::string about_file(const std::string &name, const std::string &what);

/* A description of a series as it is said, between quotes. */
std::string description_of(const std::string &said);

/* Takes one of the series that the slices make, and arranges them. */
void stack_slices(Volume &volume, const std::vector<Slice> &slices, const Request &request);

struct Files {
    std::vector<std::string> path;
    size_t links = 0;                 /* that are not followed */
    std::vector<std::string> targets; /* of links that are */
};

/* The regular files below a folder, hidden ones left out, in the order of their names. */
void walk(Files &files, const std::string &folder, bool follows_links, size_t depth);

/* ---- whether a file is whole (volume_bytes.cc) ---- */

/* Of formats whose parts say where they lie, before a library reads one; nothing of others. `what`
 * begins the words of a refusal: "slice 3 of 9 is ", or "" for the file that was asked for. */
void count_parts(const std::string &kind, const std::string &path, const std::string &what);

/* The size of the pixels of a PNG, where it says it. */
bool png_resolution(const std::string &path, double mm[2]);

/* Refuses the unit of an axis of MINC, unless it is millimetres, or not said. */
void check_minc_unit(const std::string &unit);

/* Refuses a file that has fewer bytes; returns how many more it has. */
uint64_t check_bytes(const std::string &path, uint64_t bytes);

/* Of the others, once its header is known: of voxels that are packed, or written as text, when they
 * are to be sent. */
void count_voxels(Volume &volume, const std::string &kind, const Request &request);

/* ---- headers of text, and files that others name (volume_names.cc) ---- */

/* The header of a NRRD or MetaImage, which is one of lines. */
struct Header {
    /* Of names in small letters, without the blanks around them. */
    std::map<std::string, std::string> field;
    uint64_t end = 0; /* how many bytes it has; 0 where it does not end */

    std::string value(const char *name) const; /* "" for none */
    bool has(const char *name) const
    {
        return field.count(name) > 0;
    }
    bool names_files() const /* of a NRRD */
    {
        return has("data file") || has("datafile");
    }
};

Header header_of(const std::string &kind, const std::string &path);

/* Millimetres in the units of a header: of the axes of its space, which are the rows of
 * Volume.to_mm, or of the axes of voxels, which are its columns. */
struct Units {
    double mm[3] = {1, 1, 1};
    bool are_known = true; /* false where a word is none that is known; it counts as 1 */
    bool are_of_space = false;
    const char *field = ""; /* that says them */
};

/* Refuses kinds of files that ITK does not read, by name; axes of time or of lists among those of
 * space; and numbers that are none. */
Units units_of(const std::string &kind, const Header &header);
bool nrrd_has_spacings(const Header &header); /* of each axis of space */

/* Slope and intercept by ElementToIntensityFunction. */
void scale_meta(Volume &volume, const Header &header);

/* "./" where the path has none; else with its slash. */
std::string folder_of(const std::string &path);
std::string last_name(const std::string &path); /* as it is shown */

/* What a file names is read where it is a regular file below the folder of that file: no absolute
 * name, no "..", no link that leads out, no pipe and no device. Whatever the kernel confines, this
 * is looked at before a library is given the file. "" where all is well, or why it is not. */
std::string wrong_with(const std::string &header, const std::string &name);

/* The paths of the files that the header of a NRRD or MetaImage names; none where the voxels are in
 * it. Refuses those that are not sound, and lists of too few. */
std::vector<std::string> named_files(const Request &request);

/* That the library has read the same in a MetaImage. */
void check_meta(const Request &request, const std::string &name, const std::vector<long> &sides);

/* ---- slices as pictures (volume_pictures.cc) ---- */

/* "png", "tiff" or "bmp", in the order of their names as people count. */
void stack_pictures(Volume &volume, std::vector<std::string> path, const std::string &kind);
bool is_bmp(const std::string &path); /* by its first bytes */

/* Files of TIFF, which are in their order. */
void stack_tiffs(Volume &volume, const std::vector<std::string> &path);

/* The size of pixels in mm by the resolution, which is noted and not taken. */
void note_pixels(Volume &volume, double x, double y);

const char *type_of(const itk::ImageIOBase &io);

void open_tiff(Volume &volume, const Request &request);
void open_mrc(Volume &volume, const Request &request);
void open_by_itk(Volume &volume, const Request &request, const std::string &name);
void open_hdf5(Volume &volume, const Request &request);
void open_dicom(Volume &volume, const Request &request);
void open_folder(Volume &volume, const Request &request, const Files &files);

} // namespace volume

#endif
