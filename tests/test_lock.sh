#!/bin/sh
# SPDX-License-Identifier: MIT
# Which journals are meant: --expect a last chain, and a lock, which pins the journals of a folder.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16
mkdir -p study/deep
cp s.nii study
cp s.nii study/deep

record() { # JOURNAL LABEL
    "$iftty" -c "open s.nii; seed 2,3,4 $2; seed 6,10,8 7; run; size 40 30; golden first" \
        --journal "$1" >/dev/null || fail "cannot record $1"
}
record study/a.iftty 1
record study/b.iftty 2
record study/deep/c.iftty 3
lock=study/iftty.lock
locked() { # STATUS WORDS...: a verification by the lock ends so, and says so
    wanted_status=$1
    shift
    expect "$wanted_status" "$iftty" verify --lock "$lock"
    for words; do out_has "$words"; done
}

begin "a journal has the chain that is expected, or fails"
chain=$(last_word chain study/a.iftty)
expect 0 "$iftty" verify study/a.iftty --expect "$chain"
head -n "$(($(wc -l <study/a.iftty) - 2))" study/a.iftty >study/short.iftty
cp -r study/a.golden study/short.golden
rm study/short.golden/*
expect 0 "$iftty" verify study/short.iftty # its end is gone, and nothing in it says so
expect 1 "$iftty" verify study/short.iftty --expect "$chain"
out_has "# its last chain is $(last_word chain study/short.iftty), and $chain was expected"
rm -r study/short.*
for wrong in "--expect $chain study/b.iftty" "--expect 12 --expect" "--expect ${chain}0" \
    "--expect $(echo "$chain" | tr a-f A-F)x"; do
    # shellcheck disable=SC2086
    expect 2 "$iftty" verify study/a.iftty $wrong
done
close_story

begin "a lock pins the journals of a folder and of those below it"
expect 0 "$iftty" verify --lock "$lock" --update-lock
out_has "# new in the lock: a.iftty"
out_has "# new in the lock: deep/c.iftty"
same "$(head -n 7 "$lock")" "# iftty lock 2
journal a.iftty
chain $chain
records 6
scene $(last_word scene study/a.iftty)
golden first $(sha256sum study/a.golden/first.exr | cut -c 1-64)
png first $(sha256sum study/a.golden/first.png | cut -c 1-64)"
locked 0 "ok 1 - study/a.iftty" "ok 3 - study/deep/c.iftty" "# 3 verified, 0 failed"
cp "$lock" kept
expect 0 "$iftty" verify --lock "$lock" --update-lock
out_has "# nothing has changed in $lock"
same_files "$lock" kept
expect_in study/deep 0 "$iftty" verify --lock ../iftty.lock c.iftty
out_has "1..1"
expect 0 env CI=true "$iftty" verify --lock "$lock" -j 3
close_story

begin "journals that are missing, added or changed are each named"
mv study/a.iftty gone
cp study/b.iftty study/new.iftty
cp -r study/b.golden study/new.golden
expect 0 "$iftty" -c 'label 3 liver' --journal study/deep/c.iftty
locked 1 "not ok 1 - study/a.iftty" "# missing: $lock names it, and there is no such file" \
    "ok 2 - study/b.iftty" "not ok 3 - study/deep/c.iftty" \
    "#   pinned   chain: $(sed -n '/deep/{n;s/chain //p;}' "$lock"), and it is\
 $(last_word chain study/deep/c.iftty) now" "#   pinned   records: 6, and it is 7 now" \
    "# changed: it is not the journal that $lock names" "not ok 4 - study/new.iftty" \
    "# added: $lock does not name it; --update-lock takes it in" "# 1 verified, 3 failed"
# Some of them, by name: nothing is said of the others.
expect 0 "$iftty" verify --lock "$lock" study/b.iftty
out_has "1..1"
expect 1 "$iftty" verify --lock "$lock" study/new.iftty
expect 0 "$iftty" verify --lock "$lock" --update-lock study/deep/c.iftty
out_has "# changed in the lock: deep/c.iftty"
locked 1 "# 2 verified, 2 failed"
expect 0 "$iftty" verify --lock "$lock" --update-lock
out_has "# no longer in the lock: a.iftty"
out_has "# new in the lock: new.iftty"
locked 0 "# 3 verified, 0 failed"
mv gone study/a.iftty
rm -r study/new.iftty study/new.golden
close_story

begin "bytes after the last record, which no chain covers, are none of that journal"
expect 0 "$iftty" verify --lock "$lock" --update-lock
cp study/a.iftty sound
chain=$(last_word chain study/a.iftty)
for tail in '# reviewed by Dr X, all well\n' '\n' 'seed 1,1,1 1' '\0\0\0'; do
    cp sound study/a.iftty
    # shellcheck disable=SC2059
    printf "$tail" >>study/a.iftty
    expect 0 "$iftty" verify study/a.iftty
    for part in "" "--until 3"; do
        # shellcheck disable=SC2086
        expect 1 "$iftty" verify study/a.iftty --expect "$chain" $part
        out_has "# --expect: it ends with an unfinished record, at byte $(file_bytes sound)"
    done
    locked 1 "not ok 1 - study/a.iftty" "ok 2 - " \
        "# --lock: it ends with an unfinished record, at byte $(file_bytes sound), which no chain"
    expect 1 "$iftty" verify --lock "$lock" --update-lock
    err_has "$lock is left alone: "
done
cp sound study/a.iftty
locked 0
close_story

begin "a journal made anew from end to end, with a golden image to match, is another one"
expect 0 "$iftty" verify --lock "$lock" --update-lock
record other.iftty 5
cp other.iftty study/b.iftty
cp other.golden/first.* study/b.golden
expect 0 "$iftty" verify --strict study/b.iftty
locked 1 "not ok 2 - study/b.iftty" "#   pinned   golden first: " "and it is $(sha256sum \
    study/b.golden/first.exr | cut -c 1-64) now"
close_story

begin "the PNG that people look at is pinned: gone, added, or other bytes of the same pixels"
expect 0 "$iftty" verify --lock "$lock" --update-lock
mv study/a.golden/first.png .
expect 0 "$iftty" verify --strict study/a.iftty
locked 1 "not ok 1 - study/a.iftty" "#   pinned   png first: $(sha256sum first.png |
    cut -c 1-64), and there is none now"
oiiotool first.png --compression zip:1 -o study/a.golden/first.png 2>/dev/null ||
    cp first.exr study/a.golden/first.png
locked 1 "#   pinned   png first: "
cp first.png study/a.golden
locked 0
close_story

begin "nothing is said of a file that a link leads to in the place of a golden image or PNG"
echo 'a secret' >secret
hidden=$(sha256sum secret | cut -d ' ' -f 1)
for name in first.exr first.png; do
    cp study/a.golden/$name kept
    ln -sf "$work/secret" study/a.golden/$name
    for way in '' "/usr/bin/python3 $top/tests/volumes/without_landlock.py"; do
        # shellcheck disable=SC2086
        expect 1 $way "$iftty" verify --lock "$lock"
        out_has ", and there is none now"
        ! grep -q "$hidden" out err || fail "its digest is told: $(grep "$hidden" out err)"
    done
    rm study/a.golden/$name
    mv kept study/a.golden/$name
done
locked 0
close_story

begin "a lock of version 1, which pins no PNG, is valid as it was, and says so"
cp "$lock" kept
sed '1s/2/1/; /^png /d' kept >"$lock"
locked 0 "# $lock is of the form before, and does not pin its PNGs; --update-lock does"
rm study/a.golden/first.png
locked 0
cp study/b.golden/first.png study/a.golden # that is another picture
locked 1 ": study/a.golden/first.png: it shows another picture than the golden image beside it"
cp first.png study/a.golden
expect 2 "$iftty" verify --lock "$lock" --update-lock study/a.iftty
err_has "$lock is of the form before, which pins no PNGs: --update-lock with no journals named"
sed '1s/2/1/' kept >"$lock" # a line that version 1 has not
expect 3 "$iftty" verify --lock "$lock"
err_has "$lock: line 7: expected "
sed '1s/2/1/; /^png /d' kept >"$lock"
expect 0 "$iftty" verify --lock "$lock" --update-lock
same_files "$lock" kept
close_story

begin "a lock is written where all verify, by a person, and only then"
cp "$lock" kept
cp study/b.golden/first.exr study/a.golden/first.exr
expect 1 "$iftty" verify --lock "$lock" --update-lock
err_has "$lock is left alone: "
expect 2 env CI=true "$iftty" verify --lock "$lock" --update-lock
err_has "--update-lock is a person's decision, and refused where CI is set"
expect 2 "$iftty" verify study/a.iftty --update-lock
expect 2 "$iftty" verify --lock "$lock" --update-lock --until 3
expect 2 "$iftty" verify --lock "$lock" other.iftty # which lies elsewhere
err_has "other.iftty: a lock has journals *.iftty in its own folder and those below it"
expect 2 "$iftty" verify
err_has "name a journal, or a lock by --lock FILE"
expect 3 "$iftty" verify --lock nothing.lock
mkdir empty
expect 1 "$iftty" verify --lock empty/iftty.lock --update-lock
err_has "there is no journal *.iftty where empty/iftty.lock lies"
same_files "$lock" kept
close_story

begin "a lock that is not as iftty writes it is refused, with the line"
bad() { # LINE SED-SCRIPT
    sed "$2" kept >"$lock"
    ! cmp -s kept "$lock" || fail "$2: nothing was changed"
    expect 3 "$iftty" verify --lock "$lock"
    err_has "$lock: line $1: expected "
    [ ! -s out ] || fail "$2: it verified something"
}
bad 1 '1s/2$/3/'
bad 1 '1s/2$/0/'
bad 1 '1s/$/ /'
bad 1 '1d'
bad 2 '2s/a.iftty/..\/a.iftty/'
bad 2 '2s/a.iftty/\/a.iftty/'
bad 2 '2s/a.iftty/deep\/\/a.iftty/'
bad 2 '2s/a.iftty/a/'
bad 2 '2,4d' # a scene of no journal
bad 2 '2,5d'
bad 3 '3s/chain ./chain X/'
bad 3 '3s/$/0/'
bad 3 '3d'
bad 4 '4s/records /records 0/'
bad 4 '4s/ 6/ -6/'
bad 5 '5s/ / 	/'
bad 6 '5p'
bad 6 '6s/first/..\/first/'
bad 7 '6p'
bad 8 '7p'
bad 7 '7s/first/..\/first/'
bad 7 '6{h;d;};7G' # in another order
bad 14 '8s/b/z/'
bad 9 '8p'
bad 7 '6s/$/\n/'
printf 'journal x' >>"$lock"
cat kept >"$lock"
printf 'journal x.iftty' >>"$lock"
expect 3 "$iftty" verify --lock "$lock"
err_has "expected a line of text that ends with a line feed"
head -c 3000 /dev/urandom >"$lock"
expect 3 "$iftty" verify --lock "$lock"
close_story

finish
