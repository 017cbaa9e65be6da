#!/bin/sh
# SPDX-License-Identifier: MIT
# The finish for users: a setting that is recorded, undone and resumed, whose result is in the
# records and checked by verify.
. tests/lib.sh
make_scene scene.nii 30 24 20

cat >script <<'END'
open scene.nii
seed 7,12,10 1 radius=2
seed 25,20,15 2 radius=2
seed 2,2,2 0
run
save labels plain.nii
finish majority radius=1
finish largest label=2
finish holes
save labels smooth.nii finished=yes
undo
save labels less.nii finished=yes
redo
save labels again.nii finished=yes
finish none
save labels none.nii finished=yes
goto 8
save labels eight.nii finished=yes
END

begin "a finish is recorded, and its outcome follows undo, redo and goto"
expect 0 "$iftty" run script --journal a.iftty
out_has "finish    majority radius=1, largest label=2, holes"
finished() { # RECORD
    sed -n "s/^= $1 .*finished=\([0-9a-f]*\).*/\1/p" a.iftty
}
labels=$(sed -n 's/^= 6 .*labels=\([0-9a-f]*\).*/\1/p' a.iftty)
same "$(finished 14)" "$(finished 10)"
same "$(finished 16)" "$labels"
[ "$(finished 10)" != "$labels" ] || fail "the finish changes nothing"
same_files smooth.nii again.nii
tail -c +353 plain.nii >plain && tail -c +353 none.nii >none && same_files plain none
! cmp -s plain.nii smooth.nii || fail "nothing is smoothed"
has_line smooth.nii "iftty labels, finished: majority radius=1, largest label=2, holes" ||
    fail "the file does not say that it is finished"
same "$(last_word labels a.iftty)" "$labels"

begin "a journal with finished labels verifies, for any number of threads, and resumes"
for threads in 1 2 5; do IFTTY_THREADS=$threads expect 0 "$iftty" verify a.iftty; done
printf 'finish\nsave labels resumed.nii finished=yes\n' >more
expect_out "finish    majority radius=1, largest label=2" 0 "$iftty" run more --journal a.iftty
same_files eight.nii resumed.nii
expect 0 "$iftty" verify a.iftty

begin "relaxed labels follow seeds that change no label, and verify for any number of threads"
cat >settle <<'END'
open scene.nii
seed 7,12,10 1 radius=2
seed 25,20,15 2 radius=2
run
finish relax sweeps=9
save labels first.nii finished=yes
seed 8,15,10 1
run
save labels second.nii finished=yes
finish relax label=2 reach=5
save labels third.nii finished=yes
END
expect 0 "$iftty" run settle --journal settle.iftty
out_has "finish    relax sweeps=9 reach=2, relax sweeps=20 reach=5 label=2"
for threads in 1 2 3; do IFTTY_THREADS=$threads expect 0 "$iftty" verify settle.iftty; done
expect_err "radius: \`finish relax\` has none" 2 "$iftty" -c 'open scene.nii; finish relax radius=2'
expect 2 "$iftty" -c 'open scene.nii; finish relax sweeps=0'
err_has "sweeps: expected a number 1..1000, not 0"
expect 2 "$iftty" -c 'open scene.nii; finish relax reach=17'
err_has "reach: expected a number 1..16, not 17"
expect 2 "$iftty" -c 'open scene.nii; finish largest reach=2'
err_has "reach: \`finish largest\` has none"

begin "another outcome than the recorded one is found, with its record"
sed 's/radius=1/radius=2/; s/\(save labels \)\([a-z]*\)/\1other-\2/' script >other
expect 0 "$iftty" run other --journal other.iftty
expect_out "record 6 is the first that differs" 1 "$iftty" verify --bisect a.iftty other.iftty
sed '/^= 10 /s/finished=./finished=x/' a.iftty >b.iftty
expect 1 "$iftty" verify b.iftty
cat "$work/out" "$work/err" >said
has_line said "10" || fail "$(cat said)"

begin "pictures show the finished labels, and say so; the next ones show the forest again"
cat >pictures <<'END'
open scene.nii
size 200 160
seed 7,12,10 1 radius=2
seed 25,20,15 2 radius=2
seed 2,2,2 0
overlay tint marks=off cross=off
render
finish majority radius=2
finish open
save labels map.nii finished=yes
render f.exr finished=yes
render f.exr finished=yes mode=ray replace=yes
render
slice axial 10 s.exr finished=yes
mosaic m.exr finished=yes
spin 2 spin%d.exr finished=yes
golden ball finished=yes
golden plane of=coronal finished=yes
golden four of=mosaic finished=yes
END
expect 0 "$iftty" run pictures --journal p.iftty
picture() { # RECORD
    sed -n "s/^= $1 .*picture=\([0-9a-f]*\).*/\1/p" p.iftty
}
same "$(picture 11)" "$(picture 12)"
same "$(picture 7)" "$(picture 13)"
[ "$(picture 7)" != "$(picture 11)" ] || fail "the rendition shows nothing of the finish"
for exr in f s m spin0 p.golden/ball p.golden/plane; do
    expect_out "majority radius=2, open radius=1" 0 "$iftty" info $exr.exr
done
# The same pictures of a forest that has these labels: each voxel is a seed.
cat >others <<'END'
open scene.nii
size 200 160
seed-file map.nii regions=0-9
run
overlay tint marks=off cross=off
render
slice axial 10 os.exr
mosaic om.exr
END
expect 0 "$iftty" run others --journal o.iftty
sed -n 's/^= .*picture=\([0-9a-f]*\).*/\1/p' o.iftty >pictured
same "$(picture 11; picture 14; picture 15)" "$(cat pictured)"
expect_out "p.iftty" 0 "$iftty" verify p.iftty
IFTTY_THREADS=3 expect 0 "$iftty" verify p.iftty

begin "finished on updates pictures after each seed; it is recorded, verified and resumed"
cat >live <<'END'
open scene.nii
size 200 160
seed 7,12,10 1 radius=2
seed 25,20,15 2 radius=2
seed 2,2,2 0
render
finish relax sweeps=20
render asked.exr finished=yes
finished on
render shown.exr
render finished=no
seed 12,6,8 2 radius=1
render
slice axial 8 slice.exr
undo 2
render
finished off
render
END
expect 0 "$iftty" run live --journal l.iftty
out_has "finish    relax sweeps=20 reach=2; pictures show it"
picture() { # RECORD
    sed -n "s/^= $1 .*picture=\([0-9a-f]*\).*/\1/p" l.iftty
}
same "$(picture 8) $(picture 6)" "$(picture 10) $(picture 11)"
same "$(picture 16) $(picture 18)" "$(picture 8) $(picture 6)"
[ "$(picture 13)" != "$(picture 10)" ] || fail "the seed is not seen"
expect_out "relax sweeps=20" 0 "$iftty" info slice.exr
for threads in 1 2 3; do IFTTY_THREADS=$threads expect 0 "$iftty" verify l.iftty; done
printf 'finished on\nrender\n' >more
expect 0 "$iftty" run more --journal l.iftty
same "$(picture 20)" "$(picture 10)"
expect 0 "$iftty" verify l.iftty
expect_err "on|off" 2 "$iftty" -c "open scene.nii; finished perhaps"
expect_err "finished needs a scene" 2 "$iftty" -c "finished on"

begin "labels that the finish deletes, halves or breaks are named, with voxels and pieces"
cat >walls <<'END'
open scene.nii
label 3 wall
label 7 never
box 0,0,0 29,23,19 0
box 2,2,2 8,8,8 1
box 5,5,14 24,18,14 3
box 12,2,2 14,4,4 2
box 15,3,3 20,3,3 2
box 21,2,2 23,4,4 2
box 2,14,2 8,20,8 4
box 9,17,5 9,17,5 4
run
finish majority
END
{ cat walls; echo "save labels lost.nii finished=yes"; } >script2
expect 0 "$iftty" run script2 --journal lost.iftty
out_has "the finish reduces label 2: 60 voxels in 1 piece before, 14 voxels in 2 pieces after"
out_has "the finish deletes label 3 wall: 280 voxels in 1 piece before, 0 voxels after"
same "$(grep -c 'the finish [dr]e' out)" 4 # two each from `finish` and `save`
out_has "\`finish none\` removes them"
{ cat walls; echo "stats finished=yes"; echo "stats finished=yes report=lost.csv"
    echo "stats report=lost.json"; } >script3
expect 0 "$iftty" run script3
out_has "the finish deletes label 3 wall: 280 voxels in 1 piece before, 0 voxels after"
out_has "label 3 wall: 280 seeds, 0 voxels" "label 7 never: 0 seeds, 0 voxels"
same "$(sed -n 's/^\([37],"[a-z]*"\),\([0-9]*\),[0-9]*,0,0,0,,.*/\1 \2/p' lost.csv)" '3,"wall" 0
7,"never" 0'
grep -q '"number": 7, "name": "never", "code": "", "voxels": 0, .*"mean": null' lost.json ||
    fail "$(cat lost.json)"
expect 0 "$iftty" run walls
out_has "the finish deletes label 3 wall" # as soon as the finish is chosen
printf '%s\n' 'open scene.nii' 'box 0,0,0 29,23,19 0' 'box 1,1,1 12,12,12 1' run \
    'finish open radius=9' 'stats finished=yes' >thick
expect_out "the finish deletes label 1: 1728 voxels" 0 "$iftty" run thick
out_has "the finish changes 216 voxels more than 3 voxels from any border"
sed 's/^finish majority/finish holes/' script2 >kept
sed -i 's/lost.nii/kept.nii/' kept
expect 0 "$iftty" run kept
! grep -q 'the finish [drb]' out || fail "nothing is lost: $(cat out)"

begin "at the prompt a loss is named once, as soon as a picture is made of finished labels"
expect 0 "$iftty" <<END
open scene.nii
auto on
finish majority
finished on
box 0,0,0 29,23,19 0
box 15,3,3 20,3,3 2
render
box 5,5,14 24,18,14 3
render
render
END
same "$(grep '^the finish' out)" "the finish deletes label 2; see \`stats\`
the finish deletes label 3; see \`stats\`"

begin "an invalid argument of a step is rejected, and so is a too large reach"
refused() { # COMMAND WORDS
    expect_err "$2" 2 "$iftty" -c "open scene.nii; $1"
}
refused "finish polish" "majority|largest|components|holes|open|close|none"
refused "finish largest radius=2" "radius: \`finish largest\` has none"
refused "finish components" "voxels: \`finish components\` needs it"
refused "finish none label=2" "expected a step"
refused "finish label=2" "expected a step"
refused "finish majority label=0" "label"
refused "save cost c.nii finished=yes" "only for labels and surfaces"
expect 3 "$iftty" -c "open scene.nii; finish open radius=40mm"
err_has "finish open: the radius reaches 40 voxels along x; at most 16"
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do echo "finish holes"; done >sixteen
{ echo "open scene.nii"; cat sixteen; } >many
expect 0 "$iftty" run many
echo "finish holes" >>many
expect_err "no room for more" 3 "$iftty" run many

finish
