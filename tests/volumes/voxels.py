# SPDX-License-Identifier: MIT
"""The same 60 voxels in each type, byte order and packing of a format, for tests/test_voxels.sh.

    voxels.py FOLDER   makes them there, and right.nii with the same voxels. What is called times..
                        has them as its second volume."""
import gzip
import os
import shutil
import struct
import sys
import zlib

import h5py
import nibabel
import numpy

from make import mrc, read, write

os.chdir(sys.argv[1])
DATA = (numpy.arange(60).reshape(3, 4, 5) * 7 % 101 + 1).astype("i2")  # z, y, x
TIMES = numpy.stack([DATA + 1, DATA])
PLAIN = DATA.transpose(2, 1, 0)


def meta(name, data, kind="SHORT", msb=False, more=(), sides=(5, 4, 3)):
    lines = ["ObjectType = Image", "NDims = %d" % len(sides), "BinaryData = True",
             "BinaryDataByteOrderMSB = %s" % msb, *more,
             "ElementSpacing =" + " 1" * len(sides), "DimSize = " + " ".join(map(str, sides)),
             "ElementType = MET_" + kind, "ElementDataFile = LOCAL"]
    write(name, "\n".join(lines) + "\n", data.tobytes())


def make_meta():
    for kind, code in (("CHAR", "i1"), ("UCHAR", "u1"), ("SHORT", "i2"), ("USHORT", "u2"),
                       ("INT", "i4"), ("UINT", "u4"), ("LONG_LONG", "i8"), ("ULONG_LONG", "u8"),
                       ("FLOAT", "f4"), ("DOUBLE", "f8")):
        meta(kind + "-little.mha", DATA.astype("<" + code), kind)
        meta(kind + "-big.mha", DATA.astype(">" + code), kind, True)
    meta("times.mha", TIMES.astype("<i2"), sides=(5, 4, 3, 2))
    meta("times-channels.mha", numpy.stack(TIMES, -1).astype("<i2"),
         more=["ElementNumberOfChannels = 2"])


def make_vtk():
    head = ("# vtk DataFile Version 3.0\nx\n%s\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 4 3\n"
            "SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 60\nSCALARS s %s 1\nLOOKUP_TABLE default\n")
    for kind, code in (("unsigned_char", "u1"), ("char", "i1"), ("short", "i2"),
                       ("unsigned_short", "u2"), ("int", "i4"), ("unsigned_int", "u4"),
                       ("long", "i8"), ("float", "f4"), ("double", "f8")):
        write(kind + ".vtk", head % ("BINARY", kind), DATA.astype(">" + code).tobytes())
        write(kind + "-text.vtk", head % ("ASCII", kind), " ".join(map(str, DATA.ravel())), "\n")
    write("times.vtk", (head % ("BINARY", "short")).replace("short 1", "short 2"),
          numpy.stack(TIMES, -1).astype(">i2").tobytes())


def make_raw():
    for kind in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
                 "float32", "float64"):
        for order, name in (("<", "little"), (">", "big")):
            bytes_ = DATA.astype(numpy.dtype(kind).newbyteorder(order)).tobytes()
            write("%s-%s.raw" % (kind, name), b"head", bytes_)
            write("%s-%s.raw.gz" % (kind, name), gzip.compress(b"head" + bytes_))


def make_hdf5():
    for code in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"):
        for order, name in (("<", "little"), (">", "big")):
            with h5py.File("%s-%s.h5" % (code, name), "w") as file:
                file.create_dataset("voxels", data=DATA, dtype=order + code)
    with h5py.File("times.h5", "w") as file:
        file["voxels"] = TIMES
    for packed, more in (("gzip", {}), ("shuffle", {"shuffle": True}),
                         ("sum", {"fletcher32": True})):
        with h5py.File(packed + ".h5", "w") as file:
            file.create_dataset("voxels", data=DATA, compression="gzip", **more)


def make_itk_hdf5():
    """As ITK writes them: a group for the image, with its place as data sets."""
    for name, data, order, packed in (("itk-little", DATA, "<", "gzip"),
                                      ("itk-big", DATA, ">", "gzip"), ("times", TIMES, "<", None)):
        with h5py.File(name + ".hdf5", "w") as file:
            group, sides = file.create_group("ITKImage/0"), data.ndim
            group["Dimension"] = numpy.array(data.shape[::-1], "u8")
            group["Directions"] = numpy.diag([-1.0, -1.0, 1.0, 1.0][:sides])
            group["Origin"], group["Spacing"] = numpy.zeros(sides), numpy.ones(sides)
            group["VoxelType"] = "SHORT"
            group.create_dataset("VoxelData", data=data, dtype=order + "i2", compression=packed)
            group.create_group("MetaData")
            file["ITKVersion"], file["HDFVersion"] = "5.2.1", "1.10.8"


def make_mrc():
    for mode, code, order in ((1, "i2", "<"), (2, "f4", "<"), (6, "u2", "<"), (1, "i2", ">"),
                              (2, "f4", ">"), (6, "u2", ">")):
        mrc("%s-%s.mrc" % (code, "little" if order == "<" else "big"), DATA.T.astype(code), mode,
            order=order, cell=(5e7, 4e7, 3e7), statistics=(1, 101, 50), ispg=0)  # 1 mm


def gipl(name, kind, data, sides=(5, 4, 3, 1)):
    head = struct.pack(">5H4f", *sides, kind, 1, 1, 1, 1).ljust(252, b"\0")
    write(name, head, struct.pack(">I", 719555000), data.tobytes())


def make_gipl():
    for kind, code in ((7, "i1"), (8, "u1"), (15, "i2"), (16, "u2"), (31, "u4"), (32, "i4"),
                       (64, "f4"), (65, "f8")):
        gipl(code + ".gipl", kind, DATA.astype(">" + code))
    gipl("times.gipl", 15, TIMES.astype(">i2"), (5, 4, 3, 2))


def make_others():
    nibabel.save(nibabel.Nifti1Image(PLAIN, numpy.eye(4)), "right.nii")
    times = nibabel.AnalyzeImage(numpy.stack([PLAIN + 1, PLAIN], 3), numpy.eye(4))
    nibabel.save(times, "times.img")
    with open("times.hdr", "rb") as file:
        head = file.read()
    for unit in ("um", "mm", "cm"):
        write(unit + ".hdr", head[:56] + unit.encode().ljust(4, b"\0") + head[60:])
        write(unit + ".img", TIMES.tobytes())
    lines = ["NRRD0004", "type: short", "dimension: 3", "sizes: 5 4 3", "space: RAS",
             "space directions: (1,0,0) (0,1,0) (0,0,1)", "space origin: (0,0,0)"]
    for order, name in ((">", "big"), ("<", "little")):
        bytes_ = DATA.astype(order + "i2").tobytes()
        for encoding, body in (("raw", bytes_), ("gzip", gzip.compress(bytes_)),
                               ("hex", bytes_.hex().encode())):
            write("%s-%s.nrrd" % (name, encoding), "\n".join(lines),
                  "\nendian: %s\nencoding: %s\n\n" % (name, encoding), body)
    write("text.nrrd", "\n".join(lines), "\nencoding: text\n\n", " ".join(map(str, DATA.ravel())))
    for name in ("SHORT-big.mha", "short.vtk", "i2-little.h5", "i2-little.mrc", "i2.gipl",
                 "big-raw.nrrd"):
        write(name + ".gz", gzip.compress(read(name)))


# ---- PNG ----


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def bits(row, depth):
    digits = "".join(format(int(v) % (1 << depth), "0%db" % depth) for v in row)
    digits += "0" * (-len(digits) % 8)
    return bytes(int(digits[i:i + 8], 2) for i in range(0, len(digits), 8))


def png(folder, z, rows, depth=8, colour=0, more=b""):
    os.makedirs(folder, exist_ok=True)
    write("%s/s%d.png" % (folder, z), b"\x89PNG\r\n\x1a\n",
          chunk(b"IHDR", struct.pack(">IIBBBBB", 5, len(rows), depth, colour, 0, 0, 0)), more,
          chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))),
          chunk(b"IEND", b""))


def make_png():
    palette = chunk(b"PLTE", bytes(v for i in range(256) for v in (255 - i, i, 7)))
    for z in range(3):
        plain = [row.astype("u1").tobytes() for row in DATA[z]]
        png("png-8", z, plain)
        png("png-16", z, [row.astype(">u2").tobytes() for row in DATA[z]], 16)
        for depth in (1, 2, 4):
            png("png-%d" % depth, z, [bits(row, depth) for row in DATA[z]], depth)
        png("png-palette", z, plain, 8, 3, palette)
        png("png-alpha", z, [bytes(b for v in row for b in (v, 255)) for row in DATA[z]], 8, 4)
        png("png-colours", z, [bytes(v for v in row for _ in range(3)) for row in DATA[z]], 8, 2)
        png("png-fine", z, plain, 8, 0, chunk(b"pHYs", struct.pack(">IIB", 20000, 10000, 1)))
        png("png-deeper", z, plain if z < 2 else [row.astype(">u2").tobytes() for row in DATA[z]],
            8 if z < 2 else 16)
        png("png-shorter", z, plain[:4 if z < 2 else 3])


def make_minc():
    """Those of nibabel, with another unit."""
    folder = os.path.join(os.path.dirname(nibabel.__file__), "tests", "data")
    for name, unit in (("um", b"um"), ("long", b"millimeters"), ("none", None)):
        shutil.copy(os.path.join(folder, "small.mnc"), name + ".mnc")
        os.chmod(name + ".mnc", 0o644)
        with h5py.File(name + ".mnc", "r+") as file:
            for axis in ("xspace", "yspace", "zspace"):
                attributes = file["minc-2.0/dimensions/" + axis].attrs
                del attributes["units"]
                if unit:
                    attributes["units"] = numpy.bytes_(unit)
    old = read(os.path.join(folder, "tiny.mnc"))
    begin = old.index(b"units", old.index(b"direction_cosines"))
    at = old.index(b"mm", begin)
    write("old-um.mnc", old[:at] + b"um" + old[at + 2:])
    write("old.mnc", old)


make_meta()
make_vtk()
make_raw()
make_hdf5()
make_itk_hdf5()
make_mrc()
make_gipl()
make_others()
make_minc()
make_png()
