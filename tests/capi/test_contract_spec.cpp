// rdm_pool_config_spec, rdm_pool_config_memory and rdm_pool_create of every task agree on what is good, and none of them
// leaks.
#include "contract.hpp"

namespace {

rdm_spec empty_spec() {
  rdm_spec s{};
  s.struct_size = sizeof s;
  return s;
}

bool equal(const rdm_spec& a, const rdm_spec& b) {
  return a.control_dt == b.control_dt && a.obs_dim == b.obs_dim && a.action_dim == b.action_dim &&
         a.cost_dim == b.cost_dim && a.max_steps == b.max_steps && a.layout_hash == b.layout_hash &&
         a.num_fields == b.num_fields && a.num_shapes == b.num_shapes && a.num_joints == b.num_joints &&
         a.task == b.task;
}

struct Case {
  const char* what;
  int32_t num_envs, num_threads;
  std::vector<rdm_option> options;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list = {
      {"defaults", 1, 0, {}},
      {"threads", 3, 2, {}},
      {"no worlds", 0, 0, {}},
      {"too many worlds", 65537, 0, {}},
      {"negative threads", 1, -5, {}},
      {"too many threads", 1, 257, {}},
      {"unknown modality", 1, 0, {{"modality", "bogus", 0}}},
      {"unknown camera", 1, 0, {{"modality", "rgb", 0}, {"cameras", "nope", 0}}},
      {"no camera", 1, 0, {{"modality", "depth", 0}, {"cameras", "+", 0}}},
      {"unknown cloud camera", 1, 0, {{"modality", "points", 0}, {"cloud_cameras", "above+nope", 0}}},
      {"points", 1, 0, {{"modality", "points", 0}, {"points", nullptr, 16}}},
      {"unknown option", 1, 0, {{"no_such_option", nullptr, 1}}},
      {"ode", 1, 0, {{"engine", "ode", 0}}},
      {"more iterations than ode takes", 1, 0, {{"engine", "ode", 0}, {"iterations", nullptr, 100}}},
      {"few steps", 1, 0, {{"max_steps", nullptr, 7}}},
  };
  return list;
}

class ContractSpec : public testing::TestWithParam<std::string> {
 protected:
  rdm_pool_config config(const Case& c, const rdm_host* host) const {
    rdm_pool_config out = pool_config(c.num_envs);
    out.task = GetParam().c_str();
    out.num_threads = c.num_threads;
    out.options = c.options.data();
    out.num_options = static_cast<int32_t>(c.options.size());
    out.host = host;
    return out;
  }
};

TEST_P(ContractSpec, SaysWhatCreateSays) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.what);
    CountingHost host;
    const rdm_pool_config config = this->config(c, &host.hooks);
    rdm_spec spec = empty_spec(), made = empty_spec();
    size_t ours = 0, engines = 0;
    const rdm_result said = rdm_pool_config_spec(&config, &spec);
    const std::string text = said ? rdm_last_error() : "";
    EXPECT_EQ(host.live, 0u);
    const rdm_result measured = rdm_pool_config_memory(&config, &ours, &engines);
    EXPECT_EQ(host.live, 0u);
    rdm_pool* p = nullptr;
    const rdm_result created = rdm_pool_create(&p, &config);
    EXPECT_EQ(said, created) << text << " | " << rdm_last_error();
    EXPECT_EQ(measured, created);
    if (created) {
      EXPECT_EQ(text, rdm_last_error());
    } else {
      EXPECT_EQ(host.live, ours);
      ASSERT_EQ(rdm_pool_get_spec(p, &made), RDM_OK);
      EXPECT_TRUE(equal(spec, made));
    }
    rdm_pool_destroy(p);
    EXPECT_EQ(host.live, 0u);
  }
}

TEST_P(ContractSpec, EveryRefusedAllocationIsSurvived) {
  const Case c = {"", 2, 0, {}};
  const auto spec = [](const rdm_pool_config& config) {
    rdm_spec s = empty_spec();
    return rdm_pool_config_spec(&config, &s);
  };
  const auto memory = [](const rdm_pool_config& config) {
    size_t ours = 0, engines = 0;
    return rdm_pool_config_memory(&config, &ours, &engines);
  };
  rdm_result (*const calls[])(const rdm_pool_config&) = {spec, memory};
  for (const auto call : calls) {
    bool good = false;
    for (size_t k = 0; !good; ++k) {
      ASSERT_LT(k, 20000u);
      CountingHost host;
      host.refuse_at = k;
      const rdm_result r = call(config(c, &host.hooks));
      ASSERT_TRUE(r == RDM_OK || r == RDM_ERROR_MEMORY) << k << ' ' << rdm_last_error();
      ASSERT_EQ(host.live, 0u) << k;
      good = r == RDM_OK;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, ContractSpec, testing::ValuesIn(task_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
