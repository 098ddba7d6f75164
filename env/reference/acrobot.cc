// Two links, the second one driven (Sutton 1996; the equations of Sutton and Barto's book), one Runge-Kutta
// step of 0.2 s.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

using State = std::array<double, 4>;  // both angles, both rates

State Rates(const State& state, double torque) {
  constexpr double kMiddle = 0.5, kGravity = 9.8;  // links of 1 m, 1 kg, 1 kg m^2
  const auto [angle1, angle2, rate1, rate2] = state;
  const double middle2 = kMiddle * kMiddle;
  const double d1 = middle2 + (1 + middle2 + 2 * kMiddle * std::cos(angle2)) + 1 + 1;
  const double d2 = (middle2 + kMiddle * std::cos(angle2)) + 1;
  const double phi2 = kMiddle * kGravity * std::cos(angle1 + angle2 - std::numbers::pi / 2);
  const double phi1 = -kMiddle * (rate2 * rate2) * std::sin(angle2) -
                      2 * kMiddle * rate2 * rate1 * std::sin(angle2) +
                      (kMiddle + 1) * kGravity * std::cos(angle1 - std::numbers::pi / 2) + phi2;
  const double faster2 =
      (torque + d2 / d1 * phi1 - kMiddle * (rate1 * rate1) * std::sin(angle2) - phi2) /
      (middle2 + 1 - d2 * d2 / d1);
  return {rate1, rate2, -(d2 * faster2 + phi1) / d1, faster2};
}

State Plus(const State& state, double factor, const State& rates) {
  State sum;
  for (size_t i = 0; i < 4; ++i) sum[i] = state[i] + factor * rates[i];
  return sum;
}

double Wrapped(double angle) {
  constexpr double kPi = std::numbers::pi;
  while (angle > kPi) angle -= 2 * kPi;
  while (angle < -kPi) angle += 2 * kPi;
  return angle;
}

class Acrobot final : public ReferenceTask {
 public:
  const ReferenceSpec& spec() const override {
    static const ReferenceSpec spec = {
        "Acrobot-v1",
        {"cos_angle_1", "sin_angle_1", "cos_angle_2", "sin_angle_2", "rate_1_radps", "rate_2_radps"},
        3, 1, 1, 500};
    return spec;
  }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    for (double& value : state_) value = static_cast<float>(random.Uniform(-0.1, 0.1));
    Show(observation);
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    constexpr double kStep_s = 0.2, kPi = std::numbers::pi;
    const double torque = static_cast<double>(action[0]) - 1;
    const State k1 = Rates(state_, torque), k2 = Rates(Plus(state_, kStep_s / 2, k1), torque),
                k3 = Rates(Plus(state_, kStep_s / 2, k2), torque),
                k4 = Rates(Plus(state_, kStep_s, k3), torque);
    for (size_t i = 0; i < 4; ++i)
      state_[i] += kStep_s / 6.0 * (((k1[i] + 2 * k2[i]) + 2 * k3[i]) + k4[i]);
    state_[0] = Wrapped(state_[0]);
    state_[1] = Wrapped(state_[1]);
    state_[2] = std::clamp(state_[2], -4 * kPi, 4 * kPi);
    state_[3] = std::clamp(state_[3], -9 * kPi, 9 * kPi);
    Show(observation);
    const bool up = -std::cos(state_[0]) - std::cos(state_[1] + state_[0]) > 1;
    return {up ? 0.0 : -1.0, up};
  }

 private:
  void Show(std::span<float> observation) const {
    size_t i = 0;
    for (const double value : {std::cos(state_[0]), std::sin(state_[0]), std::cos(state_[1]),
                               std::sin(state_[1]), state_[2], state_[3]})
      observation[i++] = static_cast<float>(value);
  }

  State state_{};
};

}  // namespace

std::unique_ptr<ReferenceTask> MakeAcrobot() { return std::make_unique<Acrobot>(); }

}  // namespace sandwright
