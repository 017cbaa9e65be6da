#!/bin/sh
# SPDX-License-Identifier: MIT
# The client in Python, and JSON compared with its schemas. Only Debian's Python has Debian's
# modules.
. "$(dirname "$0")/lib.sh"
PYTHONDONTWRITEBYTECODE=1
IFTTY=$iftty
TMPDIR=$work/passing
MPLCONFIGDIR=$work/passing
export PYTHONDONTWRITEBYTECODE IFTTY TMPDIR MPLCONFIGDIR
mkdir passing
make_scene s.nii 24 20 16

# as_schema SCHEMA [DEFINITION]: keep $work/out for check_schema.py at the end of the next story
documents=0 wrong=
as_schema() {
    cp "$work/out" "document-$((documents += 1))"
    echo "document-$documents $1 ${2:--}" >>checks
}

begin "every line of a session fits the schema of the protocol"
cat >lines <<'END'
{"id": 1, "do": "seed 5,10,8 1 radius=2"}
{"id": "two", "do": "auto off"}
{"id": 3, "do": "seed 20,3,3 0"}
{"array": "labels", "finished": true}
{"array": "cost"}
{"array": "intensity"}
{"id": 4, "do": "render"}
{"id": 5, "do": "spin 2 t%02d.png"}
{"id": 6, "do": "sed"}
{"id": 7, "do": "label 1 x colour"}
{"id": 8, "array": "x"}
{"id": 9, "do": "stats report=st.json"}
{"id": 10, "do": "hints report=h.json"}
{"id": 11, "do": "save labels l.nii"}
{"id": 12, "do": "compare l.nii report=c.json"}
{"id": 13, "do": "undo"}
{"id": 14, "do": "golden g"}
{"id": 15, "do": "help seed"}
{"cancel": 99}
nonsense
END
expect 0 "$iftty" serve s.nii --journal j.iftty <lines
same "$(grep -c '"ok"' "$work/out")" 20
cp "$work/out" good
as_schema protocol
sed -n 's/.*"files": \[\(".*"\)\], "journal.*/\1/p' good | tr ',' '\n' | tr -d ' "' >files
xargs ls <files >/dev/null || fail "what was written is not there"
same "$(wc -l <files)" 7
grep -v nonsense lines >"$work/out"
as_schema protocol request
expect 0 "$iftty" serve </dev/null
as_schema protocol
expect 3 "$iftty" serve missing.nii </dev/null
as_schema protocol
for change in 's/"ok": true/"ok": 1/' 's/"words": {/"words": {"Seeds": 1, /' 's/"id": [0-9]*, //' \
    's/"hints": \[/"hints": [1, /' 's/"ok"/"more": 1, "ok"/' 's/"labels": "./"labels": "/'; do
    sed "$change" good >"$work/out"
    as_schema protocol
    wrong="$wrong document-$documents" # in the order in which they are checked
done

begin "the output of --json, and reports, fit their schemas"
mv j.iftty a.iftty
mv j.golden a.golden
for name in st:stats h:hints c:compare; do
    cp "${name%:*}.json" "$work/out"
    as_schema programs "${name#*:}"
done
expect 0 "$iftty" info --json s.nii
as_schema programs info_scene
expect 0 "$iftty" info --json a.iftty
as_schema programs info_journal
expect 0 "$iftty" verify --no-strict --json a.iftty
as_schema programs verify
sed 's/radius=2/radius=1/' a.iftty >b.iftty
expect 1 "$iftty" verify --no-strict --json b.iftty
as_schema programs verify
"$iftty" log --script b.iftty | sed '/^[sg][pao]/d' >b
rm b.iftty
expect 0 "$iftty" run b --journal b.iftty
expect 0 "$iftty" compare --json l.nii l.nii
as_schema programs compare
expect 1 "$iftty" diff --json a.iftty b.iftty
as_schema programs diff
set --
while read -r document schema definition; do
    case $schema in
    protocol) schema=$top/src/program/protocol.schema.json ;;
    *) schema=$top/tests/schema/programs.schema.json ;;
    esac
    set -- "$@" "$document" "$schema" "$definition"
done <checks
"$PYTHON" -W ignore "$top/tests/check_schema.py" "$@" >told 2>&1 || fail "$(tail -n 3 told)"
same "$(sed -n 's/^\(document-[0-9]*\):.*/ \1/p' told | tr -d '\n')" "$wrong"

# The same scene, turned, somewhere in the world.
"$PYTHON" - <<'END'
import nibabel
scene = nibabel.load("s.nii")
affine = [[0.9, -0.3, 0.1, -20], [0.3, 0.9, 0, 7.5], [0, 0.1, 1.1, 3], [0, 0, 0, 1]]
placed = nibabel.Nifti1Image(scene.get_fdata().astype("int16"), affine)
placed.header.set_xyzt_units("mm")
nibabel.save(placed, "placed.nii")
END
for how in "" plain; do
    begin "the client in Python${how:+, without numpy}"
    rm -f ./*.iftty
    "$PYTHON" -W ignore "$top/tests/python_session.py" "$top" $how >told 2>&1
    grep -q '^1\.\.6$' told && ! grep -q '^not ok' told || fail "$(cat told)"
    expect 0 "$iftty" verify --no-strict given.iftty arrays.iftty
    same "$(find passing -name 'iftty-*')" ""
done

begin "the example draws a brain"
"$PYTHON" -W ignore "$top/examples/python/segment.py" brain.png brain.iftty >told 2>err
status=$?
if grep -q 'no scene ch2' err; then
    skip "there is no ch2.nii.gz here"
else
    same "$status" 0
    grep -q '^brain: 16[0-9][0-9] ml' told || fail "$(cat told err)"
    [ "$(file_bytes brain.png)" -gt 50000 ] || fail "there is no picture"
    expect_out '"size": [181, 217, 181]' 0 "$iftty" info --json brain.nii.gz
fi

finish
