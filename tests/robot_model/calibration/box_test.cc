// The box's place: it comes back from touches, from tags and from both, and bad sets are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "robot_model/calibration/box_measurements.h"
#include "tests/support/refusal.h"
#include "tests/support/simulated_calibration.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Box : public ::testing::Test {
 protected:
  RandomStream stream{5, StreamId("box test")};
  Workcell truth = TrueCell(stream);
  Workcell nominal = Calibrated(truth);

  // Camera and tool known, the box not.
  static Workcell Calibrated(const Workcell& truth) {
    Workcell cell = truth;
    cell.X_WB = Workcell{}.X_WB;
    return cell;
  }
  double WorstCorner_m(const BoxCalibration& found) const {
    double worst = 0;
    for (const double x : {0.0, truth.box.width_m})
      for (const double y : {0.0, truth.box.depth_m}) {
        const Eigen::Vector3d p(x, y, truth.box.wall_height_m);
        worst = std::max(worst, (found.X_WB * p - truth.X_WB.ToIsometry() * p).norm());
      }
    return worst;
  }
  std::string Refusal(const BoxMeasurements& measurements) const {
    return RefusalOf([&] { CalibrateBox(measurements, nominal); });
  }
};

TEST_F(Box, ComesBackExactlyWithoutNoise) {
  const MeasurementNoise none{0, 0, 0};
  EXPECT_LT(WorstCorner_m(CalibrateBox({MeasureRim(truth, none, stream), {}}, nominal)), 1e-8);
  EXPECT_LT(WorstCorner_m(CalibrateBox({{}, MeasureTags(truth, none, stream)}, nominal)), 1e-8);
  // From a file that has the box a metre away and turned.
  nominal.X_WB = {{0.4, 0.5, 0.3}, {0.3, -0.4, 1.5}};
  EXPECT_LT(WorstCorner_m(CalibrateBox({MeasureRim(truth, none, stream), {}}, nominal)), 1e-8);
}

TEST_F(Box, ComesBackWithinAMillimetreFromNoisyMeasurements) {
  for (int i = 0; i < 20; ++i) {
    const auto rim = MeasureRim(truth, {}, stream);
    const auto tags = MeasureTags(truth, {}, stream);
    const auto touched = CalibrateBox({rim, {}}, nominal);
    EXPECT_LT(WorstCorner_m(touched), 0.0015);
    EXPECT_LT(touched.error.held_out_m, kMaxHeldOut_m);
    EXPECT_NEAR(*touched.width_m, truth.box.width_m, 0.0015);
    EXPECT_LT(WorstCorner_m(CalibrateBox({{}, tags}, nominal)), 0.002);
    const auto both = CalibrateBox({rim, tags}, nominal);
    EXPECT_LT(WorstCorner_m(both), 0.0015);
    EXPECT_LT(*both.disagreement_m, kBoxTolerance_m);
  }
}

TEST_F(Box, CornersServeAsWell) {
  std::vector<RimTouch> touches;
  for (const char* at : {"x0y0", "x1y0", "x0y1", "x1y1"}) {
    const Eigen::Vector3d p(at[1] == '1' ? truth.box.width_m : 0,
                            at[3] == '1' ? truth.box.depth_m : 0, truth.box.wall_height_m);
    touches.push_back({at, truth.X_WB.ToIsometry() * p + 0.0004 * NormalVector(stream)});
  }
  EXPECT_LT(WorstCorner_m(CalibrateBox({touches, {}}, nominal)), 0.002);
}

TEST_F(Box, AWrongLabelIsNamed) {
  auto rim = MeasureRim(truth, {}, stream);
  rim[2].at = "y1";
  EXPECT_THAT(Refusal({rim, {}}),
              AllOf(HasSubstr("refused"), HasSubstr("touch 3 (at y1)"), HasSubstr("what the others")));
  auto tags = MeasureTags(truth, {}, stream);
  tags[5].p_B.x() += 0.02;
  EXPECT_THAT(Refusal({{}, tags}), HasSubstr("frame 1 tag 1 lies"));
}

TEST_F(Box, ABoxOfAnotherSizeIsSaid) {
  const auto rim = MeasureRim(truth, {}, stream);
  nominal.box.width_m += 0.012;
  EXPECT_THAT(Refusal({rim, {}}), AllOf(HasSubstr("box.width_m is 1.2120"),
                                        HasSubstr("the touches say 1.2")));
}

TEST_F(Box, TouchesAndTagsMustAgree) {
  const auto rim = MeasureRim(truth, {}, stream);
  truth.X_WB.translation_m[1] += 0.006;  // the tags see another place
  EXPECT_THAT(Refusal({rim, MeasureTags(truth, {}, stream)}),
              AllOf(HasSubstr("touches and tags place a corner"), HasSubstr("mm apart")));
}

TEST_F(Box, DegenerateSetsAreRefusedWithTheFigure) {
  auto rim = MeasureRim(truth, {}, stream);
  EXPECT_THAT(Refusal({{rim[0], rim[1], rim[2]}, {}}), HasSubstr("3 measurements; at least 4"));
  // Two walls that face each other: the box may slide between them.
  EXPECT_THAT(Refusal({{rim[0], rim[1], rim[2], rim[3]}, {}}),
              AllOf(HasSubstr("too alike"), HasSubstr("times")));
}

TEST_F(Box, FilesAreReadByName) {
  const auto read = [&](const std::string& text) {
    std::ofstream("rim.yaml") << text;
    return RefusalOf([&] { ReadRimTouches("rim.yaml", nominal); });
  };
  EXPECT_EQ(read("touches: [{at: x0y1, tcp_m: [0.1, 0.2, 0.3]}]"), "accepted");
  EXPECT_THAT(read("touches: [{at: left, tcp_m: [0.1, 0.2, 0.3]}]"),
              AllOf(HasSubstr("touch 1: at: 'left'"), HasSubstr("x0, x1")));
  EXPECT_THAT(read("touches: [{at: x0, tcp_m: [100, 200, 300]}]"), HasSubstr("Millimetres?"));
  EXPECT_THAT(read("touches: [{at: x0}]"), HasSubstr("either joints_rad or tcp_m"));
  std::ofstream("tags.yaml") << "tags: {13: [0, 0, 0.15], 5: [1.2, 0]}";
  EXPECT_THAT(RefusalOf([] { ReadTagLayout("tags.yaml"); }),
              AllOf(HasSubstr("tag 5"), HasSubstr("3 numbers")));
}

}  // namespace
}  // namespace sandwright
