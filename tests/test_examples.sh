#!/bin/sh
# SPDX-License-Identifier: MIT
# Every example journal verifies, digest for digest and pixel for pixel; the READMEs list the
# commands of the program, and the commands in them work.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

can_open() { # SCENE [OPTION...]
    file=${1%% *}
    for folder in $(echo "$IFTTY_SCENES" | tr : ' '); do
        case $1 in synth:*) return ;; *) [ ! -e "$folder/${file#raw:}" ] || return 0 ;; esac
    done
    skip "there is no $1 here"
    return 1
}

examples/scenes.sh "$work/scenes" 2>"$work/err" || skip "$(cat "$work/err")"
IFTTY_SCENES=/usr/share/mricron/templates:$work/scenes
export IFTTY_SCENES

for journal in examples/*.iftty; do
    begin "$journal verifies"
    if can_open "$(sed -n 's/^open //p' "$journal" | head -n 1)"; then
        expect 0 "$iftty" verify --strict "$journal" </dev/null ||
            fail "$(cat "$work/out")"
    fi
done

begin "the lesson corrects the labels that apply transfers to the subject"
if can_open subject.nii.gz; then
    expect_in "$work/scenes" 0 "$iftty" apply "$top/examples/first-organ.iftty" subject.nii.gz \
        --by landmarks --landmarks "$top/examples/subject-marks.txt" --fit similarity
    carried=$(sed -n 's/^labels .* copy=\([0-9a-f]*\).*/\1/p' "$work/scenes/subject.iftty")
    same "$carried" "$(sed -n 's/^labels .* copy=\([0-9a-f]*\).*/\1/p' examples/subject.iftty)"
fi

begin "journal/README.md lists the commands as help does"
"$iftty" help all | sed 's/^./    &/' >"$work/help"
sed -n '/^<!-- commands/,/^<!-- end of commands/p' journal/README.md | sed '1,2d;$d' | sed '$d' |
    diff - "$work/help" >"$work/diff" || fail "$(cat "$work/diff")"

# Run on a scene with all files that examples name; some examples have their own scene.
begin "the example in the help of every command works"
mkdir "$work/run"
"$iftty" help all | sed -n 's/^\([a-z][a-z-]*\)\( .*\)\{0,1\}$/\1/p' | sort -u >"$work/commands"
while read -r name; do
    "$iftty" help "$name" | sed -n 's/^ *Example: //p' | tail -n 1
done <"$work/commands" >"$work/lines"
same "$(wc -l <"$work/lines")" "$(wc -l <"$work/commands")"
make_scene "$work/run/unknown.nii" 24 20 16
{ nifti_header 12 12 12 4 16; head -c 3456 /dev/zero | tr '\0' '\001'; } >"$work/run/ct.nii"
seeds='seed 100,100,50 1 radius=8; seed 50,84,50 2; seed 5,5,5 0; run'
expect_in "$work/run" 0 "$iftty" -c 'open synth:geom:200x200x121; seed 9,9,9 1; run
    save labels brain.nii.gz'
cp "$work/run/brain.nii.gz" "$work/run/expert.nii.gz"
cp "$work/run/brain.nii.gz" "$work/run/flair.nii.gz"
expect_in "$work/run" 0 "$iftty" -c "open synth:geom:200x200x121; $seeds
    save labels model.nii.gz; save names aal.nii.txt"
cp "$work/run/model.nii.gz" "$work/run/aal.nii.gz"
echo "open synth:geom:200x200x121; $seeds" | tr ';' '\n' >"$work/run/script"
while read -r line; do
    case ${line%% *} in
    open | quit) before=info ;;
    orient) before='open unknown.nii' ;;
    interpolate) before='open synth:geom:20x20x20' ;;
    between)
        before='open synth:geom:20x20x20; fill 2,2,2 2 to=9,2,2 to=9,9,2 within=0
            fill 4,4,9 2 to=9,4,9 to=9,9,9 within=0'
        ;;
    object) before='open ct.nii; seed 6,6,6 2' ;;
    channel) before='open synth:geom:200x200x121' ;;
    show-channel) before='open synth:geom:200x200x121; channel brain.nii.gz' ;;
    pick) before='open synth:geom:40x40x40; seed 9,9,9 1; run; render' ;;
    redo) before='open synth:geom:20x20x20; seed 9,9,9 1; undo' ;;
    auto | finish | finished | mosaic | polarity | range | render | shade | spin | weight)
        before='open synth:geom:20x20x20; seed 9,9,9 1; run'
        rm -f "$work/run/brain.png"
        ;;
    pilot) continue ;; # needs a terminal: test_pilot.sh
    *)
        echo "$line" >>"$work/run/script"
        continue
        ;;
    esac
    expect_in "$work/run" 0 "$iftty" -c "$before; $line" || fail "$line"
done <"$work/lines"
expect_in "$work/run" 0 "$iftty" run script --keep-going || fail "$(cat "$work/err")"
same "$(grep -c '^ok' "$work/out")" "$(wc -l <"$work/run/script")"

begin "the READMEs name existing files and tests"
find . -path ./build -prune -o -type f -print | sed 's|.*/||' | sort -u >"$work/files"
sed -n 's/\.\(c\|sh\)$//p' "$work/files" >"$work/stems"
for readme in $(find . -path ./build -prune -o -name README.md -print); do
    found=$(grep -oE '\b[a-z_-]+\.(c|h|cc|sh|md|txt|py)\b' "$readme" | grep -vxFf "$work/files")
    [ -z "$found" ] || fail "$readme: there is no $found"
    found=$(grep -oE '\btest_[a-z_]+\b' "$readme" | sed 's/_racing$//' |
        grep -vxFf "$work/stems")
    [ -z "$found" ] || fail "$readme: there is no $found"
done

begin "journal/README.md lists the programs as --help does"
"$iftty" --help | sed -n '/^    iftty/,/^$/p' >"$work/help"
sed -n '/^<!-- programs/,/^<!-- end of programs/p' journal/README.md | sed '1,2d;$d' |
    diff - "$work/help" >"$work/diff" || fail "$(cat "$work/diff")"

# The commands of its sections, each of which ends with a pick.
for section in views slices; do
    begin "the $section of render/README.md"
    commands=$(sed -n "/^<!-- $section/,/^<!-- end of $section/s/^    \\([^#]*\\).*/\\1/p" \
        render/README.md | tr '\n' ';')
    if can_open ch2.nii.gz; then
        expect 0 "$iftty" -c "open ch2.nii.gz; seed 90,120,90 1; $commands" --out "$work" </dev/null
        grep -q '^ok 1[0-9] ' "$work/out" && grep -q '^ok - pick' "$work/out" ||
            fail "$(cat "$work/out")"
    fi
done

finish
