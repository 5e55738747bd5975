#!/usr/bin/env bash
# results/other_hands.md's tables of other hands and of drawn dynamics, measured again: every row is trained from scratch with the task's
# defaults (PPO-Lag), for several seeds, and evaluated on fresh episodes. Finished runs are kept, so the script can be
# stopped and called again.
#   bash examples/hands_table.sh [OUT]      OUT: folder of the runs, default runs/hands
# Environment: REDMAN (the tool), SEEDS ("0 1 2"), JOBS (runs at once, one thread each; 2), STEPS (factor on each row's; 1).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/hands}
seeds=${SEEDS:-0 1 2}
mkdir -p "$out"

# NAME TASK STEPS SETTINGS: grasp asks for a wrist, so these hands are on an arm.
rows="hand_over.allegro hand_over_safe_finger 3e6 hand=allegro
hand_over.shadow_allegro hand_over_safe_finger 3e6 right.hand=shadow,left.hand=allegro
hand_over.allegro.ur5e hand_over_safe_finger 3e6 hand=allegro,arm=ur5e,arm_range=0.1
hand_over.shadow_allegro.ur5e hand_over_safe_finger 3e6 right.hand=shadow,left.hand=allegro,arm=ur5e,arm_range=0.1
grasp.allegro.ur5e grasp 1.5e6 hand=allegro,arm=ur5e
grasp.svh.ur5e grasp 1.5e6 hand=svh,arm=ur5e
grasp.barrett.ur5e grasp 3e6 hand=barrett,arm=ur5e
grasp.robotiq.ur5e grasp 1.5e6 hand=robotiq,arm=ur5e"
# Mass of the cube (71 g) and friction: as the task has them, and drawn within 30 % of that.
plain="object_mass=0.071,friction.hand_object=0.75,friction.object_ground=1,friction.hand_ground=1"
drawn="object_mass=0.0497..0.0923,friction.hand_object=0.525..0.975,friction.object_ground=0.7..1.3,friction.hand_ground=0.7..1.3"

# settings TEXT: --set flags of a list with commas.
settings() { local IFS=,; for s in $1; do printf -- '--set %s ' "$s"; done; }

# shellcheck disable=SC2046
{
  while read -r name task steps text; do
    for seed in $seeds; do
      wait_turn
      trained "$out/$name.$seed" --task "$task" --seed "$seed" --steps "$(awk "BEGIN { print $steps * ${STEPS:-1} }")" $(settings "$text") &
    done
  done <<< "$rows"
  for kind in plain drawn; do
    for seed in $seeds; do
      wait_turn
      trained "$out/$kind.$seed" --task grasp --seed "$seed" --steps "$(awk "BEGIN { print 2e6 * ${STEPS:-1} }")" $(settings "${!kind}") &
    done
  done
  wait
  for kind in plain drawn; do
    for seed in $seeds; do
      for where in plain drawn; do
        wait_turn
        kept "$out/$kind.$seed.$where.json" eval --policy "$out/$kind.$seed" --episodes 500 --seed $((2000000 + seed)) $(settings "${!where}") &
      done
    done
  done
  wait
}

# each KEY LIMIT FILE...: the numbers of several runs, their mean first; those over the limit are marked.
each() {
  local key=$1 limit=$2
  shift 2
  for f in "$@"; do value "$key" "$f"; done |
    awk -v limit="$limit" "$deviation"'{ s += $1; t = t (NR > 1 ? ", " : "") sprintf("%.4g", $1) (limit != "" && $1 > limit + 0 ? "!" : "") }
      END { printf "%.4g%s (%s)", s / NR, deviation(t), t }'
}
percent() {
  local key=$1
  shift
  for f in "$@"; do value "$key" "$f"; done | awk '{ s += $1 } END { printf "%.0f %%", 100 * s / NR }'
}

echo "| task | hands | return, mean +- sd (each seed) | cost (limit) | success rate | episodes that fall |"
echo "|---|---|---|---|---|---|"
while read -r name task steps text; do
  files=()
  for seed in $seeds; do files+=("$out/$name.$seed.json"); done
  limit=$(value cost_limit "${files[0]}")
  echo "| \`$task\` | \`${text//,/ }\` | $(each return "" "${files[@]}") | $(each cost "$limit" "${files[@]}") (${limit%.0})" \
    "| $(percent success_rate "${files[@]}") | $(percent fall_rate "${files[@]}") |"
done <<< "$rows"
echo
echo "| grasp, trained with | evaluated with nominal dynamics: return, cost, success rate | with drawn dynamics: return, cost, success rate |"
echo "|---|---|---|"
for kind in plain drawn; do
  line="| $([ $kind = plain ] && echo 'nominal mass and friction' || echo 'mass and friction drawn within 30 %')"
  for where in plain drawn; do
    files=()
    for seed in $seeds; do files+=("$out/$kind.$seed.$where.json"); done
    line="$line | $(each return_mean "" "${files[@]}"), $(each cost_mean 25 "${files[@]}"), $(percent success_rate "${files[@]}")"
  done
  echo "$line |"
done
