#!/usr/bin/env bash
# Sets everything up and runs every test. The exit status is 0 if all of them pass. Only the thread
# sanitizer, which has to build TBB and Embree first, has to be asked for: tests/sanitizers/run.sh tsan

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/core/tools/setup.sh" --tests

failed=()
run() {
    local name=$1
    shift
    echo "== $name"
    "$@" || failed+=("$name")
}

# Two at a time: many of them keep all processors busy by themselves, but not all the time.
run ctest ctest --test-dir "$root/build" --output-on-failure --parallel 2
# The tests of a file stay in one process: they share what is slow to make, and folders to build in.
run pytest "$root/build/venv/bin/python" -m pytest -o cache_dir="$root/build/pytest-cache" \
    --numprocesses 2 --dist loadfile \
    "$root/tests/python" "$root/tests/hard_cases" "$root/tests/hosts" "$root/tests/packaging"
run asan "$root/tests/sanitizers/run.sh" asan
run fuzz "$root/tests/fuzz/run.sh" "$root/build/fuzz" "$root/build/venv/bin/python"

if ((${#failed[@]})); then
    echo "== failed: ${failed[*]}"
    exit 1
fi
echo "== all tests passed"
