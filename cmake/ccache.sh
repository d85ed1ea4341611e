#!/bin/sh
# Compiles through ccache so that another clone of the same sources hits: cmake/ccache.sh CCACHE SOURCES COMPILER ...
# Paths below SOURCES count as relative. A precompiled header differs between clones in the paths it holds: ccache takes
# a hash of its text and options instead, which lies beside it (pch_external_checksum).
ccache=$1 sources=$2
export CCACHE_BASEDIR="$sources" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=1
shift 2
case " $* " in
  *" -x c++-header "*) ;;
  *) exec "$ccache" "$@" ;;
esac
for word in "$@"; do
  [ "$last" != -o ] || output=$word
  last=$word
done
{ "$1" --version && echo "$*" | sed "s#$sources/##g" && "$@" -E -P -o -; } | sha256sum >"$output.sum" || exit
exec "$ccache" "$@"
