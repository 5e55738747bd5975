#!/bin/sh
# test_tool_readme.sh TOOL: the tables of tasks, algorithms and robots in README.md, of objects in lib/objects/README.md and of
# presets in tasks/README.md, are what the tool prints; README's task as text is the file that it names; the
# tables of results are what examples/paper_report.sh makes of the rows of runs, and README.md has the short one.
set -u
tool=$(realpath "$1")
readme=$(dirname "$0")/../../README.md
[ -f "$readme" ] || { echo "there is no README.md"; exit 1; }
lost=$({ "$tool" tasks --markdown && "$tool" algos --markdown && "$tool" robots --markdown; } | grep -v '^|---' | while IFS= read -r line; do
  grep -qxF -- "$line" "$readme" || echo "README.md has no line: $line"
done)
lost=$lost$("$tool" objects --markdown | grep -v '^|---' | while IFS= read -r line; do
  grep -qxF -- "$line" "${readme%README.md}lib/objects/README.md" || echo "lib/objects/README.md has no line: $line"
done)
lost=$lost$("$tool" tasks --presets --markdown | while IFS= read -r line; do
  grep -qxF -- "$line" "${readme%README.md}tasks/README.md" || echo "tasks/README.md has no line: $line"
done)
task=${readme%README.md}examples/scenes/press.task
sed -n '/<summary>examples\/scenes\/press.task/,/^<\/details>/p' "$readme" | sed '1,/^```toml$/d; /^```$/,$d' | cmp - "$task" ||
  lost="$lost README.md's press.task is not $task"
results=${readme%README.md}examples/results
again=$(mktemp -d)
trap 'rm -rf "$again"' EXIT
cp "$results/runs.csv" "$again"
bash "${readme%README.md}examples/paper_report.sh" "$again"
for table in table1 fig7 second claims short; do
  cmp "$again/$table.md" "$results/$table.md" || lost="$lost $results/$table.md is not what its runs.csv makes"
done
lost=$lost$(grep -v '^|---' "$results/short.md" | while IFS= read -r line; do
  grep -qxF -- "$line" "$readme" || echo "README.md has no line: $line"
done)
[ -z "$lost" ] || { echo "$lost"; exit 1; }
