// A score for people: lines to read and a picture of how the errors are spread.
#pragma once

#include <optional>
#include <string>

#include "cli/svg_chart.h"
#include "env/paired_bootstrap.h"
#include "env/score_model.h"

namespace sandwright {

// The lines that `score` prints.
std::string DescribeScore(const ScoreReport& report);
std::string DescribeComparison(const PairedComparison& comparison, const std::string& model,
                               const std::string& against);

// The density of the strokes' RMSE, its mode marked, and the noise floor.
Chart RmseDensityChart(const ScoreReport& report);

}  // namespace sandwright
