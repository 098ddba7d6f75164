#include "cli/score_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "env/kernel_density.h"

namespace sandwright {
namespace {

std::string Text(const nlohmann::json& number, int decimals) {
  return number.is_number() ? fmt::format("{:.{}f}", number.get<double>(), decimals) : "-";
}

std::string Text(const std::optional<double>& number, int decimals) {
  return number ? fmt::format("{:.{}f}", *number, decimals) : "-";
}

}  // namespace

std::string DescribeScore(const ScoreReport& report) {
  const ScoreSummary total = report.Total();
  const nlohmann::json json = report.ToJson();
  std::string text = fmt::format(
      "{} on {} strokes, cells of {:g} mm: MAE {} mm, RMSE {} mm (mode {}), worst cell {} mm on "
      "average,\n  r2_change {}, explained {} (floor {:.2f} mm, {}), volume drift {}, {:.2f} ms a "
      "stroke\n",
      report.model, total.strokes, report.cell_size_m * 1e3, Text(total.mae_mm, 2),
      Text(total.rmse_mean_mm, 2), Text(total.rmse_mode_mm, 2), Text(total.mean_max_abs_mm, 1),
      Text(total.r2_change, 3), Text(total.explained, 3), report.floor_mm, report.floor_source,
      Text(total.volume_drift_rel, 3), report.ms_per_stroke);
  text += "  RMSE by class:";
  for (const auto& [name, of_class] : json["by_complexity"].items())
    text += fmt::format(" {} {} ({})", name, Text(of_class["rmse_mean_mm"], 2),
                        of_class["strokes"].get<int>());
  text += "\n";
  if (report.floor_max_abs_mm)
    text +=
        fmt::format("  worst cell between two replicates: {:.1f} mm, of one of them {:.1f} mm\n",
                    *report.floor_max_abs_mm, json["floor_max_abs_single_mm"].get<double>());
  if (report.strokes_failed > 0)
    text += fmt::format("  {} strokes left out: grains were lost in them\n", report.strokes_failed);
  if (const auto correlation = report.RangeErrorCorrelation())
    text +=
        fmt::format("  RMSE against distance from the training strokes: rank correlation {:.2f}\n",
                    *correlation);
  for (const AccruedError& error : report.accrued) {
    if (json["accrued_rmse_mm"].contains(std::to_string(error.step)))
      text += fmt::format("  accrued RMSE after {} strokes: {:.2f} mm ({} sequences)\n", error.step,
                          error.rmse_mm, error.sequences);
  }
  if (report.accrued_growth_exponent)
    text +=
        fmt::format("  accrued RMSE grows as strokes^{:.2f}\n", *report.accrued_growth_exponent);
  if (report.paper_mae_mm)
    text += fmt::format(
        "  paper's protocol: MAE {:.2f} mm, RMSE (mode) {:.2f} mm, mean of maxima {:.1f} mm\n",
        *report.paper_mae_mm, *report.paper_rmse_mode_mm, *report.paper_mean_max_mm);
  return text;
}

std::string DescribeComparison(const PairedComparison& comparison, const std::string& model,
                               const std::string& against) {
  return fmt::format(
      "explained: {} {:.4f}, {} {:.4f}; difference {:+.4f}, 95 % interval {:+.4f} to {:+.4f}\n"
      "  ({} resamples of {} {}, {} strokes; better in {:.1f} % of them)\n",
      model, comparison.explained, against, comparison.explained_against, comparison.difference,
      comparison.low95, comparison.high95, comparison.resamples, comparison.units, comparison.unit,
      comparison.strokes, 100 * comparison.better_share);
}

Chart RmseDensityChart(const ScoreReport& report) {
  std::vector<double> rmse_mm;
  for (const StrokeScore& s : report.strokes) rmse_mm.push_back(std::sqrt(s.mse_mm2()));
  const KernelDensity density(rmse_mm);
  const auto [least, most] = std::ranges::minmax(rmse_mm);
  const double margin_mm = 3 * density.bandwidth();
  ChartSeries curve{.name = fmt::format("{}, {} strokes", report.model, rmse_mm.size()),
                    .colour = "#1f6fb2",
                    .markers = false};
  double highest = 1;  // all strokes alike: no curve, only the lines
  if (density.bandwidth() > 0) {
    constexpr int kPoints = 200;
    highest = 0;
    for (int i = 0; i <= kPoints; ++i) {
      const double low_mm = std::max(least - margin_mm, 0.0);
      curve.x.push_back(low_mm + (most + margin_mm - low_mm) * i / kPoints);
      curve.y.push_back(density.At(curve.x.back()));
      highest = std::max(highest, curve.y.back());
    }
  }
  const auto upright = [&](std::string name, double x_mm, const char* colour) {
    return ChartSeries{.name = std::move(name),
                       .x = {x_mm, x_mm},
                       .y = {0, highest},
                       .colour = colour,
                       .markers = false};
  };
  Chart chart{.x_label = "RMSE of a stroke over its score window [mm]",
              .y_label = "density [1/mm]",
              .series = {std::move(curve)}};
  chart.series.push_back(
      upright(fmt::format("mode {:.2f} mm", density.Mode()), density.Mode(), "#c8501e"));
  if (report.floor_mm > 0)
    chart.series.push_back(
        upright(fmt::format("noise floor {:.2f} mm", report.floor_mm), report.floor_mm, "#888888"));
  return chart;
}

}  // namespace sandwright
