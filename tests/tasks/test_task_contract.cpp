// What every task of the catalogue owes its host beside its numbers: refused memory leaves nothing behind, a
// state that no world can have is refused, and what is told before a pool is made is what the pool has.
#include <redman/redman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

std::vector<std::string> all_tasks() {
  register_builtin_tasks();
  std::vector<std::string> out;
  for (int32_t i = 0; i < task_count(); ++i) out.push_back(task_at(i).name);
  return out;
}

// Hooks that count live bytes and refuse from the call number `refuse_at` on.
struct RefusingHost {
  size_t live = 0, calls = 0, refuse_at = SIZE_MAX;
  HostHooks hooks() {
    HostHooks h;
    h.user = this;
    h.alloc = [](void* user, size_t bytes, size_t align) -> void* {
      auto* host = static_cast<RefusingHost*>(user);
      if (host->calls++ >= host->refuse_at) return nullptr;
      void* p = nullptr;
      if (posix_memalign(&p, std::max(align, sizeof(void*)), bytes) != 0) return nullptr;
      host->live += bytes;
      return p;
    };
    h.release = [](void* user, void* p, size_t bytes, size_t) {
      static_cast<RefusingHost*>(user)->live -= bytes;
      std::free(p);
    };
    return h;
  }
};

class TaskContract : public testing::TestWithParam<std::string> {
 protected:
  const TaskInfo& info() const { return task_at(task_find(GetParam().c_str())); }
  Options options() const {
    Options o;
    int32_t count = 0;
    const OptionSpec* specs = info().options(&count, nullptr);
    o.add_table(specs, count);
    return o;
  }
};

TEST_P(TaskContract, EveryRefusedAllocationOfMakeLeavesNothing) {
  const Options o = options();
  bool made = false;
  for (size_t k = 0; !made; ++k) {
    RefusingHost host;
    host.refuse_at = k;
    const HostHooks hooks = host.hooks();
    const Code code = code_of([&] { info().destroy(info().make(o, hooks), hooks); });
    made = code == Code::kOk;
    ASSERT_TRUE(made || code == Code::kMemory) << "allocation " << k;
    ASSERT_EQ(host.live, 0u) << "allocation " << k;
    ASSERT_LT(k, 20000u);
  }
}

// One world of a task with the task's own bytes in reach.
class OpenWorld {
 public:
  explicit OpenWorld(const char* task)
      : pool_(task, 1),
        state_(pool_->task().state_bytes() / sizeof(double) + 1),
        action_(static_cast<size_t>(pool_->task().action_dim())),
        obs_(static_cast<size_t>(pool_->obs_dim())) {
    Stream stream(5, 0, Purpose::kTest);
    task_().reset(world(), bytes(), stream);
    for (float& a : action_) a = static_cast<float>(0.5 * stream.signed_unit());
  }
  const Task& task_() { return pool_->task(); }
  World& world() { return pool_->world(0); }
  unsigned char* bytes() { return reinterpret_cast<unsigned char*>(state_.data()); }
  size_t size() { return task_().state_bytes(); }
  Code check() {
    return code_of([&] { task_().check_state(bytes()); });
  }
  // A step without physics; true when all that it gives is finite.
  bool act(int32_t step) {
    bool good = look();
    task_().control(world(), bytes(), action_.data());
    const Verdict v = task_().judge(world(), bytes(), step);
    good = look() && good && std::isfinite(v.reward);
    for (const double c : v.cost) good = good && std::isfinite(c);
    for (const double c : v.cost_raw) good = good && std::isfinite(c);
    return good;
  }

 private:
  bool look() {
    task_().observe(world(), bytes(), obs_.data());
    return std::all_of(obs_.begin(), obs_.end(), [](float x) { return std::isfinite(x); });
  }
  TestPool pool_;
  std::vector<double> state_;
  std::vector<float> action_, obs_;
};

TEST_P(TaskContract, StatesOfItsOwnAreTaken) {
  OpenWorld w(GetParam().c_str());
  EXPECT_EQ(w.check(), Code::kOk);
  for (int32_t step = 1; step <= 40; ++step) {
    ASSERT_TRUE(w.act(step));
    w.world().step();
    ASSERT_EQ(w.check(), Code::kOk) << "step " << step;
  }
}

// Each place of the struct takes values that it cannot have. They are refused, or a step with them is sound:
// no index leads out of its array (a crash, or a sanitizer's word), no number is not finite.
TEST_P(TaskContract, AStateThatNoWorldHasIsRefusedOrHarmless) {
  OpenWorld w(GetParam().c_str());
  ASSERT_TRUE(w.act(1));
  const std::vector<unsigned char> good(w.bytes(), w.bytes() + w.size());
  int refused = 0;
  const auto put_in = [&](size_t at, const void* pattern, size_t size) {
    std::copy(good.begin(), good.end(), w.bytes());
    std::memcpy(w.bytes() + at, pattern, size);
    const Code code = w.check();
    refused += code != Code::kOk;
    ASSERT_TRUE(code == Code::kOk || code == Code::kFormat) << at;
    if (code == Code::kOk) {
      ASSERT_TRUE(w.act(2)) << "byte " << at;
    }
  };
  for (size_t at = 0; at + sizeof(uint32_t) <= good.size(); at += sizeof(uint32_t))
    for (const uint32_t pattern : {0xffffffffu, 0x7fffffffu, 0x20000000u, 0x80000000u, 0x7f800000u, 0x41u})
      put_in(at, &pattern, sizeof pattern);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (size_t at = 0; at + sizeof(double) <= good.size(); at += sizeof(double))
    for (const double pattern : {nan, inf, -inf, 1e300, -1e300}) put_in(at, &pattern, sizeof pattern);
  EXPECT_GT(refused, 0);
}

TEST_P(TaskContract, ItsSpecIsWhatAPoolHas) {
  rdm_pool_config c;
  ASSERT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
  c.task = GetParam().c_str();
  rdm_spec told{}, had{};
  told.struct_size = had.struct_size = sizeof told;
  ASSERT_EQ(rdm_pool_config_spec(&c, &told), RDM_OK) << rdm_last_error();
  rdm_pool* p = nullptr;
  ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_pool_get_spec(p, &had), RDM_OK);
  rdm_pool_destroy(p);
  EXPECT_EQ(std::memcmp(&told, &had, sizeof told), 0);
  EXPECT_GT(had.obs_dim, 0);
}

// rdm_buffers.cost promises it.
TEST_P(TaskContract, CostsAreNeverNegative) {
  TestPool p(GetParam().c_str(), 4);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 40; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
    for (int i = 0; i < 4; ++i)
      for (int32_t k = 0; k < p->cost_dim(); ++k) ASSERT_GE(p.cost(i)[k], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Tasks, TaskContract, testing::ValuesIn(all_tasks()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rdm::test
