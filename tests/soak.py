#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random commands for hours, as somebody might give them who never tires: soak.py IFTTY FOLDER.

One journal of a DICOM series of a million voxels is continued in one session after another: by
`serve`, whose client also sends what is none of a client's business, by the prompt, and by the
pilot's keys.
Every third session is killed among its commands. Then the journal has to hold every command that
was acknowledged, after the bytes that stood before, and is resumed. All commands that `help` lists
are given but those of LEFT_OUT; many of them are refused. While a session lasts

    nobody else writes to its journal;
    memory is looked at every 40 commands: the median of the last quarter is no more than an eighth
    above that of the second quarter, and 16 bytes a voxel and 32 MB, for what answers, pictures and
    surfaces take once they are asked for, beside what `info` says that seeds, and what can be
    undone, have taken meanwhile: undo leads as far back as `open`. The same holds of the last
    session of a kind beside the second one. What can be undone takes less than the seeds, of which
    a command can free thousands, and 5 kB a record. And no file stays open, nor many helpers.

In the end

    the journal is verified, strictly, from its first record on;
    labels are the same after all has grown anew, and in a session that begins with the seeds alone;
    a DICOM SEG of them has the same labels, and `report` draws a page of the first sessions;
    no temporary file and no draft is left.

    COMMANDS=10000   so many in all: of more, pieces and what frees them overlap too much
    SECONDS=         sessions end after so many; the end takes half as long again
    LONGEST=2500     so many in a session; in one of the pilot at most 1000
    SIDE=100         voxels of the scene along each axis, at least 56
    SEED=1           of the random numbers, from which all commands follow, but for the kills"""
import fcntl
import hashlib
import json
import os
import pty
import random
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

import nibabel
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "volumes"))
from make import slices_of  # pylint: disable=wrong-import-position

IFTTY, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
COMMANDS = int(os.environ.get("COMMANDS", "10000"))
SECONDS = float(os.environ.get("SECONDS") or "inf")
TEMPORARY = os.path.join(FOLDER, "tmp")
JOURNAL, BATCH, WAIT = "soak.iftty", 40, 300
SIDE = int(os.environ.get("SIDE", "100"))  # voxels of the scene, at least 56
LONGEST = int(os.environ.get("LONGEST", "2500"))  # commands of a session
LONGEST_PILOT = min(LONGEST, 1000)
UNDO_MOST = 5  # kB of what can be undone for a record, without its seeds
HELPERS_MOST = 2  # one reads and writes pictures, one writes those that are not waited for
ASKED_FOR = 16 * SIDE**3 // 1000 + 32768  # kB of pictures, answers and surfaces, or none of them
OPEN = "open ct"
NUMBERS = [300, 70000, 4294967295]  # labels of a file
LEFT_OUT = {"open", "interpolate", "pilot", "quit"}  # another scene; Ctrl-O; how sessions end
rng = random.Random(int(os.environ.get("SEED", "1")))
count = {"serve": 0, "prompt": 0, "pilot": 0}
sessions = []  # those that have ended
given, goldens, marks, markers = set(), 0, 0, 0  # `given`: the first words of commands
numbered, outlined = False, None  # labels above 255 may be there; a polygon, and its label
begun = time.monotonic()
failures = []


def fail(what):
    """What is wrong, but lets all else go on."""
    failures.append(what)
    print("# " + what, flush=True)


# ---- commands ----

def place():
    return "%d,%d,%d" % tuple(rng.randrange(SIDE) for _ in range(3))


def near(other, far=6):
    at = [min(SIDE - 1, max(0, int(x) + rng.randint(-far, far))) for x in other.split(",")]
    return "%d,%d,%d" % tuple(at)


def polygon():
    """Its first corner, and the others in the same slice."""
    x, y, z = (rng.randrange(SIDE - 8) for _ in range(3))
    corners = [(x + rng.randint(3, 7), y), (x + 6, y + 6), (x, y + rng.randint(3, 7))]
    return "%d,%d,%d" % (x, y, z), " ".join("to=%d,%d,%d" % (p + (z,)) for p in corners)


def exact():
    """What makes a gesture exact, and what confines it to labels."""
    return rng.choice(["", "", "", " within=0"]) + rng.choice(
        [""] * 12 + [" over=0", " over=0-1,3", " keep=2", " over=1,2 keep=1"])


def some_label():
    return rng.choice(NUMBERS) if numbered and rng.random() < 0.1 else rng.randrange(4)


def planting():
    at, label, what = place(), some_label(), rng.random()
    if what < 0.70:
        return "seed %s %d radius=%d" % (at, label, rng.randrange(4)) + exact()
    if what < 0.80:
        to = near(at)
        return "seed %s %d radius=1 to=%s to=%s" % (at, label, to, near(to)) + rng.choice(
            ["", " joined=yes", " range=20..%d" % rng.randint(30, 200)])
    if what < 0.84:
        return "seed %s %d radius=%d within=%d" % (at, label, rng.randint(1, 3), rng.randint(4, 12))
    if what < 0.87:
        return "seed %s %d shell=yes " % (at, label) + rng.choice(
            ["radius=4", "radius=2.5mm", "through=" + near(at), "radius=5 around=1"])
    if what < 0.90:
        return "box %s %s %d" % (at, near(at), label) + rng.choice(["", " shell=yes", exact()])
    first, others = polygon()
    if what < 0.93:
        return "fill %s %d %s" % (first, label, others) + exact()
    if what < 0.94:
        return "between %d" % rng.randint(1, 3) + rng.choice(
            ["", " plane=axial", " plane=coronal", " over=0"])
    if what < 0.96:
        return outlining(first, others)
    if what < 0.985:
        return "outline %s %d %s" % (first, label, others) + rng.choice(
            ["", " ring=%d" % rng.randrange(6), " instead=%d" % rng.randint(1, markers + 9)])
    if what < 0.995:
        low = rng.randint(10, 200)
        return "object %d threshold %d..%d from=%s" % (label, low, low + 2, at) + exact()
    return "seed-file " + rng.choice(["seeds.csv", "map.nii regions=1-2 erode=2 each=9",
                                      "map.nii label=3 each=5 generator=7", "none.csv",
                                      "map.dcm regions=1-2 erode=2 each=9", "bad.dcm",
                                      "map.nii label=1 each=9 within=0 over=0"])


def outlining(first, others):
    """An outline, and then the same some slices on, for `between`."""
    global outlined
    if outlined:
        (first, label, others), outlined = outlined, None
        z = int(first.split(",")[2])
        first = first.rsplit(",", 1)[0] + ",%d" % (z + 4)
        others = others.replace(",%d " % z, ",%d " % (z + 4)).replace(",%d" % z, ",%d" % (z + 4))
    else:
        label = rng.randint(1, 3)
        outlined = first, label, others
    return "outline %s %d %s ring=%d" % (first, label, others, rng.randrange(2))


def going():
    """Back and forth in the history."""
    last = count_records()
    return rng.choice(["undo", "undo", "undo", "undo 3", "redo", "redo 2",
                       "goto %d" % max(1, last - rng.randrange(200)),
                       "goto side%d" % rng.randrange(1, 9), "branch side%d" % rng.randrange(1, 99)])


def looking():
    at = place()
    return rng.choice([
        "turn 15", "turn 0 -10", "view front", "view 30 20", "zoom 1.5", "zoom fit",
        "zoom 2 at=" + at, "cross " + at, "hide 2", "show all", "show 2", "opacity 3 60",
        "opacity all 100", "shade cubes", "shade surface ao=0", "shade surface creases=yes",
        "pan 5 -3", "focus scene", "focus " + at, "clip axial 10-80", "clip none",
        "clip sagittal 90-10", "plane " + at, "plane %s normal=1,1,0.5 offset=-5" % at,
        "plane none", "cut %s %s" % (at, place()), "cut none", "overlay tint",
        "overlay contour cross=off", "overlay none", "label 3 third",
        "label %d \"an object\" #%06x" % (rng.randint(1, 9), rng.randrange(1 << 24)),
        "label-file names.txt", "label 2 liver code=SCT:10200004:Liver", "label 2 x code=none",
        "label 1 one code=nonsense", "show-channel next", "show-channel 2", "show-channel 1",
        "# a comment of channel 2", "light 20 40", "cue 50", "edges on", "edges off", "samples 2",
        "samples 1", "background white", "background gradient", "decorate letters scale",
        "decorate none", "context mip", "context none", "window 20 90.5", "window auto",
        "magnify 2.5 at=" + at, "magnify fit", "size 128 128", "size 96 64", "landmark AC " + at,
        "landmark AC none", "orient RAS", "orient file",
        "origin 74120d6c3f0cc54e2237dc0bced98ab5 by=world as=labels"])


def growing():
    """What all grows anew by."""
    return rng.choice(["weight sobel", "weight gauss 1.5", "weight difference", "weight polarity",
                       "polarity 1 50", "polarity 2 0", "weight map.nii", "weight morph",
                       "weight morph", "weight morph", "adjacency 26", "adjacency 6", "adjacency 6",
                       "range 20 190.5", "range none", "mask map.nii regions=0-2", "mask none",
                       "range none", "mask none", "mask map.dcm", "mask none"])


def of_channels():
    return rng.choice(["channel flair.nii name=flair", "channel flair.nii", "channel 2 percent=50",
                       "channel 1 percent=80", "channel none.nii",
                       "channel 2 remove=yes", "channel 2 remove=yes", "channel 3 remove=yes"])


def finishing():
    return rng.choice(["finish relax sweeps=8", "finish majority radius=1", "finish largest",
                       "finish components voxels=20", "finish holes label=1", "finish close",
                       "finish open label=2", "finish", "finish none", "finish none", "finish none",
                       "finished on", "finished off", "finished off"])


def asking():
    at = place()
    return rng.choice([
        "render", "render mode=ray", "slice axial %d" % rng.randrange(SIDE), "slice coronal zoom=2",
        "mosaic", "stats", "stats", "why " + at, "why " + at, "why " + at,
        "profile %s %s" % (at, place()), "measure %s %s %s" % (at, place(), place()), "pick 64 64",
        "pick 20 30 of=mosaic", "info",
        "history 5", "hints 3", "hints slice", "hint %d" % rng.randint(1, 12), "help seed",
        "journal", "sync", "sync " + rng.choice(["always", "everysec", "off"]), "run for=stats",
        "stats finished=yes report=stats.json replace=yes", "compare map.nii regions=1-3",
        "compare map.dcm", "compare bad.dcm"])


def saving():
    global goldens
    if goldens < 60 and rng.random() < 0.3:
        goldens += 1
        return "golden g%d" % goldens + rng.choice(["", "", " of=axial", " of=mosaic"])
    return rng.choice([
        "save labels labels.nii replace=yes", "save labels labels.nii.gz replace=yes finished=yes",
        "save cost cost.nii.gz replace=yes", "save border border.nii.gz replace=yes",
        "save root root.nii.gz replace=yes", "save margin margin.nii.gz replace=yes",
        "save distance distance.nii.gz replace=yes", "save seeds now.csv replace=yes",
        "save names now.txt replace=yes", "save surface now.ply replace=yes triangles=900",
        "save labels labels.nii", "save labels now.dcm replace=yes",
        "save labels now.dcm replace=yes finished=yes identity=keep",
        "save labels now.seg.nrrd replace=yes", "render now.png replace=yes",
        "render now.exr replace=yes",
        "slice axial 50 slice.png replace=yes", "mosaic mosaic.png replace=yes",
        "spin 4 turn.gif replace=yes"])


def misspelling():
    """A line with something wrong about it."""
    line = rng.choice([planting, looking, asking])()
    if line == "journal":  # which twice is no mistake: the journal would go on in another file
        line = "history"
    at = rng.randrange(len(line))
    return rng.choice([
        line[:at], line[:at] + rng.choice("§=,.\"0- ") + line[at:], line.replace(",", ",,"),
        line + " " + line, line.replace("1", "99999999999999999999"), "# " + line, line.upper(),
        "seed 1,1,1 1 radius=513", "label 256 x", "goto 99999999", "undo 0", "redo 1000000",
        "mask none.nii", "open", "box 1,1,1 100,1,1 1", "outline 1,1,1 1 to=2,2,2 to=3,3,3"])


KINDS = [(0.52, planting), (0.12, None), (0.10, going), (0.02, lambda: rng.choice(
    ["auto on", "auto on", "auto off", "run"])), (0.12, looking), (0.02, finishing), (0.07, asking),
    (0.01, saving), (0.005, growing), (0.005, of_channels), (0.015, misspelling)]


def is_late():
    """Corrections of a segmentation out of a file take time and memory for each voxel around."""
    return max(sum(count.values()) / COMMANDS, (time.monotonic() - begun) / SECONDS) > 0.9


def command():
    global numbered
    make = rng.choices([k[1] for k in KINDS], [k[0] for k in KINDS])[0]
    line = make() if make else "remove %s" % place() + rng.choice(
        [" radius=%d" % rng.randrange(8), " radius=%d" % rng.randrange(8), " of=tree", ""])
    if is_late() and ("labels" not in given or rng.random() < 0.001):
        line = rng.choice(["labels map.nii least=3000 rest=none erode=1", "labels here",
                           "labels map.dcm regions=2 rest=none least=3000"])
    elif rng.random() < (0.0001 if numbered else 0.01):  # each file's pieces are freed for ever
        line, numbered = "labels numbers.nii rest=none", True
    given.add(line.split(" ")[0])
    return line


# ---- the journal ----

counted, counted_to = 0, 0
stood, stood_to = hashlib.sha256(), 0


def count_records():
    """How many there are, of which those before are not read again."""
    global counted, counted_to, markers
    with open(JOURNAL, "rb") as file:
        file.seek(counted_to)
        data = file.read()
    data = data[:data.rfind(b"\n") + 1]
    counted += len(re.findall(rb"^= [0-9]+", data, re.M))
    counted_to += len(data)
    for number in re.findall(rb" marker=([0-9]+)", data):
        markers = int(number)
    return counted


def begins_as_before():
    """What was in the journal at the last call is its beginning still."""
    global stood, stood_to
    with open(JOURNAL, "rb") as file:
        data = file.read()
    if hashlib.sha256(data[:stood_to]).digest() != stood.digest():
        fail("the journal does not begin as it did")
    stood, stood_to = hashlib.sha256(data), len(data)


def told(lines, *arguments):
    """What commands say in a session of their own."""
    return subprocess.run([IFTTY, *arguments, "-c", "; ".join(lines)], capture_output=True,
                          text=True, check=False).stdout


def accounted():
    """kB of seeds, and of what can be undone, by the program's own account."""
    said = told(["info"], "--journal", JOURNAL, "--read-only")
    seeds, undone = re.search(r"seeds (\d+\.\d).* and (\d+\.\d) MB for undo", said).groups()
    return int(1000 * float(seeds)), int(1000 * float(undone))


# ---- sessions ----

class Session:
    """A process, of which `sizes` are how many kB it takes, `helpers` how many it has, and `files`
    how many it has open, but pictures that are written while the next commands are answered."""

    def __init__(self):
        self.done, self.killed = 0, False
        self.sizes, self.files, self.helpers = [], [], []

    def note(self, commands):
        self.done += commands
        with open("/proc/%d/status" % self.process.pid, encoding="ascii") as file:
            self.sizes.append(int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)))
        opened = list(self.opened())
        self.helpers.append(sum(name.startswith("socket:") for name in opened))
        self.files.append(sum("/.iftty-" not in name for name in opened) - self.helpers[-1])

    def opened(self):
        folder = "/proc/%d/fd/" % self.process.pid
        for number in os.listdir(folder):
            try:
                yield os.readlink(folder + number)
            except FileNotFoundError:
                pass  # closed meanwhile

    def kill(self):
        self.killed = True
        os.kill(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def ended(self):
        if self.process.wait(WAIT) != 0:
            fail("%s ended with %d" % (self.kind, self.process.returncode))


class Serve(Session):
    kind = "serve"
    hostile = ["nonsense", "{", '{"id": 1}', '{"do": 5}', '{"id": {}, "do": "run"}', "[1]", "null",
               '{"id": 1, "do": "run", "do": "run"}', '{"id": 1, "do": "seed\\u0000"}', "\udcff",
               '{"id": 1, "array": "nothing"}', '{"id": 1, "do": "run", "other": 2}', "\"" * 300,
               '{"id": "%s", "do": "run"}' % ("i" * 99), '{"id": 1, "do": "%s"}' % ("x" * 1200000)]

    def __init__(self):
        super().__init__()
        self.process = subprocess.Popen(
            [IFTTY, "serve", JOURNAL], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            encoding="utf-8", errors="surrogateescape")
        self.number, self.acknowledged = 0, 0
        self.answer()

    def answer(self):
        answer = {}
        while "ok" not in answer:  # what comes before tells how far it is
            line = self.process.stdout.readline()
            if not line:
                fail("serve has ended in the middle")
                sys.exit(1)
            answer = json.loads(line)
        self.acknowledged = answer.get("record") or self.acknowledged
        return answer

    def ask(self, **request):
        self.number += 1
        print(json.dumps(dict(request, id=self.number)), file=self.process.stdin, flush=True)

    def batch(self, lines, dies=False):
        ahead = rng.random() < 0.2 or dies  # all are sent before the first is answered
        for line in lines:
            self.ask(do=line)
            if not ahead:
                self.expect(self.number)
        for i in range(len(lines) if ahead else 0):
            if dies and i == len(lines) // 2:
                return
            self.expect(self.number - len(lines) + i + 1)
        self.be_a_nuisance()

    def expect(self, number):
        answer = self.answer()
        if answer["id"] != number:
            fail("serve answers %s instead of %d" % (answer, number))
        return answer

    def be_a_nuisance(self):
        """Lines that are refused, voxels as a file, and a command that is stopped."""
        line = rng.choice(self.hostile)
        print(line, file=self.process.stdin, flush=True)
        if self.answer()["ok"]:
            fail("serve takes " + line[:60])
        if rng.random() < 0.1:
            self.ask(array=rng.choice(["labels", "cost", "root", "border", "intensity"]))
            if not os.path.exists(self.expect(self.number).get("file", "")):
                fail("serve gives no array")
        self.ask(do="stats")
        print(json.dumps({"cancel": self.number}), file=self.process.stdin, flush=True)
        self.expect(self.number)

    def end(self):
        self.process.stdin.close()
        self.ended()


class Prompt(Session):
    kind = "prompt"

    def __init__(self):
        super().__init__()
        self.master, slave = pty.openpty()
        self.process = subprocess.Popen(
            [IFTTY, JOURNAL], stdin=slave, stdout=slave, stderr=slave, start_new_session=True,
            env=dict(os.environ, TERM="xterm-256color", COLUMNS="80", LINES="24"))
        os.close(slave)
        self.enter()

    def enter(self):
        self.mark("")

    def read(self, seconds):
        try:
            if select.select([self.master], [], [], seconds)[0]:
                os.read(self.master, 65536)
        except OSError:
            pass

    def send(self, text):
        data, until = text.encode(), time.monotonic() + WAIT
        while data and time.monotonic() < until:
            ready, can_write, _ = select.select([self.master], [self.master], [], 1)
            if ready:
                os.read(self.master, 65536)
            if can_write:
                data = data[os.write(self.master, data[:512]):]

    def mark(self, before):
        """A record by which one knows that all before it has been done."""
        global marks
        marks += 1
        line = "label 9 mark%d" % marks
        until, again = time.monotonic() + WAIT, 0
        while time.monotonic() < until:
            if time.monotonic() > again:  # keys that begin something may have taken it
                again = time.monotonic() + 5
                for key in before:
                    self.send(key)
                    time.sleep(0.1)
                self.send(line + "\r")
            self.read(0.02)
            with open(JOURNAL, "rb") as file:
                file.seek(0, 2)
                file.seek(max(0, file.tell() - 4096))
                if line.encode() + b"\n= " in file.read():
                    return
        fail("%s does not come to `%s`" % (self.kind, line))
        sys.exit(1)

    def batch(self, lines, dies=False):
        self.send("".join(line + "\r" for line in lines))
        if not dies:
            self.mark("")

    def leave(self):
        self.send("\x15quit\r")

    def end(self):
        until, again = time.monotonic() + WAIT, 0
        while self.process.poll() is None and time.monotonic() < until:
            if time.monotonic() > again:
                again = time.monotonic() + 15
                self.leave()
            self.read(0.05)
        self.ended()
        os.close(self.master)

    def kill(self):
        super().kill()
        os.close(self.master)


class Pilot(Prompt):
    kind = "pilot"
    keys = (["h", "j", "k", "l", "H", "J", "K", "L", "\t", "u", "\x12", "s0", "s1", "s2", "S", "O",
             "a", "A", "d", "gg", "gc", "gz", "gh", "+", "-", "---", "b", "B", "e", "E",
             "\x1b[1;2C", "\x1b[1;2A", "z", "Z", "F", "y", "ma", "'a", "''", "Da", "c", "C", "xx",
             "XX", "n", "N",
             "t", "T20..90\r", "T9\x1b", "P", "PP", "Pi", ")", "(", "}", "{", "@lljj\r", "@5lv5j\r",
             "U", "v3lv", "v5jl", "I", "w2", "wa\r", "]", "[", "W", "o", "f", "M", "<", ">", "Vr",
             "Vs", ".", "p", " ", "?", "\x0c", "\x1b[<0;20;8M\x1b[<0;20;8m", "\x1b[<64;40;6M"] +
            ["i", "s1", "s2", "3l", "5j", "4k", "6h"] * 6)

    def enter(self):
        self.mark("")
        self.send("\x0f")
        time.sleep(0.5)
        self.mark("\x1b\x1b\x1b\x1b:")

    def batch(self, lines, dies=False):
        if rng.random() < 0.1:
            rows, columns = rng.randint(10, 50), rng.randint(30, 160)
            fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
            self.process.send_signal(signal.SIGWINCH)
        self.send("".join(rng.choice(self.keys) for _ in lines))
        if not dies:
            self.mark("\x1b\x1b\x1b\x1b:")

    def leave(self):
        for key in "\x1b\x1bq":
            self.send(key)
            time.sleep(0.2)
        super().leave()


def one_session(kind, commands, dies):
    session = kind()
    while session.done < commands and time.monotonic() < begun + SECONDS:
        session.batch([command() for _ in range(BATCH)])
        session.note(BATCH)
        if session.done == 10 * BATCH:
            told(["label 9 thief"], "--journal", JOURNAL)
    session.records = count_records()
    if dies:
        session.batch([command() for _ in range(BATCH)], dies=True)
        time.sleep(rng.random() / 4)
        session.kill()
        acknowledged = max(session.records, getattr(session, "acknowledged", 0))
        if count_records() < acknowledged:
            fail("%d records were acknowledged, and %d are left" % (acknowledged, count_records()))
    else:
        session.end()
    begins_as_before()
    session.held = accounted()
    count[session.kind] += session.done
    sessions.append(session)


# ---- what is judged in the end ----

def median(numbers, quarter):
    part = sorted(numbers[(quarter - 1) * len(numbers) // 4:quarter * len(numbers) // 4])
    return part[len(part) // 2] if part else 0


def is_more(later, former, held):
    return later > former + former // 8 + ASKED_FOR + held * 5 // 4


def memory_grows():
    grew, held = [], 0
    for i, session in enumerate(sessions):
        second, last = median(session.sizes, 2), median(session.sizes, 4)
        if is_more(last, second, sum(session.held) - held):
            grew.append("%d, %s: %d kB to %d" % (i + 1, session.kind, second, last))
        if median(session.files, 4) > median(session.files, 2):
            grew.append("%d, %s: open files" % (i + 1, session.kind))
        if max(session.helpers) > HELPERS_MOST:
            grew.append("%d, %s: %d helpers" % (i + 1, session.kind, max(session.helpers)))
        if session.held[1] > UNDO_MOST * session.records + session.held[0]:
            grew.append("%d, %s: %d kB for what can be undone of %d records" % (
                i + 1, session.kind, session.held[1], session.records))
        held = sum(session.held)
    for kind in count:
        of_kind = [s for s in sessions if s.kind == kind][1:]
        if of_kind and is_more(median(of_kind[-1].sizes, 4), median(of_kind[0].sizes, 4),
                               sum(of_kind[-1].held) - sum(of_kind[0].held)):
            grew.append("the last " + kind)
    return grew


def labels_of(answer):
    return (re.findall(r"labels ([0-9a-f]{16})", answer) or ["none"])[-1]


def is_same(a, b):
    done = subprocess.run([IFTTY, "compare", a, b], capture_output=True, check=False)
    return done.returncode == 0


def report():
    """A page of the journal so far."""
    done = subprocess.run([IFTTY, "report", JOURNAL, "-o", "page.html"], capture_output=True,
                          text=True, check=False)
    if done.returncode != 0 or not os.path.exists("page.html"):
        fail("report: status %d, %s" % (done.returncode, done.stderr))


def tell(holds, what, why=""):
    print("%s - %s%s" % ("ok" if holds else "not ok", what, ": " + str(why) if why else ""),
          flush=True)
    return not holds


def left_behind():
    """Temporary files, and drafts of what was written."""
    return os.listdir(os.environ["TMPDIR"]) + [
        name for _, _, names in os.walk(".") for name in names if name.startswith(".")]


def make_files():
    """Two channels of shells and noise, a series of the first, and maps."""
    noise = numpy.random.RandomState(1)
    shape = numpy.array([SIDE / 2] * 3)
    far = numpy.linalg.norm((numpy.indices([SIDE] * 3).T - shape) * [1, 1.2, 0.8], axis=3).T
    for name, period in (("ct", 18), ("flair", 11)):
        values = (40 + 60 * (far % period > period / 2) + far + noise.randint(0, 9, far.shape))
        if name == "ct":
            os.mkdir("ct")
            for z, one in enumerate(slices_of(values.astype(numpy.int16), numpy.eye(4))):
                one.RescaleSlope, one.RescaleIntercept = 1, 0
                one.save_as("ct/%d" % z)
        else:
            nibabel.save(nibabel.Nifti1Image(values.astype(numpy.int16), numpy.eye(4)), "flair.nii")
    numbers = numpy.zeros(far.shape, numpy.uint32)
    for i, number in enumerate(NUMBERS):
        numbers[15 * i + 5:15 * i + 15, 30:40, 40:50] = number
    nibabel.save(nibabel.Nifti1Image(numbers, numpy.eye(4)), "numbers.nii")
    told([OPEN, "seed 15,15,15 1 radius=5", "seed 45,45,15 2 radius=5", "seed 2,2,2 0", "run",
          "label 1 one", "save labels map.nii", "save labels map.dcm", "save seeds seeds.csv",
          "save names names.txt"])
    with open("map.dcm", "rb") as whole, open("bad.dcm", "wb") as bad:
        bad.write(whole.read()[:-1000])


def main():
    os.makedirs(TEMPORARY, exist_ok=True)
    os.chdir(FOLDER)
    os.environ.update(IFTTY_CONFIG="", IFTTY_HISTORY="", TMPDIR=TEMPORARY)
    make_files()
    told([OPEN, "size 128 128", "auto on"], "--journal", JOURNAL)
    while sum(count.values()) < COMMANDS and time.monotonic() < begun + SECONDS:
        left = COMMANDS - sum(count.values())
        kind = [Serve, Prompt, Pilot][len(sessions) % 3]
        one_session(kind, min(left, LONGEST_PILOT if kind is Pilot else LONGEST),
                    rng.randrange(3) == 0)
        if len(sessions) == 3:
            report()
        last = sessions[-1]
        print("# %6d commands, %5.0f s, %s%s: %d records, kB in quarters %s, "
              "%d for seeds and history" % (
                  sum(count.values()), time.monotonic() - begun, last.kind,
                  ", killed" if last.killed else "", last.records,
                  " ".join(str(median(last.sizes, q)) for q in (1, 2, 3, 4)), sum(last.held)),
              flush=True)
    plain = ["weight morph", "adjacency 6", "range none", "mask none", "finish none"]
    plain += ["channel 2 remove=yes"] * 8 + ["channel 1 percent=100"]
    last = labels_of(told(plain + [  # of which some are refused
        "run", "save seeds last.csv replace=yes", "save labels last.nii replace=yes",
        "save labels last.dcm replace=yes", "stats"],
        "--journal", JOURNAL, "--keep-going"))
    anew = labels_of(told(["adjacency 26", "run", "adjacency 6", "run", "stats"],
                          "--journal", JOURNAL))
    with open("last.csv", encoding="ascii") as file:
        planted = {line.strip().split(",")[3] for line in list(file)[1:]} - {"0"}
    told([OPEN] + ["label %s n%s" % (number, number) for number in sorted(planted)] +
         ["seed-file last.csv", "run", "save labels scratch.nii"])
    scratch = is_same("last.nii", "scratch.nii")
    segments = is_same("last.nii", "last.dcm")
    Serve().end()  # takes away the folder of one that was killed
    grew, left = memory_grows(), left_behind()
    names = set(re.findall(r"^([a-z][a-z-]*) ", subprocess.run(
        [IFTTY, "help", "all"], capture_output=True, text=True, check=True).stdout, re.M))
    with open(JOURNAL, "rb") as file:
        thieves = file.read().count(b"thief")
    failed = tell(last == anew and scratch, "labels are the same from the seeds alone, and anew",
                  "%s %s %s" % (last, scratch, anew))
    failed += tell(segments, "a DICOM SEG of them has the same labels")
    failed += tell(not grew, "memory does not grow", "; ".join(grew))
    failed += tell(not left, "nothing is left behind", " ".join(left))
    failed += tell(thieves == 0, "nobody else has written to the journal")
    failed += tell(names - given <= LEFT_OUT, "all commands are given", names - given - LEFT_OUT)
    failed += tell(not failures, "every session is as it should be", "; ".join(failures))
    print("# %s; %d sessions, %d killed, %d records, %d golden images, %.0f s" % (
        ", ".join("%s %d" % item for item in count.items()), len(sessions),
        sum(s.killed for s in sessions), count_records(), goldens, time.monotonic() - begun),
          flush=True)
    verified = subprocess.run([IFTTY, "verify", "--strict", "--limit-time", "9h", "--limit-output",
                               "90G", JOURNAL], check=False).returncode
    failed += tell(verified == 0, "the journal verifies, strictly")
    print("# %.0f s" % (time.monotonic() - begun))
    print("%d passed, %d failed, 0 skipped" % (8 - failed, failed))
    sys.exit(failed > 0)


main()
