#!/bin/sh
# test_tool_object.sh TOOL: the catalogue is listed and drawn; meshes become objects that tasks take; .object files.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
number() { awk -v key="\"$1\":" '{ i = index($0, key); if (i) { v = substr($0, i + length(key)); sub(/[,}\]].*/, "", v); print v } }' "$2"; }
near() { awk -v a="$1" -v b="$2" -v e="$3" 'BEGIN { d = a - b; exit !(d <= e && -d <= e) }'; }

"$tool" objects --markdown | grep -q '^| `banana` |' || say "objects --markdown"
"$tool" objects --json > row && [ "$(grep -o '"name":' row | wc -l)" -gt 1 ] || say "objects --json"
"$tool" objects --sheet sheet.png --side 16 --columns 12 --json > row || say "no sheet"
grep -q '"columns":12' row && grep -q '"door"' row || say "sheet: $(cat row)"
[ "$(head -c 4 sheet.png | tail -c 3)" = PNG ] || say "sheet.png is no picture"

"$tool" object mug_with_handle > out 2> err
if grep -q "without the readers" err; then
  echo "no readers in this tool"
  exit 77
fi
grep -q "16 points" out || say "mug: $(cat out err)"
"$tool" object 025_mug --out mug.object > out || say "mug.object: $(cat out)"
sed -i 's/^name = .*/name = "my_mug"/; /^alias/d' mug.object
"$tool" object mug.object | grep -q '^my_mug: 0.118 kg' || say "mug.object is not read"
for command in "rollout --policy hold --episodes 1" "eval --policy zero --episodes 2"; do
  "$tool" $command --task grasp --object mug.object --set object=my_mug > out 2>&1 || say "$command: $(cat out)"
done
"$tool" render --task grasp --object mug.object --set object=my_mug --size 32x32 --out mug.png > out 2>&1 || say "render: $(cat out)"

# Meshes of other systems are read; broken ones say why.
printf '\357\273\277v 0 0 0\rv 0.1 0 0\rv 0 0.1 0\rv 0 0 0.1\rf 1 3 2\rf 1 2 4\rf 1 4 3\rf 2 3 4\r' > mac.obj
"$tool" object mac.obj --mass 0.1 > out 2>&1 || say "mac.obj: $(cat out)"
{ printf '%80s' x; printf '\2\0\0\0'; printf '%050d' 0; } > short.stl
"$tool" object short.stl --mass 0.1 > out 2>&1 && say "short.stl is taken"
grep -q "its header says 2 facets, 184 bytes; it has 134" out || say "short.stl: $(cat out)"
{ printf '%80s' x; printf '\0\0\0\0'; } > none.stl
"$tool" object none.stl --mass 0.1 > out 2>&1 && say "none.stl is taken"
grep -q "its header says 0 facets" out || say "none.stl: $(cat out)"

# An L of two blocks, closed, in mm: 40 x 20 x 20 lies, 20 x 20 x 20 stands on its end.
cat > ell.obj << 'END'
v 0 0 0
v 40 0 0
v 40 20 0
v 20 20 0
v 20 40 0
v 0 40 0
v 0 0 20
v 40 0 20
v 40 20 20
v 20 20 20
v 20 40 20
v 0 40 20
f 6 5 4 1
f 4 3 2 1
f 7 10 11 12
f 7 8 9 10
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
f 6 1 7 12
END
"$tool" object ell.obj --scale 0.001 --mass 0.12 --json > row 2> err
if grep -q "without qhull" err; then
  echo "no qhull in this tool"
  exit $failed
fi
grep -q '"closed":true' row || say "ell.obj: $(cat row err)"
near "$(number volume_m3 row)" 2.4e-5 1e-12 || say "volume: $(cat row)"
near "$(number parts_m3 row)" 2.8e-5 1e-12 || say "hull: $(cat row)"
# three cubes of 0.04 kg and 20 mm: about z m s2 / 6 each, and m r2 with r2 of 89, 222 and 222 mm2 from their centre
near "$(sed 's/.*"moment":\[[^,]*,[^,]*,//; s/,.*//' row)" 2.93333e-5 1e-9 || say "moment: $(cat row)"
"$tool" object ell.obj --scale 0.001 --mass 0.12 --parts 2 --material wood --friction 0.45 --name ell --out ell.object --json > row 2> err
if grep -q "without HACD" err; then
  echo "no HACD in this tool: one part alone was tried"
else
  [ "$(number parts row)" -ge 2 ] || say "parts: $(cat row err)"
  near "$(number parts_m3 row)" 2.58e-5 1.8e-6 || say "parts: $(cat row err)"  # they overlap where they meet
  near "$(number error_m row)" 0 1e-5 || say "parts: $(cat row err)"
  "$tool" rollout --task hand_over_safe_finger --policy hold --episodes 1 --object ell.object --set object=ell > out 2>&1 ||
    say "not thrown: $(cat out)"
fi

# A mesh that is open has the moments of its parts.
sed '/^f 6 1 7 12/d' ell.obj > open.obj
"$tool" object open.obj --scale 0.001 --mass 0.12 --json > row || say "open.obj fails"
grep -q '"closed":false' row || say "open.obj: $(cat row)"

bad() { # bad TEXT arguments...: one line that has the text
  text=$1
  shift
  "$tool" "$@" > out 2>&1 && say "taken: $*"
  [ "$(wc -l < out)" -eq 1 ] && grep -q -- "$text" out || say "$*: $(cat out)"
}
echo 'f 1 2 9' > few.obj; head -4 ell.obj >> few.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n' > flat.obj
printf 'name = "x"\nmas = 1\n' > bad.object
bad "there is no such file, and no object of that name" object bananna
bad "needs a mass above 0 kg" object ell.obj
bad "a face names a vertex that is not there" object few.obj --mass 1
bad "in one plane" object flat.obj --mass 1
bad "line 2: mas is not a known key; nearest is mass" object bad.object
bad "are for a mesh" object mug.object --mass 1
bad "line 2: mas is not a known key" eval --task grasp --object bad.object
bad "the name is already used: give it another by redman object mug.object --name NAME --out NAME.object" eval --task grasp --object mug.object --object mug.object
# What the text says to do works.
"$tool" object mug.object --name mug2 --out mug2.object > out 2>&1 || say "object --name: $(cat out)"
"$tool" objects --object mug.object --object mug2.object | grep -q '^mug2 ' || say "mug under another name"
"$tool" object 011_banana --name banana2 --out banana2.object > out 2>&1 || say "object --name: $(cat out)"
"$tool" objects --object banana2.object | grep -q '^banana2 ' || say "one of the list under another name, without its alias"
bad "the name a b may contain only letters" object mug.object --name 'a b' --out ab.object
[ ! -e ab.object ] || say "an object is written that cannot be read"
bad "banana" eval --task grasp --set object=bananna
exit $failed
