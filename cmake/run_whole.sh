#!/bin/sh
# Runs a test program; exits 77 when it passed but skipped a case. Usage: run_whole.sh PROGRAM [arguments]
output=$(mktemp)
trap 'rm -f "$output"' EXIT
"$@" >"$output" 2>&1
status=$?
cat "$output"
[ $status -ne 0 ] && exit $status
grep -q '\[  SKIPPED \]' "$output" && exit 77
exit 0
