#!/usr/bin/env bash
# Builds the TBB of this Debian with the thread sanitizer, from Debian's source package: without it
# every task would look like a race, for the sanitizer would not see how TBB hands it over.
#
# Usage: tests/sanitizers/instrumented_tbb.sh FOLDER    where to build, and install, it

set -euo pipefail

folder=$1
version=$(dpkg-query -W -f '${source:Version}' libtbb-dev)
[[ $(cat "$folder/made-of" 2>/dev/null) == "$version" ]] && exit 0

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
{
    "${apt[@]}" update
    rm -f onetbb_*
    "${apt[@]}" source --download-only "onetbb=$version"
} >fetch.log 2>&1 || {
    cat fetch.log
    echo "the source package onetbb $version cannot be fetched" >&2
    exit 1
}

rm -rf source
mkdir source
tar xf onetbb_*.orig.tar.* -C source --strip-components=1
{
    cmake -S source -B build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread \
        -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF -DCMAKE_INSTALL_PREFIX="$PWD"
    cmake --build build
    cmake --install build
} >build.log 2>&1 || {
    tail -40 build.log
    exit 1
}
echo "$version" >made-of
