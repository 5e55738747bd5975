// The text of a handle is that of the last call that failed on it, whether the call may change it or only
// reads.
#include <functional>

#include "contract.hpp"

namespace {

struct Failing {
  const char* name;
  std::function<rdm_result()> call;
};

// Each call fails, and its text is then both the thread's and the handle's, though another one stood there.
void expect_texts(const std::vector<Failing>& calls, const std::function<const char*()>& handle_text) {
  std::string last = handle_text();
  EXPECT_EQ(last, "");
  for (size_t i = 0; i < 2 * calls.size(); ++i) {
    const Failing& f = calls[i % calls.size()];
    SCOPED_TRACE(f.name);
    EXPECT_NE(f.call(), RDM_OK);
    EXPECT_STRNE(rdm_last_error(), "");
    EXPECT_STREQ(handle_text(), rdm_last_error());
  }
}

TEST(ContractTexts, OfAPool) {
  rdm_pool* p = make_pool(pool_config());
  size_t n = 0;
  char text[RDM_TEXT_SIZE];
  unsigned char byte = 0;
  const char* key = nullptr;
  rdm_shape_info shape = RDM_INIT(rdm_shape_info);
  rdm_field_info field = RDM_INIT(rdm_field_info);
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  rdm_pose pose;
  float number = 0;
  expect_texts(
      {
          {"step", [&] { return rdm_pool_step(p); }},
          {"get_spec", [&] { return rdm_pool_get_spec(p, nullptr); }},
          {"field", [&] { return rdm_pool_field_at(p, -1, &field); }},
          {"option", [&] { return rdm_pool_setting_at(p, 100000, &key, text); }},
          {"settings", [&] { return rdm_pool_get_settings(p, text, 1, &n); }},
          {"initial_mean", [&] { return rdm_pool_get_initial_mean(p, nullptr); }},
          {"buffers", [&] { return rdm_pool_get_buffers(p, nullptr); }},
          {"bind", [&] { return rdm_pool_set_buffers(p, nullptr); }},
          {"step_masked", [&] { return rdm_pool_step_masked(p, nullptr); }},
          {"baseline", [&] { return rdm_pool_baseline(p, 9); }},
          {"state_size", [&] { return rdm_pool_write_state(p, 7, nullptr, 0, &n); }},
          {"get_state", [&] { return rdm_pool_write_state(p, 0, &byte, 1, &n); }},
          {"set_state", [&] { return rdm_pool_read_state(p, 0, &byte, 1); }},
          {"hash", [&] { return rdm_pool_get_hash(p, -2, nullptr); }},
          {"shape", [&] { return rdm_pool_shape_at(p, 9999, &shape); }},
          {"poses", [&] { return rdm_pool_get_poses(p, 2, &pose); }},
          {"contacts", [&] { return rdm_pool_get_contacts(p, 0, nullptr, 1, &n); }},
          {"render", [&] { return rdm_pool_render(p, 0, "nowhere", 8, 8, nullptr, nullptr, nullptr); }},
          {"get_stats", [&] { return rdm_pool_get_stats(p, nullptr); }},
          {"sensors", [&] { return rdm_pool_get_sensors(p, nullptr); }},
          {"sensor_camera", [&] { return rdm_pool_sensor_camera_at(p, 0, 5, &camera); }},
          {"hull", [&] { return rdm_pool_get_hull(p, -3, &number, 1, &n); }},
          {"agent_config_for_pool", [&] { return rdm_agent_config_for_pool(nullptr, p); }},
      },
      [&] { return rdm_pool_error(p); });
  rdm_pool_destroy(p);
}

TEST(ContractTexts, OfAnAgent) {
  rdm_agent* a = make_agent(agent_config());
  size_t n = 0;
  char text[RDM_TEXT_SIZE];
  unsigned char byte = 0;
  const char* key = nullptr;
  rdm_tensor tensor;
  const rdm_option option = {"no_such", nullptr, 0};
  float number = 0;
  expect_texts(
      {
          {"act", [&] { return rdm_agent_act(a, nullptr, RDM_ACT_MEAN, &number); }},
          {"record", [&] { return rdm_agent_record(a, nullptr); }},
          {"update", [&] { return rdm_agent_update(a, nullptr, nullptr); }},
          {"rollout", [&] { return rdm_agent_rollout(a, nullptr, nullptr); }},
          {"set", [&] { return rdm_agent_set_option(a, &option); }},
          {"option", [&] { return rdm_agent_setting_at(a, -1, &key, text); }},
          {"settings", [&] { return rdm_agent_get_settings(a, text, 1, &n); }},
          {"tensor", [&] { return rdm_agent_tensor_at(a, 100000, &tensor); }},
          {"tensor_read", [&] { return rdm_agent_get_tensor(a, "actor.9.weight", &number, 1); }},
          {"tensor_write", [&] { return rdm_agent_set_tensor(a, "actor.0.bias", &number, 1); }},
          {"policy", [&] { return rdm_agent_write_policy(a, &byte, 1, &n); }},
          {"policy_file", [&] { return rdm_agent_write_policy_file(a, "/nowhere/at/all"); }},
          {"save", [&] { return rdm_agent_write_state(a, &byte, 1, nullptr); }},
          {"load", [&] { return rdm_agent_read_state(a, &byte, 1); }},
          {"checkpoint_write",
           [&] { return rdm_checkpoint_write("/nowhere/at/all", a, nullptr, nullptr, 0); }},
          {"checkpoint_read",
           [&] { return rdm_checkpoint_read("/nowhere/at/all", a, nullptr, nullptr, 0, &n); }},
      },
      [&] { return rdm_agent_error(a); });
  rdm_agent_destroy(a);
}

}  // namespace
