// A policy's numbers by name, and the files that other programs read them from.
#pragma once
#include <redman/redman.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tool {

struct NamedTensor {
  std::string name;
  std::vector<int64_t> shape;
  std::vector<float> values;  // row-major
};

// The PointNet of a policy that sees points: z = its layers, the last one linear, of (millimetres / (1000
// range), one-hot class, colour / 255); features = activation(max z over points).
struct Eyes {
  int32_t points = 0;  // of a cloud, 0: there are no eyes
  int32_t classes = 0, features = 0, num_layers = 0;
  bool color = false;
  std::string activation;  // of hidden layers and features
  float origin[3] = {};    // m
  float range = 1;         // m
};

// What a policy remembers of each world, zeros at first: the state of a GRU before its last layer, or the columns of
// the decisions before this one, newest first, which stand behind the row.
struct Memory {
  int32_t size = 0;              // numbers, 0: there is no memory
  int32_t units = 0;             // of the GRU, 0: it is a history
  std::vector<int32_t> columns;  // of a row, that the history keeps
};

struct Network {
  explicit Network(const redman::Policy& policy);

  std::string activation;  // "tanh", "elu", "relu"
  int32_t obs_dim = 0, action_dim = 0, num_layers = 0;
  Eyes eyes;
  Memory memory;
  // Numbers that the layers latent.0 and on make of the row, and of the history behind it, for the actor, whose layers
  // read the row with these behind it; 0: there are none.
  int32_t latent = 0, latent_layers = 0;
  std::vector<NamedTensor> tensors;  // as rdm_policy_tensor_at names them
  // What a reader has to know beside the numbers: task, layout hash, rates, bounds of the action, entries of
  // a row that count.
  std::vector<std::pair<std::string, std::string>> metadata;

  const NamedTensor* find(const std::string& name) const;  // null: there is none
};

// ONNX, IR 8, operators 17: input obs [batch][obs_dim]; outputs action [batch][action_dim] clipped to [-1,
// 1], mean (the same before the clip) and log_std [action_dim], or [batch][action_dim] where it depends on
// the state. The normaliser is part of the graph. Of a policy with eyes there are the inputs points [batch]
// [num_points][3], m, where it tells classes apart point_class [batch][num_points], bytes, and where it sees
// colours point_color [batch][num_points][3], bytes: with any num_points, for what comes twice changes
// nothing. The encoder is part of the graph too. Of a policy with a memory there is the input state [batch]
// [state_dim], zeros where an episode begins, and the output next_state: plain operators again.
std::string onnx_bytes(const Network& network);

// safetensors: a JSON header and the numbers.
std::string safetensors_bytes(const Network& network);

}  // namespace tool
