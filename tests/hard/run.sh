#!/usr/bin/env bash
# run.sh PART SECONDS BUILD: one part of the hard checks, for about so long, with the programs of a build folder.
# PART: fuzz, refuse, words, threads, kills, soak. The last line is "N passed, M failed". See README.md.
set -u
part=$1 seconds=$2 build=$(realpath "$3")
here=$(cd "$(dirname "$0")" && pwd)
bin=$build/hard
out=$build/hard/found
mkdir -p "$out"
export UBSAN_OPTIONS=print_stacktrace=1

# Inputs of each target are led by coverage for a share of the time, at most REDMAN_FUZZ_RUNS of them. Fast targets leave their
# time to the slow ones. What ends a target stays in $out, with the command that does it again.
fuzz() {
  local most=${REDMAN_FUZZ_RUNS:-2000000} begin=$SECONDS passed=0 failed=0 targets=() left share log status program length
  # "state" of the small worlds and of those with an engine: the one steps in microseconds, the other in milliseconds
  for t in policy hull names tool_run tool_mesh tool_demo tool_record recording import task agent checkpoint map state options state-large; do
    [ -x "$bin/fuzz_${t%-*}" ] && targets+=("$t")
  done
  left=${#targets[@]}
  [ "$left" -gt 0 ] || { echo "$bin holds no fuzz target: build the target \`hard\`"; return 1; }
  printf '%-12s %9s %8s %8s %9s\n' 'fuzzed' inputs edges features 'MB at most'
  for t in "${targets[@]}"; do
    share=$(((seconds - (SECONDS - begin)) / left))
    [ "$share" -gt 1 ] || share=1
    left=$((left - 1))
    mkdir -p "$out/corpus-$t" "$here/corpus/${t%-*}"
    log=$out/$t.log program=$bin/fuzz_${t%-*} length=32768
    case $t in
      state) export RDM_FUZZ_WORLDS=small ;;
      state-large) export RDM_FUZZ_WORLDS=/ length=65536 ;;
      options | tool_demo | hull) length=2048 ;;
      names) length=8192 ;;
    esac
    "$program" --seeds "$out/corpus-$t" > /dev/null
    "$program" -max_total_time="$share" -runs=$most -max_len=$length -rss_limit_mb=1024 -malloc_limit_mb=1024 \
      -timeout=20 -print_final_stats=1 -verbosity=1 -artifact_prefix="$out/$t-" "$out/corpus-$t" "$here/corpus/${t%-*}" > "$log" 2>&1
    status=$?
    printf '%-12s %9s %8s %8s %9s\n' "$t" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
      "$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n1)" "$(sed -n 's/.* ft: \([0-9]*\) .*/\1/p' "$log" | tail -n1)" \
      "$(sed -n 's/^stat::peak_rss_mb: *//p' "$log")"
    if [ $status -eq 0 ]; then
      passed=$((passed + 1))
    else
      failed=$((failed + 1))
      grep -a -m3 -E 'not so:|ERROR: Addr|ERROR: Leak|runtime error:|took .* s$|SUMMARY' "$log"
      sed -n "s|.*Test unit written to \\(.*\\)|again: ${RDM_FUZZ_WORLDS:+RDM_FUZZ_WORLDS=$RDM_FUZZ_WORLDS }$program \\1|p" "$log"
    fi
  done
  echo "$passed passed, $failed failed"
  [ $failed -eq 0 ]
}

case $part in
  fuzz) fuzz ;;
  refuse) "$bin/hard_refuse" --seconds "$seconds" ;;
  words) ASAN_OPTIONS=detect_leaks=0:handle_abort=0 "$bin/hard_words" --seconds "$seconds" ;;
  threads) TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=$here/tsan.supp "$bin/hard_threads" --rounds $((1 + seconds / 60)) ;;
  kills) "$here/kills.sh" "$build/bin/redman" $((seconds > 300 ? 100 : 2 + seconds / 5)) ;;
  soak) "$bin/hard_soak" --seconds "$seconds" --jobs "${REDMAN_HARD_JOBS:-1}" --json "$out/soak.json" ;;
  *) echo "usage: run.sh fuzz|refuse|words|threads|kills|soak SECONDS BUILD"; exit 2 ;;
esac
