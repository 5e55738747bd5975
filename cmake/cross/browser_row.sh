#!/usr/bin/env bash
# browser_row.sh PASSED: the browser's row of the table of machines in cmake/cross/README.md, build/ports/browser.row, after all hashes were found
# equal and PASSED checks of the page passed. Speed: steps a second in Node over those of this machine's own library.
set -u
. cmake/cross/rates.sh
in_node() {
  node --no-experimental-fetch examples/browser/probe.cjs build/browser "$PWD" bench | sed -n 's/.*"steps_per_s":\([0-9]*\).*/\1/p'
}
speed=-
if native_is_built; then speed=$(speed_beside browser in_node) || exit 1; fi
worlds=$(grep -vc '^#' tests/golden/tasks.txt) learners=$(grep -v '^#' tests/golden/learners.txt | grep -vc '^policy ')
echo "| \`browser\`: WebAssembly, emscripten $(emcc -dumpversion | cut -d. -f1,2), in Node and Chromium | $worlds of $worlds | $learners of $learners | $1 of $1 | $speed | $(($(stat -c %s build/browser/redman.wasm) / 1000)) kB |" |
  tee build/ports/browser.row
