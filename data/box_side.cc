#include "data/box_side.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "data/steepness_plan.h"

namespace sandwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kStretches = 16;
constexpr int kLinesPerStretch = 8;
constexpr double kBin_m = 0.001;
constexpr double kStep_m = 0.012;           // widest step between sand and wall
constexpr double kBeyond_m = 0.04;          // how far beyond the expected side the wall is looked for
constexpr double kWallReach_m = 0.12;       // and its rim
constexpr double kLineTolerance_m = 0.008;  // two to three pixels of a Kinect at 1.2 m
constexpr double kEdgeContrast = 0.15;      // of an edge to what lies beside it [m/m]
constexpr int kBeside = 18;                 // this many bins away
constexpr double kBank_m = 0.04;  // the sand inside of a wall that its foot is compared with
constexpr double kTurns_deg = 1;  // the vote for the rectangle knows its angle to half a degree

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// One reading of a scan line: how far out it lies, how steep the surface is there, and where the foot
// of a wall would be that begins there.
struct Reading {
  double out, steepness, foot;
};

std::vector<Reading> ScanLine(const std::vector<Eigen::Vector3f>& walk, const Vector2d& outward,
                              double pixel_m) {
  std::vector<Reading> line;
  const auto out = [&](size_t i) { return outward.dot(walk[i].head<2>().cast<double>()); };
  for (size_t i = 1; i + 1 < walk.size(); ++i) {
    // The break is the larger of the two steps, half a pixel behind the last reading on sand: wall
    // readings themselves may lie anywhere in the light that bright sand throws on them.
    const bool first =
        std::abs(walk[i].z() - walk[i - 1].z()) > std::abs(walk[i + 1].z() - walk[i].z());
    line.push_back({out(i), SteepnessAt(walk, i), out(first ? i - 1 : i) + 0.5 * pixel_m});
  }
  return line;
}

// For each bin of kBin_m from `start` on, the steepness that half of the scan lines reach there;
// then the steepest of those within a pixel and a half (walls are not straight to a pixel). In this
// order: the steepest of single readings is noise, which makes sand at rest as steep as a wall.
// NaN: fewer than half of the lines saw it.
std::vector<double> StretchSteepness(const std::vector<std::vector<Reading>>& lines, double start,
                                     double length, double pixel_m) {
  const int bins = static_cast<int>(length / kBin_m);
  std::vector<std::vector<double>> seen(static_cast<size_t>(bins));
  std::vector<double> steepest(static_cast<size_t>(bins));
  for (const auto& line : lines) {
    std::ranges::fill(steepest, -1);
    for (const Reading& reading : line) {
      const double low = (reading.out - 0.5 * pixel_m - start) / kBin_m;
      const double high = (reading.out + 0.5 * pixel_m - start) / kBin_m + 1;
      for (int k = std::max(0, static_cast<int>(low)); k < std::min<double>(bins, high); ++k)
        steepest[static_cast<size_t>(k)] =
            std::max(steepest[static_cast<size_t>(k)], reading.steepness);
    }
    for (size_t k = 0; k < steepest.size(); ++k)
      if (steepest[k] >= 0) seen[k].push_back(steepest[k]);
  }
  std::vector<double> medians;
  for (auto& values : seen)
    medians.push_back(2 * values.size() < lines.size() ? std::nan("") : Median(std::move(values)));
  std::vector<double> result(medians.size(), std::nan(""));
  const int reach = static_cast<int>(std::lround(pixel_m / kBin_m));
  for (int k = 0; k < bins; ++k)
    for (int near = std::max(k - reach, 0); near <= std::min(k + reach, bins - 1); ++near)
      result[static_cast<size_t>(k)] =
          std::fmax(result[static_cast<size_t>(k)], medians[static_cast<size_t>(near)]);
  return result;
}

// Sixteen to a side; medians over its scan lines, since a single line's noise reaches the difference
// between steep sand and a wall that is seen in the light of bright sand.
struct Stretch {
  double along = 0;  // its middle
  std::vector<std::vector<Vector3f>> walks;
  std::vector<std::vector<Reading>> lines;
  std::vector<double> steepness;  // by bins from the start of the scan lines
};

std::vector<Stretch> ReadStretches(const LevelImage& image, const SideGuess& guess,
                                   double pixel_m) {
  std::vector<Stretch> stretches(kStretches);
  for (int k = 0; k < kStretches; ++k) {
    Stretch& stretch = stretches[static_cast<size_t>(k)];
    // The corners themselves (posts, tags, heaps) are left out.
    const auto place = [&](double line) {
      const double share = 0.05 + 0.9 * (k + (line + 0.5) / kLinesPerStretch) / kStretches;
      return guess.low_m + (guess.high_m - guess.low_m) * share;
    };
    stretch.along = place(0.5 * (kLinesPerStretch - 1));
    for (int line = 0; line < kLinesPerStretch; ++line) {
      const auto pixel = [&](double offset) {
        const Vector2d xy = place(line) * guess.along + (guess.position_m + offset) * guess.outward;
        return image.Pixel({xy.x(), xy.y(), guess.sand_m});
      };
      stretch.walks.push_back(ReadingsAlong(image, pixel(-guess.inside_m), pixel(kWallReach_m)));
      stretch.lines.push_back(ScanLine(stretch.walks.back(), guess.outward, pixel_m));
    }
    stretch.steepness = StretchSteepness(stretch.lines, guess.position_m - guess.inside_m,
                                         guess.inside_m + kBeyond_m, pixel_m);
  }
  return stretches;
}

// across = offset + slope * along.
struct Line {
  double slope = 0, offset = 0;
  std::vector<size_t> inliers;
  double spread = 0;
};

// Mean steepness of the side along a line that passes bin `bin` at `centre`; NaN where fewer than half
// of the stretches see it.
double LineSteepness(const std::vector<Stretch>& stretches, double centre, double slope, int bin) {
  double sum = 0;
  int seen = 0;
  for (const Stretch& stretch : stretches) {
    const double k = bin + slope * (stretch.along - centre) / kBin_m;
    if (k < 0 || k >= static_cast<double>(stretch.steepness.size())) continue;
    const double steepness = stretch.steepness[static_cast<size_t>(k)];
    if (std::isnan(steepness)) continue;
    sum += std::min<double>(steepness, kSteepnessCap);
    ++seen;
  }
  return 2 * seen < kStretches ? std::nan("") : sum / seen;
}

// The steepest line through bin `bin` of the side's middle, and how steep it is.
std::pair<Line, double> SteepestThrough(const std::vector<Stretch>& stretches, double centre,
                                        int bin) {
  const int steps = 16;
  std::pair<Line, double> best{{}, 0};
  for (int step = -steps; step <= steps; ++step) {
    const double slope = std::tan(step * kTurns_deg / steps * std::numbers::pi / 180);
    const double steepness = LineSteepness(stretches, centre, slope, bin);
    if (steepness > best.second) best = {{slope, bin * kBin_m - slope * centre, {}, 0}, steepness};
  }
  return best;
}

// The innermost line that is steep on average, and steeper than the surface inside of it: noise
// lifts a bank at rest to `wall_slope` here and there, but the bank has no edge there. Positions
// count from the start of the scan lines.
std::optional<Line> InnermostWall(const std::vector<Stretch>& stretches, double centre,
                                  double wall_slope) {
  const int bins = static_cast<int>(stretches.front().steepness.size());
  std::pair<Line, double> wall{{}, wall_slope};
  int at = bins;
  // The first line that passes may lie askew, half on the wall and half on a bank before it: on
  // from there for as long as the surface becomes steeper.
  for (int bin = 0; bin < std::min(at + 4, bins); ++bin) {
    const auto line = SteepestThrough(stretches, centre, bin);
    const double inside = LineSteepness(stretches, centre, line.first.slope, bin - kBeside);
    if (line.second > wall.second && !(line.second < inside + kEdgeContrast)) wall = line, at = bin;
  }
  return at < bins ? std::optional(wall.first) : std::nullopt;
}

// How far inside of `wall` another straight edge runs that is nearly steep enough to be the wall;
// 0: none. It may be the wall's foot, blurred by light between sand and wall. A bank of sand is as
// steep but wide: an edge is steeper than what lies on both sides of it.
double RivalInside(const std::vector<Stretch>& stretches, double centre, double wall_slope, const Line& wall) {
  const auto steepness = [&](int bin) { return LineSteepness(stretches, centre, wall.slope, bin); };
  const int last = static_cast<int>((wall.offset + wall.slope * centre) / kBin_m) - kBeside;
  for (int bin = 0; bin < last; ++bin) {
    const double edge = steepness(bin);
    const double sides = std::fmax(steepness(bin - kBeside), steepness(bin + kBeside));
    if (edge > 0.8 * wall_slope && edge - sides > kEdgeContrast)
      return wall.offset + wall.slope * centre - bin * kBin_m;
  }
  return 0;
}

// Half-way between the steepness of the sand inside of a wall at bin `wall` and that of a wall: a
// bank at rest is nearly as steep as `wall_slope`, and single readings of it are steeper.
double FootSteepness(const Stretch& stretch, double wall, double wall_slope) {
  std::vector<double> sand;
  const int last = static_cast<int>((wall - kStep_m) / kBin_m);
  for (int k = std::max(0, last - static_cast<int>(kBank_m / kBin_m)); k < last; ++k)
    if (!std::isnan(stretch.steepness[static_cast<size_t>(k)]))
      sand.push_back(stretch.steepness[static_cast<size_t>(k)]);
  return std::max(wall_slope,
                  0.5 * (std::min(Median(std::move(sand)), wall_slope) + kSteepnessCap));
}

// Where each scan line of a stretch meets the wall that is expected `wall` from the start of the
// scan lines, at `start`: the median; empty where the stretch shows nothing steep there.
std::optional<double> FootNear(const Stretch& stretch, double start, double wall,
                               double wall_slope) {
  const double steep = FootSteepness(stretch, wall, wall_slope);
  std::vector<double> feet;
  for (const auto& line : stretch.lines) {
    const Reading* foot = nullptr;
    for (const Reading& reading : line) {
      if (std::abs(reading.out - start - wall) > kStep_m) continue;
      // The first that is steep; where none is, the steepest.
      if (foot == nullptr || (foot->steepness < steep && reading.steepness > foot->steepness))
        foot = &reading;
    }
    if (foot != nullptr && foot->steepness > 0.7 * wall_slope) feet.push_back(foot->foot);
  }
  if (2 * feet.size() < stretch.lines.size()) return std::nullopt;
  return Median(std::move(feet));
}

// The line that most points lie on within `tolerance`, tried through all pairs of points (no dice:
// there are under a hundred), then least squares over those.
Line ConsensusLine(const std::vector<Vector2d>& points, double tolerance) {
  Line best;
  std::vector<size_t> near;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = i + 1; j < points.size(); ++j) {
      const double run = points[j].x() - points[i].x();
      if (std::abs(run) < 0.05) continue;
      const double slope = (points[j].y() - points[i].y()) / run;
      if (std::abs(slope) > 0.2) continue;
      const double offset = points[i].y() - slope * points[i].x();
      near.clear();
      for (size_t k = 0; k < points.size(); ++k)
        if (std::abs(points[k].y() - offset - slope * points[k].x()) <= tolerance) near.push_back(k);
      if (near.size() > best.inliers.size()) best = {slope, offset, near, 0};
    }
  }
  if (best.inliers.size() < 2) return best;
  Vector2d mean = Vector2d::Zero();
  for (size_t k : best.inliers) mean += points[k] / static_cast<double>(best.inliers.size());
  double xx = 0, xy = 0, squares = 0;
  for (size_t k : best.inliers) {
    const Vector2d p = points[k] - mean;
    xx += p.x() * p.x();
    xy += p.x() * p.y();
  }
  best.slope = xy / xx;
  best.offset = mean.y() - best.slope * mean.x();
  for (size_t k : best.inliers)
    squares += std::pow(points[k].y() - best.offset - best.slope * points[k].x(), 2);
  best.spread = std::sqrt(squares / static_cast<double>(best.inliers.size()));
  return best;
}

// Height of the wall above the sand beside it on one stretch, and its highest reading.
std::pair<double, Vector3f> Rise(const Stretch& stretch, const Vector2d& outward, double foot) {
  std::vector<double> sand, tops;
  Vector3f highest = Vector3f::Zero();
  for (const auto& walk : stretch.walks) {
    const Vector3f* top = nullptr;
    for (const Vector3f& p : walk) {
      const double beyond = outward.dot(p.head<2>().cast<double>()) - foot;
      if (beyond < -kStep_m && beyond > -3 * kStep_m) sand.push_back(p.z());
      if (beyond > -kStep_m && beyond < kWallReach_m && (top == nullptr || p.z() > top->z())) top = &p;
    }
    if (top == nullptr) continue;
    if (tops.empty() || top->z() > highest.z()) highest = *top;
    tops.push_back(top->z());
  }
  return {Median(std::move(tops)) - Median(std::move(sand)), highest};
}

}  // namespace

BoxSide ReadSide(const LevelImage& image, const SideGuess& guess, double wall_slope) {
  const double pixel_m = -guess.sand_m / image.camera.fx_px;
  const double centre = 0.5 * (guess.low_m + guess.high_m);
  const double start = guess.position_m - guess.inside_m;
  const std::vector<Stretch> stretches = ReadStretches(image, guess, pixel_m);
  BoxSide side;
  side.position_m = guess.position_m;
  const auto wall = InnermostWall(stretches, centre, wall_slope);
  if (!wall) return side;
  side.rival_m = RivalInside(stretches, centre, wall_slope, *wall);
  std::vector<Vector2d> feet;
  std::vector<double> rises;
  for (const Stretch& stretch : stretches) {
    const double expected = wall->offset + wall->slope * stretch.along;
    const auto foot = FootNear(stretch, start, expected, wall_slope);
    if (!foot) continue;
    feet.emplace_back(stretch.along, *foot);
    const auto [rise, top] = Rise(stretch, guess.outward, *foot);
    rises.push_back(rise);
    side.rim_C.push_back(image.R_LC.cast<float>().transpose() * top);
  }
  const Line line = ConsensusLine(feet, kLineTolerance_m);
  if (line.inliers.empty()) return side;
  side.support = static_cast<double>(line.inliers.size()) / kStretches;
  side.spread_m = line.spread;
  side.rise_m = Median(rises);
  side.position_m = line.offset + line.slope * centre;
  side.lean_rad = std::atan(line.slope);
  return side;
}

}  // namespace sandwright
