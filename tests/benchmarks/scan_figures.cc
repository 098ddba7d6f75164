// Figures of the scan: shaped beds seen by the camera model, their box not given, and real frames.
//
//   scan_figures SEEDS OUT.json
//
// SEEDS beds of each kind and box. Real frames are skipped where the folder of scans is absent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numeric>

#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "tests/support/shared_data.h"
#include "tests/support/simulated_beds.h"
#include "tests/support/tag_corners.h"

namespace sandwright {
namespace {

constexpr double kMaxTilt_deg = 7;
constexpr uint64_t kFirstSeed = 1000;  // beds that no limit of the scan was chosen on

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const double place = share * static_cast<double>(values.size() - 1);
  return values[static_cast<size_t>(std::lround(place))];
}

// Processor time of this process [s]: other work on the machine does not lengthen it.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// What the scans of some beds came to.
struct Tally {
  int beds = 0, accepted = 0, warned = 0;
  std::vector<double> corner_mm;  // of the accepted: their worst corner

  void Add(const SimulatedBed& bed, const ScanResult& scan) {
    ++beds;
    if (!scan.accepted) return;
    ++accepted;
    warned += !scan.warnings.empty();
    corner_mm.push_back(1000 * WorstCorner(bed, scan.corners_C));
  }
  nlohmann::json Json() const {
    const auto far = std::ranges::count_if(corner_mm, [](double mm) { return mm > 10; });
    return {{"beds", beds},
            {"accepted", accepted},
            {"accepted_with_a_warning", warned},
            {"accepted_with_a_corner_beyond_10_mm", far},
            {"worst_corner_median_mm", Quantile(corner_mm, 0.5)},
            {"worst_corner_p95_mm", Quantile(corner_mm, 0.95)},
            {"worst_corner_max_mm", Quantile(corner_mm, 1)}};
  }
};

nlohmann::json SimulatedFigures(int seeds) {
  nlohmann::json rows;
  Tally all;
  std::vector<double> seconds;
  for (const bool large_box : {true, false}) {
    for (const std::string_view kind : kBedKinds) {
      Tally tally;
      for (int seed = 0; seed < seeds; ++seed) {
        BedView view;
        view.max_tilt_deg = kMaxTilt_deg;
        view.any_heading = !large_box;
        const auto bed = DrawBed(kind, large_box, kFirstSeed + static_cast<uint64_t>(seed), view);
        const double start = CpuSeconds();
        const ScanResult scan = ScanDepth({&bed.frame, 1}, CameraModel{}, {});
        seconds.push_back(CpuSeconds() - start);
        tally.Add(bed, scan);
        all.Add(bed, scan);
      }
      nlohmann::json row = tally.Json();
      row["sand"] = kind;
      row["box_mm"] = large_box ? "1200 x 800" : "300 x 300";
      rows.push_back(row);
    }
  }
  nlohmann::json result = all.Json();
  result["what"] = fmt::format(
      "neither box nor pose given; camera tilted by up to {} degrees, turned by up to 12 degrees "
      "(large box) or at random (small box); sensor noise and holes on; first seed {}",
      kMaxTilt_deg, kFirstSeed);
  result["cpu_seconds_median"] = Quantile(seconds, 0.5);
  result["by_sand"] = rows;
  return result;
}

// What a scan with the camera's true pose leaves on maps of `cell_size_m`: the values of env/sensor.h.
nlohmann::json SensorFigures(int seeds, bool large_box, double cell_size_m) {
  double square = 0, beside = 0, shares = 0, means = 0;
  size_t cells = 0, pairs = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto bed = DrawBed("dunes", large_box, kFirstSeed + static_cast<uint64_t>(seed));
    const ScanPlace place{.box_size_m = Eigen::Vector2d(bed.sand.width_m(), bed.sand.depth_m()),
                          .X_BC = bed.X_BC};
    ScanConfig config;
    config.cell_size_m = cell_size_m;
    const HeightMap seen = ScanDepth({&bed.frame, 1}, CameraModel{}, config, place).map;
    const HeightMap truth = Resample(bed.sand, cell_size_m);
    std::vector<double> error;
    for (size_t i = 0; i < seen.size(); ++i) error.push_back(seen.height_m[i] - truth.height_m[i]);
    const double mean =
        std::accumulate(error.begin(), error.end(), 0.0) / static_cast<double>(error.size());
    means += mean * mean;
    for (size_t i = 0; i < seen.size(); ++i) {
      square += std::pow(error[i] - mean, 2);
      if ((i + 1) % static_cast<size_t>(seen.columns) == 0) continue;
      beside += (error[i] - mean) * (error[i + 1] - mean);
      ++pairs;
    }
    cells += seen.size();
    shares += static_cast<double>(std::ranges::count(seen.valid, 0)) /
              static_cast<double>(seen.size());
  }
  const double variance = square / static_cast<double>(cells);
  return {{"box_mm", large_box ? "1200 x 800" : "300 x 300"},
          {"cell_size_m", cell_size_m},
          {"noise_m", std::sqrt(variance)},
          {"correlation_of_neighbours", beside / static_cast<double>(pairs) / variance},
          {"offset_m", std::sqrt(means / seeds)},
          {"hole_share", shares / seeds}};
}

// Distances in plan from the inner corners that the corner tags of the infrared frame show [mm].
nlohmann::json TagCornerErrors(const ScanResult& scan) {
  const auto feet = TagCorners();
  nlohmann::json errors;
  for (size_t i = 0; i < 4; ++i)
    errors.push_back(1000 * (scan.corners_C[i].head<2>() - feet[i]).norm());
  return errors;
}

nlohmann::json RealFigures() {
  const auto file = SharedFile("data/scans/kinect2_depth_levelled_box.npy");
  if (!std::filesystem::exists(file)) return "skipped: the folder of real scans is absent";
  const DepthFrame frame = ReadDepthFrame(file);
  std::vector<double> seconds;
  ScanResult scan;
  for (int round = 0; round < 5; ++round) {
    const double start = CpuSeconds();
    scan = ScanDepth({&frame, 1}, CameraModel{}, {});
    seconds.push_back(CpuSeconds() - start);
  }
  const auto invalid = std::ranges::count(frame.depth_m, 0.0f);
  return {{"frame", file.filename()},
          {"accepted", scan.accepted},
          {"cpu_seconds_median", Quantile(seconds, 0.5)},
          {"noise_mm", scan.noise_mm},
          {"invalid_share_frame",
           static_cast<double>(invalid) / static_cast<double>(frame.depth_m.size())},
          {"invalid_share_box", scan.invalid_share},
          {"interpolated_share", scan.interpolated_share},
          {"tilt_removed_deg", scan.tilt_removed_deg},
          {"corner_errors_mm", TagCornerErrors(scan)}};
}

}  // namespace

void Main(int seeds, const char* file) {
  nlohmann::json result = {{"command", fmt::format("scan_figures {} {}", seeds, file)},
                                 {"commit", BuildCommit()},
                                 {"machine", MachineDescription()},
                                 {"threads_used", 1},
                                 {"simulated_beds", SimulatedFigures(seeds)},
                                 {"real_frame", RealFigures()}};
  for (const bool large_box : {true, false}) {
    for (const double cell_size_m : {0.004, 0.01})
      result["sensor"].push_back(SensorFigures(seeds, large_box, cell_size_m));
  }
  WriteFileAtomically(file, result.dump(2) + "\n");
}

}  // namespace sandwright

int main(int argc, char** argv) {
  if (argc != 3 || std::atoi(argv[1]) < 1) {
    fmt::print(stderr, "usage: scan_figures SEEDS OUT.json (SEEDS >= 1)\n");
    return 2;
  }
  try {
    sandwright::Main(std::atoi(argv[1]), argv[2]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
  return 0;
}
