#!/bin/sh
# check_language.sh ROOT LIBRARY WORK LANGUAGE: the program of examples/LANGUAGE prints what C's did, byte by byte, and
# says what is wrong with a policy that is not there. Language c comes first: check_language.sh ROOT LIBRARY WORK c TOOL
# trains the policy of all, for seconds. 77: a tool of the language is missing.
set -u
root=$1 REDMAN_LIBRARY=$2 WORK=$3 language=$4
export REDMAN_LIBRARY WORK
policy=$WORK/run/policy.rdm said=$WORK/$language.txt refused=$WORK/$language.none errors=$WORK/$language.err
mkdir -p "$WORK"

# printed POLICY FILE: what the program prints goes to FILE.
printed() { bash "$root/examples/languages.sh" "$language" "$1" > "$2" 2> "$errors"; }
fail() {
  echo "$language: $*"
  cat "$said" "$errors"
  exit 1
}

if [ "$language" = c ]; then
  "$5" train --task hand_over_safe_finger --envs 16 --steps 4000 --out "$WORK/run" --overwrite > /dev/null 2> "$errors" ||
    { cat "$errors"; exit 1; }
fi
printed "$policy" "$said"
case $? in
  0) ;;
  77) cat "$said"; exit 77 ;;
  *) fail "does not run" ;;
esac
if [ "$language" = c ]; then
  number='-\{0,1\}[0-9.]\{1,\}' hash='[0-9a-f]\{16\}'
  [ "$(grep -cx "hold cost $number hash $hash\|policy return $number cost $number hash $hash" "$said")" -eq 2 ] ||
    fail "prints other lines than a cost and a hash each"
  [ "$(sed 's/.*hash //' "$said" | sort -u | wc -l)" -eq 2 ] || fail "the policy moved nothing"
else
  cmp -s "$said" "$WORK/c.txt" || fail "prints other lines than C, which are: $(cat "$WORK/c.txt")"
fi
if printed "$WORK/none.rdm" "$refused"; then fail "is content with a policy that is not there"; fi
grep -q 'none\.rdm: cannot open: No such file or directory' "$errors" || fail "does not say what is wrong with the policy"
# Short programs, and the table of examples/README.md says how short.
lines=$(cat "$root/examples/$language"/[hH]ello.* | wc -l)
[ "$lines" -lt 120 ] || fail "has $lines lines"
[ "$language" = c ] || grep -q "]($language/[hH]ello[.a-z]*) | $lines |" "$root/examples/README.md" ||
  fail "examples/README.md does not say that the program has $lines lines"
cat "$said"
