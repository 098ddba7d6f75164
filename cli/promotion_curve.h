// What more strokes of a rig would bring, from the models that were trained on them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "env/score_model.h"
#include "env/stroke_curve.h"

namespace sandwright {

class PromotionCurve {
 public:
  // The model that more strokes would better, by its file, and its score on the rig's strokes.
  PromotionCurve(const std::string& model, const ScoreReport& report);
  // Another one; a file that does not say how many strokes it was trained on is left out.
  void Add(const std::string& model, const ScoreReport& report);

  // A line: the strokes until the error above the floor is a tenth smaller, or why that is not known.
  std::string Describe() const;
  nlohmann::json ToJson() const;  // points, exponent and more_strokes_for_10_percent, null: unknown

 private:
  std::optional<double> MoreStrokes() const;

  int strokes_ = 0;  // of the first model; 0: it does not say
  std::vector<StrokeCurvePoint> points_;
};

}  // namespace sandwright
