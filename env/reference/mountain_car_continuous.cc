// A car that must swing up a hill (Moore 1990), with a continuous force. The reward charges the raw action.
#include <cmath>

#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

constexpr double kLowest = -1.2, kHighest = 0.6, kFastest = 0.07, kGoal = 0.45;

// One step in the precision that Gymnasium takes it in: its state is float64 after a reset and float32 after
// each step, and numpy rounds Python's numbers to the precision of the array that they meet.
template <class Real>
void Move(float action, Real& position, Real& velocity) {
  constexpr double kPower = 0.0015;
  const double slope = 0.0025 * std::cos(static_cast<double>(Real(3) * position));
  if (action < -1 || action > 1)
    velocity += static_cast<Real>((action > 0 ? 1.0 : -1.0) * kPower - slope);
  else
    velocity += static_cast<Real>(action * static_cast<float>(kPower) - static_cast<float>(slope));
  const auto fastest = static_cast<Real>(kFastest);
  if (velocity > fastest) velocity = fastest;
  if (velocity < -fastest) velocity = -fastest;
  position += velocity;
  if (position > static_cast<Real>(kHighest)) position = static_cast<Real>(kHighest);
  if (position <= static_cast<Real>(kLowest)) {
    position = static_cast<Real>(kLowest);
    if (velocity < 0) velocity = 0;
  }
}

class MountainCarContinuous final : public ReferenceTask {
 public:
  const ReferenceSpec& spec() const override {
    static const ReferenceSpec spec = {
        "MountainCarContinuous-v0", {"position", "velocity"}, 0, 1, 1, 999};
    return spec;
  }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    start_ = random.Uniform(-0.6, -0.4);
    fresh_ = true;
    position_ = static_cast<float>(start_);
    velocity_ = 0;
    observation[0] = position_;
    observation[1] = velocity_;
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    bool there;
    if (fresh_) {
      double position = start_, velocity = 0;
      Move(action[0], position, velocity);
      there = position >= kGoal && velocity >= 0;
      position_ = static_cast<float>(position);
      velocity_ = static_cast<float>(velocity);
      fresh_ = false;
    } else {
      Move(action[0], position_, velocity_);
      there = position_ >= static_cast<float>(kGoal) && velocity_ >= 0;
    }
    observation[0] = position_;
    observation[1] = velocity_;
    const double raw = action[0];
    return {(there ? 100.0 : 0.0) - raw * raw * 0.1, there};
  }

 private:
  double start_ = 0;
  bool fresh_ = false;
  float position_ = 0, velocity_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceTask> MakeMountainCarContinuous() {
  return std::make_unique<MountainCarContinuous>();
}

}  // namespace sandwright
