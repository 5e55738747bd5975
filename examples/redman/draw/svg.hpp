// Line charts as SVG: panels in a grid with axes, ticks, bands and one legend.
#pragma once
#include <string>
#include <vector>

namespace tool {

// A line with a band around it. NaN breaks the line. low and high may be empty.
struct Series {
  size_t color = 0;  // index into the palette
  std::vector<double> x, y, low, high;
};

inline constexpr size_t kGrey = 6;  // in the palette

// A dashed horizontal line.
struct Level {
  size_t color = 0;
  double y = 0;
};

struct Panel {
  std::string title;
  std::vector<Series> series;
  std::vector<Level> levels;
  bool share = false;  // 0 to 1, written in per cent
};

struct LegendEntry {
  size_t color = 0;
  std::string label;
};

// Stands in the first lines of such a file.
inline constexpr const char* kChartMark = "<!-- redman plot -->";
// A whole document: `columns` panels a row. x_label stands under the panels of the last row.
std::string draw_chart(const std::string& title, const std::vector<Panel>& panels, size_t columns,
                       const std::string& x_label, const std::vector<LegendEntry>& legend);

// One panel as an <svg class="chart"> element for a page, whose style sheet has the classes of draw_chart's;
// where the plotting area is and what x it spans stand in its attributes data-left, -width, -low, -high.
std::string draw_panel(const Panel& panel, const std::string& x_label);
// Of the palette: "#0072b2".
const char* palette_color(size_t index);

}  // namespace tool
