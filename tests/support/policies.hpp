// Frozen policies for tests.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "owned.hpp"

inline Policy read_policy(const std::vector<unsigned char>& bytes) {
  rdm_policy* p = nullptr;
  EXPECT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  return Policy(p);
}

// The one that comes with a task.
inline Policy shipped(const std::string& task) {
  rdm_policy* p = nullptr;
  const std::string path = std::string(RDM_TEST_DATA) + "/../examples/policies/" + task + ".rdm";
  EXPECT_EQ(rdm_policy_read_file(&p, path.c_str()), RDM_OK) << rdm_last_error();
  return Policy(p);
}
