#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""One subject of a cohort: the procedure applied to it, verified, exported and judged.

    subject.py [--iftty FILE] [--by WAY] [--as labels|seeds] [--truth FOLDER] PROCEDURE SCENE OUT

SCENE is .../sub-01[/ses-1]/anat/sub-01[_ses-1]_T1w.nii.gz, or a link that is called so. In
OUT/sub-01/anat there are then

    sub-01_T1w.iftty and .seeds.nii.gz   the journal and what it plants, as `iftty apply` makes them
    sub-01_desc-iftty_dseg.nii.gz        the labels, and sub-01_desc-iftty_mosaic.png
    sub-01_desc-iftty_dseg.json          the sidecar: what was done by what, volumes, drops, time,
                                         memory; and Dice where FOLDER has sub-01's truth

The sidecar comes last: where it is, all is there. Each file appears whole or not at all. A task
that was killed, at whatever moment, is repeated by the same words: what is done is left alone, as
long as procedure, scene, options and journal are those that the sidecar names. What is only passing
lies in OUT/.work, which the task removes, and what a killed one has left with it.

Exit status: 0 done, also where the scene was refused, which the sidecar then says, with the reason;
2 bad usage; 3 a file cannot be read or written, or another task works on the subject.
"""
import argparse
import fcntl
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time


class Stopped(Exception):
    """The words are for the user."""


def digest(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def sync(path):
    number = os.open(path, os.O_RDONLY)
    os.fsync(number)
    os.close(number)


def read_json(path):
    try:
        with open(path) as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


class Work:
    """Runs iftty for one subject: in a folder that is gone afterwards."""

    def __init__(self, options, folder, name):
        self.folder, self.work = folder, os.path.join(options.out, ".work", name)
        self.command = [options.iftty]
        if shutil.which("setpriv"):  # what this task has started ends with it, if by SIGKILL
            self.command = ["setpriv", "--pdeathsig", "KILL"] + self.command
        self.cost = {}

    def __enter__(self):
        os.makedirs(self.folder, exist_ok=True)
        self.lock = os.open(self.folder, os.O_RDONLY)
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Stopped("another task works on %s" % self.folder) from None
        except OSError:
            pass  # a file system without locks; the journal has one of its own
        shutil.rmtree(self.work, ignore_errors=True)
        os.makedirs(self.work)
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.work, ignore_errors=True)
        try:
            os.rmdir(os.path.dirname(self.work))
        except OSError:
            pass  # others work there
        os.close(self.lock)

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, step, *words, may_fail=False):
        """What a step prints, its status; its cost is noted."""
        begun = time.monotonic()
        with (os.fdopen(os.memfd_create("out"), "w+") as out,
              os.fdopen(os.memfd_create("err"), "w+") as err):  # a full disk cannot hide them
            child = subprocess.Popen(self.command + list(words), stdin=subprocess.DEVNULL,
                                     stdout=out, stderr=err,
                                     env=dict(os.environ, TMPDIR=os.path.abspath(self.work)))
            try:
                _, status, used = os.wait4(child.pid, 0)
            except BaseException:
                child.kill()
                raise
            child.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            err.seek(0)
            printed, said = out.read(), err.read().strip()
        self.cost[step] = {"Seconds": round(time.monotonic() - begun, 2),
                           "ProcessorSeconds": round(used.ru_utime + used.ru_stime, 2),
                           "MemoryMegabytes": round(used.ru_maxrss / 1024)}
        if child.returncode and (child.returncode != 1 or not may_fail):
            why = re.findall(r'"why": "(.*?)"[,}]', printed)  # of `apply --json`
            raise Stopped("%s, status %d: %s" % (step, child.returncode, "; ".join([said] + why)))
        return printed, child.returncode

    def publish(self, name, path):
        """A file of the work folder gets its name, and is on the disk then."""
        sync(self.path(name))
        os.replace(self.path(name), path)
        sync(os.path.dirname(path))


def origin_of(journal):
    """The words of the record that says where the journal came from: "by=affine chain=..."."""
    with open(journal, errors="replace") as file:
        for line in file:
            if line.startswith("origin "):
                return line[len("origin "):].strip()
    return ""


def export(work, journal, stem, truth):
    """Labels, picture and volumes of a journal; Dice where truth is known."""
    work.run("Export", "-c", "size 480 480; overlay tint cross=off marks=off; zoom fit;"
             "save labels dseg.nii.gz; mosaic mosaic.png; stats report=stats.json", "--journal",
             journal, "--read-only", "--out", work.work)
    dice = {}
    if truth:
        found = os.path.join(truth, stem[0], "%s_desc-truth_dseg.nii.gz" % stem[1])
        if os.path.exists(found):
            told, _ = work.run("Compare", "compare", "--json", work.path("dseg.nii.gz"), found)
            dice = {str(row["label"]): row["dice"] for row in json.loads(told)["labels"]}
    return read_json(work.path("stats.json")), dice


def do_subject(options, folder, stem, journal, sidecar, work):
    about = {"Procedure": os.path.basename(options.procedure), "By": options.by,
             "As": options.as_, "ProcedureSha256": digest(options.procedure),
             "SceneSha256": digest(options.scene)}
    done = read_json(sidecar)
    if done and all(done.get(key) == value for key, value in about.items()) and (
            "Refused" in done or
            (os.path.exists(journal) and digest(journal) == done["JournalSha256"])):
        return "there already"
    was_there = os.path.exists(journal)
    told, status = work.run(
        "Apply", "apply", options.procedure, options.scene, "--by", options.by, "--as",
        options.as_, "--out", folder, "--json", may_fail=True)
    work.cost["Apply"]["JournalWasThere"] = was_there
    about["Sources"] = ["bids:raw:" + os.path.basename(options.scene)]
    version = subprocess.run([options.iftty, "--version"], capture_output=True, text=True)
    about["GeneratedBy"] = [{"Name": "iftty", "Version": version.stdout.strip()}]
    applied = json.loads(told)
    if status == 1:
        about["Refused"] = applied[0]["why"]
    else:
        verified, _ = work.run("Verify", "verify", "--json", "--no-strict", journal,
                               may_fail=True)
        verified = json.loads(verified)["journals"][0]
        stats, dice = export(work, journal, stem, options.truth)
        about.update({"Verified": verified["verified"], "Chain": verified.get("chain"),
                      "JournalSha256": digest(journal), "Origin": origin_of(journal),
                      "Stats": stats, "Dice": dice})
        about["DiskMegabytes"] = round(sum(os.path.getsize(os.path.join(top, name))
                                           for top, _, names in os.walk(folder)
                                           for name in names) / 1e6, 2)
        base = os.path.join(folder, stem[1] + "_desc-iftty_")
        work.publish("mosaic.png", base + "mosaic.png")
        work.publish("dseg.nii.gz", base + "dseg.nii.gz")
    about["Apply"] = applied
    about["Cost"] = work.cost
    with open(work.path("sidecar"), "w") as file:
        json.dump(about, file, indent=2, sort_keys=True)
        file.write("\n")
    work.publish("sidecar", sidecar)
    return "refused: " + about["Refused"] if status == 1 else "done"


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--iftty", default="iftty")
    parser.add_argument("--by", default="affine")
    parser.add_argument("--as", default="labels", dest="as_", choices=["labels", "seeds"])
    parser.add_argument("--truth", metavar="FOLDER")
    for word in "procedure", "scene", "out":
        parser.add_argument(word)
    options = parser.parse_args()
    name = os.path.basename(options.scene)
    match = re.fullmatch(r"((sub-[0-9A-Za-z]+)(?:_(ses-[0-9A-Za-z]+))?(?:_[^_/]+)*)_"
                         r"[0-9A-Za-z]+\.nii(\.gz)?", name)
    if not match:
        parser.error("%s is no name of BIDS, as sub-01_T1w.nii.gz" % name)
    part = os.path.join(*[word for word in match.group(2, 3) if word], "anat")
    folder = os.path.join(options.out, part)
    sidecar = os.path.join(folder, match.group(1) + "_desc-iftty_dseg.json")
    journal = os.path.join(folder, re.sub(r"\.nii(\.gz)?$", ".iftty", name))
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # and so the work folder goes
    try:
        with Work(options, folder, match.group(1)) as work:
            print("%s: %s" % (match.group(1), do_subject(
                options, folder, (part, match.group(1)), journal, sidecar, work)), flush=True)
    except (OSError, ValueError, KeyError, Stopped) as error:
        print("subject.py: %s: %s" % (match.group(1), error), file=sys.stderr)
        sys.exit(3)


main()
