# shellcheck shell=bash
# Sourced by the scripts of tables: runs that are kept, and numbers out of the tool's JSON.
# shellcheck disable=SC2034
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
redman=${REDMAN:-$root/build/release/bin/redman}
jobs=${JOBS:-2}
paper_tasks="hand_over_safe_finger hand_over_safe_joint catch_underarm_safe_finger catch_underarm_safe_joint grasp
  reorient hand_over_wall jenga pick_bottles clean_house"

# value KEY FILE: a number or truth value of the tool's one-line JSON, the first one of an array
value() { sed -n "s/.*\"$1\":\[\{0,1\}\([-+.0-9a-z]*\).*/\1/p" "$2"; }

# Waits until one of the $jobs places is free.
wait_turn() {
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do sleep 1; done
}

# kept FILE COMMAND...: FILE is what the tool's command prints with --json; nothing is done when it is there.
# Fails, without FILE, when the command does or was interrupted.
kept() {
  local file=$1
  shift
  [ -s "$file" ] && return
  "$redman" "$@" --json > "$file.part" 2> "${file%.json}.log" || return
  ! grep -q '"interrupted":true' "$file.part" && mv "$file.part" "$file"
}

# trained DIR FLAG...: trains into DIR, or goes on where a stopped run was left; the result is DIR.json.
trained() {
  local dir=$1
  shift
  if [ -s "$dir/config.json" ]; then
    kept "$dir.json" train --resume "$dir"
  else
    kept "$dir.json" train "$@" --out "$dir" --overwrite
  fi
}

# sampled DIR SEED: 100 episodes of a finished run's policy with its noise, as it explored, on the same starts as its
# evaluation on the mean action; the result is DIR.sampled.json.
sampled() {
  [ ! -s "$1.json" ] || kept "$1.sampled.json" eval --policy "$1" --stochastic --episodes 100 --seed $((1000000 + $2))
}

# last_tenth CSV LIMIT: of a progress.csv, "return,cost,over,swing": means of the last tenth of training, the share of its
# epochs over the limit (< 0: none), and how far the cost swings, its standard deviation over the second half of training.
last_tenth() {
  awk -F, -v limit="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) { if ($i == "Metrics/EpRet") r = i; if ($i == "Metrics/EpCost") c = i } next }
    { ret[NR] = $r; cost[NR] = $c }
    END { first = NR - int((NR - 1) / 10) + 1; if (first > NR) first = NR
      for (i = first; i <= NR; ++i) { a += ret[i]; b += cost[i]; over += limit >= 0 && cost[i] > limit }
      half = int(NR / 2) + 1
      for (i = half; i <= NR; ++i) { s += cost[i]; q += cost[i] * cost[i] }
      n = NR - first + 1; m = NR - half + 1; d = q / m - (s / m) * (s / m)
      printf "%.4f,%.4f,%.4f,%.4f", a / n, b / n, over / n, sqrt(d > 0 ? d : 0) }' "$1"
}

# reached CSV: seconds of training until half of the episodes of an epoch, noise and all, were a success; "" never.
reached() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["Metrics/SuccessRate"] >= 0.5 && $at["Metrics/SuccessRate"] ~ /^[0-9.]/ { printf "%.0f", $at["Time/Total"]; exit }' "$1"
}

# For the awk programs of the tables: a cost as text, marked where it is over its limit.
marked='function marked(cost, limit) {
  return sprintf("%.3g", cost) (limit ~ /^[0-9]/ && cost + 0 > limit + 0 ? "!" : "")
}
'
# For the awk programs of the tables: an error in two digits, without any behind the point where it is large; the standard deviation
# over seeds of a list of figures, " +- 0.4", "" of one.
error='function error(x) { return sprintf(x >= 99.5 ? "%.0f" : "%.2g", x) }
'
deviation=$error'function deviation(list, x, n, i, s, q) {
  n = split(list, x, /!?, */); for (i = 1; i <= n; ++i) s += x[i]
  for (i = 1; i <= n; ++i) q += (x[i] - s / n) ^ 2
  return n > 1 ? " +- " error(sqrt(q / (n - 1))) : ""
}
'
over_note='A seed whose mean cost is over its limit is marked with an exclamation mark; behind +- stands the standard deviation over seeds.'
