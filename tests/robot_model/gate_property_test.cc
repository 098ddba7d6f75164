// Whatever is asked for, nothing that breaks a limit comes to an arm. The limits are checked anew
// here, by other means than the gate's.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/base/error.h"
#include "env/depth_camera.h"
#include "robot_model/arm_model.h"
#include "robot_model/camera_pose.h"
#include "robot_model/plan.h"
#include "robot_model/rig_driver.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

// Looks at every motion that comes to it.
class InspectingRig final : public Rig {
 public:
  InspectingRig(const Workcell& cell, const HeightMap& bed)
      : cell_(cell), bed_(bed), model_(MakeArmModel(cell)), data_(MakeArmData(*model_)) {}

  std::string name() const override { return "inspecting"; }
  JointAngles Joints() override { return at_; }
  Execution Execute(const GatedMotion& motion, const ExecuteOptions&) override {
    ++motions;
    EXPECT_LT((motion.start().rad - at_.rad).cwiseAbs().maxCoeff(), 1e-9);
    Inspect(motion);
    at_ = motion.end();
    Execution done{.finished = true, .end = "finished"};
    done.record.time_s = {0};
    done.record.commanded = done.record.measured = {at_};
    done.record.speed_radps = {Vector6::Zero()};
    return done;
  }
  DepthView Look() override {
    const Eigen::Isometry3d X_BC = CameraInBox(cell_, at_);
    return {{DepthCamera(cell_.camera, X_BC).Render(bed_, stream_)}, X_BC};
  }
  int motions = 0;

 private:
  void Inspect(const GatedMotion& motion) {
    const MotionLimits& limits = cell_.limits;
    constexpr double dt = StrokeMotion::kPeriod_s;
    const auto& knots = motion.knots();
    for (size_t i = 0; i < knots.size(); ++i) {
      for (int joint = 0; joint < 6; ++joint) {
        const size_t j = static_cast<size_t>(joint);
        ASSERT_LE(std::abs(knots[i][joint]), limits.joint_position_rad[j]);
        if (i == 0) continue;
        ASSERT_LE(std::abs(knots[i][joint] - knots[i - 1][joint]) / dt,
                  limits.joint_speed_radps[j] * limits.share_of_speed + 1e-6);
        if (i == 1) continue;
        ASSERT_LE(std::abs(knots[i][joint] - 2 * knots[i - 1][joint] + knots[i - 2][joint]) /
                      (dt * dt),
                  limits.joint_acceleration_radps2 * limits.share_of_acceleration + 1e-6);
      }
      InspectBlade(knots[i]);
    }
  }

  // By MuJoCo's kinematics: above the floor, inside the walls or above them, not too deep.
  void InspectBlade(const JointAngles& q) {
    SetJoints(*model_, q, *data_);
    const Eigen::Isometry3d X_BT =
        cell_.X_WB.ToIsometry().inverse() * SitePose(*model_, *data_, "T");
    const Eigen::Vector3d p = X_BT.translation();
    ASSERT_GE(p.z(), cell_.limits.floor_margin_m - 1e-6);
    if (p.z() > cell_.box.wall_height_m) return;
    const double half = 0.5 * std::hypot(cell_.tool.blade.width_m * X_BT.linear()(0, 1),
                                         cell_.tool.blade.thickness_m * X_BT.linear()(0, 0));
    ASSERT_GE(p.x() - half, 0);
    ASSERT_LE(p.x() + half, cell_.box.width_m);
    ASSERT_GE(p.y(), 0);
    ASSERT_LE(p.y(), cell_.box.depth_m);
    ASSERT_LE(HeightAt(bed_, p.x(), p.y()) - p.z(), cell_.limits.max_cut_m + 1e-3);
  }

  Workcell cell_;
  HeightMap bed_;
  MujocoModel model_;
  MujocoData data_;
  JointAngles at_ = cell_.home();
  RandomStream stream_{5};
};

// Now and then what no program should ask for.
Stroke Mutated(Stroke stroke, RandomStream& random) {
  auto& points = stroke.control_points_m;
  auto& p = points[random.Index(points.size())];
  switch (random.Index(8)) {
    case 0: p.z() = random.Uniform(-0.1, 0.3); break;
    case 1: p.x() += random.Uniform(-1, 1); break;
    case 2: stroke.speed_mps = random.Uniform(-0.1, 2); break;
    case 3: p[random.Index(3)] = std::numeric_limits<double>::quiet_NaN(); break;
    case 4: p[random.Index(3)] = 1e300; break;
    case 5: points.resize(random.Index(6)); break;
    case 6: stroke.degree = static_cast<int>(random.Index(5)) - 1; break;
    default: break;
  }
  return stroke;
}

TEST(GateProperty, NothingThatBreaksALimitReachesAnArm) {
  const Workcell cell;
  HeightMap bed(80, 120, 0.01, 0.05f);
  RandomStream random(11);
  for (float& height : bed.height_m) height += static_cast<float>(random.Uniform(-0.01, 0.02));
  const SafetyGate gate(cell);
  InspectingRig rig(cell, bed);
  RigDriver driver(rig, gate, {});
  EXPECT_FALSE(driver.Run(TypicalStroke(0.6, 0.4, 0)).finished());  // nothing has been seen
  EXPECT_EQ(rig.motions, 0);
  const RigDriver::Seen seen = driver.Look();
  ASSERT_TRUE(seen.scan.accepted) << ::testing::PrintToString(seen.scan.reasons);
  int asked = 0, done = 0;
  while (asked < 1500 && !::testing::Test::HasFailure()) {
    ++asked;
    const Stroke stroke =
        Mutated(RandomStroke(cell.box.width_m, cell.box.depth_m, random), random);
    const int before = rig.motions;
    const Drive drive = asked % 5 == 0 ? driver.RunLifted(stroke, 0.03) : driver.Run(stroke);
    EXPECT_EQ(drive.refused.empty(), rig.motions == before + 1);
    done += drive.finished();
    if (asked % 50 == 0) {
      EXPECT_TRUE(driver.ToCamera().finished());
    }
  }
  EXPECT_GT(done, 100);
  EXPECT_GT(asked - done, 500);
}

// A plan file is another way in: sealed and then changed it is refused, re-sealed it meets the gate.
TEST(GateProperty, ChangedPlansAreRefusedSealOrNoSeal) {
  const Workcell cell;
  const HeightMap bed(80, 120, 0.01, 0.05f);
  const SafetyGate gate(cell);
  RandomStream random(12);
  int broken = 0;
  for (int i = 0; i < 300; ++i) {
    Plan plan{{TypicalStroke(0.6, 0.4, random.Uniform(-3, 3))}, {}};
    plan.strokes[0].control_points_m[0].z() = 0.03;
    plan.seal = MakeSeal(plan.strokes, cell, bed);
    const Stroke sealed = plan.strokes[0];
    plan.strokes[0] = Mutated(sealed, random);
    const bool same = plan.strokes[0].control_points_m == sealed.control_points_m &&
                      plan.strokes[0].degree == sealed.degree &&
                      plan.strokes[0].speed_mps == sealed.speed_mps;
    if (same) continue;
    EXPECT_THROW(CheckSeal(plan, cell, bed, "plan"), Error);
    // Re-sealed, the seal holds, and the gate has the last word.
    const GateVerdict verdict = gate.Check(plan.strokes[0], bed, GateSampling::kFine);
    const PlanVerdict whole = CheckPlan(gate, plan.strokes, bed);
    if (whole.accepted) {
      EXPECT_TRUE(verdict.accepted);
    }
    broken += !whole.accepted;
  }
  EXPECT_GT(broken, 100);
}

}  // namespace
}  // namespace sandwright
