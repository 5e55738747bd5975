#!/bin/sh
# small.sh SMALL FULL: what preset `small` installs. The headers are those of what the libraries have (test `header` compiles each); the
# shared library is under 150 kB and needs the C library alone; a program in C links the static one without the compiler of C++,
# shared or whole. A policy trained with the library of FULL acts the same with all of them. Prints sizes and start times.
set -eu
small=$1 full=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
wrong() { echo "$*"; status=1; }

cmake --install "$small" --prefix "$work/small" > /dev/null
include=$work/small/include lib=$work/small/lib
headers=$(cd "$include/redman" && echo *)
[ "$headers" = "base.h base.hpp deprecated.h policy.h policy.hpp redman.h redman.hpp" ] || wrong "these headers are installed: $headers"
awk -v mode=stable -f "$root/tests/rules/header.awk" "$include/redman/base.h" "$include/redman/policy.h" | sort > "$work/declared"
grep -o 'rdm_[a-z_0-9]*(' "$include/redman/deprecated.h" | tr -d '(' | sort -u - "$work/declared" > "$work/known"
for library in "-D $lib/libredman.so" "$lib/libredman.a"; do
  # shellcheck disable=SC2086
  nm -g --defined-only $library | awk 'NF == 3 && $2 != "A" && $2 != "u" { sub(/@.*/, "", $3); print $3 }' | sort > "$work/has"
  comm -23 "$work/declared" "$work/has" | sed "s|$|: a header has it, not ${library##*/}|" > "$work/differs"
  comm -13 "$work/known" "$work/has" | sed "s|$|: no header has it, but ${library##*/}|" >> "$work/differs"
  [ ! -s "$work/differs" ] || wrong "$(cat "$work/differs")"
done

bytes=$(stat -L -c %s "$lib/libredman.so")
[ "$bytes" -lt 150000 ] || wrong "libredman.so has $bytes bytes"
# only_libc FILE NAME...: it needs the C library, the loader and what is named
only_libc() {
  file=$1
  shift
  for name in $(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
    case " $* " in *" $name "*) continue ;; esac
    case $name in libc.so.* | libm.so.* | ld-linux-*) ;; *) wrong "$(basename "$file") needs $name" ;; esac
  done
}
only_libc "$lib/libredman.so"
echo "libredman.so: $bytes bytes, libredman.a: $(stat -c %s "$lib/libredman.a") bytes"

"$full/bin/redman" train --task hand_over_safe_finger --envs 16 --steps 12000 --seed 0 --set hidden=128,128 --out "$work/run" > "$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
policy=$work/run/policy.rdm
# runner NAME INCLUDE LIBRARIES...
runner() {
  name=$1 from=$2
  shift 2
  cc -std=c99 -Os "-I$from" "$root/tests/packages/small.c" "$@" -s -o "$work/$name" || { wrong "$name was not linked"; return; }
  "$work/$name" "$policy" 1000 > "$work/$name.out" || wrong "$name ended with $?"
  diff "$work/full.out" "$work/$name.out" || wrong "$name does not act as the full library does"
  if "$work/$name" "$work/none" 1 2> "$work/said"; then wrong "$name reads a file that is not there"; fi
  grep -q 'none: cannot open' "$work/said" || wrong "$name says of a file that is not there: $(cat "$work/said")"
}
runner full "$root/include" "-L$full" -lredman "-Wl,-rpath,$(realpath "$full")"
runner shared "$include" "-L$lib" -lredman "-Wl,-rpath,$lib"
runner archive "$include" "$lib/libredman.a" -lm
runner own "$include" -static-libgcc -Wl,--gc-sections "$lib/libredman.a" -lm
runner static "$include" -static -Wl,--gc-sections "$lib/libredman.a" -lm
# it has no call that takes a state
"$full/bin/redman" train --task hand_over_safe_finger --envs 4 --steps 256 --seed 0 --set memory=gru:8 --set horizon=64 --out "$work/gru" > "$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
if "$work/shared" "$work/gru/policy.rdm" 1 2> "$work/said"; then wrong "a policy with a memory is read"; fi
grep -q 'has a memory or reads points, which' "$work/said" || wrong "it says of a policy with a memory: $(cat "$work/said")"
only_libc "$work/archive" libgcc_s.so.1 # the unwinder
only_libc "$work/own"
# beside a C++ runtime of the program's own
printf '#include <redman/redman.hpp>\n#include <cstdio>\nint main() try { redman::Policy p("none"); } catch (const redman::Error& e) { std::puts(e.what()); }\n' > "$work/owner.cpp"
for how in -pie -static; do
  c++ -std=c++17 $how "-I$include" "$work/owner.cpp" "$lib/libredman.a" -o "$work/owner" && [ "$("$work/owner")" = "none: cannot open: No such file or directory" ] ||
    wrong "a program in C++ does not run with libredman.a $how"
done
for name in full shared archive own static; do
  spent=$( { i=0; while [ $i -lt 100 ]; do "$work/$name" "$policy" 1 > /dev/null; i=$((i + 1)); done; times; } | tail -n1 |
    awk '{ for (i = 1; i <= 2; ++i) { split($i, t, /[ms]/); sum += 60 * t[1] + t[2] } printf "%.1f", 10 * sum }')
  echo "$name: $(stat -c %s "$work/$name") bytes, $spent ms of processor time from start to the first action and the end"
done
exit $status
