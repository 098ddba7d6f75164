// The checks of the grains on scenes of some hundred grains: slopes, collapse, and one stroke repeated.
// `sandwright bench --suite grains` runs them at full size. Skipped where LAMMPS is not installed.
#include "env/grain_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/base/error.h"
#include "data/base/process.h"
#include "env/earth_moving.h"
#include "env/grain_slopes.h"
#include "env/grain_strokes.h"

namespace sandwright {
namespace {

class GrainChecksTest : public testing::Test {
 protected:
  static DemConfig Config() {
    static const TemporaryFolder folder;
    DemConfig config;
    config.cache = folder.path() / "beds";
    return config;
  }
  static bool Never() { return false; }
  void SetUp() override {
    if (!FindProgram("lmp")) GTEST_SKIP() << "LAMMPS is not installed";
  }
};

void ExpectHolds(const GrainCheck& check) {
  EXPECT_TRUE(check.holds()) << check.name << ": " << check.measured << " " << check.unit
                             << ", expected " << check.low << " to " << check.high << ": "
                             << check.source;
}

// By the end of its name.
const GrainCheck& Find(const std::vector<GrainCheck>& checks, const std::string& end) {
  const auto found = std::ranges::find_if(
      checks, [&](const GrainCheck& check) { return check.name.ends_with(end); });
  SAND_CHECK(found != checks.end(), end);
  return *found;
}

TEST_F(GrainChecksTest, ABlockDrainsToASlope) {
  const GrainCheck slope = DrainedSlope(Config(), {0.12, 0.036, 0.06}, 1, Never);
  EXPECT_EQ(slope.low, 31);
  EXPECT_EQ(slope.high, 35);
  // Ten grains high it stands steeper than the tall block of docs/sand.md.
  EXPECT_GT(slope.measured, 30);
  EXPECT_LT(slope.measured, 50);
}

TEST_F(GrainChecksTest, ACollapseKeepsItsGrainsAndTakesEnergyOnly) {
  const std::vector<GrainCheck> checks = ChannelCollapse(Config(), {0.042, 0.036, 0.042}, 1, Never);
  for (const char* end : {"energy lost", "its peak", "grains lost"}) ExpectHolds(Find(checks, end));
  EXPECT_GT(Find(checks, "run-out / length").measured, 0.3);
  EXPECT_LT(Find(checks, "height / length").measured, 1);
}

TEST_F(GrainChecksTest, AFinerStepAndStifferGrainsDifferLessThanAnotherPacking) {
  const LevelStroke small = {.bed_length_m = 0.08,
                             .bed_width_m = 0.072,
                             .bed_height_m = 0.032,
                             .length_m = 0.024,
                             .depth_m = 0.012};
  const std::vector<GrainCheck> checks = StrokeChecks(Config(), small, 1, Never);
  ExpectHolds(Find(checks, "grains lost"));
  EXPECT_GT(Find(checks, "another packing").measured, 0.5);
  // Some hundred grains: the differences scatter, so they may pass the noise by half.
  for (const char* end : {"stroke: half the time step", "stroke: four times the stiffness"})
    EXPECT_LT(Find(checks, end).measured, 1.5 * Find(checks, "another packing").measured) << end;
  EXPECT_GT(Find(checks, "draft after 10-30 mm").measured, 0.3);
}

TEST(EarthMoving, APlaneWedgeHasTheForceOfTheory) {
  // Ng of a vertical blade and 33 degrees, from Reece's equation worked by hand.
  const auto plane = [](double blade_friction) {
    return Draft_n({1e6, 0.02, 16000, 33, blade_friction}) / (1e6 * 16000 * 0.02 * 0.02);
  };
  const double rankine = std::pow(std::tan((45 + 33 / 2.0) * std::numbers::pi / 180), 2) / 2;
  EXPECT_NEAR(plane(0), rankine, 1e-5);
  const double blade_rad = 22 * std::numbers::pi / 180;
  EXPECT_NEAR(plane(std::tan(blade_rad)) / std::cos(blade_rad), 4.04, 0.005);
}

TEST(EarthMoving, SidesAndSurchargeAdd) {
  const EarthMoving bare = {0.05, 0.02, 16000, 33, 0.4};
  EarthMoving wide = bare, loaded = bare;
  wide.width_m = 0.1;
  loaded.surcharge_n = 1;
  EXPECT_GT(Draft_n(bare), Draft_n(wide) / 2);
  EXPECT_GT(Draft_n(loaded), Draft_n(bare) + 1);
}

}  // namespace
}  // namespace sandwright
