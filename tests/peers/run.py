# SPDX-License-Identifier: MIT
"""iftty beside the programs that one would take instead: run.py [--rounds N] [--core N]
[--bits 8|16]... [--json FILE] BUILD; `make bench-peers` runs it.

Every program is a worker (tests/peers/worker.h) that lives through all rounds, pinned to one core
together with this script, which waits meanwhile; iftty-2, the engine with two threads, may use all
cores. A round goes from the first markers over the eight edits of tests/peers/workload.c to erasing
the last of them again, and at each step asks every worker in turn for its run. iftty and DIFT
update; the other programs can only begin from scratch. The scene with 8 bits is followed by the one
with 16.

Figures are medians over rounds, of elapsed and of processor time. The labels of the first round are
checked by tests/peers/check_labels.c, and costs where a worker has them; after erasing iftty must
have the digest from before that edit.

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
UPDATING = ("iftty", "iftty-2", "DIFT")  # these have costs too
# Rows of a program, by the stages of its runs that they add up.
ROWS = {"": ("run",), ", whole": ("cells", "list", "run", "read"), ", border": ("run", "border")}
CLOCKS = ("processor", "elapsed")


class Broken(Exception):
    pass


class Worker:
    """A program that answers requests, on the cores given; `notes` are those of its runs
    [round][step]. Times of stages are milliseconds, in the order of CLOCKS."""

    def __init__(self, name, command, cores):
        os.sched_setaffinity(0, cores)
        self.name = name
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
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
        if words[0] != "ok":
            raise Broken("%s: %s" % (self.name, " ".join(words)))
        self.notes[-1].append(dict(word.split("=") for word in words[1:]))

    def times(self, stages, clock):
        """Sums of stages, [round][step]."""
        at = CLOCKS.index(clock)
        return [
            [sum(float(note.get(s, "0,0").split(",")[at]) for s in stages) for note in notes]
            for notes in self.notes
        ]

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def fields(line):
    return {key: int(value) for key, value in (word.split("=") for word in line.split())}


def markers_file(folder, step):
    return "%s/markers-%d.u8" % (folder, EDITS - 1 if step == ERASE else step)


def make_workload(build, folder, bits):
    scenes = os.environ.get("IFTTY_SCENES", "/usr/share/mricron/templates").split(":")[0]
    command = [build + "/tests/peers/workload", folder]
    command += [scenes + "/ch2.nii.gz", scenes + "/aal.nii.gz", str(bits)]
    made = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if made.returncode:
        raise Broken("the workload could not be made")
    return fields(made.stdout)


def start_workers(build, folder, core, cores):
    programs = build + "/tests/peers/"
    python = [sys.executable, HERE + "/python_worker.py"]
    return [
        Worker(IFTTY, [programs + "iftty_worker", folder, "1"], {core}),
        Worker("iftty-2", [programs + "iftty_worker", folder, "2"], cores),
        Worker("DIFT", [programs + "dift_worker", folder], {core}),
        Worker(ITK, [programs + "itk_worker", folder], {core}),
        Worker("vigra", [programs + "vigra_worker", folder], {core}),
        Worker("scipy", python + ["scipy", folder], {core}),
        Worker("scikit-image", python + ["skimage", folder], {core}),
    ]


def run_round(workers, folder, first):
    for worker in workers:
        worker.tell("reset")
        worker.notes.append([])
    for step in range(ERASE + 1):
        for worker in workers:
            worker.tell("markers " + markers_file(folder, step))
            worker.run()
            if first and step in CHECKED:
                worker.tell("labels %s/%s-%d.u8" % (folder, worker.name, step))
                if worker.name in UPDATING:
                    worker.tell("costs %s/%s-%d.u16" % (folder, worker.name, step))


def check_labels(build, workers, folder, step):
    """Of each program, what tests/peers/check_labels.c counts."""
    command = [build + "/tests/peers/check_labels", folder, markers_file(folder, step)]
    for worker in workers:
        path = "%s/%s-%d" % (folder, worker.name, step)
        costs = ",%s.u16" % path if worker.name in UPDATING else ""
        command.append("%s=%s.u8%s" % (worker.name, path, costs))
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


def summary(worker, stages):
    """Medians over rounds of a row."""
    median = statistics.median
    figures = {}
    for clock in CLOCKS:
        rounds = worker.times(stages, clock)
        figures["scratch_%s_ms" % clock] = median(times[SCRATCH] for times in rounds)
        figures["edits_%s_ms" % clock] = median(sum(times[1 : EDITS + 1]) for times in rounds)
        figures["erase_%s_ms" % clock] = median(times[ERASE] for times in rounds)
    return figures


def median_of(worker, stage, step, clock="processor"):
    return statistics.median(times[step] for times in worker.times((stage,), clock))


def edit_figures(iftty, dift):
    """Of each update: what iftty touched, and medians of processor time."""
    figures = []
    for step in range(1, ERASE + 1):
        note = iftty.notes[0][step]
        ms, touched = median_of(iftty, "run", step), int(note["touched"])
        figures.append(
            {
                "edit": "erase" if step == ERASE else step,
                "seeds": int(note["seeds"]),
                "touched": touched,
                "ms": ms,
                "border_ms": median_of(iftty, "border", step),
                "dift_ms": median_of(dift, "run", step),
                "ns_per_touched": ms * 1e6 / max(touched, 1),
            }
        )
    return figures


def figures_of(workers):
    programs = {}
    for worker in workers:
        for name, stages in ROWS.items():
            if all(stage in worker.notes[0][SCRATCH] for stage in stages):
                programs[worker.name + name] = summary(worker, stages)
    yardstick = programs[ITK]["scratch_elapsed_ms"]
    for figures in programs.values():
        for what in ("scratch", "edits", "erase"):
            figures[what + "_ratio"] = figures[what + "_elapsed_ms"] / yardstick
    return programs


# ---- tables ----


def print_times(programs):
    print("%-15s %26s %26s %26s" % ("", "from scratch", "eight edits", "erasing the last"))
    print("%-15s" % "" + " %8s %8s %8s" % ("elapsed", "proc.", "ITK=1") * 3)
    for name, figures in programs.items():
        row = "%-15s" % name
        for what in ("scratch", "edits", "erase"):
            keys = ("_elapsed_ms", "_processor_ms", "_ratio")
            row += " %8.1f %8.1f %8.4f" % tuple(figures[what + key] for key in keys)
        print(row)


def print_edits(edits):
    head = ("edit", "seeds", "touched", "ms", "ns/touched", "border ms", "DIFT ms")
    print("%-6s %7s %9s %9s %11s %10s %9s" % head)
    for edit in edits:
        row = (edit["edit"], edit["seeds"], edit["touched"], edit["ms"])
        row += (edit["ns_per_touched"], edit["border_ms"], edit["dift_ms"])
        print("%-6s %7d %9d %9.3f %11.1f %10.3f %9.3f" % row)


def print_labels(labels):
    head = ("labels", "as iftty's", "others: ties", "not minimal", "not minimal, own")
    print("\n%-18s %-18s %11s %13s %12s %17s" % (("",) + head))
    for step, counts in labels.items():
        for name, count in counts.items():
            voxels, differ = count["voxels"], count["voxels"] - count["same"]
            ties = "%12.2f%%" % (100 * count["ties"] / differ) if differ else "%13s" % "-"
            row = (name, step, 100 * count["same"] / voxels, ties)
            row += (count["worse_free"], count["worse_own"])
            print("%-18s %-18s %10.3f%% %s %12d %17d" % row)


def print_all(result, workers):
    workload = result["workload"]
    print(
        "ch2, %(bits)d bits: %(voxels)d voxels, 6 neighbours; markers: %(regions_voxels)d voxels "
        "in %(regions)d regions, %(air_voxels)d of air" % workload
    )
    print("one core; iftty-2: two threads; ms, medians of %d rounds\n" % result["rounds"])
    print_times(result["programs"])
    print()
    print_edits(result["edits"])
    print("\nwhole: from the map of markers to the map of labels. Processor time from scratch, ms:")
    for worker in workers:
        if worker.name in UPDATING:
            stages = ROWS[", whole"]
            parts = " ".join("%s %.0f" % (s, median_of(worker, s, SCRATCH)) for s in stages)
            print("%-8s %s" % (worker.name, parts))
    print_labels(result["labels"])
    print("\nnot minimal: voxels whose label no path of the least f_max cost brings, where a")
    print("marker costs 0; own: where it costs the gradient of its own voxel, as it does for ITK,")
    print("vigra and scikit-image. scipy weighs a step by the difference of the two voxels.\n")


def measure(options, bits, cores, folder):
    workload = dict(make_workload(options.build, folder, bits), bits=bits)
    workers = start_workers(options.build, folder, options.core, cores)
    for number in range(options.rounds):
        print("%d bits, round %d of %d" % (bits, number + 1, options.rounds), file=sys.stderr)
        run_round(workers, folder, number == 0)
    fine = all(erased_exactly(worker) for worker in workers[:2])
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
        "programs": figures_of(workers),
        "edits": edit_figures(workers[0], workers[2]),
        "labels": labels,
    }
    print_all(result, workers)
    return fine, result


def main():
    parser = argparse.ArgumentParser(description="iftty beside other programs, on one core")
    cores = os.sched_getaffinity(0)
    parser.add_argument("build", help="the build folder")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--bits", type=int, choices=(8, 16), action="append", help="default: both")
    parser.add_argument("--core", type=int, default=max(cores), help="default: the last one")
    parser.add_argument("--json", metavar="FILE", help="write all figures there too, by bits")
    options = parser.parse_args()
    fine, results = True, {}
    try:
        for bits in options.bits or (8, 16):
            with tempfile.TemporaryDirectory(prefix="iftty-peers-") as folder:
                passed, results[bits] = measure(options, bits, cores, folder)
                fine = fine and passed
    except Broken as broken:
        print("bench-peers: %s" % broken, file=sys.stderr)
        return 3
    if options.json:
        with open(options.json, "w", encoding="ascii") as file:
            json.dump(results, file, indent=1)
            file.write("\n")
    return 0 if fine else 1


sys.exit(main())
