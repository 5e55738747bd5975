// Options as text, for every task and algorithm: lines "key=value", as a list and as config.settings. What
// the asking call takes can be made, in the memory that it named; what it answers for its settings is taken
// again.
#include "fuzz.hpp"

namespace hard {
namespace {

constexpr size_t kMostOptions = 8, kMostMemory = 32 << 20;

struct Lines {
  std::vector<std::string> keys, values;
  std::vector<rdm_option> options;
  std::string text;
  Lines(const unsigned char* data, size_t size) : text(reinterpret_cast<const char*>(data), size) {
    for (size_t at = 0; at < text.size() && keys.size() < kMostOptions;) {
      const size_t end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(at, end - at);
      const size_t equals = std::min(line.find('='), line.size());
      keys.push_back(line.substr(0, equals));
      values.push_back(equals < line.size() ? line.substr(equals + 1) : "");
      at = end + 1;
    }
    for (size_t i = 0; i < keys.size(); ++i) {
      rdm_option o{keys[i].c_str(), values[i].c_str(), 0};
      // "#" and eight bytes are a number as it lies in memory
      if (values[i].size() == 9 && values[i][0] == '#') {
        std::memcpy(&o.number, values[i].data() + 1, 8);
        o.text = nullptr;
      }
      options.push_back(o);
    }
  }
};

// Every second time as one text.
template <class Config>
void give(const Lines& lines, Config& c) {
  static unsigned n = 0;
  if (++n % 2 == 0) {
    c.settings = lines.text.c_str();
  } else {
    c.options = lines.options.data();
    c.num_options = static_cast<int32_t>(lines.options.size());
  }
}

template <class Handle>
std::string settings_of(rdm_result (*ask)(const Handle*, char*, size_t, size_t*), const Handle* h) {
  size_t size = 0;
  HARD_REQUIRE(ask(h, nullptr, 0, &size) == RDM_OK, "%s", rdm_last_error());
  std::string out(size + 1, '\0');
  HARD_REQUIRE(ask(h, out.data(), out.size(), &size) == RDM_OK, "%s", rdm_last_error());
  return out;
}

// Making takes longer than asking: of what is taken, every fourth is made.
bool make_it() {
  static unsigned n = 0;
  return ++n % 4 == 0;
}

bool is_cheap(const World& w) {
  return w.engine.empty();
}

void ask_task(const World& w, Lines& lines) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = w.task.c_str();
  give(lines, c);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  const rdm_result r = rdm_pool_config_spec(&c, &spec);
  if (r != RDM_OK) return require_refusal(r);
  size_t ours = 0, engines = 0;
  HARD_REQUIRE(rdm_pool_config_memory(&c, &ours, &engines) == RDM_OK, "spec took what memory refuses: %s",
               rdm_last_error());
  if (ours > kMostMemory || !make_it()) return;
  rdm_pool* p = nullptr;
  HARD_REQUIRE(rdm_pool_create(&p, &c) == RDM_OK, "spec took what create refuses: %s", rdm_last_error());
  HARD_REQUIRE(rdm_pool_reset(p, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
  const rdm_result step = rdm_pool_step(p);
  if (step != RDM_OK) require_refusal(step);
  const char* key;
  char text[RDM_TEXT_SIZE];
  for (int32_t i = 0; rdm_pool_setting_at(p, i, &key, text) == RDM_OK; ++i)
    HARD_REQUIRE(good_text(text), "option %s", key);
  const std::string settings = settings_of<rdm_pool>(rdm_pool_get_settings, p);
  c.options = nullptr;
  c.num_options = 0;
  c.settings = settings.c_str();
  HARD_REQUIRE(rdm_pool_config_spec(&c, &spec) == RDM_OK, "its own settings: %s", rdm_last_error());
  rdm_pool_destroy(p);
}

void ask_algo(const std::string& algo, Lines& lines) {
  rdm_agent_config c;
  rdm_agent_config_init(&c, sizeof c);
  c.algo = algo.c_str();
  c.obs_dim = 2;
  c.action_dim = 1;
  c.num_envs = 2;
  give(lines, c);
  size_t bytes = 0;
  const rdm_result r = rdm_agent_config_memory(&c, &bytes);
  if (r != RDM_OK) return require_refusal(r);
  if (bytes > kMostMemory / 8 || !make_it()) return;
  rdm_agent* a = nullptr;
  HARD_REQUIRE(rdm_agent_create(&a, &c) == RDM_OK, "memory took what create refuses: %s", rdm_last_error());
  const rdm_result set = lines.options.empty() ? RDM_OK : rdm_agent_set_option(a, lines.options.data());
  if (set != RDM_OK) require_refusal(set);
  const char* key;
  char text[RDM_TEXT_SIZE];
  for (int32_t i = 0; rdm_agent_setting_at(a, i, &key, text) == RDM_OK; ++i)
    HARD_REQUIRE(good_text(text), "option %s", key);
  const std::string settings = settings_of<rdm_agent>(rdm_agent_get_settings, a);
  c.options = nullptr;
  c.num_options = 0;
  c.settings = settings.c_str();
  HARD_REQUIRE(rdm_agent_config_memory(&c, &bytes) == RDM_OK, "its own settings: %s", rdm_last_error());
  rdm_agent_destroy(a);
}

const std::vector<std::string>& algos() {
  static const auto* out = new std::vector<std::string>(all_algos());
  return *out;
}
const std::vector<World>& worlds() {
  static const auto* out = [] {
    auto* w = new std::vector<World>;
    for (const World& x : all_worlds())
      if (x.engine != "ode") w->push_back(x);
    return w;
  }();
  return *out;
}

std::string line_of(const rdm_option_spec& o) {
  return std::string(o.key) + "=" + (o.text ? o.text : std::to_string(o.number)) + "\n";
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (size_t i = 0; i < algos().size() + worlds().size(); ++i) {
    std::string text;
    rdm_option_spec o = RDM_INIT(rdm_option_spec);
    for (int32_t k = 0;; ++k) {
      const bool more = i < algos().size()
                            ? rdm_algo_option_at(static_cast<int32_t>(i), k, &o) == RDM_OK
                            : rdm_task_option_at(worlds()[i - algos().size()].index, k, &o) == RDM_OK;
      if (more) text += line_of(o);
      if (!text.empty() && (!more || k % static_cast<int32_t>(kMostOptions) == 7)) {
        out.push_back(with_pick(i, bytes_of(text)));
        text.clear();
      }
      if (!more) break;
    }
  }
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 1;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  const size_t i = pick(data, size, algos().size() + worlds().size());
  Lines lines(data + 1, size - 1);
  if (i < algos().size()) return ask_algo(algos()[i], lines);
  const World& w = worlds()[i - algos().size()];
  // the large tasks take milliseconds to ask
  static unsigned n = 0;
  if (is_cheap(w) || ++n % 64 == 1) ask_task(w, lines);
}

}  // namespace hard
