#!/bin/sh
# Every example journal verifies, digest for digest and pixel for pixel; what the READMEs say of
# commands is what the program says, and the commands of its sections work.
. "$(dirname "$0")/lib.sh"

can_open() { # SCENE
    "$iftty" -c "open $1" </dev/null >/dev/null 2>&1 || { skip "there is no $1 here"; return 1; }
}

for journal in examples/*.iftty; do
    begin "$journal verifies"
    if can_open "$(sed -n 's/^open //p' "$journal" | head -n 1)"; then
        expect 0 "$iftty" verify --strict --lock examples/iftty.lock "$journal" </dev/null ||
            fail "$(cat "$work/out")"
    fi
    close_story
done

begin "journal/README.md lists the commands as help does"
"$iftty" help | sed 's/^./    &/' >"$work/help"
sed -n '/^<!-- commands/,/^<!-- end of commands/p' journal/README.md | sed '1,2d;$d' | sed '$d' |
    diff - "$work/help" >"$work/diff" || fail "$(cat "$work/diff")"
close_story

begin "what the READMEs name is there"
find . -path ./build -prune -o -type f -print | sed 's|.*/||' | sort -u >"$work/files"
for readme in $(find . -path ./build -prune -o -name README.md -print); do
    for name in $(grep -oE '\b[a-z_]+\.(c|h|cc|sh|md|txt|py)\b' "$readme" | sort -u); do
        grep -qxF -e "$name" "$work/files" || fail "$readme: there is no $name"
    done
    for name in $(grep -oE '\btest_[a-z_]+\b' "$readme" | sort -u); do
        grep -qxE -e "$name\.(c|sh)|${name%_racing}\.c" "$work/files" ||
            fail "$readme: there is no $name"
    done
done
close_story

begin "the README lists the programs as --help does"
"$iftty" --help | sed -n '/^    iftty/,/^$/p' >"$work/help"
sed -n '/^<!-- programs/,/^<!-- end of programs/p' README.md | sed '1,2d;$d' |
    diff - "$work/help" >"$work/diff" || fail "$(cat "$work/diff")"
close_story

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
    close_story
done

finish
