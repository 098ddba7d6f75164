// What the sand does to a mirrored bed under a mirrored stroke is the mirror image.
#include "agents/symmetry.h"

#include <gtest/gtest.h>

#include "agents/networks.h"
#include "data/base/random.h"
#include "env/heightfield.h"
#include "env/shaping_env.h"

namespace sandwright {
namespace {

constexpr int kCells = 30;
constexpr double kCell_m = 0.01;

HeightMap Bed(RandomStream& stream) {
  HeightMap map(kCells, kCells, kCell_m, 0.05f);
  const double x = stream.Uniform(8, 22), y = stream.Uniform(8, 22);
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column)
      map.height_m[map.Index(row, column)] += static_cast<float>(
          0.02 * std::exp(-((row - y) * (row - y) + 2 * (column - x) * (column - x)) / 40.0));
  return map;
}

torch::Tensor ToTensor(const HeightMap& map) {
  return torch::tensor(map.height_m).view({1, 1, map.rows, map.columns});
}

HeightMap Mirrored(const HeightMap& map, int symmetry) {
  HeightMap mirrored = map;
  const auto values = Transformed(ToTensor(map), symmetry).contiguous();
  std::copy_n(values.data_ptr<float>(), map.size(), mirrored.height_m.begin());
  return mirrored;
}

HeightMap After(const Heightfield& sand, const HeightMap& map, const Action& action) {
  std::vector<SandState> states = {SandState(map)};
  const std::vector<Stroke> strokes = {
      DecodeAction(action, map, {0, 0, map.width_m(), map.depth_m()}, sand.blade(), 0.1)};
  sand.Apply(states, strokes);
  return states[0].map();
}

TEST(Symmetry, TheSandCommutesWithIt) {
  const Heightfield sand{HeightfieldConfig{}};
  RandomStream stream(3);
  for (int trial = 0; trial < 10; ++trial) {
    const HeightMap map = Bed(stream);
    Action action{};
    for (float& number : action) number = static_cast<float>(stream.Uniform(-0.6, 0.6));
    action[4] = 0.2f, action[5] = 0.4f;  // a cut
    const HeightMap plain = After(sand, map, action);
    double moved = 0;
    for (size_t i = 0; i < map.size(); ++i) moved += std::abs(plain.height_m[i] - map.height_m[i]);
    ASSERT_GT(moved, 0.05);  // the sum over cells [m]: a stroke that does something
    for (int symmetry = 0; symmetry < kSymmetriesOfSquare; ++symmetry) {
      const auto turned = TransformedAction(
          torch::from_blob(action.data(), {1, kActionSize}), symmetry).contiguous();
      Action other{};
      std::copy_n(turned.data_ptr<float>(), kActionSize, other.begin());
      const HeightMap expected = Mirrored(plain, symmetry),
                      found = After(sand, Mirrored(map, symmetry), other);
      double apart = 0;
      for (size_t i = 0; i < map.size(); ++i)
        apart += std::abs(found.height_m[i] - expected.height_m[i]);
      // Avalanches visit the cells in an order of their own.
      EXPECT_LT(apart, 0.1 * moved) << "symmetry " << symmetry << ", trial " << trial;
    }
  }
}

TEST(Symmetry, EveryElementIsAnotherOne) {
  const auto map = torch::arange(9, torch::kFloat32).view({1, 1, 3, 3});
  for (int a = 0; a < kSymmetriesOfSquare; ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_FALSE(torch::equal(Transformed(map, a), Transformed(map, b))) << a << " " << b;
  EXPECT_TRUE(torch::equal(Transformed(map, 0), map));
}

}  // namespace
}  // namespace sandwright
