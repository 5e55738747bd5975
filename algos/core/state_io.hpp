// One listing of an agent's state serves saving, checking and loading.
//
// A load first runs the listing with a checker, which throws on anything that is wrong, and only then with
// the copier, which cannot fail: a bad file changes nothing. Bounds are such that the next epochs on any
// numbers within them stay finite and overflow nothing: a checksum says that bytes are whole, not that a
// program wrote them.
#pragma once
#include <cstdint>
#include <cstring>

#include "algos/core/ranks.hpp"
#include "base/bytes.hpp"
#include "base/rng.hpp"

namespace rdm {

// The numbers of a list as a file has them, at any address; empty unless a load is being checked.
template <class T>
struct StateView {
  const unsigned char* bytes = nullptr;
  explicit operator bool() const { return bytes != nullptr; }
  T operator[](size_t i) const {
    T v;
    std::memcpy(&v, bytes + i * sizeof v, sizeof v);
    return v;
  }
};

// Bound on counters: far beyond any run, and no sum of two overflows.
inline constexpr int64_t kMaxCounter = int64_t{1} << 62;

class StateIo {
 public:
  virtual ~StateIo() = default;
  // Ends the section before it.
  virtual void section(const char tag[4]) = 0;
  // One that came later, and that a state may be without: false then. A writer writes it where it is `known`.
  virtual bool later_section(const char tag[4], bool known) = 0;
  virtual void end() = 0;
  // Finite numbers in [low, high].
  virtual StateView<float> numbers(float* x, size_t count, double low, double high) = 0;
  virtual StateView<double> numbers(double* x, size_t count, double low, double high) = 0;
  // Returns the value that is written or read.
  virtual int64_t integer(int64_t& x, int64_t low, int64_t high) = 0;
  // Each 0 or 1.
  virtual void flags(uint8_t* x, size_t count) = 0;
  // Any bytes are good.
  virtual void bytes(void* x, size_t count) = 0;
  // A condition on what a check has viewed; Error(kFormat) with the section where it does not hold.
  virtual void require(bool, const char*) const {}

  void integer(int32_t& x, int32_t low, int32_t high) {
    int64_t wide = x;
    integer(wide, low, high);
    x = static_cast<int32_t>(wide);
  }
  StateView<double> number(double& x, double low, double high) { return numbers(&x, 1, low, high); }
  // A count of what happened so far.
  void counter(int64_t& x) { integer(x, 0, kMaxCounter); }
  void stream(Stream& s) { bytes(&s, sizeof s); }

  // What each rank has of its own: a file has all of it in the order of ranks. So it is the file of one
  // process that has all worlds.
  virtual void share_bytes(void* x, size_t count) = 0;
  virtual void share(float* x, size_t count, double low, double high) = 0;
  virtual void share(double* x, size_t count, double low, double high) = 0;
  virtual void share_counters(int64_t* x, size_t count) = 0;
  virtual void share_flags(uint8_t* x, size_t count) = 0;
  void share(Stream* s, size_t count) { share_bytes(s, count * sizeof *s); }
};

class StateWriter final : public StateIo {
 public:
  // With more ranks than one all of them write, or all of them count.
  StateWriter(Writer& out, Ranks* ranks) : out_(out), ranks_(ranks) {}
  explicit StateWriter(Writer& out) : StateWriter(out, nullptr) {}
  using StateIo::integer;
  void section(const char tag[4]) override;
  bool later_section(const char tag[4], bool known) override;
  void end() override;
  StateView<float> numbers(float* x, size_t count, double, double) override {
    out_.bytes(x, count * sizeof *x);
    return {};
  }
  StateView<double> numbers(double* x, size_t count, double, double) override {
    out_.bytes(x, count * sizeof *x);
    return {};
  }
  int64_t integer(int64_t& x, int64_t, int64_t) override {
    out_.value(x);
    return x;
  }
  void flags(uint8_t* x, size_t count) override { out_.bytes(x, count); }
  void bytes(void* x, size_t count) override { out_.bytes(x, count); }
  void share_bytes(void* x, size_t count) override;
  void share(float* x, size_t count, double, double) override { share_bytes(x, count * sizeof *x); }
  void share(double* x, size_t count, double, double) override { share_bytes(x, count * sizeof *x); }
  void share_counters(int64_t* x, size_t count) override { share_bytes(x, count * sizeof *x); }
  void share_flags(uint8_t* x, size_t count) override { share_bytes(x, count); }

 private:
  Writer& out_;
  Ranks* ranks_;
  bool open_ = false;
};

// With `apply` false only checks. Of what ranks share, all is checked and one's own part is taken.
class StateReader final : public StateIo {
 public:
  StateReader(Reader& in, bool apply, int32_t rank = 0, int32_t ranks = 1)
      : in_(in), apply_(apply), rank_(rank), ranks_(ranks) {}
  using StateIo::integer;
  void section(const char tag[4]) override;
  bool later_section(const char tag[4], bool known) override;
  void end() override;
  // At the end of the listing: Error(kFormat) for a section that is not of it, nor a later one, whole.
  void end_listing();
  StateView<float> numbers(float* x, size_t count, double low, double high) override;
  StateView<double> numbers(double* x, size_t count, double low, double high) override;
  int64_t integer(int64_t& x, int64_t low, int64_t high) override;
  void flags(uint8_t* x, size_t count) override;
  void bytes(void* x, size_t count) override;
  void require(bool holds, const char* what) const override;
  void share_bytes(void* x, size_t count) override;
  void share(float* x, size_t count, double low, double high) override;
  void share(double* x, size_t count, double low, double high) override;
  void share_counters(int64_t* x, size_t count) override;
  void share_flags(uint8_t* x, size_t count) override;

 private:
  template <class T>
  StateView<T> read(T* x, size_t count, double low, double high);
  template <class Read>
  void each_part(Read&& read);
  Reader& in_;
  bool apply_;
  int32_t rank_, ranks_;
  char tag_[5] = "";
  char listed_[4 * 24 + 1] = "CONF";  // tags of all sections so far, and of the fingerprint
};

}  // namespace rdm
