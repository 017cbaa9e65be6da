#!/bin/sh
# SPDX-License-Identifier: MIT
# `make test-cohort`: the scripts of examples/cohort, by real engines: Snakemake, and Slurm with two
# nodes on this machine. Twelve subjects of 2 mm; tasks are killed, requeued and run out of disk.
# The final results of both engines are equal, byte for byte. Not part of `make test`.
. "$(dirname "$0")/lib.sh"
private_mounts "$0"
cohort=$top/examples/cohort
HOME=$work/home XDG_CACHE_HOME=$work/home XDG_CONFIG_HOME=$work/home
SLURM_CONF=$work/slurm/slurm.conf
PROCEDURE=$work/procedure/brain.iftty BIDS=$work/study OUT=$work/by-slurm COHORT=$cohort
OPTIONS="--truth $BIDS/derivatives/truth" IFTTY=$iftty
export HOME XDG_CACHE_HOME XDG_CONFIG_HOME SLURM_CONF PROCEDURE BIDS OUT COHORT OPTIONS IFTTY
mkdir home tmp slurm
TMPDIR=$work/tmp
export TMPDIR
subjects=12
touch stamp

# ---- started processes, and their end ----

# Processes whose command lines name our folder, except for this search.
ours() { # PATTERN
    ps -eo pid=,args= | grep -F "$work" | grep -e "$1" | grep -v -e grep -e 'ps -eo' |
        awk -v self=$$ '$1 != self { print $1 }'
}
end_all() {
    [ -z "$daemons" ] || scancel --user="$(id -un)" 2>/dev/null
    for pid in $daemons; do
        kill "$pid" 2>/dev/null && wait "$pid" 2>/dev/null
    done
    daemons=
    for pid in $(ours .); do kill -9 "$pid" 2>/dev/null; done
    umount full 2>/dev/null
}
daemons=
trap 'end_all; cd "$top"; chmod -R u+rwx "$work" 2>/dev/null; rm -rf "$work"' EXIT

is_running() { # PATTERN
    [ -n "$(ours "$1")" ]
}
has_sidecars() { # FOLDER COUNT
    [ "$(ls "$1"/sub-*/anat/*_dseg.json 2>/dev/null | wc -l)" -ge "$2" ]
}
# Kills the task of some subject while it works: its script, its program goes with it.
kill_one() { # FOLDER
    comes_true is_running "subject\.py.*$1" || return
    victim=$(ours "subject\.py.*$1" | tail -n 1)
    kill -9 "$victim" || fail "no task was killed"
}
nothing_passing() { # FOLDER
    same "$(find "$1" -name .work -o -name '*.part' -o -name 'iftty-*' -o -name '.iftty-*')" ''
    same "$(ls -A "$TMPDIR")" ''
}

# ---- stories ----

begin "the same seed makes the same subjects and truth"
expect 0 "$iftty" run "$top/examples/brain.iftty" --out procedure
cp "$top/examples/brain.iftty" procedure
make_subjects() { # OPTIONS
    "$cohort/subjects.py" --reduce 2 --elastic 3 --affine --noise 3 --bias 20 "$@" \
        /usr/share/mricron/templates/ch2.nii.gz procedure/brain-labels.nii.gz study >>made 2>&1 ||
        fail "subjects.py: $(tail -n 1 made)"
}
for first in 1 2; do
    for number in $(seq $first 2 $subjects); do
        make_subjects --only "$number"
    done &
done
wait
cp study/sub-03/anat/sub-03_T1w.nii.gz study/derivatives/truth/sub-03/anat/*.nii.gz tmp
make_subjects --only 3
for file in tmp/*.nii.gz; do
    same_files "$file" "$(find study -name "${file##*/}")"
done
rm tmp/*
same "$(ls study/sub-*/anat/*_T1w.nii.gz | wc -l)" $subjects
mkdir store # scenes behind links, as data sets keep them
for number in 02 07; do
    scene=study/sub-$number/anat/sub-${number}_T1w.nii.gz
    mv "$scene" store/$number && ln -s "../../../store/$number" "$scene"
done

snake() { # OPTIONS
    mkdir -p snake && cd snake &&
        setsid snakemake -s "$cohort/Snakefile" --cores 2 --rerun-incomplete "$@" --config \
            procedure="$PROCEDURE" bids="$BIDS" out="$work/by-snakemake" \
            truth="$BIDS/derivatives/truth" iftty="$iftty" >>../snake.log 2>&1
}

begin "Snakemake: a task that gets SIGKILL fails, and the others continue"
(snake) &
running=$!
kill_one by-snakemake
wait $running && fail "a task was killed, and all is well"
grep -q 'Error in rule subject' snake.log || fail "Snakemake does not name the task"

begin "Snakemake itself gets SIGKILL with all its tasks, and continues after --unlock"
(snake) &
running=$!
comes_true has_sidecars by-snakemake 4
comes_true is_running 'subject\.py.*by-snakemake'
whole=$(ours 'snakemake -s' | head -n 1)
kill -9 "-$whole" # a group of its own, by setsid
wait $running
comes_true sh -c '! ps -eo args= | grep -F "$0" | grep -q "[s]ubject.py"' "$work"
(snake) && fail "it should be locked"
grep -q 'Directory cannot be locked' snake.log || fail "nobody says that it is locked"
(snake --unlock) || fail "it cannot be unlocked"
(snake) || fail "it does not go on: $(tail -n 3 snake.log)"
has_sidecars by-snakemake $subjects || fail "subjects are missing"
nothing_passing by-snakemake
(snake) || fail "it does not end well when there is nothing to do"
tail -n 3 snake.log | grep -q 'Nothing to be done' || fail "it does again what is done"

begin "the table has all subjects and labels; picture and page too"
expect 0 /usr/bin/python3 - by-snakemake $subjects <<'PYTHON'
import csv, json, statistics, sys
from PIL import Image
out, subjects = sys.argv[1], int(sys.argv[2])
rows = list(csv.DictReader(open(out + "/cohort.csv")))
assert len({row["subject"] for row in rows}) == subjects
states = {row["subject"]: row["state"] for row in rows}
print("# %d were carried over, %d were refused" % tuple(
    list(states.values()).count(state) for state in ("done", "refused")))
assert set(states.values()) <= {"done", "refused"} and \
    list(states.values()).count("done") >= subjects / 2, states
rows = [row for row in rows if row["state"] == "done"]
assert {int(row["order"]) for row in rows} == set(range(subjects - len(rows) // 3 + 1,
                                                        subjects + 1)), "refused ones come first"
assert min(float(row["dice"]) for row in rows if row["label"] == "1") > 0.85
for label in "123":
    dice = sorted(float(row["dice"]) for row in rows if row["label"] == label)
    print("# label %s: Dice %.3f to %.3f, median %.3f" % (label, dice[0], dice[-1],
                                                          statistics.median(dice)))
for what in "seconds", "processor_seconds", "memory_mb", "disk_mb":
    known = [float(row[what]) for row in rows if row["label"] == "1" and row[what]]
    print("# %s of a subject: median %.4g, most %.4g" % (what, statistics.median(known),
                                                         max(known)))
page = open(out + "/cohort.html").read()
assert all(page.count("<b>%s</b>" % subject) == 1 for subject in states)
sheet = Image.open(out + "/cohort.png").convert("RGB")
sheet.load()
assert sheet.width >= 3 * 320 and len(sheet.getcolors(1 << 24)) > 1000
PYTHON
grep '^#' out

begin "Slurm on two nodes listens on loopback alone"
cat >slurm/slurm.conf <<CONF
ClusterName=iftty
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=17817
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
MailProg=/bin/true
StateSaveLocation=$work/slurm
SlurmdSpoolDir=$work/slurm/%n
SlurmctldPidFile=$work/slurm/controller.pid
SlurmdPidFile=$work/slurm/%n.pid
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17818 CPUs=1 RealMemory=3000
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17819 CPUs=1 RealMemory=3000
PartitionName=all Nodes=n1,n2 Default=YES State=UP
CONF
ss -Hltn | awk '{ print $4 }' | sort >listened
begin_daemon() { # NAME WORDS: it ends with this script, however that ends
    name=$1
    shift
    setpriv --pdeathsig TERM "$@" >slurm/$name.log 2>&1 &
    daemons="$daemons $!"
}
begin_daemon controller slurmctld -D
begin_daemon n1 slurmd -D -N n1
begin_daemon n2 slurmd -D -N n2
comes_true sh -c 'sinfo -h -o "%t %D" 2>/dev/null | grep -qx "idle 2"'
ss -Hltn | awk '{ print $4 }' | sort | comm -13 listened - >listens
same "$(tr '\n' ' ' <listens)" '127.0.0.1:17817 127.0.0.1:17818 127.0.0.1:17819 '

no_jobs() {
    [ -z "$(squeue -h)" ]
}
ends() { # within eight minutes: a task that is requeued waits for more than one
    for _ in $(seq 8); do
        comes_true no_jobs >ended && return
        failures=$((failures - 1))
    done
    fail "jobs do not end: $(squeue -h)"
}

begin "Slurm: a task that is requeued while it works, and one that gets SIGKILL"
job=$(sbatch --parsable --array=1-$subjects --output=slurm/task-%a.log "$cohort/cohort.sbatch")
comes_true is_running 'subject\.py.*by-slurm'
comes_true sh -c 'squeue -h -t R -o %A | grep -q .'
requeued=$(squeue -h -t R -o %A | head -n 1)
scontrol requeue "$requeued" || fail "it cannot be requeued"
comes_true has_sidecars by-slurm 2
kill_one by-slurm
ends
has_sidecars by-slurm $((subjects - 1)) || fail "more than the one that was killed are missing"
has_sidecars by-slurm $subjects && fail "the one that was killed is there"

begin "Slurm: the same command again completes all, with Snakemake's results"
job=$(sbatch --parsable --array=1-$subjects --output=slurm/task-%a.log "$cohort/cohort.sbatch")
sbatch --parsable --output=slurm/gather.log --dependency="afterany:$job" \
    --wrap "'$cohort/gather.py' $BIDS $OUT" >/dev/null
ends
grep -q "^$subjects subjects, [0-9]* to look at before any other$" slurm/gather.log ||
    fail "nothing was gathered: $(cat slurm/gather.log)"
cut -d, -f 1-11 by-snakemake/cohort.csv >csv # the rest is time
cut -d, -f 1-11 by-slurm/cohort.csv >csv2
for file in by-snakemake/sub-*/anat/*.iftty by-snakemake/sub-*/anat/*.nii.gz; do
    same_files "$file" "by-slurm/${file#by-snakemake/}"
done
awk -F, -v OFS=, '{ $3 = $9 = $11 = "" } 1' csv | sort >csv1 # doubt, where the task made it
awk -F, -v OFS=, '{ $3 = $9 = $11 = "" } 1' csv2 | sort >csv3
same_files csv1 csv3
same "$(grep -l 'there already' slurm/task-*.log | wc -l)" $((subjects - 1))
nothing_passing by-slurm

begin "a subject on a full disk fails with a message, and succeeds with more room"
if can_mount; then
    mkdir full
    mount -t tmpfs -o size=4k none full
    for size in 4k 16k 48k 96k; do
        mount -o "remount,size=$size" full
        expect 3 "$cohort/subject.py" --iftty "$iftty" $OPTIONS "$PROCEDURE" \
            "$BIDS/sub-01/anat/sub-01_T1w.nii.gz" "$work/full"
        grep -qi 'no space left' err || fail "not said: $(cat err)"
        nothing_passing full
        same "$(find full -name '*_dseg*')" ''
    done
    mount -o remount,size=100m full
    expect 0 "$cohort/subject.py" --iftty "$iftty" $OPTIONS "$PROCEDURE" \
        "$BIDS/sub-01/anat/sub-01_T1w.nii.gz" "$work/full"
    same_files full/sub-01/anat/sub-01_T1w.iftty by-slurm/sub-01/anat/sub-01_T1w.iftty
    umount full
fi

begin "all started processes have ended, and no file is left elsewhere"
end_all
same "$(ours .)" ''
same "$(ss -Hltn | awk '{ print $4 }' | sort | comm -13 listened -)" ''
same "$(find /var/spool /var/log /var/lib /run "${COHORT}" -newer stamp 2>/dev/null |
    grep -e slurm -e snakemake -e __pycache__)" ''

finish
