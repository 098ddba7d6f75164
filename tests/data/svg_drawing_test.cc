#include "data/svg_drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "data/base/atomic_file.h"
#include "data/svg_transform.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }
std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

SvgDrawing Read(const std::string& inside, const std::string& page = "width=\"100mm\" height=\"50mm\" viewBox=\"0 0 200 100\"") {
  WriteFileAtomically(Temp("d.svg"), "<svg " + page + ">" + inside + "</svg>");
  return ReadSvg(Temp("d.svg"));
}

double Area(const HeightMap& map, float height_m) {
  return map.cell_size_m * map.cell_size_m * static_cast<double>(std::ranges::count(map.height_m, height_m));
}

TEST(SvgPath, AllCommandsLeadWhereTheyShould) {
  const auto end = [](const std::string& d) { return ParseSvgPath(d, "d").back().points.back(); };
  EXPECT_EQ(end("M1,2 3,4"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(end("m1 2 l1-1h2v3"), Eigen::Vector2d(4, 4));
  EXPECT_EQ(end("M0 0C1 1 2 1 3 0s2-1 3 0"), Eigen::Vector2d(6, 0));
  EXPECT_EQ(end("M0 0Q1 1 2 0T4 0"), Eigen::Vector2d(4, 0));
  // The mirrored handle: the second wave lies below.
  EXPECT_NEAR(ParseSvgPath("M0 0Q1 1 2 0T4 0", "d")[0].points[48].y(), -0.5, 1e-12);
  // A half circle, its flags run together as some programs write them.
  const SvgLine arc = ParseSvgPath("M0 0a5 5 0 0110 0", "d")[0];
  for (const Eigen::Vector2d& p : arc.points) EXPECT_NEAR((p - Eigen::Vector2d(5, 0)).norm(), 5, 1e-9);
  EXPECT_LT(arc.points[16].y(), -4.9);  // sweep: by the top of the page
  const auto two = ParseSvgPath("M0 0h1v1zM5 5h1", "d");
  EXPECT_TRUE(two[0].closed);
  EXPECT_FALSE(two[1].closed);
  for (const char* bad : {"L1 1", "M1", "M0 0 X3", "M0 0 L1 nan", "M0 0a1 1 0 2 0 1 1", "5 5"})
    EXPECT_THAT([&] { ParseSvgPath(bad, "d.svg"); }, Fails("d.svg: the path cannot be read at")) << bad;
}

TEST(SvgTransform, ListsAndLengths) {
  const auto at = [](const std::string& text, double x, double y) {
    return Eigen::Vector2d(ParseSvgTransform(text, "t") * Eigen::Vector2d(x, y));
  };
  EXPECT_TRUE(at("translate(1,2) scale(2)", 1, 1).isApprox(Eigen::Vector2d(3, 4)));
  EXPECT_TRUE(at("rotate(90)", 1, 0).isApprox(Eigen::Vector2d(0, 1)));
  EXPECT_TRUE(at("rotate(180 1 1)", 0, 0).isApprox(Eigen::Vector2d(2, 2)));
  EXPECT_TRUE(at("matrix(1 0 0 2 5 6)", 1, 1).isApprox(Eigen::Vector2d(6, 8)));
  EXPECT_THAT([] { ParseSvgTransform("skewX(3)", "t"); }, Fails("allowed: translate, scale, rotate, matrix"));
  EXPECT_NEAR(SvgLengthMm("2.54cm").value(), 25.4, 1e-12);
  EXPECT_NEAR(SvgLengthMm("96px").value(), 25.4, 1e-12);
  EXPECT_FALSE(SvgLengthMm("100%"));
  EXPECT_FALSE(SvgLengthMm("7"));
}

TEST(SvgDrawing, AreasLinesAndDepths) {
  const SvgDrawing drawing = Read(
      "<title>t</title><g data-depth-mm='10' style='fill:none; stroke:#000; stroke-width:4'>"
      "<line x1='20' y1='20' x2='120' y2='20'/></g>"
      "<rect x='20' y='50' width='40' height='30' data-depth-mm='-5' id='r'/>"
      "<path d='M100 50h60v40h-60z M120 60h20v20h-20z' />");
  EXPECT_NEAR(drawing.unit_m.value(), 0.0005, 1e-12);
  EXPECT_EQ(drawing.shapes.size(), 3u);
  const HeightMap map = DrawSvg(drawing, 0.5, 20, "d.svg");
  EXPECT_EQ(map.columns, 400);
  EXPECT_EQ(map.rows, 200);
  EXPECT_FLOAT_EQ(map.At(200 - 41, 140), -0.010f);  // row 0 is the bottom of the page
  EXPECT_FLOAT_EQ(map.At(200 - 130, 80), 0.005f);
  EXPECT_FLOAT_EQ(map.At(2, 2), 0);
  EXPECT_FLOAT_EQ(map.At(200 - 140, 260), 0);  // in the hole of the frame
  EXPECT_NEAR(Area(map, -0.010f), 100 * 4 + 4 * std::numbers::pi, 25);
  EXPECT_NEAR(Area(map, 0.005f), 40 * 30, 40);
  EXPECT_NEAR(Area(map, -0.020f), 60 * 40 - 20 * 20, 100);
  EXPECT_THAT([&] { DrawSvg(drawing, 0.5, std::nullopt, "d.svg"); }, Fails("d.svg: a shape has no data-depth-mm"));
}

TEST(SvgDrawing, WhatIsNotReadIsNamed) {
  EXPECT_THAT([] { ReadSvg("none.svg"); }, Fails("none.svg: no such file"));
  EXPECT_THAT([] { Read("<text id='t'>SAND</text>"); }, Fails("<text t>: this element is not read; allowed: path, line"));
  EXPECT_THAT([] { Read("<use href='#a'/>"); }, Fails("<use >"));
  EXPECT_THAT([] { Read(""); }, Fails("the drawing is empty"));
  EXPECT_THAT([] { Read("<rect width='3' height='3' fill='none'/>"); }, Fails("nothing is filled or stroked"));
  EXPECT_THAT([] { Read("<rect width='3em' height='3'/>"); }, Fails("width = \"3em\""));
  EXPECT_THAT([] { Read("<rect width='3' height='3' data-depth-mm='deep'/>"); }, Fails("data-depth-mm = \"deep\""));
  EXPECT_THAT([] { Read("<rect width='3' height='3'/>", "width='100%'"); }, Fails("the drawing has no page"));
  EXPECT_THAT([] { Read("<circle r='3'"); }, Fails("not XML, or cut off"));
  WriteFileAtomically(Temp("h.svg"), "<html/>");
  EXPECT_THAT([] { ReadSvg(Temp("h.svg")); }, Fails("no element svg"));
}

}  // namespace
}  // namespace sandwright
