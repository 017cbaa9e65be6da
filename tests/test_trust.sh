#!/bin/sh
# SPDX-License-Identifier: MIT
# A stranger's journal: the files it may read and write, its limits, how its bytes are shown, and
# programs that do not execute it.
. "$(dirname "$0")/lib.sh"
mkdir "$work/there" "$work/secret" "$work/tmp"
cd "$work/there" || exit 1
TMPDIR=$work/tmp
export TMPDIR
unset IFTTY_SCENES
make_scene s.nii 24 20 16
cp s.nii "$work/secret/hidden.nii"
esc=$(printf '\033')

journal() { # FILE COMMANDS: a stranger's, a script without proof
    printf '%s\n' "$2" | tr ';' '\n' | sed 's/^ *//' >"$1"
}
# refused WORDS JOURNAL [OPTION...]: by replay and verify, with these words; nothing is written
# anywhere
refused() {
    words=$1
    shift
    states "$work" | grep -v '^\(out\|err\|before\|after\|both\) ' >"$work/before"
    for program in replay verify; do
        expect 3 timeout 120 "$iftty" $program "$@"
        grep -qF -e "$words" "$work/out" "$work/err" ||
            fail "$program: no '$words' in: $(cat "$work/out" "$work/err")"
    done
    states "$work" | grep -v '^\(out\|err\|before\|after\|both\) ' >"$work/after"
    cmp -s "$work/before" "$work/after" || fail "left: $(diff "$work/before" "$work/after")"
}

replays() { # COMMANDS: of a stranger
    journal j "$1"
    expect 0 "$iftty" replay j
}
refuses() { # WORDS COMMANDS: of a stranger, with these words
    journal j "$2"
    refused "$1" j
}

# ---- reading ----

begin "a scene is read next to the journal, below its folder, or from --scene"
mkdir below
cp s.nii below/t.nii
replays 'open s.nii; seed 2,3,4 1; run'
expect_in / 0 "$iftty" replay "$work/there/j"
replays 'open below/t.nii; seed 2,3,4 1; run'
ln -s below/t.nii inner.nii
replays 'open inner.nii; seed 2,3,4 1; run' # a link that stays inside
journal j "open $work/secret/hidden.nii; seed 2,3,4 1; run"
expect 0 "$iftty" replay j --scene "$work/secret/hidden.nii"

begin "absolute names, .., links that lead out and devices are not read"
ln -s "$work/secret/hidden.nii" out.nii
ln -s "$work/secret" folder
ln -s ../secret/hidden.nii relative.nii
ln -s /dev/zero zero.nii
mkfifo pipe.nii
refuses "expected --scene FILE" "open $work/secret/hidden.nii"
refuses "expected --scene FILE" "open ../secret/hidden.nii"
for name in out.nii folder/hidden.nii relative.nii zero.nii; do
    refuses "the journal may not read $name, which leads out of its folder" "open $name"
done
refuses "pipe.nii is not a regular file" 'open pipe.nii'
journal j 'open below' # a scene may be a folder of slices; links in it are left alone
refused "the folder holds no slices of DICOM, TIFF, PNG or BMP" j
for command in mask weight seed-file; do
    for name in "$work/secret/hidden.nii" ../secret/hidden.nii \
        out.nii folder/hidden.nii zero.nii; do
        refuses "the journal may not read $name" "open s.nii; $command $name"
    done
    for name in pipe.nii below; do
        refuses "$name is not a regular file" "open s.nii; $command $name"
    done
done

begin "both files of a pair are read, and neither may lead out"
head -c 348 s.nii >p.hdr
put p.hdr 344 'ni1'
tail -c +353 s.nii >p.img
put p.hdr 108 '\000\000\000\000'
for name in p.hdr p.img; do
    replays "open $name; seed 2,3,4 1; run"
    replays "open s.nii; mask $name"
done
mkdir pairs
mv p.hdr p.img pairs
ln -s pairs/p.hdr p.hdr
ln -s pairs/p.img p.img
replays "open p.hdr; seed 2,3,4 1; run"
expect_in "$work/secret" 0 "$iftty" -c "open $work/there/p.img; seed 2,3,4 1; run" \
    --journal "$work/tmp/far.iftty"
expect_in / 0 "$iftty" verify "$work/tmp/far.iftty" --scene "$work/there/pairs/p.img"
expect_in / 0 "$iftty" verify "$work/tmp/far.iftty" --scene "$work/there/p.hdr"
rm "$work/tmp/far.iftty" p.img
cp pairs/p.img "$work/secret"
for link in "$work/secret/p.img" ../secret/p.img /dev/zero "$work/secret/none.img"; do
    ln -s "$link" p.img
    refuses "the journal may not read p.img, which leads out of its folder" "open p.hdr"
    journal j "open s.nii; weight p.hdr"
    refused "the journal may not read p.img, which leads out of its folder" j
    rm p.img
done
mkfifo p.img
refuses "p.img is not a regular file" "open p.hdr"
rm p.hdr p.img

by_link='open away.nii' # each names one file elsewhere, away
by_path='open ../annex/key.nii'
by_whole="open $work/annex/key.nii"
# answered COMMAND...: the output of replay and verify, and the files they leave
answered() {
    rm -rf "$work/pictures"
    for program in replay verify; do
        "$@" timeout 60 "$iftty" $program p.iftty --out "$work/pictures" 2>&1
        echo "$program: $?"
        listing "$work/pictures"
    done
}
record() { # COMMANDS: in a new journal
    rm -f p.iftty
    expect 0 "$iftty" -c "$1" --journal p.iftty
}
loose() { # COMMAND...: as on a kernel without Landlock
    "$PYTHON" -I -S "$top/tests/volumes/without_landlock.py" "$@"
}
target=$work/annex/key.nii
begin "a scene elsewhere, by its path or behind a link, is read for a record with its proof"
mkdir "$work/annex" "$work/annex/p"
mkdir home && HOME=$work/there/home && export HOME
ln -s "$target" away.nii
for opens in "$by_link" "$by_path" "$by_whole"; do
    cp s.nii "$target"
    record "$opens; interpolate 1 1 2; seed 2,3,4 1; run"
    "$iftty" -c 'slice axial 3 seen.png; save labels seen.nii' --journal p.iftty >/dev/null
    rm -f seen.png seen.nii
    expect 0 "$iftty" verify p.iftty
    expect_in / 0 "$iftty" replay "$work/there/p.iftty"
    expect 0 loose "$iftty" verify p.iftty
    sed 's/ sha256=[0-9a-f]*//' p.iftty >bare # without the proof --scene is needed
    chain_anew bare bare.iftty
    expect_out "the journal may not " 3 "$iftty" verify bare.iftty
    out_has "expected --scene FILE"
    expect 0 "$iftty" verify bare.iftty --scene "$target"
    "$iftty" log p.iftty --script >script
    expect 3 "$iftty" verify script
done
cp s.nii "$work/annex/p/x.nii" # in a folder further up
record "open ../there/../annex/p/x.nii"
expect 0 "$iftty" verify p.iftty
cp pairs/p.hdr pairs/p.img "$work/annex/p" # both files of a pair
ln -s "$work/annex/p/p.hdr" p.hdr
ln -s "$work/annex/p/p.img" p.img
record "open p.hdr"
expect 0 "$iftty" verify p.iftty
cp s.nii "$work/secret/p.img" # with the name of a scene
ln -sf "$work/secret/p.img" p.img
expect 3 "$iftty" verify p.iftty
out_has "there is no scene p.hdr next to the journal or among the scenes; expected --scene FILE"
rm p.hdr p.img
cp pairs/p.hdr pairs/p.img . # a stranger's header could choose bytes to guess
record "open p.hdr"
cp p.img "$work/secret/voxels"
ln -sf "$work/secret/voxels" p.img
for name in p.hdr p.img; do
    sed "s/^open p.hdr/open $name/" p.iftty >guess
    chain_anew guess guess.iftty
    expect 3 "$iftty" verify guess.iftty
    out_has "there is no scene $name next to the journal or among the scenes"
done
rm p.hdr p.img

begin "any other file elsewhere is treated as missing"
nifti_header 30000 30000 30000 >"$work/large.nii"
for opens in "$by_link" "$by_path" "$by_whole"; do
    rm -f p.iftty "$target"
    cp s.nii "$target"
    expect 0 "$iftty" -c "$opens; seed 2,3,4 1; run" --journal p.iftty
    "$iftty" -c 'slice axial 3 seen.png; save labels seen.nii' --journal p.iftty >/dev/null
    rm -f seen.png seen.nii "$target"
    answered >"$work/none"
    grep -q 'verify: 3' "$work/none" && grep -q 'expected --scene FILE' "$work/none" ||
        fail "$(cat "$work/none")"
    for kind in other longer short empty text large folder pipe device mhd hdf5; do
        rm -rf "$target"
        case $kind in
        other) cp s.nii "$target"; flip_byte "$target" 1000 ;;
        longer) make_scene "$target" 25 20 16 ;;
        short) head -c 5000 s.nii >"$target" ;;
        empty) : >"$target" ;;
        text) echo 'the secret' >"$target" ;;
        large) cp "$work/large.nii" "$target" ;;
        folder) mkdir "$target" ;;
        pipe) mkfifo "$target" ;;
        device) ln -s /dev/zero "$target" ;;
        mhd) printf 'ObjectType = Image\nNDims = 3\nElementDataFile = x.raw\n' >"$target" ;;
        hdf5) printf '\211HDF\r\n\032\n' >"$target" ;;
        esac
        answered >"$work/some"
        cmp -s "$work/none" "$work/some" || fail "$opens, $kind: $(diff "$work/none" "$work/some")"
        answered loose >"$work/some"
        cmp -s "$work/none" "$work/some" || fail "$opens, $kind, without Landlock:" \
            "$(diff "$work/none" "$work/some")"
    done
    rm -rf "$target"
done
rm "$work/large.nii"

begin "a part of a file elsewhere, voxels without a header, and maps are not read by a proof"
cp s.nii "$target"
for opens in "$by_link crop=0-3,0-3,0-3" "$by_path reduce=2" \
    'open raw:away.nii size=4,4,4 type=uint8' 'open raw:../annex/key.nii size=4,4,4 type=uint8'; do
    record "$opens"
    expect_out "the journal may not " 3 "$iftty" verify p.iftty
    out_has "expected --scene FILE"
done
for command in mask weight labels; do
    record "open s.nii; $command away.nii"
    rm -rf p.golden
    expect 3 "$iftty" verify p.iftty
    out_has "the journal may not read away.nii, which leads out of its folder"
done
rm -f p.iftty

begin "one data set of many, and a header without voxels, are not read by a proof, under any name"
rm -f p.iftty away.nii "$target"
"$PYTHON" - "$work/annex" <<'EOP' || fail "no files"
import os, sys
import h5py, numpy
os.chdir(sys.argv[1])
with h5py.File("sets", "w") as file: # one number, which is easily guessed
    file["large"] = numpy.zeros((6, 7, 8), "u1")
    file["small"] = numpy.full((1, 1, 1), 42, "u1")
with open("meta", "w") as file:
    file.write("ObjectType = Image\nNDims = 3\nDimSize = 8 7 6\nElementSpacing = 1 1 1\n"
               "ElementType = MET_UCHAR\nElementDataFile = v.raw\n")
with open("nrrd", "w") as file:
    file.write("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 7 6\nspacings: 1 1 1\n"
               "encoding: raw\ndata file: v.raw\n\n")
EOP
seq 1 1000 | head -c 336 >v.raw
for opens in 'sets nii data=small' 'sets mnc data=small' 'meta mha' 'nrrd nrrd'; do
    set -- $opens
    ln -sf "$work/annex/$1" "away.$2"
    record "open away.$2 $3"
    expect_out "there is no scene away." 3 "$iftty" verify p.iftty
    expect_out "there is no scene away." 3 loose "$iftty" verify p.iftty --unconfined
done
rm -f p.iftty away.* v.raw
ln -s "$target" away.nii
cp s.nii "$target"

begin "a file that replaces a scene meanwhile is not shown"
expect 0 "$iftty" -c "$by_link; seed 2,3,4 1; run; slice axial 3 seen.png" --journal p.iftty
rm -f seen.png
cp s.nii "$work/annex/right.nii"
cp s.nii "$work/annex/wrong.nii"
flip_byte "$work/annex/wrong.nii" 1000
while :; do
    for file in right wrong; do
        ln -s "$work/annex/$file.nii" next.nii && mv -T next.nii away.nii
    done
done &
swapping=$!
round=0
while [ $((round += 1)) -le 20 ]; do
    rm -rf "$work/pictures"
    [ $((round % 2)) = 0 ] && set -- loose || set --
    "$@" "$iftty" replay p.iftty --out "$work/pictures" >"$work/out" 2>"$work/err"
    case $? in
    0) ;;
    3) grep -q 'there is no scene away.nii' "$work/err" && [ -z "$(ls "$work/pictures")" ] ||
        fail "$(cat "$work/err")" ;;
    *) fail "$(cat "$work/err")" ;;
    esac
done
kill $swapping
wait $swapping 2>/dev/null
rm -f away.nii next.nii p.iftty

begin "the target of a link in place of a journal is not shown, unless it is a journal"
echo 'token 1f2e3d' >"$work/secret/token"
expect 0 "$iftty" -c 'open synth:geom:20x20x20; seed 2,3,4 1; run' \
    --journal "$work/secret/far.iftty"
ln -s ../secret/far.iftty far.iftty
expect 0 "$iftty" verify far.iftty
for way in '' loose; do
    for target in ../secret/token ../secret/none "$work/secret" /dev/zero; do
        ln -sfn "$target" t.iftty
        for program in 'replay t.iftty' 'verify t.iftty'; do
            $way timeout 60 "$iftty" $program >"$work/both" 2>&1 && fail "$program: $target"
            grep -q 'token 1f\|1f2e' "$work/both" && fail "$way $program: $(cat "$work/both")"
            grep -q 't.iftty is a link, and leads to no journal' "$work/both" ||
                fail "$(cat "$work/both")"
        done
    done
done
rm t.iftty far.iftty

begin "the current folder is not searched"
mkdir elsewhere
cp s.nii "$work/secret/near.nii"
journal elsewhere/j 'open near.nii'
expect_in "$work/secret" 3 "$iftty" replay "$work/there/elsewhere/j"
expect_in "$work/secret" 0 env IFTTY_SCENES="$work/none:$work/secret" \
    "$iftty" replay "$work/there/elsewhere/j"
expect_in "$work/secret" 0 "$iftty" -c 'open near.nii' # for one's own commands it is

begin "the proof detects another scene of the same name"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run' --journal proof.iftty
grep -qE '^= 1 .* sha256=[0-9a-f]{64} chain=' proof.iftty ||
    fail "no proof: $(sed -n 3p proof.iftty)"
cp s.nii kept.nii
flip_byte s.nii 1000
expect_out "record 1, line" 1 "$iftty" verify proof.iftty
mv kept.nii s.nii
expect 0 "$iftty" verify proof.iftty
sed 's/ sha256=[0-9a-f]*//' proof.iftty >old.iftty # as journals without a proof were
expect_out "its chain digest does not fit" 1 "$iftty" verify old.iftty
expect 0 "$iftty" run "old.iftty" --journal anew.iftty
same_files anew.iftty proof.iftty

begin "the proof is the standard SHA-256"
same "$(last_word sha256 proof.iftty)" "$("$PYTHON" - <<'EOP'
import hashlib, struct
voxels = open("s.nii", "rb").read()[352:]
head = struct.pack("<6I4B", 24, 20, 16, 1000000, 1000000, 1000000, 0, 2, 4, 0)
print(hashlib.sha256(head + b"".join(struct.pack("<H", v) for v in voxels)).hexdigest())
EOP
)"

begin "a golden image is read in the journal's folder"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 30 30; golden g' --journal g.iftty
expect 0 "$iftty" verify g.iftty
mv g.golden "$work/secret"
ln -s "$work/secret/g.golden" g.golden
expect 1 "$iftty" verify g.iftty
out_has "the journal may not read g.golden/g.exr, which leads out of its folder"
rm g.golden && mkdir g.golden
ln -s /dev/zero g.golden/g.exr
expect_out "which leads out of its folder" 1 timeout 120 "$iftty" verify g.iftty
rm g.golden/g.exr && mkfifo g.golden/g.exr
expect_out "is not a regular file" 1 timeout 120 "$iftty" verify g.iftty

# ---- writing ----

begin "in the folder of --out, a replay replaces only its own files"
mkdir out
echo precious >out/p.png
echo precious >out/l.nii
journal j 'open s.nii; seed 2,3,4 1; run; render p.png replace=yes'
expect 3 "$iftty" replay j --out out
err_has "out/p.png existed before; a replay replaces only its own files"
journal j 'open s.nii; seed 2,3,4 1; run; save labels l.nii'
expect_err "out/l.nii exists already and was left alone" 3 "$iftty" replay j --out out
same "$(cat out/p.png out/l.nii | tr '\n' ' ')" "precious precious "
journal j 'open s.nii; seed 2,3,4 1; run; render q.png; turn 20; render q.png replace=yes'
if can_limit_memory; then
    expect 0 "$iftty" replay j --out out
    same "$(ls out | tr '\n' ' ')" "l.nii p.png q.png "
fi

begin "a link in the folder of --out does not lead the replay out of it"
echo precious >"$work/secret/target.png"
ln -s "$work/secret/target.png" out/t.png
for replace in no yes; do
    journal j "open s.nii; seed 2,3,4 1; run; render t.png replace=$replace"
    expect 3 "$iftty" replay j --out out
done
same "$(cat "$work/secret/target.png")" precious

# ---- limits ----

begin "memory, time and output are bounded, and the message names the option"
journal big \
    'open synth:geom; seed 100,100,50 1; run; adjacency 26; run; render a.exr; save root r.nii'
expect 3 "$iftty" replay big --limit-memory 50M
err_has "--limit-memory allows 50 MB: a scene of 200x200x100 voxels needs"
expect_err "longer than the 0.05 s of --limit-time" 3 "$iftty" replay big --limit-time 0.05
expect_out "longer than the 0.05 s of --limit-time" 3 "$iftty" verify big --limit-time 0.05s
sed 's/geom$/geom:80x80x60/; s/100,100,50/40,40,30/' big >small
expect 3 "$iftty" replay small --limit-output 1M --out bounded
err_has "more than the 1 MB of --limit-output; this file was removed"
same "$(ls bounded | tr '\n' ' ')" "a.exr " # files within the limit are kept
expect 0 "$iftty" replay small --limit-output 20M --limit-time 5m --limit-memory 2G --out bounded2
rm -r bounded bounded2

begin "several files are counted together"
{ printf 'open s.nii\nseed 2,3,4 1\nrun\n'; seq -f 'save root r%g.nii' 9; } >many
expect 3 "$iftty" replay many --limit-output 100k --out counted # of 31 kB each
same "$(ls counted | wc -l)" 3

begin "invalid limits"
for wrong in "--limit-memory 0" "--limit-memory much" "--limit-memory 5X" "--limit-memory -1" \
    "--limit-time 3d" "--limit-time 1e5" "--limit-output 99999999999T" "--limit-output 1MB"; do
    expect_err "${wrong%% *}: expected" 2 "$iftty" replay big $wrong
done

# ---- output ----

# shown WHAT COMMAND...: executed, with any status. Its output is collected below a line with WHAT.
shown() {
    echo "== $1" >>"$work/out"
    echo "== $1" >>"$work/err"
    what=$1
    shift
    "$@" >>"$work/out" 2>>"$work/err" </dev/null
    [ $? -lt 126 ] || fail "$what died"
}
# Well-formed UTF-8 without control characters other than line feeds, marks that change the
# direction of text, or invisible ones.
is_plain() { # FILE
    iconv -f utf-8 -t utf-8 "$1" >"$work/well-formed" 2>/dev/null ||
        fail "$(grep -a '^== ' "$work/well-formed" | tail -n 1): no UTF-8"
    control='[\x00-\x09\x0b-\x1f\x7f]|\xc2[\x80-\x9f\xad]|\xd8\x9c'
    hidden='\xe2\x80[\x8b-\x8f\xa8-\xae]|\xe2\x81[\xa0-\xaf]|\xef\xbb\xbf'
    obeyed=$(grep -anP "$control|$hidden|\xef\xb8[\x80-\x8f]|\xf3\xa0" "$1" | sed q)
    [ -z "$obeyed" ] || fail "$(sed "${obeyed%%:*}q" "$1" | grep -a '^== ' | tail -n 1):" \
        "a terminal would obey $(printf '%s' "$obeyed" | od -c | sed 4q)"
}

begin "bytes that control a terminal or deceive a reader are shown as text everywhere"
cat >"$work/hostile" <<'EOH'
clear\033[2Jscreen
title\033]0;mine\007
return\rover
bell\007tab\tdelete\177
eight\302\233[31mbit
raw\233[31m\220q
turned\342\200\256gpj.exe
isolated\342\201\247x\342\201\251
arabic\330\234mark
hidden\342\200\213\357\273\277joined
tags\363\240\201\201\363\240\204\200
half\342\202
long\300\257slash
surrogate\355\240\200
beyond\364\220\200\200
EOH
mkdir doors
cd doors || exit 1
cp ../s.nii ../proof.iftty .
while read -r escaped; do
    bad=$(printf "$escaped")
    : >"$work/out"
    : >"$work/err"
    cp s.nii "$bad.nii"
    cp proof.iftty "$bad.iftty"
    shown "a scene's name" "$iftty" -c "open \"$bad.nii\"; info"
    shown "a scene's name, by --scene" "$iftty" -c "open x; info" --scene "$bad.nii"
    shown "a journal's name" "$iftty" verify "$bad.iftty"
    shown "a name that is told" "$iftty" info "$bad.nii"
    shown "a name that is told, as JSON" "$iftty" info "$bad.nii" --json
    shown "a folder" "$iftty" replay proof.iftty --out "$bad/x"
    shown "an option" "$iftty" "--$bad"
    shown "a value" "$iftty" --graphics "$bad" run x
    shown "a command" "$iftty" -c "$bad"
    shown "a request of help" "$iftty" help "$bad"
    for program in run replay verify log "log --check"; do
        shown "a missing file" "$iftty" $program "$bad.missing"
    done
    printf '%s\n' 'open s.nii' 'size 60 60' "label 2 \"a$bad\"" stats "golden \"$bad\"" \
        'seed 1,1,1 1' "render \"$bad.png\"" "render \"$bad/x.png\"" "save labels \"$bad.nii\"" \
        "open \"$bad\"" "$bad" "label 2 $bad" "label 2 x $bad" "seed $bad 1" "seed 1,1,1 $bad" \
        "seed 1,1,1 1 $bad" "view $bad" "zoom $bad" "adjacency $bad" "help $bad" "golden $bad" \
        >"$bad.script"
    shown "a label, a golden image, a picture, a parameter" "$iftty" run "$bad.script" --keep-going
    shown "a script as a journal" "$iftty" run "$bad.script" --journal j.iftty
    shown "a journal's name, continued" "$iftty" -c info --journal "$bad.iftty"
    { sed -n 1,3p proof.iftty; printf '%s' "$bad"; } >torn.iftty
    shown "a torn record" "$iftty" run - --journal torn.iftty
    for line in "seed 1,1,1 $bad" "$bad" "open $bad"; do
        { sed -n 1,3p proof.iftty; printf '%s\n= 2 a=%s chain=%032d\n' "$line" "$bad" 0; } >l.iftty
        for program in replay "log --check"; do shown "$program" "$iftty" $program l.iftty; done
    done
    cp s.nii header.nii
    for at in 14 148 228 328; do # db_name, descrip, aux_file, intent_name
        printf '%s' "$bad" | dd of=header.nii bs=1 seek=$at conv=notrunc 2>/dev/null
    done
    shown "a header" "$iftty" -c 'open header.nii; info'
    shown "a header that is told" "$iftty" info header.nii
    {
        sed -n 1,3p proof.iftty
        printf '# %s\nlabel 2 "%s"\n= 2 a=%s chain=%032d\n# torn %s' "$bad" "$bad" "$bad" 0 "$bad"
    } >lines.iftty
    for program in "replay" "verify" "log" "log --check" "log --script" "log --anonymise" \
        info "info --json" "run - --journal" "run"; do
        shown "$program" "$iftty" $program lines.iftty
    done
    is_plain "$work/out"
    is_plain "$work/err"
    rm -rf -- ./*"$bad"*
done <"$work/hostile"
if needs oiiotool; then # all pictures at once, since the helper starts slowly
    set --
    while read -r escaped; do
        set -- "$@" --attrib "deceit$#" "$(printf "$escaped")"
    done <"$work/hostile"
    : >"$work/out"
    : >"$work/err"
    oiiotool --create 4x4 3 "$@" -o noted.png -o noted.exr 2>/dev/null
    shown "a picture's notes" "$iftty" info noted.png
    shown "a picture's attributes" "$iftty" info noted.exr
    shown "a picture's attributes, as JSON" "$iftty" info noted.exr --json
    names=$(wc -l <"$work/hostile")
    same "$(grep -aoE 'deceit[0-9]+"?: ' "$work/out" | wc -l)" $((3 * names))
    is_plain "$work/out"
    is_plain "$work/err"
fi
cd ..

# ---- without execution ----

begin "log --check reports intact, torn, or edited since a record"
expect_out "intact, 3 records" 0 "$iftty" log --check proof.iftty
sed 's/^seed 2,3,4 1$/seed 3,3,4 1/' proof.iftty >edited.iftty
expect_err "record 2" 1 "$iftty" log --check edited.iftty
head -c $(($(file_bytes proof.iftty) - 20)) proof.iftty >torn.iftty
expect_err "record 3" 1 "$iftty" log --check torn.iftty

begin "--anonymise removes comments and names of files, and nothing else"
cat >named <<'EOS'
# for Dr. Brown
open /home/brown/miller-1950.nii.gz

mask ../brown/mask.nii regions=1-3
weight gauss 1.5
weight edges.nii
seed-file "my seeds.csv" label=2
label 2 brain #40c060
seed 1,2,3 brain radius=3
slice axial 90 axial.png
spin 36 turn%03d.png
save labels axial.png replace=yes
render miller.brown mode=sp
render 19500401
open DOE.JANE
render jane.DOE
later /home/brown/x
EOS
cat >unnamed <<'EOS'
open scene.nii.gz
mask file-1.nii regions=1-3
weight gauss 1.5
weight file-2.nii
seed-file file-3.csv label=2
label 2 brain #40c060
seed 1,2,3 brain radius=3
slice axial 90 file-4.png
spin 36 file-5-%03d.png
save labels file-4.png replace=yes
render file-6 mode=sp
render file-7
open scene
render file-8
later file-9
EOS
expect 0 "$iftty" log named --anonymise
diff "$work/out" unnamed >"$work/both" || fail "$(cat "$work/both")"
expect 0 "$iftty" log named --anonymise --script
diff "$work/out" unnamed >"$work/both" || fail "$(cat "$work/both")"

# ---- confinement by the kernel ----

begin "info reports Landlock and seccomp of the kernel"
expect 0 "$iftty" info
grep -qE '^landlock  (version [0-9]+|none)' "$work/out" || fail "$(cat "$work/out")"
grep -q '^seccomp  ' "$work/out" || fail "$(cat "$work/out")"
expect_out '"landlock": ' 0 "$iftty" info --json
out_has '"seccomp": '

begin "replay and verify are confined, the user's own commands are not"
if needs_landlock; then
    family() { # PROCESS: it and its children, of which verify has one for each journal
        echo "$1 $(cat "/proc/$1/task/$1/children" 2>/dev/null)"
    }
    is_confined() { # PROCESS: it or one of its children
        for one in $(family "$1"); do cat "/proc/$one/status" 2>/dev/null; done |
            grep -q '^NoNewPrivs:[[:space:]]*1'
    }
    journal long 'open synth:geom:400x400x400; seed 100,100,50 1; run; adjacency 26'
    for program in replay verify -c; do
        case $program in
        -c) "$iftty" -c 'open synth:geom:400x400x400; seed 1,1,1 1; run' >"$work/out" 2>&1 & ;;
        *) "$iftty" $program long >"$work/out" 2>&1 & ;;
        esac
        process=$!
        if [ $program = -c ]; then
            sleep 0.5
            ! is_confined $process || fail "-c is confined"
        else
            comes_true is_confined $process
        fi
        kill $(family "$process") 2>/dev/null
        wait "$process" 2>/dev/null
    done
fi

finish
