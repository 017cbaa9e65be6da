# SPDX-License-Identifier: MIT
"""chafa, another program that shows pictures in terminals, on those of `bench terminal`:
chafa.py [--quick] [--json] BUILD; `make bench-chafa` runs it. --quick: one round.

iftty draws the pictures at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is
not here) as PNG: the rendition of 512x512 pixels, a mosaic of 640x640. chafa shows them in as many
cells of 8x16 pixels. Its time is from its start to its last byte, less what the same takes for a
picture of one pixel. Medians; no time is compared with a limit.

Exit status: 0 fine, 3 a program could not be run."""

import json
import os
import shutil
import statistics
import struct
import sys
import tempfile
import time
import zlib

from programs import Broken, leave_by, run

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")
ROUNDS = 1 if "--quick" in sys.argv[1:-1] else 7
SIDES = {"rendition": 512, "mosaic": 640}
FORMATS = {"kitty": "kitty", "sixel": "sixels", "iterm": "iterm", "blocks": "symbols"}


def draw(build, folder):
    """The pictures as rendition.png and mosaic.png."""
    commands = "; ".join(
        f"size {side} {side}; {'render' if name == 'rendition' else name} {name}.png"
        for name, side in SIDES.items()
    )
    broken = None
    for example in "brain.iftty", "geom.iftty":
        journal = os.path.join(folder, example)
        shutil.copyfile(os.path.join(EXAMPLES, example), journal)
        try:
            run([os.path.abspath(build) + "/iftty", "-c", commands, "--journal", journal], folder)
            return
        except Broken as error:
            broken = error
    raise broken


def write_dot(path):
    """A picture of one black pixel."""
    def chunk(kind, data):
        whole = kind + data
        return struct.pack(">I", len(data)) + whole + struct.pack(">I", zlib.crc32(whole))

    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n")
        out.write(chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)))
        out.write(chunk(b"IDAT", zlib.compress(bytes(4))) + chunk(b"IEND", b""))


def show(folder, picture, by, side):
    """Bytes and milliseconds. Where there are pixels, chafa takes cells for squares of 8x8."""
    is_text = by == "symbols"
    size = f"{side // 8}x{max(side // 16, 1) if is_text else side // 8}"
    command = ["chafa", "-f", by, "-c", "full", "--font-ratio", "1/2" if is_text else "1/1",
               "-s", size, picture]
    times = []
    for _ in range(ROUNDS):
        begin = time.monotonic()
        shown = len(run(command, folder))
        times.append(1000 * (time.monotonic() - begin))
    return shown, statistics.median(times)


def measure(build):
    """{picture: {protocol: {"bytes": .., "ms": ..}}}"""
    if not shutil.which("chafa"):
        raise Broken("chafa is not installed")
    figures = {name: {} for name in SIDES}
    with tempfile.TemporaryDirectory() as folder:
        draw(build, folder)
        write_dot(os.path.join(folder, "dot.png"))
        for protocol, by in FORMATS.items():
            start_ms = show(folder, "dot.png", by, 8)[1]
            for name, side in SIDES.items():
                shown, ms = show(folder, name + ".png", by, side)
                figures[name][protocol] = {"bytes": shown, "ms": max(ms - start_ms, 0)}
    return figures


def main():
    figures = measure(sys.argv[-1])
    if "--json" in sys.argv[1:-1]:
        print(json.dumps(figures))
        return
    print(" " * 20 + "".join(f"{protocol:>16}" for protocol in FORMATS))
    print(" " * 20 + f"{'kB':>9} {'ms':>6}" * len(FORMATS))
    for name, by in figures.items():
        words = (f"{f['bytes'] / 1000:9.2f} {f['ms']:6.2f}" for f in by.values())
        print(f"chafa: {name:<13}" + "".join(words))


leave_by(main)
