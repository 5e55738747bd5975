#!/usr/bin/env bash
# truth_table.sh [BUILD] [check] [short]: writes the truth table of physics between the marks of lib/physics/README.md,
# `<!-- truth -->` and `<!-- end of truth -->`, by BUILD/tests/truth and BUILD/bin/redman; BUILD is build/dev unless given. With
# `check` it changes nothing, prints all rows, and fails where one is off or is not as the page has it. `short` leaves out the
# rows of skills, which take minutes: those of the page stay as they are.
set -u
cd "$(dirname "$0")/.." || exit 1
page=lib/physics/README.md build=build/dev mode=write skills=1
for word in "$@"; do
  case $word in
    check) mode=check ;;
    short) skills=0 ;;
    *) build=$word ;;
  esac
done
truth=$build/tests/truth
[ -x "$truth" ] || { echo "there is no $truth: cmake --build $build --target truth redman_tool"; exit 1; }
words=(--jobs "$(nproc)")
[ $skills = 0 ] || words+=(--skills "$build/bin/redman" examples/policies)
[ $mode = write ] || exec "$truth" "${words[@]}" --page "$page"

new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
"$truth" "${words[@]}" --markdown > "$new/rows"
status=$?
[ $status -le 1 ] || exit $status
if [ $skills = 0 ]; then # the old ones
  echo >> "$new/rows"
  awk '$0 == "**Skills at other substeps**" { inside = 1 } $0 == "<!-- end of truth -->" { inside = 0 } inside { print }' "$page" >> "$new/rows"
fi
awk -v rows="$new/rows" '
  $0 == "<!-- truth -->" { print; while ((getline line < rows) > 0) print line; inside = 1; next }
  $0 == "<!-- end of truth -->" { inside = 0 }
  !inside { print }' "$page" > "$new/page"
cmp -s "$new/page" "$page" || cp "$new/page" "$page"
exit $status
