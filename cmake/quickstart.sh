#!/usr/bin/env bash
# From a fresh clone to a trained policy: installs what is missing, builds, trains for about a minute on two cores,
# evaluates beside a random policy, draws a strip of pictures and writes a page that plays an episode. A second call rebuilds what changed.
set -eu
cd "$(dirname "$0")/.."
. cmake/packages.sh
task=hand_over_safe_finger
run=runs/quickstart
train=(--task "$task" --algo ppo_lag --envs 64 --threads "$(nproc)" --steps 3000000 --seed 0 --out "$run" --overwrite)
redman=build/release/bin/redman

started=$SECONDS
part() {
  echo "[$((SECONDS - started)) s] $*" >&2
}
# number KEY JSON: the number behind the key, the first one of an array.
number() {
  sed -n "s/.*\"$1\": *\[*\(-*[0-9.][0-9.eE+-]*\).*/\1/p" <<< "$2"
}
text() {
  sed -n "s/.*\"$1\": *\"\([^\"]*\)\".*/\1/p" <<< "$2"
}

part "packages"
# shellcheck disable=SC2086
need $build_packages
# shellcheck disable=SC2086
want "the viewer of pages that \`redman render --html\` writes" $viewer_packages
part "building"
configure release
build release
part "training: redman train ${train[*]}"
trained=$("$redman" train "${train[@]}" --json)
policy=$(text policy "$trained")
part "evaluating"
agent=$("$redman" eval --task "$task" --policy "$policy" --episodes 100 --seed 1000 --json)
random=$("$redman" rollout --task "$task" --policy random --episodes 100 --seed 1000 --json)
part "drawing"
picture=$(text file "$("$redman" render --task "$task" --policy "$policy" --strip 4 --from 8 --to 32 --camera close --size 480x360 --out "$run/strip.png" --json)")
page="none: $("$redman" render --task "$task" --policy "$policy" --camera close --html "$run/episode.html" 2>&1 > /dev/null)" &&
  page=$run/episode.html
part "done"

row() { # row NAME JSON
  printf '%-10s %8.2f %8.2f %8.2f %7.0f%% %7.0f%%\n' "$1" "$(number return_mean "$2")" "$(number cost_mean "$2")" \
    "$(number cost_limit "$trained")" "$(awk "BEGIN { print 100 * $(number success_rate "$2") }")" \
    "$(awk "BEGIN { print 100 * $(number fall_rate "$2") }")"
}
echo
printf '%-10s %8s %8s %8s %8s %8s\n' policy return cost limit success falls
row trained "$agent"
row random "$random"
echo
echo "run folder  $(text run "$trained")"
echo "policy      $policy"
echo "picture     $picture"
echo "playback    $page"
