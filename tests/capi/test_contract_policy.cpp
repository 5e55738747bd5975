// Frozen policies of the C ABI: in a caller's memory, samples, names of fields, updates, generations.
#include <cmath>

#include "contract.hpp"
#include "heap_count.hpp"
#include "policies.hpp"

namespace {

using Bytes = std::vector<unsigned char>;

rdm_policy_info info_of(const rdm_policy* p) {
  rdm_policy_info info = RDM_INIT(rdm_policy_info);
  EXPECT_EQ(rdm_policy_get_info(p, &info), RDM_OK);
  return info;
}

// Agents of the small one's sizes, of all kinds of networks.
const rdm_field kFields[] = {{"place", "m", 0, 1}, {"speed", "m/s", 1, 2}};
const char* const kKinds[] = {"", "std_mode=state", "actor_obs=speed", "normalize_obs=false",
                              "encoder=4,6\nencoder_points=8\nencoder_classes=2\nencoder_color=true"};
rdm_agent* agent_of(const char* settings) {
  rdm_agent_config c = agent_config();
  c.settings = settings;
  c.fields = kFields;
  c.num_fields = 2;
  return make_agent(c);
}
Bytes file_of(const char* settings) {
  rdm_agent* a = agent_of(settings);
  if (!std::strstr(settings, "encoder")) {
    EXPECT_EQ(feed_epoch(a), RDM_OK) << rdm_last_error();
  }
  const Bytes bytes = policy_bytes(a);
  rdm_agent_destroy(a);
  return bytes;
}

constexpr float kObs[12] = {0.1f, -0.4f, 2, 0, 0.5f, 0.25f, 3, -3, 1, 0.7f, 0.7f, 0.7f};

// Actions [4][2] for kObs; of a policy that sees points, for one cloud.
std::vector<float> act(const rdm_policy* p, const float* noise = nullptr) {
  std::vector<float> action(8);
  Bytes scratch(rdm_policy_scratch(p, 4));
  if (info_of(p).num_points > 0) {
    const std::vector<float> metres(3 * 8 * 4, 0.1f);
    const Bytes classes(8 * 4), colors(3 * 8 * 4, 90);
    const rdm_points cloud = {sizeof cloud, 8, metres.data(), classes.data(), colors.data()};
    EXPECT_EQ(rdm_policy_act_points(p, kObs, &cloud, 4, noise, action.data(), scratch.data(), scratch.size()),
              RDM_OK)
        << rdm_last_error();
  } else {
    EXPECT_EQ(rdm_policy_act(p, kObs, 4, noise, action.data(), scratch.data(), scratch.size()), RDM_OK)
        << rdm_last_error();
  }
  return action;
}

TEST(PolicyInMemory, ActsAsTheOneOfTheHeapAtAnyAddress) {
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    Bytes file = file_of(kind);
    const Policy on_heap = read_policy(file);
    size_t needed = 0;
    ASSERT_EQ(rdm_policy_read_memory(file.data(), file.size(), &needed), RDM_OK) << rdm_last_error();
    Bytes memory(needed + 65);
    for (const size_t shift : {0, 1, 13, 63}) {
      std::fill(memory.begin(), memory.end(), 0xA5);
      const Bytes before = file;
      rdm_policy* p = nullptr;
      ASSERT_EQ(rdm_policy_read_in(&p, file.data(), file.size(), memory.data() + shift, needed), RDM_OK)
          << rdm_last_error();
      for (size_t i = 0; i < memory.size(); ++i)
        ASSERT_TRUE((i >= shift && i < shift + needed) || memory[i] == 0xA5) << i;
      std::fill(file.begin(), file.end(), 0);  // the file may go at once
      EXPECT_EQ(act(p), act(on_heap.get()));
      rdm_policy_destroy(p);
      EXPECT_EQ(rdm_policy_scratch(p, 1), 0u) << "its handle is of no use any more";
      file = before;
    }
  }
}

TEST(PolicyInMemory, TakesNothingFromHeapOrHooks) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted";
  const Bytes file = file_of("actor_obs=speed");
  CountingHost host;
  ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);
  size_t needed = 0;
  float action[2], mean[2];
  unsigned char scratch[1024];
  int32_t columns[3];
  size_t count;
  rdm_tensor t;
  rdm_policy_info info = RDM_INIT(rdm_policy_info);
  Bytes memory(1 << 16);
  const int64_t before = heap_count(), blocks = heap_blocks();
  rdm_result r = rdm_policy_read_memory(file.data(), file.size(), &needed);
  rdm_policy* p = nullptr;
  if (r == RDM_OK) r = rdm_policy_read_in(&p, file.data(), file.size(), memory.data(), needed);
  if (r == RDM_OK) r = rdm_policy_get_info(p, &info);
  if (r == RDM_OK) r = rdm_policy_act(p, kObs, 1, nullptr, action, scratch, sizeof scratch);
  if (r == RDM_OK) r = rdm_policy_sample(p, kObs, 1, kObs, action, mean, scratch, sizeof scratch);
  if (r == RDM_OK) r = rdm_policy_tensor_at(p, 0, &t);
  if (r == RDM_OK) r = rdm_policy_get_columns(p, columns, 3, &count);
  rdm_policy_destroy(p);
  const int64_t calls = heap_count() - before;
  rdm_shutdown();
  EXPECT_EQ(r, RDM_OK) << rdm_last_error();
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(heap_blocks(), blocks);
  EXPECT_EQ(host.calls, 0u);
}

TEST(PolicyInMemory, IsRefusedAsOnTheHeap) {
  const Bytes good = file_of("actor_obs=speed");
  size_t needed = 0;
  ASSERT_EQ(rdm_policy_read_memory(good.data(), good.size(), &needed), RDM_OK);
  Bytes memory(needed);
  rdm_policy *p = nullptr, *other = nullptr;
  EXPECT_EQ(rdm_policy_read_in(&p, good.data(), good.size(), memory.data(), needed - 1), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_last_error()).find(std::to_string(needed) + " are needed"), std::string::npos);
  EXPECT_EQ(rdm_policy_read_in(&p, good.data(), good.size(), nullptr, needed), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_read_memory(good.data(), good.size(), nullptr), RDM_ERROR_ARGUMENT);
  for (size_t cut = 0; cut < good.size(); cut += 7)
    EXPECT_EQ(rdm_policy_read_in(&p, good.data(), cut, memory.data(), needed), RDM_ERROR_FORMAT) << cut;
  for (size_t at = 0; at < good.size(); ++at) {
    Bytes bad = good;
    bad[at] ^= static_cast<unsigned char>(1u << (at % 8));
    const rdm_result wanted = rdm_policy_read(&other, bad.data(), bad.size());
    const std::string text = rdm_last_error();
    EXPECT_EQ(rdm_policy_read_in(&p, bad.data(), bad.size(), memory.data(), needed), wanted) << at;
    EXPECT_EQ(rdm_last_error(), text);
    EXPECT_LT(wanted, 0);
  }
  EXPECT_EQ(p, nullptr);
}

// Infinity is no action, though it could be clipped to one.
TEST(PolicyInMemory, RefusesWhatTheNetworkOverflowsOn) {
  rdm_agent* a = agent_of("normalize_obs=false\nactivation=relu");
  rdm_tensor first{};
  for (int32_t i = 0;
       rdm_agent_tensor_at(a, i, &first) == RDM_OK && std::string(first.name) != "actor.0.weight";)
    ++i;
  const std::vector<float> fours(static_cast<size_t>(first.rows) * static_cast<size_t>(first.cols), 4.0f);
  ASSERT_EQ(rdm_agent_set_tensor(a, "actor.0.weight", fours.data(), fours.size()), RDM_OK)
      << rdm_last_error();
  const Bytes bytes = policy_bytes(a);
  rdm_agent_destroy(a);
  rdm_policy* p = nullptr;
  ASSERT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  const std::vector<float> huge(12, 3e38f);
  std::vector<float> action(8), mean(8);
  Bytes scratch(rdm_policy_scratch(p, 4));
  EXPECT_EQ(rdm_policy_act(p, huge.data(), 4, nullptr, action.data(), scratch.data(), scratch.size()),
            RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_sample(p, huge.data(), 4, nullptr, action.data(), mean.data(), scratch.data(),
                              scratch.size()),
            RDM_ERROR_ARGUMENT);
  rdm_policy_destroy(p);
}

TEST(PolicySample, IsTheActionBeforeTheClipBesideItsMean) {
  for (const char* kind : kKinds) {
    if (std::strstr(kind, "encoder")) continue;
    SCOPED_TRACE(kind);
    const Policy p = read_policy(file_of(kind));
    const float noise[8] = {4, -0.3f, 0, -5, 0.1f, 1, -3, 0.5f};
    Bytes scratch(rdm_policy_scratch(p.get(), 4));
    float action[8], mean[8], alone[8], bare[8];
    const auto sample = [&](const float* e, float* a, float* m) {
      return rdm_policy_sample(p.get(), kObs, 4, e, a, m, scratch.data(), scratch.size());
    };
    ASSERT_EQ(sample(noise, action, mean), RDM_OK) << rdm_last_error();
    ASSERT_EQ(sample(noise, alone, nullptr), RDM_OK);
    EXPECT_EQ(std::memcmp(action, alone, sizeof action), 0);
    ASSERT_EQ(sample(noise, nullptr, alone), RDM_OK);
    EXPECT_EQ(std::memcmp(mean, alone, sizeof mean), 0);
    ASSERT_EQ(sample(nullptr, bare, alone), RDM_OK);
    EXPECT_EQ(std::memcmp(bare, mean, sizeof mean), 0) << "without noise the mean";
    float largest = 0;
    for (const float a : action) largest = std::max(largest, std::abs(a));
    EXPECT_GT(largest, 1) << "else the clip has nothing to do here";
    const auto clipped = act(p.get(), noise), clipped_mean = act(p.get());
    for (size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(clipped[i], std::clamp(action[i], -1.0f, 1.0f)) << i;
      EXPECT_EQ(clipped_mean[i], std::clamp(mean[i], -1.0f, 1.0f)) << i;
    }
    EXPECT_EQ(sample(noise, nullptr, nullptr), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(rdm_policy_sample(p.get(), kObs, 0, noise, action, mean, scratch.data(), scratch.size()),
              RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_policy_sample(p.get(), kObs, 4, noise, action, mean, scratch.data(), scratch.size() - 1),
              RDM_ERROR_RANGE);
    const float bad[12] = {NAN};
    EXPECT_EQ(rdm_policy_sample(p.get(), bad, 4, noise, action, mean, scratch.data(), scratch.size()),
              RDM_ERROR_ARGUMENT);
  }
  const Policy sees = read_policy(file_of(kKinds[4]));
  Bytes scratch(rdm_policy_scratch(sees.get(), 1));
  float action[2];
  EXPECT_EQ(rdm_policy_sample(sees.get(), kObs, 1, nullptr, action, nullptr, scratch.data(), scratch.size()),
            RDM_ERROR_STATE);
}

// What an agent samples is what its policy file samples with the same noise.
TEST(PolicySample, SaysWhatTheAgentActedOn) {
  rdm_agent* a = agent_of("");
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  float by_agent[8], action[8], mean[8], agent_mean[8], noise[8] = {};
  ASSERT_EQ(rdm_agent_act(a, kObs, RDM_ACT_SAMPLE, by_agent), RDM_OK);
  ASSERT_EQ(rdm_agent_act(a, kObs, RDM_ACT_MEAN, agent_mean), RDM_OK);
  const Policy p = read_policy(policy_bytes(a));  // after the act, which moved the normaliser
  float log_std[2];
  ASSERT_EQ(rdm_policy_get_tensor(p.get(), "actor.log_std", log_std, 2), RDM_OK);
  for (int i = 0; i < 8; ++i) noise[i] = (by_agent[i] - agent_mean[i]) / std::exp(log_std[i % 2]);
  Bytes scratch(rdm_policy_scratch(p.get(), 4));
  ASSERT_EQ(rdm_policy_sample(p.get(), kObs, 4, noise, action, mean, scratch.data(), scratch.size()), RDM_OK);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(mean[i], agent_mean[i], 1e-5f);
    EXPECT_NEAR(action[i], by_agent[i], 1e-5f);
  }
  rdm_agent_destroy(a);
}

// Of a policy file: its names of fields.
std::vector<rdm_field_info> fields_of(const rdm_policy* p) {
  std::vector<rdm_field_info> out;
  rdm_field_info f = RDM_INIT(rdm_field_info);
  for (int32_t i = 0; rdm_policy_field_at(p, i, &f) == RDM_OK; ++i) out.push_back(f);
  EXPECT_EQ(static_cast<int32_t>(out.size()), info_of(p).num_fields);
  return out;
}

TEST(PolicyFields, AreThoseOfTheConfig) {
  const Policy p = read_policy(file_of(""));
  const auto fields = fields_of(p.get());
  ASSERT_EQ(fields.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_STREQ(fields[i].name, kFields[i].name);
    EXPECT_STREQ(fields[i].unit, kFields[i].unit);
    EXPECT_EQ(fields[i].offset, kFields[i].offset);
    EXPECT_EQ(fields[i].count, kFields[i].count);
    EXPECT_TRUE(std::isnan(fields[i].low) && std::isnan(fields[i].high));
  }
  rdm_field_info f = RDM_INIT(rdm_field_info);
  EXPECT_EQ(rdm_policy_field_at(p.get(), 2, &f), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_field_at(p.get(), -1, &f), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_field_at(p.get(), 0, nullptr), RDM_ERROR_ARGUMENT);

  rdm_agent* a = make_agent(agent_config());
  EXPECT_EQ(info_of(read_policy(policy_bytes(a)).get()).num_fields, 0) << "a config without fields";
  rdm_agent_destroy(a);
}

// What a host calls its fields may be anything; what comes from a file can be printed.
TEST(PolicyFields, AreTextsThatCanBePrinted) {
  rdm_agent_config c = agent_config();
  const rdm_field odd[] = {{"a\x1b[31m\nb\xff", nullptr, 0, 3}};
  c.fields = odd;
  c.num_fields = 1;
  rdm_agent* a = make_agent(c);
  const Policy p = read_policy(policy_bytes(a));
  rdm_agent_destroy(a);
  const auto fields = fields_of(p.get());
  ASSERT_EQ(fields.size(), 1u);
  EXPECT_STREQ(fields[0].name, "a [31m b\\xff");
  EXPECT_STREQ(fields[0].unit, "");
}

Policy policy_for(const rdm_pool* pool) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = "hidden=8";
  rdm_agent* a = make_agent(c);
  Policy p = read_policy(policy_bytes(a));
  rdm_agent_destroy(a);
  return p;
}
rdm_pool* pool_of(const char* task, const char* settings = nullptr) {
  rdm_pool_config c = pool_config(1);
  c.task = task;
  c.settings = settings;
  return make_pool(c);
}

TEST(PolicyFields, OfAPoolAreThePools) {
  rdm_pool* pool = pool_of("hand_over_safe_finger");
  const Policy p = policy_for(pool);
  const auto fields = fields_of(p.get());
  const rdm_spec spec = spec_of(pool);
  ASSERT_EQ(static_cast<int32_t>(fields.size()), spec.num_fields);
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    ASSERT_EQ(rdm_pool_field_at(pool, i, &f), RDM_OK);
    EXPECT_STREQ(fields[static_cast<size_t>(i)].name, f.name);
    EXPECT_STREQ(fields[static_cast<size_t>(i)].unit, f.unit);
    EXPECT_EQ(fields[static_cast<size_t>(i)].offset, f.offset);
    EXPECT_EQ(fields[static_cast<size_t>(i)].count, f.count);
  }
  EXPECT_EQ(rdm_policy_check(p.get(), &spec), RDM_OK) << rdm_last_error();
  rdm_pool_destroy(pool);
}

std::string refusal(const rdm_policy* p, const rdm_spec& spec) {
  EXPECT_EQ(rdm_policy_check(p, &spec), RDM_ERROR_VERSION_MISMATCH);
  return rdm_last_error();
}

// The fields of the pool that the spec is of; when it has ended they are not known.
TEST(PolicyFields, AreNamedWhereALayoutDiffers) {
  rdm_pool* own = pool_of("ball_circle");
  const Policy p = policy_for(own);
  for (const char* task : {"car_circle", "point_goal1"}) {
    SCOPED_TRACE(task);
    rdm_pool* other = pool_of(task);
    const rdm_spec spec = spec_of(other);
    rdm_field_info mine = RDM_INIT(rdm_field_info), theirs = mine;
    int32_t i = -1;
    do {
      ++i;
      ASSERT_EQ(rdm_pool_field_at(own, i, &mine), RDM_OK);
      ASSERT_EQ(rdm_pool_field_at(other, i, &theirs), RDM_OK);
    } while (std::strcmp(mine.name, theirs.name) == 0 && mine.count == theirs.count);
    const std::string wanted = "; field " + std::to_string(i) + " is " + mine.name + " [" +
                               std::to_string(mine.count) + "] to the policy, " + theirs.name + " [" +
                               std::to_string(theirs.count) +
                               "] to the task; the policy learned in task ball_circle";
    EXPECT_NE(refusal(p.get(), spec).find(wanted), std::string::npos) << rdm_last_error() << "\n" << wanted;
    rdm_pool_destroy(other);
    EXPECT_EQ(refusal(p.get(), spec).find("; field"), std::string::npos) << rdm_last_error();
  }
  rdm_pool_destroy(own);
}

// The file as 0.1.0 would have written it: without the sections that came later.
Bytes without_later(const Bytes& file) {
  Bytes out(file.begin(), file.begin() + 24);
  for (size_t at = 24; at < file.size();) {
    uint64_t n;
    std::memcpy(&n, &file[at + 8], 8);
    const auto end = at + 16 + static_cast<size_t>(n);
    if (n < 4 || std::memcmp(&file[at], &file[at + 16], 4) != 0)
      out.insert(out.end(), file.begin() + static_cast<ptrdiff_t>(at),
                 file.begin() + static_cast<ptrdiff_t>(end));
    at = end;
  }
  const uint64_t length = out.size() - 24;
  std::memcpy(&out[16], &length, 8);
  return out;
}

// All numbers of a policy, and what it does.
std::vector<float> everything(const rdm_policy* p) {
  std::vector<float> out = act(p, kObs);
  rdm_tensor t;
  for (int32_t i = 0; rdm_policy_tensor_at(p, i, &t) == RDM_OK; ++i) {
    std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
    EXPECT_EQ(rdm_policy_get_tensor(p, t.name, values.data(), values.size()), RDM_OK);
    out.insert(out.end(), values.begin(), values.end());
  }
  const rdm_policy_info i = info_of(p);
  out.insert(out.end(), {i.control_dt, i.noise_correlation, static_cast<float>(i.action_repeat)});
  return out;
}

// Another epoch of whichever kind of agent.
void learn(rdm_agent* a, bool sees) {
  if (!sees) {
    EXPECT_EQ(feed_epoch(a), RDM_OK) << rdm_last_error();
    return;
  }
  rdm_tensor t;
  for (int32_t i = 0; rdm_agent_tensor_at(a, i, &t) == RDM_OK; ++i) {
    std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
    EXPECT_EQ(rdm_agent_get_tensor(a, t.name, values.data(), values.size()), RDM_OK);
    for (float& v : values) v *= 0.75f;
    EXPECT_EQ(rdm_agent_set_tensor(a, t.name, values.data(), values.size()), RDM_OK);
  }
}

TEST(PolicyUpdate, MakesThePolicyThatTheAgentWouldWrite) {
  for (const char* kind :
       {"", "std_mode=state", "actor_obs=speed", "normalize_obs=false", "average=0.9", kKinds[4]}) {
    SCOPED_TRACE(kind);
    const bool sees = std::strstr(kind, "encoder") != nullptr;
    rdm_agent* a = agent_of(kind);
    learn(a, sees);
    const Bytes before = policy_bytes(a), old = without_later(before);
    EXPECT_LT(old.size(), before.size());
    learn(a, sees);
    const Policy now = read_policy(policy_bytes(a));
    size_t needed = 0;
    ASSERT_EQ(rdm_policy_read_memory(before.data(), before.size(), &needed), RDM_OK);
    Bytes memory(needed);
    rdm_policy* inside = nullptr;
    ASSERT_EQ(rdm_policy_read_in(&inside, before.data(), before.size(), memory.data(), needed), RDM_OK);
    const Policy policies[] = {read_policy(before), read_policy(old), Policy(inside)};
    EXPECT_EQ(info_of(policies[1].get()).generation, 0u);
    for (const Policy& p : policies) {
      EXPECT_NE(everything(p.get()), everything(now.get()));
      EXPECT_NE(info_of(p.get()).generation, info_of(now.get()).generation);
      const int64_t calls = heap_count();
      const rdm_result r = rdm_policy_update_from(p.get(), a);
      EXPECT_EQ(heap_count(), calls);
      ASSERT_EQ(r, RDM_OK) << rdm_last_error();
      EXPECT_EQ(everything(p.get()), everything(now.get()));
      EXPECT_EQ(info_of(p.get()).generation, info_of(now.get()).generation);
    }
    EXPECT_EQ(info_of(policies[0].get()).num_fields, 2);
    EXPECT_EQ(info_of(policies[1].get()).num_fields, 0) << "names of fields stay as they were";
    rdm_agent_destroy(a);
  }
}

TEST(PolicyUpdate, SaysWhatDiffersAndChangesNothing) {
  const std::pair<const char*, const char*> kinds[] = {{"hidden=8", "hidden"},
                                                       {"hidden=8,4", "hidden"},
                                                       {"activation=relu", "activation"},
                                                       {"std_mode=state", "std_mode"},
                                                       {"actor_obs=speed", "actor_obs"},
                                                       {"normalize_obs=false", "normalize_obs, or obs_clip,"},
                                                       {"obs_clip=4", "normalize_obs, or obs_clip,"},
                                                       {"action_repeat=2", "action_repeat"},
                                                       {kKinds[4], "encoder_points"}};
  rdm_agent* a = agent_of("activation=tanh");
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  for (const auto& [settings, what] : kinds) {
    SCOPED_TRACE(settings);
    rdm_agent* other = agent_of(settings);
    const Policy p = read_policy(policy_bytes(other));
    rdm_agent_destroy(other);
    const auto before = everything(p.get());
    EXPECT_EQ(rdm_policy_update_from(p.get(), a), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(rdm_agent_error(a), "policy: " + std::string(what) + " differs from the agent's");
    EXPECT_EQ(everything(p.get()), before);
  }
  rdm_agent_config c = agent_config();
  c.layout_hash = 1;
  rdm_agent* hashed = make_agent(c);
  c.layout_hash = 2;
  rdm_agent* other = make_agent(c);
  const Policy p = read_policy(policy_bytes(other));
  EXPECT_EQ(rdm_policy_update_from(p.get(), hashed), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(hashed), "policy: layout_hash differs from the agent's");
  rdm_agent_destroy(other);
  rdm_agent_destroy(hashed);
  EXPECT_EQ(rdm_policy_update_from(nullptr, a), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_update_from(p.get(), nullptr), RDM_ERROR_ARGUMENT);
  rdm_agent_destroy(a);
}

TEST(PolicyGeneration, IsTheEpochAndTheNetwork) {
  rdm_agent* a = agent_of("");
  const auto generation = [&] { return info_of(read_policy(policy_bytes(a)).get()).generation; };
  const uint64_t first = generation();
  EXPECT_EQ(static_cast<uint32_t>(first), 0u);
  EXPECT_NE(first, 0u);
  float action[8];
  ASSERT_EQ(rdm_agent_act(a, kObs, RDM_ACT_SAMPLE, action), RDM_OK);
  EXPECT_EQ(generation(), first) << "within a horizon it is the same network";
  ASSERT_EQ(rdm_agent_discard(a), RDM_OK);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  const uint64_t second = generation();
  EXPECT_EQ(static_cast<uint32_t>(second), 1u);
  EXPECT_NE(second >> 32, first >> 32);
  const Bytes state = saved(a);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  EXPECT_EQ(static_cast<uint32_t>(generation()), 2u);
  ASSERT_EQ(rdm_agent_read_state(a, state.data(), state.size()), RDM_OK);
  EXPECT_EQ(generation(), second);
  // whoever sets a weight has another network in the same epoch
  float bias[8];
  ASSERT_EQ(rdm_agent_get_tensor(a, "actor.0.bias", bias, 8), RDM_OK);
  bias[0] += 1;
  ASSERT_EQ(rdm_agent_set_tensor(a, "actor.0.bias", bias, 8), RDM_OK);
  EXPECT_EQ(static_cast<uint32_t>(generation()), 1u);
  EXPECT_NE(generation(), second);
  rdm_agent_destroy(a);
}

}  // namespace
