#!/bin/sh
# SPDX-License-Identifier: MIT
# A journal that somebody watches: keys into a real terminal (tmux, 80x24), pages for a browser, and
# journals of strangers, which write nothing, read nothing else, and take no more than they may.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
. "$top/tests/tmux.sh"

make_scene s.nii 24 20 16
printf '%s\n' "open s.nii" "auto on" "label 1 head" "label 2 hole" "# Where it is bright." \
    "seed 12,10,8 1 radius=2" "seed 1,1,1 0" "seed 20,15,12 2" "undo" "turn 30" \
    "# <b>Now</b> the \"other\" one." "seed 4,15,12 2 radius=1" "render after.png" >script
"$iftty" run script --journal e.iftty >/dev/null || fail "no journal can be made"
begin_terminal

begin "space leads through a journal, and what a step changed is told"
before=$(listing . | grep -v tmux)
enter_anew "$iftty watch e.iftty"
see '^the beginning, before step 1 of 7$'
see '^Space on  Backspace back  G end  p play  m largest  : command  \? keys  q back$'
press Space
see '^step 1 of 7, record [0-9]+: label 1 head'
press Space Space
see '^step 2 of 7, record [0-9]+: label 2 hole'
type_letters "3G"
see '^step 3 of 7, record [0-9]+: seed 12,10,8 1 radius=2$'
see '^Where it is bright\.$'
see '^0 -[0-9.]+ m[lm]3?, 1 head \+[0-9.]+ m[lm]3?; 7680 voxels changed$'
close_story

begin "backspace leads back, a number to its step, and what was undone is said"
press Space
see '^step 4 of 7, record [0-9]+: seed 1,1,1 0$'
see '^0 \+'
press BSpace
see '^step 3 of 7, '
type_letters "5G"
see '^step 5 of 7, record [0-9]+: seed 20,15,12 2  \(undone later\)$'
type_letters "a"
see '^what was undone or given up is skipped$'
type_letters "4G"
see '^step 4 of 7, '
see '^0 \+'
press Space
see '^step 7 of 7, record [0-9]+: seed 4,15,12 2 radius=1$'
see '^<b>Now</b> the "other" one\.$'
close_story

begin "keys lead to the next step of a label, and to the largest change"
type_letters "gg"
see '^the beginning'
type_letters "2n"
see '^step 7 of 7, '
type_letters "m"
see '^step 3 of 7, '
see '7680 voxels changed$'
close_story

begin "one looks as one likes, and changes nothing"
type_letters "]"
type_letters "ll"
type_letters ":stats"
press Enter
see 'label|head'
press q
type_letters ":seed 1,1,1 3"
press Enter
see 'nothing is planted here; `iftty watch --quiz` asks you to'
type_letters ":undo"
press Enter
see 'this is for looking: only questions'
type_letters "c"
see '^Where it is bright\.$'
press x
see '^step 3 of 7, '
close_story

begin "a key plays it to its end, where it says whether the journal is verified"
type_letters "gg"
see '^the beginning'
type_letters ">>>>p"
see '^the end: 7 steps, 1[0-9] records$'
see '^verified: 1[0-9] commands carried out again, 1[0-9] results the same$'
press BSpace
see '^step 7 of 7, '
type_letters "q"
see '^verified: '
sane
same "$(listing . | grep -v 'tmux\|modes')" "$before"
close_story

begin "with a quiz the learner plants first, and both are compared"
enter_anew "$iftty watch e.iftty --quiz; echo ends \$?"
see '^the beginning'
type_letters "3G"
see '^YOUR TURN, before step 3 of 7$'
see '^go where the next gesture belongs; i plants the brush there'
screen_text | grep -q '12,10,8' && fail "it gives the place away"
type_letters "++s2"
see '^step 3 of 7, record [0-9]+: seed 12,10,8 1 radius=2$'
see '^0\.0 mm away, label 2 hole, not 1 head, overlap 0\.00: [0-9.]+ .*, theirs 7\.68 ml$'
press Space
see '7680 voxels changed$'
press Space
see '^YOUR TURN, before step 4 of 7$'
press Space
see '^step 4 of 7, '
type_letters "G"
see '^1 of 2 gestures tried: labels right 0, median distance 0\.0 mm, mean overlap 0\.00$'
see '^verified: '
type_letters "q"
see '^ends 0$'
see '^1 of 2 gestures tried'
sane
close_story

begin "pages are there whole, hold what the journal says as text, and nothing else"
expect 0 "$iftty" watch e.iftty --pages pages
out_has "verified: "
for file in index.html step-3-1.png step-3-2.png step-3-3.png step-7-3.png; do
    [ -s "pages/$file" ] || fail "there is no $file"
done
[ -e pages/step-1-1.png ] && fail "a label's name has a picture"
same "$(ls | grep -c iftty-)" 0
grep -q '&lt;b&gt;Now&lt;/b&gt; the &quot;other&quot; one.' pages/index.html || fail "not escaped"
grep -q '<b>\|<script\|http:\|https:\|//' pages/index.html && fail "it holds what is no text"
grep -q 'class="fine">verified' pages/index.html || fail "it does not say what it came to"
for file in $(sed -n 's/.*<img src="\([^"]*\)".*/\1/p' pages/index.html); do
    [ -s "pages/$file" ] || fail "the page names $file, which is not there"
done
expect 3 "$iftty" watch e.iftty --pages pages
err_has "expected a new folder, or an empty one"
mkdir empty
expect 0 "$iftty" watch e.iftty --pages empty/ --from 3 --until 3
same "$(ls empty | tr '\n' ' ')" "index.html step-3-1.png step-3-2.png step-3-3.png "
expect 0 "$iftty" -c "open s.nii private=yes; seed 12,10,8 1" --journal JohnDoe.iftty
expect 0 "$iftty" watch JohnDoe.iftty --pages nobody
grep -q JohnDoe nobody/index.html && fail "the page names a private journal"
expect 3 "$iftty" watch e.iftty --pages nowhere/there
expect 2 "$iftty" watch e.iftty --pages more --quiz
expect 2 "$iftty" watch e.iftty
err_has "takes a terminal; \`iftty watch JOURNAL --pages DIR\`"
close_story

begin "a stranger's journal is refused what a replay refuses, in words"
mkdir away && cp s.nii away/other.nii
sed 's/^open s.nii.*/open away\/..\/..\/other.nii/' e.iftty >out.iftty
expect 3 "$iftty" watch out.iftty --pages strange
err_has "is not at away/"
[ -e strange ] && fail "pages of nothing are there"
mkdir kept
expect 3 "$iftty" watch out.iftty --pages kept
[ -d kept ] || fail "an empty folder is gone"
expect 3 "$iftty" watch e.iftty --pages strange --limit-memory 100k
err_has "--limit-memory"
expect 3 "$iftty" watch e.iftty --pages strange --limit-output 2k
err_has "--limit-output"
[ -e strange ] && fail "pages beyond the limit are there"
same "$(ls | grep -c iftty-)" 0
close_story

begin "one whose results are others is shown as far as it goes, and is not verified"
printf 's/^seed 1,1,1 0/# \033]0;evil\a\\\nseed 1,1,2 0/\n' >edit
sed -f edit e.iftty >edited.iftty
expect 1 "$iftty" watch edited.iftty --pages differs
err_has "record"
grep -q 'class="failed">NOT verified: ' differs/index.html || fail "the page does not say so"
grep -q 'step 3 of 7' differs/index.html || fail "what is the same is not there"
grep -q "$(printf '\033')" differs/index.html && fail "an escape sequence is in the page"
enter_anew "$iftty watch edited.iftty; echo ends \$?"
see '^the beginning'
type_letters "4G"
see 'error: .*record'
see '^the beginning'
type_letters "3G"
see '7680 voxels changed$'
type_letters "G"
see '^NOT verified: '
type_letters "q"
see '^ends 1$'
sane
close_story

begin "the time that one looks is not the journal's"
enter_anew "$iftty watch e.iftty --limit-time 2s"
see '^the beginning'
sleep 2.2
type_letters ":stats"
press Enter
see 'label|head'
press q
type_letters "4G"
see '^step 4 of 7, '
type_letters "Gq"
see '^verified: '
close_story

finish
