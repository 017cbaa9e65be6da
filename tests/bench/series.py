# SPDX-License-Identifier: MIT
"""How long a DICOM series of 400 slices of 512x512 takes to open: `make bench-series`.

    series.py [--slices N] BUILD

Exit status: 0 fine, 3 a program could not be run."""
import argparse
import os
import statistics
import tempfile
import time

import numpy
import pydicom
import pydicom.data

from programs import leave_by, run


def make_series(folder, slices):
    """A cylinder in noise, on the header of a real CT."""
    one = pydicom.dcmread(pydicom.data.get_testdata_file("CT_small.dcm"))
    noise = numpy.random.default_rng(1)
    y, x = numpy.mgrid[0:512, 0:512]
    one.Rows = one.Columns = 512
    one.PixelSpacing = [0.7, 0.7]
    one.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    del one[0x00280120]
    for z in range(slices):
        data = ((x - 256) ** 2 + (y - 256) ** 2 < (150 + z / 4) ** 2) * 1000
        one.ImagePositionPatient = [-180, -180, z * 0.8]
        one.SOPInstanceUID = one.file_meta.MediaStorageSOPInstanceUID = "1.2.3.%d" % z
        one.PixelData = (data + noise.integers(0, 60, (512, 512))).astype("<i2").tobytes()
        one.save_as(os.path.join(folder, "%04d" % (z * 37 % 997)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--slices", type=int, default=400)
    parser.add_argument("build")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        make_series(folder, options.slices)
        took = []
        for _ in range(3):
            begun = time.monotonic()
            run([os.path.join(options.build, "iftty"), "-c", "open " + folder])
            took.append(time.monotonic() - begun)
    print("a series of %d slices of 512x512: %.2f s" % (options.slices, statistics.median(took)))


leave_by(main)
