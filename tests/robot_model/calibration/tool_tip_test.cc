// The tool's tip: it comes back from noisy touches, and bad sets are refused with the reason.
#include "robot_model/calibration/tool_tip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.h"
#include "tests/support/simulated_calibration.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ToolTip : public ::testing::Test {
 protected:
  RandomStream stream{3, StreamId("tool test")};
  Workcell truth = TrueCell(stream);
  Workcell nominal = NominalCell(truth);
  std::string Refusal(const ToolTouches& touches) {
    return RefusalOf([&] { CalibrateTool(touches, nominal); });
  }
};

TEST_F(ToolTip, ComesBackExactlyWithoutNoise) {
  const auto found = CalibrateTool(MeasureTool(truth, 6, {0, 0, 0}, stream), nominal);
  EXPECT_LT((found.X_FT.translation() - truth.tool.X_FT.ToIsometry().translation()).norm(), 1e-9);
  EXPECT_LT((found.X_FT.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-7);
  EXPECT_NEAR(found.edge_length_m, truth.tool.blade.width_m, 1e-9);
  EXPECT_LT(found.error.held_out_m, 1e-9);
}

TEST_F(ToolTip, ComesBackWithinAMillimetreFromNoisyTouches) {
  double sum = 0;
  for (int i = 0; i < 20; ++i) {
    const auto found = CalibrateTool(MeasureTool(truth, 8, {}, stream), nominal);
    const double error_m =
        (found.X_FT.translation() - truth.tool.X_FT.ToIsometry().translation()).norm();
    EXPECT_LT(error_m, 0.002);
    EXPECT_LT(found.error.residual_m, found.error.held_out_m);
    sum += error_m / 20;
  }
  EXPECT_LT(sum, 0.001);
}

TEST_F(ToolTip, ATouchBesideThePointIsNamed) {
  ToolTouches touches = MeasureTool(truth, 8, {}, stream);
  touches.tip[2].rad[0] += 0.02;  // 15 mm
  EXPECT_THAT(Refusal(touches), AllOf(HasSubstr("refused"), HasSubstr("touch 3 of `tip`"),
                                      HasSubstr("mm off the point")));
  touches.tip[5].rad[0] -= 0.03;
  EXPECT_THAT(Refusal(touches), HasSubstr("no single one"));
}

TEST_F(ToolTip, PosesThatAreTooAlikeAreRefusedWithTheFigure) {
  EXPECT_THAT(Refusal(MeasureTool(truth, 8, {}, stream, 0.05)),
              AllOf(HasSubstr("too alike"), HasSubstr("times the error of one touch")));
  ToolTouches three = MeasureTool(truth, 3, {}, stream);
  EXPECT_THAT(Refusal(three), HasSubstr("3 touches of the tip; at least 4"));
}

TEST_F(ToolTip, EndsThatAreNotTheBladesAreRefused) {
  ToolTouches touches = MeasureTool(truth, 8, {}, stream);
  std::swap((*touches.edge)[0], touches.tip[0]);
  touches.tip.erase(touches.tip.begin());
  EXPECT_THAT(Refusal(touches), HasSubstr("ends of the edge"));
}

TEST_F(ToolTip, FilesAreReadByName) {
  std::ofstream("touches.yaml") << "tip: [[0, 1, 2, 3, 4, 5], [0, 1, 2, 3, 4]]\n";
  EXPECT_THAT(RefusalOf([] { ReadToolTouches("touches.yaml"); }),
              AllOf(HasSubstr("tip, entry 2"), HasSubstr("6 numbers")));
  std::ofstream("touches.yaml") << "tip: [[0, 90, 2, 3, 4, 5]]\n";
  EXPECT_THAT(RefusalOf([] { ReadToolTouches("touches.yaml"); }), HasSubstr("Degrees?"));
  std::ofstream("touches.yaml") << "tip: [[0, 1, 2, 3, 4, 5]]\nedge: [[0, 1, 2, 3, 4, 5]]\n";
  EXPECT_THAT(RefusalOf([] { ReadToolTouches("touches.yaml"); }), HasSubstr("2 are needed"));
}

}  // namespace
}  // namespace sandwright
