// ONNX: the graph of a policy as a protobuf message. Field numbers are those of onnx.proto.
#include "network/network.hpp"
#include "network/protobuf.hpp"

namespace tool {
namespace {

constexpr int64_t kIr = 8, kOperators = 17, kFloat = 1;

// TensorProto
Message tensor_message(const std::string& name, const std::vector<int64_t>& shape,
                       const std::vector<float>& values) {
  Message m;
  for (const int64_t n : shape) m.integer(1, n);
  m.integer(2, kFloat);
  m.text(8, name);
  m.text(9, std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
  return m;
}

// ValueInfoProto of a float tensor; a size of 0 is the free batch size.
Message value_message(const std::string& name, const std::vector<int64_t>& shape) {
  Message dims;
  for (const int64_t n : shape) {
    Message dim;
    if (n)
      dim.integer(1, n);
    else
      dim.text(2, "batch");
    dims.message(1, dim);
  }
  Message tensor, type, m;
  tensor.integer(1, kFloat);
  tensor.message(2, dims);
  type.message(1, tensor);
  m.text(1, name);
  m.message(2, type);
  return m;
}

// The graph as it is built: each node reads values by name and writes one.
class Graph {
 public:
  std::string constant(const std::string& name, const std::vector<int64_t>& shape,
                       const std::vector<float>& values) {
    tensors_.push_back(tensor_message(name, shape, values));
    return name;
  }
  std::string constant(const NamedTensor& t) { return constant(t.name, t.shape, t.values); }
  std::string node(const char* type, const std::vector<std::string>& in, const std::string& out,
                   bool transpose_second = false) {
    Message m;
    for (const std::string& name : in) m.text(1, name);
    m.text(2, out);
    m.text(3, out);
    m.text(4, type);
    if (transpose_second) {
      Message attribute;
      attribute.text(1, "transB");
      attribute.integer(3, 1);
      attribute.integer(20, 2);  // an integer
      m.message(5, attribute);
    }
    nodes_.push_back(std::move(m));
    return out;
  }
  void input(const std::string& name, const std::vector<int64_t>& shape) {
    inputs_.push_back(value_message(name, shape));
  }
  void output(const std::string& name, const std::vector<int64_t>& shape) {
    outputs_.push_back(value_message(name, shape));
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
  x = graph.node(
      "Clip",
      {x, graph.constant("normalizer.low", {}, {-bound}), graph.constant("normalizer.high", {}, {bound})},
      "normalized");
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
                     const NamedTensor& bounds) {
  const auto part = [&](bool second, const char* out) {
    return graph.node("Gemm", {x, graph.constant(half(weight, second)), graph.constant(half(bias, second))},
                      out, true);
  };
  graph.node("Clip",
             {part(true, "log_std.free"), graph.constant("log_std.low", {}, {bounds.values[0]}),
              graph.constant("log_std.high", {}, {bounds.values[1]})},
             "log_std");
  return part(false, "mean");
}

}  // namespace

std::string onnx_bytes(const Network& network) {
  Graph graph;
  graph.input("obs", {0, network.obs_dim});
  std::string x = "obs";
  add_normalizer(network, graph, x);
  const NamedTensor *log_std = network.find("actor.log_std"), *bounds = network.find("actor.log_std_bounds");
  for (int32_t l = 0; l < network.num_layers; ++l) {
    const std::string layer = "actor." + std::to_string(l);
    const bool last = l + 1 == network.num_layers;
    const NamedTensor &weight = *network.find(layer + ".weight"), &bias = *network.find(layer + ".bias");
    if (last && bounds)
      x = add_head(graph, x, weight, bias, *bounds);
    else
      x = graph.node("Gemm", {x, graph.constant(weight), graph.constant(bias)}, last ? "mean" : layer, true);
    if (!last) x = graph.node(activation_operator(network.activation).c_str(), {x}, layer + ".out");
  }
  graph.node("Clip", {x, graph.constant("action.low", {}, {-1}), graph.constant("action.high", {}, {1})},
             "action");
  if (log_std) graph.node("Identity", {graph.constant(*log_std)}, "log_std");
  graph.output("action", {0, network.action_dim});
  graph.output("mean", {0, network.action_dim});
  if (log_std)
    graph.output("log_std", {network.action_dim});
  else
    graph.output("log_std", {0, network.action_dim});

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
