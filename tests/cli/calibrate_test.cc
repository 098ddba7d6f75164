// `sandwright calibrate` as it is used: what it writes, what it refuses, and that a refusal replaces nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Calibrate : public ::testing::Test {
 protected:
  Calibrate() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    fs::copy_file(SANDWRIGHT_ROOT "/configs/workcell.yaml", File("cell.yaml"));
    before_ = ReadFile(File("cell.yaml"));
  }
  std::string File(const std::string& name) const { return (folder_ / name).string(); }
  Finished Run(const std::string& arguments) const {
    return Invoke("calibrate " + arguments + " --workcell " + File("cell.yaml") + " --json " + File("result.json"));
  }
  // The rim of the nominal box, 10 mm further along x; the last touch off by `slip_m` across its wall.
  void WriteRim(double slip_m = 0) const {
    std::string text = "touches:\n";
    const auto touch = [&](const std::string& at, double x, double y) {
      text += "  - {at: " + at + ", tcp_m: [" + std::to_string(x - 0.590) + ", " + std::to_string(y + 0.300) +
              ", -0.030]}\n";
    };
    for (const double y : {0.1, 0.7}) touch("x0", 0, y), touch("x1", 1.2, y);
    for (const double x : {0.1, 0.6, 1.1}) touch("y0", x, 0), touch("y1", x, x > 1 ? 0.8 + slip_m : 0.8);
    WriteFileAtomically(File("rim.yaml"), text);
  }
  void Unchanged() const { EXPECT_EQ(ReadFile(File("cell.yaml")), before_); }

  fs::path folder_ = fs::path(::testing::TempDir()) / "calibrate_test";
  std::string before_;
};

TEST_F(Calibrate, BoxIsFoundWhereItsRimWasTouched) {
  WriteRim();
  const Finished done = Run("box --touches " + File("rim.yaml") + " --out " + File("found.yaml"));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const auto result = nlohmann::json::parse(ReadFile(File("result.json")));
  EXPECT_NEAR(result["X_WB"]["translation_m"][0].get<double>(), -0.590, 1e-6) << result;
  Unchanged();
  EXPECT_THAT(ReadFile(File("found.yaml")), HasSubstr("held_out"));
}

TEST_F(Calibrate, TouchBesideTheRimIsNamedAndNothingIsReplaced) {
  WriteRim(0.02);
  const Finished done = Run("box --touches " + File("rim.yaml"));
  EXPECT_EQ(done.exit_code, 3) << done.output;
  EXPECT_THAT(done.output, HasSubstr("(at y1) lies 20.0 mm off"));
  Unchanged();
}

TEST_F(Calibrate, KinematicsComeFromTheControllersFile) {
  const std::string conf =
      "[mounting]\ndelta_theta = [2e-05, 0, 0, 0, 5e-05, -7e-05]\ndelta_a = [0.0003, 0, 0, -6e-05, 7e-06, 0]\n"
      "delta_d = [4e-05, 0, 0, 0, 0.0003, 0.0001]\ndelta_alpha = [-0.0002, 0, 0, 0.0006, -0.0005, 0]\n";
  WriteFileAtomically(File("calibration.conf"), conf + "calibration_status = 2\n");
  const Finished done = Run("kinematics --from-file " + File("calibration.conf"));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_NE(ReadFile(File("cell.yaml")), before_);
  EXPECT_EQ(Invoke("workcell --workcell " + File("cell.yaml")).exit_code, 0);
  before_ = ReadFile(File("cell.yaml"));
  WriteFileAtomically(File("calibration.conf"), conf + "calibration_status = 1\n");
  const Finished refused = Run("kinematics --from-file " + File("calibration.conf"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("calibration_status"));
  Unchanged();
}

TEST_F(Calibrate, WhatIsMissingIsNamed) {
  WriteFileAtomically(File("tip.yaml"), "tip:\n  - [0, -1.5, 1.5, -1.5, -1.5, 0]\n");
  WriteFileAtomically(File("joints.yaml"), "joints_rad:\n  - [0, -1.5, 1.5, -1.5, -1.5, 0]\n");
  fs::create_directories(folder_ / "board");
  const std::string hand_eye = "hand-eye --frames " + File("board") + " --joints " + File("joints.yaml") + " --board ";
  const std::map<std::string, std::string> errors = {{"box", "neither --touches nor --tags"},
                                                     {"box --touches " + File("none.yaml"), "none.yaml"},
                                                     {hand_eye + "7x5,0.040,0.030,4X4_50", "0 frames and 1 joint"},
                                                     {hand_eye + "7by5", "7by5"}};
  for (const auto& [arguments, message] : errors) {
    const Finished done = Run(arguments);
    EXPECT_EQ(done.exit_code, 2) << arguments << "\n" << done.output;
    EXPECT_THAT(done.output, HasSubstr(message)) << arguments;
    EXPECT_FALSE(fs::exists(File("result.json"))) << arguments;
  }
  const Finished few = Run("tool --touches " + File("tip.yaml") + " --mass-kg 2.2 --centre-of-mass-m 0 0 0.08");
  EXPECT_EQ(few.exit_code, 3);
  EXPECT_THAT(few.output, HasSubstr("1 touches of the tip; at least 4 are needed"));
  Unchanged();
}

}  // namespace
}  // namespace sandwright
