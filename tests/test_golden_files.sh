#!/bin/sh
# SPDX-License-Identifier: MIT
# Files next to a journal of somebody else: none outside its folder is listed, removed or replaced,
# and in its folder only files that its records can have made.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16
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
expect 0 "$iftty" verify l.iftty
out_has "l.golden is a link, or no folder"
grep -qF -e a.png -e b.exr "$work/out" && fail "its files are listed"
expect 1 "$iftty" verify --strict l.iftty
expect 1 "$iftty" verify --remove-orphans l.iftty
expect 3 "$iftty" -c 'golden first' --journal l.iftty
err_has "l.golden is a link, or no folder"
cp j.iftty m.iftty
ln -s "$work/precious" m.golden
expect 3 "$iftty" verify m.iftty --accept why
untouched
close_story

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
out_has "o.golden/first.exr, which leads out of its folder, is not what was recorded"
expect 0 "$iftty" verify o.iftty --accept why
[ -f o.golden/first.exr ] && [ ! -h o.golden/first.exr ] || fail "the link was not replaced"
expect 0 "$iftty" verify o.iftty
untouched
close_story

begin "an orphan that the journal cannot have made is left alone"
cp ../precious/a.png ../precious/b.exr j.golden
expect 1 "$iftty" verify --remove-orphans j.iftty
out_has "a.png was left alone: no record of this journal can have made it"
[ -e j.golden/a.png ] && [ -e j.golden/b.exr ] || fail "it was removed"
rm j.golden/a.png j.golden/b.exr
for name in first.PNG first.jpg first.tiff; do
    printf x >j.golden/$name
    expect 1 "$iftty" verify j.iftty
    rm j.golden/$name
done
printf x >j.golden/first.txt
expect 0 "$iftty" verify j.iftty
expect 1 "$iftty" verify --strict j.iftty
rm j.golden/first.txt
close_story

begin "a picture without a record passes only after the last record"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first; golden last' \
    --journal p.iftty >/dev/null
sed '/^golden last/,$d' p.iftty >q.iftty
cp q.iftty p.iftty
expect 0 "$iftty" verify --strict p.iftty
out_has "last.exr was passed over"
printf x >p.golden/last.png
expect 1 "$iftty" verify p.iftty
rm p.golden/last.png
cp j.golden/first.exr j.golden/early.exr
expect 1 "$iftty" verify j.iftty
rm j.golden/early.exr
close_story

begin "a golden image that is gone while its PNG is there is named"
mv j.golden/first.exr kept.exr
expect 1 "$iftty" verify j.iftty
out_has "its PNG is there, but j.golden/first.exr, which is what is compared, is not"
expect 1 "$iftty" log --reseal j.iftty
mv kept.exr j.golden/first.exr
expect 0 "$iftty" verify --strict j.iftty
close_story

begin "an OpenEXR file with anything that is not compared fails"
# forge WAY: another file in the place of first.exr
forge() {
    /usr/bin/python3 - "$1" <<'END'
import struct, sys
exr = bytearray(open("kept.exr", "rb").read())
way, at = sys.argv[1], 8
def put(name, kind, value):
    add = name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
    exr[8:8] = add
    end = 8
    while exr[end]:
        end = exr.index(0, exr.index(0, end) + 1) + 1
        end += 4 + struct.unpack_from("<i", exr, end)[0]
    end += 1
    for k in range((30 + 15) // 16): # the table of blocks
        place, = struct.unpack_from("<Q", exr, end + 8 * k)
        struct.pack_into("<Q", exr, end + 8 * k, place + len(add))
def value_of(name):
    at = exr.index(name + b"\0") + len(name) + 1
    return exr.index(0, at) + 5
if way == "trailing":
    exr += b"more"
elif way == "attribute":
    put(b"owner", b"string", b"somebody")
elif way == "number":
    put(b"secret", b"int", struct.pack("<i", 7))
elif way == "preview":
    put(b"preview", b"preview", struct.pack("<2I", 1, 1) + b"abcd")
elif way == "window":
    struct.pack_into("<i", exr, value_of(b"displayWindow"), 3)
elif way == "size":
    struct.pack_into("<2i", exr, value_of(b"dataWindow") + 8, 16383, 16383)
elif way == "aspect":
    struct.pack_into("<f", exr, value_of(b"pixelAspectRatio"), 2.0)
elif way == "camera":
    struct.pack_into("<f", exr, value_of(b"worldToCamera"), 9.0)
open("j.golden/first.exr", "wb").write(exr)
END
}
cp j.golden/first.exr kept.exr
for way in none trailing attribute number preview window size aspect camera; do
    forge $way
    wanted=1
    [ $way != none ] || wanted=0
    expect $wanted timeout 60 "$iftty" verify --limit-memory 300M j.iftty || fail "$way"
done
out_has "it "
cp kept.exr j.golden/first.exr
close_story

begin "a journal that is a link, and other golden images next to the link"
mkdir links
ln -s ../j.iftty links/j.iftty
expect 0 "$iftty" verify --scene s.nii links/j.iftty
cp -r j.golden links
expect 0 "$iftty" verify --scene s.nii links/j.iftty
printf more >>links/j.golden/first.exr
expect 1 "$iftty" verify --scene s.nii links/j.iftty
out_has "is a link, and links/j.golden/first.exr is another file than"
expect 3 "$iftty" verify links/j.iftty --accept why
err_has "is a link; name the journal itself"
close_story

finish
