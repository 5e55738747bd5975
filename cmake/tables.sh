#!/usr/bin/env bash
# tables.sh TOOL [check]: writes what the tool prints between the marks of the pages, `<!-- NAME -->` and `<!-- end of NAME -->`,
# and begins the pages of the manual that are missing; with `check` it changes nothing, and says what is not what the tool prints.
set -u
tool=$(realpath "${1:-build/release/bin/redman}") mode=${2:-write}
[ -x "$tool" ] || { echo "tables.sh: there is no tool $tool" >&2; exit 1; }
cd "$(dirname "$0")/.." || exit 1
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
failed=0

# table PAGE NAME COMMAND...: the command's output between the marks of that name.
table() {
  local page=$1 name=$2
  shift 2
  "$@" > "$new/rows" || { echo "$page: $name: '$*' failed"; failed=1; return; }
  if ! grep -qxF "<!-- $name -->" "$page" || ! grep -qxF "<!-- end of $name -->" "$page"; then
    echo "$page has no marks of $name"
    failed=1
    return
  fi
  awk -v name="$name" -v rows="$new/rows" '
    $0 == "<!-- " name " -->" { print; while ((getline line < rows) > 0) print line; inside = 1; next }
    $0 == "<!-- end of " name " -->" { inside = 0 }
    !inside { print }' "$page" > "$new/page"
  cmp -s "$new/page" "$page" && return
  if [ "$mode" = check ]; then
    echo "$page: the table between the marks of $name is not what '${*##*/}' prints; bash cmake/tables.sh writes it"
    diff "$page" "$new/page" | head -n 6
    failed=1
  else
    cp "$new/page" "$page"
  fi
}

# page PAGE COMMAND...: each block that the command prints with its marks goes between the same marks of the page. A page that is
# missing is what the command prints.
page() {
  local page=$1 name
  shift
  "$@" > "$new/blocks" || { echo "$page: '$*' failed"; failed=1; return; }
  if [ ! -e "$page" ]; then
    if [ "$mode" = check ]; then
      echo "there is no $page; bash cmake/tables.sh begins it"
      failed=1
    else
      cp "$new/blocks" "$page"
    fi
    return
  fi
  for name in $(sed -n 's/^<!-- end of \(.*\) -->$/\1/p' "$new/blocks"); do
    table "$page" "$name" sed -n "/^<!-- $name -->\$/,/^<!-- end of $name -->\$/{//!p}" "$new/blocks"
  done
}

# links FOLDER COMMAND...: its table, whose names are links to their pages there.
links() {
  local folder=$1
  shift
  "$@" | sed "s|^. \`\([a-z0-9_]*\)\` .|\| [\`\1\`](${folder}\1.md) \||"
}
# named FOLDER COMMAND...: the names alone of its table, as links in running text.
named() {
  links "$@" | sed -n 's/^| \(\[`[^|]*\) |.*/\1/p' | paste -sd, | sed 's/,/, /g' | fold -s -w 150 | sed 's/ *$//'
}
names() { "$tool" "$1" | awk 'NR > 1 { print $1 }'; }
task_blocks() { "$tool" tasks "$1" --markdown && bash examples/score_table.sh --block "$1"; }
algo_blocks() { "$tool" algos "$1" --markdown && bash examples/paper_report.sh --block "$1"; }

table CONTRIBUTING.md modes bash cmake/check.sh --markdown
table README.md algorithms named examples/manual/algorithms/ "$tool" algos --markdown
table examples/manual/algorithms/README.md algorithms links "" "$tool" algos --markdown
table examples/manual/tasks/README.md tasks links "" "$tool" tasks --markdown
table examples/manual/tasks/README.md presets "$tool" tasks --presets --markdown
table examples/robots/README.md robots "$tool" robots --markdown
table lib/objects/README.md objects "$tool" objects --markdown
table examples/results/hand_tasks.md runs cat examples/results/short.md
for list in tasks algos; do
  folder=examples/manual/tasks blocks=task_blocks
  [ $list = tasks ] || folder=examples/manual/algorithms blocks=algo_blocks
  all=$(names $list)
  for name in $all; do page "$folder/$name.md" $blocks "$name"; done
  for found in "$folder"/[a-z]*.md; do
    name=$(basename "$found" .md)
    grep -qx "$name" <<< "$all" || { echo "$found: 'redman $list' has no $name"; failed=1; }
  done
done
exit $failed
