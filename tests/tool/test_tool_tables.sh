#!/bin/sh
# test_tool_tables.sh TOOL: the tables between marks in the pages are what the tool prints, and the tables of results are what
# examples/paper_report.sh makes of the rows of runs.
set -u
tool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
[ -f README.md ] || { echo "there is no README.md"; exit 1; }
lost=$(bash cmake/tables.sh "$tool" check)
results=examples/results
again=$(mktemp -d)
trap 'rm -rf "$again"' EXIT
cp "$results/runs.csv" "$results"/*.svg "$again"  # a page shows the curves that stand beside it
REDMAN=$tool bash examples/paper_report.sh "$again"
for table in table1 command fig7 second shield claims short; do
  cmp "$again/$table.md" "$results/$table.md" || lost="$lost $results/$table.md is not what its runs.csv makes"
done
# A row has as many cells as its head, whatever is written in them.
for list in tasks algos; do
  "$tool" $list --markdown | sed 's/\\|//g' | awk -F'|' -v list=$list 'NR == 1 { n = NF } NF != n { print list " --markdown: cells of " $2; lost = 1 } END { exit lost }' ||
    lost="$lost cells"
done
[ -z "$lost" ] || { echo "$lost"; exit 1; }
