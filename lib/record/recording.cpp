#include "record/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

void check_range(const char* name, int64_t value, int64_t low, int64_t high) {
  if (value < low || value > high)
    fail(Code::kRange, "%s: %lld is outside [%lld, %lld]", name, static_cast<long long>(value),
         static_cast<long long>(low), static_cast<long long>(high));
}

void check_finite(const char* name, const float* x, size_t rows, size_t width) {
  for (size_t i = 0; x && i < rows * width; ++i)
    if (!std::isfinite(x[i])) fail(Code::kArgument, "%s: row %zu is not finite", name, i / width);
}

void check_flags(const char* name, const uint8_t* x, size_t rows) {
  for (size_t i = 0; x && i < rows; ++i)
    if (x[i] > 1) fail(Code::kArgument, "%s: row %zu is %d, not 0 or 1", name, i, x[i]);
}

// Grows by halves, so that appending row by row copies each a few times at most.
template <class T>
void room(Vector<T>& v, size_t count) {
  if (count > v.capacity()) v.reserve(std::max(count, v.capacity() + v.capacity() / 2));
}

template <class T>
void add(Vector<T>& v, const T* from, size_t count, T otherwise = T{}) {
  if (from)
    v.insert(v.end(), from, from + count);
  else
    v.insert(v.end(), count, otherwise);
}

// Words of eight bytes: files are as long as memory, and a byte at a time is slow.
uint64_t hash_words(const void* data, size_t size, uint64_t hash) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (; size >= sizeof(uint64_t); p += sizeof(uint64_t), size -= sizeof(uint64_t)) {
    uint64_t word;
    std::memcpy(&word, p, sizeof word);
    hash = (hash ^ word) * 1099511628211ull;
    hash ^= hash >> 29;
  }
  return hash_bytes(p, size, hash);
}

// Whole millimetres within what 16 bits hold.
int16_t millimetres(float metres) {
  return static_cast<int16_t>(
      std::clamp(std::nearbyint(1000.0 * static_cast<double>(metres)), -32767.0, 32767.0));
}

float cut_unit(float v) {
  return std::clamp(v, -1.0f, 1.0f);
}

}  // namespace

Recording::Recording(const RecordingSpec& spec, int64_t capacity) : spec_(spec) {
  check_range("obs_dim", spec.obs_dim, 1, 16384);
  check_range("action_dim", spec.action_dim, 1, 1024);
  check_range("cost_dim", spec.cost_dim, 0, 16);
  check_range("state_bytes", static_cast<int64_t>(std::min<uint64_t>(spec.state_bytes, INT64_MAX)), 0,
              1 << 30);
  check_range("state_stride", spec.state_stride, 1, 1 << 30);
  check_range("num_points", spec.num_points, 0, kMaxRecordedPoints);
  check_range("capacity", capacity, 0, kMaxRecordingRows);
  const auto rows = static_cast<size_t>(capacity);
  if (rows) reserve(rows, spec.state_bytes ? rows / static_cast<size_t>(spec.state_stride) + 1 : 0);
}

void Recording::reserve(size_t rows, size_t states) {
  if (rows > static_cast<size_t>(kMaxRecordingRows))
    fail(Code::kRange, "rows: there are more than 2^%d", sizeof(size_t) == 8 ? 40 : 31);
  room(obs_, rows * obs_dim());
  room(action_, rows * action_dim());
  room(label_, rows * action_dim());
  room(reward_, rows);
  room(cost_, rows * cost_dim());
  room(terminated_, rows);
  room(truncated_, rows);
  room(success_, rows);
  room(episode_, rows);
  room(state_row_, states);
  room(state_, states * spec_.state_bytes);
  room(points_, rows * num_points() * 3);
  room(point_class_, rows * num_points());
  room(point_color_, rows * num_colors());
}

RecordingRows Recording::view() const {
  RecordingRows v;
  v.rows = rows();
  v.obs = obs_.data(), v.action = action_.data(), v.label = label_.data();
  v.reward = reward_.data(), v.cost = cost_.data();
  v.terminated = terminated_.data(), v.truncated = truncated_.data(), v.success = success_.data();
  v.episode = episode_.data();
  v.num_states = num_states();
  v.state_row = state_row_.data(), v.state = state_.data();
  if (spec_.num_points) v.points = points_.data(), v.point_class = point_class_.data();
  if (spec_.point_color) v.point_color = point_color_.data();
  return v;
}

uint64_t Recording::fingerprint() const {
  uint64_t h = hash_bytes(&spec_.obs_dim, sizeof spec_.obs_dim);
  h = hash_bytes(&spec_.action_dim, sizeof spec_.action_dim, h);
  h = hash_words(obs_.data(), obs_.size() * sizeof(float), h);
  h = hash_words(label_.data(), label_.size() * sizeof(float), h);
  if (!spec_.num_points) return h;
  h = hash_words(points_.data(), points_.size() * sizeof(int16_t), h);
  h = hash_words(point_class_.data(), point_class_.size(), h);
  return spec_.point_color ? hash_words(point_color_.data(), point_color_.size(), h) : h;
}

uint64_t Recording::state_fingerprint() const {
  return hash_words(state_.data(), state_.size(), kHashSeed);
}

namespace {

// Episodes are numbered by their first rows, so that no number stands for an episode without rows; rows of
// several may alternate, but none comes after the end of its own.
void check_episodes(const RecordingRows& in) {
  Vector<uint8_t> over;  // [episodes so far]
  for (int64_t i = 0; i < in.rows; ++i) {
    const int64_t e = in.episode[i], next = static_cast<int64_t>(over.size());
    if (e < 0 || e > next)
      fail(Code::kArgument,
           "episode: row %lld has %lld, but episodes are numbered by their first rows, and the next is %lld",
           static_cast<long long>(i), static_cast<long long>(e), static_cast<long long>(next));
    if (e == next) over.push_back(0);
    uint8_t& ended = over[static_cast<size_t>(e)];
    if (ended)
      fail(Code::kArgument, "episode: row %lld has %lld, but that episode has ended in an earlier row",
           static_cast<long long>(i), static_cast<long long>(e));
    ended = (in.terminated && in.terminated[i]) || (in.truncated && in.truncated[i]);
  }
}

}  // namespace

void Recording::check(const RecordingRows& in) const {
  check_range("rows", in.rows, 0, kMaxRecordingRows);
  check_range("num_states", in.num_states, 0, in.rows);
  const auto n = static_cast<size_t>(in.rows);
  if (n && !in.obs) fail(Code::kArgument, "obs is NULL");
  if (n && !in.action) fail(Code::kArgument, "action is NULL");
  if (n && spec_.num_points && !in.points) fail(Code::kArgument, "points is NULL");
  if (n && !spec_.num_points && in.points) fail(Code::kArgument, "points: this recording has none");
  if (n && spec_.point_color && !in.point_color) fail(Code::kArgument, "point_color is NULL");
  if (n && !spec_.point_color && in.point_color)
    fail(Code::kArgument, "point_color: this recording has none");
  if (n && !spec_.num_points && in.point_class)
    fail(Code::kArgument, "point_class: this recording has no clouds");
  if (n && cost_dim() == 0 && in.cost) fail(Code::kArgument, "cost: this recording has none");
  check_finite("obs", in.obs, n, obs_dim());
  check_finite("action", in.action, n, action_dim());
  check_finite("label", in.label, n, action_dim());
  check_finite("reward", in.reward, n, 1);
  check_finite("cost", in.cost, n, std::max<size_t>(cost_dim(), 1) * (cost_dim() > 0));
  check_flags("terminated", in.terminated, n);
  check_flags("truncated", in.truncated, n);
  check_flags("success", in.success, n);
  if (in.episode) check_episodes(in);
  if (in.num_states == 0) return;
  if (spec_.state_bytes == 0) fail(Code::kArgument, "num_states: this recording has no states");
  if (!in.state_row || !in.state) fail(Code::kArgument, "state_row or state is NULL");
  for (int64_t i = 0; i < in.num_states; ++i)
    if (in.state_row[i] < 0 || in.state_row[i] >= in.rows ||
        (i > 0 && in.state_row[i] <= in.state_row[i - 1]))
      fail(Code::kArgument, "state_row: entry %lld is not a row after the one before it",
           static_cast<long long>(i));
}

void Recording::append(const RecordingRows& in) {
  check(in);
  const auto n = static_cast<size_t>(in.rows), before = static_cast<size_t>(rows()),
             states = static_cast<size_t>(in.num_states);
  if (n == 0) return;
  reserve(before + n, state_row_.size() + states);
  int64_t episode = 0, last = 0;
  for (size_t i = 0; i < n; ++i) {
    if (in.episode) episode = in.episode[i];
    episode_.push_back(episodes_ + episode);
    last = std::max(last, episode);
    if ((in.terminated && in.terminated[i]) || (in.truncated && in.truncated[i])) ++episode;
  }
  add(obs_, in.obs, n * obs_dim());
  add(action_, in.action, n * action_dim());
  add(label_, in.label ? in.label : in.action, n * action_dim());
  for (auto* v : {&action_, &label_})
    for (size_t k = before * action_dim(); k < v->size(); ++k) (*v)[k] = cut_unit((*v)[k]);
  add(reward_, in.reward, n);
  add(cost_, in.cost, n * cost_dim());
  add(terminated_, in.terminated, n);
  add(truncated_, in.truncated, n);
  add(success_, in.success, n);
  add(points_, in.points, n * num_points() * 3);
  add(point_class_, in.point_class, n * num_points());
  add(point_color_, in.point_color, n * num_colors());
  for (size_t i = 0; i < states; ++i) state_row_.push_back(static_cast<int64_t>(before) + in.state_row[i]);
  if (states) add(state_, in.state, states * spec_.state_bytes);
  episodes_ += last + 1;
}

void Recording::append_all(const Recording& other) {
  const RecordingSpec& o = other.spec_;
  if (&other == this) fail(Code::kArgument, "other: it is the recording itself");
  if (o.obs_dim != spec_.obs_dim || o.action_dim != spec_.action_dim || o.cost_dim != spec_.cost_dim)
    fail(Code::kArgument,
         "other: its rows have %d observations, %d actions and %d costs, but these have %d, %d and %d",
         o.obs_dim, o.action_dim, o.cost_dim, spec_.obs_dim, spec_.action_dim, spec_.cost_dim);
  if (o.num_points != spec_.num_points)
    fail(Code::kArgument, "other: its clouds have %d points, but these have %d", o.num_points,
         spec_.num_points);
  if (o.point_color != spec_.point_color)
    fail(Code::kArgument, "other: one of the two recordings has no colours");
  if (o.layout_hash != spec_.layout_hash) fail(Code::kArgument, "other: it has another layout");
  if (other.num_states() > 0 && o.state_bytes != spec_.state_bytes)
    fail(Code::kArgument, "other: its states have %zu bytes, but these have %zu", o.state_bytes,
         spec_.state_bytes);
  append(other.view());
}

void Recording::copy_row(size_t from, size_t to) {
  const auto move = [&](auto& v, size_t width) {
    if (from != to && width)
      std::copy_n(v.begin() + static_cast<ptrdiff_t>(from * width), width,
                  v.begin() + static_cast<ptrdiff_t>(to * width));
  };
  move(obs_, obs_dim());
  move(action_, action_dim());
  move(label_, action_dim());
  move(reward_, 1);
  move(cost_, cost_dim());
  move(terminated_, 1);
  move(truncated_, 1);
  move(success_, 1);
  move(episode_, 1);
  move(points_, num_points() * 3);
  move(point_class_, num_points());
  move(point_color_, num_colors());
}

void Recording::cut(size_t rows, size_t states) {
  obs_.resize(rows * obs_dim());
  action_.resize(rows * action_dim());
  label_.resize(rows * action_dim());
  reward_.resize(rows);
  cost_.resize(rows * cost_dim());
  terminated_.resize(rows);
  truncated_.resize(rows);
  success_.resize(rows);
  episode_.resize(rows);
  state_row_.resize(states);
  state_.resize(states * spec_.state_bytes);
  points_.resize(rows * num_points() * 3);
  point_class_.resize(rows * num_points());
  point_color_.resize(rows * num_colors());
}

int64_t Recording::filter(bool need_success, const double* max_cost) {
  const auto count = static_cast<size_t>(episodes_), n = static_cast<size_t>(rows());
  Vector<uint8_t> good(count);
  Vector<double> cost(count * cost_dim());
  for (size_t i = 0; i < n; ++i) {
    const auto e = static_cast<size_t>(episode_[i]);
    good[e] |= success_[i];
    for (size_t k = 0; k < cost_dim(); ++k)
      cost[e * cost_dim() + k] += static_cast<double>(cost_[i * cost_dim() + k]);
  }
  Vector<int64_t> number(count);  // of an episode that stays, else -1
  int64_t kept = 0;
  for (size_t e = 0; e < count; ++e) {
    bool stays = !need_success || good[e];
    for (size_t k = 0; max_cost && k < cost_dim(); ++k)
      stays = stays && !(max_cost[k] >= 0 && cost[e * cost_dim() + k] > max_cost[k]);
    number[e] = stays ? kept++ : -1;
  }
  size_t to = 0, state = 0, states = 0;
  for (size_t i = 0; i < n; ++i) {
    const bool has_state = state < state_row_.size() && state_row_[state] == static_cast<int64_t>(i);
    const int64_t own = number[static_cast<size_t>(episode_[i])];
    if (own >= 0) {
      copy_row(i, to);
      episode_[to] = own;
      if (has_state) {
        std::memmove(state_.data() + states * spec_.state_bytes, state_.data() + state * spec_.state_bytes,
                     spec_.state_bytes);
        state_row_[states++] = static_cast<int64_t>(to);
      }
      ++to;
    }
    state += has_state;
  }
  cut(to, states);
  const int64_t dropped = episodes_ - kept;
  episodes_ = kept;
  source_ = nullptr;
  return dropped;
}

void Recording::clear() {
  cut(0, 0);
  episodes_ = 0;
  source_ = nullptr;
}

void Recording::make_room(const void* source, int32_t worlds) {
  const auto n = static_cast<size_t>(worlds);
  reserve(static_cast<size_t>(rows()) + n, spec_.state_bytes ? state_row_.size() + n : 0);
  if (source_ == source && open_.size() == n) return;
  open_.assign(n, Open());
  source_ = source;
}

void Recording::begin_row(int32_t world, const float* obs, const float* action, const float* label,
                          const float* points, const uint8_t* point_class, const uint8_t* point_color) {
  Open& o = open_[static_cast<size_t>(world)];
  if (o.episode < 0) o.episode = episodes_++, o.count = 0;
  o.row = rows();
  ++o.count;
  add(obs_, obs, obs_dim());
  for (size_t j = 0; j < action_dim(); ++j) action_.push_back(cut_unit(action[j]));
  for (size_t j = 0; j < action_dim(); ++j) label_.push_back(cut_unit(label ? label[j] : action[j]));
  reward_.push_back(0);
  add<float>(cost_, nullptr, cost_dim());
  terminated_.push_back(0);
  truncated_.push_back(0);
  success_.push_back(0);
  episode_.push_back(o.episode);
  for (size_t j = 0; j < 3 * num_points(); ++j) points_.push_back(millimetres(points[j]));
  add(point_class_, point_class, num_points());
  add(point_color_, point_color, num_colors());
}

bool Recording::state_due(int32_t world) const {
  return spec_.state_bytes > 0 && (open_[static_cast<size_t>(world)].count - 1) % spec_.state_stride == 0;
}

unsigned char* Recording::add_state(int32_t world) {
  state_row_.push_back(open_[static_cast<size_t>(world)].row);
  state_.resize(state_.size() + spec_.state_bytes);
  return state_.data() + state_.size() - spec_.state_bytes;
}

void Recording::end_row(int32_t world, float reward, const float* cost, bool terminated, bool truncated,
                        bool success) {
  Open& o = open_[static_cast<size_t>(world)];
  if (o.row < 0) return;
  const auto at = static_cast<size_t>(o.row);
  reward_[at] += reward;
  for (size_t k = 0; k < cost_dim(); ++k) cost_[at * cost_dim() + k] += cost[k];
  terminated_[at] |= terminated;
  truncated_[at] |= truncated;
  success_[at] |= success;
  if (terminated || truncated) o = Open();
}

}  // namespace rdm
