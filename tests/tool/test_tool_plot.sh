#!/bin/sh
# test_tool_plot.sh TOOL: seeds of a setting share a line, tasks have a row of panels each, a limit is drawn.
. "$(dirname "$0")/tool.sh"

for run in 'ball_run ppo_lag 0' 'ball_run ppo_lag 1' 'ball_run ppo 0' 'two_state ppo_lag 0'; do
  # shellcheck disable=SC2086
  set -- $run
  "$tool" train --task "$1" --algo "$2" --seed "$3" --envs 2 --steps 600 --set max_steps=20 --set horizon=50 \
    --out "$1.$2.$3" --json > /dev/null 2> err || exit 1
done

check() {  # check WHAT TEXT FILE COUNT
  count=$(grep -o -- "$2" "$3" | wc -l)
  [ "$count" -eq "$4" ] || { echo "$1: $count instead of $4"; failed=1; }
}

"$tool" plot ball_run.* --out one.svg --json > one || exit 1
check 'lines of one task' '"lines":2' one 1
check 'panels of one task' 'class="title"' one.svg 7
check 'the two seeds share a line' 'ppo_lag, limit 25 (2 runs)' one.svg 1
check 'the limit' 'class="level"' one.svg 1
"$tool" plot . --out all.svg --json > all || exit 1
check 'runs' '"runs":4,"lines":3' all 1
for task in ball_run two_state; do check "a row of $task" ">$task: return<" all.svg 1; done
check 'an algorithm is named once' 'class="legend"' all.svg 2
check 'the limits' 'class="level"' all.svg 2
"$tool" plot ball_run.* ball_run.ppo.0 ./ball_run.ppo.0 --out one.svg --json > one || exit 1
check 'a run that is named again is no other one' '"runs":3' one 1
"$tool" plot ball_run.* --each --out each.svg --json > each || exit 1
check 'lines of each' '"lines":3' each 1
# A run of other settings, here under a shield, is no seed of the others.
"$tool" train --task ball_run --algo ppo --seed 1 --envs 2 --steps 600 --set max_steps=20 --set horizon=50 --shield predict \
  --out shielded --json > /dev/null 2> err || exit 1
"$tool" plot ball_run.ppo.0 shielded --out two.svg --json > two || exit 1
check 'lines of two settings' '"lines":2' two 1
check 'what tells them apart' '>ppo: shield predict, limit 25<' two.svg 1
"$tool" plot . --out all.svg --json > all || exit 1
check 'seeds in the legend' '>ppo_lag (1 to 2 runs)<' all.svg 1
# A point is the mean of the epochs in its interval: returns of 9 and 11 in turn are drawn as 10.
cp -r ball_run.ppo.0 turns
awk -F, -v OFS=, 'NR == 1 { print; for (i = 1; i <= NF; ++i) at[$i] = i }
  NR == 2 { for (k = 1; k <= 1200; ++k) { $at["TotalEnvSteps"] = 10 * k; $at["Metrics/EpRet"] = 10 + (k % 2 ? 1 : -1); print } }' \
  ball_run.ppo.0/progress.csv > turns/progress.csv
"$tool" plot turns --out turns.svg --json > turns.json || exit 1
line=$(grep -o '<path class="line s[^>]*' turns.svg | head -n 1 | grep -o 'd="[^"]*')
points=$(echo "$line" | grep -o '[0-9.]* [0-9.]*' | wc -l) heights=$(echo "$line" | grep -o '[0-9.]* [0-9.]*' | cut -d' ' -f2 | sort -u | wc -l)
[ "$points" -eq 120 ] && [ "$heights" -eq 1 ] || { echo "means of epochs: $points points of $heights heights: $line"; failed=1; }
exit "$failed"
