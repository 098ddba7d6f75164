#include "env/mixed_sand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "env/sand_model_by_name.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

HeightMap Bed() { return HeightMap(20, 30, 0.01, 0.05f); }

Stroke Cut() {
  Stroke stroke;
  stroke.control_points_m = {{0.08, 0.1, 0.03}, {0.2, 0.1, 0.03}};
  return stroke;
}

// Beds of seeds 0..count-1 after one stroke, in one batch.
std::vector<SandState> Stroked(const SandModel& sand, uint64_t count) {
  std::vector<SandState> states;
  for (uint64_t seed = 0; seed < count; ++seed) states.push_back(sand.Start(Bed(), seed));
  const std::vector<Stroke> strokes(states.size(), Cut());
  sand.Apply(states, strokes);
  return states;
}

TEST(MixedSand, EachBedKeepsItsOwnSandWhateverStandsBesideIt) {
  const HeightfieldConfig middle;
  const MixedSand sand = RandomSand(middle, {.variants = 4});
  EXPECT_EQ(sand.size(), 4);
  const auto batch = Stroked(sand, 24);
  std::set<std::vector<float>> outcomes;
  for (uint64_t seed = 0; seed < 24; ++seed) {
    SandState alone = sand.Start(Bed(), seed);
    EXPECT_EQ(alone.variant(), batch[seed].variant());
    const Stroke cut = Cut();
    const auto outcome = sand.Apply({&alone, 1}, std::span(&cut, 1));
    EXPECT_GT(outcome[0].moved_volume_m3, 0);
    EXPECT_EQ(alone.map().height_m, batch[seed].map().height_m);
    outcomes.insert(alone.map().height_m);
    // The second stroke goes through the same sand as the first.
    SandState copy = batch[seed];
    sand.Apply({&copy, 1}, std::span(&cut, 1));
    EXPECT_EQ(copy.variant(), alone.variant());
  }
  EXPECT_EQ(outcomes.size(), 4u);
}

TEST(MixedSand, VariantsLieAroundTheConfiguredSand) {
  const HeightfieldConfig middle;
  const RandomSandConfig none{.variants = 3,
                              .repose_spread_deg = 0,
                              .relaxation_spread = 0,
                              .rupture_spread = 0,
                              .bite_spread = 0};
  SandState plain(Bed());
  const Stroke cut = Cut();
  Heightfield(middle).Apply({&plain, 1}, std::span(&cut, 1));
  for (const SandState& state : Stroked(RandomSand(middle, none), 5))
    EXPECT_EQ(state.map().height_m, plain.map().height_m);
  // The same seed gives the same sands, another seed others.
  const auto one = Stroked(RandomSand(middle, {.variants = 2}), 4);
  const auto same = Stroked(RandomSand(middle, {.variants = 2}), 4);
  const auto other = Stroked(RandomSand(middle, {.variants = 2, .seed = 2}), 4);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(one[i].map().height_m, same[i].map().height_m);
    EXPECT_NE(one[i].map().height_m, other[i].map().height_m);
  }
}

TEST(SandModelByName, MakesMixtures) {
  EXPECT_EQ(SandModelByName("heightfield,heightfield", {})->name(), "mixed");
  SandModelConfig three;
  three.random.variants = 3;
  EXPECT_EQ(SandModelByName("heightfield", three)->name(), "mixed");
  EXPECT_EQ(SandModelByName("heightfield", {})->name(), "heightfield");
  EXPECT_THAT([&] { SandModelByName("default", three); },
              ThrowsMessage<Error>(HasSubstr("random.variants = 3 with the sand model 'default'")));
  EXPECT_THAT([] { SandModelByName("heightfield,default", {}); },
              ThrowsMessage<Error>(HasSubstr("different cells, 0 m and 0.004 m")));
  SandModelConfig narrow;
  narrow.heightfield.repose_deg = 6;
  narrow.heightfield.loose_deg = 5.5;
  narrow.random = {.variants = 20, .repose_spread_deg = 3};
  EXPECT_THAT([&] { SandModelByName("heightfield", narrow); },
              ThrowsMessage<Error>(HasSubstr("loose_deg")));
}

}  // namespace
}  // namespace sandwright
