#!/bin/sh
# test_tool_slips.sh TOOL: what a command line says twice, what has no effect and what cannot be written is refused before the
# work, or said.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
# told TEXT COMMAND...: the tool ends with 0, and stderr has the text.
told() { text=$1; shift; wrong 0 "$text" "$@"; }
# silent TEXT COMMAND...: it ends with 0, and stderr does not have the text.
silent() {
  text=$1
  shift
  "$tool" "$@" > out 2> err || say "$*: $(cat err)"
  grep -q -- "$text" err && say "$*: stderr has '$text'"
}
one='--task ball_run --episodes 1 --set max_steps=3'
small='--task ball_run --envs 2 --steps 20 --set max_steps=10 --set horizon=10 --set hidden=8 --set minibatches=1 --no-tensorboard'

# One option, once.
wrong 2 'option Max-Steps is given twice' eval $one --set Max-Steps=4
wrong 2 'option hidden is given twice' train $small --set hidden=9 --out no
wrong 2 'option rounds is given twice' eval $one --policy hold --shield predict:rounds=2,rounds=3
wrong 2 'option samples is given twice' plan $one --samples 2 --plan samples=3
wrong 2 'option samples is given twice' eval $one --policy plan:samples=2,samples=3
wrong 2 'option passes is given twice' bench update --set passes=2 --set passes=3
wrong 2 'it is given 2 times' plan $one --samples 2 --samples 3

wrong 2 'both are the limit on column 0; give one; nothing was started' sweep --tasks ball_run --cost-limit 3 --set cost_limit=4 --out no
wrong 2 'option hidden is given twice.*; nothing was started' sweep --tasks ball_run --set hidden=8 --vary hidden=4,8 --out no
wrong 2 'column cost has two limits' plan $one --cost-limit 3 --cost-limit cost=4

# What is here a flag.
wrong 2 'give --modality' bench observe --set modality=voxels
wrong 2 'give --horizon' bench policy --set horizon=4
wrong 2 'it is the flag --seed' train $small --set seed=3 --out no
exit $failed
