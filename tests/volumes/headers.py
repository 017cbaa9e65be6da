# SPDX-License-Identifier: MIT
"""Volumes whose headers say units, axes, types and scales in many ways, for tests/test_headers.sh,
by hand and by h5py.

    headers.py FOLDER   makes there
        a file with NAME.twin.nii of nibabel's: the same voxels in the same place; or
        a line of FOLDER/NAME.refused or .says: FILE, a tab, words of the answer"""
import gzip
import json
import os
import sys

import h5py
import nibabel
import numpy

from make import LPS, mrc, read, save_plain_twin, save_twin, write

SIZE = (5, 4, 3)
os.chdir(sys.argv[1])


def voxels(kind="int16", size=SIZE):
    """No axis can be mistaken for another; of both signs where the type has them."""
    x, y, z = numpy.meshgrid(*[numpy.arange(n) for n in size], indexing="ij")
    least = -60 if numpy.dtype(kind).kind != "u" else 0
    return (x + 7 * y + 31 * z + least).astype(kind)


class Lines:
    """Expected words."""

    def __init__(self, story):
        self.files = {kind: open("%s.%s" % (story, kind), "w", encoding="ascii")
                      for kind in ("refused", "says")}

    def refused(self, name, words):
        self.files["refused"].write("%s\t%s\n" % (name, words))

    def says(self, name, words):
        self.files["says"].write("%s\t%s\n" % (name, words))


# ---- NRRD ----


def nrrd(name, *fields, data=None, sizes=None, encoding="raw", kind="short"):
    """NAME.nrrd, which iftty reads itself where it can, and NAME.nhdr, which ITK reads."""
    data = voxels() if data is None else data
    body = data if isinstance(data, bytes) else data.T.astype(data.dtype).tobytes()
    sizes = sizes or data.shape
    head = ["NRRD0004", "type: " + kind, "dimension: %d" % len(sizes),
            "sizes: " + " ".join(map(str, sizes)), "encoding: " + encoding, "endian: little"]
    head += fields
    write(name + ".nrrd", "\n".join(head) + "\n\n", body)
    write(name + ".nhdr", "\n".join(head + ["data file: %s.raw" % name]) + "\n\n")
    write(name + ".raw", body)


def twins(name, data, place=None, spacing=(0, 0, 0)):
    for ending in (".nrrd", ".nhdr"):
        if place is None:
            save_plain_twin(name + ending, data, spacing)
        else:
            save_twin(name + ending, data, place)


def make_nrrd():
    lines = Lines("nrrd")
    data = voxels()
    turn = numpy.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1.0]])
    in_um = turn * [200.0, 300.0, 500.0]
    origin = numpy.array([1000.0, -2000.0, 3000.0])
    place = numpy.eye(4)
    place[:3, :3], place[:3, 3] = in_um * 1e-3, origin * 1e-3

    def vectors(matrix):
        return " ".join("(%r,%r,%r)" % tuple(map(float, v)) for v in matrix.T)

    fields = ["space: LPS", "space directions: " + vectors(in_um),
              "space origin: (%r,%r,%r)" % tuple(map(float, origin))]
    for number, unit in enumerate(("um", "UM", "microns", "\u00b5m", "micrometer", "\\u00b5m")):
        units = "space units: " + " ".join(3 * ['"%s"' % unit])
        where = number % 3 + 1  # among the others
        nrrd("um%d" % number, *fields[:where], units, *fields[where:])
        twins("um%d" % number, data, LPS @ place)
    # Each axis of the space in a unit of its own: rows are stretched.
    mixed = numpy.array([[0, 0, 50.0, 10], [2, 0, 0, -4], [0, 3, 0, 6], [0, 0, 0, 1]])
    nrrd("mixed", "space: LPS", 'space units: "cm" "mm" "mm"', "space origin: (1,-4,6)",
         "space directions: (0,2,0) (0,0,3) (5,0,0)")
    twins("mixed", data, LPS @ mixed)
    nrrd("nowhere", "space dimension: 3", fields[1], 'space units: "um" "um" "um"')
    twins("nowhere", data, spacing=(0.2, 0.3, 0.5))
    along = numpy.diag([2.0, 3.0, 5.0])
    nrrd("nowhere-mixed", "space dimension: 3", "space directions: " + vectors(along),
         'space units: "cm" "mm" "um"')
    twins("nowhere-mixed", data, spacing=(20, 3, 0.005))
    for unit, mm in (("um", 1e-3), ("nm", 1e-6), ("mm", 1), ("cm", 10), ("m", 1e3), ("in", 25.4),
                     ("angstrom", 1e-7), ("", 1)):
        name = "units-" + (unit or "none")
        scale = 1e4 if mm < 1e-3 else 1
        nrrd(name, "spacings: " + " ".join("%r" % (v * scale) for v in (0.5, 1.25, 2.5)),
             "units: " + " ".join(3 * ['"%s"' % unit]))
        twins(name, data, spacing=numpy.array((0.5, 1.25, 2.5)) * scale * mm)
    nrrd("units-mixed", 'units: "um" "cm" "mm"', "spacings: 500 0.125 2")
    twins("units-mixed", data, spacing=(0.5, 1.25, 2))
    # Of a series the axis of time has a unit of its own, wherever it is.
    series = numpy.stack([data, data + 5], 3)
    nrrd("last", "spacings: 200 300 500 4", 'units: "um" "um" "um" "s"',
         "kinds: domain domain domain time", data=series)
    nrrd("list", "spacings: 200 nan 300 500", 'units: "um" "" "um" "um"',
         "kinds: domain list domain domain", data=numpy.moveaxis(series, 3, 1))
    for name in ("last", "list"):
        twins(name, (data + 5).astype("int16"), spacing=(0.2, 0.3, 0.5))
    nrrd("first", "spacings: 4 200 300 500", "kinds: time domain domain domain",
         data=numpy.moveaxis(series, 3, 0))
    nrrd("none", "space: LPS", "space directions: none (1,0,0) (0,1,0) (0,0,1)",
         data=numpy.moveaxis(series, 3, 0))
    for name in ("first.nrrd", "first.nhdr", "none.nrrd"):
        lines.refused(name + " volume=0", "its axis 1 is not one of space")
    for name, field, more in (("odd", "space units", fields), ("half", "space units", fields),
                              ("odd-units", "units", ["spacings: 1 2 3"])):
        words = {"odd": '"ell" "ell" "ell"', "half": '"mm" "ell" "mm"',
                 "odd-units": '"mm" "mm" "pixel"'}[name]
        nrrd(name, *more, "%s: %s" % (field, words))
        for ending in (".nrrd", ".nhdr"):
            lines.says(name + ending, 'its field "%s" has a unit that is not known' % field)
            lines.says(name + ending, "voxel spacing unknown")
            lines.says(name + ending, "orientation unknown")
    nrrd("key", *fields, "units:=ell", 'space units:="ell" "ell" "ell"')
    place[:3] *= 1e3
    twins("key", data, LPS @ place)
    # One slice.
    flat = voxels(size=(5, 4, 1))
    nrrd("flat", "spacings: 500 250", 'units: "um" "um"', data=flat, sizes=(5, 4))
    twins("flat", flat, spacing=(0.5, 0.25, 1))
    lines.says("flat.nrrd", "it is one slice, and says no thickness: 1 mm is taken for it")
    nrrd("bz", data=b"BZh91AY", sizes=SIZE, encoding="bzip2")
    lines.refused("bz.nrrd", "packed by bzip2, which is not read; `unu save -f nrrd -e gzip -i")
    nrrd("block", "block size: 7", data=bytes(420), sizes=SIZE, kind="block")
    lines.refused("block.nrrd", "its voxels are blocks of bytes; expected integers or floats")
    nrrd("comma", "spacings: 0,5 1,25 2,0")
    lines.refused("comma.nrrd", "its field spacings has a decimal comma; write its numbers with")
    # Numbers as text, which have to be of their type.
    for name, kind, numbers, wrong in (
            ("text-byte", "uchar", "300", "300"), ("text-signed", "short", "-40000", "x"),
            ("text-minus", "ushort", "-1", "x"), ("text-real", "int", "1.5", "x"),
            ("text-wide", "unsigned int", "4294967296", "x"), ("text-word", "float", "high", "x"),
            ("text-float", "float", "1e99", "x")):
        nrrd(name, data=("1 " * 59 + numbers + "\n").encode(), sizes=SIZE, encoding="ascii",
             kind=kind)
        lines.refused(name + ".nrrd", "number 60 of its voxels is not of their type")
        lines.refused(name + ".nhdr", "number 60 of its voxels is not of their type")
    nrrd("text", "spacings: 1 1 1", data=" ".join(map(str, data.T.ravel())).encode() + b"\n",
         sizes=SIZE, encoding="ascii")
    twins("text", data, spacing=(1, 1, 1))


# ---- MetaImage ----


def meta(name, *fields, data=None, sizes=SIZE, kind="MET_SHORT", binary=True, msb=None):
    data = voxels() if data is None else data
    body = data if isinstance(data, bytes) else data.T.astype(
        data.dtype.newbyteorder(">" if msb else "<")).tobytes()
    head = ["ObjectType = Image", "NDims = %d" % len(sizes), "BinaryData = %s" % binary]
    head += fields
    head += ["DimSize = " + " ".join(map(str, sizes)), "ElementType = " + kind,
             "ElementDataFile = LOCAL"]
    write(name, "\n".join(head) + "\n", body)


def make_meta():
    lines = Lines("meta")
    data = voxels()
    plain = ["TransformMatrix = 0 1 0 -1 0 0 0 0 1", "Offset = 10 20 -30",
             "ElementSpacing = 0.5 1.25 2"]
    lps = numpy.array([[0, -1.25, 0, 10], [0.5, 0, 0, 20], [0, 0, 2, -30], [0, 0, 0, 1.0]])
    for unit, mm in (("um", 1e-3), ("mm", 1), ("cm", 10), ("?", 1), ("nm", 1e-6)):
        name = "unit-%s.mha" % unit.replace("?", "none")
        fields = plain if unit != "nm" else plain[:2] + ["ElementSpacing = 50 125 200"]
        place = lps.copy()
        if unit == "nm":
            place[:3, :3] *= 100
        place[:3] *= mm
        meta(name, "DistanceUnits = " + unit, *fields)
        save_twin(name, data, LPS @ place)
    meta("after.mha", *plain, "DistanceUnits = um")
    place = lps.copy()
    place[:3] *= 1e-3
    save_twin("after.mha", data, LPS @ place)
    meta("odd.mha", "DistanceUnits = ell", *plain)
    lines.says("odd.mha", 'its field "DistanceUnits" has a unit that is not known')
    lines.says("odd.mha", "voxel spacing unknown")
    meta("scaled.mha", *plain, "ElementToIntensityFunctionSlope = 2",
         "ElementToIntensityFunctionOffset = 5.5")
    save_twin("scaled.mha", data, LPS @ lps, 2, 5.5)
    lines.says("scaled.mha; info", "values    2 * intensity")
    meta("slope0.mha", *plain, "ElementToIntensityFunctionSlope = 0")
    save_twin("slope0.mha", data, LPS @ lps)
    lines.says("slope0.mha", "which is no scale: numbers are taken as they are")
    for field in ("BinaryDataByteOrderMSB", "ElementByteOrderMSB"):
        for msb in (True, False):
            name = "%s-%s.mha" % (field[:8].lower(), msb)
            meta(name, "%s = %s" % (field, msb), *plain, msb=msb)
            save_twin(name, data, LPS @ lps)
    for name, field in (("comma", "ElementSpacing = 0,5 1,25 2"), ("offset", "Offset = 1,5 0 0"),
                        ("matrix", "TransformMatrix = 1,0 0 0 0 1 0 0 0 1")):
        meta(name + ".mha", field)
        lines.refused(name + ".mha", "has a decimal comma; write its numbers with a decimal point")
    meta("word.mha", "ElementSpacing = 1 two 3")
    lines.refused("word.mha", "its field elementspacing has words that are no numbers")
    flat = voxels(size=(5, 4, 1))
    meta("flat.mha", "ElementSpacing = 500 250", "DistanceUnits = um", data=flat, sizes=(5, 4))
    save_plain_twin("flat.mha", flat, (0.5, 0.25, 1))
    lines.says("flat.mha", "it is one slice, and says no thickness: 1 mm is taken for it")
    meta("size.mha", "ElementSize = 1 2 3")
    save_plain_twin("size.mha", data)
    lines.says("size.mha", "voxel spacing unknown")
    meta("text.mha", "ElementSpacing = 1 1 1", binary=False, kind="MET_UCHAR",
         data=b"1 " * 59 + b"256\n")
    lines.refused("text.mha", "number 60 of its voxels is not of their type")


# ---- MRC ----


def change(name, at, bytes_):
    whole = read(name)
    write(name, whole[:at], bytes_, whole[at + len(bytes_):])


def make_mrc():
    lines = Lines("mrc")
    spacing = (2e-6, 3e-6, 5e-6)
    for mode, kind in ((0, "int8"), (1, "int16"), (2, "float32"), (6, "uint16")):
        for order in "<>":
            name = "mode%d%s.mrc" % (mode, "big" if order == ">" else "")
            mrc(name, voxels(kind), mode, order=order)
            save_plain_twin(name, voxels(kind), spacing)
    many = numpy.arange(60).reshape(SIZE) * 4
    for name, kind, how in (
            ("imod-unsigned.mrc", "uint8", {"imod": 0}), ("imod-signed.mrc", "int8", {"imod": 1}),
            ("by-statistics.mrc", "uint8", {"statistics": (0, 236, 100)}),
            ("no-statistics.mrc", "int8", {"statistics": (0, -1, -2)}),
            ("low-statistics.mrc", "int8", {"statistics": (-100, 100, 0)})):
        data = (many if kind == "uint8" else many - 118).astype(kind)
        mrc(name, data, 0, **how)
        save_plain_twin(name, data, spacing)
    lines.says("by-statistics.mrc", "its bytes are taken as unsigned: its greatest value, 236, is")
    data = voxels()
    for axes in ((1, 2, 3), (1, 3, 2), (2, 1, 3), (2, 3, 1), (3, 1, 2), (3, 2, 1)):
        name = "axes%d%d%d.map" % axes
        mrc(name, data, 1, axes=axes, cell=numpy.array(SIZE) * [20, 30, 50])
        save_plain_twin(name, data, spacing)
    mrc("axes-none.mrc", data, 1, extended=b"x" * 160)
    change("axes-none.mrc", 64, bytes(12))
    save_plain_twin("axes-none.mrc", data, spacing)
    for name, how in (("wrong-stamp.mrc", {"stamp": b"\x11\x11"}), ("no-stamp.mrc",
                      {"stamp": b"\0\0"}), ("big-no-stamp.mrc", {"stamp": b"\0\0", "order": ">"})):
        mrc(name, data, 1, **how)
        save_plain_twin(name, data, spacing)
    lines.says("wrong-stamp.mrc", "its machine stamp is wrong: its numbers are little-endian")
    mrc("stack.mrc", numpy.concatenate([data, data + 5], 2), 1, ispg=401, mz=3)
    save_plain_twin("stack.mrc", (data + 5).astype("int16"), spacing)
    mrc("half-stack.mrc", data, 1, ispg=401, mz=2)
    lines.refused("half-stack.mrc", "it is a stack of volumes of 3 sections in all, and 2 in each")
    mrc("images.st", data, 1, ispg=0, mz=1)
    lines.says("images.st", "it is a stack of images, and does not say how far apart they are")
    mrc("cell0.mrc", data, 1, cell=(0, 0, 0))
    lines.says("cell0.mrc", "voxel spacing unknown")
    mrc("skewed.mrc", data, 1, angles=(90, 90, 120))
    lines.says("skewed.mrc", "the axes of its cell are not at right angles")
    mrc("tail.mrc", data, 1, tail=b"more")
    save_plain_twin("tail.mrc", data, spacing)
    lines.says("tail.mrc", "4 of its bytes come after the voxels")
    for mode, words in ((12, "its numbers are float16 (mode 12), which are not read"),
                        (3, "its numbers are complex (mode 3)"), (4, "complex (mode 4)"),
                        (101, "its numbers have 4 bits (mode 101)"), (16, "its voxels are colours"),
                        (7, "its mode is 7; expected 0, 1, 2 or 6")):
        mrc("mode-%d.mrc" % mode, data, mode)
        lines.refused("mode-%d.mrc" % mode, words)
    mrc("packed.mrc", data.astype("int8"), 0, imod=17)
    lines.refused("packed.mrc", "its numbers have 4 bits (mode 101)")
    mrc("twice.mrc", data, 1)
    change("twice.mrc", 68, b"\1")
    lines.refused("twice.mrc", "run along axes 1, 1, 3; expected 1, 2 and 3 in any order")
    mrc("old.mrc", data, 1, map_=b"    ")
    lines.refused("old.mrc", 'byte 208 is not "MAP "')
    mrc("damaged.mrc", data, 1)
    change("damaged.mrc", 0, b"\xff" * 8)
    lines.refused("damaged.mrc", "its header is damaged")
    mrc("short.mrc", data, 1)
    write("short.mrc", read("short.mrc")[:1100])
    lines.refused("short.mrc", "cut short: it has 1100 bytes, and its header promises 1144")


# ---- HDF5 ----


def tags(axes, resolution=None):
    return json.dumps({"axes": [{"key": a, "typeFlags": 2, "description": "{a} \"b\"",
                                 "resolution": (resolution or {}).get(a, 0)} for a in axes]})


def by_axes(axes, data):
    """The voxels in that order of dimensions; of t and c there are two, the second is `data`."""
    for letter in axes:
        if letter in "tc":
            data = numpy.stack([data - 5, data], -1)
    order = "xyz" + "".join(a for a in axes if a in "tc")
    return numpy.transpose(data, [order.index(a) for a in axes])


def hdf5(name, data, attributes=(), **how):
    with h5py.File(name, "w") as file:
        made = file.create_dataset("exported_data", data=data, **how)
        made.attrs.update(dict(attributes))


def make_hdf5():
    lines = Lines("hdf5")
    data = voxels()
    for axes in ("zyx", "xyz", "yxz", "zxy", "zyxc", "czyx", "cxyz", "xyzc", "tzyxc", "tczyx",
                 "txyzc", "xcyz"):
        name = axes + ".h5"
        hdf5(name, by_axes(axes, data), {"axistags": tags(axes)}, chunks=True, compression="gzip")
        save_plain_twin(name, data)
    one = by_axes("zyx", data)[..., None]
    hdf5("one.h5", one, {"axistags": tags("zyxc")})
    save_plain_twin("one.h5", data)
    flat = voxels(size=(5, 4, 1))
    hdf5("flat.h5", numpy.stack([flat[:, :, 0].T - 5, flat[:, :, 0].T], -1),
         {"axistags": tags("yxc")})
    save_plain_twin("flat.h5", flat)
    hdf5("big.h5", by_axes("tczyx", data), {"axistags": tags("tczyx")}, dtype=">i2")
    save_plain_twin("big.h5", data)
    hdf5("labels.h5", data)  # by dimension scales, in the order of x, y, z
    with h5py.File("labels.h5", "r+") as file:
        for d, letter in enumerate("xyz"):
            file["exported_data"].dims[d].label = letter
    hdf5("axes.h5", data, {"axes": "xyz"})
    hdf5("axes-many.h5", data, {"axes": ["X", "Y", "Z"]})
    for name in ("labels.h5", "axes.h5", "axes-many.h5"):
        save_plain_twin(name, data)
    hdf5("other-names.h5", data.T, {"axes": ["energy", "row", "column"]})
    save_plain_twin("other-names.h5", data)
    lines.says("other-names.h5", "its dimensions have names, and none of x, y, z: the last three")
    for name, axes, words in (("twice", "zxx", "two of its dimensions are named x"),
                              ("no-y", "zcx", "of x and y one is missing"),
                              ("few", "zy", "its axistags name 2 axis")):
        hdf5(name + ".h5", data.T, {"axistags": tags(axes)})
        lines.refused(name + ".h5", words)
    # Distances.
    hdf5("um.h5", data.T, {"element_size_um": [500.0, 300.0, 200.0]})
    hdf5("um-xyz.h5", data, {"element_size_um": [300.0] * 3, "axistags": tags("xyz")})
    size = {"x": 200, "y": 300, "z": 500}
    hdf5("resolution.h5", data, {"axistags": tags("xyz", size),
                                 "axis_units": json.dumps({"x": "um", "y": "um", "z": "um"})})
    hdf5("nm.h5", data.T, {"resolution": [4000.0] * 3, "unit": "nm"})
    hdf5("nm-name.h5", data.T, {"voxel_size_nm": [4000, 4000, 4000]})
    for name, spacing in (("um.h5", (0.2, 0.3, 0.5)), ("um-xyz.h5", (0.3, 0.3, 0.3)),
                          ("resolution.h5", (0.2, 0.3, 0.5)), ("nm.h5", (0.004,) * 3),
                          ("nm-name.h5", (0.004,) * 3)):
        save_plain_twin(name, data, spacing)
    for name, attributes, words in (
            ("no-unit", {"axistags": tags("zyx", size)}, "axistags has numbers, and their unit"),
            ("two-units", {"element_size_um": [1.0, 2, 3], "unit": "nm"}, "another has another"),
            ("which", {"element_size_um": [1.0, 2, 3], "axistags": tags("xyz")}, "whose order is"),
            ("order", {"resolution": [5.0, 3, 2], "unit": "um"}, "whose order is unknown"),
            ("odd-unit", {"spacing": [5.0, 5, 5], "unit": "ell"}, "and their unit is not known")):
        hdf5(name + ".h5", data if name == "which" else data.T, attributes)
        if name == "two-units":
            words = "and another attribute has another unit"
        lines.says(name + ".h5", words)
        lines.says(name + ".h5", "voxel spacing unknown")
    # Types.
    mask = voxels("uint8") % 2 == 1
    hdf5("bool.h5", mask.T)
    save_plain_twin("bool.h5", mask.astype("uint8"))
    for name, kind, words in (("complex", "c8", "records, such as complex numbers or colours"),
                              ("opaque", "V3", "opaque bytes"), ("text", "S2", "texts")):
        made = numpy.zeros(SIZE, kind) if kind != "V3" else numpy.zeros(SIZE, "V3")
        hdf5(name + ".h5", made)
        lines.refused(name + ".h5", "the values of its data set of three dimensions are " + words)
    hdf5("lzf.h5", data.T, chunks=True, compression="lzf")
    lines.refused("lzf.h5", "its voxels are packed by lzf, which is not read; `h5repack -f GZIP=4")


def letters(text):
    return numpy.array([c.encode() for c in text], "S1")


def make_imaris():
    """Blocks of 8x8x16 with an image of 5x4x3 in their corner; two times, two channels, and a
    smaller copy of each."""
    lines = Lines("imaris")
    data = voxels("uint16")
    for name, times, channels, unit in (("one.ims", 1, 1, "um"), ("four.ims", 2, 2, "um"),
                                        ("unit.ims", 1, 1, "ell"), ("wrong.ims", 1, 1, "um")):
        with h5py.File(name, "w") as file:
            for level, size in ((0, SIZE), (1, (3, 2, 2))):
                for t in range(times):
                    for c in range(channels):
                        group = file.create_group("DataSet/ResolutionLevel %d/TimePoint %d/"
                                                  "Channel %d" % (level, t, c))
                        block = numpy.zeros((8, 8, 16), "u2")
                        one = data[:size[0], :size[1], :size[2]] + 100 * (2 * t + c)
                        block[:size[2], :size[1], :size[0]] = one.T
                        group.create_dataset("Data", data=block, chunks=(4, 4, 8),
                                             compression="gzip")
                        for a, letter in enumerate("XYZ"):
                            side = size[a] if name != "wrong.ims" else 99
                            group.attrs["ImageSize" + letter] = letters(str(side))
            image = file.create_group("DataSetInfo/Image")
            for a, letter in enumerate("XYZ"):
                image.attrs[letter] = letters(str(SIZE[a]))
                image.attrs["ExtMin%d" % a] = letters("-1.5")
                image.attrs["ExtMax%d" % a] = letters("%g" % (SIZE[a] * (a + 2) - 1.5))
            image.attrs["Unit"] = letters(unit)
    save_plain_twin("one.ims", data, (0.002, 0.003, 0.004))
    save_plain_twin("four.ims", data + 300, (0.002, 0.003, 0.004))
    save_plain_twin("small", data[:3, :2, :2], (0.002 * 5 / 3, 0.006, 0.006))
    lines.says("unit.ims", "voxel spacing unknown")
    lines.says("unit.ims", "its attribute ExtMax has numbers, and their unit is not known")
    lines.refused("wrong.ims", "its image is 99 voxels long along x, and its data set 16")
    lines.refused("four.ims", "a series of 4 volumes; choose one")
    lines.refused("four.ims volume=4", "there is no volume 4")


# ---- VTK ----


def vtk(name, *lines, body=b"", dataset="STRUCTURED_POINTS", text="BINARY"):
    write(name, "# vtk DataFile Version 3.0\nx\n%s\nDATASET %s\n" % (text, dataset),
          "\n".join(lines) + "\n", body)


def make_vtk():
    lines = Lines("vtk")
    data = voxels()
    body = data.T.astype(">i2").tobytes()
    grid = ["DIMENSIONS 5 4 3", "SPACING 0.5 1.25 2", "ORIGIN 1 2 3"]
    values = ["POINT_DATA 60", "SCALARS s short", "LOOKUP_TABLE default"]
    vtk("plain.vtk", *grid, *values, body=body)
    vtk("turned.vtk", grid[0], grid[2], grid[1], *values, body=body)
    vtk("late.vtk", *grid[::-1], *values, body=body)
    lines.refused("late.vtk", "its DIMENSIONS come after its spacing or origin, which is not read")
    vtk("aspect.vtk", grid[0], "ASPECT_RATIO 0.5 1.25 2", *values, body=body)
    vtk("two.vtk", *grid, *values, body=body + b"\nSCALARS t short\nLOOKUP_TABLE default\n" + body)
    for name in ("plain.vtk", "turned.vtk", "aspect.vtk", "two.vtk"):
        save_plain_twin(name, data, (0.5, 1.25, 2))
    lines.says("two.vtk", "of its bytes come after the first array, which alone is read")
    vtk("cells.vtk", "DIMENSIONS 6 5 4", grid[1], "CELL_DATA 60", *values[1:], body=body)
    lines.refused("cells.vtk", "its values are of cells (CELL_DATA), and only those of points")
    vtk("bit.vtk", *grid, values[0], "SCALARS s bit", values[2], body=bytes(8))
    lines.refused("bit.vtk", "its voxels are of type bit, eight in a byte, which is not read")
    vtk("id.vtk", *grid, values[0], "SCALARS s vtkIdType", values[2], body=bytes(480))
    lines.refused("id.vtk", "its voxels are of another type, which is not read")
    vtk("field.vtk", *grid, values[0], "FIELD FieldData 1", "s 1 60 short", body=body)
    lines.refused("field.vtk", "its first values are in field, which is not read")
    vtk("points.vtk", *grid, "POINT_DATA 59", *values[1:], body=body)
    lines.refused("points.vtk", "its DIMENSIONS are of 60 points, and its POINT_DATA of another")
    for kind in ("RECTILINEAR_GRID", "STRUCTURED_GRID", "UNSTRUCTURED_GRID", "POLYDATA"):
        vtk(kind + ".vtk", *grid, *values, body=body, dataset=kind)
        lines.refused(kind + ".vtk", "it is a %s of VTK" % kind.lower())
    vtk("text.vtk", *grid, values[0], "SCALARS s unsigned_char", values[2], text="ASCII",
        body=b"1 " * 59 + b"-1\n")
    lines.refused("text.vtk", "number 60 of its voxels is not of their type")


make_nrrd()
make_meta()
make_mrc()
make_hdf5()
make_imaris()
make_vtk()
