#!/bin/sh
# SPDX-License-Identifier: MIT
# The prompt as a user sees it: keys in a real terminal (tmux, 80x24), and the screen after them.
. "$(dirname "$0")/lib.sh"
. "$top/tests/tmux.sh"

half_block=$(printf '\342\226\200')
make_scene s.nii 24 20 16
# Print the lines below the last line that is $1.
below() {
    screen_text | grep . | awk -v line="$1" '{ text = text $0 "\n" } $0 == line { text = "" }
                                        END { printf "%s", text }'
}
begin_terminal

begin "the prompt appears, and text typed before it is kept"
enter_anew "$iftty --graphics blocks s.nii"
entering "label 2 early" '^s> label 2 early$' '^s>$'
screen_text | grep -q '^24x20x16 voxels' || fail "the scene is not described:" "$(screen_text)"
same "$(below 's> label 2 early')" "s>"

begin "Tab completes a word or lists candidates; a hint shows the next parameters"
press z o Tab
see '^s> zoom fit\|FACTOR \[at=X,Y,Z\]$'
entering "fit" '^s> zoom fit$'
press s Tab
see '^seed +plant a seed' '^sync +set when records are synced'
press e Tab
see '^s> seed X,Y,Z LABEL \[radius=0\.\.512\|Rmm\] \[range=LOW\.\.HIGH\] '
pressing C-u '^s>$'
type_letters "open s."
pressing Tab '^s> open s\.nii \[volume='
press C-u

begin "a wrong command gets a caret and a line, and the prompt is back"
entering "sed 1,1,1 1" '^error: ' '^s>$'
same "$(below 's> sed 1,1,1 1')" "   ^
error: unknown command sed; did you mean seed?
s>"

begin "a key of the pilot is named, and help fits the screen"
entering "3L" '^error: 3L is a key of the pilot .Ctrl-O.$'
entering "s0" '^error: s0 is a key of the pilot .Ctrl-O.$'
entering "3sedd" '^error: unknown command 3sedd'
press C-l
entering "help" '^To segment an object, plant seeds' '^of the prompt, `help correct` shows' '^s>$'
! shows 'more --' || fail "$(screen_text)"
press C-l

begin "seeds and render: a picture of half blocks"
enter "size 40 30"
enter "zoom 1"
enter "seed 2,3,4 1"
enter "seed 20,10,8 0"
entering "render" "$half_block" '^s>$'
press C-l

begin "info names the kind of pictures, and the line that a tmux needs for better ones"
entering "info" '^graphics  text: half blocks$' 'set -g allow-passthrough on'
press q C-u # it may be shown by pages
press C-l

begin "a picture is written in the background, and reported above the line"
entering "render prompt.png" '^writing prompt\.png$'
typing "half a li" '^wrote prompt\.png$' '^s> half a li$'
press C-u
[ -s prompt.png ] || fail "no prompt.png"
enter "render prompt.png"
see '^error: prompt\.png exists already and was left alone; replace=yes overwrites it$' '^s>$'
press C-l

begin "slices and mosaics are shown too"
for command in "slice axial" "mosaic"; do
    entering "$command" "$half_block" '^s>$'
    press C-l
done

begin "Tab inserts the only word with the typed part, and lists several words"
type_letters "contour"
pressing Tab '^s> overlay contour'
press C-u
type_letters "radius"
pressing Tab '^seed  *radius=: in voxels' '^[+]  *in the pilot, larger: radius; mm; range$'
see '^s> radius$'
press C-u
press C-l

begin "Ctrl-R lists older lines below the prompt, typing narrows them, and Enter selects one"
enter "label 5 liver"
enter "label 6 lung"
enter "label 5 kidney"
press C-l
type_letters "half"
pressing C-r "^.search ''. half\$" '^  label 5 kidney$' '^  label 6 lung$'
typing "label 5" '^> label 5 kidney$' '^  label 5 liver$'
! shows '^  label 6 lung$' || fail "the list does not narrow:" "$(screen_text | grep .)"
pressing Down "^.search 'label 5'. label 5 liver\$" '^> label 5 liver$'
pressing Enter '^s> label 5 liver$' '^s>$'
! shows 'kidney' || fail "the list stays:" "$(screen_text | grep .)"
pressing C-r '^  label 5 kidney$'
pressing C-g '^s>$'
! shows 'kidney' || fail "the list stays:" "$(screen_text | grep .)"

begin "Ctrl-Z stops the prompt, fg continues with the line"
type_letters "half a li"
pressing C-z '[Ss](topped|uspended)'
sane
entering "fg" '^s> half a li$'
typing "ne" '^s> half a line$'
press C-c

begin "quit leaves a sane terminal and a journal that verifies"
enter "render last.tif"
entering "quit" '^wrote last\.tif$' '^journal: s-1\.iftty \(.* records\)$'
see '^\$$' # the shell is back: what is typed before its prompt stands behind it
entering 'echo status $?' '^status 0$'
sane
[ -s last.tif ] || fail "no last.tif"
expect 0 "$iftty" verify s-1.iftty
grep -qx 'label 2 early' s-1.iftty || fail "the label is not in the journal"
grep -qx 'seed 20,10,8 0' s-1.iftty || fail "a seed is not in the journal"
! grep -q 'sed 1\|half' s-1.iftty || fail "what was no command is in the journal"

begin "resuming tells how many records there are"
records=$(grep -c '^= ' s-1.iftty)
enter_anew "sh -c 'echo \$\$ >pid; exec $iftty s-1.iftty'" "^$records records resumed\$" '^s-1>$'
entering "seed 6,10,8 2" '^[0-9]+ voxels changed'

begin "killed at the prompt: a sane terminal, a whole journal"
typing "half a li" '^s-1> half a li$'
kill -TERM "$(cat pid)"
see '[Tt]erminated'
sane
expect 0 "$iftty" verify s-1.iftty
same "$(grep -c '^= ' s-1.iftty)" $((records + 1))

begin "a new user's labels are finished, and saved files and counts report it"
enter_anew "IFTTY_CONFIG= $iftty s.nii --journal new.iftty"
see '^finish    relax sweeps=20 reach=2; pictures show it$'
entering "seed 6,10,8 1 radius=2"
see '^[0-9]+ voxels changed before finishing, label 1: [+][0-9.]+ m[lm]3?, [0-9.]+ m?s$'
enter "seed 20,10,8 0 radius=2"
entering "save labels shown.nii" '^wrote shown.nii'
entering "save labels own.nii finished=no" '^wrote own.nii'
entering "save cost cost.nii" '^wrote cost.nii'
entering "save surface shown.stl" '^wrote shown.stl'
entering "stats report=shown.csv" '^wrote shown.csv'
entering "compare shown.nii" '^1 +1\.0000 '
enter "finished off"
entering "save labels off.nii" '^wrote off.nii'
entering "quit" '^journal: new'
cat >wanted <<END
open s.nii weight=morph
auto on
finish relax
finished on
seed 6,10,8 1 radius=2
seed 20,10,8 0 radius=2
save labels shown.nii finished=yes
save labels own.nii finished=no
save cost cost.nii
save surface shown.stl finished=yes
finished off
save labels off.nii finished=no
END
"$iftty" log --script new.iftty | grep -v '^#' >got
same "$(cat got)" "$(cat wanted)"
expect 0 "$iftty" verify new.iftty
sed '/^save/d; /^finished off/,$d' wanted >plain
cat >>plain <<END
save labels plain.nii
save labels yes.nii finished=yes
stats finished=yes report=yes.csv
END
expect 0 "$iftty" run plain --journal plain.iftty
grep -qx 'save labels plain.nii' plain.iftty || fail "a script says what it says"
same_files plain.nii own.nii
same_files plain.nii off.nii
same_files yes.nii shown.nii
same_files yes.csv shown.csv
! cmp -s own.nii shown.nii || fail "nothing was to be finished"

finish
