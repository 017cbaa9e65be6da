#!/bin/sh
# SPDX-License-Identifier: MIT
# The lesson of `iftty tutorial` in a real terminal (tmux, 80x24), at the prompt and in the pilot:
# a step is complete by its result, the reason is shown before, a step that was reached stays, the
# lesson can be resumed, and nothing but its journal is left behind.
. "$(dirname "$0")/lib.sh"
. "$top/tests/tmux.sh"

IFTTY_CONFIG= IFTTY_HISTORY=$work/history
export IFTTY_HISTORY
left_behind() {
    ls | grep -vx -e tmux -e modes -e out -e err | tr '\n' ' '
}
begin_terminal

begin "it requires a terminal, a new journal, and the scene of the lesson"
expect 2 "$iftty" tutorial </dev/null && err_has "needs a terminal"
enter_anew "IFTTY_SCENES=/nowhere $iftty tutorial; echo ends \$?"
see '^iftty: the lesson needs the head ch2.nii.gz and its brain ch2bet.nii.gz'
see '^ends 3$'
enter_anew "$iftty tutorial ch2.nii.gz; echo ends \$?"
see '^iftty: ch2.nii.gz is not a journal of a lesson; `iftty tutorial` begins one$'
see '^ends 2$'
same "$(left_behind)" ""

"$iftty" -c 'open ch2.nii.gz' </dev/null >/dev/null 2>&1 || {
    begin "the lesson"
    skip "there is no ch2.nii.gz here"
    finish
}

begin "at the prompt: the missing condition is shown, and any commands complete a step"
enter_anew "$iftty tutorial"
see '^A first organ: the brain of this head, in 5 steps\.'
see '^step 1 of 5, in the object: there is no seed of label 1 yet$'
see '^or here:  seed 60,108,90 1 radius=6$'
enter "seed 20,108,90 1 radius=3"
see '^step 1 of 5, in the object: 112 of its 123 seeds are outside the brain$'
enter "undo"
see '^step 1 of 5, in the object: there is no seed of label 1 yet$'
enter "seed 90,120,100 1 radius=4"
see '^step 2 of 5, its neighbour: there is no seed of the background yet$'
enter "seed 60,108,90 0"
see '^step 2 of 5, its neighbour: 1 of its 1 seed is in the brain$'
enter "undo"
enter "seed 160,108,90 0 radius=6"
see '^step 3 of 5, the other side: Dice 0\.7[0-9]* of 0\.920, [0-9]* ml too much, most in z='
enter "seed 20,108,90 0 radius=6"
see '^step 4 of 5, the leak: Dice 0\.93[0-9] of 0\.950, [0-9]* ml too much, most in z='
enter "seed 90,108,5 0 radius=6 to=60,108,8"
see '^step 5 of 5, a name: label 1 has no name yet$'
enter "label 1 brain"
see '^all steps are done: a brain, whose Dice coefficient with ch2bet.nii.gz is 0\.95[0-9]$'
enter "quit"
see '^journal: tutorial-1\.iftty '
sane
same "$(left_behind)" "tutorial-1.iftty "
expect 0 "$iftty" verify tutorial-1.iftty

# The user's configuration sets keys, but not the brush and the start of the lesson.
begin "in the pilot: by the ten keys, interrupted and resumed; a step that was reached stays"
printf '%s\n' "key undo U" "brush 3 2" "start none" >config
enter_anew "IFTTY_CONFIG=config $iftty tutorial"
see '^step 1 of 5, in the object: there is no seed'
press C-o
see '^3L move 30 voxels right, from a ventricle into white matter; i plant a ball of$'
see '^axial.* at 90,108,90  brush 1 r6  '
type_letters "3Li"
see '^step 2 of 5, its neighbour: there is no seed of the background'
type_letters "4Ls0"
see '^step 3 of 5, the other side: Dice 0\.89[0-9] of 0\.920, '
type_letters "U"
see '^step 3 of 5, the other side: there is no seed of the background yet$'
tmux_here capture-pane -e -p -t prompt | grep -q "$(printf '\033')\[33m14H$(printf '\033')" ||
    fail "keys have no colour: $(tmux_here capture-pane -e -p -t prompt | grep 14H)"
press C-r
see '^step 3 of 5, the other side: Dice 0\.89[0-9] of 0\.920, '
type_letters "q"
see '^ch2>$'
see '^    14H  move 140 voxels to the other side$'
enter "quit"
see '^journal: tutorial-2\.iftty '
enter_anew "$iftty tutorial tutorial-2.iftty"
see '^step 3 of 5, the other side: Dice 0\.89[0-9] of 0\.920, '
press C-o
see '^axial.* at 20,108,90  brush 1 r6  '
type_letters "14Hs0"
see '^step 4 of 5, the leak: Dice 0\.93[0-9] of 0\.950, '
type_letters "80JI14Li"
see '^step 5 of 5, a name: label 1 has no name yet$'
see '^:label 1 brain and Enter$'
type_letters ":label 1 brain"
press Enter
see '^all steps are done: a brain, whose Dice coefficient with ch2bet.nii.gz is 0\.952$'
type_letters "q"
see '^`iftty verify tutorial-2.iftty` proves it'
enter "quit"
see '^journal: tutorial-2\.iftty '
sane
same "$(left_behind)" "config tutorial-1.iftty tutorial-2.iftty "
"$iftty" log --script tutorial-2.iftty | grep -qx 'finish relax' || fail "labels do not settle"
expect 0 "$iftty" verify tutorial-2.iftty
enter_anew "$iftty tutorial"
see '^step 1 of 5, in the object: there is no seed of label 1 yet$'
enter "seed 20,108,90 1"
see '^step 1 of 5, in the object: 1 of its 1 seed is outside the brain$'
enter "interpolate 1 1 2" # on another grid nothing is counted
see 'ch2> interpolate 1 1 2'
see '^step 1 of 5, in the object: there is no seed of label 1 yet$'
enter "quit"
see '^journal: tutorial-3\.iftty '

finish
