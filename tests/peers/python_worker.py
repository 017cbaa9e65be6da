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
        shape = tuple(int(side) for side in reversed(file.read().split()))
    image = numpy.fromfile(folder + "/gradient.u8", numpy.uint8).reshape(shape)
    markers = labels = None
    for line in sys.stdin:
        request, _, path = line.strip().partition(" ")
        answer = "ok"
        if request == "markers":
            markers = numpy.fromfile(path, numpy.uint8).reshape(shape).astype(marker_type)
        elif request == "run":
            begin = time.process_time()
            labels = segment(image, markers)
            answer = "%.6f" % ((time.process_time() - begin) * 1e3)
        elif request == "labels":
            labels.astype(numpy.uint8).tofile(path)
        elif request != "reset":
            answer = "cannot do that"
        print(answer, flush=True)


main()
