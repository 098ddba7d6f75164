#include "env/fit_surrogate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>

#include "data/base/stop.h"
#include "data/stroke_dataset.h"
#include "env/fit_samples.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two strokes on a flat bed whose truth is the heightfield's prediction, half as far: something
// that a net can learn.
std::filesystem::path WriteBed(const std::string& bed, double y_m, const Blade& blade = {},
                               bool sequence = false) {
  StrokeFile file;
  file.source = "heightfield";
  file.bed = bed;
  for (double x_m : {0.07, 0.10}) {
    StrokeRecord record;
    // Deep: fluxes that carry sand over many cells at once must not meet the limit of what lies in one.
    record.before = HeightMap(50, 50, 0.004, 0.5f);
    record.stroke.control_points_m = {{x_m, y_m, 0.48}, {x_m + 0.05, y_m + 0.02, 0.48}};
    record.path = SamplePath(record.stroke, 0.002);
    record.blade = blade;
    std::vector<SandState> state{SandState(record.before)};
    Heightfield().Apply(state, std::span(&record.path, 1));
    record.after = state[0].map();
    for (size_t i = 0; i < record.after.size(); ++i)
      record.after.height_m[i] = 0.5f * (record.after.height_m[i] + record.before.height_m[i]);
    if (sequence) record.step = static_cast<int64_t>(file.strokes.size());
    file.strokes.push_back(record);
  }
  const auto path = std::filesystem::path(::testing::TempDir()) / ("fit_" + bed + ".h5");
  WriteStrokeFile(file, path);
  return path;
}

FitConfig SmallFit(int epochs) {
  FitConfig config;
  config.epochs = epochs;
  config.batch_size = 1;
  config.learning_rate = 1e-2;
  config.surrogate.net.base_channels = 8;
  config.surrogate.net.poolings = 1;
  config.surrogate.conserve_volume = false;  // training knows nothing of it
  return config;
}

std::filesystem::path Save(const Safetensors& model, const std::string& name) {
  const auto path = std::filesystem::path(::testing::TempDir()) / name;
  WriteSafetensors(model, path);
  return path;
}

class FitArchitecture : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, FitArchitecture,
                         ::testing::Values("residual", "flux", "direct", "linear"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(FitArchitecture, LearnsWhatItStartsWithoutAndPredictsAsInTraining) {
  const FitRequest request{{WriteBed("a", 0.10)}, {WriteBed("b", 0.11)}, {}, 1, 1};
  FitConfig config = SmallFit(80);
  config.surrogate.net.architecture = GetParam();
  config.surrogate.net.patch_cells = 2;
  config.surrogate.reach_m = 0.06;
  config.learning_rate = 1e-3;
  const FitReport report = FitSurrogate(config, request);
  EXPECT_EQ(report.strokes, 2);
  // Fluxes learn slower: sand that ends elsewhere passes every cell between.
  const double left = config.surrogate.net.architecture == "flux" ? 0.8 : 0.5;
  EXPECT_LT(report.validation_rmse_mm.value(), left * report.validation_start_rmse_mm.value());

  // The file's net, without torch, makes the errors that training saw.
  const Surrogate model = ReadSurrogate(Save(report.model, "fitted.safetensors"), 1);
  double squared_mm2 = 0, cells = 0;
  for (const StrokeRecord& record : ReadStrokeFile(request.validation[0]).strokes) {
    std::vector<SandState> state{SandState(record.before)};
    model.Apply(state, std::span(&record.path, 1));
    const CellRect window = StrokeWindow(record.before, record.path);
    for (int row = window.row0; row < window.row1; ++row) {
      for (int column = window.column0; column < window.column1; ++column, ++cells)
        squared_mm2 +=
            std::pow(1e3 * (state[0].map().At(row, column) - record.after.At(row, column)), 2);
    }
  }
  EXPECT_NEAR(std::sqrt(squared_mm2 / cells), report.validation_rmse_mm.value(), 1e-3);
}

TEST(FitSurrogate, SameSeedSameBytes) {
  const FitRequest request{{WriteBed("a", 0.10)}, {}, {}, 5, 1};
  FitRequest other = request;
  other.seed = 6;
  const auto head = [&](const FitRequest& r) {
    return FitSurrogate(SmallFit(3), r).model.tensors.at("up0a.weight").values;
  };
  EXPECT_EQ(head(request), head(request));
  EXPECT_NE(head(request), head(other));
}

TEST(FitSurrogate, AnInterruptedFitGoesOnBitForBit) {
  FitRequest request{{WriteBed("s", 0.10, {}, true)}, {WriteBed("b", 0.11)}, {}, 5, 1};
  FitConfig config = SmallFit(5);
  config.turn_deg = 20;
  config.shift_cells = 0.5;
  config.average_steps = 3;
  config.pushforward_steps = 2;
  const FitReport whole = FitSurrogate(config, request);
  request.state = std::filesystem::path(::testing::TempDir()) / "fit.state";
  request.log = std::filesystem::path(::testing::TempDir()) / "events";
  std::filesystem::remove_all(*request.log);
  request.epochs_now = 2;
  EXPECT_TRUE(FitSurrogate(config, request).stopped);
  request.epochs_now = 0;
  request.resume = true;
  const FitReport resumed = FitSurrogate(config, request);
  EXPECT_EQ(resumed.epochs, 5);
  const std::filesystem::directory_iterator events(*request.log);
  EXPECT_EQ(std::distance(begin(events), end(events)), 2);  // one of each call
  EXPECT_EQ(resumed.best_epoch, whole.best_epoch);
  EXPECT_EQ(resumed.validation_rmse_mm, whole.validation_rmse_mm);
  ASSERT_EQ(resumed.model.tensors.size(), whole.model.tensors.size());
  for (const auto& [name, tensor] : whole.model.tensors)
    EXPECT_EQ(resumed.model.tensors.at(name).values, tensor.values) << name;
  config.huber_mm = 3;
  EXPECT_THAT([&] { FitSurrogate(config, request); },
              ThrowsMessage<Error>(HasSubstr("not the state of this fit: another fit")));
}

TEST(FitSurrogate, PushforwardStartsFromItsOwnPredictionWhereStrokesFollowEachOther) {
  const auto weights = [&](bool sequence, int steps) {
    FitConfig config = SmallFit(3);
    config.pushforward_steps = steps;
    const FitRequest request{{WriteBed("p", 0.10, {}, sequence)}, {}, {}, 5, 1};
    return FitSurrogate(config, request).model.tensors.at("up0a.weight").values;
  };
  EXPECT_EQ(weights(false, 2), weights(false, 1));
  EXPECT_EQ(weights(true, 1), weights(false, 1));
  EXPECT_NE(weights(true, 2), weights(true, 1));
}

TEST(FitSurrogate, ContinuesFromAnotherAndNamesTheBatchThatBreaks) {
  FitRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  FitReport first = FitSurrogate(SmallFit(30), request);
  request.init = Save(first.model, "first.safetensors");
  FitConfig gentle = SmallFit(1);
  gentle.learning_rate = 1e-6;
  EXPECT_NEAR(FitSurrogate(gentle, request).train_rmse_mm, first.train_rmse_mm,
              0.3 * first.train_rmse_mm);
  for (float& w : first.model.tensors["down0a.weight"].values) w = 3e38f;
  request.init = Save(first.model, "broken.safetensors");
  EXPECT_THAT([&] { FitSurrogate(SmallFit(1), request); },
              ThrowsMessage<Error>(::testing::AllOf(HasSubstr("not finite in epoch 1, batch 1"),
                                                    HasSubstr("fit_a.h5, stroke"))));
  FitConfig wider = SmallFit(1);
  wider.surrogate.net.base_channels = 12;
  EXPECT_THAT([&] { FitSurrogate(wider, request); },
              ThrowsMessage<Error>(HasSubstr("another shape")));
}

TEST(FitSurrogate, LearnsFromStrokesMadeAnewInEachPass) {
  FitConfig config = SmallFit(2);
  config.surrogate.net.architecture = "direct";
  config.generate.strokes = 20;
  config.generate.drawn.width_m = config.generate.drawn.depth_m = 0.2;
  const FitReport report = FitSurrogate(config, {{}, {}, {}, 3, 1});
  EXPECT_EQ(report.strokes, 20);
  EXPECT_EQ(FitSurrogate(config, {{}, {}, {}, 3, 1}).model.tensors.at("head.weight").values,
            report.model.tensors.at("head.weight").values);

  const auto heights = [&](uint64_t seed, int epoch) {
    const FitStrokes made = GenerateStrokes(config.generate, 0.004, seed, epoch);
    EXPECT_EQ(made.strokes[3].behind, 3u);
    EXPECT_EQ(made.strokes[4].behind, 0u);
    EXPECT_EQ(made.strokes[2].record.before.height_m, made.strokes[1].record.after.height_m);
    return made.strokes.back().record.after.height_m;
  };
  EXPECT_EQ(heights(3, 1), heights(3, 1));
  EXPECT_NE(heights(3, 1), heights(3, 2));
  EXPECT_NE(heights(3, 1), heights(4, 1));

  config.generate.drawn.width_m = 0.201;
  EXPECT_THAT(
      [&] {
        FitSurrogate(config, {{}, {}, {}, 3, 1});
      },
      ThrowsMessage<Error>(HasSubstr("width_m = 0.201")));
}

TEST(FitSurrogate, RefusesABedInBothSetsAndAnotherBlade) {
  const auto bed = WriteBed("a", 0.10);
  EXPECT_THAT(
      [&] {
        FitSurrogate(SmallFit(1), {{bed}, {bed}, {}, 1, 1});
      },
      ThrowsMessage<Error>(HasSubstr("bed 'a' is in both")));
  Blade wide;
  wide.width_m = 0.07;
  const auto other = WriteBed("wide", 0.10, wide);
  EXPECT_THAT(
      [&] {
        FitSurrogate(SmallFit(1), {{other}, {}, {}, 1, 1});
      },
      ThrowsMessage<Error>(HasSubstr("the blade is 0.07 x 0.005 m")));
  FitConfig odd = SmallFit(1);
  odd.surrogate.cell_size_m = 0.007;
  EXPECT_THAT(
      [&] {
        FitSurrogate(odd, {{bed}, {}, {}, 1, 1});
      },
      ThrowsMessage<Error>(HasSubstr("cell_size_m = 0.007")));
}

TEST(FitSurrogateDeathTest, AStopBeforeTheFirstEpochLeavesNothing) {
  const auto bed = WriteBed("a", 0.10);
  EXPECT_EXIT(
      {
        InstallStopHandler();
        std::raise(SIGINT);
        try {
          FitSurrogate(SmallFit(100), {{bed}, {}, {}, 1, 1});
        } catch (const Error& e) {
          std::_Exit(e.kind() == ErrorKind::kInterrupted ? 130 : 1);
        }
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace sandwright
