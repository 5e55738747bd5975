// Which entries of a row a list of fields names; agents that see a part of it.
#include <algorithm>

#include "agents.hpp"
#include "algos/core/columns.hpp"
#include "nn/policy.hpp"

namespace rdm::test {
namespace {

using Columns = std::vector<int32_t>;

constexpr ObsField kFields[] = {{"right.joint_position", 0, 2},
                                {"right.ff_tip_force", 2, 3},
                                {"right.ff_tip_velocity", 5, 1},
                                {"object.position", 6, 2},
                                {"right.action", 8, 1}};
constexpr int kDim = 9;

Columns select(const char* list) {
  const Vector<int32_t> c = select_columns("actor_obs", list, kFields, 5, kDim);
  return {c.begin(), c.end()};
}
std::string refused(const char* list, Code code, int32_t fields = 5) {
  EXPECT_EQ(guard([&] { select_columns("actor_obs", list, fields ? kFields : nullptr, fields, kDim); }), code)
      << list;
  return last_error();
}

TEST(Columns, AllAreNoList) {
  for (const char* all :
       {"*", "state", " * ", "STATE", "right.*,object.*", "object.position,!object.*,*", "*,*"})
    EXPECT_EQ(select(all), Columns()) << all;
}

TEST(Columns, FieldsByNameAndPattern) {
  EXPECT_EQ(select("object.position"), (Columns{6, 7}));
  EXPECT_EQ(select("Right.Action , object.position"), (Columns{6, 7, 8}));
  EXPECT_EQ(select("*_tip_*"), (Columns{2, 3, 4, 5}));
  EXPECT_EQ(select("*position"), (Columns{0, 1, 6, 7}));
  EXPECT_EQ(select("!object.*"), (Columns{0, 1, 2, 3, 4, 5, 8}));
  EXPECT_EQ(select("*,!right.*"), (Columns{6, 7}));
  EXPECT_EQ(select("right.*,!*_tip_*,*force"), (Columns{0, 1, 2, 3, 4, 8}));
}

TEST(Columns, PresetsAreListsByName) {
  EXPECT_EQ(select("touch"), (Columns{0, 1, 2, 3, 4, 5, 8}));
  EXPECT_EQ(select("proprioception"), (Columns{0, 1, 5, 8}));
  EXPECT_EQ(select("proprioception,object.position"), (Columns{0, 1, 5, 6, 7, 8}));
  EXPECT_EQ(select("vision"), (Columns{0, 1, 2, 3, 4, 5, 8})) << "as touch: there is no goal";
  const ObsField goals[] = {{"right.joint_position", 0, 2},  {"right.ff_tip_force", 2, 1},
                            {"object.position", 3, 1},       {"goal.position", 4, 2},
                            {"object.rotation_error", 6, 1}, {"target.velocity", 7, 1}};
  const Vector<int32_t> seen = select_columns("actor_obs", "vision", goals, 6, 8);
  EXPECT_EQ(Columns(seen.begin(), seen.end()), (Columns{0, 1, 2, 4, 5})) << "the goal, nothing of objects";
  EXPECT_EQ(select("!proprioception"), (Columns{2, 3, 4, 6, 7}));
  // a field of that name comes first
  const ObsField own[] = {{"state", 0, 1}, {"rest", 1, 1}};
  const Vector<int32_t> c = select_columns("actor_obs", "state", own, 2, 2);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0], 0);
}

TEST(Columns, WordsThatNameNothing) {
  EXPECT_EQ(refused("object.positon", Code::kNotFound),
            "actor_obs: 'object.positon' names no field of the observation; nearest is object.position");
  EXPECT_EQ(refused("*,!cube.*", Code::kNotFound), "actor_obs: 'cube.*' names no field of the observation");
  EXPECT_EQ(refused("proprioceptive", Code::kNotFound),
            "actor_obs: 'proprioceptive' names no field of the observation; nearest is proprioception");
  refused("", Code::kNotFound);
  refused("object.position,", Code::kNotFound);
  refused("!", Code::kNotFound);
  EXPECT_EQ(refused("right.*,!right.*", Code::kArgument), "actor_obs: no entry of the observation is left");
  refused("!*", Code::kArgument);
  EXPECT_EQ(refused("right.action", Code::kArgument, 0),
            "actor_obs: 'right.action' needs the names of fields, but config.fields is empty");
  EXPECT_EQ(select_columns("actor_obs", "*", nullptr, 0, kDim).size(), 0u);
  const ObsField cubes[] = {{"cube", 0, 9}};
  EXPECT_EQ(guard([&] { select_columns("critic_obs", "touch", cubes, 1, kDim); }), Code::kNotFound);
  EXPECT_STREQ(last_error(), "critic_obs: the observation has no field touch");
}

// An agent of one algorithm that sees the fields `actor` and `critic` of a row.
struct Seeing {
  AgentSetup setup;
  explicit Seeing(const char* algo, const char* actor, const char* critic, int32_t threads = 0)
      : setup(algo, kDim, 2, 6) {
    setup.config.fields = kFields;
    setup.config.num_fields = 5;
    setup.config.num_threads = threads;
    setup.with("horizon", "32").with("hidden", "16,8").with("actor_obs", actor).with("critic_obs", critic);
    few_updates(setup);
  }
};

class EveryAlgoSees : public testing::TestWithParam<int32_t> {
 protected:
  const char* algo() const { return algo_at(GetParam()).name; }
};

// The rows of a world of `dim` entries, and of them those that are listed.
struct Rows {
  Stream stream{3, 0, Purpose::kTest};
  std::vector<float> whole, part, reward, cost;
  std::vector<uint8_t> ended;
  void draw(const Columns& columns, int32_t envs) {
    const auto n = size_of(envs);
    whole.resize(n * kDim), part.resize(n * columns.size()), reward.resize(n), cost.resize(n),
        ended.resize(n);
    for (float& x : whole) x = static_cast<float>(stream.signed_unit());
    for (size_t i = 0; i < n; ++i)
      for (size_t k = 0; k < columns.size(); ++k)
        part[i * columns.size() + k] = whole[i * kDim + size_of(columns[k])];
    for (float& r : reward) r = static_cast<float>(stream.signed_unit());
    for (float& c : cost) c = static_cast<float>(stream.uniform());
    for (uint8_t& e : ended) e = stream.uniform() < 0.1;
  }
};

// What an agent does that sees a part of each row is what one does that is given no more than this part.
TEST_P(EveryAlgoSees, APartAsIfThereWereNoMore) {
  for (const char* mode : {"free", "state"}) {
    const Columns columns = {0, 1, 5, 8};
    Seeing wide(algo(), "proprioception", "proprioception");
    AgentSetup narrow(algo(), 4, 2, 6, {{"horizon", "32", 0}, {"hidden", "16,8", 0}});
    few_updates(narrow);
    const AgentPtr a = wide.setup.with_known("std_mode", mode).make();
    const AgentPtr b = narrow.with_known("std_mode", mode).make();
    Rows rows;
    rows.draw(columns, 6);
    std::vector<float> action(12), other(12);
    for (int epoch = 0; epoch < 3; ++epoch) {
      while (a->missing() > 0) {
        a->act(rows.whole.data(), true, action.data());
        b->act(rows.part.data(), true, other.data());
        EXPECT_EQ(action, other);
        rows.draw(columns, 6);
        Transition t;
        t.reward = rows.reward.data(), t.cost = rows.cost.data(), t.truncated = rows.ended.data();
        t.final_obs = rows.whole.data();
        a->record(t);
        t.final_obs = rows.part.data();
        b->record(t);
      }
      a->update(rows.whole.data(), nullptr);
      b->update(rows.part.data(), nullptr);
    }
    EXPECT_EQ(parameters(*a), parameters(*b)) << mode;
    a->act(rows.whole.data(), false, action.data());
    b->act(rows.part.data(), false, other.data());
    EXPECT_EQ(action, other);
  }
}

std::vector<unsigned char> policy_of(Agent& a) {
  Writer count(nullptr, 0);
  a.write_policy_file(count);
  std::vector<unsigned char> bytes(count.size());
  Writer out(bytes.data(), bytes.size());
  a.write_policy_file(out);
  return bytes;
}
std::vector<unsigned char> saved(const Agent& a) {
  Writer count(nullptr, 0);
  a.save(count);
  std::vector<unsigned char> bytes(count.size());
  Writer out(bytes.data(), bytes.size());
  a.save(out);
  return bytes;
}

TEST_P(EveryAlgoSees, DifferentPartsOnAnyNumberOfThreadsAndAfterALoad) {
  Seeing one(algo(), "!object.*", "*"), three(algo(), "!object.*", "*", 3), other(algo(), "touch", "*");
  const AgentPtr a = one.setup.make(), b = three.setup.make(), c = other.setup.make();
  NoiseWorld world(one.setup.config), same(one.setup.config);
  for (int epoch = 0; epoch < 2; ++epoch) {
    world.epoch(*a);
    same.epoch(*b);
  }
  EXPECT_EQ(parameters(*a), parameters(*b));
  EXPECT_EQ(policy_of(*a), policy_of(*b));
  Seeing again(algo(), "!object.*", "*");
  const AgentPtr d = again.setup.make();
  const auto state = saved(*a);
  d->load(state.data(), state.size());
  EXPECT_EQ(policy_of(*d), policy_of(*a));
  world.epoch(*a);
  same.epoch(*d);
  EXPECT_EQ(parameters(*d), parameters(*a));
  // of another list, though it names the same entries
  EXPECT_EQ(guard([&] { c->load(state.data(), state.size()); }), Code::kFormat);
  EXPECT_NE(std::strstr(last_error(), "option actor_obs is '!object.*' in it, but 'touch' in this agent"),
            nullptr)
      << last_error();
}

// A policy file acts on whole rows as its agent does, whatever stands in what it does not see.
TEST_P(EveryAlgoSees, ItsPolicyTakesWholeRows) {
  Seeing s(algo(), "proprioception", "*");
  const AgentPtr a = s.setup.make();
  NoiseWorld world(s.setup.config);
  world.epoch(*a);
  const auto bytes = policy_of(*a);
  const std::unique_ptr<Policy, void (*)(Policy*)> p(Policy::read(bytes.data(), bytes.size(), {}),
                                                     Policy::destroy);
  EXPECT_EQ(p->view().obs_dim(), kDim);
  EXPECT_EQ(p->view().actor.in, 4);
  EXPECT_EQ(Columns(p->view().columns, p->view().columns + 4), (Columns{0, 1, 5, 8}));
  std::vector<float> obs(world.obs(), world.obs() + 6 * kDim), action(12), mean(12);
  std::vector<float> scratch(p->scratch_bytes(6) / sizeof(float) + 16);
  void* at = scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64 / sizeof(float);
  const auto act = [&] {
    p->act(obs.data(), 6, nullptr, action.data(), at);
    return action;
  };
  a->act(obs.data(), false, mean.data());
  const std::vector<float> first = act();
  for (size_t i = 0; i < mean.size(); ++i) EXPECT_EQ(first[i], std::clamp(mean[i], -1.0f, 1.0f));
  for (size_t i = 0; i < 6; ++i)
    for (const size_t hidden : {2, 3, 4, 6, 7}) obs[i * kDim + hidden] = 1e6f;
  EXPECT_EQ(act(), first);
  obs[5] += 0.5f;
  EXPECT_NE(act(), first);
}

INSTANTIATE_TEST_SUITE_P(List, EveryAlgoSees, testing::Range(0, algo_count()),
                         [](const auto& info) { return std::string(algo_at(info.param).name); });

TEST(Columns, FieldsThatAreNoneOfTheRow) {
  for (const ObsField bad : {ObsField{"a", -1, 2}, {"a", 8, 2}, {"a", 0, 0}, {"a", 2147483647, 2}}) {
    Seeing s("ppo", "*", "*");
    s.setup.config.fields = &bad;
    s.setup.config.num_fields = 1;
    EXPECT_EQ(guard([&] { s.setup.make(); }), Code::kRange);
  }
  const ObsField nameless{nullptr, 0, 1};
  Seeing s("ppo", "*", "*");
  s.setup.config.fields = &nameless;
  s.setup.config.num_fields = 1;
  EXPECT_EQ(guard([&] { s.setup.make(); }), Code::kArgument);
  s.setup.config.fields = nullptr;
  EXPECT_EQ(guard([&] { s.setup.make(); }), Code::kArgument);
}

// A list that is longer than a text usually is: kept, saved, and its memory told.
TEST(Columns, ALongListIsKeptWhole) {
  std::string list = "right.joint_position";
  while (list.size() < 900) list += ",right.joint_position";
  Seeing s("ppo_lag", list.c_str(), "*");
  const AgentPtr a = s.setup.make(), b = s.setup.make();
  EXPECT_EQ(a->options().text("actor_obs"), list);
  NoiseWorld world(s.setup.config);
  world.epoch(*a);
  const auto state = saved(*a);
  b->load(state.data(), state.size());
  EXPECT_EQ(parameters(*a), parameters(*b));
}

}  // namespace
}  // namespace rdm::test
