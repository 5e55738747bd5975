#!/bin/sh
# manual.sh TOOL FOLDER: every subcommand and every flag that the tool's help names stands in its manual page and in the
# completions, and shells complete with them. FOLDER is what the target `manual` made; without help2man it has no pages.
set -u
tool=$1 folder=$2
status=0
lacks() { echo "$*"; status=1; }

[ "$("$tool" --version)" = "redman $("$tool" info --json | sed 's/.*"version":"\([^"]*\)".*/\1/')" ] ||
  lacks "--version says $("$tool" --version)"

# commands WORD...: the subcommand of these words and those below it, a line each, as their help lists them.
commands() {
  echo "$*"
  for child in $("$tool" "$@" --help | awk '/^[A-Z].*:$/ { on = !/^(Positionals|Example):/; next } !/^ / && NF { on = 0 } on && /^  [a-z]/ { print $1 }'); do
    (commands "$@" "$child")
  done
}
flags=0 pages=0
list=$(commands)
while read -r words; do
  # shellcheck disable=SC2086
  help=$("$tool" $words --help)
  name=$(echo "redman $words" | sed 's/ *$//; s/ /-/g') page=
  [ -d "$folder/man1" ] && page=$folder/man1/$name.1
  # Plain text of the page: quotes of hyphens and fonts taken out.
  [ -z "$page" ] || { pages=$((pages + 1)); sed 's/\\f[BIR]//g; s/\\-/-/g; s/\\,//g; s/\\\///g' "$page" > "$folder/plain" || lacks "no page $name"; }
  bash=$(grep -F -- "    '$words') words=" "$folder/bash/redman") || lacks "bash: no '$words'"
  zsh=$(awk -v key="  '$words')" '$0 == key { on = 1 } on { print } on && /;;/ { exit }' "$folder/zsh/_redman")
  for flag in $(echo "$help" | grep -oE '^  -[^ ]*' | tr ',' ' '); do
    flags=$((flags + 1))
    [ -z "$page" ] || grep -qE -- "(^|[ ,])$flag([ ,=]|\$)" "$folder/plain" || lacks "$name.1: no $flag"
    echo "$bash" | grep -qE -- "[ ']$flag[ ']" || lacks "bash, '$words': no $flag"
    echo "$zsh" | grep -qF -- "'*$flag'" || lacks "zsh, '$words': no $flag"
    case $flag in
      --*) fish=" -l ${flag#--} " ;;
      *) fish=" -s ${flag#-} " ;;
    esac
    last=${words##* }
    grep -F -- "${last:-__fish_use_subcommand}' " "$folder/fish/redman.fish" | grep -qF -- "$fish" || lacks "fish, '$words': no $flag"
  done
done <<END
$list
END
rm -f "$folder/plain"

# Bash itself, as a person types: WORD... and what must be among the answers.
completes() {
  wanted=$1
  shift
  bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _redman; printf "%s\n" "${COMPREPLY[@]}"' \
    "$folder/bash/redman" "$@" | grep -qxF -- "$wanted" || lacks "bash does not complete '$*' with $wanted"
}
completes train redman tr
completes --task redman train --ta
completes observe redman bench ob
completes --modality redman bench observe --mo
# Names are of the halves that this build has.
algos=$("$tool" algos | grep -c '^ *focops ')
if "$tool" tasks | grep -q '^ *clean_house '; then
  completes hand_over_wall redman eval --policy zero --task hand_over_w
  completes clean_house redman tasks cl
fi
[ "$algos" -eq 0 ] || completes focops redman train --algo fo
for shell in zsh fish; do
  command -v $shell > /dev/null || { echo "no $shell here: its script is not read by it"; continue; }
  "$shell" -n "$folder/$shell/"*redman* || lacks "$shell cannot read its script"
done
if command -v fish > /dev/null; then
  set -- 'redman tr=train' 'redman bench step --ta=--task'
  [ "$algos" -eq 0 ] || set -- "$@" 'redman train --algo fo=focops'
  for pair in "$@"; do
    fish --no-config -c "source $folder/fish/redman.fish; complete -C '${pair%%=*}'" | grep -q "^${pair#*=}" ||
      lacks "fish does not complete '${pair%%=*}' with ${pair#*=}"
  done
fi
[ "$flags" -gt 100 ] || lacks "only $flags flags were looked at"
echo "$flags flags of $(echo "$list" | wc -l) commands, $pages manual pages"
exit $status
