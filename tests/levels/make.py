# SPDX-License-Identifier: MIT
"""Scenes of real and of wide whole numbers, by nibabel; how many voxels are in a range.

    make.py FOLDER     makes them, and prints two values of them
    make.py count      reads lines FILE LOW HIGH, prints COUNT FILE LOW HIGH, by nibabel's reading
                       of the file, in its precision"""
import sys

import nibabel
import numpy

SIZE = (14, 12, 10)


def save(name, values, slope=None):
    image = nibabel.Nifti1Image(values, numpy.diag((1, 1, 2, 1)), dtype=values.dtype)
    image.header.set_xyzt_units("mm")
    if slope:
        image.header.set_slope_inter(*slope)
    nibabel.save(image, name)


def make():
    numbers = numpy.arange(numpy.prod(SIZE)) * 7919 % 1009 / 1009
    plain = numbers.reshape(SIZE).astype(numpy.float32)
    save("plain.nii", plain)
    for name, far in ("far4", 1e4), ("far20", 1e20), ("low", -1e30):
        values = plain.copy()
        values[3, 4, 5] = far
        save(name + ".nii", values)
    holes = plain.astype(numpy.float64)
    holes[0] = numpy.nan
    holes[1, 1, 1], holes[1, 1, 2] = 1e300, -numpy.inf
    save("holes.nii", holes)
    save("hundredths.nii", numpy.round(plain, 2))
    save("tiny.nii", plain * numpy.float32(1e-6))
    ct = numpy.round(plain * 4000 - 1000).astype(numpy.int32)
    save("ct.nii", ct)
    save("ct-real.nii", ct.astype(numpy.float32))
    save("ct-far.nii", numpy.where(numpy.arange(ct.size).reshape(SIZE) == 77, 2000000000, ct))
    save("counts.nii", (plain * 4e12).astype(numpy.int64))
    save("unsigned.nii", (plain * 4e9).astype(numpy.uint32))
    save("quotients.nii.gz", (plain / (plain[::-1, ::-1] + 1e-5)).astype(numpy.float32))
    series = numpy.stack([plain, plain * 2], axis=3)
    series[3, 4, 5, 1] = 1e9
    save("series.nii", series)
    close = numpy.linspace(0, 1, 1680).reshape(SIZE)
    close[6] = 0.5 + numpy.arange(120).reshape(12, 10) * 1e-9
    save("close.nii", close)
    far = (numpy.arange(1728) * 7919 % 1009 / 1009).reshape(12, 12, 12).astype(numpy.float32)
    far[4, 10, 4] = 1e4
    save("far.nii", far)
    print("%g" % nibabel.load("far4.nii").dataobj[7, 7, 7],
          nibabel.load("counts.nii").dataobj[0, 0, 1])


def count(name, low, high):
    image = nibabel.load(name)
    values = numpy.asarray(image.dataobj)
    single = values.dtype == numpy.float32
    low, high = (numpy.float32(end) if single else float(end) for end in (low, high))
    return int(((values >= low) & (values <= high)).sum())


if sys.argv[1] == "count":
    for line in sys.stdin:
        print(count(*line.split()), line, end="")
else:
    make()
