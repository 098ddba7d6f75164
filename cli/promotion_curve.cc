#include "cli/promotion_curve.h"

#include <spdlog/fmt/fmt.h>

#include "env/model_origin.h"

namespace sandwright {

constexpr double kGain = 0.1;

PromotionCurve::PromotionCurve(const std::string& model, const ScoreReport& report) {
  Add(model, report);
  if (!points_.empty()) strokes_ = points_.front().strokes;
}

void PromotionCurve::Add(const std::string& model, const ScoreReport& report) {
  const auto strokes = OriginOf(ReadSafetensors(model), model).strokes;
  const double rmse_mm = report.Total().rmse_mean_mm.value();
  if (strokes)
    points_.push_back({*strokes, rmse_mm * rmse_mm - report.floor_mm * report.floor_mm});
}

std::optional<double> PromotionCurve::MoreStrokes() const {
  const auto curve = FitStrokeCurve(points_);
  return curve && strokes_ > 0 ? curve->MoreStrokes(strokes_, kGain) : std::nullopt;
}

std::string PromotionCurve::Describe() const {
  const auto curve = FitStrokeCurve(points_);
  if (!curve || strokes_ == 0)
    return "learning curve: it takes two models of this rig with different numbers of training "
           "strokes to tell what more strokes would bring (--earlier)";
  const auto more = MoreStrokes();
  if (!more) return "learning curve: more strokes have not made the error smaller so far";
  return fmt::format(
      "learning curve: the squared error above the floor falls as strokes^-{:.2f} over {} models; a "
      "tenth less takes about {:.0f} strokes more than the {} of the candidate",
      curve->exponent, points_.size(), *more, strokes_);
}

nlohmann::json PromotionCurve::ToJson() const {
  nlohmann::json points = nlohmann::json::array();
  for (const StrokeCurvePoint& point : points_)
    points.push_back({{"strokes", point.strokes}, {"excess_mm2", point.excess_mm2}});
  const auto curve = FitStrokeCurve(points_);
  const auto more = MoreStrokes();
  return {{"points", points},
          {"exponent", curve ? nlohmann::json(curve->exponent) : nlohmann::json()},
          {"more_strokes_for_10_percent", more ? nlohmann::json(*more) : nlohmann::json()}};
}

}  // namespace sandwright
