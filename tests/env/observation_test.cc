#include "env/observation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "data/base/random.h"
#include "data/task.h"

namespace sandwright {
namespace {

struct Scene {
  HeightMap sensed{30, 30, 0.01, 0.05f};
  HeightMap goal{30, 30, 0.01, 0.05f};
  Region region{0, 0, 0.3, 0.3};
  int strokes_used = 0, max_strokes = 10, rejected_in_a_row = 0;

  Scene() { goal.mask.assign(goal.size(), 1); }
  TaskView view() const {
    return {sensed, goal, region, strokes_used, max_strokes, rejected_in_a_row};
  }
};

Scene RandomScene() {
  Scene scene;
  RandomStream stream(3);
  for (float& h : scene.sensed.height_m) h = static_cast<float>(stream.Uniform(0.03, 0.07));
  for (float& h : scene.goal.height_m) h = static_cast<float>(stream.Uniform(0.03, 0.07));
  for (uint8_t& m : scene.goal.mask) m = stream.Uniform() < 0.7;
  return scene;
}

struct Observation {
  ObservationConfig config;
  std::vector<float> map, vec;
  float at(size_t channel, int row, int column) const {
    return map[channel * static_cast<size_t>(config.rows * config.columns) +
               static_cast<size_t>(row * config.columns + column)];
  }
};
enum Channel : size_t { kHeight, kDifference, kCoarse, kMask, kInBox };

Observation Look(const Scene& scene, int rows, int columns) {
  Observation observation;
  observation.config.rows = rows;
  observation.config.columns = columns;
  const ObservationSpec spec = SpecOf(observation.config);
  observation.map.assign(static_cast<size_t>(spec.map_size()), -99);
  observation.vec.assign(static_cast<size_t>(spec.vec_size()), -99);
  Encode(scene.view(), observation.config, observation.map.data(), observation.vec.data());
  return observation;
}

TEST(Observation, ReachIsAChannelMoreWhereItIsAskedFor) {
  Scene scene = RandomScene();
  scene.region = {-0.15, 0, 0.3, 0.3};  // half of it beyond the wall
  Observation observation;
  observation.config = {.rows = 4, .columns = 4, .reach = true};
  const ObservationSpec spec = SpecOf(observation.config);
  EXPECT_EQ(spec.channels.back(), "reach");
  observation.map.assign(static_cast<size_t>(spec.map_size()), -99);
  observation.vec.assign(static_cast<size_t>(spec.vec_size()), -99);
  Encode(scene.view(), observation.config, observation.map.data(), observation.vec.data());
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      EXPECT_EQ(observation.at(5, row, column), column < 2 ? 0 : 1);
  }
}

TEST(Observation, SpecNamesEveryChannelAndNumber) {
  const ObservationSpec spec = SpecOf({});
  EXPECT_EQ(spec.channels.size(), 5u);
  EXPECT_EQ(spec.map_size(), 5 * 32 * 32);
  EXPECT_EQ(spec.vec_size(), 4);
}

TEST(Observation, FinishedTaskShowsNothingToDo) {
  Scene scene;
  scene.strokes_used = 4;
  scene.rejected_in_a_row = 2;
  const Observation seen = Look(scene, 32, 32);
  for (int row = 0; row < 32; ++row) {
    for (int column = 0; column < 32; ++column) {
      EXPECT_NEAR(seen.at(kHeight, row, column), 0, 1e-5);
      EXPECT_EQ(seen.at(kDifference, row, column), 0);
      EXPECT_EQ(seen.at(kCoarse, row, column), 0);
      EXPECT_NEAR(seen.at(kMask, row, column), 1, 1e-6);
      EXPECT_NEAR(seen.at(kInBox, row, column), 1, 1e-6);
    }
  }
  EXPECT_FLOAT_EQ(seen.vec[0], 6 / 20.0f);
  EXPECT_FLOAT_EQ(seen.vec[1], 0.4f);
  EXPECT_FLOAT_EQ(seen.vec[2], 2 / 3.0f);
  EXPECT_FLOAT_EQ(seen.vec[3], 0);
}

TEST(Observation, OnTheMapsOwnGridCellsKeepTheirValues) {
  const Scene scene = RandomScene();
  const Observation seen = Look(scene, 30, 30);
  const double mean =
      std::accumulate(scene.sensed.height_m.begin(), scene.sensed.height_m.end(), 0.0) / 900;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 30; ++column) {
      const size_t i = scene.sensed.Index(row, column);
      const double h = scene.sensed.height_m[i];
      const bool counts = scene.goal.mask[i] != 0;
      EXPECT_NEAR(seen.at(kHeight, row, column), (h - mean) / 0.05, 1e-4);
      EXPECT_NEAR(seen.at(kDifference, row, column),
                  counts ? (scene.goal.height_m[i] - h) / 0.02 : 0, 1e-4);
      EXPECT_NEAR(seen.at(kMask, row, column), counts, 1e-4);
    }
  }
  EXPECT_NEAR(seen.vec[3], GoalError(scene.sensed, scene.goal) / 0.01, 1e-5);
}

TEST(Observation, CoarserCellsAreAreaMeans) {
  const Scene scene = RandomScene();
  const Observation fine = Look(scene, 30, 30), half = Look(scene, 15, 15),
                    odd = Look(scene, 20, 20);
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 15; ++column) {
      double sum = 0;
      for (int b = 0; b < 2; ++b)
        for (int a = 0; a < 2; ++a) sum += fine.at(kDifference, 2 * row + b, 2 * column + a);
      EXPECT_NEAR(half.at(kDifference, row, column), sum / 4, 1e-4);
    }
  }
  // Cells of 1.5 map cells: one axis reads [1, 1/2], the next [1/2, 1].
  const double corner = fine.at(kMask, 0, 0) + 0.5 * fine.at(kMask, 0, 1) +
                        0.5 * fine.at(kMask, 1, 0) + 0.25 * fine.at(kMask, 1, 1);
  EXPECT_NEAR(odd.at(kMask, 0, 0), corner / 2.25, 1e-4);
}

TEST(Observation, FinerCellsAreBilinear) {
  Scene scene;
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 30; ++column)
      scene.goal.At(row, column) =
          static_cast<float>(0.05 + 0.0002 * (column + 0.5) + 0.0001 * row);
  const Observation seen = Look(scene, 60, 60);
  for (int row = 1; row < 59; ++row)
    for (int column = 1; column < 59; ++column)
      EXPECT_NEAR(seen.at(kDifference, row, column),
                  (0.0001 * (column + 0.5) + 0.0001 * (row / 2.0 - 0.25)) / 0.02, 1e-4);
}

TEST(Observation, RegionBeyondTheWallsIsMarked) {
  Scene scene;
  scene.region = {-0.1, 0.05, 0.3, 0.1};  // a third of it beyond x = 0
  for (float& h : scene.goal.height_m) h = 0.06f;
  const Observation seen = Look(scene, 10, 12);
  for (int row = 0; row < 10; ++row) {
    EXPECT_EQ(seen.at(kInBox, row, 3), 0);
    EXPECT_EQ(seen.at(kMask, row, 3), 0);
    EXPECT_EQ(seen.at(kDifference, row, 3), 0);
    EXPECT_NEAR(seen.at(kInBox, row, 4), 1, 1e-5);
    EXPECT_NEAR(seen.at(kDifference, row, 4), 0.5, 1e-5);
    EXPECT_NEAR(seen.at(kHeight, row, 3), 0, 1e-5);
    EXPECT_NEAR(seen.at(kHeight, row, 11), 0, 1e-5);
  }
}

TEST(Observation, BlurSpreadsAndKeepsLevels) {
  Scene scene;
  for (float& h : scene.goal.height_m) h = 0.06f;
  EXPECT_NEAR(Look(scene, 32, 32).at(kCoarse, 16, 16), 0.5, 1e-4);  // far from the edges
  Scene spike;
  spike.goal.At(15, 15) = 0.07f;
  const Observation seen = Look(spike, 30, 30);
  double sum = 0;
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 30; ++column) sum += seen.at(kCoarse, row, column);
  EXPECT_NEAR(sum, 1, 1e-4);
  // A Gaussian of 3 cells: its peak is 1 / (2 pi 9); one sd away exp(-1/2) of it.
  EXPECT_NEAR(seen.at(kCoarse, 15, 15), 1 / (2 * 3.14159265 * 9), 6e-4);
  EXPECT_NEAR(seen.at(kCoarse, 15, 18) / seen.at(kCoarse, 15, 15), std::exp(-0.5), 1e-4);
}

TEST(Observation, MirroredSandGivesTheMirroredObservation) {
  const Scene scene = RandomScene();
  Scene mirrored = scene;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 30; ++column) {
      const size_t from = scene.sensed.Index(row, column),
                   to = scene.sensed.Index(row, 29 - column);
      mirrored.sensed.height_m[to] = scene.sensed.height_m[from];
      mirrored.goal.height_m[to] = scene.goal.height_m[from];
      mirrored.goal.mask[to] = scene.goal.mask[from];
    }
  }
  for (int size : {12, 32}) {
    const Observation a = Look(scene, size, size), b = Look(mirrored, size, size);
    for (size_t channel = 0; channel < 5; ++channel)
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
          EXPECT_NEAR(a.at(channel, row, column), b.at(channel, row, size - 1 - column), 1e-5);
  }
}

}  // namespace
}  // namespace sandwright
