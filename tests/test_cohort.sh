#!/bin/sh
# SPDX-License-Identifier: MIT
# The scripts of examples/cohort, without an engine: one subject, and the results of several.
# Engines, and tasks that are killed for good, are `make test-cohort`.
. "$(dirname "$0")/lib.sh"
cohort=$top/examples/cohort
mkdir -p study/sub-01/anat store
make_scene s.nii 24 20 16
put s.nii 254 '\001\000' # the place of its voxels: the millimetres are their numbers
for diagonal in 280 300 320; do put s.nii $diagonal '\000\000\200\077'; done
gzip -nc s.nii >store/one
ln -s ../../../store/one study/sub-01/anat/sub-01_T1w.nii.gz
expect 0 "$iftty" -c 'open s.nii; label 1 "a <b>"; seed 2,2,2 0; seed 12,10,8 1 radius=3; run' \
    --journal expert.iftty
here=made/sub-01/anat
sidecar=$here/sub-01_desc-iftty_dseg.json
journal=$here/sub-01_T1w.iftty

subject() { # STATUS PROGRAM
    expect "$1" "$cohort/subject.py" --iftty "$2" --by world expert.iftty \
        study/sub-01/anat/sub-01_T1w.nii.gz made
    [ ! -e made/.work ] || fail "the work folder stays"
    same "$(find made -name '*.part')" ''
}
says() { # CONDITION ON told
    "$PYTHON" -c 'import json, sys; told = json.load(open(sys.argv[1]))
sys.exit(not eval(sys.argv[2]))' $sidecar "$1" || fail "the sidecar: not $1"
}

begin "a subject has journal, labels, picture and sidecar, and is done once"
subject 0 "$iftty"
out_has "sub-01: done"
same "$(cd $here && echo *.*)" "sub-01_T1w.golden sub-01_T1w.iftty sub-01_T1w.seeds.nii.gz $(
    )sub-01_desc-iftty_dseg.json sub-01_desc-iftty_dseg.nii.gz sub-01_desc-iftty_mosaic.png"
says 'told["Verified"] and told["Stats"]["by_label"][0]["name"] == "a <b>"'
says '"dropped=" in told["Origin"] and told["Cost"]["Apply"]["MemoryMegabytes"] > 1'
says 'told["Sources"] == ["bids:raw:sub-01_T1w.nii.gz"]'
expect 0 "$iftty" verify $journal
cp $sidecar first
subject 0 "$iftty"
out_has "sub-01: there already"
same_files $sidecar first

begin "a killed subject continues: without sidecar or labels, or with a corrected journal"
rm $sidecar $here/*_dseg.nii.gz
subject 0 "$iftty"
out_has "sub-01: done"
says 'told["Cost"]["Apply"]["JournalWasThere"] and told["Apply"][0]["state"] == "there"'
expect 0 "$iftty" -c 'seed 2,17,2 1 radius=1; run' --journal $journal
cp $journal corrected
subject 0 "$iftty"
out_has "sub-01: done"
same_files $journal corrected
says 'told["Stats"]["by_label"][0]["voxels"] != json.load(open("first"))["Stats"]["by_label"][0][
    "voxels"]'

# A program in the place of iftty, for `apply` alone.
instead() { # SCRIPT
    printf '#!/bin/sh\n[ "$1" = apply ] || exec "%s" "$@"\n%s\n' "$iftty" "$1" >instead
    chmod +x instead
}

begin "a refused subject is done, with the reason; a failure leaves no sidecar and prints the cause"
rm -rf made
instead 'echo "[{\"state\": \"refused\", \"why\": \"no overlap\"}]"; exit 1'
subject 0 ./instead
out_has "sub-01: refused: no overlap"
says 'told["Refused"] == "no overlap" and "Chain" not in told'
rm -rf made
instead 'echo "[{\"state\": \"failed\", \"why\": \"no space\"}]"; exit 3'
subject 3 ./instead
err_has "sub-01: Apply, status 3: ; no space"
[ ! -e $sidecar ] || fail "there is a sidecar"
expect_err "no name of BIDS" 2 "$cohort/subject.py" expert.iftty s.nii made

begin "a terminated task ends its program and removes its folder; two do not interfere"
instead 'echo $$ >pid; exec sleep 100'
"$cohort/subject.py" --iftty ./instead expert.iftty study/sub-01/anat/sub-01_T1w.nii.gz made \
    >/dev/null 2>&1 &
comes_true test -s pid
expect 3 "$cohort/subject.py" --iftty "$iftty" expert.iftty study/sub-01/anat/sub-01_T1w.nii.gz made
err_has "another task works on made/sub-01/anat"
kill $!
wait $!
same $? 143
[ ! -e made/.work ] || fail "the work folder stays"
comes_true sh -c '! kill -0 "$(cat pid)" 2>/dev/null'

# made/sub-NN with a label of so many ml, so many of 1000 seeds dropped, and that doubt.
make_told() { # NN ML DROPPED DOUBT
    mkdir -p "study/sub-$1/anat" "made/sub-$1/anat"
    : >"study/sub-$1/anat/sub-$1_T1w.nii.gz"
    cat >"made/sub-$1/anat/sub-$1_desc-iftty_dseg.json" <<JSON
{"Verified": true, "Chain": "c$1", "Dice": {"1": 0.9}, "DiskMegabytes": 1.5,
 "Origin": "x by=world volumes=1:100000 dropped=0:0/9,1:$3/1000",
 "Apply": [{"labels": [{"label": 1, "doubt": $4}]}],
 "Cost": {"Apply": {"Seconds": 2, "ProcessorSeconds": 1, "MemoryMegabytes": 50}},
 "Stats": {"by_label": [{"number": 1, "name": "a <b>", "volume_mm3": $2000}]}}
JSON
}

begin "subjects to check first are listed first, and the table has all"
rm -rf study made
for number in 01 02 03 04 05 06; do
    make_told $number 10$((${number#0} % 3)) 10 0.1
done
make_told 07 40 10 0.1
make_told 08 101 400 0.1
make_told 09 101 10 0.4
make_told 10 101 10 0.1
sed -i 's/"Verified": true/"Verified": false/' made/sub-10/anat/*.json
make_told 11 101 10 0.1
echo '{"Refused": "no <overlap>"}' >made/sub-11/anat/sub-11_desc-iftty_dseg.json
mkdir -p study/sub-12/anat
: >study/sub-12/anat/sub-12_T1w.nii.gz
expect_out "12 subjects, 3 to look at before any other" 1 "$cohort/gather.py" study made
out_has "sub-11: refused: no <overlap>"
same "$(cut -d, -f 1 made/cohort.csv | sed -n '2,7p' | tr '\n' ' ')" \
    "sub-10 sub-11 sub-12 sub-07 sub-08 sub-09 "
grep -qx 'sub-08,done,5,1,a <b>,101,100,0.4,0.1,0.9,[0-9.]*,2,1,50,1.5,c08,0,0' made/cohort.csv ||
    fail "$(grep sub-08 made/cohort.csv)"
grep -q 'a &lt;b&gt;: volume 0.40 of the cohort' made/cohort.html || fail "not said why"
grep -q 'no &lt;overlap&gt;' made/cohort.html || fail "a reason is taken for HTML"
grep -q '<b>[^/]*<b>\|<overlap>' made/cohort.html && fail "a name is taken for HTML"
same "$(head -c 4 made/cohort.png | od -An -tx1 | tr -d ' ')" 89504e47
same "$(ls made | grep -c part)" 0
sed -i 's/"doubt": 0.1/&, "far_mm3": 2500, "bad": true/' made/sub-03/anat/*.json
expect 1 "$cohort/gather.py" study made
same "$(sed -n 5p made/cohort.csv | cut -d, -f 1,17,18)" sub-03,2.5,1
grep -q 'a &lt;b&gt;: bad, 100.00 ml of 100.00 ml expected, 2.50 ml far' made/cohort.html ||
    fail "a bad label is not named"
rm -r study made/sub-1?
for number in 01 02 03; do make_told $number 101 10 0.1; done
expect 0 "$cohort/gather.py" study made
expect 3 "$cohort/gather.py" nowhere made

finish
