#!/usr/bin/env bash
# budget.sh [--write] [--time] [FOLDER]: what the library costs, measured in the builds FOLDER/dev, FOLDER/release and
# FOLDER/small (build/...) as far as they are there, beside cmake/budget.txt; --write renews the rows that were measured.
# --time also builds preset release once more, and gives its processor time as a multiple of what a reference file takes on the same
# machine. Nothing is built otherwise.
# Ends with 77 when no row could be measured, which is a skip.
set -u
cd "$(dirname "$0")/.." || exit 1
page=cmake/budget.txt write=no time=no folder=build
for argument in "$@"; do
  case $argument in
    --write) write=yes ;;
    --time) time=yes ;;
    -*) echo "budget.sh: '$argument' is none of --write, --time" >&2; exit 2 ;;
    *) folder=$argument ;;
  esac
done
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT

# exports LIBRARY NODE: how many names it has at a version node
exports() { nm -D --defined-only "$1" | grep -c "@@*$2\$"; }
needed() { readelf -dW "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\.so.*/\1/p' | grep -v '^ld-linux' | sort | paste -sd,; }
stripped() { strip -o "$new/stripped" "$1" && stat -c %s "$new/stripped"; }
# current FILE: it is there, and no source is newer
current() { [ -e "$1" ] && [ -z "$(find include lib tasks algos capi CMakeLists.txt CMakePresets.json cmake/layers.cmake -newer "$1" -type f \
  \( -name '*.[hc]' -o -name '*.hpp' -o -name '*.cpp' -o -name '*.inl' -o -name '*.symbols' -o -name '*.awk' -o -name 'CMake*' -o -name '*.cmake' \) -print -quit)" ]; }

# seconds COMMAND...: the processor seconds that it and its children take; fails as it does, and then says what it said
seconds() {
  local TIMEFORMAT='%U %S' status
  { time "$@" > "$new/log" 2>&1; } 2> "$new/seconds"
  status=$?
  [ $status -eq 0 ] || { cat "$new/log" >&2; return $status; }
  awk '{ print $1 + $2 }' "$new/seconds"
}

# reference: compiles the reference file twice for each processor, as many at once as there are, as the build does with its own files
reference() {
  seq $(($(nproc) * 2)) | xargs -P "$(nproc)" -I '{}' c++ -std=c++20 -O3 -I/usr/include/eigen3 -c "$new/reference.cpp" -o "$new/reference.{}.o"
}

measure() {
  local library before build after
  library=$folder/dev/libredman.so
  if [ -e "$library" ]; then
    echo "exports_stable $(($(exports "$library" REDMAN_0) + $(exports "$library" REDMAN_1) + $(exports "$library" REDMAN_1.0)))"
    echo "exports_experimental $(exports "$library" 'REDMAN_EXPERIMENTAL_.*')"
    echo "dependencies $(needed "$library")"
  fi
  # another set of packages builds more or less
  if [ -e "$folder/dev/build.ninja" ] && grep -q '/redman_tool_parts\.dir/' "$folder/dev/build.ninja" && grep -q '/rdm_import\.dir/' "$folder/dev/build.ninja"; then
    echo "dev_build_steps $(ninja -C "$folder/dev" -t commands all | wc -l)"
  fi
  library=$folder/release/libredman.so
  if current "$library"; then
    echo "release_bytes $(stripped "$library")"
    if [ -x "$folder/release/bin/01_step" ] && command -v valgrind > /dev/null; then
      echo "start_instructions $(valgrind --tool=callgrind --callgrind-out-file=/dev/null "$folder/release/bin/01_step" 1 2>&1 |
        sed -n 's/.*Collected : *//p')"
    fi
  fi
  library=$folder/small/libredman.so
  ! current "$library" || echo "small_bytes $(stripped "$library")"
  if [ $time = yes ]; then
    cmake --preset release -B "$new/release" -DCMAKE_C_COMPILER_LAUNCHER= -DCMAKE_CXX_COMPILER_LAUNCHER= > "$new/log" 2>&1 || { cat "$new/log" >&2; exit 1; }
    cat > "$new/reference.cpp" << 'END'
#include <Eigen/Dense>
#include <map>
#include <regex>
#include <string>
int main(int argc, char **argv) {
  std::map<std::string, Eigen::MatrixXd> all;
  for (int i = 1; i < argc; ++i) all[argv[i]] = Eigen::MatrixXd::Random(argc, argc);
  double sum = 0;
  for (auto &[name, m] : all) sum += std::regex_match(name, std::regex("a+b*")) ? m.ldlt().solve(m).sum() : m.householderQr().solve(m).sum();
  return sum > 0;
}
END
    # before and after, since a machine's speed may change meanwhile
    before=$(seconds reference) && build=$(seconds env CCACHE_DISABLE=1 cmake --build "$new/release") && after=$(seconds reference) || exit 1
    echo "preset release: $build processor seconds; $(nproc) x 2 reference files: $before before, $after after" >&2
    echo "release_build_units $(awk -v build="$build" -v before="$before" -v after="$after" -v n="$(nproc)" \
      'BEGIN { printf "%.0f", build / ((before + after) / (4 * n)) }')"
  fi
}
measure > "$new/rows"
[ -s "$new/rows" ] || { echo "there is no build in $folder: cmake --build --preset dev, and release and small for all rows"; exit 77; }

if [ $write = yes ]; then
  awk 'NR == FNR { now[$1] = $2; next } !/^#/ && NF && $1 in now { sub(/^[^ ]+ +[^ ]+ */, sprintf("%-22s %-8s ", $1, now[$1])) } { print }' \
    "$new/rows" $page > "$new/page" && cp "$new/page" $page
fi
awk '
  NR == FNR { now[$1] = $2; next }
  /^#/ || !NF { next }
  !($1 in now) { printf "%-22s %s, not measured here\n", $1, $2; next }
  $2 == "-" { printf "%-22s %s, nothing is written: --write\n", $1, now[$1]; next }
  {
    off = $2 != now[$1]
    if (off && $2 + 0 > 0) { change = 100 * (now[$1] / $2 - 1); off = (change < 0 ? -change : change) > $3 }
    printf "%-22s %s, %s in the budget%s\n", $1, now[$1], $2, off ? ": more than " $3 " % away" : ""
    if (off) ++failed; else ++passed
  }
  END {
    printf "%d passed, %d failed\n", passed, failed
    if (failed) print "where this is meant: bash cmake/budget.sh --write, and the commit says why" > "/dev/stderr"
    exit failed > 0 || passed == 0
  }' "$new/rows" $page
