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
"$iftty" help | sed 's/^/    /' >"$help"
if sed -n '/^<!-- commands/,/^<!-- end of commands/p' README.md | sed '1,2d;$d' | sed '$d' |
    diff - "$help" >"$help.diff"; then
    echo "ok $number - the README lists the commands as help does"
else
    sed 's/^/# /' "$help.diff"
    echo "not ok $number - the README lists the commands as help does"
fi
rm -f "$help.diff"
number=$((number + 1))
views=$(sed -n '/^<!-- views/,/^<!-- end of views/s/^    \([^#]*\).*/\1/p' README.md |
    tr '\n' ';')
if ! "$iftty" -c "open ch2.nii.gz" >/dev/null 2>&1; then
    echo "ok $number - the views of the README # SKIP there is no ch2.nii.gz here"
elif output=$("$iftty" -c "open ch2.nii.gz; seed 90,120,90 1; $views" 2>&1) &&
    printf '%s\n' "$output" | grep -q 'ok 1[0-9] pick'; then
    echo "ok $number - the views of the README"
else
    printf '%s\n' "$output" | sed 's/^/# /'
    echo "not ok $number - the views of the README"
fi
echo "1..$number"
