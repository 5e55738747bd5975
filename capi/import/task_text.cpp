// The .task file: TOML with one table for each row of rdm_task_def and for each part of a scene, and lists of terms
// that replace a task's functions (reward, costs, observations). The file is parsed once, when the task is registered
// (text_register). `build` makes the scene (text_scene), its robots (text_players) and the program of terms
// (text_terms, task_program.hpp) again for each pool, because numbers in the file may be options of the pool.
#include <algorithm>
#include <memory>

#include "text_register.hpp"
#include "text_terms.hpp"

namespace rdm::import {
namespace {

rdm_result build(void* user, rdm_scene* scene, void* instance) {
  const TextTask& task = *static_cast<const TextTask*>(user);
  const auto named = [&](rdm_result code, const std::string& text) {
    const std::string line = task.file.empty() ? text : task.file + ": " + text;
    return rdm_fail(code, line.c_str());
  };
  try {
    TermText text(task.root, scene, static_cast<Program*>(instance));
    text.read_scene();
    text.read_players();
    text.read_terms();
    return RDM_OK;
  } catch (const Refusal& r) {
    return named(r.code, r.text);
  } catch (const std::bad_alloc&) {
    return named(RDM_ERROR_MEMORY, "out of memory");
  } catch (...) {
    return named(RDM_ERROR_INTERNAL, "internal error: unexpected exception");
  }
}

void release(void* user) {
  delete static_cast<TextTask*>(user);
}

// The last error without the prefix that the library puts before messages of a task's build.
std::string inner_text(const std::string& name) {
  std::string text = rdm_last_error();
  const std::string head = "task " + name + ": build: ";
  if (text.compare(0, head.size(), head) == 0) text.erase(0, head.size());
  return text;
}

// A world with the default options: made, reset, and stepped once.
rdm_result try_world(const char* name) {
  rdm_pool_config c;
  rdm_pool* pool = nullptr;
  rdm_pool_config_init(&c, sizeof c);
  c.task = name;
  c.num_envs = 1;
  rdm_result r = rdm_pool_create(&pool, &c);
  if (r == RDM_OK) r = rdm_pool_reset(pool, nullptr, nullptr);
  if (r == RDM_OK) r = rdm_pool_baseline(pool, RDM_BASELINE_HOLD);
  if (r == RDM_OK) r = rdm_pool_step(pool);
  rdm_pool_destroy(pool);
  return r;
}

// Turns an error about a member of rdm_task_def into one about the line of the file that gave the member.
[[noreturn]] void refuse_def(const TextTask& task, rdm_result r) {
  const std::string text = rdm_last_error();
  for (const TextTask::Row& row : task.rows) {
    if (text.compare(0, row.def.size(), row.def) != 0) continue;
    const size_t rest = text.find_first_not_of(".: ", row.def.size());
    refuse(r, "line %d: %s: %s", row.line, row.what.c_str(), text.c_str() + std::min(rest, text.size()));
  }
  const toml::node* section = task.root.get("task");
  const std::string def = "def.";
  const bool own = text.compare(0, def.size(), def) == 0;
  refuse(r, "line %d: %s", section ? line_of(*section) : 1,
         (own ? "task: " + text.substr(def.size()) : text).c_str());
}

}  // namespace

int32_t read_task(const std::string& bytes, const std::string& file) {
  auto task = std::make_unique<TextTask>();
  task->file = file;
  task->root = parse_toml(bytes);
  rdm_task_def d = registration_of(task.get());
  d.build = build;
  d.reset = program_reset;
  d.control = program_control;
  d.judge = program_judge;
  d.observe = program_observe;
  d.check_state = program_check_state;
  d.release = release;
  int32_t index = -1;
  const std::string name = d.name;
  if (const rdm_result r = rdm_task_create(&index, &d)) refuse_def(*task, r);
  (void)task.release();  // the library's, until `release`
  struct Registered {
    int32_t index;
    ~Registered() {
      if (index >= 0) rdm_task_destroy(index);
    }
  } registered{index};  // removed also where there is no memory for the reason
  if (const rdm_result r = try_world(name.c_str())) {
    std::string text = inner_text(name);
    if (!file.empty() && text.compare(0, file.size() + 2, file + ": ") == 0) text.erase(0, file.size() + 2);
    throw Refusal{r, text};
  }
  registered.index = -1;
  return index;
}

}  // namespace rdm::import
