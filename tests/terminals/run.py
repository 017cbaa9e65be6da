#!/usr/bin/python3
"""What people see: the program in real terminals, by screenshot.

    tests/terminals/run.py BUILD [WORD...]    only stories with one of these words in their names

Ends with "N passed, N failed" as tests/run.sh does; nothing is skipped: a terminal that does not
start has failed. `make test-terminals` installs what this needs.

What ought to be seen is never another screenshot of the same bytes. A picture is compared with the
pixels that went into it: all of them, and the rest of its screen with what the same session shows
under --graphics none, moved down where the picture has made room. Where there are no graphics, the
same keys under --graphics blocks, which asks the terminal nothing, give the expected screen.
"""
import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from PIL import Image

from terminals import (KINDS, Room, TerminalFailed, fresh_folder, same_pixels, wait_file)

GRAPHICAL = ("xterm", "kitty", "mlterm", "foot")


class Failure(Exception):
    """A story is not as it should be."""


class Report:
    def __init__(self, words):
        self.words, self.passed, self.failed = words, 0, 0

    @contextlib.contextmanager
    def story(self, name):
        """Counts what happens inside as one story; what goes wrong in it ends it alone."""
        begin, trouble = time.monotonic(), None
        try:
            yield
        except (Failure, TerminalFailed, OSError, subprocess.SubprocessError) as error:
            trouble = str(error) or repr(error)
        self.passed += trouble is None
        self.failed += trouble is not None
        if trouble:
            print("# " + trouble.replace("\n", "\n# "))
        print("%s %d - %s (%.1f s)" % ("not ok" if trouble else "ok", self.passed + self.failed,
                                       name, time.monotonic() - begin), flush=True)

    def wants(self, name):
        return not self.words or any(word in name for word in self.words)


def need(words):
    if words:
        raise Failure(words)


class Stage:
    """A room with the programs in it, where whoever runs a terminal can read them."""

    def __init__(self, room, build, report):
        self.room, self.report = room, report
        self.programs = os.path.join(room.folder, "bin")
        os.makedirs(self.programs)
        for name in ("iftty", "iftty-image", "tests/terminals/paint"):
            shutil.copy(os.path.join(build, name), self.programs)
        self.iftty = os.path.join(self.programs, "iftty")
        self.kept = os.path.join(build, "terminals")  # screenshots of what failed
        shutil.rmtree(self.kept, ignore_errors=True)

    def keep(self, name, **images):
        """Leaves the pictures of a failure where they can be looked at."""
        os.makedirs(self.kept, exist_ok=True)
        for what, image in images.items():
            path = os.path.join(self.kept, "%s-%s.png" % (name.replace(" ", "-"), what))
            image.save(path)
        print("# the screenshots are in " + self.kept)

    def need_screen(self, terminal, name, good, seconds=10.0):
        words = terminal.wait_screen(good, seconds)
        if words:
            self.keep(name, actual=terminal.screenshot())
            raise Failure(words)


# ---- the painter ----


def read_facts(folder):
    facts = {}
    with open(os.path.join(folder, "facts")) as lines:
        for line in lines:
            name, value = line.split()
            facts[name] = value if name == "graphics" else float(value)
    return facts


def paint(stage, name, title, edits, place):
    """A known picture and edits of it; every pixel in its place, and black around it."""
    story = "%s: %s" % (name, title)
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        folder = fresh_folder(stage.room, "paint")
        program = [os.path.join(stage.programs, "paint"), folder, "7", str(edits)] + place.split()
        with stage.room.start(name, program, folder) as terminal:
            if not wait_file(os.path.join(folder, "ready"), seconds=60):
                raise Failure("the terminal has not answered: it has not parsed all")
            facts, kind = read_facts(folder), KINDS[name]
            if facts["graphics"] != kind.graphics:
                raise Failure("graphics are %s, expected %s" % (facts["graphics"], kind.graphics))
            with Image.open(os.path.join(folder, "expected.ppm")) as picture:
                expected = picture.convert("RGB")
            x = kind.origin[0] + int(facts["column"] * facts["cell_width"])
            y = kind.origin[1] + int(facts["row"] * facts["cell_height"])
            screen = Image.new("RGB", terminal.screenshot().size)
            screen.paste(expected, (x, y))
            stage.need_screen(terminal, story,
                              lambda shot: same_pixels(shot, screen, kind.tolerance))
            print("# %dx%d pixels: %d bytes, edits %d bytes, parsed in %d ms" % (
                expected.size + tuple(facts[n] for n in ("first_bytes", "edit_bytes", "ms"))))


def painter_stories(stage):
    for name in GRAPHICAL:
        paint(stage, name, "a full picture, down to the pixel", 0, "3 2 60 30")
        paint(stage, name, "the same after 60 edits", 60, "3 2 60 30")
        paint(stage, name, "a picture that fills the window but its last row, and 60 edits", 60, "0 0 0 0")


# ---- the prompt ----

SCENE = ("open synth:geom:64x64x64", "size 240 180", "label 1 ball", "seed 32,32,32 ball radius=5",
         "seed 2,2,2 0", "zoom fit")
SHADES_APART = 12  # of 255: a rendition's shades are rounded to those of a palette


class Prompt:
    """iftty at the prompt of a shell, in a folder of its own."""

    def __init__(self, stage, name, graphics, shell=("/bin/sh",), options="", **environment):
        self.stage, self.name = stage, name
        self.folder = fresh_folder(stage.room, "prompt")
        self.journal = os.path.join(self.folder, "j.iftty")
        self.records = 0
        self.terminal = stage.room.start(name, list(shell), self.folder, **environment)
        self.terminal.settled()
        self.graphics, self.options = graphics, options

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.terminal.close()

    def begin(self):
        self.terminal.type("clear; %s --graphics %s --journal j.iftty %s\n" % (
            self.stage.iftty, self.graphics, self.options))
        if not wait_file(self.journal):
            raise Failure("the program does not start")
        self.terminal.settled()

    def commands(self, lines):
        """Types them, and waits until the last one is in the journal and its answer shown."""
        self.terminal.type("\n".join(lines) + "\n")
        self.records += len(lines)
        if not wait_file(self.journal, b"\n= %d " % self.records):
            raise Failure("%s: record %d does not come: %s" % (self.name, self.records, lines[-1]))
        return self.terminal.settled()

    def open_scene(self):
        """Opens and seeds it; what the commands have said, times among it, is cleared away."""
        self.begin()
        self.commands(SCENE)
        self.terminal.press("ctrl+l")
        self.terminal.settled()


def rendition(stage, last=()):
    """What the program itself writes into a file, in another process."""
    folder = fresh_folder(stage.room, "rendition")
    lines = "; ".join(SCENE + tuple(last) + ("render r.png",))
    subprocess.run([stage.iftty, "-c", lines], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    with Image.open(os.path.join(folder, "r.png")) as picture:
        return picture.convert("RGB")


class Cells:
    """Where the rows of a terminal lie in its screenshot."""

    def __init__(self, stage, name):
        folder = fresh_folder(stage.room, "cells")
        program = [os.path.join(stage.programs, "paint"), folder, "1", "0", "0", "0", "1", "1"]
        with stage.room.start(name, program, folder):
            if not wait_file(os.path.join(folder, "ready")):
                raise TerminalFailed(name + " does not say how large its cells are")
            facts = read_facts(folder)
        self.height, self.rows = int(facts["cell_height"]), int(facts["rows"])
        self.left, self.top = KINDS[name].origin

    def last_row(self, shot):
        """The last row that has something on it: that of the prompt."""
        return (shot.getbbox()[3] - 1 - self.top) // self.height

    def slide(self, shot, to, first, count, by):
        """Puts `count` rows of `shot` from `first` on into `to`, `by` rows further down."""
        top, height = self.top + first * self.height, count * self.height
        to.paste(shot.crop((0, top, shot.width, top + height)), (0, top + by * self.height))


def expected_inline(cells, plain, picture):
    """The screen with the picture above the last line of `plain`, and where the picture is."""
    prompt = cells.last_row(plain)
    rows = -(-picture.height // cells.height)
    gone = max(0, prompt + rows + 1 - cells.rows)  # scrolled away
    screen = Image.new("RGB", plain.size)
    cells.slide(plain, screen, gone, prompt - gone, -gone)
    cells.slide(plain, screen, prompt, 1, rows - gone)
    place = (cells.left, cells.top + (prompt - gone) * cells.height)
    screen.paste(picture, place)
    return screen, place + (place[0] + picture.width, place[1] + picture.height)


def same_inline(shot, screen, box, apart):
    """Every pixel of the text, and the picture up to how its shades are rounded."""
    words = same_pixels(shot.crop(box), screen.crop(box), apart)
    if words:
        return "the picture: " + words
    black = Image.new("RGB", (box[2] - box[0], box[3] - box[1]))
    shot, screen = shot.copy(), screen.copy()
    shot.paste(black, box)
    screen.paste(black, box)
    words = same_pixels(shot, screen)
    return words and "around the picture: " + words


def inline(stage, name, cells):
    lines = ("view left", "render")
    later = ("zoom fit", "view left", "render") # at the end of a full screen
    shots = {}
    picture = rendition(stage, ["view left"])
    with stage.report.story(name + ": a rendition at the prompt, in its place between the lines"):
        with Prompt(stage, name, "none") as prompt:
            prompt.open_scene()
            plain = prompt.commands(lines)
            prompt.terminal.press("ctrl+l")
            low = prompt.commands(["view left"] * (cells.rows - 8) + ["render"])
            filled = prompt.commands(["view left"] * cells.rows + list(later[:2]))
        prompt = Prompt(stage, name, "auto")
        shots["prompt"] = prompt
        prompt.open_scene()
        prompt.commands(lines)
        screen, box = expected_inline(cells, plain, picture)
        stage.need_screen(prompt.terminal, name + " inline",
                          lambda shot: same_inline(shot, screen, box, SHADES_APART))
    if "prompt" not in shots:
        return
    with shots["prompt"] as prompt:
        with stage.report.story(name + ": a rendition that scrolls the screen"):
            prompt.terminal.press("ctrl+l")
            prompt.commands(["view left"] * (cells.rows - 8) + ["render"])
            screen, box = expected_inline(cells, low, picture)
            stage.need_screen(prompt.terminal, name + " inline low",
                              lambda shot: same_inline(shot, screen, box, SHADES_APART))
        with stage.report.story(name + ": after many commands nothing of the pictures is left"):
            prompt.commands(["view left"] * cells.rows + list(later[:2]))
            stage.need_screen(prompt.terminal, name + " scrolled",
                              lambda shot: same_pixels(shot, filled))


def prompt_stories(stage):
    for name in GRAPHICAL:
        if stage.report.wants(name + ": at the prompt"):
            inline(stage, name, Cells(stage, name))


def tell(room, build, words):
    report = Report(words)
    stage = Stage(room, build, report)
    painter_stories(stage)
    prompt_stories(stage)
    return report


def main():
    build = os.path.abspath(sys.argv[1])
    # an end from outside is an end like any other: what was started goes too
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: sys.exit(1))
    with tempfile.TemporaryDirectory(prefix="iftty-terminals-") as folder:
        os.chmod(folder, 0o755)
        with Room(folder) as room:
            report = tell(room, build, sys.argv[2:])
    print("%d passed, %d failed" % (report.passed, report.failed))
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main())
