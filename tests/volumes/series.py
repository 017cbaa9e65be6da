# SPDX-License-Identifier: MIT
"""DICOM as scanners write it, by pydicom, for tests/test_series.sh: mosaics of Siemens, folders of
several series, and of files that are damaged.

    series.py FOLDER       makes them there; each mosaic with a twin, a NIfTI of what nibabel reads
                           of it, in the order that the slices have in the patient"""
import gzip
import os
import shutil
import struct
import sys
import warnings

import nibabel
import numpy
import pydicom
import pydicom.data
import pydicom.encaps
import pydicom.uid

from make import LPS, PLACE, SECRETS, identify, read, save_twin, slices_of, voxels, write

warnings.simplefilter("ignore")
from nibabel.nicom.dicomwrappers import wrapper_from_file  # noqa: E402 (it warns)

IMAGES = 7
KINDS = {int: b"IS\0\0", str: b"SH\0\0", numpy.float64: b"FD\0\0"}
FORMS = {numpy.float64: "%.8f"}
MR = "1.2.840.10008.5.1.4.1.1.4"


# ---- mosaics ----


def csa(**elements):
    """The private header: each element with its values, and two items more that are empty."""
    out = b"SV10\4\3\2\1" + struct.pack("<2I", len(elements), 77)
    for name, values in elements.items():
        items = [FORMS.get(type(value), "%s") % value for value in values]
        items = [item.encode() + b"\0" for item in items] + [b"", b""]
        kind = KINDS[type(values[0])]
        out += struct.pack("<64si4s3i", name.encode(), len(values), kind, 6, len(items), 77)
        for item in items:
            out += struct.pack("<4i", len(item), len(item), 77, len(item))
            out += item + b"\0" * (-len(item) % 4)
    return out


def mosaic_of(data, place, images=IMAGES, is_reversed=False, has_csa=True, has_count=True,
              called="MOSAIC", left="\0\0"):
    """One file of so many of the slices. The place of the first one's corner is made that of a
    slice as large as the square."""
    side = int(numpy.ceil(numpy.sqrt(images)))
    columns, rows = data.shape[:2]
    square = numpy.frombuffer(left.encode() * (columns * rows * side * side), "<i2").copy()
    square = square.reshape(side * rows, side * columns)
    for i in range(images):
        z = data.shape[2] - 1 - i if is_reversed else i
        y, x = i // side * rows, i % side * columns
        square[y:y + rows, x:x + columns] = data[:, :, z].T
    one = slices_of(data[:, :, :1], place)[0]
    lps = LPS @ place
    length = numpy.linalg.norm(lps[:3, :3], axis=0)
    first = data.shape[2] - 1 if is_reversed else 0
    corner = lps @ [-(side - 1) * columns / 2, -(side - 1) * rows / 2, first, 1]
    one.ImagePositionPatient = [float("%.10g" % n) for n in corner[:3]]
    one.SOPClassUID = one.file_meta.MediaStorageSOPClassUID = MR
    one.Modality = "MR"
    one.ImageType = ["ORIGINAL", "PRIMARY", "M", "ND", called]
    one.Rows, one.Columns = square.shape
    one.PixelData = square.tobytes()
    one.SpacingBetweenSlices = float("%.10g" % length[2])
    one.SliceThickness = 2.25
    one.AcquisitionMatrix = [columns, 0, 0, rows]
    del one.RescaleSlope, one.RescaleIntercept
    normal = lps[:3, 2] / length[2] * (-1 if is_reversed else 1)
    if has_csa:
        one.private_block(0x0029, "SOMEBODY ELSE", create=True).add_new(0x10, "OB", b"SV10")
        count = {"NumberOfImagesInMosaic": [images]} if has_count else {}
        block = one.private_block(0x0029, "SIEMENS CSA HEADER", create=True)
        block.add_new(0x10, "OB", csa(EchoLinePosition=["12"], **count,
                                      AcquisitionMatrixText=["%d*%d" % (columns, rows)],
                                      SliceNormalVector=normal))
    return one


def in_slices(data, place, is_reversed):
    """As they follow each other along the normal of their plane."""
    if not is_reversed:
        return data, place
    last = numpy.eye(4)
    last[2, 2], last[2, 3] = -1, data.shape[2] - 1
    return data[:, :, ::-1], place @ last


def save_mosaic_twin(path, name, is_reversed=False, kind=numpy.int16):
    """By nibabel alone: rows first, to the left and the back."""
    wrapper = wrapper_from_file(path)
    rows_first = numpy.eye(4)[[1, 0, 2, 3]]
    data, place = in_slices(wrapper.get_data().transpose(1, 0, 2),
                            LPS @ wrapper.affine @ rows_first, is_reversed)
    save_twin(name, numpy.ascontiguousarray(data).astype(kind), place)


def in_folder(name, one, file="IM0"):
    os.makedirs(name, exist_ok=True)
    one.save_as(os.path.join(name, file))


def make_mosaics():
    data = voxels()[:, :, :IMAGES]
    for name, options in (("mosaic", {}), ("reversed", {"is_reversed": True}),
                          ("full", {"images": 4}), ("one", {"images": 1}),
                          ("uncalled", {"called": "NORM"})):
        images = options.get("images", IMAGES)
        in_folder(name, mosaic_of(data[:, :, :images], PLACE, **options))
        save_mosaic_twin(name + "/IM0", name, "is_reversed" in options)
    for time in range(3):
        one = mosaic_of((data + 11 * time).astype(numpy.int16), PLACE)
        one.AcquisitionNumber = one.InstanceNumber = time + 1
        identify(one, ".5.%d" % time)
        in_folder("times", one, "IM%d" % (7 * time % 5))
    save_mosaic_twin("times/IM2", "times")
    for name, options in (("bare", {"has_csa": False}), ("uncounted", {"has_count": False}),
                          ("more", {"left": "\1\0"})):
        in_folder(name, mosaic_of(data, PLACE, **options))
    more = mosaic_of(data, PLACE)
    square = more.pixel_array.copy()
    square[-3, -4] = 77
    more.PixelData = square.tobytes()
    in_folder("hidden", more)
    odd = mosaic_of(data, PLACE)
    odd.Columns, odd.Rows = 61, odd.Rows * odd.Columns // 61
    odd.PixelData = odd.PixelData[:2 * odd.Rows * odd.Columns]
    in_folder("odd", odd)
    unturned = mosaic_of(data, PLACE)
    block = unturned.private_block(0x0029, "SIEMENS CSA HEADER")
    block[0x10].value = csa(NumberOfImagesInMosaic=[IMAGES])
    in_folder("unturned", unturned)
    broken = mosaic_of(data, PLACE)
    block = broken.private_block(0x0029, "SIEMENS CSA HEADER")
    block[0x10].value = block[0x10].value[:100]
    in_folder("broken", broken)
    twice = mosaic_of(data, PLACE)
    twice.private_block(0x0019, "SIEMENS MR HEADER", create=True).add_new(0x0a, "US", IMAGES + 1)
    in_folder("contrary", twice)
    cut = mosaic_of(data, PLACE)  # one image of it, with its header
    cut.Columns, cut.Rows = 27, 21
    cut.ImageType = ["DERIVED", "PRIMARY", "M"]
    cut.PixelData = bytes(2 * 27 * 21)
    in_folder("cut", cut)
    thick = mosaic_of(data, PLACE)
    del thick.SpacingBetweenSlices
    in_folder("thick", thick)
    save_mosaic_twin("thick/IM0", "thick")
    real = os.path.join(os.path.dirname(nibabel.__file__), "nicom", "tests", "data")
    for value in (0, 1000):
        file = "IM%d" % value
        for name in ("dwi", "dwi%d" % value):
            os.makedirs(name, exist_ok=True)
            packed = read(os.path.join(real, "siemens_dwi_%d.dcm.gz" % value))
            write(os.path.join(name, file), gzip.decompress(packed))
        save_mosaic_twin(os.path.join(name, file), name, kind=numpy.uint16)


# ---- folders of several series, and with damage ----


def save_all(folder, slices, number, **words):
    """As a series of its own, whose header has these words."""
    os.makedirs(folder, exist_ok=True)
    for z, one in enumerate(slices):
        for name, value in words.items():
            setattr(one, name, value)
        one.SeriesNumber = number
        one.SeriesInstanceUID = SECRETS[3] + ".2.%d" % number
        identify(one, ".3.%d.%d" % (number, z))
        one.save_as(os.path.join(folder, "IM%d-%d" % (number, z)))


def make_series():
    data = voxels()
    few = slices_of(data[:, :, :5], PLACE)
    path = "study"
    phase, size = ["ORIGINAL", "PRIMARY", "P", "ND"], PLACE @ numpy.diag([2, 2, 1, 1])
    save_all(path, few, 1, SeriesDescription="localizer", Modality="MR")
    save_all(path, slices_of(data, PLACE), 2, SeriesDescription="t1_mprage sag", Modality="MR")
    save_twin(path, data, PLACE, 2, -1000)
    save_all(path, few, 30, SeriesDescription="gre_field", Modality="MR", EchoTime=4.92)
    save_all(path, few, 31, SeriesDescription="gre_field", Modality="MR", EchoTime=7.38)
    save_all(path, few, 32, SeriesDescription="gre_field", Modality="MR", EchoTime=7.38,
             ImageType=phase)
    save_all(path, slices_of(data[:, :, :5], size), 33, Modality="MR",
             SeriesDescription=SECRETS[0].lower() + " T1_MPRAGE")
    one = mosaic_of(data[:, :, :IMAGES], PLACE, has_csa=False)
    in_folder("study-mosaic", one)
    save_all("study-mosaic", few, 2, SeriesDescription="t2", Modality="MR")
    for number in range(30):
        save_all("many", few[:1], number + 1, Modality="MR",
                 SeriesDescription="protocol with a long name, and number %d" % (number + 1))
    for name in ("damaged", "cut-header", "cut-between", "undecodable"):
        shutil.copytree(path, name)
        file = os.path.join(name, "IM2-4")
        contents = read(file)
        at = contents.index(b"\x20\0\x37\0DS")  # the orientation
        broken = {"damaged": contents[:at + 4] + b"OB\0\0\xff\xff\xff\x7f" + contents[at + 8:],
                  "cut-header": contents[:at + 5],
                  "cut-between": contents[:at],
                  "undecodable": contents}
        write(file, broken[name])
    one = pydicom.dcmread(file)
    one.file_meta.TransferSyntaxUID = pydicom.uid.JPEGLSLossless
    one.PixelData = pydicom.encaps.encapsulate([b"\xff\xd8" + bytes(500) + b"\xff\xd9"])
    one["PixelData"].is_undefined_length = True
    one.save_as(file)


os.chdir(sys.argv[1])
for make in (make_mosaics, make_series):
    make()
