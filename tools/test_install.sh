#!/bin/bash
# Usage: tools/test_install.sh [SUITE]   Installs build/recon_gcs-*.whl in a fresh Debian (default: trixie) with
# Python alone and without any network, as a user without rights; flies the demonstration and a survey, scores
# a seed, and removes it: nothing may be left but its state folder. Prints how long each part takes.
set -euo pipefail
cd "$(dirname "$0")/.."
suite="${1:-trixie}"

if [ "$(id -u)" != 0 ]; then
    echo "recon: chroot into a fresh Debian needs root: sudo make test-install" >&2
    exit 1
fi
command -v mmdebstrap >/dev/null || { apt-get update -qq && apt-get install -y -qq mmdebstrap >/dev/null; }

root="$(mktemp -d)"
trap 'rm -rf --one-file-system "$root"' EXIT
archive="build/debian-$suite.tar"
if [ ! -e "$archive" ]; then
    # A mirror's old snapshot of a suite is as good.
    mmdebstrap --quiet --variant=apt --aptopt='Acquire::Check-Valid-Until "false"' \
        --include=python3,python3-pip,python3-venv "$suite" "$archive.part"
    mv "$archive.part" "$archive"
fi
tar --extract --file "$archive" --directory "$root"
for tool in cargo rustc node npm gcc; do
    [ ! -e "$root/usr/bin/$tool" ] || { echo "recon: the fresh Debian has $tool" >&2; exit 1; }
done
python="$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')"
uv run --locked --quiet python -m tools.packages_at_hand "$python" "build/packages-$python"
mkdir "$root/packages"
cp "build/packages-$python"/* build/recon_gcs-*-manylinux*.whl tools/try_install.py "$root/packages"
echo "field:x:1000:1000::/home/field:/bin/sh" >>"$root/etc/passwd"
install -d -o 1000 -g 1000 "$root/home/field"
echo "Debian $suite, Python $python, $(du -sm "build/packages-$python" | cut -f 1) MB of packages"

listed() { (cd "$root" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./sys \) -prune -o -print | sort); }
listed >"$root.before"
trap 'rm -rf --one-file-system "$root" "$root.before"' EXIT

cat >"$root/packages/try.sh" <<'END'
set -eu
cd
export BEGAN="$(date +%s.%N)"
python3 -m venv recon
recon/bin/pip install --quiet --no-index --find-links /packages /packages/recon_gcs-*.whl
python3 /packages/try_install.py recon/bin --flight
recon/bin/pip uninstall --quiet --yes recon-gcs
left="$(find recon -ipath '*recon/*recon*')"
[ -z "$left" ] || { echo "recon: left after pip uninstall: $left" >&2; exit 1; }
rm -r recon
END
export root
# Processes, mounts and network of their own, which end with this script; only loopback.
unshare --mount --pid --fork --kill-child --net bash -euc '
    mount -t proc proc "$root/proc"
    mount -t tmpfs shm "$root/dev/shm"
    ip link set lo up
    exec chroot --userspec=1000:1000 "$root" env -i HOME=/home/field PATH=/usr/bin:/bin sh /packages/try.sh'

left="$(listed | comm -13 "$root.before" - | grep -v -x -e ./packages/try.sh -e ./home/field/.local \
    -e ./home/field/.local/state -e './home/field/.local/state/recon\(/.*\)\?' || true)"
[ -z "$left" ] || { echo "recon: left outside its state folder: $left" >&2; exit 1; }
echo "removed: nothing is left but its state folder"
