#!/bin/sh
# Compiles through ccache so that another clone of the same sources hits: cmake/ccache.sh CCACHE SOURCES COMPILER ...
# Paths below SOURCES count as relative. A precompiled header differs between clones in the paths it holds: ccache takes
# a hash of its text and options instead, which lies beside it (pch_external_checksum).
set -e
ccache=$1 sources=$2 last= output= skip=
export CCACHE_BASEDIR="$sources" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=1
shift 2
case " $* " in
  *" -x c++-header "*)
    for word in "$@"; do
      [ "$last" != -o ] || output=$word
      last=$word
    done
    (
      for word in "$@"; do  # without the options that name outputs
        shift
        case "$skip $word" in
          "skip "*) skip= ;;
          *" -o" | *" -MF" | *" -MT") skip=skip ;;
          *" -MD" | *" -c") ;;
          *) set -- "$@" "$word" ;;
        esac
      done
      "$@" -E -P -dD >"$output.sum.tmp"  # also definitions of macros
      { "$1" --version && echo "$*" | awk -v s="$sources" '{ while (i = index($0, s)) $0 = substr($0, 1, i - 1) substr($0, i + length(s)) } 1'; } >>"$output.sum.tmp"
    )
    sha256sum <"$output.sum.tmp" >"$output.sum"
    rm "$output.sum.tmp"
    ;;
esac
exec "$ccache" "$@"
