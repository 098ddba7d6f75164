#include "robot_model/rescan_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

// Cells within `margin_m` of the path.
std::vector<bool> Swath(const HeightMap& map, const ToolPath& path, double margin_m) {
  std::vector<bool> near(map.size(), false);
  for (const BladePose& pose : path) {
    const auto cell = [&](double value_m, int count) {
      return std::clamp(static_cast<int>(value_m / map.cell_size_m), 0, count - 1);
    };
    for (int j = cell(pose.y_m - margin_m, map.rows); j <= cell(pose.y_m + margin_m, map.rows); ++j)
      for (int i = cell(pose.x_m - margin_m, map.columns);
           i <= cell(pose.x_m + margin_m, map.columns); ++i)
        if (std::hypot((i + 0.5) * map.cell_size_m - pose.x_m,
                       (j + 0.5) * map.cell_size_m - pose.y_m) <= margin_m)
          near[map.Index(j, i)] = true;
  }
  return near;
}

void Measure(const HeightMap& before, const HeightMap& predicted, const HeightMap& after,
             const std::vector<bool>& swath, RescanFigures& figures) {
  double outside = 0, error = 0, change = 0, moved = 0, predicted_moved = 0, net = 0;
  size_t inside_cells = 0, outside_cells = 0;
  figures.lowest_m = std::ranges::min(after.height_m);
  for (size_t i = 0; i < after.size(); ++i) {
    if (!after.valid.empty() && !after.valid[i]) continue;
    const double d = after.height_m[i] - before.height_m[i];
    if (!swath[i]) {
      outside += d * d;
      ++outside_cells;
      continue;
    }
    const double e = after.height_m[i] - predicted.height_m[i];
    error += e * e;
    change += d * d;
    moved += std::abs(d);
    predicted_moved += std::abs(predicted.height_m[i] - before.height_m[i]);
    net += d;
    ++inside_cells;
  }
  const auto rms = [](double sum, size_t count) {
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
  };
  const double cell_m2 = after.cell_size_m * after.cell_size_m;
  figures.outside_rms_m = rms(outside, outside_cells);
  figures.prediction_rmse_m = rms(error, inside_cells);
  figures.change_rms_m = rms(change, inside_cells);
  figures.moved_m3 = 0.5 * moved * cell_m2;
  figures.predicted_moved_m3 = 0.5 * predicted_moved * cell_m2;
  figures.net_m3 = net * cell_m2;
}

}  // namespace

RescanFigures CheckRescan(const HeightMap& before, const HeightMap& predicted,
                          const ScanResult& after, const ToolPath& path,
                          const RescanLimits& limits) {
  RescanFigures figures;
  const auto against = [&](RescanVerdict verdict, std::string reason) {
    figures.verdict = std::max(figures.verdict, verdict);
    figures.reasons.push_back(std::move(reason));
  };
  figures.invalid_share = after.invalid_share;
  figures.registration_m = after.registration_error_m.value_or(0);
  for (const std::string& reason : after.reasons) against(RescanVerdict::kStop, reason);
  if (!after.accepted) return figures;
  SAND_CHECK(after.map.SameGrid(before) && predicted.SameGrid(before));
  Measure(before, predicted, after.map, Swath(before, path, limits.swath_margin_m), figures);
  const auto above = [&](RescanVerdict verdict, const char* what, double value, double limit,
                         double scale, const char* unit) {
    if (value > limit)
      against(verdict,
              fmt::format("{} {:.2f}{}; limit {:.2f}{}", what, scale * value, unit, scale * limit, unit));
  };
  using enum RescanVerdict;
  above(kStop, "pixels without a reading:", figures.invalid_share, limits.max_invalid_share, 100, " %");
  above(kStop, "box walls off by", figures.registration_m, limits.max_registration_m, 1e3, " mm");
  above(kStop, "sand below the floor by", -figures.lowest_m, limits.floor_tolerance_m, 1e3, " mm");
  above(kStop, "change far from the stroke:", figures.outside_rms_m, limits.max_outside_rms_m, 1e3,
        " mm rms");
  above(kReplan, "prediction off by", figures.prediction_rmse_m, limits.max_prediction_rmse_m, 1e3,
        " mm rms");
  above(kReplan, "net change of volume", std::abs(figures.net_m3) * 1e6,
        limits.max_net_share * std::max(figures.moved_m3, figures.predicted_moved_m3) * 1e6, 1,
        " cm^3");
  return figures;
}

const char* NameOf(RescanVerdict verdict) {
  switch (verdict) {
    case RescanVerdict::kAccept: return "accept";
    case RescanVerdict::kReplan: return "replan";
    case RescanVerdict::kStop: return "stop";
  }
  return "";
}

nlohmann::json ToJson(const RescanFigures& figures) {
  return {{"verdict", NameOf(figures.verdict)},
          {"reasons", figures.reasons},
          {"invalid_share", figures.invalid_share},
          {"registration_mm", 1e3 * figures.registration_m},
          {"outside_rms_mm", 1e3 * figures.outside_rms_m},
          {"lowest_mm", 1e3 * figures.lowest_m},
          {"prediction_rmse_mm", 1e3 * figures.prediction_rmse_m},
          {"change_rms_mm", 1e3 * figures.change_rms_m},
          {"moved_cm3", 1e6 * figures.moved_m3},
          {"predicted_moved_cm3", 1e6 * figures.predicted_moved_m3},
          {"net_cm3", 1e6 * figures.net_m3}};
}

}  // namespace sandwright
