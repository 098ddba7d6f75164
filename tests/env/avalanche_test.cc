// Closed-form sandpiles of the inertia-free limit. Lengths in cells of 1 mm; t = tan(33 degrees).
#include "env/avalanche.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace sandwright {
namespace {

constexpr double kCell = 1e-3;
const double kTan = std::tan(33 * std::numbers::pi / 180);

// Heights [cells] by a function of the centre's place [cells] from the map's middle.
HeightMap Make(int rows, int columns, const std::function<double(double, double)>& height) {
  HeightMap map(rows, columns, kCell);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      map.At(row, column) =
          static_cast<float>(kCell * height(column - (columns - 1) / 2.0, row - (rows - 1) / 2.0));
  }
  return map;
}

double Volume(const HeightMap& map) {
  double sum = 0;
  for (float h : map.height_m) sum += h;
  return sum;
}

// Root mean square and largest difference [cells].
std::pair<double, double> Differ(const HeightMap& a, const HeightMap& b) {
  double sum = 0, most = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(a.height_m[i] - b.height_m[i]) / kCell;
    sum += d * d;
    most = std::max(most, d);
  }
  return {std::sqrt(sum / static_cast<double>(a.size())), most};
}

void ExpectRelaxesTo(HeightMap map, const HeightMap& expected, double rmse, double most) {
  const double volume = Volume(map);
  RelaxToRepose(map, 33);
  EXPECT_NEAR(Volume(map) / volume, 1, 1e-6);
  EXPECT_GE(*std::ranges::min_element(map.height_m), 0);
  const auto [rms, largest] = Differ(map, expected);
  EXPECT_LT(rms, rmse);
  EXPECT_LT(largest, most);
}

// A tall column of few cells at (x, y) becomes a cone of the same volume.
TEST(Avalanche, PouredSandBecomesACone) {
  const double volume = 2e4, top = std::cbrt(3 * volume * kTan * kTan / std::numbers::pi);
  const auto column = [&](double x, double y) { return std::hypot(x, y) < 3 ? volume / 25 : 0; };
  ExpectRelaxesTo(
      Make(81, 81, column),
      Make(81, 81,
           [&](double x, double y) { return std::max(0.0, top - kTan * std::hypot(x, y)); }),
      0.05, 0.4);
}

TEST(Avalanche, PouredAtAWallBecomesHalfACone) {
  // The wall runs at x = -40.5; the cone's axis lies on it.
  const double volume = 1.5e4, top = std::cbrt(6 * volume * kTan * kTan / std::numbers::pi);
  const auto from_wall = [](double x) { return x + 40.5; };
  int cells = 0;
  Make(81, 81, [&](double x, double y) { return cells += std::hypot(from_wall(x), y) < 3, 0; });
  const auto column = [&](double x, double y) {
    return std::hypot(from_wall(x), y) < 3 ? volume / cells : 0;
  };
  ExpectRelaxesTo(Make(81, 81, column),
                  Make(81, 81,
                       [&](double x, double y) {
                         return std::max(0.0, top - kTan * std::hypot(from_wall(x), y));
                       }),
                  0.05, 0.4);
}

TEST(Avalanche, AStepOfAnyAzimuthSettlesAroundItsMiddle) {
  const double step = 30, base = 20;
  for (const double azimuth_deg : {0.0, 30.0, 45.0}) {
    const double c = std::cos(azimuth_deg * std::numbers::pi / 180),
                 s = std::sin(azimuth_deg * std::numbers::pi / 180);
    const auto along = [&](double x, double y) { return x * c + y * s; };
    // A cell on the edge holds its share, so that the step has its true place.
    HeightMap map = Make(121, 121, [&](double x, double y) {
      return base + step * std::clamp(0.5 - along(x, y), 0.0, 1.0);
    });
    RelaxToRepose(map, 33);
    for (int row = 45; row <= 75; ++row) {  // far from the walls that the slope meets obliquely
      for (int column = 45; column <= 75; ++column) {
        const double u = along(column - 60, row - 60);
        const double expected = base + std::clamp(step / 2 - kTan * u, 0.0, step);
        EXPECT_NEAR(map.At(row, column) / kCell, expected, 0.15) << azimuth_deg << " at " << u;
      }
    }
  }
}

TEST(Avalanche, ACylinderBecomesAFrustum) {
  const double radius = 30, height = 20, run = height / kTan,
               root = std::sqrt(4 * radius * radius - run * run / 3);
  const double inner = (-run + root) / 2, outer = (run + root) / 2;
  const auto cylinder = [&](double x, double y) {
    return height * std::clamp(radius + 0.5 - std::hypot(x, y), 0.0, 1.0);
  };
  ExpectRelaxesTo(Make(121, 121, cylinder),
                  Make(121, 121,
                       [&](double x, double y) {
                         return std::clamp((outer - std::hypot(x, y)) * kTan, 0.0,
                                           height * (inner > 0));
                       }),
                  0.05, 0.4);
}

TEST(Avalanche, PilesAreRound) {
  HeightMap map = Make(81, 81, [](double x, double y) { return std::hypot(x, y) < 3 ? 700 : 0; });
  RelaxToRepose(map, 33);
  const double half = map.At(40, 40) / 2;
  double nearest = 1e9, farthest = 0;
  for (int k = 0; k < 90; ++k) {
    const double angle = k * std::numbers::pi / 45;
    for (double r = 0;; r += 0.02) {
      const double height =
          HeightAt(map, kCell * (40.5 + r * std::cos(angle)), kCell * (40.5 + r * std::sin(angle)));
      if (height > half) continue;
      nearest = std::min(nearest, r);
      farthest = std::max(farthest, r);
      break;
    }
  }
  EXPECT_LT((farthest - nearest) / nearest, 0.01);
}

TEST(Avalanche, SlopesUpToTheCriticalOneStayAsTheyAre) {
  for (const double share : {0.0, 0.5, 1.0}) {
    for (const double azimuth_deg : {0.0, 17.0, 30.0, 45.0}) {
      const double c = std::cos(azimuth_deg * std::numbers::pi / 180),
                   s = std::sin(azimuth_deg * std::numbers::pi / 180);
      const HeightMap map =
          Make(40, 60, [&](double x, double y) { return 50 + share * kTan * (x * c + y * s); });
      HeightMap relaxed = map;
      RelaxToRepose(relaxed, 33);
      EXPECT_EQ(relaxed.height_m, map.height_m) << share << " " << azimuth_deg;
    }
  }
}

TEST(Avalanche, KeepsTheSymmetriesOfTheSquareBitForBit) {
  const auto bumps = [](double x, double y) {
    return 30 + 20 * std::sin(0.5 * x) * std::cos(0.9 * y + 0.4 * x);
  };
  HeightMap map = Make(50, 36, bumps);
  HeightMap mirrored = Make(50, 36, [&](double x, double y) { return bumps(-x, y); });
  HeightMap transposed = Make(36, 50, [&](double x, double y) { return bumps(y, x); });
  for (HeightMap* m : {&map, &mirrored, &transposed}) RelaxToRepose(*m, 33);
  for (int row = 0; row < 50; ++row) {
    for (int column = 0; column < 36; ++column) {
      EXPECT_EQ(map.At(row, column), mirrored.At(row, 35 - column));
      EXPECT_EQ(map.At(row, column), transposed.At(column, row));
    }
  }
}

TEST(Avalanche, SandNobodyTouchedLiesAsItIs) {
  HeightMap map = Make(40, 40, [](double x, double) { return x < 0 ? 40 : 10; });
  const HeightMap before = map;
  Avalanche avalanche(before, map, 1);
  avalanche.Settle(kTan);
  EXPECT_EQ(map.height_m, before.height_m);
  const std::vector<size_t> toe = {map.Index(20, 20)};
  avalanche.Disturb(toe);  // the cliff above it comes down
  avalanche.Settle(kTan);
  EXPECT_NE(map.At(20, 15), before.At(20, 15));
  EXPECT_NEAR(Volume(map) / Volume(before), 1, 1e-6);
}

// Two needles; only one stands in the rectangle.
TEST(Avalanche, SlopesAreLimitedInARectangleOnly) {
  const HeightMap before = Make(40, 60, [](double x, double y) {
    return 10 + 0.9 * kTan * x / 3 + (std::abs(std::abs(x) - 20) < 0.6 && std::abs(y) < 1 ? 15 : 0);
  });
  HeightMap map = before;
  const CellRect changed = LimitSlopes(map, {5, 0, 35, 25}, 3 * kTan);
  EXPECT_NEAR(Volume(map) / Volume(before), 1, 1e-6);
  double steepest = 0;
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 60; ++column) {
      const bool inside = row >= changed.row0 && row < changed.row1 && column >= changed.column0 &&
                          column < changed.column1;
      EXPECT_TRUE(inside || map.At(row, column) == before.At(row, column)) << row << " " << column;
      if (column < 25)
        steepest = std::max(
            steepest, std::abs(map.At(row, column + 1) - static_cast<double>(map.At(row, column))));
    }
  }
  EXPECT_LT(steepest, 3 * kTan * kCell * 1.0015);
  EXPECT_LT(changed.column1, 40);
  HeightMap again = map;
  LimitSlopes(again, {5, 0, 35, 25}, 3.01 * kTan);
  EXPECT_EQ(again.height_m, map.height_m);
}

TEST(Avalanche, NoSandPassesClosedFaces) {
  HeightMap map = Make(10, 20, [](double x, double) { return x < 0 ? 20 : 0; });
  std::vector<CellFace> wall;
  std::vector<size_t> all;
  for (int row = 0; row < 10; ++row) wall.push_back({row, 9, true});
  for (size_t i = 0; i < map.size(); ++i) all.push_back(i);
  const HeightMap before = map;
  Avalanche avalanche(before, map, 1);
  avalanche.Disturb(all);
  avalanche.Flow(kTan, 10, wall);
  EXPECT_EQ(map.height_m, before.height_m);
}

TEST(Avalanche, RefusesAnglesThatSandDoesNotHave) {
  HeightMap map(4, 4, 0.01, 0.05f);
  try {
    RelaxToRepose(map, 80);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "angle of repose = 80 degrees; allowed: 5..60");
  }
}

}  // namespace
}  // namespace sandwright
