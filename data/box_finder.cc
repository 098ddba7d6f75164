#include "data/box_finder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/level_image.h"

namespace sandwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kRays = 360;
constexpr double kVoteWindow_m = 0.016;
constexpr const char* kSideNames[4] = {"x = 0", "x = width", "y = 0", "y = depth"};

// A rectangle in L: the axes e, f at `angle` and the extents along them.
struct Rectangle {
  double angle = 0;
  std::array<double, 4> side{};  // lowest and highest along e, lowest and highest along f
  double score = -std::numeric_limits<double>::infinity();  // outline met less outline missed [m]

  Vector2d e() const { return {std::cos(angle), std::sin(angle)}; }
  Vector2d f() const { return {-std::sin(angle), std::cos(angle)}; }
  double extent(int axis) const {
    const auto a = static_cast<size_t>(2 * axis);
    return side[a + 1] - side[a];
  }
};

// A stretch of a side that one ray saw: its position across the side and its length [m].
struct Vote {
  double position, length;
};

// The position around which the votes cover most, and the length that they cover.
Vote DensestPosition(std::vector<Vote>& votes) {
  std::ranges::sort(votes, {}, &Vote::position);
  Vote best{0, 0};
  double length = 0;
  for (size_t low = 0, high = 0; low < votes.size(); length -= votes[low++].length) {
    while (high < votes.size() && votes[high].position - votes[low].position <= kVoteWindow_m)
      length += votes[high++].length;
    if (length > best.length) best = {votes[(low + high - 1) / 2].position, length};
  }
  return best;
}

// The rectangle around `seed` of whose outline the `edges` (where rays from the seed ended) cover
// most; covered length counts for it, the rest of the outline against it.
Rectangle VoteForRectangle(const std::vector<Vector2d>& edges, const Vector2d& seed) {
  Rectangle best;
  for (int degree = 0; degree < 90; ++degree) {
    Rectangle candidate;
    candidate.angle = degree * std::numbers::pi / 180;
    double covered = 0;
    bool closed = true;
    for (size_t side = 0; side < 4; ++side) {
      const Vector2d direction = side < 2 ? candidate.e() : candidate.f();
      std::vector<Vote> votes;
      for (const Vector2d& edge : edges) {
        const Vector2d ray = edge - seed;
        const double towards = (side % 2 == 0 ? -1 : 1) * direction.dot(ray);
        // A ray that grazes the side (by less than 15 degrees) says little about where it is.
        if (towards > 0.26 * ray.norm())
          votes.push_back({direction.dot(edge), ray.squaredNorm() / towards * 2 * std::numbers::pi / kRays});
      }
      const Vote densest = DensestPosition(votes);
      candidate.side[side] = densest.position;
      covered += densest.length;
      closed = closed && densest.length > 0;
    }
    if (!closed) continue;
    candidate.score = 2 * covered - 2 * (candidate.extent(0) + candidate.extent(1));
    if (candidate.score > best.score) best = candidate;
  }
  return best;
}

Rectangle SearchFromSeeds(const LevelImage& image, const BoxFinderConfig& config) {
  Rectangle best;
  for (int seed = 0; seed < 9; ++seed) {
    // The middle of the picture and eight places around it: one of them sees the sand.
    const auto width = static_cast<double>(image.camera.width);
    const auto height = static_cast<double>(image.camera.height);
    const Vector2d pixel(width * (2 + seed % 3) / 6, height * (2 + seed / 3) / 6);
    const Eigen::Vector3f* start = image.At(pixel);
    if (!start->allFinite()) continue;
    std::vector<Vector2d> edges;
    for (int ray = 0; ray < kRays; ++ray) {
      const double angle = ray * 2 * std::numbers::pi / kRays;
      const double reach = width + height;
      const Vector2d end = pixel + reach * Vector2d(std::cos(angle), std::sin(angle));
      const auto walk = ReadingsAlong(image, pixel, end);
      for (size_t i = 1; i + 1 < walk.size(); ++i) {
        if (SteepnessAt(walk, i) < config.wall_slope) continue;
        edges.push_back(walk[i].head<2>().cast<double>());
        break;
      }
    }
    const Rectangle found = VoteForRectangle(edges, start->head<2>().cast<double>());
    if (found.score > best.score) best = found;
  }
  return best;
}

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
    else if (side.rise_m < config.min_wall_rise_m)
      reasons.push_back(fmt::format("the edge at {} rises {:.0f} mm above the sand; a wall rises at "
                                    "least {:.0f} mm",
                                    kSideNames[i], 1000 * side.rise_m, 1000 * config.min_wall_rise_m));
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
  // Each round levels by the sand that the last one found; three settle a tilt of 10 degrees.
  for (int round = 0; round < 3; ++round) {
    const LevelImage image(cloud, camera, up_C);
    rectangle = SearchFromSeeds(image, config);
    std::vector<Eigen::Vector3f> sand = PointsInside(image, rectangle);
    if (sand.size() < 100)
      return {std::nullopt, {"no surface that steep edges enclose on four sides was found"}};
    const Plane plane = FitPlane(sand);
    const auto height = [&] {
      const Vector2d middle = 0.5 * ((rectangle.side[0] + rectangle.side[1]) * rectangle.e() +
                                     (rectangle.side[2] + rectangle.side[3]) * rectangle.f());
      return plane.offset + plane.slope_x * middle.x() + plane.slope_y * middle.y();
    };
    sand_L = height();
    if (round < 2 && !known_up_C) {
      const Vector3d up_L = Vector3d(-plane.slope_x, -plane.slope_y, 1).normalized();
      up_C = image.R_LC.transpose() * up_L;
      continue;
    }
    // The first pass turns the scan lines square to the walls, the second reads them.
    for (int pass = 0; pass < 2; ++pass) sides = Refine(image, sand_L, config, rectangle);
    break;
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
