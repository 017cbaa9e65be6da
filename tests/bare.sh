#!/bin/sh
# A newcomer's machine: a bare Debian 12 with git, make and gcc, a fresh clone, and what README says
# to type, `make demo` and `make test`; once as root, who gets what is missing installed, and once as
# an ordinary user without sudo, who finds it there.
#
#     bare.sh [FOLDER]   the machine lies in FOLDER, or in build/bare; it is made anew
#     KEEP=yes           and is left there afterwards
#
# What is cloned is HEAD: commit first. Packages come from where this machine has its own. Asks for
# root. Closes with "N passed, N failed, N skipped" of both runs; status 1 where something is missing,
# fails, or is skipped for a reason that is not in may_skip.txt.
set -u
cd "$(dirname "$0")/.." || exit 1
bare=${1:-build/bare}
suite=bookworm
[ "$(id -u)" = 0 ] || { echo "bare.sh: ask as root: debootstrap and chroot need it" >&2; exit 2; }
mkdir -p "$bare" && bare=$(cd "$bare" && pwd) || exit 1
root=$bare/root log=$bare/log

unmount() { # all that is mounted below it, the last first
    awk -v root="$root/" 'index($2, root) == 1 { print $2 }' /proc/mounts | sort -r |
        while read -r place; do umount "$place" || umount -l "$place"; done
}
clear_up() {
    unmount
    if awk -v root="$root/" 'index($2, root) == 1 { found = 1 } END { exit !found }' /proc/mounts; then
        echo "bare.sh: something is still mounted below $root; it is left" >&2
    elif [ -z "${KEEP:-}" ]; then
        rm -rf "$root"
    fi
}
trap clear_up EXIT
trap 'exit 1' HUP INT TERM

# The first mirror of the machine's own sources that has the suite, in either way of writing them.
mirrors() {
    {
        sed -n 's/^deb \(\[[^]]*\] *\)\{0,1\}\([^ ]*\) .*/\2/p' /etc/apt/sources.list /etc/apt/sources.list.d/*.list
        sed -n 's/^URIs: *//p' /etc/apt/sources.list.d/*.sources | tr ' ' '\n'
    } 2>/dev/null | awk 'length && !seen[$0]++'
}
make_root() {
    for mirror in $(mirrors); do
        rm -rf "$root"
        packages=git,make,gcc
        case $mirror in https:*) packages=$packages,ca-certificates ;; esac
        debootstrap --variant=minbase --include=$packages "$suite" "$root" "$mirror" \
            >"$bare/debootstrap.log" 2>&1 && return
    done
    tail -n 3 "$bare/debootstrap.log" >&2
    return 1
}
# The way out is that of this machine: proxies, and the names of hosts.
share_network() {
    apt-config dump | grep -i '^Acquire::[a-z]*::Proxy ' >"$root/etc/apt/apt.conf.d/10proxy"
    for file in resolv.conf hosts; do cp -L "/etc/$file" "$root/etc/$file" || return; done
}
mount_places() {
    mount -t proc proc "$root/proc" && mount -t tmpfs -o mode=755 dev "$root/dev" &&
        mkdir "$root/dev/pts" "$root/dev/shm" || return
    for device in null zero full random urandom tty; do
        touch "$root/dev/$device" && mount --bind "/dev/$device" "$root/dev/$device" || return
    done
    ln -s /proc/self/fd "$root/dev/fd"
    ln -s pts/ptmx "$root/dev/ptmx"
    mount -t devpts -o newinstance,ptmxmode=666,mode=620,gid=5 devpts "$root/dev/pts" &&
        mount -t tmpfs -o mode=1777 shm "$root/dev/shm"
}
inside() { # USER COMMAND, with nothing of this environment but the way out to the network
    chroot "$root" env -i HOME="$(awk -F: -v user="$1" '$1 == user { print $6 }' "$root/etc/passwd")" \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
        ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        setpriv --reuid="$1" --regid="$1" --init-groups sh -c "$2" </dev/null
}
failures=0
run() { # USER COMMAND
    echo "# $1: $2"
    inside "$1" "cd ~/iftty && $2" 2>&1 | tee -a "$log" "$bare/said"
    # the closing line of the tests, or the demo's, is what says that it went well
    case $2 in
    *test) tail -n 1 "$bare/said" | grep -qE '^[0-9]+ passed, 0 failed, [0-9]+ skipped$' ;;
    *demo) grep -q '^  # [0-9]* verified, 0 failed' "$bare/said" && ! grep -q 'stands in' "$bare/said" ;;
    esac || { failures=$((failures + 1)); echo "# that failed"; }
    : >"$bare/said"
}

unmount
: >"$log"
: >"$bare/said"
echo "# Debian $suite in $root"
make_root && share_network && mount_places || { echo "bare.sh: the machine could not be made" >&2; exit 1; }
git clone -q --no-hardlinks . "$root/root/iftty" || exit 1
chroot "$root" useradd -m somebody || exit 1
run root "make demo"
run root "make test"
# The user's clone lies on another folder, with nothing built.
git clone -q --no-hardlinks . "$root/home/somebody/iftty" &&
    chroot "$root" chown -R somebody: /home/somebody/iftty || exit 1
run somebody "make demo"
run somebody "make test"
.ci/close "$log" || failures=$((failures + 1))
[ "$failures" = 0 ]
