# SPDX-License-Identifier: MIT
"""What reading and writing large files takes: `make bench-files`.

    files.py [--rounds N] BUILD

- from the start to the end of `open` of a 512x512x400 int16 .nii.gz, beside libdeflate-gzip -dc on
  the same file, in turn; and the first command after it, for which the cells of the scene are made;
- the same of ch2, whose cells and weights `open` makes;
- `save surface` of the brain of examples/brain.iftty, and the same with 60000 triangles.

Elapsed, and of processors, which other work on the machine changes less.

Exit status: 0 fine, 3 a program could not be run."""
import argparse
import gzip
import os
import resource
import shutil
import statistics
import struct
import subprocess
import tempfile
import time

import numpy

from programs import Broken, leave_by, run

CH2 = "/usr/share/mricron/templates/ch2.nii.gz"


def make_scene(path):
    """Ch2 in 512x512x400 voxels of 16 bits, with noise: 61 MB."""
    with gzip.open(CH2) as file:
        head, data = bytearray(file.read(352)), file.read()
    shape = struct.unpack("<3h", head[42:48])
    ch2 = numpy.frombuffer(data, numpy.uint8)[:shape[0] * shape[1] * shape[2]].reshape(shape[::-1])
    size = (400, 512, 512)
    z, y, x = (numpy.arange(n) * old // n for n, old in zip(size, ch2.shape))
    noise = numpy.random.default_rng(1)
    struct.pack_into("<8h", head, 40, 3, *size[::-1], 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 4, 16)
    with gzip.open(path, "wb", 6) as file:
        file.write(head)
        for plane in ch2[z]:
            values = plane[y][:, x].astype(numpy.float32) * 4
            values += numpy.where(values > 8, noise.normal(0, 6, values.shape), 0)
            file.write((values + noise.integers(0, 2, values.shape)).astype("<i2").tobytes())


def of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def of_process(number):
    with open("/proc/%d/stat" % number) as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def seconds(words):
    used, begun = of_children(), time.monotonic()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.monotonic() - begun, of_children() - used


def in_turn(rounds, *programs):
    """Medians of each program's seconds."""
    took = [[seconds(words) for words in programs] for _ in range(rounds)]
    return [[statistics.median(times) for times in zip(*of_one)] for of_one in zip(*took)]


def answers(build, lines):
    """Seconds until each line is acknowledged."""
    with subprocess.Popen([os.path.join(build, "iftty"), "run", "-"], text=True, bufsize=1,
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL) as session:
        for line in lines:
            used, begun = of_process(session.pid), time.monotonic()
            session.stdin.write(line + "\n")
            while not session.stdout.readline().startswith("ok "):
                if session.poll() is not None:
                    raise Broken("refused: " + line)
            yield time.monotonic() - begun, of_process(session.pid) - used
        session.stdin.close()


def tell(what, took):
    print("%-56s %8.0f %8.0f" % (what, 1e3 * took[0], 1e3 * took[1]), flush=True)


def bench_opening(build, folder, rounds):
    scene = os.path.join(folder, "large.nii.gz")
    make_scene(scene)
    iftty = os.path.join(build, "iftty")
    large, peer = in_turn(rounds, [iftty, "-c", "open " + scene],
                          ["libdeflate-gzip", "-dc", scene])
    tell("open 512x512x400 int16 .nii.gz", large)
    tell("    libdeflate-gzip -dc of the same file", peer)
    *_, first = answers(build, ["open " + scene, "label 1 first", "stats"])
    tell("    the first command that looks at a voxel, stats", first)
    tell("open ch2, weights ready", *in_turn(4 * rounds, [iftty, "-c", "open " + CH2]))


def bench_surface(build, folder):
    script = run([os.path.join(build, "iftty"), "log", "--script", "examples/brain.iftty"])
    lines = [line.replace("open ch2.nii.gz", "open " + CH2) for line in script.decode().splitlines()
             if line.split(" ")[0] in ("open", "weight", "label", "seed", "remove", "run")]
    save = "save surface " + os.path.join(folder, "%s.ply") + " label=1"
    took = list(answers(build, lines + [save % "all", save % "few" + " triangles=60000"]))
    tell("save surface of a brain", took[-2])
    tell("    with 60000 triangles", took[-1])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("build")
    options = parser.parse_args()
    folder = tempfile.mkdtemp()
    print("%-56s %8s %8s" % ("", "ms", "of CPUs"))
    try:
        bench_surface(options.build, folder)
        bench_opening(options.build, folder, options.rounds)
    finally:
        shutil.rmtree(folder)


leave_by(main)
