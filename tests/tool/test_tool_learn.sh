#!/bin/sh
# test_tool_learn.sh TOOL: `learn` makes of a recorded bandit a policy at its known optimum, for any number of threads the same
# bytes; the policy acts in eval as it was measured; what it cannot learn from is refused with what to do.
. "$(dirname "$0")/tool.sh"
one() { sed -n "s/.*\"$1\":\"*\([^,\"}]*\).*/\1/p" "$2"; }

"$tool" data make bandit --rows 3000 --out bandit.npz > /dev/null 2> err || { cat err; exit 1; }

# Reward -(a - 2)^2, cost max(a, 0) with the limit 1: the optimum is a = 1, return -1, cost 1, multiplier 2.
learn() { "$tool" learn --from bandit.npz --steps "$@" \
  --set hidden=24 --set activation=tanh --set learning_rate=2e-3 --set critic_learning_rate=1e-2 --set multiplier_gain=1 --set multiplier_lr=0.1; }
learn 8000 --out policy.rdm --json > learn.json 2> progress || { cat progress; exit 1; }
near() {
  awk -v x="$(one "$1" learn.json | tr -d '[]')" -v want="$2" -v most="$3" 'BEGIN { d = x - want; exit !(d < most && d > -most) }' ||
    { echo "$1 is $(one "$1" learn.json), not $2"; cat progress; failed=1; }
}
near return_mean -1 0.2
near cost_mean 1 0.1
near multiplier 2 0.5
near expected_cost 1 0.12
[ "$(grep -c 'steps: loss' progress)" -eq 10 ] || { echo 'there are not ten lines of progress'; failed=1; }
[ "$(one rows learn.json)" = 3000 ] || { echo 'not all rows are learned from'; failed=1; }
"$tool" eval --policy policy.rdm --task bandit --episodes 20 --json > eval.json || failed=1
[ "$(one return_mean eval.json)" = "$(one return_mean learn.json)" ] || { echo 'eval has another return'; failed=1; }

# Same bytes.
learn 300 --out a.rdm --episodes 0 > out 2> /dev/null || failed=1
grep -q 'wrote a.rdm' out || { echo 'it does not say what it wrote'; failed=1; }
grep -q 'episodes' out && { echo '--episodes 0 measures the policy'; failed=1; }
learn 300 --out b.rdm --episodes 0 --threads 2 > /dev/null 2>&1 || failed=1
cmp -s a.rdm b.rdm || { echo 'two threads: other bytes'; failed=1; }
learn 300 --out c.rdm --episodes 0 --seed 1 > /dev/null 2>&1 || failed=1
cmp -s a.rdm c.rdm && { echo 'another seed gives the same policy'; failed=1; }

# The options that the set was made with come with it; one of the command stands over them.
"$tool" data make ball_run --preset dsrl --rows 500 --out ball.npz > /dev/null || failed=1
"$tool" learn --from ball.npz --steps 20 --set hidden=8 --out ball.rdm --episodes 2 --json > ball.json 2> /dev/null || failed=1
[ "$(one length_mean ball.json)" = 100.0 ] || { echo 'the episodes that measure have another length than the set'; cat ball.json; failed=1; }
grep -q '"score":{"return":' ball.json || { echo 'there are no scores'; cat ball.json; failed=1; }

wrong 2 'ppo_lag learns from its own decisions alone; td3_bc_lag' learn --from bandit.npz --algo ppo_lag --out x.rdm
wrong 2 'nearest is td3_bc_lag' learn --from bandit.npz --algo td3_bc_la --out x.rdm
wrong 2 'replay_rows: 100 has no place' learn --from bandit.npz --set replay_rows=100 --out x.rdm
wrong 1 'nearest is bandit.npz' learn --from bandi.npz --out x.rdm
wrong 2 'out' learn --from bandit.npz
wrong 2 'action_repeat=3: a row of bandit.npz lasts 1 control step' learn --from bandit.npz --set action_repeat=3 --out x.rdm
wrong 2 'steps' learn --from bandit.npz --steps 0 --out x.rdm
exit $failed
