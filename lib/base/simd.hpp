// Simd<S, N>: N numbers of type S that go through the same arithmetic, one instruction for all.
//
// Only + - * / and square roots, each rounded as IEEE 754 says, with contraction off: a lane's bits depend
// neither on N nor on the instruction set. Part of stepper_v*.cpp, included after every header with code.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace rdm {
namespace {

template <class S, int N>
struct Simd {
  static_assert(N == 4 || N == 8);
  using Scalar = S;
  static constexpr int kCount = N;
  typedef S V __attribute__((vector_size(sizeof(S) * N)));
  typedef std::conditional_t<sizeof(S) == 4, int32_t, int64_t> Mask
      __attribute__((vector_size(sizeof(S) * N)));

  [[gnu::always_inline]] static V all(S s) { return V{} + s; }
  [[gnu::always_inline]] static V select(Mask m, const V& yes, const V& no) { return m ? yes : no; }
  [[gnu::always_inline]] static S get(const V& v, int lane) { return v[lane]; }
  [[gnu::always_inline]] static void set(V* v, int lane, S s) { (*v)[lane] = s; }
  [[gnu::always_inline]] static Mask nothing() { return Mask{}; }
  // Lane l of the mask from bit l.
  [[gnu::always_inline]] static Mask mask(uint32_t bits) {
    Mask m{};
    for (int l = 0; l < N; ++l) m[l] = bits >> l & 1 ? -1 : 0;
    return m;
  }
  [[gnu::always_inline]] static uint32_t bits(const Mask& m) {
#if defined(__x86_64__)
    if constexpr (sizeof(S) == 4) {
      __m128 part[N / 4];
      std::memcpy(part, &m, sizeof m);
      uint32_t b = static_cast<uint32_t>(_mm_movemask_ps(part[0]));
      if constexpr (N == 8) b |= static_cast<uint32_t>(_mm_movemask_ps(part[1])) << 4;
      return b;
    }
#endif
    uint32_t b = 0;
    for (int l = 0; l < N; ++l) b |= static_cast<uint32_t>(m[l] != 0) << l;
    return b;
  }
  [[gnu::always_inline]] static V root(const V& v) {
#if defined(__x86_64__)
    if constexpr (sizeof(S) == 4) {
      __m128 part[N / 4];
      std::memcpy(part, &v, sizeof v);
      for (__m128& p : part) p = _mm_sqrt_ps(p);
      V r;
      std::memcpy(&r, part, sizeof r);
      return r;
    }
#endif
    V r;
    for (int l = 0; l < N; ++l) r[l] = std::sqrt(v[l]);
    return r;
  }
  // to[i] lane l = from[l][i], for i in [0, count).
  [[gnu::always_inline]] static void gather(const S* const* from, int count, V* to) {
    int i = 0;
#if defined(__x86_64__)
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < N; half += 4) {
          __m128 r[4];
          for (int l = 0; l < 4; ++l) r[l] = _mm_loadu_ps(from[half + l] + i);
          _MM_TRANSPOSE4_PS(r[0], r[1], r[2], r[3]);
          for (int k = 0; k < 4; ++k)
            std::memcpy(reinterpret_cast<S*>(&to[i + k]) + half, &r[k], sizeof r[k]);
        }
#endif
    for (; i < count; ++i)
      for (int l = 0; l < N; ++l) to[i][l] = from[l][i];
  }
  // to[l][i] = from[i] lane l, of the first `lanes` lanes.
  [[gnu::always_inline]] static void scatter(const V* from, int count, int lanes, S* const* to) {
    int i = 0;
#if defined(__x86_64__)
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < lanes; half += 4) {
          __m128 r[4];
          for (int k = 0; k < 4; ++k)
            std::memcpy(&r[k], reinterpret_cast<const S*>(&from[i + k]) + half, sizeof r[k]);
          _MM_TRANSPOSE4_PS(r[0], r[1], r[2], r[3]);
          for (int l = 0; l < 4 && half + l < lanes; ++l) _mm_storeu_ps(to[half + l] + i, r[l]);
        }
#endif
    for (; i < count; ++i)
      for (int l = 0; l < lanes; ++l) to[l][i] = from[i][l];
  }
};

template <class S>
struct Simd<S, 1> {
  using Scalar = S;
  static constexpr int kCount = 1;
  using V = S;
  using Mask = bool;
  [[gnu::always_inline]] static V all(S s) { return s; }
  [[gnu::always_inline]] static V select(Mask m, V yes, V no) { return m ? yes : no; }
  [[gnu::always_inline]] static S get(V v, int) { return v; }
  [[gnu::always_inline]] static void set(V* v, int, S s) { *v = s; }
  [[gnu::always_inline]] static Mask nothing() { return false; }
  [[gnu::always_inline]] static Mask mask(uint32_t bits) { return bits & 1; }
  [[gnu::always_inline]] static uint32_t bits(Mask m) { return m; }
  [[gnu::always_inline]] static V root(V v) { return std::sqrt(v); }
  [[gnu::always_inline]] static void gather(const S* const* from, int count, V* to) {
    std::memcpy(to, from[0], sizeof(S) * static_cast<size_t>(count));
  }
  [[gnu::always_inline]] static void scatter(const V* from, int count, int, S* const* to) {
    std::memcpy(to[0], from, sizeof(S) * static_cast<size_t>(count));
  }
};

// Sine and cosine of x: the quarter angle's series, doubled twice. Error below 5e-7 in float and 1e-15 in
// double for |x| <= 100; beyond, as coarse as the reduction by two pi.
template <class L>
[[gnu::always_inline]] inline void sine_cosine(typename L::V x, typename L::V* sine, typename L::V* cosine) {
  using S = typename L::Scalar;
  using V = typename L::V;
  constexpr bool kFloat = sizeof(S) == 4;
  constexpr S kRound = kFloat ? S(12582912.0) : S(6755399441055744.0);  // 1.5 * 2^(digits - 1)
  // two pi in two parts, so that whole turns leave small angles exact
  constexpr S kHigh = kFloat ? S(6.28125) : S(6.2831852436065673828125),
              kLow = S(6.283185307179586476925287 - (kFloat ? 6.28125 : 6.2831852436065673828125));
  const V turns = (x * S(0.15915494309189533577) + kRound) - kRound;
  x = (x - turns * kHigh) - turns * kLow;
  const V y = x * S(0.25), z = y * y;
  V s, c;
  if constexpr (kFloat) {
    s = y * (S(1) + z * (S(-1. / 6) + z * (S(1. / 120) + z * (S(-1. / 5040) + z * S(1. / 362880)))));
    c = S(1) + z * (S(-0.5) + z * (S(1. / 24) + z * (S(-1. / 720) + z * S(1. / 40320))));
  } else {
    s = y * (S(1) +
             z * (S(-1. / 6) +
                  z * (S(1. / 120) + z * (S(-1. / 5040) +
                                          z * (S(1. / 362880) + z * (S(-1. / 39916800) +
                                                                     z * (S(1. / 6227020800.) +
                                                                          z * S(-1. / 1307674368000.))))))));
    c = S(1) +
        z * (S(-0.5) +
             z * (S(1. / 24) +
                  z * (S(-1. / 720) + z * (S(1. / 40320) + z * (S(-1. / 3628800) +
                                                                z * (S(1. / 479001600) +
                                                                     z * (S(-1. / 87178291200.) +
                                                                          z * S(1. / 20922789888000.))))))));
  }
  for (int k = 0; k < 2; ++k) {
    const V twice = S(2) * s * c;
    c = S(1) - S(2) * s * s;
    s = twice;
  }
  *sine = s;
  *cosine = c;
}

}  // namespace
}  // namespace rdm
