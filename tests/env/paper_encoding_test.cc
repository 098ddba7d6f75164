#include "env/paper_encoding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

namespace sandwright {
namespace {

constexpr double kDepth_m = 0.050;

ToolPath StraightPath(double x0_m, double y0_m, double x1_m, double y1_m, double z_m) {
  return SamplePath({{{x0_m, y0_m, z_m}, {x1_m, y1_m, z_m}}, 1, 0.1}, 0.002);
}

uint8_t At(const PaperPlane& plane, int row, int column) {
  return plane[static_cast<size_t>(row * kPaperPixels + column)];
}

// Rises along x by 0.1 mm a millimetre.
HeightMap Ramp() {
  HeightMap map(100, 100, 0.004);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = static_cast<float>(kDepth_m + 0.1 * (column + 0.5) * map.cell_size_m);
  }
  return map;
}

TEST(PaperEncoding, RunsFromTopToBottomAndSeesTheStrokesLeftOnItsRight) {
  const ToolPath along_y = StraightPath(0.2, 0.15, 0.2, 0.25, 0.05);
  const PaperFrame frame(along_y);
  EXPECT_TRUE(frame.ToBox(128, 128).isApprox(Eigen::Vector2d(0.2, 0.2)));
  EXPECT_TRUE(frame.ToBox(178, 128).isApprox(Eigen::Vector2d(0.2, 0.25)));  // the end: further down
  EXPECT_TRUE(frame.ToBox(128, 138).isApprox(Eigen::Vector2d(0.19, 0.2)));
  EXPECT_TRUE(frame.ToPicture(0.19, 0.25).isApprox(Eigen::Vector2d(178, 138)));

  const ToolPath round = SamplePath(
      {{{0.2, 0.2, 0.05}, {0.25, 0.2, 0.05}, {0.25, 0.25, 0.05}, {0.2, 0.2, 0.05}}, 1, 0.1}, 0.002);
  const double last_rad = round.back().yaw_rad;
  EXPECT_NEAR(PaperFrame(round).down.x(), std::cos(last_rad), 1e-9);
  EXPECT_NEAR(PaperFrame(round).down.y(), std::sin(last_rad), 1e-9);
}

TEST(PaperEncoding, LevelsOfARampAboveItsLowestPoint) {
  const HeightMap ramp = Ramp();
  // Down the ramp's slope line; the blade stays above the lowest sand.
  const ToolPath path = StraightPath(0.15, 0.2, 0.25, 0.2, 0.065);
  const PaperInput input = EncodePaperInput(ramp, path, {}).value();
  EXPECT_NEAR(input.zero_m, kDepth_m + 0.1 * 0.0725, 1e-6);  // the first pixel's centre
  EXPECT_EQ(At(input.height, 0, 0), 0);
  for (const int row : {1, 37, 128, 255}) {
    const int level = static_cast<int>(std::lround(0.1 * row / (150.0 / 255)));
    for (const int column : {0, 128, 255}) EXPECT_EQ(At(input.height, row, column), level) << row;
  }
  EXPECT_EQ(PaperLevel(-1), 0);
  EXPECT_EQ(PaperLevel(0.150), 255);
  EXPECT_EQ(PaperLevel(0.2), 255);
  EXPECT_EQ(PaperLevel(0.010), 17);
}

TEST(PaperEncoding, PathAndRelativeDepthOfTheBlade) {
  const HeightMap level(100, 100, 0.004, static_cast<float>(kDepth_m));
  const PaperInput input =
      EncodePaperInput(level, StraightPath(0.15, 0.2, 0.25, 0.2, 0.030), {}).value();
  EXPECT_NEAR(input.zero_m, 0.030, 1e-9);  // the blade's way is the lowest point
  EXPECT_EQ(At(input.height, 10, 10), 34);
  for (const int row : {76, 128, 180}) {  // the path from 78 to 178, and half a thickness further
    for (const int column : {103, 128, 152}) {
      EXPECT_EQ(At(input.path, row, column), 255) << row << " " << column;
      EXPECT_EQ(At(input.depth, row, column), 34);
    }
    EXPECT_EQ(At(input.path, row, 101), 0);
    EXPECT_EQ(At(input.path, row, 154), 0);
  }
  EXPECT_EQ(At(input.path, 73, 128), 0);
  EXPECT_EQ(At(input.path, 182, 128), 0);
  EXPECT_EQ(At(input.depth, 182, 128), 0);
  // Above the sand the blade passes, but has no depth.
  const PaperInput above =
      EncodePaperInput(level, StraightPath(0.15, 0.2, 0.25, 0.2, 0.060), {}).value();
  EXPECT_EQ(At(above.path, 128, 128), 255);
  EXPECT_EQ(At(above.depth, 128, 128), 0);
}

TEST(PaperEncoding, BeyondTheWallsIsTheHeightAtTheWallAndDoesNotCount) {
  HeightMap map = Ramp();
  map.valid.assign(map.size(), 1);
  map.valid[map.Index(50, 10)] = 0;  // 40..44 mm along x, 200..204 mm along y
  const PaperInput input =
      EncodePaperInput(map, StraightPath(0.05, 0.2, 0.15, 0.2, 0.06), {}).value();
  EXPECT_EQ(At(input.counts, 20, 128), 0);  // x = -7.5 mm
  EXPECT_EQ(At(input.height, 20, 128), At(input.height, 28, 128));
  EXPECT_EQ(At(input.counts, 28, 120), 1);
  EXPECT_EQ(At(input.counts, 70, 130), 0);  // not seen
  EXPECT_FALSE(EncodePaperInput(map, StraightPath(5, 5, 5.1, 5, 0.06), {}));
}

TEST(PaperEncoding, PastingTheTruthGivesTheTruth) {
  HeightMap before(75, 75, 0.004, static_cast<float>(kDepth_m)), after = before;
  for (int row = 0; row < before.rows; ++row) {
    for (int column = 0; column < before.columns; ++column) {
      const double x = column - 40.0, y = row - 35.0;
      before.At(row, column) += static_cast<float>(0.004 * std::sin(0.2 * x) * std::cos(0.15 * y));
      after.At(row, column) =
          before.At(row, column) +
          static_cast<float>(0.012 * std::exp(-(x * x + y * y) / 50) -
                             0.010 * std::exp(-(x * x + (y + 10) * (y + 10)) / 40));
    }
  }
  const ToolPath path = StraightPath(0.12, 0.10, 0.20, 0.16, 0.040);
  const PaperInput input = EncodePaperInput(before, path, {}).value();
  HeightMap pasted = before;
  const CellRect held = PastePaperChange(input, EncodePaperHeight(after, input), pasted);
  double squared = 0;
  int cells = 0;
  for (int row = 0; row < before.rows; ++row) {
    for (int column = 0; column < before.columns; ++column) {
      const Eigen::Vector2d at = input.frame.ToPicture((column + 0.5) * before.cell_size_m,
                                                       (row + 0.5) * before.cell_size_m);
      if (at.minCoeff() < 0 || at.maxCoeff() >= kPaperPixels) {
        EXPECT_EQ(pasted.At(row, column), before.At(row, column));
        continue;
      }
      EXPECT_TRUE(row >= held.row0 && row < held.row1 && column >= held.column0 &&
                  column < held.column1);
      const double error = pasted.At(row, column) - after.At(row, column);
      EXPECT_LT(std::abs(error), 0.8e-3) << row << " " << column;
      squared += error * error;
      ++cells;
    }
  }
  EXPECT_LT(std::sqrt(squared / cells), 0.25e-3);  // a level is 0.59 mm
  // The picture as it was changes nothing.
  pasted = before;
  PastePaperChange(input, input.height, pasted);
  EXPECT_EQ(pasted.height_m, before.height_m);
}

TEST(PaperEncoding, PasteKeepsTheFloor) {
  HeightMap map(75, 75, 0.004, 0.010f);
  const PaperInput input =
      EncodePaperInput(map, StraightPath(0.1, 0.15, 0.2, 0.15, 0.0), {}).value();
  PaperInput high = input;
  for (uint8_t& level : high.height) level = 200;
  PastePaperChange(high, PaperPlane(kPaperCount, 0), map);
  for (const float h : map.height_m) EXPECT_GE(h, 0);
  EXPECT_EQ(map.At(37, 37), 0);
  HeightMap relative(75, 75, 0.004, 0.010f, Datum::kRelative);
  PastePaperChange(high, PaperPlane(kPaperCount, 0), relative);
  EXPECT_LT(relative.At(37, 37), -0.1);
}

TEST(PaperEncoding, APairIsOnePicture) {
  const HeightMap map = Ramp();
  const PaperInput input =
      EncodePaperInput(map, StraightPath(0.15, 0.2, 0.25, 0.2, 0.065), {}).value();
  const auto file = std::filesystem::path(::testing::TempDir()) / "paper_pair.png";
  PaperPlane after = input.height;
  after[0] = 99;
  WritePaperPair(input, after, file);
  const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(bgr.size(), cv::Size(512, 256));
  EXPECT_EQ(bgr.at<cv::Vec3b>(128, 128),
            cv::Vec3b(At(input.depth, 128, 128), 255, At(input.height, 128, 128)));
  EXPECT_EQ(bgr.at<cv::Vec3b>(0, 256), cv::Vec3b(99, 99, 99));
}

}  // namespace
}  // namespace sandwright
