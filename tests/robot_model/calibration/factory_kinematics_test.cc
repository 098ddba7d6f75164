// The controller's calibration file: what is read, and what is refused.
#include "robot_model/calibration/factory_kinematics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The form and the size of numbers of a real file: pairs of metres that cancel along the parallel
// joints, comments behind values, keys that are of no interest.
constexpr char kConf[] = R"([mounting]
delta_theta = [ 2.1e-05, 0.96, -1.85, 0.89, 5.7e-05, -7.5e-05]
delta_a = [ 0.00031, 0.0, 0.0, -6.4e-05, 7.8e-06, 0]
delta_d = [ 4.0e-05, 278.2, -183.7, -94.5, 0.0003, 0.00012]
delta_alpha = [ -0.00027, 0.0, 0.0, 0.00065, -0.00059, 0]
joint_checksum = [ 0x6e0f7bf, 0xa32a713f, 0xf636a50, 0x9ec2338a, 0xa1afded8, 0xb29b2979]
calibration_status = 2 # 0 == notInitialized / 1 == notLinearised / 2 == Linearised
)";

std::string Write(std::string text, const std::string& from = "", const std::string& to = "") {
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  std::ofstream("calibration.conf") << text;
  return "calibration.conf";
}

TEST(FactoryKinematics, DeltasAreAddedToTheNominalArm) {
  const std::string file = Write(kConf, "0.96, -1.85, 0.89", "0.0, 0.0, 0.0");
  const DhParameters dh = ReadFactoryKinematics(file), nominal;
  EXPECT_DOUBLE_EQ(dh.theta_rad[0], 2.1e-05);
  EXPECT_DOUBLE_EQ(dh.a_m[0], 0.00031);
  EXPECT_DOUBLE_EQ(dh.d_m[1], 278.2);
  EXPECT_DOUBLE_EQ(dh.d_m[5], nominal.d_m[5] + 0.00012);
  EXPECT_DOUBLE_EQ(dh.alpha_rad[4], nominal.alpha_rad[4] - 0.00059);
  const FlangeShift shift = MeasureFlangeShift(nominal, dh);
  EXPECT_GT(shift.p50_m, 1e-4);
  EXPECT_LE(shift.p50_m, shift.p95_m);
  EXPECT_LE(shift.p95_m, shift.max_m);
  EXPECT_LT(shift.max_m, 0.005);
  EXPECT_EQ(MeasureFlangeShift(dh, dh).max_m, 0);
}

TEST(FactoryKinematics, YamlHasTheKeysOfAWorkcell) {
  std::ofstream("arm.yaml") << "d_m: [0.1274, 0, 0, 0.163941, 0.1157, 0.0922]\n";
  EXPECT_DOUBLE_EQ(ReadFactoryKinematics("arm.yaml").d_m[0], 0.1274);
  std::ofstream("arm.yaml") << "d_m: [0.1274, 0]\n";
  EXPECT_THAT(RefusalOf([] { ReadFactoryKinematics("arm.yaml"); }),
              AllOf(HasSubstr("d_m has 2"), HasSubstr("6 are needed")));
}

TEST(FactoryKinematics, BadFilesAreRefusedByKey) {
  const auto refusal = [](const std::string& file) {
    return RefusalOf([&] { ReadFactoryKinematics(file); });
  };
  EXPECT_THAT(refusal(Write(kConf, "delta_a ", "delta_b ")),
              AllOf(HasSubstr("delta_a: missing"), HasSubstr("six numbers")));
  EXPECT_THAT(refusal(Write(kConf, "2.1e-05, ", "")), HasSubstr("delta_theta"));
  EXPECT_THAT(refusal(Write(kConf, "2.1e-05", "many")), HasSubstr("delta_theta"));
  EXPECT_THAT(refusal(Write(kConf, "2.1e-05", ".nan")), HasSubstr("delta_theta"));
  EXPECT_THAT(refusal(Write(kConf, "status = 2", "status = 1")), HasSubstr("needed: 2"));
  EXPECT_THAT(refusal(Write(kConf, "[mounting]", "[other]")), HasSubstr("delta_theta: missing"));
  // Another model's file: these angles do not belong to an arm that is nearly a UR10.
  EXPECT_THAT(refusal(Write(kConf)), HasSubstr("another model"));
  EXPECT_THAT(refusal("none.conf"), HasSubstr("none.conf"));
}

}  // namespace
}  // namespace sandwright
