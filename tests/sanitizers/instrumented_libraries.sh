#!/usr/bin/env bash
# Builds this Debian's TBB and Embree with the thread sanitizer, from Debian's source packages: without
# it every task would look like a race, for the sanitizer would not see how they hand memory over.
#
# Usage: tests/sanitizers/instrumented_libraries.sh FOLDER    where to build, and install, them

set -euo pipefail

folder=$1
onetbb=$(dpkg-query -W -f '${source:Version}' libtbb-dev)
embree=$(dpkg-query -W -f '${source:Version}' libembree-dev)

mkdir -p "$folder"/apt/{parts,lists/partial,cache/archives/partial}
cd "$folder"

# The sources that apt has, for source packages; nothing of the system is changed.
for list in /etc/apt/sources.list.d/*.sources; do
    [[ -f $list ]] && sed 's/^Types:.*/Types: deb-src/' "$list" >"apt/parts/${list##*/}"
done
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [[ -f $list ]] && sed -n 's/^deb /deb-src /p' "$list" >"apt/parts/${list##*/}"
done
apt=(apt-get -q -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$PWD/apt/parts"
    -o "Dir::State::Lists=$PWD/apt/lists" -o "Dir::Cache=$PWD/apt/cache" -o APT::Sandbox::User=root)

fetch() {
    local package=$1 version=$2
    rm -rf "$package" "$package"_* "$package.unpacked" &&
        "${apt[@]}" update &&
        "${apt[@]}" source --download-only --tar-only "$package=$version" &&
        mkdir "$package.unpacked" &&
        # Not all systems have an xz, which tar would want.
        cmake -E chdir "$package.unpacked" cmake -E tar xf "$PWD/$package"_*.orig.tar.* &&
        mv "$package.unpacked"/* "$package" &&
        touch "$package/readme.pdf"  # Embree installs it, and Debian left it out
}

# Configured by what follows the name and the version.
make_library() {
    local package=$1 version=$2
    shift 2
    [[ $(cat "$package.made-of" 2>/dev/null) == "$version" ]] && return
    fetch "$package" "$version" >"$package.log" 2>&1 || {
        cat "$package.log"
        echo "the source package $package $version cannot be fetched" >&2
        exit 1
    }
    {
        cmake -S "$package" -B "$package/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
            -DCMAKE_INSTALL_PREFIX="$PWD" -DCMAKE_INSTALL_LIBDIR=lib "$@" &&
            cmake --build "$package/build" &&
            cmake --install "$package/build"
    } >"$package.log" 2>&1 || {
        tail -40 "$package.log"
        exit 1
    }
    echo "$version" >"$package.made-of"
}

make_library onetbb "$onetbb" -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF \
    -DTBBMALLOC_BUILD=OFF

# As much of it as we use, for one instruction set.
without=()
for geometry in QUAD CURVE SUBDIVISION USER INSTANCE_ARRAY GRID POINT; do
    without+=("-DEMBREE_GEOMETRY_$geometry=OFF")
done
# It has flags of its own for every build type that it knows.
make_library embree "$embree" "${without[@]}" -DEMBREE_MAX_ISA=SSE2 -DEMBREE_ISPC_SUPPORT=OFF \
    -DEMBREE_TUTORIALS=OFF -DTBB_DIR="$PWD/lib/cmake/TBB" \
    -DEMBREE_IGNORE_CMAKE_CXX_FLAGS=OFF -DCMAKE_BUILD_TYPE=Sanitized \
    -DCMAKE_CXX_FLAGS="-fsanitize=thread -O1 -g1 -DNDEBUG" \
    -DCMAKE_SHARED_LINKER_FLAGS="-fsanitize=thread"
