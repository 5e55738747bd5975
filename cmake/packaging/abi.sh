#!/bin/sh
# abi.sh dump INCLUDE CC OUT: what a binary built against the stable headers in INCLUDE/redman relies on, as libabigail
# writes it: capi/abi/redman-<release>.abi of each release. The functions are empty, their types are the header's.
# abi.sh check ROOT CC: the header against the last release's dump. A stable function or type that is gone or changed fails
# while RDM_ABI is that release's; new functions, and members at the ends of sized structs, pass.
set -eu
awk=$(dirname "$0")/abi.awk headers=$(dirname "$0")/../headers.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

number() { sed -n "s/^#define $2 \([0-9]*\).*/\1/p" "$1/redman/base.h"; }
stable() { sh "$headers" "$1" stable; ls "$1"/redman/deprecated.h 2> /dev/null; }

# library INCLUDE CC OUT
library() {
  # shellcheck disable=SC2046
  awk -v mode=functions -f "$awk" $(stable "$1") > "$work/functions.c"
  "$2" -std=c99 -g -O0 -fPIC -shared -nostdlib -I"$1" -Wl,-soname,"libredman.so.$(number "$1" RDM_ABI)" "$work/functions.c" -o "$3"
}

case $1 in
  dump)
    library "$2" "$3" "$work/functions.so"
    abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --short-locs "$work/functions.so" > "$4"
    ;;
  check)
    root=$2
    last=$(ls "$root"/capi/abi/redman-*.abi | sort -V | tail -n1)
    library "$root/include" "$3" "$work/functions.so"
    # shellcheck disable=SC2046
    awk -v mode=allowed -f "$awk" $(stable "$root/include") > "$work/allowed"
    status=0
    abidiff --no-added-syms --suppressions "$work/allowed" "$last" "$work/functions.so" > "$work/report" || status=$?
    grep -v '^$' "$work/report" || true
    if ! grep -q "soname='libredman.so.$(number "$root/include" RDM_ABI)'" "$last"; then
      echo "RDM_ABI moved since $(basename "$last"): changes are allowed, and the next release needs a dump of its own"
      exit 0
    fi
    if [ $status -ne 0 ]; then
      echo "the stable headers differ from $(basename "$last") in what old binaries rely on: keep it, or move RDM_ABI"
      exit 1
    fi
    ;;
esac
