// A stroke as joint motion over time.
//
// The blade comes down vertically, follows the path, and goes up vertically. It works both ways
// round, so each pose of it can be reached with the flange turned by pi ("flipped") as well.
#pragma once

#include <optional>
#include <vector>

#include "data/stroke.h"
#include "robot_model/rest_to_rest.h"
#include "robot_model/ur10.h"
#include "robot_model/workcell.h"

namespace sandwright {

// Knots at a constant period; between them the joints move linearly.
struct StrokeMotion {
  static constexpr double kPeriod_s = 0.008;  // of the CB3 controller, 125 Hz

  std::vector<JointAngles> knots;
  // First knot of the path and one behind its last: before it the blade goes down, behind it up.
  size_t path_begin = 0, path_end = 0;
  Branch branch = 0;
  bool flipped = false;

  double duration_s() const {
    return knots.empty() ? 0 : static_cast<double>(knots.size() - 1) * kPeriod_s;
  }
};

// A stretch of blade motion from rest to rest: poses along a parameter sigma that grows with the
// distance and, where the blade turns while it moves, with the angle, so that a constant rate of
// sigma slows down in tight bends.
struct PathPiece {
  enum class Kind { kDown, kStraight, kTurn, kCurve, kUp };

  Kind kind;
  ToolPath poses;             // dense enough to be joined by straight lines
  std::vector<double> sigma;  // one a pose, from 0; m, rad for kTurn
  RestToRest timing;

  double length() const { return sigma.back(); }
  BladePose At(double sigma_value) const;
};

// How densely a curve is sampled: fine for motion, coarse where only its course matters.
enum class CurveSampling { kFine, kCoarse };

// Down, the path (a straight piece a segment with turns between them, or one curve), up.
std::vector<PathPiece> StrokePieces(const Stroke& stroke, const MotionSettings& settings,
                                    CurveSampling sampling = CurveSampling::kFine);

// Blade poses to flange poses and back, in one cell.
class BladeKinematics {
 public:
  explicit BladeKinematics(const Workcell& workcell);

  const Ur10& arm() const { return arm_; }
  // X_WF that holds the blade at `pose`, upright.
  Eigen::Isometry3d FlangePose(const BladePose& pose, bool flipped) const;
  // X_BT, the blade in the box, at the joint angles.
  Eigen::Isometry3d BladeInBox(const JointAngles& q) const;
  // Joint angles in whole turns nearest to `near`; none where the branch does not reach.
  std::optional<JointAngles> Solve(const BladePose& pose, Branch branch, bool flipped,
                                   const JointAngles& near) const;

 private:
  Ur10 arm_;
  Eigen::Isometry3d X_WB_, X_BW_, X_FT_, X_TF_;
};

// The whole motion in one branch at 125 Hz, starting in the turns nearest to `near`; none where a
// pose is out of the branch's reach.
std::optional<StrokeMotion> MakeStrokeMotion(const std::vector<PathPiece>& pieces,
                                             const BladeKinematics& kinematics, Branch branch,
                                             bool flipped, const JointAngles& near);

// Joint move from rest to rest at the settings' transfer speed: knots of kPeriod_s from `from` to
// `to`, both included, on the straight line between them.
std::vector<JointAngles> TransferKnots(const JointAngles& from, const JointAngles& to,
                                       const MotionSettings& settings);

// Largest distance [m] of the blade's edge from the path while the joints move
// linearly from knot to knot (looked at half-way).
double PathError(const StrokeMotion& motion, const BladeKinematics& kinematics,
                 const Stroke& stroke);

}  // namespace sandwright
