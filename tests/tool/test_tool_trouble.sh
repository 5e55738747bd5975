#!/bin/sh
# test_tool_trouble.sh TOOL: episodes that diverge are said by every command that has a result, are no measurement, and
# are never feasible.
. "$(dirname "$0")/tool.sh"
cc=${CC:-cc}
command -v "$cc" > /dev/null || { echo "no C compiler here"; exit 77; }
root=$here/../..
say() { echo "$*"; failed=1; }

# A ball that pays 1 in each of 10 steps; in every second episode, by the draw of its reset, step 5 pays nan.
cat > faulty.c << 'C'
#define RDM_EXPERIMENTAL
#include <math.h>
#include <redman/redman.h>
static rdm_result build(void* user, rdm_scene* scene, void* instance) {
  const rdm_shape_def sphere = {.kind = RDM_SHAPE_SPHERE, .size = {.05}};
  const rdm_body_def ball = {sizeof ball, 1, "ball", &sphere, .pose.p = {0, 0, 1}, .mass = 0.1};
  (void)user, (void)instance;
  return rdm_scene_add_body(scene, &ball, NULL);
}
static rdm_result reset(void* user, const void* instance, rdm_world* world, void* state, rdm_random* random) {
  (void)user, (void)instance, (void)world;
  *(double*)state = rdm_random_uniform(random, 0, 1);
  return RDM_OK;
}
static rdm_result control(void* user, const void* instance, rdm_world* world, void* state, const float* action) {
  (void)user, (void)instance, (void)world, (void)state, (void)action;
  return RDM_OK;
}
static rdm_result observe(void* user, const void* instance, const rdm_world* world, const void* state, float* obs) {
  (void)user, (void)instance, (void)world;
  obs[0] = (float)*(const double*)state;
  return RDM_OK;
}
static rdm_result judge(void* user, const void* instance, rdm_world* world, void* state, int32_t step, rdm_verdict* out) {
  (void)user, (void)instance, (void)world;
  out->reward = *(double*)state < 0.5 && step == 5 ? NAN : 1;
  return RDM_OK;
}
rdm_result redman_plugin(void) {
  static const rdm_field_def field = {"draw", "1", 1, 0, 0, 0};
  static const rdm_cost_def cost = {"cost", "none", 5};
  static int32_t number;
  rdm_task_def d;
  rdm_task_def_init(&d, sizeof d);
  d.name = "faulty", d.summary = "half of its episodes diverge", d.max_steps = 10, d.action_dim = 1;
  d.fields = &field, d.num_fields = 1, d.costs = &cost, d.num_costs = 1, d.state_bytes = sizeof(double);
  d.build = build, d.reset = reset, d.control = control, d.observe = observe, d.judge = judge;
  return rdm_task_create(&number, &d);
}
C
"$cc" -std=c99 -shared -fPIC "-I$root/include" faulty.c -lm -o faulty.so || exit 1
if ! "$tool" --plugin ./faulty.so tasks > out 2> err; then
  grep -q 'undefined symbol' err && { echo "the tool carries the library in itself: $(cat err)"; exit 77; }
  say "$(cat err)"
fi

run() { "$tool" "$@" --plugin ./faulty.so > out 2> err || say "redman $*: $(cat err)"; }
has() { grep -q -- "$1" "${2:-out}" || say "no '$1' in: $(cat "${2:-out}")"; }

run eval --task faulty --policy zero --episodes 40 --envs 4 --json
has '"return_mean":10.0,' # of the episodes that are measurements
has '"diverged":[1-9]'
has '"feasible":false'
has '[0-9] episodes diverged' err
run rollout --task faulty --policy zero --episodes 40 --envs 4 --out steps.csv --json
has '"diverged":[1-9]'
has '[0-9] episodes diverged' err
has ',success,status' steps.csv
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "status") c = i } NR > 1 && $c == 2 { ++n } END { exit !(n > 5) }' \
  steps.csv || say "no flagged row in: $(head -20 steps.csv)"
run train --task faulty --steps 640 --envs 4 --set horizon=32 --set hidden=8 --set minibatches=1 --out run --json
has '"training_diverged":[1-9]'
has '"feasible":false'
has 'training: [0-9]* episodes diverged' err
has 'the last policy is kept' err
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "Trouble/Diverged") c = i } NR > 1 { n += $c } END { exit !(n > 5) }' \
  run/progress.csv || say "no diverged worlds in: $(cat run/progress.csv)"
run report run --episodes 20 --strip 0 --html report.html --json
has '"feasible":false'
has '"diverged":[1-9]'
has 'episodes diverged' report.html
run plan --task faulty --episodes 10 --plan samples=4 --plan horizon=3 --json
has '"diverged":[1-9]'
has '"feasible":false'
run render --task faulty --policy zero --size 64x48 --out out.png --seed 3 --json
has '"diverged":'
exit $failed
