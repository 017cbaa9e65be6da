#!/bin/sh
# SPDX-License-Identifier: MIT
# The benchmarks as programs: their output in each form, and their errors. No time is checked.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1
bench=$build/tests/bench/bench
balanced() { # the brackets of the output
    same "$(tr -cd '{[' <"$work/out" | wc -c)" "$(tr -cd '}]' <"$work/out" | wc -c)"
}
IFTTY_SCENES=$work/none # geom in place of the brain of ch2
export IFTTY_SCENES

begin "the paper's experiments agree on geom, and are printed as text"
expect 0 "$bench" paper geom --quick --rounds 1 </dev/null
out_has "geom: 200x200x100, 4000000 voxels; median of 1 round, " "(5) DIFT + scan + BP"
out_has "identical labels, keys and pictures in all experiments: 8 comparisons"
out_has "paper             > 4     1.14"
same "$(wc -c <"$work/err")" 0 # no progress where there is no terminal
awk 'length > 100 { bad = 1 } END { exit bad }' "$work/out" ||
    fail "a line of more than 100 columns"

begin "JSON is JSON"
expect_out '"scene": "geom"' 0 "$bench" paper geom --quick --rounds 1 --json </dev/null
out_has '"identical": true' '"ift_to_dift"'
same "$(grep -c '"experiment":' "$work/out")" 10
balanced
"$PYTHON" -m json.tool "$work/out" >/dev/null 2>"$work/err" || fail "$(cat "$work/err")"

begin "one edit touches the same voxels in a scene eight times as large"
expect 0 "$bench" growth --quick --json </dev/null
same "$(grep -o '"touched": [^]]*' "$work/out" | sort -u | wc -l)" 1
same "$(grep -o '"voxels"' "$work/out" | wc -l)" 2

begin "the cost of a journal, part by part"
expect 0 "$iftty" -c 'open synth:geom:20x20x20; seed 5,5,5 1; seed 15,15,15 2
    size 64 64; render; golden one' \
    --journal "$work/small.iftty" </dev/null
expect_out "100000 records of " 0 "$bench" journal "$work/small.iftty" </dev/null
out_has "small.iftty, 6 records" "of forests and renditions" "with a sync each"
records=$(grep -c '^= ' tests/journals/semantics-12.iftty)
expect_out "\"journal\": {\"records\": $records, " \
    0 "$bench" journal tests/journals/semantics-12.iftty --json </dev/null
balanced
sed 's/^seed 5,5,5 1/seed 5,5,5 3/' "$work/small.iftty" >"$work/other.iftty"
expect_err "record 2" 1 "$bench" journal "$work/other.iftty" </dev/null
: >"$work/empty.iftty"
expect_err "there are no records to verify" 1 "$bench" journal "$work/empty.iftty" </dev/null
expect 3 "$bench" journal "$work/none.iftty" </dev/null

begin "runs, edits, pictures and memory of a scene"
expect 0 "$bench" brain --scene synth:geom:20x20x20 </dev/null
out_has "synth:geom:20x20x20: 8000 voxels, 660 seeds, "
out_has "an eliminator: update and incremental image" "bytes a voxel"
expect 0 "$bench" brain --scene synth:geom:20x20x20 --json </dev/null
out_has '"scratch_ms": {"median": ' '"seed_ms": {"median": ' '"bytes_per_voxel": '
balanced

begin "pictures for a terminal"
expect 0 "$bench" terminal --json </dev/null
out_has '"rendition": {"kitty": {"bytes": ' '"mosaic": {"kitty": ' '"patch": {"kitty": '
# a patch is a small part of a picture, whatever the encoding
for by in kitty sixel; do
    whole=$(sed "s/.*\"rendition\": {.*\"$by\": {\"bytes\": \([0-9]*\).*\"mosaic\".*/\1/" \
        "$work/out")
    patch=$(sed "s/.*\"patch\": {.*\"$by\": {\"bytes\": \([0-9]*\).*/\1/" "$work/out")
    [ "$patch" -gt 0 ] && [ $((patch * 4)) -lt "$whole" ] ||
        fail "$by: a patch takes $patch bytes, the picture $whole"
done
balanced

begin "from a key to its picture"
for try in 1 2 3; do # a busy machine can miss the moments in which it is asked about itself
    "$bench" keys --quick --json </dev/null >"$work/out" 2>"$work/err" && break
    grep -q ': the program showed nothing for [0-9]* s$' "$work/err" || fail "$(cat "$work/err")"
done
out_has '"start_to_prompt_ms": {"median": ' '"start_to_loaded_ms": {"median": ' \
    '"kitty_local": {"enter": {"keys": ' '"move": {"keys": ' '"sixel_local": {"enter": '
balanced

begin "the same pictures by chafa"
mkdir "$work/bin" # a chafa that shows a picture by the bytes of its file, in a cell or more
cat >"$work/bin/chafa" <<'EOS'
#!/bin/sh
case "$*" in *"-s 0x"* | *x0\ *) exit 1 ;; esac
for last; do :; done
cat "$last"
EOS
chmod +x "$work/bin/chafa"
PATH="$work/bin:$PATH" expect 0 "$PYTHON" -B tests/bench/chafa.py --quick --json "$build"
out_has '"rendition": {"kitty": {"bytes": ' '"mosaic": {"kitty": {"bytes": ' \
    '"sixel": ' '"blocks": '
PATH=$work/bin:$PATH expect 0 "$PYTHON" -B tests/bench/chafa.py --quick "$build"
same "$(grep -c '^chafa: ' "$work/out")" 2

begin "wrong usage is refused at once"
expect 2 "$bench" terminal --scene ch2.nii.gz
err_has '`bench terminal` has no option --scene; it belongs to '
expect_err '`bench journal` has no option --quick; it belongs to ' 2 "$bench" journal --quick
err_has 'it belongs to `bench paper`, `bench growth` and `bench keys`'
expect_err "bench: there is no program liver; see" 2 "$bench" liver
expect_err "bench: name a program; see" 2 "$bench"
expect 2 "$bench" growth --rounds 3
err_has '`bench growth` has no option --rounds; it belongs to `bench paper`'
expect_out "bench journal [JOURNAL]" 0 "$bench" --help
expect_out "--rounds N" 0 "$bench" paper --help
for scene in liver brain2 brain213 brain2111 ch2better211 geom-211 ""; do
    expect 2 "$bench" paper geom "$scene"
    err_has \
        "expected brain or geom, as they are or interpolated as in brain211, or ch2better, or all"
done
for rounds in 0 100 x 3x -1 ""; do
    expect_err "--rounds: expected a number 1..99" 2 "$bench" paper geom --rounds "$rounds"
done

begin "without the scene of brain the message names the file"
mkdir -p "$work/none"
expect_err "brain: there is no scene ch2.nii.gz here" 3 "$bench" paper brain

finish
