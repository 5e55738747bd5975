#!/usr/bin/env bash
# check.sh [MODE]: installs what the tests need, where it may; builds; runs them. `check.sh --help` lists the modes.
# The last line says how many passed and failed; the exit status is 0 when none failed.
set -u
cd "$(dirname "$0")/.." || exit 1
. cmake/packages.sh
. cmake/skips.sh
mode=${1:-dev}

# The modes: name | what it asks | when. Minutes are of two processors, on a tree whose build is there.
modes=$(cat << 'END'
quick|format, layers and the other rules, tests of `base`, `record`, `nn` and of the catalogue; installs nothing|while you work: under a minute
dev|all tests but the slow ones; what runs without a mode|every change: 15 min
asan|memory and undefined behaviour, by GCC's sanitizers|memory, parsers
tsan|races, by GCC's ThreadSanitizer, in the tests that start threads|threads
valgrind|examples, `lib/base` and the contract of the ABI under valgrind|memory
tidy|clang-tidy 14|new files
halves|the simulator and the learner are each built, tested and installed without the other|the ABI, CMake
small|memory, stack and program size of a build for size, compared with the table of examples/small|memory, dependencies
budget|exported names, file sizes, dependencies, instructions at program start and build time, compared with the bounds in cmake/budget.txt|dependencies, start, CMake
older|all tests but the slow ones with the instructions of x86-64-v2 alone, as on processors before 2013|arithmetic
clang|the recorded hashes by clang 14 at -O3|arithmetic
libc++|the recorded hashes by clang 14 with libc++|arithmetic, standard headers
arm64 [all]|the recorded hashes on 64-bit ARM under qemu; `all`: also the tests that take half an hour there|arithmetic
windows|the recorded hashes, the DLL and the tool under wine|arithmetic, system calls
browser|the library as WebAssembly, in Node and in a page|arithmetic, examples/browser
languages|the program of `examples/` in every language; the headers in four generators of bindings|the ABI
packages|`.deb` files and the wheel in clean roots, the reference, the ABI|packages, the ABI
pages|playback, reports and `view` in a browser without a window|the tool's pages
embedded|policies as C source on Cortex-M processors under qemu|export --c
physics|the truth table, the bundled policies at other substeps|the engine
slow|learning and long random runs|before a release
coverage|which lines no test runs, in build/coverage.txt|before a release
hard [MINUTES]|tries to break the library, for an hour|before a release
release [MODE...]|all of the above, or those given, in a clean copy of the commit, the files to publish, and one page of what passed|a release
END
)
case $mode in
  -h | --help)
    echo "usage: check.sh [MODE], dev where none is given"
    echo "$modes" | awk -F'|' '{ printf "  %-14s %s (%s)\n", $1, $2, $3 }'
    exit
    ;;
  --markdown)
    printf '| `check.sh` | what it asks | when |\n|---|---|---|\n'
    echo "$modes" | awk -F'|' '{ printf "| `%s` | %s | %s |\n", $1, $2, $3 }'
    exit
    ;;
esac
if ! echo "$modes" | sed 's/[ |].*//' | grep -qxF -- "$mode"; then
  echo "check.sh has no mode '$mode'" >&2
  bash "$0" --help >&2
  exit 2
fi

# Runs ctest and ends with "N passed, M failed". A test that was skipped without an excuse has failed.
run_tests() {
  local preset=$1 log=build/ctest-$mode.log
  shift
  (cd "build/$preset" && ctest --output-on-failure --no-tests=error -j "$(nproc)" "$@") 2>&1 | tee "$log"
  local status=${PIPESTATUS[0]} failed total
  failed=$(sed -n 's/.* tests passed, \([0-9]*\) tests* failed out of .*/\1/p' "$log" | tail -n1)
  total=$(sed -n 's/.* failed out of \([0-9]*\).*/\1/p' "$log" | tail -n1)
  [ -n "$total" ] || die "ctest ran nothing"
  skips "build/$preset" "$log"
  local unexcused=$?
  [ $unexcused -eq 0 ] || status=1 failed=$((failed + unexcused))
  echo "$((total - failed)) passed, $failed failed"
  return "$status"
}

# total_of FILE: the sum of its lines "N passed, M failed"; good when some passed and none failed.
total_of() {
  awk '/^[0-9]+ passed, [0-9]+ failed$/ { passed += $1; failed += $3 }
    END { print passed + 0 " passed, " failed + 0 " failed"; exit failed > 0 || passed == 0 }' "$1"
}

if [ "$mode" != quick ] && [ "$mode" != release ]; then
  # shellcheck disable=SC2086
  {
    need $library_packages libgtest-dev
    want "the tool redman and its tests" $tool_packages
    want "robots, objects and tasks out of files, and their tests" $import_packages
    want "test format" clang-format-14
    want "tests test_python_*" python3 python3-numpy python3-h5py
    want "what tests test_python_* ask of types" mypy
    want "the manual pages and test manual" help2man
    want "the site and its test" python3-sphinx python3-myst-parser furo
    want "a case of test_occupancy_file" octomap-tools
    want "pages that turn in test_tool_pages" $viewer_packages
  }
fi
case $mode in
  release)
    exec bash cmake/release.sh "${@:2}"
    ;;
  quick)
    [ -f build/dev/build.ninja ] || configure dev
    cmake --build --preset dev -j "$(nproc)" --target quick >&2 || die "preset dev could not be built: see above"
    run_tests dev -L '^quick$'
    ;;
  dev)
    configure dev
    build dev
    run_tests dev -LE slow
    ;;
  asan | tsan)
    configure "$mode"
    build "$mode"
    export UBSAN_OPTIONS=print_stacktrace=1 TSAN_OPTIONS=suppressions=$PWD/tests/hard/tsan.supp
    only=()
    [ "$mode" = asan ] || only=(-L threads)
    run_tests "$mode" -LE 'slow|format' "${only[@]}"
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
  older)
    # A processor without AVX2: other widths, other last bits of networks, no carry-less products.
    configure dev -B build/older -DCMAKE_CXX_FLAGS=-DRDM_BASE_CPU
    cmake --build build/older -j "$(nproc)" >&2 || die "the build for an older processor failed: see above"
    base_cpu=yes
    run_tests older -LE 'slow|format'
    ;;
  clang)
    # Another compiler at -O3 gives the same bytes: what is undefined shows where optimisers differ.
    need clang-14
    configure dev -B build/clang -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DREDMAN_WERROR=OFF -DREDMAN_TESTS_TOGETHER=OFF \
      -DREDMAN_TOOL=OFF '-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O3 -g1'
    cmake --build build/clang -j "$(nproc)" --target redman test_golden test_golden_learners test_stepper test_vec >&2 || die "the build with clang failed: see above"
    run_tests clang -R '^(test_golden|test_golden_learners|golden_other_libm|test_stepper|test_vec)$'
    status=$?
    bash cmake/cross/row.sh clang '`clang`: x86-64, clang 14 -O3' build/ctest-clang.log build/clang/libredman.so clang-14 env >&2
    exit $status
    ;;
  languages)
    # The program of examples/LANGUAGE in every language: the tools are Debian's, where there are no others.
    need bindgen libclang1-14 libclang-common-14-dev luajit libjna-java mono-mcs mono-runtime ruby swig python3-cffi
    for tool in rustc:rustc go:golang-go javac:default-jdk-headless node:nodejs npm:npm; do
      command -v "${tool%%:*}" > /dev/null || need "${tool#*:}"
    done
    configure dev
    cmake --build --preset dev -j "$(nproc)" --target redman redman_tool >&2 || die "preset dev could not be built: see above"
    [ -e build/node_modules/koffi ] || npm install --prefix build --no-audit --no-fund koffi@3 > build/koffi.log 2>&1 ||
      die "cannot install koffi: $(tail -n1 build/koffi.log)"
    run_tests dev -L '^languages$'
    ;;
  packages)
    # .deb files, lintian, a wheel, each used in a Debian root that has nothing else (as root: debootstrap); the reference; the
    # ABI; a runner of policies alone.
    need debootstrap lintian doxygen abigail-tools patchelf python3-pip python3-setuptools python3-wheel
    configure package
    build package
    rm -rf build/package/packages
    (cd build/package && cpack > cpack.log 2>&1) || { tail -n 5 build/package/cpack.log; die "cpack failed"; }
    wheel=$(bash cmake/wheel.sh build/package) || exit 1
    configure small
    build small
    passed=0 failed=0
    # part NAME COMMAND...: counts the command, or what its last line counts.
    part() {
      local name=$1 out=build/packages-$1.log
      shift
      "$@" > "$out" 2>&1
      local status=$? last
      last=$(tail -n1 "$out")
      case $last in
        *[0-9]' passed, '*' failed') passed=$((passed + ${last%% passed*})) last=${last#*passed, } failed=$((failed + ${last%% failed*})) ;;
        *) if [ $status -eq 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi ;;
      esac
      echo "== $name"
      cat "$out"
    }
    part lintian lintian --fail-on error,warning build/package/packages/*.deb
    part deb bash tests/packages/deb.sh build/package/packages build/package/bin/redman
    part wheel bash tests/packages/wheel.sh "$wheel" build/package/bin/redman
    part reference cmake --build build/package --target reference
    part abi sh tests/packages/abi.sh . cc
    part manual sh tests/packages/manual.sh build/package/bin/redman build/package/manual
    part small sh tests/packages/small.sh build/small build/package
    ls -l build/package/packages/*.deb "$wheel" | awk '{ print $5, $9 }'
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    ;;
  arm64)
    # 64-bit ARM under qemu: hashes of worlds and learners, contracts of the ABI, what the build says of a fused ODE;
    # with `all` the tests that take half an hour there too.
    need g++-aarch64-linux-gnu qemu-user-static googletest curl
    bash cmake/cross/deps.sh arm64 && bash cmake/cross/deps.sh arm64 contracted || exit 1
    configure arm64
    tests="golden golden_learners known_bytes fpmode simd rng kernels workers library contract_host contract_pool contract_agent
      contract_rollout"
    [ "${2:-}" != all ] || tests+=" elementary vec hash mlp adam gaussian policy policy_tensors pointnet bytes file map occupancy narrowphase convex manifold stepper
      articulated_world ode_world hostile_state pool_state pool_step learner oracle fingerprint contract_state every_algo every_task contract_tasks"
    # shellcheck disable=SC2046,SC2086
    cmake --build --preset arm64 -j "$(nproc)" --target redman redman_static 01_step 04_act $(printf 'test_%s ' $tests) >&2 ||
      die "preset arm64 could not be built: see above"
    # shellcheck disable=SC2086
    run_tests arm64 -R "^(test_($(echo $tests | tr ' ' '|'))|example_01_step)\$" | tee build/arm64.said
    sh tests/ports/contracted.sh "$PWD" aarch64-linux-gnu-g++ build/arm64/libredman.a | tee -a build/arm64.said
    sh tests/ports/neon.sh build/arm64/libredman.a aarch64-linux-gnu-objdump | tee -a build/arm64.said
    STRIP=aarch64-linux-gnu-strip bash cmake/cross/row.sh arm64 '`arm64`: 64-bit ARM, GCC 12, under qemu' build/ctest-arm64.log \
      build/arm64/libredman.so >&2
    total_of build/arm64.said
    ;;
  windows)
    # Windows under wine: the library as one DLL, hashes of worlds and learners, programs in C against the DLL, the tool.
    need g++-mingw-w64-x86-64-posix wine64 googletest curl
    bash cmake/cross/deps.sh windows || exit 1
    configure windows
    tests="golden golden_learners known_bytes fpmode rng kernels" # not elementary: its reference, sinl, is coarse there
    # shellcheck disable=SC2046,SC2086
    cmake --build --preset windows -j "$(nproc)" --target redman redman_static redman_tool 01_step 03_train $(printf 'test_%s ' $tests) >&2 ||
      die "preset windows could not be built: see above"
    # shellcheck disable=SC2086
    run_tests windows -R "^(test_($(echo $tests | tr ' ' '|'))|example_01_step|example_03_train)\$" | tee build/windows.said
    sh tests/ports/windows.sh "$PWD" build/windows | tee -a build/windows.said
    STRIP=x86_64-w64-mingw32-strip bash cmake/cross/row.sh windows '`windows`: x86-64, mingw-w64 GCC 12, under wine' build/ctest-windows.log \
      build/windows/bin/libredman.dll x86_64-w64-mingw32-gcc-posix cmake/cross/wine.sh >&2
    total_of build/windows.said
    ;;
  libc++)
    # Another standard library beside another compiler: clang's, unpacked into a folder since it is at odds with libunwind-dev.
    need clang-14 libc++1-14 libc++abi1-14
    bash cmake/cross/libcxx.sh || exit 1
    folder=$PWD/build/cross/libcxx
    configure dev -B build/libcxx -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DREDMAN_WERROR=OFF -DREDMAN_TOOL=OFF -DREDMAN_IMPORT=OFF \
      -DREDMAN_HARD=OFF -DREDMAN_TESTS_TOGETHER=OFF "-DCMAKE_CXX_FLAGS=-nostdinc++ -isystem $folder/include/c++/v1 -stdlib=libc++" "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1" \
      "-DCMAKE_EXE_LINKER_FLAGS=-L$folder/lib" "-DCMAKE_SHARED_LINKER_FLAGS=-L$folder/lib" "-DCMAKE_PREFIX_PATH=$folder" "-DCMAKE_BUILD_RPATH=$folder/lib"
    cmake --build build/libcxx -j "$(nproc)" --target redman test_golden test_golden_learners test_option test_text >&2 ||
      die "the build with libc++ failed: see above"
    run_tests libcxx -R '^test_(golden|golden_learners|option|text)$'
    status=$?
    bash cmake/cross/row.sh libcxx '`libc++`: x86-64, clang 14 and libc++ 14' "build/ctest-$mode.log" build/libcxx/libredman.so clang-14 env >&2
    exit $status
    ;;
  small)
    # What the library takes where there is little, beside the table of examples/small/README.md.
    bash cmake/small_table.sh
    ;;
  budget)
    need valgrind
    configure dev
    cmake --build --preset dev -j "$(nproc)" --target redman >&2 || die "preset dev could not be built: see above"
    configure release
    build release
    configure small
    build small
    bash cmake/budget.sh --time
    ;;
  embedded)
    # Policies as C source, on this machine and on Cortex-M processors under qemu, with a table of what they take.
    need clang-14 gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm valgrind
    configure dev
    cmake --build --preset dev -j "$(nproc)" --target redman_tool >&2 || die "the tool could not be built: see above"
    run_tests dev -V -R '^test_tool_(export_c|embedded)$'
    ;;
  pages)
    # Pages and glTF files in headless Chromium and other viewers; build/pages keeps them and what they look like.
    need chromium nodejs fonts-dejavu-core
    command -v npm > /dev/null || need npm
    configure dev
    cmake --build --preset dev -j "$(nproc)" --target redman_tool tests_tool >&2 || die "preset dev could not be built: see above"
    mkdir -p build/pages
    PAGES=$PWD/build/pages run_tests dev -R '^test_tool_(pages|view|events|solid)$'
    ;;
  browser)
    # The page of cmake/browser.sh in headless Chromium, as a file, and the library in Node; build/browser keeps what it looks like.
    need chromium fonts-dejavu-core
    bash cmake/browser.sh || exit 1
    node --no-experimental-fetch examples/browser/probe.cjs build/browser "$PWD" || exit 1
    node tests/browser/open_browser.cjs build/browser/page/index.html build/browser | tee build/browser/said
    passed=$(sed -n 's/^\([0-9]*\) passed, 0 failed$/\1/p' build/browser/said | tail -n1)
    [ -n "$passed" ] && bash cmake/cross/browser_row.sh "$passed" >&2
    ;;
  physics)
    # The truth table: each row of physics beside its analytic answer or MuJoCo's, the shipped skills at other substeps, and
    # the page that has them (lib/physics/README.md).
    configure dev
    cmake --build --preset dev -j "$(nproc)" --target truth redman_tool >&2 || die "preset dev could not be built: see above"
    bash cmake/truth_table.sh build/dev check
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
esac
