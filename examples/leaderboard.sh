#!/usr/bin/env bash
# The leaderboard: every algorithm on every task, five seeds each, in one table.
#   bash examples/leaderboard.sh [OUT] [RESULTS]   OUT: folder of the runs, default runs/leaderboard
#                                                  RESULTS: default examples/results
# Each task is a `redman sweep`, so the script can be stopped at any time and called again; what is done stays done. It writes
# RESULTS/leaderboard.csv, a row for each run with the hash of its policy, and RESULTS/leaderboard.md, the page, of the rows that
# there are. Rows of earlier calls stay, and their runs are not made again, also where OUT is gone (AGAIN=1 makes them anew).
#   PLAN=1 bash examples/leaderboard.sh
# trains nothing but 40,000 steps of each task, and writes RESULTS/leaderboard_plan.csv: how long all of it would take.
# HOURS=0.001 trains nothing more and writes the page of what is there.
# Environment: REDMAN (the tool), TASKS, ALGOS (default: all), SEEDS (0..4), JOBS (runs at once, one thread each; 0: each core),
# HOURS (time after which runs are stopped, to be gone on with later; none), SCALE (1; factor on the numbers of steps).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
out=${1:-$root/runs/leaderboard} results=${2:-$root/examples/results}
csv=$results/leaderboard.csv page=$results/leaderboard.md plan=$results/leaderboard_plan.csv
mkdir -p "$out" "$results"
names() { "$redman" "$1" --json | grep -o "{\"name\":\"[a-z0-9_]*\",\"summary\"" | cut -d'"' -f4; }
tasks=${TASKS:-$(names tasks)}
# A team needs a task with groups, and learners from data sets need those: their rows are on their own pages (manual/teams.md, offline.md).
algos=${ALGOS:-$(names algos | grep -v -x -e mappo -e mappo_lag -e happo -e macpo -e ippo -e ippo_lag -e td3_bc_lag -e cpq -e bcq_lag -e coptidice)}
first=${SEEDS:-0..4} last=${SEEDS:-0..4}
first=${first%%..*} last=${last##*..}

# steps TASK ALGO: control steps of a run. Learners from a replay memory have a tenth: they take more of each.
steps() {
  local n=3000000
  case $1 in
    bandit | two_state | lqr_line | matrix_game | recall) n=400000 ;;
    hand_over_safe_* | catch_* | hand_over_wall) n=10000000 ;;
    jenga | pick_bottles | clean_house) n=1500000 ;;
  esac
  case $2 in td3* | sac*) n=$((n / 10)) ;; esac
  awk -v n="$n" -v scale="${SCALE:-1}" 'BEGIN { printf "%.0f", n * scale }'
}

plan() {
  local task seconds TIMEFORMAT=%U
  echo "task,steps of a run,processor seconds of a million steps"
  for task in $tasks; do
    seconds=$({ time "$redman" train --task "$task" --algo ppo_lag --steps 40000 --threads 0 --no-tensorboard --overwrite --out "$out/plan" --json \
      > "$out/plan.json" 2> "$out/plan.log"; } 2>&1) || { echo "$task: no rate: $(tail -n1 "$out/plan.log")" >&2; continue; }
    awk -v task="$task" -v n="$(steps "$task" ppo_lag)" -v seconds="$seconds" -v made="$(value env_steps "$out/plan.json")" \
      'BEGIN { printf "%s,%d,%.1f\n", task, n, seconds / made * 1e6 }'
  done | tee "$plan.part"
  { echo "task,env_steps,cpu_seconds_per_million"; cat "$plan.part"; } > "$plan"
  rm "$plan.part"
  price
}

# price: what all runs of the plan take, in a sentence.
price() {
  awk -F, -v algos="$(wc -w <<< "$algos")" -v seeds="$((last - first + 1))" 'NR > 1 { hours += $2 / 1e6 * $3 * algos * seeds / 3600; ++count }
    END { printf "All %d tasks with %d algorithms and %d seeds would take %.0f hours of a core: %.1f hours on 16 cores, %.0f on 2.\n",
      count, algos, seeds, hours, hours / 16, hours / 2 }' "$plan"
}

# have TASK ALGO SEED STEPS: there is a row of as many steps.
have() {
  [ -z "${AGAIN:-}" ] && [ -s "$csv" ] &&
    awk -F, -v t="$1" -v a="$2" -v s="$3" -v n="$4" '$1 == t && $2 == a && $3 == s && $4 >= n { found = 1 } END { exit !found }' "$csv"
}

# keep TASK ALGO: rows of the finished runs of one task and algorithm.
keep() {
  local json seed
  for json in "$out/$1/$1/$2"/seed-*.json; do
    [ -s "$json" ] && ! grep -q '"interrupted":true' "$json" || continue
    seed=$((10#$(basename "$json" .json | cut -d- -f2)))
    {
      cat "$csv"
      printf '%s,%s,%d,%s,%s,%s,%s,%s,%s,%s,%s\n' "$1" "$2" "$seed" "$(value env_steps "$json")" "$(value return "$json")" "$(value cost "$json")" \
        "$(value cost_limit "$json")" "$(value success_rate "$json")" "$(value training_violating_steps "$json")" "$(value wall_seconds "$json")" \
        "$(sha256sum "${json%.json}/policy.rdm" | cut -c1-16)"
    } | awk -F, 'NR == 1 { print; next } { key = $1 "," $2 "," $3; if (!(key in row)) order[++n] = key; row[key] = $0 }
      END { for (i = 1; i <= n; ++i) print row[order[i]] }' > "$csv.part"
    mv "$csv.part" "$csv"
  done
}

if [ -n "${PLAN:-}" ]; then
  plan
  exit
fi
[ -s "$csv" ] || echo "task,algorithm,seed,env_steps,return,cost,limit,success,training_violations,wall_seconds,policy" > "$csv"
stop_at=$(awk -v now="$(date +%s)" -v hours="${HOURS:-0}" 'BEGIN { printf "%.0f", (hours > 0) ? now + 3600 * hours : 0 }')
for task in $tasks; do for algo in $algos; do
  n=$(steps "$task" "$algo") missing=
  for seed in $(seq "$first" "$last"); do have "$task" "$algo" "$seed" "$n" || missing=$missing${missing:+,}$seed; done
  [ -n "$missing" ] || continue
  left=$(awk -v now="$(date +%s)" -v stop="$stop_at" 'BEGIN { printf "%d", stop ? (stop - now) / 60 : 0 }')
  [ "$left" -gt 0 ] || [ "$stop_at" -eq 0 ] || break 2
  "$redman" sweep --tasks "$task" --algos "$algo" --seeds "$missing" --steps "$n" --jobs "${JOBS:-0}" --minutes "$left" --out "$out/$task" \
    > "$out/$task.$algo.log" 2>&1 || echo "$task $algo: $(tail -n1 "$out/$task.$algo.log")" >&2
  keep "$task" "$algo"
done; done

# The score of a run: its return, from that of random actions (0) to the best mean of an algorithm within the limit (1); 0 above the limit.
scores=$(mktemp)
awk -F, 'FILENAME ~ /scores.csv$/ { if (FNR == 1) { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    if ($at["actor"] == "random") random[$at["task"]] = $at["return"]; next }
  FNR == 1 { pass = ++files; if (pass == 2) print "task,algorithm,score"; next }
  { over = $7 != "null" && $7 >= 0 && $6 > $7 }
  pass == 1 { if (!over) { sum[$1, $2] += $5; ++n[$1, $2] } all[$1, $2] = 1; next }
  FNR == 2 { for (k in sum) { split(k, p, SUBSEP); m = sum[k] / n[k]; if (!(p[1] in best) || m > best[p[1]]) best[p[1]] = m } }
  { if (!($1 in random)) next
    span = best[$1] - random[$1]; s = over || !($1 in best) || span <= 0 ? 0 : ($5 - random[$1]) / span
    printf "%s,%s,%.6g\n", $1, $2, s < 0 ? 0 : s }' "$root/examples/results/scores.csv" "$csv" "$csv" > "$scores"
# Algorithms that have not run on each task yet cannot be compared over all of them.
partial=$(awk -F, 'NR > 1 { if (!($1 in task)) ++tasks; task[$1]; if (!(($1, $2) in seen)) ++n[$2]; seen[$1, $2] }
  END { for (a in n) if (n[a] < tasks) print a }' "$scores" | sort)
for algo in $partial; do sed -i "/^[^,]*,$algo,/d" "$scores"; done
{
  echo "# Leaderboard"
  echo
  echo "\`bash examples/leaderboard.sh\` trains every algorithm on every task with the task's own defaults, five seeds each, and writes this page from"
  echo "the runs that are done. It can be stopped and called again. [leaderboard.csv](leaderboard.csv) has a row for each run, with the first 16"
  echo "digits of the SHA-256 of its policy; the same version makes that policy again on the same vector unit."
  echo
  awk -F, 'NR > 1 { ++runs; tasks[$1]; algos[$2]; steps += $4; seconds += $10 } END { for (t in tasks) ++a; for (t in algos) ++b
    printf "This page has %d runs, of %d tasks and %d algorithms: %.1f million control steps, %.1f hours of one thread.\n", runs, a, b, steps / 1e6, seconds / 3600 }' "$csv"
  if [ -s "$plan" ]; then
    price
    echo "The estimate uses the rate of PPO-Lag on one core of this machine ([leaderboard_plan.csv](leaderboard_plan.csv), \`PLAN=1 bash examples/leaderboard.sh\`)."
  fi
  echo
  echo "## All tasks together"
  echo
  echo "The score of a run is its return, from that of random actions (0) to the best mean of an algorithm within the limit on that task (1); a run"
  echo "above its limit has 0. Algorithms without a common letter under \`group\` differ (\`redman compare\`)."
  echo
  [ "$(wc -l < "$scores")" -eq 1 ] || "$redman" compare "$scores" --over task --value score --markdown
  [ -z "$partial" ] || printf '\nNot compared, since they have not run on each of these tasks yet: %s.\n' "$(sed 's/.*/`&`/' <<< "$partial" | paste -sd, | sed 's/,/, /g')"
  for task in $(awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "$csv"); do
    printf '\n## %s\n\n' "$task"
    awk -F, -v task="$task" 'NR > 1 && $1 == task { limit = $7; if (!($2 in n)) order[++count] = $2; ++n[$2]; r[$2] += $5; rr[$2] += $5 * $5; c[$2] += $6; s[$2] += $8
        steps[$2] = $4; within[$2] += $7 == "null" || $7 < 0 || $6 <= $7; v[$2] += $9 }
      function number(x) { return sprintf(x >= 1e3 || x <= -1e3 ? "%.0f" : "%.3g", x) }
      function sd(a, v) { v = n[a] > 1 ? (rr[a] - r[a] * r[a] / n[a]) / (n[a] - 1) : 0; return n[a] > 1 ? " +- " number(sqrt(v > 0 ? v : 0)) : "" }
      function key(a) { return (within[a] == n[a] ? 1e12 : 0) + r[a] / n[a] }
      END { printf "The limit is %s.\n\n| algorithm | return | cost | seeds within the limit | success rate | control steps | violating steps in training |\n|---|---|---|---|---|---|---|\n", limit
        for (i = 1; i <= count; ++i) for (j = i + 1; j <= count; ++j) if (key(order[j]) > key(order[i])) { t = order[i]; order[i] = order[j]; order[j] = t }
        for (i = 1; i <= count; ++i) { a = order[i]; printf "| `%s` | %s%s | %s | %d of %d | %.0f %% | %s M | %.0f |\n", a, number(r[a] / n[a]), sd(a), number(c[a] / n[a]), within[a], n[a],
          100 * s[a] / n[a], number(steps[a] / 1e6), v[a] / n[a] } }' "$csv"
  done
  printf '\nReturn and cost are those of the mean action of the policy that training kept, over 100 new episodes of each seed; `+-` is the standard\ndeviation over seeds. Rows with all seeds within the limit come first, then by return.\n'
} > "$page"
rm "$scores"
echo "$page"
