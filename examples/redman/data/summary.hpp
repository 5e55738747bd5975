// What a data set holds: `data info`.
#pragma once
#include "common/report.hpp"
#include "data/set.hpp"

namespace tool {

struct ReturnRange {
  double least, most;  // sums of rewards of episodes that ended; NaN where none did
};
ReturnRange return_range(const DataSet& set);
// The limits at which policies that learned from it are judged; empty: unknown.
std::vector<double> limits_of(const DataSet& set);

Json summary_json(const DataSet& set);
std::string summary_text(const Json& summary);

}  // namespace tool
