# SPDX-License-Identifier: MIT
"""VTK in software on a label map that iftty saved: what a surface takes after the labels have
changed, what a turn takes, and the same labels as a picture.

    vtk_render.py LABELS.nii[.gz] [--size W H] [--angles YAW PITCH ROLL] [--zoom PIXELS]
                  [--rounds N] [--colours 1=#d6b296,2=#56b4e9] [--opacity 1=25,2=50] [--at X,Y,Z]
                  [--background #ffffff|gradient] [--smooth TIMES BAND] [--occlusion MM]
                  [--png FILE]

LABELS is what `save labels FILE` writes. Size, angles (degrees), zoom (pixels to a voxel of the
finest spacing) and at (the voxel in the middle) are those of iftty's `size`, `view` and `zoom`, and
so are opacity (percent), background and light. Occlusion is VTK's own, in the space of the screen,
of what is so near.

Without --png, each line printed is one JSON object:

    {"what": "versions", "vtk": ..., "mesa": ..., "renderer": ..., "smp": ..., "threads": ...}
    {"what": "label change, flying edges", "median_ms": ..., "least_ms": ..., "most_ms": ...,
     "surface_ms": ..., "rounds": N, "triangles": N}
    {"what": "label change, marching cubes", ...}
    {"what": "rotation", ...}
    {"what": "label change, smoothed, with normals", ...}
    {"what": "rotation, smoothed, with normals", ...}

A label change gives the voxels of a ball of radius 3 at the surface another label, or takes that
back; timed is all that follows until the picture is finished: the surface of every label, and the
picture. `surface_ms` is the median of the surface alone. A rotation is three degrees of yaw, and
the picture alone. Times are of the wall clock, on the cores that the process may run on
(taskset -c 0 makes it one).

Surfaces are as they come out of the filter in the first three rows. In the last two, and with
--png, they are those of flying edges, smoothed (windowed sinc, 20 iterations, pass band 0.1, or
what --smooth says) and with normals. With --png they are shaded by Phong's model with iftty's
coefficients, what is translucent by depth peeling, and written to FILE; nothing is timed.

Debian 12 has VTK 9.1 as python3-vtk9, which /usr/bin/python3 sees. Its windows are those of X even
off the screen, so this runs itself again under xvfb-run where there is no DISPLAY: packages
python3-vtk9 and xvfb. Mesa draws in software (llvmpipe); a GPU is not used.

Exit status: 0 fine, 2 bad usage, 3 bad input, or VTK or Xvfb is not there."""

import argparse
import gzip
import json
import math
import os
import shutil
import statistics
import struct
import sys
import time

RADIUS = 3  # of the ball that a label change is about, voxels
PALETTE = ["#d6b296", "#56b4e9", "#f0c842", "#009e73", "#cc79a7", "#e68228", "#8282dc", "#bebebe"]
AMBIENT, DIFFUSE, SPECULAR, SHINE = 0.2, 0.8, 70 / 255, 32
LIGHT_YAW, LIGHT_PITCH = -25, 30  # to the viewer's right, and above him
GRADIENT = "#3e4652", "#14161a"  # at the top, at the bottom
AWAY = 1000  # mm from the camera to what it looks at
PEELS = 30  # of what is translucent, at most


class Broken(Exception):
    pass


# ---- labels ----


def affine_of(header, order):
    """Rows that lead from voxels to the patient's Right, Anterior, Superior."""
    qform, sform = struct.unpack(order + "2h", header[252:256])
    pixdim = struct.unpack(order + "8f", header[76:108])
    if sform > 0:
        return [struct.unpack(order + "4f", header[i : i + 16])[:3] for i in (280, 296, 312)]
    if qform <= 0:
        return [[pixdim[1], 0, 0], [0, pixdim[2], 0], [0, 0, pixdim[3]]]
    b, c, d = struct.unpack(order + "3f", header[256:268])
    a = math.sqrt(max(0, 1 - b * b - c * c - d * d))
    side = [pixdim[1], pixdim[2], pixdim[3] * (-1 if pixdim[0] < 0 else 1)]
    turn = [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
    ]
    return [[turn[w][i] * side[i] for i in range(3)] for w in range(3)]


def nearest_axes(affine):
    """For each of the patient's axes the voxel axis that runs along it, and whether forwards."""
    best, chosen = -1, None
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        fit = 1
        for world in range(3):
            column = [affine[w][order[world]] for w in range(3)]
            fit *= abs(affine[world][order[world]]) / math.sqrt(sum(v * v for v in column))
        if fit > best:
            best, chosen = fit, order
    return [(axis, affine[world][axis] > 0) for world, axis in enumerate(chosen)]


def read_labels(path):
    """Labels [superior][anterior][right], the spacing along right, anterior, superior in mm, and
    the voxel axis that runs along each of them, and whether forwards."""
    import numpy

    opener = gzip.open if path.endswith(".gz") else open
    try:
        with opener(path, "rb") as file:
            data = file.read()
    except (OSError, EOFError) as error:
        raise Broken("cannot read %s: %s" % (path, error))
    if len(data) < 352 or data[344:348] != b"n+1\0":
        raise Broken("%s is no NIfTI-1 file of one part" % path)
    order = "<" if struct.unpack("<i", data[:4])[0] == 348 else ">"
    dim = struct.unpack(order + "8h", data[40:56])
    datatype = struct.unpack(order + "h", data[70:72])[0]
    pixdim = struct.unpack(order + "8f", data[76:108])
    first = int(struct.unpack(order + "f", data[108:112])[0])
    voxels = dim[1] * dim[2] * dim[3]
    if datatype != 2 or min(dim[1:4]) < 1 or len(data) < first + voxels:
        raise Broken("%s: expected a volume of uint8, whole" % path)
    labels = numpy.frombuffer(data, numpy.uint8, voxels, first).reshape(dim[3], dim[2], dim[1])
    axes = nearest_axes(affine_of(data, order))
    labels = labels.transpose([2 - axes[world][0] for world in (2, 1, 0)])
    labels = labels[tuple(slice(None, None, 1 if axes[w][1] else -1) for w in (2, 1, 0))]
    spacing = [abs(pixdim[1 + axis]) for axis, _ in axes]
    return numpy.ascontiguousarray(labels), spacing, axes


# ---- the scene in VTK ----


def image_of(labels, spacing):
    """The labels as VTK's image, which shares their memory."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    image.SetDimensions(labels.shape[2], labels.shape[1], labels.shape[0])
    image.SetSpacing(spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(labels.reshape(-1)))
    return image


def surface_filter(kind, image, values):
    from vtkmodules import vtkFiltersGeneral

    surface = getattr(vtkFiltersGeneral, kind)()
    surface.SetInputData(image)
    for i, value in enumerate(values):
        surface.SetValue(i, value)
    surface.ComputeGradientsOff()
    surface.ComputeNormalsOff()
    return surface


def smoothed(surface, times, band):
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkWindowedSincPolyDataFilter

    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(surface.GetOutputPort())
    smooth.SetNumberOfIterations(times)
    smooth.SetPassBand(band)
    smooth.BoundarySmoothingOff()
    smooth.NonManifoldSmoothingOn()
    smooth.NormalizeCoordinatesOn()
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(smooth.GetOutputPort())
    normals.SplittingOff()
    return normals


def rgb_of(text):
    return [int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)]


def colour_table(colours, opacity):
    from vtkmodules.vtkCommonCore import vtkLookupTable

    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    table.SetTableRange(0, 255)
    for label in range(256):
        text = colours.get(label, PALETTE[(label - 1) % len(PALETTE)])
        table.SetTableValue(label, *rgb_of(text), opacity.get(label, 100) / 100)
    return table


def look_from(camera, angles):
    """The angles of render/view.h: what is ahead, and what is up, in right, anterior, superior."""
    yaw, pitch, roll = (math.radians(angle) for angle in angles)
    right = (-math.cos(yaw), -math.sin(yaw), 0)
    up = (math.sin(yaw) * math.sin(pitch), -math.cos(yaw) * math.sin(pitch), math.cos(pitch))
    ahead = (math.sin(yaw) * math.cos(pitch), -math.cos(yaw) * math.cos(pitch), -math.sin(pitch))
    middle = camera.GetFocalPoint()
    camera.SetPosition([middle[i] - AWAY * ahead[i] for i in range(3)])
    camera.SetViewUp([right[i] * math.sin(roll) + up[i] * math.cos(roll) for i in range(3)])


def occluding(radius):
    """VTK's pass for ambient occlusion, by the proportions of VTK's own example."""
    from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAOPass

    occlusion = vtkSSAOPass()
    occlusion.SetRadius(radius)
    occlusion.SetBias(radius / 100)
    occlusion.SetKernelSize(128)
    occlusion.BlurOn()
    occlusion.SetDelegatePass(vtkRenderStepsPass())
    return occlusion


class Stage:
    """A window off the screen, with the labels in it; `middle` is a place in the image."""

    def __init__(self, middle, spacing, options):
        import vtkmodules.vtkRenderingOpenGL2  # pylint: disable=unused-import
        from vtkmodules import vtkRenderingCore as core

        self.window = core.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(options.size)
        self.renderer = core.vtkRenderer()
        self.put_background(options.background)
        if options.opacity:
            self.window.SetAlphaBitPlanes(1)
            self.renderer.UseDepthPeelingOn()
            self.renderer.SetMaximumNumberOfPeels(PEELS)
            self.renderer.SetOcclusionRatio(0)
        self.window.AddRenderer(self.renderer)
        self.mapper = core.vtkPolyDataMapper()
        self.mapper.SetLookupTable(colour_table(options.colours, options.opacity))
        self.mapper.SetColorModeToMapScalars()  # bytes would be taken for grey
        self.mapper.SetScalarRange(0, 255)
        self.actor = core.vtkActor()
        self.actor.SetMapper(self.mapper)
        shine = self.actor.GetProperty()
        shine.SetInterpolationToPhong()
        shine.SetAmbient(AMBIENT)
        shine.SetDiffuse(DIFFUSE)
        shine.SetSpecular(SPECULAR)
        shine.SetSpecularPower(SHINE)
        self.renderer.AddActor(self.actor)
        if options.occlusion:
            self.renderer.SetPass(occluding(options.occlusion))
        self.add_light(core.vtkLight())
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(middle)
        camera.SetParallelScale(options.size[1] / 2 / options.zoom * min(spacing))
        look_from(camera, options.angles)

    def put_background(self, background):
        top, bottom = GRADIENT if background == "gradient" else (background, background)
        self.renderer.SetGradientBackground(True)
        self.renderer.SetBackground(rgb_of(bottom))
        self.renderer.SetBackground2(rgb_of(top))

    def add_light(self, light):
        yaw, pitch = math.radians(LIGHT_YAW), math.radians(LIGHT_PITCH)
        light.SetLightTypeToCameraLight()
        light.SetPosition(
            math.sin(yaw) * math.cos(pitch), math.sin(pitch), math.cos(yaw) * math.cos(pitch)
        )
        light.SetFocalPoint(0, 0, 0)
        self.renderer.AutomaticLightCreationOff()
        self.renderer.AddLight(light)

    def show(self, source):
        self.mapper.SetInputConnection(source.GetOutputPort())

    def draw(self):
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        self.window.WaitForCompletion()

    def write(self, path):
        from vtkmodules.vtkIOImage import vtkPNGWriter
        from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

        self.draw()
        pixels = vtkWindowToImageFilter()
        pixels.SetInput(self.window)
        pixels.ReadFrontBufferOff()
        writer = vtkPNGWriter()
        writer.SetFileName(path)
        writer.SetInputConnection(pixels.GetOutputPort())
        writer.Write()
        if not os.path.exists(path):
            raise Broken("cannot write %s" % path)

    def versions(self):
        from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion

        told = {}
        for line in self.window.ReportCapabilities().splitlines():
            name, _, value = line.partition(":")
            told[name.strip()] = value.strip()
        return {
            "what": "versions",
            "vtk": vtkVersion.GetVTKVersion(),
            "mesa": told.get("OpenGL version string", "unknown"),
            "renderer": told.get("OpenGL renderer string", "unknown"),
            "smp": vtkSMPTools.GetBackend(),
            "threads": vtkSMPTools.GetEstimatedNumberOfThreads(),
        }


# ---- what is timed ----


class Change:
    """Relabels balls at the surface, in turn, each there and back."""

    def __init__(self, labels, image, count):
        import numpy

        self.labels, self.image, self.undo = labels, image, None
        inner = numpy.zeros(labels.shape, bool)
        core = labels[1:-1, 1:-1, 1:-1]
        edge = (core > 0) & (labels[1:-1, 1:-1, :-2] == 0)
        inner[1:-1, 1:-1, 1:-1] = edge
        places = numpy.argwhere(inner)
        if not len(places):
            raise Broken("no object has a surface inside the scene")
        self.places = [places[len(places) * (2 * i + 1) // (2 * count)] for i in range(count)]

    def make(self):
        import numpy

        if self.undo:
            box, former = self.undo
            self.labels[box] = former
            self.undo = None
        else:
            place = self.places.pop(0)
            self.places.append(place)
            box = tuple(slice(max(0, p - RADIUS), p + RADIUS + 1) for p in place)
            part = self.labels[box]
            self.undo = (box, part.copy())
            grid = numpy.ogrid[box]
            part[sum((g - p) ** 2 for g, p in zip(grid, place)) <= RADIUS**2] = self.labels[
                tuple(place)
            ]
        self.image.GetPointData().GetScalars().Modified()
        self.image.Modified()


def told(what, times, **more):
    return {
        "what": what,
        "median_ms": round(statistics.median(times), 3),
        "least_ms": round(min(times), 3),
        "most_ms": round(max(times), 3),
        "rounds": len(times),
        **more,
    }


def time_changes(stage, what, kind, labels, image, values, rounds, smooth=None):
    surface = surface_filter(kind, image, values)
    if smooth:
        surface = smoothed(surface, *smooth)
    change = Change(labels, image, (rounds + 1) // 2)
    stage.show(surface)
    stage.draw()
    stage.draw()  # what is done once, such as compiling shaders, is not counted
    whole, alone = [], []
    for _ in range(rounds):
        change.make()
        begin = time.perf_counter()
        surface.Update()
        alone.append((time.perf_counter() - begin) * 1e3)
        stage.draw()
        whole.append((time.perf_counter() - begin) * 1e3)
    if change.undo:
        change.make()
    return told(
        what,
        whole,
        surface_ms=round(statistics.median(alone), 3),
        triangles=surface.GetOutput().GetNumberOfPolys(),
    )


def time_rotation(stage, what, rounds):
    camera = stage.renderer.GetActiveCamera()
    times = []
    for _ in range(rounds):
        camera.Azimuth(3)
        begin = time.perf_counter()
        stage.draw()
        times.append((time.perf_counter() - begin) * 1e3)
    return told(what, times)


# ---- the program ----


def colour(text):
    if len(text) != 7 or text[0] != "#":
        raise ValueError(text)
    int(text[1:], 16)
    return text


def background(text):
    return text if text == "gradient" else colour(text)


def place(text):
    x, y, z = (float(part) for part in text.split(","))
    return x, y, z


def of_labels(kind):
    """What argparse reads LABEL=VALUE,... by: a dictionary."""

    def values(text):
        pairs = (part.split("=") for part in filter(None, text.split(",")))
        return {int(label): kind(value) for label, value in pairs}

    return values


def middle_of(labels, spacing, axes, at):
    """The place of a voxel of the file, or of the middle, in the image."""
    size = labels.shape[::-1]
    voxel = [(n - 1) / 2 for n in size]
    if at:
        forth = [at[axis] for axis, _ in axes]
        voxel = [v if axes[w][1] else size[w] - 1 - v for w, v in enumerate(forth)]
    return [v * mm for v, mm in zip(voxel, spacing)]


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("labels")
    parser.add_argument("--size", nargs=2, type=int, default=[512, 512])
    parser.add_argument("--angles", nargs=3, type=float, default=[0, 0, 0])
    parser.add_argument("--zoom", type=float, default=1)
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("--colours", type=of_labels(colour), default={})
    parser.add_argument("--opacity", type=of_labels(float), default={})
    parser.add_argument("--at", type=place)
    parser.add_argument("--background", type=background, default="#000000")
    parser.add_argument("--occlusion", type=float, default=0)
    parser.add_argument("--smooth", nargs=2, type=float, default=[20, 0.1])
    parser.add_argument("--png")
    options = parser.parse_args()
    if min(options.size) < 1 or options.zoom <= 0 or options.rounds < 1:
        parser.error("size, zoom and rounds are above 0")
    options.smooth[0] = int(options.smooth[0])
    return options


def begin_display():
    """Starts again under xvfb-run where X is not there."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run"):
        raise Broken("there is no DISPLAY and no xvfb-run; apt-get install xvfb")
    screen = "-screen 0 1280x1024x24"
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", screen, sys.executable] + sys.argv)


def run(options):
    import numpy

    labels, spacing, axes = read_labels(options.labels)
    values = [int(v) for v in numpy.unique(labels) if v]
    if not values:
        raise Broken("%s holds no object" % options.labels)
    labels = labels.copy()
    image = image_of(labels, spacing)
    stage = Stage(middle_of(labels, spacing, axes, options.at), spacing, options)
    if options.png:
        surface = surface_filter("vtkDiscreteFlyingEdges3D", image, values)
        stage.show(smoothed(surface, *options.smooth))
        stage.write(options.png)
        return
    lines = []
    for name, kind in (
        ("flying edges", "vtkDiscreteFlyingEdges3D"),
        ("marching cubes", "vtkDiscreteMarchingCubes"),
    ):
        what = "label change, " + name
        lines.append(time_changes(stage, what, kind, labels, image, values, options.rounds))
    lines.append(time_rotation(stage, "rotation", options.rounds))
    kind = "vtkDiscreteFlyingEdges3D"
    what = "label change, smoothed, with normals"
    lines.append(
        time_changes(stage, what, kind, labels, image, values, options.rounds, options.smooth)
    )
    lines.append(time_rotation(stage, "rotation, smoothed, with normals", options.rounds))
    for line in [stage.versions()] + lines:
        print(json.dumps(line), flush=True)


def main():
    options = parse()
    try:
        import numpy  # pylint: disable=unused-import
        import vtkmodules  # pylint: disable=unused-import

        begin_display()
        run(options)
    except ImportError as error:
        print("vtk_render.py: %s; apt-get install python3-vtk9" % error, file=sys.stderr)
        return 3
    except Broken as error:
        print("vtk_render.py: %s" % error, file=sys.stderr)
        return 3
    return 0


sys.exit(main())
