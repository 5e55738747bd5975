#!/usr/bin/env bash
# deps.sh TARGET [contracted|gtest]: ODE, libccd, OctoMap and GoogleTest for another machine (arm64, windows, wasm) or this one (native), static, from
# Debian's sources, installed below build/cross/TARGET; built once. Eigen is headers: this machine's do.
#
# Distributions compile them as their compiler likes, which for ARM is with fused multiply-adds: other bytes. Here it
# is off. With `contracted` it is on, and build/cross/TARGET-contracted has ODE and libccd alone: what a library made
# of a distribution's says of itself is tested with it. With `gtest` GoogleTest alone is made.
set -u
cd "$(dirname "$0")/../.." || exit 1
. cmake/packages.sh
. cmake/cross/sources.sh
target=${1:?} part=${2:-} contracted=""
[ "$part" != contracted ] || contracted=yes
prefix=$PWD/build/cross/$target${contracted:+-contracted}
contract=off
[ -z "$contracted" ] || contract=fast
[ -e "cmake/cross/$target.cmake" ] || die "no such machine: $target"

# add NAME FOLDER OPTION...: configures, builds and installs one of them, with its assertions as Debian's have them.
add() {
  local name=$1 source=$2 log=$prefix/$1.log
  shift 2
  [ ! -e "$prefix/$name.done" ] || return 0
  mkdir -p "$prefix"
  echo "building $name for $target" >&2
  {
    cmake -G Ninja -S "$source" -B "$prefix/build/$name" "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/cross/$target.cmake" \
      -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_INSTALL_PREFIX=$prefix" -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF \
      -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "-DCMAKE_C_FLAGS_DEBUG=-O2 -ffp-contract=$contract" \
      "-DCMAKE_CXX_FLAGS_DEBUG=-O2 -ffp-contract=$contract" "$@" &&
      cmake --build "$prefix/build/$name" -j "$(nproc)" && cmake --install "$prefix/build/$name"
  } > "$log" 2>&1 || { tail -n 20 "$log" >&2; die "$name could not be built for $target: $log"; }
  rm -rf "$prefix/build/$name"
  : > "$prefix/$name.done"
}

[ -n "$contracted" ] || add gtest /usr/src/googletest -DBUILD_GMOCK=OFF
[ "$part" != gtest ] || exit 0
ode_flags=()
if [ "$target" = windows ]; then
  need libz-mingw-w64-dev
  mkdir -p "$prefix/include"
  echo '#include <windows.h>' > "$prefix/include/Windows.h" # as ODE writes it
  ode_flags=("-DCMAKE_CXX_FLAGS=-I$prefix/include")
  # what the tool and the importers need; of those that are headers, this machine's
  tinyxml2=$(source_of tinyxml2) && png=$(source_of png) || exit 1
  add tinyxml2 "$tinyxml2" -Dtinyxml2_BUILD_TESTING=OFF
  add png "$png" -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DHAVE_LD_VERSION_SCRIPT=OFF
  cp -r /usr/include/CLI /usr/include/nlohmann /usr/include/toml++ "$prefix/include"
  mkdir -p "$prefix/share/cmake"
  cp -r /usr/share/cmake/CLI11 /usr/share/cmake/nlohmann_json "$prefix/share/cmake"
fi
ode=$(source_of ode) && ccd=$(source_of ccd) || exit 1
# emscripten's C library is one of Linux in what ODE asks of it
sed -i 's/defined(__linux__)$/& || defined(__EMSCRIPTEN__)/' "$ode/config.h.cmake.in" || exit 1
add ode "$ode" -DODE_DOUBLE_PRECISION=ON -DODE_WITH_DEMOS=OFF -DODE_WITH_TESTS=OFF -DODE_WITH_OPCODE=OFF "${ode_flags[@]}"
[ -e "$prefix/lib/libode.a" ] || cp "$prefix"/lib/libode*.a "$prefix/lib/libode.a" || exit 1 # ode_doubles on Windows
add ccd "$ccd" -DENABLE_DOUBLE_PRECISION=ON -DBUILD_DOCUMENTATION=OFF -DBUILD_TESTING=OFF
[ -z "$contracted" ] || exit 0
octomap=$(source_of octomap) || exit 1
if [ "$target" = wasm ]; then
  add octomap cmake/cross/octomap "-DOCTOMAP=$octomap"
  exit 0
fi
add octomap "$octomap" -DBUILD_OCTOVIS_SUBPROJECT=OFF -DBUILD_DYNAMICETD3D_SUBPROJECT=OFF -DBUILD_TESTING=OFF
