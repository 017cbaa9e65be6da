# SPDX-License-Identifier: MIT
"""Volumes in files that other people's programs write, for tests/test_volumes.sh.

    make.py FOLDER      makes them there, each with a twin, a NIfTI of nibabel's with the same
                        voxels in the same place: A.nrrd and A.twin.nii
    make.py same A B    whether two NIfTI files have the same matrix to the world, to a micrometre
"""
import io
import os
import shutil
import subprocess
import sys
import zlib

import h5py
import nibabel
import numpy
import pydicom
import pydicom.data
import pydicom.encaps
import pydicom.uid

SIZE = (26, 22, 14)  # x, y, z
# In the scanner, to the right, front and head: turned about two axes, of three spacings.
TURN = numpy.array([[0.96, -0.28, 0.0], [0.2688, 0.9216, -0.28], [0.0784, 0.2688, 0.96]])
SPACING = numpy.array([0.9, 1.1, 2.5])
PLACE = numpy.eye(4)
PLACE[:3, :3] = TURN * SPACING
PLACE[:3, 3] = [-31.5, 12.25, 40.0]
LPS = numpy.diag([-1.0, -1.0, 1.0, 1.0])
SECRETS = ["SECRETNAME", "SECRETNUMBER", "19450508", "1.2.826.0.1.3680043.99999"]


def voxels(kind=numpy.int16):
    """A ball of another value on a slope, so that no axis can be mistaken for another."""
    x, y, z = numpy.meshgrid(*[numpy.arange(n) for n in SIZE], indexing="ij")
    ball = (x - 9) ** 2 + (y - 12) ** 2 + (2 * (z - 6)) ** 2 < 40
    least = 0 if numpy.dtype(kind).kind == "u" else -90
    return (x + 3 * y + 7 * z + 400 * ball + least).astype(kind)


def save_twin(name, data, place, slope=1, intercept=0):
    image = nibabel.Nifti1Image(data, place)
    image.header.set_slope_inter(slope, intercept)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, name + ".twin.nii")


def save_plain_twin(name, data, spacing=(0, 0, 0)):
    """Of unknown orientation, and spacing where it is 0."""
    image = nibabel.Nifti1Image(data, None, dtype=data.dtype)
    image.header.set_qform(None, code=0)
    image.header.set_sform(None, code=0)
    image.header["pixdim"][:] = 0
    image.header["pixdim"][1:4] = spacing
    image.header.set_xyzt_units("mm")
    nibabel.save(image, name + ".twin.nii")


def run(*words, **options):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, **options)


def write(name, *parts):
    with open(name, "wb") as file:
        for part in parts:
            file.write(part.encode() if isinstance(part, str) else part)


def read(name):
    with open(name, "rb") as file:
        return file.read()


# ---- ANALYZE and NIfTI in pairs, by nibabel and medcon ----


def make_pairs():
    analyze = nibabel.AnalyzeImage
    for name, kind, ending, data_type in (("ni1", nibabel.Nifti1Pair, ".img", "<i2"),
                                          ("ni1-packed", nibabel.Nifti1Pair, ".img.gz", "<f4"),
                                          ("ni2", nibabel.Nifti2Pair, ".img", ">i2"),
                                          ("an-byte", analyze, ".img", "<u1"),
                                          ("an-short", analyze, ".img", ">i2"),
                                          ("an-int", analyze, ".img.gz", "<i4"),
                                          ("an-float", analyze, ".img", ">f4"),
                                          ("an-double", analyze, ".img", "<f8"),
                                          ("spm99", nibabel.Spm99AnalyzeImage, ".img", ">i2"),
                                          ("spm2", nibabel.Spm2AnalyzeImage, ".img", "<i2")):
        data = voxels(data_type)
        image = kind(data, PLACE, kind.header_class(endianness=data_type[0]))
        image.header.set_data_dtype(data_type)
        if name.startswith("spm"):  # which writes a .mat, too
            image.header["scl_slope"] = 0.25
        if name.startswith("ni"):
            image.header.set_xyzt_units("mm")
            save_twin(name, data.astype(data_type[1:]), PLACE)
        else:
            save_plain_twin(name, data.astype(data_type[1:]), SPACING)
        nibabel.save(image, name + ending)
    run("medcon", "-f", "ni1.twin.nii", "-c", "anlz", "-o", "medcon", "-noprefix")
    made = nibabel.load("medcon.img")
    save_plain_twin("medcon", numpy.asarray(made.dataobj).astype("i2"), SPACING)


def make_mgh():
    """By nibabel; uint16, and no place, by a byte of their headers changed."""
    for name, kind in (("byte.mgh", "uint8"), ("short.mgz", "int16"), ("int.mgz", "int32"),
                       ("float.mgh", "float32"), ("series.mgz", "int16")):
        data = voxels(kind)
        saved = numpy.stack([data, data + 5], 3) if name == "series.mgz" else data
        nibabel.save(nibabel.MGHImage(saved, PLACE), name)
        save_twin(name, data, nibabel.load(name).affine)
    data = voxels("int16")
    nibabel.save(nibabel.MGHImage(data, PLACE), "from.mgh")
    whole = read("from.mgh")
    for name, at, byte in (("ushort.mgh", 23, 10), ("nowhere.mgh", 29, 0), ("rgb.mgh", 23, 9)):
        write(name, whole[:at], bytes([byte]), whole[at + 1:])
    save_twin("ushort.mgh", data.view("uint16"), PLACE)
    save_plain_twin("nowhere.mgh", data)


def make_by_plastimatch():
    """GIPL; and every second voxel of mricron's head, and an oblique scene, as DICOM."""
    head = nibabel.load("/usr/share/mricron/templates/ch2.nii.gz")
    nibabel.save(head.slicer[::2, ::2, ::2], "head.nii.gz")
    for source, to, target in (("an-short.hdr", "--output-img", "a.gipl"),
                               ("head.nii.gz", "--output-dicom", "head"),
                               ("ni1.twin.nii", "--output-dicom", "oblique")):
        run("plastimatch", "convert", "--input", source, to, target, "--output-type", "short",
            stderr=subprocess.DEVNULL)
    shutil.copy("an-short.twin.nii", "a.gipl.twin.nii")


# ---- NRRD by unu, MetaImage and MRC by numpy ----


def vector(v):
    return "(" + ",".join(repr(float(n)) for n in v) + ")"


def make_nrrd():
    for name, kind, type_, encoding in (
            ("short", "int16", "short", "raw"), ("byte", "uint8", "uchar", "gzip"),
            ("float", "float32", "float", "raw"), ("char", "int8", "signed char", "raw"),
            ("int", "int32", "int", "raw"), ("uint", "uint32", "uint", "gzip"),
            ("ushort", "uint16", "ushort", "raw"), ("double", "float64", "double", "gzip")):
        data = voxels(kind)
        data.T.astype(data.dtype.newbyteorder("<")).tofile("raw")
        for space, place in (("RAS", PLACE), ("LPS", LPS @ PLACE)):
            path = "%s-%s.nrrd" % (space, name)
            run("teem-unu", "make", "-i", "raw", "-t", type_, "-s", *map(str, SIZE), "-en",
                "little", "-e", "raw", "-spc", space, "-dirs",
                " ".join(vector(v) for v in place[:3, :3].T),
                "-orig", vector(place[:3, 3]), "-o", path)
            if encoding == "gzip":
                run("teem-unu", "save", "-f", "nrrd", "-e", "gzip", "-i", path, "-o", path)
            save_twin(path, data, PLACE)
        os.remove("raw")
    data = voxels()
    data.T.astype("<i2").tofile("beside.raw")
    run("teem-unu", "make", "-h", "-i", "beside.raw", "-t", "short", "-s", *map(str, SIZE), "-en",
        "little", "-e", "raw", "-sp", *map(str, SPACING), "-o", "beside.nhdr")
    save_plain_twin("beside.nhdr", data, SPACING)


def make_meta():
    data = voxels()
    bytes_ = data.T.astype("<i2").tobytes()
    place = LPS @ PLACE
    axes = (place[:3, :3] / SPACING).T.ravel()
    packed = zlib.compress(bytes_)
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True",
             "BinaryDataByteOrderMSB = False",
             "TransformMatrix = " + " ".join(repr(float(n)) for n in axes),
             "Offset = " + " ".join(repr(float(n)) for n in place[:3, 3]),
             "ElementSpacing = " + " ".join(map(str, SPACING)), "DimSize = %d %d %d" % SIZE,
             "ElementType = MET_SHORT"]
    for name, more, body in (("whole.mha", ["ElementDataFile = LOCAL"], bytes_),
                             ("packed.mha", ["CompressedData = True",
                                             "CompressedDataSize = %d" % len(packed),
                                             "ElementDataFile = LOCAL"], packed),
                             ("apart.mhd", ["ElementDataFile = apart.raw"], b"")):
        write(name, "\n".join(lines + more), "\n", body)
        save_twin(name, data, PLACE)
    for name in ("apart.raw", "plain.raw", "../secret.raw"):
        write(name, bytes_)
    write("outside.mhd", "\n".join(lines + ["ElementDataFile = ../secret.raw"]), "\n")
    save_plain_twin("plain.raw", data)


def mrc(name, data, mode, axes=(1, 2, 3), order="<", stamp=None, cell=None, angles=(90, 90, 90),
        ispg=1, mz=None, imod=None, statistics=(0, -1, -1), extended=b"", tail=b"", map_=b"MAP "):
    """`data` by x, y, z; `axes` those of columns, rows and sections."""
    header = numpy.zeros(256, order + "i4")
    real = header.view(order + "f4")
    stored = numpy.transpose(data, [a - 1 for a in axes])
    header[0:3] = stored.shape
    header[3] = mode
    header[7:10] = data.shape[:2] + (mz or data.shape[2],)
    real[10:13] = cell if cell is not None else numpy.array(header[7:10]) * [20, 30, 50]
    real[13:16] = angles
    header[16:19] = axes
    real[19:22] = statistics
    header[22], header[23] = ispg, len(extended)
    if imod is not None:
        header[38], header[39] = 1146047817, imod
    raw = bytearray(header.tobytes())
    raw[208:212] = map_
    raw[212:214] = stamp or (b"DD" if order == "<" else b"\x11\x11")
    write(name, bytes(raw), extended,
          stored.T.astype(data.dtype.newbyteorder(order)).tobytes(), tail)


def make_mrc():
    mrc("a.mrc", voxels(), 1, cell=numpy.array(SIZE) * 400, ispg=0)  # 40 nm each
    save_plain_twin("a.mrc", voxels(), (4e-5, 4e-5, 4e-5))


def make_vtk():
    data = voxels()
    write("a.vtk", "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\n"
          "DIMENSIONS %d %d %d\nSPACING 0.9 1.1 2.5\nORIGIN 0 0 0\nPOINT_DATA %d\n"
          "SCALARS s short 1\nLOOKUP_TABLE default\n" % (*SIZE, data.size),
          data.T.astype(">i2").tobytes())
    save_plain_twin("a.vtk", data, SPACING)


# ---- pictures by oiiotool, HDF5 by h5py, MINC from nibabel's tests ----


def make_pictures():
    data = voxels(numpy.uint16)
    slices = range(1, SIZE[2] + 1)
    for z in slices:
        write("slice%d.pgm" % z, b"P5 %d %d 65535\n" % SIZE[:2],
              data[:, :, z - 1].T.astype(">u2").tobytes())
    # oiiotool takes long to start: one process converts all slices
    for to in ("png-slices", "tif-slices", "fine"):
        os.mkdir(to)
    pages = ["tif-slices/s%d.tif" % z for z in slices]
    run("oiiotool", "-d", "uint16", *[word for z in slices for word in
        ("slice%d.pgm" % z, "-o", "png-slices/s%d.png" % z, "-o", pages[z - 1],
         "--attrib", "XResolution", "254.0", "--attrib", "ResolutionUnit", "in",  # dots an inch
         "-o", "fine/s%d.tif" % z)])
    for z in slices:
        os.remove("slice%d.pgm" % z)
    run("oiiotool", *pages, "--siappendall", "-o", "stack.tif")
    for name in ("png-slices", "tif-slices", "stack.tif"):
        save_plain_twin(name, data)


def make_hdf5():
    data = voxels()
    for name, sets in (("a.h5", ["grey"]), ("two.h5", ["grey", "deep/other"])):
        with h5py.File(name, "w") as file:
            for each in sets:
                file.create_dataset(each, data=data.T, chunks=True, compression="gzip")
            file["grey"].attrs["element_size_um"] = 1000 * SPACING[::-1]
            file["flat"] = numpy.zeros((4, 5))
        save_plain_twin(name, data, SPACING)


def make_minc():
    tests = os.path.join(os.path.dirname(nibabel.__file__), "tests", "data")
    for name in ("small.mnc", "tiny.mnc", "minc2_4d.mnc"):
        shutil.copy(os.path.join(tests, name), name)
        image = nibabel.load(name)
        data = numpy.asarray(image.dataobj)
        if data.ndim == 4:
            data = data[1]  # nibabel's order of MINC: t, z, y, x
        # nibabel keeps the file's order of axes; ours is x, y, z
        save_twin(name, numpy.ascontiguousarray(data.T).astype(numpy.float32),
                  image.affine[:, [2, 1, 0, 3]])


# ---- DICOM by pydicom, on the header of a real CT ----

ct = pydicom.dcmread(pydicom.data.get_testdata_file("CT_small.dcm"))
ct.remove_private_tags()  # most of its elements
ct.save_as(CT := io.BytesIO())


def identify(one, number):
    one.SOPInstanceUID = one.file_meta.MediaStorageSOPInstanceUID = SECRETS[3] + number


def forget(one, *names):
    for name in names:
        if name in one:
            delattr(one, name)


def slices_of(data, place, step=None):
    """Data sets, z by z, of a place that runs to the right, front and head."""
    lps = LPS @ place
    length = numpy.linalg.norm(lps[:3, :3], axis=0)
    made = []
    for z in range(data.shape[2]):
        one = pydicom.dcmread(io.BytesIO(CT.getvalue()))
        one.PatientName = SECRETS[0] + "^ANNA"
        one.PatientID = SECRETS[1]
        one.PatientBirthDate = one.StudyDate = one.SeriesDate = SECRETS[2]
        one.StudyInstanceUID = SECRETS[3] + ".1"
        one.SeriesInstanceUID = SECRETS[3] + ".2"
        one.SeriesDescription = SECRETS[0] + " thorax"
        identify(one, ".3.%d" % z)
        one.InstanceNumber = data.shape[2] - z
        one.Rows, one.Columns = data.shape[1], data.shape[0]
        one.PixelSpacing = [float(length[1]), float(length[0])]
        one.ImageOrientationPatient = [float("%.10g" % n) for n in
                                       [*(lps[:3, 0] / length[0]), *(lps[:3, 1] / length[1])]]
        at = lps @ [0, 0, z if step is None else step[z], 1]
        one.ImagePositionPatient = [float("%.10g" % n) for n in at[:3]]
        one.RescaleSlope, one.RescaleIntercept = 2, -1000
        one.PixelData = data[:, :, z].T.astype("<i2").tobytes()
        forget(one, "PixelPaddingValue")
        made.append(one)
    return made


def save_series(folder, slices, order=None):
    os.mkdir(folder)
    for z in range(len(slices)) if order is None else order:
        slices[z].save_as(os.path.join(folder, "%s_IM%04d.dcm" % (SECRETS[0], (7 * z) % 997)))


def make_dicom():
    data = voxels()
    later = (data + 5).astype(numpy.int16)
    scale = 2, -1000
    few = [z for z in range(SIZE[2]) if z not in (4, 5, 9)]
    uneven = numpy.arange(SIZE[2]) + numpy.where(numpy.arange(SIZE[2]) % 2, 0.2, 0)
    tilted = PLACE.copy()
    tilted[:3, 2] += 0.7 * tilted[:3, 1]
    for name in ("ct", "mixed", "doubled", "times"):
        save_series(name, slices_of(data, PLACE))
    save_series("gaps", slices_of(data, PLACE), few)
    save_series("uneven", slices_of(data, PLACE, uneven))
    save_series("tilted", slices_of(data, tilted))
    save_twin("ct", data, PLACE, *scale)
    save_twin("doubled", data, PLACE, *scale)
    save_twin("tilted", data, tilted, *scale)
    save_twin("times", later, PLACE, *scale)
    blank = data.copy()
    blank[:, :, [4, 5, 9]] = -12  # what is -1024 here
    save_twin("gaps", blank, PLACE, *scale)
    for tool, options in (("dcmcrle", []), ("dcmcjpeg", ["+e1"]), ("dcmcjpls", [])):
        packed = "ct-" + tool
        os.mkdir(packed)
        for name in os.listdir("ct"):
            run(tool, *options, os.path.join("ct", name), os.path.join(packed, name))
        save_twin(packed, data, PLACE, *scale)
    for z, one in enumerate(slices_of(data[:, :, :5], PLACE)):
        one.SeriesInstanceUID = SECRETS[3] + ".7"
        identify(one, ".8.%d" % z)
        one.SeriesNumber = 99
        one.Modality = "MR"
        one.save_as("mixed/other%d" % z)
    again = slices_of(data, PLACE)[3]
    shutil.copy("doubled/%s_IM0021.dcm" % SECRETS[0], "doubled/copy")
    shutil.copytree("doubled", "clash")
    identify(again, ".9")
    again.save_as("clash/again")
    for z, one in enumerate(slices_of(later, PLACE)):
        one.AcquisitionNumber = 9
        identify(one, ".5.%d" % z)
        one.save_as("times/later%d" % z)
    scaled = slices_of(data, PLACE)
    real = numpy.zeros(SIZE, numpy.float32)
    for z, one in enumerate(scaled):
        one.Modality = "PT"
        one.RescaleSlope, one.RescaleIntercept = 0.5 + z, 0
        real[:, :, z] = data[:, :, z] * (0.5 + z)
    save_series("pet", scaled)
    save_twin("pet", real, PLACE)


# ---- single files of DICOM, of pydicom's own tests ----


def dicom(name):
    return pydicom.dcmread(pydicom.data.get_testdata_file(name))


def save_dicom_twin(path, one):
    """By pydicom: voxels, their scale and their place. Of a dose, the place of the first frame."""
    data = numpy.atleast_3d(one.pixel_array.T).astype(one.pixel_array.dtype.newbyteorder("="))
    slope = one.get("DoseGridScaling", one.get("RescaleSlope", 1))
    scale = float(slope), float(one.get("RescaleIntercept", 0))
    offsets = one.get("GridFrameOffsetVector")
    if "ImagePositionPatient" not in one:
        save_plain_twin(path, data)
        return
    axes = numpy.array(one.ImageOrientationPatient, float).reshape(2, 3)
    step = float(offsets[1]) - float(offsets[0]) if offsets else float(one.SliceThickness)
    place = numpy.eye(4)
    place[:3, 0] = axes[0] * float(one.PixelSpacing[1])
    place[:3, 1] = axes[1] * float(one.PixelSpacing[0])
    place[:3, 2] = numpy.cross(axes[0], axes[1]) * step
    place[:3, 3] = one.ImagePositionPatient
    if offsets and data.shape[2] == 1:  # which are no spacing, and all is taken for 1 mm
        place[:3, :3] /= numpy.linalg.norm(place[:3, :3], axis=0)
    save_twin(path, data, LPS @ place, *scale)


def make_dicom_files():
    os.mkdir("one")
    os.chdir("one")
    for name in ("CT_small MR_small MR_small_RLE MR_small_bigendian MR_small_expb "
                 "MR_small_implicit MR_small_padded rtdose rtdose_expb rtdose_rle rtdose_1frame "
                 "rtdose_expb_1frame rtdose_rle_1frame image_dfl MR_small_jp2klossless "
                 "MR_small_jpeg_ls_lossless").split():
        shutil.copy(pydicom.data.get_testdata_file(name + ".dcm"), name + ".dcm")
        same = "MR_small" if name.endswith("lossless") else name
        save_dicom_twin(name + ".dcm", dicom(same + ".dcm"))
    for name in "MR_truncated SC_rgb_rle badVR".split():
        shutil.copy(pydicom.data.get_testdata_file(name + ".dcm"), ".")
    one = dicom("liver_1frame.dcm")  # a segmentation, as an image
    one.SOPClassUID = one.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.4.1"
    one.save_as("bits.dcm")
    one = dicom("MR_small.dcm")
    one.add_new(0x7fe00008, "OF", bytes(4 * one.Rows * one.Columns))
    del one.PixelData
    one.BitsAllocated = 32
    one.save_as("float.dcm")
    # A preamble that is the beginning of a TIFF, or of a NIfTI, for programs that know these.
    for name, begin in (("tiff", b"II*\0\x08\0\0\0"), ("nifti", (348).to_bytes(4, "little"))):
        one = dicom("rtdose.dcm")
        one.preamble = begin.ljust(128, b"\0")
        one.save_as(name + ".dcm")
        save_dicom_twin(name + ".dcm", one)
    # Of 8 bits in words of 16, both orders; 12 of 16 bits, signed, with others above them.
    one = dicom("MR_small_expb.dcm")
    bytes_ = numpy.arange(64 * 64, dtype="u1").reshape(64, 64)
    one.BitsAllocated = one.BitsStored = 8
    one.HighBit, one.PixelRepresentation = 7, 0
    one.PixelData = bytes_.reshape(-1, 2)[:, ::-1].tobytes()
    one["PixelData"].VR = "OW"
    one.save_as("words.dcm")
    plain = dicom("MR_small.dcm")
    save_twin_of("words.dcm", plain, bytes_)
    twelve = (numpy.arange(64 * 64) - 2048).astype("i2").reshape(64, 64)
    one = dicom("MR_small.dcm")
    one.BitsStored, one.HighBit = 12, 11
    one.PixelData = ((twelve & 0xfff) | 0x5000).astype("<i2").tobytes()
    one.save_as("twelve.dcm")
    save_twin_of("twelve.dcm", plain, twelve)
    one.HighBit = 15
    one.save_as("left.dcm")
    one = dicom("MR_small.dcm")
    del one.PixelSpacing
    one.save_as("unspaced.dcm")
    # Offsets of a dose that are places, the other way round, uneven and too few.
    one = dicom("rtdose.dcm")
    for name, offsets in (("absolute", [-761.87 + 5 * z for z in range(15)]),
                          ("downwards", [-5 * z for z in range(15)]),
                          ("uneven", [5 * z + z % 2 for z in range(15)]),
                          ("few", [5 * z for z in range(14)]),
                          ("many", [5 * z for z in range(16)])):
        one.GridFrameOffsetVector = offsets
        one.save_as("dose-%s.dcm" % name)
    del one.DoseGridScaling
    one.save_as("unscaled.dcm")
    shutil.copy("rtdose.dcm.twin.nii", "dose-absolute.dcm.twin.nii")
    down = nibabel.load("rtdose.dcm.twin.nii")
    place = down.affine @ numpy.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -14], [0, 0, 0, 1.0]])
    data = one.pixel_array.T[:, :, ::-1].astype("u4")
    save_twin("dose-downwards.dcm", data, place, 1e-6, 0)
    make_cut()


def save_twin_of(path, one, data):
    plain = pydicom.dataset.Dataset(one)
    plain.file_meta = one.file_meta
    plain.is_little_endian, plain.is_implicit_VR = True, False
    save_dicom_twin(path, plain)
    place = nibabel.load(path + ".twin.nii").affine
    save_twin(path, data.T[:, :, None], place)


def make_cut():
    """Pixels of which some are missing, in every way that a file can say how many there are."""
    for name, source, bytes_ in (("plain", "rtdose", 1000), ("big", "MR_small_expb", 3000),
                                 ("deflated", "image_dfl", 3000), ("jpeg", "JPEG-lossy", 300),
                                 ("jpeg-ls", "MR_small_jpeg_ls_lossless", 300),
                                 ("jpeg-2000", "MR_small_jp2klossless", 300),
                                 ("rle", "rtdose_rle", 500)):
        data = read(pydicom.data.get_testdata_file(source + ".dcm"))
        write("cut-%s.dcm" % name, data[:-bytes_])
    for name, source in (("jpeg", "JPEG-lossy"), ("jpeg-ls", "MR_small_jpeg_ls_lossless")):
        one = dicom(source + ".dcm")
        frame = pydicom.encaps.defragment_data(one.PixelData)
        for kind, frames in (("few", [frame, frame]), ("short", [frame, frame, frame[:-300]]),
                             ("whole", [frame, frame, frame])):
            one.PixelData = pydicom.encaps.encapsulate(frames, 2 if name == "jpeg" else 1)
            one.NumberOfFrames = 3
            one.save_as("%s-%s.dcm" % (kind, name))
    one = dicom("rtdose_rle.dcm")
    frames = list(pydicom.encaps.generate_pixel_data_frame(one.PixelData, 15))
    one.PixelData = pydicom.encaps.encapsulate(frames[:14])
    one.save_as("few-rle.dcm")
    data = read(pydicom.data.get_testdata_file("image_dfl.dcm"))
    bomb = zlib.compressobj(9, zlib.DEFLATED, -15)
    write("bomb.dcm", data[:144 + int.from_bytes(data[140:144], "little")],
          *(bomb.compress(bytes(1 << 20)) for _ in range(257)), bomb.flush())
    slices = slices_of(voxels(), PLACE)
    for z in (3, 8):
        slices[z].PixelData = slices[z].PixelData[:700]
    save_series("cut-slice", slices)


def same(pairs):
    """Each line has a name and two volumes, which must have one place in the world."""
    wrong = False
    for line in open(pairs, encoding="utf-8"):
        name, a, b = line.rstrip("\n").split("\t")
        p, q = nibabel.load(a).affine, nibabel.load(b).affine
        if numpy.abs(p - q).max() > 1e-3:
            print("%s:\n%s\nis not\n%s" % (name, p, q))
            wrong = True
    sys.exit(wrong)


def main():
    if sys.argv[1] == "same":
        same(sys.argv[2])
        return
    os.chdir(sys.argv[1])
    for make in (make_pairs, make_mgh, make_by_plastimatch, make_nrrd, make_meta, make_mrc,
                 make_vtk, make_pictures, make_hdf5, make_minc, make_dicom, make_dicom_files):
        make()


if __name__ == "__main__":
    main()
