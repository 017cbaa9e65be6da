# SPDX-License-Identifier: MIT
# A bare Debian 12, or another one by SUITE=trixie, to be tried out, for the tests that ask for one
# (bare.sh, packages.sh). Source it
# as root in a separate mount namespace (own_mounts): the mounts are invisible to other processes,
# and disappear with the last process of the namespace.
#
#     make_machine FOLDER PACKAGE,PACKAGE    make $root, a new system in the folder, with these
#                                            additional packages
#     inside USER COMMAND                    run a command there
#     clear_up                               remove it, unless KEEP is set
#
# Packages are downloaded from the sources of this machine.
suite=${SUITE:-bookworm}

# own_mounts SCRIPT ARGUMENT...: restart the script in its own mount namespace.
own_mounts() {
    [ "$(id -u)" = 0 ] || { echo "$1: debootstrap and mounting ask for root" >&2; exit 2; }
    [ -n "${IFTTY_BARE:-}" ] || IFTTY_BARE=yes exec unshare -m "$@"
}
clear_up() {
    [ -n "${root:-}" ] || return
    awk -v root="$root" '$2 == root || index($2, root "/") == 1 { print $2 }' /proc/mounts |
        sort -r | while read -r place; do umount -l "$place"; done
    # where something should still be mounted, nothing of it is removed
    [ -n "${KEEP:-}" ] || rm -rf --one-file-system "$root"
}

# The mirrors of this machine's own sources, in either way of writing them.
mirrors() {
    {
        sed -n 's/^deb \(\[[^]]*\] *\)\{0,1\}\([^ ]*\) .*/\2/p' \
            /etc/apt/sources.list /etc/apt/sources.list.d/*.list
        sed -n 's/^URIs: *//p' /etc/apt/sources.list.d/*.sources | tr ' ' '\n'
    } 2>/dev/null | awk 'length && !seen[$0]++'
}
make_root() { # PACKAGE,PACKAGE: from the first mirror that has the suite
    for mirror in $(mirrors); do
        rm -rf --one-file-system "$root"
        packages=$1
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
    unshare --mount --pid --fork --kill-child sh -c '
            mount -t proc proc "$1/proc" && cd "$1" && shift &&
            pivot_root . mnt && umount -l /mnt && exec env -i "$@"' sh "$root" \
        HOME="$3" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
        ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        setpriv --reuid="$1" --regid="$1" --init-groups sh -c "cd && $2" </dev/null
}
make_machine() { # FOLDER PACKAGE,PACKAGE
    bare=$1 root=$1/root
    echo "# Debian $suite in $root"
    make_root "$2" && share_network && mount_places ||
        { echo "the machine could not be made" >&2; exit 1; }
}

