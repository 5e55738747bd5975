#include "env/copies.hpp"

namespace rdm {

Pool* make_copies(const Pool& of, int32_t num_envs, int32_t num_threads, const HostHooks& hooks) {
  // the settings as lines, so that options that a host gave hold there too
  constexpr char kBlind[] = "modality=state\n";
  Vector<char> settings = of.options().lines();
  settings.pop_back();  // each line ends itself
  settings.insert(settings.end(), kBlind, kBlind + sizeof kBlind);
  PoolConfig c;
  c.num_envs = num_envs;
  c.num_threads = num_threads > 0 ? num_threads : of.config().num_threads;
  c.task = task_at(of.task_index()).name;
  c.autoreset = Autoreset::kOff;
  c.settings = settings.data();
  c.hooks = hooks;
  return Pool::create(c);
}

}  // namespace rdm
