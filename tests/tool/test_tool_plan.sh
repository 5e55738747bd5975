#!/bin/sh
# test_tool_plan.sh TOOL: episodes by planning: better than zero, the same for any threads, played again from their
# record, with a policy's proposals; wrong words are wrong usage.
. "$(dirname "$0")/tool.sh"

check() {  # check WHAT COMMAND...
  what=$1
  shift
  "$@" || { echo "$what"; failed=1; }
}
number() { grep -o "\"$1\":[^,}]*" "$2" | head -1 | cut -d: -f2; }
less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'; }

line="--task lqr_line --method cem --iterations 3 --horizon 8 --plan knots=8 --plan noise=0.1"
# shellcheck disable=SC2086
"$tool" plan $line --episodes 4 --seed 3 --json > one || exit 1
check 'not one line' test "$(wc -l < one)" -eq 1
for key in return_mean cost_mean fall_rate success_rate success_steps_mean ms_per_action steps_per_action feasible; do
  check "no $key" grep -q "\"$key\":" one
done
"$tool" eval --task lqr_line --policy zero --episodes 4 --envs 1 --seed 3 --json > zero || exit 1
check 'planning is no better than zero' less "$(number return_mean zero)" "$(number return_mean one)"
check 'steps of the rollouts' less 1000 "$(number steps_per_action one)"

# shellcheck disable=SC2086
"$tool" plan $line --episodes 4 --seed 3 --threads 3 --json > three || exit 1
check 'threads differ' test "$(number return_mean one)" = "$(number return_mean three)"
# the same planner as an actor by name, here and in eval
"$tool" eval --task lqr_line --envs 1 --seed 3 --episodes 4 --json \
  --policy plan:method=cem,iterations=3,horizon=8,knots=8,noise=0.1 > word || exit 1
check 'eval plays another planner' test "$(number return_mean one)" = "$(number return_mean word)"

# a record is played again, to the same hash
# shellcheck disable=SC2086
"$tool" plan $line --episodes 2 --record plans.npz --json > record || exit 1
"$tool" rollout --policy plans.npz --json > replay || exit 1
check 'the record is another course' test "$(number return_mean record)" = "$(number return_mean replay)"
hash=$(grep -o '"hash":"[^"]*"' replay | head -1 | cut -d: -f2)
check 'the record ends elsewhere' grep -q "\"recorded_hash\":$hash" replay

# a policy proposes
"$tool" train --task lqr_line --steps 2000 --envs 4 --set horizon=20 --out runs/line --json > train 2> err || { cat err; exit 1; }
"$tool" plan --policy runs/line --samples 1 --horizon 2 --episodes 5 --seed 4 --json > proposed || exit 1
"$tool" eval --policy runs/line --episodes 5 --envs 1 --seed 4 --json > alone || exit 1
check 'a policy alone acts otherwise in a planner' \
  test "$(number return_mean proposed)" = "$(number return_mean alone)"

# and one with a memory, which goes along in what the planner tries
for memory in memory=gru:6 history=4; do
  "$tool" train --task lqr_line --steps 2000 --envs 4 --set horizon=20 --set $memory --out runs/$memory --json > train 2> err || { cat err; exit 1; }
  "$tool" plan --policy runs/$memory --samples 1 --horizon 2 --episodes 5 --seed 4 --json > proposed || exit 1
  "$tool" eval --policy runs/$memory --episodes 5 --envs 1 --seed 4 --json > alone || exit 1
  check "a policy with $memory acts otherwise in a planner" \
    test "$(number return_mean proposed)" = "$(number return_mean alone)"
done

# a run's critic values the end: a plan of one step sees further by it
short="--horizon 1 --samples 64 --plan noise=0.3 --plan discount=0.9 --episodes 20 --seed 5"
# shellcheck disable=SC2086
"$tool" plan --task lqr_line $short --json > blind || exit 1
# shellcheck disable=SC2086
"$tool" plan --task lqr_line --critic runs/line $short --json > valued || { cat valued; exit 1; }
check 'the critic is not asked' test "$(number return_mean blind)" != "$(number return_mean valued)"
grep -q '"policy":"plan:.*critic=runs/line"' valued || { echo 'the word lacks the critic'; failed=1; }
# the text of plan is that of eval
# shellcheck disable=SC2086
"$tool" plan $line --episodes 4 --seed 3 > plan.txt
"$tool" eval --task lqr_line --envs 1 --seed 3 --episodes 4 \
  --policy plan:method=cem,iterations=3,horizon=8,knots=8,noise=0.1 > eval.txt
grep -v 'ms per action' plan.txt > text
check 'texts of plan and eval differ' cmp text eval.txt

refused() {  # refused STATUS TEXT ARGUMENTS...
  status=$1 text=$2
  shift 2
  "$tool" "$@" > out 2> err
  got=$?
  check "redman $*: exit status $got, not $status: $(cat err)" test "$got" -eq "$status"
  check "redman $*: no '$text' in: $(cat err)" grep -q -- "$text" err
}
refused 2 'nearest is samples' plan --task lqr_line --plan sampels=3
refused 2 'method' plan --task lqr_line --method guess
refused 2 'not key=value' plan --task lqr_line --plan samples
refused 2 'nearest is horizon' eval --task lqr_line --policy plan:horizn=3
refused 1 'was trained in task lqr_line' plan --task bandit --critic runs/line
refused 1 'config.json' plan --task lqr_line --critic nowhere
refused 1 'policy file or a run folder' plan --task lqr_line --policy zero
exit $failed
