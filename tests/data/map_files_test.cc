#include "data/map_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "data/npy.h"
#include "data/tiff.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }
std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

HeightMap Hills() {
  HeightMap map(30, 40, 0.005);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = static_cast<float>(0.05 + 0.01 * std::sin(0.3 * row) * std::cos(0.2 * column));
  return map;
}

HeightMap WithHole() {
  HeightMap map = Hills();
  map.valid.assign(map.size(), 1);
  map.valid[map.Index(12, 20)] = 0;
  return map;
}

const MapFileOptions kMm = {.unit = "mm", .cell_size_m = 0.005, .datum = Datum::kFloor};

void ExpectSeenSame(const HeightMap& map, const HeightMap& again, double tolerance_m) {
  ASSERT_TRUE(map.SameGrid(again));
  EXPECT_EQ(map.datum, again.datum);
  EXPECT_EQ(map.valid, again.valid);
  for (size_t i = 0; i < map.size(); ++i)
    if (map.valid.empty() || map.valid[i]) {
      ASSERT_NEAR(map.height_m[i], again.height_m[i], tolerance_m) << i;
    }
}

TEST(MapFiles, EveryFormatGivesTheMapBackWithItsHoles) {
  for (const HeightMap& map : {Hills(), WithHole()}) {
    for (const char* name : {"map.npy", "map.tif", "map.tiff", "map.stl", "map.obj", "map.ply", "map.xyz"}) {
      for (const char* unit : {"mm", "m"}) {
        SCOPED_TRACE(std::string(name) + " " + unit);
        MapFileOptions options = kMm;
        options.unit = unit;
        WriteMapFile(map, Temp(name), options);
        ExpectSeenSame(map, ReadMapFile(Temp(name), options), 1e-8);
      }
    }
  }
}

TEST(MapFiles, GreyLevelsAreExactToHalfALevelAndRow0IsAtTheBottom) {
  MapFileOptions range = kMm, step = kMm;
  range.low_m = 0.03, range.high_m = 0.07;
  step.step_m = 1e-6;
  step.hole_level = 0;
  WriteMapFile(Hills(), Temp("range.png"), range);
  ExpectSeenSame(Hills(), ReadMapFile(Temp("range.png"), range), 0.04 / 65535 / 2 + 1e-8);
  MapFileOptions coarse = step;
  coarse.step_m = 1e-5;
  WriteMapFile(WithHole(), Temp("step.png"), coarse);
  ExpectSeenSame(WithHole(), ReadMapFile(Temp("step.png"), coarse), 0.5e-5 + 1e-8);
  const cv::Mat image = cv::imread(Temp("step.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(image.at<uint16_t>(29, 0), 5000);  // row 0: 50 mm
  EXPECT_THAT([&] { WriteMapFile(WithHole(), Temp("x.png"), range); }, AllOf(Fails("row 12, column 20"), Fails("--hole-level")));
  EXPECT_THAT([&] { WriteMapFile(HeightMap(2, 2, 0.01, 0.5f), Temp("x.png"), range); },
              Fails("is 500.0000 mm high; the levels go from 30.0000 to 70.0000 mm"));
  EXPECT_THAT([&] { WriteMapFile(HeightMap(2, 2, 0.01, 0.0f), Temp("x.png"), coarse); }, Fails("the level of holes"));
  MapFileOptions filled = range;
  filled.fill_holes = true;
  WriteMapFile(WithHole(), Temp("filled.png"), filled);
  EXPECT_TRUE(ReadMapFile(Temp("filled.png"), filled).valid.empty());
  EXPECT_FALSE(std::filesystem::exists(Temp("x.png")));
}

TEST(MapFiles, HolesOfAGoalDoNotCount) {
  MapFileOptions goal = kMm;
  goal.holes_do_not_count = true;
  WriteMapFile(WithHole(), Temp("goal.tif"), kMm);
  const HeightMap read = ReadMapFile(Temp("goal.tif"), goal);
  EXPECT_TRUE(read.valid.empty());
  EXPECT_EQ(read.mask, WithHole().valid);
  WriteMapFile(read, Temp("goal.npy"), kMm);  // out again: a hole
  EXPECT_TRUE(std::isnan(ReadNumpy(Temp("goal.npy")).values[12 * 40 + 20]));
}

TEST(MapFiles, UnitsAndGridsAreNeverGuessed) {
  MapFileOptions none;
  for (const char* name : {"a.npy", "a.tif", "a.stl"})
    EXPECT_THAT([&] { WriteMapFile(Hills(), Temp(name), none); }, AllOf(Fails(name), Fails("--unit is \"\"; allowed: mm, m")));
  EXPECT_THAT([&] { WriteMapFile(Hills(), Temp("a.png"), none); }, Fails("give either --range-mm LOW HIGH or --mm-per-level"));
  WriteMapFile(Hills(), Temp("b.npy"), kMm);
  none.unit = "mm";
  EXPECT_THAT([&] { ReadMapFile(Temp("b.npy"), none); }, Fails("--cell-size M (in m) is needed"));
  WriteMapFile(Hills(), Temp("b.tif"), kMm);
  EXPECT_EQ(ReadMapFile(Temp("b.tif"), none).cell_size_m, 0.005);  // GeoTIFF has it
  EXPECT_EQ(ReadMapFile(Temp("b.tif"), none).datum, Datum::kRelative);
  none.cell_size_m = 0.01;
  EXPECT_THAT([&] { ReadMapFile(Temp("b.tif"), none); }, Fails("--cell-size 0.01 m; the file says 0.005 m"));
}

TEST(MapFiles, DamagedPicturesAreNamed) {
  const auto fails = [](const std::string& name, const std::string& bytes, const std::string& text) {
    MapFileOptions options = kMm;
    options.step_m = 1e-5;
    WriteFileAtomically(Temp(name), bytes);
    EXPECT_THAT([&] { ReadMapFile(Temp(name), options); }, AllOf(Fails(name), Fails(text)));
  };
  WriteMapFile(Hills(), Temp("whole.tif"), kMm);
  const std::string tiff = ReadFile(Temp("whole.tif"));
  fails("bad.tif", tiff.substr(0, tiff.size() - 400), "cut off");
  fails("bad.tif", "II*", "not a TIFF file");
  std::string torn = tiff;
  std::fill(torn.begin() + 40, torn.begin() + 400, 'x');
  fails("bad.tif", torn, "damaged or cut off");
  cv::imwrite(Temp("colour.tif"), cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3)));
  fails("bad.tif", ReadFile(Temp("colour.tif")), "3 channels of 8 bits");
  MapFileOptions range = kMm;
  range.low_m = 0, range.high_m = 0.1;
  WriteMapFile(Hills(), Temp("whole.png"), range);
  const std::string png = ReadFile(Temp("whole.png"));
  fails("bad.png", png.substr(0, png.size() / 2), "cut off");
  fails("bad.png", "", "not a PNG file");
  cv::imwrite(Temp("colour.png"), cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3)));
  fails("bad.png", ReadFile(Temp("colour.png")), "3 channels of 8 bits");
  fails("bad.npy", "\x93NUMPY", "cut off");
  WriteNpy<float>(Temp("cube.npy"), std::vector<float>(8), {2, 2, 2});
  EXPECT_THAT([] { ReadMapFile(Temp("cube.npy"), kMm); }, Fails("this array has rank 3"));
  WriteNpy<float>(Temp("hole.npy"), std::vector<float>(4, std::nanf("")), {2, 2});
  EXPECT_THAT([] { ReadMapFile(Temp("hole.npy"), kMm); }, Fails("the map is all hole"));
}

TEST(Tiff, NoDataOfOthersIsAHole) {
  TiffImage image{1, 3, {1, -9999, 3}, 0.5};
  WriteTiff(image, Temp("plain.tif"));
  const TiffImage again = ReadTiff(Temp("plain.tif"));
  EXPECT_EQ(again.values, image.values);
  EXPECT_EQ(again.pixel_size, 0.5);
  cv::imwrite(Temp("grey.tif"), cv::Mat(2, 3, CV_16U, cv::Scalar(700)));
  EXPECT_EQ(ReadTiff(Temp("grey.tif")).values, std::vector<float>(6, 700));
  EXPECT_FALSE(ReadTiff(Temp("grey.tif")).pixel_size);
}

}  // namespace
}  // namespace sandwright
