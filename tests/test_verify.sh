#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty verify: its comparisons, its messages about differences, and its reports.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16

# record JOURNAL: nine records, of which the seventh and the last are golden images
record() {
    "$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,8 2 radius=1; run; size 40 30; view 30 20
        golden first
        seed 20,10,8 3; run; golden second' --journal "$1" >/dev/null || fail "cannot record $1"
}
begin "journals are verified in parallel, and reported in order"
for n in 1 2 3 4 5; do record "j$n.iftty"; done
expect 0 "$iftty" verify j1.iftty j2.iftty j3.iftty j4.iftty j5.iftty
cp out one
for processes in 1 2 5 64; do
    expect 0 "$iftty" verify -j "$processes" j1.iftty j2.iftty j3.iftty j4.iftty j5.iftty
    same_files out one
done
same "$(head -n 1 one)" "ok 1 - j1.iftty (10 commands, 10 results with 19 digests, \
2 golden images of 2400 pixels)"
same "$(tail -n 2 one | tr '\n' ' ')" "1..5 # 5 verified, 0 failed "
for wrong in "-j 0" "-j 65" "-j x" "--from 0" "--until x" "--from 3 --until 2" \
    "--junit" "--from"; do
    expect 2 "$iftty" verify j1.iftty $wrong
    [ ! -s out ] || fail "'$wrong' printed something"
done

begin "the first journal may be the slowest"
"$iftty" -c 'open synth:geom; seed 100,100,50 1; seed 10,10,10 2; run' \
    --journal long.iftty >/dev/null
expect 0 "$iftty" verify -j 3 long.iftty j1.iftty j2.iftty
same "$(sed -n 's/^ok [0-9]* - \([a-z0-9]*\).*/\1/p' out | tr '\n' ' ')" "long j1 j2 "

begin "an orphan golden image is a failure"
cp j1.golden/first.exr j1.golden/third.exr
expect 1 "$iftty" verify j1.iftty j2.iftty
out_has "# orphan golden image: the journal names no third.exr, which is in j1.golden"
out_has "# 1 verified, 1 failed"
cp j1.golden/first.exr j1.golden/First.exr
expect 1 "$iftty" verify j1.iftty
out_has "no First.exr, which is in j1.golden, and others; iftty verify --remove-orphans deletes it"
rm j1.golden/First.exr
expect 0 "$iftty" verify j1.iftty --until 9 # nobody knows yet
rm j1.golden/third.exr
cp j1.golden/first.png j1.golden/third.png # it shows what nothing was compared with
expect 1 "$iftty" verify j1.iftty
out_has "# orphan golden image: the journal names no third.png, which is in j1.golden"
rm j1.golden/third.png
cp j1.golden/first.exr j1.golden/.iftty-0-first.exr
expect 0 "$iftty" verify j1.iftty

begin "journals of one name have separate folders of evidence, others the usual one"
mkdir left right
cp s.nii left
cp s.nii right
record left/same.iftty
record right/same.iftty
record only.iftty
cp left/same.golden/second.exr left/same.golden/first.exr
cp right/same.golden/first.exr right/same.golden/second.exr
cp only.golden/first.exr only.golden/second.exr
expect 1 "$iftty" verify j2.iftty left/same.iftty right/same.iftty only.iftty --out proofs -j 3
can_limit_memory &&
    same "$(cd proofs && find . -type f | sort | tr '\n' ' ')" "./2/same.iftty.first.actual.exr \
./2/same.iftty.first.difference.png ./3/same.iftty.second.actual.exr \
./3/same.iftty.second.difference.png ./only.iftty.second.actual.exr \
./only.iftty.second.difference.png "
expect 1 "$iftty" verify left/same.iftty --out alone
can_limit_memory &&
    same "$(ls alone | tr '\n' ' ')" "same.iftty.first.actual.exr same.iftty.first.difference.png "
expect 1 "$iftty" verify left/same.iftty left/../left/same.iftty --out twice
same "$(ls twice | tr '\n' ' ')" "1 2 "
rm -r left right proofs alone twice only.iftty only.golden

begin "--from and --until compare the records in between"
cp j2.golden/second.exr j2.golden/first.exr
expect_out "# record 7, line" 1 "$iftty" verify j2.iftty
expect_out "(6 commands, 6 results with " 0 "$iftty" verify j2.iftty --until 6
expect 1 "$iftty" verify j2.iftty --until 7
expect 1 "$iftty" verify j2.iftty --from 7
expect_out "(10 commands, 3 results with " 0 "$iftty" verify j2.iftty --from 8
expect_out "(9 commands, 2 results with " 0 "$iftty" verify j2.iftty --from 8 --until 9
expect 1 "$iftty" verify j2.iftty --from 11
out_has "it ends with record 10: nothing to compare from 11 on"

begin "a difference is described"
words=$(words_of j3.iftty 9)
labels=$(printf %s "$words" | sed 's/.*labels=\([0-9a-f]*\).*/\1/')
rewrite j3.iftty 9 "forest=0123456789abcdef labels=$labels seeds=7"
expect 0 "$iftty" log --check j3.iftty
expect_out "# record 9, line" 1 "$iftty" verify j3.iftty
out_has "command  run" "meaning  only keys differ"
out_has "word     forest: 0123456789abcdef was recorded, "
out_has "word     seeds: 7 was recorded, 9 now (2 more)" "the same labels"
grep -qE '^#   now      label 2: 7 seeds, [0-9]+ voxels' out || fail "no voxels: $(cat out)"
rewrite j3.iftty 9 "forest=0123456789abcdef labels=0123456789abcdef seeds=9"
expect_out "meaning  labels differ" 1 "$iftty" verify j3.iftty

# has_children N PROGRAM: so many processes, in $children
has_children() {
    read -r children <"/proc/$2/task/$2/children"
    [ "$(echo "$children" | wc -w)" -ge "$1" ]
}
has_ended() { # a zombie has
    [ ! -e "/proc/$1" ] || grep -q '^State:.*Z' "/proc/$1/status" 2>/dev/null || [ ! -e "/proc/$1" ]
}

begin "a process that dies is one failure, with its signal"
"$iftty" -c 'open synth:geom; seed 100,100,50 1; seed 10,10,10 2; run; adjacency 26' \
    --journal large.iftty >/dev/null
"$iftty" verify large.iftty j4.iftty >out 2>err &
verifier=$!
comes_true has_children 1 "$verifier"
kill -ABRT "${children%% *}" # which no sanitiser catches
wait "$verifier"
same "$?" 1
out_has "not ok 1 - large.iftty" "# its process was ended by signal 6 (Aborted)" "ok 2 - j4.iftty"

begin "Ctrl-C ends all of them"
"$iftty" verify -j 2 large.iftty large.iftty large.iftty >out 2>err &
verifier=$!
comes_true has_children 2 "$verifier"
# They end with the one that started them, however that ends.
kill -9 "$verifier"
wait "$verifier" 2>/dev/null
for child in $children; do comes_true has_ended "$child"; done
# A background job ignores SIGINT by default.
env --default-signal=INT "$iftty" verify -j 2 large.iftty large.iftty large.iftty >out 2>err &
verifier=$!
comes_true has_children 2 "$verifier"
kill -INT "$verifier"
wait "$verifier"
same "$?" 130
err_has "cancelled; 0 of 3 journals verified"
for child in $children; do
    [ ! -e "/proc/$child" ] || fail "$child is still there"
done

# ---- reports ----

begin "JUnit's XML"
cp j5.golden/second.exr j5.golden/first.exr
cp j4.iftty 'a<b>&"c'"'.iftty"
cp -r j4.golden 'a<b>&"c'"'.golden"
expect 1 "$iftty" verify j4.iftty j5.iftty 'a<b>&"c'"'.iftty" --junit report.xml
grep -q '<testsuite name="iftty verify" tests="3" failures="1" errors="0"' report.xml ||
    fail "$(cat report.xml)"
grep -q 'name="a&lt;b&gt;&amp;&quot;c&#39;.iftty"' report.xml || fail "$(cat report.xml)"
grep -q '<failure type="check failed" message="record 7 (line' report.xml ||
    fail "$(cat report.xml)"
"$PYTHON" -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' report.xml 2>err ||
    fail "$(cat err)"
cp report.xml before
expect 0 "$iftty" verify j4.iftty --junit report.xml
grep -q 'tests="1" failures="0"' report.xml || fail "the report was not written anew"
expect 3 "$iftty" verify missing.iftty --junit report.xml
grep -q 'errors="1"' report.xml || fail "$(cat report.xml)"

begin "one page of HTML, that needs nothing else"
expect 1 "$iftty" verify j4.iftty j5.iftty 'a<b>&"c'"'.iftty" --html report.html
grep -q 'a&lt;b&gt;&amp;&quot;c&#39;.iftty' report.html || fail "a name is not escaped"
same "$(grep -c '<img alt="[^"]*" src="data:image/png;base64,[A-Za-z0-9+/]*=*">' report.html)" 3
same "$(grep -o 'expected: golden image first<\|>actual<\|>difference, in red<' report.html |
    wc -l)" 3
grep -qE 'https?:|<script|<link|url\(' report.html && fail "it refers to something else"
grep -q "default-src 'none'" report.html || fail "it does not forbid to fetch"
# The picture that is called the expected one is the golden image's.
sed -n 's/.*alt="expected[^"]*" src="data:image\/png;base64,\([^"]*\)".*/\1/p' report.html |
    base64 -d >expected.png
same "$(head -c 4 expected.png | od -An -c | tr -d ' ')" '211PNG'
if needs idiff oiiotool; then
    oiiotool expected.png --ch R,G,B -o seen.png && idiff -q seen.png j5.golden/second.png ||
        fail "it is another picture"
fi
expect 1 "$iftty" verify j3.iftty --html report.html
same "$(grep -c 'actual: the rendition after this command</figcaption>' report.html)" 1
rm j5.golden/first.exr
expect 1 "$iftty" verify j5.iftty --html report.html
same "$(grep -c 'actual; there is no golden image</figcaption>' report.html)" 1

begin "reports are written over reports, and over no journal"
cp j4.iftty kept
expect_err "j4.iftty is a journal and was left alone" 2 "$iftty" verify j4.iftty --html j4.iftty
same_files j4.iftty kept
expect 3 "$iftty" verify j4.iftty --junit nowhere/report.xml
[ ! -s out ] || fail "it verified before it looked for the folder"

# ---- accepting ----

# unlike JOURNAL NUMBER: the record's picture was another one when it was recorded
unlike() {
    rewrite "$1" "$2" "$(words_of "$1" "$2" | sed 's/picture=[0-9a-f]*/picture=00000000000000aa/')"
}

begin "accepting replaces a golden image that differs, with a reason, and keeps the former one"
record k.iftty
cp k.golden/first.exr first.kept
cp k.golden/second.exr k.golden/first.exr
unlike k.iftty 7
cp k.iftty k.before
expect 1 "$iftty" verify k.iftty
expect 0 "$iftty" verify k.iftty --accept 'softer light'
out_has "# 1 golden image accepted, 1 of 10 records of k.iftty marked; \
the former journal is stored as k.iftty.before-1"
same_files k.iftty.before-1 k.before
expect 0 "$iftty" verify k.iftty
expect 0 "$iftty" log --check k.iftty
grep -q '^# accepted: softer light (golden image first: ' k.iftty ||
    fail "no reason: $(cat k.iftty)"
grep -q "^# it was: chain=[0-9a-f]* picture=00000000000000aa" k.iftty || fail "$(cat k.iftty)"
same "$(words_of k.iftty 7)" "$(words_of j4.iftty 7)"
"$iftty" info k.golden/first.exr >info
grep -q 'iftty:journal: k.iftty' info || fail "$(cat info)"
same "$(sed -n 's/.*iftty:chain: //p' info)" "$(sed -n 's/^= 6 .*chain=//p' k.iftty)"
"$iftty" -c 'open s.nii; seed 1,1,1 1' --journal k2.iftty >/dev/null
same "$(ls -A k.golden | tr '\n' ' ')" "first.exr first.png second.exr second.png "
# The journal goes on from there.
expect 0 "$iftty" -c 'seed 1,1,1 1; run' --journal k.iftty
expect 0 "$iftty" verify k.iftty

begin "accepting a journal without differences changes nothing"
listing . | grep -vE ' ./(out|err|before|d)$' >before
expect 0 "$iftty" verify k.iftty --accept 'nothing'
out_has "# 0 golden images accepted, 0 of 12 records of k.iftty marked; nothing has changed"
listing . | grep -vE ' ./(out|err|before|d)$' | diff before - >d || fail "$(cat d)"
rm -f d

begin "a golden image that is missing, or damaged, is accepted as well"
rm k.golden/first.exr k.golden/first.png
head -c 300 j4.golden/second.exr >k.golden/second.exr
expect 1 "$iftty" verify k.iftty
expect_out "2 golden images accepted, 2 of 12" 0 "$iftty" verify k.iftty --accept 'a disk was full'
expect 0 "$iftty" verify k.iftty
same "$(ls k.iftty.before-*  | tr '\n' ' ')" "k.iftty.before-1 k.iftty.before-2 "
# Another picture of the journal may differ as well.
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; render; golden one' --journal r.iftty
unlike r.iftty 4
expect 1 "$iftty" verify r.iftty
expect_out "0 golden images accepted, 1 of 5" 0 "$iftty" verify r.iftty --accept 'the shader rounds'
expect 0 "$iftty" verify r.iftty
# One name may occur twice for one picture, and is accepted once.
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; golden one; golden one' --journal twice.iftty
rm -r twice.golden
expect 0 "$iftty" verify twice.iftty --accept 'a disk was full'
out_has "1 golden image accepted, 1 of 5"
expect 0 "$iftty" verify twice.iftty

# refused JOURNAL WORDS STATUS [OPTION...]: accepting says so, and nothing has changed
refused() {
    journal=$1 words=$2 status=$3
    shift 3
    listing . | grep -vE ' ./(out|err|before|d)$' >before
    expect_err "$words" "$status" "$@" "$iftty" verify "$journal" --accept 'why not'
    listing . | grep -vE ' ./(out|err|before|d)$' | diff before - >d || fail "$(cat d)"
    rm -f d
}

begin "a link to no journal is reported as such, with or without a target"
mkdir -p elsewhere/deep
cp s.nii elsewhere
ln -s ../s.nii elsewhere/deep/there
ln -s ../none elsewhere/deep/nowhere
for link in there nowhere; do
    expect 3 "$iftty" verify elsewhere/deep/$link
    out_has "# elsewhere/deep/$link is a link, and leads to no journal"
done
rm -r elsewhere

begin "accepting is rejected in CI, and for a record without a picture"
cp j4.golden/second.exr k.golden/first.exr
refused k.iftty "refused where CI is set" 2 env CI=true
refused k.iftty "refused where CI is set" 2 env CI=0
expect 2 "$iftty" verify k.iftty --accept ''
expect 2 "$iftty" verify k.iftty --accept "two
lines"
expect 2 "$iftty" verify k.iftty j4.iftty --accept both
cp k.golden/first.exr k.golden/third.exr
refused k.iftty "orphan golden image" 1 env
rm k.golden/third.exr
cp k.iftty kept
rewrite k.iftty 6 "forest=0123456789abcdef"
refused k.iftty "nothing has changed" 1 env
cp kept k.iftty
rewrite k.iftty 9 "forest=0123456789abcdef"
refused k.iftty "record 9 (line 22) has another forest, which is a result and not a picture" 1 env
sed 's/^seed 20,10,8 3$/seed 20,10,8 4/' kept >k.iftty
refused k.iftty "k.iftty: record 8 (line 20) was edited: iftty log --reseal comes first" 1 env
{ cat kept; echo run; } >k.iftty
refused k.iftty "continuing the journal repairs it; nothing has changed" 1 env
expect 0 "$iftty" log --script kept
grep -v '^#' out >a-script
refused a-script "a-script: this is a script, not a journal" 1 env
sed '1s/semantics .*/semantics 4/' kept >old.iftty
refused old.iftty "old.iftty: it has semantics 4, of a build before 1.0" 3 env
cp kept k.iftty
expect 0 "$iftty" verify k.iftty --accept 'now'
# One name for two pictures is nothing that a session records.
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; golden one; turn 20; golden two' \
    --journal t.iftty
sed 's/^golden two$/golden one/' t.iftty >twins.iftty
mkdir twins.golden && cp t.golden/one.* twins.golden
expect 0 "$iftty" log --reseal twins.iftty
refused twins.iftty "golden image one is given twice, and the pictures are not the same" 1 env

begin "--only accepts the golden images that it names; all others stay as they were"
record o.iftty
cp -r o.golden o.right
spoil_both() {
    cp o.right/second.exr o.golden/first.exr
    cp o.right/first.exr o.golden/second.exr
}
only() { # STATUS NAMES: what is accepted
    expect "$1" "$iftty" verify o.iftty --accept 'softer light' --only "$2"
}
spoil_both
cp o.iftty o.kept
only 1 first
out_has "# 1 golden image accepted, 1 of 10 records of o.iftty marked"
err_has "1 picture of o.iftty still differs, not named by --only"
same "$(grep -c '^# accepted: softer light (golden image first: ' o.iftty)" 1
! grep -q 'golden image second' o.iftty || fail "$(cat o.iftty)"
same_files o.golden/second.exr o.right/first.exr
same "$(words_of o.iftty 10)" "$(words_of o.kept 10)"
expect 0 "$iftty" log --check o.iftty
expect_out "# record 10, line " 1 "$iftty" verify o.iftty
! grep -q 'record 7' out || fail "$(cat out)"
cp o.iftty o.kept
cp -r o.golden o.left
only 1 first # which is right by now
out_has "# 0 golden images accepted, 0 of 10 records of o.iftty marked; nothing has changed"
for names in third first,third first, ,first '' 'fir' 'first second' 'firsts' '*'; do
    only 2 "$names"
    err_has '--only: no `golden` of this journal has the name "' "nothing has changed"
done
expect 2 env CI=true "$iftty" verify o.iftty --accept 'softer light' --only second
expect 2 "$iftty" verify o.iftty --only second
same_files o.iftty o.kept
diff -r o.golden o.left || fail "a golden image has changed"
spoil_both
rm o.golden/second.*
only 0 second,first
out_has "2 golden images accepted, 2 of 10"
expect 0 "$iftty" verify --strict o.iftty
# A picture that is no golden image has no name.
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; render; golden one' --journal p.iftty
rewrite p.iftty 4 "$(words_of p.iftty 4 | sed 's/picture=.*/picture=00000000000000aa/')"
cp p.golden/one.png p.golden/one.exr
expect 1 "$iftty" verify p.iftty --accept 'softer light' --only one
out_has "1 golden image accepted, 1 of 5"
err_has "1 picture of p.iftty still differs"
same "$(words_of p.iftty 4)" "picture=00000000000000aa"
rm -r o.* p.*

begin "accepting is rejected while another process writes the journal"
mkfifo held
"$iftty" run - --journal k.iftty <held >held.out 2>&1 &
writer=$!
exec 9>held
echo info >&9 # answered by whoever holds the journal, and not recorded
comes_true has_line held.out '^ok .* info'
refused k.iftty "is being written by another session" 3 env
exec 9>&-
wait "$writer"

begin "a full or read-only folder: nothing is changed"
cp j4.golden/second.exr k.golden/first.exr
chmod a-w .
expect 3 with_permissions "$iftty" verify k.iftty --accept 'why not'
chmod u+w .
same_files j4.golden/second.exr k.golden/first.exr

begin "an edited journal is resealed, and records it"
record e.iftty
sed 's/^seed 20,10,8 3$/seed 20,10,7 3/' e.iftty >edited.iftty
cp edited.iftty edited.kept
expect 1 "$iftty" log --reseal edited.iftty # there would be nothing to compare
err_has "golden image first is missing: there is no edited.golden/first.exr; iftty log --reseal \
--accept WHY FILE draws it again; nothing has changed"
same_files edited.iftty edited.kept
cp -r e.golden edited.golden
expect 1 "$iftty" log --check edited.iftty
expect 0 "$iftty" log --reseal edited.iftty
out_has "# 3 of 10 records of edited.iftty marked; \
the former journal is stored as edited.iftty.before-1"
same_files edited.iftty.before-1 edited.kept
expect 0 "$iftty" log --check edited.iftty
expect 0 "$iftty" replay edited.iftty
same "$(grep -c '^# resealed: ' edited.iftty)" 3
rm -r edited.golden
expect 1 "$iftty" verify edited.iftty # its golden images are another matter
expect 0 "$iftty" verify edited.iftty --accept 'the seed lies deeper'
expect 0 "$iftty" verify edited.iftty

# ---- the first that differs ----

begin "bisecting two journals names the first record that differs"
record b1.iftty
cp b1.iftty b2.iftty
expect 0 "$iftty" verify --bisect b1.iftty b2.iftty
out_has "ok 1 - b1.iftty and b2.iftty (10 records the same)"
rewrite b2.iftty 9 "$(words_of b1.iftty 9 | sed 's/forest=[0-9a-f]*/forest=0000000000000001/')"
expect 1 "$iftty" verify --bisect b1.iftty b2.iftty
out_has "# record 9 is the first that differs: the results of the command differ" "only keys differ"
out_has "in       b1.iftty, line 18: run" ", 0000000000000001 in the second"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,7 2 radius=1' --journal b3.iftty
expect 1 "$iftty" verify --bisect b1.iftty b3.iftty
out_has "# record 3 is the first that differs: the commands differ"
head -n 15 b1.iftty >b4.iftty
expect 1 "$iftty" verify --bisect b1.iftty b4.iftty
out_has "# record 8 is the first that differs: only one of the two has this record"
# Comments make other chains, and no other results.
sed '2s/^/# by somebody else\n/' b1.iftty >b5.iftty
rewrite b5.iftty 0 ''
expect 0 "$iftty" log --check b5.iftty
expect 0 "$iftty" verify --bisect b1.iftty b5.iftty
sed 's/^run$/auto on/' b1.iftty >b6.iftty
expect_err "b6.iftty: " 3 "$iftty" verify --bisect b1.iftty b6.iftty
expect 0 "$iftty" run b6.iftty --journal b7.iftty # an edited journal is a script
expect 0 "$iftty" log --check b7.iftty
expect 2 "$iftty" verify --bisect b1.iftty
expect 2 "$iftty" verify --bisect b1.iftty b2.iftty b3.iftty
expect 3 "$iftty" verify --bisect b1.iftty missing

begin "the first of many records that differs is found"
{ echo 'open s.nii'; for _ in $(seq 59); do echo 'turn 1'; done; } >many
sed '42s/turn 1/turn 2/' many >many2
expect 0 "$iftty" run many --journal m1.iftty
expect 0 "$iftty" run many2 --journal m2.iftty
expect 1 "$iftty" verify --bisect m1.iftty m2.iftty
out_has "# record 42 is the first that differs: the commands differ" \
    "not ok 1 - m1.iftty and m2.iftty (41 records the same)"

finish
