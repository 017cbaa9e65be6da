#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty agree: the consensus of several raters, beside a plain vote; figures as programs read them;
# maps and journals alike; what is refused. Votes and figures by hand: tests/test_agreement.c.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16

record() { # NAME COMMANDS
    "$iftty" -c "open s.nii; label 1 liver; seed 2,3,4 0; seed 6,10,8 1; $2; run
        save labels $1.nii" --journal "$1.iftty" >/dev/null || fail "cannot record $1"
}
record a 'seed 20,10,8 2'
record b 'seed 20,12,3 2 radius=1; seed 3,15,12 3'
record c 'seed 20,12,3 2; seed 4,15,12 4; label 4 spleen'
voxels_of() { tail -c +353 "$1"; }

begin "the consensus is that of a plain vote, and so are all figures"
expect 0 "$iftty" agree a.nii b.nii c.nii --json --save con.nii
cp out told.json
if needs python3; then
    python3 - <<'EOS' || fail "they differ"
import json
d = json.load(open('told.json'))
maps = [open(n, 'rb').read()[352:] for n in ('a.nii', 'b.nii', 'c.nii', 'con.nii')]
tied, con = 0, []
for votes in zip(*maps[:3]):
    most = max(map(votes.count, votes))
    best = {v for v in votes if votes.count(v) == most}
    tied += len(best) > 1
    con.append(best.pop() if len(best) == 1 else 0)
assert bytes(con) == maps[3] and d['tied'] == tied > 0 and d['by'] == 'majority'
assert d['voxels'] == len(con)
def near(a, b): return a is None and b is None or abs(a - b) < 1e-9
def figures(a, b, l):
    n, m = sum(v == l for v in a), sum(v == l for v in b)
    both = sum(v == w == l for v, w in zip(a, b))
    out = len(a) - m
    return (2 * both / (n + m) if n + m else None, both / m if m else None,
            (out - n + both) / out if out else None, n)
for r, rater in enumerate(d['raters']):
    assert rater['file'] == 'abc'[r] + '.nii'
    assert [l['label'] for l in rater['labels']] == [1, 2, 3, 4]
    for l in rater['labels']:
        dice, sens, spec, n = figures(maps[r], con, l['label'])
        assert near(l['dice'], dice) and near(l['sensitivity'], sens), l
        assert near(l['specificity'], spec) and l['voxels'] == n == l['volume_mm3'], l
pairs = {(p['a'], p['b']): p for p in d['pairs']}
assert len(pairs) == 3
for l in pairs['a.nii', 'c.nii']['labels']:
    assert near(l['dice'], figures(maps[0], maps[2], l['label'])[0])
EOS
fi
head -c 348 con.nii | tail -c +41 | head -c 108 >con.head # size, spacing and place
head -c 348 a.nii | tail -c +41 | head -c 108 >a.head
head -c 348 con.nii | tail -c +253 | head -c 76 >>con.head
head -c 348 a.nii | tail -c +253 | head -c 76 >>a.head
same_files con.head a.head
close_story

begin "whoever comes first, the consensus and each rater's figures are the same"
expect 0 "$iftty" agree a.nii b.nii c.nii --csv
sort out >one
expect 0 "$iftty" agree c.nii a.nii b.nii --csv --save turned.nii
sort out >two
same_files one two
same_files con.nii turned.nii
expect 0 "$iftty" agree a.nii a.nii a.nii --csv
! grep -vE '^rater|,all,|,1,1,1$' out || fail "one does not agree with himself: $(cat out)"
expect 0 "$iftty" agree a.nii a.nii
out_has "no voxel is tied"
close_story

begin "a journal is the labels that it ends with, and their names"
expect 0 "$iftty" agree a.nii b.nii c.nii --csv
sed 's/nii"/rater"/; s/"[a-z]*",/"",/' out | cut -d, -f1,2,4- >maps
expect 0 "$iftty" agree a.iftty b.nii c.iftty --csv --save mixed.nii
sed 's/nii"/rater"/; s/iftty"/rater"/' out | cut -d, -f1,2,4- >mixed
same_files maps mixed
cmp -s con.nii mixed.nii || { voxels_of con.nii >x; voxels_of mixed.nii >y; same_files x y; }
grep -q '"a.iftty",1,"liver",' out || fail "no name: $(cat out)"
expect 0 "$iftty" agree c.iftty a.iftty b.iftty
grep -q '^4 spleen' out || fail "$(cat out)"
expect 0 "$iftty" compare mixed.nii con.nii
out_has "0 of 7680 voxels differ"
close_story

begin "a journal whose scene has its axes the other way is put in the order of the first"
/usr/bin/python3 -W ignore - <<'END' || fail "nibabel"
import nibabel, numpy
a = numpy.asanyarray(nibabel.load("a.nii").dataobj)
def placed(data, flipped, shift, name):
    m = numpy.eye(4)
    if flipped:
        data, m[0, 0], m[0, 3] = data[::-1], -1, data.shape[0] - 1
    m[0, 3] += shift
    nibabel.save(nibabel.Nifti1Image(data, m), name)
placed(a, False, 0, "here.nii")
placed(a, True, 0, "turned.nii")
placed(a, True, 0.3, "off.nii")
END
for which in turned off; do
    printf 'open %s.nii\nlabels %s.nii\nrun\n' $which $which >$which.iftty
    expect 0 "$iftty" agree here.nii $which.iftty --csv
    cut -d, -f4- out >journals
    expect 0 "$iftty" agree here.nii here.nii --csv
    cut -d, -f4- out >maps
    same_files journals maps
done
expect 0 "$iftty" agree here.nii off.iftty
err_has "off.iftty: the map is 0.3 mm off the scene's grid"
close_story

begin "the consensus as a segmentation of 3D Slicer has the names of its labels"
expect 0 "$iftty" agree a.iftty c.iftty b.nii --save con.seg.nrrd
for line in 'Segment0_Name:=liver' 'Segment0_LabelValue:=1'; do
    grep -aqxF "$line" con.seg.nrrd || fail "no '$line': $(head -n 30 con.seg.nrrd)"
done
expect 0 "$iftty" compare con.seg.nrrd con.nii
out_has "0 of 7680 voxels differ"
close_story

begin "values are chosen, and others left out"
expect 0 "$iftty" agree a.nii b.nii --regions 2,3 --as 1,1 --csv
cut -d, -f2 out | sort -u | paste -sd ' ' - >labels
same "$(cat labels)" "1 all label"
expect 0 "$iftty" agree a.iftty b.iftty --regions 2,3 --as 1,1 --csv
cut -d, -f4- out >journals
expect 0 "$iftty" agree a.nii b.nii --regions 2,3 --as 1,1 --csv
cut -d, -f4- out >maps
same_files journals maps
expect 2 "$iftty" agree a.nii b.nii --as 1
close_story

begin "nothing is overwritten, and what fails leaves no file"
cp con.nii kept.nii
expect 3 "$iftty" agree a.nii b.nii --save con.nii
err_has "con.nii exists already and was left alone"
[ ! -s out ] || fail "it counted before it looked"
same_files con.nii kept.nii
expect 3 "$iftty" agree a.nii missing.nii --save con.nii
err_has "con.nii exists" # before any map is read
expect 3 "$iftty" agree a.nii b.nii --save nowhere/con.nii
expect 3 "$iftty" agree a.nii missing.nii --save new.nii
err_has "missing.nii"
[ ! -e new.nii ] || fail "new.nii is there"
listing . | grep -v ' ./\(out\|err\|before\)$' >before
expect 2 "$iftty" agree a.nii b.nii --save con.png
[ ! -s out ] || fail "it counted before it looked"
listing . | grep -v ' ./\(out\|err\|before\)$' | cmp -s - before || fail "files are left"
close_story

begin "what does not lie on the grid of the first is refused, or resampled"
"$iftty" -c "open synth:geom:30x20x16; seed 1,1,1 1; run; save labels wide.nii" >/dev/null
expect 3 "$iftty" agree a.nii wide.nii
err_has "wide.nii"
printf 'open synth:geom:30x20x16\nseed 1,1,1 1\nrun\n' >wide.txt
echo '# iftty journal 1 semantics 12' >none.iftty
cp wide.txt wide.iftty
expect 3 "$iftty" agree a.nii wide.iftty
err_has "wide.iftty: "
{ head -c 252 a.nii; printf '\001\000'; tail -c +255 a.nii | head -c 14
    printf '\000\000\100\101'; tail -c +273 a.nii; } >moved.nii
{ head -c 252 b.nii; printf '\001\000'; tail -c +255 b.nii; } >placed.nii
expect 3 "$iftty" agree placed.nii moved.nii
err_has "moved.nii"
expect 0 "$iftty" agree placed.nii moved.nii --resample
close_story

begin "what is no label map, and too few or too many raters"
expect 2 "$iftty" agree a.nii
expect 2 "$iftty" agree a.nii b.nii --by vote
err_has "--by: expected majority or staple, not vote"
# shellcheck disable=SC2046
expect 2 "$iftty" agree $(for n in $(seq 65); do echo a.nii; done)
{ nifti_header 24 20 16 4 16; head -c 15360 /dev/zero | tr '\000' '\001'; } >large.nii
expect 3 "$iftty" agree a.nii large.nii
err_has "large.nii: "
head -c 2000 a.nii >short.nii
expect 3 "$iftty" agree a.nii short.nii
err_has "short.nii: "
sed 's/ forest=[0-9a-f]*/ forest=0123456789abcdef/' b.iftty >lies.iftty
expect 3 "$iftty" agree a.nii lies.iftty
err_has "lies.iftty: it gives other results than it records"
mkdir inside
sed 's/open s.nii/open ..\/s.nii/; /^=/d; /^# iftty/d' b.iftty >inside/out.iftty
expect 3 "$iftty" agree a.nii inside/out.iftty
err_has "inside/out.iftty: "
expect 3 "$iftty" agree a.nii none.iftty
err_has "none.iftty: it opens no scene"
close_story

# Who has the helper, and what a rater of noise is: a third of his voxels is right by chance.
begin "STAPLE trusts those who agree, and not one of noise, whoever comes first"
if needs python3; then
    python3 - <<'EOS'
import random
random.seed(7)
a = open('a.nii', 'rb').read()
open('noise.nii', 'wb').write(a[:352] + bytes(random.choice((0, 1, 2)) for _ in a[352:]))
EOS
    expect 0 "$iftty" agree a.nii a.nii a.nii --by staple --csv
    ! grep -vE '^rater|,all,|,1,1,1$' out || fail "one does not agree with himself: $(cat out)"
    expect 0 "$iftty" agree a.nii c.nii noise.nii a.nii --by staple --json --save weighed.nii
    cp out one.json
    expect 0 "$iftty" agree noise.nii a.nii a.nii c.nii --by staple --json --save again.nii
    same_files weighed.nii again.nii
    python3 - <<'EOS' || fail "$(cat one.json)"
import json
one, two = json.load(open('one.json')), json.load(open('out'))
assert one['by'] == 'staple' and 'tied' not in one
def of(d): return sorted((r['file'], [(l['dice'], l['sensitivity'], l['specificity'])
                                      for l in r['labels']]) for r in d['raters'])
for (f, a), (g, b) in zip(of(one), of(two)):
    assert f == g and all(x is y is None or abs(x - y) < 1e-6 for p, q in zip(a, b)
                          for x, y in zip(p, q)), (f, a, b)
for file, figures in of(one):
    sensitivity = figures[1][1]
    assert sensitivity < 0.5 if file == 'noise.nii' else sensitivity > 0.9, (file, figures)
EOS
    cmp -s weighed.nii a.nii || { voxels_of a.nii >x; voxels_of weighed.nii >y
        expect 0 "$iftty" compare --csv weighed.nii a.nii
        awk -F, '$1 == 2 && $10 < 0.99 { exit 1 }' out || fail "$(cat out)"; }
fi
close_story

finish
