// Swinging up a pendulum by a weak torque; the cost is that of the state before the step.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

class Pendulum final : public ReferenceTask {
 public:
  const ReferenceSpec& spec() const override {
    static const ReferenceSpec spec = {
        "Pendulum-v1", {"cos_angle", "sin_angle", "rate_radps"}, 0, 1, 2, 200};
    return spec;
  }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    angle_ = random.Uniform(-std::numbers::pi, std::numbers::pi);
    rate_ = random.Uniform(-1, 1);
    Show(observation);
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    constexpr double kGravity = 10, kStep_s = 0.05, kFastest = 8;
    constexpr float kTorque = 2;
    // Gymnasium's torque is a float32, and so is what is made of it alone.
    const float torque = std::clamp(action[0], -kTorque, kTorque);
    const double full = 2 * std::numbers::pi;
    double turned = std::fmod(angle_ + std::numbers::pi, full);
    if (turned < 0) turned += full;
    const double off = turned - std::numbers::pi;
    const double cost = off * off + 0.1 * (rate_ * rate_) +
                        static_cast<double>(0.001f * (torque * torque));
    const double faster = rate_ + (3 * kGravity / 2 * std::sin(angle_) +
                                   static_cast<double>(3.0f * torque)) *
                                      kStep_s;
    rate_ = std::clamp(faster, -kFastest, kFastest);
    angle_ = angle_ + rate_ * kStep_s;
    Show(observation);
    return {-cost, false};
  }

 private:
  void Show(std::span<float> observation) const {
    observation[0] = static_cast<float>(std::cos(angle_));
    observation[1] = static_cast<float>(std::sin(angle_));
    observation[2] = static_cast<float>(rate_);
  }

  double angle_ = 0, rate_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceTask> MakePendulum() { return std::make_unique<Pendulum>(); }

}  // namespace sandwright
