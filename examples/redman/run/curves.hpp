// Curves of runs as lines to draw.
#pragma once
#include <string>
#include <vector>

#include "draw/svg.hpp"
#include "run/run_data.hpp"

namespace tool {

// A column of one run, or of several their mean and the deviation of the sample as far as all of them go,
// against control steps: means over as many equal intervals as `points`. One run of fewer rows is drawn row by row.
Series curve_of(const std::vector<const RunData*>& runs, const std::string& column, size_t color,
                size_t points = 120);

}  // namespace tool
