// The page that compares runs: a ranking, curves, what the configurations differ in, and pictures.
#pragma once
#include <string>
#include <vector>

#include "run/seeds.hpp"

namespace tool {

struct Strip {
  std::string png;  // bytes of the file, "" where there is none
  std::string caption;
};

// Runs of one task.
struct TaskReport {
  std::string task, summary;
  int32_t episodes = 0;                       // that evaluated each run
  std::vector<Configuration> configurations;  // ranked
  std::vector<Seeds> seeds;                   // of the configurations
  std::vector<Strip> strips;                  // of the configurations
  std::vector<std::string> notes;             // what could not be done
};

std::string report_page(const std::vector<TaskReport>& tasks);

}  // namespace tool
