#include "cli/goal_request.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "data/drawing.h"
#include "data/mesh_files.h"
#include "data/svg_drawing.h"
#include "env/goals.h"

namespace sandwright {
namespace {

constexpr double kRadian = std::numbers::pi / 180, kMargin_m = 0.03;
constexpr int kFiner = 4;  // drawings are drawn on cells so much finer than the terrain's

double UnitSize(const std::string& unit, const std::string& source) {
  if (unit == "mm") return 1e-3;
  if (unit == "m") return 1;
  throw Error(source + ": it carries no unit; --unit mm or --unit m is needed");
}

// The widest that keeps the shape of `width` x `depth` in the box.
double FittingWidth(double width, double depth, const HeightMap& terrain) {
  return width * std::min(terrain.width_m() / width, terrain.depth_m() / depth);
}

HeightMap ShapeOfImage(const GoalRequest& request, const HeightMap& terrain) {
  if (request.range_mm.size() != 2)
    throw Error("--image needs --range-mm LOW HIGH: the heights of black and of white [mm]");
  cv::Mat grey = ReadDrawing(request.image);
  const double width_m = request.size_m.value_or(FittingWidth(grey.cols, grey.rows, terrain));
  const double shrink = kFiner * width_m / terrain.cell_size_m / grey.cols;  // finer detail would alias
  const cv::Size coarser(std::max(2, static_cast<int>(grey.cols * shrink)), std::max(1, static_cast<int>(grey.rows * shrink)));
  if (shrink < 1) cv::resize(grey, grey, coarser, 0, 0, cv::INTER_AREA);
  HeightMap shape(grey.rows, grey.cols, width_m / grey.cols);
  const double low_m = request.range_mm[0] / 1000, high_m = request.range_mm[1] / 1000;
  for (int row = 0; row < shape.rows; ++row)  // a picture has its first row at the top
    for (int column = 0; column < shape.columns; ++column)
      shape.At(row, column) =
          static_cast<float>(low_m + (high_m - low_m) * grey.at<float>(shape.rows - 1 - row, column));
  return shape;
}

// The turn that brings the axis `up` upwards.
Eigen::Matrix3d Upright(const std::string& up) {
  static const std::map<std::string, std::array<double, 9>> kTurns = {
      {"z", {1, 0, 0, 0, 1, 0, 0, 0, 1}},  {"-z", {1, 0, 0, 0, -1, 0, 0, 0, -1}},
      {"y", {1, 0, 0, 0, 0, -1, 0, 1, 0}}, {"-y", {1, 0, 0, 0, 0, 1, 0, -1, 0}},
      {"x", {0, 0, -1, 0, 1, 0, 1, 0, 0}}, {"-x", {0, 0, 1, 0, 1, 0, -1, 0, 0}}};
  if (!kTurns.contains(up)) throw Error("--up " + up + " is no axis; allowed: x, y, z, -x, -y, -z");
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kTurns.at(up).data());
}

HeightMap ShapeOfMesh(const GoalRequest& request, const HeightMap& terrain) {
  Mesh mesh = ReadMesh(request.mesh);
  const double unit_m = UnitSize(request.unit, request.mesh);
  const Eigen::Matrix3d turn = Upright(request.up);
  for (Eigen::Vector3d& p : mesh.points) p = unit_m * (turn * p);
  Eigen::Vector3d extent = Bounds(mesh)[1] - Bounds(mesh)[0];
  if (request.size_m) {
    if (!(extent.x() > 0)) throw Error(request.mesh + ": it has no width that --size could scale");
    const double scale = *request.size_m / extent.x();
    for (Eigen::Vector3d& p : mesh.points) p *= scale;
    extent *= scale;
  }
  CheckWishExtent(extent.x(), extent.y(), terrain, request.mesh);
  return HeightsOf(mesh, terrain.cell_size_m / kFiner, request.mesh);
}

HeightMap ShapeOfSvg(const GoalRequest& request, const HeightMap& terrain) {
  const SvgDrawing drawing = ReadSvg(request.svg);
  double unit_m = 0;
  if (request.size_m) {
    unit_m = *request.size_m / drawing.width;
  } else {
    unit_m = drawing.unit_m ? *drawing.unit_m
                            : UnitSize(request.unit, request.svg + " (its width names no mm, cm or in; or give --size)");
  }
  CheckWishExtent(drawing.width * unit_m, drawing.height * unit_m, terrain, request.svg);
  HeightMap shape = DrawSvg(drawing, terrain.cell_size_m / kFiner / unit_m, request.depth_mm, request.svg);
  shape.cell_size_m *= unit_m;
  return shape;
}

// Its holes and what its mask leaves out are no part of it.
HeightMap ShapeOfScan(const GoalRequest& request) {
  HeightMap scan = ReadHeightMap(request.scan, /*nan_allowed=*/true);
  for (size_t i = 0; i < scan.size(); ++i)
    if ((!scan.valid.empty() && !scan.valid[i]) || (!scan.mask.empty() && !scan.mask[i]))
      scan.height_m[i] = std::nanf("");
  scan.valid.clear();
  scan.mask.clear();
  if (std::ranges::all_of(scan.height_m, [](float h) { return std::isnan(h); }))
    throw Error(request.scan + ": the scan is all hole");
  return scan;
}

// A shape by name counts to 30 mm beyond its foot.
HeightMap ShapeOfNamed(const GoalRequest& request, const HeightMap& terrain) {
  if (request.size_m) throw Error("--size is not for --shape; its measures are --rise-mm, --flat-mm and --length-mm");
  GoalShape shape{.kind = ParseGoalKind(request.shape), .x_m = terrain.width_m() / 2, .y_m = terrain.depth_m() / 2,
                  .heading_rad = request.turn_deg * kRadian, .half_length_m = request.length_mm / 2000,
                  .half_width_m = request.flat_mm / 2000, .rise_m = request.rise_mm / 1000};
  if (!request.at_m.empty()) shape.x_m = request.at_m[0], shape.y_m = request.at_m[1];
  HeightMap map = terrain;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const double x_m = (column + 0.5) * map.cell_size_m, y_m = (row + 0.5) * map.cell_size_m;
      const bool counts = DistanceToFoot(shape, x_m, y_m) <= kMargin_m;
      map.At(row, column) = counts ? static_cast<float>(ShapeHeight(shape, x_m, y_m)) : std::nanf("");
    }
  }
  return map;
}

// Height in B of the shape's zero.
double Zero(const GoalRequest& request, const HeightMap& shape, const HeightMap& terrain) {
  const bool absolute = !request.scan.empty() && shape.datum == Datum::kFloor && terrain.datum == Datum::kFloor;
  const std::string zero = request.zero.empty() ? (absolute ? "floor" : "sand") : request.zero;
  if (zero != "floor" && zero != "sand") throw Error("--zero " + zero + " is not known; allowed: sand, floor");
  if (zero == "sand") return MeanCounted(terrain) - (request.scan.empty() ? 0 : MeanCounted(shape));
  if (terrain.datum != Datum::kFloor)
    throw Error("--zero floor: the terrain's datum is relative, its floor is not known; allowed: sand");
  return 0;
}

}  // namespace

Wish MakeWish(const GoalRequest& request, const HeightMap& terrain) {
  const std::string* sources[] = {&request.image, &request.mesh, &request.svg, &request.scan, &request.shape};
  if (std::ranges::count_if(sources, [](const std::string* s) { return !s->empty(); }) != 1)
    throw Error("goal needs one of --image, --mesh, --svg, --scan and --shape");
  const HeightMap shape = !request.image.empty()  ? ShapeOfImage(request, terrain)
                          : !request.mesh.empty() ? ShapeOfMesh(request, terrain)
                          : !request.svg.empty()  ? ShapeOfSvg(request, terrain)
                          : !request.scan.empty() ? ShapeOfScan(request)
                                                  : ShapeOfNamed(request, terrain);
  WishPlace place{.height_scale = 1, .zero_m = Zero(request, shape, terrain) + request.lift_mm / 1000};
  if (request.shape.empty()) {  // a shape by name is at its place already
    if (!request.at_m.empty()) place.at_m = Eigen::Vector2d(request.at_m[0], request.at_m[1]);
    place.turn_rad = request.turn_deg * kRadian;
    if (!request.scan.empty() && request.size_m) place.scale = *request.size_m / shape.width_m();
  }
  const std::string name = **std::ranges::find_if(sources, [](const std::string* s) { return !s->empty(); });
  return PlaceWish(shape, place, terrain, name);
}

}  // namespace sandwright
