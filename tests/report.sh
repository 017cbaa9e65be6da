#!/bin/sh
# SPDX-License-Identifier: MIT
# A page of iftty report in a browser: make test-report. Pictures stay in build/report.
. "$(dirname "$0")/lib.sh"
pages=$top/build/report
rm -rf "$pages"
mkdir -p "$pages"
browser() {
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/user" \
        "$@" "file://$pages/page.html" >browser.out 2>&1
}

begin "a page of every step of a lesson"
expect 0 "$iftty" report "$top/examples/first-organ.iftty" -o "$pages/page.html" --steps

begin "a browser draws it, wide and narrow, light and dark, and prints it"
for width in 1280 400; do
    for scheme in 1 0; do # light, dark
        shot=$pages/$width-$scheme.png
        browser --blink-settings=preferredColorScheme=$scheme --window-size=$width,2400 \
            --screenshot="$shot" || fail "$(tail -n 3 browser.out)"
        "$PYTHON" - "$shot" $scheme <<'END' || fail "$shot is not as expected"
import sys
from PIL import Image
picture = Image.open(sys.argv[1]).convert("RGB")
paper = picture.getpixel((2, 2))
light = min(paper) > 200 if sys.argv[2] == "1" else max(paper) < 60
sys.exit(0 if light and len(picture.getcolors(1 << 24)) > 200 else 1)
END
    done
done
browser --print-to-pdf="$pages/page.pdf" && [ "$(head -c 5 "$pages/page.pdf")" = "%PDF-" ] ||
    fail "$(tail -n 3 browser.out)"
grep -qi 'refused\|violates' browser.out && fail "the policy of the page refuses a part of it"

finish
