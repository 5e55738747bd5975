// Shields for tests, and what they say.
#pragma once
#include "contract.hpp"
#include "owned.hpp"
#include "written.hpp"

inline rdm_shield_config shield_config(const Pool& pool, const char* settings = "") {
  rdm_shield_config c;
  EXPECT_EQ(rdm_shield_config_init(&c, sizeof c), RDM_OK);
  c.pool = pool.get();
  c.settings = settings;
  c.seed = 5;
  return c;
}
inline Shield shield_of(const rdm_shield_config& c) {
  rdm_shield* s = nullptr;
  EXPECT_EQ(rdm_shield_create(&s, &c), RDM_OK) << rdm_last_error();
  return Shield(s);
}

inline rdm_shield_stats stats_of(const Shield& s) {
  auto out = RDM_INIT(rdm_shield_stats);
  EXPECT_EQ(rdm_shield_get_stats(s.get(), &out), RDM_OK);
  return out;
}
inline rdm_shield_row row_of(const Shield& s, const Pool& pool, int32_t env) {
  auto out = RDM_INIT(rdm_shield_row);
  EXPECT_EQ(rdm_shield_get_row(s.get(), pool.get(), env, &out), RDM_OK);
  return out;
}
inline std::vector<unsigned char> state_of(const Shield& s) {
  return written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_shield_write_state(s.get(), out, n, size); });
}
