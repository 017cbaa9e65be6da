#!/bin/sh
# SPDX-License-Identifier: MIT
# A journal that is locked, deleted, full or damaged: the program reports it, loses no acknowledged
# command, and continues in another file.
. "$(dirname "$0")/lib.sh"
private_mounts "$0"
make_scene s.nii 24 20 16

# A session whose commands are written one after the other: begin_session ARGUMENTS..., tell LINE,
# end_session. Its output is in acks and errors.
begin_session() {
    rm -f line
    mkfifo line
    : >acks # now, since the session begins a little later
    : >errors
    "$iftty" run - --keep-going "$@" <line >acks 2>errors &
    session=$!
    exec 3>line
}
tell() { # and wait until it is answered
    before=$(cat acks errors | wc -l)
    echo "$1" >&3
    comes_true has_answered "$before"
}
has_answered() { # MORE than so many lines
    [ "$(cat acks errors | wc -l)" -gt "$1" ]
}
end_session() {
    exec 3>&-
    wait "$session"
}
errors_have() {
    grep -qF -e "$1" errors || fail "no '$1' in the errors:" "$(cat errors)"
}

begin "a second session is told the owner of the journal, and may read it"
begin_session --journal a.iftty
tell 'open s.nii'
tell 'seed 3,4,5 1'
expect_err "process $session (iftty)" 3 "$iftty" run - --journal a.iftty </dev/null
err_has "--read-only"
cp a.iftty a.kept
expect 0 "$iftty" -c 'stats; seed 9,9,9 2; journal; journal mine.iftty; seed 8,8,8 3' --read-only \
    --journal a.iftty
out_has "4 records, read-only: nothing is written" # a question has applied the seed
err_has "a.iftty is open read-only"
same_files a.iftty a.kept
expect_out "5 commands, 5 results with " 0 "$iftty" verify mine.iftty
echo 'golden g' >script
expect_err "open read-only" 2 "$iftty" run script --read-only --journal a.iftty
tell 'seed 6,6,6 2'
end_session
expect_out "3 commands" 0 "$iftty" verify a.iftty
expect_err "there is no journal none.iftty" 3 "$iftty" -c 'info' --read-only --journal none.iftty
[ ! -e none.iftty ] || fail "it was created"
expect 2 "$iftty" --read-only </dev/null

begin "a journal in a folder that cannot be written to can be looked at"
mkdir closed
cp a.iftty s.nii closed
chmod 555 closed
chmod 444 closed/a.iftty
expect 0 "$iftty" -c 'stats; journal later.iftty; seed 1,1,1 1' --read-only --journal closed/a.iftty
expect 0 "$iftty" verify later.iftty
expect 3 with_permissions "$iftty" -c 'stats' --journal closed/a.iftty
err_has "--read-only opens it for looking"
expect 3 with_permissions "$iftty" -c 'open s.nii' --journal closed/new.iftty

for harm in deleted replaced shorter longer; do
    begin "a journal that was $harm: reported, undone, and continued in another file"
    rm -rf ./*.iftty ./*.golden
    begin_session --journal b.iftty
    tell 'open s.nii'
    tell 'golden first'
    tell 'seed 3,4,5 1'
    case $harm in
    deleted) rm b.iftty ;;
    replaced) cp b.iftty b.new && mv b.new b.iftty ;;
    shorter) truncate -s -7 b.iftty ;;
    longer) echo '# mine' >>b.iftty ;;
    esac
    cp b.iftty b.kept 2>/dev/null
    tell 'seed 6,6,6 2'
    errors_have "the command was undone because it could not be recorded"
    errors_have "journal FILE"
    tell 'journal elsewhere.iftty'
    tell 'seed 7,7,7 2'
    end_session
    [ $harm = deleted ] || same_files b.iftty b.kept
    expect_out "4 commands, 4 results with " 0 "$iftty" verify elsewhere.iftty
    expect 0 "$iftty" log --script elsewhere.iftty
    grep -q 'seed 6,6,6' out && fail "the undone command is there"
    [ -f elsewhere.golden/first.exr ] || fail "the golden image did not come along"
done

begin "a full disk: the session continues on another one"
small=$work/small
mkdir "$small"
if can_mount && mount -t tmpfs -o size=16k none "$small"; then
    begin_session --journal "$small/c.iftty"
    tell "open $work/s.nii"
    n=0
    while [ ! -s errors ] && [ $((n += 1)) -lt 400 ]; do tell "seed $((n % 24)),3,4 1"; done
    errors_have "No space left on device"
    said=$(grep -c '^ok' acks)
    tell 'journal roomy.iftty'
    tell 'seed 9,9,9 3'
    end_session
    expect_out "$((said + 1)) commands" 0 "$iftty" verify roomy.iftty
    expect_out "$said records" 0 "$iftty" log --check "$small/c.iftty"
    umount "$small"
fi

begin "a disk that is full: no file is half written, and the command works when there is room"
disk=$work/disk
mkdir "$disk"
# leave KIB: leave this free space on the disk. With its source named, mount requests only this
# change; it would also request the owner, who does not exist where an ordinary user may mount.
leave() {
    used=$(df -k --output=used "$disk" | tail -n 1)
    mount -t tmpfs -o remount,size=$((used + $1))k none "$disk"
}
files_there() { # but the journal, and the folder of golden images, which may be empty
    listing "$disk" | grep -v 'f\.iftty$\|^\./f\.golden$'
}
if can_mount && mount -t tmpfs -o size=1m none "$disk"; then
    cp s.nii "$disk"
    expect_in "$disk" 0 "$iftty" -c 'open s.nii; size 64 64; seed 3,4,5 1; seed 20,15,9 2' \
        --journal f.iftty
    refused=0
    for line in 'golden g' 'golden m of=mosaic' 'render r.exr' 'save labels l.nii' \
        'save surface s.stl' 'spin 2 t%d.exr'; do
        for room in 0 4 8 12; do
            leave $room
            files_there >before
            expect_in "$disk" 0 "$iftty" log --script f.iftty
            cp out commands
            if (cd "$disk" && "$iftty" -c "$line" --journal f.iftty) >out 2>err; then
                room=done # the record was written, too
                break
            fi
            refused=$((refused + 1))
            err_has "No space left on device"
            files_there | cmp -s - before ||
                fail "$line, room for $room KiB: $(files_there | diff before -)"
            expect_in "$disk" 0 "$iftty" log --script f.iftty
            same_files out commands
        done
        leave 1024
        expect_in "$disk" 0 "$iftty" verify --strict f.iftty
        [ $room = done ] || expect_in "$disk" 0 "$iftty" -c "$line" --journal f.iftty
    done
    expect_in "$disk" 0 "$iftty" verify --strict f.iftty
    [ $refused -ge 8 ] || fail "the disk was full $refused times only"
    [ -z "$(find "$disk" -name '.iftty-*')" ] || fail "a draft is left"
    umount "$disk"
fi

begin "a link to a journal: golden images are next to the journal itself"
mkdir real
cp s.nii real
expect_in real 0 "$iftty" -c 'open s.nii; seed 3,4,5 1; golden a' --journal l.iftty
ln -s real/l.iftty link.iftty
expect 0 "$iftty" -c 'turn 20; golden b' --journal link.iftty
same "$(ls real/l.golden | tr '\n' ' ')" "a.exr a.png b.exr b.png "
[ ! -e link.golden ] || fail "there is a folder beside the link"
expect 0 "$iftty" verify link.iftty
expect_in real 0 "$iftty" verify l.iftty
mv real/l.golden link.golden # where they lay before
expect 0 "$iftty" verify link.iftty
expect 1 "$iftty" verify real/l.iftty

begin "a journal with the line ends of Windows is reported, with a command that repairs it"
sed 's/$/\r/' real/l.iftty >w.iftty
expect_err "it has the line ends of Windows" 3 "$iftty" -c info --journal w.iftty
expect_out "it has the line ends of Windows" 3 "$iftty" verify w.iftty
tr -d '\r' <w.iftty | cmp -s - real/l.iftty || fail "that does not mend it"

begin "a file system that cannot rename to a new name: bindfs"
mkdir below above
if can_fuse below above; then
    cp s.nii above
    expect_in above 0 "$iftty" -c 'open s.nii; seed 3,4,5 1; golden a; render r.png
        save labels l.nii; save surface s.stl; spin 2 t%d.png; stats report=r.json
        save labels l.nii replace=yes' --journal f.iftty
    expect_in above 3 "$iftty" -c 'save labels l.nii' --journal f.iftty
    err_has "exists already"
    expect_in above 0 "$iftty" verify f.iftty
    [ -z "$(find below -name '.iftty-*')" ] || fail "a draft is left"
    fusermount3 -u above || fusermount -u above
fi

begin "journal FILE with an existing file, or without a journal to continue"
expect 0 "$iftty" -c 'open s.nii; journal; journal d.iftty; seed 1,2,3 1; journal' --journal e.iftty
out_has "e.iftty, 1 record" "d.iftty, 2 records"
cp d.iftty d.kept
expect_err "d.iftty exists already" 3 "$iftty" -c 'journal d.iftty' --journal e.iftty
same_files d.iftty d.kept
expect 0 "$iftty" -c 'journal f.iftty; open s.nii'
expect 0 "$iftty" verify f.iftty
expect_err "without a journal" 2 "$iftty" -c 'open s.nii; journal g.iftty'
[ ! -e g.iftty ] || fail "it was created"
echo 'journal h.iftty' >script
expect 3 "$iftty" replay script
[ ! -e h.iftty ] || fail "a replay wrote a journal"

begin "modes of syncing are reported"
expect_out "before it is acknowledged" 0 "$iftty" -c 'sync; sync off; sync' --journal k.iftty
out_has "since the last"
expect_err "always" 2 "$iftty" -c 'sync never'

begin "a golden image without its record goes after its PNG, or stays to be found again"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first' --journal g.iftty >acks
sed -i '/^golden first/,$d' g.iftty
rm g.golden/first.png
mkdir -p g.golden/first.png/full # which unlink refuses
expect 0 "$iftty" -c stats --journal g.iftty
[ -e g.golden/first.exr ] || fail "nothing leads to the PNG any more"
rm -r g.golden/first.png
: >g.golden/first.png
expect_err "first.exr was removed" 0 "$iftty" -c stats --journal g.iftty
same "$(ls g.golden 2>&1)" ""

begin "a repair keeps the sound records, and saves the rest in another file"
printf 'open s.nii\nseed 1,2,3 1\n# why\nseed 4,5,6 2\nseed 7,8,9 3\n' >script
expect 0 "$iftty" run script --journal r.iftty
expect_out "intact, 4 records; nothing was changed" 0 "$iftty" log --repair r.iftty
cp r.iftty r.kept
flip_byte r.iftty "$(grep -b -o 'seed 4' r.iftty | cut -d : -f 1)"
cp r.iftty r.harmed
expect_err "record 3" 3 "$iftty" run - --journal r.iftty </dev/null
err_has "byte" "iftty log --repair"
expect_out "record 3" 0 "$iftty" log --repair r.iftty
out_has "r.iftty.torn-1" "2 records left"
cat r.iftty r.iftty.torn-1 | cmp -s - r.harmed || fail "bytes are lost"
expect 0 "$iftty" verify r.iftty
sed 's/semantics [0-9]*/semantics 999/' r.kept >v.iftty
cp v.iftty v.kept
expect_out "0 records left" 0 "$iftty" log --repair v.iftty # record 1 covers the header
cat v.iftty v.iftty.torn-1 | cmp -s - v.kept || fail "bytes are lost"
echo 'open s.nii' >script
expect_err "a script, not a journal" 3 "$iftty" log --repair script
expect 3 "$iftty" log --repair none.iftty

begin "the folder of a killed replay is removed by the next one; other folders are kept"
mkdir tmp few
printf '%s\n' 'open s.nii' 'seed 2,3,4 1' run 'save labels few.nii' >script
expect 0 "$iftty" run script --journal few.iftty
for i in $(seq 300); do printf 'undo\nredo\nsave cost %s.nii\n' "$i"; done >>script
expect_in few 0 "$iftty" run ../script --journal ../many.iftty
has_written() { ls tmp/iftty-*/1.nii; }
TMPDIR=$work/tmp "$iftty" replay many.iftty >/dev/null 2>&1 &
replay=$!
comes_true has_written >/dev/null 2>&1
kill -STOP $replay
killed=$(ls tmp)
expect 0 env TMPDIR="$work/tmp" "$iftty" replay few.iftty # which leaves its file
same "$(ls tmp | wc -l)" 2
[ -e "tmp/$killed/1.nii" ] || fail "what a process still writes is gone"
kill -KILL $replay
wait $replay 2>/dev/null
mkdir tmp/iftty-mine tmp/iftty-abcdef
ln -s "$work/few" tmp/iftty-linked
expect 0 env TMPDIR="$work/tmp" "$iftty" replay few.iftty
[ ! -e "tmp/$killed" ] || fail "it is there still: $(ls -A tmp/$killed | head)"
same "$(ls tmp | wc -l)" 5
same "$(ls tmp/iftty-*/few.nii | wc -l)" 3
[ -e few/1.nii ] || fail "what a link leads to is gone"
[ -z "$(ls -A tmp/iftty-*/.iftty* 2>/dev/null)" ] || fail "$(ls -A tmp/*)"

finish
