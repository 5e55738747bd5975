#!/usr/bin/env bash
# small_table.sh [write]: what the library takes where there is little, measured: the programs of examples/small, made for
# size (-Os), linked statically (without unused sections, stripped) and against a shared library that has all in it. The
# table is compared with that of examples/small/README.md, each number within a tenth, or written there.
set -u
cd "$(dirname "$0")/.." || exit 1
. cmake/packages.sh
readme=examples/small/README.md
folder=build/small-table
mkdir -p $folder

# shellcheck disable=SC2086
need $build_packages googletest curl
bash cmake/cross/deps.sh native || exit 1 # static engines, as Debian has none of libccd
configure small
build small
# The same flags with everything in it. The engine is told of no AVX, since the memory that worlds take depends on its lanes, and the
# table shall be that of every machine.
configure small -B build/small-all -DREDMAN_SIM=ON -DREDMAN_LEARN=ON -DREDMAN_TOOL=OFF -DREDMAN_IMPORT=OFF -DREDMAN_INSTALL=OFF \
  '-DCMAKE_CXX_FLAGS_MINSIZEREL=-Os -DNDEBUG -DRDM_BASE_CPU'
cmake --build build/small-all -j "$(nproc)" --target redman redman_static >&2 || die "the whole library could not be built for size: see above"
echo 'int main(void) { return 0; }' > $folder/nothing.c
engines="-lode -lccd -loctomap -loctomath -lstdc++" static=build/cross/native/lib
# program NAME SOURCE BUILD LIBRARIES...: a static and a dynamic one, stripped.
program() {
  local name=$1 source=$2 build=$3
  shift 3
  gcc -std=c99 -Os -s -static -Wl,--gc-sections -Iinclude "$source" ${build:+"build/$build/libredman.a"} -L$static "$@" -lm -o "$folder/$name" ||
    die "$name could not be linked"
  [ -z "$build" ] || gcc -std=c99 -Os -s -Iinclude "$source" "-Lbuild/$build" -lredman "-Wl,-rpath,$PWD/build/$build" -o "$folder/$name-shared" ||
    die "$name-shared could not be linked"
}
program nothing $folder/nothing.c ""
program act examples/small/act.c small
# shellcheck disable=SC2086
{ program worlds examples/small/worlds.c small-all $engines && program train examples/small/train.c small-all $engines; } || exit 1

# stack COMMAND...: the least `ulimit -s`, kB, that it runs with, in steps of 4.
stack() {
  local low=4 high=1024 middle
  while [ $((high - low)) -gt 4 ]; do
    middle=$(((low + high) / 2 / 4 * 4))
    if (ulimit -s $middle && "$@") > /dev/null 2>&1; then high=$middle; else low=$middle; fi
  done
  echo $high
}
kb() { echo $((($1 + 999) / 1000)); }
# row TITLE BUILD PROGRAM ARGUMENT...
row() {
  local title=$1 build=$2 name=$3 said shared library=-
  shift 3
  said=$("$folder/$name" "$@") || die "$name $* ended with $?"
  shared=$("$folder/$name-shared" "$@") || die "$name-shared $* ended with $?"
  library=$(kb "$(stat -L -c %s "build/$build/libredman.so")")
  echo "| $title | $(kb "${said#* }") | ${said% *} | ${shared% *} | $(stack "$folder/$name" "$@") | $(kb "$(stat -c %s "$folder/$name")") | $library |"
}
policy=examples/policies/hand_over_safe_finger.rdm
task=hand_over_safe_finger
{
  echo '| use | memory asked for, kB | resident, static, kB | resident, shared, kB | stack, kB | static program, kB | shared library, kB |'
  echo '|---|---|---|---|---|---|---|'
  "$folder/nothing"
  echo "| nothing: an empty C program | 0 | - | - | $(stack "$folder/nothing") | $(kb "$(stat -c %s "$folder/nothing")") | - |"
  row "a policy acts (\`$task\`)" small act $policy
  row "1 world steps (\`point_goal1\`)" small-all worlds point_goal1 1
  row "1 world steps (\`$task\`)" small-all worlds $task 1
  row "16 worlds step (\`$task\`)" small-all worlds $task 16
  row "16 worlds train, \`horizon=16\`, \`hidden=32,32\`" small-all train $task horizon=16 hidden=32,32
  row "16 worlds train, defaults" small-all train $task
} > $folder/table.md
cat $folder/table.md
small=$(stat -L -c %s build/small/libredman.so)
[ "$small" -lt 150000 ] || die "the library of policies alone has $small bytes, 150000 are allowed"

if [ "${1:-}" = write ]; then
  awk -v table=$folder/table.md '
    /^<!-- table -->/ { print; while ((getline line < table) > 0) print line; skip = 1; next }
    /^<!-- end -->/ { skip = 0 }
    !skip' $readme > $folder/readme && cp $folder/readme $readme
  exit
fi
# each number within a tenth (or 8, a page or two) of what is written
sed -n '/^<!-- table -->/,/^<!-- end -->/p' $readme | grep '^|' | paste -d '\n' - $folder/table.md | awk -F'|' '
  NR % 2 { split($0, was, "|"); n = NF; next }
  { if (NF != n) bad = bad "\n" $0
    for (i = 2; i < NF; ++i) {
      a = was[i] + 0; b = $i + 0; away = a > b ? a - b : b - a
      good = was[i] ~ /^ *[0-9]+ *$/ ? away <= 8 || away <= 0.1 * a : was[i] == $i
      if (good) ++passed; else { ++failed; print "written:" was[i] "; measured:" $i " in" $2 } } }
  END { print passed + 0 " passed, " failed + 0 " failed"; exit failed > 0 || passed == 0 || bad != "" }'
