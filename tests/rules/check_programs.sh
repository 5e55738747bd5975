#!/bin/sh
# check_programs.sh ROOT CC LIBRARY: each whole C program of README and the manual compiles without a warning and runs to the end.
set -u
root=$1 cc=$2 library=$(realpath "$3")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
status=0 programs=0
for page in "$root/README.md" "$root"/examples/manual/*.md; do
  rm -f "$scratch"/*.c
  awk -v out="$scratch/program" '/^```c$/ { n++; inside = 1; next } /^```$/ { inside = 0 } inside { print > (out n ".c") }' "$page"
  for program in $(grep -ls 'int main(' "$scratch"/*.c); do
    grep -q '"policy.c"' "$program" && continue # test_tool_export_c runs it, beside a policy
    programs=$((programs + 1))
    "$cc" -std=c99 -Wall -Wextra -Werror -I "$root/include" "$program" -o "$scratch/a.out" "$library" -lm \
      -Wl,-rpath,"$(dirname "$library")" > "$scratch/log" 2>&1 && (cd "$scratch" && ./a.out > log 2>&1) ||
      { echo "$page: a C program does not compile, or fails:"; cat "$scratch/log"; status=1; }
  done
done
[ $programs -ge 3 ] || { echo "only $programs programs were found"; status=1; }
exit $status
