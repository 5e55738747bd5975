// ONNX: the graph of a policy as a protobuf message. Field numbers are those of onnx.proto.
#include <type_traits>

#include "network/network.hpp"
#include "network/protobuf.hpp"

namespace tool {
namespace {

constexpr int64_t kIr = 8, kOperators = 17;
enum Type : int64_t { kFloat32 = 1, kByte = 2, kInteger = 7, kDouble = 11 };  // TensorProto.DataType
constexpr int64_t kBatch = 0, kNumPoints = -1;                                // sizes that are free

template <class T>
constexpr Type kTypeOf = std::is_same_v<T, float>    ? kFloat32
                         : std::is_same_v<T, double> ? kDouble
                                                     : kInteger;

// TensorProto
template <class T>
Message tensor_message(const std::string& name, const std::vector<int64_t>& shape,
                       const std::vector<T>& values) {
  Message m;
  for (const int64_t n : shape) m.integer(1, n);
  m.integer(2, kTypeOf<T>);
  m.text(8, name);
  m.text(9, std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
  return m;
}

// ValueInfoProto
Message value_message(const std::string& name, const std::vector<int64_t>& shape, Type element) {
  Message dims;
  for (const int64_t n : shape) {
    Message dim;
    if (n > 0)
      dim.integer(1, n);
    else
      dim.text(2, n == kBatch ? "batch" : "num_points");
    dims.message(1, dim);
  }
  Message tensor, type, m;
  tensor.integer(1, element);
  tensor.message(2, dims);
  type.message(1, tensor);
  m.text(1, name);
  m.message(2, type);
  return m;
}

// Of a node: one integer, or a list of them.
struct Attribute {
  const char* name;
  int64_t value;
  bool list = false;
};

// The graph as it is built: each node reads values by name and writes one.
class Graph {
 public:
  template <class T = float>
  std::string constant(const std::string& name, const std::vector<int64_t>& shape,
                       const std::vector<T>& values) {
    tensors_.push_back(tensor_message(name, shape, values));
    return name;
  }
  std::string constant(const NamedTensor& t) { return constant(t.name, t.shape, t.values); }
  std::string node(const char* type, const std::vector<std::string>& in, const std::string& out,
                   const std::vector<Attribute>& attributes = {}) {
    Message m;
    for (const std::string& name : in) m.text(1, name);
    m.text(2, out);
    m.text(3, out);
    m.text(4, type);
    for (const Attribute& a : attributes) {
      Message attribute;
      attribute.text(1, a.name);
      attribute.integer(a.list ? 8 : 3, a.value);
      attribute.integer(20, a.list ? 7 : 2);  // AttributeProto.AttributeType
      m.message(5, attribute);
    }
    nodes_.push_back(std::move(m));
    return out;
  }
  void input(const std::string& name, const std::vector<int64_t>& shape, Type element = kFloat32) {
    inputs_.push_back(value_message(name, shape, element));
  }
  void output(const std::string& name, const std::vector<int64_t>& shape) {
    outputs_.push_back(value_message(name, shape, kFloat32));
  }
  // GraphProto
  Message message() const {
    Message m;
    for (const Message& n : nodes_) m.message(1, n);
    m.text(2, "policy");
    for (const Message& t : tensors_) m.message(5, t);
    for (const Message& v : inputs_) m.message(11, v);
    for (const Message& v : outputs_) m.message(12, v);
    return m;
  }

 private:
  std::vector<Message> nodes_, tensors_, inputs_, outputs_;
};

std::string activation_operator(const std::string& name) {
  if (name == "tanh") return "Tanh";
  if (name == "elu") return "Elu";
  return "Relu";
}

void add_normalizer(const Network& network, Graph& graph, std::string& x) {
  const NamedTensor* clip = network.find("normalizer.clip");
  if (!clip) return;
  x = graph.node("Sub", {x, graph.constant(*network.find("normalizer.shift"))}, "centred");
  x = graph.node("Mul", {x, graph.constant(*network.find("normalizer.scale"))}, "scaled");
  const float bound = clip->values[0];
  x = graph.node("Clip",
                 {x, graph.constant<float>("normalizer.low", {}, {-bound}),
                  graph.constant<float>("normalizer.high", {}, {bound})},
                 "normalized");
}

std::string add_classes(const Eyes& eyes, Graph& graph) {
  graph.input("point_class", {kBatch, kNumPoints}, kByte);
  const std::string number = graph.node("Cast", {"point_class"}, "point_class.number", {{"to", kInteger}}),
                    depth = graph.constant<int64_t>("point_class.count", {}, {eyes.classes}),
                    values = graph.constant<float>("point_class.values", {2}, {0, 1});
  return graph.node("OneHot", {number, depth, values}, "point_class.one_hot");
}

// What the encoder sees of points: whole millimetres from its origin, in units of its range, class and
// colour. In doubles, as the library has it: with floats a half could become the other millimetre.
std::string add_points(const Eyes& eyes, Graph& graph) {
  graph.input("points", {kBatch, kNumPoints, 3});
  const std::vector<double> origin(eyes.origin, eyes.origin + 3);
  std::string x = graph.node("Cast", {"points"}, "points.double", {{"to", kDouble}});
  x = graph.node("Sub", {x, graph.constant("points.origin", {3}, origin)}, "points.metres");
  x = graph.node("Mul", {x, graph.constant<double>("points.thousand", {}, {1000})}, "points.millimetres");
  x = graph.node("Clip",
                 {x, graph.constant<double>("points.low", {}, {-32767}),
                  graph.constant<double>("points.high", {}, {32767})},
                 "points.bounded");
  x = graph.node("Round", {x}, "points.whole");
  x = graph.node("Cast", {x}, "points.float", {{"to", kFloat32}});
  x = graph.node("Mul", {x, graph.constant<float>("points.step", {}, {0.001f / eyes.range})},
                 "points.scaled");
  std::vector<std::string> seen = {x};
  if (eyes.classes) seen.push_back(add_classes(eyes, graph));
  if (eyes.color) {
    graph.input("point_color", {kBatch, kNumPoints, 3}, kByte);
    const std::string color = graph.node("Cast", {"point_color"}, "point_color.float", {{"to", kFloat32}});
    seen.push_back(graph.node("Div", {color, graph.constant<float>("point_color.largest", {}, {255})},
                              "point_color.scaled"));
  }
  return seen.size() == 1 ? x : graph.node("Concat", seen, "points.seen", {{"axis", 2}});
}

NamedTensor transposed(const NamedTensor& t) {
  const auto rows = static_cast<size_t>(t.shape[0]), cols = static_cast<size_t>(t.shape[1]);
  NamedTensor out{t.name + ".transposed", {t.shape[1], t.shape[0]}, std::vector<float>(t.values.size())};
  for (size_t r = 0; r < rows; ++r)
    for (size_t c = 0; c < cols; ++c) out.values[c * rows + r] = t.values[r * cols + c];
  return out;
}

// Features of the cloud.
std::string add_eyes(const Network& network, Graph& graph) {
  const Eyes& eyes = network.eyes;
  const std::string activation = activation_operator(eyes.activation);
  std::string x = add_points(eyes, graph);
  for (int32_t l = 0; l < eyes.num_layers; ++l) {
    const std::string layer = "encoder." + std::to_string(l);
    const bool last = l + 1 == eyes.num_layers;
    const NamedTensor &weight = *network.find(layer + ".weight"), &bias = *network.find(layer + ".bias");
    x = graph.node("MatMul", {x, graph.constant(transposed(weight))}, layer + ".product");
    if (last) x = graph.node("ReduceMax", {x}, "encoder.largest", {{"axes", 1, true}, {"keepdims", 0}});
    x = graph.node("Add", {x, graph.constant(bias)}, layer);
    x = graph.node(activation.c_str(), {x}, last ? "features" : layer + ".out");
  }
  return x;
}

NamedTensor half(const NamedTensor& t, bool second) {
  NamedTensor part = t;
  const size_t n = t.values.size() / 2;
  const auto begin = t.values.begin() + static_cast<long>(second ? n : 0);
  part.name += second ? ".log_std" : ".mean";
  part.shape[0] /= 2;
  part.values.assign(begin, begin + static_cast<long>(n));
  return part;
}

// The last layer of a policy whose deviations depend on the state; returns the mean.
std::string add_head(Graph& graph, const std::string& x, const NamedTensor& weight, const NamedTensor& bias,
                     const NamedTensor& bounds, const char* mean) {
  const auto part = [&](bool second, const char* out) {
    return graph.node("Gemm", {x, graph.constant(half(weight, second)), graph.constant(half(bias, second))},
                      out, {{"transB", 1}});
  };
  graph.node("Clip",
             {part(true, "log_std.free"), graph.constant<float>("log_std.low", {}, {bounds.values[0]}),
              graph.constant<float>("log_std.high", {}, {bounds.values[1]})},
             "log_std");
  return part(false, mean);
}

// Rows [gate units, (gate + 1) units) of what is there for all three gates.
NamedTensor gate_of(const NamedTensor& t, int32_t gate) {
  static constexpr const char* kGates[] = {".r", ".z", ".n"};
  const size_t n = t.values.size() / 3;
  const auto begin = t.values.begin() + static_cast<long>(static_cast<size_t>(gate) * n);
  NamedTensor part = {t.name + kGates[gate], t.shape, {begin, begin + static_cast<long>(n)}};
  part.shape[0] /= 3;
  return part;
}

// A step of the GRU; returns the next state.
std::string add_gru(const Network& network, Graph& graph, const std::string& x) {
  const auto part = [&](const std::string& in, const char* of, int32_t gate) {
    const std::string name = std::string("memory.") + of;
    const NamedTensor weight = gate_of(*network.find(name + ".weight"), gate),
                      bias = gate_of(*network.find(name + ".bias"), gate);
    return graph.node("Gemm", {in, graph.constant(weight), graph.constant(bias)}, name + std::to_string(gate),
                      {{"transB", 1}});
  };
  const auto sum = [&](int32_t gate, const char* out) {
    return graph.node("Add", {part(x, "input", gate), part("state", "state", gate)}, out);
  };
  const std::string r = graph.node("Sigmoid", {sum(0, "memory.r.sum")}, "memory.r"),
                    z = graph.node("Sigmoid", {sum(1, "memory.z.sum")}, "memory.z"),
                    kept = graph.node("Mul", {r, part("state", "state", 2)}, "memory.kept");
  const std::string n =
      graph.node("Tanh", {graph.node("Add", {part(x, "input", 2), kept}, "memory.n.sum")}, "memory.n");
  const std::string change =
      graph.node("Mul", {z, graph.node("Sub", {"state", n}, "memory.gap")}, "memory.change");
  return graph.node("Add", {n, change}, "next_state");
}

// The row with its history behind it, and the history of the next one.
std::string add_history(const Memory& memory, Graph& graph, const std::string& x) {
  const auto width = static_cast<int64_t>(memory.columns.size());
  const std::vector<int64_t> columns(memory.columns.begin(), memory.columns.end());
  const std::string newest = graph.node("Gather", {x, graph.constant("history.kept", {width}, columns)},
                                        "history.newest", {{"axis", 1}});
  std::vector<int64_t> older;
  for (int64_t i = 0; i < memory.size - width; ++i) older.push_back(i);
  if (older.empty()) {
    graph.node("Identity", {newest}, "next_state");
  } else {
    const auto count = static_cast<int64_t>(older.size());
    const std::string rest = graph.node("Gather", {"state", graph.constant("history.older", {count}, older)},
                                        "history.rest", {{"axis", 1}});
    graph.node("Concat", {newest, rest}, "next_state", {{"axis", 1}});
  }
  return graph.node("Concat", {x, "state"}, "with_history", {{"axis", 1}});
}

// The row with its latent behind it, of what the encoder sees.
std::string add_latent(const Network& network, Graph& graph, const std::string& row, std::string x) {
  for (int32_t l = 0; l < network.latent_layers; ++l) {
    const std::string layer = "latent." + std::to_string(l);
    x = graph.node(
        "Gemm",
        {x, graph.constant(*network.find(layer + ".weight")), graph.constant(*network.find(layer + ".bias"))},
        layer, {{"transB", 1}});
    if (l + 1 < network.latent_layers)
      x = graph.node(activation_operator(network.activation).c_str(), {x}, layer + ".out");
  }
  return graph.node("Concat", {row, x}, "with_latent", {{"axis", 1}});
}

}  // namespace

std::string onnx_bytes(const Network& network) {
  Graph graph;
  graph.input("obs", {kBatch, network.obs_dim});
  std::string x = "obs";
  add_normalizer(network, graph, x);
  const Memory& memory = network.memory;
  if (memory.size) graph.input("state", {kBatch, memory.size});
  const std::string row = x;
  if (memory.size && !memory.units) x = add_history(memory, graph, x);
  if (network.latent) x = add_latent(network, graph, row, x);
  // Behind all else that the actor sees.
  if (network.eyes.points) x = graph.node("Concat", {x, add_eyes(network, graph)}, "seen", {{"axis", 1}});
  const NamedTensor *log_std = network.find("actor.log_std"), *bounds = network.find("actor.log_std_bounds");
  const bool squash = network.find("action.squash") != nullptr;
  for (int32_t l = 0; l < network.num_layers; ++l) {
    const std::string layer = "actor." + std::to_string(l);
    const bool last = l + 1 == network.num_layers;
    if (last && memory.units) x = add_gru(network, graph, x);
    const NamedTensor &weight = *network.find(layer + ".weight"), &bias = *network.find(layer + ".bias");
    const char* const mean = squash ? "mean.free" : "mean";
    if (last && bounds)
      x = add_head(graph, x, weight, bias, *bounds, mean);
    else
      x = graph.node("Gemm", {x, graph.constant(weight), graph.constant(bias)}, last ? mean : layer,
                     {{"transB", 1}});
    if (!last) x = graph.node(activation_operator(network.activation).c_str(), {x}, layer + ".out");
  }
  if (squash) x = graph.node("Tanh", {x}, "mean");
  graph.node(
      "Clip",
      {x, graph.constant<float>("action.low", {}, {-1}), graph.constant<float>("action.high", {}, {1})},
      "action");
  if (log_std) graph.node("Identity", {graph.constant(*log_std)}, "log_std");
  graph.output("action", {kBatch, network.action_dim});
  graph.output("mean", {kBatch, network.action_dim});
  if (log_std)
    graph.output("log_std", {network.action_dim});
  else
    graph.output("log_std", {kBatch, network.action_dim});
  if (memory.size) graph.output("next_state", {kBatch, memory.size});

  Message operators, model;  // ModelProto
  operators.text(1, "");
  operators.integer(2, kOperators);
  model.integer(1, kIr);
  model.text(2, "redman");
  model.message(7, graph.message());
  model.message(8, operators);
  for (const auto& [key, value] : network.metadata) {
    Message entry;
    entry.text(1, key);
    entry.text(2, value);
    model.message(14, entry);
  }
  return model.bytes();
}

}  // namespace tool
