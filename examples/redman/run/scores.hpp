// Scores of runs out of a table: a CSV file with a header and a line for each run.
#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "common/statistics.hpp"

namespace tool {

struct ScoreColumns {
  std::string of, over, value;  // what is compared, the tasks ("": all runs are of one), the scores
  std::vector<std::pair<std::string, std::string>> where;  // column and the text that stands in it
};

struct Scored {
  std::string name;
  Strata runs;  // of each task, in the same order for all
};

// In the order in which names come first. Failure when a column or a score is missing, or when names are of
// different tasks. Cells hold no quotes.
std::vector<Scored> parse_scores(const char* text, size_t size, const ScoreColumns& columns);
// Best first, by the interquartile mean.
void sort_scores(std::vector<Scored>& scores);

}  // namespace tool
