#include "env/paper_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "env/paper_encoding.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }
std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

// A stroke on waves, written as a pair; `after` is `before` a centimetre lower along x = 0.3.
void WritePair(const Stroke& stroke, const std::string& name) {
  HeightMap before(150, 150, 0.004), after;
  for (int row = 0; row < before.rows; ++row)
    for (int column = 0; column < before.columns; ++column)
      before.At(row, column) = static_cast<float>(0.06 + 0.005 * std::sin(0.1 * row + 0.07 * column));
  after = before;
  for (int row = 0; row < before.rows; ++row) after.At(row, 75) -= 0.01f;
  const PaperInput input = EncodePaperInput(before, SamplePath(stroke, 0.002), {}).value();
  WritePaperPair(input, EncodePaperHeight(after, input), Temp(name));
}

TEST(PaperImport, ARecordedStrokeComesBackInItsPicture) {
  const std::vector<Stroke> strokes = {
      {{{0.25, 0.3, 0.045}, {0.37, 0.3, 0.045}}, 1, 0.1},
      {{{0.25, 0.25, 0.04}, {0.35, 0.35, 0.05}}, 1, 0.1},
      {{{0.25, 0.3, 0.045}, {0.30, 0.34, 0.045}, {0.37, 0.3, 0.045}}, 2, 0.1},
      {{{0.22, 0.3, 0.04}, {0.28, 0.33, 0.05}, {0.33, 0.27, 0.05}, {0.38, 0.3, 0.04}}, 2, 0.1}};
  for (size_t i = 0; i < strokes.size(); ++i) {
    SCOPED_TRACE(i);
    WritePair(strokes[i], "pair.png");
    const StrokeRecord record = ReadPaperPair(Temp("pair.png"), {});
    const auto& points = strokes[i].control_points_m;
    const auto& got = record.stroke.control_points_m;
    const double length_m = (points.back() - points.front()).head<2>().norm();
    EXPECT_NEAR((got.back() - got.front()).head<2>().norm(), length_m, 0.003);
    EXPECT_NEAR(got.front().y() - got.back().y(), length_m, 0.003);  // towards -y
    EXPECT_NEAR(record.path.back().z_m - record.path.front().z_m, points.back().z() - points.front().z(), 0.0025);
    EXPECT_EQ(record.before.rows, 256);
    // The height below the blade's first point: zero is the picture's own.
    const double rise_m = record.path.front().z_m -
                          HeightAt(record.before, record.path.front().x_m, record.path.front().y_m);
    HeightMap wave(150, 150, 0.004);
    for (int row = 0; row < 150; ++row)
      for (int column = 0; column < 150; ++column)
        wave.At(row, column) = static_cast<float>(0.06 + 0.005 * std::sin(0.1 * row + 0.07 * column));
    EXPECT_NEAR(rise_m, points.front().z() - HeightAt(wave, points.front().x(), points.front().y()), 0.0025);
    // Encoded again it is nearly the same picture.
    const PaperInput again = EncodePaperInput(record.before, record.path, {}).value();
    const cv::Mat image = cv::imread(Temp("pair.png"));
    int differing = 0, all = 0;
    for (int k = 0; k < kPaperCount; ++k) {
      const bool was = image.at<cv::Vec3b>(k / 256, k % 256)[1] != 0;
      all += was;
      differing += was != (again.path[static_cast<size_t>(k)] != 0);
      ASSERT_NEAR(again.height[static_cast<size_t>(k)], image.at<cv::Vec3b>(k / 256, k % 256)[2], 8);
    }
    EXPECT_LT(differing, all / 12);
  }
}

TEST(PaperImport, AFolderIsAFileOfStrokesAndWhatCannotBeTakenIsLeftOut) {
  const std::string folder = Temp("pairs");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  EXPECT_THAT([&] { ReadPaperPairs(folder, {}); }, Fails("no pair of pictures"));
  WritePair({{{0.25, 0.3, 0.045}, {0.37, 0.3, 0.045}}, 1, 0.1}, "pairs/a.png");
  WritePair({{{0.25, 0.3, 0.045}, {0.3, 0.3, 0.045}, {0.3, 0.36, 0.045}, {0.251, 0.3, 0.045}}, 1, 0.1}, "pairs/loop.png");
  WriteFileAtomically(folder + "/c.png", "words");
  const StrokeFile content = ReadPaperPairs(folder, {});
  ASSERT_EQ(content.strokes.size(), 1u);
  EXPECT_THAT(content.material, HasSubstr("\"datum\":\"relative\""));
  EXPECT_EQ(content.bed, "pairs");
}

TEST(PaperImport, WhatIsNoPairIsNamed) {
  EXPECT_THAT([] { ReadPaperPair(Temp("none.png"), {}); }, Fails("none.png: no such file"));
  cv::imwrite(Temp("small.png"), cv::Mat::zeros(256, 256, CV_8UC3));
  EXPECT_THAT([] { ReadPaperPair(Temp("small.png"), {}); }, Fails("256 x 256 pixels in 3 channels of 8 bits"));
  cv::imwrite(Temp("blank.png"), cv::Mat::zeros(256, 512, CV_8UC3));
  EXPECT_THAT([] { ReadPaperPair(Temp("blank.png"), {}); }, Fails("blank.png: no path in its middle"));
}

}  // namespace
}  // namespace sandwright
