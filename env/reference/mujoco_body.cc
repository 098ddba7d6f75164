#include "env/reference/mujoco_body.h"

#include <algorithm>
#include <array>

#include "data/base/error.h"
#include "env/reference/mjcf.h"

namespace sandwright {
namespace {

struct DeleteSpec {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};

MujocoModel Compile(const char* xml) {
  std::array<char, 500> message = {};
  const std::unique_ptr<mjSpec, DeleteSpec> spec(
      mj_parseXMLString(xml, nullptr, message.data(), static_cast<int>(message.size())));
  SAND_CHECK(spec, message.data());
  MujocoModel model(mj_compile(spec.get(), nullptr));
  SAND_CHECK(model, mjs_getError(spec.get()));
  return model;
}

}  // namespace

const mjModel& HalfCheetahModel() {
  static const MujocoModel model = [] {
    MujocoModel compiled = Compile(kHalfCheetahXml);
    mj_setTotalmass(compiled.get(), 14);
    mj_setConst(compiled.get(), MujocoData(mj_makeData(compiled.get())).get());
    return compiled;
  }();
  return *model;
}

const mjModel& HopperModel() {
  static const MujocoModel model = Compile(kHopperXml);
  return *model;
}

MujocoBody::MujocoBody(const mjModel& model, int frames)
    : model_(model), data_(mj_makeData(&model)), frames_(frames) {
  SAND_CHECK(data_);
}

double MujocoBody::Advance(std::span<const float> control) {
  const double before_m = data_->qpos[0];
  std::ranges::copy(control, data_->ctrl);
  for (int frame = 0; frame < frames_; ++frame) mj_step(&model_, data_.get());
  return (data_->qpos[0] - before_m) / (model_.opt.timestep * frames_);
}

void MujocoBody::Show(double fastest, std::span<float> observation) {
  auto out = observation.begin();
  for (const double q : position().subspan(1)) *out++ = static_cast<float>(q);
  for (const double v : rate()) *out++ = static_cast<float>(std::clamp(v, -fastest, fastest));
}

float ControlCost(float weight, std::span<const float> control) {
  float sum = 0;
  for (const float value : control) sum += value * value;
  return weight * sum;
}

}  // namespace sandwright
