/* SPDX-License-Identifier: MIT */
#include "image/foreign.h"

#include <string.h>

#include "base/file.h"

#define UNPACK "; unpack it, and open what is in it"
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

bool foreign_is_picture(const char *advice)
{
    return strstr(advice, PICTURE) != NULL;
}

const char *foreign_advice(const char *path, const uint8_t *begin, size_t length, bool by_name)
{
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
