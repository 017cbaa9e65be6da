# SPDX-License-Identifier: MIT
# Read the example of journal/FORMAT.md, and journals, by that page alone: lines, chains, words,
# markers, notes of golden images, and copies of labels. read_journal.py FORMAT.md JOURNAL...
import gzip, hashlib, re, struct, sys
from pathlib import Path

WORDS = {"at": r"\d+", "on": r"[^=]+", "branch": r"[^=]+", "took": r"\d+,\d+,\d+(;\d+,\d+,\d+)*",
         "marker": r"\d+(-\d+)?", "removed": r"\d+(-\d+)?(,\d+(-\d+)?)*",
         "spared": r"\d+(-\d+)?(,\d+(-\d+)?)*", "seeds": r"\d+", "pending": r"\d+", "added": r"\d+",
         "inside": r"\d+", "sha256": "[0-9a-f]{64}", "orientation": "file|sform|qform|user|unknown"}
SIGNATURE = r"#@ (who=[^ ]+ )?(at=\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ )?session=\d+"


def attributes(path):  # of an OpenEXR: NAME 0 TYPE 0 SIZE BYTES
    data, at, found = path.read_bytes(), 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 6
        size, = struct.unpack_from("<i", data, at - 4)
        found[name.decode()] = data[at:at + size].decode("latin-1")
        at += size
    return found


def copy_digest(path):
    data = gzip.open(path).read()
    size, begin = struct.unpack_from("<3H", data, 42), int(*struct.unpack_from("<f", data, 108))
    covered = struct.pack("<3I", *size) + data[begin:]
    for key, name in re.findall("<Label (.*?)>(.*?)</Label>", data[348:begin].decode("latin-1")):
        of = dict(re.findall(r'(\w+)="([^"]*)"', key))
        rgb = " ".join(str(round(255 * float(of[one]))) for one in ("Red", "Green", "Blue"))
        name = name[9:-3].replace('"', '\\"') + ("\t" + of["Code"] if "Code" in of else "")
        if of["Key"] != "0":
            covered += f'{of["Key"]} {rgb} 1 1 1 "{name}"\n'.encode("latin-1")
    return hashlib.sha256(covered).hexdigest()[:32]


def read(data, path):
    head, *lines = data.decode().split("\n")
    assert re.fullmatch("# iftty journal 1 semantics [1-9][0-9]{0,8}", head) and lines.pop() == ""
    chain, covered, number, marker, command = "0" * 32, head + "\n", 0, 0, None
    for line in lines:
        assert len(line.encode()) < 65536 and not re.search("[\0-\x1f\x7f]", line), line
        result = re.fullmatch("(= (\\d+)((?: [^ ]+)*)) chain=([0-9a-f]{32})", line)
        if not result:
            assert not line.startswith("#@ ") or re.fullmatch(SIGNATURE, line), line
            assert line[:1] in ("", "#") or command is None and line[0] not in " =", line
            command = line if line[:1] not in ("", "#") else command
            covered += line + "\n"
            continue
        before, number = chain, number + 1
        chain = hashlib.sha256((chain + covered + result[1]).encode()).hexdigest()[:32]
        assert (result[2], result[4]) == (str(number), chain), line
        word = dict(one.split("=", 1) for one in result[3].split())
        assert command and len(word) == len(result[3].split()) <= 64, line
        for key, value in word.items():
            assert re.fullmatch(WORDS.get(key, "[^=]+"), value), line
        first, _, last = word.get("marker", str(marker)).partition("-")
        marker += "marker" in word or "took" in word
        assert int(first) == marker or "took" in word, line
        marker = int(last or marker)
        golden = path and re.match("golden ([^ ]+)", command)
        if golden:
            note = attributes(path.with_suffix(".golden") / f"{golden[1]}.exr")
            assert (note["iftty:journal"], note["iftty:chain"]) == (path.name, before), line
        for digest in re.findall(" copy=([^ ]+)", command):
            assert copy_digest(path.with_suffix(".golden") / f"labels-{digest}.nii.gz") == digest
        covered, command = "", None
    assert not covered
    print(path, number, "records", chain)


page = Path(sys.argv[1]).read_bytes()
read(page.split(b"```journal\n")[1].split(b"```")[0], None)
for path in map(Path, sys.argv[2:]):
    read(path.read_bytes(), path)
