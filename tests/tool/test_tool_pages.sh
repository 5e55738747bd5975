#!/bin/sh
# test_tool_pages.sh TOOL: pages and glTF files of episodes, and the report of runs. What they are made of is checked
# everywhere; npm's gltf-validator judges the files, and headless Chromium opens the pages, where they are there (77, a
# skip, where they are not). PAGES=DIR keeps the pages and what they look like.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
pages=${PAGES:-$dir/pages}
mkdir -p "$pages"
pages=$(realpath "$pages")

# word FILE OFFSET: a little-endian number of four bytes
word() { od -An -tu4 -j "$2" -N 4 "$1" | tr -d ' '; }
glb() {  # glb FILE: the head tells the file's length, and JSON comes first
  [ "$(head -c 4 "$1")" = glTF ] && [ "$(word "$1" 4)" = 2 ] || say "$1 is no glTF 2.0"
  [ "$(word "$1" 8)" = "$(stat -c %s "$1")" ] || say "$1: its head says $(word "$1" 8) bytes"
}
alone() {  # alone FILE: nothing is fetched from anywhere
  grep -oE '(src|href)="[a-z]*:?//[^"]*"|@import|url\(' "$1" | head -n 3 | grep . && say "$1 needs other files"
}

"$tool" render --task ball_run --policy random --html none.html > /dev/null 2> err
viewer=$?
[ $viewer -eq 0 ] || grep -q 'no viewer library: install the package libjs-three' err || say "without a viewer: $(cat err)"
play() {  # play NAME FLAGS...
  name=$1
  shift
  "$tool" render "$@" --glb "$pages/$name.glb" --json > out 2> err || say "$name.glb: $(cat err)"
  glb "$pages/$name.glb"
  [ $viewer -eq 0 ] || return
  "$tool" render "$@" --html "$pages/$name.html" --json > out 2> err || say "$name.html: $(cat err)"
  grep -q '"frames":[0-9]' out && grep -q "\"file\":\"$pages/$name.html\"" out || say "$name: $(cat out)"
  alone "$pages/$name.html"
  size=$(stat -c %s "$pages/$name.html")
  [ "$size" -lt 3000000 ] || say "$name.html has $size bytes"
}
play hand --task hand_over_safe_finger --policy demo --seed 3
play jenga --task jenga --policy demo
play house --task clean_house --policy demo
play hull --task hand_over_safe_finger --policy zero --set object=hull
play ball --task ball_run --policy random --camera top
play arena --task point_button2 --policy random --to 60
play wall --task hand_over_wall --policy trained --seed 2 --shield predict --to 24
play one --task bandit --policy zero --from 1

# both at once, with a picture, and a moment in the middle
"$tool" render --task grasp --policy demo --from 10 --to 20 --glb g.glb --out g.png --size 32x24 --json > out 2> err || say "$(cat err)"
grep -q '"file":"g.png"' out && grep -q '"glb":"g.glb"' out && [ -s g.png ] || say "picture and glb: $(cat out)"
mkdir taken
"$tool" render --task grasp --glb taken > out 2> err && say "a folder was replaced by a file"

# the report of two configurations, one with two seeds, and of a run that cannot be evaluated
for run in 'ppo_lag 0' 'ppo_lag 1' 'ppo 0'; do
  # shellcheck disable=SC2086
  set -- $run
  "$tool" train --task ball_run --algo "$1" --seed "$2" --envs 4 --steps 16000 --set max_steps=50 --set horizon=100 --out "runs/$1.$2" \
    > /dev/null 2> err || { cat err; exit 1; }
done
"$tool" report runs --html "$pages/report.html" --episodes 10 --json > out 2> err || say "report: $(cat err)"
grep -q '"runs":3,' out && grep -q "\"file\":\"$pages/report.html\"" out || say "report: $(cat out)"
[ "$(grep -o '"configuration":' out | wc -l)" -eq 2 ] || say "seeds are not one configuration: $(cat out)"
alone "$pages/report.html"
check() {  # check WHAT TEXT COUNT
  count=$(grep -o -- "$2" "$pages/report.html" | wc -l)
  [ "$count" -eq "$3" ] || say "$1: $count instead of $3"
}
check 'rows of the ranking' '<td class="state"><b class="[a-z]*">[a-z]*</b> <small>' 2
check 'strips' 'src="data:image/png;base64,' 2
check 'the limit of the cost, in the same grey' 'class="level" stroke="#555555"' 1
check 'what differs' '<td class="name">algo</td>' 1
cp -r runs/ppo.0 runs/bad
echo 'not a policy' > runs/bad/policy.rdm
"$tool" report runs/bad runs/ppo_lag.0 --html bad.html --strip 0 > out 2> err || say "a policy that is none: $(cat err)"
grep -q 'class="note">runs/bad was not evaluated' bad.html || say "the page does not say that a run was not evaluated"
"$tool" report runs --episodes 0 --strip 0 --html quick.html > out 2> err || say "$(cat err)"
grep -q 'last tenth of training, exploration included' quick.html || say "a report without episodes does not say so"
"$tool" report taken > out 2> err && say "a folder without runs was taken"

# others judge
modules=$(dirname "$(dirname "$tool")")/viewers
reason=
if ! command -v node > /dev/null; then
  reason="there is no node"
elif [ ! -d "$modules/node_modules/gltf-validator" ] || [ ! -d "$modules/node_modules/three" ]; then
  mkdir -p "$modules"
  npm install --ignore-scripts --no-audit --no-fund --no-save --loglevel=error --prefix "$modules" gltf-validator@2.0.0-dev.3.10 \
    three@0.160.1 > npm.log 2>&1 < /dev/null || reason="npm cannot install gltf-validator and three"
fi
if [ -z "$reason" ]; then
  node "$here/gltf_validate.cjs" "$modules" "$pages"/*.glb || failed=1
fi
if [ -z "$reason" ] && [ $viewer -ne 0 ]; then
  reason="this build has no viewer library"
elif [ -z "$reason" ] && ! command -v "${CHROMIUM:-chromium}" > /dev/null; then
  reason="there is no chromium"
elif [ -z "$reason" ]; then
  node "$here/open_pages.cjs" "$modules" "$pages" || failed=1
fi
[ $failed -eq 0 ] || exit 1
[ -z "$reason" ] || { echo "skipped a part: $reason"; exit 77; }
