#include "network/network.hpp"

#include <cinttypes>

#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

std::string join(const NamedTensor* t) {
  std::string out;
  for (const float v : t->values) out += (out.empty() ? "" : " ") + format("%.9g", static_cast<double>(v));
  return out;
}

}  // namespace

Network::Network(const redman::Policy& policy) {
  const rdm_policy_info& info = policy.info();
  activation = info.activation;
  obs_dim = info.obs_dim;
  action_dim = info.action_dim;
  for (const rdm_tensor& t : policy.tensors()) {
    NamedTensor tensor{t.name, {t.rows}, policy.read(t)};
    if (tensor.name.find(".weight") != std::string::npos) {
      tensor.shape.push_back(t.cols);
      ++num_layers;
    }
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
              {"library", format("redman %u.%u.%u", v / 1000000, v / 1000 % 1000, v % 1000)},
              {"example_obs", join(find("example.obs"))},
              {"example_action", join(find("example.action"))}};
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
