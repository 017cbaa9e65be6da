#!/bin/sh
# SPDX-License-Identifier: MIT
# `iftty serve`: a session that another program drives. Its journal equals that of the same commands
# at the prompt; cancelled, refused and truncated requests leave nothing behind.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
mkdir passing
TMPDIR=$work/passing # where the folders of sessions are
export TMPDIR

# Convert lines of commands, without quotes, to requests numbered from 1.
requests() {
    awk '{ printf "{\"id\": %d, \"do\": \"%s\"}\n", NR, $0 }' "$@"
}
answer() { # ID: the line of that answer
    grep "^{\"id\": $1, \"ok\": " out
}
has() { # LINE PART
    case $1 in *"$2"*) ;; *) fail "no '$2' in:" "$1" ;; esac
}
field() { # LINE NAME: the value of a text or number
    printf '%s\n' "$1" | sed -n "s/.*\"$2\": \"*\([^\",}]*\).*/\1/p"
}
folders() { # those of sessions that are there
    find passing -mindepth 1 -maxdepth 1 | wc -l
}
# Start a session: `ask LINE` writes to it, its answers are in the file `out`. SCENE...
start() {
    rm -f in
    : >out
    mkfifo in
    env --default-signal=INT "$iftty" serve "$@" <in >out 2>err &
    server=$!
    exec 3>in
    comes_true has_line out '"protocol"'
}
ask() { # JSON
    printf '%s\n' "$1" >&3
}
answered() { # ID
    comes_true has_line out "^{\"id\": $1, \"ok\""
}
asked() { # ID JSON: ask, and wait for the answer
    ask "$2"
    answered "$1"
}
stop() { # STATUS: of the session, once its input has ended
    exec 3>&-
    wait $server
    same $? "$1"
}

cat >commands <<'END'
seed 5,10,8 1 radius=2
seed 20,3,3 0
zoom 2
why 5,10,8
seed 12,10,8 2
undo
save labels l.nii
render
info
END

begin "the first line names the protocol and the open files, and no file is left at the end"
requests commands | expect 0 "$iftty" serve s.nii --journal a.iftty
first=$(sed 1q out)
has "$first" '{"protocol": 1, "ok": true, "program": "iftty", "version": "'
has "$first" '"records": 2'
has "$first" '"scene": {"size": [24, 20, 16], "spacing": '
has "$first" "\"journal\": \"$work/a.iftty\""
same "$(grep -c '"ok"' out)" 10
same "$(folders)" 0

begin "an answer has the number, the words and the files of its record"
has "$(answer 1)" '"ok": true, "record": 3, "command": "seed 5,10,8 1 radius=2", "text": "'
has "$(answer 1)" "\"forest\": \"$(words_of a.iftty 3 | tr ' ' '\n' | sed -n 's/^forest=//p')\""
has "$(answer 1)" '"seeds": 33'
has "$(answer 4)" '"record": null, "command": "why 5,10,8"'
has "$(answer 6)" '"at": 4'
has "$(answer 7)" "\"files\": [\"$work/l.nii\"]"
has "$(answer 8)" '"picture": "'
same "$(field "$(answer 9)" chain)" "$(last_word chain a.iftty)"

begin "the journal is that of the same commands at the prompt"
rm l.nii
{ cat commands; echo quit; } | expect 0 "$iftty" s.nii --journal b.iftty
same_files a.iftty b.iftty
expect 0 "$iftty" verify --no-strict a.iftty
rm l.nii
expect 0 "$iftty" serve s.nii </dev/null
[ -s s-1.iftty ] || fail "no journal was begun, as the prompt does"

begin "a thousand commands write the same journal as a run of them"
awk 'BEGIN { srand(7); print "open s.nii"; print "auto on"
    for (i = 0; i < 1000; i++) {
        at = int(rand() * 24) "," int(rand() * 20) "," int(rand() * 16); r = rand()
        if (r < .4) print "seed " at " " int(rand() * 4) " radius=" int(rand() * 3)
        else if (r < .5) print "undo"
        else if (r < .55) print "redo"
        else if (r < .6) print "remove " at
        else if (r < .65) print "auto " (rand() < .5 ? "on" : "off")
        else if (r < .7) print "run"
        else if (r < .75) print "goto " int(rand() * i / 2 + 1)
        else if (r < .8) print "label " int(1 + rand() * 3) " name" int(rand() * 9)
        else if (r < .85) print "stats"
        else if (r < .9) print "cross " at
        else if (r < .93) print "seed " at " name" int(rand() * 9)
        else if (r < .96) print "weight " (rand() < .5 ? "sobel" : "morph")
        else print "view " int(rand() * 360) " 10" } }' >many
"$iftty" run --keep-going many --journal run.iftty >/dev/null 2>&1
sed 1,2d many | requests | expect 0 "$iftty" serve s.nii --journal serve.iftty
same_files run.iftty serve.iftty
records=$(grep -c '^= ' run.iftty)
[ "$records" -gt 600 ] || fail "$records records alone"
same "$(grep -c '"ok"' out)" 1001

begin "an invalid request is answered with a message, and the session continues"
{
    echo '{"id": 1, "do": "sed 1,2,3 1"}'
    echo '{"id": 2, "do": "label 2 \"\u00e4\ud83d\ude00\" colour"}'
    printf '{"id": 4, "do": "label 2 \377"}\n'
    head -c 100000 /dev/zero | tr '\0' '['
    printf '\n{"id": 5, "do": "info'
    head -c 3000000 /dev/zero | tr '\0' ' '
    echo '"}'
    echo '{"id": 7, "array": "label"}'
    echo '{"id": 8, "do": "zoom 3"}'
    printf '{"id": 9, "do": "undo'
} | expect 0 "$iftty" serve s.nii --journal bad.iftty
has "$(answer 1)" '"hints": ["seed"], "column": 1}'
has "$(answer 2)" '"column": 14}'
has "$(answer 4)" '"why": "byte 26: expected UTF-8"'
out_has '"why": "byte 1: expected an object, as in'
out_has '"why": "the line is longer than 1048576 bytes; it is skipped"'
has "$(answer 7)" '"hints": ["labels"]'
has "$(answer 8)" '"ok": true, "record": 3'
has "$(answer 9)" '"why": "byte 22: expected the quote that ends a text"'
same "$(grep -c '^= ' bad.iftty)" 3

begin "a comment goes into the journal with its command; an array has the edits that wait, by a run"
printf '%s\n' '# deep inside' 'zoom 4' '#' 'auto off' 'seed 5,10,8 1' | requests >waiting
echo '{"id": 6, "array": "labels"}' >>waiting
expect 0 "$iftty" serve s.nii --journal w.iftty <waiting
same "$(grep -A1 '^# deep' w.iftty)" "# deep inside
zoom 4"
has "$(answer 6)" '"records": 6'
same "$(grep -A1 '^seed' w.iftty | sed -n 2p | grep -c pending)$(grep -c '^run$' w.iftty)" 11

# Relaxing the labels of this large scene takes seconds; each way to stop is tried after it began.
begin "a cancel undoes a long command completely, as Ctrl-C does"
start synth:geom --journal long.iftty
ask '{"id": 1, "do": "finish relax sweeps=1000 reach=16"}'
ask '{"id": 2, "do": "seed 100,100,50 1"}'
asked 3 '{"id": 3, "do": "seed 5,5,5 0"}'
cp long.iftty before.iftty
for way in cancel INT; do
    ask "{\"id\": \"$way\", \"do\": \"save labels long.nii finished=yes\"}"
    comes_true has_line out "\"id\": \"$way\", \"progress\": \"[a-z ]*\", \"done\": "
    case $way in
    cancel) ask '{"cancel": "cancel"}' ;;
    *) kill -s INT $server ;;
    esac
    answered "\"$way\""
    has "$(answer "\"$way\"")" '"kind": "cancelled", "why": "cancelled; nothing has changed"'
done
kill -s INT $server # where nothing is at hand, nothing is stopped
asked 4 '{"id": 4, "do": "finish none"}'
same_files before.iftty /dev/fd/0 <<END
$(sed '/^finish none/,$d' long.iftty)
END
asked 5 '{"id": 5, "array": "labels"}'
has "$(answer 5)" '"type": "uint8", "offset": 352, "size": [200, 200, 100]'
[ ! -e long.nii ] || fail "long.nii is there"
stop 0
"$iftty" run - --journal plain.iftty >/dev/null <<'END'
open synth:geom
auto on
finish relax sweeps=1000 reach=16
seed 100,100,50 1
seed 5,5,5 0
finish none
END
same_files plain.iftty long.iftty

begin "SIGTERM undoes the current command, and ends the session cleanly"
start synth:geom --journal term.iftty
ask '{"id": 0, "do": "finish relax sweeps=1000 reach=16"}'
ask '{"id": 1, "do": "seed 100,100,50 1"}'
ask '{"id": 2, "do": "seed 5,5,5 0"}'
ask '{"id": 3, "do": "save labels long.nii finished=yes"}'
ask '{"id": 4, "do": "zoom 2"}'
comes_true has_line out '"id": 3, "progress"'
kill -s TERM $server
wait $server
same $? 0
exec 3>&-
has "$(answer 3)" '"kind": "cancelled"'
same "$(answer 4)" ''
same "$(folders)" 0
expect 0 "$iftty" log --check term.iftty
start s.nii
kill -s TERM $server
wait $server
same $? 0
same "$(folders)" 0
exec 3>&-

begin "a session that was killed is gone on with, and its folder goes"
start s.nii --journal k.iftty
ask '{"id": 1, "do": "seed 5,10,8 1 radius=2"}'
asked 2 '{"id": 2, "array": "labels"}'
file=$(field "$(answer 2)" file)
[ -s "$file" ] || fail "no $file"
same "$(stat -c '%a %u' "${file%/*}")" "700 $(id -u)"
kill -s KILL $server
wait $server 2>/dev/null
exec 3>&-
same "$(folders)" 1
start k.iftty
same "$(folders)" 1
[ ! -e "$file" ] || fail "$file is still there"
has "$(cat out)" '"records": 3'
asked 1 '{"id": 1, "do": "undo"}'
stop 0
same "$(folders)" 0
expect 0 "$iftty" verify --no-strict k.iftty

begin "links in the folder are not followed, and another folder in its place is refused"
start s.nii --journal link.iftty
ask '{"id": 1, "do": "seed 5,10,8 1"}'
asked 2 '{"id": 2, "array": "cost"}'
folder=$(field "$(answer 2)" file)
folder=${folder%/*}
echo mine >victim
ln -s "$work/victim" "$folder/labels.nii"
asked 3 '{"id": 3, "array": "labels"}'
has "$(answer 3)" '"ok": true'
same "$(cat victim)" mine
[ ! -L "$folder/labels.nii" ] || fail "the link is still there"
mkdir elsewhere
mv "$folder" "$folder.aside"
ln -s "$work/elsewhere" "$folder"
asked 4 '{"id": 4, "array": "labels"}'
has "$(answer 4)" 'is no longer the private folder of this session'
rm "$folder"
mkdir -m 700 "$folder"
asked '"new"' '{"id": "new", "array": "labels"}'
has "$(answer '"new"')" 'is no longer the private folder of this session'
rmdir "$folder"
mv "$folder.aside" "$folder"
chmod 755 "$folder"
asked 5 '{"id": 5, "array": "labels"}'
has "$(answer 5)" 'is no longer the private folder of this session'
asked 6 '{"id": 6, "do": "render"}'
has "$(answer 6)" '"ok": true, "record": 4'
has "$(grep '"notice"' out)" 'nothing was written'
chmod 700 "$folder"
mkdir "$folder/deep"
ln -s "$work/elsewhere" "$folder/deep/out"
touch elsewhere/stays
stop 0
same "$(folders) $(ls elsewhere)" "0 stays"

begin "no record needs a file of the folder, but labels, of which the journal has a copy"
start s.nii --journal given.iftty
folder=$(field "$(sed 1q out)" folder)
ask '{"id": 1, "do": "seed 5,10,8 1 radius=2"}'
asked 2 '{"id": 2, "array": "border"}'
cp "$folder/border.nii" "$folder/given.nii"
ask "{\"id\": 3, \"do\": \"seed-file $folder/given.nii\"}"
ask "{\"id\": 4, \"do\": \"mask passing/${folder##*/}/given.nii\"}"
asked 5 "{\"id\": 5, \"do\": \"labels $folder/given.nii\"}"
has "$(answer 3)" 'is removed with this session, and the record of seed-file would need it'
has "$(answer 3)" '"column": 11'
has "$(answer 4)" 'is removed with this session, and the record of mask would need it'
has "$(answer 5)" "\"files\": [\"$work/given.golden/labels-"
stop 0
expect 0 "$iftty" verify --no-strict given.iftty

begin "no record and no journal goes with the folder, by whatever name or link it is reached"
cp s.nii outside.nii
start s.nii --journal stays.iftty
folder=$(field "$(sed 1q out)" folder)
mkdir "$folder/deep"
cp s.nii "$folder/deep/scene.nii"
ln -s "$folder" inside
ln -s "$folder/deep/scene.nii" scene.nii
ln -s "$folder/later.iftty" later.iftty
ln -s "$folder/images" gone.golden
n=0
refused() { # COMMAND: nothing of it is left
    n=$((n + 1))
    ask "{\"id\": $n, \"do\": \"$1\"}"
    answered $n
    has "$(answer $n)" '"ok": false'
    has "$(answer $n)" 'with this session'
}
for path in "$folder/j.iftty" inside/j.iftty passing/../inside/deep/j.iftty gone.iftty; do
    refused "journal $path"
done
refused 'journal later.iftty'
refused 'open scene.nii'
refused 'open inside/deep'
refused "open raw:$folder/deep/scene.nii size=24,20,16 type=uint8"
refused "save labels $folder/deep/l.nii"
refused 'save labels inside/l.nii'
ln -s "$folder/images" stays.golden
refused 'golden a-1'
refused 'labels outside.nii'
rm stays.golden
ask '{"id": 50, "do": "seed 5,10,8 1"}'
ask "{\"id\": 51, \"do\": \"stats report=$folder/report.json\"}"
asked 52 '{"id": 52, "do": "journal kept.iftty"}'
has "$(answer 50)" '"record": 3'
has "$(answer 51)" '"ok": true'
has "$(answer 52)" "\"journal\": \"$work/kept.iftty\""
stop 0
same "$(grep -c '^[a-z]' stays.iftty)" "$(grep -c '^[a-z]' kept.iftty)"
same "$(ls passing)" ''

begin "an outline changes the labels at once, and replaces another one, as at the prompt"
voxel() { # ANSWER X,Y,Z: of the labels, a byte each
    set -- "$(field "$1" file)" $(($(field "$1" offset) + $(echo "$2" |
        sed 's/\(.*\),\(.*\),\(.*\)/\1 + 24 * (\2 + 20 * \3)/')))
    od -An -tu1 -j "$2" -N1 "$1" | tr -d ' '
}
square() { # RIGHT: one of label 2 in an axial slice, 8 voxels high
    echo "outline 6,5,8 2 to=$1,5,8 to=$1,13,8 to=6,13,8"
}
start s.nii --journal outline.iftty
ask "{\"id\": 1, \"do\": \"$(square 14)\"}"
asked 2 '{"id": 2, "array": "labels"}'
has "$(answer 1)" "\"command\": \"$(square 14)\""
has "$(answer 1)" '"words": {"marker": "1-2", "forest": "'
same "$(for at in 10,9,8 14,13,8 16,9,8 10,2,8; do voxel "$(answer 2)" $at; done | xargs)" "2 2 0 0"
ask "{\"id\": 3, \"do\": \"$(square 11) instead=1\"}"
asked 4 '{"id": 4, "array": "labels"}'
has "$(answer 3)" '"words": {"removed": 1, "marker": "3-4", "forest": "'
same "$(for at in 10,9,8 13,9,8 14,13,8; do voxel "$(answer 4)" $at; done | xargs)" "2 0 0"
ask '{"id": 5, "do": "undo"}' # of both at once
ask '{"id": 6, "do": "outline 6,5,8 2 to=14,5,9 to=14,13,7"}'
ask '{"id": 7, "do": "outline 6,5,8 2 to=14,5,8"}'
ask "{\"id\": 8, \"do\": \"$(square 11) instead=77\"}"
ask '{"id": 9, "do": "outline 6,5,8 2 to=14,5,8 to=14,99,8"}'
asked 10 '{"id": 10, "do": "hints slice label=2"}'
same "$(field "$(answer 5)" labels)" "$(field "$(answer 1)" labels)"
has "$(answer 6)" '"kind": "bad input", "why": "the corners of a polygon must be in one slice'
has "$(answer 7)" '"kind": "bad usage", "why": "a polygon has three corners or more'
has "$(answer 8)" '"why": "instead: there is no marker 77'
has "$(answer 9)" '"why": "14,99,8 is outside the scene'
has "$(answer 9)" '"column": 27'
has "$(answer 10)" 'mm3 in doubt, at '
has "$(answer 10)" "\"chain\": \"$(field "$(answer 5)" chain)\"" # no refused line is recorded
stop 0
{ sed -n 's/^\(outline .*\|undo\)$/\1/p' outline.iftty; echo quit; } |
    expect 0 "$iftty" s.nii --journal prompt.iftty
same_files outline.iftty prompt.iftty

begin "a journal is looked at without being written to"
cp a.iftty look.iftty
chmod a-w look.iftty
printf '%s\n' 'seed 1,1,1 3' info | requests |
    expect 0 with_permissions "$iftty" serve look.iftty --read-only
has "$(sed 1q out)" '"read_only": true'
has "$(answer 1)" '"ok": true, "record": null, "command": "seed 1,1,1 3"'
has "$(answer 1)" '"ok": true'
same_files a.iftty look.iftty

begin "if the client stops reading, answered commands are kept, and the session ends"
{
    echo '{"id": 1, "do": "seed 5,10,8 1"}'
    comes_true test -s status >late
} | { "$iftty" serve s.nii --journal pipe.iftty 2>err; echo $? >status; } | sed 2q >/dev/null
same "$(cat status) $(cat late)" "3 "
same "$(cat err)" "iftty: cannot write to standard output"
expect 0 "$iftty" log --check pipe.iftty
same "$(grep -c '^= ' pipe.iftty)" 3
same "$(folders)" 0

begin "a file that cannot be opened is reported in the first line, too"
expect 3 "$iftty" serve missing.nii </dev/null
out_has '{"protocol": 1, "ok": false, "program": "iftty", "version": "'
out_has '"kind": "input or output failed", "why": "there is no scene missing.nii here'
expect_out 'there is no journal missing.iftty' 3 "$iftty" serve missing.iftty </dev/null
expect 2 "$iftty" serve s.nii --read-only </dev/null
same "$(folders)" 0

finish
