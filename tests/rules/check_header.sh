#!/bin/sh
# The public headers compile alone, and together in later dialects, without a warning, no struct of the C ones has hidden
# padding, everything in them has a comment, and no line is longer than 100 columns. Arguments: the project's
# root, a C and a C++ compiler. The owners in C++ compile without exceptions, too, and where REDMAN_THROW is
# not given then, they say so. What a library of policies alone installs compiles without the other headers.
set -u
root=$1 cc=$2 cxx=$3 include=$1/include
status=0
strict='-Wall -Wextra -pedantic -Werror -fsyntax-only'
try() { # try COMPILER LANGUAGE HEADER DIALECT
  padded=-Wpadded
  case $3 in *.hpp) padded= ;; esac
  case $3 in redman.* | deprecated.h) macros='RDM_STABLE_ONLY RDM_EXPERIMENTAL' ;; *) macros=RDM_STABLE_ONLY ;; esac
  for macro in $macros; do
    # shellcheck disable=SC2086
    printf '#include <redman/%s>\n' "$3" | "$1" -x "$2" "-std=$4" "-D$macro" "-I$include" $strict $padded - ||
      { echo "$3 as $4 with $1: see above"; status=1; }
  done
}
headers=$(cd "$root/include/redman" && ls -- *.h)
owners=$(cd "$root/include/redman" && ls -- *.hpp)
for compiler in "$cc" clang; do
  command -v "$compiler" > /dev/null || continue
  for header in $headers; do try "$compiler" c "$header" c99; done
  for dialect in c11 c17; do try "$compiler" c redman.h $dialect; done
done
for compiler in "$cxx" clang++; do
  command -v "$compiler" > /dev/null || continue
  for header in $headers $owners; do try "$compiler" c++ "$header" c++17; done
  for header in redman.h redman.hpp; do try "$compiler" c++ "$header" c++20; done
  for header in $owners; do
    # shellcheck disable=SC2086
    printf '#define REDMAN_THROW(error) ((void)(error).what(), __builtin_trap())\n#include <redman/%s>\n' "$header" |
      "$compiler" -x c++ -std=c++17 -fno-exceptions -fno-rtti "-I$root/include" $strict - ||
      { echo "$header without exceptions with $compiler: see above"; status=1; }
  done
  echo '#include <redman/redman.hpp>' | "$compiler" -x c++ -std=c++17 -fno-exceptions "-I$root/include" -fsyntax-only - 2>&1 |
    grep -q 'error: .*define REDMAN_THROW' || { echo "redman.hpp without exceptions asks for no REDMAN_THROW with $compiler"; status=1; }
done
include=$(mktemp -d) || exit 1
trap 'rm -rf "$include"' EXIT
sh "$root/cmake/policy_headers.sh" "$root/include" "$include" || status=1
for header in $(cd "$include/redman" && ls); do
  case $header in
    *.h) try "$cc" c "$header" c99 ;;
    *) try "$cxx" c++ "$header" c++17 ;;
  esac
done
bare=$(awk -v mode=docs -f "$root/tests/rules/header.awk" "$root"/include/redman/*.h)
[ -z "$bare" ] || { echo "$bare"; status=1; }
wide=$(cd "$root/include/redman" && grep -n '.\{101\}' -- *)
[ -z "$wide" ] || { echo "longer than 100 columns: $wide"; status=1; }
exit $status
