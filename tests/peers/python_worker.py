# SPDX-License-Identifier: MIT
"""scipy.ndimage.watershed_ift, skimage.segmentation.watershed or its random_walker as a worker
(tests/peers/worker.h tells the requests): python_worker.py scipy|skimage|walker FOLDER. Each gets
its maps in the types that it works with, so that no conversion is timed that it does not insist on.
"""

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


def walker():
    from skimage.segmentation import random_walker

    # Its defaults, by conjugate gradients with Jacobi's preconditioner; of the image itself.
    return numpy.int32, lambda image, markers: random_walker(image, markers, mode="cg_j")


def main():
    kinds = {"scipy": scipy_watershed, "skimage": skimage_watershed, "walker": walker}
    marker_type, segment = kinds[sys.argv[1]]()
    reads = "/image.u8" if sys.argv[1] == "walker" else "/gradient.u8"
    folder = sys.argv[2]
    with open(folder + "/size", encoding="ascii") as file:
        shape = tuple(int(side) for side in reversed(file.read().split()))
    image = numpy.fromfile(folder + reads, numpy.uint8).reshape(shape)
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
