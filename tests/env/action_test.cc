#include "env/action.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "data/base/random.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kPi = std::numbers::pi;
constexpr double kSpeed_mps = 0.1;
const Region kWhole{0, 0, 0.3, 0.2};
const Blade kBlade;

HeightMap Flat() { return HeightMap(20, 30, 0.01, 0.05f); }

Stroke Decode(const Action& action, const HeightMap& sensed = Flat(),
              const Region& region = kWhole) {
  return DecodeAction(action, sensed, region, kBlade, kSpeed_mps);
}

void ExpectPoint(const Eigen::Vector3d& p, double x, double y, double z) {
  EXPECT_NEAR(p.x(), x, 1e-9);
  EXPECT_NEAR(p.y(), y, 1e-9);
  EXPECT_NEAR(p.z(), z, 1e-8);  // heights are float
}

TEST(DecodeAction, ZerosAreTheMiddleOfEveryRange) {
  const Stroke stroke = Decode({});
  ASSERT_EQ(stroke.control_points_m.size(), 2u);
  EXPECT_EQ(stroke.degree, 1);
  EXPECT_EQ(stroke.speed_mps, kSpeed_mps);
  // Start in the middle, heading 0, 110 mm long, 12.5 mm below 50 mm of sand.
  ExpectPoint(stroke.control_points_m[0], 0.15, 0.10, 0.0375);
  ExpectPoint(stroke.control_points_m[1], 0.26, 0.10, 0.0375);
}

TEST(DecodeAction, BoundsReachTheEndsOfEveryRange) {
  const Stroke low = Decode({-1, -1, -1, -1, -1, -1, 0});
  ExpectPoint(low.control_points_m[0], 0, 0, 0.055);  // 5 mm above the sand
  ExpectPoint(low.control_points_m[1], -0.04, 0, 0.055);
  const Stroke high = Decode({1, 1, 0.5f, 1, 1, 1, 0});
  ExpectPoint(high.control_points_m[0], 0.3, 0.2, 0.02);
  ExpectPoint(high.control_points_m[1], 0.3, 0.38, 0.02);  // leaves the box: the gate's to reject
}

TEST(DecodeAction, BendMovesTheMiddleToTheLeft) {
  const Stroke stroke = Decode({-0.5f, 0, 0, 0, -1, 1, 1});
  ASSERT_EQ(stroke.control_points_m.size(), 3u);
  EXPECT_EQ(stroke.degree, 2);
  ExpectPoint(stroke.control_points_m[0], 0.075, 0.10, 0.055);
  ExpectPoint(stroke.control_points_m[1], 0.13, 0.155, 0.0375);
  ExpectPoint(stroke.control_points_m[2], 0.185, 0.10, 0.02);
}

TEST(DecodeAction, StartIsRelativeToTheRegionAndLengthsAreNot) {
  const Stroke stroke = Decode({-1, 1, 0, 0, 0, 0, 0}, Flat(), {0.1, 0.05, 0.04, 0.06});
  ExpectPoint(stroke.control_points_m[0], 0.10, 0.11, 0.0375);
  ExpectPoint(stroke.control_points_m[1], 0.21, 0.11, 0.0375);
}

TEST(DecodeAction, DepthIsBelowTheSandAtEachEnd) {
  HeightMap slope = Flat();
  for (int row = 0; row < slope.rows; ++row)
    for (int column = 0; column < slope.columns; ++column)
      slope.At(row, column) = static_cast<float>(0.03 + 0.1 * (column + 0.5) * 0.01);
  const Stroke stroke = Decode({}, slope);
  EXPECT_NEAR(stroke.control_points_m[0].z(), 0.045 - 0.0125, 1e-8);
  EXPECT_NEAR(stroke.control_points_m[1].z(), 0.056 - 0.0125, 1e-8);
}

TEST(DecodeAction, SandIsAveragedOverTheWholeBlade) {
  HeightMap step = Flat();  // 40 mm below y = 0.10, 60 mm above
  for (int row = 0; row < step.rows; ++row)
    for (int column = 0; column < step.columns; ++column)
      step.At(row, column) = row < 10 ? 0.04f : 0.06f;
  // Along the step the blade lies half on each side; across it, it starts on the edge.
  EXPECT_NEAR(Decode({}, step).control_points_m[0].z(), 0.05 - 0.0125, 1e-8);
  const Stroke across = Decode({0, 0, 0.5f, 0, 0, 0, 0}, step);
  EXPECT_NEAR(across.control_points_m[0].z(), 0.05 - 0.0125, 1e-8);
  EXPECT_NEAR(across.control_points_m[1].z(), 0.06 - 0.0125, 1e-8);
}

TEST(DecodeAction, RejectsWhatIsNotInTheBox) {
  const auto decode = [](size_t i, float value) {
    Action action{};
    action[i] = value;
    return Decode(action);
  };
  EXPECT_THAT([&] { decode(3, 1.01f); },
              ThrowsMessage<Error>(HasSubstr("action[3] (length_m) = 1.01; allowed: [-1, 1]")));
  EXPECT_THAT([&] { decode(6, std::numeric_limits<float>::quiet_NaN()); },
              ThrowsMessage<Error>(HasSubstr("action[6] (bend) = nan")));
  EXPECT_THAT([&] { decode(0, -std::numeric_limits<float>::infinity()); },
              ThrowsMessage<Error>(HasSubstr("start_x")));
  ExpectPoint(decode(0, 1 + 5e-7f).control_points_m[0], 0.3, 0.10, 0.0375);
}

TEST(DecodeAction, EveryActionIsAStroke) {
  RandomStream stream(1);
  for (int n = 0; n < 2000; ++n) {
    Action action;
    for (float& a : action) a = static_cast<float>(stream.Uniform(-1, 1));
    const Stroke stroke = Decode(action);
    EXPECT_NO_THROW(CheckStroke(stroke, "action"));
    const Eigen::Vector3d chord = stroke.control_points_m.back() - stroke.control_points_m.front();
    const double heading = std::atan2(chord.y(), chord.x());
    EXPECT_NEAR(std::remainder(heading - kPi * static_cast<double>(action[2]), 2 * kPi), 0, 1e-6);
  }
}

TEST(EncodeLine, IsTheInverseOfDecodeForLines) {
  HeightMap hills = Flat();
  for (int row = 0; row < hills.rows; ++row)
    for (int column = 0; column < hills.columns; ++column)
      hills.At(row, column) += static_cast<float>(0.01 * std::sin(0.5 * row) * std::cos(0.3 * column));
  const Region region{0.05, 0.02, 0.2, 0.15};
  RandomStream stream(1);
  for (int n = 0; n < 500; ++n) {
    Action action;
    for (float& a : action) a = static_cast<float>(stream.Uniform(-1, 1));
    action[6] = 0;
    const Stroke stroke = Decode(action, hills, region);
    const Action again = EncodeLine(stroke.control_points_m[0], stroke.control_points_m[1], hills,
                                    region, kBlade);
    for (size_t i = 0; i < action.size(); ++i) EXPECT_NEAR(again[i], action[i], 1e-5) << i;
    const Stroke same = Decode(again, hills, region);
    for (size_t p = 0; p < 2; ++p)
      EXPECT_LT((same.control_points_m[p] - stroke.control_points_m[p]).norm(), 1e-6);
  }
}

TEST(EncodeLine, WhatNoActionReachesIsBroughtToTheBound) {
  const Eigen::Vector3d outside(-0.1, 0.1, 0.05), far(0.5, 0.1, 0.0);
  const Action action = EncodeLine(outside, far, Flat(), kWhole, kBlade);
  EXPECT_EQ(action[0], -1.0f);
  EXPECT_EQ(action[3], 1.0f);  // 180 mm at most
  EXPECT_EQ(action[5], 1.0f);  // 30 mm at most
  ExpectPoint(Decode(action).control_points_m[0], 0, 0.1, 0.05);
  ExpectPoint(Decode(action).control_points_m[1], 0.18, 0.1, 0.02);
  EXPECT_THROW(EncodeLine(outside, outside, Flat(), kWhole, kBlade), Error);
}

TEST(WithinBounds, TheHeadingGoesRoundTheRestStops) {
  EXPECT_NEAR(WithinBounds(kHeadingEntry, 1.25), -0.75, 1e-6);
  EXPECT_NEAR(WithinBounds(kHeadingEntry, -3.5), 0.5, 1e-6);
  EXPECT_EQ(WithinBounds(0, 1.25), 1.0f);
  EXPECT_EQ(WithinBounds(6, -7), -1.0f);
}

}  // namespace
}  // namespace sandwright
