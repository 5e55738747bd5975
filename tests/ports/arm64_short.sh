#!/bin/sh
# A short share of `check.sh arm64`: arithmetic, random numbers and networks on 64-bit ARM under qemu, with the recorded
# numbers of x86-64. Argument: the project's root. Skipped (77) where the tools are missing.
set -u
root=$1 build=$1/build/arm64-short
for tool in aarch64-linux-gnu-g++ qemu-aarch64-static; do
  command -v $tool > /dev/null || { echo "no $tool here: install g++-aarch64-linux-gnu and qemu-user-static"; exit 77; }
done
[ -d /usr/src/googletest ] || { echo "no source of GoogleTest here: install googletest"; exit 77; }
command -v ccache > /dev/null && set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache || set --
bash "$root/cmake/cross/deps.sh" arm64 gtest || exit 1
tests='fpmode rng simd kernels gaussian'
# shellcheck disable=SC2046,SC2086
{
  cmake -S "$root" --preset arm64 -B "$build" -DREDMAN_SIM=OFF -DREDMAN_EXAMPLES=OFF -DREDMAN_SHARED=OFF "$@" &&
    cmake --build "$build" --target $(printf 'test_%s ' $tests)
} > "$build.log" 2>&1 || { tail -n 30 "$build.log"; exit 1; }
cd "$build" || exit 1
pattern="^test_($(echo "$tests" | tr ' ' '|'))\$"
ctest --output-on-failure --no-tests=error -R "$pattern"
