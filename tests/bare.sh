#!/bin/sh
# SPDX-License-Identifier: MIT
# A newcomer's machine: a bare Debian 12 with git, make and gcc, a fresh clone, and what README says
# to type, `make demo` and `make test`; once as root, who gets what is missing installed, and once
# as an ordinary user without sudo, who finds it there.
#
#     bare.sh [FOLDER]   the machine lies in FOLDER, or in build/bare; it is made anew
#     KEEP=yes           and is left there afterwards
#
# What is cloned is HEAD: commit first. Packages come from where this machine has its own. Asks for
# root. Closes with "N passed, N failed, N skipped" of both runs; status 1 where something is
# missing, fails, or is skipped for a reason that is not in may_skip.txt.
set -u
cd "$(dirname "$0")/.." || exit 1
suite=bookworm
[ "$(id -u)" = 0 ] || { echo "bare.sh: debootstrap and mounting ask for root" >&2; exit 2; }
# All is mounted where nobody else sees it, and is gone with the last process, however that ends.
[ -n "${IFTTY_BARE:-}" ] || IFTTY_BARE=yes exec unshare -m tests/bare.sh "$@"
bare=${1:-build/bare}
mkdir -p "$bare" && bare=$(cd "$bare" && pwd) || exit 1
root=$bare/root log=$bare/log said=$bare/said
clear_up() {
    awk -v root="$root" '$2 == root || index($2, root "/") == 1 { print $2 }' /proc/mounts |
        sort -r | while read -r place; do umount -l "$place"; done
    # where something should still be mounted, nothing of it is removed
    [ -n "${KEEP:-}" ] || rm -rf --one-file-system "$root"
}
trap clear_up EXIT
trap 'exit 1' HUP INT TERM

# ---- the machine ----

# The mirrors of this machine's own sources, in either way of writing them.
mirrors() {
    {
        sed -n 's/^deb \(\[[^]]*\] *\)\{0,1\}\([^ ]*\) .*/\2/p' \
            /etc/apt/sources.list /etc/apt/sources.list.d/*.list
        sed -n 's/^URIs: *//p' /etc/apt/sources.list.d/*.sources | tr ' ' '\n'
    } 2>/dev/null | awk 'length && !seen[$0]++'
}
make_root() { # from the first mirror that has the suite
    for mirror in $(mirrors); do
        rm -rf --one-file-system "$root"
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
    mount --bind "$root" "$root" && mount -t sysfs -o ro sys "$root/sys" &&
        mount -t tmpfs -o mode=755 dev "$root/dev" &&
        mkdir "$root/dev/pts" "$root/dev/shm" || return
    for device in null zero full random urandom tty; do
        touch "$root/dev/$device" && mount --bind "/dev/$device" "$root/dev/$device" || return
    done
    ln -s /proc/self/fd "$root/dev/fd"
    ln -s pts/ptmx "$root/dev/ptmx"
    mount -t devpts -o newinstance,ptmxmode=666,mode=620,gid=5 devpts "$root/dev/pts" &&
        mount -t tmpfs -o mode=1777 shm "$root/dev/shm"
}
# USER COMMAND: there, with nothing of this environment but the way out to the network. The root is
# a real one, not that of chroot, in which the kernel makes no namespaces; and so are its processes,
# which end with the command.
inside() {
    set -- "$1" "$2" "$(awk -F: -v user="$1" '$1 == user { print $6 }' "$root/etc/passwd")"
    # shellcheck disable=SC2016
    unshare --mount --pid --fork --kill-child sh -c '
            mount -t proc proc "$1/proc" && cd "$1" && shift &&
            pivot_root . mnt && umount -l /mnt && exec env -i "$@"' sh "$root" \
        HOME="$3" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
        ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        setpriv --reuid="$1" --regid="$1" --init-groups sh -c "cd && $2" </dev/null
}

# ---- the newcomer ----

failures=0
try() { # USER COMMAND, "what is printed when all is well"
    echo "# $1: $2"
    inside "$1" "cd iftty && $2" 2>&1 | tee -a "$log" "$said"
    grep -qE "$3" "$said" || { failures=$((failures + 1)); echo "# $1: $2: that failed"; }
    : >"$said"
}
visit() { # USER
    inside root "chown -R $1: /src" && inside "$1" "git clone -q /src iftty" || exit 1
    try "$1" "make demo" '^  # [0-9]+ verified, 0 failed'
    try "$1" "make test" '^[0-9]+ passed, 0 failed, [0-9]+ skipped$'
}

: >"$log"
: >"$said"
echo "# Debian $suite in $root"
make_root && share_network && mount_places ||
    { echo "bare.sh: the machine could not be made" >&2; exit 1; }
git clone -q --bare . "$root/src" && inside root "useradd -m somebody" || exit 1
visit root
visit somebody
grep 'stands in' "$log" && failures=$((failures + 1)) # the scene of the demo could not be installed
.ci/close "$log" || failures=$((failures + 1))
[ "$failures" = 0 ]
