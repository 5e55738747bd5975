#!/usr/bin/env bash
# What doing nothing, random actions and the bundled policy make of each task: 100 new episodes, seed 0. Rows that are kept in
# examples/results/scores.csv are not measured again, so the script can be stopped and called again; it takes half an hour.
#   bash examples/score_table.sh [TASK...]      measures what is missing, of these tasks; default: all
#   bash examples/score_table.sh --block TASK   prints the block `scores` of the task's page in the manual
# To measure a task again, remove its rows. Environment: REDMAN (the tool), EPISODES (100).
set -eu
# shellcheck source=examples/runs.sh
. "$(dirname "$0")/runs.sh"
results=$root/examples/results
scores=$results/scores.csv episodes=${EPISODES:-100}

if [ "${1:-}" = --block ]; then
  echo
  echo "## Scores"
  awk -F, -v task="$2" "$error"'
    function number(x) { return sprintf(x >= 1e4 || x <= -1e4 ? "%.0f" : "%.4g", x) }
    FNR == 1 { ++file; delete at; for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["task"] != task { next }
    file == 1 { name["zero"] = "zero actions"; name["random"] = "random actions"; name["trained"] = "bundled policy"
      over = $at["limit"] != "" && $at["cost"] + 0 > $at["limit"] + 0
      rows = rows sprintf("| %s | %s ± %s | %s ± %s%s | %.0f %% | `%s` |\n", name[$at["actor"]], number($at["return"]), error($at["return_se"]),
        number($at["cost"]), error($at["cost_se"]), over ? ", above its limit" : "", 100 * $at["success"], $at["command"])
      episodes = $at["episodes"]; seed = $at["seed"] }
    file == 2 { rows = rows sprintf("| %s, %s | %s | %s | | published |\n", $at["source"], $at["algorithm"], $at["return"], $at["cost"]) }
    END { print "<!-- scores -->"
      if (episodes) {
        printf "Return and cost are sums over an episode: mean ± standard error of %d new episodes, deterministic policies, seed %d.\n\n", episodes, seed
        print "| policy | return | cost | success rate | command |"; print "|---|---|---|---|---|"
        printf "%s", rows
      } else print "Not measured: `bash examples/score_table.sh " task "`."
      print "<!-- end of scores -->" }' "$scores" "$results/published.csv"
  exit
fi

[ -s "$scores" ] || echo "task,actor,return,return_se,cost,cost_se,limit,success,episodes,seed,command" > "$scores"
part=$(mktemp)
trap 'rm -f "$part"' EXIT
tasks=${*:-$("$redman" tasks | awk 'NR > 1 { print $1 }')}
for task in $tasks; do
  for actor in zero random trained; do
    grep -q "^$task,$actor," "$scores" && continue
    [ $actor != trained ] || [ -e "$root/examples/policies/$task.rdm" ] || continue
    command="eval --task $task --policy $actor --episodes $episodes"
    # shellcheck disable=SC2086
    "$redman" $command --json > "$part"
    row=$task,$actor
    for key in return_mean return_stderr cost_mean cost_stderr cost_limits success_rate episodes; do row=$row,$(value $key "$part"); done
    echo "$row,0,redman $command" >> "$scores"
    echo "$row"
  done
done
