// The whole loop through a controller: gate, program, arm, camera, comparison, log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "agents/deployment.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/shipped.h"
#include "env/depth_camera.h"
#include "env/heightfield.h"
#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/camera_pose.h"
#include "robot_model/controller/ur_rig.h"
#include "tests/support/controller_fake/controller_fake.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

const fs::path kLog = fs::path(::testing::TempDir()) / "log";

// Pictures of the bed before and after a stroke, handed out by a command as a camera's would.
class Camera {
 public:
  Camera(Workcell& cell, const std::vector<HeightMap>& beds) {
    fs::remove_all(folder_);
    RandomStream stream(3);
    const DepthCamera camera(cell.camera, CameraInBox(cell, cell.camera_pose()));
    for (size_t look = 0; look < beds.size(); ++look) {
      const fs::path frames = folder_ / std::to_string(look);
      fs::create_directories(frames);
      for (int i = 0; i < 2; ++i)
        WriteDepthFrame(camera.Render(beds[look], stream), frames / (std::to_string(i) + ".png"));
    }
    WriteFileAtomically(folder_ / "look", "0");
    cell.camera.source.frames = 2;
    cell.camera.source.command =
        "cd " + folder_.string() +
        "; n=$(cat look); cp $n/*.png \"$SANDWRIGHT_FRAMES\"; echo $((n+1)) > look";
  }

 private:
  fs::path folder_ = fs::absolute(fs::path(::testing::TempDir()) / "camera");
};

class DeployingOnUr : public ::testing::Test {
 protected:
  DeployingOnUr() {
    fs::remove_all(kLog);
    config_.scan.cell_size_m = 0.005;
    SandState state(before_);
    model_.Apply({&state, 1}, {&stroke_, 1});
    camera_.emplace(cell_, std::vector<HeightMap>{before_, state.map()});
    const CalibrationError good{10, 0.0002, 0.0003, 0};
    cell_.calibration.kinematics = MakeRecord(cell_, good, {"kinematics"});
    cell_.calibration.hand_eye = MakeRecord(cell_, good, {"tool.X_FC"});
    cell_.calibration.tool = MakeRecord(cell_, good, {"tool.X_FT"});
    cell_.calibration.box = MakeRecord(cell_, good, {"X_WB"});
    gate_.emplace(cell_);
    ControllerFakeOptions options;
    options.start = cell_.home();
    fake_.emplace(options);
  }
  ControllerAddress Address() const {
    return {"127.0.0.1", fake_->ports().dashboard, fake_->ports().primary, fake_->ports().rtde};
  }
  Deployment Go() {
    UrRig rig(Address(), *gate_, false);
    RigLog log(kLog, false);
    return Deploy(
        rig, *gate_, model_,
        [&](const HeightMap&, int used, int) {
          return used == 0 ? std::optional(stroke_) : std::nullopt;
        },
        {}, config_, nullptr, log);
  }

  Workcell cell_ = LoadWorkcell(ShippedConfig("workcell_small.yaml"));
  Heightfield model_{HeightfieldConfig{}};
  HeightMap before_{60, 60, 0.005, 0.05f};
  const Stroke stroke_{{{0.12, 0.15, 0.035}, {0.19, 0.15, 0.035}}, 1, 0.1};
  DeploymentConfig config_;
  std::optional<Camera> camera_;
  std::optional<SafetyGate> gate_;
  std::optional<ControllerFake> fake_;
};

TEST_F(DeployingOnUr, StrokeIsDoneSeenAndJudged) {
  const Deployment done = Go();
  ASSERT_TRUE(done.ok) << done.end << ": " << done.reason;
  ASSERT_EQ(done.strokes.size(), 1u);
  EXPECT_EQ(done.strokes[0].rescan.verdict, RescanVerdict::kAccept);
  EXPECT_GT(done.strokes[0].rescan.moved_m3, 10e-6);
  EXPECT_LT(done.strokes[0].rescan.prediction_rmse_m, 0.5 * done.strokes[0].rescan.change_rms_m);
  // To the camera, once in the air for the forces, once in the sand, to the camera again.
  EXPECT_EQ(fake_->scripts().size(), 4u);
  const StrokeFile data = ReadStrokeFile(kLog / "strokes.h5");
  ASSERT_EQ(data.strokes.size(), 1u);
  EXPECT_EQ(data.source, "rig");
  const ToolPath& path = data.strokes[0].path;
  EXPECT_NEAR(path.front().x_m, 0.12, 1e-3);
  EXPECT_NEAR(path.back().x_m, 0.19, 1e-3);
  for (const BladePose& pose : path) EXPECT_NEAR(pose.y_m, 0.15, 3e-4);
}

TEST_F(DeployingOnUr, EmergencyStopEndsTheRunAndNothingFollows) {
  config_.force_baseline = false;
  std::thread operator_thread([&] {
    while (fake_->scripts().size() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    fake_->EmergencyStop();
  });
  const Deployment done = Go();
  operator_thread.join();
  EXPECT_FALSE(done.ok);
  EXPECT_EQ(done.end, "emergency_stop") << done.reason;
  EXPECT_EQ(fake_->scripts().size(), 2u);
  const auto events = RigLog::ReadEvents(kLog);
  EXPECT_EQ(events.back()["event"], "end");
  EXPECT_TRUE(std::ranges::any_of(
      events, [](const auto& e) { return e["event"] == "moved" && e["end"] == "emergency_stop"; }));
}

TEST_F(DeployingOnUr, UncalibratedCellMovesNothing) {
  cell_.calibration.box = {};
  gate_.emplace(cell_);
  EXPECT_THROW(UrRig(Address(), *gate_, false), Error);
  cell_.calibration.box = MakeRecord(cell_, {10, 0.0002, 0.0025, 0}, {"X_WB"});
  gate_.emplace(cell_);
  EXPECT_THROW(UrRig(Address(), *gate_, false), Error);
  EXPECT_TRUE(fake_->scripts().empty());
}

// After a stop in the sand: a new connection, and straight up.
TEST_F(DeployingOnUr, BuriedBladeIsLifted) {
  const Passage passage = gate_->PassStroke(stroke_, before_, cell_.home());
  ASSERT_TRUE(passage.motion);
  const StrokeMotion& motion = passage.motion->stroke_motion();
  fake_->JogTo(motion.knots[(motion.path_begin + motion.path_end) / 2]);
  UrRig rig(Address(), *gate_, false);
  RigDriver driver(rig, *gate_, config_.scan);
  EXPECT_THAT(driver.ToCamera().why(), ::testing::HasSubstr("recover first"));
  const Drive lift = driver.Lift();
  ASSERT_TRUE(lift.finished()) << lift.why();
  EXPECT_NEAR(gate_->kinematics().BladeInBox(fake_->joints()).translation().z(),
              cell_.motion.retreat_height_m, 1e-3);
}

TEST_F(DeployingOnUr, CameraThatShowsNothingEndsTheRun) {
  cell_.camera.source.command = "true";
  gate_.emplace(cell_);
  const Deployment done = Go();
  EXPECT_EQ(done.end, "rescan");
  EXPECT_THAT(done.reason, ::testing::HasSubstr("camera.source.command left 0 frames"));
  EXPECT_EQ(fake_->scripts().size(), 1u);  // to the camera, and no stroke
}

}  // namespace
}  // namespace sandwright
