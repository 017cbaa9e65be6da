# SPDX-License-Identifier: MIT
"""How true pictures are: shapes whose picture is known, as iftty and VTK draw their voxels. The
second half of `make bench-beside`.

Shapes at random places, in the voxels whose middles they hold, seen from random sides: balls of
radius 1 to 8, a torus, a tree of vessels (radius 0.8 to 3), round sheets of 1, 2 and 3 voxels, and
a ball of three regions, as they meet in an atlas. iftty opens the voxels as `labels` and renders
them as EXR, whose matrices say where each ray is; VTK draws the surfaces of vtk_render.py (windowed
sinc, 20 times, pass band 0.1), which stores what each pixel shows; and rays are followed to the
shape itself.

For each, mean and 95 % of all places:

- silhouette, in pixels: from each border between pixels of other labels, the background too, to
  that of the shape's own picture with 8x8 samples a pixel, and no more than FAR. What rays alone
  make of it, one a pixel, are the rows "rays".
- normals, in degrees, and depth, in voxels, where both the picture and the shape show something;
  of a sheet 3 voxels or more from its rim. VTK's normals are colours of 8 bits, off by up to 0.4.

FOLDER/truth-SHAPE.png is the last place by iftty, VTK and the shape itself, in one light."""

import math
import os
import re
import struct
import sys
import tempfile
import zlib

import numpy

from programs import Broken, run

VTK = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "peers", "vtk_render.py")
SIDE, ZOOM, PLACES = 48, 8, 4
SAMPLES, FAR = 8, 6  # of the shape's picture along a pixel; pixels
CLOSE, STEPS, END = 1e-4, 300, 300
TINTS = (0, 0, 0), (1, 1, 1), (0.6, 0.8, 1), (1, 0.75, 0.5)
VTK_SMOOTH = "20", "0.1"


# ---- shapes ----


class Shape:
    """What is inside where away(p) < 0: no point of it is nearer to p than that, in voxels."""

    def away(self, p):
        raise NotImplementedError

    def label(self, p):
        return numpy.ones(len(p), numpy.uint8)

    def is_judged(self, p):
        """Whether the normal and depth there are looked at."""
        return numpy.ones(len(p), bool)


def length(p):
    return numpy.sqrt((p * p).sum(1))


class Balls(Shape):
    def __init__(self, rng, side, radii=(8, 5, 3.2, 2.4, 1.5, 1)):
        self.balls = []
        while len(self.balls) < len(radii):
            radius = radii[len(self.balls)] * min(1, side / SIDE)
            middle = rng.uniform(radius + 4, side - radius - 5, 3)
            if all(math.dist(middle, m) > radius + r + 4 for m, r in self.balls):
                self.balls.append((middle, radius))

    def away(self, p):
        return numpy.min([length(p - middle) - radius for middle, radius in self.balls], 0)


class Torus(Shape):
    def __init__(self, rng, side):
        self.middle = side / 2 + rng.uniform(-1, 1, 3)
        self.turn = numpy.linalg.qr(rng.normal(size=(3, 3)))[0]
        self.radii = side * 0.29, side * 0.09

    def away(self, p):
        p = (p - self.middle) @ self.turn
        return numpy.hypot(numpy.hypot(p[:, 0], p[:, 1]) - self.radii[0], p[:, 2]) - self.radii[1]


class Tree(Shape):
    """Branches with round ends; each has two, thinner and shorter by a quarter."""

    def __init__(self, rng, side):
        self.branches, self.inside = [], False
        while not self.inside:
            self.branches, self.inside = [], True
            self.grow(rng, numpy.array([side / 2, side / 2, 7]) + rng.uniform(0, 1, 3),
                      numpy.array([0, 0, 1]), 3 * side / SIDE, 0.2 * side, side)

    def grow(self, rng, begin, along, radius, far, side):
        end = begin + far * along
        self.inside &= min(end) > radius + 3 and max(end) < side - radius - 4
        self.branches.append((begin, end, radius))
        for _ in range(2 if radius * 0.75 > 0.8 else 0):
            turned = along + rng.normal(size=3) * 0.5
            self.grow(rng, end, turned / math.hypot(*turned), radius * 0.75, far * 0.75, side)

    def away(self, p):
        least = numpy.full(len(p), numpy.inf)
        for begin, end, radius in self.branches:
            axis, q = end - begin, p - begin
            t = numpy.clip(q @ axis / (axis @ axis), 0, 1)
            least = numpy.minimum(least, length(q - t[:, None] * axis) - radius)
        return least


class Sheet(Shape):
    def __init__(self, rng, side, thickness):
        self.middle = side / 2 + rng.uniform(-1, 1, 3)
        self.along = rng.normal(size=3)
        self.along /= math.hypot(*self.along)
        self.radius, self.half = side * 0.4, thickness / 2

    def parts(self, p):
        p = p - self.middle
        d = p @ self.along
        return numpy.abs(d) - self.half, length(p - d[:, None] * self.along) - self.radius

    def away(self, p):
        return numpy.maximum(*self.parts(p))

    def is_judged(self, p):
        return self.parts(p)[1] < -3


class Junction(Shape):
    """Three regions that meet in a line through a ball, at any angles."""

    def __init__(self, rng, side):
        self.middle = side / 2 + rng.uniform(-1, 1, 3)
        self.turn = numpy.linalg.qr(rng.normal(size=(3, 3)))[0]
        self.radius = side * 0.38
        self.ends = numpy.cumsum([0] + [2 * math.pi * part for part in (0.25, 0.4)])

    def away(self, p):
        return length(p - self.middle) - self.radius

    def label(self, p):
        p = (p - self.middle) @ self.turn
        angle = numpy.arctan2(p[:, 1], p[:, 0]) % (2 * math.pi)
        return numpy.searchsorted(self.ends, angle, "right").astype(numpy.uint8)


SHAPES = {
    "balls": Balls,
    "torus": Torus,
    "tree": Tree,
    "sheet-1": lambda rng, side: Sheet(rng, side, 1),
    "sheet-2": lambda rng, side: Sheet(rng, side, 2),
    "sheet-3": lambda rng, side: Sheet(rng, side, 3),
    "junction": Junction,
}


# ---- files ----


def write_voxels(path, shape, side):
    """A NIfTI of the labels, 1 mm, voxel 0,0,0 at the world's origin."""
    z, y, x = numpy.indices((side, side, side)).reshape(3, -1).astype(float)
    p = numpy.column_stack([x, y, z])
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, side, side, side, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 2, 8)
    struct.pack_into("<9f", head, 76, 1, 1, 1, 1, 0, 0, 0, 0, 352)
    head[123] = 2
    struct.pack_into("<2h", head, 252, 0, 1)
    struct.pack_into("<12f", head, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
    head[344:348] = b"n+1\0"
    with open(path, "wb") as file:
        file.write(head + numpy.where(shape.away(p) < 0, shape.label(p), 0).astype("u1").tobytes())


EXR_TYPES = "<u4", "<f2", "<f4"


def read_exr(path):
    """Attributes as bytes, and channels as arrays: of a file of lines, packed by ZIP or not."""
    with open(path, "rb") as file:
        data = file.read()
    at, attributes = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)[:2] + [None]
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    channels, listed = [], attributes["channels"]
    while listed[0]:
        name = listed.split(b"\0", 1)[0]
        kind = struct.unpack_from("<i", listed, len(name) + 1)[0]
        channels.append((name.decode(), numpy.dtype(EXR_TYPES[kind])))
        listed = listed[len(name) + 17 :]
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    rows = 16 if attributes["compression"][0] == 3 else 1
    planes = {name: numpy.empty((height, width), kind) for name, kind in channels}
    line = sum(kind.itemsize for _, kind in channels) * width
    for first in range(0, height, rows):
        chunk = struct.unpack_from("<Q", data, at + 1 + first // rows * 8)[0]
        size = struct.unpack_from("<i", data, chunk + 4)[0]
        count = min(rows, height - first)
        block = data[chunk + 8 : chunk + 8 + size]
        if size < line * count:
            block = numpy.frombuffer(zlib.decompress(block), "u1").astype(numpy.uint32)
            block[1:] += 128
            block = (numpy.cumsum(block) & 255).astype("u1")
            halves = block[: (len(block) + 1) // 2], block[(len(block) + 1) // 2 :]
            block = numpy.empty(len(block), "u1")
            block[::2], block[1::2] = halves
            block = block.tobytes()
        for row in range(count):
            offset = row * line
            for name, kind in channels:
                planes[name][first + row] = numpy.frombuffer(block, kind, width, offset)
                offset += width * kind.itemsize
    return attributes, planes


class Picture:
    """Labels, 0 where nothing is seen; normals towards the viewer; depth along the rays in mm."""

    def __init__(self, label, normal, depth):
        self.label, self.normal, self.depth = label, normal, depth


def draw_by_iftty(build, folder, angles, pixels):
    """Its picture, and the matrix from the world to pixels and depth: points are rows."""
    script = ["open voxels.nii", "labels voxels.nii", "size %d %d" % (pixels, pixels),
              "zoom %d" % ZOOM, "view %.3f %.3f %.3f" % angles, "render picture.exr", ""]
    with open(os.path.join(folder, "script"), "w") as file:
        file.write("\n".join(script))
    run([os.path.join(os.path.abspath(build), "iftty"), "run", "script"], folder)
    attributes, planes = read_exr(os.path.join(folder, "picture.exr"))
    matrix = numpy.frombuffer(attributes["worldToNDC"], "<f4").reshape(4, 4).astype(float)
    matrix[:, :2] *= pixels
    normal = numpy.stack([planes["N." + axis] for axis in "XYZ"], -1).astype(float)
    return Picture(planes["label"], normal, planes["Z"].astype(float)), matrix


def draw_by_vtk(folder, angles, pixels, matrix):
    """Its picture, or None where VTK is not here."""
    try:
        run([sys.executable, VTK, "voxels.nii", "--maps", "maps", "--size", str(pixels),
             str(pixels), "--zoom", str(ZOOM), "--angles", *("%.3f" % angle for angle in angles),
             "--smooth", *VTK_SMOOTH], folder)
    except Broken as error:
        if "apt-get install" in str(error):
            return None
        raise
    with open(os.path.join(folder, "maps"), "rb") as file:
        maps = numpy.frombuffer(file.read(), "<f4").reshape(5, pixels, pixels).astype(float)
    middle = numpy.append(numpy.full(3, (struct.unpack("<h", read_side(folder))[0] - 1) / 2), 1)
    return Picture(maps[0].astype(int), numpy.moveaxis(maps[1:4], 0, -1),
                   maps[4] + (middle @ matrix)[2])


def read_side(folder):
    with open(os.path.join(folder, "voxels.nii"), "rb") as file:
        return file.read(44)[42:]


# ---- the shape itself ----


def follow(shape, matrix, x, y):
    """What rays at places of the picture meet: points, and whether they meet anything."""
    back = numpy.linalg.inv(matrix)
    ahead = back[2, :3] / math.hypot(*back[2, :3])
    p = (numpy.column_stack([x, y, numpy.zeros(len(x)), numpy.ones(len(x))]) @ back)[:, :3]
    gone, live = numpy.zeros(len(x)), numpy.arange(len(x))
    met = numpy.zeros(len(x), bool)
    for _ in range(STEPS):
        away = shape.away(p[live] + gone[live, None] * ahead)
        gone[live] += numpy.maximum(away, CLOSE)
        met[live[away < CLOSE]] = True
        live = live[(away >= CLOSE) & (gone[live] < END)]
        if not len(live):
            break
    return p + gone[:, None] * ahead, met


def normals_at(shape, p):
    step = 1e-3 * numpy.eye(3)
    slope = numpy.column_stack([shape.away(p + s) - shape.away(p - s) for s in step])
    return slope / numpy.maximum(length(slope), 1e-30)[:, None]


def draw_truth(shape, matrix, pixels):
    """Its picture; where its rays meet it; and the borders of its labels with SAMPLES a pixel."""
    y, x = numpy.indices((pixels, pixels)).reshape(2, -1) + 0.5
    p, met = follow(shape, matrix, x, y)
    label = numpy.where(met, shape.label(p), 0).reshape(pixels, pixels)
    depth = (numpy.column_stack([p, numpy.ones(len(p))]) @ matrix)[:, 2]
    normal = normals_at(shape, p)
    near = numpy.zeros((pixels, pixels), bool)
    near[:-1] |= label[:-1] != label[1:]
    near[:, :-1] |= label[:, :-1] != label[:, 1:]
    for axis in 0, 1:
        near = near | numpy.roll(near, 1, axis) | numpy.roll(near, -1, axis)
    fine = numpy.kron(label, numpy.ones((SAMPLES, SAMPLES), numpy.uint8))
    rows, columns = numpy.nonzero(numpy.kron(near, numpy.ones((SAMPLES, SAMPLES), bool)))
    q, met = follow(shape, matrix, (columns + 0.5) / SAMPLES, (rows + 0.5) / SAMPLES)
    fine[rows, columns] = numpy.where(met, shape.label(q), 0)
    shown = Picture(label, normal.reshape(pixels, pixels, 3), depth.reshape(pixels, pixels))
    return shown, p.reshape(pixels, pixels, 3), fine


# ---- figures ----


def borders(label):
    """The middles of sides between pixels of other labels, in half pixels: rows, columns."""
    y, x = numpy.nonzero(numpy.diff(label.astype(int), axis=0))
    v, u = numpy.nonzero(numpy.diff(label.astype(int), axis=1))
    return numpy.concatenate([2 * y + 2, 2 * v + 1]), numpy.concatenate([2 * x + 1, 2 * u + 2])


def silhouette_errors(label, fine):
    """From each border of a picture to the nearest of the fine one, in pixels; FAR at most."""
    unit, pad = 2 * SAMPLES, 2 * SAMPLES * FAR  # half samples
    drawn = numpy.zeros([2 * n + 1 + 2 * pad for n in fine.shape], bool)
    y, x = borders(fine)
    drawn[y + pad, x + pad] = True
    y, x = (places * SAMPLES + pad for places in borders(label))
    far = numpy.full(len(y), float(FAR))
    span = numpy.arange(-pad, pad + 1)
    offsets = numpy.stack(numpy.meshgrid(span, span, indexing="ij"), -1).reshape(-1, 2)
    square = (offsets**2).sum(1)
    live = numpy.arange(len(y))
    for i in numpy.argsort(square, kind="stable"):
        if not len(live) or square[i] > pad * pad:
            break
        found = drawn[y[live] + offsets[i, 0], x[live] + offsets[i, 1]]
        far[live[found]] = math.sqrt(square[i]) / unit
        live = live[~found]
    return far


def errors_of(shown, truth, points, fine, shape):
    both = (shown.label > 0) & (truth.label > 0)
    both[both] = shape.is_judged(points[both])
    cosine = (shown.normal[both] * truth.normal[both]).sum(1)
    cosine /= numpy.maximum(1e-30, length(shown.normal[both]) * length(truth.normal[both]))
    return (silhouette_errors(shown.label, fine),
            numpy.degrees(numpy.arccos(numpy.clip(cosine, -1, 1))),
            numpy.abs(shown.depth[both] - truth.depth[both]))


def lit(shown, matrix):
    """Labels and normals in a light from the viewer's right and above, as bytes of RGB."""
    axes = numpy.linalg.inv(matrix)[:3, :3]
    axes /= numpy.sqrt((axes * axes).sum(1))[:, None]
    light = numpy.array([0.37, -0.5, -0.78]) @ axes
    tone = 40 + 200 * numpy.clip(shown.normal @ light, 0, 1)
    return (tone[:, :, None] * numpy.array(TINTS)[shown.label]).astype(numpy.uint8)


def measure(build, name, out, places, side):
    """Rows: who drew, and mean and 95 % of each error."""
    from PIL import Image

    rng = numpy.random.default_rng(sorted(SHAPES).index(name))
    pixels = side * ZOOM
    errors = {}
    for _ in range(places):
        shape = SHAPES[name](rng, side)
        angles = rng.uniform(0, 359), rng.uniform(-60, 60) % 360, rng.uniform(0, 359)
        with tempfile.TemporaryDirectory() as folder:
            write_voxels(os.path.join(folder, "voxels.nii"), shape, side)
            by_iftty, matrix = draw_by_iftty(build, folder, angles, pixels)
            by_vtk = draw_by_vtk(folder, angles, pixels, matrix)
        truth, points, fine = draw_truth(shape, matrix, pixels)
        pictures = {"rays": truth, "iftty": by_iftty, "VTK": by_vtk}
        for maker, shown in pictures.items():
            if shown:
                errors.setdefault(maker, []).append(errors_of(shown, truth, points, fine, shape))
    panes = [lit(pictures[maker], matrix) for maker in ("iftty", "VTK", "rays") if pictures[maker]]
    Image.fromarray(numpy.hstack(panes)).save(os.path.join(out, "truth-%s.png" % name))
    for maker, each in errors.items():
        figures = [numpy.concatenate(kind) for kind in zip(*each)]
        yield maker, [(k.mean(), numpy.percentile(k, 95)) if len(k) else (0, 0) for k in figures]


def print_table(build, only, out, places, side):
    names = [name for name in SHAPES if only in "truth-" + name]
    if names:
        print("\n%-18s %18s %18s %18s\n%-18s" % ("", "silhouette, pixels", "normals, degrees",
                                                "depth, voxels", "shape, drawn by")
              + 3 * "     mean     95 %")
    for name in names:
        for maker, figures in measure(build, name, out, places, side):
            cells = ["%9.3f%9.3f" % pair for pair in figures]
            if maker == "rays":
                cells = cells[:1]
            print("%-18s %s" % ("%s, %s" % (name, maker), " ".join(cells)), flush=True)
