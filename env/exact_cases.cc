#include "env/exact_cases.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "env/avalanche.h"

namespace sandwright {
namespace {

// A surface over the plane: places and heights in cells, the origin in the map's middle.
using Surface = std::function<double(double, double)>;

double Radians(double angle_deg) { return angle_deg * std::numbers::pi / 180; }

constexpr int kArea =
    8;  // samples a side: a start's cells hold the mean over their area, to its rim
constexpr int kCentre = 1;  // an end is compared at the cells' centres

// Makes maps of one repose (t: rise over run) and cell.
class Cases {
 public:
  Cases(double repose_deg, double cell_size_m)
      : t_(std::tan(Radians(repose_deg))), cell_m_(cell_size_m) {}

  HeightMap Sample(int rows, int columns, const Surface& surface, int samples) const {
    HeightMap map(rows, columns, cell_m_);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        double sum = 0;
        // One sample more along y: no edge at 45 degrees runs through samples.
        const int along_y = samples == 1 ? 1 : samples + 1;
        for (int k = 0; k < samples * along_y; ++k)
          sum += surface(column + (k % samples + 0.5) / samples - columns / 2.0,
                         row + (k / samples + 0.5) / along_y - rows / 2.0);
        map.At(row, column) = static_cast<float>(cell_m_ * sum / (samples * along_y));
      }
    }
    return map;
  }

  void Add(const std::string& name, int rows, int columns, const Surface& start,
           const Surface& end) {
    cases_.push_back(
        {name, Sample(rows, columns, start, kArea), 1, Sample(rows, columns, end, kCentre)});
  }

  // Sand poured at (x, y): a narrow column; `share` of the cone's volume lies in the box.
  void Pour(const std::string& name, int size, double volume, double share, double x, double y) {
    const double top = std::cbrt(3 * volume / share * t_ * t_ / std::numbers::pi);
    const auto distance = [x, y](double u, double v) { return std::hypot(u - x, v - y); };
    cases_.push_back({name, Column(size, volume, distance), 1, Cone(size, top, distance)});
  }

  // Two equal heaps that meet: the higher of two cones of one top, which the volume decides. What has
  // come down cannot tell where it came from, so the sources must run for long: many small portions.
  void TwoSources(int size, double volume, double half_distance) {
    const auto distance = [=](double u, double v) {
      return std::hypot(std::abs(u) - half_distance, v);
    };
    double low = 0, high = volume;
    for (int i = 0; i < 50; ++i) {
      const double top = (low + high) / 2;
      (Sum(Cone(size, top, distance)) / cell_m_ < volume ? low : high) = top;
    }
    cases_.push_back(
        {"two sources", Column(size, volume, distance), 100, Cone(size, low, distance)});
  }

  // A cliff through the middle: a plane at repose around its half height.
  void Step(double azimuth_deg) {
    constexpr double kHeight = 30, kBase = 20;
    constexpr int kSize = 121;
    const double c = std::cos(Radians(azimuth_deg)), s = std::sin(Radians(azimuth_deg));
    Add(
        fmt::format("step {:g} deg", azimuth_deg), kSize, kSize,
        [&](double x, double y) { return kBase + (x * c + y * s < 0 ? kHeight : 0); },
        [&](double x, double y) {
          return kBase + std::clamp(kHeight / 2 - t_ * (x * c + y * s), 0.0, kHeight);
        });
    if (azimuth_deg == 0) return;
    HeightMap& expected = cases_.back().expected;
    expected.mask.assign(expected.size(), 0);
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column)
        expected.mask[expected.Index(row, column)] =
            std::hypot(column - kSize / 2, row - kSize / 2) < kSize / 4.0;
    }
  }

  // A block of length L beside a wall.
  void Block(const std::string& name, int columns, double length, double height) {
    const auto from_wall = [columns](double x) { return x + columns / 2.0; };
    const double half_run = height / (2 * t_), base = std::sqrt(2 * height * length / t_);
    const bool plateau = length >= half_run;
    Add(
        name, 6, columns, [&](double x, double) { return from_wall(x) < length ? height : 0; },
        [&](double x, double) {
          const double toe = plateau ? length + half_run : base;
          return std::clamp(t_ * (toe - from_wall(x)), 0.0, plateau ? height : t_ * base);
        });
  }

  // A round column (or, upside down, a pit): a frustum, or a cone where it was slender.
  void Round(const std::string& name, int size, double radius, double height, bool pit) {
    const double run = height / t_;
    const double root = std::sqrt(std::max(0.0, 4 * radius * radius - run * run / 3));
    const bool frustum = run <= std::sqrt(3.0) * radius;
    const double outer = frustum ? (run + root) / 2 : std::cbrt(3 * radius * radius * height / t_);
    const double top = frustum ? height : t_ * outer;
    const auto place = [pit, height](double h) { return pit ? height - h : h; };
    Add(
        name, size, size,
        [&](double x, double y) { return place(std::hypot(x, y) < radius ? height : 0); },
        [&](double x, double y) {
          return place(std::clamp(t_ * (outer - std::hypot(x, y)), 0.0, top));
        });
  }

  // A trench with upright walls; narrow ones end as a V.
  void Trench(const std::string& name, double width, double depth) {
    const bool flat_floor = depth <= t_ * width;
    const double bottom = flat_floor ? depth : std::sqrt(depth * width * t_);
    const double half_top =
        flat_floor ? width / 2 + depth / (2 * t_) : std::sqrt(depth * width / t_);
    constexpr double kFloor = 10;
    Add(
        name, 6, 120,
        [&](double x, double) { return kFloor + (std::abs(x) < width / 2 ? 0 : depth); },
        [&](double x, double) {
          return kFloor + depth - std::clamp(t_ * (half_top - std::abs(x)), 0.0, bottom);
        });
  }

  void Rest(const std::string& name, int size, const Surface& surface) {
    const HeightMap map = Sample(size, size, surface, kCentre);
    cases_.push_back({name, map, 1, map});
  }

  // Of a volume [cells^3] within a few cells of the sources; the surface at repose that falls off from them.
  HeightMap Column(int size, double volume, const Surface& distance) const {
    constexpr double kRadius = 3;
    HeightMap map = Sample(
        size, size, [&](double u, double v) { return distance(u, v) < kRadius; }, kArea);
    const double scale = volume * cell_m_ / Sum(map);
    for (float& h : map.height_m) h = static_cast<float>(h * scale);
    return map;
  }
  HeightMap Cone(int size, double top, const Surface& distance) const {
    return Sample(
        size, size, [&](double u, double v) { return std::max(0.0, top - t_ * distance(u, v)); },
        kCentre);
  }

  static double Sum(const HeightMap& map) {
    return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0);
  }
  double t() const { return t_; }
  std::vector<ExactCase> Take() { return std::move(cases_); }

 private:
  double t_, cell_m_;
  std::vector<ExactCase> cases_;
};

}  // namespace

std::vector<ExactCase> ExactCases(double repose_deg, double cell_size_m) {
  Cases cases(repose_deg, cell_size_m);
  cases.Pour("pour free", 101, 3.2e4, 1, 0, 0);
  cases.Pour("pour at a wall", 101, 2e4, 0.5, -50.5, 0);
  cases.Pour("pour in a corner", 101, 2e4, 0.25, -50.5, -50.5);
  cases.TwoSources(121, 4e4, 20);
  for (const double azimuth_deg : {0.0, 15.0, 30.0, 45.0}) cases.Step(azimuth_deg);
  cases.Block("block, wide", 100, 50, 40);
  cases.Block("block, tall", 100, 20, 40);
  cases.Round("cylinder to frustum", 101, 25, 20, false);
  cases.Round("cylinder to cone", 101, 15, 30, false);
  cases.Round("pit", 101, 25, 20, true);
  cases.Trench("trench, wide", 50, 20);
  cases.Trench("trench, narrow", 20, 20);
  cases.Add(
      "tilted closed box", 20, 60, [&](double x, double) { return 60 + 1.5 * cases.t() * x; },
      [&](double x, double) { return 60 + cases.t() * x; });
  cases.Rest("flat", 40, [](double, double) { return 20.0; });
  for (const double azimuth_deg : {0.0, 17.0, 30.0, 45.0}) {
    const double c = std::cos(Radians(azimuth_deg)), s = std::sin(Radians(azimuth_deg));
    for (const double share : {0.5, 1.0})
      cases.Rest(fmt::format("slope {:g} of critical, {:g} deg", share, azimuth_deg), 60,
                 [&](double x, double y) { return 50 + share * cases.t() * (x * c + y * s); });
  }
  // Each face: height difference along it alone, since the differences beside it cancel.
  cases.Rest("checkerboard", 40, [&](double x, double y) {
    return 20 +
           0.45 * cases.t() * (static_cast<int>(std::floor(x) + std::floor(y)) % 2 == 0 ? 1 : -1);
  });
  return cases.Take();
}

HeightMap SettleCase(const ExactCase& exact, double repose_deg) {
  HeightMap map(exact.start.rows, exact.start.columns, exact.start.cell_size_m);
  for (int k = 0; k < exact.portions; ++k) {
    for (size_t i = 0; i < map.size(); ++i)
      map.height_m[i] += exact.start.height_m[i] / static_cast<float>(exact.portions);
    RelaxToRepose(map, repose_deg);
  }
  return map;
}

CellError Differ(const HeightMap& map, const HeightMap& expected) {
  SAND_CHECK(map.SameGrid(expected));
  CellError error;
  double squared = 0, absolute = 0, count = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    if (!expected.mask.empty() && !expected.mask[i]) continue;
    const double difference =
        std::abs(static_cast<double>(map.height_m[i]) - expected.height_m[i]) / map.cell_size_m;
    squared += difference * difference;
    absolute += difference;
    error.largest = std::max(error.largest, difference);
    ++count;
  }
  error.rmse = std::sqrt(squared / count);
  error.mean = absolute / count;
  return error;
}

double ContourSpread(const HeightMap& heap) {
  constexpr int kDirections = 360;
  constexpr double kStep = 0.01;  // [cells]
  const double x0 = heap.width_m() / 2, y0 = heap.depth_m() / 2;
  const double half = HeightAt(heap, x0, y0) / 2;
  double nearest = std::numeric_limits<double>::max(), farthest = 0, sum = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * std::numbers::pi * k / kDirections;
    double radius = 0;
    while (radius < std::min(x0, y0) &&
           HeightAt(heap, x0 + radius * std::cos(angle), y0 + radius * std::sin(angle)) > half)
      radius += kStep * heap.cell_size_m;
    nearest = std::min(nearest, radius);
    farthest = std::max(farthest, radius);
    sum += radius;
  }
  return (farthest - nearest) / (sum / kDirections);
}

}  // namespace sandwright
