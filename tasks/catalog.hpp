// All tasks that the library knows, put into the registry.
#pragma once

namespace rdm {

// Once per process, from any thread; further calls do nothing.
void register_builtin_tasks();

}  // namespace rdm
