// What the safety gate has let through: the only thing that an arm executes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/stroke.h"
#include "robot_model/stroke_motion.h"

namespace sandwright {

// At which a buried blade is lifted.
inline constexpr double kLiftSpeed_mps = 0.02;

// A motion of the whole arm that the gate has checked from its first to its last knot. Only
// SafetyGate makes one, so that whatever takes a GatedMotion cannot be given anything else.
class GatedMotion {
 public:
  enum class Kind {
    kStroke,    // a transfer to the entry, then down, along the path, up
    kTransfer,  // a straight joint move above the sand
    kLift,      // straight up out of the sand, after a stop
  };

  Kind kind() const { return kind_; }
  // StrokeMotion::kPeriod_s apart, from where the arm stands to where it will stand.
  const std::vector<JointAngles>& knots() const { return knots_; }
  const JointAngles& start() const { return knots_.front(); }
  const JointAngles& end() const { return knots_.back(); }
  double duration_s() const {
    return static_cast<double>(knots_.size() - 1) * StrokeMotion::kPeriod_s;
  }

  // kStroke only.
  const Stroke& stroke() const { return stroke_.value(); }
  const StrokeMotion& stroke_motion() const { return motion_.value(); }
  // The knot at which stroke_motion() begins.
  size_t stroke_begin() const { return knots_.size() - stroke_motion().knots.size(); }

 private:
  friend class SafetyGate;
  GatedMotion(Kind kind, std::vector<JointAngles> knots) : kind_(kind), knots_(std::move(knots)) {}

  Kind kind_;
  std::vector<JointAngles> knots_;
  std::optional<Stroke> stroke_;
  std::optional<StrokeMotion> motion_;
};

// The gate's answer to a motion from where the arm stands.
struct Passage {
  std::optional<GatedMotion> motion;  // none where it was refused
  std::vector<std::string> reasons;   // why; each with figure and limit
};

}  // namespace sandwright
