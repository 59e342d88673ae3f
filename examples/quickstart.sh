#!/usr/bin/env bash
# Sets everything up, then renders the courtyard of 54,720 lights by uniform and by learned light
# sampling, 20 seconds each, and says where the report is.

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/core/tools/setup.sh"

output=$root/build/quickstart
"$root/build/venv/bin/lightcull" compare lanterns --samplers uniform,learned --seconds 20 \
    --reference-seconds 120 --size 320x240 --max-depth 2 -o "$output/"

echo "The report, to be opened in a browser: $output/index.html"
