// The gate between two strokes accepts what a stroke does and names what it cannot have done.
#include "robot_model/rescan_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Rescan : public ::testing::Test {
 protected:
  Rescan() {
    for (int j = 18; j < 22; ++j)
      for (int i = 20; i < 40; ++i) {
        predicted_.At(j, i) -= 0.010f;
        predicted_.At(j + 4, i) += 0.010f;
      }
    after_.accepted = true;
    after_.map = predicted_;
    after_.invalid_share = 0.05;
    after_.registration_error_m = 0.001;
  }
  RescanFigures Check() const { return CheckRescan(before_, predicted_, after_, path_, {}); }

  HeightMap before_{60, 80, 0.01, 0.05f}, predicted_ = before_;
  ScanResult after_;
  ToolPath path_ = SamplePath({{{0.2, 0.2, 0.04}, {0.4, 0.2, 0.04}}, 1, 0.1}, 0.01);
};

TEST_F(Rescan, AsForeseenIsAccepted) {
  const RescanFigures figures = Check();
  EXPECT_EQ(figures.verdict, RescanVerdict::kAccept);
  EXPECT_THAT(figures.reasons, IsEmpty());
  EXPECT_NEAR(figures.prediction_rmse_m, 0, 1e-7);
  EXPECT_NEAR(figures.moved_m3, 80 * 0.010 * 1e-4, 1e-9);  // 80 cells dug, 80 heaped
  EXPECT_NEAR(figures.net_m3, 0, 1e-9);
  EXPECT_NEAR(figures.outside_rms_m, 0, 1e-9);
}

TEST_F(Rescan, OtherSandAsksForANewPlan) {
  for (int i = 20; i < 40; ++i) after_.map.At(24, i) += 0.06f, after_.map.At(19, i) -= 0.03f;
  const RescanFigures figures = Check();
  EXPECT_EQ(figures.verdict, RescanVerdict::kReplan);
  EXPECT_THAT(figures.reasons, Contains(HasSubstr("prediction off by")));
}

TEST_F(Rescan, ChangeFarFromTheStrokeStops) {
  for (int j = 45; j < 55; ++j)
    for (int i = 60; i < 75; ++i) after_.map.At(j, i) += 0.03f;
  EXPECT_EQ(Check().verdict, RescanVerdict::kStop);
  EXPECT_THAT(Check().reasons, Contains(HasSubstr("change far from the stroke")));
}

TEST_F(Rescan, ScanThatCannotBeBelievedStops) {
  after_.registration_error_m = 0.008;
  after_.invalid_share = 0.5;
  after_.map.At(2, 2) = -0.02f;
  const auto reasons = Check().reasons;
  EXPECT_EQ(Check().verdict, RescanVerdict::kStop);
  EXPECT_THAT(reasons, Contains("box walls off by 8.00 mm; limit 3.00 mm"));
  EXPECT_THAT(reasons, Contains("pixels without a reading: 50.00 %; limit 30.00 %"));
  EXPECT_THAT(reasons, Contains(HasSubstr("sand below the floor by 20.00 mm")));
}

TEST_F(Rescan, RefusedScanKeepsItsReasons) {
  after_.accepted = false;
  after_.reasons = {"no box"};
  EXPECT_EQ(Check().verdict, RescanVerdict::kStop);
  EXPECT_THAT(Check().reasons, Contains("no box"));
}

TEST_F(Rescan, UnseenCellsDoNotCount) {
  after_.map.valid.assign(after_.map.size(), 1);
  after_.map.At(50, 70) = 5;
  after_.map.valid[after_.map.Index(50, 70)] = 0;
  EXPECT_EQ(Check().verdict, RescanVerdict::kAccept);
}

}  // namespace
}  // namespace sandwright
