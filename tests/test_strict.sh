#!/bin/sh
# Green means proven: what leaves anything of a journal unproven fails a strict verification, which
# is the default where CI is set; the line of a journal that passes says what was compared.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,8 2 radius=1; run; size 40 30; view 30 20
    golden first; render; seed 20,10,8 3; run' --journal j.iftty >/dev/null || exit 1
header=$(head -n 1 j.iftty)

# weak WORDS JOURNAL: it passes as a rule, and fails, saying so, wherever verification is strict
weak() {
    expect 0 "$iftty" verify "$2"
    expect 0 "$iftty" verify --no-strict "$2"
    expect 1 "$iftty" verify --strict "$2"
    out_has "not ok 1 - $2"
    out_has "# strict: $1"
    cp out strict
    expect 1 env CI=true "$iftty" verify "$2"
    same_files out strict
    expect 0 env CI=true "$iftty" verify --no-strict "$2"
    expect 0 env CI= "$iftty" verify "$2"
    expect 1 "$iftty" verify --strict --junit weak.xml "$2"
    grep -q "message=\"strict: " weak.xml || fail "the report gives no reason"
}
copy() { # NAME: the journal and its golden images under another name
    cp j.iftty "$1.iftty"
    cp -r j.golden "$1.golden"
}

begin "the line of a journal that passes says what was compared"
for how in "" --strict; do
    # shellcheck disable=SC2086
    expect 0 "$iftty" verify $how j.iftty
    same "$(head -n 1 out)" \
        "ok 1 - j.iftty (10 commands, 10 results with 19 digests, 1 golden image of 1200 pixels)"
done
expect 0 "$iftty" verify --strict --json j.iftty
for figure in '"commands": 10' '"results_the_same": 10' '"digests": 19' '"golden_images": 1' \
    '"pixels": 1200' "\"chain\": \"$(last_word chain j.iftty)\""; do
    out_has "$figure"
done
expect 2 "$iftty" verify --strict --no-strict j.iftty
err_has "--strict and --no-strict: give one of them"
close_story

begin "digests that were taken out, all or of one record, with the chain computed anew"
copy none
sed 's/^\(= [0-9]*\) .* chain=/\1 chain=/' j.iftty >before
chain_anew before none.iftty
expect 0 "$iftty" log --check none.iftty
weak "8 records without a digest of what the command gives, the first is record 1 (line 2)" \
    none.iftty
copy one
rewrite one.iftty 10 'seeds=9'
weak "1 record without a digest of what the command gives, the first is record 10" one.iftty
expect 0 "$iftty" log --reseal one.iftty
same "$(words_of one.iftty 10)" "$(words_of j.iftty 10)"
expect 0 "$iftty" verify --strict one.iftty
close_story

begin "no golden image, or no record at all"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run' --journal plain.iftty >/dev/null
weak "no golden image was compared: " plain.iftty
expect 0 "$iftty" verify --strict --until 2 plain.iftty # a part is not asked for one
printf '%s\n' "$header" >header.iftty
weak "it has a header and no records" header.iftty
for bytes in 0 5 20; do
    head -c "$bytes" j.iftty >begun.iftty
    expect 1 "$iftty" verify --strict begun.iftty
done
close_story

begin "an unfinished record at the end"
copy torn
printf 'seed 1,1,1 1\n' >>torn.iftty
weak "it ends with an unfinished record, at byte $(file_bytes j.iftty)" torn.iftty
out_has "# an unfinished record at byte"
close_story

begin "semantics that are not known here, and those whose pictures cannot be drawn any more"
copy next
sed "1s/semantics .*/semantics 99/" j.iftty >before
chain_anew before next.iftty
weak "it was written with semantics 99, and this program knows 1 to " next.iftty
cp "$top"/tests/journals/scene.nii.gz .
for number in 1 2; do
    cp "$top/tests/journals/semantics-$number.iftty" old.iftty
    weak "3 results of semantics $number could not be compared" old.iftty
done
close_story

begin "a PNG that shows something else than the golden image beside it"
copy seen
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first' --journal o.iftty >/dev/null
cp o.golden/first.png seen.golden/first.png
weak_png() { # WORDS
    expect 0 "$iftty" verify seen.iftty
    expect 1 "$iftty" verify --strict seen.iftty
    out_has "$1"
}
weak_png "strict: seen.golden/first.png shows another picture than the golden image beside it, in "
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 31; golden first' --journal p.iftty >/dev/null
cp p.golden/first.png seen.golden/first.png
weak_png "strict: seen.golden/first.png has another size than the golden image beside it"
head -c 100 j.golden/first.png >seen.golden/first.png
weak_png "strict: seen.golden/first.png cannot be read: "
rm seen.golden/first.png # nothing needs it
expect 0 "$iftty" verify --strict seen.iftty
close_story

begin "the PNG is over the background of its time, or has alpha; another background shows"
printf '%s\n' 'open s.nii' 'seed 2,3,4 1' run 'size 60 50' 'view 30 20' 'samples 4' 'golden grey' \
    'background white' 'golden page' 'background transparent' 'golden clear' \
    'decorate letters' 'golden named' 'background black' 'golden all of=mosaic' >script
expect 0 "$iftty" run script --journal ground.iftty
expect 0 "$iftty" verify --strict ground.iftty
out_has "5 golden images"
for other in grey clear; do
    rm -rf seen.golden
    cp -r ground.golden seen.golden
    cp ground.iftty seen.iftty
    cp ground.golden/page.png seen.golden/$other.png
    weak_png "strict: seen.golden/$other.png shows another picture than the golden image beside it"
done
close_story

begin "a recorded word that no command gives fails always"
copy word
rewrite word.iftty 4 "$(words_of j.iftty 4) flavour=sweet"
expect 1 "$iftty" verify --no-strict word.iftty
out_has "differs  flavour"
close_story

begin "the journals of every semantics whose pictures can be drawn are strictly verified"
cp "$top"/tests/journals/*.nii.gz .
for journal in "$top"/tests/journals/*.iftty; do
    case $journal in *-[12].iftty) continue ;; esac
    expect 0 env CI=true "$iftty" verify "$journal" || fail "$(cat out)"
done
close_story

finish
