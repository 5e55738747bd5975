// One listing of an agent's state serves saving, checking and loading.
//
// A load first runs the listing with a checker, which throws on anything that is wrong, and only then with
// the copier, which cannot fail: a bad file changes nothing.
#pragma once
#include <cstdint>

#include "base/bytes.hpp"
#include "base/rng.hpp"

namespace rdm {

class StateIo {
 public:
  virtual ~StateIo() = default;
  // Ends the section before it.
  virtual void section(const char tag[4]) = 0;
  virtual void end() = 0;
  // Finite numbers in [low, high].
  virtual void numbers(float* x, size_t count, double low, double high) = 0;
  virtual void numbers(double* x, size_t count, double low, double high) = 0;
  virtual void integer(int64_t& x, int64_t low, int64_t high) = 0;
  virtual void bytes(void* x, size_t count) = 0;

  void integer(int32_t& x, int32_t low, int32_t high) {
    int64_t wide = x;
    integer(wide, low, high);
    x = static_cast<int32_t>(wide);
  }
  void number(double& x, double low, double high) { numbers(&x, 1, low, high); }
  void stream(Stream& s) { bytes(&s, sizeof s); }
};

class StateWriter final : public StateIo {
 public:
  explicit StateWriter(Writer& out) : out_(out) {}
  using StateIo::integer;
  void section(const char tag[4]) override;
  void end() override;
  void numbers(float* x, size_t count, double, double) override { out_.bytes(x, count * sizeof *x); }
  void numbers(double* x, size_t count, double, double) override { out_.bytes(x, count * sizeof *x); }
  void integer(int64_t& x, int64_t, int64_t) override { out_.value(x); }
  void bytes(void* x, size_t count) override { out_.bytes(x, count); }

 private:
  Writer& out_;
  bool open_ = false;
};

// With `apply` false only checks.
class StateReader final : public StateIo {
 public:
  StateReader(Reader& in, bool apply) : in_(in), apply_(apply) {}
  using StateIo::integer;
  void section(const char tag[4]) override;
  void end() override;
  void numbers(float* x, size_t count, double low, double high) override;
  void numbers(double* x, size_t count, double low, double high) override;
  void integer(int64_t& x, int64_t low, int64_t high) override;
  void bytes(void* x, size_t count) override;

 private:
  template <class T>
  void read(T* x, size_t count, double low, double high);
  Reader& in_;
  bool apply_;
  char tag_[5] = "";
};

}  // namespace rdm
