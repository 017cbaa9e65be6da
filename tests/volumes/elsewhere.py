# SPDX-License-Identifier: MIT
"""Makes volumes whose voxels lie in other files, sound ones and such as a stranger may make:
elsewhere.py FOLDER; the secret is in FOLDER/../secret."""
import os
import sys

import h5py
import nibabel
import numpy

SIZE = (6, 5, 4)
folder = sys.argv[1]
secret = os.path.join(os.path.dirname(os.path.abspath(folder)), "secret")
os.chdir(folder)
data = (numpy.arange(120).reshape(SIZE, order="F") % 251).astype(numpy.uint8)


def write(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


write("v.raw", data.tobytes(order="F"))
write("short.raw", data.tobytes(order="F")[:90])
for name in ("v.raw", "s01.raw", "v.h5"):
    write(os.path.join(secret, name), b"")
write(os.path.join(secret, "v.raw"), data[::-1].tobytes(order="F"))
os.mkdir("deep")
for z in range(4):
    write("s%02d.raw" % (z + 1), data[:, :, z].tobytes(order="F"))
    write("deep/s%d.raw" % (z + 1), data[:, :, z].tobytes(order="F"))
    write(os.path.join(secret, "s%02d.raw" % (z + 1)), data[::-1, :, z].tobytes(order="F"))
os.symlink(os.path.join(secret, "v.raw"), "away.raw")
os.symlink("v.raw", "inner.raw")
os.symlink("/dev/zero", "zero.raw")
os.symlink(secret, "folder")
os.mkfifo("pipe.raw")
write("a%20b.raw", data.tobytes(order="F"))
nibabel.save(nibabel.Nifti1Image(data, numpy.eye(4)), "twin.nii")

META = "ObjectType = Image\nNDims = 3\nDimSize = 6 5 4\nElementType = MET_UCHAR\n"
NRRD = "NRRD0004\ntype: unsigned char\ndimension: 3\nsizes: 6 5 4\nencoding: raw\n"


def both(name, value, more=""):
    write(name + ".mhd", META + "ElementDataFile = " + value + "\n" + more)
    write(name + ".nhdr", NRRD + "data file: " + value + "\n" + more)


both("plain", "v.raw")
both("percent", "a%20b.raw")
os.remove("percent.mhd")  # to its library a pattern
both("inner", "inner.raw")
both("counted", "s%02d.raw 1 4 1")
both("list", "LIST 2", "s01.raw\ndeep/s2.raw\ns03.raw\ns04.raw\n")
both("parent", "../secret/v.raw")
both("absolute", os.path.join(secret, "v.raw"))
both("away", "away.raw")
both("folder", "folder/v.raw")
both("zero", "zero.raw")
both("pipe", "pipe.raw")
both("none", "none.raw")
both("here", "deep")
both("list-none", "LIST 2", "s01.raw\nnone.raw\ns03.raw\ns04.raw\n")
both("list-parent", "LIST 2", "s01.raw\n../secret/s02.raw\ns03.raw\ns04.raw\n")
both("list-short", "LIST 2", "s01.raw\ns02.raw\ns03.raw\n")
both("list-pipe", "LIST 2", "s01.raw\ns02.raw\ns03.raw\npipe.raw\n")
both("counted-parent", "../secret/s%02d.raw 1 4 1")
both("counted-none", "s%02d.raw 2 5 1")
both("counted-twice", "s%02d%s.raw 1 4 1")
# Headers that say two things, of which their library may take the other one.
write("swallowed.mhd", META +
      "Comment\nElementDataFile = LOCAL\nElementDataFile = ../secret/v.raw\n")
write("small.mhd", META + "elementdatafile = LOCAL\nElementDataFile = ../secret/v.raw\n")
write("twice.nhdr", NRRD + "data file: v.raw\nDATAFILE: ../secret/v.raw\n")
write("late.nhdr", NRRD + "# x\n" * 300000 + "datafile: ../secret/v.raw\n")
write("many.nhdr", NRRD + "".join("k%d:=1\n" % i for i in range(2000)) +
      "data file: ../secret/v.raw\n")


def hdf5(name):
    return h5py.File(name, "w")


for z in range(4):
    with hdf5("z%d.h5" % z) as file:
        file["d"] = data.T[z]
with hdf5(os.path.join(secret, "v.h5")) as file:
    file["d"] = data.T[:, :, ::-1]
os.symlink(os.path.join(secret, "v.h5"), "away.h5")
write("bad.h5", b"\x89HDF\r\n\x1a\n" + b"x" * 90)
with hdf5("less.h5") as file:
    file["d"] = data.T[3][:3]
with hdf5("linked.h5") as file:
    file["d"] = h5py.ExternalLink("../secret/v.h5", "d")


def virtual(name, sources, shape=(4, 5, 6)):
    layout = h5py.VirtualLayout(shape=shape, dtype="u1")
    for z, source in enumerate(sources):
        layout[z] = h5py.VirtualSource(source, "d", shape=(5, 6))
    with hdf5(name) as file:
        file.create_virtual_dataset("v", layout, fillvalue=0)


good = ["z0.h5", "z1.h5", "z2.h5"]
virtual("virtual.h5", good + ["z3.h5"])
virtual("virtual-gap.h5", good)
virtual("virtual-none.h5", good + ["none.h5"])
virtual("virtual-less.h5", good + ["less.h5"])
virtual("virtual-bad.h5", good + ["bad.h5"])
virtual("virtual-linked.h5", good + ["linked.h5"])
for name, source in (("parent", "../secret/v.h5"), ("absolute", os.path.join(secret, "v.h5")),
                     ("away", "away.h5"), ("pipe", "pipe.raw")):
    virtual("virtual-%s.h5" % name, good + [source])
layout = h5py.VirtualLayout(shape=(4, 5, 6), dtype="u1")
layout[:] = h5py.VirtualSource("virtual-none.h5", "v", shape=(4, 5, 6))
with hdf5("virtual-nested.h5") as file:
    file.create_virtual_dataset("v", layout)
layout = h5py.VirtualLayout(shape=(4, 5, 6), dtype="u1")
with hdf5("virtual-own.h5") as file:
    for z in range(4):
        file["p%d" % z] = data.T[z]
        layout[z] = h5py.VirtualSource(".", "p%d" % z, shape=(5, 6))
    file.create_virtual_dataset("v", layout)
for name, source in (("plain", "v.raw"), ("parent", "../secret/v.raw"), ("none", "none.raw"),
                     ("absolute", os.path.join(secret, "v.raw")), ("away", "away.raw"),
                     ("short", "short.raw"), ("pipe", "pipe.raw")):
    with hdf5("external-%s.h5" % name) as file:
        file.create_dataset("v", shape=(4, 5, 6), dtype="u1", external=[(source, 0, 120)])
with hdf5("link.h5") as file:
    file["v"] = h5py.ExternalLink("../secret/v.h5", "d")
with hdf5("itk.h5") as file:
    file["ITKImage"] = h5py.ExternalLink("../secret/v.h5", "/")
