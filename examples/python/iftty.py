# SPDX-License-Identifier: MIT
"""Segment 3-D scenes from Python: a session of `iftty serve`, its commands as methods.

    import iftty

    with iftty.open("ch2.nii.gz", journal="x.iftty") as s:
        s.seed((90, 108, 90), 1, radius=6)      # the line `seed 90,108,90 1 radius=6`
        s.seed((5, 5, 5), 0)
        labels = s.labels()                     # labels[x, y, z], as nibabel indexes it
        print(s.report("stats")["by_label"])

Every command of `iftty help all` is a method, with its parameters in the order of `help NAME`,
and those written `name=` by their names: `s.save("labels", "brain.nii.gz", replace=True)`. A dash
is an underscore (`s.label_file`), and a word that Python keeps for itself ends in one (`from_=`). A
tuple is joined by commas; a list of tuples is a key that comes several times. `s.do("zoom 2")`
carries out a line as it is. A command that fails raises iftty.Error, and has changed nothing.

Places are voxel indices x, y, z from 0. Arrays come as numpy arrays indexed [x, y, z]; without
numpy as memoryviews indexed [z, y, x]. `s.affine` leads from indices to millimetres, to the right,
front and head, or is None where the scene's file does not say it.

It needs Python 3.8 and the program `iftty`, in PATH or where $IFTTY says, and nothing else; numpy
and nibabel are used where they are installed.
"""
import array
import json
import logging
import os
import pathlib
import subprocess
import sys
import threading
from typing import Any, Callable, Dict, List, Optional, Sequence, Union

try:
    import numpy
except ImportError:
    numpy = None

PROTOCOL = 1
Progress = Callable[[str, int, int], None]

# Types of voxels: as numpy and as the modules array and memoryview call them.
_TYPES = {"uint8": ("u1", "B"), "uint16": ("<u2", "H"), "uint32": ("<u4", "I"),
          "float32": ("<f4", "f")}
_log = logging.getLogger("iftty")


class Error(Exception):
    """A request that was not carried out.

    `kind` is what sort of error it is ("bad usage", "bad input", "cancelled", ...), `why` its
    words, `line` the command, `column` where in it the wrong word begins (from 1, or None), `hints`
    the words that may have been meant, and `choices` lines to choose from.
    """

    def __init__(self, answer: Dict[str, Any], line: str = "") -> None:
        super().__init__(answer.get("why", "no answer"))
        self.kind: str = answer.get("kind", "input or output failed")
        self.why: str = answer.get("why", "no answer")
        self.hints: List[str] = answer.get("hints", [])
        self.column: Optional[int] = answer.get("column")
        self.choices: str = answer.get("list", "")
        self.line = line


class Answer(dict):
    """What a command answered; `answer["text"]` is `answer.text`.

    `text` is for people, `words` are those of its record (counts and digests), `record` its number
    or None, `command` its canonical form, `files` what it has written, `journal` and `chain` where
    the session stands; `picture` is the PNG that `render`, `slice` or `mosaic` without a file has
    made, which stays until the next one.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None


def _word(value: Any) -> str:
    """A value as a word of a command."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        if text and not set(text) & set(" \t\"\\") and text[0] not in "#'":
            return text
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if hasattr(value, "__len__"):
        return ",".join(_word(part) for part in value)
    return str(value.__index__()) if hasattr(value, "__index__") else repr(float(value))


def _line(name: str, values: Sequence[Any], keyed: Dict[str, Any]) -> str:
    """A command with its parameters, as it is typed."""
    words = [name.rstrip("_").replace("_", "-")]
    words += [_word(value) for value in values if value is not None]
    for key, value in keyed.items():
        several = isinstance(value, list) and value and isinstance(value[0], (list, tuple))
        for one in value if several else [value]:
            if one is not None:
                words.append(key.rstrip("_").replace("_", "-") + "=" + _word(one))
    return " ".join(words)


class Session:
    """One session of iftty; made by iftty.open. Threads may share it: commands take turns."""

    def __init__(self, command: Sequence[str], progress: Optional[Progress]) -> None:
        self.progress = progress
        self._turn, self._writing = threading.RLock(), threading.Lock()
        self._next, self._at_hand = 1, 0
        self._server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        greeting = self._read()
        if not greeting.get("ok") or greeting.get("protocol") != PROTOCOL:
            self.close()
            raise Error(greeting if not greeting.get("ok") else
                        {"why": f"protocol {greeting['protocol']}, expected {PROTOCOL}"})
        self.greeting = greeting
        self.folder: str = greeting["folder"]
        self.affine: Any = self._affine((greeting["scene"] or {}).get("affine"))

    # ---- lines ----

    def _read(self) -> Dict[str, Any]:
        line = self._server.stdout.readline()
        return json.loads(line) if line else {}

    def _write(self, message: Dict[str, Any]) -> None:
        with self._writing:
            self._server.stdin.write(json.dumps(message).encode() + b"\n")
            self._server.stdin.flush()

    def _answer(self) -> Dict[str, Any]:
        """The next line that is an answer; what comes before it is told."""
        while True:
            message = self._read()
            if "progress" in message:
                if self.progress:
                    self.progress(message["progress"], message["done"], message["total"])
            elif "notice" in message:
                _log.info("%s", message["notice"])
            else:
                return message

    def _ask(self, request: Dict[str, Any], line: str) -> Answer:
        with self._turn:
            self._at_hand, self._next = self._next, self._next + 1
            try:
                self._write({"id": self._at_hand, **request})
                try:
                    answer = self._answer()
                except BaseException:  # Ctrl-C, or from `progress`: nothing is left half read
                    self.cancel()
                    self.progress, told = None, self.progress
                    self._answer()
                    self.progress = told
                    raise
            except BrokenPipeError:
                answer = {}
            finally:
                self._at_hand = 0
        if not answer.get("ok"):
            if not answer:
                answer["why"] = f"iftty has ended, with status {self._server.wait()}"
            raise Error(answer, line)
        return Answer(answer)

    # ---- commands ----

    def do(self, line: str) -> Answer:
        """Carries out a line as at the prompt."""
        return self._ask({"do": line}, line)

    def __getattr__(self, name: str) -> Callable[..., Answer]:
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *values, **keyed: self.do(_line(name, values, keyed))

    def cancel(self) -> None:
        """Stops the command that another thread waits for, which raises Error there."""
        if self._at_hand:
            self._write({"cancel": self._at_hand})

    def report(self, name: str, *values: Any, **keyed: Any) -> Dict[str, Any]:
        """What `stats`, `hints` or `compare` writes as JSON."""
        keyed = {**keyed, "report": os.path.join(self.folder, "report.json"), "replace": True}
        answer = self.do(_line(name, values, keyed))
        return json.loads(pathlib.Path(answer.files[0]).read_text())

    # ---- arrays ----

    @staticmethod
    def _affine(rows: Optional[List[List[float]]]) -> Any:
        return numpy.array(rows, float) if numpy and rows else rows

    def array(self, name: str, finished: bool = False) -> Any:
        """Voxels of labels, cost, root, border, distance, margin or intensity."""
        request: Dict[str, Any] = {"array": name}
        if finished:
            request["finished"] = True
        with self._turn:
            answer = self._ask(request, f"array {name}")
            data = pathlib.Path(answer.file).read_bytes()[answer.offset:]
        self.affine = self._affine(answer.affine)
        modern, plain = _TYPES[answer.type]
        if numpy:
            return numpy.frombuffer(data, modern).reshape(answer.size, order="F")
        voxels = array.array(plain, data)
        if sys.byteorder == "big":
            voxels.byteswap()
        return memoryview(voxels).cast("B").cast(plain, answer.size[::-1])

    def labels(self, values: Any = None, finished: bool = False, **keyed: Any) -> Any:
        """The labels; or, of values given, begins with those as a segmentation (`labels FILE`).

        Values are a file's path, or an array of whole numbers indexed as arrays here are. The
        journal has its own copy of them beside it, and so needs neither later.
        """
        if values is None:
            return self.array("labels", finished)
        if isinstance(values, (str, os.PathLike)):
            return self.do(_line("labels", [values], keyed))
        if numpy and not isinstance(values, memoryview):
            wide = bool(numpy.max(values) > 255)
            data = numpy.asarray(values).astype("<u2" if wide else "u1").tobytes(order="F")
        else:
            data = memoryview(values).tobytes()
            wide = memoryview(values).itemsize > 1
        with self._turn:  # a map of the session has the header that this one is to have
            like = self._ask({"array": "cost" if wide else "border"}, "labels")
            if len(data) != os.path.getsize(like.file) - like.offset:
                raise ValueError(f"expected an array of {like.size} voxels")
            path = os.path.join(self.folder, "given.nii")
            pathlib.Path(path).write_bytes(
                pathlib.Path(like.file).read_bytes()[:like.offset] + data)
            return self.do(_line("labels", [path], keyed))

    def image(self, name: str = "labels", finished: bool = False) -> Any:
        """The same as a nibabel image, in memory."""
        import nibabel
        return nibabel.Nifti1Image(self.array(name, finished), self.affine)

    # ---- the end ----

    def close(self) -> None:
        """Ends the session; the journal has everything."""
        try:
            self._server.stdin.close()
        except BrokenPipeError:
            pass
        self._server.stdout.read()
        self._server.stdout.close()
        self._server.wait()

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def open(scene: Union[str, "os.PathLike[str]", None] = None, *,
         journal: Union[str, "os.PathLike[str]", None] = None, read_only: bool = False,
         progress: Optional[Progress] = None, program: Optional[str] = None,
         options: Sequence[str] = ()) -> Session:
    """Begins a session with a scene, or goes on with a journal (`scene` or `journal`).

    Without a journal one is begun here, as by the prompt: NAME-1.iftty. `progress` is called with
    what is being done, and how many of how many units are done (0: not known), for commands that
    take longer than half a second. `options` are further ones of `iftty serve`.
    """
    command = [program or os.environ.get("IFTTY") or "iftty", "serve", *options]
    if read_only:
        command.append("--read-only")
    if scene is None and journal is not None and os.path.exists(journal):
        scene, journal = journal, None  # is gone on with as it was left
    if journal is not None:
        command += ["--journal", os.fspath(journal)]
    if scene is not None:
        command += ["--", os.fspath(scene)]
    return Session(command, progress)
