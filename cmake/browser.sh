#!/usr/bin/env bash
# browser.sh [FOLDER]: a page that opens offline, with the library as WebAssembly, in build/browser/page (or FOLDER): index.html
# and its data. Debian's emscripten compiles, ODE, libccd and OctoMap too; the tool of this machine plays the demonstrations.
set -u
cd "$(dirname "$0")/.." || exit 1
. cmake/packages.sh
out=${1:-$PWD/build/browser/page}
# shellcheck disable=SC2086
need $build_packages $viewer_packages emscripten curl googletest
command -v node > /dev/null || need nodejs
export NODE_PATH=/usr/share/nodejs # where Debian's emscripten has its packages, whatever node runs it
# one run of the compiler a file: its own list of headers is enough for ccache
export CCACHE_DEPEND=1 CCACHE_COMPILERTYPE=clang
bash cmake/cross/deps.sh wasm || exit 1
configure wasm
cmake --build --preset wasm -j "$(nproc)" --target redman_static >&2 || die "preset wasm could not be built: see above"
unset CCACHE_DEPEND CCACHE_COMPILERTYPE # the tool's compiler is no clang
tool=build/release/bin/redman
if [ ! -x $tool ]; then
  tool=build/dev/bin/redman
  configure dev
  cmake --build --preset dev -j "$(nproc)" --target redman_tool >&2 || die "the tool could not be built: see above"
fi

mkdir -p build/browser
deps=build/cross/wasm/lib
emcc -O3 -msimd128 -fno-slp-vectorize -fno-vectorize -fwasm-exceptions -std=c99 -Wall -Wextra -Wpedantic -Werror -Iinclude examples/browser/page.c \
  build/wasm/libredman.a $deps/libode.a $deps/libccd.a $deps/liboctomap.a $deps/liboctomath.a -lstdc++ \
  -sMODULARIZE=1 -sEXPORT_NAME=createRedman -sENVIRONMENT=web,worker,node -sALLOW_MEMORY_GROWTH=1 -sFILESYSTEM=0 \
  -sTOTAL_STACK=1048576 -sEXPORTED_FUNCTIONS=_malloc,_free -sEXPORTED_RUNTIME_METHODS=UTF8ToString \
  -o build/browser/redman.js >&2 || die "the page's library could not be linked: see above"
three=/usr/share/javascript/three/three.min.js
[ -e $three ] || die "no $three: install libjs-three"
node examples/browser/assemble.cjs "$PWD" build/browser $tool $three "$out"
