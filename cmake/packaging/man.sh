#!/bin/sh
# man.sh TOOL VERSION OUT: a manual page for the tool and one for each subcommand into OUT/man1, made by help2man of what
# --help prints.
set -eu
tool=$1 version=$2 out=$3
rm -rf "$out/man1"
mkdir -p "$out/man1"

# The subcommands of a help text: words at the begin of a line, under the titles of their groups.
children() {
  awk '/^[A-Z].*:$/ { on = !/^(Positionals|Example):/; next } !/^ / && NF { on = 0 } on && /^  [a-z]/ { print $1 }'
}

# page SUMMARY WORD...: the page of the subcommand of these words, and of those below it.
page() {
  local summary=$1 text below name child
  shift
  name=$(echo "redman $*" | sed 's/ *$//; s/ /-/g')
  text=$("$tool" "$@" --help)
  below=$(printf '%s\n' "$text" | children)
  { echo '[see also]'
    if [ $# -gt 0 ]; then echo '.BR redman (1)'; fi
    for child in $below; do echo ".BR $name-$child (1)"; done
  } | sed '1! { $! s/$/,/; }' > "$out/see"
  # help2man takes the page's name from its program, and two spaces between a flag and its text.
  { echo '#!/bin/sh'
    printf '%s\n' "'$tool' $* --help | sed 's/^\(  -[^ ]* [^ ]*\) \([^ .].*\)/\1  \2/'"
  } > "$out/$name"
  chmod +x "$out/$name"
  help2man --no-info --section=1 --manual='redman manual' --source="redman $version" --version-string="$version" \
    --name="$summary" --include="$out/see" "$out/$name" |
    sed 's/\\fR,\(\\-[a-z\\-]*\)/\\fR, \\fB\1\\fR/g' > "$out/man1/$name.1"
  rm "$out/$name"
  for child in $below; do
    page "$(printf '%s\n' "$text" | sed -n "s/^  $child  *//p" | head -n1)" "$@" "$child"
  done
}
page "$("$tool" --help | head -n1)"
rm "$out/see"
