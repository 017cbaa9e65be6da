# SPDX-License-Identifier: MIT
"""Real terminals, started headless one at a time: a program in each, keys, and what is painted.

An X server of our own (Xvfb) bears xterm, kitty, mlterm, pterm and urxvt; a sway of our own,
without a screen and drawn by pixman, bears foot. Nothing of the user's is read, and every process
dies with this one, even where it is killed: each is started by `setpriv --pdeathsig`.

    with Room(folder) as room:
        with room.start("kitty", ["/bin/sh"], cwd) as terminal:
            terminal.type("echo ok\n")
            terminal.screenshot()               an image, RGB

A terminal may need a moment to paint what it has parsed, so pictures are polled for. Keys go by
XTEST into the focused window, because xterm takes no others; foot gets them by wtype."""
import io
import os
import shutil
import signal
import subprocess
import time

from PIL import Image, ImageChops, ImageGrab

NOBODY = 65534  # sway does not run as root
WIDTH, HEIGHT = 1280, 1100
PATIENCE = 20.0  # seconds; a slow machine shares its cores


class TerminalFailed(Exception):
    """A terminal, or what bears it, does not start or has died."""


class Kind:
    """What is known of a terminal before it starts."""

    def __init__(self, command, origin=(0, 0), tolerance=0, graphics="blocks", x11=True,
                 cells=None):
        self.command = command  # what is run, with the program in it appended
        self.origin = origin  # px: where its first cell begins in the screenshot
        self.tolerance = tolerance  # of 255: sixel colours are whole percents
        self.graphics = graphics  # what iftty should find it can do
        self.x11 = x11
        self.cells = cells  # px: width and height of one, where what it tells is nonsense; rows


XTERM = ["xterm", "-geometry", "140x60+0+0", "-fn", "fixed", "-b", "0", "-bw", "0", "+sb", "-bg",
         "black", "-fg", "white", "-xrm", "XTerm*cursorBlink: false", "-u8"]
KINDS = {
    "xterm": Kind(XTERM + ["-ti", "vt340", "-e"], tolerance=2, graphics="sixel"),
    "kitty": Kind(["kitty", "--config", "NONE", "-o", "remember_window_size=no",
                   "-o", "initial_window_width=120c", "-o", "initial_window_height=50c",
                   "-o", "window_padding_width=0", "-o", "window_margin_width=0",
                   "-o", "window_border_width=0", "-o", "draw_minimal_borders=yes",
                   "-o", "placement_strategy=top-left", "-o", "hide_window_decorations=yes",
                   "-o", "confirm_os_window_close=0", "-o", "update_check_interval=0",
                   "-o", "cursor_blink_interval=0", "-o", "shell_integration=disabled",
                   "-o", "enable_audio_bell=no", "-o", "visual_bell_duration=0"],
                  graphics="kitty"),
    "mlterm": Kind(["mlterm", "--geometry", "120x50+0+0", "--sbmod=none", "--borderless=true",
                    "--bg", "black", "--fg", "white", "--bel=none", "-e"],
                   origin=(2, 2), tolerance=2, graphics="sixel"),
    "foot": Kind(["foot", "--config=/dev/null", "-o", "pad=0x0", "-o", "csd.preferred=none",
                  "-o", "colors.background=000000", "-o", "cursor.blink=no",
                  # what sway makes of it anyway, but from the start
                  "-o", "initial-window-size-pixels=%dx%d" % (WIDTH, HEIGHT)],
                 tolerance=2, graphics="sixel", x11=False),
    # Without graphics, and without mercy for questions that they do not know.
    "xterm without sixel": Kind(XTERM + ["-e"], cells=(6, 13, 60)),
    "pterm": Kind(["pterm", "-geometry", "100x50+0+0", "-fn", "server:fixed", "+sb",
                   "-e"], origin=(1, 1), cells=(6, 13, 50)),
    "urxvt": Kind(["urxvt", "-geometry", "100x50+0+0", "-fn", "fixed", "+sb", "-b", "0", "-bg",
                   "black", "-fg", "white", "-e"], cells=(6, 13, 50)),
}
SWAY = """output HEADLESS-1 resolution %dx%d position 0,0
default_border none
default_floating_border none
hide_edge_borders both
gaps inner 0
focus_follows_mouse no
""" % (WIDTH, HEIGHT)


def same_pixels(one, other, tolerance=0):
    """None where no channel of no pixel differs by more; else words about the difference."""
    if one.size != other.size:
        return "%dx%d pixels, expected %dx%d" % (one.size + other.size)
    bands = ImageChops.difference(one, other).split()
    if max(band.getextrema()[1] for band in bands) <= tolerance:
        return None
    over = None
    for band in bands:
        band = band.point(lambda value: 255 if value > tolerance else 0)
        over = ImageChops.lighter(over, band) if over else band
    box = over.getbbox()
    x = next(x for x in range(box[0], box[2]) if over.getpixel((x, box[1])))
    return "%d pixels differ, in %d,%d..%d,%d; at %d,%d %r, expected %r" % (
        over.histogram()[255], box[0], box[1], box[2] - 1, box[3] - 1, x, box[1],
        one.getpixel((x, box[1])), other.getpixel((x, box[1])))


class Patience:
    """Time that counts only while everything runs: a machine that is busy elsewhere, or stopped for
    a while, is no terminal that does not answer."""

    def __init__(self, seconds=PATIENCE):
        self.left, self.last = seconds, time.monotonic()

    def over(self):
        now = time.monotonic()
        self.left -= min(now - self.last, 0.2)
        self.last = now
        return self.left < 0


class Room:
    """The display servers and the folder in which terminals live."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = []
        self.display = None
        self.sway_environment = None
        self.user = NOBODY if os.geteuid() == 0 else None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            end_process(process)

    def spawn(self, command, environment, cwd=None, name=None, user=None, **more):
        """A process in a group of its own, which ends when we do."""
        log = open(os.path.join(self.folder, (name or command[0]) + ".log"), "wb")
        as_user = [] if user is None else ["--reuid=%d" % user, "--regid=%d" % user,
                                           "--clear-groups"]
        with log:
            process = subprocess.Popen(
                ["setpriv"] + as_user + ["--pdeathsig", "KILL"] + command, stdin=subprocess.DEVNULL,
                stdout=log, stderr=log, cwd=cwd or self.folder, start_new_session=True,
                env=environment, **more)
        self.processes.append(process)
        return process

    def environment(self, **more):
        """Nothing of the user's, but what tests may set."""
        home = os.path.join(self.folder, "home")
        os.makedirs(home, exist_ok=True)
        config = shutil.copy("tests/bare.config", self.folder)  # the checkout may be root's alone
        if self.user is not None:
            os.chown(home, self.user, self.user)
        return dict({"PATH": os.environ["PATH"], "HOME": home, "LANG": "C.UTF-8",
                     "LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe",
                     "IFTTY_CONFIG": os.path.abspath(config),
                     "ENV": "", "PS1": "$ "}, **more)

    def is_busy(self):
        """Whether a thread in the room runs, or would if others let it: on a machine that is busy
        elsewhere, what it has to say may be long in coming."""
        room = os.path.realpath(self.folder)
        for number in filter(str.isdigit, os.listdir("/proc")):
            process = "/proc/" + number
            try:
                where = os.readlink(process + "/cwd")
                threads = os.listdir(process + "/task") if where.startswith(room) else []
                for thread in threads:
                    with open("%s/task/%s/stat" % (process, thread)) as stat:
                        if stat.read().rpartition(")")[2].split()[0] in "RD":
                            return True
            except OSError:  # ended, or somebody else's
                pass
        return False

    def need_x(self):
        if self.display:
            return
        read_end, write_end = os.pipe()
        process = self.spawn(["Xvfb", "-displayfd", str(write_end), "-screen", "0",
                              "%dx%dx24" % (WIDTH, HEIGHT), "-nolisten", "tcp", "-noreset"],
                             self.environment(), pass_fds=[write_end])
        os.close(write_end)
        with os.fdopen(read_end) as told:  # its number, or the end where it dies
            number = told.readline().strip()
        if not number or process.poll() is not None:
            raise TerminalFailed("Xvfb does not start: " + self.log("Xvfb"))
        self.display = ":" + number

    def need_sway(self):
        if self.sway_environment:
            return
        runtime = os.path.join(self.folder, "wayland")
        os.makedirs(runtime, mode=0o700, exist_ok=True)
        if self.user is not None:
            os.chown(runtime, self.user, self.user)
        config = os.path.join(self.folder, "sway.config")
        with open(config, "w") as out:
            out.write(SWAY)
        environment = self.environment(XDG_RUNTIME_DIR=runtime, WLR_BACKENDS="headless",
                                       WLR_LIBINPUT_NO_DEVICES="1", WLR_RENDERER="pixman")
        process = self.spawn(["sway", "-c", config], environment, user=self.user)
        socket = os.path.join(runtime, "wayland-1")
        patience = Patience()
        while not os.path.exists(socket):
            if process.poll() is not None or patience.over():
                raise TerminalFailed("sway does not start: " + self.log("sway"))
            time.sleep(0.05)
        self.sway_environment = dict(environment, WAYLAND_DISPLAY="wayland-1")

    def log(self, name):
        try:
            with open(os.path.join(self.folder, name + ".log"), errors="replace") as log:
                return log.read()[-300:]
        except OSError:
            return ""

    def start(self, name, program, cwd, **environment):
        """The terminal with `program` in it, `cwd` its folder. Tried twice."""
        try:
            return Terminal(self, name, program, cwd, environment)
        except TerminalFailed as first:
            try:
                return Terminal(self, name, program, cwd, environment)
            except TerminalFailed as second:
                raise TerminalFailed("%s; again: %s" % (first, second)) from None


def end_process(process):
    """Its whole group, at once: nothing in it has anything to save."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass
    process.wait()


class Terminal:
    def __init__(self, room, name, program, cwd, more):
        self.room, self.name, self.kind = room, name, KINDS[name]
        self.process = None
        if self.kind.x11:
            room.need_x()
            self.base = room.environment(DISPLAY=room.display)
        else:
            room.need_sway()
            self.base = room.sway_environment
        self.process = room.spawn(
            self.kind.command + program, dict(self.base, **more), cwd, self.kind.command[0],
            None if self.kind.x11 else room.user)
        try:
            if self.kind.x11:
                self.focus()
        except TerminalFailed:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        end_process(self.process)
        if self.process in self.room.processes:
            self.room.processes.remove(self.process)
        # the next screenshot must not see this window
        patience = Patience()
        while self.kind.x11 and self.screenshot().getextrema() != ((0, 0),) * 3:
            if patience.over():
                break
            time.sleep(0.02)

    def tool(self, *command):
        user = None if self.kind.x11 else self.room.user
        as_user = [] if user is None else ["setpriv", "--reuid=%d" % user, "--regid=%d" % user,
                                           "--clear-groups"]
        return subprocess.run(as_user + list(command), env=self.base, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, check=False, timeout=60).stdout

    def running(self, path):
        """The processes that run this program, which is nobody else's."""
        found = []
        for number in filter(str.isdigit, os.listdir("/proc")):
            try:
                if os.readlink("/proc/%s/exe" % number) == path:
                    found.append(int(number))
            except OSError:  # ended, or a kernel thread
                pass
        return sorted(found)

    def alive(self):
        if self.process.poll() is not None:
            raise TerminalFailed("%s ended: %s" % (self.name, self.room.log(self.kind.command[0])))

    def focus(self):
        """Waits for its window, and gives it the keys."""
        patience = Patience()
        while not patience.over():
            self.alive()
            windows = self.tool("xdotool", "search", "--onlyvisible", "--class", ".").split()
            if windows:
                window = windows[-1].decode()
                self.tool("xdotool", "mousemove", "%d" % (WIDTH - 1), "%d" % (HEIGHT - 1),
                          "windowfocus", "--sync", window)
                return
            time.sleep(0.05)
        raise TerminalFailed("%s shows no window" % self.name)

    def type(self, text):
        """Types it; a line feed is Enter."""
        if not self.kind.x11:
            self.wtype(text)
            return
        for i, line in enumerate(text.split("\n")):
            if i > 0:
                self.press("Return")
            if line:
                self.tool("xdotool", "type", "--delay", "2", line)

    def press(self, *keys):
        """Keys by the names of X: Return, Left, Escape, ctrl+c."""
        for key in keys:
            if self.kind.x11:
                self.tool("xdotool", "key", "--delay", "2", key)
                continue
            *held, last = key.split("+")
            self.wtype(*sum((["-M", name] for name in held), []), "-k", last)

    def click(self, x, y):
        """The mouse, at a pixel of the text. A click at once with its coming into the window is for
        kitty where it has been before."""
        self.tool("xdotool", "mousemove", *self.pixel(x, y - 1), "sleep", "0.2",
                  "mousemove", *self.pixel(x, y), "click", "1")

    def drag(self, places):
        """With the left button, from pixel to pixel."""
        self.tool("xdotool", "mousemove", *self.pixel(*places[0]), "mousedown", "1")
        for place in places:
            self.tool("xdotool", "mousemove", *self.pixel(*place))
            time.sleep(0.02)
        self.tool("xdotool", "mouseup", "1")

    def pixel(self, x, y):
        return "%d" % (self.kind.origin[0] + x), "%d" % (self.kind.origin[1] + y)

    def wtype(self, *keys):
        """Each wtype is a keyboard of its own, of which the first and last keys would be lost in
        its coming and going."""
        self.tool("wtype", "-s", "60", "-d", "2", *keys, "-s", "60")

    def screenshot(self):
        if self.kind.x11:
            return ImageGrab.grab(xdisplay=self.room.display).convert("RGB")
        picture = self.tool("grim", "-t", "ppm", "-")
        return Image.open(io.BytesIO(picture)).convert("RGB")

    def wait_screen(self, good, seconds=10.0):
        """Polls until good(screenshot) returns None; else its last words."""
        patience = Patience(seconds)
        while True:
            self.alive()
            words = good(self.screenshot())
            if words is None or patience.over():
                return words
            time.sleep(0.05)

    def settled(self, quiet=0.3):
        """A screenshot that has not changed for `quiet` seconds in which all in the room slept: who
        is looked at first may be woken by who is looked at last."""
        last, patience, most = self.screenshot(), Patience(quiet), Patience()
        while not patience.over():
            self.alive()
            time.sleep(0.05)
            now = self.screenshot()
            if ImageChops.difference(last, now).getbbox():
                last, patience = now, Patience(quiet)
            elif self.room.is_busy() and not most.over():
                patience = Patience(quiet)
        return last


def wait_file(path, contains=None, seconds=PATIENCE):
    """False where the file, with these bytes in it, does not come."""
    patience = Patience(seconds)
    while not patience.over():
        try:
            with open(path, "rb") as there:
                if contains is None or contains in there.read():
                    return True
        except OSError:
            pass
        time.sleep(0.02)
    return False


def fresh_folder(room, name):
    """A new folder, which the user that foot runs as may write to."""
    path = os.path.join(room.folder, name.replace(" ", "-"))
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)
    if room.user is not None:
        os.chown(path, room.user, room.user)
    return path
