// What planners know without a sand model: lanes and the transport of sand.
#include "agents/lane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agents/transport.h"
#include "agents/wedge_stroke.h"

namespace sandwright {
namespace {

constexpr double kWidth_m = 0.05;

// 300 x 200 mm of sand 50 mm deep that is to stay; two places to change.
struct Bed {
  HeightMap sensed = HeightMap(20, 30, 0.01, 0.05f), goal = HeightMap(20, 30, 0.01, 0.05f);
  TaskView view{.sensed = sensed, .goal = goal, .region = {0, 0, 0.3, 0.2}, .max_strokes = 5};
  Bed() { goal.mask.assign(goal.size(), 1); }
  static void Fill(HeightMap& map, const CellRect& rect, float height_m) {
    for (int row = rect.row0; row < rect.row1; ++row)
      for (int column = rect.column0; column < rect.column1; ++column)
        map.At(row, column) = height_m;
  }
};

TEST(Lane, TakesMeansAcrossTheBlade) {
  Bed bed;
  Bed::Fill(bed.sensed, {10, 4, 20, 8}, 0.06f);  // on one side of the middle line
  bed.sensed.At(9, 20) = 0.07f;
  bed.goal.mask[bed.goal.Index(9, 20)] = 0;
  bed.goal.height_m[bed.goal.Index(9, 20)] = NAN;
  const Lane lane = LaneOf(bed.view, {0, 0.105}, {1, 0}, 0.3, kWidth_m);
  ASSERT_EQ(lane.size(), 30u);
  EXPECT_NEAR(lane.At(3).x(), 0.035, 1e-9);
  EXPECT_NEAR(lane.above_m[3], 0, 1e-7);
  EXPECT_NEAR(lane.above_m[4], 0.006, 1e-7);  // 3 of 5 cells
  EXPECT_NEAR(lane.above_m[20], 0, 1e-7);     // does not count
  const Lane back = LaneOf(bed.view, {0.3, 0.105}, {-1, 0}, 0.3, kWidth_m);
  EXPECT_NEAR(back.above_m[22], lane.above_m[7], 1e-9);
}

TEST(Lane, PassesGoAheadFromTooMuchToTooLittle) {
  Bed bed;
  Bed::Fill(bed.sensed, {0, 5, 20, 8}, 0.06f);    // 30 mm of 10 mm too much
  Bed::Fill(bed.sensed, {0, 12, 20, 16}, 0.04f);  // 40 mm of 10 mm too little
  const auto passes = PassesOf(LaneOf(bed.view, {0, 0.1}, {1, 0}, 0.3, kWidth_m), 0.2);
  ASSERT_EQ(passes.size(), 3u);  // one for each step with too much
  EXPECT_EQ(passes[0].first, 5u);
  EXPECT_EQ(passes[0].last, 14u);  // the fourth step of the hollow stays
  EXPECT_NEAR(passes[0].area_m2, 3e-4, 1e-9);
  EXPECT_EQ(passes[2].first, 7u);
  EXPECT_EQ(passes[2].last, 12u);
  EXPECT_NEAR(passes[2].area_m2, 1e-4, 1e-9);
  // A blade that comes back finds the hollow before the heap.
  EXPECT_TRUE(PassesOf(LaneOf(bed.view, {0.3, 0.1}, {-1, 0}, 0.3, kWidth_m), 0.2).empty());
  // 80 mm reach to the first two steps of the hollow.
  const auto shorter = PassesOf(LaneOf(bed.view, {0, 0.1}, {1, 0}, 0.3, kWidth_m), 0.08);
  EXPECT_EQ(shorter[0].last, 13u);
  EXPECT_NEAR(shorter[0].area_m2, 2e-4, 1e-9);
}

TEST(WedgeStroke, TakesTheVolumeAlongAWedge) {
  const Bed bed;
  const WedgeConfig config{.start_back_m = 0.01,
                           .end_back_m = 0.02,
                           .depth_gain = 1,
                           .most_depth_m = 0.02,
                           .end_depth_m = 0};
  const WedgeLine line = WedgeLineOf({0.1, 0.1}, {0.2, 0.1}, config, bed.view.region);
  EXPECT_NEAR(line.start_m.x(), 0.09, 1e-9);
  EXPECT_NEAR(line.end_m().x(), 0.18, 1e-9);
  const Action action = WedgeStroke(bed.view, line, 22.5e-6, config, {});  // 50 x 90 mm
  const Stroke stroke = DecodeAction(action, bed.sensed, bed.view.region, {}, 0.1);
  EXPECT_LT((stroke.control_points_m[0] - Eigen::Vector3d(0.09, 0.1, 0.04)).norm(), 1e-6);
  EXPECT_LT((stroke.control_points_m[1] - Eigen::Vector3d(0.18, 0.1, 0.05)).norm(), 1e-6);
  // Out of the region it starts at its edge; no action is shorter than 40 mm or cuts deeper than said.
  const WedgeLine edge = WedgeLineOf({0.005, 0.1}, {0.03, 0.1}, config, bed.view.region);
  EXPECT_EQ(edge.start_m.x(), 0);
  EXPECT_EQ(edge.length_m, 0.04);
  const Stroke deep = DecodeAction(WedgeStroke(bed.view, edge, 1e-3, config, {}), bed.sensed,
                                   bed.view.region, {}, 0.1);
  EXPECT_NEAR(deep.control_points_m[0].z(), 0.03, 1e-6);
  EXPECT_THROW(WedgeLineOf({0.1, 0.1}, {0.1, 0.1}, config, bed.view.region), Error);
}

TEST(WedgeStroke, MovesMostFirstAndNothingWithoutNeed) {
  const Bed bed;
  const WedgeConfig config;
  const WedgeLine line = WedgeLineOf({0.1, 0.1}, {0.2, 0.1}, config, bed.view.region);
  const auto actions = MostFirst(bed.view, {{line, 1e-6}, {line, 9e-6}, {line, 4e-6}}, config, {});
  ASSERT_EQ(actions.size(), 3u);
  EXPECT_GT(actions[0][4], actions[1][4]);
  EXPECT_GT(actions[1][4], actions[2][4]);
  const auto nothing = MostFirst(bed.view, {}, config, {});
  ASSERT_EQ(nothing.size(), 1u);
  for (const auto& p :
       DecodeAction(nothing[0], bed.sensed, bed.view.region, {}, 0.1).control_points_m)
    EXPECT_GT(p.z(), 0.0545);
}

TEST(OptimalTransport, BringsSandTheShortestWay) {
  Bed bed;  // squares of 50 mm; two heaps and two hollows beside each other
  Bed::Fill(bed.sensed, {0, 0, 5, 5}, 0.06f);      // middle (25, 25): 25 cm^3
  Bed::Fill(bed.sensed, {15, 20, 20, 25}, 0.07f);  // middle (225, 175): 50 cm^3
  Bed::Fill(bed.sensed, {0, 10, 5, 15}, 0.04f);    // middle (125, 25): 25 cm^3
  Bed::Fill(bed.sensed, {15, 10, 20, 15}, 0.03f);  // middle (125, 175): 50 cm^3
  const auto flows = OptimalTransport(bed.view, 0.05);
  ASSERT_EQ(flows.size(), 2u);
  const bool first = flows[0].volume_m3 < flows[1].volume_m3;
  const SandFlow &small = flows[first ? 0 : 1], &large = flows[first ? 1 : 0];
  EXPECT_NEAR(small.volume_m3, 25e-6, 1e-9);
  EXPECT_LT((small.from_m - Eigen::Vector2d(0.025, 0.025)).norm(), 1e-6);
  EXPECT_LT((small.to_m - Eigen::Vector2d(0.125, 0.025)).norm(), 1e-6);
  EXPECT_NEAR(large.volume_m3, 50e-6, 1e-9);
  EXPECT_LT((large.from_m - Eigen::Vector2d(0.225, 0.175)).norm(), 1e-6);
  EXPECT_LT((large.to_m - Eigen::Vector2d(0.125, 0.175)).norm(), 1e-6);
}

TEST(OptimalTransport, NothingComesFromNowhere) {
  Bed bed;
  EXPECT_TRUE(OptimalTransport(bed.view, 0.05).empty());
  Bed::Fill(bed.sensed, {0, 0, 5, 5}, 0.06f);
  EXPECT_TRUE(OptimalTransport(bed.view, 0.05).empty());  // too much everywhere
  Bed::Fill(bed.sensed, {0, 10, 5, 15}, 0.045f);          // half as much is missing
  const auto flows = OptimalTransport(bed.view, 0.05);
  ASSERT_EQ(flows.size(), 1u);
  EXPECT_NEAR(flows[0].volume_m3, 12.5e-6, 1e-9);
  // What does not count is neither too much nor missing.
  for (int row = 0; row < 5; ++row)
    for (int column = 10; column < 15; ++column) bed.goal.mask[bed.goal.Index(row, column)] = 0;
  EXPECT_TRUE(OptimalTransport(bed.view, 0.05).empty());
}

}  // namespace
}  // namespace sandwright
