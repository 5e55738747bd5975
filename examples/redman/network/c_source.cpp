// A layer is y = W x + b. Rows of W stand by fours, [ceil(out / 4)][in][4], so that one pass over x gives
// four sums, each in the order of x, as the library adds them; missing rows are zeros.
//
// With int8 weights a row is q s, q in [-127, 127], s = max|w| / 127, and x is rounded to integers of at most
// 2^31 / (127 in): the sums are exact in 32 bits, the same on every machine and in any order. So they stand as ARM's DSP
// instructions take them, [out / 4][ceil(in / 4)][4 rows][4], of a row's four the numbers 0, 2, 1, 3.
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
constexpr size_t kErrorPoints = 200000;  // that int8 is measured on, at most: fewer rows of large clouds
constexpr int32_t kTestPoints = 24;      // of a cloud of the self-test
constexpr float kTestSpread = 2, kTestFar = 30;  // the last row's
constexpr size_t kSpare = 3;                     // of a row in 8 bits, which is taken by fours
constexpr double kFloatTolerance = 4e-6;         // another order of rounding, wherever the file runs

struct Layer {
  std::string number;
  size_t in = 0, out = 0;     // out: a multiple of 4
  std::vector<float> weight;  // [out / 4][in][4]
  std::vector<float> bias;    // [out]
  std::vector<int8_t> small;  // the weights in 8 bits, empty without
  std::vector<float> scale;   // [out] of them

  size_t small_at(size_t o, size_t k) const {
    constexpr size_t kOrder[] = {0, 2, 1, 3};
    return ((o / 4 * ((in + 3) / 4) + k / 4) * 4 + o % 4) * 4 + kOrder[k % 4];
  }
};

// Denormals are 0 to the library.
float plain(float v) {
  return std::abs(v) < FLT_MIN ? 0 : v;
}

void quantise(Layer& layer) {
  layer.small.assign(layer.out * ((layer.in + 3) / 4 * 4), 0);
  layer.scale.resize(layer.out);
  for (size_t o = 0; o < layer.out; ++o) {
    const auto at = [&](size_t k) { return (o / 4 * layer.in + k) * 4 + o % 4; };
    float largest = 0;
    for (size_t k = 0; k < layer.in; ++k) largest = std::max(largest, std::abs(layer.weight[at(k)]));
    layer.scale[o] = plain(largest / 127);
    for (size_t k = 0; k < layer.in && layer.scale[o] > 0; ++k)
      layer.small[layer.small_at(o, k)] =
          static_cast<int8_t>(std::lround(layer.weight[at(k)] / layer.scale[o]));
  }
}

// The tensors `from`.weight and .bias as a layer of so many rows.
Layer layer_of(const Network& network, const std::string& from, const std::string& number, int32_t outputs,
               bool int8) {
  Layer layer;
  layer.number = number;
  const NamedTensor &w = *network.find(from + ".weight"), &b = *network.find(from + ".bias");
  const auto rows = static_cast<size_t>(outputs);
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
  return layer;
}

// Layers of "actor" or "encoder", of the last one so many rows; `mark` begins their numbers.
std::vector<Layer> layers_of(const Network& network, const std::string& of, const char* mark, int32_t count,
                             int32_t outputs, bool int8) {
  std::vector<Layer> layers;
  for (int32_t l = 0; l < count; ++l) {
    const std::string number = std::to_string(l), from = of + '.' + number;
    const auto rows = static_cast<int32_t>(network.find(from + ".weight")->shape[0]);
    layers.push_back(layer_of(network, from, mark + number, l + 1 == count ? outputs : rows, int8));
  }
  return layers;
}

struct Layers {
  std::vector<Layer> actor;  // for the mean action: where the last one has deviations too, its first half
  std::vector<Layer> eyes;
  std::vector<Layer> memory;  // of a GRU: what the input gives, what the state gives
  std::vector<Layer> latent;  // its encoder
};
Layers layers_of(const Network& network, bool int8) {
  const Eyes& e = network.eyes;
  Layers out = {layers_of(network, "actor", "", network.num_layers, network.action_dim, int8),
                layers_of(network, "encoder", "eye_", e.num_layers, e.features, int8),
                {},
                layers_of(network, "latent", "latent_", network.latent_layers, network.latent, int8)};
  for (const char* part : {"input", "state"})
    if (network.memory.units)
      out.memory.push_back(
          layer_of(network, std::string("memory.") + part, part, 3 * network.memory.units, int8));
  return out;
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
    for (size_t k = 0; k < layer.in; ++k) sum += layer.small[layer.small_at(o, k)] * q[k];
    y[o] = std::fma(static_cast<float>(sum), unit * layer.scale[o], layer.bias[o]);
  }
  x = y;
}

void run_activation(const std::string& name, std::vector<float>& x) {
  for (float& z : x)
    z = name == "relu" ? std::max(z, 0.0f) : name == "elu" ? (z > 0 ? z : std::expm1(z)) : std::tanh(z);
}

void run_all(const std::vector<Layer>& layers, const std::string& activation, std::vector<float>& x) {
  for (const Layer& layer : layers) {
    run_layer(layer, x);
    if (&layer != &layers.back()) run_activation(activation, x);
  }
}

// Features of one cloud.
std::vector<float> run_eyes(const Eyes& e, const std::vector<Layer>& layers, const float* points,
                            const uint8_t* classes, const uint8_t* colors) {
  std::vector<float> best, x;
  for (size_t p = 0; p < static_cast<size_t>(e.points); ++p) {
    x.assign(layers[0].in, 0);
    for (size_t k = 0; k < 3; ++k) {
      const double mm = 1000 * (static_cast<double>(points[3 * p + k]) - static_cast<double>(e.origin[k]));
      x[k] = 0.001f / e.range * static_cast<float>(std::nearbyint(std::clamp(mm, -32767.0, 32767.0)));
    }
    if (e.classes) x[3 + classes[p]] = 1;
    for (size_t k = 0; e.color && k < 3; ++k)
      x[3 + static_cast<size_t>(e.classes) + k] = static_cast<float>(colors[3 * p + k]) / 255;
    run_all(layers, e.activation, x);
    if (p == 0) best = x;
    for (size_t j = 0; j < x.size(); ++j) best[j] = std::max(best[j], x[j]);
  }
  best.resize(static_cast<size_t>(e.features));
  run_activation(e.activation, best);
  return best;
}

// The hidden layers, a step of the GRU, the last layer.
void run_gru(const Network& network, const Layers& layers, std::vector<float>& x, std::vector<float>& state) {
  for (size_t l = 0; l + 1 < layers.actor.size(); ++l) {
    run_layer(layers.actor[l], x);
    run_activation(network.activation, x);
  }
  const auto units = static_cast<size_t>(network.memory.units);
  std::vector<float> part = state;
  run_layer(layers.memory[0], x);
  run_layer(layers.memory[1], part);
  const auto sigmoid = [](float v) { return 0.5f * std::tanh(0.5f * v) + 0.5f; };
  for (size_t i = 0; i < units; ++i) {
    const float r = sigmoid(x[i] + part[i]), z = sigmoid(x[units + i] + part[units + i]);
    const float n = std::tanh(std::fma(r, part[2 * units + i], x[2 * units + i]));
    state[i] = std::fma(z, state[i] - n, n);
  }
  x = state;
  run_layer(layers.actor.back(), x);
}

// Puts the history behind the row, and the row into the history.
void run_history(const Memory& memory, std::vector<float>& x, std::vector<float>& state) {
  std::vector<float> next;
  for (const int32_t i : memory.columns) next.push_back(x[static_cast<size_t>(i)]);
  next.insert(next.end(), state.begin(), state.end() - static_cast<long>(memory.columns.size()));
  x.insert(x.end(), state.begin(), state.end());
  state = next;
}

std::vector<float> run_layers(const Network& network, const Layers& layers, const float* obs,
                              const Clouds& clouds, size_t row, std::vector<float>& state) {
  std::vector<float> x(obs, obs + network.obs_dim);
  if (const NamedTensor* clip = network.find("normalizer.clip")) {
    const auto &shift = network.find("normalizer.shift")->values,
               &scale = network.find("normalizer.scale")->values;
    for (size_t i = 0; i < x.size(); ++i)
      x[i] = std::clamp((x[i] - shift[i]) * scale[i], -clip->values[0], clip->values[0]);
  }
  const Memory& memory = network.memory;
  if (memory.size && row % kProbeEpisode == 0) state.assign(static_cast<size_t>(memory.size), 0);
  std::vector<float> own = x;
  if (memory.size && !memory.units) run_history(memory, x, state);
  if (network.latent) {
    run_all(layers.latent, network.activation, x);
    own.insert(own.end(), x.begin(), x.begin() + network.latent);
    x = own;
  }
  if (const auto count = static_cast<size_t>(network.eyes.points)) {
    const auto features =
        run_eyes(network.eyes, layers.eyes, clouds.points.data() + 3 * row * count,
                 clouds.classes.data() + row * count, clouds.colors.data() + 3 * row * count);
    x.insert(x.end(), features.begin(), features.end());
  }
  if (memory.units)
    run_gru(network, layers, x, state);
  else
    run_all(layers.actor, network.activation, x);
  x.resize(static_cast<size_t>(network.action_dim));
  for (float& a : x) a = std::clamp(network.find("action.squash") ? std::tanh(a) : a, -1.0f, 1.0f);
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

// Checksum by which the self-test checks the tables: FNV-1a over the bits of the numbers.
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

// Makes a text from a file safe inside a C comment.
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

// Of a coordinate of a drawn point, to each side of the origin, mm.
int32_t reach_of(const Eyes& e) {
  return static_cast<int32_t>(std::clamp(std::lround(2000 * static_cast<double>(e.range)), 1L, 30000L));
}
int32_t test_points(const Eyes& e) {
  return std::min(kTestPoints, e.points);
}

// One cloud of the self-test, what template kDrawPoints draws; the rest of it repeats that.
void draw_cloud(const Eyes& e, uint32_t& random, float* points, uint8_t* classes, uint8_t* colors) {
  const int32_t reach = reach_of(e);
  const auto drawn = static_cast<size_t>(test_points(e));
  for (size_t i = 0; i < 3 * drawn; ++i) {
    random = random * 1664525u + 1013904223u;
    const auto mm = static_cast<int32_t>((random >> 8) % static_cast<uint32_t>(2 * reach + 1)) - reach;
    points[i] = e.origin[i % 3] + 0.001f * static_cast<float>(mm);
  }
  for (size_t p = 0; p < static_cast<size_t>(e.points); ++p) {
    if (p >= drawn) std::copy_n(points + 3 * (p % drawn), 3, points + 3 * p);
    classes[p] = e.classes ? static_cast<uint8_t>(p % drawn % static_cast<size_t>(e.classes)) : uint8_t{0};
    for (size_t k = 0; k < 3; ++k) colors[3 * p + k] = static_cast<uint8_t>((3 * (p % drawn) + k) * 37 % 256);
  }
}

struct TestRows {
  std::vector<float> obs;
  Clouds clouds;
};
// Observations of the self-test, the policy's example and drawn ones, each with a drawn cloud.
TestRows test_rows(const Network& network) {
  const Eyes& e = network.eyes;
  const auto in = static_cast<size_t>(network.obs_dim), count = static_cast<size_t>(e.points);
  TestRows rows;
  rows.obs.resize(kTestRows * in);
  rows.clouds.points.resize(kTestRows * count * 3);
  rows.clouds.classes.resize(kTestRows * count);
  rows.clouds.colors.resize(kTestRows * count * 3);
  uint32_t random = 1;
  for (size_t row = 0; row < kTestRows; ++row) {
    if (row == 1) random = 1;
    draw_row(network, random, row + 1 < kTestRows ? kTestSpread : kTestFar, rows.obs.data() + row * in);
    if (count)
      draw_cloud(e, random, rows.clouds.points.data() + 3 * row * count,
                 rows.clouds.classes.data() + row * count, rows.clouds.colors.data() + 3 * row * count);
  }
  const auto& example = network.find("example.obs")->values;
  std::copy(example.begin(), example.end(), rows.obs.begin());
  return rows;
}

struct Sizes {
  size_t front = 0, back = 0, widest = 0;
};
// The size of the two buffers that layers read and write in turn.
Sizes buffer_sizes(const std::vector<Layer>& layers) {
  Sizes s;
  s.front = layers[0].in;
  for (size_t l = 0; l < layers.size(); ++l) {
    size_t& to = l % 2 ? s.front : s.back;
    to = std::max(to, layers[l].out);
    s.widest = std::max(s.widest, layers[l].in);
  }
  return s;
}

// Calls of layers, from the row `front` on.
std::string layer_calls(const std::vector<Layer>& layers, bool int8, const char* indent,
                        const char* activate) {
  std::string out;
  for (size_t l = 0; l < layers.size(); ++l) {
    const Layer& y = layers[l];
    const std::string scale = int8 ? "NAME_scale_" + y.number + ", " : "";
    out += format("%sNAME_layer(NAME_weight_%s, %sNAME_bias_%s, %s, %zu, %zu, %s);\n", indent,
                  y.number.c_str(), scale.c_str(), y.number.c_str(), l % 2 ? "back" : "front", y.in, y.out,
                  l % 2 ? "front" : "back");
    if (l + 1 < layers.size())
      out += format("%s%s(%s, %zu);\n", indent, activate, l % 2 ? "front" : "back", y.out);
  }
  return out;
}
const char* last_row(const std::vector<Layer>& layers) {
  return layers.size() % 2 ? "back" : "front";
}
std::string with_rows(const char* text, const std::vector<Layer>& layers) {
  const Sizes sizes = buffer_sizes(layers);
  return replaced(replaced(text, "FRONT", std::to_string(sizes.front)), "BACK", std::to_string(sizes.back));
}

// What comes with points, each with `type` before it and a comma behind.
std::string channels_of(const Eyes& e, const std::string& type) {
  return (e.classes ? type + "point_class, " : "") + (e.color ? type + "point_color, " : "");
}

// What a caller of the file writes.
struct Call {
  std::string function, declaration, call, no_points;
};
Call call_of(const Network& network) {
  const Eyes& e = network.eyes;
  const std::string function = e.points ? "NAME_act_points" : "NAME_act",
                    state = network.memory.size ? "state, " : "",
                    front = function + "(obs, " + (e.points ? "points, " + channels_of(e, "") : "");
  const std::string declaration =
      "void " + function + "(const float *obs, " +
      (e.points ? "const float *points, " + channels_of(e, "const unsigned char *") + "int count, " : "") +
      (state.empty() ? "" : "float *state, ") + "float *action)";
  if (e.points == 0) return {function, declaration, front + state + "action)", ""};
  return {function, declaration, front + "count, " + state + "action)", front + "0, " + state + "action)"};
}

bool squashes(const Network& network) {
  return network.find("action.squash") != nullptr;
}
// The functions of one kind of activation, `name` in the place of "activation".
std::string activation_text(const std::string& kind, bool eye) {
  const std::string text = std::string(kind == "relu"  ? kRelu
                                       : kind == "elu" ? kElu
                                                       : kActivateTanh) +
                           kActivate;
  return eye ? replaced(text, "NAME_activat", "NAME_eye_activat") : text;
}
bool own_activation(const Network& network, const Layers& layers) {
  return network.eyes.points && (network.eyes.activation != network.activation || layers.actor.size() == 1);
}
std::string activations_text(const Network& network, const Layers& layers) {
  const bool actor = layers.actor.size() > 1 || layers.latent.size() > 1,
             eyes = own_activation(network, layers);
  std::string out;
  if (network.memory.units || squashes(network) || (actor && network.activation != "relu") ||
      (eyes && network.eyes.activation != "relu"))
    out += kTanh;
  if (actor) out += activation_text(network.activation, false);
  return eyes ? out + activation_text(network.eyes.activation, true) : out;
}

const char* eye_activate(const Network& network, const Layers& layers) {
  return own_activation(network, layers) ? "NAME_eye_activate" : "NAME_activate";
}

// What makes features of a cloud.
std::string eyes_text(const Network& network, const Layers& layers, bool int8) {
  const Eyes& e = network.eyes;
  if (e.points == 0) return "";
  std::string see = with_rows(kSeeHead, layers.eyes);
  if (e.classes) see += replaced(kSeeClasses, "CLASSES", std::to_string(e.classes));
  if (e.color) see += replaced(kSeeColors, "FIRST", std::to_string(3 + e.classes));
  see += layer_calls(layers.eyes, int8, "    ", eye_activate(network, layers)) +
         replaced(kSeeTail, "LAST", last_row(layers.eyes));
  see = replaced(see, "STEP", literal(static_cast<double>(0.001f / e.range)));
  see = replaced(see, "CHANNEL_PARAMETERS", channels_of(e, "const unsigned char *"));
  return kMillimetres + replaced(see, "FEATURES", std::to_string(e.features));
}

// The features behind what else the actor reads.
std::string features_text(const Network& network, const Layers& layers) {
  const Eyes& e = network.eyes;
  if (e.points == 0) return "";
  const size_t behind = layers.actor[0].in - static_cast<size_t>(e.features);
  const std::string out = replaced(replaced(kPutFeatures, "EYE_ACTIVATE", eye_activate(network, layers)),
                                   "BEHIND", std::to_string(behind));
  return replaced(out, "FEATURES", std::to_string(e.features));
}

// The call of a layer by name.
std::string layer_call(const Layer& y, bool int8, const char* in, const char* out) {
  const std::string scale = int8 ? "NAME_scale_" + y.number + ", " : "";
  return format("  NAME_layer(NAME_weight_%s, %sNAME_bias_%s, %s, %zu, %zu, %s);\n", y.number.c_str(),
                scale.c_str(), y.number.c_str(), in, y.in, y.out, out);
}

// The row's copy with its latent behind it becomes what the actor reads.
std::string latent_text(const Network& network, const Layers& layers, bool int8) {
  if (!network.latent) return "";
  return std::string(kKeepRow) + layer_calls(layers.latent, int8, "  ", "NAME_activate") +
         replaced(replaced(kPutLatent, "LATENT", std::to_string(network.latent)), "LAST",
                  last_row(layers.latent));
}

// The layers that share the two buffers, for their sizes: the row, with what stands behind it, fits the first.
std::vector<Layer> shared_rows(const Network& network, const Layers& layers) {
  std::vector<Layer> rows = layers.actor;
  if (network.latent) {
    const Sizes l = buffer_sizes(layers.latent);
    rows[0].in = std::max(rows[0].in, l.front);
    rows[0].out = std::max(rows[0].out, l.back);
  }
  if (network.memory.size) rows[0].in = std::max(rows[0].in, static_cast<size_t>(network.obs_dim));
  return rows;
}
// The rows of a decision beside the two buffers.
std::string rows_text(const Network& network, const Layers& layers) {
  std::string out;
  if (network.eyes.points) out += format(", features[%d]", network.eyes.features);
  if (network.memory.size) out += ", next[NAME_state_size]";
  if (network.memory.units) out += replaced(kGates, "COUNT", std::to_string(layers.memory[0].out));
  if (network.latent) out += format(", row[NAME_obs_dim], latent[%d]", network.latent);
  return out;
}

// The hidden layers, a step of the GRU, the last layer.
std::string gru_text(const Network& network, const Layers& layers, bool int8) {
  const std::vector<Layer> hidden(layers.actor.begin(), layers.actor.end() - 1);
  std::string out = layer_calls(hidden, int8, "  ", "NAME_activate");
  const char* seen = hidden.size() % 2 ? "back" : "front";
  if (!hidden.empty()) out += format("  NAME_activate(%s, %zu);\n", seen, hidden.back().out);
  out +=
      layer_call(layers.memory[0], int8, seen, "gates") + layer_call(layers.memory[1], int8, "state", "part");
  const int32_t units = network.memory.units;
  out += replaced(replaced(kGru, "UNITS", std::to_string(units)), "TWICE", std::to_string(2 * units));
  return out + layer_call(layers.actor.back(), int8, "next", last_row(layers.actor));
}

std::string act_text(const Network& network, const Layers& layers, bool int8) {
  const Memory& m = network.memory;
  const Eyes& e = network.eyes;
  std::string out = with_rows(kActHead, shared_rows(network, layers));
  out = replaced(replaced(out, "DECLARATION", call_of(network).declaration), "ROWS",
                 rows_text(network, layers));
  out = replaced(
      out, "FAULT",
      e.points ? "NAME_see(points, " + channels_of(e, "") + "count, features)" : std::string("0.0f"));
  out =
      eyes_text(network, layers, int8) + out + kRow + (network.find("normalizer.clip") ? kNormalise : kTake);
  if (m.size && !m.units) out += replaced(kHistory, "KEPT", std::to_string(m.columns.size()));
  out += latent_text(network, layers, int8) + features_text(network, layers);
  out += m.units ? gru_text(network, layers, int8) : layer_calls(layers.actor, int8, "  ", "NAME_activate");
  return out + replaced(kActTail, "LAST", last_row(layers.actor)) + (m.size ? kKeepState : "") + "}\n";
}

// The self-test's clouds.
std::string test_points_text(const Eyes& e) {
  if (e.points == 0) return "";
  const int32_t reach = reach_of(e);
  std::string parameters, lines;
  if (e.classes) {
    parameters += ", unsigned char *point_class";
    lines += format("    point_class[i / 3] = (unsigned char)(i / 3 %% %d);\n", e.classes);
  }
  if (e.color) {
    parameters += ", unsigned char *point_color";
    lines += "    point_color[i] = (unsigned char)(i * 37 % 256);\n";
  }
  std::string out = replaced(replaced(kDrawPoints, "DRAW_PARAMETER", parameters), "DRAW_LINE", lines);
  out = replaced(out, "TEST_POINTS", std::to_string(test_points(e)));
  return replaced(replaced(out, "SPAN", std::to_string(2 * reach + 1)), "REACH", std::to_string(reach));
}
std::string test_main_text(const Network& network) {
  const Eyes& e = network.eyes;
  std::string cloud, draw, refused;
  if (e.points) {
    cloud = "  static float points[3 * NAME_test_points];\n";
    if (e.classes) cloud += "  static unsigned char point_class[NAME_test_points];\n";
    if (e.color) cloud += "  static unsigned char point_color[3 * NAME_test_points];\n";
    cloud += "  const int count = NAME_test_points;\n";
    draw = format("    NAME_draw_points(&random, points%s%s);\n", e.classes ? ", point_class" : "",
                  e.color ? ", point_color" : "");
    refused = kRefusePoints;
    if (e.classes) refused += replaced(kRefuseClasses, "CLASSES", std::to_string(e.classes));
  }
  if (network.memory.size)
    cloud += "  static float state[NAME_state_size];\n";  // zeros; the rows are an episode
  std::string out = replaced(replaced(kTestMain, "CLOUD", cloud), "DRAW", draw);
  out = replaced(out, "REFUSED", refused);
  const Call call = call_of(network);
  return replaced(replaced(out, "NO_POINTS", call.no_points), "CALL", call.call);
}

std::string head_text(const Network& network, const std::vector<Layer>& layers,
                      const std::vector<ObsField>& fields, const ActionBounds& bounds,
                      const rdm_policy_info& info) {
  const Eyes& e = network.eyes;
  const Call call = call_of(network);
  std::string out = kHead, beside, sees;
  if (e.points) {
    beside = "points[3 * NAME_num_points], ";
    sees = kSees;
    if (e.classes) sees += kSeesClasses;
    if (e.color) sees += kSeesColors;
  }
  if (network.memory.size)
    beside += "state[NAME_state_size] = {0}, ", sees += replaced(kRemembers, "FUNCTION", call.function);
  out = replaced(
      replaced(replaced(out, "BESIDE", beside), "CALL", replaced(call.call, "count", "NAME_num_points")),
      "SEES", sees);
  std::string held;
  for (size_t j = 0; j < bounds.low.size(); ++j)
    if (bounds.low[j] > -1 || bounds.high[j] < 1)
      held += format(" *   action[%zu]  %g .. %g\n", j, static_cast<double>(bounds.low[j]),
                     static_cast<double>(bounds.high[j]));
  if (!held.empty()) held = kHeld + held;
  out = replaced(out, "HELD", held);
  const uint32_t v = rdm_version();
  std::string shape;
  for (int32_t l = 0; l < e.num_layers; ++l)
    shape += (l ? " -> " : "each point -> ") +
             std::to_string(network.find("encoder." + std::to_string(l) + ".bias")->shape[0]) + ' ' +
             e.activation;
  if (e.points) shape += format(", the largest of all; %d beside ", e.features);
  shape += std::to_string(network.obs_dim);
  if (network.latent) shape += format(" with a latent of %d", network.latent);
  for (size_t l = 0; l + 1 < layers.size(); ++l)
    shape += " -> " + std::to_string(network.find("actor." + layers[l].number + ".bias")->shape[0]) + ' ' +
             network.activation;
  if (network.memory.units) shape += format(" -> GRU %d", network.memory.units);
  if (network.memory.size && !network.memory.units)
    shape += format(", with a history of %d", network.memory.size);
  shape += " -> " + std::to_string(network.action_dim);
  if (!fields.empty()) {
    const bool whole = std::all_of(fields.begin(), fields.end(), [](const ObsField& f) { return f.seen; });
    out += format(" *\n * Observation: entries, field, unit%s\n",
                  whole ? "" : "; entries that are not observed may have any finite value");
    for (const ObsField& f : fields)
      out += format(" *   %4d ..%4d  %s  %s%s\n", f.offset, f.offset + f.count - 1, harmless(f.name).c_str(),
                    replaced(f.unit, "*/", "").c_str(), f.seen ? "" : "  (not observed)");
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

size_t widest_of(const Layers& layers) {
  size_t widest =
      std::max(buffer_sizes(layers.actor).widest, layers.eyes.empty() ? 0 : buffer_sizes(layers.eyes).widest);
  for (const Layer& layer : layers.memory) widest = std::max(widest, layer.in);
  for (const Layer& layer : layers.latent) widest = std::max(widest, layer.in);
  return widest;
}
size_t stack_bytes(const Network& network, const Layers& layers, bool int8) {
  const Sizes s = buffer_sizes(shared_rows(network, layers));
  size_t floats = s.front + s.back;
  if (network.latent) floats += static_cast<size_t>(network.obs_dim + network.latent);
  if (!layers.eyes.empty()) {
    const Sizes e = buffer_sizes(layers.eyes);
    floats += e.front + e.back + static_cast<size_t>(network.eyes.features);
  }
  floats += static_cast<size_t>(network.memory.size);
  for (const Layer& layer : layers.memory) floats += layer.out;
  return floats * sizeof(float) + (int8 ? (widest_of(layers) + kSpare) * sizeof(int16_t) : 0);
}

}  // namespace

void hold_to(const ActionBounds& bounds, std::vector<float>& actions) {
  const size_t dim = bounds.low.size();
  for (size_t i = 0; dim > 0 && i < actions.size(); ++i)
    actions[i] = std::clamp(actions[i], bounds.low[i % dim], bounds.high[i % dim]);
}

CSource c_source(const redman::Policy& policy, const Network& network, const std::string& name,
                 const std::vector<ObsField>& fields, const ActionBounds& bounds, bool int8) {
  const Layers layers = layers_of(network, int8);
  const Eyes& eyes = network.eyes;
  const NamedTensor* clip = network.find("normalizer.clip");
  const TestRows tests = test_rows(network);
  std::vector<float> expected = mean_actions(policy, tests.obs, tests.clouds);
  hold_to(bounds, expected);
  CSource out;
  double tolerance = kFloatTolerance;
  std::string weights = "32-bit floats";
  if (int8) {
    const size_t rows =
        eyes.points ? std::clamp<size_t>(kErrorPoints / static_cast<size_t>(eyes.points), 10, kErrorRows)
                    : kErrorRows;
    std::vector<float> obs = probe_observations(network, rows, 0);
    Clouds clouds = probe_clouds(network, rows, 0);
    std::vector<float> exact = mean_actions(policy, obs, clouds);
    hold_to(bounds, exact);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(obs, tests.obs);
    append(clouds.points, tests.clouds.points);
    append(clouds.classes, tests.clouds.classes);
    append(clouds.colors, tests.clouds.colors);
    append(exact, expected);
    const auto in = static_cast<size_t>(network.obs_dim), dim = static_cast<size_t>(network.action_dim);
    double squares = 0;
    std::vector<float> state;
    for (size_t row = 0; row < obs.size() / in; ++row) {
      std::vector<float> action = run_layers(network, layers, obs.data() + row * in, clouds, row, state);
      hold_to(bounds, action);
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
        upwards(out.largest_error), upwards(out.rms_error), rows);
  }

  Tables tables;
  if (clip) {
    auto shift = network.find("normalizer.shift")->values, scale = network.find("normalizer.scale")->values;
    for (float& v : shift) v = plain(v);
    tables.add("shift", shift);
    tables.add("scale", scale);
  }
  const bool held = !bounds.low.empty();
  if (held) tables.add("low", bounds.low), tables.add("high", bounds.high);
  if (eyes.points) tables.add("origin", std::vector<float>(eyes.origin, eyes.origin + 3));
  for (const auto* part : {&layers.actor, &layers.eyes, &layers.memory, &layers.latent})
    for (const Layer& layer : *part) {
      if (int8)
        tables.add("weight_" + layer.number, layer.small), tables.add("scale_" + layer.number, layer.scale);
      else
        tables.add("weight_" + layer.number, layer.weight);
      tables.add("bias_" + layer.number, layer.bias);
    }
  const rdm_policy_info& info = policy.info();
  std::string& text = out.text;
  text = head_text(network, layers.actor, fields, bounds, info);
  std::string sizes;
  if (network.memory.size) sizes += format(", NAME_state_size = %d", network.memory.size);
  if (eyes.points)
    sizes += format(",\n       NAME_num_points = %d, NAME_num_point_classes = %d", eyes.points, eyes.classes);
  text += replaced(replaced(kDeclarations, "DECLARATION", call_of(network).declaration), "EYE_SIZES", sizes);
  text += tables.text();
  if (const auto& kept = network.memory.columns; !kept.empty()) {
    text += format("static const uint16_t NAME_kept[%zu] = {", kept.size());
    for (size_t i = 0; i < kept.size(); ++i) text += format(i % 16 ? "%d, " : "\n  %d, ", kept[i]);
    text += "\n};\n";
  }
  text += kFma;
  text += activations_text(network, layers);
  text += int8 ? kLayerInt8 : kLayerFloat;
  text += act_text(network, layers, int8);
  text += kTestHead;
  text += tables.table("example_obs", network.find("example.obs")->values);
  text += tables.table("expected", expected);
  text += int8 ? std::string(kSumBytes) + kSumFloats : std::string(kSumFloats);
  text += replaced(replaced(kDraw, "DRAWN", clip ? "u / NAME_scale[i] + NAME_shift[i]" : "u"), "SPREAD",
                   literal(static_cast<double>(kTestSpread)));
  text = replaced(text, "FAR", literal(static_cast<double>(kTestFar)));
  text += test_points_text(eyes);
  text += replaced(test_main_text(network), "SUMS", tables.calls());
  for (const auto& [word, by] : std::vector<std::pair<std::string, std::string>>{
           {"WEIGHTS", weights},
           {"STACK", std::to_string(stack_bytes(network, layers, int8))},
           {"OBS_DIM", std::to_string(network.obs_dim)},
           {"ACTION_DIM", std::to_string(network.action_dim)},
           {"REPEAT", std::to_string(info.action_repeat)},
           {"WIDEST", std::to_string(widest_of(layers) + kSpare)},
           {"CLIP", clip ? literal(static_cast<double>(clip->values[0])) : ""},
           {"ROWS", std::to_string(kTestRows)},
           {"TOLERANCE", literal(tolerance)},
           {"CHECKSUM", format("0x%08xu", tables.checksum())},
           {"MEAN_ACTION",
            squashes(network) ? "tanh of the network's mean" : "mean action, clipped to [-1, 1]"},
           {"SQUASH_OPEN", squashes(network) ? "NAME_tanh(" : ""},
           {"SQUASH_CLOSE", squashes(network) ? ")" : ""},
           {"LOWEST", held ? "NAME_low[i]" : "-1.0f"},
           {"HIGHEST", held ? "NAME_high[i]" : "1.0f"},
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
                ": it cannot begin a C name; give a letter, then letters, digits and single underscores");
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
