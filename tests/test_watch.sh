#!/bin/sh
# SPDX-License-Identifier: MIT
# Watching a journal: keys in a real terminal (tmux, 80x24), and journals of strangers, which write
# nothing, read no other files, and stay within their limits.
. "$(dirname "$0")/lib.sh"
. "$top/tests/tmux.sh"

make_scene s.nii 24 20 16
printf '%s\n' "open s.nii" "auto on" "label 1 head" "label 2 hole" "# Where it is bright." \
    "# This comment is longer than the rest of a row of 80 columns, and is cut after a word." \
    "seed 12,10,8 1 radius=2" "seed 1,1,1 0" "seed 20,15,12 2" "undo" "turn 30" \
    "# <b>Now</b> the \"other\" one." "seed 4,15,12 2 radius=1" "render after.png" >script
"$iftty" run script --journal e.iftty >/dev/null || fail "no journal can be made"
begin_terminal

begin "space steps through a journal: a gesture is drawn, then applied, and its change is shown"
before=$(listing . | grep -v tmux)
enter "PAGER='cat >$work/paged'; export PAGER"
enter_anew "$iftty watch e.iftty --graphics blocks" '^the beginning, before step 1 of 6$'
see '^Space on  Backspace back  G end  c comments  : command  \? keys  q back$'
pressing Space '^step 1 of 6, record [0-9]+: label 1 head'
press Space Space
see '^step 2 of 6, record [0-9]+: label 2 hole'
typing "3G" '^step 3 of 6, record [0-9]+: seed 12,10,8 1 radius=2$'
see '^drawn, but not run yet: at 12,10,8, label 1 head$'
see '^Where it is bright\. This comment is longer than the rest of a row of 80 [.]{3}$'
pressing Space '^0 -[0-9.]+ m[lm]3?, 1 head \+[0-9.]+ m[lm]3?; 7680 voxels changed$'

begin "backspace steps back, a number selects its step, and undone commands are named"
pressing Space '^step 4 of 6, record [0-9]+: seed 1,1,1 0$'
pressing Space '^0 \+'
pressing BSpace '^step 3 of 6, '
typing "5G" '^step 5 of 6, record [0-9]+: seed 20,15,12 2  \(undone later\)$'
type_letters "2"
pressing Space '^step 6 of 6, record [0-9]+: seed 4,15,12 2 radius=1$'
see '^drawn, but not run yet' '^<b>Now</b> the "other" one\.$'

# Print the picture in characters, with escape sequences for colours.
picture() {
    tmux_here capture-pane -e -p -t prompt | head -n 19
}
begin "voxels changed by a step are hatched after it, but not before it or while it is drawn"
typing "gg" '^the beginning'
press o # tints
typing "3G" '^drawn, but not run yet'
drawn=$(picture)
pressing Space '7680 voxels changed$'
[ "$(picture)" != "$drawn" ] || fail "the picture is the same"
white() { picture | grep -o '[34]8;2;255;255;255m' | wc -l; }
is_hatched() { [ "$(white)" -gt 120 ]; } # some 180; the frame and marks alone 60
is_plain() { [ "$(white)" -lt 120 ]; }
comes_true is_hatched || fail "$(white) white characters: nothing is hatched"
pressing Space '^step 4 of 6, ' '^drawn, but not run yet'
comes_true is_plain || fail "$(white) white characters"
pressing BSpace '^step 3 of 6, '

begin "no pager is started with an untrusted journal: pages are printed"
entering ":help all" '^The scene$' '^-- more --$'
typing "q" '^step 3 of 6, '
[ -e "$work/paged" ] && fail "the pager of the user has run"

begin "the view can be changed, and the journal cannot"
type_letters "]ll"
entering ":stats" '^(\(any key\)|-- more --)$' 'label|head'
press q
entering ":seed 1,1,1 3" 'only questions and commands that change the view'
entering ":undo" 'only questions and commands that change the view'
typing "c" '^Where it is bright\.$'
pressing x '^step 3 of 6, '

begin "the end reports if the journal is verified"
typing "G" '^the end: 6 steps, 1[0-9] records$'
see '^verified: 1[0-9] commands replayed, 1[0-9] results the same$'
pressing BSpace '^step 6 of 6, '
typing "q" '^verified: '
sane
same "$(listing . | grep -v 'tmux\|modes')" "$before"
expect_err "needs a terminal; \`iftty replay JOURNAL\` needs none" 2 "$iftty" watch e.iftty

begin "--from and --until set the first and the last step"
enter_anew "$iftty watch e.iftty --from 3 --until 4; echo ends \$?"
see '^step 3 of 6, record [0-9]+: seed 12,10,8 1 radius=2$'
type_letters "3"
pressing Space '^the end: 6 steps, 1[0-9] records; steps after 4 are left out$'
typing "5G" 'expected a step 0\.\.4$'
typing "q" '^ends 0$'
enter_anew "$iftty watch e.iftty --from 7; echo ends \$?" 'expected a step 1\.\.6' '^ends 2$'
enter_anew "$iftty watch e.iftty --from 4 --until 3; echo ends \$?" '^ends 2$'

begin "q leaves at once, before steps whose keys were typed earlier"
# Watch with these keys; set spent to the user time in hundredths of a second. A hundred steps need
# five times that of none.
spend() {
    enter_anew "($iftty watch $top/examples/first-organ.iftty --graphics blocks; times >times)"
    typing "$1" '^verified: '
    comes_true [ -s times ]
    spent=$(tail -n 1 times | sed 's/m/ /; s/s.*//' | awk '{ print int(100 * (60 * $1 + $2)) }')
    rm times
}
if "$iftty" -c 'open ch2.nii.gz' </dev/null >/dev/null 2>&1; then
    spend q
    once=$spent
    steps="                    gg"
    spend "$steps$steps$steps$steps${steps}q"
    [ "$spent" -lt $((2 * once)) ] || fail "$spent with steps, $once without"
else
    skip "there is no ch2.nii.gz here"
fi

# at_terminal WORDS STATUS TEXT: run the program at a terminal; check its status and its output.
at_terminal() {
    enter_anew "$iftty watch $1; echo ends \$?" "^ends $2\$"
    screen_text | tr -d '\n' | grep -qF -e "$3" || fail "the screen is:" "$(screen_text | grep .)"
}
begin "an untrusted journal has the restrictions of a replay, with messages"
mkdir away && cp s.nii away/other.nii
sed 's/^open s.nii.*/open away\/..\/..\/other.nii/' e.iftty >out.iftty
at_terminal out.iftty 3 "is not at away/"
at_terminal "e.iftty --limit-memory 100k" 3 "--limit-memory"
same "$(ls | grep -c iftty-)" 0

begin "a journal with other results is shown up to the difference, and is not verified"
printf 's/^seed 1,1,1 0/# \033]0;evil\a\\\nseed 1,1,2 0/\n' >edit
sed -f edit e.iftty >edited.iftty
enter_anew "$iftty watch edited.iftty; echo ends \$?" '^the beginning, before step 1 of 3$'
typing "4G" 'expected a step 0\.\.3$'
type_letters "3G"
pressing Space '7680 voxels changed$'
pressing Space '^NOT verified: .*record'
typing "q" '^ends 1$'
sane

begin "the time of watching is not limited as that of the journal"
enter_anew "$iftty watch e.iftty --limit-time 2s" '^the beginning'
sleep 2.2
entering ":stats" '^(\(any key\)|-- more --)$' 'label|head'
press q
typing "4G" '^step 4 of 6, '
typing "Gq" '^verified: '

finish
