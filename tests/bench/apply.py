"""How well a procedure does in other heads: `make bench-apply`.

    apply.py [--count N] [--subjects FILE] BUILD

examples/brain.iftty, made on ch2, is carried to subjects that examples/cohort/subjects.py makes of
it: ch2 deformed by 3 mm, and by 5 mm with an affine, both with noise and a bias field, and the
second with other values. Their truth is the procedure's own labels, deformed alike. Printed is
Dice of brain, cerebellum and medulla, the mean over N subjects and the least, with no correction:

    world, affine    how it was carried over; seeds, labels: what was planted
    warped alone     the labels as they were carried over, and nothing grown
    3 corrections    by a robot that knows the truth: a ball in the middle of the largest piece that
                     is wrong, half as large as it is deep, which reaches three times as far

Floors: brain .93 for affine and labels on 5 mm with an affine, and no less than labels warped
alone, in the mean and in each subject.

Exit status: 0 fine, 1 below a floor, 3 a program could not be run.
"""
import argparse
import json
import os
import re
import sys
import tempfile

import nibabel
import numpy
from scipy import ndimage

from programs import leave_by, run

CH2 = "/usr/share/mricron/templates/ch2.nii.gz"
EXPERT = "examples/brain.iftty"
LABELS = (1, 2, 3)
KINDS = (("3 mm", ["--elastic", "3", "--noise", "2", "--bias", "15", "--seed", "1"]),
         ("5 mm + affine", ["--elastic", "5", "--affine", "--noise", "2", "--bias", "15", "--gain",
                            "1.7", "--seed", "7"]))
WAYS = (("world", "seeds"), ("world", "labels"), ("affine", "seeds"), ("affine", "labels"))
FLOOR = 0.93


def dice(found, truth):
    return [2 * float(((found == label) & (truth == label)).sum()) /
            max(1, (found == label).sum() + (truth == label).sum()) for label in LABELS]


def load(path):
    return numpy.asanyarray(nibabel.load(path).dataobj)


class Head:
    def __init__(self, iftty, work, expert, scene, truth):
        self.iftty, self.work, self.scene = iftty, work, scene
        self.expert, self.truth = expert, load(truth)

    def labels_of(self, journal):
        path = os.path.join(self.work, "now.nii.gz")
        run([self.iftty, "-c", "save labels %s replace=yes" % path, "--journal", journal,
             "--read-only"])
        return load(path)

    def apply(self, by, as_):
        out = os.path.join(self.work, "%s-%s" % (by, as_))
        told = run([self.iftty, "apply", EXPERT, self.scene, "--by", by, "--as", as_, "--out", out,
                    "--json"])
        return json.loads(told)[0]["journal"]

    def warped(self, journal):
        with open(journal) as file:
            pull = re.search(r"^origin .* pull=(\S+)", file.read(), re.M).group(1)
        whole = numpy.vstack([numpy.array(pull.split(","), float).reshape(3, 4), [0, 0, 0, 1]])
        labels, scene = nibabel.load(self.expert), nibabel.load(self.scene)
        way = numpy.linalg.inv(labels.affine) @ whole @ scene.affine
        return ndimage.affine_transform(numpy.asanyarray(labels.dataobj), way[:3, :3], way[:3, 3],
                                        output_shape=scene.shape, order=0)

    def correct(self, journal):
        found = self.labels_of(journal)
        wrong, most, best = found != self.truth, 0, None
        for label in (0,) + LABELS:
            pieces, _ = ndimage.label(wrong & (self.truth == label))
            sizes = numpy.bincount(pieces.ravel())
            sizes[0] = 0
            if sizes.max() > most:
                most, best = sizes.max(), (label, pieces == sizes.argmax())
        depth = ndimage.distance_transform_edt(best[1])
        at = numpy.unravel_index(depth.argmax(), depth.shape)
        radius = max(1, int(depth.max() / 2))
        run([self.iftty, "-c", "seed %d,%d,%d %d radius=%d within=%d; run" %
             (*at, best[0], radius, 3 * int(depth.max()) + 3), "--journal", journal])


def measure(options, work, kind, words):
    iftty = os.path.join(options.build, "iftty")
    expert = os.path.join(work, "expert.nii.gz")
    out = os.path.join(work, re.sub(r"\W+", "-", kind))
    run([sys.executable, options.subjects, "--count", str(options.count), *words, CH2, expert, out])
    table = {}
    for number in range(1, options.count + 1):
        name = "sub-%02d" % number
        scene = os.path.join(out, name, "anat", name + "_T1w.nii.gz")
        truth = os.path.join(out, "derivatives/truth", name, "anat",
                             name + "_desc-truth_dseg.nii.gz")
        folder = os.path.join(work, "%s-%s" % (os.path.basename(out), name))
        os.mkdir(folder)
        head = Head(iftty, folder, expert, scene, truth)
        for by, as_ in WAYS:
            journal = head.apply(by, as_)
            table.setdefault("%s, %s" % (by, as_), []).append(
                dice(head.labels_of(journal), head.truth))
        table.setdefault("warped alone", []).append(dice(head.warped(journal), head.truth))
        for _ in range(3):
            head.correct(journal)
        table.setdefault("3 corrections", []).append(
            dice(head.labels_of(journal), head.truth))
    return {row: numpy.array(values) for row, values in table.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=3)
    parser.add_argument("--subjects", default="examples/cohort/subjects.py")
    parser.add_argument("build")
    options = parser.parse_args()
    fine = True
    with tempfile.TemporaryDirectory(prefix="iftty-bench-") as work:
        script = run([os.path.join(options.build, "iftty"), "log", "--script", EXPERT]).decode()
        lines = [line for line in script.split("\n")
                 if not line.startswith(("golden", "render", "save"))]
        path = os.path.join(work, "expert.txt")
        with open(path, "w") as file:
            file.write("\n".join(lines + ["save labels %s/expert.nii.gz\n" % work]))
        run([os.path.join(options.build, "iftty"), "run", path])
        print("%-16s %-16s %17s %17s %17s" % ("subjects", "way", "brain", "cerebellum", "medulla"))
        for kind, words in KINDS:
            table = measure(options, work, kind, words)
            for row, values in table.items():
                print("%-16s %-16s %s" % (kind, row, " ".join(
                    "%9.3f (%.3f)" % (values[:, i].mean(), values[:, i].min())
                    for i in range(len(LABELS)))), flush=True)
            brain = table["affine, labels"][:, 0]
            fine &= bool((brain >= table["warped alone"][:, 0]).all())
            fine &= kind == KINDS[0][0] or brain.mean() >= FLOOR
    print("floors: " + ("held" if fine else "NOT held"))
    sys.exit(0 if fine else 1)


leave_by(main)
