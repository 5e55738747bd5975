// The same host in C++17.
#include <cstdio>
#include <redman/redman.hpp>

int main() {
  if (!(rdm_features() & RDM_FEATURE_SIM)) return rdm_task_count() == 0 ? 0 : 1;
  try {
    auto task = redman::sized<rdm_task>();
    redman::check(rdm_task_at(0, &task));
    redman::Pool pool(redman::pool_config(task.name, 2));
    pool.reset();
    for (int step = 0; step < 5; ++step) pool.step();
    std::printf("%s: reward %g\n", task.name, static_cast<double>(pool.reward()[1]));
    return pool.buffers().episode_step[1] == 5 ? 0 : 1;
  } catch (const redman::Error& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
}
