// A body that MuJoCo moves in the vertical plane, as Gymnasium steps it: what HalfCheetah and Hopper
// share. Gymnasium also computes forces after a step (mj_rnePostConstraint), which change nothing
// that is shown.
#pragma once

#include <span>

#include "robot_model/arm_model.h"

namespace sandwright {

// half_cheetah.xml and hopper.xml, compiled once for all environments.
const mjModel& HalfCheetahModel();
const mjModel& HopperModel();
inline constexpr int kHalfCheetahFrames = 5, kHopperFrames = 4;  // mj_step in a step

class MujocoBody {
 public:
  MujocoBody(const mjModel& model, int frames);

  // Joints and their rates; the first is the way along x.
  std::span<double> position() { return {data_->qpos, static_cast<size_t>(model_.nq)}; }
  std::span<double> rate() { return {data_->qvel, static_cast<size_t>(model_.nv)}; }

  // Clear takes the pose of the model, at rest; what is written over it counts from Start on.
  void Clear() { mj_resetData(&model_, data_.get()); }
  void Start() { mj_forward(&model_, data_.get()); }
  // Moves on under the motors' `control`; returns the mean speed along x [m/s].
  double Advance(std::span<const float> control);
  // Position without the first entry, then the rates within +-fastest.
  void Show(double fastest, std::span<float> observation);

 private:
  const mjModel& model_;
  MujocoData data_;
  int frames_;
};

// weight times the sum of squares, in float32 as Gymnasium has it.
float ControlCost(float weight, std::span<const float> control);

}  // namespace sandwright
