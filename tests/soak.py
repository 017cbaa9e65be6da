#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random commands for hours, as somebody might give them who never tires: soak.py IFTTY FOLDER.

One journal of a scene of a million voxels is gone on with in one session after another: by the
prompt, by the pilot's keys, and by `serve`. Every third session is killed among its commands. Then
the journal has to hold every command that was acknowledged, and is resumed. In the end

    the journal is verified, strictly, from its first record on;
    a session that begins with the seeds alone, as they are in the end, has the same labels;
    the last session of each kind has taken no more memory than the first, but for half of that and
    a kB for each record between them, since undo leads as far back as `open`.

    COMMANDS=100000  so many in all
    SEED=1           of the random numbers, from which all commands follow, but for the kills
"""
import json
import os
import pty
import random
import re
import select
import signal
import subprocess
import sys
import time

IFTTY, FOLDER = os.path.abspath(sys.argv[1]), sys.argv[2]
COMMANDS = int(os.environ.get("COMMANDS", "100000"))
JOURNAL, SIDE, BATCH, WAIT = "soak.iftty", 100, 40, 300
OPEN = "open synth:geom:%dx%dx%d" % (SIDE, SIDE, SIDE)
rng = random.Random(int(os.environ.get("SEED", "1")))
count = {"serve": 0, "prompt": 0, "pilot": 0}
memory = []  # of each session: kind, commands, kB at a quarter, at the end, and most, records
killed, goldens, marks = 0, 0, 0


def place():
    return "%d,%d,%d" % tuple(rng.randrange(SIDE) for _ in range(3))


def near(other):
    at = [min(SIDE - 1, max(0, int(x) + rng.randint(-6, 6))) for x in other.split(",")]
    return "%d,%d,%d" % tuple(at)


def command():
    """One of those that are recorded, some of which are refused."""
    global goldens
    at, label, many = place(), rng.randrange(4), rng.random()
    if many < 0.45:
        return "seed %s %d radius=%d" % (at, label, rng.randrange(4))
    if many < 0.50:
        return "seed %s %d radius=1 to=%s" % (at, label, near(at))
    if many < 0.53:
        return "box %s %s %d" % (at, near(at), label)
    if many < 0.56:
        x, y, z = (int(i) for i in at.split(","))
        x, y = min(x, SIDE - 8), min(y, SIDE - 8)
        corners = [(x + 6, y), (x + 6, y + 6), (x, y + 6)]
        return "outline %d,%d,%d %d %s" % (
            x, y, z, label, " ".join("to=%d,%d,%d" % (p + (z,)) for p in corners))
    if many < 0.66:
        return "remove %s radius=%d" % (at, rng.randrange(8))
    if many < 0.74:
        return rng.choice(["undo", "undo", "undo 3", "redo"])
    if many < 0.76:
        return rng.choice(["auto on", "auto on", "auto off", "run"])
    if many < 0.90:
        return rng.choice(["turn 15", "turn 0 -10", "view front", "view 30 20", "zoom 1.5",
                           "zoom fit", "cross " + at, "hide 2", "show all", "opacity 3 60",
                           "shade cubes", "shade surface ao=0", "pan 5 -3", "focus scene",
                           "clip axial 10-80", "clip none", "overlay tint", "label 3 third"])
    if many < 0.93:
        return rng.choice(["finish relax sweeps=8", "finish none", "finish majority",
                           "finished on", "finished off"])
    if many < 0.98:
        return rng.choice(["render", "axial %d" % rng.randrange(SIDE), "stats", "why " + at])
    if many < 0.985 and goldens < 60:
        goldens += 1
        return "golden g%d" % goldens
    return "save labels labels.nii replace=yes"


def records():
    with open(JOURNAL, "rb") as file:
        return len(re.findall(rb"^= [0-9]+", file.read(), re.M))


def fail(what):
    print("not ok - " + what)
    sys.exit(1)


class Session:
    """A process, of which `memory` is how many kB it takes."""

    def __init__(self):
        self.done = 0
        self.sizes = []

    def note(self, commands):
        self.done += commands
        with open("/proc/%d/status" % self.process.pid, encoding="ascii") as file:
            self.sizes.append(int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)))

    def kill(self):
        global killed
        killed += 1
        os.kill(self.process.pid, signal.SIGKILL)
        self.process.wait()


class Serve(Session):
    kind = "serve"

    def __init__(self):
        super().__init__()
        self.process = subprocess.Popen([IFTTY, "serve", JOURNAL], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()
        self.number = 0

    def batch(self, lines, dies=False):
        for i, line in enumerate(lines):
            self.number += 1
            print(json.dumps({"id": self.number, "do": line}), file=self.process.stdin, flush=True)
            if dies and i == len(lines) // 2:
                return
            answer = {}
            while "ok" not in answer:  # what comes before tells how far it is
                answer = json.loads(self.process.stdout.readline())
            if answer["id"] != self.number:
                fail("serve answers %s instead of %d" % (answer, self.number))

    def end(self):
        self.process.stdin.close()
        if self.process.wait(WAIT) != 0:
            fail("serve ended with %d" % self.process.returncode)


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

    def send(self, text):
        data = text.encode()
        while data:
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
                again = time.monotonic() + 15
                for key in before:
                    self.send(key)
                    time.sleep(0.1)
                self.send(line + "\r")
            if select.select([self.master], [], [], 0.02)[0]:
                os.read(self.master, 65536)
            with open(JOURNAL, "rb") as file:
                file.seek(0, 2)
                file.seek(max(0, file.tell() - 4096))
                if line.encode() + b"\n= " in file.read():
                    return
        fail("%s does not come to `%s`" % (self.kind, line))

    def batch(self, lines, dies=False):
        self.send("".join(line + "\r" for line in lines))
        if not dies:
            self.mark("")

    def leave(self):
        self.send("quit\r")

    def end(self):
        self.leave()
        until = time.monotonic() + WAIT
        while self.process.poll() is None and time.monotonic() < until:
            try:
                if select.select([self.master], [], [], 0.05)[0]:
                    os.read(self.master, 65536)
            except OSError:
                break
        if self.process.wait(WAIT) != 0:
            fail("the %s ended with %d" % (self.kind, self.process.returncode))
        os.close(self.master)

    def kill(self):
        super().kill()
        os.close(self.master)


class Pilot(Prompt):
    kind = "pilot"
    keys = (["h", "j", "k", "l", "H", "J", "K", "L", "\t", "u", "s0", "s1", "s2", "S", "a", "g",
             "+", "-", "b", "e", "\x1b[1;2C", "\x1b[1;2A", "z", "Z", "F", "y", "m", "c", "xx", "n",
             "t"] + ["i", "I", "s1", "s2", "3l", "5j"] * 3)

    def enter(self):
        self.mark("")
        self.send("\x0f")
        time.sleep(0.5)
        self.mark("\x1b\x1b:")

    def batch(self, lines, dies=False):
        self.send("".join(rng.choice(self.keys) for _ in lines))
        if not dies:
            self.mark("\x1b\x1b:")

    def leave(self):
        self.send("\x1b")
        time.sleep(0.1)
        self.send("q")
        time.sleep(0.3)
        self.send("\x15quit\r")


def one_session(kind, commands, dies):
    session = kind()
    while session.done < commands:
        session.batch([command() for _ in range(BATCH)])
        session.note(BATCH)
    stood = records()
    if dies:
        session.batch([command() for _ in range(BATCH)], dies=True)
        time.sleep(rng.random() / 4)
        session.kill()
        if records() < stood:
            fail("%d records stood, and %d are left" % (stood, records()))
    else:
        session.end()
    sizes = session.sizes
    memory.append((kind.kind, session.done, sizes[len(sizes) // 4], sizes[-1], max(sizes), stood))
    count[kind.kind] += session.done


def told(lines, *arguments):
    """What commands say in a session of their own."""
    return subprocess.run([IFTTY, *arguments, "-c", "; ".join(lines)], capture_output=True,
                          text=True, check=False).stdout


def labels_of(answer):
    return re.findall(r"labels ([0-9a-f]{16})", answer)[-1]


def main():
    os.makedirs(FOLDER, exist_ok=True)
    os.chdir(FOLDER)
    os.environ["IFTTY_CONFIG"] = os.environ["IFTTY_HISTORY"] = ""
    begun = time.monotonic()
    told([OPEN, "size 128 128", "auto on"], "--journal", JOURNAL)
    kinds = [Serve, Prompt, Pilot]
    sessions = 0
    while sum(count.values()) < COMMANDS:
        left = COMMANDS - sum(count.values())
        kind = kinds[sessions % 3]
        most = 500 if kind is Pilot else 2000
        one_session(kind, min(left, most), sessions % 3 == rng.randrange(3))
        sessions += 1
        kind, _, quarter, last, most, _ = memory[-1]
        print("# %6d commands, %5.0f s, %s: %d records, %d kB after a quarter, %d at the end, "
              "%d most" % (sum(count.values()), time.monotonic() - begun, kind, records(), quarter,
                           last, most), flush=True)
    last = labels_of(told(["run", "save seeds last.csv replace=yes", "stats"],
                          "--journal", JOURNAL))
    scratch = labels_of(told([OPEN, "seed-file last.csv", "run", "stats"]))
    print("%s - labels from the seeds alone are those of the journal: %s, %s" %
          ("ok" if last == scratch else "not ok", last, scratch))
    verified = subprocess.run([IFTTY, "verify", "--strict", JOURNAL], check=False).returncode
    print("%s - the journal verifies, strictly" % ("not ok" if verified else "ok"))
    grew = []
    for kind in count:
        of_kind = [m for m in memory if m[0] == kind]
        if of_kind and of_kind[-1][4] > of_kind[0][4] * 3 // 2 + of_kind[-1][5] - of_kind[0][5]:
            grew.append(kind)
    print("%s - memory does not grow %s" % ("not ok" if grew else "ok", " ".join(grew)))
    failed = (last != scratch) + (verified != 0) + (grew != [])
    print("# %s; %d sessions, %d killed, %d records, %.0f s" % (
        ", ".join("%s %d" % item for item in count.items()), sessions, killed, records(),
        time.monotonic() - begun))
    print("%d passed, %d failed, 0 skipped" % (3 - failed, failed))
    sys.exit(failed > 0)


main()
