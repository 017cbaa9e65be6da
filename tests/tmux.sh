# SPDX-License-Identifier: MIT
# A real terminal for stories: tmux, 80x24, with a shell in it. Source it after lib.sh, in the
# folder $work; it ends the script if tmux is missing.
begin "at a terminal"
needs tmux || finish
story=

# A server of our own, independent of the user's; -u because LC_ALL=C does not select UTF-8.
unset TMUX NO_COLOR PAGER
tmux_here() {
    (cd "$work" && exec tmux -u -S ./tmux "$@") # the whole path may be too long for a socket
}
trap 'tmux_here kill-server 2>/dev/null; rm -rf "$work"' EXIT

checks=0
screen_text() {
    tmux_here capture-pane -p -t prompt | sed 's/ *$//'
}
press() { # keys by their names in tmux
    tmux_here send-keys -t prompt "$@"
}
type_letters() {
    tmux_here send-keys -t prompt -l -- "$1"
}
enter() { # a line
    type_letters "$1"
    press Enter
}
# Return true if a line of the screen matches.
shows() {
    screen_text | grep -qE -e "$1"
}
# Wait until a line of the screen matches each pattern, one after the other.
see() {
    for pattern; do
        comes_true shows "$pattern" || fail "the screen is:" "$(screen_text | grep .)"
    done
}
# The same after keys or a line.
typing() {
    type_letters "$1"
    shift
    see "$@"
}
pressing() {
    press "$1"
    shift
    see "$@"
}
entering() {
    enter "$1"
    shift
    see "$@"
}
# Enter a line in the shell on a cleared screen, since older output could be mistaken for the
# line's, and wait for the patterns.
enter_anew() {
    checks=$((checks + 1))
    enter "clear; echo cl\"\"ear $checks"
    see "^clear $checks\$"
    entering "$@"
}
# Check that a program has left the terminal in the modes of a shell.
sane() {
    checks=$((checks + 1))
    enter "clear; stty -a >modes; echo mo\"\"des $checks"
    see "^modes $checks\$"
    for mode in echo icanon isig icrnl opost; do
        sed 's/;/ /g' modes | tr ' ' '\n' | grep -qx "$mode" || fail "$mode is off afterwards"
    done
}
begin_terminal() {
    tmux_here -f /dev/null new-session -d -s prompt -x 80 -y 24 "PS1='$ ' ENV= exec sh -i" ||
        { echo "Bail out! tmux does not start"; exit 1; }
    see '^\$$' || true # the prompt's text does not matter
}
