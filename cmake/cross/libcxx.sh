#!/usr/bin/env bash
# libcxx.sh: headers and link names of clang's C++ library, and GoogleTest and OctoMap made with it, below
# build/cross/libcxx. Debian's package cannot stand beside libunwind-dev, so it is unpacked, not installed.
set -u
cd "$(dirname "$0")/../.." || exit 1
. cmake/packages.sh
. cmake/cross/sources.sh
folder=$PWD/build/cross/libcxx
mkdir -p "$folder/debs" || exit 1
if [ ! -e "$folder/unpacked" ]; then
  (cd "$folder/debs" && apt-get -qq download libc++-14-dev libc++abi-14-dev > apt.log 2>&1) || die "cannot fetch libc++-14-dev: $(tail -n1 "$folder/debs/apt.log")"
  for deb in "$folder"/debs/*.deb; do dpkg -x "$deb" "$folder/root" || exit 1; done
  mkdir -p "$folder/include/c++" "$folder/lib"
  cp -r "$folder/root/usr/lib/llvm-14/include/c++/v1" "$folder/include/c++/"
  echo 'INPUT(/usr/lib/x86_64-linux-gnu/libc++.so.1.0 /usr/lib/x86_64-linux-gnu/libc++abi.so.1.0)' > "$folder/lib/libc++.so"
  : > "$folder/unpacked"
fi
octomap=$(source_of octomap) || exit 1
# add NAME FOLDER OPTION...
add() {
  local name=$1 source=$2 log=$folder/$1.log
  shift 2
  [ ! -e "$folder/$name.done" ] || return 0
  echo "building $name with libc++" >&2
  {
    cmake -G Ninja -S "$source" -B "$folder/build/$name" -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_BUILD_TYPE=Release \
      "-DCMAKE_CXX_FLAGS=-nostdinc++ -isystem $folder/include/c++/v1 -stdlib=libc++ -L$folder/lib" \
      "-DCMAKE_INSTALL_PREFIX=$folder" -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF \
      -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "$@" &&
      cmake --build "$folder/build/$name" -j "$(nproc)" && cmake --install "$folder/build/$name"
  } > "$log" 2>&1 || { tail -n 20 "$log" >&2; die "$name could not be built with libc++: $log"; }
  rm -rf "$folder/build/$name"
  : > "$folder/$name.done"
}
add gtest /usr/src/googletest -DBUILD_GMOCK=OFF
add octomap "$octomap" -DBUILD_OCTOVIS_SUBPROJECT=OFF -DBUILD_DYNAMICETD3D_SUBPROJECT=OFF -DBUILD_TESTING=OFF
