/* SPDX-License-Identifier: MIT */
#include "image/volume.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/image_inside.h"
#include "image/reader_common.h"

#define UNPACK "; unpack it, and open the file inside"
#define BY_BIO_FORMATS                                                                             \
    ", which is not read: `bfconvert FILE A.ome.tif` (Bio-Formats) makes a TIFF of it"
#define BY_ITK                                                                                     \
    ", which is not read: ask for it as DICOM, or convert it by a program that reads it, such as " \
    "SimpleITK or `c3d FILE -o A.nii`"
#define WEB_PAGE "a web page, as a download that was refused leaves it; fetch the file again"
#define PICTURE  "; a scene is a volume, or a folder of slices as TIFF, PNG or DICOM"

const struct foreign foreign_formats[] = {
    {"", 257, 5, "ustar", "a tar archive" UNPACK},
    {"", 0, 4, "PK\3\4", "a zip archive" UNPACK},
    {"", 0, 6, "7z\xbc\xaf\x27\x1c", "a 7z archive" UNPACK},
    {"", 0, 4, "Rar!", "a rar archive" UNPACK},
    {"", 0, 6,
     "\xfd"
     "7zXZ",
     "packed by xz" UNPACK},
    {"", 0, 3, "BZh", "packed by bzip2" UNPACK},
    {"", 0, 4, "\x28\xb5\x2f\xfd", "packed by zstd" UNPACK},
    {"", 0, 3, "\xff\xd8\xff", "a JPEG picture" PICTURE},
    {"", 0, 4, "GIF8", "a GIF picture" PICTURE},
    {"", 0, 4, "\x76\x2f\x31\x01", "an OpenEXR picture" PICTURE},
    {"", 4, 4, "jP  ", "a JPEG 2000 picture" PICTURE},
    {"", 0, 4, "%PDF", "a PDF document" PICTURE},
    {".head|.brik|.brik.gz", 0, 0, NULL,
     "a data set of AFNI, which is not read: `3dAFNItoNIFTI FILE` makes a NIfTI of it"},
    {".par", 0, 0, NULL,
     "a PAR/REC of Philips, which is not read: `dcm2niix FOLDER` makes a NIfTI of it"},
    {"", 0, 7, "MATRIX7", "an ECAT volume, which is not read: `dcm2niix FILE` makes a NIfTI of it"},
    {"", 0, 6, "MATLAB", "a file of MATLAB, which is not read: `niftiwrite` there makes a NIfTI"},
    {"", 1, 5, "NUMPY",
     "an array of NumPy, which is not read: `open raw:FILE size=X,Y,Z type=T offset=128` may do"},
    {"", 0, 10, "ZISRAWFILE", "a CZI of Zeiss" BY_BIO_FORMATS},
    {"", 0, 4, "\xda\xce\xbe\x0a", "an ND2 of Nikon" BY_BIO_FORMATS},
    {"", 0, 4, "\x70\0\0\0", "an LIF of Leica" BY_BIO_FORMATS},
    {"", 0, 8, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a compound file (OIB, ZVI)" BY_BIO_FORMATS},
    {".vti|.vtp|.vtu", 0, 0, NULL,
     "an XML file of VTK, which is not read: `c3d` or ParaView makes a .vtk or NIfTI of it"},
    {"", 0, 10, "!INTERFILE",
     "the header of an Interfile, which is not read: `medcon -f FILE -c nifti` makes a NIfTI of "
     "it"},
    {".hdr", 0, 4, "ENVI",
     "the header of an ENVI, which is not read: `open raw:FILE.img size=X,Y,Z type=T` may do"},
    {".hdr|.pic", 0, 10, "#?RADIANCE", "a Radiance picture" PICTURE},
    {"", 0, 9, "<!DOCTYPE", WEB_PAGE},
    {"", 0, 9, "<!doctype", WEB_PAGE},
    {"", 0, 5, "<html", WEB_PAGE},
    {"", 0, 5, "<?xml", "an XML file; a scene is a volume, or a folder of slices"},
    {"", 0, 4, "IMGF", "an image of a GE scanner (GE 5)" BY_ITK},
    {".4x|.adw", 0, 0, NULL, "an image of a GE scanner (GE 4, ADW)" BY_ITK},
    {"2dseq", 0, 0, NULL, "an image of a Bruker scanner" BY_ITK},
    {".spr|.sdt", 0, 0, NULL, "a Stimulate volume" BY_ITK},
    {".rda", 0, 0, NULL,
     "a file of a Siemens scanner that is not read: `dcm2niix FOLDER` may make a NIfTI of it"},
    {0},
};

#define DECLARE(format, note) extern const struct volume_format format;
VOLUME_FORMATS(DECLARE)

#define POINT_AT(format, note) &format,
static const struct volume_format *const formats[] = {VOLUME_FORMATS(POINT_AT)};
enum { FORMATS = sizeof formats / sizeof formats[0], FIRST_BYTES = 1024 };

/* ---- the format ---- */

/* Before its mark, a DICOM file may hold any bytes, even those of a TIFF, for other programs. */
static bool is_dicom(const uint8_t *begin, size_t length)
{
    enum { MARK_AT = 128, MARK_BYTES = 4 };
    return length >= MARK_AT + MARK_BYTES && memcmp(begin + MARK_AT, "DICM", MARK_BYTES) == 0;
}

/* Find the format that is read, or written, under this name. */
static const struct volume_format *format_named(const char *path, bool write)
{
    for (int i = 0; i < FORMATS; i++)
        if ((write ? formats[i]->write != NULL : formats[i]->read_header != NULL) &&
            file_is_named(path, formats[i]->endings))
            return formats[i];
    return NULL;
}

const char *volume_ending(const char *path)
{
    const struct volume_format *format = format_named(path, false);
    format = format ? format : format_named(path, true);
    return format ? file_ending(path, format->endings) : NULL;
}

/* Report an error with a list of the formats that are read, or written: "NIfTI (.nii or .nii.gz),
 * ..". */
static enum err refuse_format(const char *words, bool write, enum err err, struct fault *fault)
{
    OWNED(buf_release) struct buf list = {0};
    for (int i = 0; i < FORMATS; i++) {
        const char *endings = formats[i]->endings, *between = " (";
        struct choice ending;
        if ((write ? !formats[i]->write : !formats[i]->read_header) ||
            formats[i]->takes & TAKES_LAYOUTS)
            continue;
        buf_printf(&list, "%s%s", list.length ? ", " : "", formats[i]->name);
        if (formats[i]->takes & TAKES_FOLDERS) /* its name lists many formats */
            continue;
        for (; choice_next(&ending, &endings); between = " or ")
            buf_printf(&list, "%s%.*s", between, (int)ending.length, ending.word);
        buf_add_char(&list, ')');
    }
    fault_set(fault, err, "%s%s", words, buf_text(&list));
    return err;
}

/* Find the first format that reads folders or layouts; NULL for none. */
static const struct volume_format *format_taking(unsigned what)
{
    for (int i = 0; i < FORMATS; i++)
        if (formats[i]->takes & what)
            return formats[i];
    return NULL;
}

static const struct volume_format *format_recognising(const uint8_t *begin, size_t length)
{
    if (is_dicom(begin, length))
        return format_taking(TAKES_FOLDERS);
    for (int i = 0; i < FORMATS; i++)
        if (formats[i]->recognises && formats[i]->recognises(begin, length))
            return formats[i];
    return NULL;
}

/* Find why a file is refused, "a data set of AFNI, which is not read: `3dAFNItoNIFTI FILE` makes a
 * NIfTI of it", by its name and its first bytes, inflated if they are gzip; NULL if its format is
 * unknown. The voxels of a pair may begin with any bytes. A name alone decides only if no format
 * here uses it. */
static const char *advise(const char *path, const uint8_t *begin, size_t length)
{
    const bool by_name = !format_named(path, false);
    if (file_is_named(path, PAIR_VOXELS))
        return NULL;
    for (const struct foreign *f = foreign_formats; f->advice; f++) {
        const bool is_named = !*f->endings || file_is_named(path, f->endings) ||
                              strcmp(file_name(path), f->endings) == 0;
        const bool has_bytes = f->bytes ? f->at + f->length <= length &&
                                              memcmp(begin + f->at, f->bytes, f->length) == 0
                                        : by_name;
        if (is_named && has_bytes)
            return f->advice;
    }
    return NULL;
}

enum volume_guess volume_guess(const char *path)
{
    static const char tiff[][5] = {"II*", "II+", "MM\0*", "MM\0+"};
    uint8_t begin[FIRST_BYTES];
    OWNED(source_close) struct volume_source source;
    if (source_open(&source, path, NULL, NULL) || source.is_folder)
        return GUESS_UNKNOWN;
    const size_t length = source_peek(&source, begin, sizeof begin);
    if (is_dicom(begin, length))
        return GUESS_PATIENT;
    for (size_t i = 0; length >= 4 && i < sizeof tiff / sizeof *tiff; i++)
        if (memcmp(begin, tiff[i], 4) == 0)
            return GUESS_TIFF;
    const struct volume_format *format = format_recognising(begin, length);
    const char *advice = advise(path, begin, length);
    return (format ? !(format->takes & TAKES_FOLDERS) : advice && !strstr(advice, PICTURE))
               ? GUESS_VOLUME
               : GUESS_UNKNOWN;
}

static enum err find_format(const struct volume_format **format, struct volume_source *source,
                            const struct volume_choice *choice, struct fault *fault)
{
    uint8_t begin[FIRST_BYTES];
    const size_t length = source_peek(source, begin, sizeof begin);
    *format = choice->raw.size[0] ? format_taking(TAKES_LAYOUTS)
              : source->is_folder ? format_taking(TAKES_FOLDERS)
                                  : format_recognising(begin, length);
    if (*format)
        return OK;
    *format = format_named(source->path, false);
    const char *advice = advise(source->path, begin, length);
    if (advice)
        return fault_set(fault, ERR_INPUT, "%s", advice);
    return *format ? OK : refuse_format("not a volume; expected ", false, ERR_INPUT, fault);
}

/* ---- reading ---- */

static void note_tilt(char notes[VOLUME_NOTES_BYTES], const struct geometry *geometry)
{
    const double degrees = geometry_tilt(geometry);
    if (degrees >= 1)
        volume_note(notes,
                    "its axes are oblique: up to %.2g degrees off the sides of the patient that "
                    "name them",
                    degrees);
}

enum err volume_begin(struct volume_reader *reader, const char *path,
                      const struct volume_choice *choice, struct watch *watch, struct fault *fault)
{
    struct volume_header *header = &reader->header;
    *reader = (struct volume_reader){.path = path, .header.volumes = 1};
    if (choice)
        header->choice = *choice;
    TRY(source_open(&reader->source, path, watch, fault));
    header->bytes = reader->source.bytes;
    enum err err = find_format(&reader->format, &reader->source, &header->choice, fault);
    if (!err)
        err = reader->format->read_header(header, &reader->source, fault);
    if (!err && !header->choice.straightens) /* otherwise note those of the result */
        note_tilt(header->notes, &header->geometry);
    const double degrees = err ? 0 : geometry_shear(&header->geometry);
    if (degrees >= 0.1 && !header->choice.straightens)
        volume_note(header->notes,
                    "its axes are sheared: %.2g degrees off a right angle; volumes, surfaces and "
                    "`measure` allow for it, and pictures, radii and distances do not: "
                    "straighten=yes brings them to right angles",
                    degrees);
    return fault_prefix(fault, err, "%s", path);
}

/* Apply the spacing of the user to a file without spacing. */
static enum err apply_spacing(struct volume_header *header, struct fault *fault)
{
    struct geometry *geometry = &header->geometry;
    const uint32_t *nm = header->choice.spacing_nm;
    if (!nm[0])
        return OK;
    if (!geometry->spacing_unknown)
        return fault_set(fault, ERR_USAGE,
                         "spacing: the file says that its voxels are %gx%gx%g mm apart",
                         geometry->spacing_nm[0] / 1e6, geometry->spacing_nm[1] / 1e6,
                         geometry->spacing_nm[2] / 1e6);
    memcpy(geometry->spacing_nm, nm, sizeof geometry->spacing_nm);
    geometry->spacing_unknown = false;
    if (geometry->orientation == ORIENTATION_UNKNOWN)
        geometry_place_spaced(geometry);
    for (int a = 0; a < 3; a++) {
        const double longer = nm[a] / 1e6 / geometry_step_mm(geometry, a);
        for (int w = 0; w < 3; w++)
            geometry->to_mm[w][a] *= longer;
    }
    return OK;
}

/* Check choices that exist for one format alone. */
static enum err check_words(struct volume_header *header, struct fault *fault)
{
    const struct volume_choice *choice = &header->choice;
    const struct {
        bool given;
        const char *word, *formats, *of;
    } row[] = {
        {choice->series > 0 || choice->series_name, "series=N", "DICOM",
         "series of DICOM in a folder"},
        {choice->fills_gaps, "missing=blank", "DICOM", "a series of DICOM"},
        {choice->data != NULL, "data=NAME", "HDF5", "data sets of HDF5"},
        {choice->skip != NULL, "skip=NAME", "DICOM|TIFF slices|PNG slices|BMP slices",
         "a folder of slices"},
        {choice->threshold > 0, "threshold=N", "DICOM SEG", "fractional segments of DICOM"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        if (!row[i].given || choice_find(row[i].formats, header->format) >= 0)
            continue;
        if (!choice->as_recorded)
            return fault_set(fault, ERR_USAGE, "%s is for %s, and this is %s: leave it out%s",
                             row[i].word, row[i].of, header->format,
                             header->volumes > 1 ? "; volume=N chooses one of its volumes" : "");
        volume_note(header->notes, "%s is for %s, and this is %s: left out", row[i].word, row[i].of,
                    header->format);
    }
    return OK;
}

/* Refuse unreadable voxels, and a volume that does not exist. */
static enum err check_choice(const struct volume_header *header, struct fault *fault)
{
    const char *command = header->choice.command;
    if (*header->refusal)
        return fault_set(fault, ERR_INPUT, "%s", header->refusal);
    if (header->volumes > 1 && !header->choice.has_volume)
        return fault_set(fault, ERR_INPUT,
                         "a series of %" PRIu32
                         " volumes; choose one, as in %s%s%s0%s, of 0 to %" PRIu32 "%s%s",
                         header->volumes, command ? "`" : "--volume ", command ? command : "",
                         command ? " FILE volume=" : "", command ? "`" : "", header->volumes - 1,
                         *header->contents ? "; " : "", header->contents);
    if (header->choice.volume >= header->volumes)
        return fault_set(fault, ERR_INPUT,
                         "there is no volume %" PRIu32 "; it holds %" PRIu32 ", counted from 0",
                         header->choice.volume, header->volumes);
    return OK;
}

enum err volume_choose(struct volume_reader *reader, const struct volume_choice *choice,
                       struct fault *fault)
{
    struct volume_header *header = &reader->header;
    if (choice)
        header->choice = *choice;
    enum err err = check_words(header, fault);
    if (!err)
        err = apply_spacing(header, fault);
    if (!err)
        err = check_choice(header, fault);
    if (!err)
        err = part_choose(header, fault);
    memcpy(header->made, header->size, sizeof header->made);
    if (!err && header->choice.straightens)
        err = straighten_size(header->made, header->size, &header->geometry, fault);
    return fault_prefix(fault, err, "%s", reader->path);
}

enum err volume_open(struct volume_reader *reader, const char *path,
                     const struct volume_choice *choice, struct watch *watch, struct fault *fault)
{
    TRY(volume_begin(reader, path, choice, watch, fault));
    return volume_choose(reader, NULL, fault);
}

/* Read the numbers of the file to the end of the memory of the intensities, or of more memory if
 * they are wider. The memory is bounded by the size of the file on disk, unless the user accepts
 * more. */
static enum err read_numbers(struct volume *out, struct volume_reader *reader, struct fault *fault)
{
    const struct volume_header *header = &reader->header;
    struct volume_source *source = &reader->source;
    const uint32_t *size = header->size, *whole = header->whole;
    const size_t width = voxel_bytes(header->type), count = voxels_in(header->size);
    const size_t needed = count * width, wide = count * (width > 2 ? width : 2);
    const uint64_t bytes = (uint64_t)size[0] * size[1] * size[2] * (width > 2 ? width : 2);
    if (!header->choice.huge &&
        swelling_needs_yes(bytes, (uint64_t)whole[0] * whole[1] * whole[2] * header->volumes,
                           header->bytes))
        return fault_set(fault, ERR_LIMIT,
                         "%.1f MB on disk claim %.1f GB of voxels; if that is right, unpack it "
                         "first (`gunzip`)",
                         (double)header->bytes / 1e6, (double)bytes / 1e9);
    uint64_t offset = header->offset;
    if (!source->decoder) /* which sends only the chosen volume */
        offset += header->choice.volume * voxels_in(header->whole) * width;
    TRY(reader->format->begin_voxels ? reader->format->begin_voxels(header, source, fault) : OK);
    if (wide > mem_available())
        return fault_set(fault, ERR_MEMORY, "%zu MB of voxels; this machine has %zu MB left",
                         wide >> 20, mem_available() >> 20);
    uint8_t *voxels = mem_array(wide, 1);
    if (!voxels)
        return fault_memory(fault, "the voxels");
    out->intensity = (uint16_t *)(void *)voxels;
    voxels += wide - needed;
    if (part_is_less(header))
        return part_read(voxels, header, offset, source, source->watch, fault);
    TRY(source_go_to(source, offset, "the extensions of its header", fault));
    TRY(source_read(source, voxels, needed, "the voxels", source->watch, fault));
    return source_finish(source, fault);
}

enum err volume_take(struct volume *out, struct volume_reader *reader, struct fault *fault)
{
    const struct volume_header *header = &reader->header;
    struct watch *watch = reader->source.watch;
    *out = (struct volume){.geometry = header->geometry};
    out->choice = header->choice;
    out->series = header->series;
    memcpy(out->size, header->size, sizeof out->size);
    memcpy(out->whole, header->whole, sizeof out->whole);
    memcpy(out->notes, header->notes, sizeof out->notes);
    if (header->overlaps)
        volume_note(out->notes,
                    "%" PRIu64 " voxel%s in several segments: the one with the highest number has "
                    "%s; regions=N reads one of them",
                    header->overlaps, header->overlaps == 1 ? " is" : "s are",
                    header->overlaps == 1 ? "it" : "them");
    enum err err = read_numbers(out, reader, fault);
    if (!err)
        err = quantise(out, header, watch, fault);
    if (!err)
        err = watch_fault(watch, fault);
    if (!err && voxel_bytes(header->type) > 2) {
        void *smaller = realloc(out->intensity, voxels_in(out->size) * sizeof *out->intensity);
        out->intensity = smaller ? smaller : out->intensity;
    }
    if (!err && header->choice.straightens)
        err = straighten(out, watch, fault);
    if (!err && header->choice.straightens)
        note_tilt(out->notes, &out->geometry);
    if (err)
        volume_release(out);
    return fault_prefix(fault, err, "%s", reader->path);
}

void volume_close(struct volume_reader *reader)
{
    source_close(&reader->source);
}

enum err volume_read(struct volume *out, const char *path, const struct volume_choice *choice,
                     struct watch *watch, struct fault *fault)
{
    OWNED(volume_close) struct volume_reader reader;
    *out = (struct volume){0};
    TRY(volume_open(&reader, path, choice, watch, fault));
    return volume_take(out, &reader, fault);
}

enum err volume_read_names(struct buf *names, const struct volume_reader *reader,
                           char notes[VOLUME_NOTES_BYTES], struct fault *fault)
{
    const size_t before = names->length;
    struct fault own = {.text = ""};
    if (!reader->format->read_names)
        return OK;
    OWNED(source_close) struct volume_source source;
    enum err err = source_open(&source, reader->path, reader->source.watch, &own);
    if (!err)
        err = reader->format->read_names(names, &reader->header, &source, &own);
    if (names->failed)
        return fault_memory(fault, "the names of labels");
    if (err == ERR_MEMORY || err == ERR_CANCELLED)
        return fault_set(fault, err, "%s", own.text);
    if (err) {
        names->length = before;
        volume_note(notes, "the names and colours of its labels are not read: %s", own.text);
    }
    return OK;
}

bool volume_holds_names(const char *path)
{
    const struct volume_format *format = format_named(path, true);
    return format && format->held_by && file_is_named(path, format->held_by);
}

/* ---- writing ---- */

enum err volume_write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault)
{
    const struct volume_format *format = format_named(path, true);
    if (format)
        return format->write(path, mode, map, watch, fault);
    return fault_prefix(fault,
                        refuse_format("expected the name of a volume, ", true, ERR_USAGE, fault),
                        "cannot write %s", path);
}
