#!/bin/sh
# test_tool_view.sh TOOL: the command `view`: its flags, own tasks, that it ends as it is asked to; and its page in headless
# Chromium, where that is there (77, a skip, where it is not). PAGES=DIR keeps what it looks like.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
pages=${PAGES:-$dir/pages}
mkdir -p "$pages"
pages=$(realpath "$pages")

status() {  # status WANTED TEXT FLAGS...: a command that ends at once
  wanted=$1 text=$2
  shift 2
  "$tool" view "$@" > out 2> err
  [ $? -eq "$wanted" ] && grep -q -- "$text" err || say "view $*: $(cat out err)"
}
"$tool" view --task ball_run --policy nothing.rdm > out 2> err
if grep -q 'no viewer library' err; then
  echo "skipped: this build has no viewer library"
  exit 77
fi
status 2 'at most 64 worlds' --task ball_run --envs 65
status 2 'port' --task ball_run --port 99999
status 2 'nonsense' --task ball_run --shield nonsense
status 2 'nonsense' --task nonsense
status 1 'no such file' --task ball_run --policy nothing.rdm
mkdir taken
status 1 'taken' --task ball_run --record taken

# With what signal it is asked to end, it tells what it did; nothing was played, as nobody looked.
begun() {  # begun SIGNAL FLAGS...
  signal=$1
  shift
  : > err
  "$tool" view "$@" --json > out 2>> err &
  pid=$!
  for _ in $(seq 400); do
    grep -q '^http://127.0.0.1:[0-9]*/[0-9a-f]\{32\}/$' err && break
    sleep 0.05
  done
  kill -"$signal" $pid
  wait $pid || say "view $*: $(cat err)"
  grep -q '"steps":0,' out && [ "$(wc -l < out)" -eq 1 ] || say "view $*: $(cat out err)"
}
begun INT --task hand_over_safe_finger --envs 2 --policy random
cp err first
begun TERM --task bandit
[ "$(sed 's/.*:[0-9]*//' first)" != "$(sed 's/.*:[0-9]*//' err)" ] || say "two views have the same token"
"$tool" tasks "$here/../../examples/scenes/press.task" > /dev/null 2>&1 && begun INT --task "$here/../../examples/scenes/press.task"

reason=
if ! command -v node > /dev/null; then
  reason="there is no node"
else  # a window changes no byte, and gets its frames
  : > err
  "$tool" view --task hand_over_safe_finger --policy demo --seed 3 --envs 2 --paused --json > out 2>> err &
  pid=$!
  for _ in $(seq 400); do grep -q '^http' err && break; sleep 0.05; done
  node "$here/view_client.cjs" "$(grep '^http' err)" > seen || say "no window: $(cat err)"
  kill -TERM $pid
  wait $pid || say "view: $(cat err)"
  cat seen
  "$tool" rollout --task hand_over_safe_finger --policy demo --seed 3 --envs 2 --episodes 2 --json > played
  hash=$(grep -o '"hash":"[0-9a-f]*"' seen)
  grep -q "$hash" played || say "worlds with a window: $(cat seen), without: $(cat played)"
fi
if [ -n "$reason" ]; then
  :
elif ! command -v "${CHROMIUM:-chromium}" > /dev/null; then
  reason="there is no chromium"
else
  node "$here/open_view.cjs" "$tool" "$pages" || failed=1
  if [ -f "$pages/by_hand.npz" ]; then  # what was done by hand teaches
    "$tool" train --task hand_over_safe_finger --from "$pages/by_hand.npz" --steps 2000 --set hidden=16,16 --envs 4 --set horizon=50 --out run > out 2> err || say "train --from: $(cat err)"
    "$tool" rollout --policy "$pages/by_hand.npz" --json > out 2> err || say "rollout: $(cat err)"
  fi
fi
[ $failed -eq 0 ] || exit 1
[ -z "$reason" ] || { echo "skipped a part: $reason"; exit 77; }
