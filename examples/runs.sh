# shellcheck shell=bash
# Sourced by the scripts of tables: runs that are kept, and numbers out of the tool's JSON.
# shellcheck disable=SC2034
redman=${REDMAN:-$(dirname "${BASH_SOURCE[0]}")/../build/release/bin/redman}
jobs=${JOBS:-2}

# value KEY FILE: a number or truth value of the tool's one-line JSON, the first one of an array
value() { sed -n "s/.*\"$1\":\[\{0,1\}\([-+.0-9a-z]*\).*/\1/p" "$2"; }

# Waits until one of the $jobs places is free.
wait_turn() {
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do sleep 1; done
}

# kept FILE COMMAND...: FILE is what the tool's command prints with --json; nothing is done when it is there.
kept() {
  local file=$1
  shift
  [ -s "$file" ] && return
  "$redman" "$@" --json > "$file.part" 2> "${file%.json}.log" || return
  grep -q '"interrupted":true' "$file.part" || mv "$file.part" "$file"
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

# tail_of CSV: "return,cost", means over the last tenth of the epochs of a progress.csv.
tail_of() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if ($i == "Metrics/EpRet") r = i; if ($i == "Metrics/EpCost") c = i } next }
    { ret[NR] = $r; cost[NR] = $c }
    END { first = NR - int((NR - 1) / 10) + 1; if (first > NR) first = NR
      for (i = first; i <= NR; ++i) { a += ret[i]; b += cost[i] }
      printf "%.4f,%.4f", a / (NR - first + 1), b / (NR - first + 1) }' "$1"
}
