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
for part in stable experimental; do
  case $part in stable) list=capi/redman.symbols ;; *) list=capi/redman_experimental.symbols ;; esac
  grep '^rdm_' "$root/$list" | LC_ALL=C sort > "$work/$part.listed"
  # shellcheck disable=SC2046
  awk -v mode=$part -f "$root/tests/rules/header.awk" $(ls "$root"/include/redman/*.h | grep -v import) | LC_ALL=C sort > "$work/$part.declared"
  same "declared as $part in the headers (<) and listed in $list (>)" "$work/$part.declared" "$work/$part.listed"
done
# Each list is a version node of its own.
abi=$(sed -n 's/^#define RDM_ABI *\([0-9]*\).*/\1/p' "$root/include/redman/redman.h")
sed "s/$/@@REDMAN_$abi/" "$work/stable.listed" > "$work/nodes"
sed 's/$/@@REDMAN_EXPERIMENTAL/' "$work/experimental.listed" >> "$work/nodes"
LC_ALL=C sort "$work/nodes" > "$work/listed"
nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' | LC_ALL=C sort > "$work/exported"
same "exported (<) and listed (>)" "$work/exported" "$work/listed"
awk -v mode=stable -f "$root/tests/rules/header.awk" "$root/include/redman/redman_import.h" | LC_ALL=C sort > "$work/declared"
grep '^rdm_' "$root/capi/import/redman_import.symbols" | LC_ALL=C sort > "$work/listed"
same "declared in redman_import.h (<) and listed in capi/import/redman_import.symbols (>)" "$work/declared" "$work/listed"
if [ -n "$import" ]; then
  sed -i 's/$/@@REDMAN_IMPORT_EXPERIMENTAL/' "$work/listed"
  nm -D --defined-only "$import" | awk '$2 != "A" { print $3 }' | LC_ALL=C sort > "$work/exported"
  same "exported by redman_import (<) and listed (>)" "$work/exported" "$work/listed"
fi
exit $status
