// Line charts as inline SVG for the pages that the program writes.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sandwright {

struct ChartSeries {
  std::string name;
  std::vector<double> x = {}, y = {};       // a NaN in x: the line ends here and begins anew
  std::vector<double> low = {}, high = {};  // of a band around y at each x; empty: none
  std::string colour = {};                  // any CSS colour
  bool markers = true;
};

struct Chart {
  std::string x_label, y_label;
  std::vector<ChartSeries> series = {};
  std::optional<double> reference_y = {};  // a dashed line, e.g. a target
  std::string reference_name = {};
  bool from_zero = true;       // the y axis starts at zero
  bool logarithmic_x = false;  // powers of ten; x > 0
  int width_px = 640, height_px = 320;
};

// An <svg> element with axes, ticks at round numbers and a legend, for a page with the style of html_page.h.
std::string DrawChart(const Chart& chart);
// The same as a file of its own.
std::string DrawChartFile(const Chart& chart);

}  // namespace sandwright
