# SPDX-License-Identifier: MIT
"""Stories of examples/python/iftty.py; in TAP. python_session.py PLAIN: as without numpy."""
import _thread
import os
import pathlib
import sys
import threading

sys.path.insert(0, os.path.join(sys.argv[1], "examples/python"))
import iftty  # noqa: E402

PLAIN = len(sys.argv) > 2
if PLAIN:
    iftty.numpy = None
else:
    import nibabel
    import numpy
count = 0


def story(tell):
    """Runs a story at once."""
    global count
    count += 1
    try:
        tell()
        print(f"ok {count} - {tell.__doc__}", flush=True)
    except Exception as error:
        print(f"# {type(error).__name__}: {error}\nnot ok {count} - {tell.__doc__}", flush=True)


def fails(kind, call, *values, **keyed):
    """The error that a call ends with."""
    try:
        call(*values, **keyed)
    except iftty.Error as error:
        assert error.kind == kind, (error.kind, error.why)
        return error
    raise AssertionError(f"no error: {values} {keyed}")


@story
def words():
    """values become the words of a command"""
    line = iftty._line
    assert line("seed", [(1, 2, 3), 2], {"radius": 6, "within": None}) == "seed 1,2,3 2 radius=6"
    assert line("object", [1, "threshold", "4..5"], {"from_": (1, 2, 3)}) == \
        "object 1 threshold 4..5 from=1,2,3"
    assert line("label_file", ["a b.txt"], {}) == 'label-file "a b.txt"'
    assert line("seed", [(0, 0, 0), 1], {"to": [(1, 1, 1), (2, 2, 2)]}) == \
        "seed 0,0,0 1 to=1,1,1 to=2,2,2"
    assert line("label", [1, 'le"ft \\'], {}) == 'label 1 "le\\"ft \\\\"'
    assert line("label", [1, "'x"], {}) == 'label 1 "\'x"'
    assert line("save", ["labels", pathlib.Path("x.nii")], {"replace": True}) == \
        "save labels x.nii replace=yes"
    assert line("zoom", [2.5], {}) == "zoom 2.5"
    if not PLAIN:
        assert line("seed", [numpy.array([1, 2, 3]), numpy.uint8(4)], {}) == "seed 1,2,3 4"


@story
def arrays():
    """arrays are what the program saves, in the place that it says"""
    with iftty.open("s.nii", journal="arrays.iftty") as s:
        s.seed((5, 10, 8), 1, radius=2)
        s.seed((20, 3, 3), 0)
        s.label(1, "ä b\U0001f600")
        assert s.info().text and "ä b" in s.stats().text
        for name in "labels", "cost", "root", "border", "distance", "margin", "intensity":
            ours = s.array(name)
            if name == "intensity":
                path = "s.nii"
            else:
                path = s.save(name, f"{name}.nii", replace=True).files[0]
            if PLAIN:
                assert ours.shape == (16, 20, 24) and ours.format in "BHIf"
                size = ours.itemsize * 24 * 20 * 16
                file = pathlib.Path(path).read_bytes()
                assert name == "intensity" or ours.tobytes() == file[-size:], name
                assert name != "labels" or ours[8, 10, 5] == 1
                continue
            theirs = nibabel.load(path)
            assert ours.shape == (24, 20, 16) and numpy.array_equal(ours, theirs.dataobj), name
        if not PLAIN:
            assert s.affine is None  # the file does not say where it lies
    with iftty.open("placed.nii", journal="placed.iftty") as s:
        s.seed((5, 10, 8), 1)
        if not PLAIN:
            theirs = nibabel.load(s.save("labels", "placed-labels.nii", replace=True).files[0])
            s.labels()
            assert numpy.allclose(s.affine, theirs.affine, atol=1e-5), s.affine
            assert numpy.array_equal(s.image().dataobj, theirs.dataobj)
            assert not numpy.allclose(s.affine[:3, :3], numpy.diag(numpy.diag(s.affine)[:3]))


@story
def given():
    """labels that are given come out as they are, and the journal needs no file for that"""
    with iftty.open("s.nii", journal="given.iftty") as s:
        if PLAIN:
            voxels = bytearray(24 * 20 * 16)
            voxels[24 * 20 * 8:] = bytes([3]) * (24 * 20 * 8)
            s.labels(bytes(voxels))
            assert s.labels().tobytes() == bytes(voxels)
        else:
            voxels = numpy.zeros((24, 20, 16), int)
            voxels[3:9, 4:, :7] = 3
            voxels[15:, :5, 2:] = 200
            s.labels(voxels)
            assert numpy.array_equal(s.labels(), voxels)
            voxels[15:, :5, 2:] = 2000
            s.undo()
            s.labels(voxels)
            assert sorted(set(s.labels().flat)) == [0, 3, 2000]
            try:
                s.labels(voxels[1:])
                raise AssertionError("it was taken")
            except ValueError:
                pass
        folder = s.folder
        assert os.path.isdir(folder)
    assert not os.path.exists(folder)


@story
def errors():
    """what fails is an exception that says where and what was meant, and the session goes on"""
    with iftty.open("s.nii", journal="errors.iftty") as s:
        error = fails("bad usage", s.sed, (1, 2, 3), 1)
        assert (error.column, error.hints, error.line) == (1, ["seed"], "sed 1,2,3 1")
        assert fails("bad usage", s.label, 2, "ä b", "colour").column == 15
        assert "outside the scene" in fails("bad input", s.seed, (99, 0, 0), 1).why
        assert fails("bad usage", s.array, "label").hints == ["labels"]
        fails("input or output failed", s.save, "labels", "no/where.nii", empty=True)
        chain = s.info().chain
        fails("bad usage", s.do, "seed 1,1,1\n1 1")
        assert s.info().chain == chain and s.zoom(2).record == 3
        s.quit()
        assert "has ended, with status 0" in fails("input or output failed", s.zoom, 2).why
    assert "there is no scene" in fails("input or output failed", iftty.open, "missing.nii").why


@story
def stops():
    """a command is taken back by another thread and by Ctrl-C, and says how far it was"""
    if PLAIN:
        return
    told = []

    def progress(what, done, total):
        told.append((what, done, total))
        if len(told) == 1:
            threading.Timer(0, s.cancel).start()

    def count_of(what, done, total):
        assert what and 0 <= done and 0 <= total

    with iftty.open("synth:geom", journal="stops.iftty", progress=count_of) as s:
        s.finish("relax", sweeps=1000, reach=16)
        s.seed((100, 100, 50), 1)
        chain = s.seed((5, 5, 5), 0).chain
        s.progress = progress
        fails("cancelled", s.array, "labels", finished=True)
        s.progress = None
        assert told and s.info().chain == chain
        s.progress = lambda *_: _thread.interrupt_main()
        try:
            s.save("labels", "stopped.nii", finished=True)
            raise AssertionError("it was not stopped")
        except KeyboardInterrupt:
            s.progress = None
        assert s.info().chain == chain and not os.path.exists("stopped.nii")


@story
def goes_on():
    """a journal is gone on with, or looked at"""
    with iftty.open(journal="errors.iftty") as s:
        assert s.greeting["records"] == 3 and s.zoom(3).record == 4
    with iftty.open("errors.iftty", read_only=True) as s:
        assert s.greeting["read_only"] and s.seed((1, 1, 1), 1).records == s.info().records
    with iftty.open(journal=pathlib.Path("errors.iftty")) as s:
        assert s.greeting["records"] == 4


print(f"1..{count}")
