#!/usr/bin/env bash
# tables.sh TOOL [check]: writes what the tool prints between the marks of the pages, `<!-- NAME -->` and `<!-- end of NAME -->`;
# with `check` it changes nothing, and says which table is not what the tool prints.
set -u
tool=$(realpath "${1:-build/release/bin/redman}") mode=${2:-write}
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

table CONTRIBUTING.md modes bash cmake/check.sh --markdown
table README.md algorithms "$tool" algos --markdown
table tasks/README.md tasks "$tool" tasks --markdown
table tasks/README.md presets "$tool" tasks --presets --markdown
table examples/robots/README.md robots "$tool" robots --markdown
table lib/objects/README.md objects "$tool" objects --markdown
table examples/results/hand_tasks.md runs cat examples/results/short.md
exit $failed
