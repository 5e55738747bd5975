#include "draw/svg.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/text.hpp"

namespace tool {
namespace {

// Okabe and Ito's colours, told apart by most eyes.
constexpr const char* kPalette[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#555555"};
const char* color(size_t i) {
  return kPalette[i % std::size(kPalette)];
}

// Lines beyond the palette are dashed.
const char* dash(size_t i) {
  return i < std::size(kPalette) ? "" : " stroke-dasharray=\"5 4\"";
}

constexpr double kPanelWidth = 330, kPanelHeight = 210;                           // of the plotting area
constexpr double kLeft = 58, kRight = 16, kTop = 34, kBottom = 36, kMargin = 14;  // around it
constexpr double kTitleHeight = 34, kLegendHeight = 24, kLegendWidth = 9;         // the last: of a letter

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return low > high; }
};

// A step of 1, 2 or 5 times a power of ten that gives about `count` ticks.
double tick_step(const Range& r, int count) {
  const double raw = (r.high - r.low) / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

// Widened to whole ticks; never empty, never flat.
Range widened(Range r, double* step) {
  if (r.empty()) r = {0, 1};
  if (r.high - r.low < 1e-12 * std::max(1.0, std::abs(r.high))) {
    const double pad = std::max(std::abs(r.high) * 0.1, 0.5);
    r = {r.low >= 0 && r.low < pad ? r.low : r.low - pad, r.high + pad};
  }
  *step = tick_step(r, 5);
  r.low = std::floor(r.low / *step + 1e-9) * *step;
  r.high = std::ceil(r.high / *step - 1e-9) * *step;
  return r;
}

std::string tick_text(double v, double step, bool share) {
  if (std::abs(v) < step * 1e-6) v = 0;
  return share ? format("%.6g%%", 100 * v) : short_count(v);
}

class PanelDrawing {
 public:
  PanelDrawing(const Panel& panel, double left, double top) : panel_(panel), left_(left), top_(top) {
    Range x, y;
    for (const Series& s : panel.series) {
      for (const double v : s.x) x.add(v);
      for (const auto* values : {&s.y, &s.low, &s.high})
        for (const double v : *values) y.add(shown(v));
    }
    x.add(0);
    for (const Level& l : panel.levels) y.add(l.y);
    if (panel.share) {
      y.add(0);
      y.add(1);
    }
    if (!y.empty() && y.low > 0 && y.low < 0.5 * y.high) y.low = 0;
    x_ = x;
    if (x_.high <= x_.low) x_.high = x_.low + 1;
    x_step_ = tick_step(x_, 5);
    y_ = widened(y, &y_step_);
  }

  const Range& x() const { return x_; }
  std::string text(bool with_x_label, const std::string& x_label) const {
    std::string out = format("<text class=\"title\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", left_, top_ - 12,
                             html_text(panel_.title).c_str());
    out += grid();
    for (const Series& s : panel_.series) out += band(s);
    for (const Level& l : panel_.levels)
      out += format("<line class=\"level\" stroke=\"%s\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>\n",
                    color(l.color), left_, left_ + kPanelWidth, at_y(l.y), at_y(l.y));
    for (const Series& s : panel_.series) out += line(s);
    if (with_x_label)
      out += format("<text class=\"label\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", left_ + kPanelWidth / 2,
                    top_ + kPanelHeight + 33, html_text(x_label).c_str());
    return out;
  }

 private:
  // A band of shares ends where shares do.
  double shown(double v) const { return panel_.share ? std::clamp(v, 0.0, 1.0) : v; }
  double at_x(double v) const { return left_ + (v - x_.low) / (x_.high - x_.low) * kPanelWidth; }
  double at_y(double v) const { return top_ + (y_.high - v) / (y_.high - y_.low) * kPanelHeight; }

  std::string grid() const {
    std::string out;
    for (double v = y_.low; v <= y_.high + 0.5 * y_step_; v += y_step_)
      out += format(
          "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>"
          "<text class=\"y\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
          left_, left_ + kPanelWidth, at_y(v), at_y(v), left_ - 7, at_y(v) + 4,
          tick_text(v, y_step_, panel_.share).c_str());
    for (double v = std::ceil(x_.low / x_step_) * x_step_; v <= x_.high * (1 + 1e-9); v += x_step_)
      out += format(
          "<line class=\"axis\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>"
          "<text class=\"x\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
          at_x(v), at_x(v), top_ + kPanelHeight, top_ + kPanelHeight + 4, at_x(v), top_ + kPanelHeight + 17,
          tick_text(v, x_step_, false).c_str());
    out += format("<path class=\"axis\" d=\"M%.1f %.1fV%.1fH%.1f\"/>\n", left_, top_, top_ + kPanelHeight,
                  left_ + kPanelWidth);
    return out;
  }

  std::string band(const Series& s) const {
    std::string forth, back;
    for (size_t i = 0; i < s.low.size(); ++i) {
      if (!std::isfinite(s.low[i]) || !std::isfinite(s.high[i])) continue;
      forth += format("%s%.1f %.1f", forth.empty() ? "M" : "L", at_x(s.x[i]), at_y(shown(s.high[i])));
      back = format("L%.1f %.1f", at_x(s.x[i]), at_y(shown(s.low[i]))) + back;
    }
    if (forth.empty()) return "";
    return format("<path class=\"band s%zu\" fill=\"%s\" d=\"", s.color, color(s.color)) + forth + back +
           "Z\"/>\n";
  }

  std::string line(const Series& s) const {
    std::string path;
    bool pen = false;
    for (size_t i = 0; i < s.y.size(); ++i) {
      const bool good = std::isfinite(s.y[i]);
      if (good) path += format("%s%.1f %.1f", pen ? "L" : "M", at_x(s.x[i]), at_y(s.y[i]));
      pen = good;
    }
    if (path.empty()) return "";
    return format("<path class=\"line s%zu\" stroke=\"%s\"%s d=\"", s.color, color(s.color), dash(s.color)) +
           path + "\"/>\n";
  }

  const Panel& panel_;
  double left_, top_;
  Range x_, y_;
  double x_step_ = 1, y_step_ = 1;
};

// Entries left to right, broken into rows; returns the height in rows.
std::string draw_legend(const std::vector<LegendEntry>& legend, double width, double top, int* rows) {
  std::string out;
  double x = kMargin + kLeft;
  *rows = 1;
  for (const LegendEntry& e : legend) {
    const double space = 44 + kLegendWidth * 0.78 * static_cast<double>(e.label.size());
    if (x + space > width && x > kMargin + kLeft) {
      x = kMargin + kLeft;
      ++*rows;
    }
    const double y = top + (*rows - 1) * kLegendHeight;
    out += format(
        "<line class=\"line\" stroke=\"%s\"%s x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>"
        "<text class=\"legend\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
        color(e.color), dash(e.color), x, x + 22, y, y, x + 29, y + 4, html_text(e.label).c_str());
    x += space;
  }
  return out;
}

}  // namespace

const char* palette_color(size_t index) {
  return color(index);
}

std::string draw_panel(const Panel& panel, const std::string& x_label) {
  const PanelDrawing drawing(panel, kLeft, kTop);
  return format(
             "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" "
             "data-left=\"%.0f\" "
             "data-width=\"%.0f\" data-low=\"%.9g\" data-high=\"%.9g\">\n",
             kLeft + kPanelWidth + kRight, kTop + kPanelHeight + kBottom, kLeft, kPanelWidth, drawing.x().low,
             drawing.x().high) +
         drawing.text(true, x_label) + "</svg>\n";
}

std::string draw_chart(const std::string& title, const std::vector<Panel>& panels, size_t columns,
                       const std::string& x_label, const std::vector<LegendEntry>& legend) {
  const double cell_width = kLeft + kPanelWidth + kRight, cell_height = kTop + kPanelHeight + kBottom;
  const size_t rows = (panels.size() + columns - 1) / columns;
  const double width = 2 * kMargin + static_cast<double>(columns) * cell_width;
  int legend_rows = 0;
  const std::string legend_text = draw_legend(legend, width, kMargin + kTitleHeight + 4, &legend_rows);
  const double head = kMargin + kTitleHeight + legend_rows * kLegendHeight;
  const double height = head + static_cast<double>(rows) * cell_height + kMargin;
  std::string out = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\">\n",
      width, height, width, height);
  out += std::string(kChartMark) + '\n';
  out +=
      "<style>text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;font-size:11px;fill:#333}"
      ".head{font-size:17px;font-weight:bold;fill:#111}.title{font-size:13px;font-weight:bold}.legend{font-"
      "size:12px}"
      ".x,.label{text-anchor:middle}.y{text-anchor:end}.label{fill:#555}"
      ".grid{stroke:#e6e6e6;stroke-width:1}.axis{stroke:#888;stroke-width:1;fill:none}"
      ".line{fill:none;stroke-width:2;stroke-linejoin:round;stroke-linecap:round}.band{opacity:.18;stroke:"
      "none}"
      ".level{stroke-width:1.5;stroke-dasharray:6 4}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  out += format("<text class=\"head\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", kMargin + kLeft, kMargin + 18,
                html_text(title).c_str());
  out += legend_text;
  for (size_t i = 0; i < panels.size(); ++i) {
    const double left = kMargin + static_cast<double>(i % columns) * cell_width + kLeft;
    const double top = head + static_cast<double>(i / columns) * cell_height + kTop;
    out += PanelDrawing(panels[i], left, top).text(i + columns >= panels.size(), x_label);
  }
  return out + "</svg>\n";
}

}  // namespace tool
