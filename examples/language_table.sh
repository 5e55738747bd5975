#!/usr/bin/env bash
# examples/README.md's table of languages: what rdm_pool_step costs from each, beside C in the same minute.
#   bash examples/language_table.sh runs/first/policy.rdm
# Best of ROUNDS (3), each after C's own, in CPU time: other work on the machine shows less. Environment: LANGUAGES, and that of
# languages.sh.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
policy=${1:?usage: language_table.sh POLICY}
part=$(mktemp -d)
trap 'rm -rf "$part"' EXIT

# kept LANGUAGE FILE: appends what the language's program prints to FILE.
kept() { bash "$root/examples/languages.sh" "$1" "$policy" bench >> "$2"; }
# best FILE WORD FIELD ORDER: the least or greatest number of the lines that end with WORD.
best() { grep "$2\$" "$1" | awk -v field="$3" '{ print $field }' | sort -g"$4" | head -n1; }

echo "| language | lines | same as C | ns of a step of \`bandit\`, over C's | steps/s of \`hand_over\`, 1 world, of C's | 64 worlds |"
echo "|---|---|---|---|---|---|"
for language in ${LANGUAGES:-cpp rust go node lua java csharp ruby}; do
  rm -f "$part"/*
  for _ in $(seq "${ROUNDS:-3}"); do
    kept c "$part/c"
    kept "$language" "$part/other" || { tail -n1 "$part/other" >&2; continue 2; }
  done
  same=yes
  [ "$(grep hash "$part/c" | sort -u)" = "$(grep hash "$part/other" | sort -u)" ] || same=no
  for file in "$part/c" "$part/other"; do
    echo "$(best "$file" 'ns a step' 2 '') $(best "$file" ' 1 world' 2 r) $(best "$file" ' 64 worlds' 2 r)"
  done | xargs | awk -v language="$language" -v lines="$(cat "$root/examples/$language"/[hH]ello.* | wc -l)" -v same="$same" '{
    printf "| %s | %d | %s | %d (C %d) | %.2f (%d of %d) | %.2f (%d of %d) |\n",
      language, lines, same, $4 - $1, $1, $5 / $2, $5, $2, $6 / $3, $6, $3 }'
done
