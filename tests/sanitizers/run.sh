#!/usr/bin/env bash
# Builds the unit tests with a sanitizer, into build/asan or build/tsan, and runs them.
#
# Usage: tests/sanitizers/run.sh asan|tsan

set -euo pipefail

preset=${1:-}
case $preset in
    asan | tsan) ;;
    *)
        sed -n 's/^# Usage: /usage: /p' "$0" >&2
        exit 2
        ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")"
root=$(cd ../.. && pwd)
mkdir -p "$root/build"
if [[ $preset == tsan ]]; then
    ./instrumented_libraries.sh "$root/build/tsan-libraries"
fi

log=$root/build/$preset.log
{
    cmake --preset "$preset" && cmake --build --preset "$preset"
} >"$log" 2>&1 || {
    tail -40 "$log"
    exit 1
}
ctest --preset "$preset"
