#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Scenes for test_apply.sh: two balls in the world, as grids of any kind have them.

    phantom.py scenes WHERE...                     writes WHERE.nii for each
    phantom.py make FILE WHERE [lesion] [leak] [grown] [silent]   writes the scene, .nii
    phantom.py check SEEDS WHERE DEPTH SMALL       whether a map of seeds is what it has to be

The large ball is of radius 14 mm around 0,0,0, the small one of 5 mm around 20,5,0; a third one, of
no label, is where only one way of turning the three meets all of them. WHERE is one of
the rows of `where`: size, voxels to millimetres, and the pull, by which a place of the subject is
one of the balls' world. A lesion is a brighter ball of 4 mm in the large one; a leak, a rod of 4 mm
radius along y out of it, as bright; grown, a small ball of 6.4 mm. A silent file says nothing of
where it lies.

A seed of a label has to lie where the pull leads into its ball, as deep as DEPTH millimetres (SMALL
in the small one); and each voxel that does is a seed: but for a voxel's width."""
import gzip
import math
import struct
import sys

import numpy

BALLS = ((1, (0, 0, 0), 14), (2, (20, 5, 0), 5))
ONE = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))
C, S = math.cos(0.4), math.sin(0.4)

where = {
    "plain": ((64, 56, 48), ((1, 0, 0, -28), (0, 1, 0, -28), (0, 0, 1, -24)), ONE),
    "moved": ((70, 60, 50), ((1, 0, 0, -33), (0, 1, 0, -26), (0, 0, 1, -27)), ONE),
    "mirrored": ((48, 56, 64), ((0, 0, -1, 35), (0, -1, 0, 27), (1, 0, 0, -24)), ONE),
    "coarse": ((44, 28, 30), ((1.5, 0, 0, -28), (0, 2, 0, -28), (0, 0, 1.6, -24)), ONE),
    "oblique": ((72, 66, 52), ((C, -S, 0, -18), (S, C, 0, -40), (0, 0, 1, -25)), ONE),
    # another subject: turned, larger by a fifth, and elsewhere
    "other": ((80, 76, 64), ((1, 0, 0, -30), (0, 1, 0, -40), (0, 0, 1, -30)),
              ((C / 1.2, S / 1.2, 0, -4), (-S / 1.2, C / 1.2, 0, 2), (0, 0, 1 / 1.2, 1))),
    "far": ((20, 20, 20), ((1, 0, 0, 500), (0, 1, 0, 0), (0, 0, 1, 0)), ONE),
}


def through(matrix, at):
    return [row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3] for row in matrix]


def places(name):
    """The place of each voxel in the balls' world, as arrays [z][y][x]."""
    size, to_mm, pull = where[name]
    z, y, x = numpy.indices(size[::-1])
    return through(pull, through(to_mm, (x, y, z)))


def distance(at, middle):
    return numpy.sqrt(sum((a - m) ** 2 for a, m in zip(at, middle)))


def make(path, name, words=()):
    size, to_mm, _ = where[name]
    silent, at = "silent" in words, places(name)
    voxels = numpy.where(distance(at, (-6, -19, 10)) <= 6, 50, 20)
    for label, middle, radius in reversed(BALLS):  # a slope, so that percentiles lie apart
        radius += 1.4 * (label == 2 and "grown" in words)
        is_in = distance(at, middle) <= radius
        if label == 1 and "leak" in words:
            is_in |= (at[1] > 0) & (at[1] < 28) & (numpy.hypot(at[0], at[2]) <= 4)
        voxels = numpy.where(is_in, (80 if label == 1 else 150) + (at[0] * 0.7).astype(int), voxels)
    if "lesion" in words:
        voxels = numpy.where(distance(at, (2, 2, 2)) <= 4, 220, voxels)
    steps = [math.sqrt(sum(row[a] ** 2 for row in to_mm)) for a in range(3)]
    header = struct.pack("<i36x8h14x2h", 348, 3, *size, 1, 1, 1, 1, 2, 8)
    header += struct.pack("<h8f3f", 0, 1, *steps, 0, 0, 0, 0, 352, 0, 0)
    header = header.ljust(123, b"\0") + bytes([2])  # millimetres
    header = header.ljust(252, b"\0") + struct.pack("<2h6f", 0, 0 if silent else 1, *[0] * 6)
    header += struct.pack("<12f", *[0 if silent else v for row in to_mm for v in row])
    header = header.ljust(344, b"\0") + b"n+1\0\0\0\0\0"
    with open(path, "wb") as file:
        file.write(header + voxels.astype("u1").tobytes())


def check(path, name, depth, small):
    size, to_mm, pull = where[name]
    with gzip.open(path) as file:
        data = file.read()
    found = numpy.frombuffer(data, "<u2", math.prod(size), 352).reshape(size[::-1])
    wrong, at = 0, places(name)
    width = max(math.sqrt(sum(row[a] ** 2 for row in to_mm)) for a in range(3)) * 1.8
    scale = math.sqrt(sum(row[0] ** 2 for row in pull))  # mm of the balls' world, of a mm here
    for label, middle, radius in BALLS:
        inside = (radius - distance(at, middle)) / scale
        deep = depth if label == 1 else small
        is_seed = (found == label) | (found == label + 256)
        wrong += numpy.count_nonzero(is_seed & (inside < deep - width))
        wrong += numpy.count_nonzero(~is_seed & (inside > deep + width))
    print(wrong, *("%d:%d" % item for item in zip(*numpy.unique(found, return_counts=True))))
    sys.exit(wrong > 0)


if sys.argv[1] == "scenes":
    for each in sys.argv[2:]:
        make(each + ".nii", each)
elif sys.argv[1] == "make":
    make(sys.argv[2], sys.argv[3], sys.argv[4:])
else:
    check(sys.argv[2], sys.argv[3], float(sys.argv[4]), float(sys.argv[5]))
