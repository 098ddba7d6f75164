// A pole on a cart (Barto, Sutton and Anderson 1983), Euler steps of 20 ms.
#include <cmath>
#include <numbers>

#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

class CartPole final : public ReferenceTask {
 public:
  const ReferenceSpec& spec() const override {
    static const ReferenceSpec spec = {
        "CartPole-v1", {"x_m", "x_rate_mps", "angle_rad", "angle_rate_radps"}, 2, 1, 1, 500};
    return spec;
  }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    for (double* value : {&x_, &x_rate_, &angle_, &angle_rate_}) *value = random.Uniform(-0.05, 0.05);
    Show(observation);
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    constexpr double kGravity = 9.8, kCart = 1.0, kPole = 0.1, kHalfLength = 0.5, kForce = 10.0,
                     kStep_s = 0.02;
    constexpr double kMass = kPole + kCart, kMoment = kPole * kHalfLength;
    constexpr double kFarthest = 2.4, kSteepest = 12 * 2 * std::numbers::pi / 360;
    const double force = action[0] == 1 ? kForce : -kForce;
    const double c = std::cos(angle_), s = std::sin(angle_);
    const double push = (force + kMoment * (angle_rate_ * angle_rate_) * s) / kMass;
    const double turn = (kGravity * s - c * push) /
                        (kHalfLength * (4.0 / 3.0 - kPole * (c * c) / kMass));
    const double speed_up = push - kMoment * turn * c / kMass;
    x_ = x_ + kStep_s * x_rate_;
    x_rate_ = x_rate_ + kStep_s * speed_up;
    angle_ = angle_ + kStep_s * angle_rate_;
    angle_rate_ = angle_rate_ + kStep_s * turn;
    Show(observation);
    return {1, std::abs(x_) > kFarthest || std::abs(angle_) > kSteepest};
  }

 private:
  void Show(std::span<float> observation) const {
    size_t i = 0;
    for (const double value : {x_, x_rate_, angle_, angle_rate_})
      observation[i++] = static_cast<float>(value);
  }

  double x_ = 0, x_rate_ = 0, angle_ = 0, angle_rate_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceTask> MakeCartPole() { return std::make_unique<CartPole>(); }

}  // namespace sandwright
