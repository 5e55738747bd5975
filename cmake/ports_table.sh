#!/usr/bin/env bash
# ports_table.sh: the table of machines in cmake/cross/README.md from the rows that check.sh's modes left in build/ports; a mode that was not
# run since keeps its row.
set -u
cd "$(dirname "$0")/.." || exit 1
page=cmake/cross/README.md
for row in build/ports/*.row; do
  [ -e "$row" ] || { echo "no rows: run check.sh arm64, windows, clang, libc++, browser first"; exit 1; }
  title=$(cut -d'|' -f2 "$row")
  awk -v title="$title" -v row="$(cat "$row")" -F'|' '
    /^<!-- machines -->/ { inside = 1 }
    /^<!-- end of machines -->/ { if (!done) print row; inside = 0 }
    inside && $2 == title { print row; done = 1; next }
    { print }' "$page" > build/ports/page.md && cp build/ports/page.md "$page"
done
