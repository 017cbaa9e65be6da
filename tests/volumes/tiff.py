# SPDX-License-Identifier: MIT
"""TIFF files of tifffile, PIL, libtiff's tools and OpenImageIO, and of bytes by hand, for
tests/test_tiff.sh.

    tiff.py FOLDER      makes them there, with twins, NIfTI files of nibabel's that have the same
                        voxels, and prints lines "STORY FILE TWIN [OPTION...]"
    tiff.py break FOLDER ROUNDS
                        makes copies of some with wrong numbers in their directories, in FOLDER/bad
"""
import os
import random
import struct
import subprocess
import sys
import zlib

import numpy
import tifffile
from PIL import Image, ImageSequence

from make import read, save_plain_twin

SIZE = (26, 22, 5)  # x, y, z
KINDS = "uint8 int8 uint16 int16 uint32 int32 uint64 int64 float16 float32 float64".split()


def voxels(kind="uint16", times=1):
    """[volume][z][y][x], or without volumes where there is one; no axis can be mistaken."""
    n, z, y, x = numpy.indices((times, *SIZE[::-1]))
    ball = (x - 9) ** 2 + (y - 12) ** 2 + (4 * (z - 2)) ** 2 < 40
    least = -90 if numpy.dtype(kind).kind != "u" else 0
    data = x + 2 * y + 9 * z + 60 * ball + 5 * n + least
    data = (data / 4 if numpy.dtype(kind).kind == "f" else data).astype(kind)
    return data if times > 1 else data[0]


def twin(name, data, spacing=(0, 0, 0)):
    """Of data[z][y][x], of unknown orientation."""
    if data.dtype == numpy.float16:
        data = data.astype(numpy.float32)
    save_plain_twin(name, numpy.ascontiguousarray(data.T), spacing)
    return name + ".twin.nii"


def tell(story, name, of, *options):
    print(story, name, of, *options)


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


# Of three times and two channels: t, c, "tc" and the word that chooses the volume.
SIX = [(t, c, "%d%d" % (t, c), "volume=%d" % (2 * t + c)) for t in range(3) for c in range(2)]


def grey(name, data, **options):
    tifffile.imwrite(name, data, photometric=options.pop("photometric", "minisblack"), **options)


# ---- bytes by hand ----

CODE = {1: "B", 2: "s", 3: "H", 4: "I", 5: "I", 6: "b", 7: "B", 12: "d", 16: "Q"}
WIDTH, HEIGHT, BITS, PACKING, COLOURS, TEXT, OFFSETS, SAMPLES, ROWS, LENGTHS = \
    256, 257, 258, 259, 262, 270, 273, 277, 278, 279


def encoded(value, kind, order):
    if kind == 2:
        return value, len(value)
    values = value if isinstance(value, (list, tuple, bytes)) else [value]
    return (struct.pack("%s%d%s" % (order, len(values), CODE[kind]), *values),
            len(values) // (2 if kind == 5 else 1))


def write(name, pages, order="<", gap=b""):
    """Each page is {tag: (type, value)} and the bytes of its strips."""
    out = bytearray((b"II*\0" if order == "<" else b"MM\0*") + bytes(4))
    link = 4
    for tags, strips in pages:
        tags = dict(tags)
        tags.setdefault(OFFSETS, (4, [0] * len(strips)))
        tags.setdefault(LENGTHS, (4, [len(strip) for strip in strips]))
        at = []
        for strip in strips:
            at.append(len(out))
            out += strip + b"\0" * (len(strip) % 2)
        if tags[OFFSETS][1] == [0] * len(strips):
            tags[OFFSETS] = (4, at)
        out += gap + b"\0" * (len(gap) % 2)
        entries = b""
        for tag in sorted(tags):
            data, count = encoded(tags[tag][1], tags[tag][0], order)
            if len(data) > 4:
                where = len(out)
                out += data + b"\0" * (len(data) % 2)
                data = struct.pack(order + "I", where)
            entries += struct.pack(order + "HHI", tag, tags[tag][0], count) + data.ljust(4, b"\0")
        struct.pack_into(order + "I", out, link, len(out))
        out += struct.pack(order + "H", len(tags)) + entries
        link = len(out)
        out += bytes(4)
    with open(name, "wb") as file:
        file.write(out)


def directory(name, entries):
    """A page of 64x64 bytes by these entries, (tag, type, value) in this order: at 512 are 100
    bytes of 1 and then others, at 4608 is a whole page."""
    out = b"II*\0" + struct.pack("<IH", 8, len(entries))
    for tag, kind, value in entries:
        out += struct.pack("<HHII", tag, kind, 1, value)
    out = (out + bytes(4)).ljust(512, b"\0")
    with open(name, "wb") as file:
        file.write((out + b"\1" * 100).ljust(4608, b"\xee") + b"\2" * 4096)


def page(data, bits=None, packed=None, order="<", **more):
    """A page of data[y][x], one strip."""
    kind = {"u": 1, "i": 2, "f": 3, "b": 1}[data.dtype.kind]
    tags = {WIDTH: (3, data.shape[1]), HEIGHT: (3, data.shape[0]), PACKING: (3, 1),
            COLOURS: (3, 1), ROWS: (3, data.shape[0]), SAMPLES: (3, 1),
            BITS: (3, bits or 8 * data.dtype.itemsize), 339: (3, kind)}
    for tag, value in more.items():
        tags[int(tag[1:])] = value
    tags = {tag: value for tag, value in tags.items() if value}
    if packed is None:
        packed = data.astype(data.dtype.newbyteorder(order)).tobytes()
    return tags, [packed]


def packed_bits(data, bits):
    """Rows of so many bits a number, the highest first, each row in whole bytes."""
    each = (data[..., None].astype("i8") >> numpy.arange(bits - 1, -1, -1)) & 1
    return numpy.packbits(each.reshape(len(data), -1).astype("u1"), axis=1).tobytes()


# ---- types, packings and orders ----


def make_types():
    for kind in KINDS:
        data = voxels(kind)
        if data.dtype.kind == "f":
            data[0, 0, 0] = 1e-6  # of float16, one that is not normal
            data[0, 0, 1] = -0.0
        of = twin(kind, data)
        for name, options in ((kind + ".tif", {}), (kind + "-big.tif", {"byteorder": ">"}),
                              (kind + "-bigtiff.tif", {"bigtiff": True}),
                              (kind + "-tiles.tif", {"tile": (16, 16)}),
                              (kind + "-strips.tif", {"rowsperstrip": 5})):
            grey(name, data, **options)
            tell("types", name, of)
    mask = voxels() > 80
    of = twin("bits", mask.astype("u1"))
    grey("bits.tif", mask)
    tell("types", "bits.tif", of)
    run("tiffcp", "-t", "-w", "16", "-l", "16", "bits.tif", "bits-tiles.tif")
    tell("types", "bits-tiles.tif", of)
    odd = voxels("float32")
    odd[1, 2, 3:6] = [numpy.nan, numpy.inf, -numpy.inf]
    grey("nan.tif", odd)
    tell("types", "nan.tif", twin("nan", odd))


def make_few_bits():
    for bits in (2, 4, 6, 10, 12, 14):
        data = (voxels() * 37 % 2 ** bits).astype("u1" if bits <= 8 else "u2")
        of = twin("of%d" % bits, data)
        write("of%d.tif" % bits, [page(z, bits, packed_bits(z, bits)) for z in data])
        tell("bits", "of%d.tif" % bits, of)
    signed = (voxels().astype("i2") * 37 % 4096 - 2048).astype("i2")
    write("signed12.tif", [page(z, 12, packed_bits(z, 12)) for z in signed])
    tell("bits", "signed12.tif", twin("signed12", signed))
    for order in "<>":
        wide = voxels("uint32") * 70001 % 2 ** 24
        name = "of24-%s.tif" % ("small" if order == "<" else "big")
        write(name, [page(z, 24, z.astype(order + "u4").tobytes(), order) for z in wide], order)
        raw = []
        for z in wide:
            four = z.astype(order + "u4").view("u1").reshape(-1, 4)
            raw.append(page(z, 24, (four[:, :3] if order == "<" else four[:, 1:]).tobytes(), order))
        write(name, raw, order)
        tell("bits", name, twin("of24", wide))
    signed = voxels("int32") * 70001
    write("signed24.tif", [page(z, 24, z.astype("<i4").view("u1").reshape(-1, 4)[:, :3].tobytes())
                           for z in signed])
    tell("bits", "signed24.tif", twin("signed24", signed))


def make_packed():
    for source, ways in (("uint16", "none lzw lzw:2 zip zip:2 packbits zstd zstd:2 lzma lzma:2"),
                         ("uint8", "lzw:2 zstd"), ("uint32", "zip:2 lzw:2"), ("int16", "zstd:2"),
                         ("float32", "zip:3 zstd:3 lzw:3"), ("float64", "zip:3"),
                         ("float16", "zip:3"), ("uint64", "zip:2"), ("uint8-tiles", "lzw:2"),
                         ("uint16-tiles", "zip zstd:2"), ("uint16-big", "lzw:2"),
                         ("bits", "g3 g3:2d g4 packbits lzw")):
        for way in ways.split():
            name = "%s-%s.tif" % (source, way.replace(":", ""))
            run("tiffcp", "-c", way, source + ".tif", name)
            tell("packed", name, source.split("-")[0] + ".twin.nii")
    for source in ("uint16", "bits", "uint16-lzw", "bits-g4"):
        name = source + "-filled.tif"  # FillOrder 2
        run("tiffcp", "-f", "lsb2msb", source + ".tif", name)
        tell("packed", name, source.split("-")[0] + ".twin.nii")
    pages = []
    for z in range(SIZE[2]):  # by OpenImageIO, of tiles
        pages.append("s%d.tif" % z)
        grey(pages[-1], voxels()[z])
    run("oiiotool", *pages, "--siappendall", "--tile", "16", "16", "--compression", "zip", "-o",
        "oiio.tif")
    tell("packed", "oiio.tif", "uint16.twin.nii")
    images = [Image.fromarray(z) for z in voxels("uint8")]
    images[0].save("pil.tif", save_all=True, append_images=images[1:], compression="tiff_lzw")
    tell("packed", "pil.tif", "uint8.twin.nii")
    images[0].save("jpeg.tif", save_all=True, append_images=images[1:], compression="jpeg")
    decoded = [numpy.array(one) for one in ImageSequence.Iterator(Image.open("jpeg.tif"))]
    tell("packed", "jpeg.tif", twin("jpeg", numpy.stack(decoded)))


# ---- samples and photometric interpretations ----


def make_samples():
    data = voxels("uint8")
    of = "uint8.twin.nii"
    shades = numpy.stack([numpy.arange(256, dtype="u2") * 257] * 3)
    for name, table in (("palette.tif", shades), ("colourful.tif", shades[:, ::-1] % 40000)):
        grey(name, data, photometric="palette", colormap=table)
        tell("samples", name, of)
    few = (voxels() % 16).astype("u1")
    tags = {"_262": (3, 3), "_320": (3, [257 * i for i in range(16)] * 3)}
    write("palette4.tif", [page(z, 4, packed_bits(z, 4), **tags) for z in few])
    tell("samples", "palette4.tif", twin("palette4", few))
    alpha = numpy.stack([data, 255 - data], -1)
    for name, kind in (("alpha.tif", "unassalpha"), ("associated.tif", "assocalpha")):
        grey(name, alpha, extrasamples=[kind])
        tell("samples", name, of)
    grey("alpha-apart.tif", numpy.moveaxis(alpha, -1, 1), extrasamples=["unassalpha"],
         planarconfig="separate")
    tell("samples", "alpha-apart.tif", of)
    images = [Image.fromarray(z, "LA") for z in alpha]
    images[0].save("alpha-pil.tif", save_all=True, append_images=images[1:])
    tell("samples", "alpha-pil.tif", of)
    three = voxels("uint16", 3)
    for n in range(3):
        of = twin("three%d" % n, three[n])
        if n == 0:
            grey("contig.tif", numpy.moveaxis(three, 0, -1), extrasamples=["unspecified"] * 2)
            grey("separate.tif", numpy.moveaxis(three, 0, 1), extrasamples=["unspecified"] * 2,
                 planarconfig="separate")
            run("tiffcp", "-c", "lzw:2", "-t", "-w", "16", "-l", "16", "contig.tif",
                "contig-tiles.tif")
            run("tiffcp", "-c", "zip:2", "-r", "6", "separate.tif", "separate-zip.tif")
        for name in ("contig.tif", "separate.tif", "contig-tiles.tif", "separate-zip.tif"):
            tell("samples", name, of, "volume=%d" % n)
    mask = voxels() > 80  # white where 1, as PIL shows it
    grey("white.tif", ~mask, photometric="miniswhite")
    seen = [numpy.array(one).astype("u1")
            for one in ImageSequence.Iterator(Image.open("white.tif"))]
    tell("samples", "white.tif", twin("white", numpy.stack(seen)))
    bare = voxels("uint16")
    write("bare.tif", [page(z, _339=None, _262=None, _277=None) for z in bare])
    tell("samples", "bare.tif", "uint16.twin.nii")
    write("range.tif", [page(z, _280=(3, 5), _281=(3, 9), _340=(3, 5), _341=(3, 9), _339=(3, 4))
                        for z in bare])
    tell("samples", "range.tif", "uint16.twin.nii")
    # By numpy: some versions of PIL turn a page when it is read, and others do not.
    turns = {2: lambda one: one[:, ::-1], 3: lambda one: one[::-1, ::-1], 4: lambda one: one[::-1],
             5: lambda one: one.T, 6: lambda one: numpy.rot90(one, -1),
             7: lambda one: one[::-1, ::-1].T, 8: numpy.rot90}
    for orientation, turn in turns.items():
        name = "turned%d.tif" % orientation
        grey(name, data, extratags=[(274, 3, 1, orientation, False)])
        tell("samples", name, twin("turned%d" % orientation,
                                   numpy.stack([turn(one) for one in data])))


# ---- pages that are no slices ----


def make_pages():
    data = voxels()
    of = "uint16.twin.nii"
    small = data[0, ::4, ::4]
    for name, kind in (("thumb", 1), ("mask", 4)):
        odd = page(small, _254=(4, kind))
        before, between = [odd], []
        for z in data:
            between += [page(z, _254=(4, 2)), odd]
            before += [page(z)]
        write(name + "-first.tif", before)
        write(name + "-between.tif", between)
        tell("pages", name + "-first.tif", of)
        tell("pages", name + "-between.tif", of)
    with tifffile.TiffWriter("pyramid.tif") as file:
        for z in data:
            file.write(z, photometric="minisblack", subifds=1, metadata=None)
            file.write(z[::2, ::2], photometric="minisblack", subfiletype=1, metadata=None)
    tell("pages", "pyramid.tif", of)
    write("only-thumbs.tif", [page(small, _254=(4, 1))])
    other = {"type": page(data[2].astype("u1")), "sign": page(data[2].astype("i2")),
             "size": page(data[2, :20]), "colours": page(data[2].astype("u1"), _262=(3, 0)),
             "turned": page(data[2], _274=(3, 4)),
             "samples": page(data[2], packed=data[2].tobytes() * 2, _277=(3, 2), _338=(3, 2),
                             _258=(3, [16, 16]), _339=(3, [1, 1])),
             "packing": page(data[2], _259=(3, 34712)), "complex": page(data[2], _339=(3, 5))}
    for name, odd in other.items():
        write("other-%s.tif" % name, [page(data[0]), page(data[1]), odd, page(data[3])])


# ---- what is refused ----


def make_refused():
    data = voxels("uint8")
    one = data[0]
    rgb = numpy.stack([data] * 3, -1)
    tifffile.imwrite("rgb.tif", rgb, photometric="rgb")
    Image.fromarray(rgb[0]).save("ycbcr.tif", compression="jpeg")
    Image.fromarray(rgb[0]).convert("CMYK").save("cmyk.tif")
    Image.fromarray(rgb[0]).convert("LAB").save("lab.tif")
    grey("complex.tif", data.astype("complex64"))
    write("complex-int.tif", [page(voxels("int32")[0], _339=(3, 5))])
    grey("negative.tif", data, photometric="miniswhite")
    write("float24.tif", [page(one.astype("f4"), 24, bytes(one.size * 3))])
    write("of40.tif", [page(one, 40, bytes(one.size * 5))])
    write("old-jpeg.tif", [page(one, _259=(3, 6))])
    write("jpeg2000.tif", [page(one, _259=(3, 34712))])
    write("deep.tif", [page(one, _32997=(4, 7))])
    write("mixed.tif", [page(one, packed=one.tobytes() * 3, _277=(3, 2), _258=(3, [8, 16]),
                             _338=(3, 0))])
    write("fluoview.tif", [page(one, _34361=(7, bytes(64))), page(one)])
    write("metamorph.tif", [page(one, packed=one.tobytes() * 3, _33629=(5, [0] * 6),
                                 _279=(4, one.size))])
    write("scanimage.tif", [page(one, _270=(2, b"state.configPath = 'x'\0")), page(one)])
    # Lies.
    write("huge.tif", [page(one, _256=(4, 60000), _257=(4, 60000), _278=(4, 60000))])
    # Strips and tiles on one page: libtiff reads the later entry of each pair.
    base = [(WIDTH, 4, 64), (HEIGHT, 4, 64), (BITS, 3, 8), (PACKING, 3, 1), (COLOURS, 3, 1)]
    rows = [(SAMPLES, 3, 1), (ROWS, 4, 64)]
    directory("tile-offset.tif", base + [(OFFSETS, 4, 4608)] + rows +
              [(LENGTHS, 4, 100), (324, 4, 512)])
    directory("tiles-before.tif", [(324, 4, 4608), (325, 4, 4096)] + base +
              [(OFFSETS, 4, 512)] + rows + [(LENGTHS, 4, 100)])
    directory("tiles-after.tif", base + [(OFFSETS, 4, 512)] + rows +
              [(LENGTHS, 4, 100), (324, 4, 4608), (325, 4, 4096)])
    directory("twice.tif", base + [(OFFSETS, 4, 512), (OFFSETS, 4, 4608)] + rows +
              [(LENGTHS, 4, 100), (LENGTHS, 4, 4096)])
    few = zlib.compress(one.tobytes())
    write("huge-packed.tif", [page(one, packed=few, _259=(3, 8), _256=(4, 60000), _257=(4, 60000),
                                   _278=(4, 60000))])
    write("high.tif", [page(one, packed=few, _259=(3, 8), _278=(4, 0xffffffff),
                            _257=(4, 0xffffffff))])
    write("flat.tif", [page(one, _257=(3, 0))])
    write("no-strips.tif", [(page(one)[0], [])])
    write("no-offsets.tif", [page(one, _273=(4, [0xfffffff0]))])
    write("sparse.tif", [page(one, packed=b"", _278=(3, 11), _273=(4, [0, 0]), _279=(4, [0, 0]))])
    write("short-strip.tif", [page(one, packed=zlib.compress(one[:9].tobytes()), _259=(3, 8))])
    write("torn-strip.tif", [page(one, packed=zlib.compress(one.tobytes())[:-60], _259=(3, 8))])
    write("few-bytes.tif", [page(one, packed=one.tobytes()[:-30])])
    write("no-bits.tif", [page(one, _258=(3, 0))])
    write("no-samples.tif", [page(one, _277=(3, 0))])
    tile = {"_259": (3, 8), "_324": (4, 8), "_325": (4, 99)}
    write("no-tile.tif", [page(one, _322=(3, 0), _323=(3, 16), **tile)])
    write("wide-tile.tif", [page(one, _322=(4, 0x7ffffff0), _323=(4, 0x7ffffff0), **tile)])
    fax = page(voxels()[0] > 80, 1, bytes(40), _259=(3, 4))
    write("torn-fax.tif", [fax])
    whole = bytearray(read("jpeg.tif"))
    at = whole.index(b"\xff\xda") + 30
    whole[at:at + 4] = b"\xff\xd9" * 2
    with open("torn-jpeg.tif", "wb") as file:
        file.write(whole)


# ---- axes ----


def make_imagej():
    many = voxels("uint16", 6).reshape(3, 2, *SIZE[::-1])  # frames, channels
    stack = many.swapaxes(1, 2)  # ImageJ's order: T Z C
    spaced = {"spacing": 2.5, "unit": "um", "axes": "TZCYX"}
    tifffile.imwrite("ij.tif", stack, imagej=True, resolution=(1 / 0.5, 1 / 0.25), metadata=spaced)
    for name, resolution, words in (
            ("plain", (2, 4), {"spacing": 2.5, "unit": "\\u00B5m"}),
            ("inch", (25.4, 25.4), {"spacing": 0.1, "unit": "inch"}),
            ("flat", (2, 4), {"unit": "mm"}), ("without", (2, 4), {"spacing": 3}),
            ("pixel", (2, 4), {"spacing": 3, "unit": "pixel"})):
        tifffile.imwrite("ij-%s.tif" % name, many[0, 0], imagej=True, resolution=resolution,
                         metadata={**words, "axes": "ZYX"})
    tifffile.imwrite("ij-frames.tif", many[:, 0, 0], imagej=True, metadata={"axes": "TYX"})
    for order in "<>":
        name = "ij-run-%s.tif" % ("small" if order == "<" else "big")
        for kind in ("uint16", "float32", "uint8"):
            text = b"ImageJ=1.53t\nimages=5\nslices=5\nunit=um\nspacing=2.5\n\0"
            data = voxels(kind)
            write(kind + name, [page(data[0], packed=data.astype(data.dtype.newbyteorder(order))
                                     .tobytes(), _279=(4, [data[0].nbytes]), _270=(2, text),
                                     _282=(5, [1, 1]), _283=(5, [1, 1]))], order)
            tell("imagej", kind + name, twin("run-" + kind, data, (0.001, 0.001, 0.0025)))
    text = b"ImageJ=1.53t\nimages=30\nchannels=2\nslices=5\nframes=3\nhyperstack=true\n\0"
    write("ij-run-many.tif", [page(stack[0, 0, 0], packed=stack.tobytes(), _270=(2, text),
                                   _279=(4, [stack[0, 0, 0].nbytes]))])
    for t, c, number, choice in SIX:
        tell("imagej", "ij-run-many.tif", twin("many" + number, many[t, c]), choice)
        of = twin("ij" + number, many[t, c], (0.0005, 0.00025, 0.0025))
        tell("imagej", "ij.tif", of, choice)
    for t in range(3):
        tell("imagej", "ij-frames.tif", twin("frame%d" % t, many[t, 0, :1]), "volume=%d" % t)
    tell("imagej", "ij-plain.tif", "ij00.twin.nii")
    tell("imagej", "ij-inch.tif", twin("ij-inch", many[0, 0], (1, 1, 2.54)))
    for name in ("ij-flat.tif", "ij-pixel.tif", "ij-without.tif"):
        tell("imagej", name, "many00.twin.nii")
    short = b"ImageJ=1.53t\nimages=6\nslices=6\n\0"
    write("ij-cut.tif", [page(many[0, 0, 0], packed=many[0, 0].tobytes(), _270=(2, short),
                              _279=(4, [many[0, 0, 0].nbytes]))])
    write("ij-few.tif", [page(z, _270=(2, short)) for z in many[0, 0]])
    write("ij-wrong.tif", [page(z, _270=(2, b"ImageJ=1\nimages=5\nslices=3\nchannels=2\n\0"))
                           for z in many[0, 0]])
    write("ij-letters.tif", [page(z, _270=(2, b"ImageJ=1\nimages=-5\nslices=5\n\0"))
                             for z in many[0, 0]])
    packed = zlib.compress(many[0, 0, 0].tobytes())
    write("ij-packed.tif", [page(many[0, 0, 0], packed=packed, _259=(3, 8), _270=(2, short))])
    tags = {"_270": (2, b"scanned in 1998\n<b>&\xff [ images=9 \xb5m\0"), "_33550": (12, [1, 1, 0])}
    write("words.tif", [page(z, **tags) for z in many[0, 0]])
    tell("imagej", "words.tif", "many00.twin.nii")
    # tifffile's own descriptions
    grey("shaped.tif", many)
    grey("shaped-run.tif", many, truncate=True, byteorder=">")
    grey("shaped-axes.tif", many.transpose(0, 2, 1, 3, 4), metadata={"axes": "TZCYX"})
    for name in ("shaped.tif", "shaped-run.tif", "shaped-axes.tif"):
        for _, _, number, choice in SIX:
            tell("imagej", name, "many%s.twin.nii" % number, choice)
    write("shaped-old.tif", [page(z, _270=(2, b"shape=(3, 2, 5, 22, 26)\0"))
                             for z in many.reshape(-1, *SIZE[1::-1])])
    tell("imagej", "shaped-old.tif", "many21.twin.nii", "volume=5")
    wide = numpy.tile(many[0, 0], (1, 3, 3))
    write("rest.tif", [page(wide[0], packed=wide.tobytes(), _279=(4, wide[0].nbytes))])
    tell("imagej", "rest.tif", twin("rest", wide[:1]))
    twin("rest-all", wide)
    grey("shaped-one.tif", many[0, 0], truncate=True)
    tell("imagej", "shaped-one.tif", "many00.twin.nii")


OME = ('<?xml version="1.0" encoding="UTF-8"?>'
       '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06" UUID="urn:uuid:1">%s'
       '<Image ID="Image:0"><Pixels ID="Pixels:0" DimensionOrder="%s" '
       'Type="uint16" SizeX="26" SizeY="22" SizeZ="5" SizeC="2" SizeT="3" %s>%s</Pixels></Image>%s'
       '</OME>\0')


def ome(name, pages, order="XYZCT", sizes="", planes="", before="", after="", **more):
    text = (OME % (before, order, sizes, planes, after)).encode()
    first = dict(more, _270=(2, text))
    write(name, [page(z, **(first if i == 0 else more)) for i, z in enumerate(pages)])


def make_ome():
    many = voxels("uint16", 6).reshape(3, 2, *SIZE[::-1])
    tifffile.imwrite("a.ome.tif", many, ome=True, photometric="minisblack",
                     metadata={"axes": "TCZYX", "PhysicalSizeX": 0.5, "PhysicalSizeXUnit": "µm",
                               "PhysicalSizeY": 250, "PhysicalSizeYUnit": "nm",
                               "PhysicalSizeZ": 0.0025, "PhysicalSizeZUnit": "mm"})
    plain = many.reshape(-1, *SIZE[1::-1])
    orders = {"XYZCT": (0, 1, 2), "XYCZT": (0, 2, 1), "XYTCZ": (2, 1, 0), "XYZTC": (1, 0, 2),
              "XYCTZ": (2, 0, 1), "XYTZC": (1, 2, 0)}
    sizes = 'PhysicalSizeX="0.5" PhysicalSizeY="0.25" PhysicalSizeZ="2.5"'
    names = ["a.ome.tif", "mapped.ome.tif", "part.ome.tif", "renamed.tif"]
    for order, axes in orders.items():
        name = order.lower() + ".tif"
        ome(name, many.transpose(*axes, 3, 4).reshape(-1, *SIZE[1::-1]), order, sizes)
        names.append(name)
    backwards = "".join('<TiffData FirstZ="%d" FirstC="%d" FirstT="%d" IFD="%d"/>' %
                        (i % 5, i // 5 % 2, i // 10, 29 - i) for i in range(30))
    ome("mapped.ome.tif", plain[::-1], sizes=sizes, planes=backwards)
    runs = "".join('<TiffData FirstC="%d" FirstT="%d" IFD="%d" PlaneCount="5"/>' %
                   (i % 2, i // 2, 31 - 5 * i) for i in range(6))
    pages = [plain[0]] + [z for i in range(6) for z in plain[5 * (5 - i):5 * (6 - i)]]
    ome("part.ome.tif", [pages[0]] * 6 + pages[1:], sizes=sizes, planes=runs)
    own = '<TiffData IFD="0" PlaneCount="30"><UUID FileName="before.ome.tif">urn:uuid:1</UUID>' \
          '</TiffData>'
    ome("renamed.tif", plain, sizes=sizes, planes=own)
    for name in names:
        for _, _, number, choice in SIX:
            tell("ome", name, "ij%s.twin.nii" % number, choice)
    away = '<TiffData FirstC="%d"><UUID FileName="%s">urn:uuid:%d</UUID></TiffData>'
    ome("set.ome.tif", plain[:15],
        planes=away % (0, "set.ome.tif", 1) + away % (1, "set_C1.ome.tif", 2))
    text = b'<OME><BinaryOnly MetadataFile="a.companion.ome" UUID="urn:uuid:3"/></OME>\0'
    write("binary.ome.tif", [page(many[0, 0, 0], _270=(2, text))])
    ome("few.ome.tif", plain[:29])
    ome("hole.ome.tif", plain, planes='<TiffData IFD="0" PlaneCount="29"/>')
    ome("twice.ome.tif", plain, planes=backwards + '<TiffData IFD="3"/>')
    ome("beyond.ome.tif", plain, planes='<TiffData IFD="2" PlaneCount="30"/>')
    ome("order.ome.tif", plain, order="XYZZT")
    ome("images.ome.tif", plain, after='<Image ID="Image:1"><Pixels/></Image>')
    ome("torn.ome.tif", plain, after="<Image></OME>")
    ome("bomb.ome.tif", plain, before="<a/>")
    raw = read("bomb.ome.tif")
    bomb = b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY a "a">]><OME>'
    with open("bomb.ome.tif", "wb") as file:
        file.write(raw.replace(raw[raw.index(b"<?xml"):][:len(bomb)], bomb))
    write("other.ome.tif", [page(z, _270=(2, (OME % ("", "XYZCT", "", "", "")).encode()))
                            for z in voxels("uint8", 6).reshape(-1, *SIZE[1::-1])])
    ome("flat.ome.tif", plain, sizes='PhysicalSizeX="0.5" PhysicalSizeY="0.5"')
    ome("strange.ome.tif", plain, sizes='PhysicalSizeX="0.5" PhysicalSizeY="0.5" '
        'PhysicalSizeXUnit="reference frame" PhysicalSizeYUnit="reference frame"')
    # Channels as samples of a pixel.
    text = (OME % ("", "XYCZT", sizes, "", "")).replace('SizeT="3"', 'SizeT="1"').encode()
    samples = {"_277": (3, 2), "_258": (3, [16, 16]), "_338": (3, 0), "_339": (3, [1, 1])}
    write("samples.ome.tif", [page(many[0, 0, z], _270=(2, text), **samples,
                                   packed=numpy.moveaxis(many[0, :, z], 0, -1).tobytes())
                              for z in range(5)])
    for c in range(2):
        tell("ome", "samples.ome.tif", "ij0%d.twin.nii" % c, "volume=%d" % c)
    os.mkdir("set")
    for c in range(2):
        for z in range(5):
            text = (OME % ("", "XYZCT", "", away % (c, "c%dz%d.tif" % (c, z), 10 * c + z) +
                           away % (1 - c, "other.tif", 99), "")).encode()
            write("set/c%dz%d.tif" % (c, z), [page(many[0, c, z], _270=(2, text))])


def make_lsm():
    """Three channels in planes of a page, a thumbnail after each page; tifffile reads the same."""
    many = voxels("uint16", 6).reshape(2, 3, *SIZE[::-1])
    info = bytearray(struct.pack("<II8i", 0x0400494c, 512, 26, 22, 5, 3, 2, 2, 8, 8) +
                     struct.pack("<6dI", 0.5e-6, 0.25e-6, 2.5e-6, 0, 0, 0, 6))
    info += bytes(512 - len(info))
    tags = {"_277": (3, 3), "_258": (3, [16] * 3), "_339": (3, [1] * 3), "_284": (3, 2),
            "_262": (3, 2)}
    pages = []
    for t in range(2):
        for z in range(5):
            more = dict(tags, _34412=(1, bytes(info))) if not pages else tags
            one, _ = page(many[t, 0, z], **more)
            pages.append((one, [many[t, c, z].tobytes() for c in range(3)]))
            pages.append(page(many[t, 0, z, ::4, ::4].astype("u1"), _254=(4, 1)))
    write("a.lsm", pages)
    with tifffile.TiffFile("a.lsm") as file:
        assert file.is_lsm and (file.series[0].asarray().reshape(2, 5, 3, 22, 26) ==
                                many.swapaxes(1, 2)).all()
    for t in range(2):
        for c in range(3):
            of = twin("lsm%d%d" % (t, c), many[t, c], (0.0005, 0.00025, 0.0025))
            tell("lsm", "a.lsm", of, "volume=%d" % (3 * t + c))
    pages[0][0][34412] = (1, bytes(info[:16]) + struct.pack("<i", 9) + bytes(info[20:]))
    write("wrong.lsm", pages)
    pages[0][0][34412] = (1, bytes(info[:40]))
    write("short.lsm", pages)
    write("ycbcr.lsm", [page(many[0, 0, 0].astype("u1"), packed=bytes(2000), _277=(3, 3),
                             _258=(3, [8] * 3), _339=(3, [1] * 3), _262=(3, 6),
                             _34412=(1, bytes(info)))])


def make_folders():
    data = voxels()
    for name in ("pages", "differs", "channels", "thumbs", "white", "bigtiffs"):
        os.mkdir(name)
        for z in range(5):
            path = "%s/s%d.tif" % (name, z)
            if name == "pages":
                grey(path, numpy.stack([data[z]] * 3))
            elif name == "differs":
                grey(path, data[z].astype("u1") if z == 3 else data[z])
            elif name == "channels":
                grey(path, numpy.stack([data[z]] * 2, -1), extrasamples=["unspecified"])
            elif name == "bigtiffs":
                grey(path, data[z], bigtiff=True, byteorder="<>"[z % 2])
            elif name == "white":
                grey(path, data[z], photometric="miniswhite")
            else:
                write(path, [page(data[z, ::4, ::4], _254=(4, 1)), page(data[z])])
    tell("folders", "thumbs", "uint16.twin.nii")
    tell("folders", "bigtiffs", "uint16.twin.nii")


def make_close():
    """Masks that are packed more closely than gzip can."""
    mask = numpy.zeros((180, 640, 640), "u1")
    mask[50:60, 300:310, 200:300] = 1
    grey("close.tif", mask > 0)
    run("tiffcp", "-c", "g4", "close.tif", "close-g4.tif")
    grey("close.tif", mask)
    run("tiffcp", "-c", "zstd", "close.tif", "close-zstd.tif")
    of = twin("close", mask)
    for name in ("close-g4.tif", "close-zstd.tif"):
        tell("close", name, of, "crop=190-310,290-320,45-65")


def make_many():
    """More pages than 16 bits count, of 35 volumes."""
    head = b"ImageJ=1\nimages=70000\nslices=2000\nchannels=35\n\0"
    pages = 2000 * [page(numpy.full((2, 2), c, "u1")) for c in range(35)]
    write("many.tif", [page(numpy.zeros((2, 2), "u1"), _270=(2, head))] + pages[1:])
    for c in (0, 34):
        tell("many", "many.tif", twin("many-%d" % c, numpy.full((2000, 2, 2), c, "u1")),
             "volume=%d" % c)


# ---- wrong numbers ----

TAGS = (254, 256, 257, 258, 259, 262, 266, 270, 273, 274, 277, 278, 279, 284, 317, 320, 322, 323,
        324, 325, 338, 339, 32997, 34412)
VALUES = (0, 1, 2, 3, 4, 5, 7, 8, 16, 32, 64, 255, 1000, 32773, 34887, 34925, 50000, 65535, 0x10000,
          0x7fffffff, 0xffffffff)


def break_one(data):
    order = "<" if data[:2] == b"II" else ">"
    at = struct.unpack_from(order + "I", data, 4)[0]
    for _ in range(random.choice([1, 1, 2, 4])):
        count = struct.unpack_from(order + "H", data, at)[0]
        entry = at + 2 + 12 * random.randrange(count)
        where, kind = random.choice([(0, "H"), (2, "H"), (4, "I"), (8, "I"), (8, "I"), (8, "I")])
        value = random.choice(TAGS if where == 0 else VALUES)
        struct.pack_into(order + kind, data, entry + where, value & (65535 if kind == "H" else ~0))
    return data


def make_broken(rounds):
    os.mkdir("bad")
    for name in ("uint16.tif uint32-big.tif float16-zip3.tif uint16-tiles-zstd2.tif bits-g4.tif "
                 "jpeg.tif contig-tiles.tif separate.tif palette4.tif of12.tif turned6.tif "
                 "uint16ij-run-big.tif thumb-first.tif samples.ome.tif wrong.lsm").split():
        whole = read(name)
        for number in [48, 56, 44, 65, 82, 7, *range(100, 94 + rounds)]:  # most outcomes of 100
            random.seed("%s %d" % (name, number))
            with open("bad/%d-%s" % (number, name), "wb") as file:
                file.write(break_one(bytearray(whole)))


if sys.argv[1] == "break":
    os.chdir(sys.argv[2])
    make_broken(int(sys.argv[3]))
else:
    os.chdir(sys.argv[1])
    for make in (make_types, make_few_bits, make_packed, make_samples, make_pages, make_refused,
                 make_imagej, make_ome, make_lsm, make_folders, make_close, make_many):
        make()
