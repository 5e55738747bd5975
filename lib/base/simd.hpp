// Vectors of the compiler (GCC's and clang's vector_size) under one roof: Float4, and Simd<S, N> for any
// width.
//
// Only + - * / and square roots, each rounded as IEEE 754 says, with contraction off: a lane's bits depend
// neither on N nor on the instruction set. The kernels of lib/nn for AVX2 and AVX-512 (nn/kernels_v3.cpp,
// _v4) have vectors of their own: their fused multiply-add has other bits, and that is what they are for.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__x86_64__)
#include <emmintrin.h>  // what AVX adds takes a compiler as long as most files: whoever needs it includes it
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

namespace rdm {

// Four floats, for code that is compiled for one instruction set alone.
inline constexpr int kFloat4Lanes = 4;
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));  // as a mask -1: true, 0: false
using Double4 = double __attribute__((vector_size(32)));

[[gnu::always_inline]] inline Float4 splat(float v) {
  return Float4{v, v, v, v};
}
[[gnu::always_inline]] inline Int4 splat_int(int32_t v) {
  return Int4{v, v, v, v};
}
[[gnu::always_inline]] inline Float4 load4(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
[[gnu::always_inline]] inline void store4(float* p, Float4 v) {
  std::memcpy(p, &v, sizeof v);
}
// Four doubles, rounded, and back.
[[gnu::always_inline]] inline Float4 rounded4(const double* p) {
  Double4 v;
  std::memcpy(&v, p, sizeof v);
  return __builtin_convertvector(v, Float4);
}
[[gnu::always_inline]] inline void widen4(Float4 v, double* p) {
  const Double4 wide = __builtin_convertvector(v, Double4);
  std::memcpy(p, &wide, sizeof wide);
}
[[gnu::always_inline]] inline Float4 select(Int4 m, Float4 a, Float4 b) {
  return m ? a : b;
}
[[gnu::always_inline]] inline Int4 select(Int4 m, Int4 a, Int4 b) {
  return m ? a : b;
}
// Of two operands with a not-a-number, the second is given.
[[gnu::always_inline]] inline Float4 min(Float4 a, Float4 b) {
#if defined(__x86_64__)
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}
[[gnu::always_inline]] inline Float4 max(Float4 a, Float4 b) {
#if defined(__x86_64__)
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}
[[gnu::always_inline]] inline Float4 clamp(Float4 v, float lo, float hi) {
  return min(max(v, splat(lo)), splat(hi));
}
[[gnu::always_inline]] inline Float4 abs(Float4 v) {
  return max(v, -v);
}
[[gnu::always_inline]] inline Float4 sqrt(Float4 v) {
#if defined(__x86_64__)
  return _mm_sqrt_ps(v);
#elif defined(__wasm_simd128__)
  return (Float4)wasm_f32x4_sqrt((v128_t)v);
#else
  return Float4{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
#endif
}
// Lane l's truth in bit l.
[[gnu::always_inline]] inline uint32_t bits_of(Int4 m) {
#if defined(__x86_64__)
  __m128 r;
  std::memcpy(&r, &m, sizeof r);
  return static_cast<uint32_t>(_mm_movemask_ps(r));
#elif defined(__wasm_simd128__)
  return wasm_i32x4_bitmask((v128_t)m);
#else
  uint32_t bits = 0;
  for (int k = 0; k < kFloat4Lanes; ++k) bits |= static_cast<uint32_t>(m[k] != 0) << k;
  return bits;
#endif
}
[[gnu::always_inline]] inline bool any(Int4 m) {
  return bits_of(m) != 0;
}
[[gnu::always_inline]] inline float largest(Float4 v) {
  const float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
  return a > b ? a : b;
}
// Four rows into four columns.
[[gnu::always_inline]] inline void transpose(Float4 (&r)[4]) {
  const Float4 a = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
               b = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7);
  const Float4 c = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
               d = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
  r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  r[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

[[gnu::always_inline]] inline void transpose(Double4 (&r)[4]) {
  const Double4 a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6),
                b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const Double4 c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6),
                d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

// N numbers of type S, for code that is compiled once per instruction set: in an unnamed namespace, so that
// no linker joins two sets' copies. Such a source includes this header after every other one with code, and
// one for AVX defines RDM_SIMD_AVX before, one for AVX-512 RDM_SIMD_AVX512 too: compilers do not tell what a
// pragma or an attribute has switched on.
namespace {

template <class S, int N>
struct Simd {
  static_assert(N == 4 || N == 8 || N == 16);
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
#if defined(RDM_SIMD_AVX512)
    if constexpr (sizeof(S) == 4 && N == 16) {
      __m512i all;
      std::memcpy(&all, &m, sizeof all);
      return static_cast<uint32_t>(_mm512_movepi32_mask(all));
    }
#endif
#if defined(RDM_SIMD_AVX)
    if constexpr (sizeof(S) == 4 && N == 8) {
      __m256 all;
      std::memcpy(&all, &m, sizeof all);
      return static_cast<uint32_t>(_mm256_movemask_ps(all));
    }
#endif
    if constexpr (sizeof(S) == 4) {
      Int4 part[N / 4];
      std::memcpy(part, &m, sizeof m);
      uint32_t b = 0;
      for (int k = 0; k < N / 4; ++k) b |= bits_of(part[k]) << 4 * k;
      return b;
    }
    uint32_t b = 0;
    for (int l = 0; l < N; ++l) b |= static_cast<uint32_t>(m[l] != 0) << l;
    return b;
  }
  [[gnu::always_inline]] static V root(const V& v) {
#if defined(RDM_SIMD_AVX512)
    if constexpr (sizeof(S) == 4 && N == 16) {
      __m512 all;
      std::memcpy(&all, &v, sizeof all);
      // unmasked, GCC 12 warns of its own header
      all = _mm512_maskz_sqrt_ps(0xffff, all);
      V r;
      std::memcpy(&r, &all, sizeof r);
      return r;
    }
#endif
#if defined(RDM_SIMD_AVX)
    if constexpr (sizeof(S) == 4 && N == 8) {
      __m256 all;
      std::memcpy(&all, &v, sizeof all);
      all = _mm256_sqrt_ps(all);
      V r;
      std::memcpy(&r, &all, sizeof r);
      return r;
    }
#endif
    if constexpr (sizeof(S) == 4) {
      Float4 part[N / 4];
      std::memcpy(part, &v, sizeof v);
      for (Float4& p : part) p = sqrt(p);
      V r;
      std::memcpy(&r, part, sizeof r);
      return r;
    }
    V r;
    for (int l = 0; l < N; ++l) r[l] = std::sqrt(v[l]);
    return r;
  }
  // Lanes 0, 2, 4 ... and 1, 3, 5 ... of eight or sixteen.
  [[gnu::always_inline]] static auto evens(const V& v) {
    if constexpr (N == 16)
      return __builtin_shufflevector(v, v, 0, 2, 4, 6, 8, 10, 12, 14);
    else
      return __builtin_shufflevector(v, v, 0, 2, 4, 6);
  }
  [[gnu::always_inline]] static auto odds(const V& v) {
    if constexpr (N == 16)
      return __builtin_shufflevector(v, v, 1, 3, 5, 7, 9, 11, 13, 15);
    else
      return __builtin_shufflevector(v, v, 1, 3, 5, 7);
  }
  // to[i] lane l = from[l][i], for i in [0, count).
  [[gnu::always_inline]] static void gather(const S* const* from, int count, V* to) {
    int i = 0;
#if defined(RDM_SIMD_AVX)
    if constexpr (sizeof(S) == 4 && N >= 8)
      for (; i + 4 <= count; i += 4)
        for (int eight = 0; eight < N; eight += 8) {
          const S* const* lane = from + eight;
          __m256 r[4];
          for (int l = 0; l < 4; ++l)
            r[l] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(lane[l] + i)),
                                        _mm_loadu_ps(lane[4 + l] + i), 1);
          transpose_halves(r);
          for (int k = 0; k < 4; ++k) _mm256_storeu_ps(reinterpret_cast<S*>(&to[i + k]) + eight, r[k]);
        }
#endif
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < N; half += 4) {
          Float4 r[4];
          for (int l = 0; l < 4; ++l) r[l] = load4(from[half + l] + i);
          transpose(r);
          for (int k = 0; k < 4; ++k) store4(reinterpret_cast<S*>(&to[i + k]) + half, r[k]);
        }
    for (; i < count; ++i)
      for (int l = 0; l < N; ++l) to[i][l] = from[l][i];
  }
  // to[l][i] = from[i] lane l, of the first `lanes` lanes.
  [[gnu::always_inline]] static void scatter(const V* from, int count, int lanes, S* const* to) {
    int i = 0;
#if defined(RDM_SIMD_AVX)
    if constexpr (sizeof(S) == 4 && N >= 8)
      for (; i + 4 <= count; i += 4)
        for (int eight = 0; eight < lanes; eight += 8) {
          S* const* lane = to + eight;
          const int n = lanes - eight < 8 ? lanes - eight : 8;
          __m256 r[4];
          for (int k = 0; k < 4; ++k)
            r[k] = _mm256_loadu_ps(reinterpret_cast<const S*>(&from[i + k]) + eight);
          transpose_halves(r);
          for (int l = 0; l < 4 && l < n; ++l) _mm_storeu_ps(lane[l] + i, _mm256_castps256_ps128(r[l]));
          for (int l = 4; l < n; ++l) _mm_storeu_ps(lane[l] + i, _mm256_extractf128_ps(r[l - 4], 1));
        }
#endif
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < lanes; half += 4) {
          Float4 r[4];
          for (int k = 0; k < 4; ++k) r[k] = load4(reinterpret_cast<const S*>(&from[i + k]) + half);
          transpose(r);
          for (int l = 0; l < 4 && half + l < lanes; ++l) store4(to[half + l] + i, r[l]);
        }
    for (; i < count; ++i)
      for (int l = 0; l < lanes; ++l) to[l][i] = from[i][l];
  }

  // *at(i) lane l = from[l][i], rounded to S, for i in [0, count).
  template <class At>
  [[gnu::always_inline]] static void gather_doubles(const double* const* from, int count, const At& at) {
    int i = 0;
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < N; half += 4) {
          Float4 r[4];
          for (int l = 0; l < 4; ++l) r[l] = rounded4(from[half + l] + i);
          transpose(r);
          for (int k = 0; k < 4; ++k) store4(reinterpret_cast<S*>(at(i + k)) + half, r[k]);
        }
    for (; i < count; ++i)
      for (int l = 0; l < N; ++l) set(at(i), l, static_cast<S>(from[l][i]));
  }
  // to[l][i] = *at(i) lane l, of the first `lanes` lanes.
  template <class At>
  [[gnu::always_inline]] static void scatter_doubles(const At& at, int count, int lanes, double* const* to) {
    int i = 0;
    if constexpr (sizeof(S) == 4)
      for (; i + 4 <= count; i += 4)
        for (int half = 0; half < lanes; half += 4) {
          Float4 r[4];
          for (int k = 0; k < 4; ++k) r[k] = load4(reinterpret_cast<const S*>(at(i + k)) + half);
          transpose(r);
          for (int l = 0; l < 4 && half + l < lanes; ++l) widen4(r[l], to[half + l] + i);
        }
    for (; i < count; ++i)
      for (int l = 0; l < lanes; ++l) to[l][i] = static_cast<double>(get(*at(i), l));
  }

#if defined(RDM_SIMD_AVX)
 private:
  // Four rows into four columns, in the lower and in the upper four lanes.
  [[gnu::always_inline]] static void transpose_halves(__m256 (&r)[4]) {
    const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpackhi_ps(r[0], r[1]),
                 c = _mm256_unpacklo_ps(r[2], r[3]), d = _mm256_unpackhi_ps(r[2], r[3]);
    r[0] = _mm256_shuffle_ps(a, c, 0x44);
    r[1] = _mm256_shuffle_ps(a, c, 0xee);
    r[2] = _mm256_shuffle_ps(b, d, 0x44);
    r[3] = _mm256_shuffle_ps(b, d, 0xee);
  }
#endif
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
  template <class At>
  [[gnu::always_inline]] static void gather_doubles(const double* const* from, int count, const At& at) {
    for (int i = 0; i < count; ++i) *at(i) = static_cast<S>(from[0][i]);
  }
  template <class At>
  [[gnu::always_inline]] static void scatter_doubles(const At& at, int count, int, double* const* to) {
    for (int i = 0; i < count; ++i) to[0][i] = static_cast<double>(*at(i));
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
