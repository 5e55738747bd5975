#include "network/network.hpp"

#include <algorithm>
#include <cinttypes>

#include "common/presets.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

std::string join(const NamedTensor* t) {
  std::string out;
  for (const float v : t->values) out += (out.empty() ? "" : " ") + format("%.9g", static_cast<double>(v));
  return out;
}

// What a file says of the eyes beside their weights.
void read_eyes(Network& n, const rdm_policy_info& info) {
  Eyes& e = n.eyes;
  e.points = info.num_points;
  if (e.points == 0) return;
  constexpr const char* kActivations[] = {"tanh", "elu", "relu"};  // as rdm_policy_tensor_at numbers them
  e.classes = info.num_point_classes;
  e.color = info.point_color != 0;
  e.features = info.num_features;
  for (const NamedTensor& t : n.tensors)
    e.num_layers += t.name.starts_with("encoder.") && t.name.find(".weight") != std::string::npos;
  e.activation = kActivations[static_cast<size_t>(n.find("encoder.activation")->values[0])];
  const NamedTensor* origin = n.find("encoder.origin");
  std::copy(origin->values.begin(), origin->values.end(), e.origin);
  e.range = n.find("encoder.range")->values[0];
  n.metadata.insert(n.metadata.end(), {{"num_points", std::to_string(e.points)},
                                       {"num_point_classes", std::to_string(e.classes)},
                                       {"point_color", std::to_string(e.color)},
                                       {"num_features", std::to_string(e.features)},
                                       {"encoder_activation", e.activation},
                                       {"encoder_origin", join(origin)},
                                       {"encoder_range", join(n.find("encoder.range"))},
                                       {"example_points", join(n.find("example.points"))}});
  if (e.classes) n.metadata.push_back({"example_point_class", join(n.find("example.point_class"))});
  if (e.color) n.metadata.push_back({"example_point_color", join(n.find("example.point_color"))});
}

void read_memory(Network& n, const rdm_policy_info& info) {
  Memory& m = n.memory;
  m.size = info.state_dim;
  if (m.size == 0) return;
  if (const NamedTensor* columns = n.find("history.columns"))
    for (const float v : columns->values) m.columns.push_back(static_cast<int32_t>(v));
  else
    m.units = m.size;
  n.metadata.insert(n.metadata.end(), {{"state_dim", std::to_string(m.size)},
                                       {"state_at_start", "zeros"},
                                       {"memory", m.units ? "gru" : "history"}});
}

}  // namespace

Network::Network(const redman::Policy& policy) {
  const rdm_policy_info& info = policy.info();
  activation = info.activation;
  obs_dim = info.obs_dim;
  action_dim = info.action_dim;
  for (const rdm_tensor& t : policy.tensors()) {
    NamedTensor tensor{t.name, {t.rows}, policy.read(t)};
    const bool weight = tensor.name.find(".weight") != std::string::npos;
    if (weight || t.cols > 1) tensor.shape.push_back(t.cols);
    num_layers += weight && tensor.name.starts_with("actor.");
    latent_layers += weight && tensor.name.starts_with("latent.");
    if (tensor.name.starts_with("latent.")) latent = static_cast<int32_t>(tensor.shape[0]);
    tensors.push_back(std::move(tensor));
  }
  const uint32_t v = rdm_version();
  metadata = {{"task", info.task},
              {"layout_hash", format("%016" PRIx64, info.layout_hash)},
              {"action_low", "-1"},
              {"action_high", "1"},
              {"control_dt", format("%.9g", static_cast<double>(info.control_dt))},
              {"action_repeat", std::to_string(info.action_repeat)},
              {"noise_correlation", format("%.9g", static_cast<double>(info.noise_correlation))},
              {"activation", activation},
              {"observation_entries", ranges_text(policy_columns(policy.get()))},
              {"library", format("redman %u.%u.%u", v / 1000000, v / 1000 % 1000, v % 1000)},
              {"example_obs", join(find("example.obs"))},
              {"example_action", join(find("example.action"))}};
  if (latent) metadata.push_back({"latent", std::to_string(latent)});
  read_eyes(*this, info);
  read_memory(*this, info);
}

const NamedTensor* Network::find(const std::string& name) const {
  for (const NamedTensor& t : tensors)
    if (t.name == name) return &t;
  return nullptr;
}

std::string safetensors_bytes(const Network& network) {
  Json header = Json::object();
  Json& metadata = header["__metadata__"];
  for (const auto& [key, value] : network.metadata)
    if (key.rfind("example", 0) != 0) metadata[key] = value;
  std::string numbers;
  for (const NamedTensor& t : network.tensors) {
    const size_t begin = numbers.size();
    numbers.append(reinterpret_cast<const char*>(t.values.data()), t.values.size() * sizeof(float));
    header[t.name] = {{"dtype", "F32"}, {"shape", t.shape}, {"data_offsets", {begin, numbers.size()}}};
  }
  std::string text = header.dump();
  text.resize((text.size() + 7) / 8 * 8, ' ');  // so that the numbers are aligned
  const uint64_t length = text.size();
  return std::string(reinterpret_cast<const char*>(&length), sizeof length) + text + numbers;
}

}  // namespace tool
