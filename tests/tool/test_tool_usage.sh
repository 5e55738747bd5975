#!/bin/sh
# test_tool_usage.sh TOOL: exit statuses, nearest names, and that --json leaves one JSON object on stdout.
. "$(dirname "$0")/tool.sh"

# expect STATUS TEXT ARGUMENTS...: the exit status, and a text that stderr holds in one line.
expect() {
  status=$1 text=$2
  shift 2
  "$tool" "$@" > out 2> err
  got=$?
  if [ "$got" -ne "$status" ]; then
    echo "redman $*: exit status $got, not $status: $(cat err)"
    failed=1
  fi
  if [ -n "$text" ] && ! grep -q -- "$text" err; then
    echo "redman $*: stderr has no '$text': $(cat err)"
    failed=1
  fi
  if [ "$status" -ne 0 ] && [ "$(wc -l < err)" -ne 1 ]; then
    echo "redman $*: stderr has $(wc -l < err) lines, not 1"
    failed=1
  fi
}

expect 0 '' --help
expect 0 '' train --help
for words in '' train 'bench step' 'data make'; do  # `help WORDS` is `WORDS --help`
  # shellcheck disable=SC2086
  [ "$("$tool" help $words)" = "$("$tool" $words --help)" ] || { echo "redman help $words differs from redman $words --help"; failed=1; }
done
"$tool" completion bash > completion
grep -q "^ *'help') words='.* train " completion && grep -q "^ *'data make') words='.* grasp " completion &&
  ! grep "^ *'data info')" completion | grep -q planner || { echo "completion has other words: $(cat completion)"; failed=1; }
expect 0 ''
grep -q '^Train and play:' out || { echo "redman alone shows no help: $(cat out)"; failed=1; }
expect 2 'nearest is train' trian
expect 2 'redman train --help' train --no-such-flag 3
expect 2 'nearest is hand_over_safe_finger' train --task hand_over_safe_fingr
expect 2 'nearest is ppo_lag' train --algo ppo_lagg
expect 2 'nearest is hidden' train --set hiden=3
expect 2 'has option nonsense_of_all$' train --set nonsense_of_all=3
expect 2 'not key=value' train --set hidden
expect 2 'outside' train --set clip=-1
expect 0 '' rollout --task grasp --policy zero --set max_steps=2 --set 'noise.*_tip_*=0.01..0.02' --set action_delay=1..3
expect 2 'nearest is object.position' rollout --task grasp --policy zero --set noise.object.positon=0.1
expect 2 'it takes one number, not a range' rollout --task grasp --policy zero --set frequency=30..60
long='right.joint_position,right.joint_velocity,right.joint_force,right.action,object.*'  # more than RDM_TEXT_SIZE has room for
expect 0 '' train --task grasp --set "actor_obs=$long" --envs 2 --set horizon=8 --set minibatches=1 --steps 32 --threads 1 --no-tensorboard --out long
grep -q "\"actor_obs\": *\"$long\"" long/config.json || { echo "config.json has another actor_obs: $(cat long/config.json)"; failed=1; }
expect 0 '' train --resume long --steps 64
expect 2 'names no field of the observation; nearest is object.spin' train --task grasp --set actor_obs=object.spn
expect 2 'not a number' train --cost-limit many
expect 2 'nearest is drop' train --cost-limit dropp=1
expect 2 'envs' rollout --envs 0
expect 2 'camera' render --camera frnt
expect 2 'WIDTHxHEIGHT' render --size 64
expect 2 '' eval --episodes 0
expect 1 'no such file' eval --policy nothing.rdm
expect 1 'not a run folder' train --resume nothing
expect 1 'dev/null is not a run folder: it is no folder$' train --resume /dev/null
expect 1 'holds no run' plot nothing
printf 'not a policy' > bad.rdm
expect 1 'bad.rdm' eval --policy bad.rdm
[ ! -d runs ] || { echo "a wrong call left a run folder behind"; failed=1; }

# Hyphens, capitals and underscores in names and flags.
expect 0 '' rollout --task Hand-Over-Safe-Finger --policy ZERO --set Max-Steps=2
expect 0 '' rollout --TASK hand_over_safe_finger --set max_steps=2 --num_envs 1

# json KEYS ARGUMENTS...: stdout is one line that holds an object with these keys.
json() {
  keys=$1
  shift
  "$tool" "$@" --json > out 2> err || { echo "redman $*: failed: $(cat err)"; failed=1; }
  if [ "$(wc -l < out)" -ne 1 ] || ! grep -q '^{.*}$' out; then
    echo "redman $* --json: stdout is not one object on one line"
    failed=1
  fi
  for key in $keys; do
    grep -q "\"$key\":" out || { echo "redman $* --json: no key $key"; failed=1; }
  done
}

json 'tasks name summary obs_dim action_dim cost_dim costs limit max_steps control_dt fields unit offset count
      options key default low high help defaults initial_mean' tasks
json 'defaults initial_mean action_repeat discount presets' tasks hand_over_safe_finger
# What a preset leaves: nothing of an object in vision, no goal in touch, no forces in proprioception.
"$tool" tasks grasp > out
for row in 'object.position .* state' 'goal.position .* state vision' 'right.ff_tip_force .* state vision touch' \
  'right.joint_position .* state vision touch proprioception'; do
  grep -q "^$row *$" out || { echo "tasks grasp has no row '$row'"; failed=1; }
done
# The layout of other robots, before anything is trained.
"$tool" tasks grasp --set hand=allegro --set arm=ur5e > out || failed=1
for row in '188 observations, 22 actions' 'right.arm_position .* 0 ' '0 *right_shoulder_pan_joint' '21 *right_thj3'; do
  grep -q "^$row" out || { echo "tasks grasp of other robots has no row '$row'"; failed=1; }
done
expect 2 'has no option hnd; nearest is hand' tasks grasp --set hnd=allegro
expect 2 'name the task' tasks --set hand=allegro
json 'action_order joints obs_dim' tasks grasp --set hand=allegro
json 'algos name summary params key default low high help' algos
json 'version abi ode eigen ccd octomap precision compiler' info
json 'run policy env_steps wall_seconds steps_per_second return cost cost_stderr success_rate cost_limit feasible fall_rate length' \
  train --envs 4 --steps 200 --set max_steps=10 --out run
json 'episodes return_mean return_std return_stderr cost_mean cost_std cost_stderr success_rate length_mean violation_rate fall_rate
      cost_per_step success_stderr return_iqm interval interval_level return_quantiles cost_interval cost_quantiles cost_cvar
      cvar_share cost_over_rate remarks' eval --policy run/policy.rdm --episodes 3
json 'episodes return_mean cost_mean length_mean fall_rate hash' rollout --policy random --set max_steps=5
json 'file width height frames frames_per_second' render --step 2 --size 32x24 --out a.png
json 'file width height frames frames_per_second' render --strip 3 --size 32x24 --out b.png --to 4
json 'task envs threads steps_per_second steps_per_cpu_second bytes_per_env allocations_per_step max_joint_drift_m contacts_mean
      contacts_max overflowed diverged' \
  bench step --envs 2 --seconds 0.05
json 'samples_per_second allocations_per_update bytes' \
  bench update --obs 8 --act 2 --hidden 16,16 --samples 256 --minibatch 64 --seconds 0.01
json 'horizon calls policy_act_us ticks ticks_per_update tick_us median p99 p99.9 p99.99 worst' \
  bench latency --envs 2 --calls 100 --ticks 20 --hz 0 --set horizon=2 --set hidden=8
json 'actions_per_second' bench act --obs 8 --act 2 --hidden 16,16 --seconds 0.01
json 'file' plot run --out curve.svg
json 'file frames' render --to 3 --glb c.glb
json 'file runs ranking feasible return_sd cost_sd return_iqm interval group normalised_return normalised_cost training_cost_rate
      training_violating_steps remarks' report run --episodes 2 --strip 0 --html report.html
for file in a.png b.png curve.svg c.glb report.html run/config.json run/progress.csv run/policy.rdm run/checkpoint.rdm; do
  [ -s "$file" ] || { echo "$file was not written"; failed=1; }
done

# Of an option that task and algorithm have, the value says whose it is; what neither takes is refused with the words of one.
json cost train --task jenga --envs 1 --steps 8 --set max_steps=8 --set preset=real --set preset=omnisafe --overwrite --out whose
grep -q '"preset=real"' whose/config.json || { echo "the task has no preset: $(cat whose/config.json)"; failed=1; }
grep -q '"preset=omnisafe"' whose/config.json || { echo "the algorithm has no preset: $(cat whose/config.json)"; failed=1; }
json cost train --task hand_over_safe_finger --envs 1 --steps 8 --set max_steps=8 --set cost_signal=target --set cost_signal=raw --overwrite --out whose
expect 2 "'best' is not one of redman|real" train --task jenga --steps 8 --set preset=best --out whose2

# A run that learned magnitudes is judged by magnitudes, wherever it is met again.
signal() { grep -q "\"cost_signal\":\"$1\"" out || { echo "costs that are not $1: $(cat out)"; failed=1; }; }
json cost train --task ball_circle --envs 4 --steps 400 --set max_steps=20 --set cost_signal=raw --out raw
signal raw
json cost_mean eval --policy raw --episodes 3
signal raw
json cost_mean eval --task ball_circle --policy zero --episodes 3
signal flag

# One limit, by one flag; the limit of a step is that of an episode.
expect 2 'both are the limit on column 0' train --task bandit --cost-limit 3 --set cost_limit=4 --out no
expect 2 'column cost has two limits, 3 and cost=4' eval --task bandit --policy zero --cost-limit 3 --cost-limit cost=4
expect 2 'both are limits on column 0' train --task ball_run --cost-limit 3 --set cost_limit_per_step=0.1 --out no
json cost train --task ball_run --algo ppo_lag --envs 4 --steps 400 --set max_steps=20 --set cost_limit_per_step=0.1 --out rated
grep -q '"cost_limit":2.0' out || { echo "the limit of 20 steps of 0.1: $(cat out)"; failed=1; }
json cost_mean eval --policy rated --episodes 2
grep -q '"cost_limits":\[2.0' out || { echo "eval has another limit: $(cat out)"; failed=1; }
grep -q '"cost": 2.0' rated/config.json || { echo "config.json has another limit"; failed=1; }

press=$here/../../examples/scenes/press.task  # whose column 0 has another name
json cost train --task "$press" --envs 2 --steps 200 --set max_steps=20 --set horizon=20 --set cost_limit_per_step=0.1 --out pressed
json cost_mean eval --policy pressed --episodes 1
grep -q '"cost_limits":\[2.0' out || { echo "a task of one's own has another limit: $(cat out)"; failed=1; }

# Files that are read are not written over, and two files need two names.
cp run/policy.rdm kept.rdm
expect 2 'it is the file of --policy' export --policy kept.rdm --c kept.rdm
expect 2 'it is the file of --onnx' export --policy kept.rdm --c a.c --onnx ./a.c
expect 2 'it is the file of --out' rollout --task bandit --policy zero --out r.csv --record r.csv
cmp -s run/policy.rdm kept.rdm || { echo "the policy was written over"; failed=1; }

# A limit of the learner is none of option budget, which has its own.
expect 0 'give --set limit=3' eval --task ball_run --policy zero --episodes 1 --set budget=end --cost-limit 3

# Failures keep the promise of --json too, and a folder that holds a run is not written over.
"$tool" train --task nothing --json > out 2> err
[ $? -eq 2 ] && grep -q '^{"error":' out || { echo "a failure with --json printed: $(cat out)"; failed=1; }
expect 1 'holds a run already' train --out run
exit $failed
