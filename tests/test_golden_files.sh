#!/bin/sh
# SPDX-License-Identifier: MIT
# Files next to a journal of somebody else: none outside its folder is listed, removed or replaced,
# and in its folder only files that its records can have made.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
put s.nii 254 '\001' # it has a place in the world, and pictures a camera
for at in 280 300 320; do put s.nii $at '\000\000\200\077'; done
mkdir j
cp s.nii j
cd j || exit 1
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first' \
    --journal j.iftty >/dev/null || exit 1
mkdir ../precious
cp j.golden/* ../precious
printf x >../precious/a.png
printf x >../precious/b.exr
kept=$(cd ../precious && cksum ./*)
untouched() {
    same "$(cd ../precious && cksum ./*)" "$kept"
}

begin "the folder of golden images is a link: nothing there is listed, removed or replaced"
"$iftty" -c 'open s.nii; seed 1,1,1 1; run' --journal l.iftty >/dev/null
ln -s "$work/precious" l.golden
expect_out "l.golden is a link, or no folder" 0 "$iftty" verify l.iftty
grep -qF -e a.png -e b.exr "$work/out" && fail "its files are listed"
expect 1 "$iftty" verify --strict l.iftty
expect 1 "$iftty" verify --remove-orphans l.iftty
expect_err "l.golden is a link, or no folder" 3 "$iftty" -c 'golden first' --journal l.iftty
cp j.iftty m.iftty
ln -s "$work/precious" m.golden
expect 3 "$iftty" verify m.iftty --accept why
untouched
mkdir same # the name and records of the journal that made first.exr, which would be a leftover here
cp s.nii same
ln -s "$work/precious" same/j.golden
for cut in 9 99; do
    head -n $cut j.iftty >same/j.iftty
    expect $((cut > 9)) "$iftty" verify same/j.iftty
    expect 1 "$iftty" verify --strict same/j.iftty
    expect 1 "$iftty" verify --remove-orphans same/j.iftty
    "$iftty" log --reseal same/j.iftty >"$work/out" 2>&1
    "$iftty" verify --accept why same/j.iftty >"$work/out" 2>&1
    "$iftty" -c 'seed 9,9,9 2; run' --journal same/j.iftty >"$work/out" 2>&1
    "$iftty" -c 'golden more' --journal same/j.iftty >"$work/out" 2>&1
    untouched
done
same "$(cd same && echo *)" "j.golden j.iftty s.nii"

begin "a link further up is the user's own way to the folder"
mkdir there
cp s.nii j.iftty there
cp -r j.golden there
ln -s there via
expect 0 "$iftty" verify --strict via/j.iftty
expect 0 "$iftty" -c 'seed 9,9,9 3; run; golden next' --journal via/j.iftty
cp there/j.golden/next.exr there/j.golden/more.exr
expect 1 "$iftty" verify via/j.iftty
expect 0 "$iftty" verify --remove-orphans via/j.iftty
expect 0 "$iftty" verify --strict via/j.iftty
expect 0 "$iftty" log --reseal via/j.iftty
same "$(cd there/j.golden && echo *)" "first.exr first.png next.exr next.png"

begin "a second name of the same file keeps its content"
mkdir hard
cp s.nii hard
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first; golden last' \
    --journal hard/h.iftty >/dev/null
cp -r hard/h.golden hard/before
cp hard/h.iftty hard/whole
sed '/^golden last/,$d' hard/h.iftty >hard/cut
mkdir linked
ln hard/h.golden/* linked
cp hard/cut hard/h.iftty
expect 0 "$iftty" -c 'seed 9,9,9 2; run' --journal hard/h.iftty
[ ! -e hard/h.golden/last.exr ] || fail "the leftover is there"
"$iftty" -c 'open s.nii; seed 9,9,9 3; run; size 40 30; golden first' \
    --journal hard/i.iftty >/dev/null
rm hard/i.golden/*
ln linked/first.* hard/i.golden
ln hard/i.iftty linked/i.iftty
cp hard/i.iftty hard/former
expect 0 "$iftty" verify hard/i.iftty --accept why
expect 0 "$iftty" verify hard/i.iftty
for file in first.exr first.png last.exr last.png; do
    same_files linked/$file hard/before/$file
done
same_files linked/i.iftty hard/former

begin "a golden image that is a link is read; accepting replaces the link"
cp j.iftty k.iftty
mkdir k.golden
ln -s "$work/precious/first.exr" "$work/precious/first.png" k.golden
expect 0 "$iftty" verify --strict k.iftty
"$iftty" -c 'open s.nii; seed 9,9,9 3; run; size 40 30; golden first' \
    --journal o.iftty >/dev/null
rm -r o.golden
cp -a k.golden o.golden
expect 1 "$iftty" verify o.iftty
out_has "o.golden/first.exr, which leads out of its folder, differs from the record"
expect 0 "$iftty" verify o.iftty --accept why
[ -f o.golden/first.exr ] && [ ! -h o.golden/first.exr ] || fail "the link was not replaced"
expect 0 "$iftty" verify o.iftty
untouched
cp j.iftty gone.iftty # as git-annex leaves a file that is not here
mkdir gone.golden
ln -s "$work/nowhere/first.exr" "$work/nowhere/first.png" gone.golden
mkdir ../nowhere
expect 1 "$iftty" verify gone.iftty
"$iftty" -c 'undo 2; golden first' --journal gone.iftty >"$work/out" 2>&1
same "$(ls ../nowhere)" ""
ln -s "$work/precious/first.exr" k.golden/more.exr
expect 1 "$iftty" verify k.iftty
expect_out "more.exr was left alone" 1 "$iftty" verify --remove-orphans k.iftty
[ -h k.golden/more.exr ] || fail "the link is gone"
untouched

begin "a journal that continues elsewhere takes along files that its records name, of a link a link"
mkdir along
cp s.nii j.iftty along
cp -r j.golden along
rm along/j.golden/first.png
echo secret >secret
ln -s "$work/j/secret" along/j.golden/more.png
ln -s "$work/precious/first.png" along/j.golden
printf x >along/j.golden/note.txt
expect 0 "$iftty" -c 'journal along/mine.iftty' --journal along/j.iftty
same "$(cd along/mine.golden && echo *)" "first.exr first.png"
[ -h along/mine.golden/first.png ] || fail "what the link leads to was copied"
expect 0 "$iftty" verify along/mine.iftty

begin "an orphan that the journal cannot have made is left alone"
cp ../precious/a.png ../precious/b.exr j.golden
expect 1 "$iftty" verify --remove-orphans j.iftty
out_has "a.png was left alone: no record of this journal can have made it"
[ -e j.golden/a.png ] && [ -e j.golden/b.exr ] || fail "it was removed"
rm j.golden/a.png j.golden/b.exr
for name in first.PNG first.jpg first.tiff first.Exr first.webp; do
    printf x >j.golden/$name
    expect 1 "$iftty" verify j.iftty
    rm j.golden/$name
done
printf x >j.golden/first.txt
expect 0 "$iftty" verify j.iftty
expect 1 "$iftty" verify --strict j.iftty
rm j.golden/first.txt
ln -s ../../precious/first.exr j.golden/more.exr
expect_out "more.exr was left alone" 1 "$iftty" verify --remove-orphans j.iftty
rm j.golden/more.exr
cp j.golden/first.exr j.golden/more.exr # with a PNG that is the user's
printf x >j.golden/more.png
expect 1 "$iftty" verify --remove-orphans j.iftty
out_has "more.exr was left alone: no record of this journal can have made its PNG"
[ -e j.golden/more.exr ] && [ -e j.golden/more.png ] || fail "they were removed"
rm j.golden/more.*
cp j.iftty j # has the same folder
sed '/^golden first/,$d' j.iftty >j
expect_out "first.exr was left alone" 1 "$iftty" verify --remove-orphans j
[ -e j.golden/first.exr ] || fail "another journal's golden image is gone"
rm j

begin "a picture without a record passes only after the last record"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first; golden last' \
    --journal p.iftty >/dev/null
sed '/^golden last/,$d' p.iftty >q.iftty
cp q.iftty p.iftty
expect_out "last.exr was ignored" 0 "$iftty" verify --strict p.iftty
printf x >p.golden/last.png
expect 1 "$iftty" verify p.iftty
rm p.golden/last.png
cp j.golden/first.exr j.golden/early.exr
expect 1 "$iftty" verify j.iftty
rm j.golden/early.exr

begin "a golden image that is gone while its PNG is there is named"
mv j.golden/first.exr kept.exr
expect_out "its PNG exists, but not j.golden/first.exr, which is compared" 1 "$iftty" verify j.iftty
expect 1 "$iftty" log --reseal j.iftty
mv kept.exr j.golden/first.exr
expect 0 "$iftty" verify --strict j.iftty

begin "an OpenEXR file with anything that is not compared fails"
# forge WAY [FROM TO]: another file in the place of first.exr, whose pixels are the same where they
# are 8 bits a channel
cat >forge.py <<'END'
import struct, sys, zlib

def pack(raw):
    half = raw[0::2] + raw[1::2]
    return zlib.compress(bytes([half[0]]) + bytes((half[i] - half[i - 1] + 128) & 255
                                                  for i in range(1, len(half))), 9)

def unpack(packed, size):
    if len(packed) == size:
        return bytearray(packed)
    half = bytearray(zlib.decompress(packed))
    for i in range(1, len(half)):
        half[i] = (half[i - 1] + half[i] - 128) & 255
    raw = bytearray(size)
    raw[0::2], raw[1::2] = half[:(size + 1) // 2], half[(size + 1) // 2:]
    return raw

class Exr:
    def __init__(self, path):
        self.bytes = open(path, "rb").read()
        self.flags, self.note, at = self.bytes[:8], [], 8
        while self.bytes[at]:
            name = self.bytes.index(0, at)
            kind = self.bytes.index(0, name + 1)
            length, = struct.unpack_from("<i", self.bytes, kind + 1)
            self.note.append([self.bytes[at:name], self.bytes[name + 1:kind],
                              self.bytes[kind + 5:kind + 5 + length]])
            at = kind + 5 + length
        at += 1
        self.size = [n + 1 for n in struct.unpack_from("<2i", self.value("dataWindow"), 8)]
        self.block, lines = [], (self.size[1] + 15) // 16
        for n in range(lines):
            place, = struct.unpack_from("<Q", self.bytes, at + 8 * n)
            y, length = struct.unpack_from("<2i", self.bytes, place)
            raw = self.line_bytes() * min(16, self.size[1] - y)
            self.block.append([y, unpack(self.bytes[place + 8:place + 8 + length], raw)])

    def value(self, name):
        return next(n[2] for n in self.note if n[0] == name.encode())

    def put(self, name, value):
        next(n for n in self.note if n[0] == name.encode())[2] = value

    def channels(self): # name and bytes of each
        list_, at, found = self.value("channels"), 0, []
        while list_[at]:
            end = list_.index(0, at)
            found.append((list_[at:end].decode(), 2 if list_[end + 1] == 1 else 4))
            at = end + 17
        return found

    def line_bytes(self):
        return sum(n for _, n in self.channels()) * self.size[0]

    def place(self, channel, x): # of a sample in a line
        at = 0
        for name, n in self.channels():
            if name == channel:
                return at + n * x
            at += n * self.size[0]

    def write(self, path, more=b"", between=b"", within=b"", swap=False):
        head = self.flags + b"".join(n + b"\0" + k + b"\0" + struct.pack("<i", len(v)) + v
                                     for n, k, v in self.note) + b"\0"
        body, table, at = [], [], len(head) + 8 * len(self.block)
        for y, raw in reversed(self.block) if swap else self.block:
            packed = pack(raw) + within
            table.append(at)
            body.append(struct.pack("<2i", y, len(packed)) + packed + (b"" if body else between))
            at += len(body[-1])
        table = table[::-1] if swap else table
        open(path, "wb").write(head + b"".join([struct.pack("<Q", t) for t in table] + body) + more)

way, source, target = sys.argv[1:]
exr, how = Exr(source), {}
_, line = exr.block[0]
if way in ("half", "eye"): # the next number, which is the same of 8 bits, or nothing at all
    at = exr.place("R" if way == "half" else "Z", 20)
    line[at] ^= 1
elif way == "colour":
    at = exr.place("R", 20)
    line[at + 1] ^= 4
elif way == "layer":
    list_ = exr.value("channels")
    added = b"other.R\0" + struct.pack("<iB3x2i", 1, 0, 1, 1)
    at = list_.index(b"voxel\0")
    old, n = exr.line_bytes(), exr.place("voxel", 0)
    exr.put("channels", list_[:at] + added + list_[at:])
    for block in exr.block:
        raw = block[1]
        block[1] = bytearray().join(raw[k:k + n] + bytes(2 * exr.size[0]) + raw[k + n:k + old]
                                    for k in range(0, len(raw), old))
elif way == "part":
    exr.flags = exr.flags[:5] + bytes([exr.flags[5] | 0x10]) + exr.flags[6:]
elif way == "preview":
    exr.note.append([b"preview", b"preview", struct.pack("<2I", 1, 1) + b"abcd"])
elif way == "shown":
    exr.put("displayWindow", struct.pack("<4i", 3, 0, 39, 29))
elif way == "place":
    for name in ("dataWindow", "displayWindow"):
        exr.put(name, struct.pack("<4i", 1, 1, exr.size[0], exr.size[1]))
elif way == "screen":
    exr.put("screenWindowCenter", struct.pack("<2f", 1, 0))
elif way == "aspect":
    exr.put("pixelAspectRatio", struct.pack("<f", 2.0))
elif way == "camera":
    exr.put("worldToCamera", exr.value("worldToNDC"))
elif way == "none-of-it":
    exr.note = [n for n in exr.note if n[0] != b"worldToCamera"]
elif way == "lines":
    exr.put("lineOrder", b"\1")
elif way == "text":
    exr.note.append([b"owner", b"string", b"somebody"])
elif way == "context": # of renditions
    exr.note.append([b"iftty:context", b"string", b"all is well"])
elif way == "number":
    exr.note.append([b"secret", b"int", struct.pack("<i", 7)])
elif way == "twice":
    exr.note.append([b"iftty:look", b"string", exr.value("iftty:look")])
elif way == "again":
    exr.note.insert(0, [b"iftty:look", b"string", b"all is well"])
elif way == "wide":
    exr.note.append([b"owner", b"string", bytes(900000)])
elif way == "hidden":
    exr.put("iftty:look", exr.value("iftty:look") + b"\0hidden")
elif way == "less":
    exr.note = [n for n in exr.note if n[0] != b"iftty:look"]
elif way == "long":
    exr.note.append([b"owner", b"string", bytes(3 << 20)])
elif way == "after":
    how = {"more": b"more"}
elif way == "between":
    how = {"between": b"more"}
elif way == "within":
    how = {"within": b"more"}
elif way == "order":
    how = {"swap": True}
elif way == "giant": # as large as OpenEXR reads, out of few bytes
    exr.size = [16384, 16384]
    for name in ("dataWindow", "displayWindow"):
        exr.put(name, struct.pack("<4i", 0, 0, 16383, 16383))
    raw = bytes(16 * exr.line_bytes())
    packed, exr.block = zlib.compress(raw), []
    pack = lambda _: packed
    exr.block = [[y, b""] for y in range(0, 16384, 16)]
else:
    assert way == "none"
exr.write(target, **how)
END
cp j.golden/first.exr kept.exr
for way in none half eye colour layer part preview shown place screen aspect camera none-of-it \
    lines text number twice again hidden less long after between within order giant; do
    "$PYTHON" forge.py $way kept.exr j.golden/first.exr || fail "$way"
    wanted=1
    [ $way != none ] || wanted=0
    expect $wanted "$iftty" verify j.iftty || fail "$way"
    expect $wanted "$iftty" verify --strict j.iftty || fail "$way"
done
# before it is decoded: a limit of memory has no say
out_has "the sizes differ: it is 16384x16384 pixels, and 40x30 are drawn"
cp kept.exr j.golden/first.exr
"$iftty" -c 'open s.nii; size 40 30; golden slice of=axial' --journal slice.iftty >/dev/null
cp slice.golden/slice.exr side.exr
"$PYTHON" forge.py context side.exr slice.golden/slice.exr
expect 1 "$iftty" verify slice.iftty
out_has "its note iftty:context is all is well, which is no note of the new picture"

begin "a PNG with bytes or texts that are not compared fails"
png() { # WAY
    "$PYTHON" - "$1" <<'END'
import re, struct, sys, zlib
png, way, at, part = open("kept.png", "rb").read(), sys.argv[1], 8, []
while at < len(png):
    length, kind = struct.unpack(">I4s", png[at:at + 8])
    part.append([kind, png[at + 8:at + 8 + length]])
    at += length + 12
def find(kind):
    return next(i for i in range(len(part)) if part[i][0] == kind)
if way == "packed":
    [one for one in part if one[0] == b"IDAT"][-1][1] += b"more"
elif way == "scale":
    part[find(b"pHYs")][1] = struct.pack(">2IB", 77, 77, 1)
elif way == "journal":
    for one in part:
        one[1] = re.sub(rb"^iftty:journal\0.*", b"iftty:journal\0other.iftty", one[1])
elif way == "packed-text":
    part.insert(1, [b"zTXt", b"Comment\0\0" + zlib.compress(b"all is well")])
elif way == "text":
    part.insert(1, [b"tEXt", b"Comment\0all is well"])
elif way == "after":
    part.append([b"IEND", b""])
out = png[:8]
for kind, data in part:
    out += struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
open("j.golden/first.png", "wb").write(out)
END
}
cp j.golden/first.png kept.png
for way in none packed scale journal packed-text text after; do
    png $way
    wanted=1
    [ $way != none ] || wanted=0
    expect $wanted "$iftty" verify j.iftty || fail "$way"
done
cp kept.png j.golden/first.png

begin "a leftover image passes only if golden draws the same image and PNG after the last record"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first; golden last;
    golden side of=axial' --journal f.iftty >/dev/null
sed '/^golden last/,$d' f.iftty >q.iftty
cp q.iftty f.iftty
mkdir kept
cp f.golden/* kept
chain=$(tail -n 1 f.iftty | sed 's/.*chain=//')
"$PYTHON" - "$chain" <<'END' # as if it had been killed instead of `golden last`
import sys, re
exr = open("kept/side.exr", "rb").read()
exr = re.sub(rb"(iftty:chain\0string\0....)[0-9a-f]{32}", rb"\g<1>" + sys.argv[1].encode(), exr,
             flags=re.S)
open("kept/side.exr", "wb").write(exr)
END
rm kept/side.png
cp kept/side.exr f.golden
rm f.golden/side.png
expect_out "last.exr was ignored" 0 "$iftty" verify --strict f.iftty
out_has "side.exr was ignored"
for way in none half colour layer within after text giant; do
    "$PYTHON" forge.py $way kept/last.exr f.golden/last.exr || fail "$way"
    wanted=1
    [ $way != none ] || wanted=0
    expect $wanted timeout 60 "$iftty" verify --limit-memory 300M --limit-time 50 f.iftty ||
        fail "$way"
done
cp kept/last.exr f.golden
printf x >f.golden/last.png
expect 1 "$iftty" verify f.iftty
cp kept/last.png f.golden/last.png
expect 0 "$iftty" verify f.iftty
cp kept/last.png f.golden/side.png
expect 1 "$iftty" verify f.iftty
rm f.golden/side.* f.golden/last.exr
expect 1 "$iftty" verify f.iftty
cp kept/last.exr f.golden

begin "leftovers are judged within the limits"
"$PYTHON" forge.py colour kept/last.exr colour.exr
mkdir many
cp s.nii many
cp f.iftty many
cp -r f.golden many
seq -f many/f.golden/l%g.exr 1000 | xargs -n 1 ln colour.exr
expect_out "than the 0.5 s of --limit-time" 3 "$iftty" verify --limit-time 0.5 many/f.iftty
rm many/f.golden/l*.exr
cp f.golden/* many/f.golden
"$PYTHON" forge.py wide j.golden/first.exr wide.exr # not drawn again: of another journal
seq -f many/f.golden/l%g.exr 3000 | xargs -n 1 ln wide.exr
expect_out "than the 0.2 s of --limit-time" 3 "$iftty" verify --limit-time 0.2 many/f.iftty
rm -r many

begin "a journal that is a link, and other golden images next to the link"
mkdir links
ln -s ../j.iftty links/j.iftty
expect 0 "$iftty" verify --scene s.nii links/j.iftty
cp j.golden/first.exr j.golden/more.exr
expect_out "is a link to" 1 "$iftty" verify --remove-orphans --scene s.nii links/j.iftty
[ -e j.golden/more.exr ] || fail "it was removed by way of a link"
rm j.golden/more.exr
cp -r j.golden links
expect 0 "$iftty" verify --scene s.nii links/j.iftty
cp j.golden/first.png links/j.golden/more.png
expect 1 "$iftty" verify --scene s.nii links/j.iftty
out_has "is a link, and links/j.golden/more.png is another file than"
mv links/j.golden/more.png links/j.golden/note.txt
expect 0 "$iftty" verify --scene s.nii links/j.iftty
expect 1 "$iftty" verify --strict --scene s.nii links/j.iftty
rm links/j.golden/note.txt
printf more >>links/j.golden/first.exr
expect 1 "$iftty" verify --scene s.nii links/j.iftty
out_has "is a link, and links/j.golden/first.exr is another file than"
expect_err "is a link; name the journal itself" 3 "$iftty" verify links/j.iftty --accept why

finish
