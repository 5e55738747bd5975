#!/bin/sh
# test_tool_props.sh TOOL: demonstrations do what they claim, on the default engine: bottles are lifted by their
# necks, a broom is held and swept, a block leaves its tower; throws are caught, costs under their limits.
. "$(dirname "$0")/tool.sh"

number() { grep -o "\"$1\":\[*[-0-9.e+]*" row | head -1 | grep -o '[-0-9.e+]*$'; }

# demo TASK RETURN COST SUCCESS [EPISODES]: at least that return and success, at most that cost
demo() {
  "$tool" eval --task "$1" --policy demo --episodes "${5:-1}" --json > row || { echo "$1 fails"; failed=1; return; }
  got="$(number return_mean) $(number cost_mean) $(number success_rate)"
  echo "$got" | awk -v r="$2" -v c="$3" -v s="$4" '{ exit !($1 >= r && $2 <= c && $3 >= s) }' ||
    { echo "$1: return, cost, success are $got"; failed=1; }
}

demo pick_bottles 300 0 1
demo jenga 600 0 1
demo clean_house 17500 30 1
demo hand_over_wall 9 3 0.25 300
demo catch_underarm_safe_finger 10.5 1 0.36 300
demo reorient 42 1.5 0 300
exit $failed
