# SPDX-License-Identifier: MIT
"""iftty's pictures beside VTK's of the same labels: `make bench-beside`.

    beside.py [--only WORD] [--out FOLDER] BUILD

Each row of PICTURES is a golden image of a journal in examples/, or what more commands make of it.
iftty carries the journal's commands out, draws the picture, and saves the labels; VTK draws them by
tests/peers/vtk_render.py: the same view, zoom, size, colours, opacities, background and samples;
each label has a surface of its own, smoothed (windowed sinc, 40 times, pass band 0.01: what 3D
Slicer begins with) and with normals. What iftty hides or cuts away has label 0 for VTK. Where a
picture has ambient occlusion, VTK's is that of the screen.

FOLDER/NAME.png has both, iftty on the left, and below each the part that is most telling, four
times as large. Nothing is compared: people look.

Exit status: 0 fine, 3 a program could not be run."""

import argparse
import gzip
import json
import os
import re
import sys
import tempfile

from programs import Broken, leave_by, run

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "examples")
VTK = os.path.join(HERE, "..", "peers", "vtk_render.py")
SMOOTH = "40", "0.01"
OCCLUSION_MM = "10"
MAGNIFIED, GAP = 4, 6
# Written files, and pictures, are none of the picture's making.
IDLE = "golden", "render", "save", "mosaic", "slice", "spin", "stats", "export"

LARGE = "size 512 512"
CREASES = "shade surface creases=yes"

# Name: journal, golden image, commands after it, middle of what is magnified in parts of the sides.
PICTURES = {
    "head": ("head", "three-layers", [LARGE, "zoom 2.454"], (0.45, 0.45)),
    "head-8": ("head", "three-layers", [LARGE, "zoom 8"], (0.5, 0.5)),
    "head-brain": ("head", "brain", [LARGE, "zoom 2.68"], (0.6, 0.45)),
    "atlas": ("atlas", "left", [LARGE, "zoom 2.622"], (0.4, 0.4)),
    "atlas-8": ("atlas", "left", [LARGE, "zoom 8"], (0.5, 0.5)),
    "creases": ("atlas", "left", [LARGE, "zoom 2.622", CREASES], (0.4, 0.4)),
    "creases-8": ("atlas", "left", [LARGE, "zoom 8", CREASES], (0.5, 0.5)),
    "sulci": ("sulci", "left", [LARGE, "zoom 2.68"], (0.45, 0.35)),
    "sulci-8": ("sulci", "left", [LARGE, "zoom 8"], (0.5, 0.5)),
    "print": ("print", "page", [LARGE, "zoom 2.948", "decorate none"], (0.55, 0.45)),
    "shells": ("shells", "whole", [LARGE, "zoom 5.896"], (0.15, 0.25)),
    "shells-open": ("shells", "open", [LARGE, "zoom 5.98"], (0.85, 0.45)),
    "shells-8": ("shells", "open", [LARGE, "zoom 8", "pan -200 0"], (0.4, 0.5)),
    "cubes": ("shells", "cubes", [LARGE, "zoom 8"], (0.5, 0.5)),
    "brain": ("brain", "folds", ["shade surface", LARGE, "zoom 2.2"], (0.4, 0.4)),
    "brain-3": ("brain", "folds", ["shade surface", LARGE, "zoom 3"], (0.5, 0.4)),
    "brain-8": ("brain", "folds", ["shade surface", LARGE, "zoom 8"], (0.5, 0.5)),
}


# ---- iftty ----


def script_of(iftty, journal, golden, more):
    """The commands up to a golden image, and then to its picture and labels."""
    lines = run([iftty, "log", "--script", os.path.join(EXAMPLES, journal + ".iftty")])
    kept = []
    for line in lines.decode().splitlines():
        words = line.split()
        if words[:2] == ["golden", golden]:
            finished = "yes" if "finished on" in kept else "no"
            save = "save labels labels.nii.gz finished=" + finished
            return "\n".join(kept + more + ["render iftty.png", save, ""])
        if words and words[0] not in IDLE:
            kept.append(line)
    raise Broken("%s.iftty has no golden image %s" % (journal, golden))


def draw_by_iftty(build, folder, journal, golden, more):
    """iftty.png and labels.nii.gz; returns the picture's notes."""
    iftty = os.path.join(os.path.abspath(build), "iftty")
    with open(os.path.join(folder, "script"), "w") as script:
        script.write(script_of(iftty, journal, golden, more))
    run([iftty, "run", "script"], folder)
    notes = json.loads(run([iftty, "info", "--json", "iftty.png"], folder))["notes"]
    return {key.partition(":")[2]: value for key, value in notes.items()}


# ---- VTK ----


def cut_labels(folder, notes):
    """labels.nii.gz without what is hidden or cut away."""
    import numpy

    path = os.path.join(folder, "labels.nii.gz")
    with gzip.open(path) as file:
        data = bytearray(file.read())
    size = numpy.frombuffer(data, "<i2", 3, 42)
    labels = numpy.frombuffer(data, numpy.uint8, offset=352).reshape(size[::-1])
    shown = [int(label) for label in json.loads(notes["labels"])]
    labels[~numpy.isin(labels, shown)] = 0
    cut = notes.get("cut", "")
    if "plane" in cut:
        raise Broken("a plane is cut away, which is not told to VTK")
    for axis, first, last in re.findall(r"([xyz]) (\d+)-(\d+)", cut):
        side = labels.swapaxes(0, "zyx".index(axis))
        side[: int(first)] = side[int(last) + 1 :] = 0
    for box in re.findall(r"box (\d+),(\d+),(\d+) (\d+),(\d+),(\d+)", cut):
        x, y, z, *last = map(int, box)
        labels[z : last[2] + 1, y : last[1] + 1, x : last[0] + 1] = 0
    with gzip.open(path, "wb", 1) as file:
        file.write(data)


def opacities(notes):
    """"100 %, 25 % of label 1, 45 % of label 2" as vtk_render.py has it."""
    usual, _, others = notes.get("opacity", "100 %").partition(" %")
    of = {label: usual for label in json.loads(notes["labels"])}
    of.update((label, percent) for percent, label in re.findall(r"(\d+) % of label (\d+)", others))
    return ",".join("%s=%s" % pair for pair in of.items() if pair[1] != "100")


def draw_by_vtk(folder, notes):
    """vtk.png, with so many samples a pixel along each side as iftty has; returns that number."""
    look, view = notes["look"], notes["view"]
    samples = int(re.search(r"samples (\d+)", look)[1])
    background = re.search(r"background (\S+)", look)[1]
    number = r"(-?[\d.]+)"
    angles = re.search("yaw %s pitch %s roll %s" % (number, number, number), view).groups()
    zoom = float(re.search("zoom " + number, view)[1])
    size = re.search(r"(\d+)x(\d+) pixels", view).groups()
    at = re.search(r"voxel (\S+) in the middle", view)
    labels = json.loads(notes["labels"])
    is_occluded = "ambient occlusion" in look
    run([sys.executable, VTK, "labels.nii.gz", "--png", "vtk.png",
         "--size", *(str(int(side) * samples) for side in size), "--zoom", str(zoom * samples),
         "--angles", *angles, *(["--at", at[1]] if at else []), "--smooth", *SMOOTH,
         *(["--occlusion", OCCLUSION_MM] if is_occluded else []),
         "--background", {"white": "#ffffff", "black": "#000000"}.get(background, background),
         "--opacity", opacities(notes),
         "--colours", ",".join("%s=%s" % (n, label["colour"]) for n, label in labels.items())],
        folder)
    return samples


# ---- side by side ----


def crop(picture, middle):
    side = min(picture.size) // MAGNIFIED
    left, top = (min(max(int(size * part) - side // 2, 0), size - side)
                 for size, part in zip(picture.size, middle))
    part = picture.crop((left, top, left + side, top + side))
    return part.resize((side * MAGNIFIED, side * MAGNIFIED), 0)


def put_together(folder, samples, middle, path):
    from PIL import Image

    pictures = [Image.open(os.path.join(folder, name)).convert("RGB")
                for name in ("iftty.png", "vtk.png")]
    pictures[1] = pictures[1].resize(pictures[0].size, Image.BOX if samples > 1 else 0)
    width, height = pictures[0].size
    parts = [crop(picture, middle) for picture in pictures]
    whole = Image.new("RGB", (2 * width + GAP, height + GAP + parts[0].height), (90, 90, 90))
    for i, (picture, part) in enumerate(zip(pictures, parts)):
        whole.paste(picture, (i * (width + GAP), 0))
        whole.paste(part, (i * (width + GAP), height + GAP))
    whole.save(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--only", default="", help="pictures with this word in their names")
    parser.add_argument("--out", help="BUILD/beside where it is not given")
    parser.add_argument("build")
    options = parser.parse_args()
    out = options.out or os.path.join(options.build, "beside")
    os.makedirs(out, exist_ok=True)
    for name, (journal, golden, more, middle) in PICTURES.items():
        path = os.path.join(out, name + ".png")
        if options.only not in name:
            continue
        try:
            with tempfile.TemporaryDirectory() as folder:
                notes = draw_by_iftty(options.build, folder, journal, golden, more)
                cut_labels(folder, notes)
                samples = draw_by_vtk(folder, notes)
                put_together(folder, samples, middle, path)
        except Broken as error:
            raise Broken("%s: %s" % (name, error)) from None
        print(path)


leave_by(main)
