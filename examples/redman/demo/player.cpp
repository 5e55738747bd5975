#include "demo/player.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr double kSoon = 1e-6;  // s
constexpr double kPi = 3.14159265358979323846;

// The hands of a pool in the order of its action row.
std::vector<DemoHand> hands_of(const redman::Pool& pool) {
  const Options settings = read_settings(pool.settings());
  bool two = false;
  for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    redman::check(rdm_pool_field_at(pool.get(), i, &f));
    two = two || std::string(f.name).rfind("left.", 0) == 0;
  }
  std::vector<DemoHand> out;
  out.emplace_back(pool, settings, 0, 0);
  if (two) out.emplace_back(pool, settings, 1, out[0].entries().size());
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
    rdm_field_info f = RDM_INIT(rdm_field_info);
    redman::check(rdm_pool_field_at(pool.get(), i, &f));
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
  if (at < 0) bad(script, line, "the observation has no " + word);
  return at;
}

}  // namespace

Demo::Demo(const DemoScript& script, redman::Pool& pool)
    : file_(script.file),
      dt_(static_cast<double>(pool.spec().control_dt)),
      hands_(hands_of(pool)),
      worlds_(pool.num_envs()) {
  std::vector<DemoHand::Entry> entries;
  for (const DemoHand& hand : hands_)
    entries.insert(entries.end(), hand.entries().begin(), hand.entries().end());
  entries.resize(std::min(entries.size(), pool.action().width()));
  for (const DemoScript::Phase& p : script.phases) {
    Phase phase{p.seconds, {}, {}, {}};
    for (const DemoScript::Condition& c : p.until)
      phase.until.push_back(
          {need_field(script, c.line, pool, c.field), c.below, static_cast<float>(c.value)});
    for (const DemoScript::Command& c : p.commands) {
      Command out{{}, {}, c.follows, c.at, c.over, c.gain, c.limit, c.value, -1, -1, memory_};
      for (size_t k = 0; k < entries.size(); ++k) {
        const std::vector<std::string>& names = entries[k].names;
        if (std::none_of(names.begin(), names.end(),
                         [&](const std::string& name) { return matches(c.entry, name); }))
          continue;
        double v = c.value;
        if (c.degrees) {
          const double lower = entries[k].lower, upper = entries[k].upper;
          if (!(upper > lower)) bad(script, c.line, names[0] + " is not an angle, so it takes no degrees");
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
    for (const DemoScript::Motion& m : p.motions) {
      Motion out{m.left ? 1u : 0u, -1, {}, m.turned, m.at, m.over, motions_++, m.line};
      const char* side = m.left ? "left" : "right";
      if (out.hand >= hands_.size()) bad(script, m.line, std::string("the task has no hand on the ") + side);
      const DemoHand& hand = hands_[out.hand];
      out.finger = hand.point(m.point);
      if (out.finger < -1) bad(script, m.line, std::string("the ") + side + " hand has no " + m.point);
      if (!hand.hindrance().empty())
        bad(script, m.line,
            std::string("the ") + side + " hand cannot be moved to a place: " + hand.hindrance());
      std::copy_n(m.p, 3, out.to.p);
      double turn[3];
      for (int k = 0; k < 3; ++k) turn[k] = m.turn[k] * kPi / 180;
      turn_of(turn, out.to.q);
      phase.motions.push_back(out);
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
    worlds_[i].starts.assign(motions_, {});
    worlds_[i].started.assign(motions_, 0);
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
  for (const Motion& m : phases_[w.phase].motions) move(w, t, m);
  std::copy(w.value.begin(), w.value.end(), action);
}

// Slowly at both ends of its time.
void Demo::move(World& w, double t, const Motion& m) const {
  if (t < m.at - kSoon) return;
  const DemoHand& hand = hands_[m.hand];
  if (!w.started[m.memory]) {
    w.started[m.memory] = 1;
    w.starts[m.memory] = hand.place(w.value.data(), m.finger);
  }
  const double u = m.over > 0 ? std::min(1.0, (t + dt_ - m.at) / m.over) : 1;
  Place to = m.to;
  if (!m.turned) std::copy_n(w.starts[m.memory].q, 4, to.q);
  if (!hand.reach(between(w.starts[m.memory], to, u * u * (3 - 2 * u)), m.finger, w.value.data()))
    throw Failure(format("demo %s, line %d: the arm does not reach that far", file_.c_str(), m.line));
}

void Demo::act(redman::Pool& pool, const uint8_t* mask) {
  for (size_t i = 0; i < worlds_.size(); ++i)
    if (!mask || mask[i]) run(worlds_[i], pool.obs()[i].begin(), pool.action()[i].begin());
}

}  // namespace tool
