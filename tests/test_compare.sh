#!/bin/sh
# SPDX-License-Identifier: MIT
# Comparison of labels by command and program: the measures equal those of ITK, as text, JSON and
# CSV; the picture shows the differences; and other maps are rejected. tests/test_comparison.c
# compares the measures with a slow computation, and tests distances.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16

# Segmentations of two people, voxels of 1 x 1 x 1 mm.
record() { # NAME COMMANDS
    "$iftty" -c "open s.nii; label 1 liver; seed 2,3,4 0; seed 6,10,8 1; $2; run
        save labels $1.nii" --journal "$1.iftty" >/dev/null || fail "cannot record $1"
}
record a 'seed 20,10,8 2'
record b 'seed 20,12,3 2 radius=1; seed 3,15,12 3'

# ITK's measures of two maps.
itk_says() { # NX NY NZ SX SY SZ A B LABELS, for maps A and B
    voxels_of "$7" >a.raw
    voxels_of "$8" >b.raw
    "$build/tests/peers/itk_compare" "$1" "$2" "$3" "$4" "$5" "$6" a.raw b.raw "$9" 2>/dev/null
}
# The same measures out of a CSV report: label, Dice, Jaccard, similarity, Hausdorff, larger mean.
ours() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
        function value(name) { return $column[name] == "" ? "-" : $column[name] }
        { ab = value("surface_mean_a_to_b_mm"); ba = value("surface_mean_b_to_a_mm")
          mean = ab == "-" || ab + 0 > ba + 0 ? ab : ba
          print ($1 == "all" ? 0 : $1), value("dice"), value("jaccard"),
              value("volume_similarity"), value("hausdorff_mm"), mean }' "$1"
}
# Equal to a relative 1e-6: spacing is held in nanometres.
near() { # FILE FILE
    paste -d ' ' "$1" "$2" | awk '
        { for (i = 1; i <= 6; i++) {
              a = $i; b = $(i + 6)
              if (a == "-" || b == "-") { if (a != b) exit 1; continue }
              d = a - b; if (d < 0) d = -d
              m = a < 0 ? -a : a
              if (d > 1e-6 * (m + 1e-6)) { print "line " NR ", " a " and " b; exit 1 } } }
        END { if (NF != 12) exit 1 }' || fail "they differ:" "$(paste "$1" "$2")"
}

begin "the measures equal those of ITK"
itk_says 24 20 16 1 1 1 a.nii b.nii 3 >itk || fail "ITK cannot compare: $(cat itk)"
expect 0 "$iftty" compare --csv a.nii b.nii
ours "$work/out" >own
[ "$(wc -l <own)" = 4 ] || fail "$(cat own)"
near itk own

# Spacing along each axis of its own, in bytes 80 to 91 of the header: 0.957031, 0.5 and 3.3 mm.
begin "and so they are with voxels that are not cubes, and cut off by the edge of the scene"
for map in a b; do
    {
        head -c 80 $map.nii
        printf '\000\000\165\077\000\000\000\077\063\063\123\100'
        tail -c +93 $map.nii
    } >$map-long.nii
done
itk_says 24 20 16 0.95703125 0.5 3.29999995 a-long.nii b-long.nii 3 >itk
expect 0 "$iftty" compare --csv a-long.nii b-long.nii
ours "$work/out" >own
near itk own

begin "objects that overlap, and one in which the other has a cavity"
"$iftty" -c "open synth:geom:60x50x40; seed 1,1,1 0; box 10,8,6 30,26,22 1
    box 17,15,12 21,19,15 0; run; save labels hollow.nii; undo 2; run; save labels solid.nii
    box 33,10,6 50,30,25 2; run; save labels two.nii" >/dev/null || fail "cannot segment"
for pair in "hollow solid" "solid two" "two hollow"; do
    set -- $pair
    itk_says 60 50 40 1 1 1 "$1.nii" "$2.nii" 2 | sed '/- -$/d' >itk
    expect 0 "$iftty" compare --csv "$1.nii" "$2.nii"
    ours "$work/out" | sed '/ - -$/d' >own
    near itk own
done

begin "words, JSON and the command say the same"
"$iftty" compare a.nii b.nii >words
grep -q '^label  *Dice Jaccard' words || fail "$(cat words)"
[ "$(grep -c '^[0-9] ' words)" = 3 ] || fail "$(cat words)"
grep -q '^all ' words || fail "no line for all: $(cat words)"
expect_out "1 liver " 0 "$iftty" -c 'compare b.nii report=r.json; compare b.nii report=r.csv' \
    --journal a.iftty
sed '1,/^label/d' words | head -n 3 | cut -c 17- >from_program
sed -n '/^    label/,$p' out | sed -n 2,4p | cut -c 21- >from_command
same_files from_program from_command
"$iftty" compare --csv a.nii b.nii | sed 's/,"",/,/' >from_program
sed 's/,"[a-z]*",/,/' r.csv >from_command
same_files from_program from_command
"$PYTHON" - <<'EOS' || fail "JSON and CSV differ: $(cat r.json)"
import csv, json
d = json.load(open('r.json'))
rows = list(csv.DictReader(open('r.csv')))
assert rows[0]['name'] == 'liver' and d['labels'][0]['name'] == 'liver'
for row, told in zip(rows, d['labels'] + [d['all']]):
    for key, value in row.items():
        if key not in ('label', 'name'):
            assert told[key] == (float(value) if value else None), (key, value, told[key])
assert len(rows) == len(d['labels']) + 1 and d['b'] == 'b.nii'
EOS

begin "a question changes nothing and is not recorded"
cp a.iftty former.iftty
expect 0 "$iftty" -c 'compare b.nii picture=seen.png' --journal a.iftty
same_files a.iftty former.iftty

begin "the picture has the colours of the differences, and the scene is unchanged"
expect 0 "$iftty" -c 'compare b.nii picture=cut.png at=20,12,3; save labels after.nii' \
    --journal a.iftty
same_files after.nii a.nii
expect 0 "$iftty" compare a.nii b.nii --picture maps.png --scene s.nii
if needs oiiotool; then
    for picture in cut.png maps.png; do
        oiiotool -q "$picture" --ch R,G,B -d uint8 -o "$picture.ppm" || fail "no picture $picture"
        [ $picture = cut.png ] && side=512 || side=1024
        tail -c $((3 * side * side)) "$picture.ppm" | od -An -v -tu1 -w3 | tr -s ' ' | sort -u \
            >colours
        for colour in '230 159 0' '86 180 233' '225 225 225'; do
            grep -qF " $colour" colours || fail "no pixel of $colour in $picture"
        done
    done
fi
expect_out "iftty:differ" 0 "$iftty" info cut.png

# A box, and one that is 2 voxels larger on each side: all of the larger one is too large by as much
# along the axes, and the smaller one too small; no colour but theirs, however the light falls.
begin "the picture of a surface is red outside, blue inside, and the scene is as before"
"$iftty" -c "open synth:geom:60x50x40; box 0,0,0 59,49,39 0; box 20,18,12 39,31,27 1; run
    save labels small.nii; undo 2; box 18,16,10 41,33,29 1; run; save labels large.nii" \
    --journal boxes.iftty >/dev/null || fail "cannot segment"
expect 0 "$iftty" compare large.nii small.nii --surface red.png
expect 0 "$iftty" compare small.nii large.nii --surface blue.png
expect 0 "$iftty" compare small.nii small.nii --surface grey.png
if needs oiiotool; then
    for picture in red blue grey; do # of the middle, where no words are
        oiiotool -q $picture.png --ch R,G,B --cut 400x300+312+362 -d uint8 -o $picture.ppm ||
            fail "no picture $picture"
        tail -c 360000 $picture.ppm | od -An -v -tu1 -w3 | awk '
            { most = $1 > $3 + 40 ? "red" : $3 > $1 + 40 ? "blue" : "grey"; count[most]++ }
            END { for (c in count) if (count[c] > n) { n = count[c]; seen = c }
                  print seen, (n > 100000) }' >seen
        same "$(cat seen)" "$picture 1"
    done
fi
expect 0 "$iftty" info red.png
out_has "iftty:distance: of A's surface from B's, -5 mm inside to 5 mm outside"
expect 0 "$iftty" -c 'render; compare small.nii surface=red2.png; render' --journal boxes.iftty
same "$(grep -c 'picture=' boxes.iftty)" 2
same "$(grep -o 'picture=[0-9a-f]*' boxes.iftty | sort -u | wc -l)" 1
expect_err "--surface: " 3 "$iftty" compare large.nii small.nii --surface red.png
"$iftty" -c 'open synth:geom:60x50x40; seed 1,1,1 0; run; save labels none.nii empty=yes' \
    >/dev/null
expect 3 "$iftty" compare large.nii none.nii --surface none.png
err_has "expected an object in A and in B"

begin "one label, and regions of a map for it"
expect 0 "$iftty" compare --binary --csv a.nii b.nii
sed -n 2p out >both
same "$(wc -l <out)" 3
expect 0 "$iftty" -c 'compare b.nii label=1 report=one.csv; compare b.nii label=1 regions=1-1
    compare b.nii label=2 regions=2-3 report=two.csv' --journal a.iftty
count() { # MAP LABELS
    voxels_of "$1" | od -An -v -tu1 -w1 | grep -c " $2\$"
}
same "$(sed -n 2p one.csv | cut -d , -f 1-4)" "1,\"liver\",$(count a.nii 1),$(count b.nii '[123]')"
same "$(sed -n 2p two.csv | cut -d , -f 4)" "$(count b.nii '[23]')"

begin "the program compares chosen values of both maps, as labels that are chosen too"
expect 0 "$iftty" compare a.nii b.nii --csv --regions 2
same "$(sed 1d out | cut -d , -f 1-4)" "2,\"\",$(count a.nii 2),$(count b.nii 2)
all,\"\",$(count a.nii 2),$(count b.nii 2)"
expect 0 "$iftty" compare a.nii b.nii --csv --regions 1,2-3 --as 7,7,9
same "$(sed 1d out | cut -d , -f 1-4)" "7,\"\",$(count a.nii '[12]'),$(count b.nii '[12]')
9,\"\",0,$(count b.nii 3)
all,\"\",$(count a.nii '[123]'),$(count b.nii '[123]')"
expect 0 "$iftty" compare a.nii b.nii --csv --regions 2-3 --binary
same "$(sed -n 2p out | cut -d , -f 1-4)" "1,\"\",$(count a.nii '[23]'),$(count b.nii '[23]')"
for words in '--as 1' '--regions 2,2' '--regions 1,2 --as 1' '--regions 1 --as 1 --binary' \
    '--regions 1-' '--regions 4294967296' '--regions 1 --as 4294967296'; do
    expect 2 "$iftty" compare a.nii b.nii $words # words on purpose
done
err_has "--as: expected numbers 0..4294967295, as in 1-90,105, not 4294967296"

begin "a name with blanks is quoted, also after its key"
cp b.nii 'b 2.nii'
expect 0 "$iftty" -c 'compare "b 2.nii" report="r 2.json" picture="p 2.png"' --journal a.iftty
[ -f 'r 2.json' ] && [ -f 'p 2.png' ] || fail "$(ls)"
expect_err "one word too many" 2 "$iftty" -c 'compare b.nii report="r 2.json' --journal a.iftty

begin "finished labels are compared where they are asked for"
expect 0 "$iftty" -c 'finish majority radius=2; save labels smooth.nii finished=yes
    compare smooth.nii; compare smooth.nii finished=yes' --journal a.iftty
grep -q '^    [1-9][0-9]* of 7680 voxels differ' out || fail "the forest is compared: $(cat out)"
grep -q '^    0 of 7680 voxels differ' out || fail "finished labels are not: $(cat out)"
out_has "the labels here, finished"

# 30 mm to the right, in the bytes of qoffset_x and of srow_x.
begin "displaced maps are rejected with their distance"
{
    head -c 268 solid.nii
    printf '\000\000\360\101'
    tail -c +273 solid.nii | head -c 20
    printf '\000\000\360\101'
    tail -c +297 solid.nii
} >moved.nii
expect_err " mm" 3 "$iftty" compare solid.nii moved.nii
err_has "; --resample uses its nearest voxels"
expect_err "resampled" 0 "$iftty" compare solid.nii moved.nii --resample --csv
grep -q '^1,"",[0-9]*,[0-9]*,0,' out && fail "nothing overlaps: $(cat out)"

begin "maps that cannot be compared are rejected, with the command to type"
make_scene other.nii 24 20 15
expect_err "24x20x16" 3 "$iftty" compare a.nii other.nii
expect 3 "$iftty" compare a.nii missing.nii
expect 2 "$iftty" compare a.nii
expect_err "expected --picture too" 2 "$iftty" compare a.nii b.nii --scene s.nii
expect 2 "$iftty" compare a.nii b.nii --picture x.exr
expect_err "exists already" 3 "$iftty" compare a.nii b.nii --picture maps.png
expect 3 "$iftty" compare missing.nii b.nii --picture nowhere/d.png # before anything is read
err_has "there is no folder nowhere"
expect_err "ends in .json or .csv" 2 "$iftty" -c 'compare b.nii report=r.txt' --journal a.iftty
expect 2 "$iftty" -c 'compare b.nii at=1,1,1' --journal a.iftty
expect 3 "$iftty" -c 'compare b.nii report=r.csv' --journal a.iftty
expect 0 "$iftty" -c 'compare b.nii report=r.csv replace=yes' --journal a.iftty

begin "labels that are asked for or named have a row, though neither map has them"
expect 0 "$iftty" compare --csv --regions 1,77 a.nii b.nii
same "$(cut -d, -f 1 out | tr '\n' ' ')" 'label 1 77 all '
grep -q '^77,"",0,0,0,0,0,0,,*$' out || fail "$(cat out)"
expect 0 "$iftty" compare --csv --regions 5,6 --as 1,77 a.nii b.nii
same "$(cut -d, -f 1 out | tr '\n' ' ')" 'label 1 77 all '
expect 0 "$iftty" compare --json --regions 77 a.nii b.nii
grep -q '"label": 77, .*"dice": null' out || fail "$(cat out)"
expect 0 "$iftty" compare --regions 1,77 a.nii b.nii
grep -q '^77  *-  *-  *0' out || fail "$(cat out)"
expect 0 "$iftty" -c 'label 9 spleen; compare b.nii report=zero.csv' --journal a.iftty
grep -q '^9,"spleen",0,0,0,' zero.csv || fail "$(cat zero.csv)"
expect 0 "$iftty" -c 'compare b.nii regions=1,78 report=asked.csv' --journal a.iftty
grep -q '^78,"",0,0,0,' asked.csv || fail "$(cat asked.csv)"

finish
