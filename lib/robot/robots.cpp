#include "robot/robots.hpp"

#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/numbered.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

// New ones stand at the end: hosts keep numbers.
const Robot* const kOwn[] = {
    &kShadowHand, &kAllegroHand, &kSchunkSvh, &kBarrettBh282, &kRobotiq3f,   &kFrankaPanda,
    &kAbbIrb4600, &kKinovaJaco2, &kKukaIiwa7, &kXarm6,        &kAbbCrb15000, &kUr5e,
    &kUr10e,      &kDrawer,      &kDoor,      &kScrewBottle,  &kScissors,    &kTap,
};
constexpr int32_t kNumOwn = static_cast<int32_t>(sizeof kOwn / sizeof kOwn[0]);

struct Added {
  RobotCopy* robot = nullptr;
  HostHooks hooks;
};

std::mutex g_lock;
// Under the lock; numbered behind our own.
Numbered<Added>& added() {
  static auto* const list =
      new Numbered<Added>("robot", kNumOwn);  // never ended: a pool may outlive all statics
  return *list;
}

void release(int32_t index) {
  Added last;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    if (!added().release(index, &last)) return;
  }
  host_delete(last.hooks, last.robot);
}

// Calls f(robot, number) for all that are listed, until it returns true.
template <class F>
bool any_listed(F&& f) {
  for (int32_t i = 0; i < kNumOwn; ++i)
    if (f(*kOwn[i], i)) return true;
  for (const auto& row : added())
    if (row.listed && f(row.what.robot->robot(), row.number)) return true;
  return false;
}

bool called(const Robot& robot, const char* name) {
  return same_name(robot.name, name) || (robot.alias && same_name(robot.alias, name));
}

// Under the lock; -1: none.
int32_t find(const char* name) {
  int32_t found = -1;
  any_listed([&](const Robot& r, int32_t i) { return called(r, name) && (found = i, true); });
  return found;
}

}  // namespace

int32_t num_robots() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return added().given();
}

RobotRef::RobotRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  added().need(index);
  if (index < kNumOwn) {
    robot_ = kOwn[index];
    return;
  }
  Numbered<Added>::Row& row = added().listed(index);
  robot_ = &row.what.robot->robot();
  index_ = index;
  ++row.users;
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
  Vector<const char*> names;
  any_listed([&](const Robot& r, int32_t) {
    names.push_back(r.name);
    if (r.alias) names.push_back(r.alias);
    return false;
  });
  fail(Code::kNotFound, "robot %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

int32_t add_robot(const Robot& robot) {
  check_robot(robot);
  const HostHooks hooks = host();
  RobotCopy* copy = host_new<RobotCopy>(hooks, robot);
  try {
    const std::lock_guard<std::mutex> hold(g_lock);
    for (const char* name : {robot.name, robot.alias})
      if (name && find(name) >= 0) fail(Code::kArgument, "robot %s: the name is taken", Quoted(name).text);
    return added().add({copy, hooks});
  } catch (...) {
    host_delete(hooks, copy);
    throw;
  }
}

void remove_robot(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    added().need(index);
    if (index < kNumOwn) fail(Code::kArgument, "robot %s is the library's own", kOwn[index]->name);
    added().listed(index).listed = false;
  }
  release(index);
}

}  // namespace rdm
