#include "tasks/hand/hand_task.hpp"

#include <utility>

#include "base/error.hpp"
#include "env/options/simulation.hpp"

namespace rdm {

HandTask::HandTask(const HandControlConfig& config, const Options& o, SceneDef scene, size_t own_bytes)
    : engine_(engine_from(o)),
      max_steps_(o.integer("max_steps")),
      own_bytes_(own_bytes),
      scene_(make_scene(std::move(scene))),
      hands_(config, o, scene_) {
  if (own_bytes % alignof(double) != 0)
    fail(Code::kInternal, "hand task: %zu bytes of its own state are not a multiple of %zu", own_bytes,
         alignof(double));
}

}  // namespace rdm
