// The part of a .task file that is read once, when the task is registered: the rows of its rdm_task_def.
#pragma once
#include "toml_text.hpp"

namespace rdm::import {

struct TextTask {
  std::string file;
  toml::table root;
  std::deque<std::string> texts;
  std::vector<rdm_field_def> fields;
  std::vector<rdm_cost_def> costs;
  std::vector<rdm_option_def> options;
  std::vector<rdm_camera_def> cameras;
  std::vector<rdm_option> defaults;
  struct Row {  // where a row of rdm_task_def stands in the file
    std::string def;
    int line;
    std::string what;
  };
  std::vector<Row> rows;
  void stands(const char* list, size_t row, int line, const std::string& what) {
    rows.push_back({format("def.%s[%zu]", list, row), line, what});
  }
  const char* keep(std::string text) {
    texts.push_back(std::move(text));
    return texts.back().c_str();
  }
};

// The task's def, but for its functions; all that it points to is `task`'s.
rdm_task_def registration_of(TextTask* task);

}  // namespace rdm::import
