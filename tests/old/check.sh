#!/bin/sh
# check.sh ROOT LIBRARIES CC: what was made for release 0.1.0 goes on. Its examples, compiled with its header, find all their
# functions in today's library, at the version node that they had; compiled with today's headers they get warnings alone, and
# say the same.
set -u
root=$1 libraries=$2 cc=$3
old=$root/tests/old/redman-0.1.0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
status=0
wrong() { echo "$*"; status=1; }
cd "$work" || exit 1
export LD_LIBRARY_PATH=$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}

# make NAME SOURCE FLAGS...: a program of C99 that links the library.
make() {
  name=$1 source=$2
  shift 2
  "$cc" -std=c99 -O1 -Wall -Wextra -pedantic -Werror "$@" "$source" -o "$name" "-L$libraries" -lredman -lm > "$name.log" 2>&1 ||
    { wrong "$name cannot be made:"; head -n 20 "$name.log"; }
}
for file in "$old"/0*.c; do
  example=$(basename "$file" .c)
  make "$example-old" "$file" "-I$old"
  make "$example-new" "$file" "-I$root/include" -Wno-deprecated-declarations
  case $example in
    01_*) set -- 100 ;;
    02_*) set -- 50 2 ;;
    03_*) set -- 2 policy.rdm ;;
    04_*) set -- policy.rdm 100 ;;
    *) set -- 3 ;;
  esac
  for made in old new; do
    "./$example-$made" "$@" > "$example-$made.out" 2>&1 || { wrong "$example-$made ended with $?:"; tail -n 3 "$example-$made.out"; }
    # seconds and rates differ from run to run
    sed 's/[0-9.]* *\(s\|ms\|us\|ns\|steps\/s\)\b//g; s/[0-9]*[.][0-9]* million//' "$example-$made.out" > "$example-$made.said"
  done
  # what an agent sees is said by a member that configs of 0.1 do not have: it saw all, and learns otherwise
  case $example in 03_*) sed -i 's/^ *[0-9].*//' 03_train-*.said ;; esac
  diff "$example-old.said" "$example-new.said" || wrong "$example says something else with today's headers"
  if nm -D --undefined-only "$example-old" | grep ' rdm_' | grep -v '@REDMAN_1$' | grep '@'; then wrong "$example-old asks for another node"; fi
done
# Every old name, as a function and as a source would use it: those of 0.1, and with today's headers all that there were since.
uses() {
  echo '#include <redman/redman.h>'
  echo 'typedef void (*any)(void); int main(void) { const any all[] = {'
  sed 's/.*/  (any)&,/' "$1"
  echo '}; int n = RDM_ARGUMENT + RDM_BOX + RDM_SAMPLE + RDM_FLAG; unsigned i = 0; for (; i < sizeof all / sizeof *all; ++i) n -= !all[i];'
  echo 'return n != -1 + 2 + 0 + 2; }'
}
grep '^rdm_' "$root/capi/redman_old.symbols" > of_0_1.names
sed -n 's/^rdm_result \(rdm_[a-z_0-9]*\)(.*/\1/p' "$root/include/redman/deprecated.h" | grep -v '^rdm_import_' > since.names
uses of_0_1.names > of_0_1.c
uses since.names > since.c
make of_0_1 of_0_1.c "-I$old" -Wno-cast-function-type
./of_0_1 || wrong "names of 0.1 with its header: ended with $?"
make since since.c "-I$root/include" -DRDM_EXPERIMENTAL -Wno-deprecated-declarations -Wno-cast-function-type
./since || wrong "names since 0.1: ended with $?"
"$cc" -std=c99 -Wall -I"$root/include" -DRDM_EXPERIMENTAL -fsyntax-only since.c > warnings 2>&1
for name in $(sort -u of_0_1.names since.names) RDM_BOX; do
  grep -q "$name\b.*is deprecated" warnings || wrong "no warning for $name"
done
exit $status
