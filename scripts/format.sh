#!/usr/bin/env bash
# Formats every source file and writes docs/fitting_constants.md; with --check it only lists what differs.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v clang-format >/dev/null || scripts/install.sh develop
mode=(-i)
[ "${1:-}" = "--check" ] && mode=(--dry-run -Werror)
git ls-files -co --exclude-standard '*.h' '*.cpp' | xargs -r clang-format "${mode[@]}"
scripts/fitting_constants.py ${1:+"$1"}
