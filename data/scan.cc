#include "data/scan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "data/gridding.h"
#include "data/point_cloud.h"

namespace sandwright {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDegree = std::numbers::pi / 180;
// Readings this close to a wall are mixed with it (in pixels), and left to the cells' planes.
constexpr double kWallMargin_px = 1.5;
// Sand within this height of its level may be seen by pixels that look this far beyond the box.
constexpr double kSandSlack_m = 0.15;

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Frame B on the box that was found, with z along `up_C`: turned about the middle of the sand, so
// that the walls' feet stay where they are as nearly as they can.
Eigen::Isometry3d PoseInBox(const FoundBox& box, const Vector3d& up_C) {
  const Vector3d along = box.X_CB.linear().col(0);
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  const Vector3d x = (along - along.dot(up_C) * up_C).normalized();
  X_CB.linear() << x, up_C.cross(x), up_C;
  const Vector3d middle(box.width_m / 2, box.depth_m / 2, 0);
  X_CB.translation() = box.X_CB * middle - X_CB.linear() * middle;
  return X_CB.inverse();
}

// The vertical in C that `level` asks for. Reasons are added where it cannot be had.
Vector3d Vertical(const PointCloud& cloud, const FoundBox& box, const std::string& level,
                  std::vector<std::string>& reasons) {
  if (level == "none") return -Vector3d::UnitZ();
  const Eigen::Isometry3d X_BC = box.X_CB.inverse();
  std::vector<Vector3f> points_B;
  if (level == "sand") {
    const double margin = 0.02;
    for (const Vector3f& p_C : cloud.points_m) {
      const Vector3f p = (X_BC.cast<float>() * p_C);
      if (p.x() > margin && p.x() < box.width_m - margin && p.y() > margin && p.y() < box.depth_m - margin)
        points_B.push_back(p);
    }
  } else {
    int walls = 0;
    for (const BoxSide& side : box.sides) {
      walls += !side.rim_C.empty();
      for (const Vector3f& p_C : side.rim_C) points_B.push_back(X_BC.cast<float>() * p_C);
    }
    if (walls < 3) {
      reasons.push_back(fmt::format("the rim of {} walls is in view; levelling by it needs 3", walls));
      return box.X_CB.linear().col(2);
    }
  }
  if (points_B.size() < 12) {
    reasons.push_back(fmt::format(
        "{} readings show what is to be made level; at least 12 are needed", points_B.size()));
    return box.X_CB.linear().col(2);
  }
  const Plane plane = FitPlane(points_B);
  return box.X_CB.linear() * Vector3d(-plane.slope_x, -plane.slope_y, 1).normalized();
}

// Standard deviation of a single reading from second differences along the rows, r = z0 - (z- + z+)/2
// with variance 3/2 sigma^2: slopes cancel, and readings beyond four deviations (edges) are left out
// until that settles.
double NoiseOf(const std::vector<double>& second_differences) {
  double limit = std::numeric_limits<double>::infinity(), deviation = 0;
  for (int round = 0; round < 10; ++round) {
    double squares = 0;
    size_t count = 0;
    for (double r : second_differences)
      if (std::abs(r) <= limit) squares += r * r, ++count;
    if (count == 0) return 0;
    deviation = std::sqrt(squares / static_cast<double>(count));
    limit = 4 * deviation;
  }
  return deviation / std::sqrt(1.5);
}

// Where the box is.
struct Place {
  Eigen::Isometry3d X_BC;
  Eigen::Isometry3d X_VC;  // V: the box as its walls stand; differs from B in what is level
  Eigen::Vector2d size_m;
  double sand_V = 0;  // height of the sand; without a pose V's and B's zero is there
};

// Readings of the frame that lie in the box, in B.
struct Inside {
  std::vector<Vector3f> points_B;
  double invalid_share = 0;
  double noise_m = 0;
};

Inside ReadingsInside(const DepthFrame& frame, const DepthFrame& median, const CameraModel& camera,
                      const Place& place, double pixel_m, double corner_margin_m) {
  const auto &X_BC = place.X_BC, &X_VC = place.X_VC;
  const Eigen::Vector2d& size_m = place.size_m;
  const double sand_V = place.sand_V;
  const PointCloud cloud = ToPoints(WithoutFlyingPixels(frame, median, 0.03), camera);
  const std::vector<PixelRay> rays = PixelRays(camera);
  const Vector3d eye = X_VC.translation();
  const double margin = kWallMargin_px * pixel_m;
  Inside inside;
  std::vector<double> differences;
  size_t pixels = 0, invalid = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    // Whether the pixel looks into the box is asked at the sand's height: invalid ones have no point.
    const Vector3d ray = X_VC.linear() * Vector3d(rays[i].x, rays[i].y, 1);
    const Vector3d at = eye + (sand_V - eye.z()) / ray.z() * ray;
    const auto within = [&](double x, double y, double m) {
      return x > m && x < size_m.x() - m && y > m && y < size_m.y() - m;
    };
    if (within(at.x(), at.y(), margin)) {
      ++pixels;
      invalid += !(frame.depth_m[i] > 0);
    }
    const Vector3f& p_C = cloud.points_m[i];
    if (!p_C.allFinite()) continue;
    const Vector3f p = X_VC.cast<float>() * p_C;
    // High things beside the box lie over it in plan only because the camera sees them from its middle.
    const double slack = std::abs(p.z() - sand_V) < kSandSlack_m ? kSandSlack_m : 0;
    if (!within(p.x(), p.y(), margin) || !within(at.x(), at.y(), -slack)) continue;
    const double to_x = std::min<double>(p.x(), size_m.x() - p.x()), to_y = std::min<double>(p.y(), size_m.y() - p.y());
    if (std::hypot(to_x, to_y) < corner_margin_m) continue;
    inside.points_B.push_back(X_BC.cast<float>() * p_C);
    if (i > 0 && i + 1 < rays.size() && within(at.x(), at.y(), 0.03)) {
      const float before = frame.depth_m[i - 1], after = frame.depth_m[i + 1];
      if (before > 0 && after > 0) differences.push_back(p_C.z() - 0.5 * (before + after));
    }
  }
  inside.invalid_share = pixels == 0 ? 1 : static_cast<double>(invalid) / static_cast<double>(pixels);
  inside.noise_m = NoiseOf(differences);
  return inside;
}

// Shifts the heights to the datum that is known.
void SetDatum(HeightMap& map, const std::optional<double>& sand_depth_m) {
  const double mean = std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
                      static_cast<double>(map.size());
  const auto shift = static_cast<float>(sand_depth_m.value_or(0) - mean);
  for (float& h : map.height_m) h += shift;
  map.datum = sand_depth_m ? Datum::kFloor : Datum::kRelative;
}

// Judges and closes the holes, then the surface.
void FinishMap(const ScanConfig& config, ScanResult& result) {
  const Holes holes = MeasureHoles(result.map);
  result.interpolated_share = holes.share;
  if (result.invalid_share > config.max_invalid_share)
    result.reasons.push_back(fmt::format("{:.0f} % of the box gave no reading; at most {:.0f} % are allowed",
                                         100 * result.invalid_share, 100 * config.max_invalid_share));
  if (holes.share > config.max_interpolated_share)
    result.reasons.push_back(fmt::format("{:.0f} % of the cells were not seen; at most {:.0f} % are "
                                         "interpolated",
                                         100 * holes.share, 100 * config.max_interpolated_share));
  if (holes.largest_m > config.max_hole_m)
    result.reasons.push_back(fmt::format("a hole reaches {:.0f} mm from the nearest reading; at most "
                                         "{:.0f} mm are interpolated",
                                         1000 * holes.largest_m, 1000 * config.max_hole_m));
  if (holes.share >= 1) {
    result.map = {};
    return;
  }
  FillHoles(result.map);
  for (std::string& reason : ReasonsNotSand(result.map, config.sand))
    result.reasons.push_back(std::move(reason));
}

// Struck-off sand and the floor of an empty box look alike; nothing but a flatness that no sand
// keeps tells.
void WarnOfABoard(ScanResult& result) {
  double sum = 0, squares = 0;
  for (const float h : result.map.height_m) sum += h, squares += h * h;
  const auto count = static_cast<double>(result.map.size());
  const double deviation_mm =
      1000 * std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
  if (deviation_mm < result.noise_mm)
    result.warnings.push_back(
        fmt::format("the surface is flat to {:.2f} mm, less than a reading's noise of {:.2f} mm: "
                    "is the box empty?",
                    deviation_mm, result.noise_mm));
}

void CheckTilt(const ScanConfig& config, ScanResult& result) {
  if (result.tilt_removed_deg > config.max_tilt_deg)
    result.reasons.push_back(fmt::format("the {} is tilted by {:.1f} degrees; at most {:.1f} are removed",
                                         config.level, result.tilt_removed_deg, config.max_tilt_deg));
}

// The worst distance in plan between the corners found and those of the pose's box.
double RegistrationError(const FoundBox& found, const Eigen::Isometry3d& X_BC, const Eigen::Vector2d& size_m) {
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(0, 0), Eigen::Vector2d(size_m.x(), 0),
                                                  size_m, Eigen::Vector2d(0, size_m.y())};
  double worst = 0;
  for (const Vector3d& corner_C : found.corners_C()) {
    const Eigen::Vector2d p = (X_BC * corner_C).head<2>();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& corner : corners) nearest = std::min(nearest, (p - corner).norm());
    worst = std::max(worst, nearest);
  }
  return worst;
}

// Takes the box from the given pose; the walls in view only check it.
void UsePose(const BoxSearch& search, const ScanConfig& config, const ScanPlace& place, ScanResult& result) {
  if (!search.box || !search.reasons.empty()) {
    result.warnings.push_back("the walls could not check the camera's pose: " +
                              (search.reasons.empty() ? "no box found" : search.reasons.front()));
    return;
  }
  result.registration_error_m = RegistrationError(*search.box, *place.X_BC, *place.box_size_m);
  if (*result.registration_error_m > config.max_registration_m)
    result.reasons.push_back(fmt::format("a corner of the walls lies {:.0f} mm from where the camera's pose "
                                         "puts it; at most {:.0f} mm are allowed",
                                         1000 * *result.registration_error_m, 1000 * config.max_registration_m));
}

void CheckPlace(const ScanPlace& place) {
  if (place.X_BC && !place.box_size_m)
    throw Error("the camera's pose is given without the box's size");
  const bool longer_first = !place.box_size_m || place.X_BC || place.box_size_m->x() >= place.box_size_m->y();
  if (place.box_size_m && !(place.box_size_m->minCoeff() > 0 && longer_first))
    throw Error(fmt::format("box size {} x {} m: both must be > 0, and the longer side comes first",
                            place.box_size_m->x(), place.box_size_m->y()));
  if (place.sand_depth_m && !(*place.sand_depth_m > 0 && *place.sand_depth_m < 10))
    throw Error(fmt::format("sand depth {} m; allowed: > 0 and < 10", *place.sand_depth_m));
  if (place.X_BC && place.sand_depth_m)
    throw Error("both the camera's pose and the sand's depth are given: each sets the zero; give one");
}

// By the given pose, or by what is seen; empty where no box is in view.
std::optional<Place> Locate(const PointCloud& cloud, const CameraModel& camera, const ScanConfig& config,
                            const ScanPlace& given, ScanResult& result) {
  if (given.X_BC) {
    const Vector3d up_C = given.X_BC->linear().transpose().col(2);
    const BoxSearch search = FindBox(cloud, camera, up_C, config.box);
    UsePose(search, config, given, result);
    const double sand_B = search.box ? (*given.X_BC * search.box->X_CB.translation()).z() : 0;
    return Place{*given.X_BC, *given.X_BC, *given.box_size_m, sand_B};
  }
  const BoxSearch search = FindBox(cloud, camera, std::nullopt, config.box, given.box_size_m);
  result.reasons = search.reasons;
  if (!search.box) return std::nullopt;
  for (const BoxSide& side : search.box->sides)
    if (side.rival_m > 0)
      result.warnings.push_back(fmt::format("a wall is not clear: a second straight edge runs {:.0f} mm inside of "
                                            "it; state the box's size to be sure",
                                            1000 * side.rival_m));
  const Vector3d up_C = Vertical(cloud, *search.box, config.level, result.reasons);
  result.tilt_removed_deg = std::acos(std::clamp(-up_C.z(), -1.0, 1.0)) / kDegree;
  CheckTilt(config, result);
  return Place{PoseInBox(*search.box, up_C),
               search.box->X_CB.inverse(),
               {search.box->width_m, search.box->depth_m},
               0};
}

// The readings in the box, one view's behind another's, and the pixels' size on the sand.
struct Readings {
  std::vector<Vector3f> points_B;
  double pixel_m = 0;
};

void AddReadings(const DepthFrame& frame, const DepthFrame& median, const CameraModel& camera,
                 const ScanConfig& config, const Place& place, Readings& readings, ScanResult& result) {
  const double pixel_m = (place.X_BC.translation().z() - place.sand_V) / camera.fx_px;
  const Inside inside = ReadingsInside(frame, median, camera, place, pixel_m, config.corner_margin_m);
  result.invalid_share = std::max(result.invalid_share, inside.invalid_share);
  result.noise_mm = std::max(result.noise_mm, 1000 * inside.noise_m);
  readings.pixel_m = std::max(readings.pixel_m, pixel_m);
  readings.points_B.insert(readings.points_B.end(), inside.points_B.begin(), inside.points_B.end());
}

// On whole cells; the map is centred on the box, which it misses by half a cell at most.
void FillMap(Readings readings, const Eigen::Vector2d& size_m, const ScanConfig& config, ScanResult& result) {
  const double cell_m = config.cell_size_m;
  const int columns = static_cast<int>(std::lround(size_m.x() / cell_m)),
            rows = static_cast<int>(std::lround(size_m.y() / cell_m));
  if (rows < 2 || columns < 2)
    throw Error(fmt::format("cell_size_m = {} leaves {} x {} cells in a box of {:.3f} x {:.3f} m; at least 2 x 2 are needed",
                            cell_m, columns, rows, size_m.x(), size_m.y()));
  const Vector3f to_map(static_cast<float>(0.5 * (columns * cell_m - size_m.x())),
                        static_cast<float>(0.5 * (rows * cell_m - size_m.y())), 0);
  for (Vector3f& p : readings.points_B) p += to_map;
  result.map =
      GridPoints(readings.points_B, rows, columns, cell_m, std::max(1.2 * cell_m, 1.8 * readings.pixel_m));
}

}  // namespace

ScanResult ScanDepth(std::span<const DepthFrame> frames, const CameraModel& camera, const ScanConfig& config,
                     const ScanPlace& given) {
  const auto start = std::chrono::steady_clock::now();
  CheckPlace(given);
  const DepthFrame frame = FuseFrames(frames), median = MedianFiltered(frame);
  ScanResult result;
  if (const auto place = Locate(ToPoints(median, camera), camera, config, given, result)) {
    Readings readings;
    AddReadings(frame, median, camera, config, *place, readings, result);
    FillMap(std::move(readings), place->size_m, config, result);
    FinishMap(config, result);
    if (result.map.size() > 0) WarnOfABoard(result);
    if (given.X_BC)
      result.map.datum = Datum::kFloor;
    else if (result.map.size() > 0)
      SetDatum(result.map, given.sand_depth_m);
    const double w = place->size_m.x(), d = place->size_m.y(), z = place->sand_V;
    const Eigen::Isometry3d X_CB = place->X_BC.inverse();
    result.corners_C = {X_CB * Vector3d(0, 0, z), X_CB * Vector3d(w, 0, z), X_CB * Vector3d(w, d, z),
                        X_CB * Vector3d(0, d, z)};
  }
  result.accepted = result.reasons.empty();
  result.seconds = SecondsSince(start);
  return result;
}

ScanResult ScanViews(std::span<const DepthView> views, const CameraModel& camera, const ScanConfig& config,
                     const Eigen::Vector2d& box_size_m) {
  SAND_CHECK(!views.empty());
  const auto start = std::chrono::steady_clock::now();
  ScanResult result;
  Readings readings;
  for (const DepthView& view : views) {
    const DepthFrame frame = FuseFrames(view.frames), median = MedianFiltered(frame);
    const auto before = std::exchange(result.registration_error_m, std::nullopt);
    const Place place =
        Locate(ToPoints(median, camera), camera, config, {.box_size_m = box_size_m, .X_BC = view.X_BC}, result).value();
    if (before) result.registration_error_m = std::max(*before, result.registration_error_m.value_or(0));
    AddReadings(frame, median, camera, config, place, readings, result);
  }
  FillMap(std::move(readings), box_size_m, config, result);
  FinishMap(config, result);
  result.map.datum = Datum::kFloor;
  result.accepted = result.reasons.empty();
  result.seconds = SecondsSince(start);
  return result;
}

ScanResult ScanHeights(const NpyArray& heights, double unit_m, const ScanConfig& config,
                       const std::optional<double>& sand_depth_m) {
  const auto start = std::chrono::steady_clock::now();
  CheckPlace({std::nullopt, std::nullopt, sand_depth_m});
  if (heights.shape.size() != 2)
    throw Error(fmt::format("a height array has rank 2; this one has rank {}", heights.shape.size()));
  if (heights.shape[0] < 2 || heights.shape[1] < 2)
    throw Error(fmt::format("a height array has at least 2 x 2 cells; this one has {} x {}",
                            heights.shape[0], heights.shape[1]));
  if (config.level == "rim")
    throw Error("level = rim is not possible with a height array: the walls are not in it; allowed: sand, none");
  ScanResult result;
  HeightMap& map = result.map;
  map = HeightMap(static_cast<int>(heights.shape[0]), static_cast<int>(heights.shape[1]), config.cell_size_m);
  map.valid.assign(map.size(), 0);
  const double scale = config.heights_positive == "up" ? unit_m : -unit_m;
  std::vector<Vector3f> points;
  for (size_t i = 0; i < map.size(); ++i) {
    const double h = heights.values[i] * scale;
    if (std::isinf(h)) throw Error(fmt::format("the height array holds {} at element {}", h, i));
    if (std::isnan(h)) continue;
    map.height_m[i] = static_cast<float>(h);
    map.valid[i] = 1;
    points.emplace_back(static_cast<float>((static_cast<int>(i) % map.columns + 0.5) * config.cell_size_m),
                        static_cast<float>((static_cast<int>(i) / map.columns + 0.5) * config.cell_size_m),
                        map.height_m[i]);
  }
  result.invalid_share = 1 - static_cast<double>(points.size()) / static_cast<double>(map.size());
  std::vector<double> differences;
  for (size_t i = 1; i + 1 < map.size(); ++i)
    if (map.valid[i - 1] && map.valid[i] && map.valid[i + 1] && i % heights.shape[1] != 0 &&
        (i + 1) % heights.shape[1] != 0)
      differences.push_back(map.height_m[i] - 0.5 * (map.height_m[i - 1] + map.height_m[i + 1]));
  result.noise_mm = 1000 * NoiseOf(differences);
  if (config.level == "sand" && points.size() >= 3) {
    const Plane plane = FitPlane(points);
    result.tilt_removed_deg = plane.tilt_rad() / kDegree;
    CheckTilt(config, result);
    for (int row = 0; row < map.rows; ++row)
      for (int column = 0; column < map.columns; ++column)
        map.At(row, column) -= static_cast<float>((plane.slope_x * (column + 0.5) + plane.slope_y * (row + 0.5)) *
                                                  config.cell_size_m);
  }
  FinishMap(config, result);
  if (map.size() > 0) SetDatum(map, sand_depth_m);
  result.accepted = result.reasons.empty();
  result.seconds = SecondsSince(start);
  return result;
}

}  // namespace sandwright
