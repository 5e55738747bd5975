#!/bin/sh
# test_tool_trained.sh TOOL: the policies that come with the tool keep what examples/policies/README.md says of them:
# the limit, the return within a tenth, success within 15 of 100 episodes.
. "$(dirname "$0")/tool.sh"
table=$here/../../examples/policies/README.md
files=$here/../../examples/policies

rows() { sed -n 's/^| `\([a-z0-9_]*\)` | trained | \([^ ]*\) +- [^ ]* | \([^ ]*\) | \([^ ]*\) | [^|]* | \([0-9]*\)%.*/\1 \2 \3 \4 \5/p' "$1"; }
rows "$table" > said
[ "$(wc -l < said)" -eq "$(ls "$files" | grep -c '\.rdm$')" ] || { echo "a policy without a row, or a row without a policy"; failed=1; }
"$tool" baseline --policy trained --episodes 40 --seed 123 --markdown > measured || exit 1
rows measured > now
[ -s now ] || { echo "no rows: $(cat measured)"; exit 1; }
join said now | awk '
  { d = $6 - $2; if (d < 0) d = -d; tenth = $2 < 0 ? -$2 / 10 : $2 / 10; if (tenth < 0.5) tenth = 0.5
    if (d > tenth) { print $1 ": return " $6 ", said " $2; bad = 1 }
    if ($4 != "-" && $7 > $4) { print $1 ": cost " $7 " over its limit " $4; bad = 1 }
    if ($9 < $5 - 15) { print $1 ": success " $9 " %, said " $5; bad = 1 } }
  END { exit bad }' || failed=1
[ "$(join said now | wc -l)" -eq "$(wc -l < said)" ] || { echo "a row is not measured"; failed=1; }

# in other commands, and refused with the way out
"$tool" eval --task jenga --policy trained --episodes 1 --json | grep -q '"policy":"trained","task":"jenga"' || { echo "eval"; failed=1; }
"$tool" eval --policy trained:jenga --episodes 1 --json | grep -q '"task":"jenga"' || { echo "the word's task"; failed=1; }
"$tool" export --policy trained:jenga --safetensors j > /dev/null || { echo "export"; failed=1; }
"$tool" render --task jenga --policy trained --step 3 --out j.png > /dev/null || { echo "render"; failed=1; }
"$tool" eval --task bandit --policy trained 2> err && { echo "a task without one"; failed=1; }
grep -q 'none for task bandit.*there is one for .*jenga' err || { cat err; failed=1; }
"$tool" eval --policy trained:jemga 2> err
[ $? -eq 2 ] || { echo "an unknown task is wrong usage"; failed=1; }
grep -q 'nearest is jenga' err || { cat err; failed=1; }
exit $failed
