#!/bin/sh
# small.sh SMALL FULL: the library of preset `small` is under 150 kB, needs the C library alone, and a policy trained with
# the library of FULL acts the same with both; a program without any shared library too. Prints sizes and start times.
set -eu
small=$1 full=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
wrong() { echo "$*"; status=1; }

bytes=$(stat -L -c %s "$small/libredman.so")
[ "$bytes" -lt 150000 ] || wrong "libredman.so has $bytes bytes"
needs=$(readelf -d "$small/libredman.so" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | tr '\n' ' ')
for name in $needs; do
  case $name in libc.so.* | libm.so.* | ld-linux-*) ;; *) wrong "libredman.so needs $name" ;; esac
done
echo "libredman.so: $bytes bytes, needs $needs"

"$full/bin/redman" train --task hand_over_safe_finger --envs 16 --steps 12000 --seed 0 --set hidden=128,128 --out "$work/run" > "$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
policy=$work/run/policy.rdm
# runner NAME LIBRARIES...
runner() {
  name=$1
  shift
  cc -std=c99 -Os "-I$root/include" "$root/examples/04_act.c" "$@" -s -o "$work/$name"
  "$work/$name" "$policy" 1000 > "$work/$name.out" || wrong "$name ended with $?"
}
runner full "-L$full" -lredman "-Wl,-rpath,$(realpath "$full")"
runner small "-L$small" -lredman "-Wl,-rpath,$(realpath "$small")"
runner static -static -Wl,--gc-sections "$small/libredman.a" -lstdc++ -lm
cat "$work/small.out"
for name in small static; do
  # what scratch takes differs with the vector unit
  sed 's/[0-9]* bytes of scratch/scratch/' "$work/$name.out" > "$work/said"
  sed 's/[0-9]* bytes of scratch/scratch/' "$work/full.out" | diff - "$work/said" || wrong "$name does not act as the full library does"
done
for name in full small static; do
  spent=$( { i=0; while [ $i -lt 100 ]; do "$work/$name" "$policy" 1 > /dev/null; i=$((i + 1)); done; times; } | tail -n1 |
    awk '{ for (i = 1; i <= 2; ++i) { split($i, t, /[ms]/); sum += 60 * t[1] + t[2] } printf "%.1f", 10 * sum }')
  echo "$name: $(stat -c %s "$work/$name") bytes, $spent ms of processor time from start to the first action and the end"
done
exit $status
