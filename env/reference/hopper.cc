// A planar leg of three motors that must hop on and not fall (Erez, Tassa and Todorov 2011).
#include <algorithm>
#include <cmath>

#include "env/reference/mujoco_body.h"
#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

class Hopper final : public ReferenceTask {
 public:
  explicit Hopper(int version)
      : spec_{"Hopper-v" + std::to_string(version),
              {"height_m", "pitch_rad", "thigh_rad", "knee_rad", "ankle_rad", "speed_mps",
               "climb_mps", "pitch_radps", "thigh_radps", "knee_radps", "ankle_radps"},
              0, 3, 1, 1000},
        paid_when_fallen_(version == 4) {}

  const ReferenceSpec& spec() const override { return spec_; }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    body_.Clear();
    for (double& q : body_.position()) q += random.Uniform(-0.005, 0.005);
    for (double& v : body_.rate()) v += random.Uniform(-0.005, 0.005);
    body_.Start();
    Show(observation);
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    const double speed_mps = body_.Advance(action);
    Show(observation);
    const bool fallen = !Healthy();
    const double alive = fallen && !paid_when_fallen_ ? 0 : 1;
    return {speed_mps + alive - ControlCost(1e-3f, action), fallen};
  }

 private:
  bool Healthy() {
    const auto sane = [](double value) { return std::abs(value) < 100; };
    const std::span<double> q = body_.position();
    return q[1] > 0.7 && std::abs(q[2]) < 0.2 && std::ranges::all_of(q.subspan(2), sane) &&
           std::ranges::all_of(body_.rate(), sane);
  }

  void Show(std::span<float> observation) { body_.Show(10, observation); }

  ReferenceSpec spec_;
  bool paid_when_fallen_;
  MujocoBody body_{HopperModel(), kHopperFrames};
};

}  // namespace

std::unique_ptr<ReferenceTask> MakeHopper(int version) { return std::make_unique<Hopper>(version); }

}  // namespace sandwright
