// tanh, exp and what follows from them, by lanes. Part of kernels_v*.cpp, which define V, VI and its basics.
#pragma once

namespace rdm {
namespace {

// x P(x^2) / Q(x^2), fitted for the least relative error (2e-8) up to where the float tanh is 1.
inline V tanh_of(V x) {
  x = low(all(9.011f), high(all(-9.011f), x));
  const V u = x * x;
  V p = fma(all(1.33350530617804e-08f), u, all(2.0594981833710335e-05f));
  p = fma(p, u, all(0.0034947325475513935f));
  p = fma(p, u, all(0.13380305469036102f));
  p = fma(p, u, all(1.0f));
  V q = fma(all(7.768549039610662e-07f), u, all(0.00032842348446138203f));
  q = fma(q, u, all(0.025873728096485138f));
  q = fma(q, u, all(0.4671362042427063f));
  q = fma(q, u, all(1.0f));
  return low(all(1.0f), high(all(-1.0f), x * p / q));
}

// e^x - 1 for x <= 0, exact to some units in the last place near 0 too.
inline V expm1_of(V x) {
  const V t = tanh_of(x * all(0.5f));
  return (t + t) / (all(1.0f) - t);
}

// 2^n e^r with n = round(x / log 2). Clamped to +-87, which keeps the result normal.
inline V exp_of(V x) {
  x = low(all(87.0f), high(all(-87.0f), x));
  const V round = all(12582912.0f);  // 1.5 2^23: its last mantissa bit is 1
  const V shifted = fma(x, all(1.44269504088896341f), round);
  const V n = shifted - round;
  V r = fma(n, all(-0.693359375f), x);
  r = fma(n, all(2.12194440e-4f), r);
  V p = fma(all(1.0f / 5040), r, all(1.0f / 720));
  p = fma(p, r, all(1.0f / 120));
  p = fma(p, r, all(1.0f / 24));
  p = fma(p, r, all(1.0f / 6));
  p = fma(p, r, all(0.5f));
  p = fma(p, r, all(1.0f));
  p = fma(p, r, all(1.0f));
  VI bits, scale;
  __builtin_memcpy(&bits, &p, sizeof bits);
  __builtin_memcpy(&scale, &shifted, sizeof scale);
  bits += scale << 23;
  __builtin_memcpy(&p, &bits, sizeof p);
  return p;
}

inline V activation_of(Activation a, V z) {
  switch (a) {
    case Activation::kTanh:
      return tanh_of(z);
    case Activation::kElu:
      return positive(z, z, expm1_of(z));
    case Activation::kRelu:
      return high(all(0.0f), z);
  }
  return z;
}

// The derivative, by the activation's own value.
inline V slope_of(Activation a, V h) {
  switch (a) {
    case Activation::kTanh:
      return fma(-h, h, all(1.0f));
    case Activation::kElu:
      return positive(h, all(1.0f), h + all(1.0f));
    case Activation::kRelu:
      return positive(h, all(1.0f), all(0.0f));
  }
  return all(1.0f);
}

inline float sum_of(V v) {
  float lane[kLanes], sum = 0;
  store(lane, v);
  for (const float s : lane) sum += s;
  return sum;
}

}  // namespace
}  // namespace rdm
