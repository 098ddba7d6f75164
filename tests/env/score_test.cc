#include "env/score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sandwright {
namespace {

constexpr double kCell_m = 0.01;

ToolPath StraightPath(double x0_m, double x1_m, double y_m) {
  ToolPath path;
  for (int i = 0; i <= 10; ++i) path.push_back({x0_m + (x1_m - x0_m) * i / 10, y_m, 0.03, 0});
  return path;
}

TEST(StrokeWindow, GrowsByTheMarginAndFurtherAhead) {
  const HeightMap map(80, 120, kCell_m, 0.05f);
  const CellRect window = StrokeWindow(map, StraightPath(0.4, 0.6, 0.4));
  EXPECT_EQ(window.column0, 32);  // 0.400 - 0.075 = 0.325: the cell from 0.32
  EXPECT_EQ(window.column1, 72);  // 0.600 + 0.120
  EXPECT_EQ(window.row0, 32);
  EXPECT_EQ(window.row1, 48);  // 0.475: the cell to 0.48
}

TEST(StrokeWindow, IsClippedToTheBox) {
  const HeightMap map(30, 30, kCell_m, 0.05f);
  const CellRect window = StrokeWindow(map, StraightPath(0.05, 0.25, 0.29));
  EXPECT_EQ(window.column0, 0);
  EXPECT_EQ(window.column1, 30);
  EXPECT_EQ(window.row0, 21);
  EXPECT_EQ(window.row1, 30);
  EXPECT_TRUE(StrokeWindow(map, StraightPath(2, 2.1, 2)).empty());
}

TEST(Score, HandNumbers) {
  const HeightMap before(40, 60, kCell_m, 0.05f);
  HeightMap truth = before, prediction = before;
  truth.At(20, 20) += 0.010f;  // error 4 mm, change 10 mm
  prediction.At(20, 20) += 0.006f;
  prediction.At(20, 25) -= 0.003f;  // error 3 mm, change 0
  const ToolPath path = StraightPath(0.2, 0.3, 0.2);
  const CellRect window = ScoreWindow(before, truth, prediction, path);
  const double cells = window.rows() * window.columns();
  EXPECT_EQ(window.rows(), 16);     // 0.125..0.275 touches the cells from 0.12 to 0.28
  EXPECT_EQ(window.columns(), 30);  // 0.125..0.420

  const StrokeScore score = ScoreStroke(before, truth, prediction, path);
  EXPECT_EQ(score.cells, 480);
  EXPECT_NEAR(score.absolute_mm, 7, 1e-4);
  EXPECT_NEAR(score.squared_mm2, 25, 1e-3);
  EXPECT_NEAR(score.change_mm2, 100, 1e-3);
  EXPECT_NEAR(score.max_abs_mm, 4, 1e-4);
  EXPECT_NEAR(score.volume_drift_rel.value(), (6.0 - 3.0) / (9.0 / 2), 1e-4);

  const ScoreSummary summary = Summarise(std::span(&score, 1), 0.1);
  EXPECT_NEAR(summary.mae_mm.value(), 7 / cells, 1e-6);
  EXPECT_NEAR(summary.rmse_mean_mm.value(), std::sqrt(25 / cells), 1e-6);
  EXPECT_NEAR(summary.rmse_mode_mm.value(), std::sqrt(25 / cells), 1e-6);
  EXPECT_NEAR(summary.r2_change.value(), 0.75, 1e-5);
  EXPECT_NEAR(summary.explained.value(), 1 - (25 / cells - 0.01) / (100 / cells - 0.01), 1e-5);
}

TEST(Score, NothingChangesIsZeroAndTruthIsOne) {
  const HeightMap before(40, 60, kCell_m, 0.05f);
  HeightMap truth = before;
  truth.At(3, 55) += 0.004f;  // far from the path: the window must reach it
  const ToolPath path = StraightPath(0.2, 0.3, 0.2);
  const StrokeScore still = ScoreStroke(before, truth, before, path);
  EXPECT_DOUBLE_EQ(Summarise(std::span(&still, 1), 0).r2_change.value(), 0);
  EXPECT_FALSE(still.volume_drift_rel.has_value());
  const StrokeScore exact = ScoreStroke(before, truth, truth, path);
  EXPECT_DOUBLE_EQ(Summarise(std::span(&exact, 1), 0).r2_change.value(), 1);
  EXPECT_EQ(exact.cells, (28 - 3) * (56 - 12));
}

TEST(Score, UnseenCellsDoNotCount) {
  const HeightMap before(40, 60, kCell_m, 0.05f);
  HeightMap truth = before;
  truth.At(20, 20) += 0.010f;
  truth.valid.assign(truth.size(), 1);
  truth.valid[truth.Index(20, 20)] = 0;
  const ToolPath path = StraightPath(0.2, 0.3, 0.2);
  const StrokeScore score = ScoreStroke(before, truth, before, path);
  EXPECT_EQ(score.cells, 479);
  EXPECT_DOUBLE_EQ(score.squared_mm2, 0);
  EXPECT_FALSE(Summarise(std::span(&score, 1), 0).r2_change.has_value());
  truth.valid.assign(truth.size(), 0);
  EXPECT_THROW(ScoreStroke(before, truth, before, path), Error);
}

TEST(Score, MeansPoolCellsAndTheModeFollowsTheCrowd) {
  std::vector<StrokeScore> strokes(3);
  for (StrokeScore& s : strokes)
    s.cells = 100, s.squared_mm2 = 100, s.absolute_mm = 80, s.max_abs_mm = 5;
  strokes[2].cells = 300;
  strokes[2].squared_mm2 = 2700;  // RMSE 3
  strokes[2].max_abs_mm = 11;
  const ScoreSummary summary = Summarise(strokes, 0);
  EXPECT_NEAR(summary.rmse_mean_mm.value(), std::sqrt(2900.0 / 500), 1e-12);
  EXPECT_NEAR(summary.mae_mm.value(), 240.0 / 500, 1e-12);
  EXPECT_NEAR(summary.mean_max_abs_mm.value(), 7, 1e-12);
  EXPECT_NEAR(summary.rmse_mode_mm.value(), 1, 0.2);
  EXPECT_FALSE(Summarise({}, 0).mae_mm.has_value());
}

TEST(NoiseFloor, HalfTheSquaredDifferenceOfReplicates) {
  const HeightMap before(40, 60, kCell_m, 0.05f);
  HeightMap a = before, b = before;
  a.At(20, 20) -= 0.006f;
  b.At(20, 20) -= 0.004f;   // changed in both, 2 mm apart: 2 mm^2
  a.At(20, 22) += 0.0005f;  // changed in neither: does not count
  NoiseFloor floor;
  EXPECT_DOUBLE_EQ(floor.rmse_mm(), 0);
  EXPECT_FALSE(floor.max_abs_mm().has_value());
  floor.Add(before, a, before, b, StraightPath(0.2, 0.3, 0.2));
  EXPECT_EQ(floor.pairs(), 1);
  EXPECT_NEAR(floor.rmse_mm(), std::sqrt(2.0 / 480), 1e-6);
  EXPECT_NEAR(floor.max_abs_mm().value(), 2, 1e-4);
  a.At(20, 20) += 0.006f;  // the second pair: 4 mm
  floor.Add(before, a, before, b, StraightPath(0.2, 0.3, 0.2));
  EXPECT_NEAR(floor.max_abs_mm().value(), 3, 1e-4);
}

}  // namespace
}  // namespace sandwright
