// The pages of the manual as far as the library's tables write them: a heading, and blocks between the marks
// `<!-- NAME -->` and `<!-- end of NAME -->`, which cmake/tables.sh puts into the pages.
#pragma once
#include <cstdint>
#include <string>

namespace tool {

// facts, actions, observations, costs, options.
std::string task_page(int32_t task);
// options.
std::string algo_page(int32_t algo);

}  // namespace tool
