# SPDX-License-Identifier: MIT
"""NRRD files for tests/test_nrrd.sh, by hand: each header twice, with its voxels after it, which
iftty may read itself, and with them in another file, which ITK reads.

    nrrd.py FOLDER     makes FOLDER/ours/N.nrrd with N.nhdr, which iftty reads itself,
                       FOLDER/left/N.nrrd with N.nhdr, which it leaves to ITK, and files in
                       left-anterior-superior, FOLDER/las/NAME.nrrd with NAME.nhdr, where NAME
                       says how"""
import gzip
import itertools
import os
import struct
import sys

TYPES = {
    "b": ("signed char", "int8", "int8_t"),
    "B": ("uchar", "unsigned char", "uint8", "Uint8_T"),
    "h": ("short", "short int", "signed short", "signed short int", "int16", "int16_t"),
    "H": ("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"),
    "i": ("int", "signed int", "int32", "int32_t"),
    "I": ("uint", "unsigned int", "uint32", "uint32_t"),
    "q": ("longlong", "long long", "long long int", "signed long long", "signed long long int",
          "int64", "int64_t"),
    "Q": ("ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"),
    "f": ("float", "FLOAT"),
    "d": ("double",),
}
SIZE = (5, 4, 3)
COUNT = 60
STRAIGHT = "(0.9,0,0) (0,1.1,0) (0,0,2.5)"
TILTED = ("(0.7000000000000001,-0.1,0.0333) (1.1e-1,0.81234567890123456,0.2) "
          "( -0.0,0.3e0, -1.7 )")
TURNED = "(0,0,-1.25)\t(-0.48828125,0,-0)  (0,0.48828125,0)"
SEGMENTS = ["Segment0_ID:=Segment_1", "Segment0_Name:=liver: left", "Segment0_Tags:=|",
            "Segment0_Color:=0.5 0.25 1", "Segmentation_Source:=", ":=no key", "a:=b\\n\\\\",
            "# a comment: of no use", "#", "\u00b5:=\u00fc"]


def voxels(letter, big):
    if letter in "fd":
        values = [i * 1.37 - 11 for i in range(COUNT)]
    else:
        signed, most = letter in "bhiq", {"b": 7, "B": 7, "h": 90, "H": 90}.get(letter, 40)
        values = [(i * 37 % 18) * most - signed * 9 * most for i in range(COUNT)]
    return struct.pack((">" if big else "<") + "%d%s" % (COUNT, letter), *values)


class Maker:
    def __init__(self, folder):
        self.folder, self.number = folder, 0
        os.makedirs(folder)

    def make(self, *fields, letter="h", name=None, big=False, encoding="raw", endian=True,
             sizes="5 4 3", end="\n", magic="NRRD0004", first=None, before=b"",
             raw=None, called=None):
        """The same fields for both, in their order."""
        self.number += 1
        number = called or "%d" % self.number
        path = os.path.join(self.folder, number)
        head = first if first is not None else [
            "type: " + (name or TYPES[letter][0]), "dimension: 3", "sizes: " + sizes]
        head = [magic] + head + ["encoding: " + encoding]
        if endian:
            head.append("endian: " + ("big" if big else "little"))
        head += fields
        raw = raw or before + voxels(letter, big)
        if encoding.lower() in ("gz", "gzip"):
            raw = gzip.compress(raw, mtime=0)
        elif encoding == "hex":
            raw = raw.hex().encode()
        with open(path + ".nrrd", "wb") as file:
            file.write(end.join(head + ["", ""]).encode() + raw)
        with open(path + ".voxels", "wb") as file:
            file.write(raw)
        head.append("data file: %s.voxels" % number)
        with open(path + ".nhdr", "wb") as file:
            file.write(end.join(head + ["", ""]).encode())


def make_ours(make):
    for letter, big in itertools.product(TYPES, (False, True)):
        make(letter=letter, name=TYPES[letter][-big], big=big,
             encoding=("raw", "gz", "gzip", "GZIP")[(ord(letter) + 2 * big) % 4])
    for letter in TYPES:
        for name in TYPES[letter][1:-1]:
            make(letter=letter, name=name)
    for letter in "bB":
        make(letter=letter, endian=False)
    for space, place in itertools.product(
            ("LPS", "left-posterior-superior", "RAS", "Right-Anterior-Superior", "LAS",
             "Left-Anterior-Superior", "scanner-xyz", "3D-right-handed", "3D-left-handed", None),
            (STRAIGHT, TILTED, TURNED, None)):
        origin = None if place == STRAIGHT else "(-12.5,0,3.0000000000000004)"
        fields = ["space: " + space] if space else ["space dimension: 3"]
        fields += ["space directions: " + place] if place else []
        fields += ["space origin: " + origin] if origin else []
        make(*fields)
    for origin in ("(0,0,0)", "(-0,-0,-0)", "( 1e2 ,\t-2 , 3)", "(1e-300,1e300,7)"):
        for space in ("RAS", "LPS", "LAS"):
            make("space: " + space, "space directions: " + TILTED, "space origin: " + origin)
    make("space: lps", "space directions: (1e-2,0,0) (0,1E-2,0) (0,0,0.13e+0)")
    make("space: lps", "space directions: (1e-7,0,0) (0,5000,0) (0,0,1)")  # no distances
    make("space: RAS", "space directions: (1,0,0) (2,0,0) (0,0,1)")  # no place
    for spacings in ("1 1 1", "0.9 1.1 2.5 ", "0.48828125\t 1e-1 3", "1e-7 1 5000"):
        make("spacings: " + spacings)
    make("content: a map: of labels", "number: many", "min: 0", "max: x", "sample units: mm",
         "kinds: domain space none", "centerings: cell node none", 'labels: "x:" "" "z"',
         "spacings: 1 2 3", 'units: "mm"  "mm" "mm"')
    make("space: LPS", "space directions: " + TILTED, "kinds: domain domain domain",
         'space units: "mm" "mm" "mm"', "measurement frame: (1,0,0) (0,0,1) (0,-1,0)", *SEGMENTS)
    make(*(SEGMENTS * 400), magic="NRRD0005")
    make("spacings: 1 2 3", end="\r\n", magic="NRRD0001", encoding="gzip")
    make("TYPE: short", "Dimension: 3", "SIZES:   5\t4 3 ", "Spacings: 3 2 1", first=[])
    make("byte skip: 7", before=b"anybyte")
    make("long:=" + "x" * 70000)


def make_left(make):
    """What ITK reads, what it refuses, and what it takes otherwise than it should."""
    lps = ["space: LPS", "space directions: " + STRAIGHT]
    for space in ("left anterior superior", "left posterior superior", "LPST", "ras ", "x"):
        make("space: " + space, "space directions: " + TILTED)
    for place in ("none none none", "(nan,nan,nan) (0,1,0) (0,0,1)", "(0,0,0) (0,1,0) (0,0,1)",
                  "(1.,0,0) (0,.5,0) (0,0,1)", "(1,0,0) (0,1,0)", "(1x,0,0) (0,1,0) (0,0,1)",
                  "(1,0) (0,1) (0,0)", "(1,0,0) (0,1,0) (0,0,1) (1,1,1)",
                  "(1e20,0,0) (0,1,0) (0,0,1)", "(1.00000000000000000000001,0,0) (0,1,0) (0,0,1)"):
        make("space: LPS", "space directions: " + place)
    for spacings in ("nan nan nan", "1 nan 2", "-1 1 1", "0 1 1", "1 1", "1 1 1 1", "1x 1 1"):
        make("spacings: " + spacings)
    make(*lps, "spacings: 1 1 1")
    make("space: LPS", "spacings: 1 2 3")
    make(*lps, "space origin: none")
    make("space directions: " + STRAIGHT, "space: LPS")
    make("space dimension: 3", *lps)
    make(*lps, "kinds: vector domain domain")
    make("line skip: 0")
    make("byte skip: -1")
    make("spacings: 1 1 1", "spacings: 1 1 1")
    make("foo: bar")
    make("foo")
    make(" # no comment")
    make(*lps, "space:=x")
    make(*lps, " SPACE :=x")
    make("datafile:=x")
    make("spacings: 1 2 3", "Spacings:=nan")
    make("old min: 0")
    make("thicknesses: 1 1 1")
    make(*["k%d:=1" % i for i in range(1100)], *lps)
    make(sizes="5 4.5 3")
    make(sizes="5 4")
    make(sizes="5 12 1 1")
    make(encoding="hex")
    make(endian=False)
    make(magic="NRRD0006")
    make("x:=a\rb")
    make("type: short", "sizes: 5 4 3", "dimension: 3", first=[])
    make("x:=" + "y" * (1 << 20))


def make_las(make):
    """One voxel of 7, the fourth along x, second along y and third along z, and 0 else; and where
    all lie in left-anterior-superior, said in many ways. `ras` is the same place in another space,
    and `turned` has its axes the other way, x towards the right."""
    one = bytes(7 * (i == 3 + 5 * (1 + 4 * 2)) for i in range(COUNT))
    las, origin = "space: LAS", "space origin: (-12.5,20,3)"
    straight = "space directions: " + STRAIGHT

    def add(called, *fields, **how):
        make(*fields, letter="B", raw=one, called=called, **how)

    add("plain", las, straight, origin)
    add("gzip", "space: left-anterior-superior", straight, origin, encoding="gzip")
    add("hex", las, straight, origin, encoding="hex")
    add("dots", las, "space directions: (.9,0.,0) (0,1.1,0)  (0,0,2.5)", origin)
    add("series", las, straight + " none", origin, "kinds: domain domain domain list",
        first=["type: uchar", "dimension: 4", "sizes: 5 4 3 1"])
    add("ras", "space: RAS", "space directions: (-0.9,0,0) (0,1.1,0) (0,0,2.5)",
        "space origin: (12.5,20,3)")
    add("turned", "space: RAS", "space directions: (0.9,0,0) (0,1.1,0) (0,0,2.5)",
        "space origin: (8.9,20,3)")  # 12.5 - 4 * 0.9
    add("none", las, straight, "space origin: none")
    add("nan", las, straight, "space origin: (nan,nan,nan)")
    add("words", las, "space directions: (0.9,0,0) (0,1.1,0) (0,0,2.5x)", origin)


make_ours(Maker(os.path.join(sys.argv[1], "ours")).make)
make_left(Maker(os.path.join(sys.argv[1], "left")).make)
make_las(Maker(os.path.join(sys.argv[1], "las")).make)
