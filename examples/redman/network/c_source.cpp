// A layer is y = W x + b. Rows of W stand by fours, [ceil(out / 4)][in][4], so that one pass over x gives
// four sums, each in the order of x, as the library adds them; missing rows are zeros.
//
// With int8 weights a row is q s, q in [-127, 127], s = max|w| / 127, and x is rounded to integers of at most
// 2^31 / (127 in): the sums are exact in 32 bits, the same on every machine.
#include "network/c_source.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "common/report.hpp"
#include "common/text.hpp"
#include "network/c_template.hpp"
#include "network/probe.hpp"

namespace tool {
namespace {

constexpr size_t kErrorRows = 1000, kTestRows = 8;
constexpr float kTestSpread = 2, kTestFar = 30;  // the last row's
constexpr double kFloatTolerance = 4e-6;         // another order of rounding, wherever the file runs

struct Layer {
  std::string number;
  size_t in = 0, out = 0;     // out: a multiple of 4
  std::vector<float> weight;  // [out / 4][in][4]
  std::vector<float> bias;    // [out]
  std::vector<int8_t> small;  // the weights in 8 bits, empty without
  std::vector<float> scale;   // [out] of them
};

// Denormals are 0 to the library.
float plain(float v) {
  return std::abs(v) < FLT_MIN ? 0 : v;
}

void quantise(Layer& layer) {
  layer.small.resize(layer.weight.size());
  layer.scale.resize(layer.out);
  for (size_t o = 0; o < layer.out; ++o) {
    const auto at = [&](size_t k) { return (o / 4 * layer.in + k) * 4 + o % 4; };
    float largest = 0;
    for (size_t k = 0; k < layer.in; ++k) largest = std::max(largest, std::abs(layer.weight[at(k)]));
    layer.scale[o] = plain(largest / 127);
    for (size_t k = 0; k < layer.in && layer.scale[o] > 0; ++k)
      layer.small[at(k)] = static_cast<int8_t>(std::lround(layer.weight[at(k)] / layer.scale[o]));
  }
}

// The layers that the mean action needs: of a network with deviations in its last layer, the first half.
std::vector<Layer> layers_of(const Network& network, bool int8) {
  std::vector<Layer> layers;
  for (int32_t l = 0; l < network.num_layers; ++l) {
    Layer layer;
    layer.number = std::to_string(l);
    const NamedTensor &w = *network.find("actor." + layer.number + ".weight"),
                      &b = *network.find("actor." + layer.number + ".bias");
    const bool last = l + 1 == network.num_layers;
    const auto rows = static_cast<size_t>(last ? network.action_dim : static_cast<int32_t>(w.shape[0]));
    layer.in = static_cast<size_t>(w.shape[1]);
    layer.out = (rows + 3) / 4 * 4;
    layer.weight.assign(layer.out * layer.in, 0);
    layer.bias.assign(layer.out, 0);
    for (size_t o = 0; o < rows; ++o) {
      layer.bias[o] = plain(b.values[o]);
      for (size_t k = 0; k < layer.in; ++k)
        layer.weight[(o / 4 * layer.in + k) * 4 + o % 4] = plain(w.values[o * layer.in + k]);
    }
    if (int8) quantise(layer);
    layers.push_back(std::move(layer));
  }
  return layers;
}

// ---- the file's own arithmetic with int8 weights, to measure what they cost -------------------------------
void run_layer(const Layer& layer, std::vector<float>& x) {
  float largest = 0;
  for (size_t k = 0; k < layer.in; ++k) largest = std::max(largest, std::abs(x[k]));
  const int32_t most = std::min<int32_t>(32767, INT32_MAX / 127 / static_cast<int32_t>(layer.in));
  const auto limit = static_cast<float>(most);
  const float unit = largest / limit, per = largest > 0 ? limit / largest : 0;
  std::vector<int32_t> q(layer.in);
  for (size_t k = 0; k < layer.in; ++k)
    q[k] = static_cast<int32_t>(std::clamp(std::fma(x[k], per, x[k] < 0 ? -0.5f : 0.5f), -limit, limit));
  std::vector<float> y(layer.out);
  for (size_t o = 0; o < layer.out; ++o) {
    int32_t sum = 0;
    for (size_t k = 0; k < layer.in; ++k) sum += layer.small[(o / 4 * layer.in + k) * 4 + o % 4] * q[k];
    y[o] = std::fma(static_cast<float>(sum), unit * layer.scale[o], layer.bias[o]);
  }
  x = y;
}

std::vector<float> run_layers(const Network& network, const std::vector<Layer>& layers, const float* obs) {
  std::vector<float> x(obs, obs + network.obs_dim);
  if (const NamedTensor* clip = network.find("normalizer.clip")) {
    const auto &shift = network.find("normalizer.shift")->values,
               &scale = network.find("normalizer.scale")->values;
    for (size_t i = 0; i < x.size(); ++i)
      x[i] = std::clamp((x[i] - shift[i]) * scale[i], -clip->values[0], clip->values[0]);
  }
  for (const Layer& layer : layers) {
    run_layer(layer, x);
    if (&layer == &layers.back()) break;
    for (float& z : x)
      z = network.activation == "relu"  ? std::max(z, 0.0f)
          : network.activation == "elu" ? (z > 0 ? z : std::expm1(z))
                                        : std::tanh(z);
  }
  x.resize(static_cast<size_t>(network.action_dim));
  for (float& a : x) a = std::clamp(a, -1.0f, 1.0f);
  return x;
}

// ---- text -------------------------------------------------------------------------------------------------
std::string replaced(std::string text, const std::string& word, const std::string& by) {
  for (size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += by.size())
    text.replace(at, word.size(), by);
  return text;
}

// A float literal that reads back to the same bits.
std::string literal(double v) {
  std::string s = format("%.9g", v);
  for (int digits = 1; digits < 9; ++digits) {
    const std::string shorter = format("%.*g", digits, v);
    if (std::strtof(shorter.c_str(), nullptr) != static_cast<float>(v)) continue;
    s = shorter;
    break;
  }
  return s + (s.find_first_of(".e") == std::string::npos ? ".0f" : "f");
}
std::string literal_text(float v) {
  return literal(static_cast<double>(v));
}
std::string literal_text(int8_t v) {
  return std::to_string(v);
}

// What the self-test holds the tables to: FNV-1a over the numbers' bits.
class Checksum {
 public:
  void add(float v) {
    uint32_t bits;
    std::memcpy(&bits, &v, sizeof bits);
    mix(bits);
  }
  void add(int8_t v) { mix(static_cast<uint8_t>(v)); }
  uint32_t value() const { return value_; }

 private:
  void mix(uint32_t bits) { value_ = (value_ ^ bits) * 16777619u; }
  uint32_t value_ = 2166136261u;
};

// The tables of a file, in its order, and the self-test's calls that add them up.
class Tables {
 public:
  template <class T>
  void add(const std::string& name, const std::vector<T>& values) {
    constexpr bool kFloat = std::is_same_v<T, float>;
    text_ += table(name, values);
    for (const T v : values) checksum_.add(v);
    calls_ += format("  sum = NAME_sum_%s(sum, NAME_%s, %zu);\n", kFloat ? "floats" : "bytes", name.c_str(),
                     values.size());
  }
  // One that the checksum leaves out.
  template <class T>
  static std::string table(const std::string& name, const std::vector<T>& values) {
    std::string out = format("static const %s NAME_%s[%zu] = {",
                             std::is_same_v<T, float> ? "float" : "int8_t", name.c_str(), values.size());
    size_t column = 200;
    for (size_t i = 0; i < values.size(); ++i) {
      const std::string value = literal_text(values[i]) + (i + 1 < values.size() ? "," : "");
      const bool wrap = column + value.size() > 108;
      out += wrap ? "\n  " : " ";
      column = (wrap ? 2 : column + 1) + value.size();
      out += value;
    }
    return out + "\n};\n";
  }
  const std::string& text() const { return text_; }
  const std::string& calls() const { return calls_; }
  uint32_t checksum() const { return checksum_.value(); }

 private:
  std::string text_, calls_;
  Checksum checksum_;
};

// Two digits, not below v.
double upwards(double v) {
  if (!(v > 0)) return v;
  const double digit = std::pow(10, std::floor(std::log10(v)) - 1);
  return std::ceil(v / digit) * digit;
}

// A text of somebody else's inside a comment.
std::string harmless(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && !std::strchr("_-. ", c)) c = '_';
  return text;
}

// One row of the self-test: what template kSelfTest draws.
void draw_row(const Network& network, uint32_t& random, float spread, float* obs) {
  const NamedTensor *shift = network.find("normalizer.shift"), *scale = network.find("normalizer.scale");
  for (size_t i = 0; i < static_cast<size_t>(network.obs_dim); ++i) {
    random = random * 1664525u + 1013904223u;
    const float u = spread * (static_cast<float>(random >> 8) * 0x1p-23f - 1);
    obs[i] = scale ? u / plain(scale->values[i]) + plain(shift->values[i]) : u;
  }
}

// Observations of the self-test: the policy's example, and drawn ones.
std::vector<float> test_observations(const Network& network) {
  const auto in = static_cast<size_t>(network.obs_dim);
  std::vector<float> obs = network.find("example.obs")->values;
  obs.resize(kTestRows * in);
  uint32_t random = 1;
  for (size_t row = 1; row < kTestRows; ++row)
    draw_row(network, random, row + 1 < kTestRows ? kTestSpread : kTestFar, obs.data() + row * in);
  return obs;
}

struct Sizes {
  size_t front = 0, back = 0, widest = 0;
};
// Of the two rows that layers read and write in turn.
Sizes sizes_of(const std::vector<Layer>& layers) {
  Sizes s;
  s.front = layers[0].in;
  for (size_t l = 0; l < layers.size(); ++l) {
    size_t& to = l % 2 ? s.front : s.back;
    to = std::max(to, layers[l].out);
    s.widest = std::max(s.widest, layers[l].in);
  }
  return s;
}

std::string act_text(const Network& network, const std::vector<Layer>& layers, bool int8) {
  const Sizes sizes = sizes_of(layers);
  std::string out =
      replaced(replaced(kActHead, "FRONT", std::to_string(sizes.front)), "BACK", std::to_string(sizes.back));
  out += network.find("normalizer.clip") ? kNormalise : kTake;
  for (size_t l = 0; l < layers.size(); ++l) {
    const Layer& y = layers[l];
    const std::string scale = int8 ? "NAME_scale_" + y.number + ", " : "";
    out += format("  NAME_layer(NAME_weight_%s, %sNAME_bias_%s, %s, %zu, %zu, %s);\n", y.number.c_str(),
                  scale.c_str(), y.number.c_str(), l % 2 ? "back" : "front", y.in, y.out,
                  l % 2 ? "front" : "back");
    if (l + 1 < layers.size()) out += format("  NAME_activate(%s, %zu);\n", l % 2 ? "front" : "back", y.out);
  }
  return out + replaced(kActTail, "LAST", layers.size() % 2 ? "back" : "front");
}

std::string head_text(const Network& network, const std::vector<Layer>& layers,
                      const std::vector<ObsField>& fields, const rdm_policy_info& info) {
  std::string out = kHead;
  const uint32_t v = rdm_version();
  std::string shape = std::to_string(network.obs_dim);
  for (size_t l = 0; l + 1 < layers.size(); ++l)
    shape += " -> " + std::to_string(network.find("actor." + layers[l].number + ".bias")->shape[0]) + ' ' +
             network.activation;
  shape += " -> " + std::to_string(network.action_dim);
  if (!fields.empty()) {
    out += " *\n * Observation: entries, field, unit\n";
    for (const ObsField& f : fields)
      out += format(" *   %4d ..%4d  %s  %s\n", f.offset, f.offset + f.count - 1, harmless(f.name).c_str(),
                    replaced(f.unit, "*/", "").c_str());
  }
  out = replaced(out, "TASK", *info.task ? harmless(info.task) : "its host");
  out = replaced(out, "VERSION", format("%u.%u.%u", v / 1000000, v / 1000 % 1000, v % 1000));
  out = replaced(out, "SHAPE", shape);
  out = replaced(out, "LAYOUT", format("%016llx", static_cast<unsigned long long>(info.layout_hash)));
  return replaced(out, "RATE",
                  info.control_dt > 0 ? format("%d control steps of %.6g s", info.action_repeat,
                                               static_cast<double>(info.control_dt))
                                      : format("%d control steps", info.action_repeat));
}

size_t stack_bytes(const std::vector<Layer>& layers, bool int8) {
  const Sizes s = sizes_of(layers);
  return (s.front + s.back) * sizeof(float) + (int8 ? s.widest * sizeof(int16_t) : 0);
}

}  // namespace

CSource c_source(const redman::Policy& policy, const Network& network, const std::string& name,
                 const std::vector<ObsField>& fields, bool int8) {
  const std::vector<Layer> layers = layers_of(network, int8);
  const NamedTensor* clip = network.find("normalizer.clip");
  const std::vector<float> tests = test_observations(network), expected = mean_actions(policy, tests);
  CSource out;
  double tolerance = kFloatTolerance;
  std::string weights = "32-bit floats";
  if (int8) {
    std::vector<float> obs = probe_observations(network, kErrorRows, 0);
    std::vector<float> exact = mean_actions(policy, obs);
    obs.insert(obs.end(), tests.begin(), tests.end());
    exact.insert(exact.end(), expected.begin(), expected.end());
    const auto in = static_cast<size_t>(network.obs_dim), dim = static_cast<size_t>(network.action_dim);
    double squares = 0;
    for (size_t row = 0; row < obs.size() / in; ++row) {
      const std::vector<float> action = run_layers(network, layers, obs.data() + row * in);
      for (size_t j = 0; j < dim; ++j) {
        const auto gap = static_cast<double>(std::abs(action[j] - exact[row * dim + j]));
        out.largest_error = std::max(out.largest_error, gap);
        squares += gap * gap;
      }
    }
    out.rms_error = std::sqrt(squares / static_cast<double>(exact.size()));
    tolerance = 1.05 * out.largest_error + 1e-5;  // the last digits of another machine
    weights = format(
        "8 bits and a scale for each row. Actions then differ from\n * the policy's by %g at most, %g in "
        "root "
        "mean square, over %zu random observations",
        upwards(out.largest_error), upwards(out.rms_error), kErrorRows);
  }

  Tables tables;
  if (clip) {
    auto shift = network.find("normalizer.shift")->values, scale = network.find("normalizer.scale")->values;
    for (float& v : shift) v = plain(v);
    tables.add("shift", shift);
    tables.add("scale", scale);
  }
  for (const Layer& layer : layers) {
    if (int8)
      tables.add("weight_" + layer.number, layer.small), tables.add("scale_" + layer.number, layer.scale);
    else
      tables.add("weight_" + layer.number, layer.weight);
    tables.add("bias_" + layer.number, layer.bias);
  }
  const rdm_policy_info& info = policy.info();
  std::string& text = out.text;
  text = head_text(network, layers, fields, info);
  text += kDeclarations;
  text += tables.text();
  text += kFma;
  if (layers.size() > 1) {
    if (network.activation != "relu") text += kTanh;
    text += network.activation == "relu" ? kRelu : network.activation == "elu" ? kElu : kActivateTanh;
    text += kActivate;
  }
  text += int8 ? kLayerInt8 : kLayerFloat;
  text += act_text(network, layers, int8);
  text += kTestHead;
  text += tables.table("example_obs", network.find("example.obs")->values);
  text += tables.table("expected", expected);
  text += int8 ? std::string(kSumBytes) + kSumFloats : std::string(kSumFloats);
  text += replaced(replaced(kDraw, "DRAWN", clip ? "u / NAME_scale[i] + NAME_shift[i]" : "u"), "SPREAD",
                   literal(static_cast<double>(kTestSpread)));
  text = replaced(text, "FAR", literal(static_cast<double>(kTestFar)));
  text += replaced(kTestMain, "SUMS", tables.calls());
  for (const auto& [word, by] : std::vector<std::pair<std::string, std::string>>{
           {"WEIGHTS", weights},
           {"STACK", std::to_string(stack_bytes(layers, int8))},
           {"OBS_DIM", std::to_string(network.obs_dim)},
           {"ACTION_DIM", std::to_string(network.action_dim)},
           {"REPEAT", std::to_string(info.action_repeat)},
           {"WIDEST", std::to_string(sizes_of(layers).widest)},
           {"CLIP", clip ? literal(static_cast<double>(clip->values[0])) : ""},
           {"ROWS", std::to_string(kTestRows)},
           {"TOLERANCE", literal(tolerance)},
           {"CHECKSUM", format("0x%08xu", tables.checksum())},
           {"NAME", name}})
    text = replaced(std::move(text), word, by);
  return out;
}

void check_c_name(const std::string& name) {
  const auto good = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  const bool letter = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0]));
  if (!letter || name.size() > 63 || !std::all_of(name.begin(), name.end(), good) ||
      name.find("__") != std::string::npos)
    throw Usage("--name " + name +
                ": not the beginning of a C name: a letter, then letters, digits and single underscores");
}

std::string c_name_of(const std::string& task) {
  std::string out;
  for (const char c : task) {
    const bool good = std::isalnum(static_cast<unsigned char>(c));
    if (good) out += c;
    if (!good && !out.empty() && out.back() != '_') out += '_';
  }
  if (out.empty()) return "policy";
  return std::isalpha(static_cast<unsigned char>(out[0])) ? out : "policy_" + out;
}

}  // namespace tool
