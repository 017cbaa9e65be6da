# SPDX-License-Identifier: MIT
"""scipy.ndimage.watershed_ift or skimage.segmentation.watershed as a worker (tests/peers/worker.h
describes the requests): python_worker.py scipy|skimage FOLDER. Each gets its maps in the types that
it works with, so that no conversion is timed that it does not require."""

import sys
import time

import numpy


def scipy_watershed():
    from scipy.ndimage import watershed_ift

    # Six neighbours are its default. Its cost of a step is the difference of the two voxels.
    return numpy.int16, lambda gradient, markers: watershed_ift(gradient, markers)


def skimage_watershed():
    from skimage.segmentation import watershed

    return numpy.int32, lambda gradient, markers: watershed(gradient, markers, connectivity=1)


def main():
    kinds = {"scipy": scipy_watershed, "skimage": skimage_watershed}
    marker_type, segment = kinds[sys.argv[1]]()
    folder = sys.argv[2]
    with open(folder + "/size", encoding="ascii") as file:
        *size, bits = (int(word) for word in file.read().split())
    shape = tuple(reversed(size))
    image = numpy.fromfile(folder + "/gradient.u16", numpy.uint16).reshape(shape)
    image = image.astype(numpy.uint8 if bits == 8 else numpy.uint16)
    markers = labels = None
    for line in sys.stdin:
        request, _, path = line.strip().partition(" ")
        answer = "ok"
        if request == "markers":
            markers = numpy.fromfile(path, numpy.uint8).reshape(shape).astype(marker_type)
        elif request == "run":
            begin = time.process_time(), time.perf_counter()
            labels = segment(image, markers)
            end = time.process_time(), time.perf_counter()
            answer += " run=%.6f,%.6f" % tuple((e - b) * 1e3 for b, e in zip(begin, end))
        elif request == "labels":
            labels.astype(numpy.uint8).tofile(path)
        elif request != "reset":
            answer = "cannot do that"
        print(answer, flush=True)


main()
