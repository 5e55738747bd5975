// Teams: groups as texts, one group as the algorithm for one agent, and several groups against what they promise.
#include <cmath>
#include <cstring>
#include <functional>

#include "agents.hpp"
#include "algos/core/groups.hpp"
#include "algos/rollout/sequences.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "heap_count.hpp"
#include "learner_bench.hpp"
#include "nn/gaussian.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr int32_t kObs = 10, kActions = 5;
const ObsField kFields[] = {{"right.angle", 0, 4, ""}, {"left.angle", 4, 3, ""}, {"ball", 7, 3, ""}};
constexpr const char* kPair = "right:right.*,ball:0-1;left:!right.*:2-4";

AgentSetup team(const char* algo, const char* groups, int32_t envs = 24) {
  static const double limits[] = {1, -1};
  AgentSetup s(algo, kObs, kActions, envs);
  s.config.fields = kFields;
  s.config.num_fields = 3;
  s.config.cost_dim = 2;
  s.config.cost_limits = limits;
  s.config.max_steps = 30;
  s.config.seed = 5;
  s.with("hidden", "12,8").with("horizon", "10").with("passes", "3").with("minibatches", "2");
  s.with("learning_rate", "2e-3");
  if (groups) s.with("groups", groups);
  return s;
}

std::string refused(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.text;
  }
  return "";
}

std::string refusal(const char* groups) {
  return refused([&] { team("mappo", groups).make(); });
}

// The policy that acts.
struct Played {
  explicit Played(Agent& a) {
    bytes = policy_file(a);
    policy.reset(Policy::read(bytes.data(), bytes.size(), {}));
  }
  std::vector<float> act(const std::vector<float>& obs) const { return act_of(*policy, obs); }
  // With a memory from `state`, which becomes the next one; empty: from zeros.
  static std::vector<float> act_of(const Policy& p, const std::vector<float>& obs,
                                   std::vector<float> state = {}) {
    return act_on(p, obs, state);
  }
  static std::vector<float> act_on(const Policy& p, const std::vector<float>& obs,
                                   std::vector<float>& state) {
    const auto rows = static_cast<int32_t>(obs.size() / size_of(p.view().obs_dim()));
    std::vector<float> action(size_of(rows) * size_of(p.view().action_dim()));
    std::vector<float> scratch(p.scratch_bytes(rows) / sizeof(float) + 16);
    state.resize(size_of(rows) * size_of(p.view().state_dim()));
    p.act(obs.data(), rows, nullptr, action.data(), align_scratch(scratch.data()), {}, state.data());
    return action;
  }
  struct End {
    void operator()(Policy* p) const { Policy::destroy(p); }
  };
  std::vector<unsigned char> bytes;
  std::unique_ptr<Policy, End> policy;
};

std::vector<float> rows_of_noise(size_t numbers) {
  Stream stream(3, 0, Purpose::kTest);
  std::vector<float> out(numbers);
  for (float& x : out) x = static_cast<float>(stream.signed_unit());
  return out;
}

}  // namespace

TEST(Groups, AListSaysWhoSeesAndDoesWhat) {
  AgentSetup s = team("mappo", kPair);
  const Vector<GroupSpec> g = parse_groups(s.config, kPair);
  ASSERT_EQ(g.size(), 2u);
  EXPECT_STREQ(g[0].name, "right");
  EXPECT_STREQ(g[1].name, "left");
  EXPECT_EQ(std::vector<int32_t>(g[0].columns.begin(), g[0].columns.end()),
            (std::vector<int32_t>{0, 1, 2, 3, 7, 8, 9}));
  EXPECT_EQ(std::vector<int32_t>(g[1].columns.begin(), g[1].columns.end()),
            (std::vector<int32_t>{4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(g[0].first, 0);
  EXPECT_EQ(g[0].count, 2);
  EXPECT_EQ(g[1].first, 2);
  EXPECT_EQ(g[1].count, 3);
}

TEST(Groups, WhatIsNoListIsRefusedWithWhatIsWrong) {
  EXPECT_EQ(refusal("a:*:0-1;b:*:3-4"),
            "groups: b begins with entry 3 of the action, where entry 2 comes next");
  EXPECT_EQ(refusal("a:*:0-1;b:*:2-3"),
            "groups: entry 4 of the action, and those behind it, belong to no group");
  EXPECT_EQ(refusal("a:*:0-1;b:*:2-9"),
            "groups: entries 2 to 9 of group b are not within the 5 of the action");
  EXPECT_EQ(refusal("a:*:0-1;a:*:2-4"), "groups: a occurs twice");
  EXPECT_EQ(refusal("a:*:0-1;b:*"),
            "groups: '' of group b is not a first and a last entry of the action, such as 0-19");
  EXPECT_EQ(refusal("a:*:0-1;b:*:2-4:x"), "groups: 'b:*:2-4:x' is not NAME:FIELDS:FIRST-LAST");
  EXPECT_EQ(refusal("a:bal:0-1;b:*:2-4").substr(0, 47), "groups: 'bal' names no field of the observation");
  EXPECT_NE(refusal("pair").find("groups: the task has no set 'pair'"), std::string::npos);
}

TEST(Groups, AGroupSeesOfItsFieldsWhatActorObsHas) {
  AgentSetup s = team("mappo", kPair);
  s.with("actor_obs", "*.angle");
  const AgentPtr a = s.make();
  const Played p(*a);
  EXPECT_EQ(p.policy->view().group[0].shape.in, 4);
  EXPECT_EQ(p.policy->view().group[1].shape.in, 3);
  s.with("actor_obs", "left.angle");
  EXPECT_EQ(refused([&] { s.make(); }), "groups: actor_obs leaves right no entry of the observation");
}

TEST(Groups, ATaskShipsSetsAndTheFirstIsTheDefault) {
  const OptionInput sets[] = {{"groups.pair", kPair, 0}, {"groups.three", "a:*:0-0;b:*:1-2;c:*:3-4", 0}};
  const auto count = [&](const char* groups) {
    AgentSetup s = team("mappo", groups);
    s.config.defaults = sets;
    s.config.num_defaults = 2;
    const AgentPtr a = s.make();
    return Played(*a).policy->view().num_groups;
  };
  EXPECT_EQ(count(nullptr), 2);
  EXPECT_EQ(count("three"), 3);
  EXPECT_EQ(count("all"), 0);
  AgentSetup s = team("mappo", "tree");
  s.config.defaults = sets;
  s.config.num_defaults = 2;
  EXPECT_NE(refused([&] { s.make(); }).find("three"), std::string::npos);
}

// One group is the algorithm for one agent: the same networks, policies and epochs, to the byte.
TEST(Team, OneGroupIsTheAlgorithmForOneAgent) {
  const std::pair<const char*, const char*> pairs[] = {{"mappo", "ppo"}, {"mappo_lag", "ppo_lag"},
                                                       {"happo", "ppo"}, {"macpo", "cpo"},
                                                       {"ippo", "ppo"},  {"ippo_lag", "ppo_lag"}};
  for (const auto& [of_team, alone] : pairs) {
    SCOPED_TRACE(of_team);
    const OptionInput defaults[] = {
        {"ppo:clip", "0.3", 0}, {"ppo_lag:clip", "0.4", 0}, {"cpo:trust_kl", "0.05", 0}};
    for (const char* memory : {"", "gru:6"}) {
      SCOPED_TRACE(memory);
      AgentSetup many = team(of_team, "all"), one = team(alone, nullptr);
      for (AgentSetup* s : {&many, &one}) {
        s->config.defaults = defaults, s->config.num_defaults = 3;
        s->with("memory", memory).with("memory_chunk", "4");
      }
      const AgentPtr a = many.make(), b = one.make();
      NoiseWorld world(many.config), other(one.config);
      for (int i = 0; i < 4; ++i) {
        Epoch e, f;
        world.epoch(*a, &e);
        other.epoch(*b, &f);
        EXPECT_EQ(0, std::memcmp(&e, &f, sizeof e)) << i;
      }
      EXPECT_EQ(parameters(*a), parameters(*b));
      EXPECT_EQ(policy_file(*a), policy_file(*b));
    }
  }
}

class TeamAlgo : public testing::TestWithParam<std::tuple<const char*, const char*, const char*>> {
 protected:
  bool remembers() const { return *std::get<2>(GetParam()) != 0; }
  AgentSetup setup(int32_t threads = 0) const {
    AgentSetup s = team(std::get<0>(GetParam()), kPair, 40);
    s.with("std_mode", std::get<1>(GetParam()));
    s.with("memory", std::get<2>(GetParam())).with("memory_chunk", "4");
    s.config.num_threads = threads;
    return s;
  }
};

TEST_P(TeamAlgo, SameBytesForAnyThreadsAndResumed) {
  AgentSetup s = setup();
  const AgentPtr whole = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*whole);
  const auto bytes = saved(*whole);
  for (const int32_t threads : {1, 2, 4}) {
    AgentSetup t = setup(threads);
    const AgentPtr a = t.make();
    NoiseWorld same(t.config);
    for (int i = 0; i < 3; ++i) same.epoch(*a);
    EXPECT_EQ(saved(*a), bytes) << threads;
  }
  AgentSetup r = setup(2);
  r.config.seed = 77;
  const AgentPtr resumed = r.make();
  resumed->load(bytes.data(), bytes.size());
  NoiseWorld copy = world;
  for (int i = 0; i < 3; ++i) world.epoch(*whole), copy.epoch(*resumed);
  EXPECT_EQ(saved(*whole), saved(*resumed));
}

TEST_P(TeamAlgo, SlicesGiveTheBytesOfAWholeUpdate) {
  AgentSetup s = setup(), t = setup(2);
  const AgentPtr whole = s.make(), parts = t.make();
  NoiseWorld one(s.config), other(t.config);
  for (int i = 0; i < 3; ++i) {
    one.epoch(*whole);
    while (other.obs() && parts->missing() > 0) other.decide(*parts);
    parts->forget(true, nullptr);
    whole->forget(true, nullptr);
    const Played was(*parts);
    parts->begin_update(other.obs());
    const std::vector<float> obs(other.obs(), other.obs() + 40 * kObs);
    std::vector<float> action(40 * kActions), before(40 * kActions), state;
    parts->act(obs.data(), false, before.data());
    Played::act_on(*was.policy, obs, state);
    for (int k = 1; !parts->update_on(k % 5 + 1, nullptr); ++k) {  // what acts is the policy of before
      parts->act(obs.data(), false, action.data());
      if (!remembers()) {
        ASSERT_EQ(action, before);
      }
      const auto wanted = Played::act_on(*was.policy, obs, state);
      for (size_t j = 0; j < wanted.size(); ++j)
        ASSERT_NEAR(std::clamp(action[j], -1.0f, 1.0f), wanted[j], 1e-6f);
    }
    parts->forget(true, nullptr);
  }
  EXPECT_EQ(saved(*whole), saved(*parts));
}

TEST_P(TeamAlgo, ADropLeavesTheActorsAsTheyWere) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  for (int64_t slices = 1;; slices += 3) {
    while (a->missing() > 0) world.decide(*a);
    const auto file = policy_file(*a);
    a->begin_update(world.obs());
    int64_t i = 0;
    while (i < slices && !a->update_on(1, nullptr)) ++i;
    if (i < slices) break;  // it was done before
    EXPECT_EQ(policy_file(*a), file) << slices;
    a->discard();
    EXPECT_EQ(policy_file(*a), file) << slices;
    EXPECT_EQ(a->missing(), a->horizon());
  }
}

// A group acts on its own fields alone.
TEST_P(TeamAlgo, AGroupDoesNotSeeTheOthersFields) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*a);
  const Played p(*a);
  std::vector<float> obs = rows_of_noise(kObs);
  const std::vector<float> before = p.act(obs);
  obs[5] += 0.7f;  // left.angle
  const std::vector<float> left = p.act(obs);
  for (size_t j = 0; j < kActions; ++j) EXPECT_EQ(left[j] == before[j], j < 2) << j;
  obs[5] -= 0.7f, obs[1] += 0.7f;  // right.angle
  const std::vector<float> right = p.act(obs);
  for (size_t j = 2; j < kActions; ++j) EXPECT_NEAR(right[j], before[j], 1e-6f) << j;
  EXPECT_NE(right[0], before[0]);
}

// The file of a team plays as the agent does, and each group's own file as its part of the team.
TEST_P(TeamAlgo, FilesOfTheTeamAndOfEachGroupPlayAsTheAgent) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*a);
  const Played p(*a);
  const std::vector<float> all = rows_of_noise(4 * 40 * kObs);
  std::vector<float> agents(40 * kActions), state, own_state[2], obs;
  std::unique_ptr<Policy, Played::End> own[2];
  for (int32_t g = 0; g < 2; ++g) {
    const auto bytes = written([&](Writer& w) { write_group(w, p.policy->view(), g); });
    own[g].reset(Policy::read(bytes.data(), bytes.size(), {}));
    ASSERT_EQ(own[g]->view().action_dim(), p.policy->view().group[g].count);
    ASSERT_EQ(own[g]->view().state_dim(), remembers() ? 7 : 0);
  }
  ASSERT_EQ(p.policy->view().state_dim(), remembers() ? 14 : 0);
  for (size_t t = 0; t < 4; ++t) {  // decisions of an episode, the last of which begins another one
    const auto from = all.begin() + static_cast<long>(t * 40 * kObs);
    obs.assign(from, from + 40 * kObs);
    if (t == 3) {
      a->forget(true, nullptr);
      for (std::vector<float>* s : {&state, &own_state[0], &own_state[1]})
        std::fill(s->begin(), s->end(), 0.0f);
    }
    a->act(obs.data(), false, agents.data());
    const std::vector<float> played = Played::act_on(*p.policy, obs, state);
    for (size_t i = 0; i < agents.size(); ++i)
      ASSERT_NEAR(played[i], std::clamp(agents[i], -1.0f, 1.0f), 1e-6f);
    for (size_t g = 0; g < 2; ++g) {
      const ActorGroup& group = p.policy->view().group[g];
      const std::vector<float> part = Played::act_on(*own[g], obs, own_state[g]);
      for (size_t i = 0; i < 40; ++i)
        for (size_t j = 0; j < size_of(group.count); ++j)
          ASSERT_NEAR(part[i * size_of(group.count) + j], played[i * kActions + size_of(group.first) + j],
                      1e-6f);
    }
  }
  // and back into an agent
  AgentSetup fresh = setup();
  const AgentPtr b = fresh.make();
  b->load_policy(p.policy->view(), 1000);
  std::vector<float> again(agents.size());
  b->act(obs.data(), false, again.data());
  for (size_t i = 0; i < agents.size(); ++i) ASSERT_NEAR(again[i], agents[i], 1e-5f);
}

TEST_P(TeamAlgo, NothingIsAllocatedAfterTheFirstEpoch) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  const int64_t before = heap_count();
  world.epoch(*a);
  EXPECT_EQ(heap_count(), before);
}

INSTANTIATE_TEST_SUITE_P(All, TeamAlgo,
                         testing::Combine(testing::Values("mappo", "mappo_lag", "happo", "macpo", "ippo",
                                                          "ippo_lag"),
                                          testing::Values("free", "state"), testing::Values("", "gru:7")),
                         [](const auto& i) {
                           return std::string(std::get<0>(i.param)) + "_" + std::get<1>(i.param) +
                                  (*std::get<2>(i.param) ? "_gru" : "");
                         });

// A group of IPPO learns as an agent of its own would that sees the group's fields alone, acts as the group acted, and
// gets the team's rewards and costs: actor and critics, over ends, truncations with final rows, and rows left out.
TEST(Team, IndependentGroupsLearnAsAgentsOfTheirOwn) {
  const bool limited[] = {false, true};
  for (const auto& [with_limit, memory] :
       {std::pair{limited[0], ""}, {limited[1], ""}, {limited[0], "gru:5"}, {limited[1], "gru:5"}}) {
    const char *const of_team = with_limit ? "ippo_lag" : "ippo", *const alone =
                                                                      with_limit ? "ppo_lag" : "ppo";
    SCOPED_TRACE(std::string(of_team) + memory);
    AgentSetup s = team(of_team, kPair);
    s.with("terminal_cost", "true").with("memory", memory).with("memory_chunk", "4");
    const AgentPtr whole = s.make();
    const char* const names[] = {"right", "left"};
    const char* const fields[] = {"right.*,ball", "!right.*"};
    const int32_t first[] = {0, 2}, count[] = {2, 3};
    AgentPtr own[2];
    for (size_t g = 0; g < 2; ++g) {
      AgentSetup t = team(alone, nullptr);
      t.with("terminal_cost", "true").with("actor_obs", fields[g]).with("critic_obs", fields[g]);
      t.with("memory", memory).with("memory_chunk", "4");
      t.config.action_dim = count[g];
      own[g] = t.make();
      TensorInfo mine, theirs;
      int32_t copied = 0;
      for (int32_t i = 0; own[g]->tensor(i, &mine); ++i) {
        const std::string name = mine.name;
        if (name == "actor.log_std") continue;
        const size_t dot = name.find('.');
        const std::string wanted = name.substr(0, dot + 1) + names[g] + name.substr(dot);
        for (int32_t k = 0; whole->tensor(k, &theirs); ++k)
          if (wanted == theirs.name) {
            ASSERT_EQ(mine.rows * mine.cols, theirs.rows * theirs.cols) << wanted;
            std::copy_n(theirs.data, mine.rows * mine.cols, mine.data), ++copied;
          }
      }
      ASSERT_EQ(copied, (with_limit ? 18 : 12) + (*memory ? 4 : 0));
    }
    NoiseWorld world(s.config);
    std::vector<float> action(24 * kActions), part;
    for (int epoch = 0; epoch < 3; ++epoch) {
      while (whole->missing() > 0) {
        const std::vector<float> obs(world.obs(), world.obs() + 24 * kObs);
        whole->act(obs.data(), true, action.data());
        world.draw();
        whole->record(world.transition());
        for (size_t g = 0; g < 2; ++g) {
          part.clear();
          for (size_t i = 0; i < 24; ++i)
            part.insert(part.end(), action.begin() + static_cast<long>(i * kActions) + first[g],
                        action.begin() + static_cast<long>(i * kActions) + first[g] + count[g]);
          own[g]->put(obs.data(), part.data(), world.transition());
        }
      }
      Epoch e, f;
      whole->update(world.obs(), &e);
      for (const AgentPtr& a : own) {
        a->update(world.obs(), &f);
        EXPECT_EQ(e.multiplier[0], f.multiplier[0]);
      }
    }
    float moved = 0;
    for (size_t g = 0; g < 2; ++g) {
      TensorInfo mine, theirs;
      for (int32_t i = 0; own[g]->tensor(i, &mine); ++i) {
        const std::string name = mine.name;
        const size_t dot = name.find('.');
        const bool std = name == "actor.log_std";
        const std::string wanted = std ? name : name.substr(0, dot + 1) + names[g] + name.substr(dot);
        for (int32_t k = 0; whole->tensor(k, &theirs); ++k) {
          if (wanted != theirs.name) continue;
          for (int32_t j = 0; j < mine.rows * mine.cols; ++j) {
            const float at = theirs.data[j + (std ? first[g] : 0)];
            ASSERT_NEAR(mine.data[j], at, 2e-5f) << wanted << " " << j;
            moved = std::max(moved, std::abs(at));
          }
        }
      }
    }
    EXPECT_GT(moved, 0.1f);
  }
}

// What the Fisher matrix of one group says of a step is the KL of what the group then gives, through the sequences of
// its memory: v'Fv / 2 = KL / step^2 for small steps, and nothing of a step of the others.
TEST(Team, FisherProductsOfAGroupThroughItsMemoryAreThoseOfTheKl) {
  AgentSetup s = team("macpo", kPair, 16);
  s.with("memory", "gru:4").with("memory_chunk", "4").with("minibatches", "1").with("cg_damping", "0");
  s.with("last_layer_scale", "1").with("init_std", "0.7");
  Bench b(std::move(s));
  Rollout& r = b.rollout;
  Stream stream(2, 0, Purpose::kTest);
  for (size_t i = 0; i < size_of(r.paths()) * 16 * size_of(r.units); ++i)
    r.state[i] = static_cast<float>(stream.signed_unit());
  for (size_t i = 0; i < size_of(b.resolved.samples); ++i) r.age[i] = stream.uniform() < 0.2 ? 0 : 1;
  restart_sequences(r, 0, 16);
  Batch batch(r.order, list_sequences(r, 0, 16, 0, nullptr));
  batch.envs = 16, batch.path = r.path;
  b.learner.begin_outputs(batch, r.mean).finish();  // what acted
  for (size_t j = 0; j < kActions; ++j) r.log_std[j] = b.nets.log_std()[j];
  Arena measure;
  Fisher fisher;
  fisher.carve(measure, b.resolved);
  Arena arena(HostHooks(), measure.used());
  fisher.carve(arena, b.resolved);
  fisher.open(b.resolved, r, b.nets, b.workers);
  fisher.read_live(kTrustRows.read(b.resolved.options));
  const size_t size = b.nets.block[Networks::kActor].size;
  for (const int32_t g : {0, 1}) {
    SCOPED_TRACE(g);
    b.nets.focus = g;
    fisher.set_rows(batch);
    std::vector<float> v(size), product(size);
    const ActorGroup& own = b.nets.group[g];
    const size_t first = b.nets.std_size + own.offset, last = first + own.net().num_params();
    for (size_t j = b.nets.std_size; j < size; ++j) v[j] = static_cast<float>(stream.signed_unit());
    fisher.multiply(v.data(), product.data());
    double curve = 0;
    for (size_t j = first; j < last; ++j)
      curve += static_cast<double>(v[j]) * static_cast<double>(product[j]);
    for (size_t j = b.nets.std_size; j < size; ++j)
      if (j < first || j >= last) {
        ASSERT_EQ(product[j], 0.0f) << j;
      }
    const std::vector<float> before(b.nets.params, b.nets.params + size);
    const auto kl_of = [&](float step) {
      for (size_t j = first; j < last; ++j) b.nets.params[j] = before[j] + step * v[j];
      const double kl = b.learner.kl(batch);
      std::copy(before.begin(), before.end(), b.nets.params);
      return kl;
    };
    constexpr float kStep = 0.01f;  // the mean of both ways has no cubic term
    const double kl = (kl_of(kStep) + kl_of(-kStep)) / 2;
    EXPECT_GT(curve, 0.1);
    EXPECT_NEAR(kl / (kStep * static_cast<double>(kStep)), curve / 2, 0.02 * curve);
  }
}

// What a group's new policy makes of its actions weighs the rows of the others, within ratio_max.
TEST(Team, ARatioWeighsRowsWithinItsBound) {
  AgentSetup s = team("macpo", kPair, 16);
  s.with("last_layer_scale", "1").with("init_std", "0.3");
  Bench b(std::move(s));
  Rollout& r = b.rollout;
  const Batch batch(b.order.data(), b.resolved.samples);
  b.learner.begin_outputs(batch, r.mean).finish();  // what acted
  for (size_t j = 0; j < kActions; ++j) r.log_std[j] = b.nets.log_std()[j];
  Stream stream(3, 0, Purpose::kTest);
  const size_t rows = size_of(b.resolved.samples);
  stream.normals(r.action, b.resolved.samples * kActions);
  for (size_t i = 0; i < rows * kActions; ++i) r.action[i] = r.mean[i] + 0.3f * r.action[i];
  for (size_t i = 0; i < rows; ++i) keep_log_prob(r, i, r.mean + i * kActions, r.log_std);
  const ActorGroup& first = b.nets.group[0];
  float* const params = b.nets.params + b.nets.std_size + first.offset;
  for (size_t j = 0; j < first.net().num_params(); ++j)
    params[j] += 0.15f * static_cast<float>(stream.signed_unit());
  const auto weights = [&](double most) {
    std::fill_n(r.gain, rows, 1.0f);
    std::fill_n(r.linear, rows, -2.0f);
    b.learner.begin_weigh(batch, 0, most).finish();
    std::vector<float> out(r.gain, r.gain + rows);
    for (size_t i = 0; i < rows; ++i) EXPECT_EQ(r.linear[i], -2 * out[i]);
    return out;
  };
  const std::vector<float> any = weights(1e9), held = weights(1.5);
  int32_t above = 0, below = 0, between = 0;
  for (size_t i = 0; i < rows; ++i) {
    EXPECT_FLOAT_EQ(held[i], std::clamp(any[i], 1 / 1.5f, 1.5f));
    above += any[i] > 1.5f, below += any[i] < 1 / 1.5f;
    between += any[i] != 1 && any[i] > 1 / 1.5f && any[i] < 1.5f;
  }
  EXPECT_GT(above, 5);
  EXPECT_GT(below, 5);
  EXPECT_GT(between, 5);
  const std::vector<float> other = [&] {  // the second group has not moved
    std::fill_n(r.gain, rows, 1.0f);
    b.learner.begin_weigh(batch, 1, 1e9).finish();
    return std::vector<float>(r.gain, r.gain + rows);
  }();
  for (const float w : other) EXPECT_NEAR(w, 1, 1e-5f);
}

// The critics of a group see its fields alone.
TEST(Team, CriticsOfAGroupDoNotSeeTheOthersFields) {
  AgentSetup s = team("ippo_lag", kPair, 8);
  const AgentPtr a = s.make();
  const auto columns = [&](const char* critic) {
    TensorInfo t;
    for (int32_t i = 0; a->tensor(i, &t); ++i)
      if (std::string(t.name) == std::string(critic) + ".0.weight") return t.cols;
    return 0;
  };
  for (const char* kind : {"reward_critic.", "cost_critic."}) {
    EXPECT_EQ(columns((std::string(kind) + "right").c_str()), 7) << kind;
    EXPECT_EQ(columns((std::string(kind) + "left").c_str()), 6) << kind;
  }
  s.with("critic_obs", "left.*");
  EXPECT_NE(refused([&] { s.make(); }).find("critic_obs leaves right no entry"), std::string::npos);
}

// Each group's ratio is clipped by itself, and its parameters' gradient is that of its own factor: against finite
// differences of the sum over groups of clip(rho_g) A, written here in its own way.
TEST(Team, RatiosAreOfGroups) {
  const ActorGroup groups[2] = {[] {
                                  ActorGroup g;
                                  g.first = 0, g.count = 2;
                                  return g;
                                }(),
                                [] {
                                  ActorGroup g;
                                  g.first = 2, g.count = 3;
                                  return g;
                                }()};
  Rollout r;
  r.action_dim = kActions;
  r.group = groups, r.num_groups = 2;
  std::vector<float> action = {0.1f, -0.2f, 0.3f, 0.4f, -0.5f}, old = {0, 0.1f, 0.2f, 0.3f, 0},
                     log_std(5, -0.5f);
  std::vector<float> now = {0.05f, 0.2f, 0.1f, 0.35f, -0.1f}, log_prob(2);
  r.action = action.data(), r.mean = old.data(), r.log_std = log_std.data(), r.log_prob = log_prob.data();
  keep_log_prob(r, 0, old.data(), log_std.data());
  double product = 1;
  for (size_t g = 0; g < 2; ++g) {
    double exponent = 0;
    for (size_t j = size_of(groups[g].first); j < size_of(groups[g].first + groups[g].count); ++j) {
      const double s2 = std::exp(-1.0);
      const auto a = static_cast<double>(action[j]), m = static_cast<double>(now[j]),
                 o = static_cast<double>(old[j]);
      exponent += ((a - o) * (a - o) - (a - m) * (a - m)) / (2 * s2);
    }
    EXPECT_NEAR(part_ratio(r, 0, g, now.data(), log_std.data()), std::exp(exponent), 1e-6) << g;
    product *= std::exp(exponent);
  }
  EXPECT_NEAR(sample_ratio(r, 0, now.data(), log_std.data()), product, 1e-6);
}
