#!/bin/sh
# SPDX-License-Identifier: MIT
# Meanings are versioned: tests/journals has journals NAME-N.iftty of every number N from 12 on,
# made by a program of its time. Each is verified and continued under its own meaning. Other numbers
# are refused.
. "$(dirname "$0")/lib.sh"
journals=$top/tests/journals
cp "$journals"/*.nii.gz "$journals"/*.c* .
first=12
current=$("$iftty" info | sed -n 's/^semantics //p')

take() { # NAME: a copy, with its golden images
    rm -rf j.iftty j.golden
    cp "$journals/$1.iftty" j.iftty
    cp -r "$journals/$1.golden" j.golden
}
names=$(cd "$journals" && ls ./*.iftty | sed 's|./||; s/[.]iftty//')

begin "there is a journal of every number up to the present one"
[ "$current" -ge $first ] || fail "number $current"
for number in $(seq $first "$current"); do
    expect_out "# iftty journal 1 semantics $number" 0 head -1 "$journals/semantics-$number.iftty"
done

begin "all of them verify, strictly as under CI"
expect 0 env CI=true "$iftty" verify "$journals"
out_has "# $(find "$journals" -name '*.iftty' | wc -l) verified, 0 failed"

begin "the page of the format is enough to read them, and the examples"
expect 0 "$PYTHON" "$top/tests/read_journal.py" "$top/journal/FORMAT.md" "$journals"/*.iftty \
    "$top"/examples/*.iftty || fail "$(tail -n 3 "$work/err")"

begin "each is verified under its own meaning"
for name in $names; do
    take "$name"
    expect 0 "$iftty" verify --strict j.iftty
    [ "$(grep -c '^= .* forest=' j.iftty)" -gt 3 ] || fail "$name: nothing is compared"
    for key in forest labels weights; do
        sed "0,/ $key=[0-9a-f]*/s// $key=0123456789abcdef/" j.iftty >before
        chain_anew before other.iftty
        cp -r j.golden other.golden
        expect_out "differs  $key" 1 "$iftty" verify other.iftty
        rm -rf other.golden
    done
done

begin "each is continued under its own meaning, and is a journal of its number still"
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
for name in $names; do
    take "$name"
    cp j.iftty former
    expect 0 "$iftty" run more --journal j.iftty
    cmp -s -n "$(wc -c <former)" former j.iftty || fail "$name: what was there has changed"
    [ "$(grep -c '^= ' j.iftty)" = $(($(grep -c '^= ' former) + 7)) ] ||
        fail "$name: $(tail -3 j.iftty)"
    expect 0 "$iftty" verify j.iftty
done

begin "commands of every number are written, and saved files have the values, as before"
for name in $names; do
    take "$name"
    expect 0 "$iftty" log --script j.iftty
    cp "$work/out" printed
    mkdir again.golden
    cp j.golden/labels-* again.golden
    expect 0 "$iftty" run printed --journal again.iftty --out again.out --who anna --times
    expect 0 "$PYTHON" "$top/tests/read_journal.py" "$top/journal/FORMAT.md" again.iftty
    sed '1d; /^=/d; /^#@/d' j.iftty >then
    sed '1d; /^=/d; /^#@/d' again.iftty | diff then - >different || fail "$name: $(cat different)"
    for file in again.out/*.nii.gz again.out/*.stl; do
        [ -e "$file" ] || continue
        case $file in
        *.gz) gzip -dc "$file" >map.nii && voxels_of map.nii ;;
        *) tail -c +81 "$file" ;;
        esac | cksum
    done >sums
    same_files sums "$journals/$name.sums"
    rm -rf again.*
done

# By tests/promises.txt, which test_promises compares with the table of commands.
begin "the journals of the present number have every recorded command and its parameters"
not_recorded=' compare hint hints history info journal measure pick profile quit stats sync why '
of_files=' data= empty= finished= identity= replace= resample= threshold= times= volume= '
grep -h '^[^=#]' "$journals"/*-"$current".iftty >commands
sed -n 's/^command \([a-z-]*\)\( [a-z]*=\)\{0,1\}$/\1 \2/p' "$top/tests/promises.txt" >table
while read -r name key; do
    case $not_recorded in *" $name "*) continue ;; esac
    case $name in open | origin) key= ;; esac
    case $of_files in *" ${key:--} "*) continue ;; esac
    grep -q "^$name\( .*\)\{0,1\}${key:+ $key}" commands || fail "no $name $key"
done <table
[ "$(wc -l <table)" -gt 150 ] || fail "few lines: $(wc -l <table)"

# refused WORDS COMMAND...: status 3, one line with these words, and the journal is left alone
refused() {
    words=$1
    shift
    cp other.iftty kept
    expect 3 "$@" </dev/null
    cat "$work/out" "$work/err" | grep -q "$words" || fail "$*: $(cat "$work/out" "$work/err")"
    [ "$(wc -l <"$work/err")" -le 1 ] || fail "$*: $(cat "$work/err")"
    same_files other.iftty kept
}
# refused_everywhere NUMBER WORDS: by whatever carries the commands of a journal out
refused_everywhere() {
    take "semantics-$current"
    sed "1s/semantics .*/semantics $1/" j.iftty >before
    chain_anew before other.iftty
    rm -rf other.golden
    cp -r j.golden other.golden
    refused "$2" "$iftty" verify other.iftty
    refused "$2" "$iftty" verify --strict other.iftty
    refused "$2" "$iftty" verify --accept 'why not' other.iftty
    refused "$2" "$iftty" log --reseal other.iftty
    refused "$2" "$iftty" log --reseal --accept 'why not' other.iftty
    refused "$2" "$iftty" replay other.iftty --out replayed
    refused "$2" "$iftty" run more --journal other.iftty
    refused "$2" "$iftty" -c info --journal other.iftty
    refused "$2" "$iftty" other.iftty
    refused "$2" "$iftty" serve other.iftty
}
begin "a number of a build before 1.0 is rejected, with the program line that prints its commands"
for number in 1 11; do
    refused_everywhere $number "it has semantics $number, of a build before 1.0, and this program \
knows $current: .iftty log --script FILE. prints its commands"
    expect 0 "$iftty" log --script other.iftty
    grep -v '^#' "$work/out" >printed
    grep -v '^[=#]' other.iftty | cmp -s - printed || fail "$(diff other.iftty printed)"
    expect 0 "$iftty" log other.iftty
    expect 0 "$iftty" log --check other.iftty
    mkdir again.golden
    cp j.golden/labels-* again.golden
    expect 0 "$iftty" run printed --journal again.iftty --out again.out --who anna --times
    expect 0 "$PYTHON" "$top/tests/read_journal.py" "$top/journal/FORMAT.md" again.iftty
    [ "$(head -1 again.iftty)" = "# iftty journal 1 semantics $current" ] || fail "no new journal"
    rm -rf again.*
done

begin "a number that is not known yet is refused"
refused_everywhere $((current + 1)) \
    "it has semantics $((current + 1)), and this program knows $current: a newer iftty verifies"

begin "the record of open has the weight that it means, and one without it means morph"
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
sed -i '2s/ weight=morph//' new.iftty
expect 0 "$iftty" log --reseal new.iftty
expect 0 "$iftty" verify new.iftty
for wrong in morph: morph:4 morph:x sobel:1 gauss gauss:0.1 gauss:9 gauss: weights.nii ''; do
    rm -f new.iftty
    expect 2 "$iftty" -c "open scene.nii.gz weight=\"$wrong\"" --journal new.iftty
    err_has "weight: expected "
    ! grep -q "^open" new.iftty || fail "$wrong was recorded"
done

# Only the files that read SEMANTICS are compiled again.
begin "the new meaning in src/README.md is that of new journals; those of 12 keep theirs"
if copy_tree; then
    sed -n '/^```diff/,/^```$/p' "$top/src/README.md" | grep -v '^```' >patch
    expect_in tree 0 git apply --unidiff-zero "$work/patch"
    touch $(grep -l SEMANTICS -r tree/src --include='*.c')
    expect 0 make -C tree -o src/session/session.h VARIANT=release SANITISE= build/iftty
    next=$work/tree/build/iftty number=$((current + 1))
    grep -q "^| $number " tree/journal/FORMAT.md || fail "no row"
    expect 0 env CI=true "$next" verify "$journals"
    seeds='seed 12,3,3 2; run' # of one voxel, or of seven
    take "semantics-$current"
    cp j.iftty other.iftty
    expect 0 "$iftty" -c "$seeds" --journal j.iftty --out old
    expect 0 "$next" -c "$seeds" --journal other.iftty --out old
    same_files j.iftty other.iftty
    expect 0 "$next" -c "open scene.nii.gz; $seeds" --journal next.iftty
    same "$(sed 1q next.iftty), $(last_word seeds next.iftty)" \
        "# iftty journal 1 semantics $number, 7"
    expect 0 "$next" verify next.iftty
    expect_out "it has semantics $number, and this program knows $current: a newer iftty" \
        3 "$iftty" verify next.iftty
fi

finish
