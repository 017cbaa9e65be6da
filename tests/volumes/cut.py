# SPDX-License-Identifier: MIT
"""Volumes that other people's programs wrote, sound and cut, for tests/test_cut_files.sh.

    cut.py FOLDER      makes sound ones there, and of each, in a folder of its own, copies that are
                       cut: FOLDER/cut/NAME-N/... Prints a line for each copy:
                       OPENED WRITTEN-BY FORMAT CUT BYTES-LEFT BYTES-OF-THE-SOUND-ONE"""
import os
import shutil
import sys

import make
from make import read, run, write

# What is opened, the file of it that is cut, and how its bytes can be counted: plainly; by parts,
# which say how long they are; packed, or as text.
SOUND = [
    ("itk.mha", "itk.mha", "plain"), ("packed.mha", "packed.mha", "plain"),
    ("packed.mhd", "packed.zraw", "packed"), ("itk.mhd", "itk.raw", "plain"),
    ("list.mhd", "list2.raw", "plain"), ("count.mhd", "count02.raw", "plain"),
    ("text.mha", "text.mha", "text"), ("itk.nrrd", "itk.nrrd", "packed"),
    ("LPS-short.nrrd", "LPS-short.nrrd", "plain"), ("RAS-byte.nrrd", "RAS-byte.nrrd", "packed"),
    ("beside.nhdr", "beside.raw", "plain"), ("packed.nhdr", "packed.raw.gz", "packed"),
    ("unu.nrrd", "unu.nrrd", "text"), ("itk.gipl", "itk.gipl", "plain"),
    ("itk.vtk", "itk.vtk", "plain"), ("unu.vtk", "unu.vtk", "text"),
    ("itk.mrc", "itk.mrc", "plain"), ("a.mrc", "a.mrc", "plain"),
    ("itk.mnc", "itk.mnc", "plain"), ("tiny.mnc", "tiny.mnc", "parts"),
    ("itk.h5", "itk.h5", "plain"), ("a.h5", "a.h5", "plain"), ("itk.tif", "itk.tif", "parts"),
    ("stack.tif", "stack.tif", "parts"), ("stack.lsm", "stack.lsm", "parts"),
    ("tif-slices", "tif-slices/s7.tif", "parts"), ("png-slices", "png-slices/s7.png", "parts"),
    ("byte.mgh", "byte.mgh", "plain"), ("ni1.twin.nii", "ni1.twin.nii", "plain"),
    ("an-short.hdr", "an-short.img", "plain"),
]


def make_more():
    """ITK's writers, by plastimatch; teem's; and what neither writes, by hand."""
    for ending in ("mha", "mhd", "nrrd", "gipl", "vtk", "mrc", "mnc", "h5", "tif"):
        run("plastimatch", "convert", "--input", "ni1.twin.nii", "--output-img", "itk." + ending,
            "--output-type", "short", stderr=make.subprocess.DEVNULL)
    for form, encoding, source, to in (("nrrd", "ascii", "LPS-short.nrrd", "unu.nrrd"),
                                       ("nrrd", "gzip", "LPS-short.nrrd", "packed.nhdr"),
                                       ("vtk", "ascii", "beside.nhdr", "unu.vtk")):
        run("teem-unu", "save", "-f", form, "-e", encoding, "-i", source, "-o", to)
    shutil.copy("stack.tif", "stack.lsm")
    whole = read("packed.mha")
    at = whole.index(b"CompressedDataSize")
    local = whole.index(b"\n", whole.index(b"ElementDataFile")) + 1
    loose = whole[:at] + whole[whole.index(b"\n", at) + 1:local]
    write("loose.mha", loose, whole[local:])
    write("packed.mhd", loose.replace(b"LOCAL", b"packed.zraw"))
    write("packed.zraw", whole[local:])
    header = whole[:whole.index(b"CompressedData")]
    voxels = make.voxels().T.astype("<i2").tobytes()
    for name, data, parts in (("list", b"LIST\nlist1.raw\nlist2.raw\n",
                               ("list1.raw", "list2.raw")),
                              ("count", b"count%02d.raw 1 2 1\n",
                               ("count01.raw", "count02.raw"))):
        write(name + ".mhd", header.replace(b"NDims = 3", b"NDims = 4")
              .replace(b"DimSize = 26 22 14", b"DimSize = 26 22 7 2")
              .replace(b"TransformMatrix", b"X").replace(b"Offset", b"Y")
              .replace(b"0.9 1.1 2.5", b"0.9 1.1 2.5 1"), b"ElementDataFile = " + data)
        for i, part in enumerate(parts):
            write(part, voxels[i * len(voxels) // 2:(i + 1) * len(voxels) // 2])
    write("text.mha", header.replace(b"BinaryData = True", b"BinaryData = False"),
          b"ElementDataFile = LOCAL\n", " ".join(map(str, make.voxels().T.ravel())), "\n")


os.chdir(sys.argv[1])
for each in (make.make_pairs, make.make_mgh, make.make_nrrd, make.make_meta, make.make_mrc,
             make.make_pictures, make.make_hdf5, make.make_minc, make_more):
    each()
for opened, cut, counting in SOUND:
    whole = read(cut)
    if opened == "byte.mgh":
        whole = whole[:-20]  # how it was scanned, which may be missing
    most = len(whole)
    if counting == "text":  # its last characters are a line feed and digits
        whole = whole.rstrip()
        whole = whole[:max(whole.rindex(b" "), whole.rindex(b"\n")) + 1]
    for at in (most // 4, most // 2, most * 99 // 100, most - 1):
        at = min(at, len(whole))
        there = os.path.join("cut", "%s-%d" % (opened, at))
        os.makedirs(there, exist_ok=True)
        stem = opened.split(".")[0]
        for name in os.listdir():
            if name == opened or (opened[-4:] in (".mhd", "nhdr", ".hdr") and
                                  name.startswith(stem) and "twin" not in name):
                copy = shutil.copytree if os.path.isdir(name) else shutil.copy
                if not os.path.exists(os.path.join(there, name)):
                    copy(name, os.path.join(there, name))
        write(os.path.join(there, cut), whole[:at])
        print(os.path.abspath(os.path.join(there, opened)), os.path.basename(cut), counting,
              at, most)
