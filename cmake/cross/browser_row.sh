#!/usr/bin/env bash
# browser_row.sh PASSED: the browser's row of README's table of machines, build/ports/browser.row, after all hashes were found
# equal and PASSED checks of the page passed. Speed: steps a second in Node over those of this machine's own library.
set -u
mkdir -p build/ports
for native in build/release build/dev; do [ ! -e $native/libredman.so ] || break; done
speed=-
if [ -e $native/libredman.so ]; then
  gcc -O1 -Iinclude tests/ports/rate.c $native/libredman.so "-Wl,-rpath,$PWD/$native" -o build/ports/rate || exit 1
  # in turns, since a busy machine changes its pace
  for _ in 1 2 3; do
    node --no-experimental-fetch examples/browser/probe.cjs build/browser "$PWD" bench | sed -n 's/.*"steps_per_s":\([0-9]*\).*/\1/p' && build/ports/rate || exit 1
  done > build/ports/browser.rates
  speed=$(awk 'NR % 2 { a += $1; next } { b += $1 } END { printf "%.2f", a / b }' build/ports/browser.rates)
fi
worlds=$(grep -vc '^#' tests/golden/tasks.txt) learners=$(grep -v '^#' tests/golden/learners.txt | grep -vc '^policy ')
echo "| \`browser\`: WebAssembly, emscripten $(emcc -dumpversion | cut -d. -f1,2), in Node and Chromium | $worlds of $worlds | $learners of $learners | $1 of $1 | $speed | $(($(stat -c %s build/browser/redman.wasm) / 1000)) kB |" |
  tee build/ports/browser.row
