#include "env/score_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>

#include "data/base/stop.h"
#include "data/stroke_dataset.h"
#include "env/paper_protocol.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Lowers every cell of the map by 1 mm a stroke, on cells of any size.
class SinkingSand final : public SandModel {
 public:
  std::string name() const override { return "sinking"; }
  const Blade& blade() const override { return blade_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath>) const override {
    for (SandState& state : states) {
      HeightMap map = state.map();
      for (float& h : map.height_m) h -= 0.001f;
      state.Replace(std::move(map));
    }
    return std::vector<Outcome>(states.size());
  }

 private:
  Blade blade_;
};

// A sequence in which each stroke lowers the whole 300 mm bed by `drop_m`.
StrokeFile Sequence(int strokes, float drop_m) {
  StrokeFile file;
  file.source = "heightfield";
  file.bed = "made";
  StrokeRecord record;
  record.before = HeightMap(75, 75, 0.004, 0.05f);
  record.stroke.control_points_m = {{0.1, 0.15, 0.04}, {0.2, 0.15, 0.04}};
  record.path = SamplePath(record.stroke, 0.002);
  for (int i = 0; i < strokes; ++i) {
    record.after = record.before;
    for (float& h : record.after.height_m) h -= drop_m;
    record.step = i;
    file.strokes.push_back(record);
    record.before = record.after;
  }
  return file;
}

class ScoreModelTest : public ::testing::Test {
 protected:
  std::vector<std::filesystem::path> Write(const StrokeFile& file) {
    const auto path = std::filesystem::path(::testing::TempDir()) / "score_model_test.h5";
    WriteStrokeFile(file, path);
    return {path};
  }
};

TEST_F(ScoreModelTest, StillSandExplainsNothing) {
  const nlohmann::json json = ScoreModel(StillSand(), Write(Sequence(3, 0.002f)), {}).ToJson();
  EXPECT_EQ(json["model"], "none");
  EXPECT_EQ(json["strokes"], 3);
  EXPECT_NEAR(json["mae_mm"], 2, 1e-4);
  EXPECT_NEAR(json["rmse_mean_mm"], 2, 1e-4);
  EXPECT_DOUBLE_EQ(json["r2_change"], 0);
  EXPECT_DOUBLE_EQ(json["explained"], 0);
  EXPECT_DOUBLE_EQ(json["floor_mm"], 0);
  EXPECT_THAT(json["floor_source"], HasSubstr("no replicates"));
  EXPECT_EQ(json["by_complexity"]["A"]["strokes"], 3);
  EXPECT_EQ(json["by_complexity"]["F"]["strokes"], 0);
  EXPECT_TRUE(json["by_complexity"]["F"]["mae_mm"].is_null());
  EXPECT_TRUE(json["volume_drift_rel"].is_null());
  EXPECT_TRUE(json["floor_max_abs_mm"].is_null());
  EXPECT_TRUE(json["range_error_correlation"].is_null());
  EXPECT_TRUE(json["per_stroke"][2]["training_distance"].is_null());
  EXPECT_EQ(json["per_stroke"][2]["class"], "A");
  EXPECT_EQ(json["per_stroke"][2]["cells"], 75 * 75);  // all changed
  EXPECT_FALSE(json.contains("accrued_rmse_mm"));
}

// Asks to stop as Ctrl-C does, at its second stroke: the first one only warms caches.
class StoppingSand final : public SandModel {
 public:
  std::string name() const override { return "stopping"; }
  const Blade& blade() const override { return blade_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath>) const override {
    if (++calls_ == 2) std::raise(SIGINT);
    return std::vector<Outcome>(states.size());
  }

 private:
  Blade blade_;
  mutable int calls_ = 0;
};

TEST_F(ScoreModelTest, AStopKeepsTheStrokesSoFar) {
  const auto files = Write(Sequence(3, 0.002f));
  EXPECT_EXIT(
      {
        InstallStopHandler();
        const auto json = ScoreModel(StoppingSand(), files, {}).ToJson();
        std::_Exit(json["stopped"] == true && json["strokes"] == 1 ? 7 : 8);
      },
      ::testing::ExitedWithCode(7), "");
}

TEST_F(ScoreModelTest, RolloutErrorsPileUp) {
  ScoreConfig config;
  config.rollout = true;
  const ScoreReport report = ScoreModel(SinkingSand(), Write(Sequence(6, 0.002f)), config);
  const nlohmann::json json = report.ToJson();
  EXPECT_EQ(json["accrued_rmse_mm"].size(), 2u);
  EXPECT_NEAR(json["accrued_rmse_mm"]["1"], 1, 1e-3);  // 1 mm behind after one stroke
  EXPECT_NEAR(json["accrued_rmse_mm"]["5"], 5, 1e-3);
  ASSERT_EQ(json["accrued"].size(), 6u);
  EXPECT_EQ(json["accrued"][5]["step"], 6);
  EXPECT_EQ(json["accrued"][5]["sequences"], 1);
  EXPECT_EQ(json["accrued"][5]["cells"], 75 * 75);
  EXPECT_NEAR(json["accrued"][5]["rmse_mm"], 6, 1e-3);
  EXPECT_NEAR(json["accrued_growth_exponent"], 1, 1e-3);
  EXPECT_NEAR(report.Total().rmse_mean_mm.value(), 1, 1e-3);  // single strokes start from the truth
  EXPECT_NEAR(report.Total().volume_drift_rel.value(), -2, 1e-6);
}

TEST_F(ScoreModelTest, CoarserModelsAreChargedForTheirChangeOnly) {
  StrokeFile file = Sequence(1, 0.001f);
  for (HeightMap* map : {&file.strokes[0].before, &file.strokes[0].after}) map->At(10, 10) += 0.02f;
  ScoreConfig config;
  config.model_cell_size_m = 0.012;
  const ScoreReport report = ScoreModel(SinkingSand(), Write(file), config);
  EXPECT_NEAR(report.Total().rmse_mean_mm.value(), 0, 1e-4);
  EXPECT_DOUBLE_EQ(report.model_cell_size_m, 0.012);
}

TEST_F(ScoreModelTest, FloorComesFromReplicatesUnlessGiven) {
  StrokeFile file = Sequence(1, 0.002f);
  StrokeRecord replicate = file.strokes[0];
  for (float& h : replicate.after.height_m) h += 0.0005f;
  replicate.sequence = 1;
  replicate.replicate_of = "00000";
  file.strokes.push_back(replicate);
  const auto files = Write(file);
  const ScoreReport report = ScoreModel(StillSand(), files, {});
  EXPECT_NEAR(report.floor_mm, 0.5 / std::sqrt(2), 1e-4);
  EXPECT_THAT(report.floor_source, HasSubstr("1 pairs"));
  EXPECT_NEAR(report.floor_max_abs_mm.value(), 0.5, 1e-4);
  EXPECT_NEAR(report.ToJson()["floor_max_abs_single_mm"], 0.5 / std::sqrt(2), 1e-4);
  ScoreConfig config;
  config.floor_mm = 1.0;
  EXPECT_DOUBLE_EQ(ScoreModel(StillSand(), files, config).floor_mm, 1.0);
  file.strokes[1].replicate_of = "00007";
  const auto broken = Write(file);
  EXPECT_THAT([&] { ScoreModel(StillSand(), broken, {}); },
              ThrowsMessage<Error>(HasSubstr("replicate of '00007'")));
}

TEST_F(ScoreModelTest, RefusesAnotherBladeAndCellsThatDoNotFit) {
  StrokeFile file = Sequence(1, 0.002f);
  const auto files = Write(file);
  ScoreConfig config;
  config.cell_size_m = 0.007;
  EXPECT_THAT([&] { ScoreModel(StillSand(), files, config); },
              ThrowsMessage<Error>(HasSubstr("cell_size_m = 0.007")));
  file.strokes[0].blade.width_m = 0.08;
  const auto wide = Write(file);
  EXPECT_THAT([&] { ScoreModel(StillSand(), wide, {}); },
              ThrowsMessage<Error>(HasSubstr("the blade is 0.08 x 0.005 m")));
}

TEST_F(ScoreModelTest, PicturesAndPaperCrop) {
  ScoreConfig config;
  config.paper = true;
  config.pictures = ::testing::TempDir() + "/score_pictures";
  const ScoreReport report = ScoreModel(StillSand(), Write(Sequence(1, 0.006f)), config);
  EXPECT_TRUE(std::filesystem::exists(config.pictures + "/score_model_test_00000.png"));
  EXPECT_TRUE(std::filesystem::exists(config.pictures + "/score_model_test_00000_paper.png"));
  const double level_mm = 150.0 / 255;  // of the 8 bits
  EXPECT_NEAR(report.paper_mae_mm.value(), 6, level_mm / 2);
  EXPECT_NEAR(report.paper_mean_max_mm.value(), 6, level_mm / 2);
}

TEST(PaperCrop, QuantisesAboveTheLowestPoint) {
  const HeightMap truth(60, 60, 0.005, 0.100f);
  HeightMap prediction = truth;
  for (float& h : prediction.height_m) h += 0.0002f;  // below half a level of 0.588 mm
  const ToolPath path = {{0.1, 0.1, 0.09, 0.78}, {0.2, 0.2, 0.09, 0.78}};
  EXPECT_DOUBLE_EQ(ScorePaperCrop(truth, prediction, path).mae_mm, 0);
  for (float& h : prediction.height_m) h += 0.0002f;
  const PaperScore score = ScorePaperCrop(truth, prediction, path);
  EXPECT_NEAR(score.mae_mm, 150.0 / 255, 1e-9);
  EXPECT_NEAR(score.rmse_mm, score.max_abs_mm, 1e-9);
  const ToolPath outside = {{5, 5, 0, 0}, {5.1, 5, 0, 0}};
  EXPECT_THROW(ScorePaperCrop(truth, prediction, outside), Error);
}

}  // namespace
}  // namespace sandwright
