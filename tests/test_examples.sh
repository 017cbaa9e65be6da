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
echo "1..$number"
