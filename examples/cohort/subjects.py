#!/usr/bin/python3 -B
# SPDX-License-Identifier: MIT
"""Subjects whose truth is known: a scene, deformed anew for each of them.

    subjects.py [options] SCENE LABELS OUT

LABELS is a map of SCENE's objects on its grid, as `save labels` writes it. Each subject is both of
them, pulled through one and the same transform:

    place in SCENE = affine(place in the subject) + displacement(place in the subject)

- The displacement is smooth noise. Millimetres of --elastic are its root mean square along an axis,
  over the head (the voxels above a tenth of the brightest): 5.2 mm of length at 3, 8.7 at 5. The
  sidecar has the largest, and the least Jacobian determinant, which is above 0: nothing folds.
- --affine: turned by up to 8 degrees about each axis, scaled by up to 8 % along each, sheared by up
  to 0.04 and moved by up to 8 mm, about the middle of the head.
- --bias: a smooth field of up to so many per cent, and --noise: of so many per cent of the
  brightest, as magnitudes have it (Rician). --gain: values are those of SCENE times this.
- --reduce: voxels N times as long, each the mean of what it has in it, or its most frequent label.

The same options and seed give the same bytes. Files appear whole or not at all:

    OUT/sub-01/anat/sub-01_T1w.nii.gz and .json, participants.tsv, dataset_description.json
    OUT/derivatives/truth/sub-01/anat/sub-01_desc-truth_dseg.nii.gz and .json

Exit status: 0 fine, 2 bad usage, 3 a file cannot be read or written.
"""
import argparse
import gzip
import json
import os
import sys
import zlib

import nibabel
import numpy
from scipy import ndimage

from whole import write_whole

STEP_MM = 4  # between the places where a displacement is drawn; the rest lies between them
SMOOTH_MM = 24  # the standard deviation of what smooths it


def write_json(path, what):
    write_whole(path, (json.dumps(what, indent=2, sort_keys=True) + "\n").encode())


def write_volume(path, voxels, affine):
    """Without the time in gzip's header, so that the same volume has the same bytes."""
    image = nibabel.Nifti1Image(voxels, affine)
    image.set_sform(affine, 1)
    image.set_qform(affine, 1)
    image.header.set_xyzt_units("mm")
    write_whole(path, gzip.compress(image.to_bytes(), 6, mtime=0))


def smooth_noise(random, count, shape, spacing):
    """So many fields over a grid of millimetres, each smooth and about as large everywhere."""
    step = [max(1, int(round(STEP_MM / s))) for s in spacing]
    coarse = [n // k + 2 for n, k in zip(shape, step)]
    sigma = [SMOOTH_MM / (s * k) for s, k in zip(spacing, step)]
    at = numpy.ogrid[tuple(slice(0, n) for n in shape)]
    for _ in range(count):
        field = ndimage.gaussian_filter(random.standard_normal(coarse), sigma, mode="wrap")
        for axis, k in enumerate(step):
            place = at[axis].ravel() / k
            low = place.astype(int)
            part = (place - low).reshape([-1 if a == axis else 1 for a in range(3)])
            field = (numpy.take(field, low, axis) * (1 - part) +
                     numpy.take(field, low + 1, axis) * part)
        yield field.astype(numpy.float32)


def draw_affine(random):
    """Millimetres about the middle of the head: subject to scene."""
    turn = numpy.eye(3)
    for axis, angle in enumerate(numpy.radians(random.uniform(-8, 8, 3))):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        about = numpy.eye(3)
        about[i, i] = about[j, j] = numpy.cos(angle)
        about[j, i], about[i, j] = numpy.sin(angle), -numpy.sin(angle)
        turn = about @ turn
    scale = numpy.diag(1 + random.uniform(-0.08, 0.08, 3))
    scale[numpy.triu_indices(3, 1)] = random.uniform(-0.04, 0.04, 3)
    return turn @ scale, random.uniform(-8, 8, 3)


def least_determinant(field, spacing, linear):
    """Of the Jacobian of x -> linear x + field(x), each other voxel."""
    jacobian = numpy.empty(tuple((n + 1) // 2 for n in field[0].shape) + (3, 3), numpy.float32)
    for i in range(3):
        along = numpy.gradient(field[i][::2, ::2, ::2], *(2 * s for s in spacing))
        for j in range(3):
            jacobian[..., i, j] = along[j] + linear[i, j]
    return float(numpy.linalg.det(jacobian).min())


def reduced(voxels, by):
    cut = voxels[tuple(slice(0, n // by * by) for n in voxels.shape)]
    shape = [k for n in cut.shape for k in (n // by, by)]
    return cut.reshape(shape).mean((1, 3, 5))


def make_subject(options, scene, labels, number):
    """The image and its truth, on the subject's grid, and what the sidecar says."""
    random = numpy.random.default_rng([options.seed, number])
    voxels = numpy.asanyarray(scene.dataobj).astype(numpy.float32)
    truth = numpy.asanyarray(labels.dataobj)
    to_mm = scene.affine
    spacing = numpy.sqrt((to_mm[:3, :3] ** 2).sum(0))
    brightest = float(voxels.max())
    head = voxels > brightest / 10
    shape = voxels.shape

    linear, move = numpy.eye(3), numpy.zeros(3)
    if options.affine:
        linear, move = draw_affine(random)
    field = numpy.array(list(smooth_noise(random, 3, shape, spacing)))
    length = numpy.sqrt((field ** 2).sum(0))
    factor = options.elastic / float(numpy.sqrt((length[head] ** 2).mean() / 3))
    field *= factor
    determinant = least_determinant(field, spacing, linear)
    if determinant <= 0:
        raise ValueError("a deformation of %g mm folds; give a smaller --elastic" %
                         options.elastic)

    middle = to_mm[:3, :3] @ numpy.argwhere(head).mean(0) + to_mm[:3, 3]
    back = numpy.linalg.inv(to_mm)
    matrix = back[:3, :3] @ linear @ to_mm[:3, :3]
    offset = back[:3, :3] @ (linear @ (to_mm[:3, 3] - middle) + middle + move) + back[:3, 3]
    at = numpy.ogrid[tuple(slice(0, n) for n in shape)]
    place = [sum(matrix[i, j] * at[j] for j in range(3)) + offset[i] +
             sum(back[i, j] * field[j] for j in range(3)) for i in range(3)]
    place = numpy.array(place, numpy.float32)
    voxels = ndimage.map_coordinates(voxels, place, order=1, mode="constant")
    truth = ndimage.map_coordinates(truth, place, order=0, mode="constant")

    if options.reduce > 1:
        by, values = options.reduce, numpy.unique(truth)
        voxels = reduced(voxels, by)
        truth = values[numpy.argmax([reduced(truth == value, by) for value in values], 0)]
        to_mm = to_mm @ numpy.diag([by, by, by, 1.])
        to_mm[:3, 3] += scene.affine[:3, :3] @ numpy.full(3, (by - 1) / 2)
        spacing = spacing * by
    if options.bias:
        bias, = smooth_noise(random, 1, voxels.shape, spacing)
        voxels = voxels * (1 + options.bias / 100 * bias / numpy.abs(bias).max())
    if options.noise:
        sigma = options.noise / 100 * brightest
        real, imaginary = random.normal(0, sigma, (2,) + voxels.shape)
        voxels = numpy.sqrt((voxels + real) ** 2 + imaginary ** 2)
    voxels = numpy.clip(numpy.rint(voxels * options.gain), 0, 32767).astype(numpy.int16)
    about = {"Sources": [os.path.basename(options.scene)],
             "ElasticRmsMillimetresPerAxis": options.elastic,
             "ElasticMostMillimetres": round(float(length[head].max()) * factor, 3),
             "LeastJacobianDeterminant": round(determinant, 4),
             "Affine": numpy.round(numpy.column_stack([linear, move]), 6).tolist(),
             "NoisePercent": options.noise, "BiasPercent": options.bias, "Gain": options.gain,
             "Seed": options.seed, "SourceCrc32": "%08x" % zlib.crc32(head.tobytes())}
    return voxels, truth, to_mm, about


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--only", type=int, metavar="N", help="the Nth subject alone")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--elastic", type=float, default=3, metavar="MM")
    parser.add_argument("--affine", action="store_true")
    parser.add_argument("--noise", type=float, default=0, metavar="PERCENT")
    parser.add_argument("--bias", type=float, default=0, metavar="PERCENT")
    parser.add_argument("--gain", type=float, default=1)
    parser.add_argument("--reduce", type=int, default=1, metavar="N")
    for word in "scene", "labels", "out":
        parser.add_argument(word)
    options = parser.parse_args()
    if options.reduce < 1 or options.count < 1 or options.elastic < 0 or options.gain <= 0:
        parser.error("--count and --reduce are 1 or more, --elastic is not negative, --gain is "
                     "above 0")
    try:
        scene, labels = nibabel.load(options.scene), nibabel.load(options.labels)
        if scene.shape != labels.shape or not numpy.allclose(scene.affine, labels.affine):
            raise ValueError("%s and %s are not on one grid" % (options.scene, options.labels))
        truth = os.path.join(options.out, "derivatives", "truth")
        for number in [options.only] if options.only else range(1, options.count + 1):
            name = "sub-%02d" % number
            image, map_, to_mm, about = make_subject(options, scene, labels, number)
            mask = os.path.join(truth, name, "anat", name + "_desc-truth_dseg")
            path = os.path.join(options.out, name, "anat", name + "_T1w")
            for folder in os.path.dirname(mask), os.path.dirname(path):
                os.makedirs(folder, exist_ok=True)
            write_volume(mask + ".nii.gz", map_.astype(numpy.uint8), to_mm)
            write_json(mask + ".json", {"Manual": False, "Sources": [
                os.path.basename(options.labels)]})
            write_json(path + ".json", about)
            write_volume(path + ".nii.gz", image, to_mm)  # last: who waits for it has the rest
            print(path + ".nii.gz", flush=True)
        for folder, kind in (options.out, "raw"), (truth, "derivative"):
            write_json(os.path.join(folder, "dataset_description.json"), {
                "Name": "deformed copies of one scene", "BIDSVersion": "1.8.0",
                "DatasetType": kind, "GeneratedBy": [{"Name": "subjects.py"}]})
        people = sorted(n for n in os.listdir(options.out) if n.startswith("sub-"))
        write_whole(os.path.join(options.out, "participants.tsv"),
                    "\n".join(["participant_id"] + people + [""]).encode())
    except (OSError, ValueError, EOFError, zlib.error, nibabel.filebasedimages.ImageFileError) as e:
        print("subjects.py: %s" % e, file=sys.stderr)
        sys.exit(3)


main()
