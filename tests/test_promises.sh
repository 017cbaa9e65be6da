#!/bin/sh
# SPDX-License-Identifier: MIT
# The keys of JSON that 1.0 promises (.package/PROMISES.md) equal tests/promises.txt: output of each
# program with --json, reports, and the protocol of `iftty serve`. test_promises has the other
# promised names. Version 1.0 froze the lines of that file; later ones follow them.
. "$(dirname "$0")/lib.sh"
promises=$top/tests/promises.txt

# words_of NAME FILE: a line for each key of a document, or of each document that is a line: "json
# verify journals[].chain".
words_of() {
    "$PYTHON" - "$@" <<'END'
import json, sys
name, text = sys.argv[1], open(sys.argv[2]).read()
try:
    documents = [json.loads(text)]
except ValueError:
    documents = [json.loads(line) for line in text.splitlines()]
found = set()
def take(value, path):
    if isinstance(value, list):
        for one in value:
            take(one, path + "[]")
    elif isinstance(value, dict):
        for key, one in value.items():
            if path.endswith(("notes", "words")) and not key.startswith("iftty:"):
                continue
            of = path + ("." if path and not path.endswith(" ") else "") + key
            found.add(of)
            take(one, of)
for document in documents:
    take(document, "json " + name + " ")
print("\n".join(sorted(found)))
END
}
# prints NAME STATUS ARGUMENT...: collect the keys that the program prints
prints() {
    name=$1
    shift
    expect "$@" --json </dev/null
    words_of "$name" "$work/out" >>words || fail "$name: $(head -c 300 "$work/out")"
}

begin "JSON has the promised keys"
make_scene s.nii 24 20 16
cat >script <<'END'
open s.nii
label 1 one
seed 5,10,8 1 radius=2
seed 20,3,3 0
seed 12,15,3 2
run
size 40 30
render p.png
render p.exr
save labels a.nii
stats report=stats.json
hints report=hints.json
golden g
compare a.nii report=compared.json
END
prints run 0 "$iftty" run script --journal a.iftty
echo 'seed 1,1,1' >wrong
prints run 2 "$iftty" run wrong
sed 's/radius=2/radius=3/; s/a\.nii/b.nii/; /report/d; /render/d' script >other
prints run 0 "$iftty" run other --journal b.iftty
for report in stats hints compared; do words_of "$report" $report.json >>words; done
prints verify 0 "$iftty" verify --no-strict a.iftty
sed 's/radius=2/radius=1/' a.iftty >c.iftty
prints verify 1 "$iftty" verify a.iftty c.iftty
prints diff 1 "$iftty" diff a.iftty b.iftty
prints compare 0 "$iftty" compare a.nii b.nii
"$PYTHON" "$top/tests/apply/phantom.py" scenes plain moved far
"$iftty" -c 'open plain.nii; seed 28,28,24 1 radius=5; seed 5,5,5 0 radius=2; run' \
    --journal p.iftty >/dev/null || fail "no procedure"
prints apply 3 "$iftty" apply p.iftty moved.nii far.nii --by world --out applied
prints "info picture" 0 "$iftty" info p.png
prints "info picture" 0 "$iftty" info p.exr
prints "info scene" 0 "$iftty" info s.nii --histogram
prints "info journal" 0 "$iftty" info a.iftty
prints "info" 0 "$iftty" info
cat >lines <<'END'
{"id": 1, "do": "seed 5,10,8 1 radius=2"}
{"id": 2, "do": "seed 20,3,3 0"}
{"id": 3, "array": "labels", "finished": true}
{"id": 4, "do": "render"}
{"id": 5, "do": "save labels served.nii"}
{"id": 6, "do": "sed"}
{"id": 7, "do": "help seed"}
{"id": 8, "do": "undo"}
{"cancel": 99}
nonsense
END
expect 0 "$iftty" serve s.nii --journal served.iftty <lines
words_of serve "$work/out" >>words || fail "serve: $(sed 3q "$work/out")"
LC_ALL=C sort -u words >now
grep '^json ' "$promises" | LC_ALL=C sort >then
LC_ALL=C comm -13 now then >gone
[ ! -s gone ] || fail "promised, and gone:" "$(cat gone)"
LC_ALL=C comm -23 now then >new
[ ! -s new ] || fail "new, and no line in tests/promises.txt:" "$(cat new)"
[ "$(wc -l <then)" -gt 200 ] || fail "few words: $(wc -l <then)"

begin "no promise of 1.0 was taken away"
same "$(grep -v '^#' "$promises" | LC_ALL=C sort | uniq -d)" ""
same "$(sed '/^# added later/,$d; /^#/d' "$promises" | LC_ALL=C sort | sha256sum | cut -c 1-16)" \
    9d664dee02ab21cc

finish
