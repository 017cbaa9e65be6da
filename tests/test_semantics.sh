#!/bin/sh
# SPDX-License-Identifier: MIT
# Meanings are versioned: tests/journals has a journal of every number that there has been, made by
# a program of its time. Each is verified and gone on with under its own meaning. They stay.
. "$(dirname "$0")/lib.sh"
journals=$top/tests/journals
cd "$work" || exit 1
cp "$journals/scene.nii.gz" "$journals/las.nrrd" .
drawn=10 # from this number on pictures are drawn as they were
current=$("$iftty" info | sed -n 's/^semantics //p')

take() { # NUMBER: a copy, with its golden images
    rm -rf j.iftty j.golden
    cp "$journals/semantics-$1.iftty" j.iftty
    cp -r "$journals/semantics-$1.golden" j.golden
}

begin "there is a journal of every number up to the present one"
[ -n "$current" ] || fail "no number"
number=1
while [ "$number" -le "$current" ]; do
    expect 0 head -1 "$journals/semantics-$number.iftty"
    out_has "# iftty journal 1 semantics $number"
    number=$((number + 1))
done
close_story

begin "none of them has changed since it was recorded"
expect 0 "$iftty" verify --lock "$journals/iftty.lock"
out_has "# $(grep -c '^journal ' "$journals/iftty.lock") verified, 0 failed"
close_story

begin "each is verified under its own meaning, and what cannot be compared is counted"
for journal in "$journals"/semantics-*.iftty; do
    name=${journal##*/semantics-}
    take "${name%.iftty}"
    cp "$journals"/*.nii.gz "$journals"/waiting.csv "$journals"/names.ctab .
    expect 0 "$iftty" verify --strict j.iftty # it passes, though little of its pictures is known
    forests=$(grep -c '^= .* forest=' j.iftty) goldens=$(grep -c '^golden ' j.iftty)
    [ "$forests" -gt 3 ] || fail "$name: nothing is compared"
    if [ "$(sed -n '1s/.*semantics //p' j.iftty)" -ge $drawn ]; then
        ! grep -q "not compared" out || fail "$(cat out)"
    elif [ "$name" != 9-slices.iftty ]; then
        pictures=$(grep -cE '^= .*(picture|spin)=' j.iftty)
        out_has ", $pictures digests and $goldens golden image"
        out_has "# $pictures results were not compared: semantics "
        out_has "\`iftty log --reseal --accept WHY FILE\` draws them anew"
    fi
done
close_story

begin "a forest, a label or a word that is not what it was fails, whatever the semantics"
for number in 1 3 5 9; do
    take $number
    for key in forest labels weights; do
        sed "0,/ $key=[0-9a-f]*/s// $key=0123456789abcdef/" j.iftty >before
        chain_anew before other.iftty
        cp -r j.golden other.golden
        expect 1 "$iftty" verify other.iftty
        out_has "differs  $key"
        rm -rf other.golden
    done
done
close_story

begin "slices that look the same in every look stay compared"
take 9-slices
expect 0 "$iftty" verify --strict j.iftty
out_has "2 golden images of 6000 pixels, 9 digests and 2 golden images of a former look not"
for record in 11 12 14 15 20; do # whatever else is retired
    take 9-slices
    rewrite j.iftty $record "$(words_of j.iftty $record | sed 's/picture=./picture=g/')"
    expect 1 "$iftty" verify j.iftty
    out_has "differs  picture"
done
for record in 23 24 27 29 31 32 34 35 36; do # a rendition; label 3 by default; a contour; ...
    take 9-slices
    rewrite j.iftty $record "$(words_of j.iftty $record | sed -E 's/(picture|spin|names)=./\1=g/')"
    expect 0 "$iftty" verify j.iftty
done
take 9-slices
cp j.golden/grey.exr j.golden/tinted.exr
expect 1 "$iftty" verify j.iftty
out_has "golden image tinted"
close_story

begin "reports say what was not compared, in every form"
take 9-slices
expect 0 "$iftty" verify --strict j.iftty --junit j.xml --html j.html
for words in "ok 1 - j.iftty (36 commands" "9 digests and 2 golden images of a former look not"; do
    out_has "$words"
done
grep -q "<system-out>9 digests and 2 golden images of a former look not compared<" j.xml ||
    fail "$(cat j.xml)"
grep -q "<br>9 digests and 2 golden images of a former look not compared<" j.html || fail "HTML"
expect 0 "$iftty" verify --strict --json j.iftty
out_has '"digests_of_a_former_look": 9, "golden_images_of_a_former_look": 2'
expect 0 "$iftty" replay j.iftty --out replayed
err_has "# 9 results were not compared: semantics 9: "
close_story

begin "each is gone on with under its own meaning, and is a journal of its number still"
cat >more <<'EOF'
info
label 5 new
seed 4,4,3 5 radius=1
undo
redo
weight morph
remove 4,4,3
render
EOF
for number in $(seq 1 "$current"); do
    take $number
    cp j.iftty former
    expect 0 "$iftty" run more --journal j.iftty
    [ "$(grep -c ", semantics $number" "$work/out")" = $((number < current)) ] ||
        fail "$number: $(cat "$work/out")"
    cmp -s -n "$(wc -c <former)" former j.iftty || fail "$number: what was there has changed"
    [ "$(grep -c '^= ' j.iftty)" = $(($(grep -c '^= ' former) + 7)) ] ||
        fail "$number: $(tail -3 j.iftty)"
    expect 0 "$iftty" verify j.iftty
    with_picture=$(tail -1 j.iftty | grep -c 'picture=')
    [ "$with_picture" = $((number >= drawn)) ] || fail "$number: $(tail -1 j.iftty)"
done
close_story

begin "what a file does not say is presumed as it was in journals of semantics 4, and unknown since"
cp "$journals"/*.nii.gz .
for name in unplaced contrary; do
    rm -rf j.iftty j.golden
    cp "$journals/semantics-4-$name.iftty" j.iftty
    cp -r "$journals/semantics-4-$name.golden" j.golden
    expect 0 "$iftty" verify j.iftty
    printf 'info\nseed 5,5,9mm 3\nslice coronal 9\n' >one
    expect 0 "$iftty" run one --journal j.iftty
    out_has "the patient's "
    expect 0 "$iftty" verify j.iftty
    expect 3 "$iftty" -c "open $name.nii.gz; seed 5,5,5mm 3"
    out_has "orientation unknown"
    err_has "where this scene lies in the world is not known"
    sed "1s/semantics .*/semantics 5/" j.iftty >other.iftty
    expect 1 "$iftty" replay other.iftty
done
close_story

begin "left-anterior-superior has its wrong sides in journals of semantics 10, and none since"
take 10-las
expect 0 "$iftty" verify --strict j.iftty
out_has "13 results with 22 digests, 1 golden image of 2304 pixels"
out_has "# sides are wrong: semantics 10 takes left for right and front for back"
sed '1s/semantics .*/semantics 11/' j.iftty >before
chain_anew before other.iftty
cp -r j.golden other.golden
expect 1 "$iftty" verify other.iftty
out_has "differs  scene"
rm -rf other.golden
expect 0 "$iftty" -c info --journal j.iftty
out_has "axes towards RPS,"
take 11
expect 0 "$iftty" -c info --journal j.iftty
out_has "axes towards LAS,"
for number in 1 4 5 9; do # as all before it
    printf '# iftty journal 1 semantics %s\n' $number >old.iftty
    expect 0 "$iftty" -c 'open las.nrrd; info' --journal old.iftty
    out_has "axes towards RPS,"
    out_has "sides are wrong: semantics $number takes"
done
close_story

begin "seeds of a file come to the same forest in journals of semantics 3 as since"
cp "$journals/scene.nii.gz" "$journals/waiting.csv" .
take 3-waiting
expect 0 "$iftty" verify j.iftty
expect 0 "$iftty" -c 'undo 2; slice coronal 9; seed-file waiting.csv; mosaic' --journal j.iftty
expect 0 "$iftty" verify j.iftty
sed '1s/semantics .*/semantics 4/' j.iftty >before
chain_anew before other.iftty
cp -r j.golden other.golden
expect 0 "$iftty" verify other.iftty # they differed in pictures alone, which are of a former look
close_story

begin "the record of open has the weight that it means, and one without it means morph"
cp "$journals/scene.nii.gz" .
weights_of() { # JOURNAL: of record 1
    sed -n 's/^= 1 .*weights=\([0-9a-f]*\).*/\1/p' "$1"
}
rm -f ./*.iftty
expect 0 "$iftty" -c 'open scene.nii.gz; seed 4,4,3 1; run' --journal new.iftty
[ "$(sed -n 2p new.iftty)" = "open scene.nii.gz weight=morph" ] || fail "$(sed -n 2p new.iftty)"
expect 0 "$iftty" verify new.iftty
expect 0 "$iftty" -c 'open scene.nii.gz weight=gauss:1.5' --journal gauss.iftty
expect 0 "$iftty" -c 'info; weight sobel; seed 4,4,3 1; run; undo 3; info' --journal gauss.iftty
[ "$(grep -c "weight gauss 1.5" "$work/out")" = 2 ] || fail "$(cat "$work/out")"
expect 0 "$iftty" verify gauss.iftty
[ "$(sed -n 2p gauss.iftty)" = "open scene.nii.gz weight=gauss:1.5" ] || fail "$(cat gauss.iftty)"
[ "$(weights_of gauss.iftty)" != "$(weights_of new.iftty)" ] || fail "gauss is morph"
for number in 1 2 3 4; do # as it was recorded before, and what that means
    printf '# iftty journal 1 semantics %s\n' $number >old.iftty
    expect 0 "$iftty" -c 'open scene.nii.gz; info' --journal old.iftty
    out_has "weight morph"
    [ "$(sed -n 2p old.iftty)" = "open scene.nii.gz" ] || fail "$number: $(cat old.iftty)"
    [ "$(weights_of old.iftty)" = "$(weights_of new.iftty)" ] || fail "$number: not morph"
    expect 0 "$iftty" verify old.iftty
done
sed -i '2s/ weight=morph//' new.iftty # as programs before have recorded it
expect 0 "$iftty" log --reseal new.iftty
expect 0 "$iftty" verify new.iftty
for wrong in morph: morph:4 morph:x sobel:1 gauss gauss:0.1 gauss:9 gauss: weights.nii ''; do
    rm -f new.iftty
    expect 2 "$iftty" -c "open scene.nii.gz weight=\"$wrong\"" --journal new.iftty
    err_has "weight: expected "
    ! grep -q "^open" new.iftty || fail "$wrong was recorded"
done
close_story

begin "the digest of labels is that of the number"
for number in 1 2 3; do
    take $number
    sed -n 's/^= 9 .*\(labels=[0-9a-f]*\).*/\1/p' j.iftty
done >labels
[ "$(sed -n 2p labels)" = "$(sed -n 3p labels)" ] || fail "2 and 3: $(cat labels)"
[ "$(sed -n 1p labels)" != "$(sed -n 2p labels)" ] || fail "1 and 2: $(cat labels)"
for number in 1 2; do # under another number it does not fit
    take $number
    sed "1s/semantics .*/semantics $((3 - number))/" j.iftty >other.iftty
    expect 1 "$iftty" replay other.iftty
    err_has "labels"
done
close_story

begin "golden images of a look that is gone are there, and neither compared nor made"
for number in 2 9; do
    take $number
    expect 0 "$iftty" verify --strict j.iftty
    cp "$journals/semantics-3.golden/inside.exr" j.golden/front.exr
    expect 0 "$iftty" verify --strict j.iftty
    for how in --strict --no-strict; do # evidence that is missing is none of a former look
        cp j.golden/front.png j.golden/front.exr
        expect 1 "$iftty" verify $how j.iftty
        rm j.golden/front.exr
        expect 1 "$iftty" verify $how j.iftty
        out_has "golden image front is missing"
    done
    take $number
    cp j.iftty former
    echo 'golden again' >one
    expect 2 "$iftty" run one --journal j.iftty
    err_has "the journal has semantics $number, whose pictures this program no longer draws"
    err_has "iftty log --reseal --accept WHY FILE"
    same_files j.iftty former
    [ ! -e j.golden/again.exr ] || fail "it was made"
done
close_story

begin "words of shade that are gone are still understood, and mean a smooth surface"
expect 0 "$iftty" -c 'open scene.nii.gz; seed 9,9,8 1 radius=3; seed 1,1,1 0; run; size 40 30
    shade surface; render; shade scene; render; shade depth; render; info; shade cubes; render' \
    --journal words.iftty
out_has "look      shade surface, light"
[ "$(grep '^= .*picture=' words.iftty | sed 's/.*\(picture=[^ ]*\).*/\1/' | uniq -c |
    awk '{ print $1 }' | tr '\n' ' ')" = "3 1 " ] || fail "$(cat words.iftty)"
grep -q '^shade scene$' words.iftty || fail "it is not recorded as it was typed"
expect 0 "$iftty" verify words.iftty
expect 0 "$iftty" help shade
out_has "shade surface|cubes "
close_story

begin "resealed with a reason, a journal has the present meaning, and pictures of today"
for number in $(seq 1 $((current - 1))) 3-waiting 4-contrary 4-unplaced 9-slices 10-las; do
    take "$number"
    cp "$journals"/*.nii.gz "$journals"/waiting.csv "$journals"/names.ctab .
    expect 0 "$iftty" log --reseal --accept 'one surface' j.iftty
    out_has "the former journal is stored as j.iftty.before-1"
    [ "$(head -1 j.iftty)" = "# iftty journal 1 semantics $current" ] || fail "$(head -1 j.iftty)"
    expect 0 "$iftty" verify --strict j.iftty
    ! grep -q "not compared" out || fail "$number: $(cat out)"
    [ "$number" != 1 ] || grep -q '^# accepted: one surface' j.iftty || fail "it does not say why"
    rm j.iftty.before-1
done
close_story

begin "without a reason golden images are not drawn anew, and it says what to do"
take 1
cp j.iftty former
listing j.golden >listed
expect 1 "$iftty" log --reseal j.iftty
err_has "1 golden image had a former look: iftty log --reseal --accept WHY FILE draws it anew"
same_files j.iftty former
listing j.golden | cmp -s - listed || fail "golden images were changed"
expect 1 "$iftty" verify --accept 'one surface' j.iftty
err_has "iftty log --reseal --accept WHY FILE brings it to that, with all of its pictures"
expect 2 env CI=true "$iftty" log --reseal --accept 'one surface' j.iftty
err_has "refused where CI is set"
expect 2 "$iftty" log --reseal --accept '' j.iftty
same_files j.iftty former
sed '/^golden/,$d' former >before # without any, nothing is in the way
chain_anew before j.iftty
rm -rf j.golden
expect 0 "$iftty" log --reseal j.iftty
expect 0 "$iftty" verify j.iftty
! grep -q "not compared" out || fail "$(cat out)"
close_story

begin "a number that is not known yet is refused, and the journal left alone"
take 3
sed "1s/semantics .*/semantics $((current + 1))/" j.iftty >next.iftty
cp next.iftty kept
expect 3 "$iftty" run more --journal next.iftty
err_has "version $((current + 1))"
err_has "version $current"
cmp -s next.iftty kept || fail "it was written to"
close_story

finish
