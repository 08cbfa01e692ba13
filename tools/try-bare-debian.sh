#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tries the README's commands where nothing is installed: a minimal Debian 12 in a temporary folder, with a
# clone of the last commit. Each command runs twice: first as root, then as a plain user without network,
# which must need no package. Needs root, debootstrap and this machine's Debian mirror.
#
# Usage: try-bare-debian.sh [COMMAND...]      default: './x demo' './x test'
# REFLECTREE_BARE_BASE=FOLDER keeps the untouched system there and starts from it the next time.
# REFLECTREE_DATA, if set, is shown to the commands read-only.
set -euo pipefail

if [[ ${1:-} == --help ]]; then
  sed -n '3,9s/^# \{0,1\}//p' "$0"
  exit
fi
((EUID == 0)) || { echo "try-bare-debian: must be root, to make a system of its own" >&2; exit 2; }
# Mounts live in a namespace of our own and vanish with it.
if [[ ${1:-} != --inside ]]; then exec unshare --mount --propagation private "$0" --inside "$@"; fi
shift
(($#)) || set -- './x demo' './x test'

home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scratch=$(mktemp -d)
root=$scratch/root
mkdir "$root"

unmount() { for folder in data dev/pts dev sys proc; do mountpoint -q "$root/$folder" && umount "$root/$folder"; done; true; }
tear_down() {
  unmount
  rm -rf --one-file-system "$scratch"
}
trap tear_down EXIT
trap 'exit 130' INT TERM

mirror=$(apt-cache policy | awk '/bookworm\/main/ && !/security/ {print $2; exit}')
base=${REFLECTREE_BARE_BASE:-$scratch/base}
if [[ ! -x $base/usr/bin/apt-get ]]; then
  echo "try-bare-debian: making a minimal system" >&2
  debootstrap --variant=minbase bookworm "$base" "${mirror:-http://deb.debian.org/debian}" >"$scratch/debootstrap.log" ||
    { tail "$scratch/debootstrap.log" >&2; exit 1; }
fi
cp -a "$base/." "$root"
# How this machine reaches its mirror; stays in the temporary folder.
apt-config dump | grep -E '^Acquire::https?::' >"$root/etc/apt/apt.conf.d/99machine" || true
cp /etc/resolv.conf /etc/hosts "$root/etc/"
git clone --quiet --no-hardlinks "$home" "$root/srv/reflectree"

mount -t proc proc "$root/proc"
mount -t sysfs -o ro sysfs "$root/sys"
mount --bind /dev "$root/dev"
mount -t devpts devpts "$root/dev/pts" 2>/dev/null || true
data=()
if [[ -n ${REFLECTREE_DATA:-} ]]; then
  mkdir "$root/data"
  mount --bind "$REFLECTREE_DATA" "$root/data"
  mount -o remount,bind,ro "$root/data"
  data=(REFLECTREE_DATA=/data)
fi

# try WHO USER:GROUP COMMAND [WRAPPER...]
try() {
  local who=$1 user=$2 command=$3 start=$SECONDS status=0
  shift 3
  echo "try-bare-debian: $command ($who)" >&2
  "$@" chroot --userspec="$user" "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 \
    "${data[@]}" /bin/sh -c "cd /srv/reflectree && $command" || status=$?
  echo "try-bare-debian: $command ($who) ended with $status after $((SECONDS - start)) s" >&2
  return "$status"
}

worst=0
for command in "$@"; do
  chown -R 0:0 "$root/srv/reflectree"
  try "bare, as root" 0:0 "$command" || worst=1
  chown -R 1000:1000 "$root/srv/reflectree"
  try "again, a plain user without network" 1000:1000 "$command" unshare --net || worst=1
done
exit "$worst"
