#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Scenes for test_apply.sh: two balls in the world, as grids of any kind have them.

    phantom.py make FILE WHERE [lesion] [leak] [grown] [silent]   writes the scene, .nii
    phantom.py check SEEDS WHERE DEPTH SMALL       whether a map of seeds is what it has to be

The large ball is of radius 14 mm around 0,0,0, the small one of 5 mm around 20,5,0; a third one, of
no label, is where only one way of turning the three meets all of them. WHERE is one of
the rows of `where`: size, voxels to millimetres, and the pull, by which a place of the subject is
one of the balls' world. A lesion is a brighter ball of 4 mm in the large one; a leak, a rod of 4 mm
radius along y out of it, as bright; grown, a small ball of 6.4 mm. A silent file says nothing of
where it lies.

A seed of a label has to lie where the pull leads into its ball, as deep as DEPTH millimetres (SMALL
in the small one); and each voxel that does is a seed: but for a voxel's width.
"""
import gzip
import math
import struct
import sys

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


def value_at(at, words):
    if "lesion" in words and math.dist(at, (2, 2, 2)) <= 4:
        return 220
    for label, middle, radius in BALLS:
        is_leak = (label == 1 and "leak" in words and 0 < at[1] < 28 and
                   math.hypot(at[0], at[2]) <= 4)
        radius += 1.4 * (label == 2 and "grown" in words)
        if math.dist(at, middle) <= radius or is_leak:  # a slope, so that percentiles lie apart
            return (80 if label == 1 else 150) + int(at[0] * 0.7)
    return 50 if math.dist(at, (-6, -19, 10)) <= 6 else 20


def make(path, name, words):
    size, to_mm, pull = where[name]
    silent = "silent" in words
    voxels = bytearray()
    for z in range(size[2]):
        for y in range(size[1]):
            for x in range(size[0]):
                at = through(pull, through(to_mm, (x, y, z)))
                voxels.append(value_at(at, words))
    steps = [math.sqrt(sum(row[a] ** 2 for row in to_mm)) for a in range(3)]
    header = struct.pack("<i36x8h14x2h", 348, 3, *size, 1, 1, 1, 1, 2, 8)
    header += struct.pack("<h8f3f", 0, 1, *steps, 0, 0, 0, 0, 352, 0, 0)
    header = header.ljust(123, b"\0") + bytes([2])  # millimetres
    header = header.ljust(252, b"\0") + struct.pack("<2h6f", 0, 0 if silent else 1, *[0] * 6)
    header += struct.pack("<12f", *[0 if silent else v for row in to_mm for v in row])
    header = header.ljust(344, b"\0") + b"n+1\0\0\0\0\0"
    with open(path, "wb") as file:
        file.write(header + voxels)


def check(path, name, depth, small):
    size, to_mm, pull = where[name]
    with gzip.open(path) as file:
        data = file.read()
    found = struct.unpack("<%dH" % (size[0] * size[1] * size[2]), data[352:])
    wrong, seeds, i = 0, {}, 0
    width = max(math.sqrt(sum(row[a] ** 2 for row in to_mm)) for a in range(3)) * 1.8
    scale = math.sqrt(sum(row[0] ** 2 for row in pull))  # mm of the balls' world, of a mm here
    for z in range(size[2]):
        for y in range(size[1]):
            for x in range(size[0]):
                at, value = through(pull, through(to_mm, (x, y, z))), found[i]
                i += 1
                seeds[value] = seeds.get(value, 0) + 1
                for label, middle, radius in BALLS:
                    inside = (radius - math.dist(at, middle)) / scale
                    deep = depth if label == 1 else small
                    is_seed = value in (label, label + 256)
                    if is_seed and inside < deep - width:
                        wrong += 1
                    if not is_seed and inside > deep + width:
                        wrong += 1
    print(wrong, " ".join("%d:%d" % item for item in sorted(seeds.items())))
    sys.exit(wrong > 0)


if sys.argv[1] == "make":
    make(sys.argv[2], sys.argv[3], sys.argv[4:])
else:
    check(sys.argv[2], sys.argv[3], float(sys.argv[4]), float(sys.argv[5]))
