// Shared by the tests of lib/nn: random numbers, the instruction sets of this machine, and the network in
// plain double loops.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/cpu.hpp"
#include "base/rng.hpp"
#include "nn/kernels.hpp"
#include "nn/mlp.hpp"

inline std::vector<float> random_floats(size_t n, uint64_t seed, float scale = 1) {
  rdm::Stream stream(seed, 0, rdm::Purpose::kTest);
  std::vector<float> v(n + 1);
  stream.normals(v.data(), static_cast<int>(n));
  v.resize(n);
  for (float& x : v) x *= scale;
  return v;
}

// Runs the body once for every instruction set that this CPU has, then goes back to the best.
template <class Body>
void for_each_isa(Body body) {
  const std::string best = rdm::kernel_isa();
  for (const char* isa : {rdm::kBaseIsa, rdm::kV3Isa, rdm::kV4Isa})
    if (rdm::set_kernel_isa(isa)) body(isa);
  rdm::set_kernel_isa(best.c_str());
}

inline rdm::MlpShape make_shape(int32_t in, std::vector<int32_t> hidden, int32_t out,
                                rdm::Activation activation = rdm::Activation::kTanh) {
  rdm::MlpShape s;
  s.in = in;
  s.out = out;
  s.activation = activation;
  for (const int32_t h : hidden) s.hidden[s.num_hidden++] = h;
  return s;
}

struct OwnedScratch {
  OwnedScratch(const rdm::MlpShape& shape, int32_t rows) {
    rdm::Arena measure;
    rdm::carve_mlp_scratch(measure, shape, rows);
    arena = rdm::Arena(rdm::HostHooks{}, measure.used());
    scratch = rdm::carve_mlp_scratch(arena, shape, rows);
  }
  rdm::Arena arena;
  rdm::MlpScratch scratch;
};

// One row through the net, in double.
inline std::vector<double> net_in_double(const rdm::MlpShape& s, const std::vector<double>& params,
                                         std::vector<double> h) {
  for (int32_t l = 0; l < s.num_layers(); ++l) {
    const auto in = static_cast<size_t>(s.layer_in(l)), out = static_cast<size_t>(s.layer_out(l));
    std::vector<double> z(out);
    for (size_t o = 0; o < out; ++o) {
      z[o] = params[s.bias_offset(l) + o];
      for (size_t i = 0; i < in; ++i) z[o] += params[s.weight_offset(l) + o * in + i] * h[i];
      if (l == s.num_hidden) continue;
      if (s.activation == rdm::Activation::kTanh) z[o] = std::tanh(z[o]);
      if (s.activation == rdm::Activation::kElu && z[o] < 0) z[o] = std::expm1(z[o]);
      if (s.activation == rdm::Activation::kRelu && z[o] < 0) z[o] = 0;
    }
    h = z;
  }
  return h;
}
