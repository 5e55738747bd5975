// A learner from recorded rows written again in double, plainly: losses are functions of all parameters, gradients are
// central differences of them. Networks have one hidden layer of tanh.
#pragma once
#include <cmath>
#include <functional>
#include <map>

#include "agents.hpp"
#include "algos/off_policy/off_policy.hpp"

namespace rdm::test {

using Numbers = std::vector<double>;

struct PlainNet {
  size_t in = 0, hidden = 0, out = 0;
  Numbers p;  // weights of the hidden layer, its biases, those of the last layer
  Numbers operator()(const Numbers& x) const {
    Numbers h(hidden), y(out);
    const double* w = p.data();
    for (size_t i = 0; i < hidden; ++i) {
      h[i] = w[hidden * in + i];
      for (size_t j = 0; j < in; ++j) h[i] += w[i * in + j] * x[j];
      h[i] = std::tanh(h[i]);
    }
    w += hidden * in + hidden;
    for (size_t i = 0; i < out; ++i) {
      y[i] = w[out * hidden + i];
      for (size_t j = 0; j < hidden; ++j) y[i] += w[i * hidden + j] * h[j];
    }
    return y;
  }
};

// Adam over the parameters of a network.
struct PlainAdam {
  Numbers m, v;
  int t = 0;
  void step(Numbers& p, const Numbers& g, double rate) {
    m.resize(p.size()), v.resize(p.size());
    ++t;
    for (size_t i = 0; i < p.size(); ++i) {
      m[i] = 0.9 * m[i] + 0.1 * g[i];
      v[i] = 0.999 * v[i] + 0.001 * g[i] * g[i];
      p[i] -= rate * m[i] / (1 - std::pow(0.9, t)) / (std::sqrt(v[i] / (1 - std::pow(0.999, t))) + 1e-8);
    }
  }
};

inline Numbers differences(Numbers& p, const std::function<double()>& loss) {
  Numbers g(p.size());
  for (size_t i = 0; i < p.size(); ++i) {
    const double before = p[i], h = 1e-5;
    p[i] = before + h;
    const double high = loss();
    p[i] = before - h;
    g[i] = (high - loss()) / (2 * h);
    p[i] = before;
  }
  return g;
}

inline Numbers joined(const Numbers& a, const Numbers& b) {
  Numbers out = a;
  out.insert(out.end(), b.begin(), b.end());
  return out;
}

// The network whose tensors are PREFIX.0.weight and so on.
inline PlainNet net_of(Agent& a, const std::string& prefix) {
  PlainNet net;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i) {
    const std::string name = t.name;
    if (name.compare(0, prefix.size() + 1, prefix + ".") != 0 || name == prefix + ".log_std") continue;
    if (name == prefix + ".0.weight") net.in = size_of(t.cols), net.hidden = size_of(t.rows);
    if (name == prefix + ".1.weight") net.out = size_of(t.rows);
    for (size_t k = 0; k < size_of(t.rows) * size_of(t.cols); ++k)
      net.p.push_back(static_cast<double>(t.data[k]));
  }
  return net;
}

}  // namespace rdm::test
