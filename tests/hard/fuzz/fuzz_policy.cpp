// Policy files: what loads acts, within [-1, 1].
#include <redman/memory.h>

#include "fuzz.hpp"

namespace hard {
namespace {

// With what is usual in a row, as of an agent that has learned from more of them than it is worth here.
Bytes with_usual(Bytes file) {
  const unsigned char section[] = {'S', 'E', 'E', 'N', 0,   0,   0, 0, 12,   0,    0, 0, 0,    0,
                                   0,   0,   'S', 'E', 'E', 'N', 0, 0, 0xc0, 0x3f, 0, 0, 0xc0, 0x40};
  file.insert(file.end(), section, section + sizeof section);
  mend(file.data(), file.size());
  return file;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const char* algo : {"ppo", "trpo_lag"}) {
    AgentOf a;
    HARD_REQUIRE(a.make(algo) == RDM_OK, "%s", rdm_last_error());
    out.push_back(a.policy());
    HARD_REQUIRE(a.epoch() == RDM_OK, "%s", rdm_last_error());
    out.push_back(with_usual(a.policy()));
  }
  AgentOf seeing;
  seeing.configure("ppo");
  seeing.config.settings = "encoder=4,6\nencoder_points=8\nencoder_classes=2\nencoder_color=true";
  HARD_REQUIRE(seeing.create() == RDM_OK, "%s", rdm_last_error());
  out.push_back(seeing.policy());
  static const rdm_field fields[] = {{"seen", "1", 0, 2}, {"dynamics.drawn", "1", 2, 1}};
  for (const char* settings :
       {"memory=gru:3", "history=3", "latent=2\nlatent_hidden=3",
        "latent=2\nlatent_from=history\nhistory=3\nhistory_fields=seen",
        "history=3\nencoder=4,6\nencoder_points=8\nencoder_color=true",
        "latent=2\nlatent_hidden=3\nencoder=4,6\nencoder_points=8\nencoder_classes=2",
        "latent=2\nlatent_from=history\nhistory=3\nhistory_fields=seen\nencoder=4,6\nencoder_points=8"}) {
    AgentOf a;
    a.configure("ppo");
    a.config.settings = settings;
    a.config.fields = fields;
    a.config.num_fields = 2;
    HARD_REQUIRE(a.create() == RDM_OK, "%s", rdm_last_error());
    out.push_back(a.policy());
  }
  return out;
}

void whole(unsigned char* data, size_t size) {
  mend(data, size);
}
size_t fixed_bytes() {
  return kFileHead;
}

void one(const unsigned char* data, size_t size) {
  rdm_policy* p = nullptr;
  const rdm_result r = rdm_policy_read(&p, data, size);
  if (r != RDM_OK) return require_refusal(r);
  rdm_policy_info info{};
  info.struct_size = sizeof info;
  HARD_REQUIRE(rdm_policy_get_info(p, &info) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(good_text(info.task) && good_text(info.activation), "task %s", info.task);
  const int32_t rows = 3;
  const auto count = [](int32_t a, int32_t b) { return static_cast<size_t>(a) * static_cast<size_t>(b); };
  std::vector<float> obs(count(rows, info.obs_dim)), noise(count(rows, info.action_dim), 1.5f),
      action(noise.size());
  for (size_t i = 0; i < obs.size(); ++i) obs[i] = static_cast<float>(i % 7) - 3;
  const size_t bytes = rdm_policy_scratch(p, rows);
  HARD_REQUIRE(bytes > 0 && bytes < (1u << 28), "%zu bytes of scratch", bytes);
  void* scratch = std::malloc(bytes);
  std::vector<float> metres(count(rows * 3, info.num_points));
  for (size_t i = 0; i < metres.size(); ++i) metres[i] = 0.1f * static_cast<float>(i % 11) - 0.5f;
  std::vector<uint8_t> classes(count(rows, info.num_points));
  std::vector<float> state(count(rows, info.state_dim), 0.5f);
  float* const remembered = info.state_dim ? state.data() : nullptr;
  const std::vector<uint8_t> colors(metres.size(), 90);
  const rdm_points seen = {sizeof seen, info.num_points, metres.data(), classes.data(), colors.data()};
  for (const float* e : {static_cast<const float*>(nullptr), static_cast<const float*>(noise.data())}) {
    const rdm_result act =
        info.num_points > 0
            ? rdm_policy_act_points_state(p, obs.data(), &seen, remembered, rows, e, action.data(), scratch,
                                          bytes)
            : rdm_policy_act_state(p, obs.data(), remembered, rows, e, action.data(), scratch, bytes);
    if (act != RDM_OK) require_refusal(act);
    for (float a : action)
      HARD_REQUIRE(act != RDM_OK || (a >= -1 && a <= 1), "an action is %g", static_cast<double>(a));
  }
  std::free(scratch);
  float novelty[rows] = {};
  const rdm_result far = rdm_policy_novelty(p, obs.data(), rows, novelty);
  HARD_REQUIRE(far == (info.novelty ? RDM_OK : RDM_ERROR_UNSUPPORTED), "%s", rdm_last_error());
  for (const float n : novelty) HARD_REQUIRE(n >= 0 && std::isfinite(n), "%g", static_cast<double>(n));
  rdm_tensor t;
  for (int32_t i = 0; rdm_policy_tensor_at(p, i, &t) == RDM_OK; ++i) {
    std::vector<float> values(count(t.rows, t.cols));
    HARD_REQUIRE(rdm_policy_get_tensor(p, t.name, values.data(), values.size()) == RDM_OK, "%s",
                 rdm_last_error());
  }
  rdm_policy_destroy(p);
}

}  // namespace hard
