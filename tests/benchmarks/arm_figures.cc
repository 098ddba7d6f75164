// Figures of the arm: inverse kinematics, gate, planning, path error, reach. Writes JSON to stdout:
//
//   arm_figures WORKCELL.yaml STROKES REACH_MAP.png > arm.json
//
// STROKES random strokes are gated coarsely, and finely where the coarse sampling accepts them.
#include <spdlog/fmt/fmt.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <iostream>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "data/base/machine.h"
#include "data/base/parallel.h"
#include "data/picture.h"
#include "robot_model/plan.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Best of five rounds: the machine does other things, too.
template <class Work>
double BestSeconds(int repetitions, const Work& work) {
  double best = 1e9;
  for (int round = 0; round < 5; ++round) {
    const double start = Seconds();
    for (int i = 0; i < repetitions; ++i) work(i);
    best = std::min(best, (Seconds() - start) / repetitions);
  }
  return best;
}

HeightMap FlatSand(const Workcell& cell) {
  return HeightMap(static_cast<int>(std::lround(cell.box.depth_m / 0.01)),
                   static_cast<int>(std::lround(cell.box.width_m / 0.01)), 0.01, 0.05f);
}

nlohmann::json KinematicsFigures() {
  const Ur10 arm;
  RandomStream random(1);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 2000; ++i) {
    JointAngles q;
    for (double& angle : q.rad) angle = random.Uniform(-3.14, 3.14);
    poses.push_back(arm.Forward(q));
  }
  double worst = 0;
  size_t solutions = 0;
  for (const auto& X : poses)
    for (const auto& s : arm.Inverse(X)) {
      ++solutions;
      if (!s.near_singular)
        worst = std::max(worst, (arm.Forward(s.q).matrix() - X.matrix()).cwiseAbs().maxCoeff());
    }
  volatile size_t sink = 0;
  const double ik_s = BestSeconds(
      2000, [&](int i) { sink = sink + arm.Inverse(poses[static_cast<size_t>(i)]).size(); });
  return {{"ik_all_branches_us", ik_s * 1e6},
          {"ik_worst_error_m", worst},
          {"ik_mean_branches", static_cast<double>(solutions) / static_cast<double>(poses.size())}};
}

nlohmann::json GateFigures(const SafetyGate& gate, const HeightMap& terrain, int strokes) {
  const Workcell& cell = gate.workcell();
  const Stroke line = TypicalStroke(cell.box.width_m / 2, cell.box.depth_m / 2, 0.3);
  Stroke curve = line;
  curve.degree = 2;
  curve.control_points_m.insert(
      curve.control_points_m.begin() + 1,
      Eigen::Vector3d(cell.box.width_m / 2, cell.box.depth_m / 2 + 0.04, 0.02));
  const auto time = [&](const Stroke& stroke, GateSampling sampling, int repetitions) {
    return 1e3 * BestSeconds(repetitions, [&](int) { gate.Check(stroke, terrain, sampling); });
  };
  std::vector<Stroke> some;
  for (double x : {0.4, 0.5, 0.6})
    some.push_back(TypicalStroke(x * cell.box.width_m, 0.5 * cell.box.depth_m, x, 0.08));
  const double plan_s = BestSeconds(3, [&](int) { CheckPlan(gate, some, terrain); });
  std::atomic<int> coarse = 0, refused = 0;
  double error = 0;
  std::mutex mutex;
  ParallelFor(strokes, 2, [&](int i) {
    RandomStream random(2026, StreamId("arm_figures"), static_cast<uint64_t>(i));
    const Stroke stroke = RandomStroke(cell.box.width_m, cell.box.depth_m, random);
    if (!gate.Check(stroke, terrain, GateSampling::kCoarse).accepted) return;
    ++coarse;
    const GateVerdict fine = gate.Check(stroke, terrain, GateSampling::kFine);
    if (!fine.accepted) ++refused;
    if (!fine.motion || i % 50 != 0) return;
    const double worst = PathError(*fine.motion, gate.kinematics(), stroke);
    const std::lock_guard lock(mutex);
    error = std::max(error, worst);
  });
  return {{"gate_coarse_line_ms", time(line, GateSampling::kCoarse, 100)},
          {"gate_coarse_curve_ms", time(curve, GateSampling::kCoarse, 100)},
          {"gate_fine_line_ms", time(line, GateSampling::kFine, 10)},
          {"gate_fine_curve_ms", time(curve, GateSampling::kFine, 10)},
          {"plan_ms_per_stroke", 1e3 * plan_s / 3},
          {"random_strokes", strokes},
          {"coarse_accepted", coarse.load()},
          {"coarse_accepted_fine_refused", refused.load()},
          {"worst_path_error_mm", error * 1e3}};
}

// Share of headings of a 120 mm stroke around each cell that the gate accepts, as a picture.
nlohmann::json ReachFigures(const SafetyGate& gate, const HeightMap& terrain,
                            const std::string& picture) {
  constexpr double kCell_m = 0.02, kLength_m = 0.12;
  constexpr int kHeadings = 16, kPixels = 16;
  const Workcell& cell = gate.workcell();
  const int columns = static_cast<int>(std::lround(cell.box.width_m / kCell_m));
  const int rows = static_cast<int>(std::lround(cell.box.depth_m / kCell_m));
  std::vector<int> accepted(static_cast<size_t>(rows * columns)), fits(accepted.size());
  ParallelFor(rows * columns, 2, [&](int i) {
    const double x = (i % columns + 0.5) * kCell_m, y = (i / columns + 0.5) * kCell_m;
    for (int h = 0; h < kHeadings; ++h) {
      const auto verdict =
          gate.Check(TypicalStroke(x, y, 2 * std::numbers::pi * h / kHeadings, kLength_m), terrain,
                     GateSampling::kCoarse);
      const bool wall =
          !verdict.reasons.empty() && verdict.reasons.front().find("box wall") != std::string::npos;
      accepted[static_cast<size_t>(i)] += verdict.accepted;
      fits[static_cast<size_t>(i)] += !wall;
    }
  });
  cv::Mat map(rows, columns, CV_8UC1);
  int all = 0, inside = 0;
  for (int i = 0; i < rows * columns; ++i) {
    all += accepted[static_cast<size_t>(i)], inside += fits[static_cast<size_t>(i)];
    map.at<uchar>(rows - 1 - i / columns, i % columns) =
        static_cast<uchar>(255 * accepted[static_cast<size_t>(i)] / kHeadings);
  }
  cv::Mat colour;
  cv::applyColorMap(map, colour, cv::COLORMAP_VIRIDIS);
  cv::resize(colour, colour, {}, kPixels, kPixels, cv::INTER_NEAREST);
  // Below the box: the arm's base, drawn to scale.
  const Eigen::Vector3d base = cell.X_WB.ToIsometry().inverse().translation();
  const int below = static_cast<int>((std::max(0.0, -base.y()) + 0.1) / kCell_m * kPixels);
  cv::copyMakeBorder(colour, colour, 50, below, 20, 20, cv::BORDER_CONSTANT, {255, 255, 255});
  const cv::Point at(20 + static_cast<int>(base.x() / kCell_m * kPixels),
                     50 + rows * kPixels + static_cast<int>(-base.y() / kCell_m * kPixels));
  cv::circle(colour, at, static_cast<int>(0.075 / kCell_m * kPixels), {120, 90, 60}, cv::FILLED,
             cv::LINE_AA);
  const auto write = [&](const std::string& text, cv::Point where) {
    cv::putText(colour, text, where, cv::FONT_HERSHEY_SIMPLEX, 0.6, {40, 40, 40}, 1, cv::LINE_AA);
  };
  const double cells = static_cast<double>(rows) * columns * kHeadings;
  write(
      fmt::format(
          "120 mm strokes, 16 headings a cell: {:.1f} % of all, {:.1f} % of those inside the walls",
          100 * all / cells, 100.0 * all / inside),
      {20, 30});
  write("UR10 base", at + cv::Point(80, 5));
  WritePicture(colour, picture);
  return {{"reachable_share_of_box", all / cells},
          {"reachable_share_of_what_the_walls_allow", 1.0 * all / inside},
          {"reach_stroke_length_m", kLength_m},
          {"reach_cell_m", kCell_m},
          {"reach_headings", kHeadings}};
}

}  // namespace

int Main(int argc, char** argv) {
  if (argc != 4) throw Error("usage: arm_figures WORKCELL.yaml STROKES REACH_MAP.png");
  const Workcell cell = LoadWorkcell(argv[1]);
  const SafetyGate gate(cell);
  const HeightMap terrain = FlatSand(cell);
  nlohmann::json result = KinematicsFigures();
  result.update(GateFigures(gate, terrain, std::stoi(argv[2])));
  result.update(ReachFigures(gate, terrain, argv[3]));
  result["workcell"] = cell.name;
  result["command"] = fmt::format("arm_figures {} {} {}", argv[1], argv[2], argv[3]);
  result["machine"] = MachineDescription();
  std::cout << result.dump(2) << "\n";
  return 0;
}

}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
