#!/bin/sh
# SPDX-License-Identifier: MIT
# Ambient occlusion and creases as users meet them: words of `shade` that are recorded, stand when
# edits are undone, are kept with golden images, and printed by `info` and in pictures.
. tests/lib.sh
cd "$work" || exit 1

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

picture() { # NAME: the digest of a golden image
    sed -n "/^golden $1\$/{n;s/.* picture=\\([0-9a-f]*\\).*/\\1/p;}" a.iftty
}

begin "words of shade are recorded, stand when edits are undone, and are printed"
expect 0 "$iftty" run script --journal a.iftty
out_has "look      shade surface, light"
out_has "look      shade surface ao=60, light"
same "$(grep -c 'shade surface ao=60, light' "$work/out")" 2
has_line a.iftty "shade surface ao=60"
out_has "look      shade surface ao=60 creases=yes, light"
has_line a.iftty "shade surface ao=60 creases=yes"
expect 0 "$iftty" info a.golden/dark.png
out_has "iftty:look: shade surface ao=60, light"
expect 0 "$iftty" info a.golden/off.png
out_has "iftty:look: shade surface, light"
expect 0 "$iftty" info a.golden/both.png
out_has "iftty:look: shade surface ao=60 creases=yes, light"
close_story

begin "without them, and where objects are translucent, pictures are as they were"
same "$(picture plain)" "$(picture off)"
same "$(picture dark)" "$(picture undone)"
same "$(picture through)" "$(picture clear)"
[ "$(picture plain)" != "$(picture dark)" ] || fail "nothing is darker"
# The objects do not touch, so each has the surface that it has by itself in any case.
same "$(picture plain)" "$(picture creases)"
same "$(picture dark)" "$(picture both)"
close_story

begin "a journal with them verifies, for any number of threads, and resumes"
for threads in 1 2 5; do
    IFTTY_THREADS=$threads expect 0 "$iftty" verify a.iftty
done
printf 'info\nshade surface ao=7\ninfo\n' >more
expect 0 "$iftty" run more --journal a.iftty
out_has "look      shade surface, light"
out_has "look      shade surface ao=7, light"
expect 0 "$iftty" verify a.iftty
close_story

begin "what is no percentage, and neither yes nor no, is refused"
for wrong in ao=101 ao=-1 ao=half ao=; do
    expect 2 "$iftty" -c "open synth:geom:20x20x20; shade surface $wrong"
    err_has "ao: expected a number 0..100"
done
for wrong in 40 oa=40; do
    expect 2 "$iftty" -c "open synth:geom:20x20x20; shade surface $wrong"
    err_has "usage: shade surface|cubes [ao=PERCENT] [creases=yes|no]"
done
expect 2 "$iftty" -c "open synth:geom:20x20x20; shade surface creases=on"
err_has "creases: expected yes|no, not on"
close_story

finish
