#!/usr/bin/env bash
# Builds wheels of the Python package for machines without a compiler: with all libraries in them but
# glibc, libstdc++, zlib and expat, and with the plugin for Mitsuba, which finds the libraries of the
# installed Mitsuba. A wheel runs on systems whose glibc is as new as that of this one. Says of each
# how large it is and how long it takes to import.
#
# Usage: core/tools/wheels.sh [PYTHON...]    the interpreters; default: the one of build/venv
#
# The wheels are put into build/wheels.

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tools=$root/core/tools
build=$root/build
venv=$build/venv
wheels=$build/wheels
work=$wheels/work
openimageio=$work/openimageio
openimageio_version=3.2.2.0

say() { printf '== %s\n' "$*" >&2; }

pip() { "$1" -m pip --quiet --disable-pip-version-check "${@:2}"; }

# The library from its wheel on PyPI, which needs nothing but zlib, and the headers to compile with,
# which that wheel lacks, from the sources of the same version.
get_openimageio() {
    [[ $(cat "$openimageio/version" 2>/dev/null) == "$openimageio_version" ]] && return
    say "fetching OpenImageIO $openimageio_version"
    local fresh=$openimageio.fresh wanted=openimageio==$openimageio_version
    rm -rf "$fresh" "$openimageio"
    mkdir -p "$fresh"/{wheel,sources,include,lib}
    pip "$venv/bin/python" download --no-deps --only-binary :all: --dest "$fresh" "$wanted"
    pip "$venv/bin/python" download --no-deps --no-binary :all: --no-build-isolation \
        --dest "$fresh" "$wanted"
    "$venv/bin/python" -m zipfile --extract "$fresh"/*.whl "$fresh/wheel"
    "$venv/bin/python" -m tarfile --extract "$fresh"/*.tar.gz "$fresh/sources"
    mv "$fresh"/sources/*/src/include/OpenImageIO "$fresh/include/"
    mv "$fresh"/wheel/*.dist-info/licenses "$fresh/licenses"
    local library
    for library in OpenImageIO OpenImageIO_Util; do
        mv "$fresh/wheel/OpenImageIO/lib/lib$library".so.* "$fresh/lib/"
        ln -s "$(basename "$fresh/lib/lib$library".so.*)" "$fresh/lib/lib$library.so"
    done
    rm -r "$fresh"/{*.whl,*.tar.gz,wheel,sources}
    echo "$openimageio_version" >"$fresh/version"
    mv "$fresh" "$openimageio"
}

# An environment of the interpreter with what the package is built with and needs to be imported.
# That of build/venv is one.
environment() {
    local python=$1 tag=$2
    if [[ $python == "$venv/bin/python" ]]; then
        echo "$venv"
        return
    fi
    local folder=$work/$tag/venv
    say "making a Python environment for $python"
    "$python" -m venv --clear "$folder"
    local wanted
    mapfile -t wanted < <("$venv/bin/python" -c '
import sys, tomllib
table = tomllib.load(open(sys.argv[1], "rb"))
extra = table["project"]["optional-dependencies"]["mitsuba"]
print(*table["build-system"]["requires"], *table["project"]["dependencies"], *extra, sep="\n")
' "$root/bindings/pyproject.toml")
    pip "$folder/bin/python" install "${wanted[@]}" >&2
    echo "$folder"
}

build_wheel() {
    local python=$1 to=$2 objects=$3
    CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)} \
        pip "$python" wheel --no-deps --no-build-isolation --wheel-dir "$to" \
        --config-settings=build-dir="$objects" \
        --config-settings=cmake.define.lightcull_DIR="$build" \
        --config-settings=cmake.define.LIGHTCULL_OPENIMAGEIO="$openimageio" \
        --config-settings=cmake.define.LIGHTCULL_WERROR=ON "$root/bindings"
}

# Copies into the wheel what its libraries need. The plugin must get the very libraries that the
# process has loaded from the packages mitsuba and drjit, not copies.
repair() {
    local wheel=$1 to=$2 library
    local theirs=()
    for library in libmitsuba libdrjit-core libdrjit-extra libnanothread; do
        theirs+=(--exclude "$library.so")
    done
    PATH=$venv/bin:$PATH LD_LIBRARY_PATH=$openimageio/lib \
        "$venv/bin/auditwheel" repair "${theirs[@]}" --wheel-dir "$to" "$wheel" >/dev/null
}

# The wheel of Dr.Jit needs libatomic, which systems without a compiler may lack; lightcull.mitsuba
# loads this one before, by the name that Dr.Jit knows it by.
add_libatomic() {
    local library
    library=$(gcc --print-file-name=libatomic.so.1)
    cp --dereference "$library" "$1/lightcull.libs/"
}

add_what_auditwheel_does_not() {
    local wheel=$1 unpacked=$2
    "$venv/bin/wheel" unpack --dest "$unpacked" "$wheel" >/dev/null
    add_libatomic "$unpacked"/*
    "$venv/bin/python" "$tools/bundled_licences.py" "$unpacked"/* "$openimageio/licenses"
    "$venv/bin/wheel" pack --dest-dir "$wheels" "$unpacked"/* >/dev/null
}

make_wheel() {
    local python=$1 tag folder objects
    tag=$("$python" -c 'import sys; print(sys.implementation.cache_tag)')
    # Of the environment that setup.sh made, the objects are there already.
    objects=$work/$tag/objects
    [[ $python == "$venv/bin/python" ]] && objects=$build/bindings
    folder=$(environment "$python" "$tag")
    rm -rf "$work/$tag"/{built,repaired,unpacked}
    mkdir -p "$work/$tag"/{built,repaired,unpacked}
    say "building the wheel for $tag"
    build_wheel "$folder/bin/python" "$work/$tag/built" "$objects"
    repair "$work/$tag"/built/*.whl "$work/$tag/repaired"
    add_what_auditwheel_does_not "$work/$tag"/repaired/*.whl "$work/$tag/unpacked"
    "$folder/bin/python" "$tools/wheel_facts.py" "$wheels/$(basename "$work/$tag"/repaired/*.whl)"
}

(($#)) || set -- "$venv/bin/python"
"$tools/setup.sh" --wheels
get_openimageio
for python in "$@"; do
    make_wheel "$python"
done
