#include "robot_model/arm_bench.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "data/base/parallel.h"
#include "data/base/random.h"
#include "data/excavation.h"
#include "robot_model/plan.h"

namespace sandwright {
namespace {

constexpr double kCell_m = 0.01, kSand_m = 0.05;

template <class Work>
double BestSeconds(int repetitions, const Work& work) {
  using Clock = std::chrono::steady_clock;
  double best_s = 1e9;
  for (int round = 0; round < 5; ++round) {
    const auto start = Clock::now();
    for (int i = 0; i < repetitions; ++i) work(i);
    best_s = std::min(best_s, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best_s / repetitions;
}

HeightMap LevelSand(const BoxSettings& box) {
  return {WholeCells(box.depth_m, kCell_m, "box.depth_m"),
          WholeCells(box.width_m, kCell_m, "box.width_m"), kCell_m, static_cast<float>(kSand_m)};
}

// Straight, around (x, y), 30 mm deep.
Stroke Line(double x_m, double y_m, double heading_rad, double length_m) {
  const Eigen::Vector3d middle(x_m, y_m, kSand_m - 0.03),
      half = 0.5 * length_m * Eigen::Vector3d(std::cos(heading_rad), std::sin(heading_rad), 0);
  return {{middle - half, middle + half}, 1, 0.1};
}

nlohmann::json Kinematics(const Ur10& arm, uint64_t seed) {
  RandomStream random(seed);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 2000; ++i) {
    JointAngles q;
    for (double& angle : q.rad) angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
    poses.push_back(arm.Forward(q));
  }
  double worst = 0;
  size_t solutions = 0;
  for (const auto& X : poses) {
    for (const IkSolution& s : arm.Inverse(X)) {
      ++solutions;
      if (!s.near_singular)
        worst = std::max(worst, (arm.Forward(s.q).matrix() - X.matrix()).cwiseAbs().maxCoeff());
    }
  }
  volatile size_t sink = 0;
  const double seconds = BestSeconds(2000, [&](int i) {
    sink = sink + arm.Inverse(poses[static_cast<size_t>(i)]).size();
  });
  return {{"name", "inverse kinematics, all branches"},
          {"us_per_pose", 1e6 * seconds},
          {"worst_error_m", worst},
          {"branches", static_cast<double>(solutions) / static_cast<double>(poses.size())}};
}

nlohmann::json RandomStrokes(const SafetyGate& gate, const HeightMap& sand, const ArmBench& bench) {
  std::atomic<int64_t> coarse = 0, fine = 0, contradictions = 0;
  double error_m = 0;
  std::mutex mutex;
  ParallelFor(static_cast<int>(bench.strokes), bench.threads, [&](int i) {
    RandomStream random(bench.seed, StreamId("arm bench"), static_cast<uint64_t>(i));
    const Stroke stroke = DrawStroke({}, sand, random);
    const bool passes = gate.Check(stroke, sand, GateSampling::kCoarse).accepted;
    const GateVerdict verdict = gate.Check(stroke, sand, GateSampling::kFine);
    coarse += passes;
    fine += verdict.accepted;
    contradictions += passes && !verdict.accepted;
    if (!verdict.motion) return;
    const double worst_m = PathError(*verdict.motion, gate.kinematics(), stroke);
    const std::lock_guard lock(mutex);
    error_m = std::max(error_m, worst_m);
  });
  const auto share = [&](int64_t count) {
    return static_cast<double>(count) / static_cast<double>(bench.strokes);
  };
  return {{"name", "random strokes in the box"},
          {"strokes", bench.strokes},
          {"accepted_share", share(fine)},
          {"accepted_share_coarse", share(coarse)},
          {"coarse_accepted_fine_refused", contradictions.load()},
          {"worst_path_error_mm", 1e3 * error_m}};
}

}  // namespace

void RunArmBench(const SafetyGate& gate, const ArmBench& bench,
                 const std::function<void(const nlohmann::json&)>& report) {
  const BoxSettings& box = gate.workcell().box;
  const HeightMap sand = LevelSand(box);
  report(Kinematics(gate.kinematics().arm(), bench.seed));
  const Stroke line = Line(box.width_m / 2, box.depth_m / 2, 0.3, 0.12);
  Stroke curve = line;
  curve.degree = 2;
  curve.control_points_m.insert(
      curve.control_points_m.begin() + 1,
      Eigen::Vector3d(box.width_m / 2, box.depth_m / 2 + 0.04, kSand_m - 0.03));
  const auto gated = [&](const char* name, const Stroke& stroke, GateSampling sampling, int times) {
    const double s = BestSeconds(times, [&](int) { gate.Check(stroke, sand, sampling); });
    report({{"name", name}, {"ms_per_stroke", 1e3 * s}});
  };
  gated("gate, coarse, line", line, GateSampling::kCoarse, 100);
  gated("gate, coarse, curve", curve, GateSampling::kCoarse, 100);
  gated("gate, fine, line", line, GateSampling::kFine, 10);
  gated("gate, fine, curve", curve, GateSampling::kFine, 10);
  const JointAngles from = gate.workcell().camera_pose();
  const double pass_s = BestSeconds(10, [&](int) { (void)gate.PassStroke(line, sand, from); });
  report({{"name", "motion from the camera's pose, gated"}, {"ms_per_stroke", 1e3 * pass_s}});
  report(RandomStrokes(gate, sand, bench));
}

ReachPicture DrawReach(const SafetyGate& gate, int threads) {
  constexpr double kReachCell_m = 0.02, kLength_m = 0.12;
  constexpr int kHeadings = 16, kPixels = 16;
  const Workcell& cell = gate.workcell();
  const HeightMap sand = LevelSand(cell.box);
  const int columns = static_cast<int>(std::lround(cell.box.width_m / kReachCell_m));
  const int rows = static_cast<int>(std::lround(cell.box.depth_m / kReachCell_m));
  std::vector<int> accepted(static_cast<size_t>(rows * columns)), fits(accepted.size());
  ParallelFor(rows * columns, threads, [&](int i) {
    const double x = (i % columns + 0.5) * kReachCell_m, y = (i / columns + 0.5) * kReachCell_m;
    for (int h = 0; h < kHeadings; ++h) {
      const auto verdict = gate.Check(Line(x, y, 2 * std::numbers::pi * h / kHeadings, kLength_m),
                                      sand, GateSampling::kCoarse);
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
  ReachPicture reach{1.0 * all / (1.0 * rows * columns * kHeadings), 1.0 * all / inside, {}};
  cv::Mat colour;
  cv::applyColorMap(map, colour, cv::COLORMAP_VIRIDIS);
  cv::resize(colour, colour, {}, kPixels, kPixels, cv::INTER_NEAREST);
  const Eigen::Vector3d base = cell.X_WB.ToIsometry().inverse().translation();
  const int below = static_cast<int>((std::max(0.0, -base.y()) + 0.1) / kReachCell_m * kPixels);
  cv::copyMakeBorder(colour, colour, 50, below, 20, 20, cv::BORDER_CONSTANT, {255, 255, 255});
  const cv::Point at(20 + static_cast<int>(base.x() / kReachCell_m * kPixels),
                     50 + rows * kPixels + static_cast<int>(-base.y() / kReachCell_m * kPixels));
  cv::circle(colour, at, static_cast<int>(0.075 / kReachCell_m * kPixels), {120, 90, 60},
             cv::FILLED, cv::LINE_AA);
  const auto write = [&](const std::string& text, cv::Point where) {
    cv::putText(colour, text, where, cv::FONT_HERSHEY_SIMPLEX, 0.6, {40, 40, 40}, 1, cv::LINE_AA);
  };
  write(fmt::format("120 mm strokes, {} headings a cell: {:.1f} % of all, {:.1f} % of those inside "
                    "the walls",
                    kHeadings, 100 * reach.share_of_box, 100 * reach.share_inside_walls),
        {20, 30});
  write("UR10 base", at + cv::Point(80, 5));
  reach.picture = colour;
  return reach;
}

}  // namespace sandwright
