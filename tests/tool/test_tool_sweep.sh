#!/bin/sh
# test_tool_sweep.sh TOOL: a sweep that was killed and started again ends with the same bytes as one that was not; a wrong
# setting is one error before anything starts; a time that is over leaves runs that are gone on with.
. "$(dirname "$0")/tool.sh"
flags='--tasks bandit,two_state --algos ppo_lag,crpo --seeds 0..1 --steps 4000 --envs 8 --jobs 2 --set hidden=16 --set horizon=16'

# shellcheck disable=SC2086
"$tool" sweep $flags --out whole > table 2> err || { cat err; exit 1; }
[ "$(find whole -name policy.rdm | wc -l)" -eq 8 ] || { echo "not 8 runs: $(find whole -name policy.rdm)"; failed=1; }
grep -q '8 of 8 runs are done' table || { echo "the table does not say that all are done"; cat table; failed=1; }
[ "$(grep -c '^| bandit \|^| two_state ' whole/sweep.md)" -eq 4 ] || { echo "sweep.md has not four rows"; cat whole/sweep.md; failed=1; }

# Killed when some runs are over and others are not.
# shellcheck disable=SC2086
"$tool" sweep $flags --out broken > /dev/null 2>&1 &
pid=$!
while kill -0 $pid 2> /dev/null && [ "$(find broken -name policy.rdm 2> /dev/null | wc -l)" -lt 3 ]; do sleep 0.01; done
kill -9 $pid 2> /dev/null
wait $pid 2> /dev/null
for try in 1 2 3 4 5; do  # its runs end with it, but not at once: one that still writes is left to the next call
  # shellcheck disable=SC2086
  "$tool" sweep $flags --out broken > again 2> err && grep -q '8 of 8 runs are done' again && break
  sleep 1
done
[ "$try" -lt 5 ] || { echo "the sweep did not go on:"; cat err; failed=1; }
grep -q '8 of 8 runs are done' again || { echo "the sweep that went on is not done"; failed=1; }
for run in whole/*/*/seed-00?; do same "$run" "broken/${run#whole/}" 'killed sweep'; done

# What is done is not done again.
before=$(ls -l --time-style=full-iso whole/bandit/crpo/seed-000/policy.rdm)
# shellcheck disable=SC2086
"$tool" sweep $flags --out whole > /dev/null 2> err || { cat err; failed=1; }
[ "$before" = "$(ls -l --time-style=full-iso whole/bandit/crpo/seed-000/policy.rdm)" ] || { echo "a run that was done was done again"; failed=1; }

# Other settings are other runs, and a run that is asked for twice is no second one.
refuse() {  # refuse TEXT FLAG...
  text=$1
  shift
  # shellcheck disable=SC2086
  "$tool" sweep $flags "$@" --out whole > /dev/null 2> err
  [ $? -eq 2 ] && grep -q -- "$text" err || { echo "sweep $*: $(cat err)"; failed=1; }
}
refuse 'give another folder' --set discount=0.5
refuse 'give another folder' --cost-limit 3
"$tool" sweep --tasks bandit,bandit --steps 512 --out twice > /dev/null 2> err
[ $? -eq 2 ] && grep -q 'given twice' err || { echo "a task that is given twice: $(cat err)"; failed=1; }
"$tool" sweep --tasks bandit --seeds 0,0 --steps 512 --out twice > /dev/null 2> err
[ $? -eq 2 ] && grep -q 'given twice' err || { echo "a seed that is given twice: $(cat err)"; failed=1; }

# Two sweeps in one folder divide the runs, each of which is trained once.
for each in a b; do
  # shellcheck disable=SC2086
  "$tool" sweep $flags --out shared > table.$each 2> err.$each &
done
wait
[ "$(cat err.a err.b | grep -c ' of 8: ')" -eq 8 ] || { echo "two sweeps did not divide 8 runs"; cat err.a err.b; failed=1; }
for each in a b; do
  taken=$((8 - $(grep -c ' of 8: ' err.$each)))
  [ "$taken" -eq 0 ] || grep -q 'other sweeps in this folder have taken' table.$each || grep -q '8 of 8' table.$each || { echo "nothing is said of $taken runs"; failed=1; }
done
for run in whole/*/*/seed-00?; do same "$run" "shared/${run#whole/}" 'divided sweep'; done

# One error, before there is a folder.
for wrong in '--set clip=-1' '--vary horizon=16,0' '--algos ppo_lag,crrpo' '--tasks bandit,nothing' '--seeds 3..1' '--vary horizon'; do
  # shellcheck disable=SC2086
  "$tool" sweep $flags $wrong --out wrong > /dev/null 2> err
  [ $? -eq 2 ] || { echo "$wrong: status is not 2"; cat err; failed=1; }
  [ ! -e wrong ] || { echo "$wrong: something was started"; failed=1; }
done

# Each value is a configuration of its own.
"$tool" sweep --tasks bandit --seeds 5 --steps 2000 --envs 8 --vary clip=0.1,0.3 --set horizon=16 --out varied > table 2> err || { cat err; failed=1; }
for clip in 0.1 0.3; do
  grep -q "\"clip\": *\"*$clip" "varied/bandit/ppo_lag+clip=$clip/seed-005/config.json" || { echo "no run with clip=$clip"; failed=1; }
done

# Files of the user's own reach each run.
cp "$here/../../examples/scenes/press.task" . || exit 1
"$tool" sweep --tasks press.task,bandit --algos ppo --seeds 0 --steps 500 --envs 4 --set hidden=8 --out own > table 2> err || { cat table err; failed=1; }
[ -d own/press_button/ppo/seed-000 ] || { echo 'there is no run of the task file'; ls -R own; failed=1; }
"$tool" sweep --tasks press.task,press_button --out wrong > /dev/null 2> err && { echo 'a task is swept twice'; failed=1; }
grep -q 'one of them is given twice' err || { cat err; failed=1; }

# The time is over at once: what has begun goes on to the same end.
# shellcheck disable=SC2086
"$tool" sweep $flags --out timed --minutes 0.001 > table 2> err || { cat err; failed=1; }
grep -q 'the same command goes on' table || { echo "a sweep whose time was over does not say so"; cat table; failed=1; }
# shellcheck disable=SC2086
"$tool" sweep $flags --out timed > table 2> err || { cat err; failed=1; }
for run in whole/*/*/seed-00?; do same "$run" "timed/${run#whole/}" 'timed sweep'; done
exit $failed
