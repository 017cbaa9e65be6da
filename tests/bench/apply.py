# SPDX-License-Identifier: MIT
"""What a procedure comes to that is carried to other heads: `make bench-apply`.

    apply.py [--seeds N] [--json] [NAME...] BUILD

examples/brain.iftty, made on ch2, is carried by `iftty apply` to

- elastic3, elastic5: subjects of examples/cohort/subjects.py: ch2 deformed by 3 mm, and by 5 mm and
  an affine, with other values; both with noise of 3 % and a bias of 20 %. The truth are the
  procedure's labels, deformed

in these ways: --by world and --by affine, each --as labels and --as seeds; beside them the
procedure's labels, warped alone by the same transform; and, but for world, --as labels with three
corrections. The robot is the careful one of effort_robot.h, for three labels: it corrects the
largest piece of what is wrong at its deepest voxel, by a ball of the depth less 1, of at most 12
voxels, with the true label there.

Dice of each label, by `iftty compare`; processor time and memory of `iftty apply`.

Floors, of the brain --by affine --as labels: no less than labels warped alone, on each deformed
subject; and in the mean .93 on elastic5.

Exit status: 0 fine, 1 below a floor, 3 a program could not be run."""
import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import nibabel
import numpy
from scipy import ndimage

from programs import Broken, leave_by, run

CH2 = "/usr/share/mricron/templates/ch2.nii.gz"
SCRIPTS = os.path.join(os.path.dirname(__file__), "..", "..", "examples")
PROCEDURE = os.path.join(SCRIPTS, "brain.iftty")
DEFORMED = {"elastic3": ["--elastic", "3"],
            "elastic5": ["--elastic", "5", "--affine", "--gain", "1.7"]}
FLOOR = 0.93  # of the brain on elastic5, in the mean
# In a process of its own, since a child's memory begins as that of its parent.
MEASURED = """import resource, subprocess, sys
code = subprocess.call(sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w") as file:
    print(used.ru_utime + used.ru_stime, used.ru_maxrss, file=file)
sys.exit(code)"""
BALL_MOST = 12
CORRECTIONS = 3


class Bench:
    def __init__(self, build, folder):
        self.iftty, self.folder = os.path.abspath(os.path.join(build, "iftty")), folder
        run([self.iftty, "run", PROCEDURE, "--out", folder])
        self.labels = os.path.join(folder, "brain-labels.nii.gz")

    def path(self, name):
        return os.path.join(self.folder, name)

    def apply(self, scene, by, plants):
        """The journal, or None and why it was refused; processor seconds, megabytes."""
        out, used = tempfile.mkdtemp(dir=self.folder), self.path("used")
        words = [self.iftty, "apply", PROCEDURE, scene, "--by", by, "--as", plants, "--out", out,
                 "--json"]
        done = subprocess.run([sys.executable, "-c", MEASURED, used, *words], text=True,
                              stdin=subprocess.DEVNULL, capture_output=True)
        if done.returncode not in (0, 1):
            raise Broken("apply --by %s %s: %s" % (by, scene, done.stderr))
        told = json.loads(done.stdout)[0]
        with open(used) as file:
            seconds, kilobytes = (float(word) for word in file.read().split())
        cost = seconds, kilobytes / 1024
        return told.get("journal"), told.get("why"), cost

    def saved(self, journal):
        out = tempfile.mkdtemp(dir=self.folder)
        run([self.iftty, "-c", "save labels labels.nii.gz", "--journal", journal, "--read-only",
             "--out", out])
        return os.path.join(out, "labels.nii.gz")

    def dice(self, labels, truth):
        rows = json.loads(run([self.iftty, "compare", "--json", labels, truth]))["labels"]
        return {str(row["label"]): row["dice"] for row in rows}

    def warped(self, journal, scene):
        """The procedure's labels on the subject's grid, by the pull that the journal records."""
        with open(journal) as file:
            numbers = re.search(r"^origin .* pull=([^ ]*)", file.read(), re.M).group(1)
        pull = numpy.vstack([numpy.array([float(n) for n in numbers.split(",")]).reshape(3, 4),
                             [0, 0, 0, 1]])
        source, image = nibabel.load(self.labels), nibabel.load(scene)
        matrix = numpy.linalg.inv(source.affine) @ pull @ image.affine
        labels = ndimage.affine_transform(numpy.asanyarray(source.dataobj), matrix[:3, :3],
                                          matrix[:3, 3], image.shape, order=0)
        path = os.path.join(os.path.dirname(journal), "warped.nii.gz")
        nibabel.save(nibabel.Nifti1Image(labels.astype(numpy.uint8), image.affine), path)
        return path

    def corrected(self, journal, truth):
        """A copy of the journal, with CORRECTIONS more gestures."""
        labels = numpy.asanyarray(nibabel.load(self.saved(journal)).dataobj)
        truth = numpy.asanyarray(nibabel.load(truth).dataobj)
        for _ in range(CORRECTIONS):
            line = gesture(labels, truth)
            with subprocess.Popen([self.iftty, "run", "-", "--journal", journal],
                                  stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL, text=True) as child:
                child.communicate(line + "\nrun\n")
            if child.returncode:
                raise Broken("refused: " + line)
            labels = numpy.asanyarray(nibabel.load(self.saved(journal)).dataobj)
        return journal


def gesture(labels, truth):
    """The command that corrects most."""
    pieces, _ = ndimage.label(labels != truth)
    largest = pieces == numpy.bincount(pieces.ravel())[1:].argmax() + 1
    depth = ndimage.distance_transform_edt(numpy.pad(largest, 1, mode="edge"))[1:-1, 1:-1, 1:-1]
    at = numpy.unravel_index(depth.argmax(), depth.shape)
    radius = max(0, min(BALL_MOST, int(depth[at]) - 1))
    return "seed %d,%d,%d %d radius=%d" % (*at, int(truth[at]), radius)


def deformed(bench, name, seeds):
    """Pairs of scene and truth."""
    for seed in range(1, seeds + 1):
        out = bench.path("%s-%d" % (name, seed))
        run([os.path.join(SCRIPTS, "cohort", "subjects.py"), *DEFORMED[name], "--noise", "3",
             "--bias", "20", "--seed", str(seed), "--count", "1", CH2, bench.labels, out])
        yield (os.path.join(out, "sub-01/anat/sub-01_T1w.nii.gz"), os.path.join(
            out, "derivatives/truth/sub-01/anat/sub-01_desc-truth_dseg.nii.gz"))


# ---- what came of them ----

def measure(bench, scene, truth, rows, name):
    for by in "world", "affine":
        for plants in "labels", "seeds":
            way = "%s, %s" % (by, plants)
            journal, why, cost = bench.apply(scene, by, plants)
            row = {"of": name, "way": way, "seconds": cost[0], "memory_mb": cost[1]}
            rows.append(row)
            if not journal:
                row["refused"] = why
                continue
            row["dice"] = bench.dice(bench.saved(journal), truth)
            if plants == "labels":
                rows.append({"of": name, "way": "%s, labels warped alone" % by,
                             "dice": bench.dice(bench.warped(journal, scene), truth)})
            if plants == "labels" and by != "world":
                journal = bench.corrected(journal, truth)
                rows.append({"of": name, "way": "%s, %d corrections" % (way, CORRECTIONS),
                             "dice": bench.dice(bench.saved(journal), truth)})


def tell(name, rows):
    print("\n%-34s %7s %7s %7s %7s %6s" % (name, "brain", "cerebel", "medulla", "least", "s"))
    for way in dict.fromkeys(row["way"] for row in rows):
        some = [row for row in rows if row["way"] == way]
        dice = [row["dice"] for row in some if "dice" in row]
        cells = []
        for label in "123" if dice else "":
            known = [row[label] for row in dice if label in row]
            cells.append("%7.3f" % statistics.median(known) if known else " " * 7)
        cells += ["%7.3f" % min(row["1"] for row in dice)] if dice else []
        took = [row["seconds"] for row in some if "seconds" in row]
        cells += ["%6.1f" % statistics.median(took)] if took and dice else []
        print("    %-30s %s" % (way, " ".join(cells)))
        for row in some:
            if "refused" in row:
                print("        refused: " + row["refused"])
    memory = [row["memory_mb"] for row in rows if "memory_mb" in row]
    print("    memory at most, MB %31.0f" % max(memory), flush=True)


def holds_floors(rows):
    def brain(name, way):
        return [row["dice"]["1"] for row in rows
                if row["of"] == name and row["way"] == way and "dice" in row]
    fine = True
    for name in DEFORMED:
        grown, alone = (brain(name, "affine, labels" + way) for way in ("", " warped alone"))
        fine &= all(one >= other for one, other in zip(grown, alone))
        fine &= name != "elastic5" or not grown or statistics.mean(grown) >= FLOOR
    return fine


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("build")
    options = parser.parse_args()
    names = options.names or list(DEFORMED)
    folder = tempfile.mkdtemp()
    rows, begun = [], time.monotonic()
    try:
        bench = Bench(options.build, folder)
        for name in names:
            for scene, truth in deformed(bench, name, options.seeds):
                measure(bench, scene, truth, rows, name)
            if not options.json:
                tell(name, [row for row in rows if row["of"] == name])
    finally:
        shutil.rmtree(folder)
    if options.json:
        print(json.dumps(rows, indent=1))
    else:
        print("\nDice are medians; least: of the brain. Floors: %s. %.0f s in all" % (
            "held" if holds_floors(rows) else "NOT held", time.monotonic() - begun))
    if not holds_floors(rows):
        sys.exit(1)


leave_by(main)
