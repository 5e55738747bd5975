#!/bin/sh
# reference.sh ROOT FOLDER: Doxygen had no word to say, and in its XML every exported function, every member of a struct and
# every enum has a text.
set -eu
root=$1 folder=$2
status=0
if [ -s "$folder/warnings.txt" ]; then cat "$folder/warnings.txt"; status=1; fi
# "kind name texts" of each thing that is declared.
awk '
  /<compoundname>/ { owner = $0; gsub(/^ *<compoundname>|<\/compoundname>.*/, "", owner) }
  /<memberdef kind="/ { match($0, /kind="[a-z]+"/); kind = substr($0, RSTART + 6, RLENGTH - 7); name = ""; text = 0 }
  kind != "" && /^ *<name>/ && name == "" { name = $0; gsub(/^ *<name>|<\/name>.*/, "", name) }
  /<enumvalue / { in_value = 1 }
  /<\/enumvalue>/ { in_value = 0 }
  kind != "" && !in_value && /<para>/ { ++text }
  /<\/memberdef>/ { print kind, (kind == "variable" ? owner "." : "") name, text; kind = "" }
' "$folder"/xml/*.xml | sort -u > "$folder/declared.txt"
for name in $(cat "$root"/capi/*.symbols | grep '^rdm_' | grep -vxFf "$root/capi/redman_old.symbols"); do
  grep -q "^function $name [1-9]" "$folder/declared.txt" || { echo "$name has no text in the reference"; status=1; }
done
bare=$(grep -E '^(variable|enum|typedef|function) .* 0$' "$folder/declared.txt" || true)
[ -z "$bare" ] || { echo "without a text: $bare"; status=1; }
echo "$(grep -c ^function "$folder/declared.txt") functions, $(grep -c ^variable "$folder/declared.txt") members, $(grep -c ^enum "$folder/declared.txt") enums"
exit $status
