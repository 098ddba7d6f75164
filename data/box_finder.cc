#include "data/box_finder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/box_growth.h"
#include "data/level_image.h"

namespace sandwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRimTolerance_m = 0.015;  // a real rim is bent by light, too
constexpr const char* kSideNames[4] = {"x = 0", "x = width", "y = 0", "y = depth"};

// Places the rectangle's sides and angle by the scan lines across them.
std::array<BoxSide, 4> Refine(const LevelImage& image, double sand_L, const BoxFinderConfig& config,
                              Rectangle& box) {
  std::array<BoxSide, 4> sides;
  std::array<Vector2d, 4> middle;  // of each side, in L
  double turn_sum = 0, weight_sum = 0;
  for (size_t side = 0; side < 4; ++side) {
    const bool is_x = side < 2;
    const double sign = side % 2 == 0 ? -1 : 1;
    SideGuess guess;
    guess.outward = sign * (is_x ? box.e() : box.f());
    guess.along = is_x ? box.f() : box.e();
    guess.position_m = sign * box.side[side];
    guess.low_m = box.side[is_x ? 2 : 0];
    guess.high_m = box.side[is_x ? 3 : 1];
    guess.inside_m = std::min(0.12, 0.3 * box.extent(is_x ? 0 : 1));
    guess.sand_m = sand_L;
    sides[side] = ReadSide(image, guess, config.wall_slope);
    middle[side] = 0.5 * (guess.low_m + guess.high_m) * guess.along +
                   sides[side].position_m * guess.outward;
    // A side x = const that leans outwards by an angle turns the box by minus that, and so on.
    sides[side].lean_rad *= (is_x ? -1 : 1) * sign;
    const double weight = sides[side].support * (guess.high_m - guess.low_m);
    turn_sum += weight * sides[side].lean_rad;
    weight_sum += weight;
  }
  const double turn = weight_sum > 0 ? turn_sum / weight_sum : 0;
  box.angle += turn;
  for (size_t side = 0; side < 4; ++side) {
    sides[side].lean_rad -= turn;
    box.side[side] = (side < 2 ? box.e() : box.f()).dot(middle[side]);
  }
  return sides;
}

// Turns the rectangle by quarters until e is the longer side and points to the right of the picture.
void Orient(Rectangle& box, std::array<BoxSide, 4>& sides) {
  const auto quarter = [&] {  // e' = f, f' = -e
    box.angle += std::numbers::pi / 2;
    box.side = {box.side[2], box.side[3], -box.side[1], -box.side[0]};
    std::array<BoxSide, 4> turned = {std::move(sides[2]), std::move(sides[3]), std::move(sides[1]),
                                     std::move(sides[0])};
    sides = std::move(turned);
  };
  if (box.extent(0) < box.extent(1)) quarter();
  // L's x is the picture's right and its y the picture's up (z points at the camera).
  const double right = std::cos(box.angle), down = -std::sin(box.angle);
  if (right < -1e-9 || (std::abs(right) <= 1e-9 && down < 0)) quarter(), quarter();
}

std::vector<std::string> Verdict(const Rectangle& box, const std::array<BoxSide, 4>& sides,
                                 const BoxFinderConfig& config) {
  std::vector<std::string> reasons;
  for (size_t i = 0; i < 4; ++i) {
    const BoxSide& side = sides[i];
    if (side.support < config.min_wall_support)
      reasons.push_back(fmt::format("the wall at {} was met on {:.0f} % of its length; at least "
                                    "{:.0f} % are needed",
                                    kSideNames[i], 100 * side.support, 100 * config.min_wall_support));
    else if (side.rise_m < config.min_wall_rise_m || side.rise_m > config.max_wall_rise_m)
      reasons.push_back(
          fmt::format("the edge at {} rises {:.0f} mm above the sand; a wall rises by "
                      "{:.0f} to {:.0f} mm",
                      kSideNames[i], 1000 * side.rise_m, 1000 * config.min_wall_rise_m,
                      1000 * config.max_wall_rise_m));
    const double skew_deg = std::abs(side.lean_rad) * 180 / std::numbers::pi;
    if (skew_deg > config.max_skew_deg)
      reasons.push_back(fmt::format("the edge at {} is turned by {:.1f} degrees against the others; "
                                    "at most {:.1f} are allowed",
                                    kSideNames[i], skew_deg, config.max_skew_deg));
  }
  if (std::min(box.extent(0), box.extent(1)) < config.min_side_m)
    reasons.push_back(fmt::format("the enclosed area is {:.3f} x {:.3f} m; a box has sides of at "
                                  "least {:.3f} m",
                                  box.extent(0), box.extent(1), config.min_side_m));
  return reasons;
}

// Gives the rectangle the size that the user stated, about its middle.
void TakeKnownSize(const Vector2d& size_m, Rectangle& box, std::vector<std::string>& reasons) {
  for (int axis = 0; axis < 2; ++axis) {
    const double found = box.extent(axis), known = size_m[axis];
    const double limit = 0.02 * known + 0.010;
    if (std::abs(found - known) > limit)
      reasons.push_back(fmt::format("the box found measures {:.0f} mm along {}, the stated size is "
                                    "{:.0f} mm; they may differ by {:.0f} mm",
                                    1000 * found, axis == 0 ? "x" : "y", 1000 * known, 1000 * limit));
    const auto low = static_cast<size_t>(2 * axis);
    const double middle = 0.5 * (box.side[low] + box.side[low + 1]);
    box.side[low] = middle - 0.5 * known;
    box.side[low + 1] = middle + 0.5 * known;
  }
}

// The readings inside the rectangle, in L.
std::vector<Eigen::Vector3f> PointsInside(const LevelImage& image, const Rectangle& box) {
  std::vector<Eigen::Vector3f> inside;
  for (const Eigen::Vector3f& p : image.points_L) {
    if (!p.allFinite()) continue;
    const Vector2d xy = p.head<2>().cast<double>();
    const double x = box.e().dot(xy), y = box.f().dot(xy);
    if (x > box.side[0] && x < box.side[1] && y > box.side[2] && y < box.side[3]) inside.push_back(p);
  }
  return inside;
}

// The vertical in C: the normal of the walls' rim, which sand may slope against as it likes; of the
// sand's plane where fewer than three walls show a rim or theirs is no plane.
Vector3d VerticalOf(const LevelImage& image, const std::array<BoxSide, 4>& sides,
                    const Plane& sand) {
  std::vector<Eigen::Vector3f> rim;
  int walls = 0;
  for (const BoxSide& side : sides) {
    walls += side.rim_C.size() >= 4;
    for (const Eigen::Vector3f& p_C : side.rim_C) rim.push_back(image.R_LC.cast<float>() * p_C);
  }
  Plane plane = sand;
  if (walls >= 3) {
    const Plane fit = FitPlane(rim);
    const auto near = std::ranges::count_if(rim, [&](const Eigen::Vector3f& p) {
      return std::abs(p.z() - fit.slope_x * p.x() - fit.slope_y * p.y() - fit.offset) <
             kRimTolerance_m;
    });
    if (3 * near >= 2 * static_cast<std::ptrdiff_t>(rim.size())) plane = fit;
  }
  return image.R_LC.transpose() * Vector3d(-plane.slope_x, -plane.slope_y, 1).normalized();
}

}  // namespace

std::array<Vector3d, 4> FoundBox::corners_C() const {
  return {X_CB * Vector3d(0, 0, 0), X_CB * Vector3d(width_m, 0, 0),
          X_CB * Vector3d(width_m, depth_m, 0), X_CB * Vector3d(0, depth_m, 0)};
}

BoxSearch FindBox(const PointCloud& cloud, const CameraModel& camera,
                  const std::optional<Vector3d>& known_up_C, const BoxFinderConfig& config,
                  const std::optional<Vector2d>& known_size_m) {
  Vector3d up_C = known_up_C.value_or(-Vector3d::UnitZ());
  Rectangle rectangle;
  std::array<BoxSide, 4> sides;
  double sand_L = 0;
  AngleRange angles;
  // Each round takes the vertical from what the last one found; two settle a tilt of 10 degrees.
  for (int round = 0; round < 3; ++round) {
    const LevelImage image(cloud, camera, up_C);
    const auto grown = GrowRectangle(image, angles, config.wall_slope, config.min_side_m);
    rectangle = grown.value_or(Rectangle{});
    const std::vector<Eigen::Vector3f> sand = PointsInside(image, rectangle);
    if (sand.size() < 100)
      return {std::nullopt, {"no surface that steep edges enclose on four sides was found"}};
    const Plane plane = FitPlane(sand);
    const Vector2d middle = 0.5 * ((rectangle.side[0] + rectangle.side[1]) * rectangle.e() +
                                   (rectangle.side[2] + rectangle.side[3]) * rectangle.f());
    sand_L = plane.offset + plane.slope_x * middle.x() + plane.slope_y * middle.y();
    // The first pass turns the scan lines square to the walls, the second reads them.
    for (int pass = 0; pass < 2; ++pass) sides = Refine(image, sand_L, config, rectangle);
    if (round == 2 || known_up_C) break;
    up_C = VerticalOf(image, sides, plane);
    angles = {rectangle.angle - 3 * std::numbers::pi / 180, 7};
  }
  Orient(rectangle, sides);
  BoxSearch search;
  search.reasons = Verdict(rectangle, sides, config);
  if (known_size_m) TakeKnownSize(*known_size_m, rectangle, search.reasons);

  FoundBox box;
  box.width_m = rectangle.extent(0);
  box.depth_m = rectangle.extent(1);
  box.sides = std::move(sides);
  Eigen::Isometry3d X_LB = Eigen::Isometry3d::Identity();
  X_LB.linear() = Eigen::AngleAxisd(rectangle.angle, Vector3d::UnitZ()).toRotationMatrix();
  const Vector2d corner = rectangle.side[0] * rectangle.e() + rectangle.side[2] * rectangle.f();
  X_LB.translation() = Vector3d(corner.x(), corner.y(), sand_L);
  box.X_CB = Eigen::Isometry3d(LevelRotation(up_C).transpose()) * X_LB;
  search.box = std::move(box);
  return search;
}

}  // namespace sandwright
