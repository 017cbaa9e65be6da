#!/usr/bin/python3 -B
# SPDX-License-Identifier: MIT
"""What came of a cohort: a table, a page of those to look at first, and a contact sheet.

    gather.py BIDS OUT

BIDS has the scenes, sub-*/[ses-*/]anat/*_T1w.nii.gz, OUT what subject.py has made of them. Written
are, each whole or not at all:

    OUT/cohort.csv    a row for each subject and label: volume, share of seeds dropped, doubt, Dice
                      where truth is known, time and memory
    OUT/cohort.html   the same, those first that are to be looked at first, with their pictures
    OUT/cohort.png    their pictures on one sheet, in the same order

The order does not know Dice. First come subjects that are missing, were refused or did not verify.
Of the others, a label counts by how far it is from what the cohort has: the logarithm of its volume
as a share of the procedure's (in the millimetres of its own scene), its share of dropped seeds, its
doubt; each less the median and over the median deviation from it, at least so much that nothing
counts which is within 5 %. A subject counts by its worst label; before all others come subjects
with a label that `iftty apply` calls bad: by its volume, or by the part of it that is far from the
place where it was carried.

Exit status: 0 all are there, verified, and none was refused; 1 some are not; 3 bad input or I/O.
"""
import csv
import glob
import html
import io
import json
import math
import os
import re
import statistics
import sys

from PIL import Image, ImageDraw

from whole import write_whole

COLUMNS = ["subject", "state", "order", "label", "name", "volume_ml", "procedure_ml",
           "dropped_share", "doubt", "dice", "strange", "seconds", "processor_seconds",
           "memory_mb", "disk_mb", "chain", "far_ml", "bad"]
LEAST = {"volume": 0.05, "dropped_share": 0.05, "doubt": 0.05}  # deviations that count as none
SIDE = 320  # pixels of a picture of the sheet


def scenes(bids):
    found = [path for level in ("sub-*", "sub-*/ses-*") for path in
             glob.glob(os.path.join(bids, level, "anat", "*_T1w.nii.gz"))]
    return sorted(os.path.relpath(path, bids) for path in found)


def read_subject(out, scene):
    """Its facts, and a row a label; whatever is wrong with its files is its state."""
    stem = re.sub(r"_[^_]+\.nii\.gz$", "", os.path.basename(scene))
    base = os.path.join(out, os.path.dirname(scene), stem + "_desc-iftty_")
    subject = {"subject": stem, "labels": [], "picture": base + "mosaic.png", "why": []}
    try:
        with open(base + "dseg.json") as file:
            told = json.load(file)
    except FileNotFoundError:
        return dict(subject, state="missing")
    except (OSError, ValueError) as error:
        return dict(subject, state="unreadable", why=[str(error)])
    if "Refused" in told:
        return dict(subject, state="refused", why=[told["Refused"]])
    cost, applied = told["Cost"], applied_labels(told)
    if not cost["Apply"].get("JournalWasThere"):  # else what it took is not known any more
        subject.update(seconds=sum(step["Seconds"] for step in cost.values()),
                       processor_seconds=sum(step["ProcessorSeconds"] for step in cost.values()),
                       memory_mb=max(step["MemoryMegabytes"] for step in cost.values()))
    for row in told["Stats"]["by_label"]:
        label = str(row["number"])
        facts = applied.get(label, {})
        subject["labels"].append({
            "label": label, "name": row["name"], "volume_ml": row["volume_mm3"] / 1000,
            "procedure_ml": facts.get("procedure_ml"), "dice": told["Dice"].get(label),
            "dropped_share": facts.get("dropped_share"), "doubt": facts.get("doubt"),
            "far_ml": facts.get("far_ml"), "bad": facts.get("bad")})
    return dict(subject, state="done" if told["Verified"] else "not verified",
                disk_mb=told["DiskMegabytes"], chain=told["Chain"])


def applied_labels(told):
    """By label: what its journal says of where it came from, and, where this task has made it, what
    `iftty apply --json` said besides."""
    facts = {}
    for word in told["Origin"].split():
        key, _, value = word.partition("=")
        for part in value.split(",") if key in ("volumes", "dropped") else []:
            label, _, figure = part.partition(":")
            if key == "volumes":
                facts.setdefault(label, {})["procedure_ml"] = float(figure) / 1000
            else:
                dropped, _, seeds = figure.partition("/")
                facts.setdefault(label, {})["dropped_share"] = int(dropped) / max(1, int(seeds))
    for row in told["Apply"][0].get("labels", []):
        facts.setdefault(str(row["label"]), {}).update(
            doubt=row["doubt"], far_ml=row.get("far_mm3", 0) / 1000, bad=int(row.get("bad", False)))
    return facts


def volume(row):
    value = row["volume_ml"] / (row["procedure_ml"] or 1)
    return math.log(value) if value > 0 else -10


def judge(subjects):
    """How strange each label is beside the same one of the others, and why."""
    numbers = sorted({row["label"] for s in subjects for row in s["labels"]}, key=int)
    for number in numbers:
        rows = [(s, row) for s in subjects for row in s["labels"] if row["label"] == number]
        for _, row in rows:
            row["strange"] = 0
        for what in LEAST:
            known = [(s, row, volume(row) if what == "volume" else row[what]) for s, row in rows
                     if what == "volume" or row[what] is not None]
            if len(known) < 3:
                continue
            middle = statistics.median(value for _, _, value in known)
            spread = statistics.median(abs(value - middle) for _, _, value in known)
            for subject, row, value in known:
                by = value - middle if what == "volume" else max(0, value - middle)
                strange = abs(by) / max(1.4826 * spread, LEAST[what])
                row["strange"] = round(max(row["strange"], strange), 2)
                if strange >= 2:
                    subject["why"].append((strange, (
                        "%s: volume %.2f of the cohort's" % (row["name"], math.exp(by))
                        if what == "volume" else "%s: %s %.2f, the cohort has %.2f" % (
                            row["name"], what.replace("_", " "), value, middle))))
    for subject in subjects:
        bad = [row for row in subject["labels"] if row["bad"]]
        subject["bad"] = len(bad)
        subject["why"] += [(math.inf, "%s: bad, %.2f ml of %.2f ml expected, %.2f ml far away" % (
            row["name"], row["volume_ml"], row["procedure_ml"] or 0, row["far_ml"])) for row in bad]
        subject["why"] = [word if isinstance(word, str) else word[1] for word in
                          sorted(subject["why"], key=lambda w: w if isinstance(w, str) else -w[0])]
        subject["strange"] = max([row["strange"] for row in subject["labels"]], default=0)
    subjects.sort(key=lambda s: (s["state"] == "done", not s["bad"], -s["strange"], s["subject"]))


def write_csv(path, subjects):
    text = io.StringIO()
    table = csv.DictWriter(text, COLUMNS, extrasaction="ignore", lineterminator="\n")
    table.writeheader()
    for order, subject in enumerate(subjects, 1):
        for row in subject["labels"] or [{}]:
            whole = dict(subject, **row, order=order)
            for key, value in whole.items():
                whole[key] = "%.6g" % value if isinstance(value, float) else value
            table.writerow(whole)
    write_whole(path, text.getvalue().encode())


def write_sheet(path, subjects):
    across = max(1, math.ceil(math.sqrt(len(subjects))))
    sheet = Image.new("RGB", (across * SIDE, math.ceil(len(subjects) / across) * (SIDE + 16)))
    draw = ImageDraw.Draw(sheet)
    for i, subject in enumerate(subjects):
        at = i % across * SIDE, i // across * (SIDE + 16)
        try:
            with Image.open(subject["picture"]) as picture:
                sheet.paste(picture.convert("RGB").resize((SIDE, SIDE)), (at[0], at[1] + 16))
        except OSError:
            pass  # its state says why
        draw.text((at[0] + 4, at[1] + 2), "%d  %s  %s" % (i + 1, subject["subject"],
                                                          subject["state"]))
    data = io.BytesIO()
    sheet.save(data, "PNG")
    write_whole(path, data.getvalue())


def cell(value):
    return "<td>%s</td>" % ("" if value is None else "%.3f" % value if isinstance(value, float)
                            else html.escape(str(value)))


def write_page(path, subjects):
    parts = ["<!doctype html><meta charset=utf-8><title>Cohort</title><style>body{font:14px "
             "sans-serif;max-width:70em;margin:1em auto}img{width:320px}td,th{padding:1px 8px;"
             "text-align:right}section{display:flex;gap:1em;border-top:1px solid;padding:1em 0}"
             "</style><h1>%d subjects, those to look at first</h1>" % len(subjects)]
    columns = ["name", "volume_ml", "procedure_ml", "far_ml", "dropped_share", "doubt", "dice",
               "strange"]
    for subject in subjects:
        parts.append("<section><div><b>%s</b>: %s" % tuple(
            html.escape(subject[key]) for key in ("subject", "state")))
        parts += ["<br>" + html.escape(word) for word in subject["why"]]
        if subject["labels"]:
            parts.append("<table><tr>" + "".join(
                "<th>%s</th>" % name.replace("_", " ") for name in columns))
            parts += ["<tr>" + "".join(cell(row.get(name)) for name in columns)
                      for row in subject["labels"]]
            parts.append("</table>")
        parts.append("</div>")
        if os.path.exists(subject["picture"]):
            parts.append('<img alt="three slices and the rendition" src="%s">' % html.escape(
                os.path.relpath(subject["picture"], os.path.dirname(path) or ".")))
        parts.append("</section>")
    write_whole(path, ("\n".join(parts) + "\n").encode())


def main():
    if len(sys.argv) != 3:
        print("usage: gather.py BIDS OUT", file=sys.stderr)
        sys.exit(2)
    bids, out = sys.argv[1:]
    try:
        subjects = [read_subject(out, scene) for scene in scenes(bids)]
        if not subjects:
            raise ValueError("%s has no sub-*/anat/*_T1w.nii.gz" % bids)
        judge(subjects)
        write_csv(os.path.join(out, "cohort.csv"), subjects)
        write_sheet(os.path.join(out, "cohort.png"), subjects)
        write_page(os.path.join(out, "cohort.html"), subjects)
        write_whole(os.path.join(out, "dataset_description.json"), (json.dumps({
            "Name": "labels of a procedure that was applied", "BIDSVersion": "1.8.0",
            "DatasetType": "derivative", "GeneratedBy": [{"Name": "iftty"}]}, indent=2) +
            "\n").encode())
    except (OSError, ValueError, KeyError) as error:
        print("gather.py: %s" % error, file=sys.stderr)
        sys.exit(3)
    bad = [s for s in subjects if s["state"] != "done"]
    print("%d subjects, %d to look at before any other" % (len(subjects), len(bad)))
    for subject in bad:
        print("%s: %s%s" % (subject["subject"], subject["state"],
                            "".join(": " + word for word in subject["why"][:1])))
    sys.exit(1 if bad else 0)


main()
