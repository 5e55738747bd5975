// Refused memory at every allocation site: for each thing that the library makes or does, allocation number
// 1, 2, 3 ... fails, once alone and once with all that follow. The code must be RDM_ERROR_MEMORY (or the call must
// do without), nothing may leak, and the same call must work when memory is there again.
//
// Two ways in: the host's alloc hook, and the C library's malloc with its kin, which takes in operator new,
// ODE, libccd, OctoMap and libstdc++.
//
//   hard_refuse [--seconds S] [--only TEXT]     S: about so long in all; sites are then sampled
#include <malloc.h>
#include <redman/map.h>
#include <redman/sense.h>

#include <atomic>
#include <cerrno>

#include "isolate.hpp"
#include "worlds.hpp"

using namespace hard;

namespace {

// The allocation that fails, and what is taken at the moment.
struct Faults {
  std::atomic<bool> armed{false};
  std::atomic<long> calls{0};
  std::atomic<int64_t> live{0};
  long at = 0;
  bool onwards = false;
  bool refuse() {
    if (!armed.load(std::memory_order_relaxed)) return false;
    const long n = ++calls;
    return onwards ? n >= at : n == at;
  }
};
constinit Faults g_heap, g_hook;

void* kept(void* p) {
  if (p) g_heap.live += static_cast<int64_t>(malloc_usable_size(p));
  return p;
}

}  // namespace

// glibc's own names for its allocator; shared libraries of the process come here too.
extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);

void* malloc(size_t size) noexcept {
  return g_heap.refuse() ? (errno = ENOMEM, nullptr) : kept(__libc_malloc(size));
}
void* calloc(size_t count, size_t size) noexcept {
  return g_heap.refuse() ? (errno = ENOMEM, nullptr) : kept(__libc_calloc(count, size));
}
void* realloc(void* p, size_t size) noexcept {
  if (g_heap.refuse()) return errno = ENOMEM, nullptr;
  const auto before = p ? static_cast<int64_t>(malloc_usable_size(p)) : 0;
  void* out = __libc_realloc(p, size);
  if (out || size == 0) g_heap.live -= before;
  return kept(out);
}
void* memalign(size_t align, size_t size) noexcept {
  return g_heap.refuse() ? (errno = ENOMEM, nullptr) : kept(__libc_memalign(align, size));
}
void* aligned_alloc(size_t align, size_t size) noexcept {
  return g_heap.refuse() ? (errno = ENOMEM, nullptr) : kept(__libc_memalign(align, size));
}
int posix_memalign(void** out, size_t align, size_t size) noexcept {
  if (g_heap.refuse()) return ENOMEM;
  *out = kept(__libc_memalign(align, size));
  return *out ? 0 : ENOMEM;
}
void free(void* p) noexcept {
  if (p) g_heap.live -= static_cast<int64_t>(malloc_usable_size(p));
  __libc_free(p);
}
}

namespace {

void* hook_alloc(void*, size_t bytes, size_t align) {
  if (g_hook.refuse()) return nullptr;
  void* p = nullptr;
  if (posix_memalign(&p, align < sizeof(void*) ? sizeof(void*) : align, bytes) != 0) return nullptr;
  g_hook.live += static_cast<int64_t>(bytes);
  return p;
}
void hook_release(void*, void* p, size_t bytes, size_t) {
  g_hook.live -= static_cast<int64_t>(bytes);
  std::free(p);
}
const rdm_host kHooks{sizeof(rdm_host), 0, nullptr, hook_alloc, hook_release, nullptr, nullptr};

// `before` and `after` stand around `act`, which alone is refused memory. `act` must be repeatable when it
// failed.
struct Case {
  std::string name;
  std::function<void(const rdm_host*)> before;
  std::function<rdm_result(const rdm_host*)> act;
  std::function<void()> after;
};

// What the cases work on. Empty between two of them.
struct Bench {
  PoolOf pool;
  AgentOf agent;
  rdm_map* map = nullptr;
  rdm_policy* policy = nullptr;
  Bytes bytes;
  void clear() {
    pool.reset();
    agent.reset();
    rdm_map_destroy(map);
    rdm_policy_destroy(policy);
    map = nullptr;
    policy = nullptr;
    Bytes().swap(bytes);
  }
};
Bench g;

void must(rdm_result r) {
  HARD_REQUIRE(r == RDM_OK, "%s", rdm_last_error());
}
rdm_result steps(int n) {
  for (int i = 0; i < n; ++i) {
    g.pool.fill_actions(static_cast<uint32_t>(i));
    if (const rdm_result r = rdm_pool_step(g.pool.handle)) return r;
  }
  return RDM_OK;
}
void make_map(const rdm_host* host) {
  rdm_map_config c;
  rdm_map_config_init(&c, sizeof c);
  c.resolution = 0.1;
  c.memory = 1 << 20;
  c.host = host;
  must(rdm_map_create(&g.map, &c));
}
rdm_result fill_map() {
  float points[30];
  for (int i = 0; i < 30; ++i) points[i] = static_cast<float>((i * 37) % 23) * 0.05f;
  const float origin[3] = {0, 0, 1};
  return rdm_map_insert(g.map, origin, points, 10, nullptr);
}
Bytes map_bytes(int32_t format) {
  size_t n = 0;
  must(rdm_map_write(g.map, format, nullptr, 0, &n));
  Bytes out(n);
  must(rdm_map_write(g.map, format, out.data(), n, &n));
  return out;
}

std::vector<Case> all_cases() {
  std::vector<Case> out;
  const auto nothing = [](const rdm_host*) {};
  const auto clear = [] { g.clear(); };
  const auto ask = [](const World& w, int32_t envs, int32_t threads, const std::vector<rdm_option>& options) {
    return [=](const rdm_host* host) { g.pool.configure(w, envs, host, threads, options); };
  };
  const auto create = [](const rdm_host*) { return g.pool.create(); };
  const auto made = [=](const World& w, const std::vector<rdm_option>& options) {
    return [=](const rdm_host* host) { must(g.pool.make(w, 1, host, 0, options)); };
  };
  const auto ready = [=](const World& w, const std::vector<rdm_option>& options) {
    return [=](const rdm_host* host) {
      made(w, options)(host);
      must(rdm_pool_reset(g.pool.handle, nullptr, nullptr));
    };
  };
  for (const World& w : all_worlds()) {
    out.push_back({"pool " + w.name(), ask(w, 1, 0, {}), create, clear});
    out.push_back({"reset and steps " + w.name(), made(w, {}),
                   [](const rdm_host*) {
                     const rdm_result r = rdm_pool_reset(g.pool.handle, nullptr, nullptr);
                     return r == RDM_OK ? steps(3) : r;
                   },
                   clear});
    out.push_back({"set_state " + w.name(),
                   [=](const rdm_host* host) {
                     ready(w, {})(host);
                     must(steps(2));
                     g.bytes = g.pool.state();
                   },
                   [](const rdm_host*) {
                     return rdm_pool_read_state(g.pool.handle, -1, g.bytes.data(), g.bytes.size());
                   },
                   clear});
  }
  out.push_back({"task register", nothing,
                 [](const rdm_host*) {
                   static rdm::test::BallTask own("own_refused");
                   int32_t task = -1;
                   const rdm_result r = rdm_task_create(&task, &own.def);
                   if (r == RDM_OK) rdm_task_destroy(task);
                   return r;
                 },
                 clear});
  const std::vector<World> worlds = all_worlds();
  for (const World& w : worlds) {
    if (w.task != "grasp" && w.task != "two_state") continue;
    out.push_back({"pool of 3 worlds, 3 threads " + w.name(), ask(w, 3, 3, {}), create, clear});
  }
  // what discovery and the asking calls take
  for (const World& w : worlds) {
    if (w.engine == "ode") continue;
    out.push_back({"spec, memory, field " + w.task, nothing,
                   [=](const rdm_host* host) {
                     rdm_pool_config c;
                     rdm_pool_config_init(&c, sizeof c);
                     c.task = w.task.c_str();
                     c.host = host;
                     rdm_spec spec{};
                     spec.struct_size = sizeof spec;
                     size_t ours = 0, engines = 0;
                     rdm_field_info field = RDM_INIT(rdm_field_info);
                     rdm_result r = rdm_pool_config_spec(&c, &spec);
                     if (r == RDM_OK) r = rdm_pool_config_memory(&c, &ours, &engines);
                     if (r == RDM_OK) r = rdm_task_field_at(w.index, 0, &field);
                     return r;
                   },
                   clear});
  }
  for (const World& w : worlds) {
    if (w.task != "grasp" && w.task != "clean_house") continue;
    static const std::vector<std::vector<rdm_option>> sights = {
        {{"modality", "rgb", 0}, {"width", nullptr, 8}, {"height", nullptr, 8}},
        {{"modality", "points", 0}, {"points", nullptr, 16}},
    };
    for (const auto& sight : sights) {
      PoolOf probe;
      if (probe.make(w, 1, nullptr, 0, sight) != RDM_OK) continue;
      out.push_back({"pool that sees, " + std::string(sight[0].text) + " " + w.name(), ask(w, 1, 0, sight),
                     create, clear});
      out.push_back({"steps that see, " + std::string(sight[0].text) + " " + w.name(), ready(w, sight),
                     [](const rdm_host*) { return steps(2); }, clear});
    }
    rdm_camera_info camera = RDM_INIT(rdm_camera_info);
    if (rdm_task_camera_at(w.index, 0, &camera) != RDM_OK) continue;
    const std::string name = camera.name;
    out.push_back({"render " + w.name(), ready(w, {}),
                   [=](const rdm_host*) {
                     uint8_t rgb[16 * 16 * 3];
                     float depth[16 * 16];
                     return rdm_pool_render(g.pool.handle, 0, name.c_str(), 16, 16, rgb, depth, nullptr);
                   },
                   clear});
    out.push_back({"map scan " + w.name(),
                   [=](const rdm_host* host) {
                     ready(w, {})(host);
                     make_map(host);
                   },
                   [=](const rdm_host*) {
                     return rdm_map_scan(g.map, g.pool.handle, 0, name.c_str(), 16, 16, nullptr, 0, nullptr);
                   },
                   clear});
  }
  for (const std::string& algo : all_algos()) {
    const auto configure = [=](int32_t threads) {
      return [=](const rdm_host* host) { g.agent.configure(algo, host, threads); };
    };
    const auto create_agent = [](const rdm_host*) { return g.agent.create(); };
    const auto ready_agent = [=](const rdm_host* host) { must(g.agent.make(algo, host)); };
    out.push_back({"agent " + algo, configure(0), create_agent, clear});
    out.push_back({"agent of 2 threads " + algo, configure(2), create_agent, clear});
    out.push_back({"epoch " + algo, ready_agent, [](const rdm_host*) { return g.agent.epoch(); }, clear});
    out.push_back(
        {"agent load " + algo,
         [=](const rdm_host* host) {
           ready_agent(host);
           must(g.agent.epoch());
           g.bytes = g.agent.state();
         },
         [](const rdm_host*) { return rdm_agent_read_state(g.agent.handle, g.bytes.data(), g.bytes.size()); },
         clear});
    out.push_back({"agent save and policy " + algo,
                   [=](const rdm_host* host) {
                     ready_agent(host);
                     g.bytes.resize(1 << 16);
                   },
                   [](const rdm_host*) {
                     size_t n = 0;
                     const rdm_result r =
                         rdm_agent_write_state(g.agent.handle, g.bytes.data(), g.bytes.size(), &n);
                     return r == RDM_OK
                                ? rdm_agent_write_policy(g.agent.handle, g.bytes.data(), g.bytes.size(), &n)
                                : r;
                   },
                   clear});
  }
  const auto seeing = [=](const rdm_host* host) {
    g.agent.configure("trpo_lag", host);
    g.agent.config.settings = "encoder=4,6\nencoder_points=8\nencoder_classes=2";
  };
  out.push_back({"agent that sees", seeing, [](const rdm_host*) { return g.agent.create(); }, clear});
  out.push_back({"pretrain",
                 [=](const rdm_host* host) {
                   seeing(host);
                   must(g.agent.create());
                 },
                 [](const rdm_host*) {
                   float metres[5 * 8 * 3];
                   for (int i = 0; i < 120; ++i) metres[i] = 0.01f * static_cast<float>((i * 37) % 41);
                   uint8_t label[5 * 8];
                   for (int i = 0; i < 40; ++i) label[i] = static_cast<uint8_t>(i % 2);
                   const rdm_points points = {sizeof points, 8, metres, label, nullptr};
                   rdm_pretrain_config how;
                   must(rdm_pretrain_config_init(&how, sizeof how));
                   how.num_labels = 2, how.epochs = 2;
                   return rdm_agent_pretrain(g.agent.handle, &points, label, 5, &how, nullptr);
                 },
                 clear});
  out.push_back({"policy that sees, load",
                 [=](const rdm_host* host) {
                   seeing(host);
                   must(g.agent.create());
                   g.bytes = g.agent.policy();
                 },
                 [](const rdm_host*) { return rdm_policy_read(&g.policy, g.bytes.data(), g.bytes.size()); },
                 clear});
  const std::string checkpoint = "hard_refuse-" + std::to_string(getpid()) + ".rdm";
  const auto pair = [=](const rdm_host* host) {
    must(g.agent.make("ppo_lag", host));
    must(g.pool.make({"two_state", "", 0, 0}, 2, host));
    must(rdm_pool_reset(g.pool.handle, nullptr, nullptr));
  };
  const auto write = [=] {
    return rdm_checkpoint_write(checkpoint.c_str(), g.agent.handle, g.pool.handle, "note", 4);
  };
  out.push_back({"checkpoint write", pair, [=](const rdm_host*) { return write(); },
                 [=] {
                   g.clear();
                   std::remove(checkpoint.c_str());
                 }});
  out.push_back({"checkpoint read",
                 [=](const rdm_host* host) {
                   pair(host);
                   must(write());
                 },
                 [=](const rdm_host*) {
                   char note[8];
                   size_t n = 0;
                   return rdm_checkpoint_read(checkpoint.c_str(), g.agent.handle, g.pool.handle, note,
                                              sizeof note, &n);
                 },
                 [=] {
                   g.clear();
                   std::remove(checkpoint.c_str());
                 }});
  out.push_back({"policy load",
                 [=](const rdm_host* host) {
                   AgentOf a;
                   must(a.make("ppo", host));
                   g.bytes = a.policy();
                 },
                 [](const rdm_host*) { return rdm_policy_read(&g.policy, g.bytes.data(), g.bytes.size()); },
                 clear});
  out.push_back({"map", nothing,
                 [](const rdm_host* host) {
                   rdm_map_config c;
                   rdm_map_config_init(&c, sizeof c);
                   c.memory = 1 << 20;
                   c.host = host;
                   return rdm_map_create(&g.map, &c);
                 },
                 clear});
  out.push_back({"map insert", make_map, [](const rdm_host*) { return fill_map(); }, clear});
  for (const int32_t format : {RDM_MAP_BINARY, RDM_MAP_FULL}) {
    const std::string name = format == RDM_MAP_BINARY ? " .bt" : " .ot";
    const auto filled = [](const rdm_host* host) {
      make_map(host);
      must(fill_map());
    };
    out.push_back({"map load" + name,
                   [=](const rdm_host* host) {
                     filled(host);
                     g.bytes = map_bytes(format);
                   },
                   [](const rdm_host*) { return rdm_map_read(g.map, g.bytes.data(), g.bytes.size()); },
                   clear});
    out.push_back({"map save" + name,
                   [=](const rdm_host* host) {
                     filled(host);
                     g.bytes.resize(1 << 16);
                   },
                   [=](const rdm_host*) {
                     size_t n = 0;
                     return rdm_map_write(g.map, format, g.bytes.data(), g.bytes.size(), &n);
                   },
                   clear});
  }
  out.push_back({"map queries",
                 [](const rdm_host* host) {
                   make_map(host);
                   must(fill_map());
                 },
                 [](const rdm_host*) {
                   const float point[3] = {0.2f, 0.2f, 0.2f}, low[3] = {-1, -1, -1}, high[3] = {2, 2, 2};
                   const float half[3] = {1, 1, 1}, down[3] = {0, 0, -1};
                   const rdm_pose pose{};
                   float number = 0, hit[3];
                   rdm_voxel voxel[4];
                   size_t n = 0;
                   int32_t yes = 0;
                   const int32_t cells[3] = {4, 4, 4};
                   int8_t grid[64];
                   rdm_result r = rdm_map_get_probabilities(g.map, point, 1, &number);
                   if (r == RDM_OK) r = rdm_map_get_voxels(g.map, low, high, voxel, 4, &n);
                   if (r == RDM_OK) r = rdm_map_meets(g.map, &pose, half, &yes);
                   if (r == RDM_OK) r = rdm_map_raycast(g.map, high, down, 3, 1, hit, &yes);
                   if (r == RDM_OK) r = rdm_map_get_distances(g.map, point, 1, 1, &number);
                   if (r == RDM_OK) r = rdm_map_get_grid(g.map, &pose, cells, 0.1f, grid);
                   return r;
                 },
                 clear});
  return out;
}

// One case with one refused allocation: twice the bytes it leaks, since the first time may fill a cache.
Outcome refuse_one(const Case& c, const rdm_host* host, long at, bool onwards, Tally& tally) {
  Faults& faults = host ? g_hook : g_heap;
  bool absorbed = false;
  for (int round = 0; round < 2; ++round) {
    const int64_t before = g_heap.live, hooks_before = g_hook.live;
    c.before(host);
    faults.at = at;
    faults.onwards = onwards;
    faults.calls = 0;
    faults.armed = true;
    const rdm_result r = c.act(host);
    faults.armed = false;
    const bool fired = faults.calls >= at;
    if (fired && r == RDM_OK) absorbed = true;
    if (r != RDM_OK && r != RDM_ERROR_MEMORY) {
      tally.remember("allocation %ld%s: code %d, %s", at, onwards ? " and all after" : "", r,
                     rdm_last_error());
      return Outcome::kBad;
    }
    const rdm_result again = r == RDM_OK ? r : c.act(host);
    if (again != RDM_OK) {
      tally.remember("allocation %ld%s: not usable afterwards: %d, %s", at, onwards ? " and all after" : "",
                     again, rdm_last_error());
      return Outcome::kBad;
    }
    c.after();
    if (!fired) return Outcome::kEnd;
    const int64_t leak = g_heap.live - before, hook_leak = g_hook.live - hooks_before;
    if (leak <= 0 && hook_leak == 0) break;
    if (round == 1) {
      tally.remember("allocation %ld%s: %lld bytes leak, %lld of the hooks'", at,
                     onwards ? " and all after" : "", static_cast<long long>(leak),
                     static_cast<long long>(hook_leak));
      return Outcome::kBad;
    }
  }
  return absorbed ? Outcome::kOther : Outcome::kGood;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = std::atof(argument(argc, argv, "--seconds", "0").c_str());
  const std::string only = argument(argc, argv, "--only", "");
  std::vector<Case> cases;
  for (Case& c : all_cases())
    if (c.name.find(only) != std::string::npos) cases.push_back(std::move(c));
  const double begin = now();
  long passed = 0, failed = 0;
  std::printf("%-52s %5s %7s %7s %7s %7s %7s\n", "refused memory", "by", "sites", "refused", "without",
              "wrong", "died");
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    for (const bool by_hook : {false, true}) {
      const rdm_host* host = by_hook ? &kHooks : nullptr;
      // sites: calls of a run that is refused nothing; a child counts, to stay clean
      long sites = 0;
      double cost = 0;
      int ends[2];
      if (pipe(ends) != 0) return 2;
      const pid_t child = fork();
      if (child == 0) {
        Tally none;
        refuse_one(c, host, 1L << 60, false, none);  // fills the caches
        const double t = now();
        refuse_one(c, host, 1L << 60, false, none);
        const double took = now() - t;
        const long n = by_hook ? g_hook.calls : g_heap.calls;
        const bool good =
            write(ends[1], &n, sizeof n) == sizeof n && write(ends[1], &took, sizeof took) == sizeof took;
        _exit(good ? 0 : 1);
      }
      close(ends[1]);
      if (read(ends[0], &sites, sizeof sites) != sizeof sites ||
          read(ends[0], &cost, sizeof cost) != sizeof cost)
        sites = -1;
      close(ends[0]);
      waitpid(child, nullptr, 0);
      if (sites < 0) {
        std::printf("%-52s %5s does not work with all memory there\n", c.name.c_str(),
                    by_hook ? "hook" : "heap");
        ++failed;
        continue;
      }
      const double share =
          seconds > 0
              ? std::max(0.05, (begin + seconds - now()) / static_cast<double>(2 * (cases.size() - i)))
              : 0;
      const double all = 4 * cost * static_cast<double>(sites);  // two modes, act and act again
      const long stride = share > 0 && all > share ? 1 + static_cast<long>(all / share) : 1;
      const Tally t = isolate(2, 2 * sites + 2, stride, share, 60, [&]() -> Experiment {
        Tally none;
        refuse_one(c, host, 1L << 60, false, none);
        return [&](long k, Tally& tally) { return refuse_one(c, host, k / 2, k % 2 != 0, tally); };
      });
      passed += t.good + t.other;
      failed += t.failed();
      std::printf("%-52s %5s %7ld %7ld %7ld %7ld %7ld%s%s\n", c.name.c_str(), by_hook ? "hook" : "heap",
                  sites, t.good, t.other, t.bad, t.crashed, *t.note ? "  " : "", t.note);
      std::fflush(stdout);
    }
  }
  std::printf("%ld passed, %ld failed\n", passed, failed);
  return failed != 0;
}
