#!/bin/sh
# -ffast-math and -Ofast are refused by the compiler, with a word why; our own flags are not. Arguments: the
# project's root and the C++ compiler.
set -u
root=$1 compiler=$2
try() {
  echo '#include "base/fpmode.hpp"' | "$compiler" "$@" -std=c++20 -fsyntax-only -I "$root/lib" -x c++ - 2>&1
}
out=$(try -O2) || { echo "the header alone: $out"; exit 1; }
for flag in -ffast-math -Ofast; do
  out=$(try "$flag") && { echo "$flag is not refused"; exit 1; }
  case $out in *"-ffast-math and -Ofast"*) ;; *) echo "$flag is refused for another reason: $out"; exit 1 ;; esac
done
