#!/usr/bin/env bash
# regenerate.sh [BUILD]: writes again what follows from the lists of tasks, algorithms, robots and objects and from the public
# headers: the golden rows, the layouts of structs, Python's declarations, and the tables between marks in the pages. BUILD is a
# folder with tests, build/dev unless given. What it changed is for you to look at and to commit.
# tests/golden/tasks_windows.txt needs the build for Windows, build/windows, which `bash cmake/check.sh windows` makes.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/dev}
[ -f "$build/CMakeCache.txt" ] || { echo "$build is no build folder: cmake --preset dev, or give another"; exit 1; }
cmake --build "$build" --target redman_tool test_golden test_golden_learners print_layout truth
for rows in test_golden test_golden_learners; do
  RDM_WRITE_GOLDEN=1 "$build/tests/$rows" > "$build/$rows.log" || { cat "$build/$rows.log"; exit 1; }
done
if [ -e build/windows/tests/test_golden.exe ]; then
  cmake --build build/windows --target test_golden
  RDM_WRITE_GOLDEN=1 cmake/cross/wine.sh build/windows/tests/test_golden.exe > build/windows/test_golden.log || { cat build/windows/test_golden.log; exit 1; }
elif ! git diff --quiet -- tests/golden/tasks.txt; then
  echo "tests/golden/tasks_windows.txt is as it was: run bash cmake/check.sh windows, and this again if test_golden failed there"
fi
sh tests/tool/test_tool_data.sh "$build/bin/redman" --write
"$build/tests/print_layout" > capi/layout.golden
python3 capi/python/generate_abi.py
bash cmake/tables.sh "$build/bin/redman"
bash cmake/truth_table.sh "$build" short || echo "the truth table has rows that are off: see above"
git status --short -- tests/golden capi/layout.golden capi/python/redman/_abi.py capi/python/redman/_import_abi.py '*.md'
