#!/bin/sh
# abi.sh ROOT CC: the header keeps what the last release promised to binaries; and the check itself finds each kind of break
# and lets what is promised pass.
set -u
root=$1 cc=$2
for program in abidw abidiff; do
  command -v $program > /dev/null || { echo "no $program here (Debian: abigail-tools)"; exit 77; }
done
check=$root/cmake/packaging/abi.sh
sh "$check" check "$root" "$cc" || exit 1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
# The edits are made to the header as it is, against a dump of it, so they stand for themselves.
mkdir -p "$work/capi/abi"
sh "$check" dump "$root/include" "$cc" "$work/capi/abi/redman-0.0.0.abi"
# edit good|bad WHAT SED
edit() {
  rm -rf "$work/include"
  cp -r "$root/include" "$work/include"
  sed -i "$3" "$work"/include/redman/*.h
  if diff -r "$root/include" "$work/include" > /dev/null; then echo "nothing to edit: $2"; status=1; return; fi
  if sh "$check" check "$work" "$cc" > "$work/out" 2>&1; then got=good; elif grep -q '^the stable headers differ' "$work/out"; then got=bad; else got=broken; fi
  [ $got = "$1" ] || { echo "$2 is $got:"; cat "$work/out"; status=1; }
}
edit bad 'a function is gone' '/rdm_policy_destroy(/d'
edit bad 'an argument of another type' 's/rdm_task_at(int32_t index/rdm_task_at(int64_t index/'
edit bad 'a member in the middle' 's/^  float control_dt; .*/  float control_dt; int32_t more, still_more;/'
edit bad 'a name of an older release is gone' '/RDM_BOX RDM_DEPRECATED/d'
edit bad 'a frozen struct that grew' 's/^} rdm_field;/  int64_t more;\n} rdm_field;/'
edit bad 'a constant with another value' 's/RDM_ERROR_STATE = -3/RDM_ERROR_STATE = -33/'
edit bad 'a constant is gone' 's/RDM_BASELINE_ZERO = 0, //'
edit good 'a new function' 's/^RDM_API uint32_t rdm_version/RDM_API int32_t rdm_new(int32_t a);\n&/'
edit good 'a member at the end of a sized struct' 's/^} rdm_build;/  const char *more;\n} rdm_build;/'
edit good 'an experimental function that changed' 's/rdm_map_clear(rdm_map \*m)/rdm_map_clear(rdm_map *m, int32_t more)/'
edit good 'a break with a new RDM_ABI' 's/^#define RDM_ABI .*/#define RDM_ABI 99/; /rdm_policy_destroy(/d'
exit $status
