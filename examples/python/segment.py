#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Segments the brain of ch2, a head of Debian's mricron-data, and draws it with matplotlib.

    python3 segment.py [PICTURE.png [JOURNAL.iftty]]

Each part between two "# %%" is a cell, for editors that know them. What it does is in the journal
afterwards: `iftty verify JOURNAL` carries it out again, and `iftty JOURNAL` goes on with it.
"""
# %% A session: the scene is found among the folders of $IFTTY_SCENES.
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import iftty  # noqa: E402

picture = sys.argv[1] if len(sys.argv) > 1 else "segment.png"
journal = sys.argv[2] if len(sys.argv) > 2 else "segment.iftty"
session = iftty.open("ch2.nii.gz", journal=journal)
s = session
s.label(1, "brain", "#e06040")

# %% Seeds, in voxels: a ball in the brain, one in the skull at either side, and a stroke through
# the leak next to the neck.
s.seed((90, 108, 90), "brain", radius=6)
s.seed((20, 108, 90), 0, radius=6)
s.seed((160, 108, 90), 0, radius=6)
answer = s.seed((160, 108, 10), 0, radius=6, to=[(20, 108, 10)])
print(answer.text, end="")

# %% The labels as an array, and what is known of them.
head = s.array("intensity")
labels = s.labels()
cost = s.array("cost").astype(float)
brain, = s.report("stats")["by_label"]
millilitres = brain["volume_mm3"] / 1000
assert np.isclose(millilitres, (labels == 1).sum() * abs(np.linalg.det(s.affine[:3, :3])) / 1000)
print(f"{brain['name']}: {millilitres:.0f} ml in {brain['components']} component(s)")

# %% Where the border is least certain: the first places of `hints`.
hints = s.report("hints")["hints"][:3]
for hint in hints:
    print(hint["place"], f"{hint['voxels']} voxels, doubt {hint['doubt']}")

# %% Slices as radiologists see them are for `s.slice`; here x runs to the right, as in the array.
axes = plt.subplots(2, 3, figsize=(12, 8), facecolor="black")[1]
middle = [int(round(brain[f"centre_{axis}"])) for axis in "xyz"]
for column, (axis, name) in enumerate(zip(range(3), ("sagittal", "coronal", "axial"))):
    def cut(volume, axis=axis):
        """A slice through the middle of the brain, its second axis upwards."""
        return np.take(volume, middle[axis], axis).T
    for row in range(2):
        view = axes[row][column]
        view.imshow(cut(head), cmap="gray", origin="lower")
        view.set_axis_off()
    axes[0][column].contour(cut(labels), [0.5], colors=[(0.88, 0.38, 0.25)], linewidths=1.2)
    axes[0][column].set_title(f"{name} {middle[axis]}", color="white")
    axes[1][column].imshow(np.ma.masked_where(cut(labels) == 0, cut(cost)), cmap="inferno",
                           origin="lower", alpha=0.8, vmax=np.percentile(cost[labels == 1], 99))
axes[1][0].set_title("the cost of the paths of the brain's voxels", color="white", loc="left")
plt.tight_layout()
plt.savefig(picture, dpi=80, facecolor="black")
print(f"wrote {picture}")

# %% The session ends; the journal has all of it.
s.save("labels", picture.rsplit(".", 1)[0] + ".nii.gz", replace=True)
session.close()
