#!/usr/bin/env bash
# Builds hostile files in a temporary folder and runs mocurate on each under limits of memory and time (docs/security.md).
# Usage: scripts/hostile.sh [--program FILE] [--only PATTERN] [--list] [--keep DIR] ...   (--help shows all)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
python=/usr/bin/python3  # Debian's, with its h5py and numpy
if ! "$python" -c 'import h5py, numpy' 2>/dev/null; then
  echo "hostile.sh: $python lacks h5py or numpy; install them with: scripts/install.sh tests" >&2
  exit 4
fi
exec "$python" -B "$here/hostile/cases.py" "$@"
