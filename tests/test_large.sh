#!/bin/sh
# SPDX-License-Identifier: MIT
# Large scenes, and long commands: what is announced and refused before anything is loaded, how far
# things are, and Ctrl-C at any moment.
. "$(dirname "$0")/lib.sh"

free_gb=$(awk '/^MemAvailable/ { print int($2 / 1000000) }' /proc/meminfo)

begin "more than 2^32 cells are refused, however they are asked for"
for size in 1624x1624x1624 65534x65534x65534 65535x1x1 4294967295x1x1; do
    expect 3 "$iftty" -c "open synth:geom:$size"
    grep -qE 'at most (2\^32 cells|65534) are held|at most 65534' err || fail "$size: $(cat err)"
done
for size in 0x1x1 4294967296x1x1 18446744073709551617x1x1 1x1 1x1x1x1 1x1x 10x-1x10 10X10X10; do
    refuses "expected synth:geom" "open synth:geom:$size"
done
nifti_header 1700 1700 1700 >huge.nii
truncate -s $((352 + 1700 * 1700 * 1700)) huge.nii
refuses "at most 2^32 cells are held" "open huge.nii"
err_has "open a part of it, with crop=A-B,C-D,E-F or reduce=2"
answers "10x10x100 voxels" "open huge.nii crop=0-9,1690-1699,1600-1699"

begin "a scene that there is no memory for is refused before it is loaded"
if [ "${free_gb:-0}" -gt 0 ] && [ "$free_gb" -lt 75 ]; then
    expect 3 "$iftty" -c "open synth:geom:1600x1600x1600"
    err_has "a scene of 1600x1600x1600 voxels needs 77.1 GB of memory and"
    err_has "GB are free; nothing was opened"
else
    skip "this machine has memory for every scene"
fi

begin "a scene of a given size opens and prints its size; geom with its default size is geom"
expect 0 "$iftty" -c "open synth:geom:200x200x100" --journal sized.iftty
expect 0 "$iftty" -c "open synth:geom" --journal plain.iftty
same "$(last_word scene sized.iftty)" "$(last_word scene plain.iftty)"
answers "label 1: 1 seed, 105 voxels" "open synth:geom:7x5x3; seed 3,2,1 1; run; stats"

begin "a large scene reports its memory on standard error, which has no other lines"
if [ "${free_gb:-0}" -le 2 ]; then
    skip "this machine has less than 2 GB of memory free"
else
    expect 0 "$iftty" -c "open synth:geom:400x400x340"
    same "$(sed 's/, [0-9.]* GB/, N GB/' err)" \
        "iftty: 400x400x340 voxels: needs 1.0 GB of memory, N GB are free"
fi

begin "a scene needs less than 20 bytes per voxel at the peak, and info prints the other memory"
if [ "${free_gb:-0}" -le 2 ]; then
    skip "this machine has less than 2 GB of memory free"
else
    for side in 30 260; do # the program itself takes some 10 MB
        expect 0 "$PYTHON" - "$iftty" $side <<'END'
import re, resource, subprocess, sys
side, middle = int(sys.argv[2]), "%d,%d,%d" % ((int(sys.argv[2]) // 2,) * 3)
run = subprocess.Popen([sys.argv[1], "run", "-"], stdin=-1, stdout=-1, stderr=-3, text=True)
print("open synth:geom:%dx%dx%d" % (side, side, side), "seed %s 1 radius=3" % middle,
      "seed 1,1,1 0", "seed 5,5,5 2 radius=4", "seed %d,9,9 3" % (side * 3 // 4), "run",
      "remove " + middle, "run", "seed %s 1 radius=9" % middle, "run", "info",
      "size 256 256", sep="\n", file=run.stdin, flush=True)
lines = [""]
while not lines[-1].startswith("ok 11 ") and run.poll() is None:
    lines.append(run.stdout.readline())
print(int(re.search(r"VmHWM:\s+(\d+)", open("/proc/%d/status" % run.pid).read())[1]) * 1024,
      file=open("peak.%d" % side, "w"))
print("render", "info", sep="\n", file=run.stdin)
run.stdin.close()
open("out", "w").write("".join(lines) + run.stdout.read())
run.wait()
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024,
      file=open("pictured.%d" % side, "w"))
END
    done
    [ $(($(cat peak.260) - $(cat peak.30))) -lt $((20 * 260 * 260 * 260)) ] ||
        is_sanitised || fail "at most $(cat peak.260) bytes, $(cat peak.30) of them without a scene"
    # A surface takes bytes by its area: here it has a third of a million quads.
    [ $(($(cat pictured.260) - $(cat pictured.30))) -lt $((22 * 260 * 260 * 260)) ] ||
        is_sanitised || fail "at most $(cat pictured.260) bytes with a picture"
    out_has '; pictures 0.0; and '
    grep -qE 'scene [0-9.]+, 1[0-9]\.[0-9] bytes a voxel' out || fail "$(grep memory out)"
    grep -qE 'pictures [1-9][0-9]*\.[0-9]; and ' out || fail "$(grep memory out)"
fi

begin "a turntable of large pictures needs less than 14 bytes per pixel in addition to its session"
# 4 for the picture, 5 for the rows of samples that two threads draw; its maps would take 25 more.
# The image helper, whose libraries hold more than that, has no part in a verification.
head='open synth:geom:40x40x40
seed 20,20,20 1 radius=4
seed 1,1,1 0
run
zoom 8'
printf '%s\n' "$head" >without
printf '%s\n' "$head" 'samples 4' 'size 2048 2048' 'spin 2 held%d.png' >with
for each in without with; do
    expect 0 "$iftty" run $each --journal $each.iftty
    set -- "$iftty" verify $each.iftty
    "$PYTHON" -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True, env={"IFTTY_THREADS": "2"})
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)' "$@" >peak.$each
done
held=$(($(cat peak.with) - $(cat peak.without)))
[ "$held" -lt $((14 * 2048 * 2048)) ] || is_sanitised || fail "$held bytes"
rm -f held?.png

begin "progress is shown on a terminal, and erased afterwards"
if needs script; then
    line="$iftty -c 'open synth:geom:320x320x320; seed 160,160,160 1; seed 1,1,1 0; run'"
    script -qec "$line" /dev/null </dev/null >seen
    tr '\r' '\n' <seen >lines
    grep -qE '\[#*-*\] +[0-9]+ %, [0-9]+ s' lines || fail "no bar: $(head -c 600 seen)"
    sed -n '/^ok 1/,$p' lines | grep -q '^ok 4 run' ||
        fail "acknowledgements are garbled: $(cat lines)"
    case $(tail -n 1 lines) in "" | "    "*) ;; *) fail "it stays: $(tail -n 1 lines)" ;; esac
fi

# interrupted NAME DELAY [DELAY]: runs `script` with a journal, and sends SIGINT after each delay.
interrupted() {
    env --default-signal=INT "$iftty" run script --journal "$1.iftty" >"$1.out" 2>"$1.err" &
    pid=$!
    sleep "$2"
    kill -INT $pid 2>/dev/null
    [ -z "$3" ] || { sleep "$3"; kill -INT $pid 2>/dev/null; }
    wait $pid
    got=$?
}

cat >script <<'EOS'
open synth:geom:80x80x80
seed 40,40,40 1
seed 55,32,41 2
seed 2,2,2 0
run
render a.png replace=yes
weight sobel
remove 55,32,41
adjacency 26
run
save labels a.nii.gz replace=yes
hide 1
render mode=ray
show 1
samples 4
spin 4 turn%d.png replace=yes
EOS

begin "Ctrl-C at any moment undoes the current command, and the journal has all others"
"$iftty" run script --journal whole.iftty >whole.out 2>err || fail "$(cat err)"
rm -f turn?.png
commands=$(wc -l <script)
stopped=0
for delay in 0.01 0.04 0.1 0.2 0.35 0.6; do
    interrupted at $delay
    acks=$(grep -c '^ok ' at.out)
    if [ "$acks" -lt "$commands" ]; then
        stopped=$((stopped + 1))
        [ "$got" = 130 ] || fail "status $got after $acks commands"
        [ ! -s at.err ] || grep -q "^script:$((acks + 1)): cancelled" at.err ||
            fail "after $acks commands: $(cat at.err)"
        same "after $acks commands: $(ls | grep '^turn')" "after $acks commands: "
    fi
    if [ -f at.iftty ]; then
        "$iftty" log --check at.iftty >out 2>err || fail "$(cat err)"
        same "$(grep -c '^= ' at.iftty)" "$acks"
        tail -n "+$((acks + 1))" script >rest
        "$iftty" run rest --journal at.iftty >out 2>err || fail "going on after $acks: $(cat err)"
        same_files at.iftty whole.iftty
    fi
    ls -A | grep -E '^\.|~$|draft' && fail "something was left behind"
    rm -f at.* turn?.png
done
[ "$stopped" -ge 2 ] || fail "only $stopped of the runs were stopped"

begin "a second Ctrl-C does no more than the first"
for delay in 0.05 0.2; do
    interrupted twice $delay 0.03
    [ ! -f twice.iftty ] || "$iftty" replay twice.iftty --out replayed >out 2>err ||
        fail "$(cat err)"
    rm -rf twice.* replayed
done

# Whether a process acts on SIGINT by itself, or has ended. Before that it is lost: what a shell
# starts in the background ignores it.
takes_interrupts() { # PROCESS
    case $(sed -n 's/^State:.Z.*/ended/p; s/^SigCgt:.*\(.\)$/\1/p' "/proc/$1/status") in
    [2367abef] | ended*) ;;
    *) false ;;
    esac
}
# is_stopped WORDS...: whether the program ends by SIGINT, with its status in got. It may be through
# before the signal comes.
is_stopped() {
    env --default-signal=INT "$iftty" "$@" >out 2>err &
    pid=$!
    comes_true takes_interrupts $pid
    kill -INT $pid
    wait $pid
    got=$?
    [ "$got" = 130 ]
}

begin "replay and -c stop as well"
is_stopped replay whole.iftty --out replayed || [ "$(grep -c '^ok' out)" = "$commands" ] ||
    fail "replay: status $got"
for _ in 1 2 3 4 5 6 7 8 9 10; do
    is_stopped -c 'open synth:geom:300x300x300; info' --keep-going && break
    same "$got" 0
done
same "$got" 130
[ ! -s out ] || fail "$(cat out)"

begin "Ctrl-C while a script is waited for ends the program at once"
mkfifo pipe
env --default-signal=INT "$iftty" run - --journal fifo.iftty <pipe >out 2>err &
pid=$!
exec 3>pipe
echo "open synth:geom:20x20x20" >&3
comes_true has_line out '^ok 1'
kill -INT $pid
wait $pid
got=$?
exec 3>&-
same "$got" 130
expect_out "1 record" 0 "$iftty" log --check fifo.iftty

finish
