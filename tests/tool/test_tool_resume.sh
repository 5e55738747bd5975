#!/bin/sh
# test_tool_resume.sh TOOL: a run that was killed and resumed ends in the same bytes as one that was not
# (Time/* columns apart), wherever it was killed; SIGINT saves and exits with status 0.
. "$(dirname "$0")/tool.sh"
flags='--envs 8 --set max_steps=20 --set hidden=16,16 --set horizon=8 --eval-every 4 --checkpoint-every 3'
steps=20000

# shellcheck disable=SC2086
"$tool" train $flags --steps $steps --out whole > /dev/null 2> err || { cat err; exit 1; }
[ "$(wc -l < whole/progress.csv)" -gt 40 ] || { echo "the run is too short to be broken"; failed=1; }

# Killed when the curve has so many rows: before and after checkpoints and evaluations.
for rows in 1 2 5 9 14 23; do
  rm -rf broken
  # shellcheck disable=SC2086
  "$tool" train $flags --steps $steps --out broken > /dev/null 2>&1 &
  pid=$!
  while kill -0 $pid 2> /dev/null && { [ ! -f broken/progress.csv ] || [ "$(wc -l < broken/progress.csv)" -lt $rows ]; }; do
    sleep 0.01
  done
  kill -9 $pid 2> /dev/null
  wait $pid 2> /dev/null
  "$tool" train --resume broken > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
  same whole broken "killed at row $rows"
done

# A run that ended early goes on to more steps; where nothing follows a schedule over the run it is the long one.
fixed="$flags --set std_schedule=none --set kl_target_end=0"
# shellcheck disable=SC2086
"$tool" train $fixed --steps $steps --out fixed > /dev/null 2>&1
# shellcheck disable=SC2086
"$tool" train $fixed --steps 7000 --out longer > /dev/null 2>&1
"$tool" train --resume longer --steps $steps > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
same fixed longer 'resumed with more steps'

# SIGINT ends the epoch, saves, exits with 0; the run can go on.
# shellcheck disable=SC2086
"$tool" train $flags --steps $steps --out stopped > /dev/null 2> err &
pid=$!
while kill -0 $pid 2> /dev/null && { [ ! -f stopped/progress.csv ] || [ "$(wc -l < stopped/progress.csv)" -lt 6 ]; }; do
  sleep 0.01
done
kill -INT $pid
wait $pid
status=$?
[ $status -eq 0 ] || { echo "after SIGINT the exit status is $status"; failed=1; }
grep -q 'train --resume stopped' err || { echo "after SIGINT there is no note: $(cat err)"; failed=1; }
"$tool" train --resume stopped > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
same whole stopped 'stopped by SIGINT'

# Another version or other kernels: the run goes on, and a line says what that means.
if grep -q 'trained with' err; then echo "the same build is another one: $(cat err)"; failed=1; fi
sed -i 's/"version": "[^"]*"/"version": "0.9.7"/; s/"kernels": "[^"]*"/"kernels": "abacus"/' stopped/config.json
"$tool" train --resume stopped > /dev/null 2> err || { echo "resume failed: $(cat err)"; failed=1; }
grep -q 'stopped: it was trained with version 0.9.7, kernels abacus, here is version .*: results differ' err ||
  { echo "nothing is said of another version: $(cat err)"; failed=1; }
exit $failed
