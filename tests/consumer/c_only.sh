#!/bin/sh
# A CMake project with LANGUAGES C alone links the static library: that of the installed package, and that of the
# tree as a subdirectory (a build without both halves: quick), which then installs nothing of its own.
# Arguments: cmake, C and C++ compiler, prefix, the tree, a folder for the builds.
set -eu
cmake=$1 cc=$2 cxx=$3 prefix=$4 tree=$5 out=$6
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$out"
build() { # build NAME OPTIONS...
  name=$1
  shift
  "$cmake" -S "$here/c_only" -B "$out/$name" -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" "$@" > "$out.log" 2>&1 &&
    "$cmake" --build "$out/$name" -j 2 >> "$out.log" 2>&1 || { cat "$out.log"; exit 1; }
  for program in use_c import_c; do
    [ ! -e "$out/$name/$program" ] || "$out/$name/$program"
  done
}
build package -DCMAKE_PREFIX_PATH="$prefix"
build subdirectory -DREDMAN_TREE="$tree" -DREDMAN_SIM=OFF -DREDMAN_LEARN=OFF -DREDMAN_SHARED=OFF
"$cmake" --install "$out/subdirectory" --prefix "$out/installed" > /dev/null
[ "$(cd "$out/installed" && find . -type f)" = ./bin/use_c ] || { find "$out/installed"; exit 1; }
