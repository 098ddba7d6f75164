// `convert` and `goal` as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "data/base/atomic_file.h"
#include "data/height_map.h"
#include "data/stroke_dataset.h"
#include "data/task.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::Field;
using ::testing::HasSubstr;

class ConvertTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("convert_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    HeightMap bed(60, 80, 0.01);
    for (int row = 0; row < bed.rows; ++row)
      for (int column = 0; column < bed.columns; ++column)
        bed.At(row, column) = static_cast<float>(0.08 + 0.004 * std::sin(0.2 * row) * std::cos(0.15 * column));
    WriteHeightMap(bed, Path("bed.h5"));
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  // Runs in the test's folder. SANDWRIGHT_PROGRAM comes from CMake.
  Finished Invoke(const std::string& arguments) const {
    return Shell("cd " + folder_.string() + " && " SANDWRIGHT_PROGRAM " " + arguments);
  }
  void Done(const std::string& arguments) const {
    const Finished run = Invoke(arguments);
    ASSERT_EQ(run.exit_code, 0) << arguments << "\n" << run.output;
  }
  void Refused(const std::string& arguments, const std::string& text) const {
    EXPECT_THAT(Invoke(arguments), AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr(text)))) << arguments;
  }
  nlohmann::json Json(const std::string& name) const { return nlohmann::json::parse(ReadFile(Path(name))); }
  std::filesystem::path folder_;
};

TEST_F(ConvertTest, AMapGoesOutAndComesBack) {
  const HeightMap bed = ReadHeightMap(Path("bed.h5"));
  for (const auto& [name, flags] : {std::pair{"m.tif", "--unit mm"}, {"m.npy", "--unit m --cell-size 0.01"},
                                    {"m.stl", "--unit mm --cell-size 0.01"}, {"m.ply", "--unit m --cell-size 0.01"},
                                    {"m.png", "--range-mm 70 90 --cell-size 0.01"}}) {
    Done("convert bed.h5 " + std::string(name) + " " + flags);
    Done("convert " + std::string(name) + " back.h5 --datum floor " + flags + " --json r.json");
    const HeightMap back = ReadHeightMap(Path("back.h5"));
    ASSERT_TRUE(back.SameGrid(bed)) << name;
    EXPECT_EQ(back.datum, Datum::kFloor);
    for (size_t i = 0; i < bed.size(); ++i) ASSERT_NEAR(back.height_m[i], bed.height_m[i], 2e-7) << name;
    EXPECT_EQ(Json("r.json")["rows"], 60);
  }
}

TEST_F(ConvertTest, BadInputIsNamedAndReplacesNothing) {
  WriteFileAtomically(Path("out.h5"), "precious");
  WriteFileAtomically(Path("bad.stl"), "solid words");
  WriteFileAtomically(Path("bad.png"), "words");
  Refused("convert bed.h5 m.stl", "--unit is \"\"; allowed: mm, m");
  Refused("convert bad.stl out.h5 --unit mm --cell-size 0.01", "bad.stl: no STL file");
  Refused("convert bad.png out.h5 --mm-per-level 1 --cell-size 0.01", "bad.png: not a PNG file");
  Refused("convert none.tif out.h5 --unit mm", "none.tif: no such file");
  Refused("convert bed.h5 bed.docx", "no way from \"bed.h5\" to \"bed.docx\"; maps: .h5 .png");
  Refused("convert bed.h5 s.svg", "schema is \"sandwright-heightmap\"");
  EXPECT_EQ(ReadFile(Path("out.h5")), "precious");
  EXPECT_FALSE(std::filesystem::exists(Path("m.stl")));
}

TEST_F(ConvertTest, StrokesGoOutAndTablesComeBack) {
  WriteFileAtomically(Path("plan.yaml"),
                      "schema: sandwright-plan\nschema_version: 1\nframe: box\nstrokes:\n"
                      "  - {control_points_m: [[0.1, 0.1, 0.07], [0.2, 0.15, 0.06], [0.3, 0.1, 0.07]], degree: 2, speed_mps: 0.1}\n");
  for (const char* name : {"s.dxf", "s.svg", "s.csv", "s.yaml"}) Done("convert plan.yaml " + std::string(name));
  Done("convert s.csv again.yaml");
  EXPECT_EQ(ReadStrokes(Path("again.yaml")).at(0).control_points_m[1].y(), 0.15);
  Done("convert " SANDWRIGHT_ROOT "/data/strokes/dem/bed_504.h5 dem.csv --json r.json");
  EXPECT_GT(Json("r.json")["strokes"], 3);
  WriteFileAtomically(Path("data.csv"),
                      "stroke,x_mm,y_mm,z_mm,degree,speed_mps,before,after\n0,100,150,70,1,0.1,bed.h5,bed.h5\n0,200,150,70,1,0.1,,\n");
  Done("convert data.csv data.h5");
  EXPECT_EQ(ReadStrokeFile(Path("data.h5")).strokes.size(), 1u);
}

TEST_F(ConvertTest, GoalsFromEverySource) {
  cv::Mat grey = cv::Mat::zeros(60, 80, CV_8U);
  cv::circle(grey, {40, 30}, 15, cv::Scalar(255), cv::FILLED);
  cv::imwrite(Path("disc.png"), grey);
  WriteFileAtomically(Path("d.svg"),
                      "<svg viewBox='0 0 300 200' width='300mm' height='200mm'><rect x='60' y='60' width='180' height='80' data-depth-mm='20'/></svg>");
  WriteFileAtomically(Path("m.obj"), "v 0 0 0\nv 200 0 0\nv 200 200 0\nv 0 200 0\nv 100 100 30\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
  HeightMap before = ReadHeightMap(Path("bed.h5"));
  before.At(30, 40) += 0.01f;
  WriteHeightMap(before, Path("before.h5"));
  const std::string common =
      " goal.free_spread_m=0 --terrain bed.h5 --out g.h5 --picture g.png --json r.json";
  for (const char* source : {"--image disc.png --range-mm 0 25", "--svg d.svg", "--mesh m.obj --unit mm --rotate-deg 30 --at 0.4 0.3",
                             "--scan before.h5", "--shape mound --rise-mm 20", "--mesh m.obj --unit m --size 0.3"}) {
    Done("goal " + std::string(source) + common);
    CheckTask({ReadHeightMap(Path("bed.h5")), ReadGoal(Path("g_feasible.h5")), 5}, source);
    const auto json = Json("r.json");
    EXPECT_NEAR(json["feasible"]["volume_missing_cm3"].get<double>(), 0, 0.5) << source;
    EXPECT_EQ(json["feasible"]["steep_share"], 0) << source;
    EXPECT_TRUE(ReadFile(Path("g.png")).starts_with("\x89PNG"));
  }
  Done("goal --scan before.h5" + common);  // to undo: cell by cell
  EXPECT_EQ(ReadGoal(Path("g.h5")).height_m, before.height_m);
  Done("goal --shape trench --terrain bed.h5 --out t.h5 --feasible f.h5");
  Done("tasks --terrain bed.h5 --goal f.h5 --vary --count 4 --seed 2 --out set.h5 vary.turn_deg=20");
  EXPECT_EQ(ReadTasks(Path("set.h5")).size(), 4u);
}

TEST_F(ConvertTest, WishesThatCannotBeReadAreNamed) {
  WriteFileAtomically(Path("m.obj"), "v 0 0 0\nv 200 0 0\nv 200 200 0\nf 1 2 3\n");
  WriteFileAtomically(Path("empty.obj"), "# nothing\n");
  WriteFileAtomically(Path("t.svg"), "<svg viewBox='0 0 9 9'><text>a</text></svg>");
  WriteFileAtomically(Path("u.svg"), "<svg viewBox='0 0 9 9'><rect width='5' height='5'/></svg>");
  const std::string common = " --terrain bed.h5 --out g.h5";
  Refused("goal" + common, "goal needs one of --image, --mesh, --svg, --scan and --shape");
  Refused("goal --mesh m.obj" + common, "m.obj: it carries no unit; --unit mm or --unit m is needed");
  Refused("goal --mesh m.obj --unit m" + common, "m.obj: 200 x 200 m, and the box is 0.8 x 0.6 m; is the unit right");
  Refused("goal --mesh empty.obj --unit m" + common, "empty.obj: the mesh is empty");
  Refused("goal --mesh m.obj --unit mm --up up" + common, "--up up is no axis");
  Refused("goal --svg t.svg" + common, "this element is not read");
  Refused("goal --svg u.svg --depth-mm 5" + common, "it carries no unit");
  Refused("goal --svg u.svg --size 0.2" + common, "--depth-mm is not given");
  Refused("goal --image none.png --range-mm 0 5" + common, "none.png: no such file");
  Refused("goal --shape cube" + common, "goal kind \"cube\" is unknown");
  Refused("goal --scan none.h5" + common, "none.h5");
  EXPECT_FALSE(std::filesystem::exists(Path("g.h5")));
}

}  // namespace
}  // namespace sandwright
