#!/bin/sh
# What the header declares, what the checked-in lists name and what the shared library exports, each list as a
# version node of its own, are the same; so of redman_import. Arguments: the project's root, the shared library, and
# that of the importers where it was built.
set -u
root=$1 library=$2 import=${3:-}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
status=0
same() { # same WHAT A B
  diff "$2" "$3" > "$work/diff" || { echo "$1:"; grep '^[<>]' "$work/diff"; status=1; }
}
number() { sed -n "s/^#define RDM_$1 *\([0-9]*\).*/\1/p" "$root/include/redman/base.h"; }
minor=$(number VERSION_MAJOR)_$(number VERSION_MINOR)
# A list a version node; what a release adds to the stable half has a list of its own.
: > "$work/nodes"
for list in redman redman_old redman_1.0 redman_experimental; do
  case $list in
    redman | redman_old) part=stable node=REDMAN_$(number ABI) ;;
    redman_experimental) part=experimental node=REDMAN_EXPERIMENTAL_$minor ;;
    *) part=stable node=REDMAN_${list#redman_} ;;
  esac
  # what has another name now is in no header but deprecated.h
  [ $list = redman_old ] || grep '^rdm_' "$root/capi/$list.symbols" >> "$work/$part.names"
  sed -n "s/^\(rdm_.*\)/\1@@$node/p" "$root/capi/$list.symbols" >> "$work/nodes"
done
LC_ALL=C sort "$work/nodes" > "$work/listed"
for part in stable experimental; do
  LC_ALL=C sort "$work/$part.names" > "$work/$part.listed"
  # shellcheck disable=SC2046
  awk -v mode=$part -f "$root/tests/rules/header.awk" $(sh "$root/cmake/headers.sh" "$root/include" $part) | LC_ALL=C sort > "$work/$part.declared"
  same "declared as $part in the headers (<) and listed in capi/*.symbols (>)" "$work/$part.declared" "$work/$part.listed"
done
nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' | LC_ALL=C sort > "$work/exported"
same "exported (<) and listed (>)" "$work/exported" "$work/listed"
awk -v mode=experimental -f "$root/tests/rules/header.awk" "$root/include/redman/import.h" | LC_ALL=C sort > "$work/declared"
grep '^rdm_' "$root/capi/import/redman_import.symbols" | LC_ALL=C sort > "$work/listed"
same "declared in import.h (<) and listed in capi/import/redman_import.symbols (>)" "$work/declared" "$work/listed"
if [ -n "$import" ]; then
  sed -i 's/$/@@REDMAN_IMPORT_EXPERIMENTAL_'"$minor"'/' "$work/listed"
  nm -D --defined-only "$import" | awk '$2 != "A" { print $3 }' | LC_ALL=C sort > "$work/exported"
  same "exported by redman_import (<) and listed (>)" "$work/exported" "$work/listed"
fi
exit $status
