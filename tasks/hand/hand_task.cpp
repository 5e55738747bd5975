#include "tasks/hand/hand_task.hpp"

#include <utility>

#include "base/error.hpp"
#include "env/options/simulation.hpp"
#include "tasks/hand/free_start.hpp"

namespace rdm {

namespace {

HandScene freed(const HandControlConfig& config, HandScene made) {
  free_start(config, &made);
  return made;
}

SceneDef adjusted(HandScene* made) {
  made->adjustable = made->adjustable || !made->draws.empty();
  return std::move(static_cast<SceneDef&>(*made));
}

}  // namespace

HandTask::HandTask(const HandControlConfig& config, const Options& o, HandScene scene, size_t own_bytes)
    : engine_(engine_from(o)),
      max_steps_(o.integer("max_steps")),
      own_bytes_(own_bytes),
      made_(freed(config, std::move(scene))),
      scene_(make_scene(adjusted(&made_))),
      hands_(config, o, scene_, made_) {
  if (own_bytes % alignof(double) != 0)
    fail(Code::kInternal, "hand task: %zu bytes of its own state are not a multiple of %zu", own_bytes,
         alignof(double));
}

}  // namespace rdm
