#include "env/surrogate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/random.h"
#include "env/fit_samples.h"
#include "env/random_strokes.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SurrogateConfig SmallConfig() {
  SurrogateConfig config;
  config.net.base_channels = 4;
  config.net.poolings = 1;
  config.conserve_volume = false;
  return config;
}

// A net with random weights whose output is shifted by `head_bias` (in units of 10 mm).
Safetensors RandomParameters(const SurrogateNetConfig& config, float head_bias) {
  RandomStream stream(7);
  Safetensors file;
  for (const ConvShape& shape : SurrogateLayers(config)) {
    NamedTensor weight{{shape.out, shape.in, shape.size, shape.size}, {}};
    for (int i = 0; i < shape.out * shape.in * shape.size * shape.size; ++i)
      weight.values.push_back(static_cast<float>(0.3 * stream.Normal()));
    file.tensors[shape.name + ".weight"] = weight;
    file.tensors[shape.name + ".bias"] = {
        {shape.out}, std::vector<float>(static_cast<size_t>(shape.out), head_bias)};
  }
  return file;
}

HeightMap Bumpy(int rows, int columns) {
  HeightMap map(rows, columns, 0.004, 0.05f);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      map.At(row, column) += 0.006f * std::sin(0.13f * static_cast<float>(column)) *
                             std::cos(0.1f * static_cast<float>(row));
  }
  return map;
}

Stroke Curve() { return {{{0.06, 0.08, 0.035}, {0.15, 0.19, 0.03}, {0.22, 0.10, 0.04}}, 2, 0.1}; }

double Volume(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0);
}

HeightMap Apply(const SandModel& model, const HeightMap& map, const Stroke& stroke) {
  std::vector<SandState> states{SandState(map)};
  model.Apply(states, std::span(&stroke, 1));
  return states.front().map();
}

// The formula of the header, cell by cell.
double Convolved(const std::vector<float>& in, int channels, int rows, int columns,
                 const NamedTensor& w, int out, int row, int column) {
  double sum = 0;
  for (int c = 0; c < channels; ++c) {
    for (int ky = 0; ky < 3; ++ky) {
      for (int kx = 0; kx < 3; ++kx) {
        const int y = row + ky - 1, x = column + kx - 1;
        if (y < 0 || x < 0 || y >= rows || x >= columns) continue;
        sum += w.values[static_cast<size_t>(((out * channels + c) * 3 + ky) * 3 + kx)] *
               in[static_cast<size_t>((c * rows + y) * columns + x)];
      }
    }
  }
  return sum;
}

TEST(SurrogateNet, MatchesTheFormulaOfItsConvolutions) {
  SurrogateNetConfig config;
  config.base_channels = 4;
  config.poolings = 0;
  const Safetensors file = RandomParameters(config, 0.1f);
  const int rows = 5, columns = 19;  // more than one block of columns
  RandomStream stream(3);
  std::vector<float> in(static_cast<size_t>(kSurrogateChannelCount * rows * columns));
  for (float& v : in) v = static_cast<float>(stream.Normal());
  const auto layer = [&](const std::vector<float>& x, int channels, const std::string& name) {
    std::vector<float> out;
    for (int o = 0; o < 4; ++o) {
      for (int i = 0; i < rows * columns; ++i)
        out.push_back(static_cast<float>(
            std::max(0.1 + Convolved(x, channels, rows, columns, file.tensors.at(name + ".weight"),
                                     o, i / columns, i % columns),
                     0.0)));
    }
    return out;
  };
  const auto hidden = layer(layer(in, kSurrogateChannelCount, "down0a"), 4, "down0b");
  const auto residual = SurrogateNet(config, file, "test").Forward(in, ActiveCells(rows, columns));
  for (size_t i = 0; i < residual.size(); ++i) {
    double expected = 0.1f;
    for (size_t c = 0; c < 4; ++c)
      expected += file.tensors.at("head.weight").values[c] * hidden[c * residual.size() + i];
    ASSERT_NEAR(residual[i], expected, 1e-3 * (1 + std::abs(expected))) << i;
  }
}

TEST(SurrogateNet, InactiveCellsAreZeroAndChangeNothingElsewhere) {
  SurrogateNetConfig config;
  config.base_channels = 8;
  config.poolings = 1;
  config.patch_cells = 2;
  const SurrogateNet net(config, RandomParameters(config, 0.1f), "test");
  const int rows = 24, columns = 32;
  RandomStream stream(3);
  std::vector<float> in(static_cast<size_t>(kSurrogateChannelCount * rows * columns));
  std::vector<uint8_t> mask;
  for (int i = 0; i < rows * columns; ++i) mask.push_back(i % columns < 12);
  for (float& v : in) v = static_cast<float>(stream.Normal());
  const std::vector<float> left = net.Forward(in, ActiveCells(rows, columns, mask));
  std::vector<float> changed = in;
  for (size_t i = 0; i < in.size(); ++i) {
    if (!mask[i % mask.size()]) changed[i] = 7;
  }
  EXPECT_EQ(net.Forward(changed, ActiveCells(rows, columns, mask)), left);
  for (size_t i = 0; i < left.size(); ++i) ASSERT_EQ(left[i] == 0, mask[i] == 0) << i;
  EXPECT_LT(net.Flops(ActiveCells(rows, columns, mask)),
            0.5 * net.Flops(ActiveCells(rows, columns)));
}

TEST(SurrogateNet, RefusesForeignParameters) {
  const SurrogateNetConfig config = SmallConfig().net;
  Safetensors file = RandomParameters(config, 0);
  file.tensors["down1a.bias"].values[0] = NAN;
  EXPECT_THAT(
      [&] { SurrogateNet(config, file, "model.safetensors"); },
      ThrowsMessage<Error>(HasSubstr("tensor down1a.bias holds a value that is not finite")));
  file.tensors["down1a.bias"] = {{3}, {0, 0, 0}};
  EXPECT_THAT([&] { SurrogateNet(config, file, "model.safetensors"); },
              ThrowsMessage<Error>(HasSubstr("down1a.bias has shape [3]; expected [8]")));
  SurrogateNetConfig even;
  even.architecture = "linear";
  even.linear_cells = 4;
  EXPECT_THAT([&] { SurrogateLayers(even); }, ThrowsMessage<Error>(HasSubstr("must be odd")));
  file.tensors.erase("down1a.bias");
  EXPECT_THAT([&] { SurrogateNet(config, file, "model.safetensors"); },
              ThrowsMessage<Error>(HasSubstr("down1a.bias")));
}

TEST(Surrogate, ASilentNetIsTheHeightfield) {
  const SurrogateConfig config = SmallConfig();
  Safetensors silent = RandomParameters(config.net, 0);
  for (float& w : silent.tensors["head.weight"].values) w = 0;
  const HeightMap bed = Bumpy(75, 75);
  EXPECT_EQ(Apply(Surrogate(config, silent, "test"), bed, Curve()).height_m,
            Apply(Heightfield(config.heightfield), bed, Curve()).height_m);
}

TEST(Surrogate, TellsHowFarAStrokeLiesFromItsTrainingWhereItsFileDoes) {
  const SurrogateConfig config = SmallConfig();
  Safetensors file = RandomParameters(config.net, 0);
  const auto distance = [&](const Stroke& stroke) {
    std::vector<SandState> state{SandState(Bumpy(75, 75))};
    return Surrogate(config, file, "test")
        .Apply(state, std::span(&stroke, 1))
        .front()
        .training_distance;
  };
  EXPECT_FALSE(distance(Curve()).has_value());
  const HeightMap bed = Bumpy(75, 75);
  const ToolPath path = SamplePath(Curve(), bed.cell_size_m / 2);
  std::vector<SandState> state{SandState(bed)};
  Heightfield(config.heightfield).Apply(state, std::span(&path, 1));
  const SurrogateInput input =
      EncodeStroke(bed, state[0].map(), path, Blade{}, config.net.multiple());
  TrainingRange(std::span(&input, 1)).Save(file);
  EXPECT_NEAR(distance(Curve()).value(), 1, 1e-5);  // the only stroke of its training
  Stroke deep = Curve();
  for (Eigen::Vector3d& point : deep.control_points_m) point.z() -= 0.025;
  EXPECT_GT(distance(deep).value(), 1.2);
}

TEST(Surrogate, BeyondTheWindowIsTheHeightfield) {
  const SurrogateConfig config = SmallConfig();
  const HeightMap bed(100, 150, 0.004, 0.05f);
  const Stroke stroke = Curve();
  const HeightMap learned =
      Apply(Surrogate(config, RandomParameters(config.net, 0.1f), "test"), bed, stroke);
  const HeightMap plain = Apply(Heightfield(config.heightfield), bed, stroke);
  const CellRect window = StrokeWindow(bed, SamplePath(stroke, 0.002)),
                 changed = ChangedBounds(plain, learned, 0);
  EXPECT_FALSE(changed.empty());
  EXPECT_EQ(Union(window, changed).rows(), window.rows());
  EXPECT_EQ(Union(window, changed).columns(), window.columns());
}

TEST(Surrogate, TakesAtMostWhatLiesThere) {
  SurrogateConfig config = SmallConfig();
  const HeightMap bed(75, 75, 0.004, 0.004f);
  const Safetensors hungry = RandomParameters(config.net, -30);  // 300 mm less everywhere
  const Stroke stroke{{{0.1, 0.15, 0.001}, {0.2, 0.15, 0.001}}, 1, 0.1};
  const HeightMap after = Apply(Surrogate(config, hungry, "test"), bed, stroke);
  for (float h : after.height_m) ASSERT_GE(h, 0);
  EXPECT_EQ(after.At(37, 40), 0);  // all of it
  config.conserve_volume = true;
  const HeightMap kept = Apply(Surrogate(config, hungry, "test"), bed, stroke);
  for (float h : kept.height_m) ASSERT_GE(h, 0);
  EXPECT_NEAR(Volume(kept), Volume(bed), 1e-5 * Volume(bed));
}

class SurrogateArchitecture : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, SurrogateArchitecture,
                         ::testing::Values("residual", "flux", "direct", "linear"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(SurrogateArchitecture, BatchOrderAndThreadsDoNotMatter) {
  SurrogateConfig config = SmallConfig();
  config.net.architecture = GetParam();
  const Safetensors parameters = RandomParameters(config.net, 0.05f);
  const Surrogate one(config, parameters, "test");
  config.threads = config.heightfield.threads = 3;
  const Surrogate three(config, parameters, "test");
  const std::vector<Stroke> strokes = {
      Curve(), {{{0.05, 0.05, 0.03}, {0.2, 0.2, 0.03}}, 1, 0.1}, Curve()};
  std::vector<SandState> states = {SandState(Bumpy(75, 75)), SandState(Bumpy(90, 60)),
                                   SandState(Bumpy(60, 90))};
  std::vector<SandState> again = states;
  const std::vector<Outcome> outcomes = one.Apply(states, strokes);
  three.Apply(again, strokes);
  for (size_t i = 0; i < states.size(); ++i) {
    EXPECT_EQ(states[i].map().height_m, again[i].map().height_m);
    EXPECT_GT(outcomes[i].moved_volume_m3, 0);
  }
  EXPECT_EQ(Apply(one, Bumpy(90, 60), strokes[1]).height_m, states[1].map().height_m);
}

TEST_P(SurrogateArchitecture, NoSandTouchedNothingChanges) {
  SurrogateConfig config = SmallConfig();
  config.net.architecture = GetParam();
  const Surrogate model(config, RandomParameters(config.net, 0.3f), "test");
  const HeightMap bed(75, 75, 0.004, 0.05f);
  const Stroke above{{{0.1, 0.15, 0.08}, {0.2, 0.15, 0.08}}, 1, 0.1};
  EXPECT_EQ(Apply(model, bed, above).height_m, bed.height_m);
}

// Whatever the weights say: volume is kept where it is promised, no height is below the floor and
// nothing changes where the stroke cannot reach.
TEST_P(SurrogateArchitecture, KeepsVolumeAndFloorUnderWildWeights) {
  SurrogateConfig config = SmallConfig();
  config.net.architecture = GetParam();
  config.conserve_volume = true;
  config.reach_m = 0.05;
  const HeightMap bed(75, 75, 0.004, 0.01f);
  const Stroke stroke{{{0.1, 0.15, 0.001}, {0.2, 0.17, 0.001}}, 1, 0.1};
  for (const float bias : {-3.0f, 0.0f, 3.0f}) {
    Safetensors wild = RandomParameters(config.net, bias);
    const HeightMap after = Apply(Surrogate(config, wild, "test"), bed, stroke);
    if (bias == 0) {  // else the residual may be all inflow, of which nothing is kept
      EXPECT_NE(after.height_m, Apply(Heightfield(config.heightfield), bed, stroke).height_m);
    }
    EXPECT_NEAR(Volume(after), Volume(bed), 2e-6 * Volume(bed));
    for (float h : after.height_m) ASSERT_GE(h, 0);
    EXPECT_EQ(after.At(2, 2), bed.At(2, 2));
  }
}

double SteepestOverRepose(const HeightMap& map) {
  return SteepestFace(map) / std::tan(HeightfieldConfig().repose_deg * std::numbers::pi / 180);
}

TEST(Surrogate, LimitsTheSlopesItLeavesOnAnyNumberOfThreads) {
  SurrogateConfig config = SmallConfig();
  config.conserve_volume = true;
  const Safetensors wild = RandomParameters(config.net, 0);
  const HeightMap bed = Bumpy(75, 75);
  ASSERT_GT(SteepestOverRepose(Apply(Surrogate(config, wild, "test"), bed, Curve())), 3);
  config.steepest_over_repose = 2;
  const HeightMap after = Apply(Surrogate(config, wild, "test"), bed, Curve());
  EXPECT_LT(SteepestOverRepose(after), 2 * 1.0015);
  EXPECT_NEAR(Volume(after), Volume(bed), 2e-6 * Volume(bed));
  EXPECT_GE(*std::ranges::min_element(after.height_m), 0);
  config.threads = config.heightfield.threads = 3;
  std::vector<SandState> states(5, SandState(bed));
  const std::vector<Stroke> strokes(5, Curve());
  Surrogate(config, wild, "test").Apply(states, strokes);
  for (const SandState& state : states) EXPECT_EQ(state.map().height_m, after.height_m);
}

TEST(Surrogate, TheLimitOnSlopesDoesNothingBelowIt) {
  SurrogateConfig config = SmallConfig();
  Safetensors silent = RandomParameters(config.net, 0);
  for (float& w : silent.tensors["head.weight"].values) w = 0;
  const HeightMap bed = Bumpy(75, 75);
  const HeightMap free = Apply(Surrogate(config, silent, "test"), bed, Curve());
  ASSERT_LT(SteepestOverRepose(free), 1.5);
  config.steepest_over_repose = 1.5;
  EXPECT_EQ(Apply(Surrogate(config, silent, "test"), bed, Curve()).height_m, free.height_m);
}

TEST(Surrogate, DirectKnowsNoHeightfieldAndReportsItsLimits) {
  SurrogateConfig config = SmallConfig();
  config.net.architecture = "direct";
  Safetensors silent = RandomParameters(config.net, 0);
  for (float& w : silent.tensors["head.weight"].values) w = 0;
  const Surrogate model(config, silent, "test");
  EXPECT_EQ(Apply(model, Bumpy(75, 75), Curve()).height_m, Bumpy(75, 75).height_m);
  const Stroke outside{{{0.1, 0.15, -0.01}, {0.32, 0.15, 0.03}}, 1, 0.1};
  std::vector<SandState> state{SandState(Bumpy(75, 75))};
  const Outcome outcome = model.Apply(state, std::span(&outside, 1))[0];
  EXPECT_TRUE(outcome.left_box);
  EXPECT_TRUE(outcome.below_floor);
}

// A map that is turned by 90 degrees, with the stroke, has turned features.
TEST(SurrogateNet, LinearFeaturesAreLinearInTheHeightsAndTurnWithTheStroke) {
  const size_t cells = 2;
  std::vector<float> channels(kSurrogateChannelCount * cells, 0.0f);
  channels[1 * cells] = 0.5f;  // height
  channels[kDirectionXChannel * cells] = 0.3f;
  channels[(kDirectionXChannel + 1) * cells] = 0.4f;
  const std::vector<float> once = LinearFeatures(channels, cells);
  const std::vector<float> expected = {0.5f, 0.5f * 0.6f, 0.5f * 0.8f, 0.5f * (0.36f - 0.64f),
                                       0.5f * 2 * 0.6f * 0.8f};
  for (size_t k = 0; k < 5; ++k) EXPECT_NEAR(once[(5 + k) * cells], expected[k], 1e-6);
  channels[1 * cells] = 1.5f;
  const std::vector<float> thrice = LinearFeatures(channels, cells);
  for (size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(thrice[(5 + k) * cells], 3 * once[(5 + k) * cells], 1e-6);
  EXPECT_EQ(once[5 * cells + 1], 0);
}

TEST(Surrogate, RefusesOtherCellsAndLeavesTheStateAlone) {
  const SurrogateConfig config = SmallConfig();
  const Surrogate model(config, RandomParameters(config.net, 0.1f), "test");
  const HeightMap bed(30, 30, 0.01, 0.05f);
  EXPECT_THAT([&] { Apply(model, bed, Curve()); },
              ThrowsMessage<Error>(HasSubstr("works on cells of 0.004 m")));
}

TEST(SurrogateEncoding, OnlyCellsThatTheStrokeReachesAreActive) {
  const HeightMap bed = Bumpy(75, 75);
  const ToolPath path = SamplePath(Stroke{{{0.1, 0.15, 0.03}, {0.15, 0.15, 0.03}}, 1, 0.1}, 0.002);
  const SurrogateInput all = EncodeStroke(bed, bed, path, Blade{}, 4),
                       part = EncodeStroke(bed, bed, path, Blade{}, 4, 0.05);
  const auto at = [&](double x_m, double y_m) {
    return static_cast<size_t>((static_cast<int>(y_m / 0.004) - part.window.row0) * part.columns +
                               static_cast<int>(x_m / 0.004) - part.window.column0);
  };
  EXPECT_TRUE(part.active[at(0.12, 0.195)]);
  EXPECT_FALSE(part.active[at(0.12, 0.205)]);
  EXPECT_TRUE(part.active[at(0.26, 0.15)]);  // the way ahead of the end
  EXPECT_FALSE(part.active[at(0.045, 0.15)]);
  const size_t plane = part.active.size();
  for (size_t i = 0; i < part.channels.size(); ++i)
    ASSERT_EQ(part.channels[i], part.active[i % plane] ? all.channels[i] : 0) << i;
  EXPECT_EQ(std::accumulate(all.active.begin(), all.active.end(), size_t{0}), plane);
}

TEST(SurrogateEncoding, TurnsWithTheSquare) {
  constexpr double kReach_m = 0.06;
  const SurrogateConfig config = SmallConfig();
  const HeightMap bed = Bumpy(75, 75);
  const ToolPath path = SamplePath(Curve(), 0.002);
  std::vector<SandState> state{SandState(bed)};
  Heightfield(config.heightfield).Apply(state, std::span(&path, 1));
  FitSample sample;
  sample.input = EncodeStroke(bed, state[0].map(), path, Blade{}, 1, kReach_m);
  sample.target.assign(static_cast<size_t>(sample.input.rows * sample.input.columns), 0);
  sample.weight = sample.target;
  const double side = bed.width_m(), pi = std::acos(-1);
  for (int symmetry = 0; symmetry < 8; ++symmetry) {
    const auto turn_map = [&](const HeightMap& map) {
      HeightMap out = map;
      for (int row = 0; row < 75; ++row) {
        for (int column = 0; column < 75; ++column) {
          const int j = symmetry & 2 ? 74 - row : row, i = symmetry & 1 ? 74 - column : column;
          (symmetry & 4 ? out.At(i, j) : out.At(j, i)) = map.At(row, column);
        }
      }
      return out;
    };
    ToolPath turned = path;
    for (BladePose& p : turned) {
      if (symmetry & 1) p.x_m = side - p.x_m, p.yaw_rad = pi - p.yaw_rad;
      if (symmetry & 2) p.y_m = side - p.y_m, p.yaw_rad = -p.yaw_rad;
      if (symmetry & 4) std::swap(p.x_m, p.y_m), p.yaw_rad = pi / 2 - p.yaw_rad;
    }
    const SurrogateInput direct =
        EncodeStroke(turn_map(bed), turn_map(state[0].map()), turned, Blade{}, 1, kReach_m);
    const SurrogateInput by_copy = ApplySymmetry(sample, symmetry).input;
    ASSERT_EQ(direct.rows, by_copy.rows);
    ASSERT_EQ(direct.columns, by_copy.columns);
    // So may cells at the edge of the reach.
    size_t other_reach = 0;
    for (size_t i = 0; i < direct.active.size(); ++i)
      other_reach += direct.active[i] != by_copy.active[i];
    EXPECT_LT(other_reach, direct.active.size() / 1000) << "symmetry " << symmetry;
    // Cells on the edge of the blade's footprint may fall on either side by rounding.
    size_t different = 0;
    for (size_t i = 0; i < direct.channels.size(); ++i)
      different += std::abs(direct.channels[i] - by_copy.channels[i]) > 1e-3f;
    EXPECT_LT(different, direct.channels.size() / 1000) << "symmetry " << symmetry;
  }
}

}  // namespace
}  // namespace sandwright
