#include "demo/player.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "common/names.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr double kSoon = 1e-6;  // s
constexpr double kPi = 3.14159265358979323846;

// Where each action entry stands, by name.
struct EntryNames {
  std::vector<std::string> names;    // [action_dim]
  std::vector<double> lower, upper;  // rad; 0, 0 for a base's entries
};

EntryNames entry_names(const redman::Pool& pool) {
  EntryNames out;
  rdm_robot robot{};
  robot.struct_size = sizeof robot;
  redman::check(rdm_robot_at(0, &robot));
  std::vector<std::string> joints(static_cast<size_t>(robot.num_actuated));
  std::vector<double> lower(joints.size()), upper(joints.size());
  for (int32_t i = 0; i < robot.num_joints; ++i) {
    rdm_joint j{};
    redman::check(rdm_robot_joint(0, i, &j));
    if (j.action < 0) continue;
    const auto k = static_cast<size_t>(j.action);
    joints[k] = j.name;
    lower[k] = j.lower;
    upper[k] = j.upper;
  }
  const size_t width = pool.action().width();
  bool two = false;
  for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
    rdm_field f;
    redman::check(rdm_pool_field(pool.get(), i, &f));
    two = two || std::string(f.name).rfind("left.", 0) == 0;
  }
  const size_t per_hand = two ? width / 2 : width;
  constexpr const char* kBase[] = {"x", "y", "z", "rx", "ry", "rz"};
  for (const char* side : {"right.", "left."}) {
    if (!two && side[0] == 'l') break;
    for (size_t k = 0; k < per_hand; ++k) {
      const bool joint = k < joints.size();
      out.names.push_back(side + (joint ? joints[k] : std::string(kBase[(k - joints.size()) % 6])));
      out.lower.push_back(joint ? lower[k] : 0);
      out.upper.push_back(joint ? upper[k] : 0);
    }
  }
  return out;
}

// One '*' stands for any run of characters.
bool matches(const std::string& pattern, const std::string& name) {
  const size_t star = pattern.find('*');
  if (star == std::string::npos) return same_name(pattern, name);
  const std::string head = pattern.substr(0, star), tail = pattern.substr(star + 1);
  return name.size() >= head.size() + tail.size() && same_name(name.substr(0, head.size()), head) &&
         same_name(name.substr(name.size() - tail.size()), tail);
}

// "object.position[2]" as an index of the observation; -1 when there is none.
int32_t observed(const redman::Pool& pool, const std::string& word, bool* angle) {
  const size_t open = word.find('[');
  const std::string name = word.substr(0, open);
  char* end = nullptr;
  const long k = open == std::string::npos ? 0 : std::strtol(word.c_str() + open + 1, &end, 10);
  if (end && (end == word.c_str() + open + 1 || std::strcmp(end, "]") != 0)) return -1;
  for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
    rdm_field f;
    redman::check(rdm_pool_field(pool.get(), i, &f));
    if (!same_name(f.name, name)) continue;
    if (angle) *angle = std::string(f.unit) == "rad";
    return k >= 0 && k < f.count ? f.offset + static_cast<int32_t>(k) : -1;
  }
  return -1;
}

[[noreturn]] void bad(const DemoScript& script, int line, const std::string& what) {
  throw Failure(format("demo %s, line %d: %s", script.file.c_str(), line, what.c_str()));
}

// `angle`: whether the field is one.
int32_t need_field(const DemoScript& script, int line, const redman::Pool& pool, const std::string& word,
                   bool* angle = nullptr) {
  const int32_t at = observed(pool, word, angle);
  if (at < 0) bad(script, line, "the task observes no " + word);
  return at;
}

}  // namespace

Demo::Demo(const DemoScript& script, redman::Pool& pool)
    : dt_(static_cast<double>(pool.spec().control_dt)), worlds_(pool.num_envs()) {
  const EntryNames entries = entry_names(pool);
  for (const DemoScript::Phase& p : script.phases) {
    Phase phase{p.seconds, {}, {}};
    for (const DemoScript::Condition& c : p.until)
      phase.until.push_back(
          {need_field(script, c.line, pool, c.field), c.below, static_cast<float>(c.value)});
    for (const DemoScript::Command& c : p.commands) {
      Command out{{}, {}, c.follows, c.at, c.over, c.gain, c.limit, c.value, -1, -1, memory_};
      for (size_t k = 0; k < entries.names.size(); ++k) {
        if (!matches(c.entry, entries.names[k])) continue;
        double v = c.value;
        if (c.degrees) {
          const double lower = entries.lower[k], upper = entries.upper[k];
          if (!(upper > lower)) bad(script, c.line, entries.names[k] + " takes no degrees");
          v = (2 * c.value * kPi / 180 - upper - lower) / (upper - lower);
        }
        out.entries.push_back(static_cast<int32_t>(k));
        out.values.push_back(static_cast<float>(std::clamp(v, -1.0, 1.0)));
      }
      if (out.entries.empty()) bad(script, c.line, "the task has no action " + c.entry);
      if (c.follows) {
        out.measured = need_field(script, c.line, pool, c.measured, &out.turns);
        if (!c.aim.empty()) out.aim = need_field(script, c.line, pool, c.aim);
      }
      memory_ += out.entries.size();
      phase.commands.push_back(out);
    }
    phases_.push_back(phase);
  }
  pool.baseline(RDM_BASELINE_HOLD);
  hold_.assign(pool.action()[0].begin(), pool.action()[0].end());
  restart(nullptr);
}

void Demo::restart(const uint8_t* mask) {
  for (size_t i = 0; i < worlds_.size(); ++i) {
    if (mask && !mask[i]) continue;
    worlds_[i].phase = 0;
    worlds_[i].step = 0;
    worlds_[i].value = hold_;
    worlds_[i].from.assign(memory_, std::nanf(""));
  }
}

bool Demo::over(const Phase& phase, const World& world, const float* obs) const {
  if (phase.seconds >= 0 && world.step * dt_ > phase.seconds - kSoon) return true;
  if (phase.until.empty() || world.step == 0) return false;
  return std::all_of(phase.until.begin(), phase.until.end(), [&](const Condition& c) {
    return c.below ? obs[c.entry] < c.value : obs[c.entry] > c.value;
  });
}

void Demo::run(World& w, const float* obs, float* action) const {
  while (w.phase + 1 < phases_.size() && over(phases_[w.phase], w, obs)) {
    ++w.phase;
    w.step = 0;
  }
  const double t = w.step++ * dt_;
  for (const Command& c : phases_[w.phase].commands) {
    if (t < c.at - kSoon) continue;
    const double aim = c.aim < 0 ? c.offset : static_cast<double>(obs[c.aim]) + c.offset;
    for (size_t k = 0; k < c.entries.size(); ++k) {
      float& value = w.value[static_cast<size_t>(c.entries[k])];
      if (c.follows) {
        double error = aim - static_cast<double>(obs[c.measured]);
        if (c.turns) error = std::remainder(error, 2 * kPi);
        value = static_cast<float>(std::clamp(c.gain * error, -c.limit, c.limit));
        continue;
      }
      float& from = w.from[c.memory + k];
      if (std::isnan(from)) from = value;
      const double share = c.over > 0 ? std::min(1.0, (t + dt_ - c.at) / c.over) : 1;
      value = from + static_cast<float>(share) * (c.values[k] - from);
    }
  }
  std::copy(w.value.begin(), w.value.end(), action);
}

void Demo::act(redman::Pool& pool, const uint8_t* mask) {
  for (size_t i = 0; i < worlds_.size(); ++i)
    if (!mask || mask[i]) run(worlds_[i], pool.obs()[i].begin(), pool.action()[i].begin());
}

}  // namespace tool
