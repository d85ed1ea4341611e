#!/bin/sh
# Runs a test program and prints what did not pass. Exits 77 when nothing failed and a case was skipped; the file
# MOCURATE_SKIPPED, if set, then lists it. Usage: run_whole.sh PROGRAM [arguments]
output=$(mktemp)
trap 'rm -f "$output" "$output.status"' EXIT
# Without the two lines of a case that passed, and as it comes: the last one that begins is where a program crashed or
# hung.
{ "$@" 2>&1; echo $? >"$output.status"; } | tee "$output" |
  sed -u -e '/^\[ RUN /{N;/\n\[       OK /d}' -e '/^\[-*\]/d' -e '/^Note: Google Test filter/d' -e '/^$/d'
status=$(cat "$output.status")
[ -n "${MOCURATE_SKIPPED:-}" ] && sed -n 's/^\[  SKIPPED \] \([^ ]*\) (.*/\1/p' "$output" >>"$MOCURATE_SKIPPED"
[ "$status" -ne 0 ] && exit "$status"
grep -q '\[  SKIPPED \]' "$output" && exit 77
exit 0
