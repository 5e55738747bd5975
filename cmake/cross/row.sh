#!/usr/bin/env bash
# row.sh NAME TITLE LOG LIBRARY [COMPILER RUNNER]: writes build/ports/NAME.row, a row of the table of machines in cmake/cross/README.md, from
# what was measured: LOG is ctest's, LIBRARY a shared library. With a compiler its steps a second, through RUNNER (env: here),
# are set beside those of this machine's own library (build/release or build/dev); an emulator's would say nothing.
set -u
name=$1 title=$2 log=$3 library=$4 compiler=${5:-} runner=${6:-}
strip=${STRIP:-strip} copy=$(mktemp)
trap 'rm -f "$copy"' EXIT
. cmake/cross/rates.sh
# verdict TEST FILE: how many of the file's hashes are equal: all, since the test compares all, but for those that it has
# other ones of on this machine.
verdict() {
  local count others=tests/golden/${2%.txt}_$name.txt less=0
  count=$(grep -vc '^#' "tests/golden/$2")
  [ ! -e "$others" ] || less=$(grep -vc '^#' "$others")
  if grep -qE " $1 \.+ +Passed" "$log"; then echo "$((count - less)) of $count"; elif grep -q " $1 \.\.\." "$log"; then echo differ; else echo 'not run'; fi
}
total=$(sed -n 's/.* tests failed out of \([0-9]*\).*/\1/p' "$log" | tail -n1)
failed=$(sed -n 's/.* tests passed, \([0-9]*\) tests* failed out of .*/\1/p' "$log" | tail -n1)
"$strip" -o "$copy" "$library" || exit 1
speed=-
if [ -n "$compiler" ] && native_is_built; then
  link=$library
  [ ! -e "${library%/bin/*}/libredman.dll.a" ] || link=${library%/bin/*}/libredman.dll.a
  program=$(dirname "$library")/rate.exe # beside a DLL, where Windows finds it
  "$compiler" -O1 -Iinclude tests/ports/rate.c "$link" "-Wl,-rpath,$PWD/$(dirname "$library")" -o "$program" &&
    speed=$(speed_beside "$name" "$runner" "$program") || exit 1
fi
echo "| $title | $(verdict test_golden tasks.txt) | $(verdict test_golden_learners learners.txt) | $((total - failed)) of $total | $speed | $(($(stat -c %s "$copy") / 1000)) kB |" |
  tee "build/ports/$name.row"
