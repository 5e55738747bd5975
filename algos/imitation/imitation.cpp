#include "algos/imitation/imitation.hpp"

#include "base/elementary.hpp"

namespace rdm {

void Imitation::open(const ResolvedAgentConfig& resolved, const Regression& regression) {
  resolved_ = &resolved;
  regression_ = &regression;
  stream_ = Stream(resolved.config.seed, 0, Purpose::kImitation);
}

void Imitation::set(const DemoRows& demo, uint64_t mark, const HostHooks& hooks) {
  const HostScope scope(hooks);
  const auto n = static_cast<size_t>(demo.rows);
  Vector<float> obs(demo.obs, demo.obs + n * resolved_->obs_dim());
  Vector<float> label(demo.label, demo.label + n * resolved_->action_dim());
  Vector<int32_t> order(n ? static_cast<size_t>(resolved_->all_samples()) : 0);
  DemoMemory memory;
  memory.open(*resolved_, demo);
  const size_t count = n * static_cast<size_t>(resolved_->eyes.points);
  const PointRows& clouds = demo.clouds;
  Vector<int16_t> points(clouds.points, clouds.points + (clouds.points ? 3 * count : 0));
  Vector<uint8_t> classes(clouds.classes, clouds.classes + (clouds.classes ? count : 0));
  Vector<uint8_t> colors(clouds.colors, clouds.colors + (clouds.colors ? 3 * count : 0));
  points_ = std::move(points), classes_ = std::move(classes), colors_ = std::move(colors);
  obs_ = std::move(obs), label_ = std::move(label), order_ = std::move(order);
  memory_ = std::move(memory);
  demo_ = {demo.rows, obs_.data(), label_.data(), nullptr, {}};
  demo_.clouds.points = points_.empty() ? nullptr : points_.data();
  demo_.clouds.classes = classes_.empty() ? nullptr : classes_.data();
  demo_.clouds.colors = colors_.empty() ? nullptr : colors_.data();
  memory_.attach(demo_);
  mark_ = n ? mark : 0;
  items_ = rows_ = 0;
}

void Imitation::begin_epoch(int32_t done) {
  const SharedOptions& o = resolved_->shared;
  weight_ = has_rows() ? o.imitation * elementary::pow(o.imitation_decay, done) : 0;
  items_ = rows_ = 0;
}

Job Imitation::remember() {
  group_ = 0;
  return weight_ > 0 && demo_.memory ? Job::of<&Imitation::advance_memory>(this) : Job();
}

void Imitation::draw(int32_t rows) {
  if (!(weight_ > 0)) return;
  const int32_t wanted = std::min({rows, demo_.rows, resolved_->all_samples()});
  const auto count = static_cast<uint32_t>(demo_.items());
  for (items_ = rows_ = 0; rows_ < wanted; ++items_) {
    const auto item = static_cast<int32_t>(stream_.below(count));
    order_[static_cast<size_t>(items_)] = item;
    rows_ += demo_.rows_of(item);
  }
}

Job Imitation::begin(float* grad) {
  fit_ = {&demo_, order_.data(), items_, rows_, true, weight_, grad, true};
  return Job::of<&Imitation::advance>(this);
}

void Imitation::visit(StateIo& io) {
  io.section("IMIT");
  auto mark = static_cast<int64_t>(mark_);
  const int64_t there = io.integer(mark, INT64_MIN, INT64_MAX);
  io.require(there == static_cast<int64_t>(mark_),
             mark_ ? "the hash of another recording than the agent's"
                   : "the hash of a recording; call rdm_agent_set_recording first");
  io.stream(stream_);
}

}  // namespace rdm
