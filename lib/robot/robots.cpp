#include "robot/robots.hpp"

#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

const Robot* const kOwn[] = {&kShadowHand,  &kAllegroHand, &kSchunkSvh,   &kBarrettBh282, &kRobotiq3f,
                             &kFrankaPanda, &kAbbIrb4600,  &kKinovaJaco2, &kKukaIiwa7,    &kXarm6,
                             &kAbbCrb15000, &kUr5e,        &kUr10e,       &kDrawer,       &kDoor,
                             &kScrewBottle, &kScissors,    &kTap};
constexpr int32_t kNumOwn = static_cast<int32_t>(sizeof kOwn / sizeof kOwn[0]);

struct Added {
  RobotCopy* robot;
  HostHooks hooks;
  int32_t users;  // references, and one for the list
  bool listed;    // not removed; what is removed stays until its last user goes
};

std::mutex g_lock;
Added g_added[kMaxRobots];
int32_t g_num_added = 0;

// Under the lock.
const Robot* at(int32_t index) {
  if (index < kNumOwn) return kOwn[index];
  return &g_added[index - kNumOwn].robot->robot();
}
bool listed(int32_t index) {
  return index < kNumOwn || g_added[index - kNumOwn].listed;
}

void release(int32_t index) {
  RobotCopy* last = nullptr;
  HostHooks hooks;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    Added& added = g_added[index - kNumOwn];
    if (--added.users > 0) return;
    last = std::exchange(added.robot, nullptr);
    hooks = added.hooks;
  }
  host_delete(hooks, last);
}

bool called(const Robot& robot, const char* name) {
  return same_name(robot.name, name) || (robot.alias && same_name(robot.alias, name));
}

// Under the lock; -1: none.
int32_t find(const char* name) {
  for (int32_t i = 0; i < kNumOwn + g_num_added; ++i)
    if (listed(i) && called(*at(i), name)) return i;
  return -1;
}

}  // namespace

int32_t num_robots() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return kNumOwn + g_num_added;
}

RobotRef::RobotRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  if (index < 0 || index >= kNumOwn + g_num_added)
    fail(Code::kRange, "robot: %d is outside [0, %d)", index, kNumOwn + g_num_added);
  if (!listed(index)) fail(Code::kNotFound, "robot %d was removed", index);
  robot_ = at(index);
  if (index < kNumOwn) return;
  index_ = index;
  ++g_added[index - kNumOwn].users;
}

RobotRef::RobotRef(RobotRef&& other) noexcept
    : index_(std::exchange(other.index_, -1)), robot_(std::exchange(other.robot_, nullptr)) {}

RobotRef& RobotRef::operator=(RobotRef&& other) noexcept {
  std::swap(index_, other.index_);
  std::swap(robot_, other.robot_);
  return *this;
}

RobotRef::~RobotRef() {
  if (index_ >= 0) release(index_);
}

int32_t find_robot(const char* name) {
  if (!name) fail(Code::kArgument, "robot: the name is NULL");
  const std::lock_guard<std::mutex> hold(g_lock);
  const int32_t i = find(name);
  if (i >= 0) return i;
  const char* names[2 * (kNumOwn + kMaxRobots)];
  int32_t count = 0;
  for (int32_t k = 0; k < kNumOwn + g_num_added; ++k) {
    if (!listed(k)) continue;
    names[count++] = at(k)->name;
    if (at(k)->alias) names[count++] = at(k)->alias;
  }
  fail(Code::kNotFound, "robot %s: unknown%s", Quoted(name).text, Nearest(name, names, count).text);
}

int32_t add_robot(const Robot& robot) {
  check_robot(robot);
  const HostHooks hooks = host();
  RobotCopy* copy = host_new<RobotCopy>(hooks, robot);
  const char* taken = nullptr;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    for (const char* name : {robot.name, robot.alias})
      if (name && !taken && find(name) >= 0) taken = name;
    if (!taken && g_num_added < kMaxRobots) {
      g_added[g_num_added] = {copy, hooks, 1, true};
      return kNumOwn + g_num_added++;
    }
  }
  host_delete(hooks, copy);
  if (taken) fail(Code::kArgument, "robot %s: the name is taken", Quoted(taken).text);
  fail(Code::kRange, "robot %s: more than %d robots were added", Quoted(robot.name).text, kMaxRobots);
}

void remove_robot(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    if (index < 0 || index >= kNumOwn + g_num_added)
      fail(Code::kRange, "robot: %d is outside [0, %d)", index, kNumOwn + g_num_added);
    if (index < kNumOwn) fail(Code::kArgument, "robot %s is the library's own", kOwn[index]->name);
    if (!listed(index)) fail(Code::kNotFound, "robot %d was removed", index);
    g_added[index - kNumOwn].listed = false;
  }
  release(index);
}

}  // namespace rdm
