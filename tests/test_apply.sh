#!/bin/sh
# SPDX-License-Identifier: MIT
# A procedure applied to other scenes by the program: landmarks, transforms, planted and dropped
# seeds, existing journals, untrusted files, and errors.
. "$(dirname "$0")/lib.sh"
phantom="$PYTHON $top/tests/apply/phantom.py"
$phantom scenes plain moved mirrored coarse oblique other far
seeds='seed 28,28,24 1 radius=5; seed 48,33,24 2 radius=2; seed 5,5,5 0 radius=2'
marks='landmark A 28,28,24; landmark B 48,33,24; landmark C 28,42,30; landmark D 20,28,38'
names="label 1 large #ff0000 code=SCT:5:large; label 2 'the small one'; label 0 air"
expect 0 "$iftty" -c "open plain.nii; $names; $marks; $seeds; box 0,0,0 63,55,1 0; run" \
    --journal p.iftty
# apply SCENE...: into $work/o, which is new
apply() {
    rm -rf o
    expect 0 "$iftty" apply p.iftty "$@" --out o
}

begin "landmarks are recorded, listed, moved, removed and undone"
expect 2 "$iftty" -c "open synth:geom; landmark AC 9,8,7; landmark PC 1,2,3; landmark AC 9,9,9; info
landmark AC none; info; undo; info; landmark XX none" --journal l.iftty --keep-going
same "$(grep '^ *landmarks' out)" "    landmarks AC 9,9,9, PC 1,2,3
    landmarks PC 1,2,3
    landmarks AC 9,9,9, PC 1,2,3"
err_has "there is no landmark XX"
expect 2 "$iftty" -c "open synth:geom; landmark A 1,1,1; interpolate 2 2 2"
err_has "landmarks belong to the present grid"
expect_err "NAME: expected a word" 2 "$iftty" -c "open synth:geom; landmark 'a b' 1,1,1"
expect 0 "$iftty" verify l.iftty

begin "an origin is recorded, shown and undone, changes no voxel, and is checked"
chain=74120d6c3f0cc54e2237dc0bced98ab5
expect 0 "$iftty" -c "open plain.nii; $seeds; run; origin $chain by=file as=seeds volumes=1:9,2:8
info; undo; origin $chain; origin none; info" --journal m.iftty
out_has "origin    procedure $chain, by file, as seeds"
same "$(grep -c '^ *origin ' out)" 1
of_run=$(sed -n 's/^= 5 .*forest=\([0-9a-f]*\).*/\1/p' m.iftty)
same "$(last_word forest m.iftty)" "$of_run"
for words in xyz "$chain digest=12" "$chain pull=1,2,3" "$chain volumes=2:1,1:1" \
    "$chain dropped=1:9/8" "$chain by=guess"; do
    expect 2 "$iftty" -c "open synth:geom; origin $words"
done

begin "a procedure's file has all that apply needs, and no image, file name or comment"
printf '# John Doe, born 1950\nopen plain.nii\n# he said ouch\n' >q.txt
sed -n '/^label/p; /^landmark/p; /^seed/p; /^box/p; /^run/p' p.iftty >>q.txt
expect 0 "$iftty" run q.txt --journal q.iftty
expect 0 "$iftty" log --procedure q.proc q.iftty
grep -qiE 'plain|nii|doe|ouch|1950|/' q.proc && fail "$(grep -iE 'plain|nii|doe|ouch' q.proc)"
grep -q '^label 2 #.* the small one$' q.proc || fail "$(grep ^label q.proc)"
same "$(grep -c ^gesture q.proc)" 3
same "$(grep ^landmark q.proc | head -1)" "landmark A 0 0 0"
expect 3 "$iftty" log --procedure q.proc q.iftty
expect 0 "$iftty" log --procedure - q.iftty
same_files out q.proc

begin "labels are placed correctly on grids that are moved, mirrored, coarse, oblique"
for where in plain moved mirrored coarse oblique; do
    apply $where.nii --by world
    expect 0 $phantom check o/$where.seeds.nii.gz $where 7 2.2
    expect 0 "$iftty" verify o/$where.iftty
    grep -qx 'label 1 large #ff0000 code=SCT:5:large' o/$where.iftty || fail "it has no code"
done

begin "parts that belong to the expert's scene are not carried over, and each is named"
expect 0 "$iftty" -c "open plain.nii; weight plain.nii; mask plain.nii regions=1-255; range 0 300
    $seeds; box 0,0,0 63,55,1 0; outline 24,24,24 1 to=32,24,24 to=32,32,24 to=24,32,24; run" \
    --journal left.iftty
expect 0 "$iftty" apply left.iftty plain.nii --by world --as seeds --out left
out_has "not carried over: its map of weights, its mask, its range, 2 gestures that are no ball"
expect 0 "$iftty" log --procedure left.proc left.iftty
same "$(grep ^left left.proc)" "left 1 1 1 2"
expect 0 "$iftty" apply left.proc moved.nii --by world --out left
out_has "not carried over: its map of weights, its mask, its range"

begin "the journal and the procedure's file yield the same bytes"
expect 0 "$iftty" log --procedure p.proc p.iftty
for as in labels seeds; do
    rm -rf a b
    expect 0 "$iftty" apply p.iftty oblique.nii --by world --as $as --out a
    expect 0 "$iftty" apply p.proc oblique.nii --by world --as $as --out b
    same_files a/oblique.iftty b/oblique.iftty
    [ $as = seeds ] || same_files a/oblique.seeds.nii.gz b/oblique.seeds.nii.gz
done

begin "gestures themselves are moved, with their radii, and verify"
apply mirrored.nii --by world --as seeds
grep -qx 'seed 24,27,35 1 radius=5mm range=.*' o/mirrored.iftty || fail "$(grep ^seed o/*.iftty)"
grep -q '^seed 24,22,15 2 radius=2mm' o/mirrored.iftty || fail "$(grep ^seed o/*.iftty)"
expect 0 "$iftty" verify o/mirrored.iftty

begin "exact gestures stay exact, and over= is evaluated in the other scene"
expect 0 "$iftty" -c "open plain.nii; $seeds; run; seed 20,28,24 2 radius=2 within=0
seed 28,34,24 2 radius=2 within=0 over=1; seed 30,28,28 2 radius=1 over=1" --journal e.iftty
expect 0 "$iftty" log --procedure e.proc e.iftty
same "$(sed -n '/^gesture/p' e.proc | tail -3)" "gesture 2 2 -1 75 -8 0 0
gesture 2 2 -1 80 over=1 0 6 0
gesture 2 1 0 81 over=1 2 0 4"
for procedure in e.iftty e.proc; do
    rm -rf o
    expect 0 "$iftty" apply $procedure mirrored.nii --by world --as seeds --out o
    grep -qx 'seed 24,27,43 2 radius=2mm range=[^ ]* within=0' o/mirrored.iftty || fail
    grep -qx 'seed 24,21,35 2 radius=2mm range=[^ ]* within=0 over=1' o/mirrored.iftty || fail
    grep -qx 'seed 28,27,33 2 radius=1mm range=[^ ]* over=1' o/mirrored.iftty || fail
    expect 0 "$iftty" verify o/mirrored.iftty
done

begin "removed, undone and covered gestures are left out; a stroke has its corners"
expect 0 "$iftty" -c "open plain.nii; seed 9,9,9 0 radius=1; seed 20,28,24 1; remove 20,28,24
seed 22,28,24 1; undo; seed 30,28,24 1 radius=2; seed 30,28,24 2 radius=2
seed 24,28,24 1 to=28,30,24 to=28,34,24 radius=1.5mm; seed 28,24,24 1 within=9mm; run" \
    --journal g.iftty
mkdir -p moved_away && mv g.iftty moved_away/g.iftty
expect 3 "$iftty" log --procedure - moved_away/g.iftty
expect 0 "$iftty" log --procedure - moved_away/g.iftty --scene plain.nii
same "$(grep ^gesture out)" "gesture 0 1 0 20 -19 -19 -15
gesture 2 2 0 81 2 0 0
gesture 1 1.5 0 78 -4 0 0 0 2 0 0 6 0
gesture 1 0 9 80 0 -4 0"

begin "landmarks: rigid, similarity or affine, with the residual"
# the places in other.nii that the pull of phantom.py maps to those of p.iftty
"$PYTHON" - >marks.txt <<'END'
import math
c, s = math.cos(0.4), math.sin(0.4)
for name, at in (("A", (0, 0, 0)), ("B", (20, 5, 0)), ("C", (0, 14, 6)), ("D", (-8, 0, 14))):
    x, y, z = at[0] + 4, at[1] - 2, at[2] - 1
    print("%s %.6f,%.6f,%.6f" % (name, 1.2 * (c * x - s * y), 1.2 * (s * x + c * y), 1.2 * z))
END
for fit in similarity affine; do
    apply other.nii --by landmarks --landmarks marks.txt --fit $fit
    out_has "$fit by 4 landmarks, off by 0.00 mm"
    expect 0 $phantom check o/other.seeds.nii.gz other 7.8 2.8
done
grep -q '^landmark A ' o/other.iftty || fail "no landmark in the journal"
apply other.nii --by landmarks --landmarks marks.txt --fit rigid
out_has "rigid by 4 landmarks, off by 2."
grep -q ' rms=2\.' o/other.iftty || fail "$(grep ^origin o/other.iftty)"
expect 0 "$iftty" verify o/other.iftty
head -2 marks.txt >few.txt
expect 3 "$iftty" apply p.iftty other.nii --by landmarks --landmarks few.txt --out o2
[ ! -e o2 ] || fail "a folder is left"
err_has "2 landmarks of the subject are in the procedure too (2 and 4), and 3 are needed"
sed 's/A /A x/' marks.txt >bad.txt
expect 3 "$iftty" apply p.iftty other.nii --by landmarks --landmarks bad.txt --out o2
err_has "bad.txt, line 1: expected NAME X,Y,Z in millimetres, each name once"
expect 2 "$iftty" apply p.iftty other.nii --by landmarks --out o2
err_has "--by landmarks: name the subject's landmarks by --landmarks FILE: lines NAME X,Y,Z in"

begin "the subject's landmarks may come from a journal"
marked="landmark A 33,26,27; landmark B 53,31,27; landmark C 33,40,33"
expect 0 "$iftty" -c "open moved.nii; $marked" --journal s.iftty
apply moved.nii --by landmarks --landmarks s.iftty
expect 0 $phantom check o/moved.seeds.nii.gz moved 7 2.2

begin "a transform of ITK"
cat >shift.txt <<'END'
#Insight Transform File V1.0
#Transform 0
Transform: AffineTransform_double_3_3
Parameters: 1 0 0 0 1 0 0 0 1 500 0 0
FixedParameters: 0 0 0
END
cp moved.nii away.nii
put away.nii 292 '\000\200\351\103' # its sform: 467 in place of -33
apply away.nii --by shift.txt
expect 0 "$iftty" verify o/away.iftty
expect_err "the scenes do not overlap" 3 "$iftty" apply p.iftty far.nii --by world --out o
expect_err "nothere.txt" 3 "$iftty" apply p.iftty moved.nii --by nothere.txt --out o

begin "seeds with an intensity unlike the object's are dropped, counted, and kept as dropped"
$phantom make lesion.nii moved lesion
apply lesion.nii --by world
grep -q ' dropped=.*1:2[0-9][0-9]/' o/lesion.iftty || fail "$(grep ^origin o/lesion.iftty)"
$phantom check o/lesion.seeds.nii.gz moved 7 2.2 | grep -q ' 257:2[0-9][0-9]' || fail "no drops"
out_has "large"
expect 0 "$iftty" verify o/lesion.iftty

begin "labels far from where they were carried, and labels of a wrong volume, are all marked"
advice() { sed -n "s,^ *$1 .* \([0-9]*\.[0-9]*\) *\(look here.*\)*$,\1 \2,p" out; } # LABEL
expect 0 "$iftty" -c "save labels from.nii" --journal p.iftty --read-only
$phantom make bad.nii moved
apply bad.nii --by world
same "$(advice 1), $(advice 2)" "0.00 , 0.00 look here first"
$phantom make bad.nii moved leak
apply bad.nii --by world
leaks="$(advice 1), $(advice 2)"
expect 0 "$iftty" -c "save labels to.nii" --journal o/bad.iftty --read-only
far=$(python3 - <<'END'
from struct import unpack
def voxels(name, x, y, z): # of label 1, of a grid that is elsewhere by whole millimetres
    with open(name, "rb") as file:
        data = file.read()
    size, begin = unpack("<3h", data[42:48]), int(*unpack("<f", data[108:112]))
    return {(i % size[0] + x, i // size[0] % size[1] + y, i // size[0] // size[1] + z)
            for i, value in enumerate(data[begin:]) if value == 1}
there, here = voxels("from.nii", -28, -28, -24), voxels("to.nii", -33, -26, -27)
near = [(x, y, z) for x in range(-5, 6) for y in range(-5, 6) for z in range(-5, 6)
        if x * x + y * y + z * z <= 25]
print("%.2f" % (sum(all((x + a, y + b, z + c) not in there for a, b, c in near)
                    for x, y, z in here - there) / 1000))
END
)
same "$leaks" "$far look here, 0.00 "
[ "$far" != 0.00 ] || fail "there is no leak"
$phantom make bad.nii moved leak grown
apply bad.nii --by world
same "$(advice 1), $(advice 2)" "$far look here, 0.00 look here first"
apply bad.nii --by world --json
out_has '"far_mm3": 0.000, "bad": true'
apply moved.nii --by world --json
same "$(grep -o '"bad": [a-z]*' out | tr '\n' ' ')" '"bad": false "bad": false '

begin "finished subjects and differing files are left alone, and corrections stay"
apply moved.nii --by world
before=$(cat o/moved.iftty)
expect 0 "$iftty" apply p.iftty moved.nii --by world --out o
out_has "moved.nii: done before: o/moved.iftty"
expect 3 "$iftty" apply p.iftty moved.nii --by world --as seeds --out o
err_has "exists, and differs from the journal that would be written"
cp mirrored.nii moved2.nii && mkdir -p other && cp mirrored.nii other/moved.nii
expect 3 "$iftty" apply p.iftty other/moved.nii --by world --out o
same "$(cat o/moved.iftty)" "$before"
expect 0 "$iftty" -c "seed 9,9,9 2 radius=1; run" --journal o/moved.iftty
expect_out "done before" 0 "$iftty" apply p.iftty moved.nii --by world --out o
grep -v '^= 11' o/moved.iftty | head -c 1500 >o/cut && mv o/cut o/moved.iftty
expect 3 "$iftty" apply p.iftty moved.nii --by world --out o

begin "a subject is done if its records match, not its origin alone"
for by in world affine; do
    cp plain.nii again.nii
    apply again.nii --by $by
    [ $by = world ] || out_has "registered: overlap 100 %"
    expect 0 $phantom check o/again.seeds.nii.gz plain 7 2.2
    expect 0 "$iftty" verify o/again.iftty
    expect 0 "$iftty" apply p.iftty again.nii --by $by --out o
    out_has "again.nii: done before: o/again.iftty"
    # Another map of seeds, other seeds after it, another name: each with the origin of the other.
    origin=$(grep '^origin ' o/again.iftty)
    cp o/again.iftty real.iftty
    for change in "seed 5,5,5 1 radius=2" "label 1 another" "orient file"; do
        sed -n '/^open /,$p' real.iftty | grep -v '^=' >forged.txt
        sed "/^origin /i $change" forged.txt >forged2.txt
        rm o/again.iftty
        expect 0 "$iftty" run forged2.txt --journal o/again.iftty
        grep -qF "$origin" o/again.iftty || fail "no such origin: $origin"
        cp o/again.iftty forged.iftty
        expect 3 "$iftty" apply p.iftty again.nii --by $by --out o
        err_has "exists, and differs from the journal that would be written"
        same_files o/again.iftty forged.iftty
    done
done

begin "no other file is replaced, and after a failure no new file is left"
rm -rf o && mkdir o
echo mine >o/moved.seeds.nii.gz
expect 3 "$iftty" apply p.iftty moved.nii --by world --out o
err_has "o/moved.seeds.nii.gz exists, and is not the map of seeds that would be written"
same "$(cat o/moved.seeds.nii.gz) $(ls o)" "mine moved.seeds.nii.gz"
echo mine >elsewhere && ln -sf ../elsewhere o/moved.seeds.nii.gz
expect 3 "$iftty" apply p.iftty moved.nii --by world --out o
same "$(cat elsewhere) $(ls o)" "mine moved.seeds.nii.gz"
rm o/moved.seeds.nii.gz
expect 0 "$iftty" apply p.iftty moved.nii --by world --out o
rm o/moved.iftty # as after a kill before the end
expect 0 "$iftty" apply p.iftty moved.nii --by world --out o
expect 0 "$iftty" verify o/moved.iftty
cp -r o edited
sed -i 's/^label 1 large/label 1 small/' edited/moved.iftty
cp edited/moved.iftty torn.iftty
rm -r edited/moved.golden edited/moved.seeds.nii.gz
expect 3 "$iftty" apply p.iftty moved.nii --by world --out edited
same "$(ls edited)" moved.iftty
same_files edited/moved.iftty torn.iftty

begin "no input is overwritten, a scene or the procedure, through any link"
rm -rf o && mkdir o
nothing() { # SCENE...: status 2, and o is as it was
    ls -l o >before
    expect 2 "$iftty" apply "$@" --by world --out o
    ls -l o >after
    same_files before after
}
nothing p.iftty moved.nii o/moved.seeds.nii.gz
err_has "moved.nii would be written to o/moved.seeds.nii.gz, which is the file o/moved.seeds.nii.gz"
mkdir there && ln -s ../o there/linked
nothing p.iftty moved.nii there/linked/moved.seeds.nii.gz
ln -s o/moved.seeds.nii.gz not-yet.nii.gz
nothing p.iftty moved.nii not-yet.nii.gz
cp moved.nii real.seeds.nii.gz && ln real.seeds.nii.gz o/plain.seeds.nii.gz
nothing p.iftty moved.nii plain.nii real.seeds.nii.gz
cp p.iftty o/moved.iftty
nothing o/moved.iftty moved.nii --scene plain.nii
err_has "which is the file o/moved.iftty that is read"
rm -r o/* && cp moved.nii o/slice.nii
nothing p.iftty o
err_has "which is in the folder o that is read"

begin "a killed task leaves no journal, and the same command completes it"
rm -rf o
for tenths in 0 1 2 4; do
    "$iftty" apply p.iftty moved.nii --by world --out o >/dev/null 2>&1 &
    task=$!
    sleep "0.0$tenths"
    kill -9 $task 2>/dev/null
    wait $task 2>/dev/null
    if [ -e o/moved.iftty ]; then
        expect 0 "$iftty" verify o/moved.iftty
        rm o/moved.iftty
    fi
done
expect 0 "$iftty" apply p.iftty moved.nii --by world --out o
expect 0 "$iftty" verify o/moved.iftty
same "$(find o -name '*tmp*' | wc -l)" 0

begin "a scene behind a link, named as seen from the journal's folder; two of one name"
mkdir -p data links && cp moved.nii data/real.nii && ln -sf ../data/real.nii links/sub-01_T1w.nii
apply links/sub-01_T1w.nii --by world
grep -q '^open \.\./links/sub-01_T1w.nii ' o/sub-01_T1w.iftty || fail "$(sed -n 2p o/*.iftty)"
rm o/sub-01_T1w.seeds.nii.gz # the journal has a copy beside it, under its own name
same "$(find o -name 'labels-*' | cut -d / -f 2)" sub-01_T1w.golden
expect 0 "$iftty" verify o/sub-01_T1w.iftty
expect 2 "$iftty" apply p.iftty moved.nii other/moved.nii --by world --out o
err_has "would both be written to o/moved.iftty"

begin "unknown geometry is not guessed"
$phantom make silent.nii moved silent
expect 3 "$iftty" apply p.iftty silent.nii --by world --out o
err_has "does not say to which sides of the patient its axes run, and iftty does not guess it; " \
    "if you know the orientation for sure, give it, for example by --orient RAS"
expect 3 "$iftty" apply p.iftty silent.nii --by world --orient RAS --out o
err_has "its file does not say where it is in the world; --by landmarks needs only"
printf 'A 33,26,27\nB 53,31,27\nC 33,40,33\n' >told.txt
apply silent.nii --by landmarks --landmarks told.txt --orient RAS
expect 0 $phantom check o/silent.seeds.nii.gz moved 7 2.2
expect 0 "$iftty" -c "open silent.nii; $seeds; run" --journal silent.iftty
expect_err "does not say to which sides" 3 "$iftty" log --procedure - silent.iftty

begin "a registration without the expert's image is refused with advice"
expect 3 "$iftty" apply p.proc moved.nii --out o3
err_has "needs both scenes, and a procedure's file has no scene; use the journal with its scene"

begin "an implausible registration is refused: status 1, and no journal"
expect 1 "$iftty" apply p.iftty oblique.nii --out o3
err_has "the scenes were registered, and the result is implausible"
same "$(ls o3)" ""

begin "JSON of several scenes; one that fails keeps none of the others"
rm -rf o
expect 3 "$iftty" apply p.proc moved.nii far.nii oblique.nii --by world --out o --json
"$PYTHON" - "$work/out" <<'END' || fail "$(cat "$work/out")"
import json, sys
rows = json.load(open(sys.argv[1]))
assert [row["state"] for row in rows] == ["made", "failed", "made"], rows
assert rows[0]["labels"][0]["name"] == "large" and rows[0]["labels"][0]["seeds"] > 500
assert 0.8 < rows[0]["labels"][1]["volume_mm3"] / rows[0]["labels"][1]["expected_mm3"] < 1.3
assert len(rows[0]["pull"]) == 12 and "do not overlap" in rows[1]["why"]
END
err_has "1 of 3 scenes failed or were refused"

begin "hints begin with the label whose volume differs most from the procedure's"
expect 0 "$iftty" -c "hints 2" --journal o/moved.iftty --read-only
out_has "first label 2 the small one, which has 1"
grep -A1 'first label' out | tail -1 | grep -q 'label 2' || fail "$(cat out)"

# forge FROM TO SED: a procedure's file with its digest right
forge() {
    sed '$d' "$1" | sed "$3" >forged
    printf 'digest %s\n' "$(sha256sum forged | cut -c 1-64)" >>forged
    mv forged "$2"
}
begin "a stranger's procedure reads and writes no file, and a malformed one is refused"
refused() { # SED WORDS
    forge p.proc bad.proc "$1"
    expect_err "$2" 3 "$iftty" apply bad.proc moved.nii --by world --out hostile
    [ -e hostile/moved.iftty ] && fail "$1: a journal was made"
}
forge p.proc same.proc ''
same_files p.proc same.proc
refused 's/^setting weight.*/setting weight \/etc\/passwd/' "a setting that is not of weights"
refused 's/^setting weight.*/setting save labels stolen.nii/' "a setting that is not of weights"
refused 's/^setting weight.*/setting open other.nii/' "a setting that is not of weights"
refused 's/^setting weight.*/setting nonsense/' "a setting that is not of weights"
refused 's/^size .*/size 65534 65534 65534/' "it has more than"
refused 's/^size .*/size 64 56 47/' "runs LABEL"
refused 's/^size .*/size 64 56 49/' "runs LABEL"
refused 's/^to_mm .*/to_mm 1 0 0 0 1 0 0 0 0 0 0 0/' "can be inverted"
refused 's/^label 1 /label 9 /' "in rising order"
refused 's/^chain .*/chain 12/' "chain and 32 digits"
refused 's/^iftty procedure 1/iftty procedure 2/' "version 2"
refused 's/^landmark B/landmark A/' "each landmark once"
refused 's/^gesture 1 5 0/gesture 1 -5 0/' "gesture LABEL RADIUS"
refused 's/^gesture 1 5 0/gesture 1 5 -2/' "gesture LABEL RADIUS"
refused 's/^gesture 1 5 0 [0-9.]*/& over=256/' "over=, and labels"
refused 's/^gesture 1 5 0 [0-9.]*/& over=1-/' "over=, and labels"
refused 's/^gesture 1 5 0 .*/& 1 2 3/; s/^gesture 1 5 0/gesture 1 5 9/' "a reach for a ball alone"
refused 's/^label 2 .*/& "quoted"/' "label N #rrggbb"
head -c 2000 p.proc >cut.proc
expect 3 "$iftty" apply cut.proc moved.nii --by world --out hostile
cp p.proc flipped.proc && flip_byte flipped.proc 300
expect 3 "$iftty" apply flipped.proc moved.nii --by world --out hostile

begin "usage: at least one scene, known ways and fits; a journal stays confined"
expect 2 "$iftty" apply p.iftty
expect 2 "$iftty" apply p.iftty moved.nii --as pictures
err_has "--as: expected labels or seeds, not pictures"
expect 2 "$iftty" apply p.iftty moved.nii --by landmarks --fit bent --landmarks marks.txt
expect 2 "$iftty" apply p.iftty moved.nii far.nii --by landmarks --landmarks marks.txt
err_has "the landmarks belong to one subject"
mkdir -p stranger && cp p.iftty stranger && sed -i 's/^open .*/open ..\/plain.nii weight=morph/' \
    stranger/p.iftty
chain_anew stranger/p.iftty stranger/q.iftty
sed -i 's/ sha256=[0-9a-f]*//' stranger/q.iftty
expect 3 "$iftty" apply stranger/q.iftty moved.nii --by world --out o4
err_has "the journal may not open ../plain.nii"

finish
