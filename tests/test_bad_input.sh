#!/bin/sh
# SPDX-License-Identifier: MIT
# Wrong, hostile or too large input: each ends with status 2 or 3 and one line with the reason,
# without escape sequences and without new files.
. "$(dirname "$0")/lib.sh"
private_mounts "$0"
mkdir field
cd field || exit 1
full=$work/full

make_scene good.nii 24 20 16

# No byte that a terminal obeys, line feeds apart.
is_plain() { # FILE...
    ! grep -qaP '[\x00-\x09\x0b-\x1f\x7f\x9b]' "$@" ||
        fail "control characters in $*: $(cat "$@" | od -c | sed 4q)"
}

# refused STATUS WORDS COMMAND...: exactly one line of complaint, which holds WORDS
refused() {
    states . >"$work/before"
    refused_status=$1 words=$2
    shift 2
    expect "$refused_status" "$@"
    # lines of the report of a replay begin with #
    awk '!/^#/ { n++ } length > 799 { n = 9 } END { exit n != 1 }' "$work/err" ||
        fail "not one line of less than 800 from $*:" "$(sed 5q "$work/err")"
    grep -qF -e "$words" "$work/err" "$work/out" ||
        fail "no '$words' from $*:" "$(cat "$work/err" "$work/out")"
    is_plain "$work/err" "$work/out"
    states . | cmp -s - "$work/before" || fail "left by $*:" "$(states . | diff "$work/before" -)"
}
scene_refused() { # WORDS FILE: by each way to open one
    refused 3 "$1" "$iftty" -c "open \"$2\""
    refused 3 "$1" "$iftty" "$2" </dev/null
    refused 3 "$1" "$iftty" -c 'open other.nii' --scene "$2"
}

# variant NAME OFFSET BYTES: the good scene with other bytes in its header
variant() {
    cp good.nii "$1"
    put "$1" "$2" "$3"
}

header_refused() { # WORDS OFFSET BYTES: as a variant
    variant h.nii "$2" "$3"
    scene_refused "$1" h.nii
}

# ---- scenes ----

begin "a good scene is fine"
expect 0 "$iftty" -c 'open good.nii; info'
gzip -nc good.nii >good.nii.gz
expect 0 "$iftty" -c 'open good.nii.gz; info'

begin "scenes cut short"
half=$(($(file_bytes good.nii.gz) / 2))
head -c $half good.nii.gz >cut.nii.gz
scene_refused "cut.nii.gz" cut.nii.gz
head -c $(($(file_bytes good.nii.gz) - 4)) good.nii.gz >cut.nii.gz
scene_refused "cut.nii.gz" cut.nii.gz
for n in 0 1 2 10 347 351 352 1000 8031; do
    head -c $n good.nii >cut.nii
    scene_refused "cut.nii" cut.nii
done
head -c 12 good.nii.gz >cut.nii.gz
scene_refused "cut.nii.gz" cut.nii.gz

begin "a flipped bit within a gzip"
cp good.nii.gz flipped.nii.gz
flip_byte flipped.nii.gz $half
scene_refused "flipped.nii.gz" flipped.nii.gz
cp good.nii.gz flipped.nii.gz
flip_byte flipped.nii.gz $(($(file_bytes good.nii.gz) - 6))
scene_refused "flipped.nii.gz" flipped.nii.gz

begin "headers that make no sense"
header_refused "h.nii" 344 'xyz'
header_refused "h.nii" 0 '\001'
header_refused "dim" 40 '\011\000' # dim[0] of 9
header_refused "dim" 40 '\000\000'
header_refused "h.nii" 40 '\004\000\030\000\024\000\020\000\002\000' # a series
header_refused "dim" 42 '\000\000'
header_refused "dim" 42 '\377\377'
header_refused "h.nii" 42 '\377\177\377\177\377\177' # 32767 each way
header_refused "type" 70 '\000\007' # complex numbers
header_refused "h.nii" 108 '\000\000\300\177' # begins at NaN
header_refused "h.nii" 108 '\377\377\177\177' # begins far away
variant h.nii 80 '\000\000\300\177' # a spacing of NaN
answers "pixdim[1] is nan, which is no distance of voxels" 'open h.nii'
out_has "lengths and volumes are in voxels"

begin "pairs of which a file is missing, short, exchanged, misnamed or no file"
head -c 344 good.nii >a.hdr # and the magic of a pair
printf 'ni1\000' >>a.hdr
put a.hdr 108 '\000\000\000\000'
scene_refused "there is no a.img next to it, with its voxels; expected both files" a.hdr
tail -c +353 good.nii >a.img
expect 0 "$iftty" -c 'open a.hdr'
expect 0 "$iftty" -c 'open a.img'
cp a.img alone.img
scene_refused "there is no alone.hdr next to it, with its header" alone.img
expect 0 "$iftty" -c 'open raw:alone.img size=24,20,16 type=uint8'
head -c 999 a.img >short.img
cp a.hdr short.hdr
for name in short.hdr short.img; do
    scene_refused "$name: its .img: cut short or false: its header claims 7680 bytes" $name
done
gzip -n <a.img | head -c 60 >torn.img.gz
cp a.hdr torn.hdr
for name in torn.hdr torn.img.gz; do
    scene_refused "$name: cut short: it ends within the voxels" $name
done
cp a.hdr turned.img
cp a.img turned.hdr
for name in turned.hdr turned.img; do
    scene_refused "the .hdr and the .img may have each other's names" $name
done
cp a.hdr named.nii
scene_refused "expected the names A.hdr and A.img" named.nii
cp a.hdr folder.hdr
mkdir folder.img
scene_refused "folder.img: a folder; expected a file" folder.hdr
rmdir folder.img
mkfifo folder.img
refused 3 "folder.img" timeout 60 "$iftty" -c 'open folder.hdr'
cp good.nii whole.hdr
expect 0 "$iftty" -c 'open whole.hdr'
cp a.img whole.img
scene_refused "its .hdr is that of a single file, not of a pair" whole.img
for n in 0 1 347; do
    head -c $n a.hdr >cut.hdr
    cp a.img cut.img
    scene_refused "cut.hdr: no header of ANALYZE or NIfTI" cut.hdr
    scene_refused "cut.img: its .hdr: not a NIfTI file: $n bytes" cut.img
done
cp a.hdr far.hdr
cp a.img far.img
put far.hdr 108 '\000\000\200\277' # the voxels begin at -1
scene_refused "vox_offset is -1; expected a whole number of bytes from 0" far.hdr
put far.hdr 108 '\000\000\200\077'
scene_refused "its .img: cut short or false" far.hdr
put far.hdr 42 '\377\177\377\177\377\177' # 32767 each way
scene_refused "its .img: cut short or false" far.hdr
rm -r folder.img

begin "a voxel that is no number"
nifti_header 24 20 16 16 32 >nan.nii
head -c $((24 * 20 * 16 * 4)) /dev/zero >>nan.nii
expect 0 "$iftty" -c 'open nan.nii'
put nan.nii 1000 '\000\000\300\177'
put nan.nii 2000 '\000\000\200\177' # infinite
answers "2 voxels are no number or infinite: taken for 0" 'open nan.nii'

# In 400 MB of memory and a few seconds, where the sanitizers do not need more themselves.
bounded() {
    case $build in
    *asan*) "$@" ;;
    *) (
        ulimit -v 400000
        "$@"
    ) ;;
    esac
}

begin "eight threads share a scene of seven million voxels in this address space"
{ nifti_header 200 200 175; head -c 7000000 /dev/zero; } >even.nii
{ nifti_header 200 200 175; head -c 7000000 /dev/urandom; } >noise.nii
for scene in even noise; do
    bounded env IFTTY_THREADS=8 "$iftty" -c "open $scene.nii; seed 9,9,9 1; seed 190,190,170 2
        run" >"$work/out" 2>"$work/err" || fail "$scene: $(cat "$work/err")"
    out_has 'voxels changed'
done
rm even.nii noise.nii

begin "a gzip that swells is not swallowed"
{ nifti_header 24 20 16; head -c 300000000 /dev/zero; } | gzip -1 -n >bomb.nii.gz
cp bomb.nii.gz bomb-again.nii.gz
bounded "$iftty" -c 'open bomb.nii.gz' >"$work/out" 2>"$work/err"
case $? in
0) out_has '24x20x16 voxels' ;;
3) err_has bomb.nii.gz ;;
*) fail "it died: $(cat "$work/err")" ;;
esac
{ nifti_header 32767 32767 32767; head -c 9000000 /dev/zero; } | gzip -1 -n >bomb.nii.gz
refused 3 "bomb.nii.gz" bounded "$iftty" -c 'open bomb.nii.gz'
{ nifti_header 700 700 700; head -c 3000000 /dev/zero; } | gzip -1 -n >bomb.nii.gz # claims 343 MB
refused 3 "bomb.nii.gz" bounded "$iftty" -c 'open bomb.nii.gz'
le64() { # below 2^24
    printf '\\%03o\\%03o\\%03o\\000\\000\\000\\000\\000' \
        $(($1 & 255)) $(($1 >> 8 & 255)) $(($1 >> 16 & 255))
}
{
    printf '\034\002\000\000n+2\000\r\n\032\n\002\000\010\000'
    printf "$(le64 3)$(le64 60000)$(le64 60000)$(le64 60000)$(le64 1)$(le64 1)$(le64 1)$(le64 1)"
    head -c 24 /dev/zero # intent parameters
    for _ in 1 2 3 4 5 6 7 8; do printf '\000\000\000\000\000\000\360\077'; done
    printf "$(le64 544)"
    head -c 368 /dev/zero
} >claims.nii
same "$(file_bytes claims.nii)" 544
refused 3 "claims.nii" bounded "$iftty" -c 'open claims.nii'
{ cat claims.nii; head -c 3000000 /dev/zero; } | gzip -1 -n >bomb.nii.gz
refused 3 "bomb.nii.gz" bounded "$iftty" -c 'open bomb.nii.gz'
rm bomb.nii.gz

begin "files that are no scenes"
mkdir folder.nii folder.png
mkfifo pipe.nii
scene_refused "missing.nii" missing.nii
refused 3 "folder.nii" "$iftty" -c 'open folder.nii'
refused 3 "pipe.nii" timeout 60 "$iftty" -c 'open pipe.nii'
refused 3 "/dev/zero" timeout 60 "$iftty" -c 'open /dev/zero'
printf 'hello\n' >text.nii
scene_refused "text.nii" text.nii
head -c 50000 "$iftty" >program.nii
scene_refused "program.nii" program.nii
ln -s loop.nii loop.nii
refused 3 "loop.nii" "$iftty" -c 'open loop.nii'
refused 3 "a/b" "$iftty" -c "open good.nii/a/b"
refused 3 "synth:geom" "$iftty" -c "open synth:geom:999"
refused 3 "synth:" "$iftty" -c "open synth:"

# ---- masks and weights ----

begin "files that are no masks or weights"
make_scene small.nii 23 20 16
head -c 1000 good.nii >cut.nii
mv bomb-again.nii.gz bomb.nii.gz
{ nifti_header 32767 32767 32767; head -c 9000000 /dev/zero; } | gzip -1 -n >vast.nii.gz
variant other-way.nii 252 '\001\000' # a qform, whose quaternion is half a turn about x
put other-way.nii 256 '\000\000\200\077'
cp good.nii placed.nii
put placed.nii 252 '\001\000'
for command in mask weight; do
    start='open good.nii; auto on; seed 1,1,1 1'
    refused 3 "missing.nii" "$iftty" -c "$start; $command missing.nii"
    refused 3 "small.nii: the map has 23x20x16 voxels and the scene 24x20x16" \
        "$iftty" -c "$start; $command small.nii"
    if [ $command = weight ]; then
        answers "2 voxels are no number or infinite: taken for 0" "$start; $command nan.nii"
    fi
    refused 3 "cut.nii" "$iftty" -c "$start; $command cut.nii"
    refused 3 "text.nii" "$iftty" -c "$start; $command text.nii"
    refused 3 "folder.nii" "$iftty" -c "$start; $command folder.nii"
    refused 3 "pipe.nii" timeout 60 "$iftty" -c "$start; $command pipe.nii"
    refused 3 "vast.nii.gz: cut short or false: its header claims" \
        bounded "$iftty" -c "$start; $command vast.nii.gz"
    refused 3 "the map is up to 48.4 mm away from the scene" \
        "$iftty" -c "open placed.nii; $command other-way.nii"
    expect 0 "$iftty" -c "$start; $command good.nii"
done
bounded "$iftty" -c "$start; mask bomb.nii.gz" >"$work/out" 2>"$work/err"
[ $? = 3 ] || fail "a mask that swells: $(cat "$work/err")"
rm bomb.nii.gz vast.nii.gz

begin "a small file that declares gigabytes is opened with crop= or huge=yes"
{ nifti_header 1024 1024 70; head -c $((1024 * 1024 * 70)) /dev/zero; } | gzip -9 -n >swell.nii.gz
scene_refused "MB on disk claim a scene that needs 1.4 GB of memory; \`open FILE huge=yes\`" \
    swell.nii.gz
expect 0 "$iftty" -c "open swell.nii.gz crop=0-9,0-9,0-9"
if can_limit_memory; then
    bounded "$iftty" -c "open swell.nii.gz huge=yes" >"$work/out" 2>"$work/err"
    grep -qE "GB of memory and .* GB are free|out of memory" "$work/err" ||
        fail "$(cat "$work/err")"
fi
rm swell.nii.gz

begin "the same holds for maps, tables of values and pictures, in every command"
nifti_header 1024 1024 500 >header
put header 252 '\001\000'
# A gzip may have any number of members: the zeros are packed once.
head -c $((1024 * 1024 * 50)) /dev/zero | gzip -1 -n >zeros.gz
{ cat header; head -c $((1024 * 1024 * 50)) /dev/zero; } | gzip -1 -n >swell.nii.gz
for _ in 1 2 3 4 5 6 7 8 9; do cat zeros.gz; done >>swell.nii.gz
rm zeros.gz
said=" MB on disk claim 1.0 GB of voxels; if that is right, unpack it first (\`gunzip\`)"
for command in mask weight seed-file labels; do
    refused 3 "$said" bounded "$iftty" -c "open placed.nii; $command swell.nii.gz resample=yes"
    refused 3 "the map has 1024x1024x500 voxels" \
        bounded "$iftty" -c "open placed.nii; $command swell.nii.gz"
done
refused 3 "$said" bounded "$iftty" compare swell.nii.gz swell.nii.gz
refused 3 "$said" bounded "$iftty" info --histogram swell.nii.gz
expect 0 "$iftty" info swell.nii.gz
"$PYTHON" - <<'EOP' # 256 million pixels, and the bytes of the first few
import struct, zlib
def piece(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
with open("swell.png", "wb") as out:
    out.write(b"\x89PNG\r\n\x1a\n")
    out.write(piece(b"IHDR", struct.pack(">2I5B", 16000, 16000, 8, 0, 0, 0, 0)))
    out.write(piece(b"IDAT", zlib.compress(bytes(1 << 20))) + piece(b"IEND", b""))
EOP
refused 3 "swell.png: it claims 16000x16000 pixels" "$iftty" info swell.png
rm -f header swell.nii.gz swell.png

# ---- commands ----

begin "commands that are wrong, through the program"
start='open good.nii; seed 1,1,1 1; run'
refused 3 "0,0,0 to 23,19,15" "$iftty" -c "$start; seed 24,0,0 1"
refused 3 "0,0,0 to 23,19,15" "$iftty" -c "$start; why -1,0,0"
refused 2 "unknown command" "$iftty" -c "$start; exterminate"
refused 2 "expected a label" "$iftty" -c "$start; seed 1,1,1 nobody"
refused 2 "expected 6|26" "$iftty" -c "$start; adjacency 7"
refused 2 "a word in quotes does not end" "$iftty" -c "$start; label 2 \"x"
refused 3 "outside the picture" "$iftty" -c "$start; size 20 20; render; pick 20 3"

begin "lines that are too long, zero bytes, bytes of no language"
{
    echo 'open good.nii'
    head -c 100000 /dev/zero | tr '\0' a
    printf '\nseed 1,1,1 1\n'
} >script
refused 2 "script:2: the command is longer than 65535 bytes" "$iftty" run script
{ printf 'open good.nii\nseed 1,1,1 1\000 2\n'; } >script
refused 2 "script:2: " "$iftty" run script
printf 'open good.nii\n\000\000\000\n' >script
refused 2 "script:2: a command is UTF-8 text" "$iftty" run script
printf 'open good.nii\n\377\376\n' >script
refused 2 "without control characters, not \\xff\\xfe" "$iftty" run script
head -c 100000 "$iftty" >script
refused 2 "script:1: " "$iftty" run script
for program in "replay script" "verify script" "run - --journal script"; do
    states . >"$work/before"
    "$iftty" $program </dev/null >"$work/out" 2>"$work/err"
    case $? in 1 | 2 | 3) ;; *) fail "$program: $(cat "$work/err")" ;; esac
    is_plain "$work/out" "$work/err"
    [ "$(grep -vc '^#' "$work/err")" = 1 ] || fail "$program:" "$(cat "$work/err")"
    states . | cmp -s - "$work/before" || fail "left by $program"
done
rm script

begin "a file of another kind is named by its kind"
neither="this is neither a journal, which begins with a header, nor a script, which is text"
for program in log verify replay "diff good.nii" "log --anonymise"; do
    refused 3 "$neither" "$iftty" $program good.nii
done
refused 1 "$neither" "$iftty" log --check good.nii
! grep -q 'record 0' "$work/err" || fail "$(cat "$work/err")"
printf '<!DOCTYPE html>\n<html>404 Not Found</html>\n' >refused.nii.gz
scene_refused "a web page, as a download that was refused leaves it; fetch the file again" \
    refused.nii.gz
rm refused.nii.gz
echo 'open good.nii' >words.iftty
: >empty.iftty
for name in words.iftty empty.iftty; do
    refused 3 "$name has no header of a journal; \`iftty run $name\`" "$iftty" $name </dev/null
    refused 3 "$name is named as a journal, and \`open\` opens scenes" "$iftty" -c "open $name"
    refused 3 "it is no picture of a format that is known here" "$iftty" info $name
done
refused 3 "it is no picture of a format that is known here" "$iftty" show good.nii
rm words.iftty empty.iftty

# ---- journals ----

begin "journals that are none"
expect 0 "$iftty" -c "$start" --journal j.iftty
printf '# iftty journal 2 semantics 1\n' >f.iftty
refused 3 "f.iftty" "$iftty" run - --journal f.iftty </dev/null
refused 3 "format" "$iftty" replay f.iftty
printf '# iftty journal 1 semantics 999\n' >f.iftty
refused 3 "it has semantics 999, and this program knows" "$iftty" run - --journal f.iftty </dev/null
printf '# iftty journal one\n' >f.iftty
refused 3 "f.iftty" "$iftty" run - --journal f.iftty </dev/null
printf 'open good.nii\n' >f.iftty
refused 3 "this is a script" "$iftty" run - --journal f.iftty </dev/null
sed 2d j.iftty >f.iftty # a result without its command
refused 3 "f.iftty" "$iftty" run - --journal f.iftty </dev/null
refused 3 "record 1" "$iftty" replay f.iftty
refused 3 "record 1" "$iftty" verify f.iftty
refused 1 "record 1" "$iftty" log --check f.iftty # a check that failed
{ cat j.iftty; printf 'seed 1,1,1 1\000\nrun\n'; cat j.iftty; } >f.iftty
refused 3 "f.iftty" "$iftty" run - --journal f.iftty </dev/null
{ cat j.iftty; head -c 70000 /dev/zero | tr '\0' a; printf '\n'; cat j.iftty; } >f.iftty
refused 3 "f.iftty" "$iftty" run - --journal f.iftty </dev/null
sed 's/seed 1,1,1 1/seed 2,1,1 1/' j.iftty >f.iftty
refused 3 "record 2" "$iftty" run - --journal f.iftty </dev/null
refused 3 "folder.nii" "$iftty" run - --journal folder.nii </dev/null
refused 3 "/dev/zero" timeout 60 "$iftty" run - --journal /dev/zero </dev/null
refused 3 "/dev/zero" timeout 60 "$iftty" replay /dev/zero
refused 3 "folder.nii" "$iftty" log folder.nii

# ---- where nothing can be written ----

begin "folders where nothing can be written"
echo text >x.txt
for place in x.txt/y none/y /proc/nonexistent/y /proc/y; do
    refused 3 "$place.exr" "$iftty" -c "$start; render $place.exr"
    refused 3 "$place.png" "$iftty" -c "$start; render $place.png"
    refused 3 "$place.nii.gz" "$iftty" -c "$start; save labels $place.nii.gz"
    refused 3 "$place.iftty" "$iftty" -c "$start" --journal "$place.iftty"
done
refused 3 "x.txt" "$iftty" -c "$start; render y.exr" --out x.txt
refused 3 "none/out" "$iftty" -c "$start; render y.exr" --out none/out
refused 3 "folder.nii" "$iftty" -c "$start; save labels folder.nii replace=yes"
refused 3 "pipe.nii" "$iftty" -c "$start; save labels pipe.nii"
refused 3 "loop.nii" "$iftty" -c "$start; save labels loop.nii"
refused 2 ".txt" "$iftty" -c "$start; save labels labels.txt"
refused 3 "picture.odd" "$iftty" -c "$start; render picture.odd"
refused 3 "folder.png" "$iftty" -c "$start; render folder.png replace=yes"

# With files of at most N blocks of 512 bytes: the disk is as good as full.
within() {
    (
        trap '' XFSZ
        ulimit -f "$1"
        shift
        exec "$@"
    )
}
seeds() { # many of them
    echo 'open good.nii'
    awk 'BEGIN {
        for (i = 0; i < 200; i++) print "seed " i % 24 "," i % 20 "," i % 16 " " i % 7
        print "run" }'
}
# Commands acknowledged before the disk was full are in the journal, and more can follow.
holds_what_was_said() { # JOURNAL
    sed -n 's/^ok [0-9-]* //p' "$work/out" >"$work/said"
    "$iftty" log --script "$1" >"$work/kept" || fail "log --script"
    cmp -s "$work/said" "$work/kept" ||
        fail "said and recorded differ:" "$(diff "$work/said" "$work/kept" | sed 4q)"
    [ "$(wc -l <"$work/said")" -gt 5 ] || fail "only $(wc -l <"$work/said") commands were possible"
    expect 0 "$iftty" verify "$1"
    expect 0 "$iftty" -c 'seed 5,5,5 5; run' --journal "$1"
    expect 0 "$iftty" verify "$1"
}

begin "files that may not grow: nothing is left of them"
refused 3 "l.nii" within 4 "$iftty" -c "$start; save root l.nii"
refused 3 "p.exr" within 4 "$iftty" -c "$start; size 300 300; view 30 20; render p.exr"
refused 3 "p.png" within 4 \
    "$iftty" -c "$start; size 500 500; view 30 20; seed 20,10,10 2; zoom 9; render p.png"
cp good.nii l.nii
refused 3 "l.nii" within 4 "$iftty" -c "$start; save root l.nii replace=yes"
same_files l.nii good.nii

begin "a journal that may not grow: the command is undone, the rest is kept"
seeds >"$work/seeds"
expect 3 within 8 "$iftty" run "$work/seeds" --journal grown.iftty
err_has "the command was undone because it could not be recorded"
same "$(wc -l <"$work/err")" 3 # why, and two lines of how to go on
err_has "iftty run $work/seeds --journal grown.iftty"
holds_what_was_said grown.iftty
rm grown.iftty

begin "a full disk"
mkdir "$full"
if can_mount && mount -t tmpfs -o size=64k tmpfs "$full"; then
    cp good.nii "$full"
    cat /dev/zero >"$full/ballast" 2>/dev/null
    cd "$full" || exit 1
    refused 3 "l.nii" "$iftty" -c "$start; save root l.nii"
    refused 3 "p.exr" "$iftty" -c "$start; size 300 300; seed 20,10,10 2; zoom 9; render p.exr"
    refused 3 "p.png" "$iftty" -c "$start; size 300 300; seed 20,10,10 2; zoom 9; render p.png"
    refused 3 "j.iftty" "$iftty" -c "$start" --journal j.iftty
    head -c 45056 /dev/zero >ballast # 64k less two pages for the scene and three to write on
    "$iftty" run "$work/seeds" --journal "$full/j.iftty" >"$work/out" 2>"$work/err"
    same "$?" 3
    err_has "No space left on device"
    rm "$full/ballast"
    holds_what_was_said j.iftty
    cd "$work/field" || exit 1
    umount "$full"
fi

finish
