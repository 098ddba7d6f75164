// Plan files, seals, and the program for the controller.
#include "robot_model/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <regex>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "robot_model/urscript.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<Stroke> Strokes() {
  return {{{{0.55, 0.35, 0.03}, {0.65, 0.35, 0.025}, {0.65, 0.45, 0.03}}, 1, 0.1},
          {{{0.4, 0.3, 0.03}, {0.45, 0.34, 0.03}, {0.5, 0.3, 0.03}}, 2, 0.08}};
}

class PlanFiles : public ::testing::Test {
 protected:
  std::vector<std::string> SealReasons(const Plan& plan, const Workcell& cell) const {
    try {
      CheckSeal(plan, cell, terrain_, "plan.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kRefused);
      return error.reasons();
    }
    return {};
  }

  Workcell cell_;
  HeightMap terrain_{80, 120, 0.01, 0.05f};
  SafetyGate gate_{cell_};
};

TEST_F(PlanFiles, RoundTripBitForBit) {
  Plan plan{Strokes(), MakeSeal(Strokes(), cell_, terrain_)};
  plan.strokes[0].control_points_m[0].x() = 0.1 + 0.2;  // not a short decimal
  WritePlan(plan, "plan.yaml");
  const Plan again = ReadPlan("plan.yaml");
  ASSERT_EQ(again.strokes.size(), 2u);
  EXPECT_EQ(again.strokes[0].control_points_m[0].x(), 0.1 + 0.2);
  EXPECT_EQ(again.strokes[1].degree, 2);
  EXPECT_EQ(again.strokes[1].speed_mps, 0.08);
  ASSERT_TRUE(again.seal.has_value());
  EXPECT_EQ(again.seal->seal, plan.seal->seal);
  WritePlan({Strokes(), std::nullopt}, "plan.yaml");
  EXPECT_FALSE(ReadPlan("plan.yaml").seal.has_value());
}

TEST_F(PlanFiles, SealTellsWhatChanged) {
  Plan plan{Strokes(), std::nullopt};
  EXPECT_THAT(SealReasons(plan, cell_), Contains(HasSubstr("not sealed")));
  plan.seal = MakeSeal(plan.strokes, cell_, terrain_);
  EXPECT_TRUE(SealReasons(plan, cell_).empty());

  Plan edited = plan;
  edited.strokes[1].control_points_m[0].z() -= 1e-6;
  EXPECT_THAT(SealReasons(edited, cell_), Contains(HasSubstr("edited since it was sealed")));

  Workcell other = cell_;
  other.tool.blade.width_m = 0.06;
  EXPECT_THAT(SealReasons(plan, other), Contains(HasSubstr("another blade")));
  other = cell_;
  other.kinematics.theta_rad[1] = 1e-4;
  EXPECT_THAT(SealReasons(plan, other), Contains(HasSubstr("another calibration")));
  EXPECT_THAT(SealReasons(plan, other), Contains(HasSubstr("another workcell")));
  terrain_.At(0, 0) += 0.001f;
  EXPECT_THAT(SealReasons(plan, cell_), Contains(HasSubstr("another scan")));
}

TEST_F(PlanFiles, SealedPlanWithoutAHashIsNamed) {
  std::ofstream("plan.yaml")
      << "schema: sandwright-plan\nschema_version: 1\nframe: box\nseal: abc\nstrokes: []\n";
  EXPECT_THROW(ReadPlan("plan.yaml"), Error);
}

TEST_F(PlanFiles, VerdictHasTheKeysOfCheck) {
  const PlanVerdict verdict = CheckPlan(gate_, Strokes(), terrain_);
  EXPECT_TRUE(verdict.accepted) << ::testing::PrintToString(verdict.reasons);
  EXPECT_EQ(verdict.transfers.size(), 3u);
  const auto json = ToJson(verdict, cell_);
  for (const char* key : {"accepted", "reasons", "strokes", "calibration_hash"})
    EXPECT_TRUE(json.contains(key));
  for (const char* key : {"accepted", "reasons", "duration_s", "peak_joint_speed_share",
                          "min_clearance_m", "min_singular_value", "branch"})
    EXPECT_TRUE(json["strokes"][1].contains(key)) << key;
  auto bad = Strokes();
  bad[1].control_points_m[0].z() = -0.01;
  const PlanVerdict refused = CheckPlan(gate_, bad, terrain_);
  EXPECT_FALSE(refused.accepted);
  EXPECT_THAT(refused.reasons, Contains(HasSubstr("stroke 1: blade 10.0 mm below the box floor")));
}

TEST_F(PlanFiles, MotionIsOneFromHomeToHome) {
  const PlanVerdict verdict = CheckPlan(gate_, Strokes(), terrain_);
  ASSERT_TRUE(verdict.accepted);
  JointAngles at = cell_.home();
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_LT((verdict.transfers[i].knots.front().rad - at.rad).norm(), 1e-12);
    EXPECT_LT((verdict.transfers[i].knots.back().rad - verdict.strokes[i].motion->knots.front().rad)
                  .norm(),
              1e-12);
    at = verdict.strokes[i].motion->knots.back();
  }
  EXPECT_LT((verdict.transfers[2].knots.back().rad - cell_.home().rad).norm(), 1e-12);
}

// To renew the golden file after a wanted change: SANDWRIGHT_RENEW_GOLDEN=1.
TEST_F(PlanFiles, UrScriptIsTheGoldenFile) {
  const auto golden =
      std::filesystem::path(SANDWRIGHT_ROOT) / "tests/robot_model/golden/two_strokes.script";
  const std::string script =
      MakeUrScript(Strokes(), CheckPlan(gate_, Strokes(), terrain_), gate_, "two_strokes");
  if (std::getenv("SANDWRIGHT_RENEW_GOLDEN")) WriteFileAtomically(golden, script);
  EXPECT_EQ(script, ReadFile(golden));
}

TEST_F(PlanFiles, UrScriptKeepsTheControllersRules) {
  const std::string script =
      MakeUrScript(Strokes(), CheckPlan(gate_, Strokes(), terrain_), gate_, "two_strokes");
  std::istringstream lines(script);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "def two_strokes():");
  size_t popups = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double blend = 0;
  const std::regex pose(R"(move[lp]\(p\[([^,]*), ([^,]*), ([^,]*),.*)"),
      radius(R"(.*r=([0-9.]+)\))");
  while (std::getline(lines, line)) {
    popups += line.starts_with("  popup(");
    if (line == "end") break;
    ASSERT_TRUE(line.starts_with("  ")) << line;  // all but the first and last line are indented
    std::smatch match;
    const std::string command = line.substr(2);
    if (!std::regex_match(command, match, pose)) continue;
    const Eigen::Vector3d next(std::stod(match[1]), std::stod(match[2]), std::stod(match[3]));
    std::smatch found;
    const double next_blend = std::regex_match(command, found, radius) ? std::stod(found[1]) : 0;
    if (next_blend > 0 || blend > 0) {
      EXPECT_LT(blend + next_blend, (next - at).norm()) << line;
    }
    at = next;
    blend = next_blend;
  }
  EXPECT_EQ(line, "end");
  EXPECT_EQ(popups, 1u);
  EXPECT_THAT(script, HasSubstr("set_payload(2.200"));
  EXPECT_EQ(script.find("*"),
            std::string::npos);  // scalars only: nothing is computed on the controller
}

TEST_F(PlanFiles, UrScriptNamesAreChecked) {
  const PlanVerdict verdict = CheckPlan(gate_, Strokes(), terrain_);
  for (const char* name : {"", "2strokes", "a-b", "a_name_that_is_longer_than_the_31_it_may_have"})
    EXPECT_THROW(MakeUrScript(Strokes(), verdict, gate_, name), Error) << name;
}

}  // namespace
}  // namespace sandwright
