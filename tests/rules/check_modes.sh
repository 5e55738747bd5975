#!/bin/sh
# check.sh --help lists its modes and no others, the page has that table, an unknown mode is refused; each test that
# tests/skips.txt excuses is there, and a skip without an excuse counts. Argument: the project's root.
set -u
cd "$1" || exit 1
failed=0
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
say() { echo "$*"; failed=1; }
script=cmake/check.sh
bash $script --help | sed -n 's/^  \([^ ]*\).*/\1/p' | sort > "$scratch/modes"
sed -n 's/^  \([a-z0-9+| ]*\))$/\1/p' $script | tr -d ' ' | tr '|' '\n' | grep -v '^--\|^-h$' | sort |
  diff "$scratch/modes" - || say "$script --help lists other modes than it has"
said=$(bash $script no_such_mode 2>&1)
[ $? -eq 2 ] || say "an unknown mode is no usage error"
case $said in
  *"no mode 'no_such_mode'"*quick*hard*) ;;
  *) say "an unknown mode: $said" ;;
esac
bash $script release no_such_mode 2>&1 | grep -q "no mode 'no_such_mode' for a release" || say "an unknown mode of a release is not refused"
bash $script --markdown | while IFS= read -r row; do
  grep -qxF -- "$row" CONTRIBUTING.md || echo "$row"
done | grep . && say "CONTRIBUTING.md has other rows: bash cmake/tables.sh writes them"
grep -v '^#' tests/skips.txt | while read -r name _; do
  case $name in
    *.*) pattern=$(echo "$name" | sed 's/^\*\///; s/\..*//'); grep -rqE "^(TEST|TEST_F|TEST_P)\($pattern," tests ;;
    language_*) [ -d "examples/${name#language_}" ] ;;
    arm64_short | abi | generators | site) grep -q "NAME $name " tests/CMakeLists.txt ;;
    *) ls tests/*/$name.* > /dev/null 2>&1 ;;
  esac || echo "tests/skips.txt excuses $name, which is no test"
done | grep . && failed=1

# skipped EXPECTED SANITIZER LINE...: so many skips of a run that said these lines have no excuse.
skipped() {
  expected=$1
  echo "REDMAN_SANITIZE:STRING=$2" > "$scratch/CMakeCache.txt"
  shift 2
  mkdir -p "$scratch/Testing/Temporary"
  printf '%b\n' "$@" | tee "$scratch/said" > "$scratch/Testing/Temporary/LastTest.log"
  bash -c '. cmake/skips.sh; skips "$1" "$1/said"' skips "$scratch" 2> "$scratch/err"
  got=$?
  [ $got -eq "$expected" ] || say "$*: $got skips without an excuse, $expected are: $(cat "$scratch/err")"
}
skipped 0 ''
skipped 0 '' '\t 12 - test_tool_export (Skipped)'  # this build has no modules of npm
grep -q 'test_tool_export, as there is no ' "$scratch/err" || say "no reason: $(cat "$scratch/err")"
skipped 1 '' '\t 12 - test_simple (Skipped)'
skipped 2 '' '\t 12 - test_simple (Skipped)' '[  SKIPPED ] Adam.NoHeap' '[  SKIPPED ] Adam.NoHeap (0 ms)'
skipped 1 'thread' '\t 12 - test_simple (Skipped)' '[  SKIPPED ] Adam.NoHeap'
exit $failed
