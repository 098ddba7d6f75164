// A planar runner of six motors (Wawrzynski 2009), paid for its speed.
#include <limits>

#include "env/reference/mujoco_body.h"
#include "env/reference/numpy_normal.h"
#include "env/reference/reference_task.h"

namespace sandwright {
namespace {

class HalfCheetah final : public ReferenceTask {
 public:
  explicit HalfCheetah(int version)
      : spec_{"HalfCheetah-v" + std::to_string(version),
              {"height_m", "pitch_rad", "back_thigh_rad", "back_shin_rad", "back_foot_rad",
               "front_thigh_rad", "front_shin_rad", "front_foot_rad", "speed_mps", "climb_mps",
               "pitch_radps", "back_thigh_radps", "back_shin_radps", "back_foot_radps",
               "front_thigh_radps", "front_shin_radps", "front_foot_radps"},
              0, 6, 1, 1000} {}

  const ReferenceSpec& spec() const override { return spec_; }

  void Reset(NumpyRandom& random, std::span<float> observation) override {
    body_.Clear();
    for (double& q : body_.position()) q += random.Uniform(-0.1, 0.1);
    for (double& v : body_.rate()) v += 0.1 * StandardNormal(random);
    body_.Start();
    Show(observation);
  }

  ReferenceStep Step(std::span<const float> action, std::span<float> observation) override {
    const double speed_mps = body_.Advance(action);
    Show(observation);
    return {speed_mps - ControlCost(0.1f, action), false};
  }

 private:
  void Show(std::span<float> observation) {
    body_.Show(std::numeric_limits<double>::infinity(), observation);
  }

  ReferenceSpec spec_;
  MujocoBody body_{HalfCheetahModel(), kHalfCheetahFrames};
};

}  // namespace

std::unique_ptr<ReferenceTask> MakeHalfCheetah(int version) {
  return std::make_unique<HalfCheetah>(version);
}

}  // namespace sandwright
