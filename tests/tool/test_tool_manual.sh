#!/bin/sh
# test_tool_manual.sh TOOL: the command lines of README, the manual and the folders' pages name subcommands and flags that the tool has;
# each algorithm has a page of the same parts.
set -u
tool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
helps=$(mktemp -d)
trap 'rm -rf "$helps"' EXIT
failed=0 commands=0
# Lines of code, joined where a backslash ends them: the page, the subcommand (of bench and data its own too), the flags.
awk '
  FNR == 1 { fence = code = 0 }
  /^```/ { fence = !fence; code = fence && /^```(sh)?$/; next }
  code {
    line = line $0
    if (sub(/\\$/, "", line)) next
    sub(/ #.*/, "", line)
    gsub(/\$\([^)]*\)/, "", line)  # what another command prints
    if (match(line, /(^|[ (])(build\/[a-z]*\/bin\/|\$|\.\/)?redman +[a-z]+/)) {
      text = substr(line, RSTART)
      sub(/^[ (]*[^ ]* +/, "", text)
      words = split(text, word, " ")
      command = word[1]
      if (command == "bench" || command == "data") command = command " " word[2]
      flags = ""
      for (i = 2; i <= words; i++) if (word[i] ~ /^--[a-z]/) { sub(/=.*/, "", word[i]); flags = flags " " word[i] }
      print FILENAME "|" command "|" flags
    }
    line = ""
  }' README.md examples/manual/*.md examples/demos/README.md examples/policies/README.md examples/scenes/README.md > "$helps/lines"
while IFS='|' read -r page command flags; do
  commands=$((commands + 1))
  help="$helps/$(echo "$command" | tr ' ' _).help"
  # shellcheck disable=SC2086
  [ -e "$help" ] || "$tool" $command --help > "$help" 2> /dev/null || { echo "$page: redman has no command $command"; failed=1; continue; }
  for flag in $flags; do
    case $flag in --json | --plugin | --help) continue ;; esac
    grep -qE -- "(^|[ ,])$flag([ ,=]|\$)" "$help" || { echo "$page: redman $command has no $flag"; failed=1; }
  done
done < "$helps/lines"
# Learners from data alone have no curve over control steps.
for algo in $("$tool" algos | awk 'NR > 1 { print $1 }'); do
  page=examples/manual/algorithms/$algo.md
  for part in Update Source 'Differences from the source' Options; do
    grep -q "^## $part\$" "$page" || { echo "$page: it has no section $part"; failed=1; }
  done
  case $algo in td3_bc_lag | cpq | bcq_lag | coptidice) continue ;; esac
  grep -q "^!\[.*(../../pictures/algorithms/$algo.svg)" "$page" && [ -s "examples/pictures/algorithms/$algo.svg" ] ||
    { echo "$page: it has no learning curves"; failed=1; }
done
[ $commands -ge 50 ] || { echo "only $commands command lines were found"; failed=1; }
exit $failed
