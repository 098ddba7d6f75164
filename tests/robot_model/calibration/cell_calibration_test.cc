// When a cell counts as calibrated, and what its file remembers.
#include "robot_model/calibration/cell_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "data/base/atomic_file.h"
#include "tests/support/refusal.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Workcell Calibrated() {
  Workcell cell;
  const CalibrationError error{12, 0.0004, 0.0006, 0.001};
  cell.calibration.kinematics = MakeRecord(cell, {}, {"kinematics"});
  cell.calibration.hand_eye = MakeRecord(cell, error, {"tool.X_FC", "camera.fx_px"});
  cell.calibration.tool = MakeRecord(cell, error, {"tool.X_FT"});
  cell.calibration.box = MakeRecord(cell, error, {"X_WB", "tool.X_FT"});
  return cell;
}

TEST(CellCalibration, TheShippedCellLacksAllFourInOrder) {
  EXPECT_THAT(CalibrationFaults(Workcell{}),
              ElementsAre(HasSubstr("kinematics: never"), HasSubstr("hand-eye: never"),
                          HasSubstr("tool: never"), HasSubstr("box: never")));
  EXPECT_THAT(CalibrationFaults(Calibrated()), IsEmpty());
}

TEST(CellCalibration, OtherKinematicsMakeAllOfItOld) {
  Workcell cell = Calibrated();
  cell.kinematics.d_m[5] += 1e-6;
  EXPECT_THAT(CalibrationFaults(cell), SizeIs(4));
  EXPECT_THAT(CalibrationFaults(cell)[1], HasSubstr("other kinematics"));
  cell.calibration.kinematics = MakeRecord(cell, {}, {"kinematics"});
  EXPECT_THAT(CalibrationFaults(cell), SizeIs(3));
}

TEST(CellCalibration, ABoxTouchedWithAnotherToolIsOld) {
  Workcell cell = Calibrated();
  cell.tool.X_FT.translation_m[2] += 0.001;
  cell.calibration.tool = MakeRecord(cell, {4, 0.0004, 0.0006, 0}, {"tool.X_FT"});
  EXPECT_THAT(CalibrationFaults(cell),
              ElementsAre(AllOf(HasSubstr("box:"), HasSubstr("X_WB, tool.X_FT"))));
}

TEST(CellCalibration, APoseEditedByHandAndALargeErrorAreFaults) {
  Workcell cell = Calibrated();
  cell.X_WB.translation_m[0] += 0.001;
  EXPECT_THAT(CalibrationFaults(cell), ElementsAre(HasSubstr("box: its result")));
  cell = Calibrated();
  cell.calibration.hand_eye.held_out_m = 0.0021;
  EXPECT_THAT(CalibrationFaults(cell),
              ElementsAre(AllOf(HasSubstr("hand-eye"), HasSubstr("2.10 mm"), HasSubstr("2.00"))));
}

TEST(CellCalibration, TheFileKeepsRecordsAndTheUsersWords) {
  const Workcell cell = Calibrated();
  std::ofstream("mine.yaml") << "# The cell in the cellar.\n# Second line.\nname: \"old\"\n";
  SaveWorkcell(cell, "calibrated.yaml", "mine.yaml");
  EXPECT_TRUE(ReadFile("calibrated.yaml").starts_with(
      "# The cell in the cellar.\n# Second line.\nname: \"workcell\""));
  const Workcell again = LoadWorkcell("calibrated.yaml");
  EXPECT_THAT(CalibrationFaults(again), IsEmpty());
  EXPECT_EQ(again.calibration.box.values, cell.calibration.box.values);
  EXPECT_THAT(again.calibration.box.date, HasSubstr("T"));
  // Strokes are the same with or without the records: a plan sealed before stays sealed.
  EXPECT_EQ(WorkcellHash(again), WorkcellHash(Workcell{}));
}

TEST(CellCalibration, AFaultyCellIsNotWritten) {
  Workcell cell = Calibrated();
  cell.home_joints_rad[0] = 9;
  std::ofstream("mine.yaml") << "# mine\n";
  EXPECT_THAT(RefusalOf([&] { SaveWorkcell(cell, "mine.yaml", "mine.yaml"); }),
              HasSubstr("home_joints_rad"));
  EXPECT_EQ(ReadFile("mine.yaml"), "# mine\n");
}

}  // namespace
}  // namespace sandwright
