#!/bin/sh
# test_tool_props.sh TOOL: every demonstration does what it claims, from starts that are drawn, on the default engine:
# bottles are lifted by their necks, a broom is held and swept, a block leaves its tower, throws are caught, a cube is
# lifted and a block turned, costs under their limits. Bounds are about three standard errors off what is measured
# (in parentheses): a skill that is lost shows, a bit that changes does not.
. "$(dirname "$0")/tool.sh"

number() { grep -o "\"$1\":\[*[-0-9.e+]*" row | head -1 | grep -o '[-0-9.e+]*$'; }

# demo TASK RETURN COST SUCCESS EPISODES [FLAGS...]: at least that return and success, at most that cost
demo() {
  task=$1 return=$2 cost=$3 success=$4 episodes=$5
  shift 5
  "$tool" eval --task "$task" --policy demo --episodes "$episodes" "$@" --json > row ||
    { echo "$task fails"; failed=1; return; }
  got="$(number return_mean) $(number cost_mean) $(number success_rate)"
  echo "$got" | awk -v r="$return" -v c="$cost" -v s="$success" '{ exit !($1 >= r && $2 <= c && $3 >= s) }' ||
    { echo "$task: return, cost, success are $got"; failed=1; }
}

# Loose things stand up to a millimetre off their places.
demo pick_bottles 330 2.5 0.8 16 --set reset_noise=0.001     # (333, 0, 100 %)
demo jenga 610 5 0.8 16 --set reset_noise=0.001              # (629, 0, 100 %)
demo clean_house 19000 5 0.9 16 --set reset_noise=0.003      # (19056, 0, 100 %)
# Throws and grasps are drawn by themselves.
demo hand_over_safe_finger 22 0.5 0.83 200                   # (24.3, 0.03, 91 %)
demo hand_over_safe_joint 18.5 0.5 0.7 200                   # (21.4, 0, 80 %)
demo catch_underarm_safe_finger 9.3 0.5 0.33 200             # (11.4, 0.03, 44 %)
demo catch_underarm_safe_joint 8.5 0.5 0.3 200               # (10.9, 0, 40 %)
demo hand_over_wall 8.6 3 0.22 200                           # (10.4, 1.7, 32 %)
demo grasp 710 12 0.82 100                                   # (925, 6.7, 99 %)
demo reorient 39.5 3 0 200                                   # (46.8, 1.3); hold has 34.7 at 7.5
exit $failed
