// Strokes to and from the files of others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/npy.h"
#include "data/stroke_drawing.h"
#include "data/stroke_import.h"
#include "data/stroke_table.h"
#include "data/svg_drawing.h"
#include "tests/support/zip.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }
std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

const std::vector<Stroke> kStrokes = {
    {{{0.1, 0.2, 0.03}, {0.2, 0.2, 0.04}, {0.2, 0.1, 0.05}}, 1, 0.1},
    {{{0.1, 0.1, 0.05}, {0.15, 0.15, 0.04}, {0.2, 0.15, 0.03}, {0.25, 0.1, 0.05}}, 2, 0.05}};

TEST(StrokeTable, ComesBackAsItWas) {
  WriteStrokeTable(kStrokes, Temp("s.csv"));
  const std::vector<StrokeRow> rows = ReadStrokeTable(Temp("s.csv"));
  ASSERT_EQ(rows.size(), 2u);
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].stroke.degree, kStrokes[i].degree);
    EXPECT_EQ(rows[i].stroke.speed_mps, kStrokes[i].speed_mps);
    ASSERT_EQ(rows[i].stroke.control_points_m.size(), kStrokes[i].control_points_m.size());
    for (size_t k = 0; k < kStrokes[i].control_points_m.size(); ++k)
      EXPECT_LT((rows[i].stroke.control_points_m[k] - kStrokes[i].control_points_m[k]).norm(), 1e-12);
  }
}

TEST(StrokeTable, BadLinesAreNamed) {
  const auto fails = [](const std::string& text, const std::string& message) {
    WriteFileAtomically(Temp("bad.csv"), text);
    EXPECT_THAT([] { ReadStrokeTable(Temp("bad.csv")); }, Fails(message));
  };
  const std::string head = "stroke,x_mm,y_mm,z_mm,degree,speed_mps\n";
  fails("a,b\n", "no column \"stroke\"");
  fails(head, "it holds no strokes");
  fails(head + "0,1,2,three,1,0.1\n", "line 2: z_mm is \"three\"; a number is needed");
  fails(head + "0,1,2\n", "line 2: degree is \"\"");
  fails(head + "0,1,2,3,1,0.1\n", "stroke 0: control_points_m has 1 points");
  fails(head + "0,1,2,3,1,0.1\n0,9,2,3,1,0.1\n1,1,2,3,7,0.1\n1,9,2,3,7,0.1\n", "stroke 1: degree = 7");
}

TEST(StrokeDrawing, DxfHoldsOnePolylineAStrokeInMm) {
  WriteStrokesDxf(kStrokes, Temp("s.dxf"));
  const std::string text = ReadFile(Temp("s.dxf"));
  EXPECT_THAT(text, HasSubstr("$INSUNITS\n70\n4\n"));
  EXPECT_THAT(text, HasSubstr("VERTEX\n8\nSTROKES\n10\n200.0000\n20\n100.0000\n30\n50.0000\n70\n32\n"));
  EXPECT_TRUE(text.ends_with("0\nSEQEND\n8\nSTROKES\n0\nENDSEC\n0\nEOF\n"));
  size_t polylines = 0;
  for (size_t at = 0; (at = text.find("\nPOLYLINE\n", at)) != std::string::npos; ++at) ++polylines;
  EXPECT_EQ(polylines, 2u);
}

TEST(StrokeDrawing, SvgKeepsCurvesAndPlaces) {
  WriteStrokesSvg(kStrokes, {}, Temp("s.svg"));
  EXPECT_THAT(ReadFile(Temp("s.svg")), HasSubstr("M100.0000,-100.0000 C150.0000,-150.0000 200.0000,-150.0000 250.0000,-100.0000"));
  const SvgDrawing drawing = ReadSvg(Temp("s.svg"));
  EXPECT_NEAR(drawing.unit_m.value(), 0.001, 1e-9);
  EXPECT_NEAR(drawing.width, 250, 1e-6);  // 100 to 250 mm and a blade's width around
  ASSERT_EQ(drawing.shapes.size(), 2u);
  EXPECT_EQ(drawing.shapes[0].stroke_width, 50);
}

// An archive of two strokes on one bed of 2 x 3 cells, `left_out` missing.
void WriteNpz(const std::string& left_out, size_t maps_after = 2) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ZipMember> members;
  const auto add = [&](const std::string& name, const std::vector<double>& values, const std::vector<size_t>& shape) {
    if (name == left_out) return;
    WriteNpy<double>(Temp("member.npy"), values, shape);
    const std::string npy = ReadFile(Temp("member.npy"));
    members.push_back({name + ".npy", npy, npy.size(), 0});
  };
  const std::vector<double> beds = {0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.04, 0.05, 0.06, 0.05, 0.05, 0.05,
                                    0.04, 0.04, 0.06, 0.06, 0.05, 0.05};
  add("before_m", {beds.begin(), beds.begin() + 12}, {2, 2, 3});
  add("after_m", {beds.begin() + 6, beds.begin() + 6 + 6 * static_cast<int64_t>(maps_after)}, {maps_after, 2, 3});
  add("control_points_m", {0.1, 0.1, 0.04, 0.2, 0.1, 0.04, nan, nan, nan,  //
                           0.1, 0.2, 0.04, 0.2, 0.2, 0.03, 0.2, 0.1, 0.04},
      {2, 3, 3});
  add("degree", {1, 2}, {2});
  add("speed_mps", {0.1, 0.05}, {2});
  add("cell_size_m", {0.1}, {});
  WriteFileAtomically(Temp("data.npz"), Zip(members));
}

TEST(StrokeImport, NpzBecomesSequences) {
  WriteNpz("nothing");
  const StrokeFile content = ReadStrokesNpz(Temp("data.npz"), {}, Datum::kRelative, {});
  ASSERT_EQ(content.strokes.size(), 2u);
  EXPECT_EQ(content.strokes[0].after.rows, 2);
  EXPECT_EQ(content.strokes[0].after.height_m[2], 0.06f);
  EXPECT_EQ(content.strokes[0].stroke.control_points_m.size(), 2u);  // lines of NaN fill up
  EXPECT_EQ(content.strokes[1].stroke.control_points_m.size(), 3u);
  EXPECT_EQ(content.strokes[1].stroke.speed_mps, 0.05);
  EXPECT_EQ(content.strokes[1].sequence, 0);
  EXPECT_EQ(content.strokes[1].step, 1);  // its bed is the one that the first left
}

TEST(StrokeImport, NpzNamesWhatIsMissing) {
  const auto read = [](std::optional<double> cell_size_m) {
    return [=] { ReadStrokesNpz(Temp("data.npz"), {}, Datum::kRelative, cell_size_m); };
  };
  EXPECT_THAT([] { ReadStrokesNpz(Temp("none.npz"), {}, Datum::kRelative, 0.01); }, Fails("none.npz: no such file"));
  for (const std::string name : {"before_m", "after_m", "control_points_m", "degree", "speed_mps", "cell_size_m"}) {
    WriteNpz(name);
    EXPECT_THAT(read({}), Fails(name)) << name;
  }
  EXPECT_NO_THROW(read(0.1)());  // told beside the file
  WriteNpz("nothing", 1);
  EXPECT_THAT(read({}), Fails("after_m"));
}

TEST(StrokeImport, CsvNamesItsMaps) {
  HeightMap bed(30, 30, 0.01, 0.05f), after = bed;
  after.At(15, 15) = 0.04f;
  WriteHeightMap(bed, Temp("bed.h5"));
  WriteHeightMap(after, Temp("after.h5"));
  WriteFileAtomically(Temp("data.csv"),
                      "stroke,x_mm,y_mm,z_mm,degree,speed_mps,before,after\n"
                      "a,100,150,40,1,0.1,bed.h5,after.h5\na,200,150,40,1,0.1,,\n"
                      "b,100,150,40,1,0.1,after.h5,bed.h5\nb,200,150,40,1,0.1,,\n");
  const StrokeFile content = ReadStrokesCsv(Temp("data.csv"), {}, {});
  ASSERT_EQ(content.strokes.size(), 2u);
  EXPECT_EQ(content.strokes[1].step, 1);
  EXPECT_EQ(content.strokes[1].sequence, 0);
  EXPECT_EQ(content.strokes[0].after.height_m, after.height_m);
  EXPECT_EQ(nlohmann::json::parse(content.material)["datum"], "relative");
  WriteStrokeFile(content, Temp("data.h5"));
  EXPECT_EQ(ReadStrokeFile(Temp("data.h5")).source, "imported");
  WriteFileAtomically(Temp("data.csv"),
                      "stroke,x_mm,y_mm,z_mm,degree,speed_mps\na,100,150,40,1,0.1\na,200,150,40,1,0.1\n");
  EXPECT_THAT([] { ReadStrokesCsv(Temp("data.csv"), {}, {}); }, Fails("both must name height map files"));
}

}  // namespace
}  // namespace sandwright
