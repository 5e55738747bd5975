// A task of one ball whose functions do what a test says.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <functional>
#include <string>

namespace rdm::test {

class CalledTask {
 public:
  std::function<rdm_result(rdm_scene*)> build;
  std::function<rdm_result(rdm_world*, rdm_random*)> reset;
  std::function<rdm_result(rdm_world*, int64_t*)> control;  // and the control steps of the episode so far
  std::function<rdm_result(const rdm_world*, int64_t, rdm_verdict*)> judge;
  std::function<rdm_result(const rdm_world*)> observe;
  std::function<float(int64_t)> shows;  // the observation after so many control steps, in the place of them
  std::function<void()> release;
  rdm_task_def def;

  explicit CalledTask(const char* name) {
    rdm_task_def_init(&def, sizeof def);
    def.name = name;
    def.max_steps = 20;
    def.action_dim = 1;
    def.fields = &field_, def.num_fields = 1;
    def.costs = &cost_, def.num_costs = 1;
    def.state_bytes = sizeof(int64_t);
    def.user = this;
    def.build = [](void* u, rdm_scene* scene, void*) {
      rdm_shape_def sphere{};
      sphere.kind = RDM_SHAPE_SPHERE, sphere.size[0] = 0.05;
      rdm_body_def ball{};
      ball.struct_size = sizeof ball, ball.name = "ball", ball.shapes = &sphere, ball.num_shapes = 1;
      ball.mass = 0.1, ball.pose.p[2] = 1;
      if (const rdm_result r = rdm_scene_add_body(scene, &ball, nullptr)) return r;
      return self(u).build ? self(u).build(scene) : rdm_result{RDM_OK};
    };
    def.reset = [](void* u, const void*, rdm_world* world, void*, rdm_random* random) {
      return self(u).reset ? self(u).reset(world, random) : rdm_result{RDM_OK};
    };
    def.control = [](void* u, const void*, rdm_world* world, void* state, const float*) {
      auto* steps = static_cast<int64_t*>(state);
      ++*steps;
      return self(u).control ? self(u).control(world, steps) : rdm_result{RDM_OK};
    };
    def.judge = [](void* u, const void*, rdm_world* world, void* state, int32_t, rdm_verdict* out) {
      out->reward = 1;
      out->cost[0] = out->cost_raw[0] = 0.5;
      return self(u).judge ? self(u).judge(world, *static_cast<int64_t*>(state), out) : rdm_result{RDM_OK};
    };
    def.observe = [](void* u, const void*, const rdm_world* world, const void* state, float* obs) {
      const int64_t steps = *static_cast<const int64_t*>(state);
      obs[0] = self(u).shows ? self(u).shows(steps) : static_cast<float>(steps);
      return self(u).observe ? self(u).observe(world) : rdm_result{RDM_OK};
    };
    def.release = [](void* u) {
      if (self(u).release) self(u).release();
    };
    if (rdm_task_create(&number, &def) != RDM_OK) ADD_FAILURE() << rdm_last_error();
  }
  ~CalledTask() { rdm_task_destroy(number); }
  CalledTask(const CalledTask&) = delete;
  CalledTask& operator=(const CalledTask&) = delete;

  int32_t number = -1;

 private:
  static CalledTask& self(void* user) { return *static_cast<CalledTask*>(user); }
  rdm_field_def field_ = {"steps", "1", 1, 0, 0, 0};
  rdm_cost_def cost_ = {"cost", "half of one in each step", 5};
};

}  // namespace rdm::test
