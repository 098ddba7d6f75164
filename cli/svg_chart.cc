#include "cli/svg_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

struct Axis {
  double low, high, step;
  double Share(double value) const { return (value - low) / (high - low); }
};

// About `count` steps of 1, 2 or 5 times a power of ten that cover [low, high].
Axis RoundAxis(double low, double high, int count) {
  if (!(high > low)) high = low + 1;
  const double raw = (high - low) / count;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  const double step = power * (raw / power > 5   ? 10
                               : raw / power > 2 ? 5
                               : raw / power > 1 ? 2
                                                 : 1);
  return {std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step, step};
}

}  // namespace

std::string DrawChart(const Chart& chart) {
  const auto scaled = [&](double x) { return chart.logarithmic_x ? std::log10(x) : x; };
  double x_low = 1e300, x_high = -1e300, y_low = chart.from_zero ? 0 : 1e300, y_high = -1e300;
  const auto include_y = [&](double y) {
    y_low = std::min(y_low, y), y_high = std::max(y_high, y);
  };
  for (const ChartSeries& series : chart.series) {
    SAND_CHECK(series.x.size() == series.y.size(), series.name);
    for (size_t i = 0; i < series.x.size(); ++i) {
      if (std::isnan(series.x[i])) continue;
      x_low = std::min(x_low, scaled(series.x[i])), x_high = std::max(x_high, scaled(series.x[i]));
      include_y(series.y[i]);
    }
    SAND_CHECK(series.low.size() == series.high.size() &&
                   (series.low.empty() || series.low.size() == series.x.size()),
               series.name);
    for (size_t i = 0; i < series.low.size(); ++i) include_y(series.low[i]), include_y(series.high[i]);
  }
  SAND_CHECK(x_low <= x_high);
  if (chart.reference_y) include_y(*chart.reference_y);
  const Axis x_axis = chart.logarithmic_x ? Axis{std::floor(x_low), std::ceil(x_high), 1}
                                          : RoundAxis(x_low, x_high, 8);
  const Axis y_axis = RoundAxis(y_low, y_high, 5);

  const double left = 56, right = 24, top = 14, bottom = 64;
  const double plot_width = chart.width_px - left - right,
               plot_height = chart.height_px - top - bottom;
  const auto px = [&](double x) { return left + x_axis.Share(scaled(x)) * plot_width; };
  const auto py = [&](double y) { return top + (1 - y_axis.Share(y)) * plot_height; };

  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" class=\"chart\">\n",
      chart.width_px, chart.height_px);
  for (double y = y_axis.low; y <= y_axis.high + y_axis.step / 2; y += y_axis.step) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
        left, left + plot_width, py(y), py(y), left - 6, py(y) + 4,
        std::abs(y) < y_axis.step * 1e-9 ? 0 : y);
  }
  for (double at = x_axis.low; at <= x_axis.high + x_axis.step / 2; at += x_axis.step) {
    const double x = chart.logarithmic_x ? std::pow(10, at) : at;
    svg += fmt::format(
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>\n",
        px(x), top + plot_height + 16, std::abs(x) < x_axis.step * 1e-9 ? 0 : x);
  }
  svg += fmt::format(
      "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
      left + plot_width / 2, top + plot_height + 34, chart.x_label);
  svg += fmt::format(
      "<text class=\"label\" transform=\"translate(13 {:.1f}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      top + plot_height / 2, chart.y_label);
  if (chart.reference_y) {
    svg += fmt::format(
        "<line class=\"reference\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
        left, left + plot_width, py(*chart.reference_y), py(*chart.reference_y),
        left + plot_width - 4, py(*chart.reference_y) + 15, chart.reference_name);
  }
  double legend_x = left;
  for (const ChartSeries& series : chart.series) {
    std::string points;
    for (size_t i = 0; i < series.low.size(); ++i)
      points += fmt::format("{:.1f},{:.1f} ", px(series.x[i]), py(series.low[i]));
    for (size_t i = series.high.size(); i-- > 0;)
      points += fmt::format("{:.1f},{:.1f} ", px(series.x[i]), py(series.high[i]));
    if (!points.empty())
      svg += fmt::format("<polygon points=\"{}\" fill=\"{}\" opacity=\"0.2\"/>\n", points,
                         series.colour);
    points.clear();
    const auto finish_line = [&] {
      if (!points.empty())
        svg += fmt::format(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", points,
            series.colour);
      points.clear();
    };
    for (size_t i = 0; i < series.x.size(); ++i) {
      if (std::isnan(series.x[i])) {
        finish_line();
      } else {
        points += fmt::format("{:.1f},{:.1f} ", px(series.x[i]), py(series.y[i]));
      }
    }
    finish_line();
    for (size_t i = 0; series.markers && i < series.x.size(); ++i)
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>",
                         px(series.x[i]), py(series.y[i]), series.colour);
    const double legend_y = chart.height_px - 12;
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2}\" y2=\"{2}\" stroke=\"{3}\" "
        "stroke-width=\"3\"/><text class=\"tick\" x=\"{4:.1f}\" y=\"{5}\">{6}</text>\n",
        legend_x, legend_x + 18, legend_y, series.colour, legend_x + 24, legend_y + 4, series.name);
    legend_x += 42 + 7.2 * static_cast<double>(series.name.size());
  }
  return svg + "</svg>\n";
}

std::string DrawChartFile(const Chart& chart) {
  std::string svg = DrawChart(chart);
  svg.insert(svg.find(' '), " xmlns=\"http://www.w3.org/2000/svg\"");
  svg.insert(svg.find('\n') + 1,
             "<style>.grid{stroke:#ddd} .reference{stroke:#888;stroke-dasharray:6 4} "
             "text{font:12px sans-serif;fill:#333}</style>\n"
             "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
  return svg;
}

}  // namespace sandwright
