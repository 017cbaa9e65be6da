#!/bin/sh
# SPDX-License-Identifier: MIT
# The command line: run, -c, replay, verify, log, their exit statuses, and edited journals.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
scene=$work/s.nii

cat >script <<EOS
# two seeds in a small scene
open s.nii
label 2 ball #40c060

seed 2,3,4 1
seed 6,10,8 ball radius=1
  seed   20,10,8	3
run
size 40 30
view 30 20
render mode=bp
golden first
remove 20,10,8
run
golden second
EOS
sed -n 's/^  seed   20,10,8	3$/seed 20,10,8 3/; s/ ball radius/ 2 radius/
    s/^open .*/& weight=morph/; /^[a-z]/p' script >canonical

acks() {
    sed -n 's/^ok [0-9-]* //p' out
}

begin "run acknowledges each command in canonical form, and records it"
sed '/golden/d' script >plain
expect 0 "$iftty" run plain
sed '/golden/d' canonical >plain.canonical
acks | cmp -s - plain.canonical || fail "$(acks | diff - plain.canonical)"
same "$(sed -n 's/^ok \([0-9]*\) .*/\1/p' out | tr '\n' ' ')" "1 2 3 4 5 6 7 8 9 10 11 "
[ ! -s err ] || fail "$(cat err)"
expect 0 "$iftty" run - <plain
acks | cmp -s - plain.canonical || fail "$(acks | diff - plain.canonical)"
expect 0 "$iftty" run script --journal j.iftty
acks | cmp -s - canonical || fail "$(acks | diff - canonical)"
out_has "stored as j.golden/first.exr"
same "$(grep -c '^= ' j.iftty)" 13
expect 0 "$iftty" log --script j.iftty
grep '^[a-z]' out | cmp -s - canonical || fail "log --script: $(diff out canonical)"
expect_out "13 records" 0 "$iftty" log --check j.iftty
expect 0 "$iftty" log j.iftty
same_files out j.iftty
[ -f j.golden/first.exr ] && [ -f j.golden/first.png ] && [ -f j.golden/second.exr ] ||
    fail "golden images are missing: $(ls j.golden)"

begin "-c carries out commands between semicolons"
expect 0 "$iftty" -c 'open s.nii; seed 1,1,1 1;run ;; # nothing'
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;seed 1,1,1 1;run;"
cp s.nii 'a; b.nii'
expect_out 'ok 1 open "a; b.nii"' 0 "$iftty" -c 'open "a; b.nii"; info'
expect_err "-c:2: unknown command sed" 2 "$iftty" -c 'open s.nii; sed'
expect 0 "$iftty" -c '# a "comment; with a quote
open s.nii; # "
seed 1,1,1 1'
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;seed 1,1,1 1;"
expect_err '-c:1: there is no command a"; b' 2 "$iftty" -c 'help "a\"; b"; sed'

begin "the first error ends a script, or not with --keep-going"
printf 'open s.nii\nseed 99,1,1 1\nseed 1,1,1 1\nsed\nrun\n' >bad
expect 3 "$iftty" run bad
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;"
same "$(cat err)" \
    "bad:2: 99,1,1 is outside the scene, whose voxels are 0,0,0 to 23,19,15; nothing has changed"
expect 3 "$iftty" run bad --keep-going
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;seed 1,1,1 1;run;"
same "$(cut -d: -f1-2 err | tr '\n' ' ')" "bad:2 bad:4 "
expect 2 "$iftty" -c 'sed; open nothing' --keep-going
same "$(wc -l <err)" 2
expect 0 "$iftty" -c 'open s.nii; quit; seed 1,1,1 1' # what follows `quit` is not carried out
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;quit;"

begin "exit statuses"
expect_out "iftty run FILE|-" 0 "$iftty" --help
expect 0 "$iftty" -V
same "$(sed -n 2p out)" "journal semantics $("$iftty" info | sed -n 's/^semantics //p')"
for library in OpenEXR zlib libdeflate nettle; do
    grep -qE "(^|, )$library [0-9]+[.][0-9]+" out || fail "no $library: $(cat out)"
done
expect 0 "$iftty" help
expect 0 "$iftty" help seed
for wrong in "help nothing" "--nothing" "run" "run a b" "run --journal" "replay" "verify" "log" \
    "a b" "--graphics loud run script" "-c"; do
    expect 2 "$iftty" $wrong </dev/null
    same "$(wc -l <err)" 1
    [ ! -s out ] || fail "'$wrong' printed something"
done
for missing in "run nothing" "replay nothing" "verify nothing" "log nothing" "log --check nothing" \
    "log --script nothing" "-c open\\ nothing" "nothing"; do
    eval "expect 3 \"\$iftty\" $missing </dev/null"
    same "$(wc -l <err)" 1
done
expect 3 "$iftty" nothing.iftty </dev/null
same "$(cat err)" \
    "iftty: there is no journal nothing.iftty; \`iftty SCENE --journal FILE\` begins one"
expect_out "# there is no journal nothing" 3 "$iftty" verify nothing

begin "an input without a command leaves no journal"
mkdir nothing
expect_in nothing 0 "$iftty" </dev/null
same "$(ls -A nothing)" ""
echo 'open synth:geom:9x9x9' >one
expect_in nothing 0 "$iftty" <one
same "$(grep -v '^[=#]' nothing/session-1.iftty | tr '\n' ';')" \
    "auto on;open synth:geom:9x9x9 weight=morph;"

begin "a pipe without a reader ends a program in silence, and a full disk does not"
mkfifo pipe
for program in "--help" "log q.iftty" "verify --no-strict q.iftty"; do
    [ -e q.iftty ] || "$iftty" -c 'open s.nii' --journal q.iftty >/dev/null
    { (exec 3<pipe); : >closed; } &
    exec 4>pipe
    comes_true [ -e closed ]
    "$iftty" $program >&4 2>err
    same "$?" 141
    same "$(cat err)" ""
    exec 4>&-
    rm closed
done
for program in --help 'run plain'; do
    "$iftty" $program >/dev/full 2>err
    same "$?" 3
    same "$(sed q err)" "iftty: cannot write to standard output"
done

begin "a script that fails reports the records of its journal and the way to continue"
printf '# one\nlabel 1 a\nlabel 2 b\nlabell 3 c\nlabel 4 d\n' >"it's half.txt"
expect 2 "$iftty" run "it's half.txt" --journal half.iftty
same "$(sed 1d err)" "half.iftty holds 2 records, of the lines before line 4; to continue there:
    tail -n +4 'it'\\''s half.txt' | iftty run - --journal half.iftty"
sed s/labell/label/ "it's half.txt" >mended && mv mended "it's half.txt"
eval "$(sed -n '$p' err | sed "s|iftty run|'$iftty' run|")" >out 2>err ||
    fail "it does not go on: $(cat err)"
same "$("$iftty" log --script half.iftty | tail -n 1)" "label 4 d"
expect 2 "$iftty" -c "label 5 'a; b'; labell 6" --journal half.iftty
same "$(sed -n '$p' err)" "    iftty run - --journal half.iftty"
same "$("$iftty" log --script half.iftty | tail -n 1)" 'label 5 "a; b"'

begin "every program has help, by --help and by its name"
"$iftty" --help | sed -n 's/^    iftty \([a-z][a-z]*\).*/\1/p' | sort -u >programs
[ "$(wc -l <programs)" -ge 9 ] || fail "too few programs: $(cat programs)"
while read -r name; do
    expect 0 "$iftty" "$name" --help </dev/null
    cp out own
    same "$(head -n 1 own | cut -d' ' -f1-2)" "iftty $name"
    expect 0 "$iftty" help "$name"
    tail -n "$(wc -l <own)" out | cmp -s - own || fail "help $name: $(cat out)"
done <programs
expect 0 "$iftty" help run # a command as well
same "$(sed -n 1p out)" "run [for=QUESTION]"
out_has "iftty run FILE|-"
expect_err "there is no command or program verfy; did you mean verify?" 2 "$iftty" help verfy

begin "--version names libraries, also those of the helpers, and each helper that is missing"
expect 0 "$iftty" --version </dev/null
for line in 'iftty [0-9.]*' 'journal semantics [0-9]*' \
    'OpenEXR [0-9.]*, zlib [0-9.]*, libdeflate [0-9.]*, nettle [0-9.]*' \
    'iftty-image: OpenImageIO [0-9.]*, OpenEXR [0-9.]*' \
    'iftty-volume: ITK [0-9.]*, GDCM [0-9.]*, HDF5 [0-9.]*, libtiff [0-9.]*, expat [0-9.]*, '\
'zlib [0-9.]*' \
    'iftty-register: ITK [0-9.]*'; do
    grep -qx "$line" "$work/out" || fail "no line $line" "$(cat "$work/out")"
done
same "$(wc -l <"$work/out")" 6
mkdir "$work/without"
cp "$iftty" "$work/without/iftty"
printf '#!/bin/sh\necho versions 4000\n' >"$work/without/iftty-volume"
chmod +x "$work/without/iftty-volume"
expect 0 "$work/without/iftty" --version </dev/null
out_has "iftty-image: missing; the package iftty-image has it"
out_has "iftty-volume: no answer: it is of another version, or broken"
out_has "iftty-register: missing; the package iftty-volume has it"
same "$(wc -l <"$work/out")" 6

# Try each option with every program that does not have it.
begin "an option that a program does not have is bad usage"
while read -r name; do "$iftty" "$name" --help; done <programs >help
"$iftty" --help >>help
sed -n 's/^    \(--*[a-z-]*\).*/\1/p' help | sort -u >options
sed -n 's/^iftty \([a-z].*\)/\1/p' help | tr -d "'[]" | tr '|' ' ' >usages
tried=0
while read -r usage; do
    own=$("$iftty" ${usage%% *} --help </dev/null | tr -d "'[]" | tr '|' ' ' |
        sed -n "/^iftty $usage\$/,/^\$/p"
    sed -n "s/^${usage%% *} -/    -/p" usages) # other forms
    while read -r option; do
        case "$own " in *"    $option"[!a-z-]*) continue ;; esac
        expect_err "has no option" 2 "$iftty" $usage "$option" 1 </dev/null
        [ ! -s out ] || fail "$usage $option printed something"
        tried=$((tried + 1))
    done <options
done <usages
[ "$tried" -gt 300 ] || fail "only $tried were tried"

begin "a fresh journal replays and verifies"
expect_out "ok 1 - j.iftty (13 commands, 13 results with " 0 "$iftty" verify j.iftty
out_has "# 1 verified, 0 failed"
expect 0 "$iftty" replay j.iftty
acks | cmp -s - canonical || fail "$(acks | diff - canonical)"
out_has "13 commands replayed, 13 results the same"
expect_in / 0 "$iftty" verify "$work/j.iftty" # the scene lies beside it

begin "resuming continues, and the parts are equal to the whole"
sed '8,$d' script >part1
sed '1,7d' script >part2
expect 0 "$iftty" run part1 --journal r.iftty
expect 0 "$iftty" run part2 --journal r.iftty
same "$(sed -n 1p out | cut -d' ' -f1-3)" "ok 6 run"
same_files r.iftty j.iftty # chain and all
expect 0 "$iftty" verify r.iftty
expect 0 "$iftty" run - --journal r.iftty </dev/null
same_files r.iftty j.iftty

begin "a journal is a script, and a script becomes a journal"
mkdir again
cp s.nii again
expect_in again 0 "$iftty" run ../j.iftty --journal j.iftty
same_files again/j.iftty j.iftty
expect 0 "$iftty" log --script j.iftty
cp out again/script
expect_in again 0 "$iftty" run script --journal k.iftty
same "$(last_word chain again/k.iftty)" "$(last_word chain j.iftty)"
expect 0 "$iftty" replay plain
expect_out "this is a script, not a journal" 1 "$iftty" verify plain

begin "one writer at a time"
"$iftty" run pipe --journal j.iftty >writer.out 2>&1 &
writer=$!
exec 3>pipe
echo info >&3
comes_true has_line writer.out '^ok'
expect_err "being written by another session" 3 "$iftty" run - --journal j.iftty </dev/null
exec 3>&-
wait "$writer" || fail "the first writer: $(cat writer.out)"
expect 0 "$iftty" run - --journal j.iftty </dev/null

# ---- edited journals ----

# changed NAME SED-SCRIPT TEXT: edit the journal; the failure contains the text
changed() {
    sed "$2" j.iftty >t.iftty
    ! cmp -s t.iftty j.iftty || fail "$1: nothing was changed"
    rm -rf t.golden
    cp -r j.golden t.golden
    expect 1 "$iftty" replay t.iftty
    expect_out "not ok 1 - t.iftty" 1 "$iftty" verify t.iftty
    out_has "$3"
    same "$(wc -l <err)" 1
}

begin "a changed coordinate is found, with its record"
changed coordinate 's/^seed 2,3,4 1$/seed 3,3,4 1/' \
    "record 3, line 8: its chain digest does not fit"
out_has "record 6, line 14: the first command whose result differs" "command  run" "differs  forest"
changed "another label" 's/^label 2 ball/label 2 bell/' "record 2, line 5: its chain"

begin "verify --json prints one object with the content of TAP"
expect 1 "$iftty" verify j.iftty t.iftty --json
"$PYTHON" -B - out >found 2>&1 <<'EOP' || fail "$(cat found)"
import json, sys
report = json.load(open(sys.argv[1]))
assert (report["verified"], report["failed"]) == (1, 1), report
good, bad = report["journals"]
assert good["journal"] == "j.iftty" and good["verified"] and good["commands"] == 13, good
assert bad["journal"] == "t.iftty" and not bad["verified"] and bad["kind"] == "check failed", bad
EOP

begin "a changed digit of a digest or a chain, a comment, a record taken out or twice: found"
digest=$(sed -n 's/^= 6 forest=\([0-9a-f]*\) .*/\1/p' j.iftty)
digit=$(printf %s "$digest" | cut -c 1 | tr 0-9a-f 1-9a-f0)
changed digest "s/^= 6 forest=./= 6 forest=$digit/" "record 6, line 14"
out_has "expected $digit" "actual   $digest"
digit=$(last_word chain j.iftty | cut -c 32 | tr 0-9a-f 1-9a-f0)
changed chain "\$s/.\$/$digit/" "record 13, line"
out_has "chain digest does not fit"
changed comment 's/^# two seeds/# ten seeds/' "record 1, line 3"
changed "record out" '/^view 30 20/{N;d;}' "record 8"
changed "record twice" '/^view 30 20/{N;p;}' "record 9"

begin "a golden image that differs is found, with its pixel; evidence is left below --out alone"
cp -r j.golden kept.golden
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,8 2 radius=1; seed 20,10,8 3
    run; size 40 30; view 31 20; golden first' \
    --journal other.iftty
cp other.golden/first.exr j.golden/first.exr
others() { listing . | grep -vE ' ./(out|err|before|evidence)(/|$)'; }
others >before
expect_out "golden image first: " 1 "$iftty" verify j.iftty --out evidence
grep -qE 'first column [0-9]+, row [0-9]+: (colour|depth|label|voxel) is' out ||
    fail "no pixel: $(cat out)"
out_has "record 10, line"
can_limit_memory &&
    same "$(ls evidence | tr '\n' ' ')" "j.iftty.first.actual.exr j.iftty.first.difference.png "
others | grep -v '^./evidence$' | diff before - >err || fail "$(cat err)"
expect 0 "$iftty" replay j.iftty # which does not look at golden images

begin "so is one that is damaged, cut or missing; of several journals the worst counts"
cp kept.golden/first.exr j.golden/first.exr
flip_byte j.golden/first.exr $(($(file_bytes j.golden/first.exr) - 40))
expect_out "golden image first" 1 "$iftty" verify j.iftty
head -c 500 kept.golden/first.exr >j.golden/first.exr
expect_out "golden image first" 1 "$iftty" verify j.iftty
: >j.golden/first.exr
expect 1 "$iftty" verify j.iftty
rm j.golden/first.exr
expect_out "golden image first is missing" 1 "$iftty" verify j.iftty
[ ! -e j.golden/first.exr ] || fail "verify has made it"
cp kept.golden/first.exr j.golden/first.exr
expect 1 "$iftty" verify j.iftty t.iftty j.iftty
same "$(grep -o '^[a-z ]*ok [1-3] - [a-z]*.iftty' out | tr '\n' ';')" \
    "ok 1 - j.iftty;not ok 2 - t.iftty;ok 3 - j.iftty;"
out_has "# 2 verified, 1 failed"

# ---- files ----

begin "no file is overwritten without replace=yes"
start='open s.nii; seed 2,3,4 1; seed 6,10,8 2; run'
expect_out "wrote l.nii.gz" 0 "$iftty" -c "$start; save labels l.nii.gz; render p.exr; render p.png"
cp l.nii.gz l.kept && cp p.exr p.kept && cp p.png q.kept
other='open s.nii; seed 2,3,4 3; run'
for command in "save labels l.nii.gz" "save labels l.nii.gz replace=no" \
    "render p.exr" "render p.png"; do
    refuses "exists already and was left alone; replace=yes overwrites it" "$other; $command"
done
same_files l.nii.gz l.kept && same_files p.exr p.kept && same_files p.png q.kept
expect 0 "$iftty" -c "$other; save labels l.nii.gz replace=yes; render p.exr replace=yes"
! cmp -s l.nii.gz l.kept || fail "replace=yes has replaced nothing"
! cmp -s p.exr p.kept || fail "replace=yes has replaced nothing"
[ -z "$(ls -A | grep '^[.]iftty-')" ] || fail "drafts are left: $(ls -A | grep '^[.]iftty-')"

begin "saved maps are scenes of the same size"
expect 0 "$iftty" -c "$start; save cost c.nii; save root o.nii.gz; save border b.nii"
same "$(file_bytes c.nii)" $((352 + 24 * 20 * 16 * 2))
same "$(file_bytes b.nii)" $((352 + 24 * 20 * 16))
expect_out "24x20x16 voxels of 1x1x1 mm" 0 "$iftty" -c 'open l.nii.gz; info'
expect 0 "$iftty" -c 'open c.nii'

begin "a replay writes only into --out, or into a new folder"
mkdir w
cp s.nii w
expect_in w 0 "$iftty" -c "$start; render p.exr; save labels l.nii; save cost sub.nii" \
    --journal w.iftty
cp w/p.exr p.first && cp w/l.nii l.first
rm w/p.exr w/l.nii w/sub.nii
listing w >before
mkdir fresh
expect_err "# files are in $work/fresh/iftty-" 0 env TMPDIR="$work/fresh" "$iftty" replay w/w.iftty
same_files fresh/iftty-*/l.nii l.first
same "$(ls fresh | wc -l)" 1
rm -r fresh/*
expect 0 env TMPDIR="$work/fresh" "$iftty" replay j.iftty # which writes no file
[ ! -s err ] && [ -z "$(ls fresh)" ] || fail "it leaves $(ls fresh): $(cat err)"
expect 0 "$iftty" verify w/w.iftty
expect_in w 0 "$iftty" verify w.iftty
expect_in w 0 "$iftty" run - --journal w.iftty </dev/null
listing w | diff before - >d || fail "$(cat d)"
expect 0 "$iftty" replay w/w.iftty --out made
same "$(ls made | tr '\n' ' ')" "l.nii p.exr sub.nii "
same_files made/l.nii l.first
listing w | diff before - >d || fail "$(cat d)"

begin "a journal that names files elsewhere verifies, and writes them below --out alone"
mkdir -p spread/here spread/a spread/b
cp s.nii spread/here
expect_in spread/here 0 "$iftty" -c "open s.nii; seed 1,1,1 1; run; save labels ../lab.nii.gz
    save labels $work/spread/abs.nii; save cost ../a/lab.nii.gz; render ../b/abs.nii.png
    save labels ../lab.nii.gz replace=yes; save labels lab-2.nii.gz" --journal own.iftty
listing spread >before
expect_in spread/here 0 "$iftty" verify own.iftty
expect_in / 0 "$iftty" verify "$work/spread/here/own.iftty"
expect_out "9 results the same" 0 "$iftty" replay spread/here/own.iftty --out mapped
same "$(ls mapped | tr '\n' ' ')" "abs.nii abs.nii.png lab-2-2.nii.gz lab-2.nii.gz lab.nii.gz "
same_files mapped/lab.nii.gz spread/lab.nii.gz
same_files mapped/lab-2.nii.gz spread/a/lab.nii.gz
same_files mapped/lab-2-2.nii.gz spread/here/lab-2.nii.gz
same_files mapped/abs.nii spread/abs.nii
listing spread | diff before - >d || fail "$(cat d)"

begin "files that were read from elsewhere are looked for by name"
expect_in spread/here 0 "$iftty" -c 'open s.nii; mask ../abs.nii; seed 1,1,1 1; run' \
    --journal r.iftty
expect 3 "$iftty" verify spread/here/r.iftty
out_has "the journal may not read ../abs.nii: there is no file abs.nii next to the journal or among"
expect 0 env IFTTY_SCENES="$work/spread" "$iftty" verify spread/here/r.iftty

begin "a hostile journal writes below --out alone"
mkdir -p made2 fresh2
echo precious >precious
ln -s ../precious made2/link.png
ln -s .. made2/up
listing . | grep -vE ' ./(out|err|d|before)$' >before
for name in .. . ../.. a/.. link.png /etc/link.png up "$work/made2/up" ../up/; do
    printf 'open s.nii\nseed 1,1,1 1\nrender %s replace=yes\n' "$name" >evil
    expect 3 "$iftty" replay evil --out made2
done
rm evil
listing . | grep -vE ' ./(out|err|d|before)$' | diff before - >d || fail "$(cat d)"
for name in "$work/evil.png" ../evil.exr a/../../evil.tif /dev/evil.jpg up/evil.gif; do
    printf 'open s.nii\nseed 1,1,1 1\nrender %s\n' "$name" >evil
    expect 0 env TMPDIR="$work/fresh2" "$iftty" replay evil
    expect 0 "$iftty" replay evil --out made2
done
same "$(ls made2 | tr '\n' ' ')" "evil.exr evil.gif evil.jpg evil.png evil.tif link.png up "
same "$(cat precious)" precious
[ ! -e evil.png ] && [ ! -e ../evil.exr ] && [ ! -e evil.gif ] || fail "it has written elsewhere"

begin "a session that wrote files elsewhere can be continued"
expect 0 "$iftty" -c "$start; render $work/mine.exr" --journal mine.iftty
expect_out "ok 6 seed 1,1,1 1" 0 "$iftty" -c "seed 1,1,1 1; run" --journal mine.iftty

begin "an acknowledgement has the number of the record, or states that the command has none"
expect 0 "$iftty" -c "open synth:geom:20x20x20; info; seed 1,1,1 1; measure 1,1,1 2,2,2
    run; undo" \
    --journal numbers.iftty
same "$(sed -n 's/^ok \([-0-9]* [a-z]*\).*/\1/p' out | tr '\n' ';')" \
    "1 open;- info;2 seed;- measure;3 run;4 undo;"
out_has "    undone: 3 run"
expect 0 "$iftty" -c "info; seed 2,2,2 1" --journal numbers.iftty
same "$(sed -n 's/^ok \([-0-9]* [a-z]*\).*/\1/p' out | tr '\n' ';')" "- info;5 seed;"

begin "run --out writes there, also when resumed"
expect_out "wrote there/p.exr" 0 "$iftty" -c "$start; render p.exr" --journal o.iftty --out there
cp there/p.exr o.kept
expect 0 "$iftty" -c "render q.exr" --journal o.iftty --out there
same "$(ls there | tr '\n' ' ')" "p.exr q.exr "
same_files there/p.exr o.kept

begin "a scene in a folder further up is found when it is named"
mkdir -p up/scenes up/here
cp s.nii up/scenes
expect_in up/here 0 "$iftty" -c "open ../scenes/s.nii; seed 1,1,1 1; run" --journal u.iftty
expect_in up/here 0 "$iftty" run - --journal u.iftty </dev/null # one's own goes on
expect 0 "$iftty" verify up/here/u.iftty
mv up/scenes up/away
expect 3 "$iftty" verify up/here/u.iftty
out_has "the scene of this record is not at ../scenes/s.nii: there is no scene s.nii next to the"
out_has "expected --scene FILE"
expect_err "expected --scene FILE" 3 "$iftty" run - --journal up/here/u.iftty </dev/null
mv up/away up/scenes
expect_in / 0 "$iftty" verify "$work/up/here/u.iftty" --scene "$work/s.nii"

begin "a record names files relative to its journal, for any current folder"
mkdir -p far/out far/subj far/maps
cp s.nii far/subj/b.nii
cp s.nii far/maps/m.nii
printf '1,1,1,2\n' >far/maps/p.csv
names_of() { # JOURNAL: the names of files in it
    sed -n 's/^\(open\|mask\|weight\|seed-file\) \([^ ]*\).*/\2/p' "$1" | tr '\n' ' '
}
commands='mask maps/m.nii; weight maps/m.nii; mask none; weight morph'
expect_in far 0 "$iftty" -c "open subj/b.nii; $commands; seed 1,1,1 1; run" --journal out/s.iftty
same "$(names_of far/out/s.iftty)" "../subj/b.nii ../maps/m.nii ../maps/m.nii none morph "
expect 0 "$iftty" run - --journal far/out/s.iftty </dev/null
expect_in / 0 "$iftty" run - --journal "$work/far/out/s.iftty" </dev/null
expect_in far/maps 0 "$iftty" -c "mask m.nii; mask ../maps/./m.nii" --journal ../out/s.iftty
expect_in far/subj 0 "$iftty" -c "mask ./../maps/m.nii" --journal "$work/far/out/s.iftty"
same "$(names_of far/out/s.iftty)" "../subj/b.nii ../maps/m.nii ../maps/m.nii none morph \
../maps/m.nii ../maps/./m.nii ./../maps/m.nii " # found beside it, they stay as they were typed
expect_in / 0 "$iftty" run - --journal "$work/far/out/s.iftty" </dev/null
expect_in far 0 "$iftty" -c 'open subj/b.nii' --journal one.iftty # beside it, as it was typed
expect_in far 0 "$iftty" -c "open $work/far/subj/b.nii" --journal two.iftty
expect_in far/out 0 "$iftty" -c 'open raw:../subj/b.nii size=2,2,2 type=uint8' \
    --journal ../subj/three.iftty
ln -s "$work/far/out" linked
expect_in far/subj 0 "$iftty" -c 'open b.nii' --journal "$work/linked/four.iftty"
same "$(names_of far/one.iftty)$(names_of far/two.iftty)$(names_of far/subj/three.iftty)" \
    "subj/b.nii $work/far/subj/b.nii raw:../subj/b.nii "
same "$(names_of far/out/four.iftty)" "../subj/b.nii "
expect 3 "$iftty" verify far/out/s.iftty # maps of strangers are read below the folder alone
out_has "no file m.nii next to the journal or among the scenes (\$IFTTY_SCENES names their folders)"
expect 0 env IFTTY_SCENES="$work/far/maps" "$iftty" verify far/out/s.iftty
expect 0 "$iftty" verify far/one.iftty far/two.iftty far/out/four.iftty linked/four.iftty
cp s.nii far/out/s.nii
flip_byte far/out/s.nii 1000
expect 3 "$iftty" -c 'open s.nii' --journal far/out/five.iftty
err_has "there are two files s.nii, here and next to the journal; expected the whole path"
rm -r far linked

begin "~/ is the home folder in every command, and records do not depend on it"
mkdir -p home/data home/out
cp s.nii home/data/h.nii
cp s.nii home/data/m.nii
HOME=$work/home
export HOME
expect_in home/out 0 "$iftty" -c 'open ~/data/h.nii; mask ~/data/m.nii; seed 1,1,1 1; run
    save labels ~/l.nii; slice axial 1 ~/p.png; stats report=~/r.csv; save names ~/n.txt' \
    --journal h.iftty
same "$(ls home | tr '\n' ' ')" "data l.nii n.txt out p.png r.csv "
same "$(sed -n 's/^\(open\|mask\) \([^ ]*\).*/\2/p' home/out/h.iftty | tr '\n' ' ')" \
    "../data/h.nii ../data/m.nii "
expect_in / 0 env HOME=/nowhere "$iftty" run - --journal "$work/home/out/h.iftty" </dev/null
expect 0 "$iftty" -c 'open ~/data/h.nii' # without a journal, and with one that is begun later
expect 0 "$iftty" -c 'journal ~/later.iftty; open ~/data/h.nii'
expect 0 "$iftty" verify home/later.iftty
expect_err "there is no scene $work/home/none.nii here" 3 "$iftty" -c 'open ~/none.nii'
mkdir '~' && cp s.nii '~/own.nii' # a folder of that name is ./~
expect 0 "$iftty" -c 'open ./~/own.nii; seed 1,1,1 1' --journal own.iftty
expect 0 "$iftty" verify own.iftty
printf 'open ~/data/h.nii\n' >stranger
expect_out "the journal may not open ~/data/h.nii" 3 "$iftty" verify stranger
out_has "expected --scene FILE"
cp s.nii h.nii
expect 0 "$iftty" replay stranger # by the last part of the name, as a whole path
rm -r home '~' h.nii stranger own.iftty
unset HOME

begin "--scene opens another file under the name that is written"
mkdir moved
cp j.iftty moved && cp -r j.golden moved
mv s.nii elsewhere.nii
expect_in moved 3 "$iftty" verify j.iftty
expect_in moved 0 "$iftty" verify j.iftty --scene ../elsewhere.nii
mkdir moved/sub && cp elsewhere.nii moved/sub/s.nii
expect_in moved 0 env IFTTY_SCENES="$work/none:$work/moved/sub" "$iftty" verify j.iftty
expect_in moved 1 "$iftty" verify j.iftty --scene ../c.nii
mv elsewhere.nii s.nii

begin "comments go into the journal, and a line too long hides no command"
{
    printf 'open s.nii\n#'
    head -c 65535 /dev/zero | tr '\0' ' '
    printf 'seed 1,1,1 1\nrun\n'
} >lengthy
expect 0 "$iftty" run lengthy --keep-going
same "$(acks | tr '\n' ';')" "open s.nii weight=morph;run;"
grep -q '^# two seeds in a small scene$' j.iftty || fail "the comment is lost"

# ---- results ----

digests() { # of the last edit of journal $1
    echo "$(last_word forest "$1") $(last_word labels "$1") $(last_word seeds "$1")"
}

begin "any order of seeds, in batches, by any neighbours: the same"
one='seed 2,3,4 1' two='seed 6,10,8 2 radius=2' three='seed 20,10,8 3' four='seed 20,18,3 4'
while IFS='|' read -r name commands; do
    expect 0 "$iftty" -c "open s.nii; $commands" --journal "$name.iftty" </dev/null
done <<END
one-run|$one; $two; $three; $four; run
other-order|$four; $two; $one; $three; run
batches|$three; run; $one; run; $two; $four; run
auto|auto on; $two; seed 9,9,9 7; $four; remove 9,9,9; $three; $one
three-seeds|$one; $two; $three; run
switched-to-26|$one; $two; $three; $four; run; adjacency 26; render
begun-with-26|adjacency 26; $one; $two; $three; $four; run
END
for other in other-order batches auto; do
    same "$other: $(digests $other.iftty)" "$other: $(digests one-run.iftty)"
done
for other in three-seeds switched-to-26; do
    [ "$(digests $other.iftty)" != "$(digests one-run.iftty)" ] || fail "$other gives the same"
done
same "$(digests begun-with-26.iftty)" "$(digests switched-to-26.iftty)"
expect 0 "$iftty" verify switched-to-26.iftty
expect 0 "$iftty" -c "adjacency 6" --journal switched-to-26.iftty
same "$(digests switched-to-26.iftty)" "$(digests one-run.iftty)"

begin "four ways to render give the same picture, also after an edit"
in_modes() { # MODE...
    for mode; do echo "render mode=$mode"; done
}
{
    echo "$start; size 60 50" | tr ';' '\n'
    for view in front "30 20 10" "45 45"; do
        echo "view $view"
        in_modes sp bp ii ray
    done
    echo "seed 12,4,4 3"
    in_modes ii sp bp ray # the first one updates the picture
} >modes
expect 0 "$iftty" run modes --journal modes.iftty
same "$(sed -n 's/.*picture=\([0-9a-f]*\).*/\1/p' modes.iftty | uniq -c |
    awk '{ print $1 }' | xargs)" "4 4 4 4"

begin "the synthetic scene: one run, replayed, in another order"
expect 0 "$iftty" -c "open synth:geom; seed 100,100,50 1 radius=2; seed 10,10,10 2; run
    size 200 200; golden g" --journal g1.iftty
expect 0 "$iftty" verify g1.iftty
expect 0 "$iftty" -c "open synth:geom; seed 10,10,10 2; auto on; seed 100,100,50 1 radius=2
    size 200 200; render mode=ray" --journal g2.iftty
same "$(digests g2.iftty)" "$(digests g1.iftty)"
same "$(last_word picture g2.iftty)" "$(last_word picture g1.iftty)"

begin "info draws the histogram of a scene, and counts each voxel once"
make_scene "$work/h.nii" 20 18 16
expect_out "histogram |" 0 "$iftty" info "$work/h.nii" --histogram
out_has "values 12 to 122; "
expect 0 "$iftty" info "$work/h.nii" --histogram --json
sum=$(sed 's/.*"below"//' "$work/out" | tr -c '0-9' '\n' | awk '{ sum += $1 } END { print sum }')
same "$sum" $((20 * 18 * 16))
expect 0 "$iftty" info "$work/h.nii"
! grep -q histogram "$work/out" || fail "a histogram that nobody asked for"

ch2=/usr/share/mricron/templates/ch2.nii.gz
begin "a brain: found by its name alone, replayed from elsewhere"
if [ -r "$ch2" ]; then
    expect 0 "$iftty" -c 'open ch2.nii.gz; seed 90,108,90 1; seed 2,2,2 0; run' --journal ch2.iftty
    mkdir far && cp ch2.iftty far
    expect 0 "$iftty" verify far/ch2.iftty
else
    skip "mricron-data is not installed"
fi

finish
