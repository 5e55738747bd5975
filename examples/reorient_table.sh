#!/usr/bin/env bash
# results/reorient.md's table of Reorient, learned: for each seed four stages one after the other, each from the run of the one
# before (whose options hold until others are given), then 500 fresh episodes of the task as it comes. Finished stages
# are kept and stopped ones go on, so the script can be stopped and called again.
#   bash examples/reorient_table.sh [OUT]   OUT: folder of the runs, default runs/reorient
# Environment: REDMAN (the tool), SEEDS ("1 2 3"), JOBS (seeds at once, one thread each; 2).
#   1 PPO, costs not counted, goals three times as wide: what turns an egg at all
#   2 PPO-Lag, goals twice as wide: off the fingertips
#   3 the same for long: goals
#   4 goals and observations as the task has them (a quaternion's sign is free), small steps, little noise
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/reorient} seeds=${SEEDS:-1 2 3}
mkdir -p "$out"
seen='right.joint_position,right.joint_velocity,object.*,right.action'

# stage SEED NUMBER FLAG...
stage() {
  local seed=$1 number=$2
  shift 2
  trained "$out/$seed.$number" --task reorient --seed "$seed" --envs 256 --threads 1 --no-tensorboard \
    --set turn_reward=20 --set reward_factor=0.02 --set action_repeat=3 \
    --set horizon=24 --set passes=4 --set minibatches=8 --set "actor_obs=$seen" --set "critic_obs=$seen" "$@"
}

# limited SEED NUMBER FLAG...: PPO-Lag, from the stage before.
limited() {
  local seed=$1 number=$2
  shift 2
  stage "$seed" "$number" --algo ppo_lag --from "$out/$seed.$((number - 1))/policy.rdm" --set cost_limit=1 \
    --set multiplier_normalized=false --set multiplier_lr=0.0005 "$@"
}

learn() {  # SEED
  stage "$1" 1 --set canonical_rotation=true --algo ppo --steps 8e6 --eval-every 20 --set success_angle=0.3 --set kl_target=0.03 &&
    limited "$1" 2 --steps 6.6e6 --eval-every 20 --set success_angle=0.2 --set warm_epochs=8 --set learning_rate=0.0004 \
      --set kl_target=0.03 --set multiplier_init=0.05 &&
    limited "$1" 3 --steps 110e6 --eval-every 40 --set success_angle=0.2 --set warm_epochs=6 --set learning_rate=0.0003 \
      --set kl_target=0.03 --set multiplier_init=0.6 --set std_schedule=linear --set init_std=0.25 --set std_min=0.08 &&
    limited "$1" 4 --set canonical_rotation=false --steps 40e6 --eval-every 40 --set success_angle=0.1 --set warm_epochs=6 \
      --set learning_rate=0.0002 --set kl_target=0.02 --set multiplier_init=0.4 --set std_schedule=linear --set init_std=0.15 --set std_min=0.06 &&
    kept "$out/$1.json" eval --policy "$out/$1.4" --set turn_reward=0 --episodes 500 --seed $((1000000 + $1)) &&
    kept "$out/$1.sampled.json" eval --policy "$out/$1.4" --stochastic --set turn_reward=0 --episodes 500 --seed $((1000000 + $1))
}

for seed in $seeds; do
  wait_turn
  learn "$seed" || echo "seed $seed failed: see $out/$seed.*.log" >&2 &
done
wait

echo "| seed | episodes with a goal | goals per episode | return | cost (limit 1) | episodes that fall | stochastic policy: episodes with a goal @ cost | control steps | training time, s |"
echo "|---|---|---|---|---|---|---|---|---|"
percent() { awk -v x="$1" 'BEGIN { printf "%.0f %%", 100 * x }'; }
for seed in $seeds; do
  f=$out/$seed.json s=$out/$seed.sampled.json
  if [ ! -s "$f" ] || [ ! -s "$s" ]; then continue; fi
  steps=0 wall=0
  for k in 1 2 3 4; do
    steps=$(awk -v a="$steps" -v b="$(value env_steps "$out/$seed.$k.json")" 'BEGIN { print a + b }')
    wall=$(awk -v a="$wall" -v b="$(value wall_seconds "$out/$seed.$k.json")" 'BEGIN { print a + b }')
  done
  printf "| %s | %s | %.2f | %.0f | %s | %s | %s @ %.2f | %.0f M | %.0f |\n" "$seed" "$(percent "$(value success_rate "$f")")" \
    "$(value success_steps_mean "$f")" "$(value return_mean "$f")" \
    "$(awk -v c="$(value cost_mean "$f")" "$marked BEGIN { print marked(c, 1) }")" "$(percent "$(value fall_rate "$f")")" \
    "$(percent "$(value success_rate "$s")")" "$(value cost_mean "$s")" "$(awk -v s="$steps" 'BEGIN { print s / 1e6 }')" "$wall"
done
