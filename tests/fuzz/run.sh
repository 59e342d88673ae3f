#!/usr/bin/env bash
# Builds the fuzz targets and runs each on so many inputs that grow out of the corpus in the
# repository, the same ones each time. What breaks one is written into BUILD/found; once it is
# mended, add it to the corpus.
#
# Usage: tests/fuzz/run.sh BUILD PYTHON    a folder to build in; the Python that has the package

set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1 python=$2
clang=$(command -v clang++-14 || command -v clang++) || {
    echo "fuzz targets: left out, there is no clang++"
    exit 0
}

log=$build/build.log
mkdir -p "$build/found"
{
    cmake -S "$here" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER="$clang" -DPython_EXECUTABLE="$python"
    cmake --build "$build"
} >"$log" 2>&1 || {
    cat "$log"
    exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# NAME INPUTS TARGET: what is found on the way stays out of the corpus.
fuzz() {
    local name=$1 inputs=$2 target=$3
    mkdir "$work/$name"
    if ! "$build/$target" -runs="$inputs" -max_len=4096 -seed=1 -print_final_stats=1 \
        -artifact_prefix="$build/found/$name-" "$work/$name" "$here/corpus/$name" \
        >"$work/$name.log" 2>&1; then
        tail -40 "$work/$name.log"
        echo "fuzz $name: failed"
        return 1
    fi
    sed -n "s/^stat::number_of_executed_units: */fuzz $name: inputs tried: /p" "$work/$name.log"
}

export PYTHONPATH=$here PYTHONDONTWRITEBYTECODE=1 TMPDIR=$work
PYTHONPATH+=:$("$python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')
# All at once: each keeps one processor busy.
fuzz sampler 3000 fuzz_sampler &
running=($!)
for ending in glb gltf obj ply; do
    FUZZ_ENDING=.$ending fuzz "$ending" 3000 fuzz_loader &
    running+=($!)
done
failed=0
for one in "${running[@]}"; do
    wait "$one" || failed=1
done
exit "$failed"
