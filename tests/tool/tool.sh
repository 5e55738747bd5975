# What every test of the tool begins with, sourced as `. "$(dirname "$0")/tool.sh"`: the tool's path, the folder of
# the tests, and an empty folder of its own to work in, which goes when the test ends.
set -u
tool=$(realpath "$1")
here=$(cd "$(dirname "$0")" && pwd)
failed=0
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1

# The columns before the first Time/ column.
curve() {
  awk -F, 'NR == 1 { for (i = NF; i > 0; --i) if ($i ~ /^Time\//) last = i - 1 }
           { for (i = 1; i <= last; ++i) printf "%s%s", $i, i < last ? "," : "\n" }' "$1/progress.csv"
}
# same RUN OTHER WHAT: two runs learned the same, policy and curve; else failed=1, with WHAT said.
same() {
  curve "$1" > a
  curve "$2" > b
  cmp -s a b || { echo "$2/progress.csv differs from $1's ($3)"; failed=1; }
  cmp -s "$1/policy.rdm" "$2/policy.rdm" || { echo "$2/policy.rdm differs from $1's ($3)"; failed=1; }
}
# wrong STATUS TEXT COMMAND...: the tool ends with that status, and its error has the text; else failed=1.
wrong() {
  status=$1 says=$2
  shift 2
  "$tool" "$@" > out 2> err
  [ $? -eq "$status" ] || { echo "$*: the status is not $status"; cat err; failed=1; }
  grep -q -- "$says" err || { echo "$*: the error does not say '$says':"; cat err; failed=1; }
}
