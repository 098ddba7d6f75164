// Grains through LAMMPS. The tests that run it are skipped where it is not installed.
#include "env/dem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "data/base/process.h"
#include "data/stroke_dataset.h"
#include "env/score_model.h"
#include "tests/support/sand_checks.h"

namespace sandwright {
namespace {

// A bed of some thousand grains, made once for all tests.
class DemTest : public testing::Test {
 protected:
  static DemConfig Config() {
    static const TemporaryFolder folder;
    DemConfig config;
    config.reach_m = 0.05;
    config.cache = folder.path() / "beds";
    return config;
  }
  static HeightMap Terrain() {
    HeightMap map(25, 30, 0.004, 0.04f);
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column)
        map.At(row, column) += static_cast<float>(0.003 * std::cos(column * 0.2));
    }
    return map;
  }
  static const SandState& Bed() {
    static const SandState bed = Dem(Config()).Start(Terrain(), 1);
    return bed;
  }
  void SetUp() override {
    if (!FindProgram("lmp")) GTEST_SKIP() << "LAMMPS is not installed";
  }
};

// Deepest overlap of two grains over their mean diameter [1].
double DeepestOverlap(const std::vector<Grain>& grains) {
  // Sorted along x: only grains within one diameter of each other there can touch.
  std::vector<Grain> sorted = grains;
  std::ranges::sort(sorted, {}, &Grain::x_m);
  double widest = 0, deepest = 0;
  for (const Grain& g : sorted) widest = std::max(widest, 2 * g.radius_m);
  for (size_t i = 0; i < sorted.size(); ++i) {
    const Grain& a = sorted[i];
    for (size_t j = i + 1; j < sorted.size() && sorted[j].x_m - a.x_m < widest; ++j) {
      const Grain& b = sorted[j];
      const double reach = a.radius_m + b.radius_m;
      if (std::abs(b.y_m - a.y_m) >= reach || std::abs(b.z_m - a.z_m) >= reach) continue;
      const double distance = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m, b.z_m - a.z_m);
      deepest = std::max(deepest, (reach - distance) / reach);
    }
  }
  return deepest;
}

double MeanHeight(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
         static_cast<double>(map.size());
}

Stroke Line(double x0, double x1, double y, double z) { return {{{x0, y, z}, {x1, y, z}}, 1, 0.1}; }

bool Same(const Grain& a, const Grain& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m && a.z_m == b.z_m && a.radius_m == b.radius_m;
}

ToolPath Cut(double x0, double x1) { return SamplePath(Line(x0, x1, 0.04, 0.027), 0.002); }

TEST_F(DemTest, ABedComesNearToItsTerrain) {
  const HeightMap terrain = Terrain();
  ASSERT_TRUE(Bed().grains());
  EXPECT_NEAR(MeanHeight(Bed().map()), MeanHeight(terrain), 0.001);
  EXPECT_LT(RmsDifference(Bed().map(), terrain), 0.5 * Config().material.grain_m);
  EXPECT_LT(DeepestOverlap(Bed().grains()->grains), 0.05);
  EXPECT_EQ(Dem(Config()).Start(terrain, 1).map().height_m, Bed().map().height_m);
  EXPECT_GT(RmsDifference(Dem(Config()).Start(terrain, 2).map(), Bed().map()), 5e-4)
      << "another packing";
}

TEST_F(DemTest, AStrokeMovesTheGrainsNearItAndTheNextOneGoesOnWithThem) {
  const Dem dem(Config());
  SandState state = Bed();
  DemReport report;
  const Outcome outcome = dem.ApplyStroke(state, Cut(0.03, 0.07), report);
  EXPECT_EQ(report.grains_lost, 0);
  EXPECT_GT(report.grains_moving, 500);
  EXPECT_FALSE(outcome.limited());
  EXPECT_GT(outcome.moved_volume_m3, 5e-6);
  const auto rise_m = [&](double x) {
    return HeightAt(state.map(), x, 0.04) - HeightAt(Bed().map(), x, 0.04);
  };
  EXPECT_LT(rise_m(0.045), -0.005);
  EXPECT_GT(rise_m(0.095), 0.002);
  const auto &was = Bed().grains()->grains, &is = state.grains()->grains;
  ASSERT_EQ(was.size(), is.size());
  for (size_t i = 0; i < was.size(); ++i) {
    EXPECT_EQ(was[i].radius_m, is[i].radius_m);
    EXPECT_TRUE(was[i].y_m < 0.095 || Same(was[i], is[i])) << "out of reach";
  }
  EXPECT_EQ(state.map().height_m, SurfaceOf(*state.grains(), 25, 30, 0.002).height_m);

  // Without a blade in the sand the bed stays as it is, but for a stir where contacts build up anew.
  const HeightMap left = state.map();
  dem.ApplyStroke(state, SamplePath(Line(0.03, 0.04, 0.04, 0.08), 0.002), report);
  EXPECT_LT(RmsDifference(state.map(), left), 1.5e-3);  // another packing differs by 2 mm and more
}

TEST_F(DemTest, CoarserGrainsAreScoredLikeAnyModel) {
  const Dem dem(Config());
  SandState state = Bed();
  StrokeRecord record;
  record.before = state.map();
  record.stroke = Line(0.03, 0.07, 0.04, 0.027);
  record.path = Cut(0.03, 0.07);
  DemReport report;
  dem.ApplyStroke(state, record.path, report);
  record.after = state.map();
  StrokeFile file;
  file.source = "dem";
  file.bed = "made";
  file.strokes = {record};
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "strokes.h5";
  WriteStrokeFile(file, path);

  DemConfig coarse = Config();
  coarse.material.grain_m = 0.008;
  const ScoreReport score = ScoreModel(Dem(coarse), std::span(&path, 1), {});
  ASSERT_EQ(score.strokes.size(), 1u);
  EXPECT_GT(*score.Total().r2_change, 0.3) << "of a stroke two grains deep";
  EXPECT_GT(score.ms_per_stroke, 100) << "the run counts";

  // The blade pushes back the sand that it drives, and the samples cover the stroke.
  ASSERT_FALSE(report.blade_loads.empty());
  double along_n = 0;
  for (const BladeLoad& load : report.blade_loads) along_n += load.force_n.x();
  EXPECT_LT(along_n / static_cast<double>(report.blade_loads.size()), -0.1);
  EXPECT_NEAR(report.samples.back().time_s, report.simulated_s, 1e-9);
  EXPECT_GT(report.samples.back().time_s, report.blade_loads.back().time_s);
}

TEST_F(DemTest, SeveralRanksMoveTheSameBed) {
  if (!FindProgram("mpirun")) GTEST_SKIP() << "no mpirun";
  DemConfig config = Config();
  SandState one = Bed(), two = Bed();
  DemReport report;
  Dem(config).ApplyStroke(one, Cut(0.03, 0.05), report);
  config.ranks = 2;
  Dem(config).ApplyStroke(two, Cut(0.03, 0.05), report);
  EXPECT_EQ(report.grains_lost, 0);
  EXPECT_LT(RmsDifference(one.map(), two.map()), 0.002);  // other rounding, then chaos
}

TEST_F(DemTest, ReportsWhatIsClipped) {
  SandState state = Bed();
  DemReport report;
  const ToolPath through_the_wall = SamplePath(Line(0.03, 0.05, 0.022, 0.037), 0.002);
  const Outcome outcome = Dem(Config()).ApplyStroke(state, through_the_wall, report);
  EXPECT_TRUE(outcome.left_box);
  EXPECT_FALSE(outcome.below_floor);
}

TEST_F(DemTest, LostGrainsAreAnErrorAndChangeNothing) {
  DemConfig config = Config();
  config.speed_mps = config.plunge_mps = 2;  // a hammer
  std::vector<SandState> states = {Bed(), Bed()};
  const std::vector<ToolPath> paths = {Cut(0.03, 0.04),
                                       SamplePath(Line(0.03, 0.08, 0.04, 0.002), 0.002)};
  EXPECT_THAT([&] { Dem(config).Apply(states, paths); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("were lost in a stroke")));
  EXPECT_EQ(states[0].map().height_m, Bed().map().height_m);
  EXPECT_EQ(states[1].map().height_m, Bed().map().height_m);
}

TEST(Dem, RefusesWhatItCannotStartFrom) {
  const Dem dem;
  std::vector<SandState> states = {SandState(HeightMap(20, 20, 0.01, 0.03f))};
  const std::vector<Stroke> strokes = {Line(0.05, 0.1, 0.1, 0.02)};
  EXPECT_THAT([&] { dem.Apply(states, strokes); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("without grains")));
  EXPECT_THAT([&] { dem.Start(HeightMap(20, 20, 0.01, 0.03f, Datum::kRelative), 1); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("datum is relative")));
}

TEST(Dem, WithoutLammpsSaysHowToGetIt) {
  const std::string path = std::getenv("PATH");
  const TemporaryFolder empty;
  DemConfig config;
  config.cache = empty.path() / "beds";
  setenv("PATH", empty.path().c_str(), 1);
  EXPECT_THAT([&] { Dem(config).Start(HeightMap(20, 20, 0.01, 0.03f), 1); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("apt-get install lammps")));
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace sandwright
