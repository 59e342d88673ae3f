#!/usr/bin/env bash
# Installs a wheel by pip alone into a new Debian that has Python, pip and nothing else, in a chroot,
# and renders there. For root; needs debootstrap and the package registries. Not part of tests/run.sh:
# it fetches 400 MB. Its time is that of the network.
#
# Usage: tests/packaging/bare_system.sh WHEEL [SUITE]
#   WHEEL  as core/tools/wheels.sh has built it
#   SUITE  of Debian, with the Python and a glibc that the wheel is for; default: bookworm

set -euo pipefail

wheel=$(realpath "$1")
suite=${2:-bookworm}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
system=$(mktemp -d)
trap 'umount -q "$system/proc" || true; rm -rf --one-file-system "$system"' EXIT

debootstrap --variant=minbase --include=ca-certificates,python3,python3-pip,python3-venv \
    "$suite" "$system" >"$system.log" || {
    tail "$system.log"
    exit 1
}
mount -t proc proc "$system/proc"  # of /proc/self/maps
for settings in /etc/resolv.conf /etc/pip.conf /etc/ssl/certs/ca-certificates.crt; do
    [[ -e $settings ]] && install -D --mode=644 "$settings" "$system$settings"
done
mkdir "$system/wheel"
cp "$wheel" "$here/installed_render.py" "$system/wheel/"

# Without the folders of this system that the environment names.
inside() {
    chroot "$system" /usr/bin/env -u LD_LIBRARY_PATH -u PYTHONPATH -u PIP_FIND_LINKS \
        PATH=/usr/bin:/bin HOME=/root "$@"
}

compilers=$(inside sh -c 'command -v cc gcc g++ clang cmake || true')
[[ -z $compilers ]] || {
    echo "this is no bare system: $compilers" >&2
    exit 1
}
inside python3 -m venv /venv
inside /venv/bin/pip install --quiet "/wheel/$(basename "$wheel")[mitsuba,llvm]"
inside /venv/bin/python /wheel/installed_render.py /wheel llvm_ad_rgb >/dev/null
inside /venv/bin/python /wheel/installed_render.py /wheel scalar_rgb >"$system.loaded"
inside /venv/bin/lightcull info cornell
echo "installed and rendered on $suite; the libraries loaded from outside of Python's packages:"
grep -v site-packages "$system.loaded" | grep -v /lib-dynload/
rm "$system.log" "$system.loaded"
