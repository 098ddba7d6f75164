#include "env/fit_heightfield.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/error.h"
#include "env/collect.h"

namespace sandwright {
namespace {

// Strokes that a heightfield with other parameters made: the search must find its way there.
class FitHeightfieldTest : public testing::Test {
 protected:
  std::filesystem::path Strokes(const std::string& name, uint64_t seed) {
    CollectConfig config;
    config.cell_size_m = 0.01;
    config.heightfield.cut.bite_m = 0.008;
    const auto file = std::filesystem::path(testing::TempDir()) / (name + ".h5");
    std::filesystem::remove(file);
    Collect(config, {.out = file, .strokes = 6, .sequence = 6, .seed = seed});
    return file;
  }
};

TEST_F(FitHeightfieldTest, FindsTheParameterThatMadeTheStrokes) {
  CalibrationConfig config;
  config.cell_sizes_m = {0.01};
  config.parameters = {"cut.bite_m"};
  int calls = 0;
  const Calibration found = CalibrateHeightfield(
      config, {Strokes("fit_a", 1)}, {Strokes("fit_b", 2)}, 1, [&](int, double) { ++calls; });
  EXPECT_NEAR(found.heightfield.cut.bite_m, 0.008, 0.0005);
  EXPECT_GT(found.fitted.r2_change, 0.995);
  EXPECT_LT(found.start.r2_change, 0.97);
  ASSERT_TRUE(found.validation);
  EXPECT_GT(found.validation->r2_change, 0.99);
  EXPECT_EQ(calls, found.evaluations);
  EXPECT_EQ(found.heightfield.repose_deg, 33);
}

TEST_F(FitHeightfieldTest, RefusesOneBedInBothSetsAndKeysThatAreNoNumbers) {
  const auto file = Strokes("fit_c", 3);
  CalibrationConfig config;
  const auto fit = [&] { CalibrateHeightfield(config, {file}, {file}, 1, [](int, double) {}); };
  EXPECT_THAT(fit,
              testing::ThrowsMessage<Error>(testing::HasSubstr("in both --data and --validation")));
  config.parameters = {"cut.bight_m"};
  EXPECT_THAT(fit, testing::ThrowsMessage<Error>(testing::HasSubstr("'cut.bight_m'")));
}

}  // namespace
}  // namespace sandwright
