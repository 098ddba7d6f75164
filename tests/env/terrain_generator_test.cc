#include "env/terrain_generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "data/base/error.h"
#include "env/avalanche.h"

namespace sandwright {
namespace {

TEST(TerrainGenerator, MakesNaturalSandAtRest) {
  for (const double amplitude_m : {0.004, 0.008, 0.03}) {
    TerrainConfig config;
    config.amplitude_m = amplitude_m;
    RandomStream stream(11);
    const HeightMap map = GenerateTerrain(config, 60, 90, 0.005, stream);
    const double mean = std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
                        static_cast<double>(map.size());
    EXPECT_NEAR(mean, 0.05, 1e-6);
    EXPECT_GE(*std::min_element(map.height_m.begin(), map.height_m.end()), 0.01f - 1e-6f);
    double square = 0;
    for (float h : map.height_m) square += (h - mean) * (h - mean);
    const double deviation = std::sqrt(square / static_cast<double>(map.size()));
    EXPECT_GT(deviation, 0.5 * std::min(amplitude_m, 0.015));
    EXPECT_LT(deviation, 1.01 * amplitude_m);
    HeightMap relaxed = map;
    RelaxToRepose(relaxed, config.repose_deg);
    EXPECT_EQ(relaxed.height_m, map.height_m);
  }
}

TEST(TerrainGenerator, StrokesWorkTheBedAndKeepItsSand) {
  TerrainConfig config;
  config.amplitude_m = 0.004;
  RandomStream plain_stream(5), stream(5), again(5);
  const HeightMap plain = GenerateTerrain(config, 30, 30, 0.01, plain_stream);
  config.strokes = 8;
  const HeightMap worked = GenerateTerrain(config, 30, 30, 0.01, stream);
  EXPECT_EQ(worked.height_m, GenerateTerrain(config, 30, 30, 0.01, again).height_m);
  double volume = 0, moved = 0;
  for (size_t i = 0; i < plain.size(); ++i) {
    volume += worked.height_m[i];
    moved += std::abs(worked.height_m[i] - plain.height_m[i]);
  }
  EXPECT_NEAR(volume / 900, 0.05, 1e-6);
  EXPECT_GT(moved / 900, 0.003);  // grooves of up to 30 mm and the heaps at their ends
  HeightMap relaxed = worked;
  RelaxToRepose(relaxed, config.repose_deg);
  EXPECT_EQ(relaxed.height_m, worked.height_m);
  EXPECT_THROW(GenerateTerrain(config, 8, 8, 0.01, stream), Error);  // no room for a stroke
}

TEST(TerrainGenerator, StreamsDecide) {
  RandomStream a(1), again(1), b(2);
  const HeightMap first = GenerateTerrain({}, 40, 40, 0.005, a);
  EXPECT_EQ(first.height_m, GenerateTerrain({}, 40, 40, 0.005, again).height_m);
  EXPECT_NE(first.height_m, GenerateTerrain({}, 40, 40, 0.005, b).height_m);
}

TEST(TerrainGenerator, FlatIsFlatAndBadValuesAreNamed) {
  TerrainConfig config;
  config.amplitude_m = 0;
  RandomStream stream(1);
  const HeightMap flat = GenerateTerrain(config, 2, 30, 0.01, stream);
  EXPECT_TRUE(
      std::all_of(flat.height_m.begin(), flat.height_m.end(), [](float h) { return h == 0.05f; }));
  config.repose_deg = 90;
  try {
    GenerateTerrain(config, 20, 20, 0.01, stream);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("repose_deg"), std::string::npos) << e.what();
  }
  EXPECT_THROW(GenerateTerrain({}, 1, 1, 0.01, stream), Error);
}

}  // namespace
}  // namespace sandwright
