#include "env/drawn_goal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/imgproc.hpp>

#include "env/random_strokes.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Region kWhole{0, 0, 0.4, 0.3};
constexpr double kNarrowest_m = 0.03, kSlope = 0.45;

HeightMap Hills() {
  HeightMap terrain(60, 80, 0.005);
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 80; ++column)
      terrain.At(row, column) =
          static_cast<float>(0.06 + 0.004 * std::sin(0.2 * row) * std::cos(0.3 * column));
  return terrain;
}

// A picture of 1 mm a pixel in the whole place, black.
cv::Mat Black() { return cv::Mat::zeros(300, 400, CV_32F); }

double VolumeDifference(const HeightMap& goal, const HeightMap& terrain) {
  double sum = 0;
  for (size_t i = 0; i < goal.size(); ++i)
    if (goal.mask[i]) sum += static_cast<double>(goal.height_m[i]) - terrain.height_m[i];
  return sum;
}

TEST(DrawnGoal, WhiteIsHighTopIsFarAndBothComeToRest) {
  cv::Mat grey = Black();
  cv::rectangle(grey, {50, 40, 100, 60}, cv::Scalar(1), cv::FILLED);  // near the top left
  const HeightMap terrain = Hills();
  const HeightMap goal = MakeDrawnGoal(grey, 0.02, terrain, kWhole, kNarrowest_m, kSlope);
  EXPECT_NEAR(VolumeDifference(goal, terrain), 0, 1e-5);
  // Its middle: x = 100 mm, y = 300 - 70 mm. The plane lies around 60 mm less the block's share.
  EXPECT_NEAR(goal.At(46, 20) - goal.At(5, 70), 0.02, 1e-4);
  EXPECT_LT(SteepestFace(goal), kSlope * 1.005);
  EXPECT_GT(SteepestFace(goal), kSlope * 0.95);  // a wall of 20 mm did slide
  EXPECT_EQ(std::accumulate(goal.mask.begin(), goal.mask.end(), 0), 60 * 80);
  const HeightMap sunk = MakeDrawnGoal(grey, -0.02, terrain, kWhole, kNarrowest_m, kSlope);
  EXPECT_NEAR(sunk.At(46, 20) - sunk.At(5, 70), -0.02, 1e-4);
}

TEST(DrawnGoal, KeepsItsProportionsInTheMiddleOfItsPlace) {
  cv::Mat grey = cv::Mat::zeros(100, 100, CV_32F);
  cv::rectangle(grey, {30, 30, 40, 40}, cv::Scalar(1), cv::FILLED);
  const HeightMap terrain = Hills();
  const HeightMap goal =
      MakeDrawnGoal(grey, 0.01, terrain, {0.1, 0.05, 0.3, 0.2}, kNarrowest_m, kSlope);
  // 200 x 200 mm, 50 mm to the right of the place's left edge.
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 80; ++column)
      EXPECT_EQ(goal.mask[goal.Index(row, column)],
                row >= 10 && row < 50 && column >= 30 && column < 70)
          << row << ", " << column;
  EXPECT_EQ(goal.At(0, 0), terrain.At(0, 0));
}

TEST(DrawnGoal, WhatIsTooNarrowIsLeftOut) {
  cv::Mat grey = Black(), wide = Black();
  for (cv::Mat* drawing : {&grey, &wide})
    cv::rectangle(*drawing, {50, 40, 100, 100}, cv::Scalar(1), cv::FILLED);
  cv::rectangle(grey, {250, 0, 15, 300}, cv::Scalar(1), cv::FILLED);  // a ridge of half the width
  cv::rectangle(grey, {85, 40, 15, 100}, cv::Scalar(0), cv::FILLED);  // a slit through the block
  const HeightMap terrain = Hills();
  const HeightMap with = MakeDrawnGoal(grey, 0.02, terrain, kWhole, kNarrowest_m, kSlope);
  const HeightMap without = MakeDrawnGoal(wide, 0.02, terrain, kWhole, kNarrowest_m, kSlope);
  EXPECT_NEAR(with.At(30, 51), without.At(30, 51), 1e-4);
  EXPECT_NEAR(with.At(42, 18), without.At(42, 18), 1e-4);
}

TEST(DrawnGoal, SaysWhatIsWrong) {
  const auto make = [](const cv::Mat& grey, double range_m, const HeightMap& terrain,
                       const Region& region) {
    return [=] { MakeDrawnGoal(grey, range_m, terrain, region, kNarrowest_m, kSlope); };
  };
  cv::Mat hair = Black(), block = Black();
  cv::line(hair, {0, 0}, {399, 299}, cv::Scalar(1), 3);
  cv::rectangle(block, {50, 40, 100, 100}, cv::Scalar(1), cv::FILLED);
  EXPECT_THAT(make(hair, 0.02, Hills(), kWhole),
              ThrowsMessage<Error>(HasSubstr("nothing in the drawing is as wide as 30 mm")));
  EXPECT_THAT(make(block, -0.03, HeightMap(60, 80, 0.005, 0.01f), kWhole),
              ThrowsMessage<Error>(HasSubstr("the drawn goal reaches")));
  EXPECT_THAT(make(block, 0.02, Hills(), {2, 2, 0.3, 0.3}),
              ThrowsMessage<Error>(HasSubstr("covers no two cells")));
}

}  // namespace
}  // namespace sandwright
