// Parts of a TaskInfo that are written once: option tables, makers, and lists of learner defaults.
#pragma once
#include <array>
#include <cstddef>
#include <iterator>

#include "base/option_rows.hpp"
#include "env/option_table.hpp"
#include "env/task.hpp"

namespace rdm {

// `first` and then `more`; they have no key in common.
template <size_t N, size_t M>
constexpr std::array<LearnerDefault, N + M> join_defaults(const std::array<LearnerDefault, N>& first,
                                                          const LearnerDefault (&more)[M]) {
  std::array<LearnerDefault, N + M> out{};
  for (size_t i = 0; i < N; ++i) out[i] = first[i];
  for (size_t i = 0; i < M; ++i) out[N + i] = more[i];
  return out;
}

// TaskInfo::options of a table that `fill` makes at the first call.
template <void (*fill)(OptionTable&)>
const OptionSpec* filled_options(int32_t* count, OptionTable* chosen) {
  if (chosen) {
    fill(*chosen);
    *count = chosen->count();
    return chosen->rows();
  }
  struct Filled : OwnOptionTable {
    Filled() { fill(*this); }
  };
  static const Filled table;
  *count = table.count();
  return table.rows();
}

// A row of the registry; `make` gives a T.
template <class T, const auto& kCosts, const auto& kCameras, const auto& kDefaults>
constexpr TaskInfo task_row(const char* name, const char* alias, const char* summary,
                            const OptionSpec* (*options)(int32_t*, OptionTable*),
                            Task* (*make)(const Options&, const HostHooks&)) {
  return {name,
          alias,
          summary,
          options,
          std::data(kCosts),
          static_cast<int32_t>(std::size(kCosts)),
          std::data(kCameras),
          static_cast<int32_t>(std::size(kCameras)),
          std::data(kDefaults),
          static_cast<int32_t>(std::size(kDefaults)),
          make,
          [](Task* task, const HostHooks& hooks) { host_delete(hooks, static_cast<T*>(task)); }};
}
// A T is made from the constants, if any, and the options. Alias null: none.
template <class T, const auto& kCosts, const auto& kCameras, const auto& kDefaults, auto... kConstants>
constexpr TaskInfo task_info(const char* name, const char* alias, const char* summary,
                             const OptionSpec* (*options)(int32_t*, OptionTable*)) {
  return task_row<T, kCosts, kCameras, kDefaults>(name, alias, summary, options,
                                                  [](const Options& o, const HostHooks& hooks) -> Task* {
                                                    const HostScope scope(hooks);
                                                    return host_new<T>(hooks, kConstants..., o);
                                                  });
}
// A T is made from what a list of rows (option_rows.hpp) reads.
template <class T, const auto& kRows, const auto& kCosts, const auto& kCameras, const auto& kDefaults>
constexpr TaskInfo task_info(const char* name, const char* alias, const char* summary) {
  return task_row<T, kCosts, kCameras, kDefaults>(
      name, alias, summary,
      [](int32_t* count, OptionTable*) -> const OptionSpec* {
        *count = static_cast<int32_t>(kRows.size());
        return kRows.specs;
      },
      [](const Options& o, const HostHooks& hooks) -> Task* {
        const HostScope scope(hooks);
        return host_new<T>(hooks, kRows.read(o));
      });
}

}  // namespace rdm
