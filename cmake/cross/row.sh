#!/usr/bin/env bash
# row.sh NAME TITLE LOG LIBRARY RATE NATIVE: writes build/ports/NAME.row, a row of README's table of machines, from what was
# measured: LOG is ctest's, LIBRARY a shared library, RATE and NATIVE commands that print steps a second, there and here
# ("-": no rate; an emulator's says nothing).
set -u
name=$1 title=$2 log=$3 library=$4 rate=$5 native=$6
strip=${STRIP:-strip} copy=$(mktemp)
trap 'rm -f "$copy"' EXIT
mkdir -p build/ports
# verdict TEST FILE: how many of the file's hashes are equal: all, since the test compares all.
verdict() {
  local count
  count=$(grep -vc '^#' "tests/golden/$2")
  if grep -qE " $1 \.+ +Passed" "$log"; then echo "$count of $count"; elif grep -q " $1 \.\.\." "$log"; then echo differ; else echo 'not run'; fi
}
total=$(sed -n 's/.* tests failed out of \([0-9]*\).*/\1/p' "$log" | tail -n1)
failed=$(sed -n 's/.* tests passed, \([0-9]*\) tests* failed out of .*/\1/p' "$log" | tail -n1)
"$strip" -o "$copy" "$library" || exit 1
speed=-
if [ "$rate" != - ]; then
  there=$($rate | tr -d '\r') here=$($native) || exit 1
  speed=$(awk -v a="$there" -v b="$here" 'BEGIN { printf "%.2f", a / b }')
fi
echo "| $title | $(verdict test_golden tasks.txt) | $(verdict test_golden_learners learners.txt) | $((total - failed)) of $total | $speed | $(($(stat -c %s "$copy") / 1000)) kB |" |
  tee "build/ports/$name.row"
