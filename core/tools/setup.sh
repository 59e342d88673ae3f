#!/usr/bin/env bash
# Brings a Debian 12 or 13, however bare, to where lightcull runs: Debian packages, a Python
# environment in build/venv, the C++ libraries in build/, the Python package and the command
# `lightcull`. What is there already is neither installed nor built again.
#
# Usage: core/tools/setup.sh [--tests | --wheels]
#   --tests   also what the tests need
#   --wheels  also what core/tools/wheels.sh needs; --tests has it, too

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$root/build
venv=$build/venv

packages=(
    ca-certificates cmake g++ ninja-build pkgconf python3 python3-dev python3-venv
    libembree-dev libhwy-dev libimath-dev libopencolorio-dev libopenimageio-dev libtbb-dev
    libtinyobjloader-dev
    glslc libvulkan-dev
)
requirement_groups=(build run)
with_tests=OFF
if [[ ${1:-} == --tests || ${1:-} == --wheels ]]; then
    packages+=(libfmt-dev)
    requirement_groups+=(mitsuba wheel)
fi
if [[ ${1:-} == --tests ]]; then
    with_tests=ON
    packages+=(doctest-dev libbenchmark-dev)
    # A Vulkan device without a GPU, and what checks the use of it.
    packages+=(mesa-vulkan-drivers vulkan-validationlayers libspirv-cross-c-shared-dev)
    requirement_groups+=(cluster test usd)
fi

# What could be neither found nor installed; named once it was missed, and again if that is fatal.
missing=()

say() { printf '== %s\n' "$*" >&2; }

on_exit() {
    local status=$?
    if ((status != 0)); then
        say "the set-up has failed${missing[*]:+; missing here: ${missing[*]}}"
    fi
}
trap on_exit EXIT

# ---- Debian packages -----------------------------------------------------------------------------

packages_not_installed() {
    local package
    for package in "${packages[@]}"; do
        [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
            echo "$package"
    done
}

install_packages() {
    local wanted reason="see $build/packages.log"
    mapfile -t wanted < <(packages_not_installed)
    ((${#wanted[@]})) || return 0
    say "installing Debian packages (300 MB on a bare system): ${wanted[*]}"
    local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300)
    ((EUID == 0)) || apt=(sudo "${apt[@]}")
    mkdir -p "$build"
    if ! command -v "${apt[0]}" >/dev/null; then
        reason="neither root nor sudo"
    elif "${apt[@]}" update >"$build/packages.log" 2>&1; then
        "${apt[@]}" install --no-install-recommends "${wanted[@]}" >>"$build/packages.log" 2>&1 ||
            true
    fi
    mapfile -t wanted < <(packages_not_installed)
    ((${#wanted[@]})) || return 0
    missing+=("${wanted[@]}")
    say "going on without these Debian packages, which could not be installed" \
        "($reason): ${wanted[*]}"
}

# ---- Python packages -----------------------------------------------------------------------------

make_venv() {
    local stamp
    stamp="$venv $(/usr/bin/python3 --version)"
    [[ $(cat "$venv/made-for" 2>/dev/null) == "$stamp" ]] && return
    say "making the Python environment"
    /usr/bin/python3 -m venv --clear "$venv"
    echo "$stamp" >"$venv/made-for"
}

# The requirements of the groups, one a line, from where they are written down.
requirements() {
    "$venv/bin/python" - "$root/bindings/pyproject.toml" "$@" <<'PYTHON'
import sys, tomllib

with open(sys.argv[1], "rb") as file:
    table = tomllib.load(file)
project = table["project"]
groups = {
    "build": table["build-system"]["requires"],
    "run": project["dependencies"],
    **project["optional-dependencies"],
}
for name in sys.argv[2:]:
    print("\n".join(groups[name]))
PYTHON
}

# Of the requirements on standard input, those that are not met.
unmet() {
    "$venv/bin/python" -c '
import sys
from importlib.metadata import PackageNotFoundError, version
from pip._vendor.packaging.requirements import Requirement

for line in sys.stdin.read().splitlines():
    wanted = Requirement(line)
    try:
        if wanted.specifier.contains(version(wanted.name)):
            continue
    except PackageNotFoundError:
        pass
    print(line)
'
}

install_requirements() {
    local wanted
    mapfile -t wanted < <(requirements "${requirement_groups[@]}" | unmet)
    ((${#wanted[@]})) || return 0
    say "installing Python packages: ${wanted[*]}"
    "$venv/bin/pip" install --quiet --disable-pip-version-check "${wanted[@]}" >&2 && return
    mapfile -t wanted < <(printf '%s\n' "${wanted[@]}" | unmet)
    ((${#wanted[@]})) || return 0
    missing+=("${wanted[@]}")
    say "going on without these Python packages, which could not be installed: ${wanted[*]}"
}

# ---- the C++ libraries ---------------------------------------------------------------------------

# As many as there are processors, with 1.5 GB of memory for each.
job_count() {
    local processors memory
    processors=$(nproc)
    memory=$(awk '/^MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
    ((memory < 1)) && memory=1
    echo $((processors < memory ? processors : memory))
}

cached() { sed -n "s|^$1:[A-Z]*=||p" "$build/CMakeCache.txt" 2>/dev/null || true; }

configure() {
    # A tree that has been moved, or configured for another tool, is configured from scratch.
    local fresh=()
    [[ $(cached CMAKE_HOME_DIRECTORY) == "$root" && $(cached CMAKE_GENERATOR) == Ninja ]] ||
        fresh=(--fresh)
    # Once the tests have been asked for, they stay.
    if [[ -f $build/build.ninja && -z ${fresh[*]} ]] &&
        [[ $(cached LIGHTCULL_TESTS) == ON || $with_tests == OFF ]]; then
        return
    fi
    say "configuring"
    cmake "${fresh[@]}" -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
        -DLIGHTCULL_TESTS="$with_tests" >&2
}

build_libraries() {
    configure
    local target=core/all
    [[ $with_tests == OFF ]] || target=all
    say "building the C++ libraries"
    cmake --build "$build" --target "$target" --parallel "$(job_count)" >&2
}

# ---- the Python package --------------------------------------------------------------------------

# Of everything that the Python package is made from.
package_hash() {
    {
        find "$root/bindings" "$root/plugin" "$root/core/include" "$build/core" -type f \
            -not -path '*/__pycache__/*' \( -not -path "$build/*" -o -name '*.a' \) -print0 |
            LC_ALL=C sort -z | xargs -0 sha256sum
        "$venv/bin/python" "$root/plugin/mitsuba/find_mitsuba.py"
    } | sha256sum
}

install_package() {
    local hash
    hash=$(package_hash)
    [[ $(cat "$venv/package-hash" 2>/dev/null) == "$hash" ]] && return
    say "building and installing the Python package"
    CMAKE_BUILD_PARALLEL_LEVEL=$(job_count) \
        "$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
        --config-settings=build-dir="$build/bindings" \
        --config-settings=cmake.define.lightcull_DIR="$build" \
        --config-settings=cmake.define.LIGHTCULL_OPENIMAGEIO= \
        --config-settings=cmake.define.LIGHTCULL_WERROR=ON "$root/bindings" >&2
    echo "$hash" >"$venv/package-hash"
}

install_packages
make_venv
install_requirements
build_libraries
install_package
say "set up"
