#!/bin/sh
# A file is one noun: at most 500 lines, a source has a test of the same name or a reason in
# tests/excuses.txt. Argument: the project's root.
set -u
cd "$1" || exit 1
status=0
long=$(find lib tasks algos capi include examples tests cmake \
         \( -name '*.[ch]' -o -name '*.[ch]pp' -o -name '*.sh' -o -name '*.cmake' -o -name CMakeLists.txt \) \
         -exec wc -l {} + | awk '$1 > 500 && $2 != "total" { print $2 ": " $1 " lines" }')
[ -z "$long" ] || { echo "$long"; status=1; }
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
lost=$(sed -n 's/^\([^#:]*\): .*/\1/p' tests/excuses.txt | while read -r file; do
  [ -f "$file" ] || echo "tests/excuses.txt: $file does not exist"
done)
[ -z "$lost" ] || { echo "$lost"; status=1; }
exit $status
