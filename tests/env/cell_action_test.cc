#include "env/cell_action.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const CellActionConfig kConfig{.rows = 6, .columns = 8, .headings = 4};

TEST(CellAction, StartsInTheMiddleOfItsCell) {
  EXPECT_EQ(CellActionSizes(kConfig), (CellAction{48, 4, 4, 4, 4, 3}));
  const HeightMap sand(30, 40, 0.01, 0.05f);
  const Region region{0, 0, 0.4, 0.3};
  // Row 2, column 5; along -y; the shortest, at the least depth, a line.
  const Stroke stroke = DecodeAction(ActionOf({2 * 8 + 5, 3, 0, 0, 0, 1}, kConfig), sand, region,
                                     Blade{}, 0.1);
  ASSERT_EQ(stroke.control_points_m.size(), 2u);
  const Eigen::Vector3d from = stroke.control_points_m[0], to = stroke.control_points_m[1];
  EXPECT_NEAR(from.x(), 5.5 * 0.05, 1e-6);
  EXPECT_NEAR(from.y(), 2.5 * 0.05, 1e-6);
  EXPECT_NEAR(to.x(), from.x(), 1e-6);
  EXPECT_NEAR(to.y(), from.y() - 0.04, 1e-6);
  EXPECT_NEAR(from.z(), 0.055, 1e-6);
}

TEST(CellAction, LevelsReachBothEndsOfTheirRange) {
  const Action last = ActionOf({47, 3, 3, 3, 3, 2}, kConfig);
  for (const size_t i : {3, 4, 5, 6}) EXPECT_EQ(last[i], 1);
  const Action first = ActionOf({0, 0, 0, 0, 0, 0}, kConfig);
  for (const size_t i : {3, 4, 5, 6}) EXPECT_EQ(first[i], -1);
  EXPECT_EQ(first[2], 0);  // along x
}

TEST(CellAction, RefusesWhatIsNoChoice) {
  EXPECT_THAT([] { ActionOf({48, 0, 0, 0, 0, 0}, kConfig); },
              ThrowsMessage<Error>(HasSubstr("choice[0] = 48; allowed: 0 to 47")));
  EXPECT_THAT([] { ActionOf({0, 0, -1, 0, 0, 0}, kConfig); },
              ThrowsMessage<Error>(HasSubstr("choice[2] = -1; allowed: 0 to 3")));
}

TEST(CellAction, TheMaskKnowsWallsAndReach) {
  HeightMap sand(30, 40, 0.01, 0.05f), goal = sand;
  goal.mask.assign(goal.size(), 1);
  TaskView view{sand, goal, {-0.1, 0, 0.4, 0.3}, 0, 10};  // two columns lie outside the walls
  const std::vector<uint8_t> mask = StartMask(view, kConfig);
  ASSERT_EQ(mask.size(), 48u);
  for (size_t i = 0; i < mask.size(); ++i) EXPECT_EQ(mask[i], i % 8 >= 2) << i;

  Workcell cell;
  cell.box.width_m = 0.4;
  cell.box.depth_m = 0.3;
  cell.X_WB.translation_m[1] += 0.62;
  const SafetyGate gate(cell);
  view.region.x_m = 0;
  view.gate = &gate;
  const std::vector<uint8_t> reached = StartMask(view, kConfig);
  EXPECT_EQ(reached[5 * 8], 0) << "the far corner";
  EXPECT_TRUE(std::ranges::any_of(reached, [](uint8_t m) { return m == 1; }));
}

}  // namespace
}  // namespace sandwright
