#include "data/scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/gridding.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

auto Fails(const std::string& text) {
  return ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr(text)));
}

// A smooth bed of 60 x 80 cells in mm, tilted by `slope` along the rows.
NpyArray Bed(double slope = 0) {
  NpyArray array{"f8", {60, 80}, {}};
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 80; ++i)
      array.values.push_back(10 * std::sin(0.2 * i) * std::sin(0.15 * j) + slope * 5 * i);
  return array;
}

TEST(ScanHeights, MeanIsTheDatumUnlessTheDepthIsGiven) {
  ScanConfig config;
  config.level = "none";
  const ScanResult relative = ScanHeights(Bed(), 1e-3, config);
  ASSERT_TRUE(relative.accepted);
  EXPECT_EQ(relative.map.datum, Datum::kRelative);
  const ScanResult absolute = ScanHeights(Bed(), 1e-3, config, 0.05);
  EXPECT_EQ(absolute.map.datum, Datum::kFloor);
  double sum = 0;
  for (float h : absolute.map.height_m) sum += h;
  EXPECT_NEAR(sum / static_cast<double>(absolute.map.size()), 0.05, 1e-6);
  EXPECT_NEAR(absolute.map.At(7, 9) - relative.map.At(7, 9), 0.05, 1e-6);
  EXPECT_NEAR(relative.map.At(7, 9) - relative.map.At(0, 0), 0.01 * std::sin(1.8) * std::sin(1.05), 1e-6);
}

TEST(ScanHeights, TakesOutATilt) {
  const ScanResult scan = ScanHeights(Bed(0.1), 1e-3, {});
  ASSERT_TRUE(scan.accepted);
  EXPECT_NEAR(scan.tilt_removed_deg, std::atan(0.1) * 180 / M_PI, 0.2);
  EXPECT_NEAR(scan.map.At(0, 79) - scan.map.At(0, 0), 0, 0.002);
  ScanConfig strict;
  strict.max_tilt_deg = 3;
  EXPECT_THAT(ScanHeights(Bed(0.1), 1e-3, strict).reasons, Contains(HasSubstr("at most 3.0 are removed")));
}

TEST(ScanHeights, DistancesCountDownwards) {
  ScanConfig config;
  config.level = "none";
  config.heights_positive = "down";
  const HeightMap up = ScanHeights(Bed(), -1e-3, config).map, down = ScanHeights(Bed(), 1e-3, config).map;
  EXPECT_NEAR(up.At(10, 10), -down.At(10, 10), 1e-7);
}

TEST(ScanHeights, ClosesSmallHolesAndMarksThem) {
  NpyArray bed = Bed();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (size_t i : {805u, 806u, 885u, 886u}) bed.values[i] = nan;
  const ScanResult scan = ScanHeights(bed, 1e-3, {});
  ASSERT_TRUE(scan.accepted);
  EXPECT_NEAR(scan.invalid_share, 4.0 / 4800, 1e-12);
  EXPECT_EQ(scan.map.valid[805], 0);
  EXPECT_EQ(scan.map.valid[804], 1);
  EXPECT_NEAR(scan.map.height_m[805], ScanHeights(Bed(), 1e-3, {}).map.height_m[805], 0.0005);
}

TEST(ScanHeights, RefusesLargeHolesNamingTheLimit) {
  NpyArray bed = Bed();
  for (int j = 20; j < 40; ++j)
    for (int i = 20; i < 40; ++i) bed.values[static_cast<size_t>(80 * j + i)] = std::nan("");
  EXPECT_THAT(ScanHeights(bed, 1e-3, {}).reasons, Contains(HasSubstr("a hole reaches 50 mm")));
  bed.values.assign(4800, std::nan(""));
  const ScanResult blind = ScanHeights(bed, 1e-3, {});
  EXPECT_FALSE(blind.accepted);
  EXPECT_THAT(blind.reasons, Contains(HasSubstr("100 % of the box gave no reading")));
}

TEST(ScanHeights, RefusesAnObjectAndAnArm) {
  NpyArray plate = Bed();
  for (int j = 20; j < 30; ++j)
    for (int i = 30; i < 50; ++i) plate.values[static_cast<size_t>(80 * j + i)] = 40;
  const ScanResult object = ScanHeights(plate, 1e-3, {});
  EXPECT_FALSE(object.accepted);
  EXPECT_THAT(object.reasons, Contains(HasSubstr("a hard object")));
  for (int i = 0; i < 80; ++i) plate.values[static_cast<size_t>(80 * 10 + i)] = 600;
  EXPECT_THAT(ScanHeights(plate, 1e-3, {}).reasons, Contains(HasSubstr("sand in a box spans at most 400 mm")));
}

TEST(ScanHeights, RejectsWhatIsNotAMap) {
  ScanConfig rim;
  rim.level = "rim";
  EXPECT_THAT([&] { ScanHeights(Bed(), 1e-3, rim); }, Fails("allowed: sand, none"));
  EXPECT_THAT([] { ScanHeights({"f8", {4}, {1, 2, 3, 4}}, 1, {}); }, Fails("rank 1"));
  EXPECT_THAT([] { ScanHeights({"f8", {1, 1}, {1}}, 1, {}); }, Fails("1 x 1"));
  EXPECT_THAT([] { ScanHeights({"f8", {2, 2}, {1, 2, 3, INFINITY}}, 1, {}); }, Fails("inf"));
  EXPECT_THAT([] { ScanHeights(Bed(), 1e-3, {}, -0.1); }, Fails("sand depth -0.1 m"));
}

TEST(ScanDepth, RejectsContradictoryInput) {
  CameraModel camera;
  camera.width = camera.height = 64;
  const DepthFrame frame{64, 64, std::vector<float>(4096, 1)};
  const auto scan = [&](const ScanPlace& place) { return [=] { ScanDepth({&frame, 1}, camera, {}, place); }; };
  EXPECT_THAT(scan({std::nullopt, Eigen::Isometry3d::Identity(), std::nullopt}), Fails("without the box's size"));
  EXPECT_THAT(scan({Eigen::Vector2d(0.8, 1.2), std::nullopt, std::nullopt}), Fails("longer side comes first"));
  EXPECT_THAT(scan({Eigen::Vector2d(1.2, 0.8), Eigen::Isometry3d::Identity(), 0.1}), Fails("each sets the zero"));
  const DepthFrame other{32, 64, std::vector<float>(2048, 1)};
  EXPECT_THAT([&] { ScanDepth({&other, 1}, camera, {}); }, Fails("32 x 64 px"));
}

TEST(ScanDepth, RefusesAnEmptyFloor) {
  const DepthFrame floor{512, 424, std::vector<float>(512 * 424, 2)};
  const ScanResult scan = ScanDepth({&floor, 1}, CameraModel{}, {});
  EXPECT_FALSE(scan.accepted);
  EXPECT_THAT(scan.reasons, ElementsAre(HasSubstr("no surface that steep edges enclose")));
}

TEST(Gridding, PlanesComeBackExactlyFromScatteredPoints) {
  std::vector<Eigen::Vector3f> points;
  for (int k = 0; k < 4000; ++k) {  // a lattice that fits no cell
    const float x = std::fmod(0.0137f * static_cast<float>(k), 0.1f), y = 0.1f * static_cast<float>(k) / 4000;
    points.emplace_back(x, y, 0.3f * x - 0.2f * y + 0.05f);
  }
  const HeightMap map = GridPoints(points, 20, 20, 0.005, 0.006);
  for (int j = 1; j < 19; ++j)
    for (int i = 1; i < 19; ++i)
      EXPECT_NEAR(map.At(j, i), 0.3 * (i + 0.5) * 0.005 - 0.2 * (j + 0.5) * 0.005 + 0.05, 0.0002);
  EXPECT_EQ(MeasureHoles(map).share, 0);
}

TEST(Gridding, HolesAreSpannedByAMembrane) {
  HeightMap map(9, 9, 0.01);
  map.valid.assign(map.size(), 1);
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      const bool hole = j > 2 && j < 6 && i > 2 && i < 6;
      map.At(j, i) = hole ? 99 : 0.1f * static_cast<float>(i) + 0.05f * static_cast<float>(j);
      map.valid[map.Index(j, i)] = !hole;
    }
  const Holes holes = MeasureHoles(map);
  EXPECT_NEAR(holes.share, 9.0 / 81, 1e-12);
  EXPECT_NEAR(holes.largest_m, 0.02, 1e-6);  // the middle is two cells from the nearest seen one
  FillHoles(map);
  EXPECT_NEAR(map.At(4, 4), 0.6, 1e-5);  // a plane is its own membrane
  EXPECT_NEAR(map.At(3, 5), 0.65, 1e-5);
}

}  // namespace
}  // namespace sandwright
