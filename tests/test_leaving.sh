#!/bin/sh
# SPDX-License-Identifier: MIT
# A real terminal after the program was killed or the line was closed; blocks instead of garbage
# inside multiplexers; and progress of long work.
. "$(dirname "$0")/lib.sh"
. "$top/tests/tmux.sh"
half_block=$(printf '\342\226\200')
make_scene s.nii 24 20 16
begin_terminal

state() { # of the terminal: alternate screen, mouse, cursor
    tmux_here display-message -p -t prompt '#{alternate_on}#{mouse_any_flag}#{cursor_flag}'
}
processes() { # of ours at the terminal
    ps -t "$(tmux_here display-message -p -t prompt '#{pane_tty}')" -o comm= | grep iftty
}
is_guarded() { # by a process that has its name by now
    [ "$(processes | sort | tr '\n' ' ')" = "iftty iftty-guardian " ]
}
start_session() { # JOURNAL [WORDS...]
    enter_anew "sh -c 'echo \$\$ >pid; exec $iftty --journal $*'" '^[a-z]+>$'
}
nothing_left() {
    [ -z "$(processes)" ]
}
state_is() {
    [ "$(state)" = "$1" ]
}

begin "killed at the prompt: a sane terminal, a whole journal, no process"
start_session one.iftty s.nii
comes_true is_guarded || fail "there are: $(processes)"
entering "seed 2,3,4 1" '^[0-9]+ voxels changed'
typing "half a li" '> half a li$'
kill -KILL "$(cat pid)"
see '[Kk]illed'
comes_true nothing_left
sane
state_is 001 || fail "the state is $(state)"
expect 0 "$iftty" verify one.iftty
grep -qx 'seed 2,3,4 1' one.iftty || fail "the seed is not in the journal"

begin "killed while it has the whole screen: the same"
start_session two.iftty s.nii
entering "seed 2,3,4 1" '^[0-9]+ voxels changed'
enter "pilot"
comes_true state_is 110
comes_true is_guarded || fail "there are: $(processes)"
kill -KILL "$(cat pid)"
comes_true state_is 001 # what the shell says may have gone with that screen
comes_true nothing_left
sane
expect 0 "$iftty" verify two.iftty

begin "stopped and continued while it has the whole screen: that, and the mouse, come back"
start_session stop.iftty s.nii
enter "pilot"
comes_true state_is 110
press C-z
comes_true state_is 001
sane
enter "fg"
comes_true state_is 110
kill -KILL "$(cat pid)"
comes_true state_is 001
comes_true nothing_left
sane

begin "aborted while it has the whole screen: the same"
start_session three.iftty s.nii
enter "pilot"
comes_true state_is 110
kill -ABRT "$(cat pid)"
comes_true state_is 001
see '[Aa]borted'
comes_true nothing_left
sane

begin "in tmux that passes everything through, to no terminal: blocks, and nothing else"
tmux_here set-option -g allow-passthrough on 2>/dev/null
start_session four.iftty s.nii
screen_text >before
! grep -q 'Gi=31\|AAAA\|2026' before || fail "garbage:" "$(cat before)"
entering "slice axial" "$half_block"
entering "quit" '^journal: four'
sane

begin "in GNU screen: blocks, and nothing else"
if needs screen; then
    mkdir -m 700 screens
    screen="SCREENDIR=./screens screen -U -c /dev/null"
    enter_anew "$screen sh -c 'exec $iftty --journal five.iftty s.nii'" '^[a-z]+>$'
    screen_text >before
    ! grep -q 'Gi=31\|AAAA\|2026' before || fail "garbage:" "$(cat before)"
    entering "slice axial" "$half_block"
    entering "quit" 'screen is terminating'
    sane
fi

begin "a long command reports progress at a terminal"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; save labels s.mha' >/dev/null
"$iftty" -c 'open s.mha; seed 2,3,4 1; run' --journal slow.iftty >/dev/null
mkdir slow
cp "$iftty" slow
cp /usr/bin/sort slow/iftty-volume # takes a request, and answers nothing
for words in "verifying: verify slow.iftty" "replaying: diff slow.iftty slow.iftty" \
    "replaying: log --procedure - slow.iftty" \
    "replaying: apply slow.iftty s.nii --by world --out none"; do
    enter_anew "slow/iftty ${words#*: }; echo sta\"\"tus \$?" "^${words%%:*} +[0-9]+ s"
    pressing C-c "^status 130"
done
[ ! -e none ] || fail "apply has left a folder"
sane

begin "the line is gone: the process too, and the journal is whole"
start_session six.iftty s.nii
entering "seed 2,3,4 1" '^[0-9]+ voxels changed'
enter "render late.png"
type_letters "seed 20,10"
tmux_here kill-server
gone() {
    ! kill -0 "$(cat pid)" 2>/dev/null
}
comes_true gone
expect 0 "$iftty" verify six.iftty
grep -qx 'seed 2,3,4 1' six.iftty || fail "the seed is not in the journal"
! grep -q 'seed 20' six.iftty || fail "half a line is in the journal"

finish
