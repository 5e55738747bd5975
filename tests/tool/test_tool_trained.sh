#!/bin/sh
# test_tool_trained.sh TOOL: the policies that come with the tool do what examples/policies/README.md says of them, on
# other episodes: within the limit, and return and success as far off as chance may put them, by their own deviations.
. "$(dirname "$0")/tool.sh"
files=$here/../../examples/policies

# TASK RETURN DEVIATION COST LIMIT SUCCESS of a table
rows() { sed -n 's/^| `\([a-z0-9_]*\)` | trained | \([^ ]*\) +- \([^ ]*\) | \([^ ]*\) | \([^ ]*\) | [^|]* | \([0-9]*\)%.*/\1 \2 \3 \4 \5 \6/p' "$1" | sort; }
rows "$files/README.md" > said
[ "$(wc -l < said)" -eq "$(ls "$files" | grep -c '\.rdm$')" ] || { echo "a policy without a row, or a row without a policy"; failed=1; }
"$tool" baseline --policy trained --episodes 40 --seed 123 --json | tr '{' '\n' |
  sed -n 's/.*"task":"\([^"]*\)".*"return_mean":\([^,]*\).*"cost_mean":\[\([^],]*\).*"cost_stderr":\[\([^],]*\).*"success_rate":\([^,]*\).*/\1 \2 \3 \4 \5/p' |
  sort > now
[ -s now ] || { echo "no rows"; exit 1; }
[ "$(join said now | wc -l)" -eq "$(wc -l < said)" ] || { echo "a row is not measured"; failed=1; }
# 4 standard errors of a mean of 40 episodes and of one of 100
join said now | awk '
  function off(x) { return x < 0 ? -x : x }
  { room = 4 * $3 * sqrt(1 / 40 + 1 / 100) + 0.01 * off($2) + 0.01
    if (off($7 - $2) > room) { print $1 ": return " $7 ", said " $2 " +- " $3; bad = 1 }
    if ($5 != "-" && $8 - 3 * $9 > $5) { print $1 ": cost " $8 " +- " $9 " over its limit " $5; bad = 1 }
    p = $6 / 100; q = p < 0.02 ? 0.02 : p > 0.98 ? 0.98 : p
    if (off($10 - p) > 4 * sqrt(q * (1 - q) * (1 / 40 + 1 / 100))) { print $1 ": success " $10 ", said " p; bad = 1 } }
  END { exit bad }' || failed=1

# in other commands, and refused with the way out
"$tool" eval --task jenga --policy trained --episodes 1 --json | grep -q '"policy":"trained","task":"jenga"' || { echo "eval"; failed=1; }
"$tool" eval --policy trained:jenga --episodes 1 --json | grep -q '"task":"jenga"' || { echo "the word's task"; failed=1; }
"$tool" export --policy trained:jenga --safetensors j > /dev/null || { echo "export"; failed=1; }
"$tool" export --policy trained --safetensors j 2> err && { echo "export of no task"; failed=1; }
grep -q 'give trained:TASK' err || { echo "no word of the task: $(cat err)"; failed=1; }
"$tool" render --task jenga --policy trained --step 3 --out j.png > /dev/null || { echo "render"; failed=1; }
"$tool" eval --task "$here/../../examples/scenes/touch.task" --policy trained 2> err && { echo "a task without one"; failed=1; }
grep -q 'none for task touch_puck.*there is one for .*jenga' err || { cat err; failed=1; }
"$tool" eval --policy trained:jemga 2> err
[ $? -eq 2 ] || { echo "an unknown task is wrong usage"; failed=1; }
grep -q 'nearest is jenga' err || { cat err; failed=1; }
exit $failed
