#!/usr/bin/env bash
# check.sh [dev|asan|tsan|valgrind|tidy|slow|halves|clang|coverage|hard [MINUTES]]: installs what the tests need, builds, and runs them.
# The last line says how many passed and failed; the exit status is 0 when none failed.
set -u
cd "$(dirname "$0")/.." || exit 1
. cmake/packages.sh
mode=${1:-dev}

# Runs ctest and ends with "N passed, M failed".
run_tests() {
  local preset=$1 log=build/ctest-$mode.log
  shift
  (cd "build/$preset" && ctest --output-on-failure --no-tests=error -j "$(nproc)" "$@") 2>&1 | tee "$log"
  local status=${PIPESTATUS[0]} failed total
  failed=$(sed -n 's/.* tests passed, \([0-9]*\) tests* failed out of .*/\1/p' "$log" | tail -n1)
  total=$(sed -n 's/.* failed out of \([0-9]*\).*/\1/p' "$log" | tail -n1)
  [ -n "$total" ] || die "ctest ran nothing"
  echo "$((total - failed)) passed, $failed failed"
  return "$status"
}

# shellcheck disable=SC2086
need $build_packages libgtest-dev clang-format-14 octomap-tools python3 python3-numpy mypy
case $mode in
  dev)
    configure dev
    build dev
    run_tests dev -LE slow
    ;;
  asan | tsan)
    configure "$mode"
    build "$mode"
    export UBSAN_OPTIONS=print_stacktrace=1 TSAN_OPTIONS=suppressions=$PWD/tests/hard/tsan.supp
    run_tests "$mode" -LE 'slow|format'
    ;;
  slow)
    configure dev
    build dev
    run_tests dev -L slow
    ;;
  valgrind)
    need valgrind libc6-dbg
    configure dev -DREDMAN_VALGRIND=ON
    build dev
    run_tests dev -L valgrind
    ;;
  tidy)
    need clang-tidy-14
    configure dev
    build dev
    passed=0 failed=0
    list=$(mktemp -d)
    find lib tasks algos capi -name '*.cpp' -print0 | xargs -0 -n 1 -P "$(nproc)" sh -c '
      if clang-tidy-14 -p build/dev --quiet "$1" > "$0/$$.out" 2> /dev/null; then echo ok > "$0/$$.ok"; else
        echo "$1"; cat "$0/$$.out"; echo bad > "$0/$$.bad"; fi' "$list"
    passed=$(find "$list" -name '*.ok' | wc -l) failed=$(find "$list" -name '*.bad' | wc -l)
    rm -rf "$list"
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    ;;
  coverage)
    # Which lines the tests run: a row a file, the least covered first, in build/coverage.txt; the sum is printed.
    need gcovr
    configure coverage
    build coverage
    find build/coverage -name '*.gcda' -delete
    run_tests coverage -LE 'slow|format'
    status=$?
    gcovr --root . --object-directory build/coverage --filter '(lib|tasks|algos|capi)/' --exclude-throw-branches \
      --sort-uncovered --txt build/coverage.txt --print-summary -j "$(nproc)" | grep '^lines' >&2
    exit $status
    ;;
  halves)
    # Each half builds, passes its tests and installs without the other.
    for half in SIM LEARN; do
      configure dev -B build/without-$half -DREDMAN_$half=OFF
      cmake --build build/without-$half -j "$(nproc)" >&2 || die "the build without $half failed: see above"
      run_tests without-$half -LE slow || exit 1
    done
    ;;
  clang)
    # Another compiler at -O3 gives the same bytes: what is undefined shows where optimisers differ.
    need clang-14
    configure dev -B build/clang -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DREDMAN_WERROR=OFF \
      -DREDMAN_TOOL=OFF '-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O3 -g1'
    cmake --build build/clang -j "$(nproc)" --target test_golden test_stepper test_vec >&2 || die "the build with clang failed: see above"
    run_tests clang -R '^(test_golden|golden_other_libm|test_stepper|test_vec)$'
    ;;
  hard)
    # Tries to break the library for an hour (or MINUTES), builds included: tests/hard/README.md. Two lines of work,
    # one for each of two processors; every part gets a share of the time that the builds leave.
    minutes=${2:-60}
    need clang-14 libclang-rt-14-dev
    for preset in dev fuzz tsan; do
      configure $preset
      targets=hard
      [ $preset = dev ] && targets="hard redman_tool"
      [ $preset = tsan ] && targets=hard_threads
      # shellcheck disable=SC2086
      cmake --build --preset $preset -j "$(nproc)" --target $targets >&2 || die "preset $preset could not be built: see above"
    done
    time=$((minutes * 60 - SECONDS - 30))
    [ $time -gt 60 ] || time=60
    echo "hard: $time s for the parts, of $minutes minutes" >&2
    mkdir -p build/hard
    # part PERCENT BUILD NAME
    part() {
      bash tests/hard/run.sh "$3" $((time * $1 / 100)) "build/$2" > "build/hard/$3.log" 2>&1
      echo "$3: $(tail -n1 "build/hard/$3.log"), details in build/hard/$3.log" >&2
    }
    { part 70 fuzz fuzz; part 30 fuzz words; } &
    { part 10 tsan threads; part 15 dev kills; part 35 dev refuse; part 40 dev soak; } &
    wait
    cat build/hard/{fuzz,words,threads,kills,refuse,soak}.log
    passed=0 failed=0
    for name in fuzz words threads kills refuse soak; do
      result=$(tail -n1 "build/hard/$name.log")
      case $result in
        *' passed, '*' failed')
          passed=$((passed + ${result%% passed*})) result=${result#*passed, }
          failed=$((failed + ${result%% failed*}))
          ;;
        *) echo "$name did not come to its end"; failed=$((failed + 1)) ;;
      esac
    done
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    ;;
  *) die "usage: check.sh [dev|asan|tsan|valgrind|tidy|slow|halves|clang|coverage|hard [MINUTES]]" ;;
esac
