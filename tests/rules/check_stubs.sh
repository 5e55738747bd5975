#!/bin/sh
# What capi/stubs.awk writes for the builds without a half compiles, defines each function once, and leaves out
# exactly what such a build has. Arguments: the project's root and a C++ compiler.
set -u
root=$1 cxx=$2
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
status=0
headers=$(sh "$root/cmake/headers.sh" "$root/include")
# shellcheck disable=SC2086
for part in stable experimental; do awk -v mode=$part -f "$root/tests/rules/header.awk" $headers; done > "$work/all"
LC_ALL=C sort -o "$work/all" "$work/all"
for halves in '0 0' '0 1' '1 0' '1 1'; do
  set -- $halves
  name=$1$2
  awk -v sim="$1" -v learn="$2" -v policy="$2" -f "$root/capi/stubs.awk" $headers > "$work/$name.cpp"
  sed -n 's/^[a-z].*[ *]\(rdm_[a-z_0-9]*\)(.*{.*/\1/p' "$work/$name.cpp" | grep -v '^rdm_result$' |
    LC_ALL=C sort > "$work/$name"
  [ "$name" = 11 ] && continue
  "$cxx" -x c++ -std=c++20 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only -DRDM_EXPERIMENTAL \
    "-I$root" "-I$root/lib" "-I$root/include" "$work/$name.cpp" || { echo "stubs $name: see above"; status=1; }
done
[ -s "$work/11" ] && { echo "stubs for a build that has all:"; cat "$work/11"; status=1; }
unknown=$(LC_ALL=C comm -23 "$work/00" "$work/all")
[ -z "$unknown" ] || { echo "not in the header: $unknown"; status=1; }
# what is in every build has no half; nothing else is missing from the stubs of a build with neither
always=$(LC_ALL=C comm -13 "$work/00" "$work/all" | tr '\n' ' ')
expected='rdm_agent_config_init rdm_build_info rdm_check_abi rdm_check_experimental rdm_clone_config_init rdm_fail rdm_features rdm_init rdm_last_error rdm_nearest_names rdm_pool_config_init rdm_pretrain_config_init rdm_result_string rdm_rotation rdm_shutdown rdm_version '
[ "$always" = "$expected" ] || { echo "in every build: $always"; status=1; }
# a function that both builds with one half lack takes a pool and an agent
both=$(LC_ALL=C comm -12 "$work/01" "$work/10" | tr '\n' ' ')
[ "$both" = 'rdm_agent_config_for_pool rdm_agent_rollout rdm_agent_set_shield ' ] || { echo "of both halves: $both"; status=1; }
exit $status
