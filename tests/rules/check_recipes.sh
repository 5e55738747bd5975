#!/bin/sh
# The recipes of tasks/README.md, algos/README.md and lib/README.md, done in a scratch copy: a task, an algorithm and a
# robot, three edits each, then found and used through the C ABI, put through the tests over all rows, and written into the
# pages' tables. Only what the edits touch is compiled; the rest comes out of the static library and of the tests that are
# built. Arguments: the project's root, a C and a C++ compiler, the static library, the build folder.
set -u
root=$1 cc=$2 cxx=$3 library=$(realpath "$4") build=$(realpath "$5")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
status=0
tree=$work/tree
mkdir "$tree"
for part in lib tasks algos capi include; do cp -r "$root/$part" "$tree"; done

# steps PAGE HEADING: the files that the numbered steps of a recipe name, in their order.
steps() {
  awk -v heading="## $2" 'index($0, heading) == 1 { on = 1; next } /^## / { on = 0 }
    on && match($0, /^[0-9]+\. `[^`]*`/) { s = substr($0, RSTART, RLENGTH); sub(/^[^`]*`/, "", s); sub(/`$/, "", s); print s }' \
    "$root/$1"
}
# recipe PAGE HEADING FOLDER NAME SAMPLE SYMBOL TYPE: step 1 adds FOLDER/NAME.cpp, step 2 declares SYMBOL in a header beside a
# symbol of its TYPE, step 3 puts it at the end of the list. More steps, or other words for them, need another test.
recipe() {
  page=$1 heading=$2 folder=$3 name=$4 sample=$5 symbol=$6 type=$7
  steps "$page" "$heading" > "$work/steps"
  [ "$(wc -l < "$work/steps")" -eq 3 ] || { echo "$page, $heading: not three steps"; status=1; return; }
  header=$(sed -n 2p "$work/steps") list=$(sed -n 3p "$work/steps")
  cp "$root/tests/rules/recipes/$sample" "$tree/$folder/$name.cpp"
  # the first declaration of this kind gets a neighbour; the list, its first run of entries, another last one
  awk -v line="extern const $type $symbol;" -v key="^extern const $type k" '{ print } !done && $0 ~ key { on = 1 }
    on && !done && /;$/ { print line; done = 1 } END { exit !done }' "$tree/$header" > "$work/edit" &&
    cp "$work/edit" "$tree/$header" || { echo "$header: no declaration of a $type to stand beside"; status=1; }
  awk -v entry="&$symbol" '!done && /&k[A-Z][A-Za-z0-9]*/ { on = 1 }
    on && !done && /}/ { k = index($0, "}"); head = substr($0, 1, k - 1); sub(/,? *$/, "", head)
      $0 = head (head ~ /[^ ]/ ? ", " : "    ") entry substr($0, k); done = 1 }
    { print } END { exit !done }' "$tree/$list" > "$work/edit" && cp "$work/edit" "$tree/$list" || { echo "$list: no list of entries"; status=1; }
  printf '%s\n%s\n' "$folder/$name.cpp" "$list" >> "$work/sources"
}
recipe tasks/README.md "A task" tasks/closed_form fenced_walk task.cpp kFencedWalk TaskInfo
recipe algos/README.md "An algorithm" algos/lagrange priced algorithm.cpp kPriced AlgoRow
recipe lib/README.md "A robot" lib/robot/tables one_finger robot.cpp kOneFinger Robot
[ $status -eq 0 ] || exit 1

objects=
while read -r source; do
  object=$work/$(echo "$source" | tr / _).o
  "$cxx" -std=c++20 -O1 -fPIC -fvisibility=hidden -Wall -Wextra -ffp-contract=off -I"$tree" -I"$tree/lib" -I"$tree/include" \
    -c "$tree/$source" -o "$object" || exit 1
  objects="$objects $object"
done < "$work/sources"
third="$(pkg-config --libs ode ccd octomap) -lpthread -lm"

# Through the C ABI.
"$cc" -std=c99 -I"$tree/include" -c "$root/tests/rules/recipes/use.c" -o "$work/use.o" || exit 1
# shellcheck disable=SC2086
"$cxx" "$work/use.o" $objects "$library" $third -o "$work/use" && "$work/use" || exit 1

# The tests over all rows, as they are built: none of them is edited. program NAME TEST...: the suites of these files.
program() {
  program=tests_$1
  shift
  built=$(find "$build/tests/CMakeFiles/$program.dir" -name '*.o' 2> /dev/null)
  [ -n "$built" ] || { echo "$program is not built: build the tests first"; status=1; return; }
  # shellcheck disable=SC2086
  "$cxx" $built $objects "$library" -lgtest_main -lgtest $third -o "$work/$program" || { status=1; return; }
  for test; do
    suites=$(sed -nE 's/^(TEST|TEST_F|TEST_P|TYPED_TEST)\(([A-Za-z0-9_]+).*/\2/p' "$root/tests/$test.cpp" | sort -u)
    filter=$(for suite in $suites; do printf '%s.*:*/%s.*:' "$suite" "$suite"; done)
    "$work/$program" --gtest_filter="$filter" > "$work/log" 2>&1 && grep -q PASSED "$work/log" || {
      echo "$test fails with the recipes' rows:"
      grep -vE '^\[ +(OK|RUN) |^\[-' "$work/log" | head -n 20
      status=1
    }
  done
  rm -f "$work/$program"
}
program tasks tasks/test_catalog tasks/test_task_contract  # test_every_task has tasks with a choice of engines alone
program abi capi/test_contract_tasks
program algos algos/test_algo_registry algos/test_every_algo algos/test_option_tables
program robot robot/test_robot robot/test_robots robot/test_robot_motion robot/test_robot_poses

# The tables of the pages: they want the new rows, and get them from the script that the recipes name.
if [ -x "$build/bin/redman" ] && [ -f "$build/redman.map" ]; then
  # shellcheck disable=SC2086
  "$cxx" -shared -Wl,-z,muldefs $objects -Wl,--whole-archive "$library" -Wl,--no-whole-archive $third \
    -Wl,--version-script="$build/redman.map" -Wl,-soname,libredman.so.1 -o "$work/libredman.so.1" || exit 1
  for page in README.md lib/objects/README.md examples/robots/README.md examples/results/hand_tasks.md examples/results/short.md \
    examples/results/runs.csv examples/results/scores.csv examples/results/published.csv examples/runs.sh examples/score_table.sh \
    examples/paper_report.sh CONTRIBUTING.md cmake/tables.sh cmake/check.sh cmake/packages.sh cmake/skips.sh; do
    mkdir -p "$tree/$(dirname $page)" && cp "$root/$page" "$tree/$page"
  done
  cp -r "$root/examples/manual" "$tree/examples"
  tables() { LD_LIBRARY_PATH=$work bash "$tree/cmake/tables.sh" "$build/bin/redman" "$@"; }
  tables check > "$work/stale" && { echo "the pages' tables do not miss the recipes' rows"; status=1; }
  tables > "$work/written" || { cat "$work/written"; status=1; }
  tables check || status=1
  for row in 'examples/manual/algorithms/README.md:[`priced`](priced.md)' 'examples/manual/tasks/README.md:[`fenced_walk`](fenced_walk.md)' \
    'examples/robots/README.md:`one_finger`'; do
    grep -qF "${row#*:}" "$tree/${row%%:*}" || { echo "${row%%:*} got no row of ${row#*:}"; status=1; }
  done
  for page in tasks/fenced_walk algorithms/priced; do
    grep -q '^<!-- end of options -->$' "$tree/examples/manual/$page.md" || { echo "examples/manual/$page.md was not begun"; status=1; }
  done
fi
exit $status
