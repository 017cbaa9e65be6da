#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty report: a page about a journal.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
"$iftty" -c '# <b>why</b>
    open s.nii; label 1 "a<b>&"; seed 2,3,4 1; seed 6,10,8 2 radius=1; run; size 40 30; view 30 20
    golden first; # later
    label 300 far; seed 20,10,8 far; run; save labels map.nii; golden second' \
    --journal j.iftty >out 2>err || fail "$(cat err)"

begin "a page has the verdict, the chain, labels, slices, golden images and steps"
expect 0 "$iftty" report j.iftty -o page.html
expect 0 "$iftty" log j.iftty
chain=$(sed -n 's/^= .* chain=//p' out | tail -n 1)
grep -q "<p class=\"verified\">verified: .* results* the same</p>" page.html || fail "no verdict"
grep -q "<p>chain $chain<br>semantics 12, iftty " page.html || fail "no chain"
same "$(grep -c '<figure>' page.html)" 5 # three labels, two golden images
grep -q '<td class="n">300</td>' page.html || fail "no row of label 300"
same "$(grep -c 'a&lt;b&gt;&amp;' page.html)" 2 # its row, and its picture
same "$(grep -c 'a<b>' page.html)" 0
same "$(grep -c '<h2>Steps' page.html)" 0
expect 0 "$iftty" report j.iftty -o steps.html --steps
steps=$(sed -n 's/.*step 1 of \([0-9]*\), record.*/\1/p' steps.html | head -n 1)
same "$(grep -c '<figure>' steps.html)" $((5 + steps))
grep -q 'step 3 of [0-9]*, record .*: seed 6,10,8 2 radius=1$' steps.html || fail "no step"
grep -q '&lt;b&gt;why&lt;/b&gt;' steps.html || fail "no comment"

begin "the same journal gives the same page, which names no other file"
expect 0 "$iftty" report j.iftty -o again.html
same_files page.html again.html
same "$(grep -oE '(src|href)="[^"]{0,14}' steps.html | sort -u)" 'src="data:image/png'

begin "a comparison with a map"
expect 0 "$iftty" report j.iftty -o compared.html --compare map.nii
grep -q '<h2>Comparison with map.nii</h2>' compared.html || fail "no comparison"
grep -q 'Dice' compared.html || fail "no figures"
expect 3 "$iftty" report j.iftty -o none.html --compare nowhere.nii
[ ! -e none.html ] || fail "a page without its comparison"

begin "a journal that does not verify has a page that says so"
sed 's/^seed 2,3,4 1$/seed 2,3,5 1/' j.iftty >edited.iftty
cp -r j.golden edited.golden
expect 1 "$iftty" report edited.iftty -o edited.html
grep -q '<p class="failed">NOT verified: ' edited.html || fail "no failure"

begin "no file is overwritten, and a page needs a name"
expect_err "page.html exists; it was not overwritten" 3 "$iftty" report j.iftty -o page.html
same_files page.html again.html
expect_err "name the page, as in -o REPORT.html" 2 "$iftty" report j.iftty
expect 3 "$iftty" report nowhere.iftty -o x.html
[ ! -e x.html ] || fail "a page about nothing"

finish
