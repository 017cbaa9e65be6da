#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What people see: the program in real terminals, by screenshot.

    tests/terminals/run.py BUILD [WORD...]    only stories with one of these words in their names

Ends with "N passed, N failed, 0 skipped" as tests/run.sh does; nothing is skipped: a terminal that
does not start has failed. `make test-terminals` installs what this needs.

What ought to be seen is never another screenshot of the same bytes. A picture is compared with the
pixels that went into it, and the rest of its screen, to the pixel, with what the same session shows
under --graphics none, moved down where the picture has made room. So questions that a terminal
prints, cut pictures, and lines in the wrong place all show."""
import cmath
import contextlib
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from PIL import Image, ImageChops

from terminals import (KINDS, Patience, Room, TerminalFailed, fresh_folder, same_pixels, wait_file)

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
        for name in ("iftty", "iftty-image", "tests/terminals/paint", "tests/terminals/panel"):
            shutil.copy(os.path.join(build, name), self.programs)
        self.iftty = os.path.join(self.programs, "iftty")
        self.kept = os.path.join(build, "terminals")  # screenshots of what failed

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


def paint(stage, name, title, edits, place, how=None):
    """A known picture and edits of it; every pixel in its place, and black around it."""
    story = "%s: %s" % (name, title)
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        folder = fresh_folder(stage.room, "paint")
        program = [os.path.join(stage.programs, "paint"), folder, "7", str(edits)] + place.split()
        program += [how] if how else []
        with stage.room.start(name, program, folder) as terminal:
            if not wait_file(os.path.join(folder, "ready"), seconds=60):
                raise Failure("the terminal has not answered: it has not parsed all")
            facts, kind = read_facts(folder), KINDS[name]
            graphics = "tiles" if how == "tiles" else kind.graphics
            if facts["graphics"] != graphics:
                raise Failure("graphics are %s, expected %s" % (facts["graphics"], graphics))
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
        paint(stage, name, "a picture that fills the window but its last row, and 60 edits",
              60, "0 0 0 0")
    paint(stage, "kitty", "the same without frame edits, as tiles", 60, "3 2 60 30", "tiles")
    paint(stage, "kitty", "labels over slices that live in the terminal", 60, "3 2 60 30", "slices")


# ---- the prompt ----

SCENE = ("open synth:geom:64x64x64", "auto on", "size 240 180", "label 1 ball",
         "seed 32,32,32 ball radius=5", "seed 2,2,2 0", "zoom fit")
SHADES_APART = 24  # of 255: a rendition's shades are rounded to those of a palette, along a line
                   # from dark to lit to shining, and what shines in the dark lies beside it;
COLOURS_APART = 60  # and what is laid over slices to fewer


class Prompt:
    """iftty at the prompt of a shell, in a folder of its own."""

    def __init__(self, stage, name, graphics, shell=("/bin/sh",), **environment):
        self.stage, self.name = stage, name
        self.folder = fresh_folder(stage.room, "prompt")
        self.journal = os.path.join(self.folder, "j.iftty")
        self.records = 0
        self.terminal = stage.room.start(
            name, list(shell), self.folder,
            IFTTY="%s --graphics %s --smooth --journal j.iftty" % (stage.iftty, graphics),
            **environment)
        self.terminal.settled()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.terminal.close()

    def begin(self):
        self.terminal.type("clear; $IFTTY\n")
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
        kind = KINDS[name]
        self.left, self.top = kind.origin
        if kind.cells:
            self.width, self.height, self.rows = kind.cells
            self.columns = 0  # nobody asks
            return
        folder = fresh_folder(stage.room, "cells")
        program = [os.path.join(stage.programs, "paint"), folder, "1", "0", "0", "0", "1", "1"]
        with stage.room.start(name, program, folder):
            if not wait_file(os.path.join(folder, "ready")):
                raise TerminalFailed(name + " does not say how large its cells are")
            facts = read_facts(folder)
        self.width, self.height, self.columns, self.rows = (
            int(facts[what]) for what in ("cell_width", "cell_height", "columns", "rows"))

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


# ---- the pilot ----

# keys as typed, or by name; the last leaves the coronal pane marked
KEYS = ("l", "l", "9k", "s3", "Tab", "6j", "s4", "x", "Escape", "u", "shift+Right", "r", "+", "s2",
          "Z", "h")
ROUNDED_MEAN = 3  # of 255,
ROUNDED_MOST = 0.002  # and the share of pixels further off than COLOURS_APART: of cross-hairs, say


def panel(stage, cells, journal):
    """What the pilot's picture ought to be, from the journal alone."""
    folder = fresh_folder(stage.room, "panel")
    path = os.path.join(folder, "expected.ppm")
    subprocess.run([os.path.join(stage.programs, "panel"), journal,
                    str(cells.columns), str(cells.rows - 2), str(cells.width), str(cells.height),
                    "1", path], check=True)
    with Image.open(path) as picture:
        return picture.convert("RGB")


def same_panel(cells, shot, expected):
    """The picture, up to how its colours are rounded; nothing beside it but two rows of text."""
    right = cells.left + expected.width
    bottom = cells.top + expected.height
    found = shot.crop((cells.left, cells.top, right, bottom))
    mean, share = mean_apart(found, expected), share_apart(found, expected, COLOURS_APART)
    if mean > ROUNDED_MEAN or share > ROUNDED_MOST:
        return "the picture is %.2f of 255 from the right one, %.2f %% of its pixels by %d: %s" % (
            mean, 100 * share, COLOURS_APART, same_pixels(found, expected, COLOURS_APART))
    rest = shot.copy()
    rest.paste(Image.new("RGB", (shot.width, 2 * cells.height)), (0, bottom))
    rest.paste(Image.new("RGB", expected.size), (cells.left, cells.top))
    return same_pixels(rest, Image.new("RGB", rest.size))


def press_keys(terminal):
    terminal.type("pilot\n")
    terminal.settled()
    for key in KEYS:
        if len(key) > 2:
            terminal.press(key)
        else:
            terminal.type(key)
        if key == "Escape":  # with the next one at once, it would be Alt
            terminal.settled()
    terminal.settled(0.6)


def check_commands(stage, prompt):
    """Ends the pilot and the session, whose journal has the commands of the keys."""
    for text in ("q", "quit\n"):
        prompt.terminal.type(text)
        prompt.terminal.settled()
    with open(prompt.journal) as lines:
        commands = [line.split()[0] for line in lines if line[0] not in "=#\n"]
    missing = {"cross", "seed", "undo", "turn", "zoom"} - set(commands)
    if missing:
        raise Failure("not in the journal: " + ", ".join(sorted(missing)))
    subprocess.run([stage.iftty, "verify", "--no-strict", prompt.journal], check=True,
                   stdout=subprocess.DEVNULL)


def drive(stage, name):
    story = name + ": the pilot shows what its journal says"
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        cells = Cells(stage, name)
        with Prompt(stage, name, "auto") as prompt:
            prompt.open_scene()
            press_keys(prompt.terminal)
            expected = panel(stage, cells, prompt.journal)
            stage.need_screen(prompt.terminal, story,
                              lambda shot: same_panel(cells, shot, expected))
            # Sixel has the palette of what went whole last; which that was, the pace of keys says.
            if name != "kitty":
                prompt.terminal.press("ctrl+l")
                prompt.terminal.settled(0.6)
                stage.need_screen(prompt.terminal, story,
                                  lambda shot: same_panel(cells, shot, expected))
            # On a busy machine tiles get fine slowly: what comes next waits 2 s for an answer,
            shown = prompt.terminal.settled(2.5)
            prompt.terminal.press("ctrl+l")
            prompt.terminal.settled(0.6)  # and here as well
            words = prompt.terminal.wait_screen(lambda shot: same_pixels(shown, shot))
            if words:
                stage.keep(story, shown=shown, anew=prompt.terminal.screenshot())
                raise Failure("drawn anew, it differs: " + words)
            check_commands(stage, prompt)


def like_panel(cells, shot, expected):
    """The picture made of text, roughly, and not that of another place."""
    box = (cells.left, cells.top, cells.left + expected.width, cells.top + expected.height)
    size = (cells.columns, 2 * (cells.rows - 2))
    found, wanted = (image.resize(size, Image.BOX) for image in (shot.crop(box), expected))
    others = [Image.new("RGB", size)] + [wanted.transpose(way) for way in (
        Image.Transpose.FLIP_LEFT_RIGHT, Image.Transpose.FLIP_TOP_BOTTOM)]
    apart, rest = mean_apart(found, wanted), [mean_apart(found, other) for other in others]
    return None if apart < 0.6 * min(rest) else (
        "the picture is %.1f of 255 from the right one, nothing %.1f, mirrored %.1f and %.1f" % (
            apart, *rest))


def drive_in_tmux(stage, name):
    """There pictures are made of text, unless tmux passes them on, as in placeholders."""
    story = name + ": tmux: the pilot shows what its journal says, in text"
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        cells = Cells(stage, name)
        config = write_file(stage, "tmux.conf", "set -g status off\nset -g destroy-unattached on\n"
                            "set -g default-shell /bin/sh\n")
        shell = ("tmux", "-u", "-S", os.path.join(stage.room.folder, "tmux-pilot"), "-f", config,
                 "new-session", "/bin/sh")
        with Prompt(stage, name, "auto", shell) as prompt:
            prompt.open_scene()
            press_keys(prompt.terminal)
            expected = panel(stage, cells, prompt.journal)
            stage.need_screen(prompt.terminal, story,
                              lambda shot: like_panel(cells, shot, expected))
            check_commands(stage, prompt)


def draw(stage, name):
    """A ring of some five voxels' radius, by the mouse: cells are as large as two and more."""
    story = name + ": an outline that the mouse draws by pixels has corners within cells"
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        cells = Cells(stage, name)
        middle = cells.columns * cells.width // 4 + 31, (cells.rows - 2) * cells.height // 4 + 23
        with Prompt(stage, name, "auto") as prompt:
            prompt.open_scene()
            prompt.terminal.type("pilot\nl")
            if not wait_file(prompt.journal, b"\ncross "):
                raise Failure("the pilot does not begin")
            prompt.terminal.settled()  # by now the terminal knows that it is to tell of clicks
            prompt.terminal.click(*middle)
            prompt.terminal.type("2b@")
            prompt.terminal.settled()
            ring = [cmath.rect(40, 2 * math.pi * i / 48) for i in range(48)]
            prompt.terminal.drag([(middle[0] + round(by.real), middle[1] + round(by.imag))
                                  for by in ring])
            if not wait_file(prompt.journal, b"\noutline "):
                raise Failure("no outline is planted")
            with open(prompt.journal) as lines:
                commands = [line.split() for line in lines]
            places = [place.split(",") for words in commands if words[:1] == ["outline"]
                      for place in [words[1]] + [w[3:] for w in words if w.startswith("to=")]]
            crosses = [words[1].split(",") for words in commands if words[:1] == ["cross"]]
            here = crosses[1]
            for axis in (0, 2):  # of the coronal slice, which is there
                at = sorted({int(place[axis]) for place in places})
                if len(at) < 6 or abs(at[0] + at[-1] - 2 * int(here[axis])) > 2:
                    raise Failure("around %s there are corners at %s" % (here, at))


def pilot_stories(stage):
    for name in GRAPHICAL:
        drive(stage, name)
    for name in ("kitty", "xterm"):
        drive_in_tmux(stage, name)
    for name in ("kitty", "xterm"):  # mlterm has no pixels, and for sway there is no mouse here
        draw(stage, name)


# ---- blocks, where there are no graphics ----


def same_blocks(cells, shot, plain, picture):
    """The text of `plain` to the pixel, and the picture between its last lines, roughly: blocks are
    few, and what they look like is the font's affair."""
    prompt, end = cells.last_row(plain), cells.last_row(shot)
    if end - prompt < 4:
        return "no picture"
    rows = end - prompt
    columns = 2 * rows * picture.width // picture.height + 1
    screen = Image.new("RGB", plain.size)
    cells.slide(plain, screen, 0, prompt, 0)
    cells.slide(plain, screen, prompt, 1, rows)
    place = (cells.left, cells.top + prompt * cells.height)
    size = (columns * cells.width, rows * cells.height)
    box = place + (place[0] + size[0], place[1] + size[1])
    found, shot = shot.crop(box).resize((columns, 2 * rows), Image.BOX), shot.copy()
    shot.paste(Image.new("RGB", size), box)
    words = same_pixels(shot, screen)
    if words:
        return "around the picture: " + words
    wanted = picture.resize((columns, 2 * rows), Image.BOX)
    apart = mean_apart(found, wanted)
    nothing = mean_apart(Image.new("RGB", wanted.size), wanted)
    # Sixteen colours, in the worst case, none of them orange.
    turned = [mean_apart(found, wanted.transpose(way))
              for way in (Image.Transpose.FLIP_LEFT_RIGHT, Image.Transpose.FLIP_TOP_BOTTOM)]
    return None if apart < 0.7 * nothing and apart < 0.9 * min(turned) else (
        "the picture is %.1f of 255 from the right one, %.1f and %.1f from it mirrored, nothing at "
        "all %.1f" % (apart, *turned, nothing))


def share_apart(one, other, tolerance):
    over = None
    for band in ImageChops.difference(one, other).split():
        band = band.point(lambda value: 255 if value > tolerance else 0)
        over = ImageChops.lighter(over, band) if over else band
    return over.histogram()[255] / (one.width * one.height)


def mean_apart(one, other):
    total = 0
    for band in ImageChops.difference(one, other).split():
        total += sum(value * count for value, count in enumerate(band.histogram()))
    return total / (3 * one.width * one.height)


def blocks(stage, name, where, shell=("/bin/sh",), **environment):
    story = "%s: %s: blocks, and nothing but text around them" % (name, where)
    if not stage.report.wants(story):
        return
    lines = ("view left", "render")
    with stage.report.story(story):
        cells = Cells(stage, name)
        with Prompt(stage, name, "none", shell, **environment) as prompt:
            prompt.open_scene()
            plain = prompt.commands(lines)
        picture = rendition(stage, ["view left"])
        with Prompt(stage, name, "auto", shell, **environment) as prompt:
            prompt.open_scene()
            prompt.commands(lines)
            stage.need_screen(prompt.terminal, story,
                              lambda shot: same_blocks(cells, shot, plain, picture))


def dumb(stage):
    """TERM=dumb: not one escape, so nothing differs from a session without graphics."""
    story = "xterm: TERM=dumb: text alone"
    if not stage.report.wants(story):
        return
    with stage.report.story(story):
        shots = []
        for graphics in ("none", "auto"):
            dumb = ("/usr/bin/env", "TERM=dumb", "/bin/sh")
            with Prompt(stage, "xterm", graphics, dumb) as prompt:
                prompt.begin()
                prompt.commands(["label 2 other"])  # what is typed ahead is echoed at any moment
                shots.append(prompt.commands(["size 100 100"]))
        need(same_pixels(shots[1], shots[0]))


def write_file(stage, name, text):
    path = os.path.join(stage.room.folder, name)
    with open(path, "w") as out:
        out.write(text)
    return path


def multiplexed(stage):
    """Inside tmux and GNU screen, which end with the terminal that they are shown in."""
    screen = write_file(stage, "screen.rc", "startup_message off\nautodetach off\nvbell off\n")
    os.makedirs(os.path.join(stage.room.folder, "screens"), mode=0o700, exist_ok=True)
    for passing in ("off", "on"):
        write_file(stage, "tmux.conf." + passing,
                   "set -g status off\nset -g destroy-unattached on\n"
                   "set -g allow-passthrough %s\nset -g default-shell /bin/sh\n" % passing)
    for name in ("xterm", "kitty"):
        for passing in ("off", "on"):
            folder = stage.room.folder
            shell = ("tmux", "-u", "-S", os.path.join(folder, "tmux-" + passing), "-f",
                     os.path.join(folder, "tmux.conf." + passing), "new-session", "/bin/sh")
            blocks(stage, name, "tmux, allow-passthrough " + passing, shell)
        # to one that is told no more, it shows eight colours
        blocks(stage, name, "GNU screen",
               ("/usr/bin/env", "TERM=xterm-256color", "screen", "-U", "-c", screen, "/bin/sh"),
               SCREENDIR=os.path.join(stage.room.folder, "screens"))


def silence_stories(stage):
    for name in ("pterm", "urxvt", "xterm without sixel"):
        blocks(stage, name, "no graphics")
    for name in ("xterm", "pterm", "urxvt"):
        blocks(stage, name, "TERM=linux", ("/usr/bin/env", "TERM=linux", "/bin/sh"))
    dumb(stage)
    multiplexed(stage)


# ---- leaving ----


def after(terminal, folder):
    """What a shell shows and what its modes are, for commands typed now."""
    modes = os.path.join(folder, "modes")
    with contextlib.suppress(FileNotFoundError):
        os.remove(modes)
    terminal.type("stty -a >modes; clear\n")
    if not wait_file(modes, b"eol", 10):
        raise Failure("the shell takes no commands")
    cleared = terminal.settled()
    terminal.type("echo ok\n")
    terminal.wait_screen(lambda shot: None if same_pixels(shot, cleared) else "nothing yet")
    shot = terminal.settled()
    with open(modes) as lines:
        return shot, lines.read()


def kill_program(stage, prompt, number):
    """The session, which began before its helpers did."""
    running = prompt.terminal.running(stage.iftty)
    if not running:
        raise Failure("the program does not run")
    os.kill(running[0], number)
    patience = Patience(10)
    while running[0] in prompt.terminal.running(stage.iftty):
        if patience.over():
            raise Failure("signal %d does not end it" % number)
        time.sleep(0.02)
    prompt.terminal.settled()


def leave(stage, name, how, expected):
    story = "%s: after %s the shell goes on as before" % (name, how)
    if not stage.report.wants(story):
        return
    with stage.report.story(story), Prompt(stage, name, "auto") as prompt:
        if how == "quit":
            prompt.open_scene()
            prompt.commands(["render"])
            prompt.terminal.type("quit\n")
            prompt.terminal.settled()
        elif how == "a quit typed ahead":
            prompt.terminal.type("clear; $IFTTY\nquit\n")
            prompt.terminal.settled()
        else:
            prompt.open_scene()
            prompt.commands(["render"])
            if "pilot" in how:
                prompt.terminal.type("pilot\n")
                prompt.terminal.settled()
            kill_program(stage, prompt, getattr(signal, how.split()[0]))
        shot, modes = after(prompt.terminal, prompt.folder)
        if modes != expected[1]:
            raise Failure("its modes are\n" + modes + "expected\n" + expected[1])
        words = same_pixels(shot, expected[0])
        if words:
            stage.keep(story, actual=shot, expected=expected[0])
            raise Failure(words)


def leaving_stories(stage):
    for name in GRAPHICAL + ("pterm", "urxvt"):
        if not stage.report.wants(name + ": after leaving the shell goes on as before"):
            continue
        folder = fresh_folder(stage.room, "prompt")
        with stage.room.start(name, ["/bin/sh"], folder) as terminal:
            terminal.settled()
            expected = after(terminal, folder)
        for how in ("quit", "a quit typed ahead", "SIGTERM", "SIGSEGV", "SIGKILL",
                    "SIGTERM in the pilot", "SIGKILL in the pilot"):
            if name in GRAPHICAL or how in ("quit", "SIGKILL in the pilot"):
                leave(stage, name, how, expected)


def tell(room, build, words):
    report = Report(words)
    stage = Stage(room, build, report)
    painter_stories(stage)
    prompt_stories(stage)
    pilot_stories(stage)
    silence_stories(stage)
    leaving_stories(stage)
    return report


def run_here(build, words):
    with tempfile.TemporaryDirectory(prefix="iftty-terminals-") as folder:
        os.chmod(folder, 0o755)
        with Room(folder) as room:
            return tell(room, build, words)


def run_beside(build):
    """Each terminal's stories in a process of their own, one for each core: most of it is waiting.
    What they say comes one after the other."""
    shutil.rmtree(os.path.join(build, "terminals"), ignore_errors=True)
    report, running, waiting = Report([]), [], [name + ":" for name in KINDS]
    while waiting or running:
        while waiting and len(running) < (os.cpu_count() or 1):
            running.append(subprocess.Popen(
                ["setpriv", "--pdeathsig", "TERM", sys.executable, "-B", __file__, build,
                 waiting.pop(0)], stdout=subprocess.PIPE, text=True))
        process = running.pop(0)
        for line in process.communicate()[0].splitlines():
            good, bad = line.startswith("ok "), line.startswith("not ok ")
            report.passed += good
            report.failed += bad
            if good or bad:
                line = re.sub("[0-9]+", str(report.passed + report.failed), line, count=1)
            if not re.fullmatch("[0-9]+ passed, [0-9]+ failed, 0 skipped", line):
                print(line, flush=True)
        if process.returncode not in (0, 1):
            report.failed += 1
            print("not ok %d - it ended with status %d" % (report.passed + report.failed,
                                                           process.returncode))
    return report


def main():
    build = os.path.abspath(sys.argv[1])
    # an end from outside is an end like any other: what was started goes too
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: sys.exit(2))
    report = run_here(build, sys.argv[2:]) if sys.argv[2:] else run_beside(build)
    print("%d passed, %d failed, 0 skipped" % (report.passed, report.failed))
    return 1 if report.failed or not report.passed else 0


if __name__ == "__main__":
    sys.exit(main())
