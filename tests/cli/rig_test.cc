// The program on a stand-in for a real arm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "data/stroke_dataset.h"
#include "env/depth_camera.h"
#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/camera_pose.h"
#include "tests/support/controller_fake/controller_fake.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

// A calibrated cell whose camera always shows the same level bed.
Workcell CellWithCamera(const fs::path& folder) {
  Workcell cell = LoadWorkcell(SANDWRIGHT_ROOT "/configs/workcell_small.yaml");
  RandomStream stream(3);
  const DepthCamera camera(cell.camera, CameraInBox(cell, cell.camera_pose()));
  WriteDepthFrame(camera.Render(HeightMap(60, 60, 0.005, 0.05f), stream), folder / "frame.png");
  cell.camera.source.frames = 1;
  cell.camera.source.command = "cp " + (folder / "frame.png").string() + " \"$SANDWRIGHT_FRAMES\"";
  const CalibrationError good{10, 0.0002, 0.0003, 0};
  cell.calibration.kinematics = MakeRecord(cell, good, {"kinematics"});
  cell.calibration.hand_eye = MakeRecord(cell, good, {"tool.X_FC"});
  cell.calibration.tool = MakeRecord(cell, good, {"tool.X_FT"});
  cell.calibration.box = MakeRecord(cell, good, {"X_WB"});
  return cell;
}

TEST(Rig, CollectsRandomStrokes) {
  const fs::path folder = fs::path(::testing::TempDir()) / "rig_collects";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const Workcell cell = CellWithCamera(folder);
  SaveWorkcell(cell, folder / "cell.yaml", SANDWRIGHT_ROOT "/configs/workcell_small.yaml");
  ControllerFakeOptions options;
  options.start = cell.home();
  const ControllerFake fake(options);
  const Finished done = Invoke(
      "collect --source rig --arm 127.0.0.1 --strokes 1 --workcell cell.yaml --out log "
      "deployment.force_baseline=false controller.dashboard_port=" +
          std::to_string(fake.ports().dashboard) +
          " controller.primary_port=" + std::to_string(fake.ports().primary) +
          " controller.rtde_port=" + std::to_string(fake.ports().rtde),
      "cd " + folder.string() + " && ");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const StrokeFile file = ReadStrokeFile(folder / "log/strokes.h5");
  EXPECT_EQ(file.source, "rig");
  EXPECT_EQ(file.strokes.size(), 1u);
  EXPECT_EQ(fake.scripts().size(), 3u);  // to the camera, the stroke, to the camera
}

}  // namespace
}  // namespace sandwright
