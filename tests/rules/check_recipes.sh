#!/bin/sh
# The recipes of tasks/README.md, algos/README.md and lib/README.md, done in a scratch copy: a task, an algorithm and a
# robot, three edits each, then found and used through the C ABI. Only what the edits touch is compiled; the rest comes
# out of the static library. Arguments: the project's root, a C and a C++ compiler, the static library.
set -u
root=$1 cc=$2 cxx=$3 library=$4
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
# symbol of its TYPE, step 3 puts it into the list. More steps, or other words for them, need another test.
recipe() {
  page=$1 heading=$2 folder=$3 name=$4 sample=$5 symbol=$6 type=$7
  steps "$page" "$heading" > "$work/steps"
  [ "$(wc -l < "$work/steps")" -eq 3 ] || { echo "$page, $heading: not three steps"; status=1; return; }
  header=$(sed -n 2p "$work/steps") list=$(sed -n 3p "$work/steps")
  cp "$root/tests/rules/recipes/$sample" "$tree/$folder/$name.cpp"
  # the first declaration of this kind gets a neighbour, the list's first entry too
  awk -v line="extern const $type $symbol;" -v key="^extern const $type k" '{ print } !done && $0 ~ key { on = 1 }
    on && !done && /;$/ { print line; done = 1 } END { exit !done }' "$tree/$header" > "$work/edit" &&
    cp "$work/edit" "$tree/$header" || { echo "$header: no declaration of a $type to stand beside"; status=1; }
  awk -v entry="&$symbol, " '{ if (!done && match($0, /&k[A-Z][A-Za-z0-9]*/)) { $0 = substr($0, 1, RSTART - 1) entry substr($0, RSTART); done = 1 } print }
    END { exit !done }' "$tree/$list" > "$work/edit" && cp "$work/edit" "$tree/$list" || { echo "$list: no list of entries"; status=1; }
  printf '%s\n%s\n' "$folder/$name.cpp" "$list" >> "$work/sources"
}
recipe tasks/README.md "A task" tasks/closed_form fenced_walk task.cpp kFencedWalk TaskInfo
recipe algos/README.md "An algorithm" algos/lagrange crpo algorithm.cpp kCrpo AlgoRow
recipe lib/README.md "A robot" lib/robot/tables one_finger robot.cpp kOneFinger Robot
[ $status -eq 0 ] || exit 1

objects=
while read -r source; do
  object=$work/$(echo "$source" | tr / _).o
  "$cxx" -std=c++20 -O1 -Wall -Wextra -ffp-contract=off -I"$tree" -I"$tree/lib" -I"$tree/include" -c "$tree/$source" \
    -o "$object" || exit 1
  objects="$objects $object"
done < "$work/sources"
"$cc" -std=c99 -I"$tree/include" -c "$root/tests/rules/recipes/use.c" -o "$work/use.o" || exit 1
# shellcheck disable=SC2046,SC2086
"$cxx" "$work/use.o" $objects "$library" $(pkg-config --libs ode ccd octomap) -lpthread -lm -o "$work/use" || exit 1
"$work/use"
