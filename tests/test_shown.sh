#!/bin/sh
# SPDX-License-Identifier: MIT
# Visibility and shading through the program: hide, show, opacity and context are recorded and
# resumed, and all but context are undone; occlusion and creases of `shade` are kept when edits are
# undone. Pictures change with them, and their journals verify.
. "$(dirname "$0")/lib.sh"

cat >scene <<'END'
open synth:geom:40x36x30
label 1 shell
label 2 core
seed 20,18,15 1 radius=8
seed 20,18,15 2 radius=4
seed 2,2,2 0
run
size 60 60
view 30 20
zoom 1.4
END

# picture COMMANDS...: the digest of the rendition after the scene and these
picture() {
    { cat scene; printf '%s\n' "$@" render; } >one
    rm -f one.iftty
    expect 0 "$iftty" run one --journal one.iftty
    last_word picture one.iftty
}
differ() { # two texts
    [ "$1" != "$2" ] || fail "'$1' twice"
}
# says JOURNAL RECORD PATTERN: print the \(..\) of a line of `info` after that record
says() {
    cp "$1" asked.iftty
    "$iftty" -c "goto $2; info" --journal asked.iftty 2>err | sed -n "s/^    $3/\1/p"
}

whole=$(picture)
without_shell=$(picture 'hide 1')
nothing=$(picture 'hide 1' 'hide 2')

begin "hide all and show all apply to every label, later ones too"
differ "$whole" "$nothing"
same "$(picture 'hide all')" "$nothing"
same "$(picture 'hide all' 'show all')" "$whole"
same "$(picture 'hide all' 'show core')" "$without_shell"
same "$(picture 'hide all' 'seed 8,8,8 3 radius=3' run)" "$nothing"
differ "$(picture 'hide all' 'seed 8,8,8 3 radius=3' run 'show 3')" "$nothing"
cp one.iftty hidden.iftty
[ "$(grep -cxE 'hide all|show 3' hidden.iftty)" = 2 ] || fail "$(grep -v '^= ' hidden.iftty)"
expect 0 "$iftty" verify hidden.iftty
expect 0 "$iftty" -c 'goto 13; stats' --journal hidden.iftty
[ "$(grep -c ', hidden$' out)" = 3 ] || fail "$(cat out)"
expect 0 "$iftty" -c 'undo 3; stats' --journal hidden.iftty
[ "$(grep -c ', hidden$' out)" = 0 ] || fail "$(cat out)"

begin "opacity is a setting of each label or of all, printed by info and undone by undo"
{ cat scene; printf '%s\n' 'opacity shell 30' 'opacity 2 55' 'opacity all 40' 'opacity all 100'
} >script
rm -f j.iftty
expect 0 "$iftty" run script --journal j.iftty
opacity='opacity   \(.*\)'
same "$(says j.iftty 10 "$opacity")" ""
same "$(says j.iftty 11 "$opacity")" "100 %, 30 % of label 1"
same "$(says j.iftty 12 "$opacity")" "100 %, 30 % of label 1, 55 % of label 2"
same "$(says j.iftty 13 "$opacity")" "40 %"
same "$(says j.iftty 14 "$opacity")" ""
expect 0 "$iftty" -c 'undo; undo; info; redo; info' --journal j.iftty
out_has "opacity   100 %, 30 % of label 1, 55 % of label 2" "opacity   40 %"
grep -qx 'opacity 1 30' j.iftty || fail "a name is recorded as its number: $(grep opac j.iftty)"

begin "translucency changes the picture, and no label; 0 omits an object"
through=$(picture 'opacity 1 30')
differ "$through" "$whole"
differ "$through" "$without_shell"
same "$(last_word labels one.iftty)" "$(last_word labels j.iftty)"
same "$(picture 'opacity 1 100')" "$whole"
same "$(picture 'opacity all 0')" "$nothing"
{ cat scene; printf '%s\n' 'opacity 1 30' 'render mode=sp' 'render mode=ray' 'golden through'
} >script
rm -f t.iftty
expect 0 "$iftty" run script --journal t.iftty
same "$(sed -n 's/.* picture=\([0-9a-f]*\).*/\1/p' t.iftty | sort -u)" "$through"
for threads in 1 3; do IFTTY_THREADS=$threads expect 0 "$iftty" verify --strict t.iftty; done
expect 0 "$iftty" replay t.iftty --out replayed
# One percent more gives another picture, and fails by its record.
sed 's/^opacity 1 30$/opacity 1 31/' t.iftty >changed
chain_anew changed t.iftty
expect_out "picture" 1 "$iftty" verify t.iftty

begin "context is a setting of the view, which uses the window"
around=$(picture 'context mip')
differ "$around" "$whole"
same "$(picture 'context mip' 'context none')" "$whole"
same "$(picture 'context mip' 'hide 1' undo)" "$around" # how one looks is not undone
differ "$(picture 'context mip' 'window 100 120')" "$around"
same "$(picture 'context mip' 'window 100 120' 'window auto')" "$around"
same "$(picture 'window 100 120')" "$whole"
differ "$(picture 'context mip' 'hide all')" "$nothing"
differ "$(picture 'context mip' 'clip axial 0-14')" "$(picture 'clip axial 0-14')"
rm -f c.iftty
{ cat scene; printf '%s\n' 'context mip' 'opacity 1 50' 'golden around'; } >script
expect 0 "$iftty" run script --journal c.iftty
same "$(says c.iftty 11 'look .*, \(context mip\)')" "context mip"
same "$(says c.iftty 10 'look .*, \(context mip\)')" "context mip"
for threads in 1 3; do IFTTY_THREADS=$threads expect 0 "$iftty" verify --strict c.iftty; done
expect_out "context mip" 0 "$iftty" -c 'info; hide 2; render' --journal c.iftty
expect 0 "$iftty" verify c.iftty
expect_out "iftty:context: mip, intensities " 0 "$iftty" info c.golden/around.png
# A slice has no context, also after a rendition with one.
rm -rf c.iftty c.golden
{ cat scene; printf '%s\n' 'context mip' 'render' 'window 20 90.5'; } >script
expect 0 "$iftty" run script --journal c.iftty
expect 0 "$iftty" -c 'golden axial of=axial; golden planes of=mosaic' --journal c.iftty
expect 0 "$iftty" verify --strict c.iftty
expect 0 "$iftty" info c.golden/axial.png
! grep -q "iftty:context" "$work/out" || fail "a slice has a context:" "$(cat "$work/out")"

cat >script <<'END'
open synth:geom:60x60x60
seed 2,2,2 0
seed 16,24,30 1 radius=4
seed 40,24,30 2 radius=4
run
size 120 120
zoom fit
info
golden plain
shade surface ao=60
info
golden dark
remove 40,24,30
run
undo 2
info
golden undone
shade surface ao=0
golden off
shade surface creases=yes
golden creases
shade surface ao=60 creases=yes
info
golden both
shade surface ao=60
shade surface
opacity all 50
shade surface ao=60
golden through
shade surface
golden clear
END

golden_of() { # NAME: the digest of a golden image
    sed -n "/^golden $1\$/{n;s/.* picture=\\([0-9a-f]*\\).*/\\1/p;}" a.iftty
}
begin "options of shade are recorded, kept when edits are undone, and printed"
rm -f a.iftty
expect_out "look      shade surface, light" 0 "$iftty" run script --journal a.iftty
out_has "look      shade surface ao=60, light"
same "$(grep -c 'shade surface ao=60, light' "$work/out")" 2
has_line a.iftty "shade surface ao=60"
out_has "look      shade surface ao=60 creases=yes, light"
has_line a.iftty "shade surface ao=60 creases=yes"
expect_out "iftty:look: shade surface ao=60, light" 0 "$iftty" info a.golden/dark.png
expect_out "iftty:look: shade surface, light" 0 "$iftty" info a.golden/off.png
expect_out "iftty:look: shade surface ao=60 creases=yes, light" 0 "$iftty" info a.golden/both.png

begin "without them, and where objects are translucent, pictures are as they were"
same "$(golden_of plain)" "$(golden_of off)"
same "$(golden_of dark)" "$(golden_of undone)"
same "$(golden_of through)" "$(golden_of clear)"
[ "$(golden_of plain)" != "$(golden_of dark)" ] || fail "nothing is darker"
# The objects do not touch, so their surfaces are the same with and without creases.
same "$(golden_of plain)" "$(golden_of creases)"
same "$(golden_of dark)" "$(golden_of both)"

begin "a journal with them verifies, for any number of threads, and resumes"
for threads in 1 2 5; do IFTTY_THREADS=$threads expect 0 "$iftty" verify a.iftty; done
printf 'info\nshade surface ao=7\ninfo\n' >more
expect_out "look      shade surface, light" 0 "$iftty" run more --journal a.iftty
out_has "look      shade surface ao=7, light"
expect 0 "$iftty" verify a.iftty

begin "an unknown word is named, and no command is recorded"
refused() { # COMMAND WORDS
    rm -f n.iftty
    expect_err "$2" 2 "$iftty" -c "open synth:geom:9x9x9; $1" --journal n.iftty
    same "$(grep -c '^= ' n.iftty)" 1
}
refused 'hide 0' "LABEL: expected all, a label 1..255 or the name of one, not 0"
refused 'show 256' "LABEL: expected all, a label 1..255 or the name of one, not 256"
refused 'show al' "not al; did you mean all?"
refused 'hide' "missing: LABEL; usage: hide all|LABEL"
refused 'opacity 0 50' "LABEL: expected all, a label 1..255"
refused 'opacity 1' "missing: PERCENT; usage: opacity all|LABEL PERCENT"
refused 'opacity 1 101' "PERCENT: expected a number 0..100, not 101"
refused 'opacity 1 0.5' "PERCENT: expected a number 0..100, not 0.5"
refused 'context' "missing: WHAT; usage: context none|mip"
refused 'context max' "WHAT: expected none|mip, not max"
for wrong in ao=101 ao=-1 ao=half ao=; do
    refused "shade surface $wrong" "ao: expected a number 0..100"
done
for wrong in 40 oa=40; do
    refused "shade surface $wrong" "usage: shade surface|cubes [ao=PERCENT] [creases=yes|no]"
done
refused "shade surface creases=on" "creases: expected yes|no, not on"
for command in 'hide all' 'opacity 1 30' 'context mip'; do
    expect_err "${command%% *} needs a scene; open one first" 2 "$iftty" -c "$command"
done

finish
