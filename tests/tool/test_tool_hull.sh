#!/bin/sh
# test_tool_hull.sh TOOL: a mesh becomes an object that is thrown; .obj and both kinds of .stl are read.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }

# A block of 40 x 60 x 100 mm with points that are no corners of its hull.
{
  echo "# a block"
  for x in 0 40; do for y in 0 60; do for z in 0 100; do echo "v $x $y $z"; done; done; done
  echo "v 20 30 50"
  echo "v 20 30 0"
  echo "f 1 2 3"
} > block.obj
"$tool" hull block.obj --scale 0.001 --json > row 2> err
if grep -q "without qhull" err; then
  echo "no qhull in this tool"
  exit 77
fi
grep -q '"corners":8,' row || say "block.obj: $(cat row err)"
awk 'match($0, /"volume_m3":[0-9.e-]+/) { v = substr($0, RSTART + 12, RLENGTH - 12)
       exit !(v > 0.0002399 && v < 0.0002401) }' row || say "volume: $(cat row)"
option=$("$tool" hull block.obj --scale 0.001)
"$tool" rollout --task hand_over_safe_finger --policy hold --episodes 2 --set object=hull --set "$option" > out 2>&1 ||
  say "not thrown: $(cat out)"

# A ball of 30 mm: fewer corners are asked for, the hull stays near it.
awk 'BEGIN {
  print "solid ball"; n = 20; pi = 3.14159265358979
  for (i = 0; i <= n; ++i) for (j = 0; j < n; ++j) {
    a = pi * i / n; b = 2 * pi * j / n
    printf "vertex %.6f %.6f %.6f\n", 0.03 * sin(a) * cos(b), 0.03 * sin(a) * sin(b), 0.03 * cos(a)
  }
  print "endsolid"
}' > ball.stl
"$tool" hull ball.stl --points 24 --json > row || say "ball.stl fails"
grep -o '"points":\[\[.*\]\]' row | tr -d '"' | awk -F'],' '{ exit NF != 24 }' || say "not 24 points: $(cat row)"
awk 'match($0, /"error_m":[0-9.e-]+/) { e = substr($0, RSTART + 10, RLENGTH - 10); exit !(e > 0 && e < 0.006) }' row ||
  say "error: $(cat row)"

# One tetrahedron of 50 mm in binary: header, count, four facets of twelve floats and two bytes.
python3 - << 'END' 2> /dev/null || exit $failed
import struct
p = [(0, 0, 0), (0.05, 0, 0), (0, 0.05, 0), (0, 0, 0.05)]
with open("tetra.stl", "wb") as f:
    f.write(b"solid but binary".ljust(80) + struct.pack("<I", 4))
    for t in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)):
        f.write(struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in p[i]), 0))
END
"$tool" hull tetra.stl | grep -q '^hull=[-0-9.,;]*0.05' || say "tetra.stl fails"

for bad in "missing.obj" "block.txt" "flat.obj"; do
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n' > flat.obj
  "$tool" hull "$bad" > out 2>&1 && say "$bad was taken"
  [ "$(wc -l < out)" -eq 1 ] || say "$bad: $(cat out)"
done
exit $failed
