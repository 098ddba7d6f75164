// Strokes on the simulated rig, end to end: what runs, what is refused, and what ends a run.
#include "agents/deployment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "data/base/error.h"
#include "data/shipped.h"
#include "env/heightfield.h"
#include "env/simulated_rig.h"
#include "tests/support/needle_sand.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

const fs::path kLog = fs::path(::testing::TempDir()) / "log";
using ::testing::HasSubstr;

// A rig whose n-th motion ends with a fault.
class FaultyRig final : public Rig {
 public:
  FaultyRig(Rig& rig, int fault_at) : rig_(rig), fault_at_(fault_at) {}
  std::string name() const override { return rig_.name(); }
  JointAngles Joints() override { return rig_.Joints(); }
  Execution Execute(const GatedMotion& motion, const ExecuteOptions& options) override {
    if (motions++ != fault_at_) return rig_.Execute(motion, options);
    return {.end = "force", .reason = "60 N above the baseline"};
  }
  DepthView Look() override { return rig_.Look(); }
  int motions = 0;

 private:
  Rig& rig_;
  int fault_at_;
};

class Deploying : public ::testing::Test {
 protected:
  Deploying() {
    fs::remove_all(kLog);
    config_.scan.cell_size_m = 0.005;
  }
  SimulatedRig MakeRig(const SandModel& world) const {
    return {cell_, world, terrain_, {}, RandomStream(1)};
  }
  Deployment Go(Rig& rig, const std::vector<Stroke>& strokes, DeploymentJob job,
                const std::function<bool(const std::string&)>& confirm = nullptr) {
    RigLog log(kLog, false);
    return Deploy(
        rig, gate_, model_,
        [&](const HeightMap&, int used, int) {
          return used < std::ssize(strokes) ? std::optional(strokes[static_cast<size_t>(used)])
                                            : std::nullopt;
        },
        job, config_, confirm, log);
  }
  static int Count(const std::string& event, const std::string& kind) {
    const auto events = RigLog::ReadEvents(kLog);
    return static_cast<int>(std::ranges::count_if(
        events, [&](const auto& e) { return e["event"] == event && e.value("kind", "") == kind; }));
  }

  Workcell cell_ = LoadWorkcell(ShippedConfig("workcell_small.yaml"));
  HeightMap terrain_{60, 60, 0.005, 0.05f};
  SafetyGate gate_{cell_};
  Heightfield model_{HeightfieldConfig{}};
  DeploymentConfig config_;
  const Stroke line_{{{0.1, 0.12, 0.035}, {0.2, 0.12, 0.035}}, 1, 0.1},
      bent_{{{0.1, 0.2, 0.04}, {0.15, 0.22, 0.035}, {0.2, 0.2, 0.04}}, 2, 0.1},
      deep_{{{0.1, 0.2, -0.02}, {0.2, 0.2, 0.03}}, 1, 0.1};
};

TEST_F(Deploying, PlanRunsStrokeByStroke) {
  SimulatedRig rig = MakeRig(model_);
  const Deployment done = Go(rig, {line_, bent_}, {.planned = true, .planned_for = terrain_});
  EXPECT_TRUE(done.ok) << done.end << ": " << done.reason;
  EXPECT_EQ(done.end, "done");
  ASSERT_EQ(done.strokes.size(), 2u);
  for (const DeployedStroke& stroke : done.strokes) {
    EXPECT_EQ(stroke.rescan.verdict, RescanVerdict::kAccept);
    EXPECT_GT(stroke.rescan.moved_m3, 10e-6);
    EXPECT_LT(stroke.rescan.prediction_rmse_m, 0.5 * stroke.rescan.change_rms_m);
    EXPECT_LT(stroke.deviation_rad, 0.01);
  }
  EXPECT_EQ(Count("motion", "stroke"), 2);
  EXPECT_EQ(ReadStrokeFile(kLog / "strokes.h5").strokes.size(), 2u);
  EXPECT_EQ(ReadStrokeFile(kLog / "strokes.h5").source, "simulated");
}

// Two poses that each see a part of the bed: one map, as good as from above the middle.
TEST_F(Deploying, BedIsSeenFromSeveralPoses) {
  const std::vector<double> whole = cell_.camera_joints_rad;
  cell_.camera.width = 130;  // sees some 0.3 m of the bed
  cell_.camera.cx_px = 65;
  for (const double turn : {0.12, -0.12}) {
    std::vector<double> pose = whole;
    pose[0] += turn;
    cell_.camera_joints_rad.insert(cell_.camera_joints_rad.end(), pose.begin(), pose.end());
  }
  cell_.camera_joints_rad.erase(cell_.camera_joints_rad.begin(), cell_.camera_joints_rad.begin() + 6);
  CheckWorkcell(cell_, "cell");
  const SafetyGate gate(cell_);
  SimulatedRig rig(cell_, model_, terrain_, {}, RandomStream(1));
  RigDriver driver(rig, gate, config_.scan);
  const RigDriver::Seen seen = driver.Look();
  ASSERT_TRUE(seen.scan.accepted) << ::testing::PrintToString(seen.scan.reasons);
  double worst_m = 0;
  for (const float height : seen.scan.map.height_m)
    worst_m = std::max<double>(worst_m, std::abs(height - 0.05));
  EXPECT_LT(worst_m, 0.004);
  // Either of them alone leaves a hole.
  cell_.camera_joints_rad.resize(6);
  const SafetyGate one_gate(cell_);
  SimulatedRig one_rig(cell_, model_, terrain_, {}, RandomStream(1));
  RigDriver one(one_rig, one_gate, config_.scan);
  EXPECT_FALSE(one.Look().scan.accepted);
}

TEST_F(Deploying, RefusedStrokeNeverReachesTheArm) {
  SimulatedRig rig = MakeRig(model_);
  const Deployment planned = Go(rig, {deep_, line_}, {.planned = true});
  EXPECT_FALSE(planned.ok);
  EXPECT_EQ(planned.end, "refused");
  EXPECT_THAT(planned.reason, HasSubstr("below the box floor"));
  EXPECT_EQ(Count("motion", "stroke"), 0);
  fs::remove_all(kLog);
  const Deployment chosen = Go(rig, {deep_, line_, deep_, deep_, deep_, line_}, {});
  EXPECT_EQ(chosen.end, "refused");
  EXPECT_THAT(chosen.reason, HasSubstr("3 strokes in a row"));
  EXPECT_EQ(Count("motion", "stroke"), 1);
}

TEST_F(Deploying, NoIsNo) {
  SimulatedRig rig = MakeRig(model_);
  int asked = 0;
  const Deployment done =
      Go(rig, {line_, bent_}, {}, [&](const std::string&) { return ++asked < 2; });
  EXPECT_EQ(done.end, "not confirmed");
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(Count("motion", "stroke"), 1);
}

TEST_F(Deploying, FaultEndsTheRunWhereverItComes) {
  for (int fault_at = 0; fault_at < 4; ++fault_at) {
    fs::remove_all(kLog);
    SimulatedRig rig = MakeRig(model_);
    FaultyRig faulty(rig, fault_at);
    const Deployment done = Go(faulty, {line_, bent_}, {});
    EXPECT_FALSE(done.ok);
    EXPECT_EQ(done.end, "force");
    EXPECT_EQ(faulty.motions, fault_at + 1);  // nothing after it
    EXPECT_EQ(RigLog::ReadEvents(kLog).back()["event"], "end");
  }
}

TEST_F(Deploying, SandThatDoesSomethingElseEndsAPlanAndNotAnAgent) {
  const NeedleSand world(0.12f);
  config_.rescan.max_prediction_rmse_m = 0.001;
  config_.rescan.max_outside_rms_m = 0.1;
  SimulatedRig rig = MakeRig(world);
  const Deployment planned = Go(rig, {line_, bent_}, {.planned = true});
  EXPECT_EQ(planned.end, "rescan");
  EXPECT_EQ(planned.strokes.size(), 1u);
  fs::remove_all(kLog);
  SimulatedRig again = MakeRig(world);
  EXPECT_EQ(Go(again, {line_, bent_}, {}).end, "done");
}

TEST_F(Deploying, PlanForOtherSandDoesNotBegin) {
  HeightMap hilly = terrain_;
  for (int j = 20; j < 30; ++j)
    for (int i = 10; i < 50; ++i) hilly.At(j, i) += 0.02f;
  SimulatedRig rig = MakeRig(model_);
  const Deployment done = Go(rig, {line_}, {.planned = true, .planned_for = hilly});
  EXPECT_EQ(done.end, "rescan");
  EXPECT_THAT(done.reason, HasSubstr("not what the plan was made for"));
  EXPECT_EQ(Count("motion", "stroke"), 0);
}

TEST_F(Deploying, DryRunLeavesTheSandAlone) {
  SimulatedRig rig = MakeRig(model_);
  const Deployment done = Go(rig, {line_, bent_}, {.mode = DeployMode::kDryRun});
  EXPECT_TRUE(done.ok) << done.reason;
  EXPECT_EQ(Count("motion", "stroke"), 2);
  EXPECT_EQ(rig.truth().height_m, terrain_.height_m);
  config_.dry_run_deviation_rad = 1e-6;
  fs::remove_all(kLog);
  EXPECT_EQ(Go(rig, {line_}, {.mode = DeployMode::kDryRun}).end, "dry run failed");
}

TEST_F(Deploying, GoalAndBudgetEndARun) {
  SimulatedRig rig = MakeRig(model_);
  HeightMap goal = terrain_;
  goal.mask.assign(goal.size(), 1);
  EXPECT_EQ(Go(rig, {line_}, {.goal = goal}).end, "goal reached");
  fs::remove_all(kLog);
  EXPECT_EQ(Go(rig, {line_, line_, line_}, {.max_strokes = 1}).end, "budget used");
}

TEST_F(Deploying, BuriedBladeMustBeRecoveredFirst) {
  SimulatedRig rig = MakeRig(model_);
  SandState unused(terrain_);
  class Buried final : public Rig {
   public:
    explicit Buried(JointAngles q) : q_(q) {}
    std::string name() const override { return "buried"; }
    JointAngles Joints() override { return q_; }
    Execution Execute(const GatedMotion& motion, const ExecuteOptions&) override {
      lifted = motion.kind() == GatedMotion::Kind::kLift;
      return {.finished = true, .end = "finished"};
    }
    DepthView Look() override { return {}; }
    bool lifted = false;

   private:
    JointAngles q_;
  };
  const auto passage = gate_.PassStroke(line_, terrain_, cell_.home());
  ASSERT_TRUE(passage.motion);
  const StrokeMotion& motion = passage.motion->stroke_motion();
  Buried buried(motion.knots[motion.path_begin + 20]);
  const Deployment done = Go(buried, {line_}, {});
  EXPECT_EQ(done.end, "refused");
  EXPECT_THAT(done.reason, HasSubstr("recover first"));
  RigDriver driver(buried, gate_, {});
  EXPECT_TRUE(driver.Lift().finished());
  EXPECT_TRUE(buried.lifted);
}

}  // namespace
}  // namespace sandwright
