#!/bin/sh
# test_tool_numbers.sh TOOL: what eval, report and compare say beside means, and that they say where a number means nothing.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
# json KEY: what follows the key in `out`, up to the end of a number or list
json() { sed "s/.*\"$1\":\\(\\[[^]]*\\]\\|[^,}]*\\).*/\\1/" out; }
is() { [ "$(json "$1")" = "$2" ] || say "$1 is $(json "$1"), not $2"; }
# about KEY VALUE: a number within 1e-9 of it
about() { awk -v x="$(json "$1")" -v y="$2" 'BEGIN { d = x - y; exit !(x != "null" && d < 1e-9 && d > -1e-9) }' || say "$1 is $(json "$1"), not $2"; }

# An evaluation: at a glance in its first line, and the same again in JSON. Ten episodes of an unlimited cost too.
"$tool" eval --task point_goal1 --policy trained --episodes 10 --seed 3 > text 2> err || { cat err; exit 1; }
grep -qE '^10 episodes of point_goal1: return [0-9.]+ \+- [0-9.]+, cost [0-9.]+ \+- [0-9.]+ \(limit 25\), success [0-9.]+%, over a limit [0-9.]+%, CVaR of the cost [0-9.]+$' text ||
  say "the first line is: $(head -n 1 text)"
grep -qE '^hazards +[0-9.]+ \+- .* - +-$' text || say "no row of a cost without a limit: $(cat text)"
"$tool" eval --task point_goal1 --policy trained --episodes 10 --seed 3 --json > out
[ "$(json cost_over_rate)" = "[$(json violation_rate),null,null]" ] || say "shares over limits: $(json cost_over_rate)"
# one episode: no error, no interval, and that is said
"$tool" eval --task point_goal1 --policy trained --episodes 1 --json > out
is return_stderr null
is interval '[null,null]'
grep -q '"remarks":\["one episode has no standard error' out || say "one episode: $(cat out)"
# no spread
"$tool" eval --task bandit --policy zero --episodes 5 --json > out
is interval '[null,null]'
is return_stderr 0.0
grep -q '"remarks":\["the same in every episode, so without an interval: return, cost"\]' out || say "no spread: $(cat out)"
# a cost that swings above its limit
"$tool" eval --task two_state --policy random --episodes 50 --cost-limit 1 > text
grep -q '^the deviation of cost, .* is above its limit, 1: .*use --episodes 1000 for more precision$' text || say "no remark on the deviation: $(cat text)"
"$tool" eval --task two_state --policy random --episodes 1000 --cost-limit 1 > text
grep -q 'for more precision' text && say "a remark on the deviation of 1000 episodes"

# Runs of a table of one's own. Worked out by hand: test_tool_statistics.
printf 'algorithm,task,return\n' > rows.csv
for row in a,x,5 a,x,6 a,y,5 a,y,6 b,x,1 b,x,2 b,y,1 b,y,2 c,x,5 c,x,6 c,y,5 c,y,6; do echo "$row"; done >> rows.csv
"$tool" compare rows.csv --over task --json > out || say "compare: $(cat out)"
[ "$(grep -o '"group":"[a-z]*"' out | tr '\n' ' ')" = '"group":"a" "group":"a" "group":"b" ' ] || say "groups: $(cat out)"
grep -q '"better":"a","than":"c","probability":0.5,' out && grep -q '"better":"a","than":"b","probability":1.0,"interval":\[1.0,1.0\],"difference":4.0' out ||
  say "pairs: $(cat out)"
"$tool" compare rows.csv --over task --less > text
[ "$(awk 'NR == 2 { print $1 }' text)" = b ] || say "less is better: $(cat text)"
"$tool" compare rows.csv --where task=x > text
grep -qE '^a +2 +5.5 +0.707 +5.5 +5 .. 6 +a$' text && grep -q 'fewer than 5 runs are too narrow' text || say "of one task: $(cat text)"
"$tool" compare rows.csv --value retrn > text 2> err && say "a column that is not there was taken"
grep -q 'rows.csv: there is no column retrn; nearest is return' err || say "$(cat err)"
"$tool" compare rows.csv --where task > text 2> err
[ $? -eq 2 ] && grep -q 'not column=text' err || say "$(cat err)"

# Seeds of a report, beside reports of each run alone.
for run in 'ppo 0' 'ppo 1' 'ppo_lag 0' 'ppo_lag 1' 'ppo_lag 2'; do
  # shellcheck disable=SC2086
  set -- $run
  "$tool" train --task ball_run --algo "$1" --seed "$2" --envs 4 --steps 4000 --set max_steps=50 --set horizon=100 --out "runs/$1.$2" \
    --json > "$1.$2.json" 2> err || { cat err; exit 1; }
done
for key in return_stderr violation_rate cost_cvar return_iqm interval cost_quantiles; do
  grep -q "\"$key\":" ppo.0.json || say "train --json has no $key"
done
for seed in 0 1 2; do
  "$tool" report runs/ppo_lag.$seed --html one.html --strip 0 --episodes 20 --json > out 2> err || say "$(cat err)"
  echo "$(json return) $(json training_violating_steps)"
  is return_sd null
  is interval '[null,null]'
  is normalised_return null
done > each
[ $failed -eq 0 ] || cat each
set -- $(awk '{ s += $1; v += $2; x[NR] = $1 } END { m = s / NR; for (i = 1; i <= NR; ++i) q += (x[i] - m) ^ 2
  printf "%.12f %.12f %.12f", m, sqrt(q / (NR - 1)), v / NR }' each)
"$tool" report runs/ppo.* --html one.html --strip 0 --episodes 20 --json > out
free=$(json return)
is normalised_return 1.0
"$tool" report runs --html seeds.html --strip 0 --episodes 20 > text 2> err || say "$(cat err)"
"$tool" report runs --html seeds.html --strip 0 --episodes 20 --json | sed 's/.*{"task":"ball_run","configuration":"ppo_lag",\([^}]*}.*\)/{\1/; s/,{"task".*//' > out
about return "$1"
about return_sd "$2"
about training_violating_steps "$3"
about normalised_return "$(awk -v a="$1" -v b="$free" 'BEGIN { printf "%.12f", a / b }')"
awk -v i="$(json interval)" -v m="$1" 'BEGIN { gsub(/[][]/, "", i); split(i, e, ","); exit !(e[1] <= m && m <= e[2]) }' || say "interval: $(json interval)"
grep -q '<h3>Over seeds</h3>' seeds.html && grep -q 'of PPO&rsquo;s return' seeds.html && grep -q '95 % interval of the difference' seeds.html ||
  say "the page has no numbers over seeds"
grep -qE '^ppo_lag +3 +[a-z]+ +[-0-9.e+]+ \+- ' text && grep -q 'fewer than 5 runs are too narrow' text || say "the text: $(cat text)"
exit $failed
