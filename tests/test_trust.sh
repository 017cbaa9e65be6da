#!/bin/sh
# The journals of others: what they may read, write and take, what is shown of them, and what can be
# told of them without carrying them out.
. "$(dirname "$0")/lib.sh"
mkdir "$work/there" "$work/secret" "$work/tmp"
cd "$work/there" || exit 1
TMPDIR=$work/tmp
export TMPDIR
unset IFTTY_SCENES
make_scene s.nii 24 20 16
cp s.nii "$work/secret/hidden.nii"
esc=$(printf '\033')

journal() { # FILE COMMANDS: as somebody else may write one, a script without proof
    printf '%s\n' "$2" | tr ';' '\n' | sed 's/^ *//' >"$1"
}
# refused WORDS JOURNAL [OPTION...]: by replay and verify, in one line that is no surprise; nothing is
# written anywhere
refused() {
    words=$1
    shift
    listing "$work" | grep -v ' ./\(out\|err\|before\|after\|both\)$' >"$work/before"
    for program in replay verify; do
        expect 3 timeout 20 "$iftty" $program "$@"
        cat "$work/out" "$work/err" >"$work/both"
        grep -qF -e "$words" "$work/both" || fail "$program: no '$words' in: $(cat "$work/both")"
    done
    listing "$work" | grep -v ' ./\(out\|err\|before\|after\|both\)$' >"$work/after"
    cmp -s "$work/before" "$work/after" || fail "left: $(diff "$work/before" "$work/after")"
}

# ---- reading ----

begin "a scene is read beside the journal, below its folder, or where --scene says"
mkdir below
cp s.nii below/t.nii
journal j 'open s.nii; seed 2,3,4 1; run'
expect 0 "$iftty" replay j
expect_in / 0 "$iftty" replay "$work/there/j"
journal j 'open below/t.nii; seed 2,3,4 1; run'
expect 0 "$iftty" replay j
ln -s below/t.nii inner.nii
journal j 'open inner.nii; seed 2,3,4 1; run'
expect 0 "$iftty" replay j # a link that stays inside
journal j "open $work/secret/hidden.nii; seed 2,3,4 1; run"
expect 0 "$iftty" replay j --scene "$work/secret/hidden.nii"
close_story

begin "absolute names, .., links that lead out and devices are not read"
ln -s "$work/secret/hidden.nii" out.nii
ln -s "$work/secret" folder
ln -s ../secret/hidden.nii relative.nii
ln -s /dev/zero zero.nii
mkfifo pipe.nii
journal j "open $work/secret/hidden.nii"
refused "expected --scene FILE" j
journal j "open ../secret/hidden.nii"
refused "expected --scene FILE" j
for name in out.nii folder/hidden.nii relative.nii zero.nii; do
    journal j "open $name"
    refused "the journal may not read $name, which leads out of its folder" j
done
for name in pipe.nii below; do
    journal j "open $name"
    refused "$name is not a regular file" j
done
for command in mask weight seed-file; do
    for name in "$work/secret/hidden.nii" ../secret/hidden.nii out.nii folder/hidden.nii zero.nii; do
        journal j "open s.nii; $command $name"
        refused "the journal may not read $name" j
    done
    journal j "open s.nii; $command pipe.nii"
    refused "pipe.nii is not a regular file" j
done
close_story

begin "the folder that a journal is called from is not looked at"
mkdir elsewhere
cp s.nii "$work/secret/near.nii"
journal elsewhere/j 'open near.nii'
expect_in "$work/secret" 3 "$iftty" replay "$work/there/elsewhere/j"
expect_in "$work/secret" 0 env IFTTY_SCENES="$work/none:$work/secret" "$iftty" replay "$work/there/elsewhere/j"
expect_in "$work/secret" 0 "$iftty" -c 'open near.nii' # one's own commands are
close_story

begin "another scene under the same name is found out by its proof"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run' --journal proof.iftty
grep -qE '^= 1 .* sha256=[0-9a-f]{64} chain=' proof.iftty || fail "no proof: $(sed -n 3p proof.iftty)"
cp s.nii kept.nii
flip_byte s.nii 1000
expect 1 "$iftty" verify proof.iftty
out_has "record 1, line"
mv kept.nii s.nii
expect 0 "$iftty" verify proof.iftty
sed 's/ sha256=[0-9a-f]*//' proof.iftty >old.iftty # as journals without a proof were
expect 1 "$iftty" verify old.iftty
out_has "its chain digest does not fit"
expect 0 "$iftty" run "old.iftty" --journal anew.iftty
same_files anew.iftty proof.iftty
close_story

if command -v python3 >/dev/null; then
    begin "the proof is SHA-256 as anyone computes it"
    same "$(last_word sha256 proof.iftty)" "$(python3 - <<'EOP'
import hashlib, struct
voxels = open("s.nii", "rb").read()[352:]
head = struct.pack("<6I4B", 24, 20, 16, 1000000, 1000000, 1000000, 0, 2, 4, 0)
print(hashlib.sha256(head + b"".join(struct.pack("<H", v) for v in voxels)).hexdigest())
EOP
)"
    close_story
fi

begin "a golden image is read in the journal's folder"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 30 30; golden g' --journal g.iftty
expect 0 "$iftty" verify g.iftty
mv g.golden "$work/secret"
ln -s "$work/secret/g.golden" g.golden
expect 1 "$iftty" verify g.iftty
out_has "the journal may not read g.golden/g.exr, which leads out of its folder"
rm g.golden && mkdir g.golden
ln -s /dev/zero g.golden/g.exr
expect 1 timeout 20 "$iftty" verify g.iftty
out_has "which leads out of its folder"
rm g.golden/g.exr && mkfifo g.golden/g.exr
expect 1 timeout 20 "$iftty" verify g.iftty
out_has "is not a regular file"
close_story

# ---- writing ----

begin "what was in the folder of --out stays, what the replay wrote may be replaced"
mkdir out
echo precious >out/p.png
echo precious >out/l.nii
journal j 'open s.nii; seed 2,3,4 1; run; render p.png replace=yes'
expect 3 "$iftty" replay j --out out
err_has "out/p.png was there before; a replay replaces only what it has written itself"
journal j 'open s.nii; seed 2,3,4 1; run; save labels l.nii'
expect 3 "$iftty" replay j --out out
err_has "out/l.nii exists already and was left alone"
same "$(cat out/p.png out/l.nii | tr '\n' ' ')" "precious precious "
journal j 'open s.nii; seed 2,3,4 1; run; render q.png; turn 20; render q.png replace=yes'
expect 0 "$iftty" replay j --out out
same "$(ls out | tr '\n' ' ')" "l.nii p.png q.png "
close_story

begin "a link in the folder of --out does not lead the replay out of it"
echo precious >"$work/secret/target.png"
ln -s "$work/secret/target.png" out/t.png
for replace in no yes; do
    journal j "open s.nii; seed 2,3,4 1; run; render t.png replace=$replace"
    expect 3 "$iftty" replay j --out out
done
same "$(cat "$work/secret/target.png")" precious
close_story

# ---- limits ----

begin "memory, time and output are bounded, and the message names the option"
journal big 'open synth:geom; seed 100,100,50 1; run; adjacency 26; run; render a.exr; save root r.nii'
expect 3 "$iftty" replay big --limit-memory 50M
err_has "--limit-memory allows 50 MB: a scene of 200x200x100 voxels needs"
expect 3 "$iftty" replay big --limit-time 0.05
err_has "longer than the 0.05 s of --limit-time"
expect 3 "$iftty" verify big --limit-time 0.05s
out_has "longer than the 0.05 s of --limit-time"
expect 3 "$iftty" replay big --limit-output 1M --out bounded
err_has "more than the 1 MB of --limit-output; this file was not kept"
same "$(ls bounded | tr '\n' ' ')" "a.exr " # what fitted in is kept
expect 0 "$iftty" replay big --limit-output 20M --limit-time 5m --limit-memory 2G --out bounded2
rm -r bounded bounded2
close_story

begin "several files are counted together"
{ printf 'open s.nii\nseed 2,3,4 1\nrun\n'; seq -f 'save root r%g.nii' 9; } >many
expect 3 "$iftty" replay many --limit-output 100k --out counted # of 31 kB each
same "$(ls counted | wc -l | tr -d ' ')" 3
close_story

begin "limits that are none"
for wrong in "--limit-memory 0" "--limit-memory much" "--limit-memory 5X" "--limit-memory -1" \
    "--limit-time 3d" "--limit-time 1e5" "--limit-output 99999999999T" "--limit-output 1MB"; do
    # shellcheck disable=SC2086
    expect 2 "$iftty" replay big $wrong
    err_has "${wrong%% *}: expected"
done
close_story

# ---- the kernel's walls ----

begin "the program says whether the kernel has walls"
expect 0 "$iftty" info
grep -qE '^landlock  (version [0-9]+|none)' "$work/out" || fail "$(cat "$work/out")"
expect 0 "$iftty" info --json
out_has '"landlock": '
close_story

finish
