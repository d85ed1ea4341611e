#!/bin/bash
# Runs every table and figure of the papers in profile smoke, in minutes, and prints a table of the exit codes.
#
#   scripts/reproduce_smoke.sh [FOLDER] [ID...]        default: build/reproduce_smoke, all items
#
# The program is build/test/bin/mocurate, or $MOCURATE. Networks of the same options are trained once: items share the
# cache (MOCURATE_CACHE, default FOLDER/cache).
set -u
cd "$(dirname "$0")/.."
program=${MOCURATE:-build/test/bin/mocurate}
folder=${1:-build/reproduce_smoke}
shift || true
mkdir -p "$folder"
export MOCURATE_CACHE=${MOCURATE_CACHE:-$(realpath "$folder")/cache}
ids=("$@")
if [ ${#ids[@]} -eq 0 ]; then
  mapfile -t ids < <("$program" reproduce list --json |
    python3 -c 'import json, sys; [print(i["id"]) for i in json.load(sys.stdin) if i["kind"] != "diagram"]')
fi
failed=0
printf '%-20s %8s %8s  %s\n' item exit seconds "tables and pictures"
for id in "${ids[@]}"; do
  place=$folder/${id//\//_}
  begun=$(date +%s)
  "$program" reproduce "$id" --profile smoke -o "$place" --json > "$place.json" 2> "$place.log"
  code=$?
  [ $code -eq 0 ] || failed=$((failed + 1))
  made=$(cd "$place" 2> /dev/null && ls tables/"${id#*/}".md pictures/* survey/*/survey.html 2> /dev/null | tr '\n' ' ')
  printf '%-20s %8s %8s  %s\n' "$id" $code $(($(date +%s) - begun)) "$made"
  [ $code -eq 0 ] || tail -n 2 "$place.log"
done
exit $((failed > 0))
