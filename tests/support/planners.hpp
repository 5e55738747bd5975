// What a planner holds, for tests: its plan and its saved state.
#pragma once
#include <gtest/gtest.h>

#include <vector>

#include "owned.hpp"
#include "written.hpp"

inline std::vector<float> plan_of(const Planner& planner) {
  rdm_planner_spec s{};
  s.struct_size = sizeof s;
  EXPECT_EQ(rdm_planner_get_spec(planner.get(), &s), RDM_OK);
  std::vector<float> plan(static_cast<size_t>(s.horizon * s.action_dim));
  EXPECT_EQ(rdm_planner_get_plan(planner.get(), plan.data()), RDM_OK);
  return plan;
}

inline std::vector<unsigned char> state_of(const Planner& planner) {
  return written_bytes([&](void* out, size_t n, size_t* size) {
    return rdm_planner_write_state(planner.get(), out, n, size);
  });
}
