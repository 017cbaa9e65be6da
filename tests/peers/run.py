# SPDX-License-Identifier: MIT
"""iftty beside the programs that one would take instead: run.py [--rounds N] [--core N]
[--json FILE] BUILD; `make bench-peers` runs it.

Every program is a worker (tests/peers/worker.h) that lives through all rounds, pinned to one core
together with this script, which waits meanwhile. A round goes from the first markers over the
eight edits of tests/peers/workload.c to erasing the last of them again, and at each step asks
every worker in turn for its run. A peer can only begin from scratch; iftty updates.

Figures are medians over rounds, in processor time. The labels of the first round are checked by
tests/peers/check_labels.c, and after erasing iftty must have the digest from before that edit.

Exit status: 0 fine, 1 a check failed, 3 a program could not be run."""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
EDITS = 8
SCRATCH, ERASE = 0, EDITS + 1  # steps of a round; those between are the edits
CHECKED = {SCRATCH: "from scratch", EDITS: "after eight edits", ERASE: "after erasing"}
IFTTY, ITK = "iftty", "ITK"


class Broken(Exception):
    pass


class Worker:
    """A program that answers requests; `times` are milliseconds [round][step]."""

    def __init__(self, name, command, folder):
        self.name = name
        self.process = subprocess.Popen(
            command + [folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.times = []
        self.notes = []

    def ask(self, request):
        try:
            self.process.stdin.write(request + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # the answer that does not come tells
        answer = self.process.stdout.readline().strip()
        if not answer:
            raise Broken("%s ended at '%s'" % (self.name, request))
        return answer

    def tell(self, request):
        answer = self.ask(request)
        if answer != "ok":
            raise Broken("%s at '%s': %s" % (self.name, request, answer))

    def run(self):
        words = self.ask("run").split()
        try:
            self.times[-1].append(float(words[0]))
        except ValueError:
            raise Broken("%s: %s" % (self.name, " ".join(words))) from None
        self.notes[-1].append(dict(word.split("=") for word in words[1:]))

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def fields(line):
    return {key: int(value) for key, value in (word.split("=") for word in line.split())}


def markers_file(folder, step):
    return "%s/markers-%d.u8" % (folder, EDITS - 1 if step == ERASE else step)


def make_workload(build, folder):
    scenes = os.environ.get("IFTTY_SCENES", "/usr/share/mricron/templates").split(":")[0]
    command = [build + "/tests/peers/workload", folder]
    command += [scenes + "/ch2.nii.gz", scenes + "/aal.nii.gz"]
    made = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if made.returncode:
        raise Broken("the workload could not be made")
    return fields(made.stdout)


def start_workers(build, folder):
    programs = build + "/tests/peers/"
    python = [sys.executable, HERE + "/python_worker.py"]
    return [
        Worker(IFTTY, [programs + "iftty_worker"], folder),
        Worker(ITK, [programs + "itk_worker"], folder),
        Worker("vigra", [programs + "vigra_worker"], folder),
        Worker("scipy", python + ["scipy"], folder),
        Worker("scikit-image", python + ["skimage"], folder),
    ]


def run_round(workers, folder, first):
    for worker in workers:
        worker.tell("reset")
        worker.times.append([])
        worker.notes.append([])
    for step in range(ERASE + 1):
        for worker in workers:
            worker.tell("markers " + markers_file(folder, step))
            worker.run()
            if first and step in CHECKED:
                worker.tell("labels %s/%s-%d.u8" % (folder, worker.name, step))
                if worker.name == IFTTY:
                    worker.tell("costs %s/costs-%d.u8" % (folder, step))


def check_labels(build, workers, folder, step):
    """Of each program, what tests/peers/check_labels.c counts."""
    command = [build + "/tests/peers/check_labels", folder, markers_file(folder, step)]
    command.append("%s/costs-%d.u8" % (folder, step))
    command += ["%s=%s/%s-%d.u8" % (w.name, folder, w.name, step) for w in workers]
    checked = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    counts = {}
    for line in checked.stdout.splitlines():
        name, _, rest = line.partition(" ")
        counts[name] = fields(rest)
    return checked.returncode == 0, counts


def erased_exactly(worker):
    return all(
        notes[ERASE]["digest"] == notes[EDITS - 1]["digest"]
        and notes[SCRATCH]["digest"] == worker.notes[0][SCRATCH]["digest"]
        for notes in worker.notes
    )


# ---- figures ----


def summary(rounds):
    """Medians over rounds of milliseconds [round][step]."""
    median = statistics.median
    return {
        "scratch_ms": median(times[SCRATCH] for times in rounds),
        "edits_ms": median(sum(times[1 : EDITS + 1]) for times in rounds),
        "erase_ms": median(times[ERASE] for times in rounds),
    }


def with_border(worker):
    return [
        [ms + float(note["border"]) for ms, note in zip(times, notes)]
        for times, notes in zip(worker.times, worker.notes)
    ]


def edit_figures(worker):
    """Of each update of iftty: what it touched, and the median of its times."""
    figures = []
    for step in range(1, ERASE + 1):
        note = worker.notes[0][step]
        ms = statistics.median(times[step] for times in worker.times)
        border = statistics.median(float(notes[step]["border"]) for notes in worker.notes)
        touched = int(note["touched"])
        figures.append(
            {
                "edit": "erase" if step == ERASE else step,
                "seeds": int(note["seeds"]),
                "touched": touched,
                "ms": ms,
                "border_ms": border,
                "ns_per_touched": ms * 1e6 / max(touched, 1),
            }
        )
    return figures


def figures_of(workers, workload):
    programs = {}
    for worker in workers:
        programs[worker.name] = summary(worker.times)
        if worker.name == IFTTY:
            programs["iftty, border too"] = summary(with_border(worker))
    yardstick = programs[ITK]["scratch_ms"]
    for figures in programs.values():
        for what in ("scratch", "edits", "erase"):
            ms = figures[what + "_ms"]
            figures[what + "_ns_per_voxel"] = ms * 1e6 / workload["voxels"]
            figures[what + "_ratio"] = ms / yardstick
    return programs


def median_note(worker, key, steps):
    return statistics.median(float(notes[step][key]) for notes in worker.notes for step in steps)


# ---- tables ----


def print_times(programs):
    print("%-17s %25s %25s %25s" % ("", "from scratch", "eight edits", "erasing the last"))
    print("%-17s" % "" + " %9s %7s %7s" % ("ms", "ns/vox", "ITK=1") * 3)
    for name, figures in programs.items():
        row = "%-17s" % name
        for what in ("scratch", "edits", "erase"):
            values = tuple(figures[what + key] for key in ("_ms", "_ns_per_voxel", "_ratio"))
            row += " %9.2f %7.2f %7.4f" % values
        print(row)


def print_edits(edits):
    head = ("edit", "seeds", "touched", "ms", "ns/touched", "border ms")
    print("%-6s %7s %9s %9s %11s %10s" % head)
    for edit in edits:
        row = (edit["edit"], edit["seeds"], edit["touched"], edit["ms"])
        row += (edit["ns_per_touched"], edit["border_ms"])
        print("%-6s %7d %9d %9.3f %11.1f %10.3f" % row)


def print_labels(labels):
    head = ("labels", "as iftty's", "others: ties", "not minimal", "not minimal, own")
    print("%-18s %-18s %11s %13s %12s %17s" % (("",) + head))
    for step, counts in labels.items():
        for name, count in counts.items():
            voxels, differ = count["voxels"], count["voxels"] - count["same"]
            ties = "%12.2f%%" % (100 * count["ties"] / differ) if differ else "%13s" % "-"
            row = (name, step, 100 * count["same"] / voxels, ties)
            row += (count["worse_free"], count["worse_own"])
            print("%-18s %-18s %10.3f%% %s %12d %17d" % row)


def print_all(result, iftty):
    workload = result["workload"]
    print(
        "ch2: %(voxels)d voxels, 6 neighbours; markers: %(regions_voxels)d voxels in "
        "%(regions)d regions, %(air_voxels)d of air" % workload
    )
    print("one core, %d rounds, medians\n" % result["rounds"])
    print_times(result["programs"])
    print()
    print_edits(result["edits"])
    ready, read = (median_note(iftty, key, [SCRATCH]) for key in ("ready", "read"))
    print("\niftty's times leave out, once a scene, making the cells: %.0f ms; and copying" % ready)
    print("labels and costs out of them, which nothing in it needs: %.0f ms\n" % read)
    print_labels(result["labels"])
    print("\nnot minimal: voxels whose label no path of the least f_max cost brings, where a")
    print("marker costs 0; own: where it costs the gradient of its own voxel, as it does for ITK,")
    print("vigra and scikit-image. scipy weighs a step by the difference of the two voxels.")


def measure(options, folder):
    workload = make_workload(options.build, folder)
    workers = start_workers(options.build, folder)
    iftty = workers[0]
    for number in range(options.rounds):
        print("round %d of %d" % (number + 1, options.rounds), file=sys.stderr)
        run_round(workers, folder, number == 0)
    fine = erased_exactly(iftty)
    if not fine:
        print("iftty: erasing an edit did not give the former forest", file=sys.stderr)
    labels = {}
    for step, name in CHECKED.items():
        minimal, labels[name] = check_labels(options.build, workers, folder, step)
        fine = fine and minimal
    for worker in workers:
        worker.end()
    result = {
        "workload": workload,
        "rounds": options.rounds,
        "programs": figures_of(workers, workload),
        "edits": edit_figures(iftty),
        "labels": labels,
    }
    print_all(result, iftty)
    if options.json:
        with open(options.json, "w", encoding="ascii") as file:
            json.dump(result, file, indent=1)
            file.write("\n")
    return 0 if fine else 1


def main():
    parser = argparse.ArgumentParser(description="iftty beside other programs, on one core")
    parser.add_argument("build", help="the build folder")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--core", type=int, help="default: the last one that may be used")
    parser.add_argument("--json", metavar="FILE", help="write all figures there too")
    options = parser.parse_args()
    core = max(os.sched_getaffinity(0)) if options.core is None else options.core
    os.sched_setaffinity(0, {core})
    try:
        with tempfile.TemporaryDirectory(prefix="iftty-peers-") as folder:
            return measure(options, folder)
    except Broken as broken:
        print("bench-peers: %s" % broken, file=sys.stderr)
        return 3


sys.exit(main())
