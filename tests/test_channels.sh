#!/bin/sh
# SPDX-License-Identifier: MIT
# Several channels of a scene: weights, relaxation, answers, pictures and undo.
. "$(dirname "$0")/lib.sh"
"$PYTHON" - <<'END' || exit 1
import nibabel, numpy
noise = numpy.random.default_rng(3)
x, y, z = numpy.indices((60, 50, 40))
save = lambda voxels, name: nibabel.save(nibabel.Nifti1Image(voxels, numpy.eye(4)), name)
balls = [(x - at) ** 2 + (y - 25) ** 2 + (z - 20) ** 2 < 100 for at in (20, 42)]
for ball, name in zip(balls, "ab"):
    voxels = numpy.where(ball, 300, 100) + noise.integers(-8, 9, ball.shape)
    save(voxels.astype(numpy.int16), f"case_000{'ab'.index(name)}.nii")
    save((voxels / 7).astype(numpy.float32), f"{name}-real.nii")
save(numpy.where(balls[0], 1, numpy.where(balls[1], 2, 0)).astype(numpy.uint8), "truth.nii")
save(numpy.zeros((9, 9, 9), numpy.int16), "small.nii")
voxels = noise.normal(0, 9, ball.shape).astype(numpy.float32)
voxels[1, 1, 1], voxels[2, 2, 2] = 1e12, numpy.nan
save(voxels, "outlier.nii")
save(noise.normal(0, 9e6, ball.shape).astype(numpy.int32), "wide.nii")
END
seeds='seed 20,25,20 1 radius=3; seed 42,25,20 2 radius=3; seed 30,5,5 0 radius=3
    seed 31,45,35 0 radius=3; run'
dice() { # LABEL: of the last compare
    awk -v label="$1" '$1 == label && NF > 5 { print int(1000 * $2) }' out
}
last() { # WORD of the last record that has it
    sed -n "s/^= .* $2=\([^ ]*\).*/\1/p" "$1" | tail -n 1
}

begin "two objects, each with its edge in one channel alone, in four gestures"
expect 0 "$iftty" -c "open case_0000.nii; channel case_0001.nii name=FLAIR; $seeds
    compare truth.nii" --journal j.iftty
for label in 1 2; do
    [ "$(dice $label)" -ge 800 ] || fail "label $label: $(dice $label)"
done
out_has 'other files of this case may be channels: `channel case_0001.nii`'
expect 0 "$iftty" -c "open case_0000.nii; $seeds; compare truth.nii"
[ "$(dice 2)" -lt 300 ] || fail "the first channel alone has an edge there: $(dice 2)"
expect 0 "$iftty" verify j.iftty
expect_out "channel   2 FLAIR, digest " 0 "$iftty" -c "info" --journal j.iftty

begin "the scene as its own second channel changes no bit"
expect 0 "$iftty" -c "open case_0000.nii; $seeds; finish relax; finished on; stats finished=yes" \
    --journal one.iftty
expect 0 "$iftty" -c "open case_0000.nii; channel case_0000.nii; $seeds; finish relax; finished on
    save labels two.nii finished=yes" --journal two.iftty
expect 0 "$iftty" -c "open case_0000.nii; $seeds; finish relax; save labels one.nii finished=yes"
same "$(last one.iftty forest)" "$(last two.iftty forest)"
same_files one.nii two.nii
for name in outlier wide; do # read as a scene is, not as numbers of labels
    for part in "" reduce=2 "crop=1-40,1-30,1-20 reduce=2"; do
        rm one.iftty two.iftty
        grow="seed 1,1,1 1; seed 9,9,9 2; run; why 4,4,4"
        expect 0 "$iftty" -c "open $name.nii $part; $grow" --journal one.iftty
        grep voxel.4,4 out | sed 's/intensity/intensity in channel 2:/' >seen
        expect 0 "$iftty" -c "open $name.nii $part; channel $name.nii; show-channel 2; $grow" \
            --journal two.iftty
        same "$name $part $(last one.iftty forest)" "$name $part $(last two.iftty forest)"
        same "$(cat seen)" "$(grep voxel.4,4 out)"
        expect 0 "$iftty" verify two.iftty
    done
done

begin "only pictures and figures depend on the channel that is shown"
for show in 1 2; do
    expect 0 "$iftty" -c "open case_0000.nii; channel case_0001.nii; show-channel $show; $seeds
        finish relax; save labels shown$show.nii finished=yes; why 42,25,20
        size 64 64; slice coronal shown$show.png" --journal "shown$show.iftty"
    cp out seen
    expect 0 "$iftty" verify "shown$show.iftty"
done
grep -q "intensity in channel 2: 293" seen || fail "$(grep voxel seen)"
same_files shown1.nii shown2.nii
same "$(last shown1.iftty forest)" "$(last shown2.iftty forest)"
! cmp -s shown1.png shown2.png || fail "the pictures are the same"

begin "each channel has its own window, values and range of planting"
expect 3 "$iftty" -c "open a-real.nii; channel b-real.nii; window 10 20; show-channel next
    window 30 40; show-channel 1; info; show-channel 2; info; why 42,25,20; why 20,25,20
    seed 42,25,20 2 radius=3 range=40..50; seed 42,25,20 2 radius=3 range=2:40..50
    seed 20,25,20 1 radius=3 range=1:40..50; object 2 threshold 2:40..50" --keep-going
same "$(grep -o 'window [0-9. ]*,' out | tail -n 2 | tr '\n' ' ')" "window 10 20, window 30 40, "
grep -q 'voxel 42,25,20 .*intensity in channel 2: 4' out || fail "$(grep voxel out)"
grep -q 'voxel 20,25,20 .*intensity in channel 2: 1' out || fail "$(grep voxel out)"
err_has "range: no voxel of it has such an intensity in channel 1"
grep -q '^ok [0-9]* seed 42,25,20 2 radius=3 range=2:40..50' out || fail "nothing was planted"
grep -q '^ok [0-9]* seed 20,25,20 1 radius=3 range=40..50' out || fail "not of the first channel"
out_has 'ok 10 object 2 threshold 2:40..50'

begin "a range means the same whichever channel is shown, and goes back with its channel"
for show in 1 2; do
    expect 0 "$iftty" -c "open a-real.nii; channel b-real.nii; show-channel $show
        range 35..50; range 2:35..50; seed 42,25,20 1; range 2:10..50; seed 20,25,20 2 range=30..50
        run; object 1 threshold 2:30..50; undo 2; redo; save labels range$show.nii" \
        --journal "range$show.iftty"
    expect 0 "$iftty" verify "range$show.iftty"
done
same_files range1.nii range2.nii
same "$(last range1.iftty fence)" "$(last range2.iftty fence)"
same "$(grep '^range' range1.iftty | tr '\n' ';')" "range 35 50;range 2:35..50;range 2:10..50;"
expect 0 "$iftty" -c "open a-real.nii; channel a-real.nii; channel b-real.nii; window 10 20
    show-channel 3; window 30 40; range 3:35..50; range 35 50; range 3:35..50; channel 2 remove=yes
    info; undo; info; undo 4; info; redo 4; info; channel b-real.nii; undo 2; show-channel 3
    info" --journal back.iftty
same "$(grep -o 'region .*:' out | tr -s ' \n' ' ;')" "region range 2:35..50:;$(
)region range 3:35..50:;region range 3:35..50:;region range 35..50:;"
same "$(sed -n 's/.*slices .*window \([0-9]*\).*/\1/p' out | tr '\n' ' ')" "30 30 10 30 30 "
expect 0 "$iftty" verify back.iftty

begin "a channel that undo has removed leaves the window of the first"
expect 0 "$iftty" -c "open a-real.nii; window 10 20; channel b-real.nii; show-channel 2
    window 30 40; undo 9; info; redo 9; info; show-channel 1; info"
same "$(grep -o 'window [0-9. ]*,' out | tail -n 3 | tr '\n' ' ')" \
    "window 10 20, window 30 40, window 10 20, "

begin "another file in the slot of an undone channel has no window of that one"
expect 0 "$iftty" -c "open a-real.nii; channel a-real.nii; undo; channel b-real.nii; show-channel 2
    window 30 40; goto 2; show-channel 2; info; goto 4; info"
same "$(grep -o 'window [a-z0-9: ]*' out | tail -n 2 | cut -c 1-12 | tr '\n' ';')" \
    "window auto:;window 30 40;"

begin "the context is that of the channel that is shown"
expect 0 "$iftty" -c "open a-real.nii; size 64 64; context mip; channel a-real.nii; show-channel 2
    window 10 50; render a.png; channel 2 remove=yes; channel b-real.nii; show-channel 2
    window 10 50; render b.png"
expect 0 "$iftty" -c "open a-real.nii; size 64 64; context mip; channel b-real.nii; show-channel 2
    window 10 50; render fresh.png"
same_files b.png fresh.png
! cmp -s a.png b.png || fail "the context is that of the removed channel"

begin "adding, scaling and removing a channel is undone exactly, whatever is shown"
steps="open case_0000.nii; channel case_0001.nii; $seeds; show-channel 2"
expect 0 "$iftty" -c "$steps; channel 2 percent=50; undo; channel 2 remove=yes; why 42,25,20; undo
    why 42,25,20; goto 1; why 42,25,20; goto 7; why 42,25,20" --journal undo.iftty
cp out seen
expect 0 "$iftty" verify undo.iftty
same "$(grep -o 'intensity [^,]*' seen | tr '\n' ';')" \
    "intensity 98;intensity in channel 2: 293;intensity 98;intensity in channel 2: 293;"
same "$(last undo.iftty forest)" "$(last j.iftty forest)"
expect 0 "$iftty" -c "open case_0000.nii; $seeds; range 90 310; channel case_0001.nii; undo; run" \
    --journal range.iftty
expect 0 "$iftty" verify range.iftty

begin "a channel is read from --channel, and elsewhere for a record with its proof"
mkdir here there
cp case_0000.nii here
cp case_0001.nii there/flair.nii
cp a-real.nii there/real.nii
expect_in here 0 "$iftty" -c "open case_0000.nii; channel ../there/flair.nii
    channel ../there/real.nii name=real; $seeds; range 3:10..50" --journal c.iftty
grep -q '^channel ../there/flair.nii$' here/c.iftty || fail "$(cat here/c.iftty)"
for way in "" "$PYTHON -I -S $top/tests/volumes/without_landlock.py"; do
    expect 0 $way "$iftty" verify here/c.iftty
    expect 0 $way "$iftty" replay here/c.iftty
done
again=$(yes 'channel 3 remove=yes; channel ../there/real.nii;' | head -16)
cp there/flair.nii there/late.nii # after more records than files that a replay may read
expect_in here 0 "$iftty" -c "open case_0000.nii; channel ../there/flair.nii
    channel ../there/real.nii; $again; channel ../there/late.nii" --journal many.iftty
expect 0 "$iftty" verify here/many.iftty
rm there/late.nii
mv there away
expect_out "there is no file flair.nii next to the journal or among the scenes" 3 \
    "$iftty" verify here/c.iftty
out_has "the channel of this record is not at ../there/flair.nii: "
out_has "expected --channel FILE"
expect 3 "$iftty" verify here/c.iftty --channel away/flair.nii
expect 0 "$iftty" verify here/c.iftty --channel away/flair.nii --channel away/real.nii
expect 0 "$iftty" replay here/c.iftty --channel=away/flair.nii --channel=away/real.nii
expect 0 "$iftty" diff here/c.iftty here/c.iftty --channel away/flair.nii --channel away/real.nii
expect_out "a file that the command read holds something else" 1 \
    "$iftty" verify here/c.iftty --channel away/real.nii --channel away/flair.nii
expect 2 "$iftty" verify here/c.iftty $(seq -f '--channel x%g' 8)
err_has "--channel: expected at most 7"
expect 2 "$iftty" verify here/c.iftty --scene a --scene b

begin "any other file elsewhere is a missing channel, and a changed one beside the journal is found"
mv away none
expect 3 "$iftty" verify here/c.iftty
cp out missing
for kind in other small text cut folder; do
    rm -rf there
    cp -r none there
    case $kind in
    other) flip_byte there/flair.nii 9000 ;;
    small) cp small.nii there/flair.nii ;;
    text) echo secret >there/flair.nii ;;
    cut) head -c 9000 none/flair.nii >there/flair.nii ;;
    folder) rm there/flair.nii; mkdir there/flair.nii ;;
    esac
    expect 3 "$iftty" verify here/c.iftty
    cmp -s out missing || fail "$kind: $(diff out missing)"
done
rm -r there
cp none/flair.nii none/real.nii here
expect 0 "$iftty" verify here/c.iftty
flip_byte here/flair.nii 9000
expect_out "a file that the command read holds something else" 1 "$iftty" verify here/c.iftty
cp none/flair.nii here/flair.nii
"$PYTHON" -c 'import nibabel; i = nibabel.load("none/real.nii")
nibabel.save(nibabel.Nifti1Image(i.get_fdata(dtype="f4") * 2, i.affine), "here/real.nii")'
expect_out "record 3" 1 "$iftty" verify here/c.iftty

begin "a channel of a part of a scene is not read elsewhere"
cp -r none there
rm here/flair.nii
expect_in here 0 "$iftty" -c "open case_0000.nii crop=0-0,0-0,0-0; channel ../there/flair.nii" \
    --journal part.iftty
expect 3 "$iftty" verify here/part.iftty
out_has "the journal may not read ../there/flair.nii: there is no file flair.nii next to"
expect 0 "$iftty" verify here/part.iftty --channel there/flair.nii

begin "--channel is for recorded channels, each command FILE in turn"
expect 0 "$iftty" -c "open case_0000.nii; channel case_0001.nii; channel 2 remove=yes
    channel truth.nii" --journal turn.iftty
mkdir turn
cp turn.iftty case_0000.nii turn
cp case_0001.nii turn/1.nii
cp truth.nii turn/2.nii
cp a-real.nii turn/new.nii
for program in verify replay; do
    expect 0 "$iftty" $program turn/turn.iftty --channel turn/1.nii --channel turn/2.nii
done
expect_in turn 0 "$iftty" -c "channel new.nii" --journal turn.iftty --channel 1.nii \
    --channel 2.nii --channel case_0000.nii
expect 0 "$iftty" -c "open case_0000.nii; channel a-real.nii" --journal new.iftty
same "$(last turn/turn.iftty channel)" "$(last new.iftty channel)"
for words in "case_0000.nii case_0001.nii" "serve case_0000.nii" "-c info"; do
    expect 2 "$iftty" $words --channel a-real.nii </dev/null
    err_has "--channel: only for a journal that has recorded"
done

begin "several files of the command line are a scene and its channels"
for program in "" serve; do
    rm -f files.iftty
    expect 0 "$iftty" $program case_0000.nii case_0001.nii --journal files.iftty </dev/null
    same "$("$iftty" log --script files.iftty | grep -v '^#' | tr '\n' ';')" \
        "open case_0000.nii weight=morph;channel case_0001.nii;auto on;"
done
cp case_0000.nii a_0001_0002.nii
cp case_0001.nii "here/b b_0003.nii"
cp case_0001.nii "here/b b_0007.nii"
"$iftty" case_0000.nii case_0001.nii </dev/null >out 2>&1
"$iftty" -c "open a_0001_0002.nii" >>out
grep "may be" out && fail "no file is to be added"
answers '`channel "here/b b_0007.nii"`' "open 'here/b b_0003.nii'"
rm -f files.iftty
expect 3 "$iftty" case_0000.nii small.nii --journal files.iftty </dev/null
cp case_0000.nii here/whole
cp case_0001.nii here/3 # names without a dot: no program, and no channel 3
for program in "" serve; do
    rm -f here/files.iftty
    expect_in here 0 "$iftty" $program whole 3 --journal files.iftty </dev/null
    same "$(grep -c sha256 here/files.iftty)" 2
    expect 0 "$iftty" verify here/files.iftty
done
expect 2 "$iftty" serv here/whole
err_has "serv is no program, and no file or folder here; did you mean serve?"
expect 2 "$iftty" j.iftty case_0001.nii </dev/null
err_has "j.iftty is a journal; expected no other file"
expect_err '`channel FILE` adds another file' 2 "$iftty" -c "open case_0000.nii case_0001.nii"

begin "answers about intensities name the channel, if there are several"
for channels in "" "channel case_0001.nii name=FLAIR; show-channel 2"; do
    rm -f s.json s.csv
    expect 0 "$iftty" -c "open case_0000.nii; $channels; $seeds; profile 20,25,20 42,25,20
        stats report=s.json; stats report=s.csv"
    same "$(grep -c "s of channel 2 FLAIR\|s in channel 2 FLAIR: " out)" \
        "$([ "$channels" ] && echo 3 || echo 0)"
    same "$(grep -c '"intensity_channel": 2' s.json)$(grep -c ',intensity_channel$' s.csv)" \
        "$([ "$channels" ] && echo 11 || echo 00)"
done

begin "refusals"
refused() { # COMMANDS WORDS
    expect 2 "$iftty" -c "open case_0000.nii; channel case_0001.nii; $1"
    err_has "$2"
}
refused "weight difference" "several channels need gradients as weights"
refused "weight truth.nii" "several channels need gradients as weights"
refused "channel 3 percent=9" "there is no channel 3: the scene has 2"
refused "channel 1 remove=yes" "the first channel cannot be removed"
refused "channel 2 volume=1" "volume: only a file has one"
refused "show-channel 5" "there is no channel 5"
refused "range 2:0..400; channel 2 remove=yes" 'a `range` of channel 2 restricts trees'
refused "range 3:0..400" "there is no channel 3: the scene has 2"
refused "seed 1,1,1 1 range=3:0..400" "there is no channel 3: the scene has 2"
refused "range 2:40 50" "expected none or LOW..HIGH"
refused "range 1 2..3" "HIGH: expected a number"
refused "range 0..9 7" "expected LOW and HIGH, 2:LOW..HIGH, or none alone"
refused "interpolate 2 2 2" "a mask, a channel or weights from a file belong to the present"
expect 2 "$iftty" -c "open case_0000.nii; weight polarity; channel case_0001.nii"
expect 2 "$iftty" -c "open case_0000.nii; show-channel next"
err_has 'the scene has one channel; `channel FILE` adds another'
expect 3 "$iftty" -c "open case_0000.nii; channel small.nii"
expect_err "its scene has several channels" 3 "$iftty" apply j.iftty case_0001.nii --by world

finish
