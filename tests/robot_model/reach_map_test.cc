#include "robot_model/reach_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/error.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Workcell SmallCell(double width_m, double depth_m) {
  Workcell cell;
  cell.box.width_m = width_m;
  cell.box.depth_m = depth_m;
  return cell;
}

TEST(ReachMap, IsWholeInTheMiddleAndLessAtTheWalls) {
  const SafetyGate gate(SmallCell(0.4, 0.3));
  const ReachMap& reach = gate.reach();
  EXPECT_EQ(reach.columns, 16);
  EXPECT_EQ(reach.rows, 12);
  EXPECT_EQ(reach.At(0.2, 0.15), 1);
  // 12.5 mm from a wall a blade of 50 mm stands free only along it.
  EXPECT_LT(reach.At(0.01, 0.15), 0.5);
  EXPECT_EQ(reach.At(-0.001, 0.15), 0);
  EXPECT_EQ(reach.At(0.2, 0.301), 0);
  EXPECT_EQ(&gate.reach(), &reach);  // measured once
}

TEST(ReachMap, ShowsWhatIsOutOfReach) {
  Workcell cell = SmallCell(0.4, 0.3);
  cell.X_WB.translation_m[1] += 0.55;  // the far corner 1.3 m from the arm, which with the tool down reaches about 1.1
  const ReachMap reach = MeasureReach(SafetyGate(cell));
  EXPECT_GT(reach.At(0.2, 0.05) + reach.At(0.3, 0.05), 0) << "near the arm";
  EXPECT_EQ(reach.At(0.02, 0.28), 0) << "far from it";
}

TEST(ReachMap, NeedsWholeMillimetres) {
  EXPECT_THAT([] { MeasureReach(SafetyGate(SmallCell(0.4003, 0.3))); },
              ThrowsMessage<Error>(HasSubstr("box of 0.4003 x 0.3 m; a reach map needs whole")));
}

}  // namespace
}  // namespace sandwright
