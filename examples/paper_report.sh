#!/usr/bin/env bash
# The tables of examples/paper_tables.sh out of the runs that it kept, without training anything:
#   bash examples/paper_report.sh [RESULTS]      RESULTS: the folder with runs.csv, default examples/results
# writes RESULTS/table1.md, command.md (with costs of commanded targets), fig7.md, second.md, shield.md, claims.md and short.md, which
# hand_tasks.md has;
#   bash examples/paper_report.sh --block ALGORITHM
# prints the block `runs` of the algorithm's page in the manual.
# Environment: REDMAN (the tool, which tells algorithms apart).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "${BASH_SOURCE[0]}")/runs.sh"
block=
[ "${1:-}" != --block ] || { block=$2; shift 2; }
results=${1:-$root/examples/results}
[ -n "$block" ] || [ -x "$redman" ] || { echo "there is no $redman: build it, or say where it is with REDMAN" >&2; exit 1; }
# For the awk programs of the tables: a figure as text.
number=$error'function number(x) { return sprintf(x >= 1e3 ? "%.0f" : "%.3g", x) }
function spread(sd) { return sd == "-" ? "" : " +- " error(sd) }
'

# means PART: one line for each task and algorithm: task algo limit seeds steps return cost falls success sampled_return
# sampled_cost sampled_over train_return train_cost train_over train_swing wall returns costs seeds_over feasible
# second_limit second_cost seconds_to_half return_sd cost_sd; the last two, over seeds, are "-" of one.
means() {
  awk -F, -v part="$1" "$number"'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["part"] == part { k = $at["task"] SUBSEP $at["algorithm"]
      if (!(k in n)) { order[++count] = k; limit[k] = $at["limit"] + 0 }
      i = ++n[k]; split("env_steps return cost falls success sampled_return sampled_cost sampled_over train_return train_cost train_over train_swing wall_seconds", key, " ")
      for (j = 1; j <= 13; ++j) sum[k, j] += $at[key[j]]
      value[k, i, 2] = $at["return"]; value[k, i, 3] = $at["cost"]
      if ($at["seconds_to_half"] != "") { half[k] += $at["seconds_to_half"]; ++halves[k] }
      second[k] = $at["second_limit"]; more[k] += $at["second_cost"]
      over = limit[k] >= 0 && $at["cost"] > limit[k]; overs[k] += over
      each[k] = each[k] (i > 1 ? "," : "") number($at["return"]); costs[k] = costs[k] (i > 1 ? "," : "") number($at["cost"]) (over ? "!" : "") }
    function sd(k, j, i, s) { for (i = 1; i <= n[k]; ++i) s += (value[k, i, j] - sum[k, j] / n[k]) ^ 2; return n[k] > 1 ? sprintf("%.4g", sqrt(s / (n[k] - 1))) : "-" }
    END { for (c = 1; c <= count; ++c) { k = order[c]; split(k, name, SUBSEP); m = n[k]
      printf "%s %s %s %d", name[1], name[2], limit[k], m
      for (j = 1; j <= 13; ++j) printf " %.6g", sum[k, j] / m
      printf " %s %s %d %d %s %.3g %s %s %s\n", each[k], costs[k], overs[k] + 0, (limit[k] < 0 || sum[k, 3] / m <= limit[k]) && (second[k] == "" || more[k] / m <= second[k]),
        second[k] == "" ? "-" : second[k], more[k] / m, halves[k] ? half[k] / halves[k] : "-", sd(k, 2), sd(k, 3) } }' "$results/runs.csv"
}

# letters PART: TASK ALGO GROUPS, of the returns of the seeds of a task; "-" of one seed.
letters() {
  local task
  for task in $(means "$1" | cut -d" " -f1 | sort -u); do
    "$redman" compare "$results/runs.csv" --where "part=$1" --where "task=$task" --markdown |
      awk -F' *[|] *' -v task="$task" 'NR > 2 { gsub("`", "", $2); print task, $2, $8 }'
  done
}

# together PART: of the algorithms that have runs of all tasks, each return over the best algorithm's mean on its task.
together() {
  local scores
  scores=$(mktemp)
  means "$1" | awk -F'[ ]' 'NR == FNR { ++tasks[$2]; if (!($1 in best) || $6 > best[$1]) best[$1] = $6; if (!($1 in seen)) { seen[$1] = 1; ++count }; next }
    FNR == 1 { split($0, name, ","); for (i in name) at[name[i]] = i; print "task,algorithm,score"; next }
    { split($0, cell, ","); t = cell[at["task"]]; a = cell[at["algorithm"]]
      if (cell[at["part"]] == part && count > 1 && tasks[a] == count) print t "," a "," cell[at["return"]] / best[t] }' part="$1" - part="$1" "$results/runs.csv" > "$scores"
  [ "$(wc -l < "$scores")" -lt 2 ] || {
    printf '\n## All tasks together\n\nEach return is divided by the best mean of its task. IQM: the interquartile mean of all runs.\n\n'
    "$redman" compare "$scores" --over task --value score --markdown
  }
  rm "$scores"
}

# The paper's Table 1 as TASK ALGO RETURN COST.
published() {
  local algo a b c d e f g h
  while read -r algo a b c d e f g h; do
    echo "hand_over_safe_finger $algo $a $b"
    echo "hand_over_safe_joint $algo $c $d"
    echo "catch_underarm_safe_finger $algo $e $f"
    echo "catch_underarm_safe_joint $algo $g $h"
  done <<'T'
cpo 4.57 32.41 6.18 29.54 21.63 34.72 2.68 29.3
trpo_lag 3.62 36.02 3.83 10.77 4.55 15.6 3.37 33.13
ppo_lag 17.4 27.69 22.44 71.15 25.5 65.56 24.11 64.39
p3o 21.93 40.54 21.9 31.34 22.72 47.3 20.09 55.84
pcpo 3.08 70.15 3.08 70.15 0.3 3.22 0.26 5.0
focops 13.89 39.68 19.79 33.45 18.95 38.57 4.1 32.54
cppo_pid 3.63 29.41 5.21 28.54 0.31 3.28 3.81 32.6
ipo 3.12 69.23 3.01 69.21 0.27 4.18 0.32 5.24
T
}

order="hand_over_safe_finger hand_over_safe_joint catch_underarm_safe_finger catch_underarm_safe_joint grasp reorient
  hand_over_wall jenga pick_bottles clean_house"

# table PART: Markdown, feasible first, by the return of the mean action; the stochastic policy, and training.
table() {
  local task groups
  groups=$(letters "$1" | sed 's/^/L /')
  echo "| task (cost limit) | algorithm | group | return, mean +- sd (each seed) | cost, mean +- sd (each seed) | second cost (its limit) | episodes that fall | success rate | stochastic policy: return @ cost | its episodes above a limit | last tenth of training: return @ cost | epochs above the limit | control steps | training time, s | until half succeed, s | paper: return @ cost |"
  echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
  for task in $order; do
    { published | sed 's/^/P /'; echo "$groups"; means "$1" | awk -v t="$task" '$1 == t' | sort -k21,21nr -k6,6nr; } |
      awk "$number"'$1 == "P" { known[$2, $3] = $4 " @ " $5; next }
        NF == 0 { next }
        $1 == "L" { letters[$2, $3] = $4; next }
        { gsub(",", ", ", $18); gsub(",", ", ", $19)
          printf "| `%s` (%s) | `%s` | %s | %s%s", $1, $3 < 0 ? "-" : $3, $2, letters[$1, $2], number($6), spread($25); if ($4 > 1) printf " (%s)", $18
          printf " | %s%s%s", number($7), $21 ? "" : "!", spread($26); if ($4 > 1) printf " (%s)", $19
          if ($22 == "-") printf " | "; else printf " | %s (%s)", $23, $22
          printf " | %.0f %% | %.0f %% | %s @ %s | %.0f %% | %s @ %s | %.0f %% | %.3g M | %.0f | %s | %s |\n", 100 * $8, 100 * $9, number($10),
            number($11), 100 * $12, number($13), number($14), 100 * $15, $5 / 1e6, $17, $24 == "-" ? "" : sprintf("%.0f", $24), (($1, $2) in known) ? known[$1, $2] : "" }'
  done
}

note() {
  cat <<'T'

Rows within the limit come first, then by return. Return and cost are sums over an episode: the mean action (deterministic policy) in
100 new episodes of each seed. The policy is the best of training, chosen on other episodes, its cost at least one standard error below
the limit. `+-` is the standard deviation over seeds, `!` means above the limit. Algorithms without a common letter under `group` differ
in return: the 95 % interval of the difference of their seeds' interquartile means does not contain 0 (`redman compare`; each pair for
itself, and the interval is too narrow for fewer than 5 seeds). Training was stochastic and used one thread; an epoch is above the limit if
its mean cost is. `until half succeed`: training time until half of the training episodes succeed. `paper`: its Table 1, 100 M control steps.
T
}

# short PART TASK...: a column for each of the tasks that has runs, a row for each algorithm; the mean action.
short() {
  local part=$1
  shift
  { published | sed 's/^/P /'; means "$part" | sed 's/^/M /'; } | awk -v tasks="$*" "$number"'
    function cost_of(x, limit) { return number(x) (limit >= 0 && x > limit ? "!" : "") }
    $1 == "P" { published[$2, $3] = $4; its[$2, $3] = $5; next }
    { limit[$2] = $4; seeds[$2, $3] = $5; known[$3] = 1
      cell[$2, $3] = sprintf("%s%s @ %s%s, %.0f %%", number($7), spread($26), cost_of($8, $4), spread($27), 100 * $10)
      sampled[$2, $3] = number($11) " @ " cost_of($12, $4) }
    END { n = split(tasks, task, " "); m = 0
      for (i = 1; i <= n; ++i) if (task[i] in limit) column[++m] = task[i]
      if (m == 0) exit
      head = "| algorithm |"; rule = "|---|"
      for (i = 1; i <= m; ++i) { head = head " `" column[i] "`" (limit[column[i]] >= 0 ? " (" limit[column[i]] ")" : "") " |"; rule = rule "---|" }
      print head; print rule
      na = split("ppo ppo+predict ppo+project trpo ppo_lag trpo_lag cppo_pid cpo pcpo focops p3o ipo", algo, " ")
      for (j = 1; j <= na; ++j) { if (!(algo[j] in known)) continue
        line = "| `" algo[j] "` |"
        for (i = 1; i <= m; ++i) { k = column[i] SUBSEP algo[j]
          line = line " " (k in cell ? cell[k] (seeds[k] > 1 ? " (" seeds[k] " seeds)" : "") "; " sampled[k] (k in published ? "; " published[k] " @ " cost_of(its[k], limit[column[i]]) : "") : "-") " |" }
        print line } }'
}

# shields: a row for each run under a shield, the throws first: what it did while it learned, and what its policy does.
shields() {
  echo "| task (cost limit) | seed | control steps | violating steps in training; inevitable | under the shield: return @ cost, success | without: return @ cost, success | steps/s |"
  echo "|---|---|---|---|---|---|---|"
  local task
  for task in $order; do
    awk -F, -v task="$task" "$number"'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
      $at["task"] == task && $at["algorithm"] == "ppo+predict" && $at["bare_return"] != "" {
        printf "| `%s` (%s) | %d | %.3g M | %d; %s | %s @ %s, %.0f %% | %s @ %s, %.0f %% | %s |\n", task, $at["limit"] + 0, $at["seed"], $at["env_steps"] / 1e6, $at["violations"],
          $at["inevitable"] != "" ? $at["inevitable"] : $at["violations"] == 0 ? 0 : "-",
          number($at["return"]), number($at["cost"]), 100 * $at["success"], number($at["bare_return"]), number($at["bare_cost"]), 100 * $at["bare_success"],
          number($at["env_steps"] / $at["wall_seconds"]) }' "$results/runs.csv"
  done
}

claims() {
  { letters command | sed 's/^/L /'; means command | sed 's/^/T /'; means fig7 | sed 's/^/F /'; } | awk "$number"'
    $1 == "L" { group[$2, $3] = $4; next }
    { k = $2 SUBSEP $3; ret[k] = $7; cost[k] = $8; limit[k] = $4; tcost[k] = $15; swing[k] = $17; ok[k] = $22; there[k] = 1
      R[k] = sprintf("%.1f%s", $7, spread($26)); C[k] = sprintf("%.1f%s", $8, spread($27)) }
    function alike(a, b) { return group[a] ~ /[a-z]/ && group[b] ~ "[" group[a] "]" }
    function at(task, algo) { return task SUBSEP algo }
    function row(name, verdict, figures) { printf "| %s | %s | %s |\n", name, verdict, figures }
    function all(verdicts) { return verdicts ~ /0/ ? (verdicts ~ /1/ ? "in part" : "contradicted") : (verdicts == "" ? "not measured" : "yes") }
    END {
      nt = split("hand_over_safe_finger hand_over_safe_joint catch_underarm_safe_finger catch_underarm_safe_joint", throws, " ")
      na = split("cpo trpo_lag ppo_lag p3o pcpo focops cppo_pid ipo", algos, " ")
      print "| claim of the paper | holds here | measured |"; print "|---|---|---|"
      v = f = ""
      for (i = 1; i <= nt; ++i) { k = at(throws[i], "cpo"); if (!there[k]) continue
        v = v (tcost[k] <= limit[k] && cost[k] <= limit[k] ? 1 : 0)
        f = f sprintf("%s%s: %s, in training %.1f of %d", f == "" ? "" : "; ", throws[i], C[k], tcost[k], limit[k]) }
      row("CPO ends within the limit in all four throws", all(v), f)
      v = f = ""
      for (i = 2; i <= nt; i += 2) { best = ""
        for (j = 1; j <= na; ++j) { k = at(throws[i], algos[j]); if (there[k] && ok[k] && (best == "" || ret[k] > ret[at(throws[i], best)])) best = algos[j] }
        k = at(throws[i], "ppo_lag"); if (best == "" || !there[k]) continue
        b = at(throws[i], best); v = v (b == k || alike(b, k) ? 1 : 0)
        f = f sprintf("%s%s: ", f == "" ? "" : "; ", throws[i])
        if (b != k) f = f sprintf("%s %s @ %s, %s ", best, R[b], C[b], alike(b, k) ? "not told apart from" : "more than")
        f = f sprintf("ppo_lag %s @ %s", R[k], C[k]) }
      row("PPO-Lag has the most return in Safe Joint (there above the limit)", all(v), f)
      v = f = ""
      n = split("jenga pick_bottles", props, " ")
      for (i = 1; i <= n; ++i) { a = at(props[i], "ppo_lag"); b = at(props[i], "ppo"); if (!there[a] || !there[b]) continue
        v = v (ret[a] > 1.5 * ret[b] ? 1 : 0)
        f = f sprintf("%s%s: PPO-Lag %s @ %s, PPO %s @ %s", f == "" ? "" : "; ", props[i], R[a], C[a], R[b], C[b]) }
      row("PPO-Lag is far ahead of PPO in return in Jenga and Pick Bottles", all(v), f)
      v = f = ""
      for (i = 1; i <= nt; ++i) { a = at(throws[i], "focops"); b = at(throws[i], "ppo_lag"); if (!there[a] || !there[b]) continue
        v = v (swing[a] > 1.25 * swing[b] ? 1 : 0)
        f = f sprintf("%s%s: %.2f, PPO-Lag %.2f", f == "" ? "" : "; ", throws[i], swing[a], swing[b]) }
      row("The cost of FOCOPS oscillates (standard deviation of an epoch'"'"'s cost over the second half of training)", all(v), f)
      v = f = ""
      for (i = 1; i <= nt; ++i) { a = at(throws[i], "cppo_pid"); b = at(throws[i], "ppo_lag"); if (!there[a] || !there[b]) continue
        v = v (swing[a] < swing[b] ? 1 : 0)
        f = f sprintf("%s%s: %.2f, PPO-Lag %.2f", f == "" ? "" : "; ", throws[i], swing[a], swing[b]) }
      row("PID damps that oscillation", all(v), f)
      v = f = ""
      for (i = 1; i <= nt; ++i) { k = at(throws[i], "ipo"); if (!there[k]) continue
        v = v (tcost[k] > limit[k] || cost[k] > limit[k] ? 1 : 0)
        f = f sprintf("%s%s: %s @ %s, in training %.1f of %d", f == "" ? "" : "; ", throws[i], R[k], C[k], tcost[k], limit[k]) }
      row("IPO needs a start within the limit (these start above it in the finger tasks, at it or below in the joint ones)", all(v), f)
    }'
}

if [ -n "$block" ]; then
  printf '\n## Measured\n<!-- runs -->\n'
  { published | sed 's/^/P /'; for part in table1 fig7 command; do means $part | sed "s/^/$part /"; done; } |
    awk -v algo="$block" "$number"'
    $1 == "P" { if ($3 == algo) known[$2] = $4 " @ " $5; next }
    $3 != algo { next }
    !rows++ { print "| task | cost counts | cost limit | seeds | return, mean +- sd | cost, mean +- sd | success rate | stochastic policy: return @ cost | paper: return @ cost |"; print "|---|---|---|---|---|---|---|---|---|" }
    { printf "| [`%s`](../tasks/%s.md) | %s | %s | %d | %s%s | %s%s%s | %.0f %% | %s @ %s | %s |\n", $2, $2,
        $1 == "table1" ? "measured angles" : $1 == "command" ? "commanded targets" : "as the task says", $4 < 0 ? "-" : $4, $5, number($7), spread($26), number($8), spread($27),
        ($4 >= 0 && $8 > $4) ? ", above its limit" : "", 100 * $10, number($11), number($12), $1 == "command" ? known[$2] : "" }
    END { if (!rows) print "No runs of this algorithm are kept in examples/results." }'
  echo "<!-- end of runs -->"
  exit
fi

# page TITLE PART [LONG]: a table, and the one of long runs of the same.
page() {
  echo "# $1"
  echo
  table "$2"
  [ -z "${4:-}" ] || [ ! -e "$results/$4" ] || { echo; echo "![Return, cost and success over control steps: the mean of the runs that the legend counts]($4)"; }
  note
  [ -n "${3:-}" ] || return 0
  together "$2"
  [ -z "$(means "$3")" ] || { echo; echo "## 100 M steps"; echo; table "$3"; }
}
page "Table 1" table1 long fig6.svg > "$results/table1.md"
page "Table 1, with costs of commanded targets" command command_long command.svg > "$results/command.md"
page "Fig. 7" fig7 "" fig7.svg > "$results/fig7.md"
{ page "With a second limit" second; echo; echo "## With costs of commanded targets"; echo; table command_second; } > "$results/second.md"
{
  echo "# Learning under a shield"
  echo
  echo "PPO under \`--shield predict\`, one thread: the throws from nothing, the others from their bundled policies. A step violates when a"
  echo "cost of it is above 0. It is inevitable if the shield found no plan that avoids it (\`-\`: the run is older than this count). Means over"
  echo "100 new episodes by the mean action, once under the shield and once without. Other programs ran beside the runs: their steps/s are at"
  echo "least these."
  echo
  shields
} > "$results/shield.md"
{ echo "# What the paper says of its algorithms"; echo; echo "Throws with costs of commanded targets, which the paper's figures fit."; echo; claims; } > "$results/claims.md"
{
  for part in "table1 Throws, with costs of measured angles" "command Throws, with costs of commanded targets" "fig7 Others"; do
    [ -n "$(means "${part%% *}")" ] || continue
    echo "${part#* }:"
    echo
    # shellcheck disable=SC2086
    short "${part%% *}" $order
    echo
  done
} > "$results/short.md"
