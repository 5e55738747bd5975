#include "algos/core/state_io.hpp"

#include <cmath>
#include <cstring>

#include "base/error.hpp"

namespace rdm {

void StateWriter::section(const char tag[4]) {
  end();
  out_.begin_section(tag);
  open_ = true;
}

bool StateWriter::later_section(const char tag[4], bool known) {
  end();
  if (!known) return false;
  out_.begin_later_section(tag);
  return open_ = true;
}

void StateWriter::end() {
  if (open_) out_.end_section();
  open_ = false;
}

void StateWriter::share_bytes(void* x, size_t count) {
  if (!ranks_ || ranks_->alone()) return out_.bytes(x, count);
  const auto ranks = static_cast<size_t>(ranks_->count());
  for (size_t r = 0; out_.counts() && r < ranks; ++r) out_.bytes(x, count);
  if (out_.counts()) return;
  Vector<unsigned char> all(ranks * count);
  ranks_->gather(x, count, all.data());
  out_.bytes(all.data(), all.size());
}

void StateReader::section(const char tag[4]) {
  end();
  in_.need_section(tag);
  std::memcpy(tag_, tag, 4);
  const size_t n = std::strlen(listed_);
  if (n + 4 >= sizeof listed_) fail(Code::kInternal, "agent state: it has more sections than are listed");
  std::memcpy(listed_ + n, tag, 4);
}

bool StateReader::later_section(const char tag[4], bool) {
  end();
  if (!in_.find_later_section(tag)) return false;
  std::memcpy(tag_, tag, 4);
  return true;
}

void StateReader::end_listing() {
  end();
  in_.need_whole_tags(listed_);
}

void StateReader::end() {
  if (*tag_) in_.expect_end();
  *tag_ = '\0';
}

template <class T>
StateView<T> StateReader::read(T* x, size_t count, double low, double high) {
  const StateView<T> view{in_.view(count * sizeof(T))};
  if (apply_) {
    if (count) std::memcpy(x, view.bytes, count * sizeof(T));
    return {};
  }
  for (size_t i = 0; i < count; ++i) {
    const auto d = static_cast<double>(view[i]);
    if (!(d >= low && d <= high))
      fail(Code::kFormat, "agent state: section %s holds %g, which is outside [%g, %g]", tag_, d, low, high);
  }
  return view;
}

StateView<float> StateReader::numbers(float* x, size_t count, double low, double high) {
  return read(x, count, low, high);
}
StateView<double> StateReader::numbers(double* x, size_t count, double low, double high) {
  return read(x, count, low, high);
}

int64_t StateReader::integer(int64_t& x, int64_t low, int64_t high) {
  const auto v = in_.value<int64_t>();
  if (v < low || v > high)
    fail(Code::kFormat, "agent state: section %s holds %lld, which is outside [%lld, %lld]", tag_,
         static_cast<long long>(v), static_cast<long long>(low), static_cast<long long>(high));
  if (apply_) x = v;
  return v;
}

void StateReader::flags(uint8_t* x, size_t count) {
  const unsigned char* p = in_.view(count);
  if (apply_ && count) std::memcpy(x, p, count);
  for (size_t i = 0; i < count; ++i) require(p[i] <= 1, "a flag that is not 0 or 1");
}

// Others' parts are only looked at.
template <class Read>
void StateReader::each_part(Read&& read) {
  const bool apply = apply_;
  for (int32_t r = 0; r < ranks_; ++r) {
    apply_ = apply && r == rank_;
    read();
  }
  apply_ = apply;
}

void StateReader::share_bytes(void* x, size_t count) {
  each_part([&] { bytes(x, count); });
}
void StateReader::share(float* x, size_t count, double low, double high) {
  each_part([&] { read(x, count, low, high); });
}
void StateReader::share(double* x, size_t count, double low, double high) {
  each_part([&] { read(x, count, low, high); });
}
void StateReader::share_flags(uint8_t* x, size_t count) {
  each_part([&] { flags(x, count); });
}
void StateReader::share_counters(int64_t* x, size_t count) {
  each_part([&] {
    for (size_t i = 0; i < count; ++i) counter(x[i]);
  });
}

void StateReader::require(bool holds, const char* what) const {
  if (!holds) fail(Code::kFormat, "agent state: section %s holds %s", tag_, what);
}

void StateReader::bytes(void* x, size_t count) {
  const unsigned char* p = in_.view(count);
  if (apply_ && count) std::memcpy(x, p, count);
}

}  // namespace rdm
