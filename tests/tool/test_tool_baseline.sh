#!/bin/sh
# test_tool_baseline.sh TOOL: the floor rows of tasks: three policies each and the demonstration, as `eval` gives them.
. "$(dirname "$0")/tool.sh"

check() {  # check WHAT COMMAND...
  what=$1
  shift
  "$@" || { echo "$what"; failed=1; }
}

"$tool" baseline --task ball_run --task two-state --episodes 20 --json > rows || exit 1
check 'not one line' test "$(wc -l < rows)" -eq 1
for task in ball_run two_state; do
  for policy in zero hold random; do
    check "no row $task $policy" grep -q "{\"task\":\"$task\",\"policy\":\"$policy\",\"episodes\":20," rows
  done
done
check 'six rows, for neither has a demonstration' test "$(grep -o '"policy"' rows | wc -l)" -eq 6

# a ball at rest costs nothing; the random one falls short of the finish too
"$tool" baseline --task ball_run --episodes 20 --markdown > table || exit 1
check 'the ball at rest' grep -q '^| `ball_run` | zero *| -\{0,1\}0.00 +- 0.00 | 0.00 ' table

# the same numbers as eval, for any number of threads
mean() { grep -o "$1[^{]*" "$2" | head -1 | grep -o '"return_mean":[^,]*'; }
"$tool" eval --task ball_run --policy random --episodes 20 --json > one || exit 1
check 'eval differs' test "$(mean '"policy":"random"' rows)" = "$(mean '"policy":"random"' one)"
"$tool" baseline --task ball_run --task two_state --episodes 20 --threads 3 --json > again || exit 1
check 'threads differ' cmp -s rows again

# a demonstration has its row, beside the floors, with the options that it was written for
"$tool" baseline --task grasp --episodes 4 --json > grasp || exit 1
check 'no row of the demonstration' grep -q '"policy":"demo","episodes":4,' grasp
"$tool" eval --task grasp --policy demo --episodes 4 --json > demo || exit 1
check 'the demonstration is another one' \
  test "$(mean '"policy":"demo"' grasp)" = "$(grep -o '"return_mean":[^,]*' demo)"

"$tool" baseline --task nothing > out 2> err
check 'an unknown task is wrong usage' test $? -eq 2
exit $failed
