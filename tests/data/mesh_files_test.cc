#include "data/mesh_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/base/atomic_file.h"
#include "data/mesh_bytes.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }
std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

Mesh Read(const std::string& name, const std::string& bytes) {
  WriteFileAtomically(Temp(name), bytes);
  return ReadMesh(Temp(name));
}

// Hills of 40 x 30 cells with a hole in the middle and one at the edge.
HeightMap Hills() {
  HeightMap map(30, 40, 0.005);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = static_cast<float>(0.05 + 0.01 * std::sin(0.3 * row) * std::cos(0.2 * column));
  map.At(12, 20) = map.At(13, 20) = map.At(0, 5) = kNaN;
  return map;
}

void ExpectSame(const HeightMap& a, const HeightMap& b, double tolerance_m) {
  ASSERT_EQ(a.rows, b.rows);
  ASSERT_EQ(a.columns, b.columns);
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::isnan(a.height_m[i]), std::isnan(b.height_m[i])) << i;
    if (!std::isnan(a.height_m[i])) {
      ASSERT_NEAR(a.height_m[i], b.height_m[i], tolerance_m) << i;
    }
  }
}

TEST(MeshFiles, AMapComesBackFromEveryFormatWithItsHoles) {
  const HeightMap map = Hills();
  for (const double unit_m : {1.0, 0.001}) {
    Mesh mesh = MeshOf(map, "hills");
    for (Eigen::Vector3d& p : mesh.points) p /= unit_m;
    for (const char* name : {"hills.stl", "hills.obj", "hills.ply", "hills.xyz"}) {
      SCOPED_TRACE(name);
      WriteMesh(mesh, Temp(name));
      Mesh again = ReadMesh(Temp(name));
      for (Eigen::Vector3d& p : again.points) p *= unit_m;
      ExpectSame(map, HeightsOf(again, map.cell_size_m, name), 1e-8);
    }
  }
}

TEST(MeshFiles, TheHighestSurfaceCountsAndScatteredPointsAreGridded) {
  // A table over a floor, and the floor alone where the table is not.
  const Mesh mesh = Read("table.obj",
                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
                         "v 0 0 0.5\nv 0.5 0 0.5\nv 0.5 1 0.5\nv 0 1 0.5\nf -4 -3 -2 -1\n");
  const HeightMap map = HeightsOf(mesh, 0.1, "table");
  EXPECT_EQ(map.columns, 11);
  EXPECT_FLOAT_EQ(map.At(5, 2), 0.5f);
  EXPECT_FLOAT_EQ(map.At(5, 8), 0);
  std::string points;
  for (int i = 0; i < 4000; ++i) {
    const double x = std::fmod(i * 0.6180339887, 1), y = std::fmod(i * 0.7548776662, 1);
    points += std::to_string(x) + "; " + std::to_string(y) + "; " + std::to_string(0.1 * x) + "\n";
  }
  const HeightMap plane = HeightsOf(Read("plane.xyz", "# x y z\n" + points), 0.05, "plane");
  EXPECT_NEAR(plane.At(10, 10), 0.05, 2e-3);
}

TEST(MeshFiles, AsciiAndBigEndianFilesAreRead) {
  const Mesh stl = Read("a.stl",
                        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1\n"
                        "endloop\nendfacet\nendsolid a\n");
  EXPECT_EQ(stl.points.size(), 3u);
  EXPECT_EQ(stl.triangles.size(), 1u);
  const std::string head = " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\n"
                           "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_EQ(Read("a.ply", "ply\nformat ascii" + head + "0 0 1 9\n1 0 1 9\n0 1 2.5 9\n3 0 1 2\n").points[2].z(), 2.5);
  std::string body;
  const auto add = [&](auto value) {
    std::string bytes;
    Append(bytes, value);
    body.append(bytes.rbegin(), bytes.rend());
  };
  for (int i = 0; i < 3; ++i) add(static_cast<float>(i)), add(0.0f), add(2.5), add(uint8_t{9});
  add(uint8_t{3});
  for (int i : {0, 1, 2}) add(i);
  const Mesh big = Read("b.ply", "ply\nformat binary_big_endian" + head + body);
  EXPECT_EQ(big.points[2], Eigen::Vector3d(2, 0, 2.5));
  EXPECT_EQ(big.triangles.at(0)[2], 2u);
}

TEST(MeshFiles, DamagedFilesAreNamedWithThePlace) {
  const auto fails = [](const std::string& name, const std::string& bytes, const std::string& text) {
    EXPECT_THAT([&] { Read(name, bytes); }, ::testing::AllOf(Fails(name), Fails(text)));
  };
  WriteMesh(MeshOf(Hills(), "hills"), Temp("whole.stl"));
  const std::string stl = ReadFile(Temp("whole.stl"));
  fails("bad.stl", stl.substr(0, stl.size() / 2), "triangles need");
  fails("bad.stl", "", "cut off: 0 bytes");
  fails("bad.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 1\nvertex 1 0\n", "line 4: a vertex needs three numbers");
  fails("bad.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 1\nendfacet\nendsolid\n", "a facet with 1 corners");
  fails("bad.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 1\n", "cut off: no endsolid");
  fails("bad.stl", std::string(84, '\0'), "the mesh is empty");
  fails("bad.obj", "v 0 0\n", "line 1: a point (v) needs three numbers");
  fails("bad.obj", "v 0 0 0\nf 1 2 3\n", "line 2: face corner \"2\"; allowed: 1..1");
  fails("bad.obj", "v 0 0 0\nf 1 1\n", "a face (f) with 2 corners");
  fails("bad.obj", "v 0 0 inf\n", "line 1");
  fails("bad.obj", "# nothing\n", "the mesh is empty");
  WriteMesh(MeshOf(Hills(), "hills"), Temp("whole.ply"));
  const std::string ply = ReadFile(Temp("whole.ply"));
  fails("bad.ply", ply.substr(0, ply.size() - 5), "cut off");
  fails("bad.ply", ply.substr(0, 60), "no end_header");
  fails("bad.ply", "ply words", "no end_header");
  fails("bad.ply", "words", "not a PLY file");
  fails("bad.ply", "ply\nformat text 1.0\nend_header\n", "format \"text\"");
  fails("bad.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "no x, y and z");
  fails("bad.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 nan\n3 0 0 0\n",
        "point 0 is not finite");
  fails("bad.xyz", "1 2 3\n4 5\n", "line 2: a point needs three numbers");
  EXPECT_THAT([] { ReadMesh("none.stl"); }, Fails("none.stl: no such file"));
}

TEST(MeshFiles, AnExtentThatCannotBeMeantIsSaid) {
  const Mesh plate = Read("plate.obj", "v 0 0 0\nv 1200 0 0\nv 1200 800 0\nf 1 2 3\n");
  EXPECT_THAT([&] { HeightsOf(plate, 0.005, "plate.obj"); },
              Fails("plate.obj: 1200 x 800 m make 240001 x 160001 cells of 0.005 m"));
  EXPECT_THAT([&] { HeightsOf(plate, 2000, "plate.obj"); }, Fails("make 1 x 1 cells"));
}

}  // namespace
}  // namespace sandwright
