#!/bin/sh
# slow_tool_demonstrate.sh TOOL: 20 demonstrations of press.task through the page of `view`, by a pointer in headless Chromium, are cloned
# to a policy that presses the button in nine of ten fresh episodes (77, a skip, without node and chromium).
. "$(dirname "$0")/tool.sh"
for need in node "${CHROMIUM:-chromium}"; do
  command -v "$need" > /dev/null || { echo "skipped: there is no $need"; exit 77; }
done
task=$(realpath "$here/../../examples/scenes/press.task")
node "$here/demonstrate.cjs" "$tool" "$task" press.npz 20 press.png || exit 1
"$tool" train --task "$task" --algo ppo --from press.npz --clone-epochs 600 --clone-rate 0.0003 --set hidden=256,256 --steps 1 --out clone --json \
  > out 2> err || { cat err; exit 1; }
"$tool" eval --policy clone --episodes 100 --seed 1000 --json > played 2> err || { cat err; exit 1; }
grep -o '"success_rate":[0-9.]*\|"cost_mean":\[[0-9.]*' played
success=$(sed 's/.*"success_rate":\([0-9.]*\).*/\1/' played)
awk -v s="$success" 'BEGIN { exit !(s >= 0.9) }' || { echo "the clone presses the button in $success of its episodes"; exit 1; }
