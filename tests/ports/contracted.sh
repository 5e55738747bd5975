#!/bin/sh
# The library says so when its ODE and libccd have fused multiply-adds, and when they have not. Arguments: the
# project's root, the C++ compiler of 64-bit ARM, libredman.a for it.
set -u
root=$1 compiler=$2 library=$3
cross=$root/build/cross/arm64 folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
passed=0 failed=0
# expect TEXT FOLDER: what the program says when ODE and libccd come from there.
expect() {
  "$compiler" -x c -std=c99 -I "$root/include" "$root/tests/ports/say_build.c" -x none "$library" "$2/lib/libode.a" \
    "$2/lib/libccd.a" "$cross/lib/liboctomap.a" "$cross/lib/liboctomath.a" -lpthread -o "$folder/say" || { failed=$((failed + 1)); return; }
  said=$(qemu-aarch64-static -L /usr/aarch64-linux-gnu "$folder/say")
  if [ "$said" = "$1" ]; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "$2: said '$said', not '$1'"; fi
}
expect 'base; same bytes' "$cross"
expect 'base; ODE, libccd' "$cross-contracted"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
