#include "env/grain_slopes.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "data/base/error.h"
#include "data/base/random.h"
#include "env/dem_bed.h"
#include "env/grains.h"

namespace sandwright {
namespace {

constexpr uint64_t kPour = StreamId("grain checks pour");
constexpr double kRepose_deg = 33, kReposeSpread_deg = 2;
constexpr double kCell_m = 0.002;  // of the maps that are measured
constexpr double kSpread = 0.15;   // of a law of experiments, over materials
constexpr double kWait_s = 3;      // for a slope to come to rest

// Mean heights over bins of kCell_m along a line or a radius.
using Profile = std::vector<double>;

HeightMap Surface(const DemScene& scene) {
  GrainBed bed{scene.high_m[0], scene.high_m[1], scene.grains};
  std::erase_if(bed.grains, [](const Grain& g) { return g.radius_m == 0; });  // lost
  return SurfaceOf(bed, static_cast<int>(std::lround(bed.depth_m / kCell_m)),
                   static_cast<int>(std::lround(bed.width_m / kCell_m)), 0);
}

// `bin` of a cell's centre (x, y) [m]; negative: not counted.
Profile MeanHeights(const HeightMap& map, const std::function<int(double, double)>& bin) {
  Profile sum;
  std::vector<int> count;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int at = bin((column + 0.5) * map.cell_size_m, (row + 0.5) * map.cell_size_m);
      if (at < 0) continue;
      const auto i = static_cast<size_t>(at);
      if (i >= sum.size()) sum.resize(i + 1), count.resize(i + 1);
      sum[i] += map.At(row, column);
      ++count[i];
    }
  }
  for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1, count[i]);
  return sum;
}

Profile AlongX(const HeightMap& map) {
  return MeanHeights(map, [](double x, double) { return static_cast<int>(x / kCell_m); });
}

// Around the middle of the grains, up to the nearest edge of the map.
Profile AlongRadius(const HeightMap& map, const std::vector<Grain>& grains) {
  double x_m = 0, y_m = 0, n = 0;
  for (const Grain& g : grains) {
    if (g.radius_m == 0) continue;
    x_m += g.x_m, y_m += g.y_m, ++n;
  }
  x_m /= n, y_m /= n;
  const double reach_m = std::min({x_m, y_m, map.width_m() - x_m, map.depth_m() - y_m});
  return MeanHeights(map, [=](double x, double y) {
    const double radius_m = std::hypot(x - x_m, y - y_m);
    return radius_m < reach_m ? static_cast<int>(radius_m / kCell_m) : -1;
  });
}

// Of the line through a falling profile between a fifth and four fifths of its top [deg].
double Slope_deg(const Profile& profile) {
  const double top_m = *std::ranges::max_element(profile);
  double n = 0, x = 0, h = 0, xx = 0, xh = 0;
  for (size_t i = 0; i < profile.size(); ++i) {
    if (profile[i] < 0.2 * top_m || profile[i] > 0.8 * top_m) continue;
    const double at_m = static_cast<double>(i) * kCell_m;
    ++n, x += at_m, h += profile[i], xx += at_m * at_m, xh += at_m * profile[i];
  }
  if (n < 5) throw Error(fmt::format("a slope of {} cells of {} m is too short", n, kCell_m));
  return -std::atan((n * xh - x * h) / (n * xx - x * x)) * 180 / std::numbers::pi;
}

// How far a deposit reaches: where its mean height is still half a grain.
double Front_m(const Profile& profile, double grain_m) {
  size_t last = profile.size();
  while (last > 0 && profile[last - 1] < grain_m / 2) --last;
  return static_cast<double>(last) * kCell_m;
}

GrainCheck Repose(std::string name, double measured_deg) {
  return {std::move(name),
          "deg",
          measured_deg,
          kRepose_deg - kReposeSpread_deg,
          kRepose_deg + kReposeSpread_deg,
          "dry sand"};
}

// A settled block between smooth side walls, its end at high x open: the box goes on to `end_m`.
DemScene OpenedBlock(const DemConfig& config, const SandBlock& block, double end_m, uint64_t seed,
                     const std::function<bool()>& stop) {
  GrainBed bed = SettledBed(config, block.length_m, block.width_m, block.height_m, seed, stop);
  std::erase_if(bed.grains, [&](const Grain& g) { return g.z_m + g.radius_m > block.height_m; });
  DemScene scene{{0, 0}, {end_m, block.width_m}, {true, true}, {false, true}, bed.grains, {}, {}};
  scene.held.assign(scene.grains.size(), 0);
  scene.wall_friction = 0;
  scene.gate = DemGate{block.length_m};
  return scene;
}

DemConfig Patient(DemConfig config) {
  config.settle_s = kWait_s;
  return config;
}

// A loose cluster over the middle of a box, its lowest layer at `bottom_m`.
void AddPortion(const GrainMaterial& material, double x_m, double y_m, double bottom_m,
                RandomStream& stream, DemScene& scene) {
  constexpr double kPitch = 1.22, kRadius = 3.3, kShift = 0.05;  // [diameters]
  constexpr int kLayers = 5;
  const double pitch_m = kPitch * material.grain_m;
  for (int layer = 0; layer < kLayers; ++layer) {
    for (int row = -3; row <= 3; ++row) {
      for (int column = -3; column <= 3; ++column) {
        if (std::hypot(row, column) * kPitch > kRadius) continue;
        const double radius_m = material.grain_m / 2 *
                                (1 + stream.Uniform(-material.grain_spread, material.grain_spread));
        const double dx_m = stream.Uniform(-kShift, kShift) * material.grain_m;
        const double dy_m = stream.Uniform(-kShift, kShift) * material.grain_m;
        scene.grains.push_back({x_m + column * pitch_m + dx_m, y_m + row * pitch_m + dy_m,
                                bottom_m + (layer + 0.5) * pitch_m, radius_m});
      }
    }
  }
}

// Energy over a run without a blade, as shares of what it lost.
std::vector<GrainCheck> EnergyChecks(const std::string& scene, const DemReport& report) {
  const auto total = [](const DemSample& s) { return s.kinetic_j + s.height_j + s.spring_j; };
  const std::vector<DemSample>& samples = report.samples;
  const double lost_j = total(samples.front()) - total(samples.back());
  double rise_j = 0, kinetic_j = 0;
  for (size_t i = 1; i < samples.size(); ++i) {
    rise_j = std::max(rise_j, total(samples[i]) - total(samples[i - 1]));
    kinetic_j = std::max(kinetic_j, samples[i].kinetic_j);
  }
  return {{scene + ", largest rise of energy / energy lost", "1", rise_j / lost_j, 0, 0.01,
           "friction and damping only take"},
          {scene + ", kinetic energy at the end / its peak", "1",
           samples.back().kinetic_j / kinetic_j, 0, 1e-3, "sand comes to rest"},
          {scene + ", grains lost", "grains", static_cast<double>(report.grains_lost), 0, 0,
           "none may vanish"}};
}

}  // namespace

GrainCheck DrainedSlope(const DemConfig& config, const SandBlock& block, uint64_t seed,
                        const std::function<bool()>& stop) {
  DemScene scene = OpenedBlock(config, block, block.length_m, seed, stop);
  RunGrains(Patient(config), {}, scene, stop);
  return Repose("repose, drained slope", Slope_deg(AlongX(Surface(scene))));
}

GrainCheck PouredCone(const DemConfig& config, int portions, uint64_t seed,
                      const std::function<bool()>& stop) {
  const double grain_m = config.material.grain_m;
  const double side_m = std::ceil(60 * grain_m / kCell_m) * kCell_m;
  DemScene scene{{0, 0}, {side_m, side_m}, {false, false}, {false, false}, {}, {}, {}};
  RandomStream stream(seed, kPour);
  for (int i = 0; i < portions; ++i) {
    double apex_m = 0;
    for (const Grain& g : scene.grains) apex_m = std::max(apex_m, g.z_m + g.radius_m);
    AddPortion(config.material, side_m / 2, side_m / 2, apex_m + 3 * grain_m, stream, scene);
    scene.held.assign(scene.grains.size(), 0);
    RunGrains(Patient(config), {}, scene, stop);
    std::erase_if(scene.grains, [](const Grain& g) { return g.radius_m == 0; });
  }
  return Repose(fmt::format("repose, poured cone of {} grains", scene.grains.size()),
                Slope_deg(AlongRadius(Surface(scene), scene.grains)));
}

std::vector<GrainCheck> ChannelCollapse(const DemConfig& config, const SandBlock& block,
                                        uint64_t seed, const std::function<bool()>& stop) {
  DemScene scene = OpenedBlock(config, block, 5 * block.length_m, seed, stop);
  const double length_m = block.length_m;
  const double aspect = block.height_m / length_m;
  const DemReport report = RunGrains(Patient(config), {}, scene, stop);
  const Profile after = AlongX(Surface(scene));
  const std::string name = fmt::format("channel collapse, aspect {:.2g}", aspect);
  const double height = std::min(aspect, std::cbrt(aspect));
  std::vector<GrainCheck> checks = {
      {name + ", run-out / length", "1",
       (Front_m(after, config.material.grain_m) - length_m) / length_m,
       1.2 * aspect * (1 - kSpread), 1.6 * aspect * (1 + kSpread),
       "1.2 a (Lajeunesse 2005) to 1.6 a (Lube 2005), 15 %"},
      {name + ", height / length", "1", *std::ranges::max_element(after) / length_m,
       height * (1 - kSpread), height * (1 + kSpread), "a, a^(1/3) (Lajeunesse 2005), 15 %"}};
  std::ranges::move(EnergyChecks(name, report), std::back_inserter(checks));
  return checks;
}

std::vector<GrainCheck> ColumnCollapse(const DemConfig& config, double radius_m, double height_m,
                                       uint64_t seed, const std::function<bool()>& stop) {
  GrainBed bed = SettledBed(config, 2 * radius_m, 2 * radius_m, height_m, seed, stop);
  std::erase_if(bed.grains, [&](const Grain& g) {
    return std::hypot(g.x_m - radius_m, g.y_m - radius_m) + g.radius_m > radius_m ||
           g.z_m + g.radius_m > height_m;
  });
  const double aspect = height_m / radius_m, middle_m = 5 * radius_m;
  DemScene scene{{0, 0}, {2 * middle_m, 2 * middle_m}, {false, false}, {false, false}, {}, {}, {}};
  for (Grain g : bed.grains) {
    g.x_m += middle_m - radius_m, g.y_m += middle_m - radius_m;
    scene.grains.push_back(g);
  }
  scene.held.assign(scene.grains.size(), 0);
  scene.gate = DemGate{middle_m, middle_m, radius_m};
  RunGrains(Patient(config), {}, scene, stop);
  const Profile after = AlongRadius(Surface(scene), scene.grains);
  const std::string name = fmt::format("column collapse, aspect {:.2g}", aspect);
  const double lube = aspect < 1 ? aspect : 0.88 * std::pow(aspect, 1.0 / 6);
  return {{name + ", run-out / radius", "1",
           (Front_m(after, config.material.grain_m) - radius_m) / radius_m, aspect * (1 - kSpread),
           1.24 * aspect * (1 + kSpread), "a (Lajeunesse 2004) to 1.24 a (Lube 2004), 15 %"},
          {name + ", height / radius", "1", *std::ranges::max_element(after) / radius_m,
           std::min(aspect, 0.74) * (1 - kSpread), lube * (1 + kSpread),
           "0.74 (Lajeunesse 2004) to 0.88 a^(1/6) (Lube 2004), 15 %"}};
}

}  // namespace sandwright
