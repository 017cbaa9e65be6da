#!/bin/sh
# Every example journal verifies, digest for digest and pixel for pixel.
iftty=${IFTTY_BUILD:-build}/iftty
number=0
for journal in examples/*.iftty; do
    number=$((number + 1))
    scene=$(sed -n 's/^open //p' "$journal" | head -n 1)
    if ! "$iftty" -c "open $scene" >/dev/null 2>&1; then
        echo "ok $number - $journal verifies # SKIP there is no $scene here"
    elif output=$("$iftty" verify "$journal" 2>&1); then
        echo "ok $number - $journal verifies"
    else
        printf '%s\n' "$output" | sed 's/^/# /'
        echo "not ok $number - $journal verifies"
    fi
done
number=$((number + 1))
help=$(mktemp)
trap 'rm -f "$help"' EXIT
"$iftty" help | sed 's/^./    &/' >"$help"
if sed -n '/^<!-- commands/,/^<!-- end of commands/p' README.md | sed '1,2d;$d' | sed '$d' |
    diff - "$help" >"$help.diff"; then
    echo "ok $number - the README lists the commands as help does"
else
    sed 's/^/# /' "$help.diff"
    echo "not ok $number - the README lists the commands as help does"
fi
rm -f "$help.diff"
# The commands of the README's sections, each of which ends with a pick.
folder=$(mktemp -d)
trap 'rm -rf "$help" "$folder"' EXIT
for section in views slices; do
    number=$((number + 1))
    commands=$(sed -n "/^<!-- $section/,/^<!-- end of $section/s/^    \\([^#]*\\).*/\\1/p" README.md |
        tr '\n' ';')
    if ! "$iftty" -c "open ch2.nii.gz" >/dev/null 2>&1; then
        echo "ok $number - the $section of the README # SKIP there is no ch2.nii.gz here"
    elif output=$("$iftty" -c "open ch2.nii.gz; seed 90,120,90 1; $commands" --out "$folder" 2>&1) &&
        printf '%s\n' "$output" | grep -q 'ok 1[0-9] pick'; then
        echo "ok $number - the $section of the README"
    else
        printf '%s\n' "$output" | sed 's/^/# /'
        echo "not ok $number - the $section of the README"
    fi
done
echo "1..$number"
