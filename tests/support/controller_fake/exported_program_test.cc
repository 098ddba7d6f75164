// The exported program, run by the fake controller, draws the strokes that were planned.
#include <gtest/gtest.h>

#include <algorithm>

#include "robot_model/plan.h"
#include "robot_model/urscript.h"
#include "tests/support/controller_fake/offline_run.h"

namespace sandwright {
namespace {

constexpr double kMostStray_m = 0.3e-3;
constexpr double kAtTheEnd_m = 2e-5;  // poses in the program have five decimals

std::vector<Stroke> AllKinds() {
  return {
      // A line, a line that climbs.
      {{{0.45, 0.40, 0.03}, {0.60, 0.40, 0.03}}, 1, 0.1},
      {{{0.45, 0.30, 0.02}, {0.60, 0.35, 0.05}}, 1, 0.15},
      // Corners, one with a step in height.
      {{{0.55, 0.35, 0.03}, {0.65, 0.35, 0.025}, {0.65, 0.45, 0.03}}, 1, 0.1},
      {{{0.50, 0.30, 0.03}, {0.58, 0.38, 0.05}, {0.66, 0.32, 0.02}, {0.70, 0.40, 0.04}}, 1, 0.08},
      // Curves, level and not.
      {{{0.40, 0.30, 0.03}, {0.45, 0.34, 0.03}, {0.50, 0.30, 0.03}}, 2, 0.08},
      {{{0.50, 0.45, 0.05}, {0.60, 0.36, 0.02}, {0.70, 0.45, 0.05}}, 2, 0.12},
      {{{0.42, 0.42, 0.03}, {0.50, 0.50, 0.03}, {0.58, 0.34, 0.04}, {0.64, 0.42, 0.03}}, 2, 0.1},
  };
}

double DistanceToLine(const Eigen::Vector3d& p, const std::vector<Eigen::Vector3d>& line) {
  double nearest = 1e9;
  for (size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector3d step = line[i] - line[i - 1];
    const double square = step.squaredNorm();
    const double t =
        square > 0 ? std::clamp((p - line[i - 1]).dot(step) / square, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (line[i - 1] + t * step - p).norm());
  }
  return nearest;
}

struct Stray {
  double drawn_m = 0;    // of what was drawn from what was planned
  double planned_m = 0;  // the other way round
  size_t end = 0;        // where in the trace the path ends
};

// `drawn` from `begin` on comes to the path's start, follows it, and leaves at its end.
Stray Compare(const std::vector<Eigen::Vector3d>& drawn, size_t begin,
              const std::vector<Eigen::Vector3d>& planned) {
  const auto first = std::find_if(drawn.begin() + begin, drawn.end(), [&](const auto& p) {
    return (p - planned.front()).norm() < kAtTheEnd_m;
  });
  const auto last = std::find_if(first, drawn.end(), [&](const auto& p) {
    return (p - planned.back()).norm() < kAtTheEnd_m;
  });
  EXPECT_TRUE(first != drawn.end() && last != drawn.end());
  if (last == drawn.end()) return {1, 1, drawn.size()};
  const std::vector<Eigen::Vector3d> path(first, last + 1);
  Stray stray;
  for (const auto& p : path) stray.drawn_m = std::max(stray.drawn_m, DistanceToLine(p, planned));
  for (const auto& p : planned)
    stray.planned_m = std::max(stray.planned_m, DistanceToLine(p, path));
  stray.end = last - drawn.begin();
  return stray;
}

void ExpectPlannedPaths(const Workcell& cell) {
  const HeightMap terrain(80, 120, 0.01, 0.05f);
  const SafetyGate gate(cell);
  const auto strokes = AllKinds();
  const PlanVerdict verdict = CheckPlan(gate, strokes, terrain);
  ASSERT_TRUE(verdict.accepted) << ::testing::PrintToString(verdict.reasons);

  ControllerFakeOptions options;
  options.dh = cell.kinematics;
  options.start = cell.home();
  fake::ControllerCore core(options);
  ASSERT_TRUE(fake::RunToEnd(core, MakeUrScript(strokes, verdict, gate, "all_kinds")));
  ASSERT_FALSE(core.last_fault()) << core.last_fault()->line << ": " << core.last_fault()->text;

  const auto position = [&](const JointAngles& q) -> Eigen::Vector3d {
    return gate.kinematics().BladeInBox(q).translation();
  };
  std::vector<Eigen::Vector3d> drawn;
  for (const auto& point : core.trace()) drawn.push_back(position(point.q));
  size_t at = 0;
  for (size_t i = 0; i < strokes.size(); ++i) {
    const StrokeMotion& motion = *verdict.strokes[i].motion;
    std::vector<Eigen::Vector3d> planned;
    for (size_t k = motion.path_begin; k < motion.path_end; ++k)
      planned.push_back(position(motion.knots[k]));
    const Stray stray = Compare(drawn, at, planned);
    EXPECT_LE(stray.drawn_m, kMostStray_m) << "stroke " << i;
    EXPECT_LE(stray.planned_m, kMostStray_m) << "stroke " << i;
    at = stray.end;
  }
  EXPECT_LT((core.state().q.rad - cell.home().rad).norm(), 1e-5);
}

TEST(ExportedProgram, TracesThePlannedPaths) { ExpectPlannedPaths(Workcell{}); }

TEST(ExportedProgram, TracesThemWithACalibratedArm) {
  Workcell cell;
  cell.kinematics.theta_rad = {0, 0.0014, -0.0021, 0.0009, 0.0003, 0};
  cell.kinematics.a_m = {0.0001, -0.6127, -0.5718, -0.0002, 0.0001, 0};
  cell.kinematics.alpha_rad[1] = 0.0011;
  cell.kinematics.alpha_rad[2] = -0.0008;
  ExpectPlannedPaths(cell);
}

}  // namespace
}  // namespace sandwright
