#!/bin/sh
# SPDX-License-Identifier: MIT
# The pilot as a person meets it: keys into a real terminal (tmux, 80x24), what stands on its screen
# then, and what the journal says of it.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
. "$top/tests/tmux.sh"

make_scene u.nii 24 20 16 # which says nothing of the patient,
cp u.nii s.nii
printf '\001' | dd of=s.nii bs=1 seek=252 conv=notrunc 2>dd || fail "$(cat dd)" # and as his axes
half_block=$(printf '\342\226\200')
last_record() {
    grep -v '^[=#]' s-1.iftty | tail -n 1
}
# Waits until the last command of the journal is this one.
is_last_record() {
    [ "$(last_record)" = "$1" ]
}
recorded() {
    comes_true is_last_record "$1" || fail "the last command is '$(last_record)', not '$1'"
}
# Whether the magnified slices go on around another voxel than this.
has_panned() {
    case $(last_record) in *"at=$1") return 1 ;; "magnify "*) return 0 ;; *) return 1 ;; esac
}
# Whether the letters stand in this column, first above and then below.
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

begin "pilot takes the whole screen: slices, and where the cross-hair is"
enter_anew "$iftty --graphics blocks s.nii"
see '^24x20x16 voxels'
see '^Ctrl-O: the pilot, to segment by keys; `help`: the commands$'
enter "pilot"
see '^axial at 12,10,8  brush 1 r3  no label  intensity [0-9]*  [-0-9.,]* mm$'
screen_text | head -n 20 | grep -q "$half_block" || fail "there is no picture:" "$(screen_text)"
close_story

begin "what has nothing to show says how to begin"
see '^nothing to show yet: i plants a seed here'
close_story

begin "the brush has a radius, which - makes smaller"
type_letters "3-"
see '^axial at 12,10,8  brush 1  no label  intensity '
close_story

begin "keys move, seed, undo and turn, each as the command it is"
press Right
recorded "cross 11,10,8"
type_letters "3k"
recorded "cross 11,13,8"
type_letters "s2"
recorded "seed 11,13,8 2"
see 'voxels changed'
see '^axial at 11,13,8  brush 2  here 2 7.68 ml  intensity [0-9]*  [-0-9.,]* mm'
press Tab
see '^coronal at [0-9]*,13,[0-9]* '
see '^one label takes all: a here, then beyond its edge S encloses it; s0 background$'
type_letters "++s1"
recorded "seed 11,13,8 1 radius=2"
see '^coronal .*at 11,13,8  brush 1 r2  here 1 [0-9.]* m[lm][3 ]'
type_letters "u"
recorded "undo"
see '^undone: [0-9]+ seed 11,13,8 1 radius=2; after [0-9]+ seed 11,13,8 2'
press C-r
recorded "redo"
press S-Right
recorded "turn 15"
type_letters "I"
press Up
type_letters "-s3"
recorded "seed 11,13,9 3 radius=1 to=11,13,8"
close_story

begin "the pen that is down is told in colour, and by what the keys do"
type_letters "v"
press Tab
see '^PEN DOWN  sagittal '
see '^moving draws; v ends the stroke, Escape drops it$'
tmux_here capture-pane -e -p -t prompt | grep -q '41m.*PEN DOWN' || fail "it is not in colour"
press Escape
see '^sagittal '
press Tab Tab
see '^coronal '
close_story

begin "a stroke of the pen is one record when it is lifted, and none when it is dropped"
at=$(last_record)
type_letters "vlljj"
see '^PEN DOWN'
same "$(last_record)" "$at"
press Escape
see 'the stroke is dropped, and the pen is up'
same "$(last_record)" "$at"
type_letters "vlljjv"
recorded "seed 11,13,9 3 radius=1 to=9,13,9 to=9,13,7"
type_letters "u"
see '^undone: [0-9]+ seed '
type_letters ":cross 11,13,9"
press Enter
recorded "cross 11,13,9"
press Escape
see '^i seed '
close_story

begin "an Alt-KEY that does nothing is Escape, then KEY; one that pans still does"
press M-:
type_letters "finish largest"
press Enter
recorded "finish largest"
press M-:
type_letters "finish none"
press Enter
recorded "finish none"
type_letters "3"
press M-:
type_letters "zoom 2"
press Enter
recorded "zoom 2"
type_letters ":zoom 1"
press Enter
recorded "zoom 1"
type_letters "?" # a page of keys: Escape leaves it
see 'keys'
press M-:
type_letters "zoom 3"
press Enter
recorded "zoom 3"
type_letters ":zoom 1"
press Enter
recorded "zoom 1"
press M-h
recorded "pan -16 0"
press M-l
recorded "pan 16 0"
close_story

begin "finished labels are shown as one works, and the forest's again, by one key"
type_letters "y"
see '`:finish relax` has them settle on the edges'
type_letters ":finish relax sweeps=9"
press Enter
recorded "finish relax sweeps=9"
see '^the finish (breaks|reduces|deletes) label' # a page, since labels are lost from
see '^[(]any key[)]$'
type_letters " "
type_letters "y"
recorded "finished on"
tmux_here resize-window -t prompt -x 100 -y 24 # the place in mm comes before that word
see '^coronal at 11,13,9  brush 3 r1  finished  '
type_letters "s1"
recorded "seed 11,13,9 1 radius=1"
press Escape
see '^i seed ' # with the u before that, it would be Alt
see '^coronal at 11,13,9  brush 1 r1  finished  '
tmux_here resize-window -t prompt -x 80 -y 24
type_letters "uy"
recorded "finished off"
see '^coronal .*at 11,13,9  brush 1 r1  here '
type_letters "3b"
press Escape
see '^i seed '
close_story

begin "keys walk through hints, and tell how a voxel came to its label"
is_cross() {
    case $(last_record) in "cross "*) return 0 ;; *) return 1 ;; esac
}
type_letters ")"
see '^1  at [0-9]+,[0-9]+,[0-9]+: [0-9]+ voxels?, [0-9.]+ m[lm].*; label '
comes_true is_cross
type_letters "gh"
see '^red, where the border is least certain'
type_letters "P"
see '^label [0-9].*, cost [0-9]+, [0-9]+ steps?'
see '^P to its strongest edge .* Escape ends$' # and what keys do there
press Escape
type_letters "gh:cross 11,13,9"
press Enter
recorded "cross 11,13,9"
press Escape
see '^i seed '
close_story

begin "what is pasted acts nowhere: it stands in the line of the colon"
tmux_here set-buffer -b paste "$(printf 'box 10 xx u\nseed 1,1,1 2\nq ')"
before=$(last_record)
tmux_here paste-buffer -p -b paste -t prompt
hint='( \[range=LOW\.\.HIGH\] \[shell=yes\] \[around=LABEL\])?' # of a command
see "^:box 10 xx u seed 1,1,1 2 q$hint\$"
press Escape
see '^i seed '
type_letters ":label 5 "
tmux_here paste-buffer -p -b paste -t prompt
see '^:label 5 box 10 xx u seed 1,1,1 2 q( \[number=1\.\.65533\])?$'
press Enter
see '^error: '
type_letters "?"
see 'a seed of the label'
tmux_here paste-buffer -p -b paste -t prompt
sleep 0.3
see 'a seed of the label' # a page of text takes none
press Escape
see '^coronal '
same "$(last_record)" "$before"
close_story

begin "x shows the marker first, and removes it then"
type_letters "x"
see '^marker [0-9]+: [0-9]+ trees?, [0-9]+ voxels?, label [0-9].*; x removes it'
type_letters "x"
recorded "remove 11,13,9"
close_story

begin "? tells the keys, and any key goes back"
type_letters "?"
see 'a seed of the label'
type_letters "i"
see '^coronal at [0-9]*,13,[0-9]* '
recorded "remove 11,13,9"
close_story

begin "Tab finds commands and keys by a piece of a word, each with its key"
type_letters ":cont"
press Tab
see '^context  '
see '^overlay contour  o in the pilot: '
see '^:cont$'
press Escape
see '^i seed ' # the row above stays while a line is edited
type_letters ":pen"
press Tab
see "^v  *in the pilot, pen: pen draws; stroke's end$"
see '^:pen$'
press Escape
see '^i seed ' # the row above stays while a line is edited
type_letters ":und" # what begins so is completed as ever
press Tab
see '^:undo \[COUNT\]$'
press Escape
see '^i seed ' # the row above stays while a line is edited
close_story

begin "/ shows the keys that have a word in them"
type_letters "?"
see '^What is planted$'
type_letters "/contour"
see '^/contour$'
see '^  o  *overlay  *contour; finish; greys$'
press Enter
see '^/ shows what has a word in it; any other key leaves$'
type_letters "i"
see '^coronal at [0-9]*,13,[0-9]* '
recorded "remove 11,13,9"
close_story

begin "a colon takes a command; what says more than a line has a page"
type_letters ":"
enter "label 3 node"
recorded "label 3 node"
tmux_here resize-window -t prompt -x 100 -y 24 # the brush's name is the first to fall out
see '^coronal at 11,13,9  brush 3 node r1  here '
tmux_here resize-window -t prompt -x 80 -y 24
see '^coronal at 11,13,9  brush 3 r1  here '
type_letters ":"
enter "help seed"
see 'plant a seed'
see '\(any key\)'
press Enter
see '^coronal at [0-9]*,13,[0-9]* '
type_letters ":"
enter "sed 1"
see 'error: unknown command sed'
close_story

begin "an answer longer than the screen comes page by page"
type_letters ":"
enter "help"
see '^The scene'
see '^-- more --$'
press Space
see '^outline X,Y,Z '
type_letters "q"
see '^coronal at [0-9]*,13,[0-9]* '
type_letters ":"
enter "help"
see '^The scene'
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
see '^quit  *leave'
see '^[(]any key[)]$'
press Escape
see '^coronal at [0-9]*,13,[0-9]* '
close_story

begin "a message of more than a row takes both, until the next key"
type_letters ":"
enter "seed 1,1,1 a-name-that-no-label-has-been-given-and-that-is-long"
see '^error: LABEL: expected'
see 'name one with'
press Tab
see '^sagittal '
press Tab Tab
see '^coronal at [0-9]*,13,[0-9]* '
close_story

begin "what the keys do in a mode stands below as long as it lasts, and fits"
type_letters "w"
press Left
see '^window [-0-9.]+ [-0-9.]+  arrows  a auto  Enter done  1 bone  2 brain  3 lung'
press Enter
see '^i seed '
type_letters "w2"
recorded "window 0 80"
see '^the window of brain$'
type_letters "p"
press Left
see '^CORRECT at pixel [0-9]+,[0-9]+  0-9 a seed there  p to its voxel  Escape ends$'
see '^CORRECT  (axial|coronal|sagittal) '
press Escape
see '^i seed '
type_letters ":"
enter "size 16 16"
recorded "size 16 16"
type_letters "plllllllllllllljjjjjjjjjjjjjj" # to the last of the pane's pixels, which are more
see '^CORRECT at pixel [2-9][0-9],[2-9][0-9]  '
press Escape
see '^i seed '
type_letters ":"
enter "size 512 512"
recorded "size 512 512"
close_story

begin "slices are magnified and moved by commands; what has the screen is no command"
type_letters "]]"
recorded "magnify 1.5 at=11,13,9"
see '^coronal x1.5 at 11,13,9 '
press M-Up # to the sides all is seen
comes_true has_panned 11,13,9 || fail "$(last_record)"
type_letters "gz"
recorded "magnify 1.5 at=11,13,9"
before=$(grep -c . s-1.iftty)
type_letters "f"
comes_true sides_are 'S' 'I' 40 || fail "$(screen_text)"
type_letters "f"
comes_true sides_are_not 'S' 'I' 40 || fail "$(screen_text)"
same "$(grep -c . s-1.iftty)" "$before"
type_letters "W"
recorded "magnify fit"
see '^coronal at 11,13,9 '
close_story

begin "the patient's sides and a scale bar stand in cells"
see '^ *[0-9]+ mm'
screen_text | head -n 22 | grep -q '^R' || fail "$(screen_text)"
screen_text | head -n 22 | grep -q '^A' && fail "there is no A on the left of a coronal slice"
type_letters ":"
enter "overlay words=off"
comes_true no_words || fail "$(screen_text)"
type_letters ":"
enter "overlay words=on"
see '^ *[0-9]+ mm'
close_story

begin "boxes, polygons, millimetres and intensities, each as the command it is"
type_letters ":"
enter "cross 12,13,8"
see '^coronal at 12,13,8'
type_letters "2ba"
see '^1 corner; d plants the box'
type_letters "2l3k"
see '^coronal at 10,13,11  brush 2 r1 1 corner  '
type_letters "d"
recorded "box 12,13,8 10,13,11 2"
type_letters "aha"
recorded "cross 11,13,11"
type_letters "j"
recorded "cross 11,13,10"
type_letters "aA"
recorded "outline 10,13,11 2 to=11,13,11 to=11,13,10"
type_letters "T-99999..99999"
see '^intensities LOW..HIGH, or none: -99999..99999_  Enter takes it  Escape leaves$'
press Enter
see '^coronal at 11,13,10  brush 2 r1 -99999..99999  '
type_letters "M"
see 'radius 1mm, intensities'
type_letters "i"
recorded "seed 11,13,10 2 radius=1mm range=-99999..99999"
type_letters "M-T"
press Enter
see '^the brush: label 2, radius 0$'
close_story

begin "an outline is drawn, closed, taken up again, dragged, and takes the place of what it was"
type_letters ":"
enter "cross 12,13,8"
see '^coronal at 12,13,8'
type_letters "@"
see '^OUTLINE  coronal at 12,13,8'
see '^moving, or the mouse, draws an outline  Enter plants it  Escape drops it$'
type_letters "4l4k4h"
see '^OUTLINE  coronal at 12,13,12  brush 2 4 corners'
press Enter
recorded "outline 12,13,8 2 to=8,13,8 to=8,13,12 to=12,13,12"
type_letters "U"
see '^the outline of marker [0-9]+$'
type_letters "v"
see '^held: moving drags it  Enter plants it  v takes hold, lets go  Escape drops it$'
type_letters "2h"
press Enter
comes_true replaces_outline || fail "$(last_record)"
type_letters "}"
see ' in doubt; the (border|outline) of '
press Escape
see '^the outline is dropped$'
type_letters ":"
enter "cross 11,13,10"
see '^through 11,13,10'
for plane in 1 2 3; do # it may be any of them
    press Tab
    comes_true shows ' at 11,13,10 '
    shows '^coronal ' && break
done
see '^coronal at 11,13,10'
close_story

begin "stopped and continued, the screen comes back"
press C-z
see '[Ss]topped'
enter "fg"
see '^coronal at [0-9]*,13,[0-9]* '
close_story

begin "another size of the window is another picture"
stands_in_row() {
    screen_text | sed -n "$1p" | grep -q '^coronal at [0-9]*,13,[0-9]* '
}
tmux_here resize-window -t prompt -x 130 -y 30
comes_true stands_in_row 29 || fail "the screen is:" "$(screen_text | grep .)"
see '^coronal at .* mm  mean [0-9.]*, SD [0-9.]*, [0-9.]* x [0-9.]* x [0-9.]* m' # of the label
enter ":seed 20,4,3 0"
see '^this `seed` took .* of label 1 through 20,4,2; undo takes it back$' # lines are a page
see '^[(]any key[)]$'
type_letters " "
see '^coronal at [0-9]*,13,[0-9]* '
enter ":cross 20,4,3"
see '^coronal at [0-9]*,4,.*  here 0  changed [0-9] [0-9.]* m[lm]3? .*  intensity '
type_letters "u"
recorded "undo"
enter ":cross 11,13,10"
see '^through 11,13,10'
type_letters "lh"
see '^i seed  b label'
tmux_here resize-window -t prompt -x 80 -y 24
comes_true stands_in_row 23 || fail "the screen is:" "$(screen_text | grep .)"
close_story

begin "the smallest window: the keys page by page, and the pen is loud"
tmux_here resize-window -t prompt -x 20 -y 10
see '^coronal at 11,13,10$'
see '^i seed  q back$' # nothing is cut within a word, and how to leave is there
type_letters "?"
see '^h j k l arrows$'
see '^  move the$'
see '^-- more --$'
tmux_here resize-window -t prompt -x 80 -y 24
see 'h j k l arrows   move the cross-hair     H L Ctrl-arrows'
tmux_here resize-window -t prompt -x 20 -y 10
see '^h j k l arrows$'
type_letters "q"
see '^coronal at 11'
type_letters "v"
see '^PEN DOWN  coronal$'
press Escape
see '^coronal at 11'
tmux_here resize-window -t prompt -x 80 -y 24
see '^coronal at'
close_story

begin "q goes back to the prompt, with the screen as it was before"
type_letters "q"
see '^s>$'
see '^24x20x16 voxels'
enter "quit"
see '^journal: '
sane
close_story

begin "what was done in the pilot replays like any other session"
expect 0 "$iftty" verify s-1.iftty
grep -qx 'cross 11,13,8' s-1.iftty || fail "a move is not in the journal"
close_story

begin "no side is named where nobody knows it"
enter_anew "$iftty --graphics blocks u.nii"
see '^u>$'
press C-o
see '^ *10 mm'
see '^z=8 at 12,10,8 .* orientation unknown'
press Tab
see '^y=10 at 12,10,8 '
screen_text | head -n 22 | grep -q '[RLAPSI]' && fail "$(screen_text)"
type_letters "q"
see '^u>$'
enter "quit"
see '^journal: '
sane
close_story

begin "Ctrl-O is the pilot too; killed there, the terminal is sane"
enter_anew "sh -c 'echo \$\$ >pid; exec $iftty --graphics blocks s-1.iftty'"
see '^s-1>$'
press C-o
see '^axial'
kill -TERM "$(cat pid)"
see '[Tt]erminated'
sane
expect 0 "$iftty" verify s-1.iftty
close_story

begin "killed while the pen is down, all but that stroke is in the journal"
enter_anew "sh -c 'echo \$\$ >pid; exec $iftty --graphics blocks s-1.iftty'"
see '^s-1>$'
press C-o
see '^axial'
type_letters "s4"
comes_true grep -q '^seed .* 4' s-1.iftty || fail "$(last_record)"
last=$(last_record)
type_letters "vlllkkk"
see '^PEN DOWN'
shows_stroke() { # the cross-hair is where the keys have led
    screen_text | grep -q "^PEN DOWN .* at $1 "
}
end=$(echo "$last" | sed 's/^seed //; s/ .*//' | awk -F, '{ print $1 - 3 "," $2 + 3 "," $3 }')
comes_true shows_stroke "$end" || fail "not at $end:" "$(screen_text)"
kill -KILL "$(cat pid)"
is_given_back() { # by the guardian, which has gone then
    [ "$(tmux_here display-message -p -t prompt '#{alternate_on}#{mouse_any_flag}')" = 00 ] &&
        ! ps -t "$(tmux_here display-message -p -t prompt '#{pane_tty}')" -o comm= | grep -q iftty
}
comes_true is_given_back || fail "$(screen_text)"
sane
same "$(last_record)" "$last"
expect 0 "$iftty" verify s-1.iftty
expect 0 "$iftty" log --check s-1.iftty
grep -q '^intact' out || fail "$(cat out)"
enter_anew "$iftty --graphics blocks s-1.iftty"
see '^s-1>$'
enter "undo"
see "^undone: [0-9]* $last"
enter "quit"
see '^journal: '
sane
close_story

begin "the ten keys of README.md segment a brain"
cat >reference <<END
open ch2.nii.gz
mask ch2bet.nii.gz
seed 60,108,90 1
run
END
if "$iftty" run reference >/dev/null 2>&1; then
    enter_anew "IFTTY_CONFIG= $iftty --graphics blocks ch2.nii.gz"
    see '^ch2>$'
    press C-o
    see '^axial at 90,108,90  brush 1 r6'
    keys=$(sed -n '/^<!-- organ/,/^<!-- end of organ/s/^    \([^ ]*\) .*/\1/p' "$top/README.md")
    same "$(printf '%s\n' "$keys" | wc -l)" 10
    for key in $keys; do type_letters "$key"; done
    see '^axial at 20,108,10  brush 0 r6  here 0'
    see '^the finish breaks label 1 to 1690916 voxels in 4 pieces; see `stats`'
    type_letters "1bgc" # the volume is that of what is shown, which has settled
    tmux_here resize-window -t prompt -x 110 -y 24
    see 'finished  here 1 1\.69 l'
    tmux_here resize-window -t prompt -x 80 -y 24
    type_letters "q"
    see '^ch2>$'
    enter "quit"
    see '^journal: ' # what is typed before is the prompt's, and goes with it
    sane
    "$iftty" log --script ch2-1.iftty >organ
    echo "compare ch2bet.nii.gz label=1 finished=yes" >>organ
    "$iftty" run organ >out 2>err
    grep -q '^ *1 *0\.95' out || fail "$(cat out err)"
else
    skip "there is no ch2.nii.gz here"
fi
close_story

begin "what a user has written down: keys, a brush, commands; and what of it is wrong"
cat >config <<END
theme light
brush 7 2
key plant P
key undu U
window liver 60 160
start overlay tint
start overlay red
END
rm -f s-*.iftty
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s.nii"
see '^config:4: there is no action undu; did you mean undo\?; left out$'
see '^config:7: LABELS: expected '
see '^s>$'
press C-o
see '^axial at 12,10,8  brush 7 r2'
type_letters "P"
recorded "seed 12,10,8 7 radius=2"
type_letters "?"
see '^  P +a seed of the label'
type_letters "q"
type_letters "w5"
recorded "window -20 140"
type_letters "q"
enter "quit"
see '^journal: '
grep -qx 'overlay tint' s-1.iftty || fail "the command is not recorded"
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s-1.iftty"
see 'resumed as they left it'
enter "quit"
see '^journal: '
same "$(grep -cx 'overlay tint' s-1.iftty)" 1 # a session that goes on does not begin
expect 0 "$iftty" verify s-1.iftty
IFTTY_CONFIG=config expect 0 "$iftty" -c "open s.nii"
! grep -q overlay out || fail "a script is not begun with it"
echo "open s.nii" | IFTTY_CONFIG=config "$iftty" >out 2>err
! grep -q 'config\|overlay' out err || fail "nor is what is no terminal"
close_story

begin "a theme without colours has none anywhere"
echo "theme none" >config
enter_anew "IFTTY_CONFIG=config $iftty --graphics blocks s.nii"
see '^s>$'
type_letters "see"
press C-u
press C-o
see '^axial'
type_letters "v"
see '^PEN DOWN'
! tmux_here capture-pane -e -p -t prompt | grep -q "$(printf '\033')\[[0-9;]*[34][0-8][;m]" ||
    fail "there are colours"
type_letters "q"
see '^s>$'
enter "quit"
see '^journal: '
sane
close_story

begin "keys typed while a command runs are taken after it, in their order"
rm -f synth-*.iftty
enter_anew "$iftty --graphics blocks synth:geom:240x240x240"
see '^Ctrl-O: the pilot'
press C-o
see '^axial at 120,120,120'
type_letters "ilK2ls2u"
comes_true grep -q '^undo$' synth-1.iftty || fail "$(cat synth-1.iftty)"
same "$(grep -v '^[=#]' synth-1.iftty | tail -n 6 | paste -s -d ' ')" \
    "seed 120,120,120 1 radius=3 cross 119,120,120 cross 119,120,121 cross 117,120,121 \
seed 117,120,121 2 radius=3 undo"
type_letters "q"
enter "quit"
expect 0 "$iftty" verify synth-1.iftty
close_story

begin "in a script there is no pilot"
expect 2 "$iftty" -c "open s.nii; pilot"
grep -q "the pilot needs the prompt of a terminal" err || fail "$(cat err)"
close_story

finish
