#!/bin/sh
# A file is one noun: at most 500 lines, a source has a test of the same name or a reason in
# tests/excuses.txt. Argument: the project's root.
set -u
cd "$1" || exit 1
status=0
for file in $(find lib tasks algos capi include examples tests cmake \
              \( -name '*.[ch]' -o -name '*.[ch]pp' -o -name '*.sh' -o -name '*.cmake' -o -name CMakeLists.txt \) 2> /dev/null); do
  lines=$(wc -l < "$file")
  [ "$lines" -le 500 ] || { echo "$file: $lines lines"; status=1; }
done
for file in lib/*/*.cpp tasks/*.cpp algos/*.cpp capi/*.cpp; do
  [ -f "$file" ] || continue
  noun=$(basename "$file" .cpp)
  excuse=$(grep "^$file: " tests/excuses.txt)
  if [ -f "tests/test_$noun.cpp" ]; then
    [ -z "$excuse" ] || { echo "$file: has a test, its excuse can go"; status=1; }
  elif [ -z "$excuse" ]; then
    echo "$file: neither tests/test_$noun.cpp nor a reason in tests/excuses.txt"
    status=1
  fi
done
sed 's/: .*//' tests/excuses.txt | while read -r file; do
  case $file in '' | '#'*) ;; *) [ -f "$file" ] || echo "tests/excuses.txt: $file does not exist" ;; esac
done > "${TMPDIR:-/tmp}/excuses.$$"
cat "${TMPDIR:-/tmp}/excuses.$$"
[ ! -s "${TMPDIR:-/tmp}/excuses.$$" ] || status=1
rm -f "${TMPDIR:-/tmp}/excuses.$$"
exit $status
