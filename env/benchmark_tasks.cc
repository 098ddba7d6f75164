#include "env/benchmark_tasks.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "data/base/parallel.h"
#include "data/scan.h"
#include "env/depth_camera.h"

namespace sandwright {
namespace {

constexpr int kDraws = 50;
constexpr double kLeastSand_m = 0.01;

std::string IdOf(const std::string& name) { return fmt::format("{}-{}", name, kBenchmarkVersion); }

RandomStream StreamOf(const std::string& name, int task) {
  return RandomStream(StreamId(IdOf(name)), kBenchmarkTasks, static_cast<uint64_t>(task));
}

// A goal of the set's difficulty on a terrain that stays as it is.
std::optional<Task> GoalWithin(const TaskConfig& config, const HeightMap& terrain,
                               RandomStream& stream) {
  for (int draw = 0; draw < kDraws; ++draw) {
    Task task = GenerateGoal(config, terrain, stream);
    const double error_m = GoalError(task.terrain, task.goal);
    if (error_m >= config.difficulty_low_m && error_m <= config.difficulty_high_m) return task;
  }
  return std::nullopt;
}

// The bed as the scan has it, seen from somewhere above; none where the scan refuses it.
std::optional<HeightMap> Scanned(const HeightMap& bed, double cell_size_m, RandomStream& stream) {
  // The middle of a Kinect v2's picture: the bed fills no more of it.
  const CameraModel camera{.width = 256, .height = 212, .cx_px = 128, .cy_px = 106};
  DepthCameraConfig scene;
  scene.wall_height_m = std::ranges::max(bed.height_m) + 0.03;
  Eigen::Isometry3d X_BC = CameraAbove(bed.width_m(), bed.depth_m(), stream.Uniform(0.7, 1.1));
  X_BC.translation() += Eigen::Vector3d(stream.Uniform(-0.03, 0.03), stream.Uniform(-0.03, 0.03), 0);
  const DepthFrame frame = DepthCamera(camera, X_BC, scene).Render(bed, stream);
  ScanConfig scan;
  scan.cell_size_m = cell_size_m;
  ScanResult result = ScanDepth({&frame, 1}, camera, scan,
                                {.box_size_m = Eigen::Vector2d(bed.width_m(), bed.depth_m()),
                                 .X_BC = X_BC});
  if (!result.accepted) return std::nullopt;
  result.map.valid.clear();
  return std::move(result.map);
}

Task ScannedTask(const TaskConfig& config, RandomStream& stream) {
  constexpr double kBedCell_m = 0.004;  // finer than a pixel
  for (int draw = 0; draw < kDraws; ++draw) {
    const HeightMap bed =
        GenerateTerrain(config.terrain, WholeCells(config.depth_m, kBedCell_m, "depth_m"),
                        WholeCells(config.width_m, kBedCell_m, "width_m"), kBedCell_m, stream);
    const auto terrain = Scanned(bed, config.cell_size_m, stream);
    if (!terrain) continue;
    if (auto task = GoalWithin(config, *terrain, stream)) return *std::move(task);
  }
  throw Error(fmt::format("no scanned bed in {} draws has a goal in range", kDraws));
}

// A piece of a scan, laid on its floor; none where sand would be missing.
std::optional<HeightMap> DrawPiece(const TaskConfig& config, const HeightMap& scan,
                                   RandomStream& stream) {
  const double room_x = scan.width_m() - config.width_m, room_y = scan.depth_m() - config.depth_m;
  if (room_x < 0 || room_y < 0) return std::nullopt;
  const double x_m = stream.Uniform(0, room_x), y_m = stream.Uniform(0, room_y);
  HeightMap piece =
      SampleOnto(scan, x_m, y_m, WholeCells(config.depth_m, config.cell_size_m, "depth_m"),
                 WholeCells(config.width_m, config.cell_size_m, "width_m"), config.cell_size_m);
  piece.datum = Datum::kFloor;
  const double lift_m = config.terrain.mean_depth_m -
                        std::accumulate(piece.height_m.begin(), piece.height_m.end(), 0.0) /
                            static_cast<double>(piece.size());
  for (float& h : piece.height_m) h = static_cast<float>(h + lift_m);
  if (std::ranges::min(piece.height_m) < kLeastSand_m) return std::nullopt;
  return piece;
}

}  // namespace

TaskConfig BenchmarkConfig(const std::string& name) {
  TaskConfig config;
  if (name == "easy") {
    config.difficulty_low_m = 0.003;
    config.difficulty_high_m = 0.006;
  } else if (name == "hard") {
    config.goals = {"mound", "crater", "trench", "ridge", "terrace", "letters", "letters"};
    config.terrain.strokes = 12;
    config.area_low = 0.5;
    config.difficulty_low_m = 0.006;
    config.difficulty_high_m = 0.012;
    config.max_strokes = 20;
  } else if (name == "scanned") {
    config.goals.push_back("letters");
    config.terrain.amplitude_m = 0.008;
    config.area_low = 0.5;
    config.difficulty_low_m = 0.003;
    config.difficulty_high_m = 0.012;
    config.max_strokes = 15;
  } else if (name == "real") {
    config.goals.push_back("letters");
    config.terrain.mean_depth_m = 0.08;
    config.difficulty_low_m = 0.003;
    config.difficulty_high_m = 0.020;
    config.max_strokes = 20;
  } else {
    throw Error(
        fmt::format("task set \"{}\" is unknown; allowed: {}", name, fmt::join(kBenchmarkNames, ", ")));
  }
  return config;
}

Benchmark MakeBenchmark(const std::string& name, int threads) {
  const TaskConfig config = BenchmarkConfig(name);
  SAND_CHECK(name != "real");
  Benchmark set{IdOf(name), std::vector<Task>(kBenchmarkSize)};
  ParallelFor(kBenchmarkSize, threads, [&](int i) {
    RandomStream stream = StreamOf(name, i);
    if (name != "scanned") {
      set.tasks[static_cast<size_t>(i)] = GenerateTask(config, stream);
      return;
    }
    TaskConfig bed = config;
    bed.terrain.strokes = i % 2 == 0 ? 0 : 8;
    set.tasks[static_cast<size_t>(i)] = ScannedTask(bed, stream);
  });
  return set;
}

Benchmark MakeRealBenchmark(std::span<const HeightMap> scans) {
  SAND_CHECK(!scans.empty());
  const TaskConfig config = BenchmarkConfig("real");
  Benchmark set{IdOf("real"), {}};
  for (int i = 0; i < kBenchmarkSize; ++i) {
    RandomStream stream = StreamOf("real", i);
    std::optional<Task> task;
    for (size_t draw = 0; !task && draw < kDraws * scans.size(); ++draw) {
      const auto piece =
          DrawPiece(config, scans[(static_cast<size_t>(i) + draw) % scans.size()], stream);
      if (piece) task = GoalWithin(config, *piece, stream);
    }
    if (!task)
      throw Error(fmt::format(
          "no piece of {:g} x {:g} m of the {} scans has {:.0f} mm of sand above its floor everywhere "
          "and a goal error of {:.0f} to {:.0f} mm",
          config.width_m, config.depth_m, scans.size(), 1e3 * kLeastSand_m,
          1e3 * config.difficulty_low_m, 1e3 * config.difficulty_high_m));
    set.tasks.push_back(*std::move(task));
  }
  return set;
}

}  // namespace sandwright
