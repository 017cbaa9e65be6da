#!/bin/sh
# SPDX-License-Identifier: MIT
# The pilot as a user sees it: keys in a real terminal (tmux, 80x24), the screen after them, and the
# commands that the journal records.
. "$(dirname "$0")/lib.sh"
. "$top/tests/tmux.sh"

make_scene u.nii 24 20 16 # without an orientation,
cp u.nii s.nii
printf '\001' | dd of=s.nii bs=1 seek=252 conv=notrunc 2>dd || fail "$(cat dd)" # and with its axes
half_block=$(printf '\342\226\200')
last_record() {
    grep -v '^[=#]' s-1.iftty | tail -n 1
}
# The last command of the journal is this one.
is_last_record() {
    [ "$(last_record)" = "$1" ]
}
recorded() {
    comes_true is_last_record "$1" || fail "the last command is '$(last_record)', not '$1'"
}
# Type keys or a line after `:`, and wait for the record that they make, by default the line itself.
types() {
    type_letters "$1"
    recorded "$2"
}
presses() {
    press "$1"
    recorded "$2"
}
commands() {
    type_letters ":"
    enter "$1"
    recorded "${2:-$1}"
}
commanding() {
    type_letters ":"
    entering "$@"
}
# The magnified slices are around another voxel than this.
has_panned() {
    case $(last_record) in *"at=$1") return 1 ;; "magnify "*) return 0 ;; *) return 1 ;; esac
}
# These letters are in this column, the first at the top and the second at the bottom.
sides_are() {
    screen_text | sed -n 1p | grep -q "^.\{$3\}$1" &&
        screen_text | sed -n 22p | grep -q "^.\{$3\}$2"
}
sides_are_not() {
    ! sides_are "$@"
}
replaces_outline() {
    case $(last_record) in "outline "*" 2 to="*" instead="[1-9]*) ;; *) return 1 ;; esac
}
no_words() {
    ! screen_text | head -n 22 | grep -q ' mm\|^[RLAPSI]'
}
begin_terminal

begin "pilot uses the whole screen, with slices and the place of the cross-hair"
enter_anew "$iftty --graphics blocks s.nii"
see '^24x20x16 voxels' '^Ctrl-O: the pilot, to segment by keys; `help`: how to segment$'
entering "pilot" '^axial at 12,10,8  brush 1 r3  no label  intensity [0-9]*  [-0-9.,]* mm$'
screen_text | head -n 20 | grep -q "$half_block" || fail "there is no picture:" "$(screen_text)"

begin "an empty session shows how to begin"
see '^nothing to show yet: i plants a seed here'

begin "keys are bold in the row of keys"
tmux_here capture-pane -e -p -t prompt | grep -q "$(printf '\033')\[1mi$(printf '\033')\[0m" ||
    fail "$(tmux_here capture-pane -e -p -t prompt | tail -n 1)"

begin "the brush has a radius, which - makes smaller"
typing "3-" '^axial at 12,10,8  brush 1  no label  intensity '

begin "keys move, seed, undo and turn, each as the command it is"
presses Right "cross 11,10,8"
types "3k" "cross 11,13,8"
types "s2" "seed 11,13,8 2"
see 'voxels changed' '^axial at 11,13,8  brush 2  here 2 7.68 ml  intensity [0-9]*  [-0-9.,]* mm'
pressing Tab '^coronal at [0-9]*,13,[0-9]* '
see '^one label fills all: a here, then beyond its edge S encloses it; s0 background$'
types "++s1" "seed 11,13,8 1 radius=2"
see '^brush 1; 7680 voxels changed'
press Escape
see '^coronal .*at 11,13,8  brush 1 r2  here 1 [0-9.]* m[lm][3 ]'
types "u" "undo"
see '^undone: [0-9]+ seed 11,13,8 1 radius=2; after [0-9]+ seed 11,13,8 2'
presses C-r "redo"
presses S-Right "turn 15"
type_letters "I"
press Up
types "-s3" "seed 11,13,9 3 radius=1 to=11,13,8"

begin "a lowered pen is shown by its colour and by the help of keys"
type_letters "v"
pressing Tab '^PEN DOWN  sagittal ' '^moving draws; v ends the stroke, Escape drops it$'
tmux_here capture-pane -e -p -t prompt | grep -q '41m.*PEN DOWN' || fail "it is not in colour"
pressing Escape '^sagittal '
press Tab Tab
see '^coronal '

begin "a stroke of the pen is one record when it is lifted, and none when it is dropped"
at=$(last_record)
typing "vlljj" '^PEN DOWN'
same "$(last_record)" "$at"
pressing Escape 'the stroke is dropped, and the pen is up'
same "$(last_record)" "$at"
types "vlljjv" "seed 11,13,9 3 radius=1 to=9,13,9 to=9,13,7"
typing "u" '^undone: [0-9]+ seed '
commands "cross 11,13,9"
pressing Escape '^i seed '

begin "an Alt-KEY that does nothing is Escape, then KEY; one that pans still does"
press M-:
type_letters "finish largest"
presses Enter "finish largest"
press M-:
type_letters "finish none"
presses Enter "finish none"
type_letters "3"
press M-:
type_letters "zoom 2"
presses Enter "zoom 2"
commands "zoom 1"
typing "?" 'keys' # a page of keys: Escape leaves it
press M-:
type_letters "zoom 3"
presses Enter "zoom 3"
commands "zoom 1"
presses M-h "pan -16 0"
presses M-l "pan 16 0"

begin "finished labels are shown as one works, and the forest's again, by one key"
typing "y" '`:finish relax` settles them on the edges'
commands "finish relax sweeps=9"
see '^the finish (breaks|reduces|deletes) label' # a page, since labels are lost from
see '^[(]any key[)]$'
type_letters " "
types "y" "finished on"
tmux_here resize-window -t prompt -x 100 -y 24 # the place in mm has a higher rank than that word
see '^coronal at 11,13,9  brush 3 r1  finished  '
types "s1" "seed 11,13,9 1 radius=1"
pressing Escape '^i seed ' # with the u before that, it would be Alt
see '^coronal at 11,13,9  brush 1 r1  finished  '
tmux_here resize-window -t prompt -x 80 -y 24
types "uy" "finished off"
see '^coronal .*at 11,13,9  brush 1 r1  here '
type_letters "3b"
pressing Escape '^i seed '

begin "keys walk through hints, and tell how a voxel came to its label"
is_cross() {
    case $(last_record) in "cross "*) return 0 ;; *) return 1 ;; esac
}
typing ")" '^1  at [0-9]+,[0-9]+,[0-9]+: [0-9]+ voxels?, [0-9.]+ m[lm].*; label '
comes_true is_cross
typing "gh" '^red, where the border is least certain'
typing "P" '^label [0-9].*, cost [0-9]+, [0-9]+ steps?'
see '^P to its strongest edge .* Escape ends$' # and what keys do there
press Escape
type_letters "gh:cross 11,13,9"
presses Enter "cross 11,13,9"
pressing Escape '^i seed '

begin "pasted text presses no key: it is inserted in the line of the colon"
tmux_here set-buffer -b paste "$(printf 'box 10 xx u\nseed 1,1,1 2\nq ')"
before=$(last_record)
tmux_here paste-buffer -p -b paste -t prompt
hint='( \[range=LOW\.\.HIGH\] \[shell=yes\] \[around=LABEL\] .*)?' # of a command, cut to the row
see "^:box 10 xx u seed 1,1,1 2 q$hint\$"
pressing Escape '^i seed '
type_letters ":label 5 "
tmux_here paste-buffer -p -b paste -t prompt
see '^:label 5 box 10 xx u seed 1,1,1 2 q( \[number=N\] \[code=none\|SCHEME:VALUE\])?$'
pressing Enter '^error: '
typing "?" 'a seed of the label'
tmux_here paste-buffer -p -b paste -t prompt
sleep 0.3
see 'a seed of the label' # a page of text takes none
pressing Escape '^coronal '
same "$(last_record)" "$before"

begin "x shows the marker first, and removes it then"
typing "x" '^marker [0-9]+: [0-9]+ trees?, [0-9]+ voxels?, label [0-9].*; x removes it'
types "x" "remove 11,13,9"

begin "? tells the keys, a key its description, and Escape goes back"
typing "?" 'a seed of the label'
typing "I" "^  I  *stroke " '; I sets one end, a seed the other[.]$'
typing "V" '^  Vp  *back ' '^    View from the front, back, left,'
pressing Up '^  k  *up ' '^    Move the cross-hair in the active slice'
pressing Escape '^coronal at [0-9]*,13,[0-9]* '
recorded "remove 11,13,9"

begin "Ctrl-C leaves a line, and nothing else; :q and Ctrl-O leave the pilot"
pressing C-c '^q leaves$'
typing ":label 7" '^:label 7 '
pressing C-c '^i seed '
screen_text | head -n 20 | grep -q "$half_block" || fail "the picture has moved:" "$(screen_text)"
entering ":q" '^s>$'
pressing C-o '^coronal at [0-9]*,13,[0-9]* '
pressing C-o '^s>$'
pressing C-o '^coronal at [0-9]*,13,[0-9]* '
recorded "remove 11,13,9"

begin "gu shows the commands that can be undone"
typing "gu" '^[*] [0-9]+ remove 11,13,9 '
pressing Escape '^coronal at [0-9]*,13,[0-9]* '

begin "Tab finds commands and keys by a piece of a word, each with its key"
type_letters ":cont"
pressing Tab '^context  ' '^overlay contour  o in the pilot: ' '^:cont$'
pressing Escape '^i seed ' # the row above stays while a line is edited
type_letters ":pen"
pressing Tab "^v  *in the pilot, pen: pen; end of a stroke$" '^:pen$'
pressing Escape '^i seed ' # the row above stays while a line is edited
type_letters ":und" # what begins so is completed as ever
pressing Tab '^:undo \[COUNT\]$'
pressing Escape '^i seed ' # the row above stays while a line is edited

begin "/ shows the keys that have a word in them"
typing "?" '^Planting$'
typing "/greys" '^/greys$' '^  o  *overlay  *labels; greys; channel$'
pressing Enter '^a key shows its description; / finds keys by a word; Escape leaves$'
pressing Escape '^coronal at [0-9]*,13,[0-9]* '
recorded "remove 11,13,9"

begin "a colon reads a command; an answer of several lines has a page"
commands "label 3 node"
tmux_here resize-window -t prompt -x 100 -y 24 # the brush's name is left out first
see '^coronal at 11,13,9  brush 3 node r1  here '
tmux_here resize-window -t prompt -x 80 -y 24
see '^coronal at 11,13,9  brush 3 r1  here '

begin "the name of the label under the cross-hair is in the row"
here=$(screen_text | sed -n 's/^coronal .*  here \([0-9]*\) .*/\1/p')
commands "label $here Left-Cerebral-White-Matter"
see "^coronal at 11,13,9  brush 3 r1  here $here Left-Cerebral-White-Matter  intensity "
types "u" "undo"
press Escape
see "^coronal at 11,13,9  brush 3 r1  here $here [0-9.]+ m[lm]3?  intensity "

begin "gl lists the labels: go to, choose, hide, rename"
typing "gl" '^> .* 3  node  *0 ml  brush$'
see '^Enter go there  b brush  e hide, show  r rename  q back$'
pressing Up '^> .* 1  *[0-9.]* m[lm]'
typing "e" '^> .* 1 .*  hidden$'
recorded "hide 1"
types "e" "show 1"
typing "b" '^> .* 1 .*  brush$'
pressing Down '^> .* 3  node '
typing "b" '^> .* 3  node .*  brush$'
pressing Enter '^label 3 has no voxel$'
typing "gl" '^> .* 3  node '
press Up Enter
comes_true is_cross
see '^coronal at '
for name in cyst "large cyst"; do
    typing "glr" '^:label 3 ""'
    enter "$name"
    [ "$name" = cyst ] || name="\"$name\""
    recorded "label 3 $name"
    types "u" "undo"
done
commanding "label 3 large cyst" '^error: COLOUR: .* [(]quote a name with blanks'
commanding "cross 11,13,9" '^through 11,13,9'
pressing Escape '^coronal at 11,13,9'
commanding "help box" 'plant a box'
see '\(any key\)'
pressing Enter '^coronal at [0-9]*,13,[0-9]* '
commanding "sed 1" 'error: unknown command sed'

begin "an answer longer than the screen comes page by page"
commanding "help all" '^The scene'
see '^-- more --$'
pressing Space '^box X,Y,Z '
typing "q" '^coronal at [0-9]*,13,[0-9]* '
commanding "help all" '^The scene'
is_another_page() {
    screen_text >page
    grep -q '^-- more --$\|^[(]any key[)]$' page && ! cmp -s page former
}
for page in 1 2 3 4 5 6 7 8 9; do
    screen_text >former
    grep -q '^quit ' former && break
    press Space
    comes_true is_another_page || fail "no page follows:" "$(cat former)"
done
see '^quit  *end the session' '^[(]any key[)]$'
pressing Escape '^coronal at [0-9]*,13,[0-9]* '

begin "a message longer than a row uses both rows, until the next key"
type_letters ":"
entering "seed 1,1,1 a-name-that-no-label-has-been-given-and-that-is-long" '^error: LABEL: expected'
see 'name one with'
pressing Tab '^sagittal '
press Tab Tab
see '^coronal at [0-9]*,13,[0-9]* '

begin "the keys of a mode are listed below while it lasts, and the list fits"
type_letters "w"
pressing Left '^window [-0-9.]+ [-0-9.]+  arrows  a auto  Enter done  1 bone  2 brain  3 lung'
pressing Enter '^i seed '
types "w2" "window 0 80"
see '^the window of brain$'
type_letters "p"
pressing Left '^CORRECT at pixel [0-9]+,[0-9]+  0-9 a seed there  p to its voxel  Escape ends$'
see '^CORRECT  (axial|coronal|sagittal) '
pressing Escape '^i seed '
commands "size 16 16"
type_letters "plllllllllllllljjjjjjjjjjjjjj" # to the last of the pane's pixels, which are more
see '^CORRECT at pixel [2-9][0-9],[2-9][0-9]  '
pressing Escape '^i seed '
commands "size 512 512"

begin "slices are magnified and moved by commands; enlarging a pane is no command"
types "]]" "magnify 1.5 at=11,13,9"
see '^coronal x1.5 at 11,13,9 '
press M-Up # no part of the width is hidden
comes_true has_panned 11,13,9 || fail "$(last_record)"
types "gz" "magnify 1.5 at=11,13,9"
before=$(grep -c . s-1.iftty)
type_letters "f"
comes_true sides_are 'S' 'I' 40 || fail "$(screen_text)"
type_letters "f"
comes_true sides_are_not 'S' 'I' 40 || fail "$(screen_text)"
same "$(grep -c . s-1.iftty)" "$before"
types "W" "magnify fit"
see '^coronal at 11,13,9 '

begin "the patient's sides and a scale bar are drawn in cells"
see '^ *[0-9]+ mm'
screen_text | head -n 22 | grep -q '^R' || fail "$(screen_text)"
screen_text | head -n 22 | grep -q '^A' && fail "there is no A on the left of a coronal slice"
type_letters ":"
enter "overlay words=off"
comes_true no_words || fail "$(screen_text)"
commanding "overlay words=on" '^ *[0-9]+ mm'

begin "boxes, polygons, millimetres and intensities, each as the command it is"
commanding "cross 12,13,8" '^coronal at 12,13,8'
typing "2ba" '^1 corner; d plants the box'
typing "2l3k" '^coronal at 10,13,11  brush 2 r1 1 corner  '
types "d" "box 12,13,8 10,13,11 2"
types "aha" "cross 11,13,11"
types "j" "cross 11,13,10"
types "aA" "outline 10,13,11 2 to=11,13,11 to=11,13,10"
type_letters "T-99999..99999"
see '^intensities LOW..HIGH, or none: -99999..99999_  Enter sets it  Escape leaves$'
pressing Enter '^coronal at 11,13,10  brush 2 r1 -99999..99999  '
typing "M" 'radius 1mm, intensities'
types "i" "seed 11,13,10 2 radius=1mm range=-99999..99999"
entering "M-T" '^the brush: label 2, radius 0$'

begin "an outline is drawn, closed, edited again, dragged, and replaces the former one"
commanding "cross 12,13,8" '^coronal at 12,13,8'
typing "@" '^OUTLINE  coronal at 12,13,8'
see '^moving, or the mouse, draws an outline  Enter plants it  Escape drops it$'
typing "4l4k4h" '^OUTLINE  coronal at 12,13,12  brush 2 4 corners'
presses Enter "outline 12,13,8 2 to=8,13,8 to=8,13,12 to=12,13,12"
typing "U" '^the outline of marker [0-9]+$'
typing "v" '^grabbed: moving drags it  Enter plants it  v grabs, lets go  Escape drops it$'
enter "2h"
comes_true replaces_outline || fail "$(last_record)"
typing "}" ' in doubt; the (border|outline) of '
pressing Escape '^the outline is dropped$'
commanding "cross 11,13,10" '^through 11,13,10'
for plane in 1 2 3; do # it may be any of them
    press Tab
    comes_true shows ' at 11,13,10 '
    shows '^coronal ' && break
done
see '^coronal at 11,13,10'

begin "stopped and continued, the screen comes back"
pressing C-z '[Ss]topped'
entering "fg" '^coronal at [0-9]*,13,[0-9]* '

begin "another size of the window is another picture"
stands_in_row() {
    screen_text | sed -n "$1p" | grep -q '^coronal at [0-9]*,13,[0-9]* '
}
tmux_here resize-window -t prompt -x 130 -y 30
comes_true stands_in_row 29 || fail "the screen is:" "$(screen_text | grep .)"
see '^coronal at .* mm  mean [0-9.]*, SD [0-9.]*, [0-9.]* x [0-9.]* x [0-9.]* m' # of the label
enter ":seed 20,4,3 0"
see '^this `seed` took .* of label 1 through 20,4,2; undo reverts it$' # lines are a page
see '^[(]any key[)]$'
typing " " '^coronal at [0-9]*,13,[0-9]* '
enter ":cross 20,4,3"
see '^coronal at [0-9]*,4,.*  here 0  changed: label [0-9], [0-9.]* m[lm]3? .*  intensity '
types "u" "undo"
entering ":cross 11,13,10" '^through 11,13,10'
typing "lh" '^i seed  b label'
tmux_here resize-window -t prompt -x 80 -y 24
comes_true stands_in_row 23 || fail "the screen is:" "$(screen_text | grep .)"

begin "the smallest window: the keys page by page, and the pen is loud"
tmux_here resize-window -t prompt -x 20 -y 10
see '^coronal at 11,13,10$'
see '^i seed  q back$' # nothing is cut within a word, and how to leave is there
typing "?" '^h j k l arrows$' '^  move the$' '^-- more --$'
tmux_here resize-window -t prompt -x 80 -y 24
see 'h j k l arrows   move the cross-hair     H L Ctrl-arrows'
tmux_here resize-window -t prompt -x 20 -y 10
see '^h j k l arrows$'
typing "q" '^coronal at 11'
typing "v" '^PEN DOWN  coronal$'
pressing Escape '^coronal at 11'
tmux_here resize-window -t prompt -x 80 -y 24
see '^coronal at'

begin "q goes back to the prompt, with the screen as it was before"
typing "q" '^s>$' '^24x20x16 voxels'
entering "quit" '^journal: '
sane

begin "a session in the pilot replays like any other session"
expect 0 "$iftty" verify s-1.iftty
grep -qx 'cross 11,13,8' s-1.iftty || fail "a move is not in the journal"

begin "no side is named if the orientation is unknown"
enter_anew "$iftty --graphics blocks u.nii" '^u>$'
pressing C-o '^ *10 mm' '^z=8 at 12,10,8 .* orientation unknown'
pressing Tab '^y=10 at 12,10,8 '
screen_text | head -n 22 | grep -q '[RLAPSI]' && fail "$(screen_text)"
typing "q" '^u>$'
entering "quit" '^journal: '
sane

begin "Ctrl-O is the pilot too; killed there, the terminal is sane"
enter_anew "sh -c 'echo \$\$ >pid; exec $iftty --graphics blocks s-1.iftty'" '^s-1>$'
pressing C-o '^axial'
kill -TERM "$(cat pid)"
see '[Tt]erminated'
sane
expect 0 "$iftty" verify s-1.iftty

begin "killed while the pen is down, all but that stroke is in the journal"
enter_anew "sh -c 'echo \$\$ >pid; exec $iftty --graphics blocks s-1.iftty'" '^s-1>$'
pressing C-o '^axial'
type_letters "s4"
comes_true grep -q '^seed .* 4' s-1.iftty || fail "$(last_record)"
last=$(last_record)
typing "vlllkkk" '^PEN DOWN'
shows_stroke() { # the cross-hair follows the keys
    screen_text | grep -q "^PEN DOWN .* at $1 "
}
end=$(echo "$last" | sed 's/^seed //; s/ .*//' | awk -F, '{ print $1 - 3 "," $2 + 3 "," $3 }')
comes_true shows_stroke "$end" || fail "not at $end:" "$(screen_text)"
kill -KILL "$(cat pid)"
is_given_back() { # by the guardian, which has ended then
    [ "$(tmux_here display-message -p -t prompt '#{alternate_on}#{mouse_any_flag}')" = 00 ] &&
        ! ps -t "$(tmux_here display-message -p -t prompt '#{pane_tty}')" -o comm= | grep -q iftty
}
comes_true is_given_back || fail "$(screen_text)"
sane
same "$(last_record)" "$last"
expect 0 "$iftty" verify s-1.iftty
expect 0 "$iftty" log --check s-1.iftty
grep -q '^intact' out || fail "$(cat out)"
enter_anew "$iftty --graphics blocks s-1.iftty" '^s-1>$'
entering "undo" "^undone: [0-9]* $last"
entering "quit" '^journal: '
sane

begin "the ten keys of README.md segment a brain"
cat >reference <<END
open ch2.nii.gz
mask ch2bet.nii.gz
seed 60,108,90 1
run
END
if "$iftty" run reference >/dev/null 2>&1; then
    enter_anew "IFTTY_CONFIG= $iftty --graphics blocks ch2.nii.gz" '^ch2>$'
    pressing C-o '^axial at 90,108,90  brush 1 r6'
    keys=$(sed -n '/^<!-- organ/,/^<!-- end of organ/s/^    \([^ ]*\) .*/\1/p' "$top/README.md")
    same "$(printf '%s\n' "$keys" | wc -l)" 10
    tmux_here pipe-pane -t prompt "cat >'$work/stream'"
    for key in $keys; do type_letters "$key"; done
    see '^axial at 20,108,10  brush 0 r6  here 0'
    see '^the finish breaks label 1 to 1686106 voxels in 6 pieces; see `stats`'
    shows_progress() { # the row may go soon
        grep -aEq ' %, [0-9]+ s( left)?' "$work/stream"
    }
    if ! shows_progress; then # in the half second before it appears, fast machines are done
        for _ in $(seq $(($(nproc) * 4))); do timeout 60 sh -c 'while :; do :; done' & done
        type_letters "u"
        press C-r
        comes_true shows_progress
        kill $(jobs -p)
    fi
    tmux_here pipe-pane -t prompt
    # Nothing is drawn over progress before it is erased.
    LC_ALL=C awk 'BEGIN { RS = "[\r\033]" } /^[a-z]+ +\[.* s/ { n++; works = 1 }
        /^ +$|^\[2J/ { works = 0 }
        works && / (seed|keys|back)/ { print; n = 0; exit } END { exit !n }' stream >row ||
        fail "hints over progress: $(cat row)"
    type_letters "1bgc" # the volume is that of what is shown, which has settled
    tmux_here resize-window -t prompt -x 110 -y 24
    see 'finished  here 1 1\.69 l'
    commanding "stats" '^label 1: .* 1686106 voxels, 1686\.1 ml'
    press Escape
    tmux_here resize-window -t prompt -x 80 -y 24
    typing "q" '^ch2>$'
    entering "quit" '^journal: ' # what is typed before is the prompt's, and goes with it
    sane
    "$iftty" log --script ch2-1.iftty >organ
    echo "compare ch2bet.nii.gz label=1 finished=yes" >>organ
    "$iftty" run organ >out 2>err
    grep -q '^ *1 *0\.95' out || fail "$(cat out err)"
else
    skip "there is no ch2.nii.gz here"
fi

begin "the configuration: keys, a brush, commands; and its errors"
cat >config <<END
theme light
brush 7 2
key plant P
key undu U
window liver 60 160
start overlay tint
start overlay red
who jane times=yes
END
rm -f s-*.iftty
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s.nii"
see '^config:4: there is no action undu; did you mean undo\?; left out$'
see '^config:7: LABELS: expected ' '^s>$'
pressing C-o '^axial at 12,10,8  brush 7 r2'
types "P" "seed 12,10,8 7 radius=2"
typing "?" '^  P +a seed of the label'
type_letters "q"
types "w5" "window -20 140"
type_letters "q"
entering "# a comment here" 'stored with the next recorded command'
entering "label 7 here"
entering "quit" '^journal: '
tail -n 4 s-1.iftty | tr '\n' '|' |
    grep -q '^# a comment here|#@ who=jane at=20.*Z session=1|label 7 here|= ' ||
    fail "$(tail -n 4 s-1.iftty)"
grep -qx 'overlay tint' s-1.iftty || fail "the command is not recorded"
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s-1.iftty" 'records* resumed'
entering "quit" '^journal: '
same "$(grep -cx 'overlay tint' s-1.iftty)" 1 # a session that goes on does not begin
expect 0 "$iftty" verify s-1.iftty
IFTTY_CONFIG=config expect 0 "$iftty" -c "open s.nii"
! grep -q overlay out || fail "a script is not begun with it"
echo "open s.nii" | IFTTY_CONFIG=config "$iftty" >out 2>err
! grep -q 'config\|overlay' out err || fail "nor is what is no terminal"

begin "a theme without colours has none anywhere"
echo "theme none" >config
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s.nii" '^s>$'
type_letters "see"
press C-u
pressing C-o '^axial'
typing "v" '^PEN DOWN'
! tmux_here capture-pane -e -p -t prompt |
    grep -q "$(printf '\033')\[\(1m\|[0-9;]*[34][0-8][;m]\)" || fail "there are colours"
typing "q" '^s>$'
entering "quit" '^journal: '
sane

begin "after labels the brush is exact, over or keeping a label, until they are undone"
printf 'start none\nbrush 1 1\n' >config
rm -f s-*.iftty
is_frozen() {
    case $(last_record) in "labels here finished=no erode=0 copy="*) ;; *) return 1 ;; esac
}
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s.nii" '^s>$'
pressing C-o '^axial at 12,10,8  brush 1 r1  '
commands "seed 2,2,2 0"
types "i" "seed 12,10,8 1 radius=1"
type_letters "gL"
comes_true is_frozen || fail "$(last_record)"
see '^axial at 12,10,8  brush 1 r1 exact  here 1 '
types "2bi" "seed 12,10,8 2 radius=1 within=0"
typing "go" '^axial .*  brush 2 r1 exact over 2  ' '^the brush: label 2, radius 1, exact, over 2$'
types "h" "cross 13,10,8"
types "3bi" "seed 13,10,8 3 radius=1 within=0 over=2"
typing "gO" '^axial .*  brush 3 r1 exact keep 3  '
types "h" "cross 14,10,8"
types "vhv" "seed 14,10,8 3 radius=1 to=15,10,8 within=0 keep=3"
typing "3gO" '^axial .*  brush 3 r1 exact  '
types "9h" "cross 23,10,8"
types "9j" "cross 23,1,8"
typing "*" '^the brush: label [01], radius 1, exact$'
types "4u" "undo 4"
pressing Escape '^axial at 23,1,8  brush [01] r1  here' # it grows again
typing "ge" '^the brush: label [01], radius 1, exact$'
typing "4bi" '^objects here were grown, .*; u, then gL keeps'
recorded "seed 23,1,8 4 radius=1 within=0"
types "u" "undo"
typing "2goge-i" '^over needs an exact brush .ge., or a single ball of radius 1 or more'
type_letters "q"
entering "quit" '^journal: '
expect 0 "$iftty" verify s-1.iftty

begin "keys typed while a command runs are taken after it, in their order"
rm -f synth-*.iftty
enter_anew "$iftty --graphics blocks synth:geom:240x240x240" '^Ctrl-O: the pilot'
pressing C-o '^axial at 120,120,120'
type_letters "ilK2ls2u:label 5 typed"
press Enter
comes_true grep -q '^label 5 typed$' synth-1.iftty || fail "$(cat synth-1.iftty)"
same "$(grep -v '^[=#]' synth-1.iftty | tail -n 7 | head -n 6 | paste -s -d ' ')" \
    "seed 120,120,120 1 radius=3 cross 119,120,120 cross 119,120,121 cross 117,120,121 \
seed 117,120,121 2 radius=3 undo"
type_letters "q"
enter "quit"
expect 0 "$iftty" verify synth-1.iftty

begin "in a script there is no pilot"
expect 2 "$iftty" -c "open s.nii; pilot"
grep -q "the pilot needs the prompt of a terminal" err || fail "$(cat err)"

finish
