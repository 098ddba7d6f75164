#include "data/stroke.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/hdf5.h"
#include "data/stroke_dataset.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

auto Fails(const std::string& text) {
  return ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr(text)));
}
Stroke Make(std::vector<Eigen::Vector3d> points, int degree = 1) {
  return {std::move(points), degree, 0.1};
}
std::string Temp(const std::string& name) { return ::testing::TempDir() + "stroke_test_" + name; }

TEST(StrokeTest, BadStrokesAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d a(0.1, 0.1, 0.04), b(0.2, 0.1, 0.04);
  EXPECT_THAT([&] { CheckStroke(Make({a}), "s"); },
              Fails("s: control_points_m has 1 points; allowed: 2..4"));
  EXPECT_THAT([&] { CheckStroke(Make({a, b, a, b, a}), "s"); }, Fails("has 5 points"));
  EXPECT_THAT([&] { CheckStroke(Make({a, a}), "s"); }, Fails("points 0 and 1 are 0 m apart"));
  EXPECT_THAT(
      [&] {
        CheckStroke(Make({a, b, {0.2, nan, 0}}), "s");
      },
      Fails("point 2 is [0.2, nan, 0]"));
  EXPECT_THAT([&] { CheckStroke(Make({a, b}, 3), "s"); }, Fails("degree = 3"));
  Stroke still = Make({a, b});
  still.speed_mps = 0;
  EXPECT_THAT([&] { CheckStroke(still, "s"); }, Fails("speed_mps = 0"));
}

TEST(StrokeTest, LineIsSampledEvenlyWithItsEnds) {
  const ToolPath path = SamplePath(Make({{0, 0, 0.04}, {0.1, 0, 0.02}}), 0.03);
  ASSERT_EQ(path.size(), 5u);  // ceil(0.1 / 0.03) = 4 steps
  EXPECT_NEAR(path[1].x_m, 0.025, 1e-12);
  EXPECT_NEAR(path[1].z_m, 0.035, 1e-12);
  EXPECT_NEAR(path.back().x_m, 0.1, 1e-12);
  for (const BladePose& pose : path) EXPECT_EQ(pose.yaw_rad, 0);
}

TEST(StrokeTest, PolylineTurnsOnTheSpotTheShortWay) {
  const ToolPath path = SamplePath(Make({{0, 0, 0}, {0.1, 0, 0}, {0.1, -0.1, 0}}), 0.1, 0.5);
  // 0, corner; four turning poses of pi/8; the end.
  ASSERT_EQ(path.size(), 7u);
  EXPECT_NEAR(path[2].yaw_rad, -std::numbers::pi / 8, 1e-12);
  EXPECT_NEAR(path[2].x_m, 0.1, 1e-12);
  EXPECT_NEAR(path[5].yaw_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(path[6].y_m, -0.1, 1e-12);
}

TEST(StrokeTest, BezierKeepsSpacingAndTangents) {
  const Stroke curve = Make({{0, 0, 0.03}, {0.05, 0.08, 0.03}, {0.1, 0, 0.03}}, 2);
  const double step = 0.004;
  const ToolPath path = SamplePath(curve, step);
  EXPECT_NEAR(path.front().yaw_rad, std::atan2(0.08, 0.05), 1e-9);
  EXPECT_NEAR(path.back().yaw_rad, -std::atan2(0.08, 0.05), 1e-9);
  EXPECT_EQ(path.back().x_m, 0.1);
  for (size_t i = 1; i < path.size(); ++i)
    EXPECT_LE(std::hypot(path[i].x_m - path[i - 1].x_m, path[i].y_m - path[i - 1].y_m),
              step * 1.001);
  // Apex of a quadratic Bezier: half the control point's height.
  const auto apex = std::ranges::max_element(path, {}, &BladePose::y_m);
  EXPECT_NEAR(apex->y_m, 0.04, 1e-5);
}

TEST(StrokeTest, ClassesOfThePaper) {
  const Eigen::Vector3d a(0, 0, .04), b(.1, 0, .04), c(.1, .1, .04), d(0, .1, .04);
  const Eigen::Vector3d low(.1, 0, .02);
  EXPECT_EQ(ComplexityClass(Make({a, b})), 'A');
  EXPECT_EQ(ComplexityClass(Make({a, b}, 2)), 'A');  // a Bezier of two points is a line
  EXPECT_EQ(ComplexityClass(Make({a, b, c})), 'B');
  EXPECT_EQ(ComplexityClass(Make({a, low})), 'C');
  EXPECT_EQ(ComplexityClass(Make({a, low, c})), 'C');
  EXPECT_EQ(ComplexityClass(Make({a, b, c}, 2)), 'D');
  EXPECT_EQ(ComplexityClass(Make({a, low, c, d})), 'E');
  EXPECT_EQ(ComplexityClass(Make({a, low, c, d}, 2)), 'F');
}

TEST(StrokeTest, StrokeListsFromYaml) {
  const std::string head = "schema: sandwright-plan\nschema_version: 1\n";
  const std::string good = head +
                           "frame: box\nstrokes:\n  - {control_points_m: [[0.1, 0.1, 0.04], [0.2, "
                           "0.1, 0.03]], degree: 1, speed_mps: 0.1}\n";
  WriteFileAtomically(Temp("a.yaml"), good);
  const auto strokes = ReadStrokes(Temp("a.yaml"));
  ASSERT_EQ(strokes.size(), 1u);
  EXPECT_EQ(strokes[0].control_points_m[1].z(), 0.03);
  WriteFileAtomically(Temp("b.yaml"), head + "frame: world\nstrokes: []\n");
  EXPECT_THAT([&] { ReadStrokes(Temp("b.yaml")); }, Fails("frame is \"world\"; allowed: box"));
  WriteFileAtomically(Temp("c.yaml"), "strokes: []\n");
  EXPECT_THAT([&] { ReadStrokes(Temp("c.yaml")); }, Fails("expected sandwright-plan version 1"));
  WriteFileAtomically(Temp("d.yaml"), head +
                                          "frame: box\nstrokes:\n  - {control_points_m: [[0.1, "
                                          "0.1]], degree: 1, speed_mps: 0.1}\n");
  EXPECT_THAT([&] { ReadStrokes(Temp("d.yaml")); },
              Fails("strokes[0]: a control point needs 3 numbers"));
  WriteFileAtomically(Temp("e.yaml"),
                      head + "frame: box\nstrokes:\n  - {degree: 1, speed_mps: 0.1}\n");
  EXPECT_THAT([&] { ReadStrokes(Temp("e.yaml")); },
              Fails("strokes[0]: control_points_m has 0 points"));
}

StrokeFile SmallFile() {
  StrokeRecord record;
  record.before = HeightMap(4, 5, 0.01, 0.05f);
  record.after = record.before;
  record.after.At(1, 1) = 0.04f;
  record.stroke = Make({{0.01, 0.01, 0.04}, {0.03, 0.02, 0.04}});
  record.path = SamplePath(record.stroke, 0.005);
  record.replicate_of = "00000";
  record.time = "2026-03-01T12:00:00Z";
  record.stroke.speed_mps = 0.15;
  record.before.valid.assign(record.before.size(), 1);
  record.before.valid[3] = 0;
  StrokeFile file{"heightfield", "bed_7", 7, R"({"repose_deg": 33})", {record, record}};
  file.strokes[1].step = 1;
  file.workcell = "9c56cc51b374c3ba";
  return file;
}

TEST(StrokeDatasetTest, RoundTrip) {
  const StrokeFile file = SmallFile();
  WriteStrokeFile(file, Temp("a.h5"));
  const StrokeFile back = ReadStrokeFile(Temp("a.h5"));
  EXPECT_EQ(back.source, "heightfield");
  EXPECT_EQ(back.bed, "bed_7");
  EXPECT_EQ(back.material, file.material);
  ASSERT_EQ(back.strokes.size(), 2u);
  EXPECT_EQ(back.strokes[0].after.height_m, file.strokes[0].after.height_m);
  EXPECT_EQ(back.strokes[1].step, 1);
  EXPECT_EQ(back.strokes[0].path.size(), file.strokes[0].path.size());
  EXPECT_EQ(back.strokes[0].replicate_of, "00000");
  EXPECT_EQ(back.strokes[0].time, "2026-03-01T12:00:00Z");
  EXPECT_EQ(back.strokes[0].stroke.speed_mps, 0.15);
  EXPECT_EQ(back.strokes[0].before.valid, file.strokes[0].before.valid);
  EXPECT_TRUE(back.strokes[0].after.valid.empty());
  EXPECT_EQ(back.workcell, "9c56cc51b374c3ba");
}

TEST(StrokeDatasetTest, OptionalPartsMayBeMissing) {
  StrokeFile file = SmallFile();
  file.material = R"({"speed": 0.2})";
  WriteStrokeFile(file, Temp("bare.h5"));
  {
    H5::H5File h5(Temp("bare.h5"), H5F_ACC_RDWR);
    h5.removeAttr("bed");
    h5.removeAttr("workcell");
    const H5::Group group = h5.openGroup("/strokes/00000");
    for (const char* name : {"speed_mps", "replicate_of", "time"}) group.removeAttr(name);
    group.unlink("valid_before");
  }
  const StrokeFile back = ReadStrokeFile(Temp("bare.h5"));
  EXPECT_EQ(back.bed, "stroke_test_bare");           // the file is the bed
  EXPECT_EQ(back.strokes[0].stroke.speed_mps, 0.2);  // of the material
  EXPECT_EQ(back.strokes[0].time, std::nullopt);
  EXPECT_TRUE(back.strokes[0].before.valid.empty());
}

TEST(StrokeDatasetTest, SeedsKeepAllTheirBits) {
  StrokeFile file = SmallFile();
  file.seed = (int64_t{1} << 62) + 1;
  WriteStrokeFile(file, Temp("seed.h5"));
  EXPECT_EQ(ReadStrokeFile(Temp("seed.h5")).seed, file.seed);
}

TEST(StrokeDatasetTest, ForeignFilesAreRefusedByName) {
  EXPECT_THAT([] { ReadStrokeFile("missing.h5"); }, Fails("missing.h5: no such file"));
  WriteFileAtomically(Temp("text.h5"), "this is not HDF5");
  EXPECT_THAT([] { ReadStrokeFile(Temp("text.h5")); }, Fails("not an HDF5 file, or cut off"));
  WriteStrokeFile(SmallFile(), Temp("whole.h5"));
  const std::string bytes = ReadFile(Temp("whole.h5"));
  WriteFileAtomically(Temp("cut.h5"), bytes.substr(0, bytes.size() - 100));
  EXPECT_THAT([] { ReadStrokeFile(Temp("cut.h5")); }, Fails("cut off"));
  WriteHeightMap(HeightMap(2, 2, 0.01), Temp("map.h5"));
  EXPECT_THAT([] { ReadStrokeFile(Temp("map.h5")); },
              Fails("schema is \"sandwright-heightmap\"; expected \"sandwright-strokes\""));
}

TEST(StrokeDatasetTest, BadFilesNameTheGroup) {
  const auto write = [&](const char* name, const std::function<void(H5::H5File&)>& change) {
    WriteStrokeFile(SmallFile(), Temp(name));
    H5::H5File h5(Temp(name), H5F_ACC_RDWR);
    change(h5);
  };
  write("nan.h5", [](H5::H5File& f) {
    std::vector<float> heights(20, std::numeric_limits<float>::quiet_NaN());
    f.openDataSet("/strokes/00001/after_m").write(heights.data(), H5::PredType::NATIVE_FLOAT);
  });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("nan.h5")); },
              Fails("/strokes/00001/after_m: height_m at row 0"));
  write("infinite.h5", [](H5::H5File& f) {
    std::vector<float> heights(20, std::numeric_limits<float>::infinity());
    f.openDataSet("/strokes/00000/before_m").write(heights.data(), H5::PredType::NATIVE_FLOAT);
  });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("infinite.h5")); },
              Fails("/strokes/00000/before_m: height_m"));
  write("blade.h5", [](H5::H5File& f) {
    const double width_m = -0.05;
    f.openGroup("/strokes/00001")
        .openAttribute("blade_width_m")
        .write(H5::PredType::NATIVE_DOUBLE, &width_m);
  });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("blade.h5")); },
              Fails("/strokes/00001: the blade is -0.05 x"));
  write("point.h5", [](H5::H5File& f) {
    const std::vector<double> same = {0.01, 0.01, 0.04, 0.01, 0.01, 0.04};
    f.openDataSet("/strokes/00000/control_points_m")
        .write(same.data(), H5::PredType::NATIVE_DOUBLE);
  });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("point.h5")); },
              Fails("/strokes/00000: control points 0 and 1 are 0 m apart"));
  write("no_path.h5", [](H5::H5File& f) { f.unlink("/strokes/00000/path_m"); });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("no_path.h5")); },
              Fails("/strokes/00000: dataset path_m is missing"));
  write("no_strokes.h5", [](H5::H5File& f) { f.unlink("/strokes"); });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("no_strokes.h5")); }, Fails("/strokes is missing"));
  write("version.h5", [](H5::H5File& f) {
    const int64_t version = 9;
    f.openAttribute("schema_version").write(H5::PredType::NATIVE_INT64, &version);
  });
  EXPECT_THAT([&] { ReadStrokeFile(Temp("version.h5")); },
              Fails("schema_version of sandwright-strokes is 9"));
}

TEST(StrokeDatasetTest, ReadsTheShippedGrains) {
  const std::string folder = std::string(SANDWRIGHT_ROOT) + "/data/strokes/dem";
  const auto files = FindStrokeFiles({folder});
  ASSERT_EQ(files.size(), 15u);
  for (const auto& path : files) {
    const StrokeFile file = ReadStrokeFile(path);
    EXPECT_EQ(file.source, "dem");
    EXPECT_GE(file.strokes.size(), 2u);
    for (const StrokeRecord& record : file.strokes) {
      EXPECT_EQ(record.before.rows, file.bed.starts_with("dem_704") ? 300 : 150);
      // The sampled path of our own geometry follows the recorded one.
      const ToolPath own = SamplePath(record.stroke, 0.002);
      EXPECT_NEAR(own.front().x_m, record.path.front().x_m, 1e-6);
      EXPECT_NEAR(own.back().y_m, record.path.back().y_m, 1e-6);
      EXPECT_NEAR(
          std::remainder(own.back().yaw_rad - record.path.back().yaw_rad, 2 * std::numbers::pi), 0,
          0.03);
    }
  }
  EXPECT_THROW(FindStrokeFiles({"nowhere"}), Error);
}

// Of a rig's log the strokes alone, whatever other maps lie in it.
TEST(StrokeDatasetTest, FindsTheStrokesOfALog) {
  const std::string log = Temp("log");
  std::filesystem::create_directories(log + "/scans");
  for (const char* name : {"/strokes.h5", "/bed.h5", "/terrain.h5", "/scans/0000.h5"})
    WriteFileAtomically(log + name, "");
  EXPECT_EQ(FindStrokeFiles({log}), std::vector<std::filesystem::path>{log + "/strokes.h5"});
}

}  // namespace
}  // namespace sandwright
