#!/usr/bin/env bash
# Proves that the two README commands work on a bare Debian 12: debootstraps one into FOLDER, copies what is committed
# here into it, runs the commands inside, and keeps everything that was printed in TRANSCRIPT. By hand, as root.
#   tests/bare_debian.sh FOLDER [TRANSCRIPT]     (default: FOLDER.log)
# BRINK_FIRST is the first command; MIRROR is where packages come from.
set -euo pipefail
folder=${1:?usage: tests/bare_debian.sh FOLDER [TRANSCRIPT]}
transcript=$(readlink -f "${2:-$folder.log}")
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
mirror=${MIRROR:-http://deb.debian.org/debian}
first=${BRINK_FIRST:-$(grep -m1 -oE '^ *\./brink run [^ ]+\.toml' "$root/README.md" | sed 's/^ *//')}

command -v debootstrap >/dev/null || { echo "debootstrap is needed" >&2; exit 3; }
[ "$(id -u)" = 0 ] || { echo "debootstrap and chroot need root" >&2; exit 3; }

inside() { chroot "$folder" /usr/bin/env -i HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} bash -c "$1"; }

let_go() { umount "$folder/proc" 2>/dev/null || true; }

{
  date -u
  echo "commit $(git -C "$root" rev-parse HEAD)"
  [ -e "$folder/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$folder" "$mirror"
  # inside, packages come from where they come from here, if this machine has a place of its own
  for conf in /etc/apt/apt.conf.d/*proxy* /etc/resolv.conf; do [ ! -e "$conf" ] || cp -L "$conf" "$folder$conf"; done
  rm -rf "$folder/srv/brink"
  mkdir -p "$folder/srv/brink"
  git -C "$root" archive HEAD | tar -x -C "$folder/srv/brink"
  mount -t proc proc "$folder/proc" 2>/dev/null || true
  trap let_go EXIT
  echo "== cat /etc/debian_version; dpkg -l | wc -l"
  inside 'cat /etc/debian_version; dpkg -l | wc -l'
  for command in "$first" './brink test'; do
    echo "== $command"
    start=$(date +%s)
    status=0
    inside "cd /srv/brink && $command" || status=$?
    echo "== exit status $status after $(($(date +%s) - start)) s"
    [ "$status" = 0 ] || exit "$status"
  done
} 2>&1 | tee "$transcript"
