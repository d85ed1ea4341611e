#!/usr/bin/env bash
# Installs what is missing, builds the programs and runs the main job on a synthetic capture that they generate.
# Usage: scripts/demo.sh [RUN_FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install.sh programs
cmake --preset release
cmake --build --preset release
exec build/release/bin/mocurate run -o "${1:-runs/demo}"
