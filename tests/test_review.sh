#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty verify --review in a real terminal: each picture that differs is shown, a person decides.
. "$(dirname "$0")/lib.sh"
. tests/tmux.sh
begin_terminal
cd "$work" || exit 1
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,8 2 radius=1; run; size 40 30; view 30 20
    golden first; turn 20; golden second; render; turn 30; golden third' \
    --journal j.iftty >/dev/null || exit 1
cp j.iftty kept.iftty
cp -r j.golden kept.golden

begin "in no pipe, and not where CI is set"
expect 2 "$iftty" verify --review j.iftty </dev/null
err_has "--review asks a person at a terminal; --accept WHY takes in all pictures of a journal"
close_story

# spoil: two golden images show something else, and the digest of a picture is another one
spoil() {
    rm -rf j.iftty* j.golden
    cp -r kept.golden j.golden
    cp kept.golden/third.exr j.golden/first.exr
    cp kept.golden/first.exr j.golden/third.exr
    cp kept.iftty j.iftty
    rewrite j.iftty 10 "$(words_of kept.iftty 10 | sed 's/picture=.*/picture=00000000000000aa/')"
    cp j.iftty spoilt
}
# The question about a record is asked: what is typed while its picture is drawn answers nothing.
asks() {
    screen_text | awk -v record="^j.iftty, record $1" '$0 ~ record { drawn = 1 }
        drawn && /^a accept   r reject   s skip   q quit/ { asked = 1 } END { exit !asked }'
}
see_question() { # RECORD
    comes_true asks "$1" || fail "record $1; the screen is:" "$(screen_text | grep .)"
}
review() { # OPTION...
    enter_anew "$iftty verify --review --graphics blocks $* j.iftty; echo sta\"\"tus \$?"
    see_question "7: golden first"
}

begin "each picture is shown, and those that are accepted are taken in, with their reasons"
spoil
review
see "^golden image first: .* pixels differ"
see "^expected . actual . what differs, in red"
shows '[▀▄█▌▐▘▝▖▗▚▞▛▜▟▙]' || fail "no picture in blocks: $(screen_text)"
type_letters a
see "^Why is it right"
enter "softer light"
see_question "10: render"
see "^its picture has another digest than is recorded"
type_letters x # which is no answer
type_letters s
see_question "12: golden third"
type_letters a
see "^Why is it right. .softer light."
enter ""
see "^status 1"
see "2 golden images accepted, 2 of 12 records of j.iftty marked"
see "0 pictures of j.iftty rejected, 1 skipped: it goes on failing"
same "$(grep -c '^# accepted: softer light (golden image ' j.iftty)" 2
same "$(words_of j.iftty 10)" "picture=00000000000000aa"
expect 0 "$iftty" log --check j.iftty
expect 1 "$iftty" verify j.iftty
out_has "record 10, line"
same_files j.iftty.before-1 spoilt
sane
close_story

begin "what is rejected or skipped stays as it was, to the byte"
spoil
cp -r j.golden golden.spoilt
review
type_letters r
see_question "10: render"
type_letters q
see "^status 1"
see "1 picture of j.iftty rejected, 2 skipped: it goes on failing"
same_files j.iftty spoilt
diff -r j.golden golden.spoilt || fail "a golden image has changed"
[ ! -e j.iftty.before-1 ] || fail "the journal was written"
close_story

begin "a reason that is given is not asked for, and what is all accepted verifies"
spoil
review --accept rounding
type_letters a
see_question "10: render"
type_letters a
see_question "12: golden third"
type_letters a
see "^status 0"
same "$(grep -c '^# accepted: rounding' j.iftty)" 3
expect 0 "$iftty" verify --strict j.iftty
for name in first third; do
    "$iftty" info j.golden/$name.exr >said
    grep -q 'iftty:journal: j.iftty' said || fail "$(cat said)"
done
enter_anew "$iftty verify --review j.iftty; echo sta\"\"tus \$?"
see "^status 0"
see "0 golden images accepted, 0 of 12 records of j.iftty marked"
close_story

begin "Ctrl-C leaves all as it was, also after some were accepted"
spoil
rm j.golden/third.exr
review
type_letters a
see "^Why is it right"
enter "softer light"
see_question "10: render"
type_letters a
see "^Why is it right"
enter ""
see_question "12: golden third"
see "^there is no golden image . actual"
press C-c
see "^status 130"
same_files j.iftty spoilt
same "$(ls -A j.golden | tr '\n' ' ')" "first.exr first.png second.exr second.png third.png "
enter_anew "CI=1 $iftty verify --review j.iftty; echo sta\"\"tus \$?"
see "^status 2"
see "review is a person.s decision, and refused where CI is set"
sed '1s/semantics .*/semantics 4/' j.iftty >old.iftty
enter_anew "$iftty verify --review old.iftty; echo sta\"\"tus \$?"
see "^iftty: old.iftty: it has semantics 4, of a build before 1.0"
see "^status 3"
sane
close_story

begin "what takes long says so at a terminal"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; save labels s.mha' >/dev/null
"$iftty" -c 'open s.mha; seed 2,3,4 1; run' --journal slow.iftty >/dev/null
mkdir slow
cp "$iftty" slow
cp /usr/bin/sort slow/iftty-volume # takes a request, and answers nothing
for words in "verifying: verify slow.iftty" "replaying: diff slow.iftty slow.iftty" \
    "replaying: log --procedure - slow.iftty" \
    "replaying: apply slow.iftty s.nii --by world --out none"; do
    enter_anew "slow/iftty ${words#*: }; echo sta\"\"tus \$?"
    see "^${words%%:*} +[0-9]+ s"
    press C-c
    see "^status 130"
done
[ ! -e none ] || fail "apply has left a folder"
sane
close_story

finish
